"""The extremes of a cage: how far a part can be turned and shifted, jaws opened, and still come home.

In an extreme place pegs let the part go no farther that way: what touches balances a pull along it, perhaps with S at its
largest. To such places ways lead (``kernels.seating.reaching``), and closing the jaws leads home from them; so nothing is
told that lies outside the cage. Ways begin in the seat, in poses on a grid around it from which closing leads home, and
where other ways ended. That they miss no extreme is not proven, but compared with sampling: see ``SHORT``.
"""

from __future__ import annotations

from collections.abc import Callable
from math import pi

import numpy as np
from attrs import define, field
from numpy.typing import NDArray

from workhold.seating.descents import LONGEST_STEP, Closing

__all__ = ["Extents"]

Array = NDArray[np.float64]
# Steps of ways: the first of all, in mm, and how much shorter those are that take up where a way left the cage.
FIRST_STEP, SHORTER, TRIES = 0.05, 8.0, 3
# Ways along which turn, x and y grow, and fall.
AIMS = np.vstack([np.eye(3, 4), -np.eye(3, 4)])
# How many times the part's size a way leads at most along x and y.
FARTHEST = 100.0


@define(eq=False)
class Extents:
    """The extremes found so far of the poses of a cage.

    Parameters
    ----------
    closing : the jaws about the part.
    seat : (4,) configuration.
    most : the largest S in mm.
    come_home : whether closing leads home from configurations (N, 4): (N,).
    reach : (3, 2) least and largest turn in radians, and shifts in mm.
    ends : (N, 4) configurations in which they were found, and other ends of ways.
    """

    closing: Closing
    seat: Array
    most: float
    come_home: Callable[[Array], NDArray[np.bool_]]
    reach: Array
    ends: Array = field(factory=lambda: np.empty((0, 4)))

    def widen(self, starts: Array) -> None:
        """Go as far as ways lead from configurations (N, 4) in the cage."""
        configs, aims = np.repeat(starts, len(AIMS), axis=0), np.tile(AIMS, (len(starts), 1))
        longest = LONGEST_STEP * min(self.closing.pattern.radii)
        for _ in range(TRIES):
            ends, home = self.along(configs, aims, longest)
            self.ends = np.vstack([self.ends, ends])
            off = ends[:, :3] - self.seat[:3]
            if len(off):
                self.reach[:, 0] = np.minimum(self.reach[:, 0], off.min(axis=0))
                self.reach[:, 1] = np.maximum(self.reach[:, 1], off.max(axis=0))
            # Beside a pass a step may lead over it.
            configs, aims, longest = ends[~home], aims[~home], longest / SHORTER
            if home.all():
                return

    def along(self, configs: Array, aims: Array, longest: float) -> tuple[Array, NDArray[np.bool_]]:
        """The last configurations (N, 4) on ways from which closing leads home, and whether the ways end there."""
        size = self.closing.size
        bounds = np.array([size * (self.seat[0] + pi), *(FARTHEST * size + self.seat[1:3]), 0.0])
        bounds = np.array([size * (self.seat[0] - pi), *(self.seat[1:3] - FARTHEST * size), 0.0]), bounds
        far = np.where((aims > 0.0).any(axis=1), (aims * bounds[1]).sum(axis=1), (aims * bounds[0]).sum(axis=1))
        nodes, begins = self.closing.reached(configs, aims, far, min(FIRST_STEP, longest), longest, self.most)
        low, high = begins[:-1], begins[1:] - 1
        out = np.array(configs)
        some = high >= low
        low, high = np.array(low[some]), np.array(high[some])
        last, home = np.array(low), np.ones(len(configs), np.bool_)
        at_end = self.come_home(nodes[high, :4])
        last[at_end] = high[at_end]
        home[np.flatnonzero(some)[~at_end]] = False
        going = np.flatnonzero(~at_end)
        while len(going := going[high[going] - last[going] > 1]):
            middle = (last[going] + high[going]) // 2
            inside = self.come_home(nodes[middle, :4])
            last[going[inside]], high[going[~inside]] = middle[inside], middle[~inside]
        out[some] = nodes[last, :4]
        return out, home
