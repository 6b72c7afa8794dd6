"""Loops: area, running direction, inside, meeting points."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from strategies import outlines
from workhold.geometry.loop import compute_signed_area, make_loop_segments, reverse_vertices
from workhold.geometry.segment import (
    Arc,
    Line,
    find_carrier_crossings,
    find_common_points,
    holds,
    make_segment_from_bulge,
)

places = st.tuples(st.floats(-50, 50), st.floats(-50, 50)).map(lambda p: (round(p[0], 2), round(p[1], 2)))


def polygon_area(segments, steps: int) -> float:
    """Shoelace area of the polygon through points on the segments."""
    points = []
    for s in segments:
        ends = np.linspace(-1, 1, steps, endpoint=False) * s.half_extent
        points += [s.compute_point(t if isinstance(s, Line) or s.sign > 0 else -t) for t in ends]
    x, y = np.array(points).T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


@pytest.mark.thorough
@given(outlines())
def test_area_is_the_limit_of_inscribed_polygons(part):
    """The shoelace sum plus circular segments is the limit of polygon areas, which converge with the square of the step."""
    for segments in part.loop_segments:
        area = compute_signed_area(segments)
        errors = [abs(polygon_area(segments, n) - area) for n in (50, 100, 200)]
        assert errors[2] <= 1e-3 * abs(area) + 1e-9
        assert errors[2] <= errors[0] / 12 + 1e-9 * abs(area)


@pytest.mark.thorough
@given(outlines())
def test_a_reversed_loop_has_the_same_points_and_the_opposite_area(part):
    """Reversing keeps the first vertex and the point set, negates the area, and is its own inverse."""
    for vertices in part.loops:
        back = reverse_vertices(vertices)
        assert back[0, :2] == pytest.approx(vertices[0, :2])
        assert np.array_equal(reverse_vertices(back), vertices)
        forward, reverse = make_loop_segments(vertices), make_loop_segments(back)
        assert compute_signed_area(reverse) == pytest.approx(-compute_signed_area(forward))
        assert sum(s.length for s in reverse) == pytest.approx(sum(s.length for s in forward))
        for s, t in zip(forward, reversed(reverse), strict=True):
            assert s.compute_point(0.0) == pytest.approx(t.compute_point(0.0), abs=1e-9)
            assert s.start == pytest.approx(t.end, abs=1e-9)


def test_known_areas():
    """A 20 x 10 rectangle, a disc from two halves, and an obround."""
    rectangle = make_loop_segments(np.array([[0, 0, 0], [20, 0, 0], [20, 10, 0], [0, 10, 0.0]]))
    disc = make_loop_segments(np.array([[-5, 0, 1], [5, 0, 1.0]]))
    obround = make_loop_segments(np.array([[0, 0, 0], [20, 0, 1], [20, 10, 0], [0, 10, 1.0]]))
    assert compute_signed_area(rectangle) == pytest.approx(200)
    assert compute_signed_area(disc) == pytest.approx(25 * pi)
    assert compute_signed_area(obround) == pytest.approx(200 + 25 * pi)


@pytest.mark.thorough
@settings(max_examples=200)
@given(
    places, places, st.sampled_from([0.0, 0.4, -1.5, 1.0]), places, places, st.sampled_from([0.0, -0.3, 2.0])
)
def test_intersections_of_carriers_lie_on_both(p, q, bulge, r, s, other_bulge):
    """Every common point of two carriers has distance 0 from both; lines meet once, circles and lines at most twice."""
    if max(abs(p[0] - q[0]), abs(p[1] - q[1])) < 0.1 or max(abs(r[0] - s[0]), abs(r[1] - s[1])) < 0.1:
        return
    a, b = make_segment_from_bulge(p, q, bulge), make_segment_from_bulge(r, s, other_bulge)
    points = find_carrier_crossings(a, b)
    assert len(points) <= 2
    for x, y in points:
        for segment in (a, b):
            if isinstance(segment, Arc):
                off = abs(np.hypot(x - segment.center[0], y - segment.center[1]) - segment.radius)
            else:
                (mx, my), (tx, ty) = segment.middle, segment.tangent
                off = abs((x - mx) * ty - (y - my) * tx)
            assert off < 1e-6 * (1 + 1e-3 * np.hypot(x, y))
    # Segments found to meet by a change of side are found to meet by their carriers.
    if isinstance(a, Line) and isinstance(b, Line):
        sides = [np.sign(np.cross([*a.tangent, 0], [t[0] - p[0], t[1] - p[1], 0])[2]) for t in (r, s)]
        other = [np.sign(np.cross([*b.tangent, 0], [t[0] - r[0], t[1] - r[1], 0])[2]) for t in (p, q)]
        if sides[0] * sides[1] < 0 and other[0] * other[1] < 0:
            assert len(find_common_points(a, b, 1e-7)) == 1


@pytest.mark.thorough
def test_arcs_meet_where_a_sampling_says_so():
    """The number of common points of two arcs is the number of sign changes of one's circle equation along the other."""
    random = np.random.default_rng(5)
    met = 0
    for _ in range(300):
        a = Arc(
            tuple(random.uniform(-5, 5, 2)),
            random.uniform(2, 8),
            random.uniform(-3, 3),
            random.uniform(0.3, 3),
            1.0,
        )
        b = Arc(
            tuple(random.uniform(-5, 5, 2)),
            random.uniform(2, 8),
            random.uniform(-3, 3),
            random.uniform(0.3, 3),
            1.0,
        )
        t = np.linspace(-a.half_sweep, a.half_sweep, 4001)
        points = np.array([a.compute_point(x) for x in t])
        off = np.hypot(*(points - b.center).T) - b.radius
        changes = np.flatnonzero(off[1:] * off[:-1] < 0)
        inside = [holds(b, tuple(points[k]), 0.0) for k in changes]
        margin = [abs(abs(b.find_parameter(tuple(points[k]))) - b.half_sweep) for k in changes]
        if min([*margin, 1.0]) < 0.01 or (
            np.abs(off).min() > 0 and np.abs(off).min() < 1e-2 and not len(changes)
        ):
            continue
        met += sum(inside)
        assert len(find_common_points(a, b, 1e-9)) == sum(inside)
    assert met > 50
