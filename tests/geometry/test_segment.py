"""Segments from bulges: ends, sweep, radius, parameters and rows."""

from __future__ import annotations

from fractions import Fraction
from math import atan, cos, hypot, pi, sin, tan, tau
from random import Random

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from strategies import outlines, seeds
from workhold import Workpiece
from workhold.geometry.segment import (
    Arc,
    Line,
    compute_bounding_box,
    cross_carrying_circles,
    find_common_points,
    holds,
    make_segment_from_bulge,
    make_segment_rows,
)

places = st.tuples(st.floats(-100, 100), st.floats(-100, 100)).map(lambda p: (round(p[0], 3), round(p[1], 3)))
bulges = st.one_of(st.floats(0.01, 20), st.floats(-20, -0.01))


@pytest.mark.thorough
@given(places, places, bulges)
def test_a_bulge_is_the_tangent_of_a_quarter_of_the_sweep(start, end, bulge):
    """The arc runs from start to end, turns by 4 atan(bulge) (counter-clockwise if positive), at constant radius."""
    assume(start != end)
    arc = make_segment_from_bulge(start, end, bulge)
    assert isinstance(arc, Arc)
    size = 1e-9 * (1 + arc.radius)
    assert arc.start == pytest.approx(start, abs=size) and arc.end == pytest.approx(end, abs=size)
    assert arc.sign * 2 * arc.half_sweep == pytest.approx(4 * atan(bulge))
    assert arc.length == pytest.approx(abs(4 * atan(bulge)) * arc.radius)
    # The middle of the arc lies |bulge| c / 2 from the chord, on the right for a counter-clockwise arc.
    dx, dy = end[0] - start[0], end[1] - start[1]
    middle = ((start[0] + end[0] + bulge * dy) / 2, (start[1] + end[1] - bulge * dx) / 2)
    assert arc.compute_point(0.0) == pytest.approx(middle, abs=size)


@pytest.mark.thorough
@given(places, places, st.one_of(st.just(0.0), bulges), st.floats(-1, 1))
def test_parameter_is_the_inverse_of_at(start, end, bulge, part):
    """parameter(at(t)) = t for |t| <= half_extent, and moving along the normal keeps t."""
    assume(start != end)
    segment = make_segment_from_bulge(start, end, bulge)
    t = part * segment.half_extent * 0.999999
    scale = 1.0 if isinstance(segment, Line) else segment.radius
    assert segment.find_parameter(segment.compute_point(t)) == pytest.approx(t, abs=1e-9 * (1 + 200 / scale))
    (x, y), (nx, ny) = segment.compute_point(t), segment.compute_normal(t)
    assert hypot(nx, ny) == pytest.approx(1.0)
    moved = (x + 0.3 * scale * nx, y + 0.3 * scale * ny)
    assert segment.find_parameter(moved) == pytest.approx(t, abs=1e-9 * (1 + 200 / scale))


@given(places, places, st.one_of(st.just(0.0), bulges))
def test_the_normal_points_to_the_right(start, end, bulge):
    """With material on the left, the outward normal is the running direction turned right by a quarter turn."""
    assume(start != end)
    segment = make_segment_from_bulge(start, end, bulge)
    step = 1e-6 * segment.half_extent
    forward = 1.0 if isinstance(segment, Line) else segment.sign
    (x0, y0), (x1, y1) = segment.compute_point(-forward * step), segment.compute_point(forward * step)
    nx, ny = segment.compute_normal(0.0)
    length = hypot(x1 - x0, y1 - y0)
    assert (nx, ny) == pytest.approx(((y1 - y0) / length, -(x1 - x0) / length), abs=1e-6)


@pytest.mark.thorough
@given(places, places, st.one_of(st.just(0.0), bulges), st.floats(-1, 1), st.floats(-1, 1))
def test_a_part_is_the_segment_between_two_parameters(start, end, bulge, one, two):
    """part(low, high) runs over exactly the points at(low) ... at(high)."""
    assume(start != end and abs(one - two) > 1e-3)
    segment = make_segment_from_bulge(start, end, bulge)
    low, high = (t * segment.half_extent for t in sorted((one, two)))
    part = segment.cut_part(low, high)
    near = 1e-9 * (200 + getattr(segment, "radius", 0.0))
    ends = (segment.compute_point(low), segment.compute_point(high))
    found = (
        (part.start, part.end) if not (isinstance(part, Arc) and part.sign < 0) else (part.end, part.start)
    )
    assert found[0] == pytest.approx(ends[0], abs=near) and found[1] == pytest.approx(ends[1], abs=near)
    assert part.length == pytest.approx((high - low) / (2 * segment.half_extent) * segment.length)


