"""Pressure on flat faces that touch: affine on a patch, nowhere negative, its force and moment as exact
integrals.

Two flat and stiff faces on an elastic bed press on each other with p = a + b u + c v, u along the jaw and v
upward. The faces stay in contact everywhere if p is not negative at the corners. Such pressures form a cone.
The edges of the cone are the pressures that vanish along one side of the convex hull of the corners; every
other pressure of the cone is a sum of edges. The kern is the set of possible centres of pressure, the convex
hull of the edges' centres of pressure (for a rectangle of a given height, its middle third).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from functools import cached_property
from itertools import pairwise
from math import sqrt

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.geometry.hull import compute_convex_hull
from workhold.geometry.segment import Point
from workhold.model.jaw_hold import JawPatch, Rectangle

__all__ = ["PatchCells", "PressedPatch", "PressedPolygon", "hulls_meet"]

Array = NDArray[np.float64]
# Cells of a rectangle along the jaw and upward; of a line, upward.
CELLS_ALONG, CELLS_UP, CELLS_OF_LINE = 6, 4, 6
# Approximate number of cells of a foot, and the part of a whole cell below which a piece is dropped as
# rounding.
CELLS_OF_FOOT, LEAST_CELL = 50, 1e-9


@frozen(eq=False)
class PatchCells:
    """The cells of a patch, in which friction acts.

    Parameters
    ----------
    centre : (C, 2) centre of each of C cells, in mm.
    area : (C,) area of each cell in mm²; its length in mm where the patch is a line.
    """

    centre: Array
    area: Array


class PressedFace(ABC):
    """A flat face with the pressures p = a + b u + c v >= 0 that can act on it; the base of faces of all
    outlines.
    """

    @property
    @abstractmethod
    def corners(self) -> list[Point]:
        """Corners of the convex hull in mm, counter-clockwise; two for an upright line."""

    @property
    @abstractmethod
    def integrals(self) -> Array:
        """Integrals (3, 3) over the face of the products of 1, u and v."""

    @cached_property
    def edges(self) -> Array:
        """Extreme pressures (R, 3): coefficients a, b, c of each, scaled to a total force of 1.

        All other pressures are sums of multiples of these.
        """
        return compute_pressure_edges(self.corners, self.integrals[0])

    @cached_property
    def centres(self) -> Array:
        """Centres of pressure (R, 2) of ``edges``, in mm; their convex hull is the kern."""
        return np.asarray((self.edges @ self.integrals)[:, 1:])

    def compute_pressures(self, points: Array) -> Array:
        """Return the pressure of each of the R ``edges`` at points (N, 2),
        clipped to 0 or more, as (R, N).
        """
        return np.maximum(self.edges @ np.column_stack([np.ones(len(points)), points]).T, 0.0)


@frozen(eq=False)
class PressedPatch(PressedFace):
    """A patch of a jaw, with its possible pressures; u runs along the jaw, v upward."""

    patch: JawPatch

    @property
    def rectangles(self) -> tuple[Rectangle, ...]:
        """Rectangles (x0, x1, z0, z1) of the patch, in mm."""
        return self.patch.rectangles

    @cached_property
    def corners(self) -> list[Point]:
        """Corners of the convex hull in mm, counter-clockwise; two for an upright line."""
        return compute_convex_hull(
            (x, z) for x0, x1, z0, z1 in self.rectangles for x in (x0, x1) for z in (z0, z1)
        )

    @cached_property
    def integrals(self) -> Array:
        """Integrals (3, 3) over the patch of the products of 1, u and v."""
        total = np.zeros((3, 3))
        for x0, x1, z0, z1 in self.rectangles:
            width, height = x1 - x0, z1 - z0
            area = height if self.patch.is_line else width * height
            mean = np.array([1.0, (x0 + x1) / 2, (z0 + z1) / 2])
            total += area * (np.outer(mean, mean) + np.diag([0.0, width**2 / 12, height**2 / 12]))
        return total

    @cached_property
    def cells(self) -> PatchCells:
        """Cells of the patch's rectangles: 6 along the jaw by 4 upward in each rectangle, or 6 on a line."""
        centres, areas = list[tuple[float, float]](), list[float]()
        for x0, x1, z0, z1 in self.rectangles:
            along, up = (1, CELLS_OF_LINE) if self.patch.is_line else (CELLS_ALONG, CELLS_UP)
            width, height = (x1 - x0) / along, (z1 - z0) / up
            area = height if self.patch.is_line else width * height
            for k in range(along):
                for m in range(up):
                    centres.append((x0 + (k + 0.5) * width, z0 + (m + 0.5) * height))
                    areas.append(area)
        return PatchCells(np.array(centres), np.array(areas))

    def compute_largest_pressures(self) -> Array:
        """Return the pressure of each of the R ``edges`` at the K corners of the hull, (R, K)."""
        return self.compute_pressures(np.array(self.corners))


