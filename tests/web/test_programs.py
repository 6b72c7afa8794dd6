"""Programs over HTTP: what is understood of them, what a search makes of them, and refusals without a path or an option."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from running_server import RunningServer

from workhold import Program, Query, Vise, answer, load
from workhold.statics.program_forces import find_cutting_need

EXAMPLES = Path(__file__).parents[2] / "examples"
PART = load(EXAMPLES / "bracket.dxf")
PROGRAM: dict[str, Any] = {
    "name": "bracket.nc",
    "text": (EXAMPLES / "bracket.nc").read_text(),
    "tools": {"name": "tools.toml", "text": (EXAMPLES / "tools.toml").read_text()},
    "thickness": 12.0,
    "peg_height": 6.0,
}
SEARCH: dict[str, Any] = {
    "workpiece": {"name": "bracket", "loops": [loop.tolist() for loop in PART.loops]},
    "toolkit": {"pitch": [20, 20], "columns": 2, "peg_radius": 4},
    "program": PROGRAM,
}


def test_a_program_is_described_with_its_paths(server: RunningServer) -> None:
    """Tools in their order with lines and heights, and a path for each look, in tenths of mm."""
    told = server.client.post("/api/programs", json={"program": PROGRAM}).json()
    read = Program.read(EXAMPLES / "bracket.nc", EXAMPLES / "tools.toml", thickness=12)
    assert (told["moves"], told["skipped"], told["notes"]) == (
        len(read.moves),
        list(read.skipped),
        list(read.notes),
    )
    assert [one["tool"] for one in told["tools"]] == [1, 3, 2]
    assert told["tools"][1]["first_line"] == 37 and told["tools"][1]["lowest_cut"] == -3.0
    kinds = [path["kind"] for path in told["paths"]]
    assert kinds.count("band") == 3 and kinds.count("rapid") == 1 and {"cut", "dot"} <= set(kinds)
    slot = next(path["d"] for path in told["paths"] if path["kind"] == "band" and path["place"] == 2)
    assert "L600 -190" in slot


def test_a_start_and_thousandths_are_taken(server: RunningServer) -> None:
    """As the page's fields give them."""
    text = "G21 G90\nT1 M6\nG0 Z5000\nG1 Z-1000 F90\nX40.\n"
    form = {**PROGRAM, "text": text, "start": [1, 2, 30], "whole_numbers": "thousandths"}
    told = server.client.post("/api/programs", json={"program": form}).json()
    assert told["box"] == [[1, 2, 11], [40, 2, 42]] and told["moves"] == 3


@pytest.mark.thorough
def test_a_search_keeps_clear_of_it_and_names_the_nearest_move(server: RunningServer) -> None:
    """The list is that of the program's own query, and a fixture says which line comes nearest, and where."""
    url = server.done(SEARCH)
    program = Program.read(EXAMPLES / "bracket.nc", EXAMPLES / "tools.toml", thickness=12)
    own = answer(Query(PART, Vise(20, 2, 4), program=program, peg_height=6))
    state = server.client.get(url).json()
    assert state["found"] == len(own)
    assert state["request"]["program"]["name"] == "bracket.nc" and "text" not in state["request"]["program"]
    row = server.client.get(f"{url}/fixtures/1").json()
    near = row["passing"]
    assert near["distance"] == pytest.approx(own[0].quality["program_clearance"], abs=1e-6)
    assert near["line"] in program.moves.line and len(near["path"]) in (1, 2)
    sheet = server.client.get(f"{url}/fixtures/1/sheet.svg").text
    assert "bracket.nc" in sheet and f"line {near['line']}, T{near['tool']}" in sheet
    assert 'class="rapid"' in server.client.get(f"{url}/fixtures/1/picture.svg").text


@pytest.mark.thorough
def test_a_preference_counts_the_forces_of_the_tools(server: RunningServer) -> None:
    """As loads do: what presses least under them comes before what presses least without."""
    tools = "\n".join(
        f"[tool.{number}]\ndiameter = {size}\ncutting_force = 300"
        for number, size in ((1, 10), (2, 8), (3, 9))
    )
    strong = {**SEARCH, "prefer": "strong"}
    plain = server.client.get(f"{server.done(strong)}/result.json").json()
    forced = {**PROGRAM, "tools": {"name": "tools.toml", "text": tools}}
    ranked = server.client.get(f"{server.done({**strong, 'program': forced})}/result.json").json()
    assert "load_reaction" in ranked["ranking"] and "load_reaction" not in plain["ranking"]


