"""Distance from straight pieces to the segments of an outline: where a clamp's body, a capsule, may lie."""

from __future__ import annotations

from math import hypot, inf, sqrt

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.compiling import compiled, inner
from workhold.kernels.base.distance import segment_distance
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, RADIUS, X, Y
from workhold.kernels.base.shallow import point_at

Array = NDArray[np.float64]

# Two straight pieces whose directions have a smaller cross product meet at an end of one, if at all.
PARALLEL = 1e-12


@inner
def distance_along(x: float, y: float, start: Array, ax: float, ay: float, length: float) -> float:
    """Distance in mm from a point to a straight piece of a direction (unit vector) and a length in mm."""
    dx, dy = x - start[0], y - start[1]
    along = min(max(dx * ax + dy * ay, 0.0), length)
    return hypot(dx - along * ax, dy - along * ay)


@inner
def piece_distance(start: Array, end: Array, row: Array) -> float:
    """Distance in mm from a straight piece to one segment (see ``base.feature``).

    It is least at an end of either, or where they cross, or, from an arc's outside, at the foot of the perpendicular from
    its centre; from its inside the distance has no minimum between.
    """
    length = hypot(end[0] - start[0], end[1] - start[1])
    best = segment_distance(start[0], start[1], row)
    if length == 0.0:
        return best
    best = min(best, segment_distance(end[0], end[1], row))
    ax, ay = (end[0] - start[0]) / length, (end[1] - start[1]) / length
    for side in (-1.0, 1.0):
        x, y = point_at(row, side * row[HALF_EXTENT])
        best = min(best, distance_along(x, y, start, ax, ay, length))
    dx, dy = row[X] - start[0], row[Y] - start[1]
    if row[IS_ARC] == 0.0:
        turn = ax * row[AXIS_Y] - ay * row[AXIS_X]
        if abs(turn) > PARALLEL:
            along = (dx * row[AXIS_Y] - dy * row[AXIS_X]) / turn
            across = (dx * ay - dy * ax) / turn
            if 0.0 <= along <= length and abs(across) <= row[HALF_EXTENT]:
                best = 0.0
        return best
    foot, off = dx * ax + dy * ay, abs(dx * ay - dy * ax)
    half = sqrt(max((row[RADIUS] - off) * (row[RADIUS] + off), 0.0))
    for side in (-1.0, 1.0):
        along = foot + side * half
        if 0.0 <= along <= length:
            best = min(best, segment_distance(start[0] + along * ax, start[1] + along * ay, row))
    return best


@compiled
def piece_distances(starts: Array, ends: Array, rows: Array, distances: Array) -> None:
    """Distances in mm, which ``distances`` (M,) receives, from straight pieces, given by their ends (M, 2) each, to the
    nearest of (N, 10) segments."""
    for k in range(starts.shape[0]):
        best = inf
        for n in range(rows.shape[0]):
            best = min(best, piece_distance(starts[k], ends[k], rows[n]))
        distances[k] = best
