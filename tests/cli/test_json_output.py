"""``--json`` on every command that prints: one object on standard output, and what it says is so."""

from __future__ import annotations

import json
from math import inf
from pathlib import Path
from typing import Any

import attrs
import pytest

import workhold
from fakes import fake_proof, fake_result
from workhold import save
from workhold.cli.main import COMMANDS
from workhold.presenting.data import describe_part

# Commands whose only output is a text for another program, or a page.
NO_TABLES = {"completion", "mcp", "serve", "workbench"}
WEDGE = '{"name": "wedge", "units": "mm", "loops": [[[0, 0, 0], [41, 0, 0], [13, 37, 0]]]}'
VISE = ("--pitch", 15, "--columns", 1, "--peg-radius", 2)


def told(outcome: Any, code: int = 0) -> Any:
    """The one object that a command has printed; numbers that JSON does not have are refused."""

    def refuse(word: str) -> float:
        raise AssertionError(word)

    assert outcome.exit_code == code, outcome.stderr
    assert outcome.stdout.count("\n") == 1
    return json.loads(outcome.stdout, parse_constant=refuse)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a result file of six fixtures and a part."""
    monkeypatch.chdir(tmp_path)
    save(fake_result(6), "r.json")
    Path("wedge.json").write_text(WEDGE)
    return tmp_path


@pytest.mark.parametrize("name", sorted(set(COMMANDS) - NO_TABLES))
def test_every_command_that_prints_has_it(run: Any, name: str) -> None:
    assert "--json" in run(name, "--help").stdout


def test_show_tells_the_fixture(run: Any, folder: Path) -> None:
    """Its rank, pegs, pose and settings, in mm whatever the unit, and what loads do to it."""
    content = told(
        run("show", "r.json", 2, "--json", "--unit", "inch", "--load", "moment=500", "--draw", "two.svg")
    )
    fixture, opened = content["fixture"], workhold.open("r.json")[1]
    assert (fixture["rank"], content["listed"], content["complete"]) == (2, 6, True)
    assert [(peg["hole"], *peg["faces"], peg["x"], peg["force"]) for peg in fixture["pegs"]] == [
        (peg.hole, peg.face, peg.x, peg.force) for peg in opened.pegs
    ]
    assert fixture["pose"]["theta_deg"] == opened.pose.theta_deg
    assert [one["length"] for one in fixture["settings"]] == [opened.jaw_separation]
    assert [case["load"]["moment"] for case in content["loads"]] == [500.0]
    assert content["written"] == ["two.svg"] and Path("two.svg").exists()
    assert told(run("show", "r.json", 2, "--json"))["loads"] == []


def test_design_tells_the_best_and_where_the_file_is(run: Any, folder: Path) -> None:
    content = told(run("design", "wedge.json", *VISE, "--json", "--list", 2, "--out", "w.json"))
    result = workhold.open("w.json")
    assert content["found"] == dict(result.found) and content["listed"] == len(result) > 2
    assert content["fixtures"][0]["rank"] == 1 and len(content["fixtures"]) == 2
    assert content["complete"] and content["result_file"] == "w.json" and content["explanation"] is None
    assert content["proof"]["verified"] == result.proof.verified  # type: ignore[union-attr]


def test_design_explains_why_there_is_none(run: Any, folder: Path) -> None:
    """With what would help, and the pictures it drew."""
    words = (*VISE, "--json", "--max-opening", 15.5, "--angle=0..1", "--draw", "pictures")
    content = told(run("design", "wedge.json", *words))
    assert sum(content["found"].values()) == 0 and content["fixtures"] == []
    why = content["explanation"]
    assert why["removals"][-1]["rule"] == why["last_rule"] and why["removals"][-1]["after"] == 0
    assert all(help["fixtures"] > 0 for help in why["helps"])
    assert all(set(help) == {"change", "fixtures", "complete", "fields"} for help in why["helps"])
    assert [Path(name).exists() for name in content["pictures"]] == [True, True]


def test_design_that_is_interrupted_says_so(run: Any, searched: Any, folder: Path) -> None:
    searched["result"] = fake_result(3, complete=False, proof=fake_proof(2))
    content = told(run("design", "wedge.json", *VISE, "--json", "--list", 0), code=130)
    assert content["complete"] is False and content["fixtures"] == []
    assert [len(one["faces"]) for one in content["proof"]["undecided"]] == [4, 4]


def test_features_tell_faces_layers_and_parts(run: Any, folder: Path) -> None:
    content = told(run("features", "wedge.json", "--json"))
    assert content["name"] == "wedge" and [face["number"] for face in content["faces"]] == [0, 1, 2]
    assert (
        content["faces"][0] | {"kind": "line", "length": 41.0, "from": [0.0, 0.0], "to": [41.0, 0.0]}
        == content["faces"][0]
    )
    parts = told(run("features", "wedge.json", "--json", "--parts", "--draw", "parts.svg"))
    assert parts["parts"] == [{"number": 1, "bounds": [0.0, 0.0, 41.0, 37.0], "holes": 0}]
    assert parts["chosen"] == 1 and parts["written"] == ["parts.svg"]
    drawing = Path(__file__).parent.parent / "data" / "drawings" / "vslot_2020.dxf"
    layers = told(run("features", drawing, "--json", "--layers"))
    assert [layer["loops"] for layer in layers["layers"]] == [2] and layers["in_mm"]


def test_arcs_tell_their_circle() -> None:
    """Of a hole the loop, that it is hollow, and its whole turn."""
    ring = workhold.Workpiece.from_loops(
        "ring", [[[0, 0, 0], [60, 0, 0], [60, 40, 0]], [[40, 15, -1], [44, 15, -1]]]
    )
    face = describe_part(ring)["faces"][-1]
    assert (face["kind"], face["loop"], face["concave"], face["radius"], face["sweep_deg"]) == (
        "arc",
        1,
        True,
        2.0,
        360.0,
    )


def test_lists_tell_all_of_it(run: Any, folder: Path) -> None:
    """Parts, toolkits and schemas."""
    assert [part["name"] for part in told(run("parts", "--json"))["parts"]][-1] == "widget"
    assert {one["name"] for one in told(run("toolkits", "--json"))["toolkits"]} == {
        name
        for kind in (
            workhold.Vise,
            workhold.Plate,
            workhold.Fence,
            workhold.FlatJaw,
            workhold.PlainVise,
            workhold.StrapPlate,
        )
        for name in kind.presets()
    }
    vise = next(
        line for line in run("toolkits").stdout.splitlines() if line.startswith("machine-vise-6-inch")
    )
    assert vise.split()[1:4] == ["12.7", "6.35", "11"], "the pegs are those of the jaw that has some"
    (one,) = told(run("toolkits", "plate-20mm", "--json"))["toolkits"]
    assert one["fields"]["pitch"] == [20.0, 20.0] and one["tolerance"]["peg"] == 0.0145
    assert "result" in [one["name"] for one in told(run("schema", "--json"))["schemas"]]


def test_verify_tells_what_is_refuted(run: Any, folder: Path) -> None:
    """With the exit code of a result that does not hold."""
    content = told(run("verify", "r.json", "--json"), code=2)
    assert not content["holds"] and content["fixtures"] == 6 == content["refuted"] + content["proven"]
    assert content["unproven"][0]["rank"] >= 1 and content["unproven"][0]["verdict"] == "refuted"


def test_explore_tells_every_toolkit(run: Any, folder: Path) -> None:
    words = ("--pitch", 15, "--columns", "1", "--peg-radius", "2,9", "--out", "table.csv")
    content = told(run("explore", "wedge.json", *words, "--json"))
    good, bad = content["toolkits"]
    assert good["fixtures"] == sum(good["found"].values()) > 0 and content["first_choice"] == good["name"]
    assert bad["fixtures"] == 0 and bad["reason"] and content["written"] == ["table.csv"]


@pytest.mark.parametrize(
    "words",
    [
        ("sheet", "r.json", 1, "-o", "out.svg"),
        ("convert", "r.json", "out.csv"),
        ("drill", "--vise", "plate-20mm", "--rows", 4, "-o", "out.dxf"),
    ],
    ids=lambda words: words[0],
)
def test_files_written_are_named(run: Any, folder: Path, words: tuple[Any, ...]) -> None:
    (written,) = told(run(*words, "--json"))["written"]
    assert Path(written).exists() and written == next(word for word in words if str(word)[:3] == "out")


@pytest.mark.parametrize("words", [("convert", "r.json", "-"), ("design", "wedge.json", *VISE, "--out", "-")])
def test_two_things_in_one_place_are_refused(run: Any, folder: Path, words: tuple[Any, ...]) -> None:
    outcome = run(*words, "--json")
    assert outcome.exit_code == 2 and not outcome.stdout
    assert "would both go to the terminal" in outcome.stderr


def test_forces_without_end_are_nothing(run: Any, folder: Path) -> None:
    """JSON has no infinity."""
    result = fake_result(1)
    quality = result.table.quality.copy()
    quality[0, 0] = inf
    from workhold.presenting.data import describe_fixture

    fixture = attrs.evolve(result, table=attrs.evolve(result.table, quality=quality))[0]
    assert None in describe_fixture(fixture, result.toolkit)["quality"].values()
