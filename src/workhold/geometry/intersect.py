"""Where the lines and circles that carry two segments meet."""

from __future__ import annotations

from math import cos, hypot, sin, sqrt

from workhold.geometry.segment import Arc, Line, Point, Segment

__all__ = ["carrier_intersections", "circle_circle", "common_points", "contains_parameter", "line_circle"]


def line_line(a: Line, b: Line) -> list[Point]:
    """Common point of two carrying lines; none when they are parallel to within 1e-12 rad."""
    (ax, ay), (atx, aty) = a.middle, a.tangent
    (bx, by), (btx, bty) = b.middle, b.tangent
    cross = atx * bty - aty * btx
    if abs(cross) < 1e-12:
        return []
    s = ((bx - ax) * bty - (by - ay) * btx) / cross
    return [(ax + s * atx, ay + s * aty)]


def line_circle(line: Line, center: Point, radius: float, tolerance: float = 1e-9) -> list[Point]:
    """Common points of a carrying line and a circle; a near touch within the tolerance (mm) gives its one point."""
    (px, py), (tx, ty) = line.middle, line.tangent
    dx, dy = center[0] - px, center[1] - py
    along = dx * tx + dy * ty
    across = abs(dx * ty - dy * tx)
    foot = (px + along * tx, py + along * ty)
    if across >= radius:
        return [foot] if across - radius <= tolerance else []
    half = sqrt((radius - across) * (radius + across))
    return [(foot[0] - half * tx, foot[1] - half * ty), (foot[0] + half * tx, foot[1] + half * ty)]


def circle_circle(
    center_a: Point, radius_a: float, center_b: Point, radius_b: float, tolerance: float = 1e-9
) -> list[Point]:
    """Common points of two circles; a near touch within the tolerance (mm) gives its one point, equal circles none."""
    dx, dy = center_b[0] - center_a[0], center_b[1] - center_a[1]
    distance = hypot(dx, dy)
    if distance <= tolerance:
        return []
    ux, uy = dx / distance, dy / distance
    along = (distance + (radius_a - radius_b) * (radius_a + radius_b) / distance) / 2
    square = (radius_a - along) * (radius_a + along)
    if square <= 0:
        gap = max(distance - radius_a - radius_b, abs(radius_a - radius_b) - distance)
        if gap > tolerance:
            return []
        along = radius_a if along > 0 else -radius_a
        return [(center_a[0] + along * ux, center_a[1] + along * uy)]
    half = sqrt(square)
    x, y = center_a[0] + along * ux, center_a[1] + along * uy
    return [(x - half * uy, y + half * ux), (x + half * uy, y - half * ux)]


def carrier_intersections(a: Segment, b: Segment) -> list[Point]:
    """Common points of the carrying lines or circles of two segments (none when they coincide)."""
    if isinstance(a, Line):
        return line_line(a, b) if isinstance(b, Line) else line_circle(a, b.center, b.radius)
    if isinstance(b, Line):
        return line_circle(b, a.center, a.radius)
    return circle_circle(a.center, a.radius, b.center, b.radius)


def contains_parameter(segment: Segment, parameter: float, tolerance: float) -> bool:
    """Whether a parameter lies on a segment, ends included, to within a tolerance in mm."""
    slack = tolerance if isinstance(segment, Line) else tolerance / segment.radius
    return abs(parameter) <= segment.half_extent + slack


def distance_to_segment(point: Point, segment: Segment) -> float:
    """Distance in mm from a point to a segment."""
    parameter = segment.parameter(point)
    parameter = min(max(parameter, -segment.half_extent), segment.half_extent)
    x, y = segment.at(parameter)
    nearest = hypot(point[0] - x, point[1] - y)
    if isinstance(segment, Arc) and abs(segment.parameter(point)) > segment.half_extent:
        x, y = segment.at(-parameter)
        nearest = min(nearest, hypot(point[0] - x, point[1] - y))
    return nearest


def common_points(a: Segment, b: Segment, tolerance: float) -> list[Point]:
    """Points at which two segments meet or touch to within a tolerance in mm.

    Overlapping segments (same line or circle) give the ends of each that lie on the other.
    """
    points = [
        p
        for p in carrier_intersections(a, b)
        if contains_parameter(a, a.parameter(p), tolerance) and contains_parameter(b, b.parameter(p), tolerance)
    ]
    points += [p for p in (a.start, a.end) if distance_to_segment(p, b) <= tolerance]
    points += [p for p in (b.start, b.end) if distance_to_segment(p, a) <= tolerance]
    if isinstance(a, Arc) and isinstance(b, Arc) and a.is_full and b.is_full:
        apart = hypot(a.center[0] - b.center[0], a.center[1] - b.center[1])
        if apart <= tolerance and abs(a.radius - b.radius) <= tolerance:
            points.append(a.start)
    return points


def bounding_box(segment: Segment) -> tuple[float, float, float, float]:
    """(smallest x, smallest y, largest x, largest y) of a segment in mm."""
    xs, ys = [segment.start[0], segment.end[0]], [segment.start[1], segment.end[1]]
    if isinstance(segment, Arc):
        for dx, dy in ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)):
            extreme = (segment.center[0] + segment.radius * dx, segment.center[1] + segment.radius * dy)
            toward = cos(segment.mid_angle) * dx + sin(segment.mid_angle) * dy
            if toward >= cos(segment.half_sweep):
                xs.append(extreme[0])
                ys.append(extreme[1])
    return min(xs), min(ys), max(xs), max(ys)
