"""Where closing the jaws leads from a configuration, and whether a part can be taken away from all pegs."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.kernels.seating.closing import close_jaws
from workhold.kernels.seating.columns import NODE_LENGTH, Obstacles, WorkSpace
from workhold.kernels.seating.leaving import RANGES, leave
from workhold.kernels.seating.reaching import reach_out
from workhold.seating.locus import Locus
from workhold.seating.pattern import Pattern

__all__ = ["LONGEST_STEP", "Closing"]

Array = NDArray[np.float64]
# No step is longer than this part of the peg radius: no wall is thin enough to be passed.
LONGEST_STEP = 0.35
NO_SEATS = np.zeros((0, 4))
# Nodes that a way down has as a rule.
USUAL = 128


@define(frozen=True, eq=False, slots=False)
class Closing:
    """The jaws of a pattern about a part.

    Parameters
    ----------
    locus, pattern : of the part and the pegs.
    size : of the part in mm.
    """

    locus: Locus
    pattern: Pattern
    size: float

    @cached_property
    def obstacles(self) -> Obstacles:
        """What kernels are given."""
        return self.locus.obstacles(self.pattern, self.size, self.pattern.end(2.0 * self.size))

    def run(
        self, configs: Array, first: float | Array, seats: Array = NO_SEATS, stop: float | None = None
    ) -> tuple[Array, NDArray[np.int8]]:
        """Where configurations (N, 4) of theta, x, y and S end, and how: ``kernels.seating.closing``.

        Parameters
        ----------
        first : how long the first steps are, in mm, or (N, 2) of each way: of linear programs, and along both faces.
        seats : (M, 4) configurations at which closing is known to end.
        stop : S in mm at which the jaws are stopped; where the pattern ends if None.
        """
        obstacles = self.obstacles
        if stop is not None:
            obstacles = obstacles._replace(stop=max(stop, obstacles.stop))
        out, lengths = np.array(configs, dtype=np.float64), np.empty((len(configs), 2))
        lengths[:] = first
        ends, _, _ = self.closed(out, lengths, obstacles, seats, 0)
        return out, ends

    def followed(self, configs: Array, first: Array, seats: Array) -> tuple[Array, NDArray[np.int64], NDArray[np.int8]]:
        """The nodes (M, 10) of the ways from configurations (N, 4), from first steps (N, 2) in mm on, where those of each
        begin and, last, end, and how the ways end; see ``run``."""
        room = USUAL * len(configs)
        while True:
            ends, begins, nodes = self.closed(np.array(configs), first, self.obstacles, seats, room)
            if begins[-1] <= room:
                return nodes[: begins[-1]], begins, ends
            room = int(begins[-1])

    def closed(
        self, configs: Array, lengths: Array, obstacles: Obstacles, seats: Array, room: int
    ) -> tuple[NDArray[np.int8], NDArray[np.int64], Array]:
        """How ways from configurations, which are moved to their ends, end, and their nodes, as far as there is room."""
        ends, begins, nodes = (
            np.zeros(len(configs), np.int8),
            np.empty(len(configs) + 1, np.int64),
            np.empty((room, NODE_LENGTH)),
        )
        work = WorkSpace.for_pieces(len(obstacles.rows))
        known = seats[np.argsort(seats[:, 3], kind="stable")]
        most = LONGEST_STEP * min(self.pattern.radii)
        close_jaws(configs, lengths, most, obstacles, known, work, ends, begins, nodes)
        return ends, begins, nodes

    def reached(
        self, configs: Array, aims: Array, far: Array, first: float, longest: float, most: float
    ) -> tuple[Array, NDArray[np.int64]]:
        """The nodes (M, 10) of ways from configurations (N, 4) along aims on which no peg enters and S is no more than the
        largest, and where those of each begin and, last, end; see ``kernels.seating.reaching``.

        Parameters
        ----------
        aims, far : (N, 4) and (N,), as there.
        first, longest : how long the first steps and all of them are, in mm.
        most : the largest S, in mm.
        """
        obstacles, begins = self.obstacles._replace(most=most), np.empty(len(configs) + 1, np.int64)
        room = USUAL * len(configs)
        work = WorkSpace.for_pieces(len(obstacles.rows))
        while True:
            nodes = np.empty((room, NODE_LENGTH))
            reach_out(np.array(configs), aims, far, first, longest, obstacles, work, begins, nodes)
            if begins[-1] <= room:
                return nodes[: begins[-1]], begins
            room = int(begins[-1])

    def escape(self, configs: Array, asked: NDArray[np.bool_] | None = None) -> NDArray[np.bool_]:
        """Whether the part can be taken straight away from all pegs in configurations (N, 4), jaws as they stand; false of
        those that are not asked for (N,)."""
        return ~np.isnan(self.ways_away(configs, asked))

    def ways_away(self, configs: Array, asked: NDArray[np.bool_] | None = None) -> Array:
        """The directions (N,) in radians in which it can, as pegs move on the part; NaN where it cannot, or is not asked."""
        out, obstacles = np.zeros(len(configs)), self.obstacles
        if asked is not None:
            out[~asked] = np.nan
        if len(out):
            room = RANGES * len(obstacles.pegs) * len(obstacles.rows) + 1
            leave(np.ascontiguousarray(configs), obstacles, np.empty((room, 2)), out)
        return out

    def leaves(self, starts: Array, ends: Array, stopped: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Whether a part can be taken away where ways ended that were stopped (N,), or where they began: what can be taken
        away at first can be, wherever closing the jaws leads."""
        away = self.escape(ends, stopped)
        return np.asarray(away | self.escape(starts, stopped & ~away))