@pytest.mark.thorough
@given(places, places, st.one_of(st.just(0.0), bulges))
def test_the_bounding_box_is_the_range_of_the_points(start, end, bulge):
    """No point of the segment lies outside its box, and each side of the box is reached."""
    assume(start != end)
    segment = make_segment_from_bulge(start, end, bulge)
    points = [segment.compute_point(segment.half_extent * k / 500) for k in range(-500, 501)]
    x0, y0, x1, y1 = compute_bounding_box(segment)
    xs, ys = [p[0] for p in points], [p[1] for p in points]
    slack = 1e-4 * (1 + getattr(segment, "radius", 0.0))
    assert x0 <= min(xs) + 1e-9 * 200 and x1 >= max(xs) - 1e-9 * 200
    assert (x0, y0, x1, y1) == pytest.approx((min(xs), min(ys), max(xs), max(ys)), abs=slack)


def test_known_arcs():
    """Bulge 1 is a half circle, tan(pi / 8) a quarter, 1 + sqrt 2 three quarters; a tiny bulge is a line."""
    half = make_segment_from_bulge((0, 0), (2, 0), 1.0)
    assert (half.center, half.radius, half.half_sweep) == (pytest.approx((1, 0)), 1.0, pytest.approx(pi / 2))
    assert half.compute_point(0.0) == pytest.approx((1, -1))
    quarter = make_segment_from_bulge((1, 0), (0, 1), tan(pi / 8))
    assert (quarter.center, quarter.radius) == (pytest.approx((0, 0)), pytest.approx(1.0))
    big = make_segment_from_bulge((1, 0), (0, -1), tan(3 * pi / 8))
    assert (big.center, big.radius, big.sign) == (pytest.approx((0, 0)), pytest.approx(1.0), 1.0)
    assert big.compute_point(0.0) == pytest.approx((cos(3 * pi / 4), sin(3 * pi / 4)))
    assert make_segment_from_bulge((0, 0), (1, 0), 1e-13) == Line((0, 0), (1, 0))


def test_rows_hold_the_segments():
    """A row is kind, middle or centre, direction, largest parameter, radius, sign, rest; rows cannot be written to."""
    rows = make_segment_rows([Line((0, 0), (6, 8)), Arc((1, 2), 5.0, pi / 2, 0.7, -1.0)])
    assert rows[0] == pytest.approx([0, 3, 4, 0.6, 0.8, 5, 0, 1, 0, 0])
    assert rows[1] == pytest.approx([1, 1, 2, 0, 1, 0.7, 5, -1, 0, 0])
    with pytest.raises(ValueError, match="read-only"):
        rows[0, 0] = 1.0
    assert make_segment_rows([]).shape == (0, 10)


def off_circle(arc: Arc, point: tuple[float, float]) -> float:
    """How far in mm a point is from an arc's circle, from its very numbers: (d^2 - R^2) / 2R."""
    x, y = (
        Fraction(p) - Fraction(c) - Fraction(rest)
        for p, c, rest in zip(point, arc.center, arc.rest, strict=True)
    )
    radius = Fraction(arc.radius)
    return float((x * x + y * y - radius * radius) / (2 * radius))


