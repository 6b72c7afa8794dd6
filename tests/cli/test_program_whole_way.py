"""From drawing and program to a sheet: the first choice lets every tool of the bracket pass, and says how near they come."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import workhold
from slow_program import OFF, walked
from workhold import Program

pytestmark = pytest.mark.thorough

EXAMPLES = Path(__file__).parents[2] / "examples"
PEG_HEIGHT = 6.0


def least_distance(program: Program, pegs: np.ndarray, radius: float) -> float:
    """The least distance of a tool from a peg on a walk along a program, 0.02 mm fine."""
    places, numbers = walked(program)
    found = np.inf
    for number, tool in program.tools.items():
        mine = places[program.moves.tool[numbers] == number]
        for cylinder in tool.cylinders:
            there = mine[mine[:, 2] + cylinder.low <= PEG_HEIGHT, :2]
            for x, y in pegs:
                away = np.hypot(there[:, 0] - x, there[:, 1] - y).min(initial=np.inf)
                found = min(found, float(away) - cylinder.radius - radius)
    return found


def test_the_first_choice_lets_every_tool_pass(run: Any, tmp_path: Path) -> None:
    """A contour, a slot, a bore and four holes: a sheet with the path of each tool, and a walk that meets no peg."""
    result, sheet = tmp_path / "bracket.json", tmp_path / "bracket.svg"
    asked = ("--program", EXAMPLES / "bracket.nc", "--tools", EXAMPLES / "tools.toml", "--thickness", "12")
    held = ("--pitch", "10", "--columns", "2", "--peg-radius", "3", "--peg-height", PEG_HEIGHT)
    ways = ("--out", result, "--sheet", sheet)
    outcome = run("design", EXAMPLES / "bracket.dxf", *held, *asked, *ways)
    assert outcome.exit_code == 0, outcome.stderr
    found = workhold.open(result)
    best, program = found[0], found.query.program
    assert program is not None and sorted(program.tools) == [1, 2, 3]
    x, y = best.pose.inverse.apply(*np.array([(peg.x, peg.y) for peg in best.pegs]).T)
    near = least_distance(program, np.stack([x, y], axis=1), 3.0)
    assert near >= program.clearance - OFF
    assert best.quality["program_clearance"] == pytest.approx(near, abs=OFF)
    root = ET.fromstring(sheet.read_text(encoding="utf-8"))
    words = [one.text or "" for one in root.iter() if one.tag.endswith("text")]
    assert {"bracket.nc", "T1", "T2", "T3"} <= set(words)
    assert any(f"T2: {best.quality['program_clearance']:.3f} mm" in word for word in words)
    drawn = {one.get("class") for one in root.iter()}
    assert {"band", "rapid", "cut-1", "cut-2", "cut-3", "nearest"} <= drawn


def test_holes_drilled_through_are_no_place_for_supports(run: Any, tmp_path: Path) -> None:
    """With --supports the drill's four holes and the clamp's keep-outs are those of the program, also in the file."""
    result, supports = tmp_path / "bracket.json", tmp_path / "supports.json"
    asked = ("--program", EXAMPLES / "bracket.nc", "--tools", EXAMPLES / "tools.toml", "--thickness", "12")
    held = ("--pitch", "10", "--columns", "2", "--peg-radius", "3", "--peg-height", PEG_HEIGHT, "--best", "3")
    outcome = run("design", EXAMPLES / "bracket.dxf", *held, *asked, "--supports", "--out", result)
    assert outcome.exit_code == 0, outcome.stderr
    outcome = run("supports", result, "1", "--thickness", "12", "--out", supports)
    assert outcome.exit_code == 0, outcome.stderr
    from workhold.files.supports_file import read_supports

    found = read_supports(supports)
    assert found.triples and len(found.request.bottom_zones) >= 4
    holes = np.array([(16, 54), (24, 19), (60, 19), (102, 18)])
    for triple in found.triples:
        for pad in triple.supports:
            away = np.hypot(holes[:, 0] - pad.x, holes[:, 1] - pad.y)
            assert away.min() >= 4.5 + 1.0 + found.request.pad_radius - 1e-6


def test_what_is_skipped_for_too_much_work_is_said(
    run: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Past a limit of places the table ends, and one line says under which fixtures was not looked."""
    asked = ("design", EXAMPLES / "bracket.dxf", "--vise", "plate-20mm", "--thickness", "12", "--best", 5)
    whole = run(*asked, "--supports", "--out", tmp_path / "a.json").stdout
    assert "looking was stopped" not in whole
    monkeypatch.setattr("workhold.cli.support_words.MOST_PLACES", 1)
    cut = run(*asked, "--supports", "--out", tmp_path / "b.json").stdout
    assert "the search stopped after 1: under 2 it did not look at all sets, and under 3 to 5 at none." in cut
