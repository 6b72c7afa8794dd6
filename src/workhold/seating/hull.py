"""The features of a part that may touch a straight wall: corners, arcs and edges of its convex hull."""

from __future__ import annotations

from functools import cached_property
from math import acos, atan2, cos, hypot, sin, tau

import numpy as np
from attrs import define, frozen
from numpy.typing import NDArray

from workhold.conventions import LEAST_HULL_EDGE, SAME_POSE, TOUCHING
from workhold.geometry.hull_edges import HullPieces
from workhold.kernels.seating.walls import SUPPORTS
from workhold.model.workpiece import Workpiece
from workhold.seating.boundary_pieces import Touch

__all__ = ["Hull", "HullSide"]

Array = NDArray[np.float64]


@frozen
class HullSide:
    """A hull edge that lies on a wall.

    Parameters
    ----------
    angle : of its outward normal on the part, in radians.
    pieces : at its start and its end, run through with the part on its left.
    """

    angle: float
    pieces: tuple[int, int]


@define(frozen=True, eq=False)
class Hull:
    """The pieces of a part's hull.

    Parameters
    ----------
    rows : (H, 6) see ``kernels.seating.walls``.
    touches : what of the part each is.
    """

    rows: Array
    touches: tuple[Touch, ...]

    @classmethod
    def of(cls, workpiece: Workpiece) -> Hull:
        """The hull of a part, about the centre of its box."""
        outer = [face for face in workpiece.faces if face.number < len(workpiece.loops[0])]
        pieces = HullPieces.of([face.segment for face in outer])
        rows = np.concatenate(
            [
                pieces.center - np.array(workpiece.center),
                pieces.radius[:, None],
                pieces.middle,
                pieces.cosine[:, None],
            ],
            axis=1,
        )
        return cls(rows, tuple(Touch(outer[faces[-1]].number, len(faces) > 1) for faces in pieces.faces))

    @property
    def turned_over(self) -> Hull:
        """The hull of the part turned over, x to -x."""
        return Hull(self.rows * np.array([-1.0, 1.0, 1.0, -1.0, 1.0, 1.0]), self.touches)

    @property
    def limits(self) -> Array:
        """Directions in radians in which arcs that are no whole circles cease to support."""
        arcs = self.rows[(self.rows[:, 2] > 0.0) & (self.rows[:, 5] > -1.0)]
        middle, half = np.arctan2(arcs[:, 4], arcs[:, 3]), np.arccos(arcs[:, 5])
        return np.concatenate([middle - half, middle + half]) % tau

    def reach(self, angles: Array) -> Array:
        """The reach (N, H) in mm of the pieces in directions (N,), -inf where they do not support."""
        normal = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        there = normal @ self.rows[:, 3:5].T >= self.rows[:, 5] - SUPPORTS
        return np.asarray(np.where(there, normal @ self.rows[:, :2].T + self.rows[:, 2], -np.inf))

    def clearance(self, configs: Array, wall: tuple[float, float, float]) -> Array:
        """Distances (N,) in mm of the part from a wall in configurations (N, 4); see ``Pattern.wall``."""
        ux, uy, off = wall
        reach = self.reach(atan2(-uy, -ux) - configs[:, 0]).max(axis=1)
        return np.asarray(configs[:, 1] * ux + configs[:, 2] * uy - off - reach)

    @cached_property
    def sides(self) -> list[HullSide]:
        """The hull edges, by their angles."""
        found: list[tuple[float, int]] = []
        for i, one in enumerate(self.rows):
            for j, other in enumerate(self.rows[:i]):
                dx, dy = other[:2] - one[:2]
                size, across = hypot(dx, dy), one[2] - other[2]
                if size * size - across * across < LEAST_HULL_EDGE**2:
                    continue
                for turn in (1.0, -1.0):
                    angle = (atan2(dy, dx) + turn * acos(across / size)) % tau
                    reach = self.reach(np.array([angle]))[0]
                    if min(reach[i], reach[j]) > reach.max() - 2 * TOUCHING:
                        found += [(angle, i), (angle, j)]
        sides: list[HullSide] = []
        for angle, _ in found:
            near = [k for other, k in found if abs((other - angle + 1.0) % tau - 1.0) < SAME_POSE]
            along = self.rows[near, :2] @ [-sin(angle), cos(angle)]
            pieces = near[int(np.argmin(along))], near[int(np.argmax(along))]
            if all(abs((side.angle - angle + 1.0) % tau - 1.0) >= SAME_POSE for side in sides):
                sides.append(HullSide(angle, pieces))
        return sorted(sides, key=lambda side: side.angle)
