"""Line and arc segments of a generalized polygon, with material on their left, and where they meet.

Glossary
--------
parameter : position along a segment measured from its middle; millimetres on a line, radians on an arc.
normal : unit vector pointing away from the material (to the right of a line's direction, away from the centre
    of a convex arc, towards the centre of a concave one).
convex arc : an arc run through counter-clockwise, so that the material is on the centre's side; its ``sign``
    is +1.
row : the ten numbers that describe a segment to the compiled kernels, see :func:`make_segment_rows`.
carrier : the endless line or whole circle that a segment is a part of.
box : a rectangle with sides along the axes.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from math import atan, atan2, cos, dist, hypot, pi, sin, sqrt

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from workhold.conventions import PARALLEL, STRAIGHT
from workhold.kernels.base.feature import (
    AXIS_X,
    AXIS_Y,
    HALF_EXTENT,
    IS_ARC,
    RADIUS,
    SEGMENT_LENGTH,
    SHALLOW,
    X,
    Y,
)

__all__ = [
    "Arc",
    "Box",
    "Line",
    "Point",
    "Segment",
    "find_carrier_crossings",
    "cross_carrying_circles",
    "find_common_points",
    "holds",
    "make_segment_from_bulge",
    "find_row_ends",
    "make_segment_rows",
]

Point = tuple[float, float]
# mm. A line and a circle, or two circles, that miss each other by at most this have one common point.
TOUCH = 1e-9


@frozen
class Line:
    """A straight segment.

    Parameters
    ----------
    start, end : (x, y) in mm; they differ.
    """

    start: Point
    end: Point

    @property
    def length(self) -> float:
        """Length in mm."""
        return dist(self.start, self.end)

    @property
    def half_extent(self) -> float:
        """Largest parameter: half the length, in mm."""
        return self.length / 2

    @property
    def middle(self) -> Point:
        """The middle of the segment, which has parameter 0."""
        return ((self.start[0] + self.end[0]) / 2, (self.start[1] + self.end[1]) / 2)

    @property
    def tangent(self) -> Point:
        """Unit vector from start to end."""
        length = self.length
        return ((self.end[0] - self.start[0]) / length, (self.end[1] - self.start[1]) / length)

    def compute_point(self, parameter: float) -> Point:
        """Return the point at a parameter: mm from the middle, positive towards the end."""
        (x, y), (tx, ty) = self.middle, self.tangent
        return (x + parameter * tx, y + parameter * ty)

    def compute_normal(self, parameter: float = 0.0) -> Point:
        """Return the outward unit normal, the same at every parameter."""
        tx, ty = self.tangent
        return (ty, -tx)

    def find_parameter(self, point: Point) -> float:
        """Return the parameter in mm of the foot of a point on the infinite line."""
        (x, y), (tx, ty) = self.middle, self.tangent
        return (point[0] - x) * tx + (point[1] - y) * ty

    def to_row(self) -> tuple[float, ...]:
        """Return the row of ten numbers for the kernels, see :func:`make_segment_rows`."""
        return (0.0, *self.middle, *self.tangent, self.half_extent, 0.0, 1.0, 0.0, 0.0)

    def cut_part(self, low: float, high: float) -> Line:
        """Return the part from parameter ``low`` to ``high``, in mm from the middle."""
        return Line(self.compute_point(low), self.compute_point(high))


@frozen
class Arc:
    """A circular arc, or a full circle.

    Parameters
    ----------
    center : (x, y) in mm.
    radius : in mm, positive.
    mid_angle : direction from the centre to the arc's middle, in radians.
    half_sweep : half the angle covered, in radians, in (0, pi]; pi is a full circle.
    sign : +1 for a convex arc (run counter-clockwise), -1 for a concave one (run clockwise).
    rest : rounding error of the centre, (x, y) in mm, to be added to it. It is kept for shallow arcs
        (``kernels.base.feature``), whose centre is too far away for its rounding to be negligible.
    """

    center: Point
    radius: float
    mid_angle: float
    half_sweep: float
    sign: float
    rest: Point = (0.0, 0.0)

    @property
    def length(self) -> float:
        """Length in mm."""
        return 2 * self.half_sweep * self.radius

    @property
    def half_extent(self) -> float:
        """Largest parameter: half the sweep, in radians."""
        return self.half_sweep

    @property
    def middle(self) -> Point:
        """The middle of the arc, which has parameter 0; computed in fractions and rounded once."""
        x, y = to_middle(self.radius, self.mid_angle)
        (cx, cy), (rest_x, rest_y) = self.center, self.rest
        return (float(Fraction(cx) + Fraction(rest_x) + x), float(Fraction(cy) + Fraction(rest_y) + y))

    @property
    def is_full(self) -> bool:
        """Whether the arc is a full circle."""
        return self.half_sweep >= pi

    @property
    def start(self) -> Point:
        """First point in running order."""
        return self.compute_point(-self.sign * self.half_sweep)

    @property
    def end(self) -> Point:
        """Last point in running order."""
        return self.compute_point(self.sign * self.half_sweep)

    def compute_point(self, parameter: float) -> Point:
        """Return the point at a parameter: the angle in radians from the arc's middle, counter-clockwise
        whatever the sign.
        """
        if self.half_sweep < SHALLOW:
            (x, y), (tx, ty) = self.middle, (cos(self.mid_angle), sin(self.mid_angle))
            beside, back = self.radius * sin(parameter), 2 * self.radius * sin(parameter / 2) ** 2
            return (x - beside * ty - back * tx, y + beside * tx - back * ty)
        angle = self.mid_angle + parameter
        return (self.center[0] + self.radius * cos(angle), self.center[1] + self.radius * sin(angle))

    def compute_normal(self, parameter: float = 0.0) -> Point:
        """Return the outward unit normal at a parameter in radians."""
        angle = self.mid_angle + parameter
        return (self.sign * cos(angle), self.sign * sin(angle))

    def find_parameter(self, point: Point) -> float:
        """Return the parameter in radians, in (-pi, pi], of that point of the whole circle that is nearest to
        ``point``.
        """
        (x, y), radius = (self.middle, self.radius) if self.half_sweep < SHALLOW else (self.center, 0.0)
        dx, dy = point[0] - x, point[1] - y
        mx, my = cos(self.mid_angle), sin(self.mid_angle)
        return atan2(mx * dy - my * dx, radius + mx * dx + my * dy)

    def to_row(self) -> tuple[float, ...]:
        """Return the row of ten numbers for the kernels, see :func:`make_segment_rows`."""
        direction = (cos(self.mid_angle), sin(self.mid_angle))
        return (1.0, *self.center, *direction, self.half_sweep, self.radius, self.sign, *self.rest)

    def cut_part(self, low: float, high: float) -> Arc:
        """Return the part from parameter ``low`` to ``high``, in radians from the arc's middle,
        counter-clockwise.
        """
        return evolve(self, mid_angle=self.mid_angle + (low + high) / 2, half_sweep=(high - low) / 2)

    def grow(self, by: float) -> Arc:
        """Return the arc with its radius larger by ``by`` mm; ``by`` may be negative, but the radius must
        stay above 0.
        """
        radius = self.radius + by
        if self.half_sweep >= SHALLOW:
            return evolve(self, radius=radius)
        lost = float(Fraction(self.radius) + Fraction(by) - Fraction(radius))
        rest = (self.rest[0] + lost * cos(self.mid_angle), self.rest[1] + lost * sin(self.mid_angle))
        return evolve(self, radius=radius, rest=rest)


Segment = Line | Arc


def to_middle(radius: float, mid_angle: float) -> tuple[Fraction, Fraction]:
    """Return the vector in mm from an arc's centre to its middle as fractions, exact up to about the square
    of rounding.

    ``mid_angle`` is the vector's direction in radians. Its cosine and sine are rounded, so the vector is
    normalized again.
    """
    x, y = Fraction(cos(mid_angle)), Fraction(sin(mid_angle))
    scale = Fraction(radius) * (3 - x * x - y * y) / 2
    return scale * x, scale * y


def make_segment_from_bulge(start: Point, end: Point, bulge: float) -> Segment:
    """Return the segment from ``start`` to ``end`` with a DXF bulge, tan(sweep / 4), 0 for a line.

    The points must differ; a bulge below ``STRAIGHT`` makes a line. Formula: chord c, sweep 4 atan(bulge),
    radius c / (2 sin(sweep / 2)) (AutoCAD DXF reference, LWPOLYLINE group 42).
    """
    if abs(bulge) < STRAIGHT:
        return Line(start, end)
    half_sweep = 2 * atan(abs(bulge))
    sign = 1.0 if bulge > 0 else -1.0
    dx, dy = end[0] - start[0], end[1] - start[1]
    chord = hypot(dx, dy)
    radius = chord / (2 * sin(half_sweep))
    # The arc's middle is bulge * chord / 2 to the right of the chord, its centre a radius left of that.
    nx, ny = dy / chord, -dx / chord
    to_center = sign * radius * cos(half_sweep)
    center = ((start[0] + end[0]) / 2 - nx * to_center, (start[1] + end[1]) / 2 - ny * to_center)
    mid_angle = atan2(sign * ny, sign * nx)
    if half_sweep >= SHALLOW:
        return Arc(center, radius, mid_angle, half_sweep, sign)
    x, y = to_middle(radius, mid_angle)
    exact_x = Fraction((start[0] + end[0]) / 2 + bulge * dy / 2) - x
    exact_y = Fraction((start[1] + end[1]) / 2 - bulge * dx / 2) - y
    center = (float(exact_x), float(exact_y))
    rest = (float(exact_x - Fraction(center[0])), float(exact_y - Fraction(center[1])))
    return Arc(center, radius, mid_angle, half_sweep, sign, rest)


def make_segment_rows(segments: Sequence[Segment]) -> NDArray[np.float64]:
    """Return rows (N, 10) of segments for the kernels, read-only, columns as in ``kernels.base.feature``."""
    rows = np.array([segment.to_row() for segment in segments], dtype=np.float64).reshape(-1, SEGMENT_LENGTH)
    rows.setflags(write=False)
    return rows


def find_row_ends(rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the end points (N, 2, 2) in mm of N segments: first at the least parameter, then at the largest.

    ``rows`` (N, 10 or more) are those of :func:`make_segment_rows`.
    """
    half, axis = rows[:, HALF_EXTENT, None] * np.array([-1.0, 1.0]), rows[:, None, AXIS_X : AXIS_Y + 1]
    cosine, sine = np.cos(half), np.sin(half)
    turned = (cosine * axis[..., 0] - sine * axis[..., 1], sine * axis[..., 0] + cosine * axis[..., 1])
    on_arc = np.stack(turned, axis=-1) * rows[:, None, None, RADIUS]
    is_arc = rows[:, IS_ARC, None, None] != 0.0
    return np.asarray(rows[:, None, X : Y + 1] + np.where(is_arc, on_arc, axis * half[..., None]))


