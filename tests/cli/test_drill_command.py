"""``workhold drill``: a drawing of the plates, and what it refuses."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import ezdxf
import pytest

GIVEN = ("drill", "--vise", "plate-20mm", "--rows", 5)


def test_a_vise_by_name_has_its_holes(run: Any, tmp_path: Path) -> None:
    """Three columns of five holes a jaw, as wide as the middle of what the vise says, 5.987 to 6.000 mm; bolts in inches."""
    path = tmp_path / "plates.dxf"
    options = ("--bolts", "10mm,10mm;10mm,70mm", "--bolt-diameter", "0.25", "--unit", "inch")
    for _ in range(2):
        outcome = run(*GIVEN, *options, "-o", path)
        assert outcome.exit_code == 0, outcome.stderr
    space = ezdxf.readfile(path).modelspace()
    radii = [round(circle.dxf.radius, 6) for circle in space.query('CIRCLE[layer=="DOWEL_HOLES"]')]
    assert radii == [round((5.987 + 6.0) / 4, 6)] * 30
    assert {round(c.dxf.radius, 6) for c in space.query('CIRCLE[layer=="BOLT_HOLES"]')} == {3.175}


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("-o", "a.pdf"), "names no drawing of plates"),
        (("-o", "a.dxf", "--bolts", "10,10"), "bolts need --bolts and --bolt-diameter"),
        (("-o", "a.dxf", "--bolts", "10", "--bolt-diameter", "5"), "--bolts '10' is no list of places"),
        (("-o", "a.dxf", "--bolts", "0,0", "--bolt-diameter", "5"), "runs into dowel hole L-A1"),
        (("-o", "a.dxf", "--edge", "-2"), "--edge '-2' is not above 0"),
    ],
)
def test_what_cannot_be_is_refused(
    run: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, options: tuple[str, ...], said: str
) -> None:
    """Names, places and lengths that make no plate; nothing is written."""
    monkeypatch.chdir(tmp_path)
    outcome = run(*GIVEN, *options)
    assert outcome.exit_code == 2 and said in outcome.stderr
    assert list(tmp_path.iterdir()) == []


def test_rows_have_to_be_given(run: Any) -> None:
    """A preset has as many as needed, a plate has not."""
    outcome = run("drill", "--vise", "plate-20mm", "-o", "a.dxf")
    assert outcome.exit_code == 2 and "add --columns and --rows" in outcome.stderr
