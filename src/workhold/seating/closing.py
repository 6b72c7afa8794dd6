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

from workhold.kernels.seating.closing import close_jaws, reach_out
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
from workhold.kernels.seating.free_space import RANGES, leave
from workhold.seating.obstacle_boundary import ObstacleBoundary
from workhold.seating.pattern import Pattern

__all__ = [
    "LONGEST_STEP",
    "Closing",
    "DescentCache",
    "DescentPaths",
    "make_candidate",
    "find_descent_starts",
    "filled",
    "with_room",
]


def filled(width: int, room: int, kernel: Callable[..., int], *arguments: Any) -> NDArray[np.float64]:
    """The rows that a kernel writes into its last argument, which is made larger until it has room."""
    while True:
        out = np.empty((room, width))
        count = kernel(*arguments, out)
        if count >= 0:
            return out[:count]
        room *= 4


def with_room(rows: NDArray[Any], count: int, more: int) -> NDArray[Any]:
    """An array with room for more rows: itself, or a copy of twice the length."""
    if count + more <= len(rows):
        return rows
    out = np.empty((2 * (count + more), *rows.shape[1:]), rows.dtype)
    out[:count] = rows[:count]
    return out


def make_candidate(
    config: NDArray[np.float64] | tuple[float, ...], contacts: Sequence[tuple[int, int]]
) -> NDArray[np.float64]:
    """A candidate (24,) without forces: theta, x, y and S, and the pegs that touch, each with its piece."""
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
class Closing:
    """The jaws of a pattern about a part.

    Parameters
    ----------
    boundary, pattern : of the part and the pegs.
    size : of the part in mm.
    """

    boundary: ObstacleBoundary
    pattern: Pattern
    size: float

    @cached_property
    def obstacles(self) -> Obstacles:
        """The part and the pegs, as kernels take them."""
        return self.boundary.obstacles(self.pattern, self.size, self.pattern.end(2.0 * self.size))

    def run(
        self, configs: Array, first: float | Array, seats: Array = NO_SEATS, level: float | None = None
    ) -> tuple[Array, NDArray[np.int8]]:
        """Where configurations (N, 4) of theta, x, y and S end, and how: ``kernels.seating.closing``.

        Parameters
        ----------
        first : how long the first steps are, in mm, or (N, 2) of each path: of linear programs, and along
            both faces.
        seats : (M, 4) configurations at which closing is known to end.
        level : S in mm down to which the jaws close; the pattern's end if None.
        """
        obstacles = self.obstacles
        if level is not None:
            obstacles = obstacles._replace(stop=max(level, obstacles.stop))
        out, lengths = np.array(configs, dtype=np.float64), np.empty((len(configs), 2))
        lengths[:] = first
        ends, _, _ = self.closed(out, lengths, obstacles, seats, 0)
        return out, ends

    def followed(
        self, configs: Array, first: Array, seats: Array
    ) -> tuple[Array, NDArray[np.int64], NDArray[np.int8]]:
        """The descent paths from configurations (N, 4), with first steps (N, 2) in mm; see ``run``.

        Returns
        -------
        tuple
            Nodes (M, 10), where those of each path begin and, last, end, and how the paths end.
        """
        room = USUAL * len(configs)
        while True:
            ends, begins, nodes = self.closed(np.array(configs), first, self.obstacles, seats, room)
            if begins[-1] <= room:
                return nodes[: begins[-1]], begins, ends
            room = int(begins[-1])

    def closed(
        self, configs: Array, lengths: Array, obstacles: Obstacles, seats: Array, room: int
    ) -> tuple[NDArray[np.int8], NDArray[np.int64], Array]:
        """How descent paths end, where their nodes begin, and the nodes, as far as there is room.

        The configurations are moved to the ends of the paths.
        """
        ends, begins, nodes = (
            np.zeros(len(configs), np.int8),
            np.empty(len(configs) + 1, np.int64),
            np.empty((room, NODE_LENGTH)),
        )
        work = DescentWorkSpace.for_pieces(len(obstacles.rows))
        known = seats[np.argsort(seats[:, 3], kind="stable")]
        most = LONGEST_STEP * min(self.pattern.radii)
        close_jaws(configs, lengths, most, obstacles, known, work, ends, begins, nodes)
        return ends, begins, nodes

    def reached(
        self, configs: Array, aims: Array, far: Array, first: float, longest: float, most: float
    ) -> tuple[Array, NDArray[np.int64]]:
        """Paths along aims on which no peg enters the part, from configurations (N, 4).

        Parameters
        ----------
        aims, far : (N, 4) and (N,), as there.
        first, longest : how long the first steps and all of them are, in mm.
        most : the largest S, in mm.

        Returns
        -------
        tuple
            Nodes (M, 10), and where those of each path begin and, last, end.
        """
        obstacles, begins = self.obstacles._replace(most=most), np.empty(len(configs) + 1, np.int64)
        room = USUAL * len(configs)
        work = DescentWorkSpace.for_pieces(len(obstacles.rows))
        while True:
            nodes = np.empty((room, NODE_LENGTH))
            reach_out(np.array(configs), aims, far, first, longest, obstacles, work, begins, nodes)
            if begins[-1] <= room:
                return nodes[: begins[-1]], begins
            room = int(begins[-1])

    def escape(self, configs: Array, asked: NDArray[np.bool_] | None = None) -> NDArray[np.bool_]:
        """Whether the part can be taken straight away from all pegs in configurations (N, 4), jaws standing.

        It is false of configurations that are not asked for (N,).
        """
        return ~np.isnan(self.directions_away(configs, asked))

    def directions_away(self, configs: Array, asked: NDArray[np.bool_] | None = None) -> Array:
        """The directions (N,) in radians, of pegs on the part, in which it can be taken away.

        NaN where there is none, and of configurations that are not asked for (N,).
        """
        out, obstacles = np.zeros(len(configs)), self.obstacles
        if asked is not None:
            out[~asked] = np.nan
        if len(out):
            room = RANGES * len(obstacles.pegs) * len(obstacles.rows) + 1
            axes, ranges = np.empty(len(obstacles.rows)), np.empty((room, 2))
            leave(np.ascontiguousarray(configs), obstacles, axes, ranges, out)
        return out

    def leaves(self, starts: Array, ends: Array, stopped: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Whether a part can be taken away where paths ended that met the stop (N,), or where they began.

        What can be taken away at first can be, wherever closing the jaws leads.
        """
        away = self.escape(ends, stopped)
        return np.asarray(away | self.escape(starts, stopped & ~away))


IntArray = NDArray[np.int64]
# Nodes for which there is room at first.
ROOM = 65_536


def find_descent_starts(rows: Array, size: float) -> tuple[Array, Array]:
    """Where descent paths begin, to one and the other side of each of some passes (N, 24).

    Configurations (2 N, 4), and how long the first steps are in mm (2 N, 2).
    """
    starts, lengths = np.empty((2 * len(rows), 4)), np.empty((2 * len(rows), 2))
    begin_descents(np.ascontiguousarray(rows), size, starts, lengths)
    return starts, lengths


@define(eq=False)
class DescentCache:
    """The descent paths of all subsets of pegs on a part, as far as they were followed.

    What was written stays where it is: whoever has read how much there is reads it while others add to it.

    Parameters
    ----------
    numbers : (C, 2) of the paths off both sides of each candidate, -1 as long as they are not known.
    nodes : (M, 10) along all paths: ``kernels.seating.columns``.
    begins : (W + 1,) where the nodes of each path begin and, last, end.
    how : (W,) how each path ends: ``kernels.seating.closing``.
    counts : how many candidates, nodes and paths there are: there is room for more.
    """

    numbers: IntArray = field(factory=lambda: np.zeros((0, 2), np.int64))
    nodes: Array = field(factory=lambda: np.empty((ROOM, NODE_LENGTH)))
    begins: IntArray = field(factory=lambda: np.zeros(1, np.int64))
    how: NDArray[np.int8] = field(factory=lambda: np.zeros(0, np.int8))
    counts: tuple[int, int, int] = (0, 0, 0)
    lock: Lock = field(factory=Lock)

    def with_candidates(self, count: int) -> int:
        """Makes room for so many further candidates, and returns the number of the first."""
        with self.lock:
            first, nodes, paths = self.counts
            self.numbers = with_room(self.numbers, first, count)
            self.numbers[first : first + count] = -1
            self.counts = first + count, nodes, paths
        return first

    def add(self, candidates: IntArray, nodes: Array, begins: IntArray, how: NDArray[np.int8]) -> None:
        """Adds the paths off both sides of some candidates, with where they begin and how they end."""
        with self.lock:
            every, first, paths = self.counts
            self.nodes, self.how = (
                with_room(self.nodes, first, len(nodes)),
                with_room(self.how, paths, len(how)),
            )
            self.begins = with_room(self.begins, paths + 1, len(how))
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
    cache : what was followed so far.
    first : number of the first candidate in the cache.
    """

    closing: Closing
    candidates: Array
    cache: DescentCache
    first: int = field(init=False)

    def __attrs_post_init__(self) -> None:
        self.first = self.cache.with_candidates(len(self.candidates))

    def follow(self, numbers: IntArray) -> None:
        # Another thread may follow some at the same time: then both are there, and are the same.
        starts, first = find_descent_starts(self.candidates[numbers - self.first], self.closing.size)
        self.cache.add(numbers, *self.closing.followed(starts, first, self.seats))

    @cached_property
    def seats(self) -> Array:
        """Configurations (M, 4) of the candidates at which closing ends for certain."""
        every = self.candidates
        is_seat = (every[:, DOUBT] == 0.0) & ((every[:, SECOND] > 0.0) | (every[:, CONTACTS] == 4.0))
        return np.asarray(every[is_seat][:, CONFIG])
