"""Segments from bulges: ends, sweep, radius, parameters and rows."""

from __future__ import annotations

from fractions import Fraction
from math import atan, cos, hypot, pi, sin, tan

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from workhold.geometry.segment import Arc, Line, bounding_box, segment_from_bulge, segment_rows

places = st.tuples(st.floats(-100, 100), st.floats(-100, 100)).map(lambda p: (round(p[0], 3), round(p[1], 3)))
bulges = st.one_of(st.floats(0.01, 20), st.floats(-20, -0.01))


@given(places, places, bulges)
def test_a_bulge_is_the_tangent_of_a_quarter_of_the_sweep(start, end, bulge):
    """The arc runs from start to end, turns by 4 atan(bulge) (counter-clockwise if positive), at constant radius."""
    assume(start != end)
    arc = segment_from_bulge(start, end, bulge)
    assert isinstance(arc, Arc)
    size = 1e-9 * (1 + arc.radius)
    assert arc.start == pytest.approx(start, abs=size) and arc.end == pytest.approx(end, abs=size)
    assert arc.sign * 2 * arc.half_sweep == pytest.approx(4 * atan(bulge))
    assert arc.length == pytest.approx(abs(4 * atan(bulge)) * arc.radius)
    # The middle of the arc lies |bulge| c / 2 from the chord, on the right for a counter-clockwise arc.
    dx, dy = end[0] - start[0], end[1] - start[1]
    middle = ((start[0] + end[0] + bulge * dy) / 2, (start[1] + end[1] - bulge * dx) / 2)
    assert arc.at(0.0) == pytest.approx(middle, abs=size)


@given(places, places, st.one_of(st.just(0.0), bulges), st.floats(-1, 1))
def test_parameter_is_the_inverse_of_at(start, end, bulge, part):
    """parameter(at(t)) = t for |t| <= half_extent, and moving along the normal keeps t."""
    assume(start != end)
    segment = segment_from_bulge(start, end, bulge)
    t = part * segment.half_extent * 0.999999
    scale = 1.0 if isinstance(segment, Line) else segment.radius
    assert segment.parameter(segment.at(t)) == pytest.approx(t, abs=1e-9 * (1 + 200 / scale))
    (x, y), (nx, ny) = segment.at(t), segment.normal(t)
    assert hypot(nx, ny) == pytest.approx(1.0)
    moved = (x + 0.3 * scale * nx, y + 0.3 * scale * ny)
    assert segment.parameter(moved) == pytest.approx(t, abs=1e-9 * (1 + 200 / scale))


@given(places, places, st.one_of(st.just(0.0), bulges))
def test_the_normal_points_to_the_right(start, end, bulge):
    """With material on the left, the outward normal is the running direction turned right by a quarter turn."""
    assume(start != end)
    segment = segment_from_bulge(start, end, bulge)
    step = 1e-6 * segment.half_extent
    forward = 1.0 if isinstance(segment, Line) else segment.sign
    (x0, y0), (x1, y1) = segment.at(-forward * step), segment.at(forward * step)
    nx, ny = segment.normal(0.0)
    length = hypot(x1 - x0, y1 - y0)
    assert (nx, ny) == pytest.approx(((y1 - y0) / length, -(x1 - x0) / length), abs=1e-6)


@given(places, places, st.one_of(st.just(0.0), bulges), st.floats(-1, 1), st.floats(-1, 1))
def test_a_part_is_the_segment_between_two_parameters(start, end, bulge, one, two):
    """part(low, high) runs over exactly the points at(low) ... at(high)."""
    assume(start != end and abs(one - two) > 1e-3)
    segment = segment_from_bulge(start, end, bulge)
    low, high = (t * segment.half_extent for t in sorted((one, two)))
    part = segment.part(low, high)
    near = 1e-9 * (200 + getattr(segment, "radius", 0.0))
    ends = (segment.at(low), segment.at(high))
    found = (
        (part.start, part.end) if not (isinstance(part, Arc) and part.sign < 0) else (part.end, part.start)
    )
    assert found[0] == pytest.approx(ends[0], abs=near) and found[1] == pytest.approx(ends[1], abs=near)
    assert part.length == pytest.approx((high - low) / (2 * segment.half_extent) * segment.length)


