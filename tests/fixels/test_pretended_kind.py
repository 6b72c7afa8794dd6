"""A kind of toolkit that is nothing but data does whatever the others do, with no line of code elsewhere."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import workhold

SCRIPT, SOURCES = Path(__file__).parent / "pretended_kind.py", Path(workhold.__file__).parents[1]
WEDGE = [[[0, 0, 0], [41, 0, 0], [13, 37, 0]]]


@pytest.fixture(scope="module")
def outcomes(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Any]]:
    """The folder of what was written, and the exit code and words of each command."""
    folder = tmp_path_factory.mktemp("press")
    (folder / "parts").mkdir()
    content = json.dumps({"name": "wedge", "units": "mm", "loops": WEDGE})
    for path in (folder / "wedge.json", folder / "parts" / "wedge.json"):
        path.write_text(content)
    (folder / "press.toml").write_text('unit = "mm"\nkind = "press"\npitch = 15\npeg_radius = 2\n')
    done = subprocess.run(
        [sys.executable, str(SCRIPT), "wedge.json"],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(SOURCES)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    return folder, json.loads(done.stdout)


@pytest.mark.thorough
def test_every_command_takes_it(outcomes: tuple[Path, dict[str, Any]]) -> None:
    """Each ends as it does for a vise, without a fault."""
    for name, (code, words) in outcomes[1].items():
        assert code == 0, (name, words)
        assert "a mistake of workhold" not in words, words


@pytest.mark.thorough
def test_its_files_are_written_and_say_the_same(outcomes: tuple[Path, dict[str, Any]]) -> None:
    """The result in columns is the result; sheet, set-up and pins are there."""
    folder = outcomes[0]
    result = json.loads((folder / "r.json").read_text())
    assert result["toolkit"] == {"kind": "press", "pitch": [15.0, 15.0], "peg_radius": 2.0, "min_gap": 15.0}
    assert len(result["fixtures"]) > 0 and {peg["jaw"] for peg in result["fixtures"][0]["pegs"]} == {
        "bed",
        "ram",
    }
    assert (folder / "again.json").read_bytes() == (folder / "r.json").read_bytes()
    assert (folder / "sheet.pdf").read_bytes().startswith(b"%PDF")
    assert b"BED" in (folder / "set-up.dxf").read_bytes() and "B-" in (folder / "pins.csv").read_text()
    few = json.loads((folder / "few.json").read_text())
    assert few["fixtures"] == result["fixtures"][:3]


@pytest.mark.thorough
def test_its_fixtures_are_those_of_a_vise_of_that_type(outcomes: tuple[Path, dict[str, Any]]) -> None:
    """Three pegs on one jaw and one on the other, of two columns each."""
    vise = workhold.Vise(pitch=15, columns=2, peg_radius=2)
    same = workhold.design(workhold.Workpiece.from_loops("wedge", WEDGE), vise, types="II")
    listed = json.loads((outcomes[0] / "r.json").read_text())["fixtures"]
    poses = sorted([round(v, 6) for v in fixture["pose"].values()] for fixture in listed)
    expected = sorted([round(f.pose.theta_deg, 6), round(f.pose.x, 6), round(f.pose.y, 6)] for f in same)
    assert len(poses) == len(expected) > 0
    for one, other in zip(poses, expected, strict=True):
        assert one == pytest.approx(other, abs=1e-5)


@pytest.mark.thorough
def test_its_own_words_are_told(outcomes: tuple[Path, dict[str, Any]]) -> None:
    """On the terminal, the page and in the schema."""
    told = {name: words for name, (_, words) in outcomes[1].items()}
    assert "bed" in told["show"].lower() or "B-" in told["show"]
    (page,) = json.loads(told["page"])
    assert page["title"] == "Press" and page["closes"] == "Close press"
    assert {field["name"] for field in page["fields"]} == {"pitch", "peg_radius", "min_gap"}
    assert "A press with pegs on its bed and its ram" in told["schema"]
    assert (
        told["request"].startswith("Press(") and "No fixture exists for wedge in this press" in told["none"]
    )