@pytest.mark.thorough
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
    arc = make_segment_from_bulge(start, end, bulge)
    dx, dy = end[0] - start[0], end[1] - start[1]
    middle = ((start[0] + end[0]) / 2 + bulge * dy / 2, (start[1] + end[1]) / 2 - bulge * dx / 2)
    assert arc.compute_point(0.0) == pytest.approx(middle, abs=1e-13)
    assert (*arc.start, *arc.end) == pytest.approx(points, abs=3e-13)
    for point in (start, middle, end):
        assert abs(off_circle(arc, point)) < 3e-13
    grown = arc.grow(by).cut_part(-0.3 * arc.half_sweep, 0.9 * arc.half_sweep)
    assert abs(off_circle(grown, grown.compute_point(0.1 * arc.half_sweep))) < 3e-13
    assert grown.half_sweep == pytest.approx(0.6 * arc.half_sweep)
    for s in (-0.9, 0.0, 0.5):
        (x, y), (nx, ny) = arc.compute_point(s * arc.half_sweep), arc.compute_normal(s * arc.half_sweep)
        assert arc.find_parameter((x, y)) * arc.radius == pytest.approx(
            s * arc.half_sweep * arc.radius, abs=1e-11
        )
        outer = (x + arc.sign * by * nx, y + arc.sign * by * ny)
        assert abs(off_circle(grown, outer)) < 3e-13


# Faces: neighbouring segments of one line or circle are one face.
def faces(*loops):
    """Faces of a workpiece of some loops."""
    return Workpiece.from_loops("part", loops).faces


@pytest.mark.thorough
@given(outlines())
def test_faces_partition_the_segments(part):
    """Every segment belongs to one face, a face is named by its smallest segment, and lengths add up."""
    numbers = sorted(n for face in part.faces for n in face.segments)
    assert numbers == list(range(len(part.segments)))
    assert [face.number for face in part.faces] == sorted(min(face.segments) for face in part.faces)
    for face in part.faces:
        assert face.segment.length == pytest.approx(sum(part.segments[n].length for n in face.segments))


@pytest.mark.thorough
@given(outlines())
def test_splitting_segments_changes_no_face(part):
    """Every segment cut in two: twice the segments, the same faces."""
    loops = []
    for vertices, segments in zip(part.loops, part.loop_segments, strict=True):
        loop = []
        for (x, y, bulge), segment in zip(vertices, segments, strict=True):
            half = tan(np.arctan(bulge) / 2)
            loop += [[x, y, half], [*segment.compute_point(0.0), half]]
        loops.append(loop)
    split = Workpiece.from_loops("split", loops)
    assert len(split.faces) == len(part.faces)
    for one, two in zip(part.faces, split.faces, strict=True):
        assert sorted(two.segments) == sorted(2 * n + k for n in one.segments for k in (0, 1))
        assert two.segment.length == pytest.approx(one.segment.length)
        if not (isinstance(one.segment, Arc) and one.segment.is_full):
            assert two.segment.compute_point(0.0) == pytest.approx(one.segment.compute_point(0.0), abs=1e-6)


def test_collinear_segments_are_one_face_across_the_first_vertex():
    """A square begun in the middle of a side has four faces, the first of segments 4 and 0, named 0."""
    found = faces([[10, 0, 0], [20, 0, 0], [20, 20, 0], [0, 20, 0], [0, 0, 0]])
    assert [face.number for face in found] == [0, 1, 2, 3]
    assert sorted(found[0].segments) == [0, 4]
    assert isinstance(found[0].segment, Line) and found[0].segment.length == pytest.approx(20)
    assert found[0].segment.start == pytest.approx((0, 0))


@pytest.mark.parametrize("pieces", [2, 3, 5])
@pytest.mark.parametrize("sign", [1, -1])
def test_a_circle_drawn_in_pieces_is_one_face(pieces, sign):
    """k arcs of one circle, either way round, are one whole circle: convex outside, concave as a hole."""
    bulge = sign * tan(tau / pieces / 4)
    circle = [
        [8 * cos(sign * tau * k / pieces), 8 * sin(sign * tau * k / pieces), bulge] for k in range(pieces)
    ]
    (face,) = faces(circle)
    assert face.segment.is_full and face.segment.sign == 1.0 and face.number == 0
    assert face.segment.radius == pytest.approx(8) and face.segment.half_sweep == pi
    square = [[-20, -20, 0], [20, -20, 0], [20, 20, 0], [-20, 20, 0]]
    hole = faces(square, circle)[4]
    assert hole.segment.is_full and hole.segment.sign == -1.0 and hole.number == 4


def test_different_carriers_stay_apart():
    """A bend of 1e-6 rad, and arcs of two radii joined tangentially, are separate faces."""
    assert len(faces([[0, 0, 0], [10, 0, 0], [20, 2e-5, 0], [20, 20, 0], [0, 20, 0]])) == 5
    lens = [[0, 0, tan(pi / 8)], [10, 10, tan(pi / 8)], [-10, 30, 0], [-10, 0, 0]]
    assert len(faces(lens)) == 4


