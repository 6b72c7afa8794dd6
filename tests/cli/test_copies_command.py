"""``workhold copies``: what it tells, draws and refuses."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import ezdxf
import pytest

from workhold import Plate, Query, Workpiece, answer, save
from workhold.family.copies import pack_copies

pytest.importorskip("scipy", reason="the extra [batch] is not installed")

BAR = Workpiece.from_loops("bar", [[[0, 0, 0], [50, 0, 0], [50, 28, 0], [0, 28, 0]]])


@pytest.mark.thorough
def test_copies_are_told_and_drawn_or_refused(run: Any, tmp_path: Path) -> None:
    result = answer(Query(BAR, Plate(pitch=20, peg_radius=3, clamps=2, travel=(10, 35)), best=3), threads=1)
    file, picture = tmp_path / "r.json", tmp_path / "p.png"
    save(result, file, "json")
    outcome = run("copies", file, 1, "--columns", 12, "--rows", 9, "--draw", picture)
    assert outcome.exit_code == 0, outcome.stderr
    packing = pack_copies(result[0], result.workpiece, result.toolkit, 12, 9)
    count = len(packing.shifts)
    assert f"{count} copies on a plate of 12 columns and 9 rows; no more fit" in outcome.stdout
    assert picture.read_bytes().startswith(b"\x89PNG")
    lines = outcome.stdout.splitlines()
    assert [line.split()[0] for line in lines[2 : 2 + count]] == [str(k + 1) for k in range(count)]
    data = json.loads(run("copies", file, 1, "--columns", 12, "--rows", 9, "--json").stdout)
    assert data["copies"] == data["at_most"] == count
    assert [(one["columns"], one["rows"]) for one in data["shifts"]] == list(packing.shifts)
    fewer = json.loads(run("copies", file, 1, "--columns", 12, "--rows", 9, "--gap", "19mm", "--json").stdout)
    assert fewer["copies"] < count
    for arguments, message in (
        ((file, 1, "--columns", 12), "how large the plate is, is not known: give --rows"),
        ((file, 1, "--columns", 12, "--rows", 9, "--gap", "-1"), "is negative"),
        ((file, 1, "--columns", 2, "--rows", 9), "does not hold this fixture once"),
        ((file, 9, "--columns", 12, "--rows", 9), "there is no fixture 9"),
        ((file, 1, "--columns", 12, "--rows", 9, "--draw", "p.pdf"), "let the name end in .svg or .png"),
        ((file, 1, "--columns", 99999, "--rows", 99999), "holes"),
    ):
        outcome = run("copies", *arguments)
        assert outcome.exit_code == 2 and message in outcome.stderr, outcome.stderr


# ``workhold drill``: a drawing of the plates, and what it refuses.
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
        (("-o", "a.dxf", "--bolts", "10", "--bolt-diameter", "5"), "--bolts '10' is not a list of places"),
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
