"""The end of closing the jaws from a configuration, and the descent paths from passes of subsets of pegs.

Without friction the part moves so that the separation falls as fast as the contacts allow: M. A. Peshkin and
A. C. Sanderson, "Minimization of energy in quasi-static manipulation", IEEE Transactions on Robotics and
Automation 5 (1989).

The descent paths of a subset of pegs are followed once, for all patterns that contain the subset. Such a path
is also a descent path of the pattern, up to the point where another peg of the pattern would enter the part.
From that point it is followed with all pegs.

Glossary
--------
descent path : a path from a saddle along which a function falls, here the separation as the jaws close: J.
    Milnor, *Morse Theory* (1963).
descent cache : a store of descent paths already followed, as of a function's values: D. Michie, "Memo
    functions and machine learning", Nature 218 (1968).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from threading import Lock
from typing import Any

import numpy as np
from attrs import define, field
from numpy.typing import NDArray

from workhold.kernels.seating.closing import close_jaws, move_along_aims
from workhold.kernels.seating.columns import (
    CANDIDATE_LENGTH,
    CONFIG,
    CONTACTS,
    DOUBT,
    NODE_LENGTH,
    PEG,
    PIECE,
    SECOND,
    DescentWorkSpace,
    Obstacles,
)
from workhold.kernels.seating.descent_paths import begin_descents
from workhold.kernels.seating.free_space import RANGES, write_escape_directions
from workhold.seating.obstacle_boundary import ObstacleBoundary
from workhold.seating.pattern import Pattern

__all__ = [
    "LONGEST_STEP",
    "ClosingMotion",
    "DescentCache",
    "DescentPaths",
    "make_candidate",
    "find_descent_starts",
    "fill_rows",
    "ensure_room",
]


def fill_rows(width: int, room: int, kernel: Callable[..., int], *arguments: Any) -> NDArray[np.float64]:
    """Return the rows that a kernel writes into a new array (rows, ``width``), which is passed as its last
    argument.

    The kernel is given ``room`` rows and returns how many it wrote, or a negative number where there were too
    few. Then it is called again with four times as many rows.
    """
    while True:
        out = np.empty((room, width))
        count = kernel(*arguments, out)
        if count >= 0:
            return out[:count]
        room *= 4


def ensure_room(rows: NDArray[Any], count: int, more: int) -> NDArray[Any]:
    """Return an array with room for ``more`` rows after the first ``count`` rows of ``rows``.

    It is ``rows`` itself if that is long enough, else a longer array with a copy of these ``count`` rows.
    """
    if count + more <= len(rows):
        return rows
    out = np.empty((2 * (count + more), *rows.shape[1:]), rows.dtype)
    out[:count] = rows[:count]
    return out


def make_candidate(
    config: NDArray[np.float64] | tuple[float, ...], contacts: Sequence[tuple[int, int]]
) -> NDArray[np.float64]:
    """Return a candidate (24,) with a configuration and contacts.

    Its forces and all other columns are 0; free places for contacts have the numbers -1. ``config`` is
    (theta, x, y, S) with the jaw separation S in mm, and ``contacts`` are up to four pairs of numbers (peg,
    piece). A candidate is a configuration with contacts and forces that may be an equilibrium, see
    ``kernels.seating.columns``.
    """
    row = np.zeros(CANDIDATE_LENGTH)
    row[CONFIG] = config
    row[CONTACTS], row[PEG : PEG + 4], row[PIECE : PIECE + 4] = len(contacts), -1.0, -1.0
    for at, (peg, piece) in enumerate(contacts):
        row[PEG + at], row[PIECE + at] = peg, piece
    return row


Array = NDArray[np.float64]
# No step is longer than this part of the peg radius: no wall is thin enough to be passed.
LONGEST_STEP = 0.35
NO_SEATS = np.zeros((0, 4))
# Nodes that a descent path has as a rule.
USUAL = 128


@define(frozen=True, eq=False, slots=False)
class ClosingMotion:
    """The jaws of a pattern and a part between them, for following how the part moves.

    Parameters
    ----------
    boundary, pattern : boundary of the part, and pegs.
    size : the part's size in mm; a turn in radians times ``size`` is compared with shifts.
    """

    boundary: ObstacleBoundary
    pattern: Pattern
    size: float

    @cached_property
    def obstacles(self) -> Obstacles:
        """The part and the pegs, in the form that the kernels take."""
        return self.boundary.make_obstacles(
            self.pattern, self.size, self.pattern.find_least_separation(2.0 * self.size)
        )

    def close_from(
        self, configs: Array, first: float | Array, seats: Array = NO_SEATS, level: float | None = None
    ) -> tuple[Array, NDArray[np.int8]]:
        """Return the configurations in which closing the jaws ends, for starting configurations (N, 4) of
        theta, x, y and the jaw separation S.

        Parameters
        ----------
        first : greatest length of the first steps in mm: a number, or an array (N, 2) with two lengths per
            path, for steps found by linear programs and for steps along both faces touched.
        seats : (M, 4) configurations at which closing is known to end.
        level : value of S in mm at which closing is stopped; None for the pattern's stop.

        Returns
        -------
        tuple
            Configurations at the ends (N, 4), and how each path ends (N,): GAVE_UP, AT_REST or AT_THE_STOP of
            ``kernels.seating.closing``.
        """
        obstacles = self.obstacles
        if level is not None:
            obstacles = obstacles._replace(stop=max(level, obstacles.stop))
        out, lengths = np.array(configs, dtype=np.float64), np.empty((len(configs), 2))
        lengths[:] = first
        ends, _, _ = self.trace_paths_into(out, lengths, obstacles, seats, 0)
        return out, ends

    def trace_paths(
        self, configs: Array, first: Array, seats: Array
    ) -> tuple[Array, NDArray[np.int64], NDArray[np.int8]]:
        """Return the whole descent paths from configurations (N, 4), with first steps (N, 2) as in
        :meth:`close_from`.

        Returns
        -------
        tuple
            Three arrays: the nodes (M, 10) of all paths, one path after the other, see
            ``kernels.seating.columns``; the index (N + 1,) of each path's first node, with M at the end; how
            each path ends (N,), see ``kernels.seating.closing``.
        """
        room = USUAL * len(configs)
        while True:
            ends, begins, nodes = self.trace_paths_into(np.array(configs), first, self.obstacles, seats, room)
            if begins[-1] <= room:
                return nodes[: begins[-1]], begins, ends
            room = int(begins[-1])

    def trace_paths_into(
        self, configs: Array, lengths: Array, obstacles: Obstacles, seats: Array, room: int
    ) -> tuple[NDArray[np.int8], NDArray[np.int64], Array]:
        """Follow descent paths from ``configs`` (N, 4), which are overwritten with the ends of the paths.

        Return three arrays: how each path ends (N,); the index of each path's first node (N + 1,), with the
        number of all nodes at the end; the nodes (``room``, 10). Nodes beyond ``room`` are counted but not
        written.
        """
        ends, begins, nodes = (
            np.zeros(len(configs), np.int8),
            np.empty(len(configs) + 1, np.int64),
            np.empty((room, NODE_LENGTH)),
        )
        work = DescentWorkSpace.allocate(len(obstacles.rows))
        known = seats[np.argsort(seats[:, 3], kind="stable")]
        most = LONGEST_STEP * min(self.pattern.radii)
        close_jaws(configs, lengths, most, obstacles, known, work, ends, begins, nodes)
        return ends, begins, nodes

    def move_along_aims(
        self, configs: Array, aims: Array, far: Array, first: float, longest: float, most: float
    ) -> tuple[Array, NDArray[np.int64]]:
        """Return paths from configurations (N, 4), each moving along its aim while no peg enters the part.

        Parameters
        ----------
        aims, far : (N, 4) directions and (N,) how far to go, see ``kernels.seating.closing.move_along_aims``.
        first, longest : greatest length of the first steps, and of any step, in mm.
        most : the largest jaw separation S, in mm.

        Returns
        -------
        tuple
            Two arrays: the nodes (M, 10) of all paths, see ``kernels.seating.columns``; the index (N + 1,) of
            each path's first node, with M at the end.
        """
        obstacles, begins = self.obstacles._replace(most=most), np.empty(len(configs) + 1, np.int64)
        room = USUAL * len(configs)
        work = DescentWorkSpace.allocate(len(obstacles.rows))
        while True:
            nodes = np.empty((room, NODE_LENGTH))
            move_along_aims(np.array(configs), aims, far, first, longest, obstacles, work, begins, nodes)
            if begins[-1] <= room:
                return nodes[: begins[-1]], begins
            room = int(begins[-1])

    def find_escaping(self, configs: Array, asked: NDArray[np.bool_] | None = None) -> NDArray[np.bool_]:
        """Return for each configuration (N, 4) whether the part can be moved straight away from all pegs
        (N,).

        The jaws stay where they are. ``asked`` (N,) selects configurations; the result is False for all
        others.
        """
        return ~np.isnan(self.find_escape_directions(configs, asked))

    def find_escape_directions(self, configs: Array, asked: NDArray[np.bool_] | None = None) -> Array:
        """Return for each configuration (N, 4) a direction along which the part can be moved straight away
        from all pegs.

        It is the direction in radians (N,) in which the pegs then move relative to the part, in the part's
        frame; NaN where there is none. ``asked`` (N,) selects configurations; the result is NaN for all
        others.
        """
        out, obstacles = np.zeros(len(configs)), self.obstacles
        if asked is not None:
            out[~asked] = np.nan
        if len(out):
            room = RANGES * len(obstacles.pegs) * len(obstacles.rows) + 1
            axes, ranges = np.empty(len(obstacles.rows)), np.empty((room, 2))
            write_escape_directions(np.ascontiguousarray(configs), obstacles, axes, ranges, out)
        return out

    def find_escaping_at_stop(
        self, starts: Array, ends: Array, stopped: NDArray[np.bool_]
    ) -> NDArray[np.bool_]:
        """Return for each of N paths whether it met the stop and the part can be taken away at one of its
        ends.

        ``starts`` and ``ends`` (N, 4) are configurations, ``stopped`` (N,) is True for paths that met the
        stop. A part that can be taken away at the start counts as outside, wherever closing leads.
        """
        away = self.find_escaping(ends, stopped)
        return np.asarray(away | self.find_escaping(starts, stopped & ~away))


IntArray = NDArray[np.int64]
# Nodes for which there is room at first.
ROOM = 65_536


def find_descent_starts(rows: Array, size: float) -> tuple[Array, Array]:
    """Return the starts of the two descent paths from each of N passes.

    They are configurations (2 N, 4) and first step lengths in mm (2 N, 2): rows 2 n and 2 n + 1 are the two
    sides of pass n. ``rows`` (N, 24) are the passes as candidates. ``size`` is the part's in mm. A candidate
    is a configuration with contacts and forces that may be an equilibrium, see ``kernels.seating.columns``.
    """
    starts, lengths = np.empty((2 * len(rows), 4)), np.empty((2 * len(rows), 2))
    begin_descents(np.ascontiguousarray(rows), size, starts, lengths)
    return starts, lengths


@define(eq=False)
class DescentCache:
    """The descent paths followed so far, of all subsets of pegs on a part.

    Written entries never move. So a thread that has read ``counts`` can read the entries while another thread
    adds more.

    Parameters
    ----------
    numbers : (C, 2) for each candidate the numbers of its two paths; -1 where they were not followed yet.
    nodes : (M, 10) nodes of all paths, see ``kernels.seating.columns``.
    begins : (W + 1,) index of each path's first node, with the number of all nodes at the end.
    how : (W,) how each path ends, see ``kernels.seating.closing``.
    counts : numbers of candidates, nodes and paths; the arrays may be longer.
    """

    numbers: IntArray = field(factory=lambda: np.zeros((0, 2), np.int64))
    nodes: Array = field(factory=lambda: np.empty((ROOM, NODE_LENGTH)))
    begins: IntArray = field(factory=lambda: np.zeros(1, np.int64))
    how: NDArray[np.int8] = field(factory=lambda: np.zeros(0, np.int8))
    counts: tuple[int, int, int] = (0, 0, 0)
    lock: Lock = field(factory=Lock)

    def reserve_candidates(self, count: int) -> int:
        """Make room for ``count`` more candidates, and return the number of the first of them."""
        with self.lock:
            first, nodes, paths = self.counts
            self.numbers = ensure_room(self.numbers, first, count)
            self.numbers[first : first + count] = -1
            self.counts = first + count, nodes, paths
        return first

    def add_paths(self, candidates: IntArray, nodes: Array, begins: IntArray, how: NDArray[np.int8]) -> None:
        """Add the paths of N candidates (numbers (N,)), two for each.

        ``nodes``, ``begins`` (2 N + 1,) and ``how`` (2 N,) are those that :meth:`ClosingMotion.trace_paths`
        returns.
        """
        with self.lock:
            every, first, paths = self.counts
            self.nodes, self.how = (
                ensure_room(self.nodes, first, len(nodes)),
                ensure_room(self.how, paths, len(how)),
            )
            self.begins = ensure_room(self.begins, paths + 1, len(how))
            self.nodes[first : first + len(nodes)] = nodes
            self.begins[paths + 1 : paths + len(begins)] = first + begins[1:]
            self.how[paths : paths + len(how)] = how
            self.counts = every, first + len(nodes), paths + len(how)
            self.numbers[candidates] = paths + np.arange(len(how)).reshape(-1, 2)


@define(eq=False, slots=False)
class DescentPaths:
    """The descent paths of one subset of pegs.

    Parameters
    ----------
    closing : these pegs alone, and the part between them.
    candidates : (N, 24) equilibria of these pegs.
    cache : the paths followed so far, of this and other subsets.
    first : number in ``cache`` of the first of ``candidates``.
    """

    closing: ClosingMotion
    candidates: Array
    cache: DescentCache
    first: int = field(init=False)

    def __attrs_post_init__(self) -> None:
        self.first = self.cache.reserve_candidates(len(self.candidates))

    def follow(self, numbers: IntArray) -> None:
        """Follow the two descent paths of each candidate in ``numbers`` (its number in the cache), and add
        them to the cache.
        """
        # Another thread may follow some at the same time: then both are there, and are the same.
        starts, first = find_descent_starts(self.candidates[numbers - self.first], self.closing.size)
        self.cache.add_paths(numbers, *self.closing.trace_paths(starts, first, self.seats))

    @cached_property
    def seats(self) -> Array:
        """Configurations (M, 4) of the candidates that are certainly seats: closing ends there."""
        every = self.candidates
        is_seat = (every[:, DOUBT] == 0.0) & ((every[:, SECOND] > 0.0) | (every[:, CONTACTS] == 4.0))
        return np.asarray(every[is_seat][:, CONFIG])