@frozen(eq=False)
class PressedPolygon(PressedFace):
    """A flat face of any outline, such as the lower side of a part on a plate, with its possible pressures.

    Parameters
    ----------
    loops : corners (N, 2) in mm of each loop, with the face on its left.
    """

    loops: tuple[Array, ...]

    @cached_property
    def corners(self) -> list[Point]:
        """Corners of the convex hull in mm, counter-clockwise."""
        return compute_convex_hull((float(x), float(y)) for loop in self.loops for x, y in loop)

    @cached_property
    def integrals(self) -> Array:
        """Integrals (3, 3) over the face of the products of 1, u and v."""
        return sum((integrate_polygon(loop) for loop in self.loops), np.zeros((3, 3)))

    @cached_property
    def cells(self) -> PatchCells:
        """About 50 pieces of the face, cut by the squares of a grid, each with its centre of area."""
        points = np.vstack(self.loops)
        low, high = points.min(axis=0), points.max(axis=0)
        side = sqrt(float(self.integrals[0, 0]) / CELLS_OF_FOOT)
        counts = np.ceil((high - low) / side).astype(int)
        size = (high - low) / counts
        centres, areas = list[Array](), list[float]()
        for place in np.ndindex(*counts.tolist()):
            corner = low + size * place
            total = np.zeros((3, 3))
            for loop in self.loops:
                total += integrate_polygon(cut_to_box(loop, corner, corner + size))
            if total[0, 0] > LEAST_CELL * size.prod():
                centres.append(total[0, 1:] / total[0, 0])
                areas.append(float(total[0, 0]))
        return PatchCells(np.array(centres), np.array(areas))


def compute_pressure_edges(corners: Sequence[Point], integral: Array) -> Array:
    """Return the extreme rays (R, 3) of the cone of pressures a + b u + c v that are not negative on a convex
    hull.

    Rows are coefficients a, b, c, scaled to a total force of 1.

    Parameters
    ----------
    corners : corners of the convex hull, counter-clockwise; two for a line that runs upward.
    integral : (3,) integrals of 1, u and v over the face.
    """
    if len(corners) == 2:
        (_, low), (_, high) = sorted(corners, key=lambda one: one[1])
        rows = [(-low, 0.0, 1.0), (high, 0.0, -1.0)]
    else:
        rows = []
        for (u, v), (other_u, other_v) in pairwise([*corners, corners[0]]):
            along, up = other_u - u, other_v - v
            rows.append((up * u - along * v, -up, along))
    pressures = np.array(rows)
    return np.asarray(pressures / (pressures @ integral)[:, None])


def integrate_polygon(loop: Array) -> Array:
    """Return the integrals (3, 3) over a polygon of the products of 1,
    u and v; negative for a clockwise polygon.

    ``loop`` (N, 2) are the corners. Each side makes a triangle with the first corner; a function of second
    degree is integrated exactly from its values at the middles of a triangle's sides.
    """
    total = np.zeros((3, 3))
    if len(loop) < 3:
        return total
    first = loop[0]
    one, other = loop[1:-1], loop[2:]
    area = (
        (one[:, 0] - first[0]) * (other[:, 1] - first[1]) - (one[:, 1] - first[1]) * (other[:, 0] - first[0])
    ) / 2
    for middle in ((first + one) / 2, (one + other) / 2, (other + first) / 2):
        rows = np.column_stack([np.ones(len(middle)), middle])
        total += np.einsum("n,ni,nj->ij", area / 3, rows, rows)
    return total


def cut_to_box(loop: Array, low: Array, high: Array) -> Array:
    """Return the part (K, 2) of a polygon (N, 2) that lies in a box (Sutherland & Hodgman).

    The box is from ``low`` to ``high``, (2,) each. Separate pieces stay joined along the border by sides
    without area. Empty where nothing is inside.
    """
    for axis in (0, 1):
        for level, way in ((low[axis], 1.0), (high[axis], -1.0)):
            if not len(loop):
                return loop
            depth = way * (loop[:, axis] - level)
            after, next_depth = np.roll(loop, -1, axis=0), np.roll(depth, -1)
            out = list[Array]()
            for point, other, here, there in zip(loop, after, depth, next_depth, strict=True):
                if here >= 0:
                    out.append(point)
                if (here < 0) != (there < 0):
                    out.append(point + here / (here - there) * (other - point))
            loop = np.array(out).reshape(-1, 2)
    return loop


def hulls_meet(one: Array, other: Array, slack: float) -> bool:
    """Return whether the convex hulls of points (N, 2) and (M, 2) meet, or are at most ``slack`` mm apart.

    Convex sets that do not meet are separated along the normal of a side of one of them; sets without area may
    also be separated along a side, or along the line from one point to the other.

    >>> hulls_meet(np.array([[0, 0], [2, 0], [0, 2]]), np.array([[1.5, 1.5], [1.5, 3]]), 1e-9)
    False
    """
    hulls = [np.array(compute_convex_hull(map(tuple, points.tolist()))) for points in (one, other)]
    directions = [hulls[1][0] - hulls[0][0]]
    for corners in hulls:
        sides = np.roll(corners, -1, axis=0) - corners
        directions += [way for side in sides for way in (side, np.array([-side[1], side[0]]))]
    for way in directions:
        size = np.hypot(*way)
        if size > 0.0:
            mine, theirs = (corners @ (way / size) for corners in hulls)
            if max(theirs.min() - mine.max(), mine.min() - theirs.max()) > slack:
                return False
    return True
