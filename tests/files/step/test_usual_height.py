"""Beside a solid pegs are no higher than they must be, where nobody says how high and the toolkit is known."""

from __future__ import annotations

from typing import Any

import pytest

pytest.importorskip("OCP", reason="the extra 'step' is not installed")

from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
from step_shapes import cylinder, fused

import workhold
from solid_examples import bearing_housing, boss, lying_shaft, ribbed, stepped
from workhold.cli.tables import explain_sliding_part
from workhold.errors import InputError
from workhold.files.part.load import read_workpiece, refuse_unsure_numbers
from workhold.model.dowel_lengths import list_standouts

VISE = workhold.Vise(pitch=20, columns=3, peg_radius=3)
SIXTEEN = workhold.Vise(pitch=50, columns=2, peg_radius=8)
SEVEN = workhold.Vise(pitch=20, columns=3, peg_radius=3.5)
POINTS = workhold.Vise(pitch=20, columns=3, peg_radius=0)


def touchable(shape: Any, height: float) -> float:
    """The length of what pegs of a height can touch; 0 where there is no such outline."""
    try:
        part = workhold.load(shape, peg_height=height)
    except InputError:
        return 0.0
    assert part.solid is not None
    bands = part.solid.bands
    return sum(s.length for s, band in zip(part.segments, bands, strict=True) if band is not None)


@pytest.mark.parametrize(
    ("height", "toolkit", "expected"),
    [(40.0, VISE, 11.0), (10.0, VISE, 9.0), (3.0, VISE, 3.0), (60.0, SIXTEEN, 31.0), (40.0, SEVEN, 40.0)],
)
def test_of_a_block(height: float, toolkit: workhold.Vise, expected: float) -> None:
    """The largest standout within two diameters; what is not sold ends where its rows do."""
    block = BRepPrimAPI_MakeBox(60.0, 40.0, height).Shape()
    part = workhold.load(block, toolkit=toolkit)
    assert part.solid is not None
    assert part.solid.peg_height == expected
    assert workhold.load(block).solid.peg_height == height  # type: ignore[union-attr]
    assert workhold.load(block, toolkit=toolkit, peg_height=2.5).solid.peg_height == 2.5  # type: ignore[union-attr]


@pytest.mark.parametrize("make", [bearing_housing, boss, stepped, ribbed])
@pytest.mark.parametrize("toolkit", [VISE, SIXTEEN], ids=["6", "16"])
def test_it_is_the_rule_word_for_word(make: Any, toolkit: workhold.Vise) -> None:
    """The largest standout up to two diameters that touches half of what the best does, else the least."""
    shape = make()
    loaded = read_workpiece(shape, peg_diameter=toolkit.peg_diameter)
    assert loaded.usual is not None and loaded.workpiece.solid is not None
    top, best = loaded.usual.height, max(row.touchable for row in loaded.heights)
    possible = [p for p in list_standouts(toolkit.peg_diameter) if p <= top + 1e-5]
    enough = [p for p in possible if touchable(shape, p) >= best / 2 * (1 - 1e-9)]
    low = [p for p in enough if p <= 2 * toolkit.peg_diameter]
    expected = max(low) if low else min(enough, default=top)
    assert loaded.workpiece.solid.peg_height == loaded.usual.peg_height == expected


def test_points_end_where_rows_do() -> None:
    """Without a diameter there is no standout, and the least end of a row that touches enough is taken."""
    loaded = read_workpiece(stepped(), peg_diameter=0.0)
    best = max(row.touchable for row in loaded.heights)
    ends = [row.high for row in loaded.heights]
    assert loaded.usual is not None
    assert loaded.usual.peg_height == min(p for p in ends if touchable(stepped(), p) >= best / 2 * (1 - 1e-9))


def test_the_note_says_how_high_why_and_how_to_have_them_as_tall() -> None:
    block = BRepPrimAPI_MakeBox(60.0, 40.0, 40.0).Shape()
    (note,) = read_workpiece(block, peg_diameter=6.0).remarks
    assert "stand out 11 mm, as dowels of 6 × 20 mm do that sit 9 mm deep: higher ones bend more" in note
    assert note.endswith("For pegs as tall as the part give peg_height 40mm.")
    assert read_workpiece(block).remarks == ()


def test_no_height_is_advised_where_the_part_slides_along_pegs_of_any() -> None:
    """A stepped shaft that lies shows pegs its ends and shoulders; two flats on it keep it from sliding."""
    shaft = fused(cylinder(15, 60, (0, 0, 22), (1, 0, 0)), cylinder(22, 40, (60, 0, 22), (1, 0, 0)))
    for shape, slides in ((shaft, True), (lying_shaft(), False)):
        loaded = read_workpiece(shape, peg_diameter=6.0)
        assert all(row.slides for row in loaded.heights if row.touchable > 0) == slides
        said = " ".join(loaded.remarks)
        assert "stand out 11 mm" in said and ("peg_height" in said) != slides
        assert (explain_sliding_part(loaded.workpiece, loaded.heights) != []) == slides


def test_numbers_that_depend_on_the_height_are_refused_with_both() -> None:
    """Of a prism they do not, and where a height is given nothing is unsure."""
    loaded = read_workpiece(stepped(), peg_diameter=6.0)
    assert loaded.usual is not None and not loaded.usual.is_whole
    low, high = loaded.usual.peg_height, loaded.usual.height
    with pytest.raises(InputError) as refused:
        refuse_unsure_numbers(loaded, (0, 2), {"peg_height": "--peg-height"})
    assert "faces 0, 2 are named by number" in str(refused.value)
    assert f"--peg-height {low:g}mm" in str(refused.value) and f"--peg-height {high:g}mm" in str(
        refused.value
    )
    refuse_unsure_numbers(loaded, ())
    refuse_unsure_numbers(read_workpiece(stepped(), peg_height=low, peg_diameter=6.0), (0, 2))
    refuse_unsure_numbers(
        read_workpiece(BRepPrimAPI_MakeBox(60.0, 40.0, 40.0).Shape(), peg_diameter=6.0), (0,)
    )
