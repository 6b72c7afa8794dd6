"""The extremes of a cage: how far a part can be turned and shifted, jaws opened, and still come home.

In an extreme place something holds the part back: what touches balances a pull that way, perhaps with S at
its largest. Paths lead to such places (``kernels.seating.reaching``), and closing the jaws leads home from
them, so that no extreme lies outside the cage. That none is missed is not proven but sampled:
``model.seating.CAGE_SHORT``.
"""

from __future__ import annotations

from collections.abc import Callable
from math import pi

import numpy as np
from attrs import define, field
from numpy.typing import NDArray

from workhold.seating.closing import LONGEST_STEP, Closing

__all__ = ["Extents"]

Array = NDArray[np.float64]
# mm. How long the first steps of paths are.
FIRST_STEP = 0.05
# By how much shorter steps are where a path that left the cage is followed anew, and how often that is done.
SHORTER, TRIES = 8.0, 3
# Along turn, x and y, forth and back.
AIMS = np.vstack([np.eye(3, 4), -np.eye(3, 4)])
# How far paths lead at most, in radians and in sizes of the part.
FARTHEST = np.array([pi, 100.0, 100.0, 0.0])


@define(eq=False)
class Extents:
    """The extremes of the poses of a cage that were found so far.

    Parameters
    ----------
    closing : the jaws about the part.
    seat : (4,) configuration.
    most : the largest S in mm.
    come_home : whether closing leads home from configurations (N, 4).
    reach : (3, 2) least and largest turn in radians, and shifts in mm.
    ends : (N, 4) configurations in which paths ended, all in the cage.
    """

    closing: Closing
    seat: Array
    most: float
    come_home: Callable[[Array], NDArray[np.bool_]]
    reach: Array
    ends: Array = field(factory=lambda: np.empty((0, 4)))

    @property
    def farthest(self) -> Array:
        """(6, 4) the ends that lie farthest each way."""
        return np.array(self.ends[np.append(self.ends[:, :3].argmin(axis=0), self.ends[:, :3].argmax(axis=0))])

    def widen(self, starts: Array) -> None:
        """Follows paths from configurations (N, 4) in the cage, and widens the extremes by their ends."""
        configs, aims = np.repeat(starts, len(AIMS), axis=0), np.tile(AIMS, (len(starts), 1))
        longest = LONGEST_STEP * min(self.closing.pattern.radii)
        for _ in range(TRIES):
            ends, left = self.along(configs, aims, longest)
            self.ends = np.vstack([self.ends, ends])
            off = ends[:, :3] - self.seat[:3]
            self.reach[:, 0] = np.minimum(self.reach[:, 0], off.min(axis=0))
            self.reach[:, 1] = np.maximum(self.reach[:, 1], off.max(axis=0))
            # Beside a pass a step may lead over it, where shorter ones do not.
            configs, aims, longest = ends[left], aims[left], longest / SHORTER
            if not left.any():
                return

    def along(self, configs: Array, aims: Array, longest: float) -> tuple[Array, NDArray[np.bool_]]:
        """The last configurations on paths along aims (N, 4) from which closing leads home.

        Parameters
        ----------
        longest : how long steps are at most, in mm.

        Returns
        -------
        tuple
            Configurations (N, 4), and whether each path left the cage (N,).
        """
        size = self.closing.size
        far = aims @ (self.seat * [size, 1.0, 1.0, 0.0]) + np.abs(aims) @ (size * FARTHEST)
        nodes, begins = self.closing.reached(configs, aims, far, min(FIRST_STEP, longest), longest, self.most)
        inside, outside = np.array(begins[:-1]), begins[1:] - 1
        left = ~self.come_home(nodes[outside, :4])
        inside[~left] = outside[~left]
        while len(apart := np.flatnonzero(outside - inside > 1)):
            middle = (inside[apart] + outside[apart]) // 2
            home = self.come_home(nodes[middle, :4])
            inside[apart[home]], outside[apart[~home]] = middle[home], middle[~home]
        return nodes[inside, :4], left
