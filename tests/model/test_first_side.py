"""Two set-ups of one solid: how the part is turned between them, and which of its faces are in both."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from attrs import evolve

from workhold import Plate, Restrictions, Workpiece, design
from workhold.errors import InputError
from workhold.model.first_side import compare_with_first_side, compute_standing_rotation, describe_turn
from workhold.model.solid import AXES, SolidOutline

CORNERS = [(0.0, 0.0), (80.0, 4.0), (76.0, 50.0), (6.0, 44.0)]
PLATE = Plate(pitch=20, peg_radius=3)


def side(axis: str, faces: list[tuple[int, ...]], mirrored: bool) -> Workpiece:
    """A prism as seen from one of its sides, with the solid's faces over its sides."""
    corners = [(-x, y, 0.0) for x, y in reversed(CORNERS)] if mirrored else [(x, y, 0.0) for x, y in CORNERS]
    solid = SolidOutline(axis, 20.0, 8.0, 0.5, 1.0, [(0.0, 8.0)] * 4, faces)
    return Workpiece.from_loops("prism", [corners], solid=solid)


# Faces 1 to 4 of the solid stand over its sides; seen from the other side they follow each other the other way.
FIRST, SECOND = side("z", [(1,), (2,), (3,), (4,)], False), side("-z", [(3,), (2,), (1,), (4,)], True)


@pytest.mark.parametrize("axis", AXES)
def test_standing_is_as_the_reader_has_it(axis: str) -> None:
    """The matrix is the turn that the reader of solids gives them."""
    pytest.importorskip("OCP", reason="the extra 'step' is not installed")
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
    from OCP.gp import gp_Pnt

    from workhold.files.step.library import compute_bounding_box, turn_axis_up

    box = BRepPrimAPI_MakeBox(gp_Pnt(1, 2, 3), 10.0, 20.0, 40.0).Solid()
    low, high = compute_bounding_box(turn_axis_up(box, axis))
    ends = np.array([compute_standing_rotation(axis) @ corner for corner in ((1, 2, 3), (11, 22, 43))])
    assert np.allclose(ends.min(axis=0), low, atol=1e-6) and np.allclose(ends.max(axis=0), high, atol=1e-6)


@pytest.mark.parametrize(("before", "now"), list(product(AXES, AXES)))
def test_words_describe_the_turn(before: str, now: str) -> None:
    """Half turns are told about the axis that they leave; every standing is a turn, none a mirror image."""
    turn = compute_standing_rotation(now) @ compute_standing_rotation(before).T
    assert np.linalg.det(turn) == pytest.approx(1.0)
    words = describe_turn(before, now)
    for k, name in enumerate("xyz"):
        fixed = np.allclose(turn @ np.eye(3)[k], np.eye(3)[k])
        if not np.allclose(turn, np.eye(3)):
            assert (f"about the {name} axis" in words) == fixed
    assert ("half a turn" in words) == (np.trace(turn) == -1 and "axis" in words)
    if words == "the same side up":
        assert before == now


def test_other_side_up_is_turned_over_like_a_page() -> None:
    """Minus an axis is half a turn about the plan's y, whichever axis it is."""
    for axis in "xyz":
        assert (
            describe_turn(axis, f"-{axis}")
            == "turned over about the y axis of the first drawing, by half a turn"
        )
        assert describe_turn(f"-{axis}", axis) == describe_turn(axis, f"-{axis}")


def test_faces_are_found_again_by_their_numbers_in_the_solid() -> None:
    """What was avoided first is not touched, and what both touch is named by the solid's numbers."""
    first = design(FIRST, PLATE, best=40, restrictions=Restrictions(avoid=(2,)))
    second = design(SECOND, PLATE, best=40, restrictions=Restrictions(avoid=(0,)))
    for located in list(first)[::9]:
        for fixture in list(second)[::9]:
            shared = compare_with_first_side(fixture, second.query, first.query, located)
            assert (shared.up, shared.up_before) == ("-z", "z")
            assert shared.cut_of_solid == (3,) and shared.cut == (0,)
            here = {(3, 2, 1, 4)[peg.face] for peg in fixture.pegs}
            there = {peg.face + 1 for peg in located.pegs}
            assert shared.shared == tuple(sorted(here & there))
    alone = compare_with_first_side(second[0], second.query, first.query, None)
    assert alone.shared == ()


def test_parts_of_no_solid_are_refused() -> None:
    """A drawing has no faces of a solid to find again."""
    drawing = Workpiece.from_points("drawing", CORNERS)
    result = design(drawing, PLATE, best=1)
    first = design(FIRST, PLATE, best=1)
    with pytest.raises(InputError, match="drawing has no faces of a solid"):
        compare_with_first_side(result[0], result.query, first.query, None)
    assert FIRST.solid is not None
    bare = evolve(FIRST, solid=evolve(FIRST.solid, faces=()))
    with pytest.raises(InputError, match="prism has no faces of a solid"):
        compare_with_first_side(first[0], first.query, evolve(first.query, workpiece=bare), None)