def cross_carrying_lines(a: Line, b: Line) -> list[Point]:
    """Return the common point of the infinite lines through two segments; an empty list where they are
    parallel (1e-12 rad).
    """
    (ax, ay), (atx, aty) = a.middle, a.tangent
    (bx, by), (btx, bty) = b.middle, b.tangent
    cross = atx * bty - aty * btx
    if abs(cross) < 1e-12:
        return []
    s = ((bx - ax) * bty - (by - ay) * btx) / cross
    return [(ax + s * atx, ay + s * aty)]


def cross_carrying_line_and_circle(line: Line, center: Point, radius: float) -> list[Point]:
    """Return the common points of the infinite line through a segment and a circle: none, one or two.

    There is one point where they touch, or miss each other by at most ``TOUCH`` mm.
    """
    (px, py), (tx, ty) = line.middle, line.tangent
    dx, dy = center[0] - px, center[1] - py
    along = dx * tx + dy * ty
    across = abs(dx * ty - dy * tx)
    foot = (px + along * tx, py + along * ty)
    if across >= radius:
        return [foot] if across - radius <= TOUCH else []
    half = sqrt((radius - across) * (radius + across))
    return [(foot[0] - half * tx, foot[1] - half * ty), (foot[0] + half * tx, foot[1] + half * ty)]


