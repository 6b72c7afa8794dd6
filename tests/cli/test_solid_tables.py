"""What the command says of a solid that pegs of one height hold nowhere."""

from __future__ import annotations

from attrs import evolve

from workhold import Workpiece
from workhold.cli.tables import suggest_other_heights
from workhold.model.solid import HeightRow, SolidOutline
from workhold.units import MILLIMETRE, find_unit

SQUARE = [[0, 0, 0], [40, 0, 0], [40, 40, 0], [0, 40, 0]]
ROWS = [
    HeightRow(0.0, 3.0, 1600.0, 160.0, 90.0, 3.0),
    HeightRow(3.0, 12.7, 1600.0, 160.0, 120.0, 8.0),
    HeightRow(12.7, 15.0, 1600.0, 160.0, 0.0, 0.0),
    HeightRow(15.0, 18.0, 1600.0, 160.0, 80.0, 3.0),
    HeightRow(18.0, 19.0, 1600.0, 160.0, 80.0, 3.0),
    HeightRow(19.0, 20.0, 1600.0, 160.0, 160.0, 3.0),
]


def standing(axis: str) -> Workpiece:
    """A block with pegs as high as it."""
    solid = SolidOutline(axis, 20.0, 20.0, 0.5, 1.0, [(0.0, 20.0)] * 4)
    return Workpiece.from_loops("block", [SQUARE], solid=solid)


def test_heights_with_most_to_touch_are_named_and_the_other_side() -> None:
    """Not the height that was asked for, and none that touches nothing; each in the unit of the command."""
    (said,) = suggest_other_heights(standing("z"), ROWS, MILLIMETRE)
    assert "--peg-height 12.700, --peg-height 3.000, --peg-height 19.000, or its other side up" in said
    assert "(--axis=-z)" in said and "20.000" not in said and "15.000" not in said
    assert "--peg-height 0.5000" in suggest_other_heights(standing("z"), ROWS, find_unit("inch"))[0]
    (said,) = suggest_other_heights(standing("-y"), [], MILLIMETRE)
    assert "--peg-height" not in said and "(--axis=y)" in said
    assert not suggest_other_heights(Workpiece.from_loops("plate", [SQUARE]), ROWS, MILLIMETRE)


def test_a_shaft_that_lies_is_said_to_slide_whatever_its_pegs() -> None:
    """Only its ends are touched, which are parallel: no height is named but one that touches more than ends."""
    sliding = [evolve(row, slides=row.touchable > 0) for row in ROWS]
    for bands, slides in (
        ([None, (0.0, 20.0), None, (0.0, 20.0)], True),
        ([(0.0, 20.0), (0.0, 20.0), None, (0.0, 20.0)], False),
        ([None] * 4, False),
    ):
        solid = SolidOutline("z", 20.0, 20.0, 0.5, 1.0, bands)
        shaft = Workpiece.from_loops("shaft", [SQUARE], solid=solid)
        (said,) = suggest_other_heights(shaft, sliding, MILLIMETRE)
        assert ("parallel to one another" in said and "vee blocks" in said) == slides
        assert ("--peg-height" in said) != slides
        (said,) = suggest_other_heights(shaft, [*sliding[:1], ROWS[1], *sliding[2:]], MILLIMETRE)
        assert "--peg-height 12.700" in said and "vee blocks" not in said
        assert ("--peg-height 3.000" in said) != slides
    solid = SolidOutline("z", 20.0, 20.0, 0.5, 1.0, [(0.0, 20.0)] * 2)
    disc = Workpiece.from_loops("disc", [[[-20, 0, 1], [20, 0, 1]]], solid=solid)
    assert "parallel" not in suggest_other_heights(disc, ROWS, MILLIMETRE)[0]
