"""Hull edges: the straight pieces of the boundary of an outline's convex hull, over corners, faces, gaps and arcs."""

from __future__ import annotations

from math import cos, hypot, pi, sin, sqrt, tau

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slow_fence import orientations
from workhold import Fence, InputError, Workpiece, design
from workhold.geometry.hull import HullEdge

Loop = list[tuple[float, ...]]


def edges_of(loop: Loop) -> tuple[HullEdge, ...]:
    """The hull edges of a part of one loop."""
    return Workpiece.from_loops("part", [loop]).hull_edges


def test_pads_on_one_line_are_one_edge_over_the_gap_and_its_ends_are_of_the_pads() -> None:
    """Two feet, the arch between them off the line; up to the rounding of a drawing."""
    for off in (0.0, 4e-8, -4e-8):
        feet = [
            (0, 0, 0),
            (10, 0, 0),
            (15, 6, 0),
            (25, 6, 0),
            (30, off, 0),
            (40, off, 0),
            (40, 20, 0),
            (0, 20, 0),
        ]
        (bottom,) = (edge for edge in edges_of(feet) if abs(edge.tangent[1]) < 0.1 and edge.tangent[0] > 0)
        assert (bottom.start.point, bottom.end.point) == ((0, 0), (40, off))
        assert (bottom.start.faces, bottom.end.faces) == ((0,), (4,))
        assert bottom.start.along and bottom.end.along
        assert len(edges_of(feet)) == 4


def test_what_stands_out_by_more_than_rounding_makes_edges_of_its_own() -> None:
    """A foot a micrometre lower than the other."""
    feet = [
        (0, 0, 0),
        (10, 0, 0),
        (15, 6, 0),
        (25, 6, 0),
        (30, -1e-3, 0),
        (40, -1e-3, 0),
        (40, 20, 0),
        (0, 20, 0),
    ]
    below = [edge for edge in edges_of(feet) if edge.tangent[0] > 0.9]
    assert [(edge.start.point[0], edge.end.point[0]) for edge in below] == [(0, 30), (30, 40)]
    assert below[0].start.faces == (0, 7) or set(below[0].start.faces) == {0, 7}


def test_two_discs_joined_by_a_waist_have_two_edges_from_arc_to_arc() -> None:
    """By hand: circles of radius 10 and 4, 40 apart, whose common tangents rise by the angle with sine 6 / 40."""
    # Both circles run on from the waist, which is straight and inside the hull.
    a = sqrt(10.0**2 - 2.0**2)
    b = sqrt(4.0**2 - 2.0**2)
    sweep_big, sweep_small = tau - 2 * np.arcsin(0.2), tau - 2 * np.arcsin(0.5)
    loop = [
        (a, 2.0, np.tan(sweep_big / 4)),
        (a, -2.0, 0.0),
        (40 - b, -2.0, np.tan(sweep_small / 4)),
        (40 - b, 2.0, 0.0),
    ]
    edges = edges_of(loop)
    assert len(edges) == 2
    for edge in edges:
        assert sorted((edge.start.radius, edge.end.radius)) == [pytest.approx(4.0), pytest.approx(10.0)]
        assert edge.length == pytest.approx(sqrt(40.0**2 - 6.0**2))
        assert abs(edge.tangent[1]) == pytest.approx(6.0 / 40.0)
        assert edge.measure_height((0.0, 0.0)) == pytest.approx(10.0) and edge.measure_height(
            (40.0, 0.0)
        ) == pytest.approx(4.0)


def test_where_a_face_runs_smoothly_into_an_arc_the_face_is_named() -> None:
    """A slot: two straight sides and two half circles; no edge is listed twice."""
    edges = edges_of([(0, 0, 0), (30, 0, 1), (30, 10, 0), (0, 10, 1)])
    assert [(edge.start.faces, edge.end.faces) for edge in edges] == [((0,), (0,)), ((2,), (2,))]
    assert [edge.length for edge in edges] == [30.0, 30.0]


def test_a_disc_has_none_and_a_disc_with_a_flat_one() -> None:
    """A whole circle supports in every direction by itself."""
    assert edges_of([(0, 0, 1), (20, 0, 1)]) == ()
    assert len(edges_of([(0, 0, 0), (12, 0, 2.0)])) == 1


def test_edges_shorter_than_a_micrometre_fraction_do_not_count() -> None:
    """A corner broken by less than 1e-6 mm is a corner."""
    for size, count in ((5e-7, 4), (5e-6, 5)):
        assert len(edges_of([(0, 0, 0), (20, 0, 0), (20, 10, 0), (size, 10, 0), (0, 10 - size, 0)])) == count


@pytest.mark.thorough
@given(st.integers(3, 9), st.integers(0, 2**32 - 1), st.floats(0.0, 6.2))
def test_they_are_where_the_lowest_point_jumps_as_the_part_turns(count: int, seed: int, turn: float) -> None:
    """Of random outlines about a point, with arcs bent in and out: the slow search finds the same orientations and ends."""
    random = np.random.default_rng(seed)
    angles = np.arange(count) * tau / count + random.uniform(-0.3, 0.3, count) * tau / count + turn
    radii = random.uniform(20.0, 30.0, count)
    bulges = random.choice([0.0, 0.0, 0.12, 0.2, -0.15], count)
    loop = [(r * cos(a), r * sin(a), b) for a, r, b in zip(angles, radii, bulges, strict=True)]
    try:
        part = Workpiece.from_loops("part", [loop])
    except InputError:
        # It crosses itself.
        return
    slow = [(angle, left, right) for angle, left, right in orientations(part) if apart(left, right) > 1e-5]
    edges = part.hull_edges
    # Shorter ones the halving cannot distinguish from none.
    assert sum(edge.length > 1e-5 for edge in edges) == len(slow)
    theta = part.flush.theta
    for angle, left, right in slow:
        k = int(part.flush.find_nearest_edges(np.array([angle]))[0])
        assert abs((theta[k] - angle + pi) % tau - pi) < 1e-9
        assert apart(edges[k].start.point, left) < 1e-6 and apart(edges[k].end.point, right) < 1e-6


def apart(a: tuple[float, float], b: tuple[float, float]) -> float:
    """Distance of two points."""
    return hypot(a[0] - b[0], a[1] - b[1])


def test_an_arc_and_its_own_end_have_no_edge_between_them() -> None:
    """The corner is on the circle but for rounding, whose square root is more than a micrometre."""
    loop = [(19.401, 18.921, 0.0), (-18.602, 19.0, 0.117), (0.232, -17.441, -0.295)]
    part = Workpiece.from_loops("wedge", [loop])
    assert all(edge.length > 1.0 for edge in part.hull_edges)
    assert len(design(part, Fence(pitch=10, peg_radius=3, wall_offset=6, clamp_radius=4))) > 0
