"""Distances from points and from straight pieces to the segments of an outline and to what a tool sweeps.

The angle that an outline turns around a point is computed here, too. A clamp's body is a capsule: all points
within a radius of a straight piece. The body is clear of the part where that piece is far enough from the
outline.

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
    compute_point,
    find_arc_parameter,
    is_shallow,
    measure_shallow_offset,
)


@inner
def measure_segment_distance(x: float, y: float, row: Array) -> float:
    """Return the distance in mm, at least 0, from the point (x, y) to
    one segment row (see ``base.feature``).
    """
    dx, dy = x - row[X], y - row[Y]
    if row[IS_ARC] == 0.0:
        along = dx * row[AXIS_X] + dy * row[AXIS_Y]
        beyond = max(abs(along) - row[HALF_EXTENT], 0.0)
        return hypot(beyond, dx * row[AXIS_Y] - dy * row[AXIS_X])
    if abs(find_arc_parameter(row, x, y)) <= row[HALF_EXTENT]:
        return abs(measure_shallow_offset(row, x, y)[0] if is_shallow(row) else hypot(dx, dy) - row[RADIUS])
    low_x, low_y = compute_point(row, -row[HALF_EXTENT])
    high_x, high_y = compute_point(row, row[HALF_EXTENT])
    return min(hypot(x - low_x, y - low_y), hypot(x - high_x, y - high_y))


@inner
def measure_outline_distance(x: float, y: float, rows: Array) -> float:
    """Return the distance in mm from the point (x, y) to the nearest of (N, 10) segments, inf for none.

    See ``base.feature`` for the layout of ``rows``.
    """
    best = inf
    for k in range(rows.shape[0]):
        best = min(best, measure_segment_distance(x, y, rows[k]))
    return best


def measure_outline_distances(points: Array, rows: Array) -> Array:
    """Return the distance in mm from each of (M, 2) points to the nearest of (N, 10) segments, shape (M,).

    See ``base.feature`` for the layout of ``rows``.
    """
    out = np.empty(points.shape[0])
    write_outline_distances(points, rows, out)
    return out


@compiled
def write_outline_distances(points: Matrix, rows: Matrix, out: Vector) -> None:
    """Write the distance in mm from each of (M, 2) points to the nearest of (N, 10) segments to ``out`` (M,).

    See ``base.feature`` for the layout of ``rows``.
    """
    for k in range(points.shape[0]):
        out[k] = measure_outline_distance(points[k, 0], points[k, 1], rows)


@inner
def measure_winding_angle(x: float, y: float, row: Array) -> float:
    """Return the signed angle in radians by which the ray from a
    point to one segment turns along that segment.

    Counter-clockwise is positive. The segment runs in its own direction: an arc with SIGN -1 clockwise. The
    point must not lie on the segment. See ``base.feature`` for the layout of ``row``.
    """
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
def measure_winding(x: float, y: float, rows: Matrix) -> float:
    """Return the angle in radians by which the ray from a point to (N, 10) segments turns in all.

    It is 2 pi inside a closed counter-clockwise outline and 0 outside. The point must not lie on a segment.
    See ``base.feature`` for the layout of ``rows``.
    """
    total = 0.0
    for k in range(rows.shape[0]):
        total += measure_winding_angle(x, y, rows[k])
    return total


def is_inside(x: float, y: float, rows: Array) -> bool:
    """Return whether the point (x, y), not on the outline, lies in the material that (N, 10) segments bound.

    The segments form closed loops with the material on their left. See ``base.feature`` for the layout of
    ``rows``.
    """
    return measure_winding(x, y, rows) > pi


# Two straight pieces whose directions have a smaller cross product meet at an end of one, if at all.
PARALLEL = 1e-12


@inner
def measure_distance_to_piece(x: float, y: float, start: Array, ax: float, ay: float, length: float) -> float:
    """Return the distance in mm from the point (x, y) to a straight piece.

    The piece begins at ``start`` (2,) and has the direction (ax, ay), a unit vector, and ``length`` in mm.
    """
    dx, dy = x - start[0], y - start[1]
    along = min(max(dx * ax + dy * ay, 0.0), length)
    return hypot(dx - along * ax, dy - along * ay)


@inner
def measure_piece_distance(start: Array, end: Array, row: Array) -> float:
    """Return the distance in mm from the straight piece ``start`` to
    ``end`` to one segment (see ``base.feature``).

    The distance is least at an end of either, or where they cross, or, outside an arc's circle, at the foot
    of the perpendicular from its centre. Inside the circle it is least at an end.
    """
    length = hypot(end[0] - start[0], end[1] - start[1])
    best = measure_segment_distance(start[0], start[1], row)
    if length == 0.0:
        return best
    best = min(best, measure_segment_distance(end[0], end[1], row))
    ax, ay = (end[0] - start[0]) / length, (end[1] - start[1]) / length
    for side in (-1.0, 1.0):
        x, y = compute_point(row, side * row[HALF_EXTENT])
        best = min(best, measure_distance_to_piece(x, y, start, ax, ay, length))
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
            best = min(best, measure_segment_distance(start[0] + along * ax, start[1] + along * ay, row))
    return best


@compiled
def write_piece_distances(starts: Matrix, ends: Matrix, rows: Matrix, distances: Vector) -> None:
    """Write the distance in mm from each of M straight pieces to the
    nearest of (N, 10) segments to ``distances`` (M,).

    ``starts`` and ``ends`` (M, 2) are the ends of the pieces in mm. See ``base.feature`` for the layout of
    ``rows``.
    """
    for k in range(starts.shape[0]):
        best = inf
        for n in range(rows.shape[0]):
            best = min(best, measure_piece_distance(starts[k], ends[k], rows[n]))
        distances[k] = best


# Pieces in a leaf, and the nodes that wait at most: a tree is less deep.
LEAF, DEPTH = 4, 64


class SweptTree(NamedTuple):
    """Swept pieces in the order of their tree of boxes.

    Parameters
    ----------
    rows : (N, 10) segments and arcs, see ``base.feature``; N is ``LEAF`` times the number L of leaves.
    radius : (N,) of the cylinders in mm; -inf for a row that only fills a leaf.
    nodes : (2 L, 5) with columns x0, y0, x1, y1 of the box and the largest radius of each node; row 0 is
        unused.
    """

    rows: Matrix
    radius: Vector
    nodes: Matrix


@inner
def bound_node_clearance(x0: float, y0: float, x1: float, y1: float, node: Array) -> float:
    """Return a lower bound in mm of distance minus radius from
    anything in the box (x0, y0, x1, y1) to pieces of a node.
    """
    dx = max(max(node[0] - x1, x0 - node[2]), 0.0)
    dy = max(max(node[1] - y1, y0 - node[3]), 0.0)
    return hypot(dx, dy) - node[4]


@compiled
def write_nearest_swept(
    starts: Matrix,
    ends: Matrix,
    tree: SweptTree,
    waiting: IntVector,
    least: Vector,
    which: IntVector,
) -> None:
    """Write, for each of M straight pieces, the least value of (distance - radius) in mm over all swept
    pieces, and the swept piece that has it.

    Parameters
    ----------
    starts, ends : (M, 2) ends of the pieces in mm; equal for a point.
    waiting : (DEPTH,) work space for numbers of nodes.
    least, which : (M,) receive the distances (negative inside a cylinder) and the rows in ``tree.rows``; inf
        and -1 where the tree holds no piece.
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
            if bound_node_clearance(x0, y0, x1, y1, nodes[node]) >= best:
                continue
            if node < leaves:
                one, other = 2 * node, 2 * node + 1
                if bound_node_clearance(x0, y0, x1, y1, nodes[one]) < bound_node_clearance(
                    x0, y0, x1, y1, nodes[other]
                ):
                    one, other = other, one
                # The nearer one is looked at first.
                waiting[count], waiting[count + 1] = one, other
                count += 2
                continue
            first = (node - leaves) * LEAF
            for row in range(first, first + LEAF):
                if radius[row] == -inf:
                    continue
                off = measure_piece_distance(starts[k], ends[k], rows[row]) - radius[row]
                if off < best:
                    best, found = off, row
        least[k], which[k] = best, found
