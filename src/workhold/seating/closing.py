"""Where closing the jaws leads from a configuration, and the descent paths off the passes of subsets of pegs.

Without friction the part moves so that the separation falls as fast as the contacts allow: M. A. Peshkin and
A. C. Sanderson, "Minimization of energy in quasi-static manipulation", IEEE Transactions on Robotics and
Automation 5 (1989).

Descent paths are followed once for all patterns with such subsets. In a pattern such a path is one of its own
as long as no further peg is in the part. From there on it is followed with all pegs.

Glossary
--------
descent path : a path off a saddle along which a function falls, here the separation as the jaws close: J.
    Milnor, *Morse Theory* (1963).
descent cache : descent paths that are kept, as a function's values are: D. Michie, "Memo functions and
    machine learning", Nature 218 (1968).
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
    """Return the rows that a kernel writes into its last argument, an array of shape (rows, ``width``).

    Begin with ``room`` rows, and call the kernel again with four times as many as long as it returns a
    negative number.
    """
    while True:
        out = np.empty((room, width))
        count = kernel(*arguments, out)
        if count >= 0:
            return out[:count]
        room *= 4


def ensure_room(rows: NDArray[Any], count: int, more: int) -> NDArray[Any]:
    """Return an array with room for ``more`` rows after its first
    ``count``: itself, or a larger copy of these.
    """
    if count + more <= len(rows):
        return rows
    out = np.empty((2 * (count + more), *rows.shape[1:]), rows.dtype)
    out[:count] = rows[:count]
    return out


def make_candidate(
    config: NDArray[np.float64] | tuple[float, ...], contacts: Sequence[tuple[int, int]]
) -> NDArray[np.float64]:
    """Return a candidate (24,) without forces, with configuration
    (theta, x, y, S) and (peg, piece) of each contact.

    S is the jaw separation in mm. See ``kernels.seating.columns`` for the layout of candidates.
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
    """The jaws of a pattern about a part.

    Parameters
    ----------
    boundary, pattern : of the part and the pegs.
    size : of the part in mm; a turn in radians times this is compared with shifts.
    """

    boundary: ObstacleBoundary
    pattern: Pattern
    size: float

    @cached_property
    def obstacles(self) -> Obstacles:
        """The part and the pegs, as kernels take them."""
        return self.boundary.make_obstacles(
            self.pattern, self.size, self.pattern.find_least_separation(2.0 * self.size)
        )

    def close_from(
        self, configs: Array, first: float | Array, seats: Array = NO_SEATS, level: float | None = None
    ) -> tuple[Array, NDArray[np.int8]]:
        """Return where closing leads from configurations (N, 4) of theta,
        x, y and S, and how each path ends (N,).

        How is GAVE_UP, AT_REST or AT_THE_STOP of ``kernels.seating.closing``. S is the jaw separation in mm.

        Parameters
        ----------
        first : lengths of the first steps in mm: a number, or (N, 2) for each path: of linear programs, and
            along both faces.
        seats : (M, 4) configurations at which closing is known to end.
        level : S in mm down to which the jaws close; None for the pattern's stop.
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
        """Return the descent paths from configurations (N, 4), with first
        steps (N, 2) in mm; see :meth:`close_from`.

        See ``kernels.seating.columns`` for the layout of nodes.

        Returns
        -------
        tuple
            Nodes (M, 10), numbers (N + 1,) of the first node of each path and, last, M, and how the paths end
            (N,).
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
        """Follow descent paths; return how they end (N,), numbers
        (N + 1,) of their first nodes, and nodes (``room``, 10).

        ``configs`` are replaced by the ends of the paths. Nodes for which there is no room are not written,
        but counted.
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
        """Return paths from configurations (N, 4) along aims, on which no peg enters the part.

        S is the jaw separation in mm. See ``kernels.seating.columns`` for the layout of nodes.

        Parameters
        ----------
        aims, far : (N, 4) and (N,), see ``kernels.seating.closing.move_along_aims``.
        first, longest : greatest length of the first steps and of all steps, in mm.
        most : the largest S, in mm.

        Returns
        -------
        tuple
            Nodes (M, 10), and numbers (N + 1,) of the first node of each path and, last, M.
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
        """Return, for configurations (N, 4), whether the part can be
        taken straight away from all pegs while the jaws stand.

        False for configurations that are not asked for (``asked`` (N,) is False).
        """
        return ~np.isnan(self.find_escape_directions(configs, asked))

    def find_escape_directions(self, configs: Array, asked: NDArray[np.bool_] | None = None) -> Array:
        """Return directions (N,) in radians in which the pegs move on the
        part, in its frame, when it is taken away.

        NaN where there is none, and for configurations that are not asked for (``asked`` (N,) is False).
        """
        out, obstacles = np.zeros(len(configs)), self.obstacles
        if asked is not None:
            out[~asked] = np.nan
        if len(out):
            room = RANGES * len(obstacles.pegs) * len(obstacles.rows) + 1
            axes, ranges = np.empty(len(obstacles.rows)), np.empty((room, 2))
            write_escape_directions(np.ascontiguousarray(configs), obstacles, axes, ranges, out)
        return out

    def find_leaving_at_stop(
        self, starts: Array, ends: Array, stopped: NDArray[np.bool_]
    ) -> NDArray[np.bool_]:
        """Return, for paths that met the stop, whether the part can be
        taken away at their ends or at their starts.

        ``starts`` and ``ends`` are (N, 4), ``stopped`` (N,); False for other paths. A part that can be taken
        away at first can be, wherever closing the jaws leads.
        """
        away = self.find_escaping(ends, stopped)
        return np.asarray(away | self.find_escaping(starts, stopped & ~away))


