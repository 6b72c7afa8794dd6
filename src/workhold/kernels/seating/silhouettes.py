"""Whether a part covers the place that it covers elsewhere, see ``seating.silhouette``."""

from __future__ import annotations

from math import cos, hypot, sin

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.compiling import compiled, inner
from workhold.kernels.base.distance import segment_distance
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, IS_ARC, RADIUS, X, Y
from workhold.kernels.base.shallow import is_shallow

Array = NDArray[np.float64]


@inner
def is_near(x: float, y: float, row: Array, most: float) -> bool:
    """Whether a point is within a distance of a segment. The carrier decides of most that they are not."""
    if not is_shallow(row):
        dx, dy = x - row[X], y - row[Y]
        off = hypot(dx, dy) - row[RADIUS] if row[IS_ARC] != 0.0 else dx * row[AXIS_Y] - dy * row[AXIS_X]
        if abs(off) > most:
            return False
    return segment_distance(x, y, row) <= most


@inner
def covers_same(one: Array, other: Array, sign: float, rows: Array, points: Array, most: float) -> bool:
    """Whether a part covers in two configurations the same place; ``sign`` is -1 for one turned over."""
    turn = other[0] - one[0]
    cosine, sine, c, s = cos(turn), sin(turn), cos(one[0]), sin(one[0])
    dx, dy = other[1] - one[1], other[2] - one[2]
    for k in range(points.shape[0]):
        px, py = sign * points[k, 0], points[k, 1]
        # As the point lies on the part in the one configuration.
        x = cosine * px - sine * py + c * dx + s * dy
        y = sine * px + cosine * py + c * dy - s * dx
        near = False
        for row in range(rows.shape[0]):
            near = near or is_near(x, y, rows[row], most)
        if not near:
            return False
    return True


@compiled
def cover_same(
    one: Array,
    others: Array,
    turned_over: NDArray[np.int8],
    rows: Array,
    points: Array,
    most: float,
    out: NDArray[np.int8],
) -> None:
    """Writes whether a part covers in configurations (N, 4) the place that it covers in one (4,).

    Parameters
    ----------
    turned_over : (N,) 1 where the part is turned over, x to -x in its own frame.
    rows, points : (S, 10) faces about the centre of the part, and (M, 2) points on them.
    most : how far in mm a point may be from all faces.
    """
    for n in range(others.shape[0]):
        sign = -1.0 if turned_over[n] == 1 else 1.0
        out[n] = 1 if covers_same(one, others[n], sign, rows, points, most) else 0
