"""The foot of a part on a plate, by another method than the search's: areas and moments from Green's theorem.

The area of the foot within a square of a grid is a sum over the sides of the outline: of the areas between
each side, cut off at the square, and the square's lower edge. Pressures are derived from second moments.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import acos, ceil, cos, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from workhold.geometry.segment import Arc, Segment
from workhold.verification.jaw_forces import PressingJaw, compute_wrenches, find_hull_corners

__all__ = ["Foot"]

Array = NDArray[np.float64]
# mm. How far chords may be off an arc, as is claimed; about how many cells a foot has, and directions of friction.
CHORD, CELLS, WAYS = 0.1, 50, 16
# Of a square, the part that counts as a cell.
LEAST_CELL = 1e-6
# The places and weights of Gauss with two points on [0, 1], exact for cubics.
GAUSS = ((0.5 - sqrt(3) / 6, 0.5), (0.5 + sqrt(3) / 6, 0.5))


class Foot:
    """The foot of a part: the area on which it rests, bounded by loops of segments with material on their
    left.

    All data are in the plate's frame, in mm.

    Attributes
    ----------
    sides : (N, 4) start x, y and end x, y of each of the N chords of the loops.
    area, centre, second : the area in mm², the centre of area (2,), and the second moments (2, 2) about the
        centre.
    hull : the corners of the convex hull, counter-clockwise.
    """

    def __init__(self, loops: Sequence[Sequence[Segment]]) -> None:
        self.sides = np.array([side for loop in loops for side in cut_into_chords(loop)])
        low, high = self.extent
        self.area, self.centre, self.second = self.compute_moments(low, high)
        self.hull = find_hull_corners([(float(x), float(y)) for x, y in self.sides[:, :2].round(9)])

    @property
    def extent(self) -> tuple[Array, Array]:
        """The least (x, y) and the greatest (x, y) of the foot, each (2,), in mm."""
        return self.sides[:, :2].min(axis=0), self.sides[:, :2].max(axis=0)

    def compute_moments(self, low: Array, high: Array) -> tuple[float, Array, Array]:
        """Return (area, centre (2,), second moments (2, 2) about that centre) of the part of the foot within
        a box.

        ``low`` and ``high`` are the box's corners (2,). Where the box has no area of the foot, centre and
        moments are NaN.
        """
        total = np.zeros(6)
        for x0, y0, x1, y1 in self.sides:
            total -= integrate_under(x0, y0, x1, y1, low, high)
        area = float(total[0])
        if area <= 0.0:
            return 0.0, np.full(2, np.nan), np.full((2, 2), np.nan)
        x, y, xx, xy, yy = total[1:] / area
        return area, np.array([x, y]), np.array([[xx - x * x, xy - x * y], [xy - x * y, yy - y * y]])

    def compute_pressures(self, middle: Array) -> Array:
        """Return the pressures (H,) in 1/mm² at the H corners of the hull under a unit force at the point
        ``middle`` (2,).

        The pressure is assumed linear in x and y over the foot.
        """
        slope = np.linalg.solve(self.second, middle - self.centre)
        return np.asarray((1.0 + (np.array(self.hull) - self.centre) @ slope) / self.area)

    def make_pressing_jaw(self, friction: float, centre: Array) -> PressingJaw:
        """Return the plate below the foot, in the form of a jaw that presses upward.

        Moments of its wrenches are about ``centre`` (3,). ``friction`` is the coefficient of friction.
        """
        rows, acting = list[Array](), list[Array]()
        for (x, y), (far_x, far_y) in zip(self.hull, [*self.hull[1:], self.hull[0]], strict=True):
            inward = np.array([y - far_y, far_x - x]) / np.hypot(far_x - x, far_y - y)
            level = float(inward @ (x, y))
            mean = float(inward @ self.centre) - level
            rows.append(np.array([-level, *inward]) / (mean * self.area))
            acting.append(self.centre + self.second @ inward / mean)
        pressures, at = np.array(rows), np.array(acting)
        up = compute_wrenches(np.column_stack([at, np.zeros(len(at))]) - centre, (0.0, 0.0, 1.0))
        places, areas = self.make_cells()
        cells = np.column_stack([places, np.zeros(len(places))]) - centre
        turns = [2 * np.pi * k / WAYS for k in range(WAYS)]
        rubbing = np.stack([compute_wrenches(cells, (cos(turn), sin(turn), 0.0)) for turn in turns], axis=1)
        local = pressures @ np.column_stack([np.ones(len(places)), places]).T
        return PressingJaw(up, rubbing, friction * np.maximum(local, 0.0) * areas)

    def make_cells(self) -> tuple[Array, Array]:
        """Return (centres (C, 2), areas (C,)) of the C pieces into which a square grid cuts the foot; slivers
        are left out.
        """
        low, high = self.extent
        counts = np.ceil((high - low) / sqrt(self.area / CELLS)).astype(int)
        size = (high - low) / counts
        places, areas = list[Array](), list[float]()
        for across in range(counts[0]):
            for up in range(counts[1]):
                corner = low + size * (across, up)
                area, centre, _ = self.compute_moments(corner, corner + size)
                if area > LEAST_CELL * size.prod():
                    places.append(centre)
                    areas.append(area)
        return np.array(places), np.array(areas)


def integrate_under(x0: float, y0: float, x1: float, y1: float, low: Array, high: Array) -> Array:
    """Return the integrals (6,) of 1, x, y, xx, xy, yy over the area between a directed side and the box's
    lower edge.

    The side runs from (x0, y0) to (x1, y1) and is cut off at the box with the corners ``low`` and ``high``.
    The integrals are negative where x falls along the side.
    """
    out = np.zeros(6)
    if x0 == x1:
        return out
    rise = (y1 - y0) / (x1 - x0)
    ends = sorted((min(max(x0, low[0]), high[0]), min(max(x1, low[0]), high[0])))
    cuts = [x0 + (level - y0) / rise for level in (low[1], high[1])] if rise else []
    places = [ends[0], *sorted(cut for cut in cuts if ends[0] < cut < ends[1]), ends[1]]
    for a, b in pairwise(places):
        for share, weight in GAUSS:
            x = a + share * (b - a)
            y = min(max(y0 + rise * (x - x0), low[1]), high[1])
            high_y, square, cube = y - low[1], (y * y - low[1] ** 2) / 2, (y**3 - low[1] ** 3) / 3
            part = np.array([high_y, x * high_y, square, x * x * high_y, x * square, cube])
            out += weight * (b - a) * part
    return out if x1 > x0 else -out


def cut_into_chords(loop: Sequence[Segment]) -> list[tuple[float, float, float, float]]:
    """Return the chords (x, y, next x, next y) of a closed loop; an arc's chords
    are at most ``CHORD`` mm off the arc.
    """
    points = list[tuple[float, float]]()
    for one in loop:
        if not isinstance(one, Arc):
            points.append(one.start)
            continue
        step = 2 * acos(max(1.0 - CHORD / one.radius, 0.0))
        count = max(ceil(2 * one.half_sweep / step), 1)
        turns = [one.mid_angle + one.sign * one.half_sweep * (2 * k / count - 1.0) for k in range(count)]
        points += [
            (one.center[0] + one.radius * cos(turn), one.center[1] + one.radius * sin(turn)) for turn in turns
        ]
    return [(*p, *q) for p, q in zip(points, [*points[1:], points[0]], strict=True)]
