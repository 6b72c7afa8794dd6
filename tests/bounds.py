"""What a user bounds, asked of fixtures one by one: the slow definition of "at least", which a bound that is met meets.

Nothing is shared with the search but the outline: a peg slides along its face in small steps, and a zone is as far away as
its nearest point. ``within`` says by how much a bound may be missed, in mm or, of angles, in hundredths of degrees.
"""

from __future__ import annotations

from math import cos, hypot, inf, radians, sin

import numpy as np

from slow_fence import distances
from workhold import Result, Workpiece
from workhold.fixels.carrier import WALL
from workhold.geometry.segment import Arc, Line
from workhold.model.fixture import Fixture, Peg

__all__ = ["WITHIN", "avoids", "clear_of_box", "clear_of_circle", "keeps_margin", "lies_within"]

Box = tuple[float, float, float, float]
WITHIN = 1e-9
# mm. Roundings of a place in a fixture.
ROUNDING = 1e-11
# mm. What is no farther from a fence lies on it.
FLAT = 1e-7
STEPS = 30


def places_in_part(fixture: Fixture) -> list[tuple[Peg, tuple[float, float]]]:
    """The pegs and tips of a fixture, with their centres in the part's frame."""
    angle = radians(fixture.pose.theta_deg)
    c, s = cos(angle), sin(angle)
    moved = [(p, p.x - fixture.pose.x, p.y - fixture.pose.y) for p in fixture.pegs if p.carrier != WALL]
    return [(peg, (c * x + s * y, c * y - s * x)) for peg, x, y in moved]


def radius_of(peg: Peg, result: Result) -> float:
    """Of a peg, or of a clamp's tip."""
    toolkit = result.toolkit
    return float(toolkit.clamp_radius if peg.carrier.startswith("clamp") else toolkit.peg_radius)  # type: ignore[attr-defined]


def keeps_margin(fixture: Fixture, result: Result, margin: float, within: float = WITHIN) -> bool:
    """Whether each peg can slide by a margin to both sides, on its face and clear of all others."""
    reach = margin - within
    return all(
        slides(result.workpiece, peg.face, center, radius_of(peg, result), reach)
        for peg, center in places_in_part(fixture)
    )


def slides(part: Workpiece, face: int, center: tuple[float, float], radius: float, reach: float) -> bool:
    """Whether a peg can slide so far to both sides, on its face and clear of all others."""
    segments = {one.number: one.segment for one in part.faces}
    segment = segments[face]
    place, unit = segment.find_parameter(center), 1.0
    if isinstance(segment, Arc):
        unit = segment.radius + segment.sign * radius
    whole = isinstance(segment, Arc) and segment.is_full
    if not whole and (segment.half_extent - abs(place)) * unit < reach - ROUNDING:
        return False
    points = []
    for step in (place + np.linspace(-reach, reach, 2 * STEPS + 1) / unit).tolist():
        (x, y), (nx, ny) = segment.compute_point(step), segment.compute_normal(step)
        points.append((x + radius * nx, y + radius * ny))
    others = [
        distances(np.array(points), other).min() for number, other in segments.items() if number != face
    ]
    return bool(min(others, default=inf) >= radius - ROUNDING)


def clear_of_box(fixture: Fixture, result: Result, box: Box, within: float = WITHIN) -> bool:
    """Whether no body, and no fence, stands over a box from (x0, y0) to (x1, y1)."""
    x0, y0, x1, y1 = box
    heights = [fixture.pose.apply(x, y)[1] for x in (x0, x1) for y in (y0, y1)]
    if any(peg.carrier == WALL for peg in fixture.pegs) and min(heights) < -within:
        return False
    return all(
        hypot(max(x0 - x, 0.0, x - x1), max(y0 - y, 0.0, y - y1))
        >= radius_of(peg, result) - within - ROUNDING
        for peg, (x, y) in places_in_part(fixture)
    )


def clear_of_circle(
    fixture: Fixture, result: Result, circle: tuple[float, float, float], within: float = WITHIN
) -> bool:
    """Whether no body, and no fence, stands over a circle."""
    cx, cy, size = circle
    if any(peg.carrier == WALL for peg in fixture.pegs) and fixture.pose.apply(cx, cy)[1] - size < -within:
        return False
    return all(
        hypot(x - cx, y - cy) - size >= radius_of(peg, result) - within - ROUNDING
        for peg, (x, y) in places_in_part(fixture)
    )


def avoids(fixture: Fixture, result: Result, faces: tuple[int, ...], within: float = WITHIN) -> bool:
    """Whether each peg touches a face that is none of some, be it at a joint with one of them, and so does a fence."""
    left = [face.segment for face in result.workpiece.faces if face.number not in faces]
    return fence_avoids(fixture, result, faces) and all(
        min(distances(np.array([center]), face)[0] for face in left) <= radius_of(peg, result) + within
        for peg, center in places_in_part(fixture)
    )


def fence_avoids(fixture: Fixture, result: Result, faces: tuple[int, ...]) -> bool:
    """Whether a fence, if there is one, touches a face that is none of some at both ends of its contact.

    Where a face lies along the fence it is that face that is touched, not the other one of its corner.
    """
    segments = {face.number: face.segment for face in result.workpiece.faces}
    lying = {
        number
        for number, one in segments.items()
        if isinstance(one, Line) and all(abs(fixture.pose.apply(*p)[1]) < FLAT for p in (one.start, one.end))
    }
    for end in (peg for peg in fixture.pegs if peg.carrier == WALL):
        point = np.array([fixture.pose.inverse.apply(end.x, 0.0)])
        touched = {number for number, one in segments.items() if distances(point, one)[0] < FLAT}
        if (touched & lying or touched) <= set(faces):
            return False
    return True


def lies_within(fixture: Fixture, angles: tuple[float, float], within: float = WITHIN) -> bool:
    """Whether the part lies at an angle in a range, or does so after the half turn that swaps the jaws."""
    turns, hair = (0.0, 180.0) if fixture.type == "I" else (0.0,), 100.0 * within
    low, high = angles
    return any(
        (fixture.pose.theta_deg + turn - low + hair) % 360.0 <= high - low + 2 * hair for turn in turns
    )
