"""Outlines on the page: segments written as SVG paths whose arcs are true arcs."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from math import ceil, pi

import numpy as np
from numpy.typing import NDArray

from workhold.drawing.scene import View, number
from workhold.fixels.contact_kind import CLAMP_TIP, FLAT_PIN, ROUND_PIN, WALL_END, ContactKind
from workhold.geometry.segment import Arc, Line, Point, Segment
from workhold.model.workpiece import Workpiece

__all__ = [
    "contact_of",
    "face_of",
    "outline_path",
    "sampled",
    "sampled_loop",
    "segment_path",
]

# An SVG arc is told by its ends and radius. Beyond this sweep its centre suffers from the rounding of the ends, so
# longer arcs are written in pieces.
LONGEST_SWEEP = 2 * pi / 3


def segment_path(segment: Segment, view: View, moved: bool = True) -> str:
    """SVG path data of one segment, beginning with a move to its start unless ``moved`` is False."""
    start = "M{} {}".format(*map(number, view(segment.start))) if moved else ""
    if isinstance(segment, Line):
        return start + "L{} {}".format(*map(number, view(segment.end)))
    pieces = ceil(2 * segment.half_sweep / LONGEST_SWEEP - 1e-9)
    radius = number(segment.radius * view.scale)
    sweep = "0" if segment.sign > 0 else "1"  # y is turned over, so counter-clockwise is SVG's negative direction
    for k in range(1, pieces + 1):
        parameter = segment.sign * segment.half_sweep * (2 * k / pieces - 1)
        x, y = map(number, view(segment.at(parameter)))
        start += f"A{radius} {radius} 0 0 {sweep} {x} {y}"
    return start


def outline_path(loops: Sequence[Sequence[Segment]], view: View) -> str:
    """SVG path data of closed loops; fill it by the even-odd rule."""
    return " ".join(
        "".join(segment_path(segment, view, k == 0) for k, segment in enumerate(loop)) + "Z" for loop in loops
    )


def sampled(segments: Iterable[Segment], view: View, step: float) -> NDArray[np.float64]:
    """(N, 2) page points along segments, about ``step`` page units apart, both ends included."""
    points: list[Point] = []
    for segment in segments:
        count = max(1, min(400, ceil(segment.length * view.scale / step)))
        half = segment.half_extent
        points += [view(segment.at(half * (2 * k / count - 1))) for k in range(count + 1)]
    return np.array(points, dtype=np.float64).reshape(-1, 2)


def sampled_loop(loop: Sequence[Segment], view: View, step: float) -> NDArray[np.float64]:
    """(N, 2) page points around a closed loop in running order, about ``step`` apart; the last is the first."""
    runs = []
    for segment in loop:
        points = sampled([segment], view, step)
        backwards = isinstance(segment, Arc) and segment.sign < 0
        runs.append(points[::-1] if backwards else points)
    return np.vstack(runs)


def face_of(workpiece: Workpiece, number: int) -> Segment:
    """The whole face that a segment number belongs to."""
    return next(face.segment for face in workpiece.faces if number in face.segments)


def contact_of(kind: ContactKind, center: Point, face: Segment) -> tuple[Point, Point]:
    """Where a contact of a kind, about a centre, touches a face, and the outward unit normal there, all in one frame, mm."""
    return CONTACTS[kind](center, face)


def wall_contact(center: Point, face: Segment) -> tuple[Point, Point]:
    """The contact of a part with a wall below it, where its end is."""
    return center, (0.0, -1.0)


def pin_contact(center: Point, face: Segment) -> tuple[Point, Point]:
    """The contact of a pin about a centre with a face."""
    half = face.half_extent
    parameter = max(-half, min(half, face.parameter(center)))
    return face.at(parameter), face.normal(parameter)


CONTACTS: Mapping[ContactKind, Callable[[Point, Segment], tuple[Point, Point]]] = {
    ROUND_PIN: pin_contact,
    FLAT_PIN: pin_contact,
    CLAMP_TIP: pin_contact,
    WALL_END: wall_contact,
}