@given(places, places, st.one_of(st.just(0.0), bulges))
def test_the_bounding_box_is_the_range_of_the_points(start, end, bulge):
    """No point of the segment lies outside its box, and each side of the box is reached."""
    assume(start != end)
    segment = segment_from_bulge(start, end, bulge)
    points = [segment.at(segment.half_extent * k / 500) for k in range(-500, 501)]
    x0, y0, x1, y1 = bounding_box(segment)
    xs, ys = [p[0] for p in points], [p[1] for p in points]
    slack = 1e-4 * (1 + getattr(segment, "radius", 0.0))
    assert x0 <= min(xs) + 1e-9 * 200 and x1 >= max(xs) - 1e-9 * 200
    assert (x0, y0, x1, y1) == pytest.approx((min(xs), min(ys), max(xs), max(ys)), abs=slack)


def test_known_arcs():
    """Bulge 1 is a half circle, tan(pi / 8) a quarter, 1 + sqrt 2 three quarters; a tiny bulge is a line."""
    half = segment_from_bulge((0, 0), (2, 0), 1.0)
    assert (half.center, half.radius, half.half_sweep) == (pytest.approx((1, 0)), 1.0, pytest.approx(pi / 2))
    assert half.at(0.0) == pytest.approx((1, -1))
    quarter = segment_from_bulge((1, 0), (0, 1), tan(pi / 8))
    assert (quarter.center, quarter.radius) == (pytest.approx((0, 0)), pytest.approx(1.0))
    big = segment_from_bulge((1, 0), (0, -1), tan(3 * pi / 8))
    assert (big.center, big.radius, big.sign) == (pytest.approx((0, 0)), pytest.approx(1.0), 1.0)
    assert big.at(0.0) == pytest.approx((cos(3 * pi / 4), sin(3 * pi / 4)))
    assert segment_from_bulge((0, 0), (1, 0), 1e-13) == Line((0, 0), (1, 0))


def test_rows_hold_the_segments():
    """A row is kind, middle or centre, direction, largest parameter, radius, sign, rest; rows cannot be written to."""
    rows = segment_rows([Line((0, 0), (6, 8)), Arc((1, 2), 5.0, pi / 2, 0.7, -1.0)])
    assert rows[0] == pytest.approx([0, 3, 4, 0.6, 0.8, 5, 0, 1, 0, 0])
    assert rows[1] == pytest.approx([1, 1, 2, 0, 1, 0.7, 5, -1, 0, 0])
    with pytest.raises(ValueError, match="read-only"):
        rows[0, 0] = 1.0
    assert segment_rows([]).shape == (0, 10)


def off_circle(arc: Arc, point: tuple[float, float]) -> float:
    """How far in mm a point is from an arc's circle, from its very numbers: (d^2 - R^2) / 2R."""
    x, y = (
        Fraction(p) - Fraction(c) - Fraction(rest)
        for p, c, rest in zip(point, arc.center, arc.rest, strict=True)
    )
    radius = Fraction(arc.radius)
    return float((x * x + y * y - radius * radius) / (2 * radius))


@given(
    st.tuples(*[st.floats(-100, 100)] * 4).filter(lambda p: hypot(p[2] - p[0], p[3] - p[1]) > 1),
    st.floats(-5.6, -2.4),
    st.sampled_from([1, -1]),
    st.floats(-5, 5),
)
def test_a_shallow_arc_is_where_it_is_drawn(points, size, sign, by):
    """Its circle, which may be centred kilometres away, goes through its ends and its middle to the last digit or so, and
    so does that of the arc moved out, and of a part of it."""
    start, end, bulge = points[:2], points[2:], sign * 10**size
    arc = segment_from_bulge(start, end, bulge)
    dx, dy = end[0] - start[0], end[1] - start[1]
    middle = ((start[0] + end[0]) / 2 + bulge * dy / 2, (start[1] + end[1]) / 2 - bulge * dx / 2)
    assert arc.at(0.0) == pytest.approx(middle, abs=1e-13)
    assert (*arc.start, *arc.end) == pytest.approx(points, abs=3e-13)
    for point in (start, middle, end):
        assert abs(off_circle(arc, point)) < 3e-13
    grown = arc.grown(by).part(-0.3 * arc.half_sweep, 0.9 * arc.half_sweep)
    assert abs(off_circle(grown, grown.at(0.1 * arc.half_sweep))) < 3e-13
    assert grown.half_sweep == pytest.approx(0.6 * arc.half_sweep)
    for s in (-0.9, 0.0, 0.5):
        (x, y), (nx, ny) = arc.at(s * arc.half_sweep), arc.normal(s * arc.half_sweep)
        assert arc.parameter((x, y)) * arc.radius == pytest.approx(s * arc.half_sweep * arc.radius, abs=1e-11)
        outer = (x + arc.sign * by * nx, y + arc.sign * by * ny)
        assert abs(off_circle(grown, outer)) < 3e-13
