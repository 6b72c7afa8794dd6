"""The command ``straps``: its sentences, its tables and its JSON."""

from __future__ import annotations

import json
from typing import Any

import pytest

import workhold
from workhold import Plate, Workpiece
from workhold.files.result.writer import write_result

BLOCK = Workpiece.from_points("block", [(0, 0), (100, 0), (100, 60), (0, 60)])
LOADED = ("--thickness", "25", "--load", "force=300 at=50,30")


@pytest.fixture(scope="module")
def result_file(tmp_path_factory: Any) -> str:
    path = tmp_path_factory.mktemp("straps") / "block.json"
    plate = Plate(pitch=20, peg_radius=3, columns=8, rows=6, clamps=2)
    write_result(workhold.design(BLOCK, plate, best=1), path)
    return str(path)


@pytest.mark.thorough
def test_bolts_heels_push_and_force_are_said(run: Any, result_file: str) -> None:
    outcome = run("straps", result_file, "1", *LOADED, "--strap-force", "1000")
    assert outcome.exit_code == 0, outcome.stderr
    for words in (
        "Locators stand in A2, B1, F1",
        "heels 25.000 mm high",
        "Push the part by hand",
        "loads times 2",
    ):
        assert words in outcome.stdout
    assert "a strap is rated for 1000 N" in outcome.stderr


@pytest.mark.thorough
def test_json_has_what_the_tables_have(run: Any, result_file: str) -> None:
    outcome = run("straps", result_file, "1", *LOADED, "--friction", "tip=0.2,plate=0.2", "--json")
    found = json.loads(outcome.stdout)
    assert found["type"] == "strapped"
    assert len(found["straps"]) == 2
    assert len(found["pegs"]) == 3
    assert found["friction"] == {"tip": 0.2, "plate": 0.2}
    smoother = json.loads(run("straps", result_file, "1", *LOADED, "--json").stdout)
    assert found["quality"]["clamp_needed"] < smoother["quality"]["clamp_needed"]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--thickness", "25"), "give one load or more"),
        (LOADED[2:], "the thickness of the part is not known"),
        ((*LOADED, "--count", "5"), "give 1 to 4"),
        ((*LOADED, "--reach", "60:20"), "cannot reach"),
        ((*LOADED, "--friction", "ice=0.1"), "friction of 'ice' is not known"),
    ],
)
def test_what_cannot_be_is_refused_in_a_sentence(
    run: Any, result_file: str, words: tuple[str, ...], said: str
) -> None:
    outcome = run("straps", result_file, "1", *words)
    assert outcome.exit_code != 0
    assert said in " ".join(outcome.stderr.split())


SLOT = "G21 G90\nG0 X{x}. Y{y}. Z70.\nT1 M6\nZ5.\nG1 Z-{deep}. F200\nX70. F600\nG0 Z70.\nM30\n"
TOOLS = "tool.1 = {diameter = 10, flute_length = 30, stickout = 40, cutting_force = 180}\n"


def write_program(folder: Any, x: int = 30, deep: int = 3, y: int = 30) -> tuple[str, ...]:
    (folder / "p.nc").write_text(SLOT.format(x=x, deep=deep, y=y))
    (folder / "tools.toml").write_text(TOOLS)
    files = ("--program", str(folder / "p.nc"), "--tools", str(folder / "tools.toml"))
    return *files, "--start", f"{x},{y},70", "--thickness", "25"


@pytest.mark.thorough
def test_a_program_alone_loads_the_part(run: Any, result_file: str, tmp_path: Any) -> None:
    asked = ("straps", result_file, "1", *write_program(tmp_path))
    outcome = run(*asked, "--jaw-force", "1kN")
    words = " ".join(outcome.stdout.split())
    assert outcome.exit_code == 0, outcome.stderr
    assert "The program asks for" in words and "in line" in words and "its tools may press" in words
    assert "loads times 2" in words and "comes too near" not in outcome.stderr
    said = json.loads(run(*asked, "--json").stdout)
    assert said["program_force"]["force"] == pytest.approx(said["quality"]["clamp_needed"])


@pytest.mark.thorough
def test_supports_are_named_with_their_height(run: Any, result_file: str, tmp_path: Any) -> None:
    over = ("--over", "supports", "--support-height", "15", "--pad-radius", "5")
    outcome = run("straps", result_file, "1", *write_program(tmp_path), *over)
    words = " ".join(outcome.stdout.split())
    assert "the part lies on supports 15.000 mm high in" in words and "Set the heels 40.000 mm high" in words
    assert "between support and milled steel" in words
    kept_off = (*over, "--keep-out-below", "circle=50,30,20")
    fewer = run("straps", result_file, "1", *write_program(tmp_path), *kept_off)
    assert "holes under the part" in fewer.stdout and fewer.stdout != outcome.stdout


@pytest.mark.thorough
def test_a_locator_that_a_tool_hits_is_warned_of(run: Any, result_file: str, tmp_path: Any) -> None:
    """Its slot runs out over the side that a locator is at, deeper than the locator is high or not."""
    asked = ("straps", result_file, "1")
    deep = run(*asked, *write_program(tmp_path, -10, 12, 18), "--peg-height", "20")
    assert "a tool of the program comes too near to A2" in " ".join(deep.stderr.split())
    low = run(*asked, *write_program(tmp_path, -10, 12, 18), "--peg-height", "10")
    assert "comes too near" not in low.stderr


def test_options_of_a_program_want_one(run: Any, result_file: str) -> None:
    outcome = run("straps", result_file, "1", *LOADED, "--tools", "tools.toml")
    assert outcome.exit_code != 0 and "belongs to a program" in " ".join(outcome.stderr.split())
    outcome = run("straps", result_file, "1", *LOADED, "--over", "air")
    assert outcome.exit_code != 0


@pytest.mark.thorough
def test_heights_and_program_are_those_of_the_result(run: Any, tmp_path: Any) -> None:
    """A fixture that was designed with them asks for no more words."""
    from workhold import Program

    write_program(tmp_path)
    program = Program.read(tmp_path / "p.nc", tmp_path / "tools.toml", thickness=25, start=(30, 30, 70))
    plate = Plate(pitch=20, peg_radius=3, columns=8, rows=6, clamps=2)
    asked = {"program": program, "thickness": 25, "peg_height": 15, "best": 1}
    write_result(workhold.design(BLOCK, plate, **asked), tmp_path / "cut.json")
    outcome = run("straps", str(tmp_path / "cut.json"), "1")
    assert outcome.exit_code == 0, outcome.stderr
    assert "The program asks for" in " ".join(outcome.stdout.split())
