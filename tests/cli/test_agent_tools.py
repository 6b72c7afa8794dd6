"""Tools for agents: what each says, that every error is a sentence, and the protocol on standard input and output."""

from __future__ import annotations

import json
import subprocess
import sys
from base64 import b64decode
from collections.abc import Iterator
from pathlib import Path
from threading import Event
from typing import Any

import pytest

import workhold
from workhold.cli.agent_tools import TOOLS
from workhold.cli.serving_commands import REQUIREMENT, run_tool

WEDGE = '{"name": "wedge", "units": "mm", "loops": [[[0, 0, 0], [41, 0, 0], [13, 37, 0]]]}'
VISE = {"toolkit": "vise", "fields": {"pitch": [15, 15], "columns": 1, "peg_radius": 2}}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a part, in which the tools work; their own folder is in it."""
    monkeypatch.chdir(tmp_path)
    Path("wedge.json").write_text(WEDGE)
    Path("own").mkdir()
    return tmp_path / "own"


def told(name: str, folder: Path, **arguments: Any) -> Any:
    """What a tool says; it must not fail."""
    data, _, failed = run_tool(name, arguments, folder, Event())
    assert not failed, data
    return json.loads(json.dumps(data, allow_nan=False))


@pytest.mark.thorough
def test_the_whole_way(folder: Path) -> None:
    """From a part's faces over its fixtures to the sheet, with forbidden faces, places, loads and an order."""
    part = told("load", folder, part="wedge.json")
    assert [face["number"] for face in part["faces"]] == [0, 1, 2]
    every = told("design", folder, part="wedge.json", **VISE, count=1)
    assert every["listed"] == sum(every["found"].values()) and len(every["fixtures"]) == 1
    assert Path(every["result_file"]).parent == folder
    wishes = {"keep_out": [{"circle": [20, 0, 1]}, {"polygon": [[0, 0], [1, 0], [0, 1]]}], "prefer": "strong"}
    load = {"force": "0.2 kN", "at": [20, 10], "direction": "30..60"}
    some = told("design", folder, part="wedge.json", **VISE, **wishes, loads=[load], best=7, out="some.json")
    opened = workhold.open("some.json")
    assert some["result_file"] == "some.json" and some["listed"] == len(opened) == 7
    assert opened.query.loads[0].force == 200.0 and len(opened.query.restrictions.zones) == 2
    assert opened.query.rank_by[:2] == ("warnings", "load_reaction")
    shown = told("show", folder, result_file="some.json", rank=2, jaw_force=5)
    assert shown["fixture"]["rank"] == 2 and shown["loads"][0]["jaw_force"] == 5.0
    assert told("sheet", folder, result_file="some.json", path="setup.svg", zero="centre")["written"] == [
        "setup.svg"
    ]
    assert "SHA-256" in Path("setup.svg").read_text()


@pytest.mark.thorough
def test_seating_is_told_where_it_is_asked_for(folder: Path) -> None:
    """Of the first of a design, which then stand in its order; of any fixture; and only with what it needs."""
    made = told("design", folder, part="wedge.json", **VISE, seating=2, count=3, out="some.json")
    assert all(("seating" in fixture) == (fixture["rank"] <= 2) for fixture in made["fixtures"])
    assert made["fixtures"][0]["seating"]["capture_opening"] > 0.0
    assert workhold.open("some.json").query.seating == 2
    shown = [
        told("show", folder, result_file="some.json", rank=3, seating=asked, picture=False)
        for asked in (True, False)
    ]
    [right] = workhold.seatings(workhold.open("some.json"), [workhold.open("some.json")[2]])
    assert shown[0]["fixture"]["seating"]["reading"] == pytest.approx(right.find_least_reading(), abs=1e-8)
    assert "seating" not in shown[1]["fixture"]
    told("sheet", folder, result_file="some.json", rank=3, path="setup.svg", seating=True)
    assert "Does the part end up there?" in Path("setup.svg").read_text()
    data, _, failed = run_tool("design", {"part": "wedge.json", **VISE, "foolproof": True}, folder, Event())
    assert failed and "such as seating 100" in json.dumps(data)