IntArray = NDArray[np.int64]
# Nodes for which there is room at first.
ROOM = 65_536


def find_descent_starts(rows: Array, size: float) -> tuple[Array, Array]:
    """Return where descent paths begin, at both sides of each of some
    passes (N, 24): rows 2 n and 2 n + 1 of pass n.

    They are configurations (2 N, 4), and lengths of the first steps in mm (2 N, 2). ``size`` is the part's in
    mm. See ``kernels.seating.columns`` for the layout of candidates.
    """
    starts, lengths = np.empty((2 * len(rows), 4)), np.empty((2 * len(rows), 2))
    begin_descents(np.ascontiguousarray(rows), size, starts, lengths)
    return starts, lengths


@define(eq=False)
class DescentCache:
    """The descent paths of all subsets of pegs on a part, as far as they were followed.

    Entries that are written stay where they are: a thread that has read the counts can read the entries while
    others add to them.

    Parameters
    ----------
    numbers : (C, 2) numbers of the paths from both sides of each candidate, -1 as long as they are not known.
    nodes : (M, 10) along all paths: ``kernels.seating.columns``.
    begins : (W + 1,) number of the first node of each path and, last, of all nodes.
    how : (W,) how each path ends: ``kernels.seating.closing``.
    counts : numbers of candidates, nodes and paths; arrays may have more rows.
    """

    numbers: IntArray = field(factory=lambda: np.zeros((0, 2), np.int64))
    nodes: Array = field(factory=lambda: np.empty((ROOM, NODE_LENGTH)))
    begins: IntArray = field(factory=lambda: np.zeros(1, np.int64))
    how: NDArray[np.int8] = field(factory=lambda: np.zeros(0, np.int8))
    counts: tuple[int, int, int] = (0, 0, 0)
    lock: Lock = field(factory=Lock)

    def reserve_candidates(self, count: int) -> int:
        """Make room for ``count`` further candidates, and return the number of the first."""
        with self.lock:
            first, nodes, paths = self.counts
            self.numbers = ensure_room(self.numbers, first, count)
            self.numbers[first : first + count] = -1
            self.counts = first + count, nodes, paths
        return first

    def add_paths(self, candidates: IntArray, nodes: Array, begins: IntArray, how: NDArray[np.int8]) -> None:
        """Add the paths from both sides of N candidates: their nodes,
        numbers (2 N + 1,) of first nodes, and how they end.
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
    """The descent paths of a subset of pegs.

    Parameters
    ----------
    closing : the jaws with these pegs alone.
    candidates : (N, 24) their equilibria.
    cache : holds the paths that were followed so far.
    first : number of the first candidate in the cache.
    """

    closing: ClosingMotion
    candidates: Array
    cache: DescentCache
    first: int = field(init=False)

    def __attrs_post_init__(self) -> None:
        self.first = self.cache.reserve_candidates(len(self.candidates))

    def follow(self, numbers: IntArray) -> None:
        """Follow the paths from candidates, given by their numbers in the
        cache, and add the paths to the cache.
        """
        # Another thread may follow some at the same time: then both are there, and are the same.
        starts, first = find_descent_starts(self.candidates[numbers - self.first], self.closing.size)
        self.cache.add_paths(numbers, *self.closing.trace_paths(starts, first, self.seats))

    @cached_property
    def seats(self) -> Array:
        """The configurations (M, 4) of the candidates at which closing certainly ends."""
        every = self.candidates
        is_seat = (every[:, DOUBT] == 0.0) & ((every[:, SECOND] > 0.0) | (every[:, CONTACTS] == 4.0))
        return np.asarray(every[is_seat][:, CONFIG])
