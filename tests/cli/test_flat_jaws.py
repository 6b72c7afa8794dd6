"""A plain vise at the commands for many parts and many toolkits: compared where it can be, refused in a sentence."""

from __future__ import annotations

import json
from math import floor
from pathlib import Path
from typing import Any

import pytest

import workhold

EXAMPLES = Path(__file__).parents[2] / "examples"
RECTANGLE, BRACKET = (str(EXAMPLES / name) for name in ("rectangle.dxf", "bracket.dxf"))


def test_plain_vises_are_compared_by_their_own_figures(run: Any) -> None:
    """The first choice is one of them, with the area that its jaws touch."""
    outcome = run("explore", RECTANGLE, "--toolkit", "plain-vise")
    assert outcome.exit_code == 0, outcome.stderr
    assert "contact area" in outcome.stdout
    assert "First choice: plain-vise-" in outcome.stdout
    assert "its first fixture has contact area" in outcome.stdout


@pytest.mark.thorough
def test_a_batch_has_plain_vises_beside_others(run: Any, tmp_path: Any) -> None:
    """Their rows have no holes, and the faces that both jaws touch."""
    folder = tmp_path / "all"
    words = ("--toolkit", "plain-vise-6-inch,table-50mm", "--out", str(folder))
    outcome = run("batch", RECTANGLE, *words)
    assert outcome.exit_code == 0, outcome.stderr
    assert "2 jobs" in outcome.stdout + outcome.stderr


@pytest.mark.parametrize(
    ("command", "message"),
    [
        ("family", "rectangle.dxf: how thick it is decides which parallels it stands on: give --thickness"),
        ("copies", "a plain vise holds one part"),
        ("seat", "the seating is worked out only for round pegs"),
    ],
)
def test_what_is_of_pegs_is_refused_in_a_sentence(
    command: str, message: str, run: Any, tmp_path: Any
) -> None:
    if command == "family":
        outcome = run(command, RECTANGLE, BRACKET, "--toolkit", "plain-vise-6-inch")
    else:
        path = tmp_path / "result.json"
        made = run("design", RECTANGLE, "--toolkit", "plain-vise-6-inch", "--out", str(path))
        assert made.exit_code == 0, made.stderr
        more = ("--columns", "5", "--rows", "5") if command == "copies" else ()
        outcome = run(command, str(path), "1", *more)
    assert outcome.exit_code == 2
    assert message in outcome.stderr


@pytest.mark.thorough
def test_a_program_s_forces_are_told_with_their_line(run: Any, tmp_path: Path) -> None:
    """The table has the force, and the fixture says which line asks for it."""
    program, tools, path = (tmp_path / name for name in ("slot.nc", "tools.toml", "r.json"))
    program.write_text("G21 G90\nT1 M6\nG0 X20. Y20. Z5.\nG1 Z-3. F200\nX60. F600\nG0 Z20.\nM30\n")
    tools.write_text("tool.1 = {diameter = 10, flute_length = 30, stickout = 40, holder_diameter = 40}\n")
    words = ("--thickness", "25", "--program", program, "--tools", tools, "--cutting-force", "400")
    made = run("design", RECTANGLE, "--toolkit", "plain-vise-6-inch", *words, "--out", path)
    assert made.exit_code == 0, made.stderr
    assert "clamp needed N" in made.stdout and "Friction of the jaws" in made.stdout
    shown = run("show", path, "1")
    assert "The program asks for a jaw force of" in shown.stdout
    assert "in line 5, T1 (milling from" in shown.stdout
    assert run("sheet", path, "1", "-o", tmp_path / "sheet.pdf").exit_code == 0
    # A force of one's own, and how often it holds the load and the tools.
    own = ("--jaw-force", "9kN", "--load", "name=end force=500 at=40,20", "--force")
    made = run("design", RECTANGLE, "--toolkit", "plain-vise-6-inch", *words, *own, "--out", path)
    assert made.exit_code == 0, made.stderr
    hold = workhold.open(path)[0].hold
    shown = run("show", path, "1").stdout
    times = [f"{floor(2 * 9000 / need * 100) / 100:.2f}" for need in hold.forces_needed]
    assert "times at 9000 N" in shown and times[0] in shown
    assert f"Closed with 9000 N, its tools may press {times[1]} times as hard." in shown


