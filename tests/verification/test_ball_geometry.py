"""Sides of the outline as balls: the same lines and arcs as the geometry's floats, without their rounding."""

from __future__ import annotations

from math import cos, hypot, pi, sin
from random import Random

import pytest
from flint import arb
from hypothesis import given

from strategies import outlines, seeds
from workhold import Workpiece
from workhold.geometry.segment import Arc, Line, measure_distance_to_segment
from workhold.verification.ball_geometry import (
    ArcSide,
    BallOutline,
    make_arc_side,
    make_exact_point,
    make_line_side,
)


def holds(ball: arb, value: float, tolerance: float = 1e-9) -> bool:
    """Whether a ball is narrow and agrees with a float to its rounding."""
    return bool(abs(ball - value) < tolerance * max(1.0, abs(value)))


@pytest.mark.thorough
@given(outlines(), seeds)
def test_distances_and_gaps_are_those_of_the_floats(workpiece: Workpiece, seed: int) -> None:
    random = Random(seed)
    outline = BallOutline.from_workpiece(workpiece)
    assert len(outline.segments) == len(workpiece.segments)
    for _ in range(4):
        x, y = random.uniform(-80, 80), random.uniform(-80, 80)
        for side, segment in zip(outline.segments, workpiece.segments, strict=True):
            assert holds(
                side.compute_distance(make_exact_point(x, y)),
                measure_distance_to_segment((x, y), segment),
                1e-8,
            )
            if isinstance(segment, Line):
                normal = segment.compute_normal()
                gap = (x - segment.start[0]) * normal[0] + (y - segment.start[1]) * normal[1]
            else:
                gap = segment.sign * (hypot(x - segment.center[0], y - segment.center[1]) - segment.radius)
            assert holds(side.compute_gap(make_exact_point(x, y)), gap, 1e-8)


@pytest.mark.thorough
@given(outlines(), seeds)
def test_slacks_are_the_ways_to_the_ends(workpiece: Workpiece, seed: int) -> None:
    """On a face moved out by an offset, also past its ends."""
    random = Random(seed)
    outline = BallOutline.from_workpiece(workpiece)
    for face in workpiece.faces:
        side, segment, offset = outline.faces[face.number], face.segment, random.uniform(0.0, 3.0)
        parameter = random.uniform(-1.1, 1.1) * segment.half_extent
        nx, ny = segment.compute_normal(parameter)
        x, y = segment.compute_point(parameter)
        slacks = side.compute_slacks(make_exact_point(x + offset * nx, y + offset * ny), arb(offset))
        scale = 1.0
        if isinstance(segment, Arc):
            scale = segment.radius + segment.sign * offset
            if segment.is_full:
                assert slacks == ()
                continue
            if scale < 1e-3 or abs(parameter) > pi - 1e-3:
                continue
        # A segment's parameter runs counter-clockwise, a concave arc's face clockwise.
        signed = parameter * getattr(segment, "sign", 1)
        for slack, along in zip(slacks, (signed, -signed), strict=True):
            assert holds(slack, scale * (segment.half_extent + along), 1e-7)


@pytest.mark.parametrize(("bulge", "center"), [(1.0, (0, 0)), (-1.0, (0, 0)), (0.5, (0, 3)), (-2.0, (0, 3))])
def test_an_arc_from_its_bulge(bulge: float, center: tuple[int, int]) -> None:
    """Chord from (-4, 0) to (4, 0): radius 4 for a half circle, and the 3-4-5 triangle for bulges 1/2 and 2."""
    side = make_arc_side(make_exact_point(-4, 0), make_exact_point(4, 0), bulge)
    assert all(ball.contains(value) for ball, value in zip(side.center, center, strict=True))
    assert side.radius.contains(4 if center == (0, 0) else 5)
    assert side.sign == (1 if bulge > 0 else -1)
    below = 1 if bulge > 0 else -1
    assert side.middle[0].contains(0)
    assert side.middle[1].contains(-below)


def test_a_point_beside_and_past_a_line() -> None:
    side = make_line_side(make_exact_point(0, 0), make_exact_point(10, 0))
    assert side.compute_distance(make_exact_point(4, -3)).contains(3)
    assert side.compute_distance(make_exact_point(13, -4)).contains(5)
    # Just beside the end the ball of distances holds both cases.
    assert side.compute_distance((arb(10, 1e-20), arb(-3))).contains(3)
    assert side.compute_gap(make_exact_point(4, -3)).contains(3)
    assert side.compute_gap(make_exact_point(4, 3)).contains(-3)
    assert side.find_vector_away(make_exact_point(-1e-15, 1)) == make_exact_point(-1e-15, 1)
    assert side.find_vector_away(make_exact_point(1e-15, 1)) == make_exact_point(0, -1)
    assert side.find_vector_away(make_exact_point(0, 1)) is None


def test_a_circle_of_two_halves_is_one_face_without_ends() -> None:
    plate = [[-40, -30, 0], [40, -30, 0], [40, 30, 0], [-40, 30, 0]]
    workpiece = Workpiece.from_loops("plate", [plate, [[-7, 0, -1], [7, 0, -1]]])
    side = BallOutline.from_workpiece(workpiece).faces[4]
    assert isinstance(side, ArcSide)
    assert side.whole
    assert side.compute_slacks(make_exact_point(5, 0), arb(2)) == ()
    for angle in (0.0, 1.0, pi, -2.0):
        assert holds(side.compute_distance(make_exact_point(5 * cos(angle), 5 * sin(angle))), 2.0)


def test_lines_that_continue_each_other_are_one_face() -> None:
    workpiece = Workpiece.from_loops("bar", [[[0, 0, 0], [20, 0, 0], [60, 0, 0], [60, 40, 0], [0, 40, 0]]])
    outline = BallOutline.from_workpiece(workpiece)
    slacks = outline.faces[0].compute_slacks(make_exact_point(20, -3), arb(3))
    assert [slack.contains(far) for slack, far in zip(slacks, (20, 40), strict=True)] == [True, True]
    assert {index for index, _ in outline.others[0]} == {2, 3, 4}