@pytest.mark.thorough
def test_with_two_clamps_agents_are_told_what_to_do_by_hand(folder: Path) -> None:
    """Of the first of a design, of any fixture that is asked for, and on the sheet."""
    plate = {"toolkit": "two-clamp-plate-20mm"}
    made = told("design", folder, part="wedge.json", **plate, seating=1, count=2, out="some.json")
    right, other = workhold.seatings(workhold.open("some.json"), 2)
    assert made["fixtures"][0]["by_hand"] == right.to_fields() and "by_hand" not in made["fixtures"][1]
    for asked in (True, False):
        shown = told("show", folder, result_file="some.json", rank=2, seating=asked, picture=False)["fixture"]
        assert shown.get("by_hand") == (other.to_fields() if asked else None) and "seating" not in shown
    told("sheet", folder, result_file="some.json", rank=2, path="setup.svg", seating=True)
    assert "Does the part end up there?" in Path("setup.svg").read_text()


def test_design_keeps_results_apart(folder: Path) -> None:
    first, second = (
        told("design", folder, part="wedge.json", **VISE, best=1)["result_file"] for _ in range(2)
    )
    assert first != second and workhold.open(first) == workhold.open(second)


def test_faces_to_avoid_and_angles_are_heeded(folder: Path) -> None:
    square = '{"name": "s", "units": "mm", "loops": [[[0,0,0],[40,0,0],[52,30,0],[30,55,0],[0,40,0]]]}'
    Path("five.json").write_text(square)
    asked = {"part": "five.json", **VISE, "count": 100, "contact_margin": 1.0}
    some = told("design", folder, **asked, avoid=[2], angles=[[-90, 90]], types=["I"])
    assert some["fixtures"] and some["found"].get("II", 0) == 0
    for fixture in some["fixtures"]:
        assert all(2 not in peg["faces"] for peg in fixture["pegs"])
        assert not 90 < fixture["pose"]["theta_deg"] < 270


def test_presets_are_toolkits_and_bring_their_tolerance(folder: Path) -> None:
    told(
        "design", folder, part="wedge.json", toolkit="plate-20mm", fields={"columns": 2}, best=1, out="p.json"
    )
    query = workhold.open("p.json").query
    assert query.toolkit == workhold.Vise.preset("plate-20mm", columns=2)
    assert query.tolerance == workhold.Tolerance.preset("plate-20mm")


def test_explain_tells_why_there_is_none(folder: Path) -> None:
    """And that there are some where there are."""
    why = told("explain", folder, part="wedge.json", **VISE, angles=[[1, 1.01]])
    assert why["found"] == 0 and why["last_rule"] and why["sentence"] and why["removals"][-1]["after"] == 0
    some = told("explain", folder, part="wedge.json", **VISE)
    assert some["found"] > 0 and "design lists them" in some["sentence"]


def test_a_search_that_is_ended_says_so(folder: Path) -> None:
    """Neither proves that there is none."""
    cancel = Event()
    cancel.set()
    data, _, failed = run_tool("design", {"part": "wedge.json", **VISE}, folder, cancel)
    assert not failed and isinstance(data, dict) and data["complete"] is False
    data, _, failed = run_tool("explain", {"part": "wedge.json", **VISE}, folder, cancel)
    assert (
        not failed and isinstance(data, dict) and not data["complete"] and "ended before" in data["sentence"]
    )


