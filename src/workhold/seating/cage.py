"""How far a part can lie off its seat and still come home: the cage, and the placing, both to a grid's step.

Poses are looked at in which the part is free with the jaws opened, on a grid of orientations and heights; whether they
belong to the cage is told by closing the jaws from there. So what is told as within the cage is, but for what lies
between the grid's lines nothing is told.
"""

from __future__ import annotations

from math import asin, pi, tau

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.kernels.seating.closing import AT_REST
from workhold.kernels.seating.fibres import MOST_CROSSINGS, MOST_INTERVALS, free_poses
from workhold.kernels.seating.places import AT_SEAT, SAME_LEVEL
from workhold.seating.descents import Closing
from workhold.seating.tree import distances

__all__ = ["Surroundings"]

Array = NDArray[np.float64]
# Cells across the grid, how often it is fitted to what it finds, and how much larger it is then.
CELLS, FITS, ROOM = 25, 4, 1.3
# Steepest lean of the grid, in mm per radian, and its least half sizes in radians and mm.
STEEPEST, LEAST = 500.0, np.array([1e-4, 1e-3])
# Steps of closing, in mm, of this part of the cage's size at most.
FIRST_STEP = 0.05
# Configurations that are closed together.
TOGETHER = 64
COLUMNS = [0, 1, 2]


@define(frozen=True, eq=False)
class Surroundings:
    """What lies around a seat with the jaws opened.

    Parameters
    ----------
    closing : the jaws about the part.
    seat : (4,) configuration.
    seats : (M, 4) configurations of all seats.
    opening : in mm, a hair less than to the pass.
    way : (3,) from the seat to the pass, which belongs to the cage's edge.
    arm : R, largest distance in mm of a point of the silhouette from the centre of its box.
    """

    closing: Closing
    seat: Array
    seats: Array
    opening: float
    way: Array
    arm: float

    def poses(self, half: Array, lean: float) -> Array:
        """Free poses (N, 5) on a grid of half sizes (2,), nearest first: distance, theta, x, y, S."""
        out = np.empty((12 * CELLS * CELLS, 5))
        work = np.empty((MOST_CROSSINGS, 2)), np.empty((2, MOST_INTERVALS, 2))
        step, obstacles = 2.0 * half / CELLS, self.closing.obstacles
        count = free_poses(self.seat, self.opening, CELLS, step, lean, self.arm, obstacles, *work, out)
        return out[:count][np.argsort(out[:count, 0], kind="stable")]

    def come_home(self, configs: Array) -> NDArray[np.bool_]:
        """Whether closing the jaws from configurations (N, 4) ends in the seat."""
        ended, how = self.closing.run(configs, FIRST_STEP, self.seats)
        near = distances(ended, self.seat, self.closing.size) < AT_SEAT
        return np.asarray(near & (how == AT_REST) & (np.abs(ended[:, 3] - self.seat[3]) < SAME_LEVEL))

    @property
    def cage(self) -> Array:
        """Least and largest turn in radians, x and y in mm, shape (3, 2), of poses found to be in the cage."""
        reach = np.stack([np.minimum(self.way, 0.0), np.maximum(self.way, 0.0)], axis=1)
        lean = float(np.clip(self.way[2] / self.way[0], -STEEPEST, STEEPEST)) if abs(self.way[0]) > 1e-6 else 0.0
        # As far as the pass is, whichever way that is; then fitted.
        size = float(np.hypot(*self.way[1:]) + self.arm * abs(self.way[0]))
        half = np.maximum([size / self.arm, size], LEAST)
        for _ in range(FITS):
            poses = self.poses(np.minimum(half, [pi, np.inf]), lean)
            inside = poses[self.come_home(poses[:, 1:])][:, 1:4] - self.seat[:3]
            if not len(inside):
                half = half / 3.0
                continue
            reach[:, 0] = np.minimum(reach[:, 0], inside.min(axis=0))
            reach[:, 1] = np.maximum(reach[:, 1], inside.max(axis=0))
            beside = inside[:, 2] - lean * inside[:, 0]
            half = ROOM * np.array([np.abs(inside[:, 0]).max(), np.abs(beside).max()]) + 2.0 * half / CELLS
        return reach

    @property
    def placing(self) -> float:
        """Least distance |shift| + 2 R sin(|turn| / 2) in mm of a free pose from which closing does not lead home; no
        more than that of the pass."""
        turn = abs((self.way[0] + pi) % tau - pi)
        own = float(np.hypot(*self.way[1:]) + 2.0 * self.arm * np.sin(turn / 2.0))
        poses = self.poses(np.array([2.0 * asin(min(own / 2.0 / self.arm, 1.0)), own]), 0.0)
        poses = poses[poses[:, 0] < own]
        for start in range(0, len(poses), TOGETHER):
            part = poses[start : start + TOGETHER]
            home = self.come_home(part[:, 1:])
            if not home.all():
                return float(part[np.argmin(home), 0])
        return own
