"""Which side of the part is up: what tells an outline from its mirror image."""

from __future__ import annotations

import pytest
from drawing_examples import example
from hypothesis import given, settings
from hypothesis import strategies as st

from strategies import outlines
from workhold import Pose, Workpiece
from workhold.drawing.scene import LengthUnit
from workhold.drawing.upper_side import (
    OutlineMark,
    describe_upper_side,
    find_distinguishing_marks,
    list_marks,
)
from workhold.geometry.symmetry import is_own_mirror_image

LENGTHS = LengthUnit.in_mm()
SQUARE = [[0, 0, 0], [20, 0, 0], [20, 20, 0], [0, 20, 0]]


def circle(x: float, y: float, radius: float) -> list[list[float]]:
    """A circle in two halves."""
    return [[x - radius, y, -1], [x + radius, y, -1]]


def mirrored(workpiece: Workpiece) -> Workpiece:
    """The part turned over."""
    return Workpiece.from_loops(
        "turned over", [[[-x, y, -bulge] for x, y, bulge in loop] for loop in workpiece.loops]
    )


def is_same_outline(loops: list[list[list[float]]]) -> bool:
    """Whether an outline is its own mirror image."""
    return is_own_mirror_image([face.segment for face in Workpiece.from_loops("part", loops).faces])


@pytest.mark.parametrize(
    ("loops", "same"),
    [
        ([SQUARE], True),
        ([circle(0, 0, 9), circle(0, 0, 4)], True),
        ([SQUARE, circle(8, 12, 2)], True),
        ([SQUARE, circle(8, 11, 2)], False),
        ([[[0, 0, 0], [30, 0, 0], [40, 20, 0], [10, 20, 0]]], False),
        ([[[0, 0, 0], [10, -5, 0], [30, 0, 0], [10, 5, 0]]], True),
        ([[[0, 0, 0], [30, 0, 0], [0, 20, 0]]], False),
    ],
)
def test_known_mirror_images(loops: list[list[list[float]]], same: bool) -> None:
    """A square, a ring, a hole on a square's diagonal and a kite are; a hole off it, a parallelogram and a triangle of
    three lengths are not."""
    assert is_same_outline(loops) is same
    words = describe_upper_side(Workpiece.from_loops("part", loops), example()[0], LENGTHS)
    assert ("is its own mirror image" in words) is same


@pytest.mark.thorough
@given(outlines())
@settings(max_examples=60)
def test_marks_run_round_the_other_way_in_a_part_turned_over(part: Workpiece) -> None:
    """Each of the two marks is found once in the part turned over, and there they run round its middle the other way."""
    marks = find_distinguishing_marks(part)
    if marks is None:
        return
    twins = [[other for other in list_marks(mirrored(part)) if other.is_like(mark)] for mark in marks]
    assert [len(found) for found in twins] == [1, 1]

    def turn(one: OutlineMark, other: OutlineMark) -> float:
        return one.place[0] * other.place[1] - one.place[1] * other.place[0]

    assert turn(*marks) * turn(twins[0][0], twins[1][0]) < 0


def test_marks_that_look_alike_are_not_told_apart() -> None:
    """A rounding and a hollow of one radius differ; two holes within 2.5 % of one another do not."""
    rounding = OutlineMark(0, (5.0, 5.0), 10.0, 5.0, 1)
    assert not rounding.is_like(OutlineMark(0, (9.0, 5.0), 10.0, 5.0, -1))
    assert OutlineMark(1, (5.0, 5.0), 10.0, 3.0, 2).is_like(OutlineMark(2, (9.0, 5.0), 10.2, 3.06, 2))
    assert not OutlineMark(1, (5.0, 5.0), 10.0, 3.0, 2).is_like(OutlineMark(2, (9.0, 5.0), 10.5, 3.15, 2))


@given(st.floats(0, 360), st.floats(-50, 50))
@settings(max_examples=30)
def test_places_are_told_as_the_part_lies(theta: float, x: float) -> None:
    """A hole right of the middle lies where the part's turn takes it; where the part lies makes no difference."""
    part = Workpiece.from_loops(
        "part", [[[0, 0, 0], [60, 0, 0], [60, 40, 0], [0, 40, 0]], circle(50, 20, 4), circle(30, 32, 2)]
    )
    fixture = example()[0]
    words = describe_upper_side(
        part, type(fixture)(fixture.type, fixture.pegs, Pose(theta, x, 7.0), 36.0, {}), LENGTHS
    )
    eighths = ["right", "upper right", "top", "upper left", "left", "lower left", "bottom", "lower right"]
    near = {eighths[int(turn // 45) % 8] for turn in (theta + 22.4, theta + 22.6)}
    assert any(f"hole 1, Ø 8 mm, at the {eighth} and hole 2" in words for eighth in near)
