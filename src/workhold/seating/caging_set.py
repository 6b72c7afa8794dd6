"""How far from its seat a part may lie so that closing still leads into the seat: the cage, its extremes, and
the placing.

A pose belongs to the cage if closing the jaws from it leads into the seat. The placing is the largest
distance such that closing leads into the seat from every pose within that distance. It is found on a grid of
orientations and heights, among poses in which no peg enters the part while the jaws are opened, and is exact
up to the grid's step. The extremes of the cage are found by following paths that begin in the seat and in
such poses.

At an extreme the contacts balance a pull in that direction, possibly with the jaw separation S at its largest
value. From each extreme, closing the jaws is shown to lead into the seat (``kernels.seating.closing``), so no
extreme lies outside the cage. Completeness is not proven but sampled: ``model.seating.CAGE_SHORT``.

Glossary
--------
caging set : the configurations from which a part cannot get away without the jaws being opened: E. Rimon and
    A. Blake, "Caging planar bodies by one-parameter two-fingered gripping systems", International Journal of
    Robotics Research 18 (1999).
"""

from __future__ import annotations

from collections.abc import Callable
from math import asin, pi, tau

import numpy as np
from attrs import define, field
from numpy.typing import NDArray

from workhold.kernels.seating.closing import AT_REST
from workhold.kernels.seating.descent_paths import AT_SEAT, SAME_LEVEL
from workhold.kernels.seating.free_space import MOST_CROSSINGS, MOST_INTERVALS, write_free_poses
from workhold.seating.closing import LONGEST_STEP, ClosingMotion
from workhold.seating.join_tree import measure_distances

__all__ = ["CagingSet", "PoseExtents"]

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
class PoseExtents:
    """The extreme poses found so far in a cage (the set of poses from which closing the jaws leads into one
    seat).

    Parameters
    ----------
    closing : the jaws and the part between them.
    seat : (4,) configuration of the seat: theta, x, y, S.
    most : the largest S in mm.
    come_home : function that takes configurations (N, 4) and returns whether closing the jaws from each leads
        into the seat.
    reach : (3, 2) least and greatest difference from the seat: turn in radians, shift in x and in y in mm.
    ends : (N, 4) end points of paths, as configurations in the cage.
    """

    closing: ClosingMotion
    seat: Array
    most: float
    come_home: Callable[[Array], NDArray[np.bool_]]
    reach: Array
    ends: Array = field(factory=lambda: np.empty((0, 4)))

    @property
    def farthest(self) -> Array:
        """Six of ``ends`` as rows (6, 4): those with the least theta, x and y, then those with the largest."""
        return np.array(
            self.ends[np.append(self.ends[:, :3].argmin(axis=0), self.ends[:, :3].argmax(axis=0))]
        )

    def widen(self, starts: Array) -> None:
        """Follow paths from configurations (N, 4) in the cage to least and largest theta, x and y.

        Append the ends of the paths to ``ends``, and widen ``reach`` so that it holds them.
        """
        configs, aims = np.repeat(starts, len(AIMS), axis=0), np.tile(AIMS, (len(starts), 1))
        longest = LONGEST_STEP * min(self.closing.pattern.radii)
        for _ in range(TRIES):
            ends, left = self.follow_aims(configs, aims, longest)
            self.ends = np.vstack([self.ends, ends])
            off = ends[:, :3] - self.seat[:3]
            self.reach[:, 0] = np.minimum(self.reach[:, 0], off.min(axis=0))
            self.reach[:, 1] = np.maximum(self.reach[:, 1], off.max(axis=0))
            # Beside a pass a step may lead over it, where shorter ones do not.
            configs, aims, longest = ends[left], aims[left], longest / SHORTER
            if not left.any():
                return

    def follow_aims(self, configs: Array, aims: Array, longest: float) -> tuple[Array, NDArray[np.bool_]]:
        """Follow N paths in the cage, each as far as possible along an aim; return the last configuration of
        each.

        Parameters
        ----------
        configs : (N, 4) configurations at which the paths start.
        aims : (N, 4) unit vectors in (theta times the part's size, x, y, S): the direction in which a path
            goes.
        longest : greatest length of a step, in mm.

        Returns
        -------
        tuple
            Configurations (N, 4) of theta, x, y and the jaw separation S, and whether each path left the cage
            after that configuration (N,).
        """
        size = self.closing.size
        far = aims @ (self.seat * [size, 1.0, 1.0, 0.0]) + np.abs(aims) @ (size * FARTHEST)
        nodes, begins = self.closing.move_along_aims(
            configs, aims, far, min(FIRST_STEP, longest), longest, self.most
        )
        inside, outside = np.array(begins[:-1]), begins[1:] - 1
        left = ~self.come_home(nodes[outside, :4])
        inside[~left] = outside[~left]
        while len(apart := np.flatnonzero(outside - inside > 1)):
            middle = (inside[apart] + outside[apart]) // 2
            home = self.come_home(nodes[middle, :4])
            inside[apart[home]], outside[apart[~home]] = middle[home], middle[~home]
        return nodes[inside, :4], left


# Cells across the grid, how often it is fitted to the cage, and how much larger it is then.
CELLS, FITS, ROOM = 25, 4, 1.3
# Steepest lean of the grid, in mm per radian, and its least half sizes in radians and mm.
STEEPEST, LEAST = 500.0, np.array([1e-4, 1e-3])
# Steps of closing, in mm, of this part of the cage's size at most.
# Configurations that are closed together.
TOGETHER = 64
# Paths begin in as many cells to each side, and are followed on until no extreme moves by more than this part
# of the whole.
CHOSEN, SETTLED = 3, 1e-3


