"""Distances from points and from straight pieces to the segments of an outline, and how it turns around a
point.

A clamp's body is a capsule, what lies within a radius of a straight piece: it may lie where that piece is far
enough from the outline.
"""

from __future__ import annotations

from math import atan2, cos, hypot, inf, pi, sin, sqrt

import numpy as np

from workhold.kernels.base.compiling import Array, compiled, compiled_making_arrays, inner
from workhold.kernels.base.feature import (
    AXIS_X,
    AXIS_Y,
    HALF_EXTENT,
    IS_ARC,
    RADIUS,
    SIGN,
    X,
    Y,
    angle_on,
    is_shallow,
    off_shallow,
    point_at,
)


@inner
def segment_distance(x: float, y: float, row: Array) -> float:
    """Distance in mm from a point to one segment (see ``base.feature``)."""
    dx, dy = x - row[X], y - row[Y]
    if row[IS_ARC] == 0.0:
        along = dx * row[AXIS_X] + dy * row[AXIS_Y]
        beyond = max(abs(along) - row[HALF_EXTENT], 0.0)
        return hypot(beyond, dx * row[AXIS_Y] - dy * row[AXIS_X])
    if abs(angle_on(row, x, y)) <= row[HALF_EXTENT]:
        return abs(off_shallow(row, x, y)[0] if is_shallow(row) else hypot(dx, dy) - row[RADIUS])
    low_x, low_y = point_at(row, -row[HALF_EXTENT])
    high_x, high_y = point_at(row, row[HALF_EXTENT])
    return min(hypot(x - low_x, y - low_y), hypot(x - high_x, y - high_y))


@inner
def outline_distance(x: float, y: float, rows: Array) -> float:
    """Distance in mm from a point to the nearest of (N, 10) segments."""
    best = inf
    for k in range(rows.shape[0]):
        best = min(best, segment_distance(x, y, rows[k]))
    return best


@compiled_making_arrays
def outline_distances(points: Array, rows: Array) -> Array:
    """Distances in mm from (M, 2) points to the nearest of (N, 10) segments, shape (M,)."""
    out = np.empty(points.shape[0])
    for k in range(points.shape[0]):
        out[k] = outline_distance(points[k, 0], points[k, 1], rows)
    return out


@inner
def winding_angle(x: float, y: float, row: Array) -> float:
    """Angle in radians that one segment, run along its direction, turns around a point not on it."""
    dx, dy = x - row[X], y - row[Y]
    if row[IS_ARC] == 0.0:
        ax, ay = -row[HALF_EXTENT] * row[AXIS_X] - dx, -row[HALF_EXTENT] * row[AXIS_Y] - dy
        bx, by = row[HALF_EXTENT] * row[AXIS_X] - dx, row[HALF_EXTENT] * row[AXIS_Y] - dy
        return atan2(ax * by - ay * bx, ax * bx + ay * by)
    mid = atan2(row[AXIS_Y], row[AXIS_X])
    ax, ay = row[RADIUS] * cos(mid - row[HALF_EXTENT]) - dx, row[RADIUS] * sin(mid - row[HALF_EXTENT]) - dy
    bx, by = row[RADIUS] * cos(mid + row[HALF_EXTENT]) - dx, row[RADIUS] * sin(mid + row[HALF_EXTENT]) - dy
    turned = atan2(ax * by - ay * bx, ax * bx + ay * by)
    # Seen from inside its circle a counter-clockwise arc turns forward, by up to a whole turn; from outside
    # it turns as its chord does.
    if hypot(dx, dy) < row[RADIUS]:
        if row[HALF_EXTENT] >= pi:
            turned = 2.0 * pi
        elif turned < 0.0:
            turned += 2.0 * pi
    elif row[HALF_EXTENT] >= pi:
        turned = 0.0
    return row[SIGN] * turned


@compiled
def turns_around(x: float, y: float, rows: Array) -> float:
    """Angle in radians that (N, 10) segments, run along their directions, turn around a point not on them."""
    total = 0.0
    for k in range(rows.shape[0]):
        total += winding_angle(x, y, rows[k])
    return total


@compiled
def is_inside(x: float, y: float, rows: Array) -> bool:
    """Whether a point not on the outline lies in the material bounded by (N, 10) segments, material on the
    left."""
    return turns_around(x, y, rows) > pi


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

    It is least at an end of either, or where they cross, or, from an arc's outside, at the foot of the
    perpendicular from its centre. From its inside the distance has no minimum between.
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
    """Distances in mm, which ``distances`` (M,) receives, from straight pieces, given by their ends (M, 2)
    each, to the nearest of (N, 10) segments."""
    for k in range(starts.shape[0]):
        best = inf
        for n in range(rows.shape[0]):
            best = min(best, piece_distance(starts[k], ends[k], rows[n]))
        distances[k] = best
