"""A set-up in the middle of the shop's plate, or where somebody says, and what hangs over."""

from __future__ import annotations

from typing import Any

import pytest

import workhold
from toolkit_results import MOUTH, part
from workhold import Fence, Fixture, FlatJaw, InputError, Plate, Result, Vise
from workhold.drawing.sheet_facts import collect_sheet_details
from workhold.fixels.toolkit import Toolkit
from workhold.model.moved_setup import (
    count_spare_holes,
    describe_overhang,
    find_move_to_middle,
    find_overhangs,
    move_fixture_by_holes,
    move_to,
)
from workhold.model.shown import bound_placed_part
from workhold.web.answers import describe_fixture

LOOP = [(0, 0, 0), (100, 0, 0), (100, 30, 0), (40, 34, 0), (40, 90, 0), (4, 90, 0)]
KITE = [(0, 0, 0), (56, 6, 0), (48, 44, 0), (10, 37, 0)]
KINDS: dict[str, Toolkit] = {
    "plate": Plate(pitch=20, peg_radius=3, clamp_radius=5, columns=13, rows=10, travel=(10, 40)),
    "no stroke": Plate(pitch=20, peg_radius=3, columns=13, rows=10),
    "two clamps": Plate(
        pitch=20, peg_radius=3, clamp_radius=5, columns=12, rows=9, travel=(10, 40), clamps=2
    ),
    "fence": Fence(pitch=20, peg_radius=3, wall_offset=10, columns=12, rows=8, travel=(10, 40)),
    "flat jaw": FlatJaw(pitch=12, peg_radius=3, columns=15),
}


def held(toolkit: Toolkit) -> Result:
    """The best fixtures of a part in a toolkit."""
    return workhold.design(part(LOOP), toolkit, best=5)


@pytest.mark.thorough
@pytest.mark.thinned(4)
@pytest.mark.parametrize("kind", KINDS)
def test_all_stands_in_the_middle_and_nothing_changes_among_itself(kind: str) -> None:
    """No other place is nearer to the middle; pegs, part and strokes keep to one another; holes have names."""
    toolkit, result = KINDS[kind], held(KINDS[kind])
    assert len(result)
    moves = set()
    for fixture in result:
        move = find_move_to_middle(fixture, toolkit, result.workpiece)
        moves.add(move)
        placed = move_fixture_by_holes(fixture, toolkit, move)
        by = [steps * pitch for steps, pitch in zip(move, toolkit.plates[0].pitch, strict=True)]
        for one, other in zip(fixture.pegs, placed.pegs, strict=True):
            assert (other.x - one.x, other.y - one.y) == pytest.approx(by)
            carrier = toolkit.find_carrier(one.carrier)
            if carrier.has_lattice:
                assert carrier.compute_hole_center(other.column, other.row, placed.travel) == pytest.approx(
                    (other.x, other.y)
                )
                assert 0 <= other.column < (toolkit.plates[0].columns or 99)
                assert 0 <= other.row < (toolkit.plates[0].rows or 99)
        assert (placed.pose.x - fixture.pose.x, placed.pose.y - fixture.pose.y) == pytest.approx(by)
        if kind != "no stroke":
            assert placed.travels == fixture.travels
        off = [middle_off(placed, result, axis) for axis in (0, 1)]
        for axis, (back, ahead) in enumerate(count_spare_holes(placed, toolkit)):
            for step in range(-back, (ahead or 0) + 1):
                there = move_fixture_by_holes(placed, toolkit, (step, 0) if axis == 0 else (0, step))
                if ahead is not None:
                    assert abs(middle_off(there, result, axis)) >= abs(off[axis]) - 1e-6
    assert moves != {(0, 0)}
    if toolkit.wall is not None:
        assert {rows for _, rows in moves} == {0}


def middle_off(fixture: Fixture, result: Result, axis: int) -> float:
    """How far the middle of part, pegs and clamps is from that of the plate along an axis, in mm."""
    plate = result.toolkit.plates[0]
    box = bound_placed_part(result.workpiece, fixture.pose)
    ends = [(box.x0, box.y0)[axis], (box.x1, box.y1)[axis], *((peg.x, peg.y)[axis] for peg in fixture.pegs)]
    for peg in fixture.pegs:
        carrier = result.toolkit.find_carrier(peg.carrier)
        if carrier.has_body_behind:
            ends.append(carrier.compute_hole_center(peg.column, peg.row)[axis])
    count = (plate.columns, plate.rows)[axis] or 1
    return (min(ends) + max(ends)) / 2 - plate.offset[axis] - (count - 1) * plate.pitch[axis] / 2