@define(frozen=True, eq=False)
class CagingSet:
    """The set of poses from which closing the jaws leads into a seat, while the jaws are opened by a given
    length.

    Parameters
    ----------
    closing : the jaws about the part.
    seat : (4,) configuration.
    seats : (M, 4) configurations of all seats.
    opening : opening of the jaws in mm, slightly less than up to the pass.
    to_pass : (3,) turn in radians and shifts in mm from the seat to the pass, where the cage opens.
    arm : R, largest distance in mm of a point of the silhouette from the centre of its box.
    """

    closing: ClosingMotion
    seat: Array
    seats: Array
    opening: float
    to_pass: Array
    arm: float

    def list_free_poses(self, half: Array, lean: float, middle: Array | None = None) -> Array:
        """Return poses on a grid of orientations and heights in which no peg enters the part, nearest first.

        Each row of the (N, 5) array is: distance from the seat in mm, theta, x, y, S (the jaw separation in
        mm). The grid extends by ``half`` (2,) to both sides: radians in theta and mm in y. Its centre is the
        seat or, if given, ``middle``, a configuration (4,) with the seat's x and S. The middle of its heights
        rises by ``lean`` mm per radian. See ``kernels.seating.free_space.write_free_poses`` for the distance.
        """
        out = np.empty((12 * CELLS * CELLS, 5))
        work = np.empty((MOST_CROSSINGS, 2)), np.empty((2, MOST_INTERVALS, 2))
        step, obstacles = 2.0 * half / CELLS, self.closing.obstacles
        count = write_free_poses(
            self.seat if middle is None else middle,
            self.opening,
            CELLS,
            step,
            lean,
            self.arm,
            obstacles,
            *work,
            out,
        )
        return out[:count][np.argsort(out[:count, 0], kind="stable")]

    def find_homecoming(self, configs: Array) -> NDArray[np.bool_]:
        """Return whether closing the jaws from each configuration (N, 4) ends in the seat, as booleans
        (N,).
        """
        ended, how = self.closing.close_from(configs, FIRST_STEP, self.seats)
        near = measure_distances(ended, self.seat, self.closing.size) < AT_SEAT
        return np.asarray(near & (how == AT_REST) & (np.abs(ended[:, 3] - self.seat[3]) < SAME_LEVEL))

    @property
    def extents(self) -> PoseExtents:
        """The extremes of the poses of the cage that paths reach; computed at each access."""
        reach = np.stack([np.minimum(self.to_pass, 0.0), np.maximum(self.to_pass, 0.0)], axis=1)
        found = PoseExtents(self.closing, self.seat, self.seat[3] + self.opening, self.find_homecoming, reach)
        found.widen(self.seat[None])
        for _ in range(FITS):
            before = np.array(found.reach)
            found.widen(self.list_path_starts(found))
            if (np.abs(found.reach - before).max(axis=1) <= SETTLED * np.ptp(found.reach, axis=1)).all():
                break
        return found

    def list_path_starts(self, found: PoseExtents) -> Array:
        """Return configurations (N, 4) in the cage from which to continue the search for its extremes.

        They are the farthest configurations in ``found``, and free poses in the cage: the range of turns and
        heights in ``found`` is divided into cells, and the poses with the least and the largest x in each
        cell are taken.
        """
        middle, half = found.reach.mean(axis=1), np.ptp(found.reach, axis=1) / 2.0
        turn, up = (found.ends[:, k] - self.seat[k] - middle[k] for k in (0, 2))
        lean = float(np.clip((turn @ up) / max(turn @ turn, 1e-12), -STEEPEST, STEEPEST))
        half = np.maximum([half[0], np.abs(up - lean * turn).max()], LEAST)
        config = self.seat + np.array([middle[0], 0.0, middle[2], 0.0])
        poses = self.list_free_poses(np.minimum(ROOM * half, [pi, np.inf]), lean, config)[:, 1:]
        poses = poses[self.find_homecoming(poses)]
        turn, up = poses[:, 0] - config[0], poses[:, 2] - config[2]
        across, along = np.floor(CHOSEN / half[:, None] * [turn, up - lean * turn])
        order = np.lexsort((poses[:, 1], along, across))
        ends = np.flatnonzero(np.diff(across[order]).astype(bool) | np.diff(along[order]).astype(bool))
        ends = np.unique(np.concatenate([[0], ends, ends + 1, [len(poses) - 1]])) if len(poses) else ends
        return np.vstack([poses[order[ends]], found.farthest])

    @property
    def placing(self) -> float:
        """The distance in mm from the seat to the nearest free pose from which closing does not lead into the
        seat.

        A pose that is shifted and turned has the distance |shift| + 2 R sin(|turn| / 2), with R = ``arm``.
        The result is at most the distance of the pass. It is computed at each access.
        """
        turn = abs((self.to_pass[0] + pi) % tau - pi)
        own = float(np.hypot(*self.to_pass[1:]) + 2.0 * self.arm * np.sin(turn / 2.0))
        poses = self.list_free_poses(np.array([2.0 * asin(min(own / 2.0 / self.arm, 1.0)), own]), 0.0)
        poses = poses[poses[:, 0] < own]
        for start in range(0, len(poses), TOGETHER):
            part = poses[start : start + TOGETHER]
            home = self.find_homecoming(part[:, 1:])
            if not home.all():
                return float(part[np.argmin(home), 0])
        return own