def cross_carrying_circles(center_a: Point, radius_a: float, center_b: Point, radius_b: float) -> list[Point]:
    """Return the common points of two circles: none, one or two.

    There is one point where they touch, or miss each other by at most ``TOUCH`` mm. Concentric circles have
    none.
    """
    dx, dy = center_b[0] - center_a[0], center_b[1] - center_a[1]
    distance = hypot(dx, dy)
    if distance <= TOUCH:
        return []
    ux, uy = dx / distance, dy / distance
    along = (distance + (radius_a - radius_b) * (radius_a + radius_b) / distance) / 2
    square = (radius_a - along) * (radius_a + along)
    if square <= 0:
        gap = max(distance - radius_a - radius_b, abs(radius_a - radius_b) - distance)
        if gap > TOUCH:
            return []
        along = radius_a if along > 0 else -radius_a
        return [(center_a[0] + along * ux, center_a[1] + along * uy)]
    half = sqrt(square)
    x, y = center_a[0] + along * ux, center_a[1] + along * uy
    return [(x - half * uy, y + half * ux), (x + half * uy, y - half * ux)]


def find_carrier_crossings(a: Segment, b: Segment) -> list[Point]:
    """Return the common points of the whole lines or circles on which two segments lie.

    The list is empty where both lie on the same line or circle.
    """
    if isinstance(a, Line):
        return (
            cross_carrying_lines(a, b)
            if isinstance(b, Line)
            else cross_carrying_line_and_circle(a, b.center, b.radius)
        )
    if isinstance(b, Line):
        return cross_carrying_line_and_circle(b, a.center, a.radius)
    return cross_carrying_circles(a.center, a.radius, b.center, b.radius)