def test_the_time_for_a_search_is_kept(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A clock is set to the seconds asked for, ends the search and is taken back."""
    clocks: list[Any] = []

    class Clock:
        def __init__(self, seconds: float, ring: Any) -> None:
            self.seconds, self.ring, self.is_cancelled = seconds, ring, False
            clocks.append(self)

        def start(self) -> None:
            self.ring()

        def cancel(self) -> None:
            self.is_cancelled = True

    monkeypatch.setattr("workhold.cli.agent_tools.Timer", Clock)
    content = told(
        "design", folder, part="wedge.json", **VISE, seconds=7.5, contact_margin=0.25, out="late.json"
    )
    assert not content["complete"] and [(one.seconds, one.is_cancelled) for one in clocks] == [(7.5, True)]
    assert workhold.open("late.json").query.contact_margin == 0.25


@pytest.mark.thorough
def test_pictures_are_shown_where_asked_for(folder: Path) -> None:
    for name, asked in (
        ("load", {"part": "wedge.json"}),
        ("design", {"part": "wedge.json", **VISE, "out": "w.json"}),
    ):
        assert run_tool(name, asked, folder, Event())[1] is None
        _, picture, _ = run_tool(
            name, {**asked, "picture": True, **({"force": True} if name == "design" else {})}, folder, Event()
        )
        assert b64decode(picture or "").startswith(b"\x89PNG")
    assert run_tool("show", {"result_file": "w.json"}, folder, Event())[1] is not None


@pytest.mark.parametrize(
    ("name", "arguments", "words"),
    [
        ("nothing", {}, "there is no tool 'nothing': the tools are load, design, show, sheet, explain."),
        ("load", None, "part is not as it should be: field required."),
        ("load", {"part": "none.dxf"}, "'none.dxf': file not found, and no built-in part has that name"),
        (
            "load",
            {"part": "wedge.json", "what": 1},
            "what is not as it should be: extra inputs are not permitted.",
        ),
        (
            "load",
            {"part": "wedge.json", "unit": "mm"},
            'wedge.json: the JSON file gives its own "units": leave unit out.',
        ),
        ("load", {"part": "wedge.json", "unit": "ell"}, "unit is not as it should be"),
        ("design", {"part": "wedge.json", "toolkit": "nix"}, "no toolkit has that name"),
        ("design", {"part": "wedge.json", "toolkit": "vise"}, "the vise's pitch is not given."),
        (
            "design",
            {"part": "wedge.json", "toolkit": "vise", "fields": {"pitch": {}, "columns": 1, "peg_radius": 2}},
            "",
        ),
        ("design", {"part": "wedge.json", **VISE, "avoid": [77]}, "77"),
        ("design", {"part": "wedge.json", **VISE, "loads": [{"at": [0, 0]}]}, "load 1 has at but no force"),
        ("design", {"part": "wedge.json", **VISE, "types": ["IV"]}, "type IV is unknown"),
        ("design", {"part": "wedge.json", **VISE, "out": "wedge.json"}, "wedge.json is also an input"),
        (
            "design",
            {"part": "wedge.json", **VISE, "out": "other.txt"},
            "other.txt was not written by workhold: give another name, or force",
        ),
        ("show", {"result_file": "wedge.json"}, "wedge.json"),
        ("show", {"result_file": "wedge.json", "rank": 0}, "rank is not as it should be"),
        ("sheet", {"result_file": "none.json", "path": "x.pdf"}, "none.json"),
    ],
)
def test_errors_are_sentences(name: str, arguments: dict[str, Any] | None, words: str, folder: Path) -> None:
    """One, without a line break or an option of the command line."""
    Path("other.txt").write_text("somebody's own")
    data, picture, failed = run_tool(name, arguments, folder, Event())
    assert failed and picture is None and isinstance(data, str)
    assert words in data and data.endswith(".") and "\n" not in data and "--" not in data


def test_a_fault_is_owned_up_to(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*arguments: Any, **options: Any) -> None:
        raise KeyError("secret\nlines")

    monkeypatch.setattr("workhold.cli.agent_tools.read_workpiece", broken)
    data, _, failed = run_tool("load", {"part": "wedge.json"}, folder, Event())
    assert (
        failed
        and str(data).startswith("workhold has a mistake, which is not yours (KeyError")
        and "\n" not in str(data)
    )


def test_without_the_library_the_command_says_so(run: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "mcp.server.stdio", None)
    told = run("mcp")
    assert (
        told.exit_code == 2 and told.stderr.count("\n") == 1 and f"pip install '{REQUIREMENT}'" in told.stderr
    )


class Spoken:
    """A conversation with ``workhold mcp``, a line for each message."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self.process = process
        self.last = 0

    def say(self, **message: Any) -> None:
        assert self.process.stdin is not None
        self.process.stdin.write(json.dumps({"jsonrpc": "2.0", **message}) + "\n")
        self.process.stdin.flush()

    def ask(self, method: str, **params: Any) -> Any:
        """The result of a request; notifications on the way are passed over."""
        assert self.process.stdout is not None
        self.last += 1
        self.say(id=self.last, method=method, params=params)
        while True:
            answer = json.loads(self.process.stdout.readline())
            if answer.get("id") == self.last:
                return answer["result"]


@pytest.fixture(scope="module")
def spoken(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Spoken]:
    """A running server that has been greeted."""
    pytest.importorskip("mcp", reason="the extra 'mcp' is not installed")
    folder = tmp_path_factory.mktemp("agent")
    (folder / "wedge.json").write_text(WEDGE)
    process = subprocess.Popen(
        [sys.executable, "-m", "workhold", "mcp"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        cwd=folder,
    )
    with process:
        spoken = Spoken(process)
        client = {"name": "test", "version": "1"}
        greeting = spoken.ask("initialize", protocolVersion="2025-06-18", capabilities={}, clientInfo=client)
        assert (
            greeting["serverInfo"]["name"] == "workhold" and "find all fixtures" in greeting["instructions"]
        )
        spoken.say(method="notifications/initialized")
        yield spoken
        assert process.stdin is not None
        process.stdin.close()
        assert process.wait(60) == 0


@pytest.mark.thorough
def test_the_protocol_lists_the_tools(spoken: Spoken) -> None:
    """With what each does and the schema of its arguments, all of which are described where their names do not tell."""
    tools = {tool["name"]: tool for tool in spoken.ask("tools/list")["tools"]}
    assert list(tools) == list(TOOLS) == ["load", "design", "show", "sheet", "explain"]
    for name, tool in tools.items():
        assert tool["description"] == TOOLS[name].words
        assert (
            tool["inputSchema"]["type"] == "object" and tool["inputSchema"]["additionalProperties"] is False
        )
    assert tools["design"]["inputSchema"]["required"] == ["part", "toolkit"]


@pytest.mark.thorough
def test_the_protocol_calls_a_tool(spoken: Spoken) -> None:
    """Its data as text and as such, its picture as PNG, and what it cannot do as an error for the agent to read."""
    told = spoken.ask(
        "tools/call", name="design", arguments={"part": "wedge.json", **VISE, "best": 3, "picture": True}
    )
    text, picture = told["content"]
    assert json.loads(text["text"]) == told["structuredContent"] and told["structuredContent"]["listed"] == 3
    assert picture["mimeType"] == "image/png" and b64decode(picture["data"]).startswith(b"\x89PNG")
    assert Path(told["structuredContent"]["result_file"]).exists()
    wrong = spoken.ask("tools/call", name="show", arguments={"result_file": "none.json"})
    assert wrong["isError"] and wrong["content"][0]["text"].startswith("none.json")


@pytest.mark.thorough
def test_a_program_and_its_forces(folder: Path) -> None:
    """Fixtures keep clear of its tools; a fixture says which line asks for the force, and what of it cuts."""
    Path("p.nc").write_text("(T1 D=8. - end mill)\nG21 G90\nT1 M6\nG0 X-30 Y12 Z9\nG1 Z-1 F90\nX70\nM30\n")
    program = {"path": "p.nc", "thickness": 6, "peg_height": 3, "stock": {"side": 0, "top": 0}}
    program["cutting"] = {"cutting_force": 70}
    told("design", folder, part="wedge.json", **VISE, program=program, best=2, out="p.json")
    shown = told("show", folder, result_file="p.json")["program"]
    assert any("line 6, T1 (end mill, milling from X" in one for one in shown), shown
    opened = workhold.open("p.json").query.program
    assert opened is not None and opened.stock is not None and opened.stock.side == 0.0
    refused, _, failed = run_tool(
        "design", {"part": "wedge.json", **VISE, "program": {"path": "p.nc"}}, folder, Event()
    )
    assert failed and "give the part's thickness" in str(refused)
