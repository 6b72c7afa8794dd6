"""A program on the command line reaches the search with its heights, and what is missing is asked for."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from workhold.model.setup import choose_part_zero

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
    assert query.rank_by[1] == "program_clearance"


@pytest.mark.thorough
@pytest.mark.parametrize("place", ["corner", "centre", "hole 1"])
def test_its_zero_is_named_as_on_the_sheet(
    run: Any, searched: dict[str, Any], file: Path, place: str
) -> None:
    outcome = run("design", BRACKET, *HELD, "--program", file, "--thickness", "10", "--zero", place)
    assert outcome.exit_code == 0, outcome.stderr
    query = searched["asked"]
    assert query.program.zero == choose_part_zero(query.workpiece, place).point


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
        (["--thickness", "10", "--start", "3,4"], "--start '3,4' is not a place: give three lengths"),
        (["--thickness", "10", "--whole-numbers", "tenths"], "--whole-numbers"),
        (["--thickness", "10", "--program-clearance", "-1"], "clearance"),
    ],
)
def test_what_is_missing_is_asked_for(
    run: Any, searched: dict[str, Any], file: Path, words: list[str], said: str
) -> None:
    outcome = run("design", "widget", *HELD, "--program", file, *words)
    assert outcome.exit_code == 2 and said in outcome.stderr and searched["asked"] is None


def test_a_start_and_thousandths_reach_the_program(run: Any, searched: dict[str, Any], file: Path) -> None:
    """Where the command asks for them it names its own options, and so does a file of jobs."""
    file.write_text("(T1 D=6 - mill)\nG21 G90\nT1 M6\nG0 Z5.\nG1 Z-4. F200\nX30\nG0 Z5.\nM30\n")
    words = ["--program", file, "--thickness", "10"]
    refused = run("design", "widget", *HELD, *words)
    assert refused.exit_code == 2 and "line 5: the tool cuts at a place" in refused.stderr
    assert "give where the tip is at the start with --start X,Y,Z." in refused.stderr
    assert "--start X,Y,Z" in run("program", file).stderr
    for more, end in (([], 30.0), (["--whole-numbers", "thousandths"], 0.03)):
        outcome = run("design", "widget", *HELD, *words, "--start", "-10,-1cm,5", *more)
        assert outcome.exit_code == 0, outcome.stderr
        moves = searched["asked"].program.moves
        assert moves.start[0].tolist() == [-10.0, -10.0, 15.0] and moves.end[1, 0] == pytest.approx(end)
    said = run("program", file, "--start", "-10,-1cm,5", "--whole-numbers", "thousandths").stdout
    assert (
        "The tip starts at X-10 Y-10 Z5 mm, as given." in said and "multiples of 0.001 mm, as asked" in said
    )


def test_words_about_no_program_are_refused(run: Any, searched: dict[str, Any]) -> None:
    outcome = run("design", "widget", *HELD, "--zero", "3,4")
    assert outcome.exit_code == 2 and "--zero belongs to a program" in outcome.stderr
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


@pytest.mark.thorough
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


FORCES = ("--material", "aluminium", "--teeth", "2", "--cut-depth", "3")


@pytest.mark.thorough
def test_forces_reach_the_table_the_sentences_and_the_sheet(run: Any, file: Path, tmp_path: Path) -> None:
    file.write_text(PROGRAM.replace("T1 M6", "T1 M6 S3000"))
    out, sheet = tmp_path / "widget.json", tmp_path / "widget.svg"
    words = ["--program", file, "--thickness", "10", "--best", "3", "--threads", "1", "--out", out]
    designed = run("design", "widget", *HELD, *words, *FORCES, "--sheet", sheet)
    assert designed.exit_code == 0, designed.stderr
    assert "jaw force needed N" in designed.stdout and "load reaction N" in designed.stdout
    entry = json.loads(out.read_text())["fixtures"][0]["program_forces"]
    assert entry["jaw_force"] == entry["jaw"]["force"] > 0 and entry["room"] is None
    shown = run("show", out, "1")
    assert f"asked for by line {entry['jaw']['line']}, T1 (flat end mill, milling from X" in shown.stdout
    assert " mm): with less the part leaves" in shown.stdout
    text = " ".join(sheet.read_text().split())
    assert "Jaw force at least" in text
    given = run("show", out, "1", "--jaw-force", "9000", "--jaw", "constant")
    assert "The 9000 N given leave" in given.stdout and "With 9000 N peg" in given.stdout
    little = run("show", out, "1", "--jaw-force", "1", "--json")
    need = json.loads(little.stdout)["program_forces"]
    assert need["jaw"] == entry["jaw"] and need["room"] == pytest.approx(1 - entry["jaw"]["force"])


def test_forces_rank_where_they_are_asked_for(
    run: Any, searched: dict[str, Any], file: Path, tmp_path: Path
) -> None:
    tools = tmp_path / "tools.toml"
    tools.write_text("tool.1 = {diameter = 6, cutting_force = 120}\n")
    words = ["--program", file, "--thickness", "10"]
    for more in (["--tools", tools], ["--power", "2hp"], FORCES):
        outcome = run("design", "widget", *HELD, *words, *more, "--prefer", "strong")
        if "--power" in more:
            assert outcome.exit_code == 2 and "does not say the spindle's speed, S" in outcome.stderr
            continue
        if more is FORCES:
            assert outcome.exit_code == 2 and "spindle's speed, S" in outcome.stderr
            continue
        assert outcome.exit_code == 0, outcome.stderr
        assert searched["asked"].rank_by[1] == "load_reaction"
    bare = run("design", "widget", *HELD, *words, "--rank-by", "jaw-force-needed")
    assert bare.exit_code == 2 and "there is no load to rank by" in bare.stderr


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--material", "butter"], "the material 'butter' is not known"),
        (["--power", "much"], "--power 'much' is not a power above 0"),
        (["--power", "2", "--material", "steel"], "power and material are two ways to the same force"),
        (["--cutting-force", "-3"], "--cutting-force"),
        (["--cutting-force", "3", "--stock", "ball"], "--stock 'ball' is not known: give outline or block"),
        (
            ["--cutting-force", "3", "--stock", "block,5"],
            "--stock '5' is not the stock: give outline or block",
        ),
        (["--teeth", "2.5"], "--teeth"),
        (["--cutting-force", "90", "--cutting-direction", "up"], "--cutting-direction 'up' is not known"),
    ],
)
def test_words_about_forces_that_mean_nothing_are_refused(
    run: Any, file: Path, words: list[str], said: str
) -> None:
    outcome = run("design", "widget", *HELD, "--program", file, "--thickness", "10", *words)
    assert outcome.exit_code == 2 and said in outcome.stderr
    read = run("program", file, *words)
    assert read.exit_code == 2 and said in read.stderr


def test_the_program_command_states_forces_of_tools(run: Any, file: Path) -> None:
    said = run("program", file, "--cutting-force", "0.2kN")
    assert said.exit_code == 0 and "T1: up to 200 N as given." in said.stdout
    data = json.loads(run("program", file, "--cutting-force", "200", "--json").stdout)["cutting"]
    assert data == [{"tool": 1, "force": 200.0, "torque": 600.0, "axial": [pytest.approx(-115.47), 200.0]}]
    assert "with 5.000 mm around" in said.stdout
    bare = run("program", file, "--cutting-force", "200", "--stock", "block,0,2in")
    assert "the block around the part with 0.000 mm around" in bare.stdout
    assert "cutting" not in json.loads(run("program", file, "--json").stdout)
