"""The boundary of (part + disc of the peg radius): offset faces, arcs around convex corners, and pockets.

Reference: T. Lozano-Perez, "Spatial planning: a configuration space approach", IEEE Transactions on Computers
C-32 (1983).
"""

from __future__ import annotations

from math import atan2, pi

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.conventions import CLEARANCE, JOINT, TANGENT
from workhold.geometry.offset import cut_points, kept_parts, raw_offset, trimmed_offsets
from workhold.geometry.segment import Arc, Point, Segment, segment_rows
from workhold.kernels.base.distance import outline_distances
from workhold.kernels.base.feature import X, Y
from workhold.model.workpiece import Workpiece

__all__ = ["Touch", "pockets_of", "touched_pieces"]

Array = NDArray[np.float64]
# Corners that turn by less, in radians, are rounding.
STRAIGHT_ON = 1e-7


@frozen
class Touch:
    """A face or a corner.

    Parameters
    ----------
    face : number of the face, or of the face that begins at the corner.
    corner : whether it is the corner rather than the face.
    """

    face: int
    corner: bool


def touched_pieces(workpiece: Workpiece, radius: float) -> list[tuple[Touch, Segment]]:
    """The boundary for pegs of a radius in mm, and what they touch on each piece."""
    faces = workpiece.faces
    segments = [face.segment for face in faces]
    pieces = [(Touch(faces[k].number, False), piece) for k, piece in trimmed_offsets(segments, radius)]
    number = {segment.start: face.number for face, segment in zip(faces, segments, strict=True)}
    return pieces + [(Touch(number[corner], True), arc) for corner, arc in rolled_corners(segments, radius)]


def rolled_corners(segments: list[Segment], radius: float) -> list[tuple[Point, Arc]]:
    """The arcs on which a disc rolls around convex corners of an outline, where nothing else is nearer."""
    rows, out = segment_rows(segments), []
    raw = [piece for piece in (raw_offset(segment, radius) for segment in segments) if piece is not None]
    before = {segment.end: segment for segment in segments if not is_full(segment)}
    joints = [segment.start for segment in segments if not is_full(segment)]

    def is_clear(points: Array) -> NDArray[np.bool_]:
        return np.asarray(outline_distances(points, rows) >= radius - CLEARANCE)

    for segment in segments:
        if is_full(segment):
            continue
        previous = before.get(segment.start) or min(before.values(), key=lambda s: distance(s.end, segment.start))
        low, high = end_angle(previous, 1.0), end_angle(segment, -1.0)
        turn = (high - low + pi) % (2 * pi) - pi
        if turn <= STRAIGHT_ON:
            continue
        arc = Arc(segment.start, radius, low + turn / 2, turn / 2, 1.0)
        others = [joint for joint in joints if 0.0 < distance(joint, segment.start) <= 2 * radius + CLEARANCE]
        out += [(segment.start, kept) for kept in kept_parts(arc, cut_points(arc, raw, others, radius), is_clear)]
    return [(corner, arc) for corner, arc in out if isinstance(arc, Arc)]


def is_full(segment: Segment) -> bool:
    """Whether a segment is a whole circle."""
    return isinstance(segment, Arc) and segment.is_full


def distance(a: Point, b: Point) -> float:
    """Distance in mm of two points."""
    return float(np.hypot(a[0] - b[0], a[1] - b[1]))


def end_angle(segment: Segment, end: float) -> float:
    """Direction in radians of the outward normal at the end (1) or the start (-1) of a segment."""
    along = end * segment.half_extent * (segment.sign if isinstance(segment, Arc) else 1.0)
    x, y = segment.normal(along)
    return atan2(y, x)


def pockets_of(pieces: list[Segment], rows: Array) -> tuple[Array, NDArray[np.int64]]:
    """The pockets, in which two pieces end with different normals: places, normals and numbers of pieces."""
    ends = [(k, s) for k, piece in enumerate(pieces) if not is_full(piece) for s in (-1.0, 1.0)]
    if not ends:
        return np.zeros((0, 6)), np.zeros((0, 2), np.int64)
    points = np.array([pieces[k].at(s * pieces[k].half_extent) for k, s in ends])
    normals = np.array([pieces[k].normal(s * pieces[k].half_extent) for k, s in ends])
    shift = rows[0, [X, Y]] - np.array(
        pieces[0].center if isinstance(pieces[0], Arc) else pieces[0].middle  # the same point before centring
    )
    found, whose = [], []
    for i in range(len(ends)):
        for j in range(i + 1, len(ends)):
            if np.abs(points[i] - points[j]).max() > JOINT or ends[i][0] == ends[j][0]:
                continue
            if np.abs(normals[i] - normals[j]).max() <= TANGENT:
                continue
            place = (points[i] + points[j]) / 2 + shift
            found.append([*place, *normals[i], *normals[j]])
            whose.append([ends[i][0], ends[j][0]])
    return np.array(found).reshape(-1, 6), np.array(whose, dtype=np.int64).reshape(-1, 2)
