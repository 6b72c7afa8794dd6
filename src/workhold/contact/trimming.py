"""Removal of the places along contact features at which a tool of a program comes too near to a peg.

Let R be the radius of a tool's cylinder. A peg of radius r on a feature is clear of a swept piece if its
centre is at least d = R + clearance + r from the piece's path. For a shoulder below the part, r is the
shoulder's radius and the pieces are those swept there. So each piece covers an open part of a feature, and
the rest is closed: a place exactly d away is allowed.

The parts are exact. The distance from a segment or an arc is continuous along a feature. It equals d only
where the feature meets the parallels of the segment, the circles about the arc's centre, or the circles of
radius d about the path's ends. On each part between these points, distance minus d has the sign that it has
at the part's middle. A covered part is the union of those of all pieces. Distance changes by no more than the
way along a feature. So a part shorter than ``LEAST_PART`` between two covered ones is marginal, within 1e-6
of the clearance.

What cutting moves take off the faces needs no rule of its own. Let a cutter's axis come within R of a point q
of a face at a height of the pegs. A peg that touches the face within the clearance of q has its centre within
R + clearance + r of the axis, and is ruled out here.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from workhold.contact.swept import SweptSpans
from workhold.geometry.segment import Arc, Segment, compute_bounding_box
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, RADIUS, X, Y

__all__ = ["find_covered_parts", "find_line_most_in_the_way", "trim_to_clear_parts"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

# mm. Shorter parts left of a feature are dropped: their places are within half of this of covered ones.
LEAST_PART = 1e-6


def trim_to_clear_parts(segment: Segment, swept: SweptSpans, beyond: float) -> list[Segment]:
    """Return the parts of a segment on which a peg's centre is clear of the swept space, in ascending order.

    Parameters
    ----------
    beyond : sum of clearance and radius of the peg, in mm.
    """
    return subtract_covered_ranges(segment, find_covered_parts(segment, swept, beyond)[0])


def subtract_covered_ranges(segment: Segment, covered: Array) -> list[Segment]:
    """Return the parts of a segment outside covered ranges (K, 2) of its parameter, except those under
    ``LEAST_PART`` mm."""
    half = segment.half_extent
    if not len(covered):
        return [segment]
    least = LEAST_PART / (segment.radius if isinstance(segment, Arc) else 1.0)
    low, high = covered[np.argsort(covered[:, 0])].T
    ends = np.concatenate([[-half], np.maximum.accumulate(high)])
    begins = np.concatenate([low, [half]])
    return [
        segment.cut_part(a, b) for a, b in zip(ends.tolist(), begins.tolist(), strict=True) if b - a > least
    ]


def find_line_most_in_the_way(segments: Sequence[Segment], swept: SweptSpans, beyond: float) -> int | None:
    """Return the line of the program that covers the longest parts of
    all segments together; None where none covers any.

    Parameters
    ----------
    beyond : clearance and radius of the peg together, in mm.
    """
    lengths: dict[int, float] = {}
    for segment in segments:
        covered, lines = find_covered_parts(segment, swept, beyond)
        scale = segment.radius if isinstance(segment, Arc) else 1.0
        for line in np.unique(lines).tolist():
            free = sum(
                2 * part.half_extent for part in subtract_covered_ranges(segment, covered[lines == line])
            )
            lengths[line] = lengths.get(line, 0.0) + (2 * segment.half_extent - free) * scale
    return max(lengths, key=lambda line: (lengths[line], -line)) if lengths else None


def find_covered_parts(segment: Segment, swept: SweptSpans, beyond: float) -> tuple[Array, IntArray]:
    """Return the ranges of a segment's parameter that swept pieces cover, and the program line of each range.

    Parameters
    ----------
    beyond : a piece covers places nearer to its path than the piece's radius plus this, in mm; a filled box
        covers its inside.

    Returns
    -------
    (ranges (K, 2), which may overlap; lines (K,) of the program)
    """
    x0, y0, x1, y1 = compute_bounding_box(segment)
    keep, boxes = swept.tree.radius + beyond, swept.boxes
    gap = np.maximum.reduce([boxes[:, 0] - x1, x0 - boxes[:, 2], boxes[:, 1] - y1, y0 - boxes[:, 3]])
    near = np.flatnonzero((gap < keep) & (swept.line >= 0))
    own = np.array(segment.to_row())
    rows, keep = swept.tree.rows[near], keep[near]
    cuts = np.concatenate(
        [intersect_with_offset_circles(own, rows, keep), find_crossings_with_parallels(own, rows, keep)],
        axis=1,
    )
    ranges, piece = list_covered_parts_between_cuts(
        own, cuts, lambda x, y: measure_distances(rows, x, y) < keep[:, None]
    )
    lines = swept.line[near][piece]
    if len(swept.filled):
        inside, box = find_parts_inside_boxes(own, swept.filled)
        ranges, lines = np.concatenate([ranges, inside]), np.concatenate([lines, swept.filled_by[box, 0]])
    return ranges, lines


def list_covered_parts_between_cuts(
    own: Array, cuts: Array, is_covered: Callable[[Array, Array], NDArray[np.bool_]]
) -> tuple[Array, IntArray]:
    """Return the ranges between neighbouring cuts of a segment whose middles are covered, and the piece that
    covers each.

    Parameters
    ----------
    own : kernel row of the segment.
    cuts : (P, C) parameters at which each of P pieces cuts the segment, in any order; NaN and those beyond
        its ends are ignored.
    is_covered : called with x and y (P, C + 1) of points; returns for each whether the piece of its row
        covers it.

    Returns
    -------
    (ranges (K, 2) of the parameter, indices (K,) of the pieces)
    """
    half, count = own[HALF_EXTENT], len(cuts)
    inner = np.where(np.abs(cuts) < half, cuts, half)
    edges = np.sort(np.hstack([np.full((count, 1), -half), inner, np.full((count, 1), half)]), axis=1)
    middles = (edges[:, 1:] + edges[:, :-1]) / 2
    covered = is_covered(*compute_points(own, middles)) & (edges[:, 1:] > edges[:, :-1])
    piece, number = np.nonzero(covered)
    return np.stack([edges[piece, number], edges[piece, number + 1]], axis=1), piece


def compute_points(own: Array, parameter: Array) -> tuple[Array, Array]:
    """Return x and y in mm of the points of a segment, given by its kernel row, at parameters of any
    shape.
    """
    if own[IS_ARC] == 0.0:
        return own[X] + parameter * own[AXIS_X], own[Y] + parameter * own[AXIS_Y]
    cosine, sine = np.cos(parameter), np.sin(parameter)
    return (
        own[X] + own[RADIUS] * (cosine * own[AXIS_X] - sine * own[AXIS_Y]),
        own[Y] + own[RADIUS] * (cosine * own[AXIS_Y] + sine * own[AXIS_X]),
    )


def compute_ends(rows: Array) -> tuple[Array, Array]:
    """Return the low ends and the high ends, (P, 2) each, of kernel rows (P, 10).

    See ``kernels.base.feature`` for the layout of rows.
    """
    is_arc, half = rows[:, IS_ARC] != 0.0, rows[:, HALF_EXTENT]
    axis, center = rows[:, [AXIS_X, AXIS_Y]], rows[:, [X, Y]]
    across = np.stack([-axis[:, 1], axis[:, 0]], axis=1)
    out = []
    for side in (-1.0, 1.0):
        bent = np.cos(half)[:, None] * axis + side * np.sin(half)[:, None] * across
        along = np.where(is_arc[:, None], rows[:, RADIUS, None] * bent, side * half[:, None] * axis)
        out.append(center + along)
    return out[0], out[1]


def intersect_with_offset_circles(own: Array, rows: Array, keep: Array) -> Array:
    """Return parameters (P, 8) at which a segment meets circles of kernel rows, NaN for circles that it does
    not meet.

    For each row there are up to four circles: two of radius ``keep`` (P,) about both ends and, for an arc,
    the two about its centre that are ``keep`` mm outside and inside the arc.
    """
    one, other = compute_ends(rows)
    around, is_arc = rows[:, [X, Y]], rows[:, IS_ARC] != 0.0
    outer = np.where(is_arc, rows[:, RADIUS] + keep, np.nan)
    inner = np.where(is_arc, np.abs(rows[:, RADIUS] - keep), np.nan)
    circles = ((one, keep), (other, keep), (around, outer), (around, inner))
    return np.hstack([intersect_with_circles(own, center, radius) for center, radius in circles])


def intersect_with_circles(own: Array, center: Array, radius: Array) -> Array:
    """Return parameters (P, 2) at which a segment's line or circle
    meets circles (P,), NaN where it does not.
    """
    dx, dy = center[:, 0] - own[X], center[:, 1] - own[Y]
    along, across = dx * own[AXIS_X] + dy * own[AXIS_Y], own[AXIS_X] * dy - own[AXIS_Y] * dx
    with np.errstate(invalid="ignore", divide="ignore"):
        if own[IS_ARC] == 0.0:
            half = np.sqrt((radius - np.abs(across)) * (radius + np.abs(across)))
            return np.stack([along - half, along + half], axis=1)
        away = np.hypot(dx, dy)
        size = ((own[RADIUS] - radius) * (own[RADIUS] + radius) / away + away) / (2 * own[RADIUS])
        turn, middle = np.arccos(size), np.arctan2(across, along)
    return wrap_angles(np.stack([middle - turn, middle + turn], axis=1))


def find_crossings_with_parallels(own: Array, rows: Array, keep: Array) -> Array:
    """Return parameters (P, 4) at which a segment meets both
    parallels, ``keep`` (P,) mm away, of straight kernel rows.

    NaN where the segment does not meet them, and where a row is an arc.
    """
    normal = np.stack([-rows[:, AXIS_Y], rows[:, AXIS_X]], axis=1)
    level = (normal * rows[:, [X, Y]]).sum(axis=1)
    straight = rows[:, IS_ARC] == 0.0
    return np.hstack(
        [
            intersect_with_lines(own, normal, np.where(straight, level + side * keep, np.nan))
            for side in (-1.0, 1.0)
        ]
    )


def intersect_with_lines(own: Array, normal: Array, level: Array) -> Array:
    """Return parameters (P, 2) at which a segment's line or circle
    meets lines normal · x = level, NaN where it does not.

    ``normal`` is (P, 2) of unit vectors, ``level`` (P,) in mm.
    """
    level = level - normal @ own[[X, Y]]
    along = normal @ own[[AXIS_X, AXIS_Y]]
    with np.errstate(invalid="ignore", divide="ignore"):
        if own[IS_ARC] == 0.0:
            place = level / along
            return np.stack([place, np.full(len(place), np.nan)], axis=1)
        turn = np.arccos(level / own[RADIUS])
    across = normal[:, 1] * own[AXIS_X] - normal[:, 0] * own[AXIS_Y]
    middle = np.arctan2(across, along)
    return wrap_angles(np.stack([middle - turn, middle + turn], axis=1))


def wrap_angles(angles: Array) -> Array:
    """Return angles in radians brought into [-pi, pi)."""
    return np.asarray((angles + np.pi) % (2 * np.pi) - np.pi)


def measure_distances(rows: Array, x: Array, y: Array) -> Array:
    """Return the distances (P, C) in mm from points x, y (P, C) to
    the segments of kernel rows (P, 10), row by row.

    See ``kernels.base.feature`` for the layout of rows.
    """
    dx, dy = x - rows[:, X, None], y - rows[:, Y, None]
    ax, ay, half = (rows[:, k, None] for k in (AXIS_X, AXIS_Y, HALF_EXTENT))
    along, across = dx * ax + dy * ay, ax * dy - ay * dx
    straight = np.hypot(np.maximum(np.abs(along) - half, 0.0), across)
    if not rows[:, IS_ARC].any():
        return np.asarray(straight)
    to_rim = np.abs(np.hypot(dx, dy) - rows[:, RADIUS, None])
    ends = [np.hypot(x - end[:, 0, None], y - end[:, 1, None]) for end in compute_ends(rows)]
    bent = np.where(np.abs(np.arctan2(across, along)) <= half, to_rim, np.minimum(*ends))
    return np.where(rows[:, IS_ARC, None] != 0.0, bent, straight)


def find_parts_inside_boxes(own: Array, boxes: Array) -> tuple[Array, IntArray]:
    """Return ranges (K, 2) of a segment's parameter inside filled
    boxes (B, 4), and the index (K,) of the box of each.
    """
    normals = np.tile(np.array([[1.0, 0.0], [0.0, 1.0]]), (2, 1))
    cuts = np.hstack(
        [
            intersect_with_lines(own, np.tile(normals[k], (len(boxes), 1)), boxes[:, k])
            for k in range(len(normals))
        ]
    )
    x0, y0, x1, y1 = (boxes[:, k, None] for k in range(4))
    return list_covered_parts_between_cuts(own, cuts, lambda x, y: (x0 < x) & (x < x1) & (y0 < y) & (y < y1))