@pytest.mark.thorough
def test_without_an_end_of_the_plate_and_in_a_vise_nothing_moves() -> None:
    """Columns of jaws are nearest to the opening, rows listed in the middle; a jaw with ends has its columns."""
    for toolkit in (
        Plate(pitch=20, peg_radius=3),
        Vise(pitch=20, columns=4, rows=9, peg_radius=3),
        FlatJaw(pitch=12, peg_radius=3, columns=9, jaw_width=80),
    ):
        result = held(toolkit)
        assert len(result)
        assert {find_move_to_middle(one, toolkit, result.workpiece) for one in result} == {(0, 0)}


@pytest.mark.thorough
def test_a_hole_that_is_asked_for_takes_the_lowest_column_and_row() -> None:
    """What cannot be is refused with what can."""
    toolkit = KINDS["plate"]
    result = held(toolkit)
    fixture = result[0]
    placed = move_fixture_by_holes(fixture, toolkit, move_to(fixture, toolkit, "d4"))
    assert (min(peg.column for peg in placed.pegs), min(peg.row for peg in placed.pegs)) == (3, 3)
    for wrong, words in (
        ("4D", "'4D' names no hole to stand at: give a column letter and a row"),
        ("Z4", "the set-up cannot stand at Z4: its lowest column can be one of A to"),
        ("A10", "the set-up cannot stand at A10: its lowest row can be one of 1 to"),
    ):
        with pytest.raises(InputError, match=words):
            move_to(fixture, toolkit, wrong)
    vise = Vise(pitch=20, columns=4, rows=9, peg_radius=3, blocked=["L-D9", "L-C9", "L-B9", "L-A9"])
    seen = held(vise)
    lowest = min(peg.row for peg in seen[0].pegs)
    assert move_to(seen[0], vise, "L-A1") == (0, -lowest)
    span = max(peg.row for peg in seen[0].pegs) - lowest
    if any(peg.row - lowest == span and peg.carrier == "left" for peg in seen[0].pegs):
        with pytest.raises(InputError, match="is blocked"):
            move_to(seen[0], vise, f"L-A{9 - span}")
    jaw = FlatJaw(pitch=12, peg_radius=3, columns=9, jaw_width=80)
    with pytest.raises(InputError, match="its lowest column can be"):
        move_to(held(jaw)[0], jaw, "I1")


@pytest.mark.thorough
def test_what_hangs_over_is_told() -> None:
    """Beyond half a pitch outside the last holes, or beyond the ends of a jaw; nothing of plates without ends."""
    plate = KINDS["plate"].with_fields({"columns": 6, "rows": 5})
    result = held(plate)
    assert len(result)
    fixture = move_fixture_by_holes(result[0], plate, find_move_to_middle(result[0], plate, result.workpiece))
    box = bound_placed_part(result.workpiece, fixture.pose)
    wanted = {"left": -10 - box.x0, "right": box.x1 - 110, "lower": -10 - box.y0, "upper": box.y1 - 90}
    found = {one.side: one.length for one in find_overhangs(fixture, plate, result.workpiece)}
    assert found == pytest.approx({side: by for side, by in wanted.items() if by > 1e-6})
    jaw = FlatJaw(pitch=12, peg_radius=3, columns=4, jaw_width=30)
    kite = workhold.design(part(KITE), jaw)
    words = describe_overhang(kite[0], jaw, kite.workpiece, "{:.3f} mm".format)
    box = bound_placed_part(kite.workpiece, kite[0].pose)
    left, right = 3.0 - box.x0, box.x1 - 33.0
    told = f"{left:.3f} mm at the left and {right:.3f} mm at the right"
    assert words == f"The part stands out beyond the flat jaw: {told}."
    free = held(Plate(pitch=20, peg_radius=3))
    assert describe_overhang(free[0], free.toolkit, free.workpiece, str) == ""


@pytest.mark.thorough
def test_the_sheet_has_it_there_and_the_page_lays_the_plate_so() -> None:
    """Both name the same holes; on the page all places stay those of the list, and the plate lies elsewhere under them."""
    toolkit = KINDS["plate"]
    result = held(toolkit)
    asked: dict[str, Any] = {"zero": None}
    placed, details = collect_sheet_details(result, 1, **asked)
    row = describe_fixture(result[0], result.workpiece, toolkit)
    assert [peg.hole for peg in placed.pegs] == row["holes"] != [peg.hole for peg in result[0].pegs]
    assert row["pegs"] == [[peg.x, peg.y] for peg in result[0].pegs]
    moved = [steps * 20.0 for steps in details.moved]
    assert row["placed"] == moved
    there, details = collect_sheet_details(result, 1, at="B2")
    assert min(peg.column for peg in there.pegs) == 1 and details.is_asked_place
    mouth = workhold.design(part(MOUTH), FlatJaw(pitch=9, peg_radius=2, columns=12, jaw_width=40), best=3)
    row = describe_fixture(mouth[0], mouth.workpiece, mouth.toolkit)
    assert row["stands_out_of"] == "flat jaw" and row["hangs_over"]
