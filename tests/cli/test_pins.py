"""The terminal says how far pegs bend, and asks which height is meant where numbers depend on it."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

PART = {"name": "square", "units": "mm", "loops": [[[-17, -17, 0], [17, -17, 0], [17, 17, 0], [-17, 17, 0]]]}
HELD = ("--pitch", "10", "--columns", "2", "--peg-radius", "3", "--best", "2")


@pytest.fixture
def part(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    monkeypatch.chdir(tmp_path)
    Path("square.json").write_text(json.dumps(PART))
    return "square.json"


def test_a_drawing_takes_a_thickness_and_a_height_of_the_pegs_without_a_program(run: Any, part: str) -> None:
    """The lower of the two is what pegs press up to; `show` says it peg by peg, and beside the location error."""
    asked = ("--thickness", "90", "--peg-height", "76", "--jaw-force", "500")
    assert run("design", part, *HELD, *asked, "--out", "r.json").exit_code == 0
    head = json.loads(Path("r.json").read_text())
    assert (head["thickness"], head["peg_height"]) == (90.0, 76.0)
    shown = run("show", "r.json", 1).stdout
    for words in (
        "pin deflection",
        "How far the peg that bends most gives way, at a jaw force of 500 N.",
        "Pegs bend as follows, at a jaw force of 500 N, if they are built in at the plate; "
        "in a real hole they give way more:",
        "38.00",
        "on top of its location error of",
        "Beware: ",
        "more than the 421 MPa that a pin should take",
    ):
        assert words in shown, words
    data = json.loads(run("show", "r.json", 1, "--json").stdout)
    assert {peg["height"] for peg in data["pins"]["pegs"]} == {38.0}
    assert data["pins"]["movement"] == pytest.approx(data["fixture"]["quality"]["pin_movement"], rel=1e-6)
    assert json.loads(run("show", "r.json", 1, "--json", "--jaw-force", "1000").stdout)["pins"][
        "movement"
    ] == pytest.approx(2 * data["pins"]["movement"])
    assert run("verify", "r.json").exit_code == 0


def test_without_a_force_it_is_said_to_be_for_each_kn(run: Any, part: str) -> None:
    assert run("design", part, *HELD, "--peg-height", "10", "--out", "r.json").exit_code == 0
    shown = run("show", "r.json", 1).stdout
    assert "gives way, for each kN of jaw force." in shown
    assert "Pegs bend as follows, for each kN of jaw force, if they are built in at the plate" in shown
    assert "Beware" not in shown
    inches = run("show", "r.json", 1, "--unit", "inch").stdout
    assert "gives way, for each 225 lbf (1000 N) of jaw force." in inches and "kN" not in inches


def test_loads_act_at_the_force_of_the_result_in_its_unit(run: Any, part: str) -> None:
    """As on the sheet: what closes it is known, and forces are pounds with inches, with newtons in sentences."""
    load = ("--load", "force=100 at=10,5")
    assert run("design", part, *HELD, *load, "--jaw-force", "900", "--out", "r.json").exit_code == 0
    shown = run("show", "r.json", 1, "--friction", "0.1").stdout
    assert "Forces on the part at a jaw force of 900 N:" in shown and "jaw force needed N" in shown
    assert "at a jaw force of 500 N:" in run("show", "r.json", 1, "--jaw-force", "500").stdout
    inches = run("show", "r.json", 1, "--friction", "0.1", "--unit", "inch").stdout
    assert "Forces on the part at a jaw force of 202 lbf (900 N):" in inches
    assert "jaw force needed lbf" in inches and "needed with friction lbf" in inches
    needed = [
        row.split() for words in (shown, inches) for row in words.splitlines() if row.startswith("load 1")
    ]
    assert float(needed[0][2]) == pytest.approx(float(needed[2][2]) * 4.4482, abs=0.3)
    assert not re.search(r"\bN\b(?!\))", inches)


def test_without_heights_nothing_is_said(run: Any, part: str) -> None:
    assert run("design", part, *HELD, "--jaw-force", "500", "--out", "r.json").exit_code == 0
    assert "bend" not in run("show", "r.json", 1).stdout
    assert "thickness" not in json.loads(Path("r.json").read_text())


def test_the_sheet_names_a_dowel_that_is_sold(run: Any, part: str) -> None:
    """Of 6 mm, 20 long for pegs of 11 mm; in a vise of inches by inches."""
    asked = ("--thickness", "30", "--peg-height", "11", "--jaw-force", "500", "--out", "r.json")
    assert run("design", part, *HELD, *asked).exit_code == 0
    assert run("sheet", "r.json", 1, "-o", "a.svg").exit_code == 0
    text = "".join(path.read_text() for path in sorted(Path().glob("a*.svg")))
    for words in (
        "pegs: dowels of",
        "6 × 20 mm",
        "each sits in the jaw",
        "9.000 mm",
        "11.000 mm",
        "Pegs bend",
    ):
        assert words in text, words


@pytest.mark.thorough
def test_numbers_of_faces_are_asked_about(run: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A stepped solid has other numbers with other pegs: both heights are named, and either is taken."""
    pytest.importorskip("OCP", reason="the extra 'step' is not installed")
    from OCP.STEPControl import STEPControl_StepModelType, STEPControl_Writer

    from solid_examples import stepped

    monkeypatch.chdir(tmp_path)
    writer = STEPControl_Writer()
    writer.Transfer(stepped(), STEPControl_StepModelType.STEPControl_AsIs)
    writer.Write("part.step")
    asked = ("design", "part.step", "--toolkit", "clamp-plate-20mm", "--best", "1", "--avoid", "0")
    refused = run(*asked)
    assert refused.exit_code == 2
    assert "face 0 is named by number" in refused.stderr
    heights = [word for word in refused.stderr.replace(",", " ").split() if word.endswith("mm")]
    assert len(set(heights)) >= 2
    assert run(*asked, "--peg-height", heights[-1]).exit_code == 0
    features = run("features", "part.step", "--toolkit", "clamp-plate-20mm")
    assert features.exit_code == 0 and "stand out" in features.stderr
