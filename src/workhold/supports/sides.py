"""Sides of triangles: what a support has to give depends on the side that faces it and on its height over it.

Let d be the distance from the side that faces support j, and h_j the height of the triangle over that side.
Then beta_j(q) = d(q) / h_j, and h_j N_j is the same for all supports that face the side. So the worst loads
are looked for once for each directed line through two holes, and not for each of the many more triangles.

Glossary
--------
side : a line from one hole to another; what lies on its left is at a positive distance.
"""

from __future__ import annotations

import numpy as np
from attrs import define, field
from numpy.typing import NDArray

from workhold.conventions import GAP_SLACK
from workhold.model.support_request import SpatialLoad
from workhold.supports.forces import Lines, PegForces, support_forces

__all__ = ["ON_ONE_LINE", "Corners", "Sides"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
# Two supports and a third nearer to their line than this, in mm, are on one line.
ON_ONE_LINE = 1e-6
# Sides whose loads are looked for together.
AT_ONCE = 1 << 16


@define(frozen=True, eq=False)
class Corners:
    """N triangles of holes, run counter-clockwise, with what decides between them; lengths in mm.

    Parameters
    ----------
    numbers : (N, 3) of the holes, the smallest first.
    sides : (N, 3) numbers of the sides that face them, see :attr:`Sides.length`.
    heights : (N, 3) over these sides.
    """

    numbers: IntArray
    sides: IntArray
    heights: Array

    def take(self, rows: NDArray[np.intp] | NDArray[np.bool_]) -> Corners:
        """Some of the triangles."""
        return Corners(self.numbers[rows], self.sides[rows], self.heights[rows])


@define(frozen=True, eq=False)
class Sides:
    """The sides of H holes; side H a + b runs from hole a to hole b.

    Parameters
    ----------
    points : (H, 2) of the holes, in mm in the part's coordinates.
    pegs, bands : of the fixture, and the heights (P, 2) at which pegs press.
    loads : with their heights written out.
    jaw_force : in N.
    """

    points: Array
    pegs: PegForces
    bands: Array
    loads: tuple[SpatialLoad, ...]
    jaw_force: float
    length: Array = field(init=False)
    least: Array = field(init=False)
    most: Array = field(init=False)

    def __attrs_post_init__(self) -> None:
        count = len(self.points)
        apart = self.points[None] - self.points[:, None]
        object.__setattr__(self, "length", np.hypot(apart[..., 0], apart[..., 1]).ravel())
        least, most = (
            np.zeros(count * count if self.loads else 0),
            np.zeros(count * count if self.loads else 0),
        )
        for first in range(0, len(least), AT_ONCE):
            numbers = np.arange(first, min(first + AT_ONCE, len(least)))
            least[numbers], most[numbers] = support_forces(
                self.lines(numbers), self.pegs, self.bands, self.loads, self.jaw_force
            )
        object.__setattr__(self, "least", least)
        object.__setattr__(self, "most", most)

    def lines(self, numbers: IntArray) -> Lines:
        """Sides (...) as lines; those from a hole to itself have no direction, and lie nowhere."""
        begin, end = self.points[numbers // len(self.points)], self.points[numbers % len(self.points)]
        length = self.length[numbers]
        along = (end - begin) / np.where(length > 0.0, length, np.inf)[..., None]
        normals = np.stack([-along[..., 1], along[..., 0]], axis=-1)
        return Lines(normals, -(normals[..., 0] * begin[..., 0] + normals[..., 1] * begin[..., 1]))

    def corners(self, numbers: IntArray, inside: float) -> Corners:
        """Triangles of holes (N, 3), each in order, that are no lines and whose incircle is large enough.

        Parameters
        ----------
        inside : the least radius of the incircle, in mm: no point is farther inside than its centre.
        """
        count = len(self.points)
        i, j, k = numbers.T
        (ax, ay), (bx, by), (cx, cy) = (self.points[one].T for one in (i, j, k))
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        turned = area < 0.0
        first, second = np.where(turned, k, j), np.where(turned, j, k)
        # Of i, j and k the sides j k, k i and i j, or the other way round.
        sides = np.stack(
            [
                first * count + second,
                np.where(turned, i * count + k, k * count + i),
                np.where(turned, j * count + i, i * count + j),
            ],
            axis=1,
        )
        length = self.length[sides]
        area = np.abs(area)
        kept = (area > ON_ONE_LINE * length.max(axis=1, initial=0.0)) & (
            area >= (inside - GAP_SLACK) * (length[:, 0] + length[:, 1] + length[:, 2])
        )
        return Corners(numbers[kept], sides[kept], area[kept, None] / length[kept])

    def reach(self, corners: Corners) -> Array:
        """r_j (N, 3): the clamp force at each support that keeps it in contact, in N."""
        return -self.least[corners.sides] / corners.heights

    def largest(self, corners: Corners) -> Array:
        """The largest force (N, 3) on each support without the clamp, in N."""
        return self.most[corners.sides] / corners.heights

    def incircle(self, corners: Corners) -> Array:
        """Radii (N,) of the incircles."""
        one = 1.0 / corners.heights
        return np.asarray(1.0 / (one[:, 0] + one[:, 1] + one[:, 2]))

    def distances(self, corners: Corners, points: Array) -> Array:
        """Distances (N, 3) of points (N, 2), or of one (2,) for all, from the sides, positive inside."""
        return self.lines(corners.sides).at(points[..., None, :])
