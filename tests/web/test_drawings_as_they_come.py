"""Drawings as people have them lead to a setup sheet: on the page by its questions, on the command line by its sentences.

One of each kind is tried always, all ten of each kind by ``make prove``.
"""

from __future__ import annotations

import re
import shlex
from pathlib import Path
from typing import Any

import pytest
from running_server import RunningServer
from typer.testing import CliRunner

import workhold
from drawings_people_have import DRAWINGS, Drawing
from workhold.cli.main import app

# How far off a size may be, in mm: gaps are closed by moving ends.
OFF = 0.5
# The fit that the page proposes first.
FIT = 0.01
# What the sentences of a refusal say to do about it.
REMEDIES = (
    (re.compile(r"--fit ([\d.]+)"), "--fit"),
    (re.compile(r"--join-tolerance, above ([\d.]+) mm"), "--join-tolerance"),
    (re.compile(r"--layer ('[^']+'|[\w-]+)"), "--layer"),
    (re.compile(r"(--unit|--drawing-unit) mm"), "--unit"),
)
CASES = [(kind, drawing) for kind, several in DRAWINGS.items() for drawing in several]
# Of each kind one that asks for something.
TRIED = {
    "unit-1.svg",
    "circle-1.dxf",
    "layers-4-4.dxf",
    "parts-1.svg",
    "gap-1-0.16.dxf",
    "cam-1.dxf",
    "ellipse-1.dxf",
}
TRIED |= {"chords-3.dxf"}


def cases() -> list[Any]:
    """All of them, most to be proven at leisure."""
    return [
        pytest.param(drawing, id=drawing.name, marks=() if drawing.name in TRIED else pytest.mark.prove)
        for _, drawing in CASES
    ]


def vise_for(width: float, height: float) -> dict[str, Any]:
    """A vise of one column of holes that a part of this size fits well."""
    pitch = max(round(max(width, height) / 5), 4)
    return {"pitch": [pitch, pitch], "columns": 1, "peg_radius": pitch / 6}


def of_that_size(drawing: Drawing, width: float, height: float) -> bool:
    """Whether the part that is meant was read."""
    expected = ((drawing.width, width), (drawing.height, height))
    return all(abs(told - read) < OFF for told, read in expected if told)


def test_there_are_ten_of_each_kind_and_one_of_each_is_tried() -> None:
    assert [len(several) for several in DRAWINGS.values()] == [10] * 8
    assert [sum(one.name in TRIED for one in several) for several in DRAWINGS.values()] == [1] * 8
    assert len({drawing.name for _, drawing in CASES}) == len(CASES)


@pytest.mark.thorough
@pytest.mark.parametrize("drawing", cases())
def test_the_page_asks_and_leads_to_a_sheet(server: RunningServer, drawing: Drawing) -> None:
    """Every refusal comes with a question that the survey gives the answers for; none is a dead end."""
    how: dict[str, Any] = {}
    for _ in range(5):
        answer = server.client.post(
            "/api/parts/survey", content=drawing.content, headers={"X-Filename": drawing.name}, params=how
        )
        assert answer.status_code == 200, answer.text
        seen = answer.json()
        if seen["part"] is not None:
            break
        assert "--" not in seen["error"]
        asked = seen["asked"]
        if "unit" in asked:
            how["unit"] = drawing.unit
        elif "fit" in asked:
            how["fit"] = FIT
        elif "join_tolerance" in asked and seen["gaps"]:
            how["join_tolerance"] = max(gap for gap in seen["gaps"] if gap < 1.0) * (1 + 1e-5)
        else:
            assert drawing.layer in [layer["name"] for layer in seen["layers"]], seen["error"]
            how["layers"] = drawing.layer
    part = seen["part"]
    assert part is not None, seen["error"]
    x0, y0, x1, y1 = part["bounds"]
    assert of_that_size(drawing, x1 - x0, y1 - y0), part["bounds"]
    workpiece = {key: part[key] for key in ("name", "loops", "departure")}
    job = server.done({"workpiece": workpiece, "toolkit": vise_for(x1 - x0, y1 - y0)})
    sheet = server.client.get(f"{job}/fixtures/1/sheet.pdf")
    assert sheet.status_code == 200 and sheet.content.startswith(b"%PDF")


@pytest.mark.thorough
@pytest.mark.parametrize("drawing", cases())
def test_the_command_says_what_to_add_and_leads_to_a_sheet(drawing: Drawing, tmp_path: Path) -> None:
    """Whoever adds what each refusal says comes to a sheet; the first of several remedies is taken."""
    path = tmp_path / drawing.name
    path.write_bytes(drawing.content)
    result, sheet = tmp_path / "result.json", tmp_path / "sheet.pdf"
    vise = vise_for(drawing.width or 60, drawing.height or 50)
    words = [
        "--pitch",
        vise["pitch"][0],
        "--columns",
        1,
        "--peg-radius",
        vise["peg_radius"],
        "--best",
        1,
        "--list",
        0,
    ]
    added: list[str] = []
    for _ in range(5):
        outcome = CliRunner().invoke(
            app, [str(word) for word in ("design", path, *words, "--out", result, *added)]
        )
        if outcome.exit_code == 0:
            break
        assert outcome.exit_code == 2, outcome.output
        found = ((remedy.search(outcome.stderr), option) for remedy, option in REMEDIES)
        remedy, option = next((match, option) for match, option in found if match and option not in added)
        added += [option, "mm" if option == "--unit" else shlex.split(remedy[1])[0]]
    assert outcome.exit_code == 0, outcome.stderr
    x0, y0, x1, y1 = workhold.open(result).workpiece.bounds
    assert of_that_size(drawing, x1 - x0, y1 - y0)
    assert CliRunner().invoke(app, ["sheet", str(result), "1", "-o", str(sheet)]).exit_code == 0
    assert sheet.read_bytes().startswith(b"%PDF")
