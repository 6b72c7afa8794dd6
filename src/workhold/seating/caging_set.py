"""How far a part can lie off its seat and still come home: the cage, and the placing.

Closing the jaws from a pose decides whether it belongs to the cage. The placing is sought among poses in
which the part is free with the jaws opened, on a grid of orientations and heights, and known to its step.
Paths that begin in the seat and in such poses lead to the extremes of the cage (``seating.extents``).

Glossary
--------
caging set : the configurations from which a part cannot get away without the jaws being opened: E. Rimon and
    A. Blake, "Caging planar bodies by one-parameter two-fingered gripping systems", International Journal of
    Robotics Research 18 (1999).
"""

from __future__ import annotations

from math import asin, pi, tau

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.kernels.seating.closing import AT_REST
from workhold.kernels.seating.configuration_slices import MOST_CROSSINGS, MOST_INTERVALS, free_poses
from workhold.kernels.seating.places import AT_SEAT, SAME_LEVEL
from workhold.seating.closing import Closing
from workhold.seating.extents import Extents
from workhold.seating.join_tree import distances

__all__ = ["CagingSet"]

Array = NDArray[np.float64]
# Cells across the grid, how often it is fitted to the cage, and how much larger it is then.
CELLS, FITS, ROOM = 25, 4, 1.3
# Steepest lean of the grid, in mm per radian, and its least half sizes in radians and mm.
STEEPEST, LEAST = 500.0, np.array([1e-4, 1e-3])
# Steps of closing, in mm, of this part of the cage's size at most.
FIRST_STEP = 0.05
# Configurations that are closed together.
TOGETHER = 64
# Paths begin in as many cells to each side, and are followed on until no extreme moves by more than this part
# of the whole.
CHOSEN, SETTLED = 3, 1e-3


@define(frozen=True, eq=False)
class CagingSet:
    """The poses around a seat, with the jaws opened, from which closing leads into it.

    Parameters
    ----------
    closing : the jaws about the part.
    seat : (4,) configuration.
    seats : (M, 4) configurations of all seats.
    opening : in mm, a hair less than to the pass.
    to_pass : (3,) from the seat to the pass, which belongs to the cage's edge.
    arm : R, largest distance in mm of a point of the silhouette from the centre of its box.
    """

    closing: Closing
    seat: Array
    seats: Array
    opening: float
    to_pass: Array
    arm: float

    def poses(self, half: Array, lean: float, middle: Array | None = None) -> Array:
        """Free poses (N, 5) on a grid of half sizes (2,), nearest first: distance, theta, x, y, S.

        The grid lies about the seat, or about a configuration with the seat's x and S.
        """
        out = np.empty((12 * CELLS * CELLS, 5))
        work = np.empty((MOST_CROSSINGS, 2)), np.empty((2, MOST_INTERVALS, 2))
        step, obstacles = 2.0 * half / CELLS, self.closing.obstacles
        count = free_poses(
            self.seat if middle is None else middle, self.opening, CELLS, step, lean, self.arm, obstacles, *work, out
        )
        return out[:count][np.argsort(out[:count, 0], kind="stable")]

    def come_home(self, configs: Array) -> NDArray[np.bool_]:
        """Whether closing the jaws from configurations (N, 4) ends in the seat."""
        ended, how = self.closing.run(configs, FIRST_STEP, self.seats)
        near = distances(ended, self.seat, self.closing.size) < AT_SEAT
        return np.asarray(near & (how == AT_REST) & (np.abs(ended[:, 3] - self.seat[3]) < SAME_LEVEL))

    @property
    def extents(self) -> Extents:
        """The extremes of the poses of the cage, as far as paths lead to them."""
        reach = np.stack([np.minimum(self.to_pass, 0.0), np.maximum(self.to_pass, 0.0)], axis=1)
        found = Extents(self.closing, self.seat, self.seat[3] + self.opening, self.come_home, reach)
        found.widen(self.seat[None])
        for _ in range(FITS):
            before = np.array(found.reach)
            found.widen(self.starts(found))
            if (np.abs(found.reach - before).max(axis=1) <= SETTLED * np.ptp(found.reach, axis=1)).all():
                break
        return found

    def starts(self, found: Extents) -> Array:
        """Configurations (N, 4) in the cage from which paths begin.

        They are those found that lie farthest and, of poses on a grid about all of them, the ends of x in
        some cells.
        """
        middle, half = found.reach.mean(axis=1), np.ptp(found.reach, axis=1) / 2.0
        turn, up = (found.ends[:, k] - self.seat[k] - middle[k] for k in (0, 2))
        lean = float(np.clip((turn @ up) / max(turn @ turn, 1e-12), -STEEPEST, STEEPEST))
        half = np.maximum([half[0], np.abs(up - lean * turn).max()], LEAST)
        config = self.seat + np.array([middle[0], 0.0, middle[2], 0.0])
        poses = self.poses(np.minimum(ROOM * half, [pi, np.inf]), lean, config)[:, 1:]
        poses = poses[self.come_home(poses)]
        turn, up = poses[:, 0] - config[0], poses[:, 2] - config[2]
        across, along = np.floor(CHOSEN / half[:, None] * [turn, up - lean * turn])
        order = np.lexsort((poses[:, 1], along, across))
        ends = np.flatnonzero(np.diff(across[order]).astype(bool) | np.diff(along[order]).astype(bool))
        ends = np.unique(np.concatenate([[0], ends, ends + 1, [len(poses) - 1]])) if len(poses) else ends
        return np.vstack([poses[order[ends]], found.farthest])

    @property
    def placing(self) -> float:
        """The least |shift| + 2 R sin(|turn| / 2) in mm of a free pose from which closing does not lead home.

        It is no more than that of the pass.
        """
        turn = abs((self.to_pass[0] + pi) % tau - pi)
        own = float(np.hypot(*self.to_pass[1:]) + 2.0 * self.arm * np.sin(turn / 2.0))
        poses = self.poses(np.array([2.0 * asin(min(own / 2.0 / self.arm, 1.0)), own]), 0.0)
        poses = poses[poses[:, 0] < own]
        for start in range(0, len(poses), TOGETHER):
            part = poses[start : start + TOGETHER]
            home = self.come_home(part[:, 1:])
            if not home.all():
                return float(part[np.argmin(home), 0])
        return own