def test_raw_block_goes_from_the_command_to_the_sheet(run: Any, tmp_path: Any) -> None:
    """Its margins may carry a unit; show, verify and the sheet read the block back."""
    out, sheet = str(tmp_path / "raw.json"), str(tmp_path / "raw.svg")
    words = (
        "--toolkit",
        "plain-vise-6-inch",
        "--thickness",
        "12",
        "--stop",
        "left",
        "--raw",
        "side=3,bottom=0.5in",
    )
    outcome = run("design", RECTANGLE, *words, "--out", out, "--sheet", sheet)
    assert outcome.exit_code == 0, outcome.stderr
    assert "the jaws stay below the part" in outcome.stdout
    shown = run("show", out, "1").stdout
    assert "nothing on top, 12.7 mm below" in shown and "Put the raw block in" in shown
    assert "0 refuted, 0 undecided" in run("verify", out).stdout
    told = json.loads(run("design", RECTANGLE, *words, "--json").stdout)
    assert told["raw"] == {"side": 3.0, "top": 0.0, "bottom": 12.7}
    text = Path(sheet).read_text()
    for said in ("Raw block", "x right of the work stop", "Z0 above the parallels", 'class="finished"'):
        assert said in text


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--raw", "3"), "is not a raw block: say each once, as in side=3,top=2,bottom=5"),
        (("--raw", "side=3,side=2"), "is not a raw block: say each once"),
        (("--raw", "side=-3"), "is negative: give 0 or more"),
    ],
)
def test_raw_block_that_cannot_be_read_is_refused(run: Any, words: tuple[str, ...], message: str) -> None:
    outcome = run("design", RECTANGLE, "--toolkit", "plain-vise-6-inch", "--thickness", "12", *words)
    assert outcome.exit_code == 2 and message in outcome.stderr


@pytest.mark.thorough
def test_settings_of_freecad_s_vise_are_shown(run: Any, tmp_path: Path) -> None:
    """The origin is on the fixed jaw, at the top of the jaws and in their middle; other hardware has none."""
    path = tmp_path / "result.json"
    made = run("design", RECTANGLE, "--toolkit", "plain-vise-6-inch", "--out", str(path), "--thickness", "25")
    assert made.exit_code == 0, made.stderr
    for rank in ("1", "2"):
        shown = json.loads(run("show", str(path), rank, "--json").stdout)["fixture"]
        settings = json.loads(run("show", str(path), rank, "--freecad", "--json").stdout)["freecad"]
        vise, pose = json.loads(path.read_text())["toolkit"], shown["pose"]
        assert settings == {
            "JawWidth": vise["jaw_width"],
            "JawHeight": vise["jaw_height"],
            "MaxOpening": vise["max_opening"],
            "Opening": shown["jaw_separation"],
            "SeatHeight": shown["parallels"],
            # The part lies on the side of the fixed jaw to which y falls.
            "X": pytest.approx(vise["jaw_width"] / 2 - pose["x"]),
            "Y": 0.0 - pose["y"],
            "Z": shown["parallels"] - vise["jaw_height"],
            "Angle": (pose["theta_deg"] + 180) % 360,
        }
    assert settings["Y"] < 0


def test_a_vise_of_freecad_is_named_by_its_file(run: Any, tmp_path: Path) -> None:
    """Where a toolkit is named; what it does not state is asked for, or given beside it."""
    from zipfile import ZipFile

    def save(name: str, **lengths: float) -> Path:
        rows = "".join(
            f'<Property name="{key}" type="App::PropertyLength"><Float value="{value}"/></Property>'
            for key, value in lengths.items()
        )
        xml = (
            '<Document><Objects><Object type="App::VarSet" name="Vise"/></Objects>'
            f'<ObjectData><Object name="Vise"><Properties>{rows}</Properties></Object></ObjectData></Document>'
        )
        with ZipFile(tmp_path / name, "w") as archive:
            archive.writestr("Document.xml", xml)
        return tmp_path / name

    whole = save("whole.FCStd", Opening=50.0, JawHeight=40.0, JawWidth=125.0, MaxOpening=150.0)
    narrow = save("narrow.FCStd", Opening=50.0, JawHeight=40.0)
    shown = run("toolkits", whole)
    assert shown.exit_code == 0 and "125 mm" in shown.stdout and "FreeCAD's CAM workbench" in shown.stdout
    out = tmp_path / "r.json"
    words = ("--thickness", "25", "--parallels", "20,30", "--out", out)
    assert run("design", RECTANGLE, "--vise", whole, *words).exit_code == 0
    toolkit = json.loads(out.read_text())["toolkit"]
    assert (toolkit["jaw_width"], toolkit["parallels"]) == (125.0, [20.0, 30.0])
    lacking = run("design", RECTANGLE, "--vise", narrow, *words)
    assert lacking.exit_code == 2 and "width of its jaws is not given: add --jaw-width" in lacking.stderr
    assert run("design", RECTANGLE, "--vise", narrow, "--jaw-width", "100", *words).exit_code == 0
    none = run("toolkits", save("none.FCStd", Length=3.0))
    assert none.exit_code == 2 and "none.FCStd: this FreeCAD document has no vise" in none.stderr
