"""Where closing the jaws leads from a configuration, and whether a part can be taken away from all pegs."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.kernels.seating.closing import close_jaws
from workhold.kernels.seating.columns import Obstacles, WorkSpace
from workhold.kernels.seating.leaving import leave
from workhold.seating.locus import Locus
from workhold.seating.pattern import Pattern

__all__ = ["Closing"]

Array = NDArray[np.float64]
# No step is longer than this part of the peg radius: no wall is thin enough to be passed.
LONGEST_STEP = 0.35
# Directions in which a part may be taken away.
DIRECTIONS = 48
NO_SEATS = np.zeros((0, 4))


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
        self, configs: Array, first: float, seats: Array = NO_SEATS, stop: float | None = None
    ) -> tuple[Array, NDArray[np.int8]]:
        """Where configurations (N, 4) of theta, x, y and S end, and how: ``kernels.seating.closing``.

        Parameters
        ----------
        first : how long the first steps are, in mm.
        seats : (M, 4) configurations at which closing is known to end.
        stop : S in mm at which the jaws are stopped; where the pattern ends if None.
        """
        obstacles = self.obstacles
        if stop is not None:
            obstacles = obstacles._replace(stop=max(stop, obstacles.stop))
        out = np.array(configs, dtype=np.float64)
        ends = np.zeros(len(out), np.int8)
        work = WorkSpace.for_pieces(len(obstacles.rows))
        known = seats[np.argsort(seats[:, 3], kind="stable")]
        close_jaws(out, first, LONGEST_STEP * min(self.pattern.radii), obstacles, known, work, ends)
        return out, ends

    def escape(self, configs: Array) -> NDArray[np.bool_]:
        """Whether the part can be taken straight away from all pegs in configurations (N, 4), jaws as they stand, in one of
        many directions."""
        out = np.empty(len(configs), np.int8)
        if len(out):
            leave(np.ascontiguousarray(configs), self.obstacles, DIRECTIONS, np.empty((4, 2)), out)
        return out.astype(np.bool_)
