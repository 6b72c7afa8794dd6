"""What the commands say of a given force of the straps: how often it holds, and what is too little or too much."""

from __future__ import annotations

import json

import pytest

import workhold
from strap_program import read_slot_program
from workhold import Load, Plate, StrapPlate, Workpiece

BLOCK = Workpiece.from_points("block", [(0, 0), (100, 0), (100, 60), (0, 60)])
LOAD = Load(points=(50, 30), force=300, name="slot")


def held(**asked):
    asked = {"loads": [LOAD], "thickness": 25, "strapped": 1, "best": 1, **asked}
    return workhold.design(BLOCK, StrapPlate(20, 3, 8, 6, max_force=4000), **asked)


@pytest.mark.thorough
def test_words_of_command_and_sheet(run, tmp_path):
    """How often the force holds the loads, a warning where that is too little, and one beyond the rating."""
    path = str(tmp_path / "held.json")
    result = held(program=read_slot_program(tmp_path), peg_height=15, jaw_force=1000.0)
    workhold.save(result, path)
    shown = " ".join(run("show", path, "1").stdout.split())
    times = result[0].hold.safety_reached
    assert "times at 1000 N" in shown
    assert f"the loads and the tools may press {int(times * 100) / 100:.2f} times as hard as given" in shown
    assert (
        f"at each tip hold the loads and the tools {int(times * 100) / 100:.2f} times, and 2 times" in shown
    )
    of_program = int(result[0].hold.safety_each[-1] * 100) / 100
    assert f"its tools may press {of_program:.2f} times as hard" in shown
    sheet = tmp_path / "sheet.svg"
    assert run("sheet", path, "1", "-o", str(sheet)).exit_code == 0
    text = sheet.read_text()
    assert "With 1000 N at each tip" in text and "How many times each load is held" in text
    strong = held(jaw_force=5000.0)
    workhold.save(strong, path, overwrite=True)
    assert "5000 N are to be at each tip, and a strap is rated for 4000 N" in " ".join(
        run("show", path, "1").stdout.split()
    )


@pytest.mark.thorough
def test_words_of_the_command_straps(run, tmp_path):
    path = str(tmp_path / "clamped.json")
    workhold.save(workhold.design(BLOCK, Plate(20, 3, 8, 6, clamps=2), best=1), path)
    asked = ("straps", path, "1", "--thickness", "25", "--load", "force=300 at=50,30", "--jaw-force", "1kN")
    outcome = run(*asked)
    assert "times at 1000 N" in outcome.stdout and "2 times are asked for" in outcome.stderr
    said = json.loads(run(*asked, "--json").stdout)
    assert said["jaw_force"] == 1000.0
    assert said["quality"]["safety_reached_each"] == [pytest.approx(2000 / said["quality"]["clamp_needed"])]
