"""``workhold family`` in a plain vise: what it says, writes and refuses."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("scipy", reason="the extra [batch] is not installed")

VISE = ("--vise", "plain-vise-6-inch", "--stop", "left")
SIZES = {"low": (90, 40, 14), "high": (60, 30, 45), "wide": (300, 200, 20)}


@pytest.fixture(scope="module")
def shop(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of blocks, one of them too wide, and a file of jobs with their thicknesses."""
    folder = tmp_path_factory.mktemp("shop")
    lines = ['unit = "mm"']
    for name, (width, depth, thickness) in SIZES.items():
        loop = [[0, 0, 0], [width, 0, 0], [width, depth, 0], [0, depth, 0]]
        (folder / f"{name}.json").write_text(json.dumps({"name": name, "units": "mm", "loops": [loop]}))
        lines += ["[[job]]", f'part = "{name}.json"', f"thickness = {thickness}"]
    (folder / "jobs.toml").write_text("\n".join(lines))
    return folder


def test_jobs_have_their_own_thickness(
    run: Any, shop: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("workhold.cli.table.find_terminal_width", lambda stream: 80)
    out, sheets = tmp_path / "f.json", tmp_path / "f.svg"
    words = ("--setups", 2, "--out", out, "--sheets", sheets, "--draw", tmp_path / "c.svg")
    outcome = run("family", shop / "jobs.toml", *VISE, *words)
    assert outcome.exit_code == 0, outcome.stderr
    assert "wide.json is left out: it cannot be held in this vise: the part is wider" in outcome.stderr
    assert max(map(len, outcome.stdout.splitlines())) <= 80
    text = " ".join(outcome.stdout.split())
    assert "changes" in text and "pegs" not in text
    assert "The loss is the best grip that each part has in this vise, divided by the grip." in text
    assert "2 parts, 6 set-ups that hold at least one of them" in text
    assert "Set-up 1 of 2: parallels of 16 mm; stop: left end of the jaws, its tip" in text
    assert "(change the parallels, the stop stays)" in text
    data = json.loads(out.read_text())["family"]
    assert [[one["parallels"] for one in point["plan"]] for point in data["curve"]] == [[36.0], [16.0, 36.0]]
    assert "Set-up 2 of 2" in sheets.read_text() and "moving jaw" in sheets.read_text()


def test_one_thickness_for_drawings_and_a_limit(run: Any, shop: Path) -> None:
    words = (*VISE, "--thickness", "45", "--limit", "above=20", "--json")
    outcome = run("family", shop / "low.json", shop / "high.json", *words)
    assert outcome.exit_code == 0, outcome.stderr
    (first, *_) = json.loads(outcome.stdout)["family"]["curve"]
    assert all(one["above"] >= 20 for setup in first["plan"] for one in setup["parts"])


@pytest.mark.thorough
def test_programs_and_loads_of_jobs_count(run: Any, shop: Path, tmp_path: Path) -> None:
    """Part zero is where the program of the part has it."""
    program, tools, jobs = (tmp_path / name for name in ("slot.nc", "tools.toml", "jobs.toml"))
    program.write_text("G21 G90\nT1 M6\nG0 X20. Y0. Z5.\nG1 Z-2. F200\nX40. F600\nG0 Z20.\nM30\n")
    tools.write_text("tool.1 = {diameter = 10, flute_length = 30, stickout = 40, holder_diameter = 40}\n")
    jobs.write_text(
        f'unit = "mm"\ntools = "{tools}"\ncutting_force = 300\nthickness = 45\n'
        f'[[job]]\npart = "{shop / "high.json"}"\nprogram = "{program}"\nzero = "0,15"\n'
    )
    outcome = run("family", jobs, *VISE, "--json")
    assert outcome.exit_code == 0, outcome.stderr
    found = json.loads(outcome.stdout)["family"]
    assert found["figure"] == "clamp_needed" and found["parts"][0]["zero"] == [0, 15]
    both = run("family", jobs, *VISE, "--both-sides")
    assert both.exit_code == 2 and "its other side has a program of its own" in both.stderr


def test_what_pegs_do_not_take_is_refused(run: Any, shop: Path) -> None:
    pegs = ("--pitch", "10", "--columns", "1", "--peg-radius", "3")
    outcome = run("family", shop / "low.json", *pegs, "--thickness", "12")
    assert outcome.exit_code == 2 and "--thickness counts in a plain vise" in outcome.stderr
    outcome = run("family", shop / "jobs.toml", *pegs)
    assert outcome.exit_code == 2 and "names a program" in outcome.stderr
    outcome = run("family", shop / "low.json", *VISE, "--thickness", "14", "--limit", "tilt=1")
    assert outcome.exit_code == 2 and "no limit of tilt" in outcome.stderr


def test_the_other_side_is_another_member(run: Any, shop: Path) -> None:
    outcome = run("family", shop / "low.json", *VISE, "--thickness", "30", "--both-sides", "--json")
    assert outcome.exit_code == 0, outcome.stderr
    assert [one["name"] for one in json.loads(outcome.stdout)["family"]["parts"]] == [
        "low.json",
        "low.json, side 2",
    ]
