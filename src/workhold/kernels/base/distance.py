"""Distance from points to the segments of an outline."""

from __future__ import annotations

from math import atan2, cos, hypot, inf, pi, sin

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.compiling import compiled, inner

Array = NDArray[np.float64]


@inner
def segment_distance(x: float, y: float, row: Array) -> float:
    """Distance in mm from a point to one segment (row layout of ``segment_rows``)."""
    dx, dy = x - row[1], y - row[2]
    if row[0] == 0.0:
        along = dx * row[3] + dy * row[4]
        beyond = max(abs(along) - row[5], 0.0)
        return hypot(beyond, dx * row[4] - dy * row[3])
    angle = atan2(row[3] * dy - row[4] * dx, row[3] * dx + row[4] * dy)
    if abs(angle) <= row[5]:
        return abs(hypot(dx, dy) - row[6])
    mid = atan2(row[4], row[3])
    low, high = mid - row[5], mid + row[5]
    to_low = hypot(dx - row[6] * cos(low), dy - row[6] * sin(low))
    to_high = hypot(dx - row[6] * cos(high), dy - row[6] * sin(high))
    return min(to_low, to_high)


@inner
def outline_distance(x: float, y: float, rows: Array) -> float:
    """Distance in mm from a point to the nearest of (N, 8) segments."""
    best = inf
    for k in range(rows.shape[0]):
        best = min(best, segment_distance(x, y, rows[k]))
    return best


@compiled
def outline_distances(points: Array, rows: Array) -> Array:
    """Distances in mm from (M, 2) points to the nearest of (N, 8) segments, shape (M,)."""
    out = np.empty(points.shape[0])
    for k in range(points.shape[0]):
        out[k] = outline_distance(points[k, 0], points[k, 1], rows)
    return out


@inner
def winding_angle(x: float, y: float, row: Array) -> float:
    """Angle in radians that one segment, run along its direction, turns around a point not on it."""
    dx, dy = x - row[1], y - row[2]
    if row[0] == 0.0:
        ax, ay = -row[5] * row[3] - dx, -row[5] * row[4] - dy
        bx, by = row[5] * row[3] - dx, row[5] * row[4] - dy
        return atan2(ax * by - ay * bx, ax * bx + ay * by)
    mid = atan2(row[4], row[3])
    ax, ay = row[6] * cos(mid - row[5]) - dx, row[6] * sin(mid - row[5]) - dy
    bx, by = row[6] * cos(mid + row[5]) - dx, row[6] * sin(mid + row[5]) - dy
    turned = atan2(ax * by - ay * bx, ax * bx + ay * by)
    # Seen from inside its circle a counter-clockwise arc turns forward, by up to a whole turn; from outside it turns as
    # its chord does.
    if hypot(dx, dy) < row[6]:
        if row[5] >= pi:
            turned = 2.0 * pi
        elif turned < 0.0:
            turned += 2.0 * pi
    elif row[5] >= pi:
        turned = 0.0
    return row[7] * turned


@compiled
def turns_around(x: float, y: float, rows: Array) -> float:
    """Angle in radians that (N, 8) segments, run along their directions, turn around a point not on them."""
    total = 0.0
    for k in range(rows.shape[0]):
        total += winding_angle(x, y, rows[k])
    return total


@compiled
def is_inside(x: float, y: float, rows: Array) -> bool:
    """Whether a point not on the outline lies in the material bounded by (N, 8) segments, material on the left."""
    return turns_around(x, y, rows) > pi
