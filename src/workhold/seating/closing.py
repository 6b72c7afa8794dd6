"""Where closing the jaws leads from a configuration, and whether a part can be taken away from all pegs.

Without friction the part moves so that the separation falls as fast as the contacts allow: M. A. Peshkin and
A. C. Sanderson, "Minimization of energy in quasi-static manipulation", IEEE Transactions on Robotics and
Automation 5 (1989).
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.kernels.seating.closing import close_jaws
from workhold.kernels.seating.columns import NODE_LENGTH, DescentWorkSpace, Obstacles
from workhold.kernels.seating.leaving import RANGES, leave
from workhold.kernels.seating.reaching import reach_out
from workhold.seating.obstacle_boundary import ObstacleBoundary
from workhold.seating.pattern import Pattern

__all__ = ["LONGEST_STEP", "Closing"]

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

    def followed(self, configs: Array, first: Array, seats: Array) -> tuple[Array, NDArray[np.int64], NDArray[np.int8]]:
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
        """Paths along aims on which no peg enters the part, from configurations (N, 4): see ``kernels.seating``.

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
        """Whether the part can be taken straight away from all pegs, jaws as they stand, in configurations (N, 4).

        It is false of configurations that are not asked for (N,).
        """
        return ~np.isnan(self.directions_away(configs, asked))

    def directions_away(self, configs: Array, asked: NDArray[np.bool_] | None = None) -> Array:
        """The directions (N,) in radians, of pegs on the part, in which it can be taken away; NaN if there is none.

        It is NaN of configurations that are not asked for (N,), too.
        """
        out, obstacles = np.zeros(len(configs)), self.obstacles
        if asked is not None:
            out[~asked] = np.nan
        if len(out):
            room = RANGES * len(obstacles.pegs) * len(obstacles.rows) + 1
            leave(np.ascontiguousarray(configs), obstacles, np.empty((room, 2)), out)
        return out

    def leaves(self, starts: Array, ends: Array, stopped: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Whether a part can be taken away where paths ended that met the stop (N,), or where they began.

        What can be taken away at first can be, wherever closing the jaws leads.
        """
        away = self.escape(ends, stopped)
        return np.asarray(away | self.escape(starts, stopped & ~away))
