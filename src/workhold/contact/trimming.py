"""The places of pegs along contact features, less those at which a tool of a program comes too near.

Let R be the radius of a tool's cylinder. A peg of radius r on a feature is clear of a swept piece where its
centre keeps d = R + clearance + r from the piece's path. A shoulder below the part keeps its own radius from
what is swept there. So each piece covers an open part of a feature, and what is left is closed: what is
exactly d away may stay.

Nothing is lost and nothing is let in. Distance from a segment or an arc is continuous along a feature. It is
d only where the feature meets the parallels of the segment or the circles about the arc's centre, or those of
radius d about the path's ends. Cut there, a feature has parts on which the distance less d has one sign, that
of the part's middle. A covered part is the union of those of all pieces. Distance changes by no more than the
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

from workhold.contact.swept import Swept
from workhold.geometry.segment import Arc, Segment, bounding_box
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, RADIUS, X, Y

__all__ = ["find_covered_parts", "find_line_most_in_the_way", "trim_to_clear_parts"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

# mm. Shorter parts left of a feature are dropped: their places are within half of this of covered ones.
LEAST_PART = 1e-6


def trim_to_clear_parts(segment: Segment, swept: Swept, beyond: float) -> list[Segment]:
    """The parts of a segment on which a peg's centre is clear of what is swept.

    Parameters
    ----------
    beyond : clearance and radius of the peg together, in mm.
    """
    return left_of(segment, find_covered_parts(segment, swept, beyond)[0])


def left_of(segment: Segment, covered: Array) -> list[Segment]:
    """The parts of a segment outside covered ones, ranges (K, 2) of its parameter."""
    half = segment.half_extent
    if not len(covered):
        return [segment]
    least = LEAST_PART / (segment.radius if isinstance(segment, Arc) else 1.0)
    low, high = covered[np.argsort(covered[:, 0])].T
    ends = np.concatenate([[-half], np.maximum.accumulate(high)])
    begins = np.concatenate([low, [half]])
    return [segment.part(a, b) for a, b in zip(ends.tolist(), begins.tolist(), strict=True) if b - a > least]


def find_line_most_in_the_way(segments: Sequence[Segment], swept: Swept, beyond: float) -> int | None:
    """The line of the program that covers the longest parts of segments; None where none does.

    Parameters
    ----------
    beyond : clearance and radius of the peg together, in mm.
    """
    lengths: dict[int, float] = {}
    for segment in segments:
        covered, lines = find_covered_parts(segment, swept, beyond)
        scale = segment.radius if isinstance(segment, Arc) else 1.0
        for line in np.unique(lines).tolist():
            free = sum(2 * part.half_extent for part in left_of(segment, covered[lines == line]))
            lengths[line] = lengths.get(line, 0.0) + (2 * segment.half_extent - free) * scale
    return max(lengths, key=lambda line: (lengths[line], -line)) if lengths else None


def find_covered_parts(segment: Segment, swept: Swept, beyond: float) -> tuple[Array, IntArray]:
    """Ranges (K, 2) of a segment's parameter nearer to the paths of swept pieces than radius and some more.

    Parameters
    ----------
    beyond : what is kept besides a piece's radius, in mm.

    Returns
    -------
    ranges, which may overlap, and the lines (K,) of the program
    """
    x0, y0, x1, y1 = bounding_box(segment)
    keep, boxes = swept.tree.radius + beyond, swept.boxes
    gap = np.maximum.reduce([boxes[:, 0] - x1, x0 - boxes[:, 2], boxes[:, 1] - y1, y0 - boxes[:, 3]])
    near = np.flatnonzero((gap < keep) & (swept.line >= 0))
    own = np.array(segment.row())
    rows, keep = swept.tree.rows[near], keep[near]
    cuts = np.concatenate(
        [on_circles(own, rows, keep), find_crossings_with_parallels(own, rows, keep)], axis=1
    )
    ranges, piece = list_covered_parts_between_cuts(
        own, cuts, lambda x, y: distances(rows, x, y) < keep[:, None]
    )
    lines = swept.line[near][piece]
    if len(swept.filled):
        inside, box = find_parts_inside_boxes(own, swept.filled)
        ranges, lines = np.concatenate([ranges, inside]), np.concatenate([lines, swept.filled_line[box]])
    return ranges, lines


def list_covered_parts_between_cuts(
    own: Array, cuts: Array, is_covered: Callable[[Array, Array], NDArray[np.bool_]]
) -> tuple[Array, IntArray]:
    """Ranges (K, 2) between neighbouring cuts (P, C) of a segment's row whose middles are covered, and of
    which of P pieces (K,) each is.

    Parameters
    ----------
    is_covered : of points x, y (P, C + 1) whether they are.
    """
    half, count = own[HALF_EXTENT], len(cuts)
    inner = np.where(np.abs(cuts) < half, cuts, half)
    edges = np.sort(np.hstack([np.full((count, 1), -half), inner, np.full((count, 1), half)]), axis=1)
    middles = (edges[:, 1:] + edges[:, :-1]) / 2
    covered = is_covered(*points_on(own, middles)) & (edges[:, 1:] > edges[:, :-1])
    piece, number = np.nonzero(covered)
    return np.stack([edges[piece, number], edges[piece, number + 1]], axis=1), piece


def points_on(own: Array, parameter: Array) -> tuple[Array, Array]:
    """x and y of points of a segment's row."""
    if own[IS_ARC] == 0.0:
        return own[X] + parameter * own[AXIS_X], own[Y] + parameter * own[AXIS_Y]
    cosine, sine = np.cos(parameter), np.sin(parameter)
    return (
        own[X] + own[RADIUS] * (cosine * own[AXIS_X] - sine * own[AXIS_Y]),
        own[Y] + own[RADIUS] * (cosine * own[AXIS_Y] + sine * own[AXIS_X]),
    )


