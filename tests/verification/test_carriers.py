"""What carriers say of each toolkit, from which a verification puts its rules together, is what the contract says.

Holes, lines and limits are written out here from the fields alone: the model's own description is what is checked.
"""

from __future__ import annotations

import pytest

from workhold import Fence, Fixture, OpeningVise, Peg, Plate, Pose, Vise
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import ClampPair
from workhold.verification.rules.hardware import ToolkitRules


def place(toolkit: Toolkit, carrier: str, column: int, row: int) -> tuple[float, float]:
    """Where a verification puts a hole, in mm."""
    x, y = ToolkitRules(toolkit).compute_hole_center(Peg(carrier, column, row, 0.0, 0.0, 0, 0.0))
    return float(x.mid()), float(y.mid())


def way(toolkit: Toolkit, carrier: str) -> tuple[float, float]:
    """Along which it moves what stands there."""
    return ToolkitRules(toolkit).find_way(Peg(carrier, 0, 0, 0.0, 0.0, 0, 0.0))


@pytest.mark.parametrize("kind", [Vise, OpeningVise])
def test_the_jaws_of_a_vise(kind: type[Vise]) -> None:
    """The right jaw's first column is a separation beyond the left jaw's last, and its rows are higher by the offset."""
    vise = kind(
        (8, 9.5), 3, 2, rows=7, min_gap=5, max_opening=40, row_offset=1.5, body_radius=2.5, blocked=["L-B3"]
    )
    hardware = ToolkitRules(vise)
    assert place(vise, "left", 2, 4) == (16.0, 38.0) and way(vise, "left") == (0.0, 0.0)
    assert place(vise, "right", 1, 4) == (24.0, 39.5) and way(vise, "right") == (1.0, 0.0)
    left, right = hardware.lattices
    assert right.travel is not None and (right.travel.least, right.travel.most) == (5, 40)
    assert {(jaw.columns, jaw.rows, jaw.peg_radius, jaw.body_radius) for jaw in (left, right)} == {
        (3, 7, 2, 2.5)
    }
    assert [(holes.column, holes.row) for holes in left.blocked] == [(1, 2)] and right.blocked == ()
    assert (hardware.clamps, hardware.walls, hardware.from_lowest) == (0, [], ())
    assert hardware.largest_radius == 2 and hardware.names == ("peg 1", "peg 2", "peg 3", "peg 4")


@pytest.mark.parametrize("wall", [None, 6.0])
@pytest.mark.parametrize("clamps", [1, 2])
def test_clamps_on_a_plate_and_beside_a_fence(wall: float | None, clamps: int) -> None:
    """Their travel grows as they open, the other way than they push; rows of a fence begin so far from it."""
    fields = {"columns": 7, "rows": 5, "clamp_radius": 2.5, "travel": (4, 26), "clamps": clamps}
    ways = {"-x": (1.0, 0.0), "+x": (-1.0, 0.0), "-y": (0.0, 1.0), "+y": (0.0, -1.0)}
    for direction, expected in ways.items():
        directions = [(direction, direction)] if clamps == 2 else [direction]
        toolkit: Plate
        if wall is None:
            toolkit = Plate((20, 16), 3, directions=directions, **fields)  # type: ignore[arg-type]
        else:
            toolkit = Fence((20, 16), 3, wall_offset=wall, directions=directions, **fields)  # type: ignore[arg-type]
        hardware, first = ToolkitRules(toolkit), wall or 0.0
        assert (
            place(toolkit, "plate", 2, 3)
            == place(toolkit, f"clamp {direction}", 2, 3)
            == (40.0, 48.0 + first)
        )
        assert way(toolkit, f"clamp {direction}") == expected and way(toolkit, "plate") == (0.0, 0.0)
        (lattice,), tip = hardware.lattices, hardware.tips[direction]
        assert (lattice.columns, lattice.rows, lattice.peg_radius, tip.peg_radius) == (7, 5, 3, 2.5)
        assert hardware.stroke.span == (4, 26) and bool(hardware.walls) == (wall is not None)
        assert hardware.from_lowest == (("column", "row") if wall is None else ("column",))
        still = ("locator 1", "locator 2", "locator 3")
        if wall is not None:
            still = ("the locator", "the fence at its left end", "the fence at its right end")
        assert hardware.names == (*still, *(("the clamp",) if clamps == 1 else ("clamp 1", "clamp 2")))
    assert ToolkitRules(Plate(20, 3)).stroke.span is None


def test_clamps_stand_in_order_and_on_lines_that_count_from_the_first_hole() -> None:
    """Two in one direction by their lines; one without a stroke has no hole on its line."""
    locators = [Peg("plate", k, 0, 20.0 * k, 0.0, k, 0.1) for k in range(3)]
    pair = ClampPair((0.0, 0.0), (0.0, 1.0), ((0.0, 0.0),) * 5, 1)
    plate = Plate(20, 3, clamps=2, directions=[("-x", "-x")])
    for rows, words in (
        ((0, 2), []),
        ((2, 0), ["its clamps are not in the order of directions, lines and faces"]),
    ):
        clamps = [Peg("clamp -x", 0, row, 0.0, 20.0 * row, 3, 0.1) for row in rows]
        fixture = Fixture("clamp2", (*locators, *clamps), Pose(0.0, 0.0, 0.0), 0.0, {}, "-x -x", pair)
        assert [found.reason for found in ToolkitRules(plate).judge_question(fixture)] == words
    for column, words in (
        (0, []),
        (1, ["the place of a clamp on its line is not counted from the plate's first hole"]),
    ):
        clamp = Peg("clamp -x", column, 2, 20.0 * column, 40.0, 3, 0.1, "clamp row 3")
        rules = ToolkitRules(Plate(20, 3))
        assert [found.reason for found in rules.judge_clamp_place("a clamp", clamp)] == words