# Where segments meet, and the boxes around them.
@given(seeds)
def test_a_box_holds_its_arc_and_touches_it_on_all_sides(seed: int) -> None:
    """Of arcs of any sweep, also of those that hardly pass an extreme point or nearly close: points all along lie in the
    box, and some on each of its sides."""
    random = Random(seed)
    half = random.choice([random.uniform(0.01, pi), pi - 10 ** random.uniform(-6, -1)])
    middle = random.choice(
        [random.uniform(-pi, pi), random.randrange(4) * pi / 2 + half - 10 ** random.uniform(-6, -1)]
    )
    arc = Arc((3.0, -2.0), 7.0, middle, half, random.choice([1.0, -1.0]))
    low_x, low_y, high_x, high_y = compute_bounding_box(arc)
    angles = middle + half * np.concatenate([np.linspace(-1, 1, 2001), 1 - np.geomspace(1e-9, 1e-2, 60)])
    extremes = np.arange(-12, 13) * pi / 2
    angles = np.concatenate([angles, extremes[np.abs(extremes - middle) <= half]])
    x, y = 3.0 + 7.0 * np.cos(angles), -2.0 + 7.0 * np.sin(angles)
    assert (low_x - 1e-12 <= x).all() and (x <= high_x + 1e-12).all()
    assert (low_y - 1e-12 <= y).all() and (y <= high_y + 1e-12).all()
    assert [x.min(), y.min(), x.max(), y.max()] == pytest.approx([low_x, low_y, high_x, high_y], abs=1e-4)


def test_a_segment_that_lies_in_another_meets_it_at_both_its_ends() -> None:
    """On one line and on one circle the carriers have no common points to list: the ends do, whichever comes first."""
    inner, outer = Line((2.0, 1.0), (5.0, 1.0)), Line((0.0, 1.0), (10.0, 1.0))
    wide, narrow = Arc((0.0, 0.0), 5.0, 1.0, 1.2, 1.0), Arc((0.0, 0.0), 5.0, 0.9, 0.3, -1.0)
    for whole, part in ((outer, inner), (wide, narrow)):
        for pair in ((whole, part), (part, whole)):
            assert {(round(x, 9), round(y, 9)) for x, y in find_common_points(*pair, 1e-7)} == {
                (round(x, 9), round(y, 9)) for x, y in (part.start, part.end)
            }
    assert find_common_points(outer, Line((0.0, 1.1), (10.0, 1.1)), 1e-7) == []
    apart = Arc((0.0, 0.0), 5.0, 1.0 + pi, 0.3, 1.0)
    assert find_common_points(narrow, apart, 1e-7) == []
    assert find_common_points(narrow, Line((cos(0.9), sin(0.9)), (9 * cos(0.9), 9 * sin(0.9))), 1e-7) == [
        pytest.approx((5 * cos(0.9), 5 * sin(0.9)))
    ]


def test_circles_that_touch_have_one_common_point_and_one_inside_another_none() -> None:
    """Whichever of them comes first; a touch from inside lies beyond the centre of the smaller one."""
    wide, narrow = ((0.0, 0.0), 5.0), ((2.0, 0.0), 3.0)
    for one, two in ((wide, narrow), (narrow, wide)):
        assert cross_carrying_circles(*one, *two) == [pytest.approx((5.0, 0.0))]
        assert cross_carrying_circles(*one, two[0], two[1] + 1e-6 * (1 if two is wide else -1)) == []
    assert cross_carrying_circles(*wide, (8.0, 0.0), 3.0) == [pytest.approx((5.0, 0.0))]
    assert cross_carrying_circles(*wide, (8.0 + 1e-6, 0.0), 3.0) == []


def test_a_tolerance_at_the_end_of_an_arc_is_a_length() -> None:
    """So much along the arc, whatever its radius."""
    arc = Arc((0.0, 0.0), 100.0, 0.0, 0.5, 1.0)
    assert holds(arc, arc.compute_point(0.5 + 0.9e-5), 1e-3)
    assert not holds(arc, arc.compute_point(0.5 + 1.1e-5), 1e-3)