@pytest.mark.thorough
def test_without_a_program_nothing_is_passed(server: RunningServer) -> None:
    """The place for it is empty."""
    url = server.done({key: value for key, value in SEARCH.items() if key != "program"})
    assert server.client.get(f"{url}/fixtures/1").json()["passing"] is None


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"text": "G21\nT1 M6\nG68 X0\n"}, "line 3: G68 turns"),
        ({"text": "hello"}, "line 1: "),
        ({"text": "G21\nG0 X1 Y1 Z1\n", "tools": None}, "what is in the spindle (T0)"),
        ({"tools": {"name": "my tools.toml", "text": "= 3"}}, "my tools.toml"),
        ({"tools": {"name": "t.csv", "text": "tool;size\n1;2\n"}}, "t.csv"),
        ({"thickness": None}, "the part's thickness"),
        ({"clearance": -1.0}, "clearance"),
        ({"rapid": "curved"}, "rapid"),
        ({"text": 5}, "text"),
        (
            {"text": "G21 G90\nT1 M6\nG0 Z5.\nG1 Z-1. F9\n"},
            "line 4: the tool cuts at a place that the program does not say, as X and Y are not named before: write X "
            'and Y with G0 before it, or give where the tip is at the start with "tip starts at".',
        ),
        ({"start": [1, 2]}, "start"),
        ({"whole_numbers": "tenths"}, "whole_numbers"),
    ],
)
def test_what_cannot_be_read_is_refused_in_the_words_of_the_page(
    server: RunningServer, change: dict[str, Any], sentence: str
) -> None:
    """One sentence at either address, with the user's own names of files: no folder, no option of a command."""
    form = {**PROGRAM, **change}
    for address, body in (("/api/programs", {"program": form}), ("/api/jobs", {**SEARCH, "program": form})):
        refused = server.client.post(address, json=body)
        assert refused.status_code == 400, refused.text
        words = refused.json()["error"]
        assert sentence.lower() in words.lower() and "/tmp" not in words and "--" not in words


@pytest.mark.thorough
def test_the_description_names_the_form(server: RunningServer) -> None:
    """OpenAPI has the address, the form with its parts, and the same form in a search."""
    told = server.client.get("/api/openapi.json").json()
    assert "/api/v1/programs" in told["paths"]
    forms = told["components"]["schemas"]
    assert {
        "text",
        "tools",
        "zero",
        "z_zero",
        "clearance",
        "rapid",
        "unit",
        "thickness",
        "peg_height",
    } <= set(forms["ProgramForm"]["properties"])
    assert "program" in forms["JobForm"]["properties"] and "program" in forms["ExploreForm"]["properties"]


@pytest.mark.thorough
def test_forces_act_where_tools_meet_the_stock(server: RunningServer) -> None:
    """As the page's fields give them: what is asked for, and what of which line does."""
    asked = {"cutting": {"cutting_force": 500}, "stock": {"side": 0, "top": 1, "shape": "block"}}
    url = server.done({**SEARCH, "program": {**PROGRAM, **asked}})
    told = server.client.get(f"{url}/fixtures/1").json()["program_forces"]
    how: dict[str, Any] = {"thickness": 12, **asked}
    program = Program.read(EXAMPLES / "bracket.nc", EXAMPLES / "tools.toml", **how)
    own = find_cutting_need(answer(Query(PART, Vise(20, 2, 4), program=program, peg_height=6)), 0)
    assert own is not None
    assert {key: told[key] for key in own.to_dict()} == own.to_dict()
    assert f"line {own.jaw.line}, T{own.jaw.tool} (end mill, milling from X" in told["words"][0]
    # Without forces nothing is asked for.
    bare = server.client.get(f"{server.done(SEARCH)}/fixtures/1").json()
    assert bare["program_forces"] is None
    wrong = {**PROGRAM, "stock": {"side": -1}}
    assert server.client.post("/api/programs", json={"program": wrong}).status_code == 400
