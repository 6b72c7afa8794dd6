"""Trimmed offset of an outline: the straight and circular pieces of the boundary of (part + disc).

No general arrangement is needed. Every raw offset piece is cut where it meets another raw offset piece or a
circle of the offset radius around a joint. A cut piece belongs to the boundary exactly when its middle is no
nearer than the radius to the outline, because nearness can only change at such a cut. Quadratic in the number
of segments, exact up to rounding.

Glossary
--------
raw piece : a segment moved outward by the radius, before trimming.
joint circle : the circle around a joint on which a disc rolls around a corner.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from itertools import pairwise
from math import pi

import numpy as np
from numpy.typing import NDArray

from workhold.conventions import CLEARANCE, FILLED
from workhold.geometry.segment import (
    Arc,
    Line,
    Point,
    Segment,
    compute_bounding_box,
    find_carrier_crossings,
    make_segment_rows,
)
from workhold.kernels.base.distance import is_inside, measure_outline_distances

__all__ = [
    "find_clear_parts",
    "make_joint_circle",
    "keep_clear_parts",
    "offset_segment",
    "list_trimmed_offsets",
]


def offset_segment(segment: Segment, radius: float) -> Segment | None:
    """Return a segment moved outward by ``radius`` mm; None for a concave arc that vanishes."""
    if isinstance(segment, Line):
        nx, ny = segment.compute_normal()
        (x0, y0), (x1, y1) = segment.start, segment.end
        return Line((x0 + radius * nx, y0 + radius * ny), (x1 + radius * nx, y1 + radius * ny))
    if segment.radius + segment.sign * radius <= CLEARANCE:
        return None
    return segment.grow(segment.sign * radius)


def list_trimmed_offsets(
    segments: Sequence[Segment], radius: float, flat: float | None = None
) -> list[tuple[int, Segment]]:
    """Return the offsets of the part's segments, trimmed to the boundary of (part + disc of ``radius`` mm).

    Arcs around the part's corners are left out.

    Parameters
    ----------
    segments : the whole outline with its holes, material on the left.
    radius : in mm, zero or more.
    flat : offset in mm for straight segments instead of ``radius``, at most as large, for a peg whose flat
        lies against the segment; None for none.

    Returns
    -------
    list of (index of the segment, piece), in the order of the segments and of the parameter along each.
    """
    rows = make_segment_rows(segments)
    raw = [offset_segment(segment, radius) for segment in segments]
    joints = [s.start for s in segments if not (isinstance(s, Arc) and s.is_full)]
    circles = [make_joint_circle(joint, radius) for joint in joints]
    boxes = np.array([compute_bounding_box(segment) for segment in segments])
    joint_boxes = np.array([(*joint, *joint) for joint in joints]).reshape(-1, 4)
    pieces: list[tuple[int, Segment]] = []

    def is_clear(beside: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return for each point (M, 2) whether it is at least the radius from the segments with rows
        ``beside`` (M,).
        """
        return np.asarray(measure_outline_distances(points, beside) >= radius - CLEARANCE)

    # With a flat the disc reaches over the line, and behind an acute corner over segments on the other side
    # of the part.
    behind = [None if flat is None else offset_segment(segment, -radius) for segment in segments]
    for index, segment in enumerate(segments):
        piece, beside, sides = raw[index], rows, [raw]
        if flat is not None and isinstance(segment, Line):
            piece, beside, sides = offset_segment(segment, flat), np.delete(rows, index, 0), [raw, behind]
        # A hollow that the disc fills gives no piece, but still cuts its neighbours.
        if piece is None or (isinstance(piece, Arc) and piece.radius <= FILLED):
            continue
        # Only what comes within a diameter of the segment can touch the disc beside it.
        near = np.flatnonzero(measure_box_gaps(boxes, compute_bounding_box(piece)) <= 2 * radius + CLEARANCE)
        others = [r for side in sides for k in near if k != index and (r := side[k]) is not None]
        close = np.flatnonzero(
            measure_box_gaps(joint_boxes, compute_bounding_box(piece)) <= radius + CLEARANCE
        )
        others += [circles[k] for k in close]
        pieces += [(index, kept) for kept in keep_clear_parts(piece, others, partial(is_clear, beside))]
    return pieces


def find_clear_parts(piece: Segment, zone: Sequence[Segment], radius: float) -> list[Segment]:
    """Return the parts of a segment outside a zone and at least ``radius`` mm from it.

    ``zone`` is a closed loop with its inside on the left.
    """
    rows = make_segment_rows(zone)
    others = [raw for segment in zone if (raw := offset_segment(segment, radius)) is not None]
    others += [make_joint_circle(segment.start, radius) for segment in zone]

    def is_clear(middles: NDArray[np.float64]) -> NDArray[np.bool_]:
        outside = np.array([not is_inside(x, y, rows) for x, y in middles], np.bool_)
        return np.asarray(outside & (measure_outline_distances(middles, rows) >= radius - CLEARANCE))

    return keep_clear_parts(piece, others, is_clear)


def make_joint_circle(joint: Point, radius: float) -> Segment:
    """Return the full circle of ``radius`` mm around a joint."""
    return Arc(joint, radius, 0.0, pi, 1.0)


def keep_clear_parts(
    piece: Segment,
    others: Sequence[Segment],
    is_clear: Callable[[NDArray[np.float64]], NDArray[np.bool_]],
) -> list[Segment]:
    """Return the parts of a segment that are clear, in order along it.

    The segment is cut where it meets the line or the circle of any of ``others``. A part is kept if its
    middle is clear: ``is_clear`` takes points (M, 2) and returns booleans (M,).
    """
    half = piece.half_extent
    points = [point for other in others for point in find_carrier_crossings(piece, other)]
    inner = sorted(p for p in (piece.find_parameter(point) for point in points) if -half < p < half)
    cuts = [-half, *inner, half]
    scale = piece.radius if isinstance(piece, Arc) else 1.0
    spans: list[list[float]] = []
    clear = is_clear(np.array([piece.compute_point((a + b) / 2) for a, b in pairwise(cuts)]))
    for (a, b), keep in zip(pairwise(cuts), clear, strict=True):
        if keep and spans and spans[-1][1] == a:
            spans[-1][1] = b
        elif keep:
            spans.append([a, b])
    if spans == [[-half, half]]:
        return [piece]
    return [piece.cut_part(a, b) for a, b in spans if (b - a) * scale > CLEARANCE]


def measure_box_gaps(
    boxes: NDArray[np.float64], box: tuple[float, float, float, float]
) -> NDArray[np.float64]:
    """Return the gaps (N,) in mm between ``box`` and each of ``boxes`` (N, 4); negative where they overlap.

    A gap is the larger of those in x and in y. Boxes are smallest x and y, largest x and y.
    """
    x0, y0, x1, y1 = box
    gaps = np.stack([boxes[:, 0] - x1, x0 - boxes[:, 2], boxes[:, 1] - y1, y0 - boxes[:, 3]])
    return np.asarray(gaps.max(axis=0))
