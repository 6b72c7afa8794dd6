"""A program on the command line reaches the search with its heights, and what is missing is asked for."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from workhold.model.setup import part_zero

BRACKET = str(Path(__file__).parents[2] / "examples" / "bracket.dxf")
HELD = ("--pitch", "8", "--columns", "2", "--peg-radius", "3")
PROGRAM = """(T1 D=6 - flat end mill)
G21 G90 G17
T1 M6
G0 X-10 Y-10 Z5
G0 X-6 Y-6
G1 Z-4 F200
G1 X30 F600
G2 X33 Y-3 I0 J3
G1 Y20
G0 Z5
M30
"""


@pytest.fixture
def file(tmp_path: Path) -> Path:
    """A program with its tool in a comment."""
    path = tmp_path / "plate.nc"
    path.write_text(PROGRAM)
    return path


def test_the_program_reaches_the_search_as_it_was_typed(
    run: Any, searched: dict[str, Any], file: Path, tmp_path: Path
) -> None:
    tools = tmp_path / "tools.csv"
    tools.write_text("tool,diameter\n1,12\n")
    words = ["--program", file, "--thickness", "10", "--tools", tools, "--zero", "1,2", "--rapid", "box"]
    outcome = run("design", "widget", *HELD, *words, "--program-clearance", "2.5", "--prefer", "roomy")
    assert outcome.exit_code == 0, outcome.stderr
    query = searched["asked"]
    assert (query.program.zero, query.program.rapid, query.program.clearance) == ((1.0, 2.0), "box", 2.5)
    assert query.program.z_zero == query.peg_height == 10.0
    assert query.program.tools[1].diameter == 12.0
    assert query.ranking[1] == "program_clearance"


@pytest.mark.parametrize("place", ["corner", "centre", "hole 1"])
def test_its_zero_is_named_as_on_the_sheet(
    run: Any, searched: dict[str, Any], file: Path, place: str
) -> None:
    outcome = run("design", BRACKET, *HELD, "--program", file, "--thickness", "10", "--zero", place)
    assert outcome.exit_code == 0, outcome.stderr
    query = searched["asked"]
    assert query.program.zero == part_zero(query.workpiece, place).point


@pytest.mark.parametrize(
    ("words", "heights"),
    [
        (["--thickness", "12", "--peg-height", "8"], (12.0, 8.0)),
        (["--peg-height", "8", "--z-zero", "bottom"], (0.0, 8.0)),
        (["--thickness", "12", "--z-zero", "3.5"], (3.5, 12.0)),
        (["--thickness", "0.5", "--unit", "inch"], (12.7, 12.7)),
    ],
)
def test_heights_are_those_that_were_given(
    run: Any, searched: dict[str, Any], file: Path, words: list[str], heights: tuple[float, float]
) -> None:
    outcome = run("design", "widget", *HELD, "--program", file, *words)
    assert outcome.exit_code == 0, outcome.stderr
    query = searched["asked"]
    assert (query.program.z_zero, query.peg_height) == pytest.approx(heights)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], "give its --thickness, and --peg-height where pegs are not as high"),
        (["--peg-height", "8"], "give its --thickness"),
        (["--thickness", "10", "--rapid", "bent"], "--rapid"),
        (["--thickness", "10", "--zero", "3"], "--zero '3' is not a place here"),
        (["--thickness", "10", "--program-clearance", "-1"], "clearance"),
    ],
)
def test_what_is_missing_is_asked_for(
    run: Any, searched: dict[str, Any], file: Path, words: list[str], said: str
) -> None:
    outcome = run("design", "widget", *HELD, "--program", file, *words)
    assert outcome.exit_code == 2 and said in outcome.stderr and searched["asked"] is None


def test_words_about_no_program_are_refused(run: Any, searched: dict[str, Any]) -> None:
    outcome = run("design", "widget", *HELD, "--zero", "3,4")
    assert outcome.exit_code == 2 and "--zero says something of a program" in outcome.stderr
    ranked = run("design", "widget", *HELD, "--rank-by", "program-clearance")
    assert ranked.exit_code == 2 and "there is no program to rank by" in ranked.stderr


def test_show_says_what_comes_nearest(run: Any, file: Path, tmp_path: Path) -> None:
    out = tmp_path / "widget.json"
    words = ["--program", file, "--thickness", "10", "--best", "3", "--threads", "1", "--out", out]
    designed = run("design", "widget", *HELD, *words)
    assert designed.exit_code == 0, designed.stderr
    assert "program clearance mm" in designed.stdout
    entry = json.loads(out.read_text())["fixtures"][0]["program_clearance"]
    shown = run("show", out, "1")
    assert f"keep {entry['distance']:.3f} mm from all that holds the part" in shown.stdout
    assert f"T1 comes nearest in line {entry['line']}, to the {entry['element']}." in shown.stdout
    said = json.loads(run("show", out, "1", "--json").stdout)
    assert said["program_clearance"].pop("distance") == pytest.approx(entry.pop("distance"), rel=1e-9)
    assert said["program_clearance"] == entry


def test_explore_and_batch_take_a_program(run: Any, file: Path, tmp_path: Path) -> None:
    words = ["--program", file, "--thickness", "10"]
    table = run("explore", "widget", *HELD, *words, "--prefer", "roomy")
    free = run("explore", "widget", *HELD)
    assert table.exit_code == 0 and "program clearance" in table.stdout and "program" not in free.stdout
    jobs = tmp_path / "jobs.toml"
    jobs.write_text(
        'toolkit = "plate-20mm"\nthickness = "10"\n'
        '[[job]]\npart = "widget"\nprogram = "plate.nc"\n[[job]]\npart = "widget"\n'
    )
    outcome = run("batch", jobs, "--out", tmp_path / "out", "--workers", "1")
    assert outcome.exit_code == 0, outcome.stderr
    records = [path.read_text() for path in (tmp_path / "out" / "work").rglob("*") if path.is_file()]
    passed = [text for text in records if '"program_clearance"' in text]
    assert len(passed) == 1 and '"peg_height": 10.0' in passed[0]
