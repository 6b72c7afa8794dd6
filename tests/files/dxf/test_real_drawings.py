"""Three real drawings (tests/data/drawings/SOURCES.md) and the example of our own making."""

from __future__ import annotations

import runpy
from math import pi
from pathlib import Path

import pytest
from reading_helpers import area

from workhold import load
from workhold.errors import InputError
from workhold.files.part.load import read_workpiece
from workhold.geometry.loop import compute_signed_area as loop_area
from workhold.geometry.segment import Arc

ROOT = Path(__file__).parents[3]
DRAWINGS = ROOT / "tests" / "data" / "drawings"


def test_vslot_2020() -> None:
    """A 20 x 20 mm extrusion profile of loose lines and arcs with a round bore, fourfold symmetrical."""
    loaded = read_workpiece(DRAWINGS / "vslot_2020.dxf")
    part = loaded.workpiece
    assert part.bounds == pytest.approx((-10, -10, 10, 10))
    assert len(part.loops) == 2
    assert len(part.segments) == 50
    assert len(part.loops[1]) == 2
    assert loaded.remarks == ()


def test_mc_12x31() -> None:
    """A steel channel MC 12 x 31 in inches: 12 in high, one LWPOLYLINE with bulged fillets, area near 9.12 in²."""
    part = load(DRAWINGS / "mc_12x31.dxf")
    x0, y0, x1, y1 = part.bounds
    assert (y1 - y0) / 25.4 == pytest.approx(12, abs=1e-6)
    assert (x1 - x0) / 25.4 == pytest.approx(3.67, abs=1e-6)
    assert area(part) / 25.4**2 == pytest.approx(9.12, abs=0.05)
    assert any(isinstance(segment, Arc) for segment in part.segments)


def test_motor_mount_plate() -> None:
    """A plate without a unit: refused until one is given; then 48 holes, and seven stray lines are reported."""
    path = DRAWINGS / "motor_mount_plate.dxf"
    with pytest.raises(
        InputError, match=r"unit is not said: it is 89\.998 mm wide, or 89\.998 in = 2,286 mm"
    ):
        load(path)
    loaded = read_workpiece(path, unit="mm")
    x0, y0, x1, y1 = loaded.workpiece.bounds
    assert (x1 - x0, y1 - y0) == pytest.approx((90, 157.734), abs=0.01)
    assert len(loaded.workpiece.loops) == 49
    assert loaded.remarks[0].startswith("Left out 7 open pieces outside any closed outline: LINE 104 from")


def test_bracket_example() -> None:
    """The example part: 120 x 70 mm, two holes and a slot; text and dimension are ignored, the centre line left out."""
    loaded = read_workpiece(ROOT / "examples" / "bracket.dxf")
    part = loaded.workpiece
    assert part.bounds == pytest.approx((0, 0, 120, 70))
    assert [len(loop) for loop in part.loops] == [9, 4, 2, 2]
    assert "1 DIMENSION, 1 TEXT" in loaded.remarks[0]
    assert "1 open piece" in loaded.remarks[1]
    outline = load(ROOT / "examples" / "bracket.dxf", layers=["outline"])
    assert area(outline) == area(part)
    holes = [loop_area(segments) for segments in part.loop_segments[1:]]
    assert sorted(holes) == pytest.approx([-360 - 25 * pi, -(6.5**2) * pi, -(4.5**2) * pi])


def test_brackets_outline_is_tangent_where_it_is_drawn_so() -> None:
    """Neighbours with a tangent joint: the end radius, both ends of the fillet and the corner radius."""
    part = load(ROOT / "examples" / "bracket.dxf")
    outline = part.loop_segments[0]
    smooth = 0
    for before, after in zip(outline, outline[1:] + outline[:1], strict=True):
        n, m = before.compute_normal(before.half_extent), after.compute_normal(-after.half_extent)
        if isinstance(before, Arc):
            n = before.compute_normal(before.sign * before.half_sweep)
        if isinstance(after, Arc):
            m = after.compute_normal(-after.sign * after.half_sweep)
        smooth += n == pytest.approx(m, abs=1e-7)
    assert smooth == 6


def test_the_script_draws_the_file_again(tmp_path: Path) -> None:
    """``make_bracket.py`` and ``bracket.dxf`` agree."""
    draw = runpy.run_path(str(ROOT / "examples" / "make_bracket.py"))["draw"]
    draw(tmp_path / "bracket.dxf")
    again, kept = load(tmp_path / "bracket.dxf"), load(ROOT / "examples" / "bracket.dxf")
    assert [loop.tolist() for loop in again.loops] == [loop.tolist() for loop in kept.loops]