def holds(segment: Segment, point: Point, tolerance: float) -> bool:
    """Return whether a point that is on a segment's whole line or circle lies on the segment itself.

    Both ends count, with a tolerance in mm.
    """
    slack = tolerance if isinstance(segment, Line) else tolerance / segment.radius
    return abs(segment.find_parameter(point)) <= segment.half_extent + slack


def measure_distance_to_segment(point: Point, segment: Segment) -> float:
    """Return the distance in mm from a point to a segment."""
    parameter, half = segment.find_parameter(point), segment.half_extent
    if abs(parameter) <= half:
        return dist(point, segment.compute_point(parameter))
    return min(dist(point, segment.compute_point(end)) for end in (-half, half))


def find_common_points(a: Segment, b: Segment, tolerance: float) -> list[Point]:
    """Return the points at which two segments meet or touch within a tolerance in mm.

    They are in no particular order, and some may be repeated. Segments that overlap on one line or circle
    give those ends of each that lie on the other.
    """
    points = [p for p in find_carrier_crossings(a, b) if holds(a, p, tolerance) and holds(b, p, tolerance)]
    points += [p for p in (a.start, a.end) if measure_distance_to_segment(p, b) <= tolerance]
    points += [p for p in (b.start, b.end) if measure_distance_to_segment(p, a) <= tolerance]
    if isinstance(a, Arc) and isinstance(b, Arc) and a.is_full and b.is_full:
        same = dist(a.center, b.center) <= tolerance and abs(a.radius - b.radius) <= tolerance
        points += [a.start] if same else []
    return points


def compute_bounding_box(segment: Segment) -> tuple[float, float, float, float]:
    """Return (smallest x, smallest y, largest x, largest y) of a segment in mm."""
    xs, ys = [segment.start[0], segment.end[0]], [segment.start[1], segment.end[1]]
    if isinstance(segment, Arc):
        for dx, dy in ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)):
            if cos(segment.mid_angle) * dx + sin(segment.mid_angle) * dy >= cos(segment.half_sweep):
                xs.append(segment.center[0] + segment.radius * dx)
                ys.append(segment.center[1] + segment.radius * dy)
    return min(xs), min(ys), max(xs), max(ys)


def are_parallel_lines(segments: Iterable[Segment]) -> bool:
    """Return whether all segments are lines that are parallel or antiparallel; False where there are none."""
    found = list(segments)
    if not found or not all(isinstance(one, Line) for one in found):
        return False
    (x, y), *rest = (one.compute_normal() for one in found)
    return all(abs(x * v - y * u) <= PARALLEL for u, v in rest)


def compute_box_around(segments: Iterable[Segment]) -> tuple[float, float, float, float]:
    """Return (smallest x, smallest y, largest x, largest y) in mm of one or more segments."""
    x0, y0, x1, y1 = zip(*map(compute_bounding_box, segments), strict=True)
    return min(x0), min(y0), max(x1), max(y1)


@frozen
class Box:
    """A rectangle with sides along the axes, from (x0, y0) to (x1, y1)."""

    x0: float
    y0: float
    x1: float
    y1: float

    @classmethod
    def from_center(cls, center: Point, width: float, height: float) -> Box:
        """Return the box with a centre, width and height."""
        x, y = center
        return cls(x - width / 2, y - height / 2, x + width / 2, y + height / 2)

    @property
    def width(self) -> float:
        return self.x1 - self.x0

    @property
    def height(self) -> float:
        return self.y1 - self.y0

    @property
    def center(self) -> Point:
        return (self.x0 + self.x1) / 2, (self.y0 + self.y1) / 2

    @property
    def corners(self) -> list[Point]:
        """Corners, counter-clockwise from the lower left."""
        return [(self.x0, self.y0), (self.x1, self.y0), (self.x1, self.y1), (self.x0, self.y1)]

    def grow(self, margin: float) -> Box:
        """Return the box enlarged by a margin on every side."""
        return Box(self.x0 - margin, self.y0 - margin, self.x1 + margin, self.y1 + margin)

    def unite(self, other: Box) -> Box:
        """Return the smallest box that contains this box and ``other``."""
        return Box(
            min(self.x0, other.x0), min(self.y0, other.y0), max(self.x1, other.x1), max(self.y1, other.y1)
        )

    def compute_overlap_area(self, other: Box) -> float:
        """Return the area common to both boxes; 0 where they do not overlap."""
        width = min(self.x1, other.x1) - max(self.x0, other.x0)
        height = min(self.y1, other.y1) - max(self.y0, other.y0)
        return max(width, 0.0) * max(height, 0.0)

    def contains(self, other: Box) -> bool:
        """Return whether the box ``other`` lies in this box; borders may coincide."""
        return self.x0 <= other.x0 and self.y0 <= other.y0 and self.x1 >= other.x1 and self.y1 >= other.y1
