"""Distances from points and from straight pieces to the segments of an outline and to what a tool sweeps.

How an outline turns around a point stands here, too. A clamp's body is a capsule, what lies within a radius
of a straight piece: it may lie where that piece is far enough from the outline.

Swept pieces are segments or arcs along which an axis runs, each with the radius of its cylinder. The nearest
is found in a tree of boxes. The tree is a heap: node k has the nodes 2 k and 2 k + 1, and the last half of
the nodes are leaves with a few pieces each.

References
----------
J. Goldsmith and J. Salmon, "Automatic Creation of Object Hierarchies for Ray Tracing", IEEE Computer Graphics
and Applications 7 (1987), for bounds of boxes that hold boxes.
"""

from __future__ import annotations

from math import atan2, cos, hypot, inf, pi, sin, sqrt
from typing import NamedTuple

import numpy as np

from workhold.kernels.base.compiling import (
    Array,
    IntVector,
    Matrix,
    Vector,
    compiled,
    inner,
)
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


def outline_distances(points: Array, rows: Array) -> Array:
    """Return the distances in mm from (M, 2) points to the nearest of (N, 10) segments, shape (M,)."""
    out = np.empty(points.shape[0])
    write_outline_distances(points, rows, out)
    return out


@compiled
def write_outline_distances(points: Matrix, rows: Matrix, out: Vector) -> None:
    """Write the distances of :func:`outline_distances` to (M,) numbers."""
    for k in range(points.shape[0]):
        out[k] = outline_distance(points[k, 0], points[k, 1], rows)


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
def turns_around(x: float, y: float, rows: Matrix) -> float:
    """Return the angle in radians of :func:`turning_about`."""
    return turning_about(x, y, rows)


@inner
def turning_about(x: float, y: float, rows: Array) -> float:
    """Return the angle in radians that (N, 10) segments, run along their directions, turn around a point not
    on them."""
    total = 0.0
    for k in range(rows.shape[0]):
        total += winding_angle(x, y, rows[k])
    return total


@compiled
def is_inside(x: float, y: float, rows: Matrix) -> bool:
    """Whether a point not on the outline lies in the material bounded by (N, 10) segments, material on the
    left."""
    return turning_about(x, y, rows) > pi


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
def piece_distances(starts: Matrix, ends: Matrix, rows: Matrix, distances: Vector) -> None:
    """Distances in mm, which ``distances`` (M,) receives, from straight pieces, given by their ends (M, 2)
    each, to the nearest of (N, 10) segments."""
    for k in range(starts.shape[0]):
        best = inf
        for n in range(rows.shape[0]):
            best = min(best, piece_distance(starts[k], ends[k], rows[n]))
        distances[k] = best


# Pieces in a leaf, and the nodes that wait at most: a tree is less deep.
LEAF, DEPTH = 4, 64


class SweptTree(NamedTuple):
    """Swept pieces in the order of their tree.

    Parameters
    ----------
    rows : (N, 10) segments and arcs, see ``base.feature``; N is a multiple of the leaves.
    radius : (N,) of the cylinders in mm; -inf for a row that only fills a leaf.
    nodes : (2 L, 5) of each node x0, y0, x1, y1 and the largest radius; the first is none.
    """

    rows: Matrix
    radius: Vector
    nodes: Matrix


@inner
def node_bound(x0: float, y0: float, x1: float, y1: float, node: Array) -> float:
    """Least clearance in mm that anything in a box has to what a node holds."""
    dx = max(max(node[0] - x1, x0 - node[2]), 0.0)
    dy = max(max(node[1] - y1, y0 - node[3]), 0.0)
    return hypot(dx, dy) - node[4]


@compiled
def nearest_swept(
    starts: Matrix,
    ends: Matrix,
    tree: SweptTree,
    waiting: IntVector,
    least: Vector,
    which: IntVector,
) -> None:
    """The least distance less radius in mm, and the piece it is to, from straight pieces to what is swept.

    Parameters
    ----------
    starts, ends : (M, 2) ends in mm; equal for a point.
    waiting : (DEPTH,) room for the numbers of nodes.
    least, which : (M,) receive the distances and the numbers of rows.
    """
    rows, radius, nodes = tree.rows, tree.radius, tree.nodes
    leaves = nodes.shape[0] // 2
    for k in range(starts.shape[0]):
        x0, x1 = min(starts[k, 0], ends[k, 0]), max(starts[k, 0], ends[k, 0])
        y0, y1 = min(starts[k, 1], ends[k, 1]), max(starts[k, 1], ends[k, 1])
        best, found, count = inf, -1, 1
        waiting[0] = 1
        while count > 0:
            count -= 1
            node = waiting[count]
            if node_bound(x0, y0, x1, y1, nodes[node]) >= best:
                continue
            if node < leaves:
                one, other = 2 * node, 2 * node + 1
                if node_bound(x0, y0, x1, y1, nodes[one]) < node_bound(x0, y0, x1, y1, nodes[other]):
                    one, other = other, one
                # The nearer one is looked at first.
                waiting[count], waiting[count + 1] = one, other
                count += 2
                continue
            first = (node - leaves) * LEAF
            for row in range(first, first + LEAF):
                if radius[row] == -inf:
                    continue
                off = piece_distance(starts[k], ends[k], rows[row]) - radius[row]
                if off < best:
                    best, found = off, row
        least[k], which[k] = best, found