def ends_of(rows: Array) -> tuple[Array, Array]:
    """Both ends (P, 2) of rows."""
    is_arc, half = rows[:, IS_ARC] != 0.0, rows[:, HALF_EXTENT]
    axis, center = rows[:, [AXIS_X, AXIS_Y]], rows[:, [X, Y]]
    across = np.stack([-axis[:, 1], axis[:, 0]], axis=1)
    out = []
    for side in (-1.0, 1.0):
        bent = np.cos(half)[:, None] * axis + side * np.sin(half)[:, None] * across
        along = np.where(is_arc[:, None], rows[:, RADIUS, None] * bent, side * half[:, None] * axis)
        out.append(center + along)
    return out[0], out[1]


def on_circles(own: Array, rows: Array, keep: Array) -> Array:
    """Parameters (P, 8) at which a segment meets circles of rows, NaN for those that it does not meet.

    They are the circles of radii ``keep`` (P,) about both ends, and of arcs those about the centre.
    """
    one, other = ends_of(rows)
    around, is_arc = rows[:, [X, Y]], rows[:, IS_ARC] != 0.0
    outer = np.where(is_arc, rows[:, RADIUS] + keep, np.nan)
    inner = np.where(is_arc, np.abs(rows[:, RADIUS] - keep), np.nan)
    circles = ((one, keep), (other, keep), (around, outer), (around, inner))
    return np.hstack([on_circle(own, center, radius) for center, radius in circles])


def on_circle(own: Array, center: Array, radius: Array) -> Array:
    """Parameters (P, 2) at which a segment meets circles; NaN where it does not."""
    dx, dy = center[:, 0] - own[X], center[:, 1] - own[Y]
    along, across = dx * own[AXIS_X] + dy * own[AXIS_Y], own[AXIS_X] * dy - own[AXIS_Y] * dx
    with np.errstate(invalid="ignore", divide="ignore"):
        if own[IS_ARC] == 0.0:
            half = np.sqrt((radius - np.abs(across)) * (radius + np.abs(across)))
            return np.stack([along - half, along + half], axis=1)
        away = np.hypot(dx, dy)
        size = ((own[RADIUS] - radius) * (own[RADIUS] + radius) / away + away) / (2 * own[RADIUS])
        turn, middle = np.arccos(size), np.arctan2(across, along)
    return in_one_turn(np.stack([middle - turn, middle + turn], axis=1))


def find_crossings_with_parallels(own: Array, rows: Array, keep: Array) -> Array:
    """Parameters (P, 4) at which a segment meets the parallels, ``keep`` (P,) away, of straight rows."""
    normal = np.stack([-rows[:, AXIS_Y], rows[:, AXIS_X]], axis=1)
    level = (normal * rows[:, [X, Y]]).sum(axis=1)
    straight = rows[:, IS_ARC] == 0.0
    return np.hstack(
        [on_line(own, normal, np.where(straight, level + side * keep, np.nan)) for side in (-1.0, 1.0)]
    )


def on_line(own: Array, normal: Array, level: Array) -> Array:
    """Parameters (P, 2) at which a segment meets lines normal · x = level; NaN where it does not."""
    level = level - normal @ own[[X, Y]]
    along = normal @ own[[AXIS_X, AXIS_Y]]
    with np.errstate(invalid="ignore", divide="ignore"):
        if own[IS_ARC] == 0.0:
            place = level / along
            return np.stack([place, np.full(len(place), np.nan)], axis=1)
        turn = np.arccos(level / own[RADIUS])
    across = normal[:, 1] * own[AXIS_X] - normal[:, 0] * own[AXIS_Y]
    middle = np.arctan2(across, along)
    return in_one_turn(np.stack([middle - turn, middle + turn], axis=1))


def in_one_turn(angles: Array) -> Array:
    """Angles in radians brought to within half a turn of 0."""
    return np.asarray((angles + np.pi) % (2 * np.pi) - np.pi)


def distances(rows: Array, x: Array, y: Array) -> Array:
    """Distances (P, C) in mm from points (P, C) to the row of each line of them."""
    dx, dy = x - rows[:, X, None], y - rows[:, Y, None]
    ax, ay, half = (rows[:, k, None] for k in (AXIS_X, AXIS_Y, HALF_EXTENT))
    along, across = dx * ax + dy * ay, ax * dy - ay * dx
    straight = np.hypot(np.maximum(np.abs(along) - half, 0.0), across)
    if not rows[:, IS_ARC].any():
        return np.asarray(straight)
    to_rim = np.abs(np.hypot(dx, dy) - rows[:, RADIUS, None])
    ends = [np.hypot(x - end[:, 0, None], y - end[:, 1, None]) for end in ends_of(rows)]
    bent = np.where(np.abs(np.arctan2(across, along)) <= half, to_rim, np.minimum(*ends))
    return np.where(rows[:, IS_ARC, None] != 0.0, bent, straight)


def find_parts_inside_boxes(own: Array, boxes: Array) -> tuple[Array, IntArray]:
    """Ranges (K, 2) of a segment's parameter inside filled boxes (B, 4), and of which (K,) each is."""
    normals = np.tile(np.array([[1.0, 0.0], [0.0, 1.0]]), (2, 1))
    cuts = np.hstack(
        [on_line(own, np.tile(normals[k], (len(boxes), 1)), boxes[:, k]) for k in range(len(normals))]
    )
    x0, y0, x1, y1 = (boxes[:, k, None] for k in range(4))
    return list_covered_parts_between_cuts(own, cuts, lambda x, y: (x0 < x) & (x < x1) & (y0 < y) & (y < y1))
