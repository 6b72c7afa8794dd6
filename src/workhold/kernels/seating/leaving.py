"""Whether a part can be taken straight away from all pegs."""

from __future__ import annotations

from math import cos, hypot, pi, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.compiling import compiled, inner
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, RADIUS, SIGN, X, Y
from workhold.kernels.seating.columns import Obstacles
from workhold.kernels.seating.pieces import angle_from_middle

Array = NDArray[np.float64]
# mm. What a peg meets nearer than this it touches already. No unit: ways this near to a face go along it.
TOUCHED, LEVEL = 1e-6, 1e-12


@inner
def meets(row: Array, x: float, y: float, wx: float, wy: float) -> bool:
    """Whether a point moved along a direction enters the part through a piece."""
    dx, dy = x - row[X], y - row[Y]
    if row[IS_ARC] == 0.0:
        entering = wx * row[AXIS_Y] - wy * row[AXIS_X]
        if entering > -LEVEL:
            return False
        t = -(dx * row[AXIS_Y] - dy * row[AXIS_X]) / entering
        return t > TOUCHED and abs((dx + t * wx) * row[AXIS_X] + (dy + t * wy) * row[AXIS_Y]) <= row[HALF_EXTENT]
    middle, size = wx * dx + wy * dy, hypot(dx, dy)
    square = middle * middle - (size - row[RADIUS]) * (size + row[RADIUS])
    if square <= 0.0:
        return False
    # Into a convex arc from without, into a concave one from within.
    t = -middle - row[SIGN] * sqrt(square)
    if t <= TOUCHED:
        return False
    return row[HALF_EXTENT] >= pi or abs(angle_from_middle(row, dx + t * wx, dy + t * wy)) <= row[HALF_EXTENT]


@compiled
def leaves(points: Array, obstacles: Obstacles, ways: int, ux: float, uy: float) -> bool:
    """Whether pegs (K, 2) seen from the part can all move away in one of some directions without entering it, and without a
    wall, from which (ux, uy) points to the part, coming nearer."""
    for k in range(ways):
        wx, wy = cos(2.0 * pi * k / ways), sin(2.0 * pi * k / ways)
        blocked = wx * ux + wy * uy > LEVEL
        for p in range(points.shape[0]):
            side = obstacles.right[p]
            for piece in range(obstacles.parts[side, 0], obstacles.parts[side, 1]):
                blocked = blocked or meets(obstacles.rows[piece], points[p, 0], points[p, 1], wx, wy)
            if blocked:
                break
        if not blocked:
            return True
    return False
