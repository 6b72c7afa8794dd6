"""JSON Schemas fit the files there are, and refuse what the readers refuse for its shape."""

from __future__ import annotations

import copy
import json
import tomllib
from collections.abc import Iterator
from importlib.resources import files
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

import workhold
from fakes import fake_proof, fake_result
from workhold.cli.main import app
from workhold.errors import InputError
from workhold.files.loads_file import read_loads
from workhold.files.result.writer import write_result_text

jsonschema = pytest.importorskip("jsonschema_rs", reason="schemathesis, which brings it, is not installed")
ROOT = Path(__file__).parent.parent.parent
DATA = files("workhold") / "data"
SCHEMAS = {
    name: json.loads(CliRunner().invoke(app, ["schema", name]).stdout)
    for name in ("part", "toolkit", "loads", "query", "result")
}
FITS = {name: jsonschema.validator_for(schema).is_valid for name, schema in SCHEMAS.items()}


def parts() -> Iterator[Any]:
    """Every part in JSON."""
    yield from (json.loads(path.read_text()) for path in sorted((DATA / "parts").iterdir(), key=str))  # type: ignore[arg-type]
    yield from (
        json.loads((ROOT / "examples" / name).read_text()) for name in ("plate.json", "square-inch.json")
    )


def toolkits() -> Iterator[Any]:
    """Every toolkit in TOML."""
    yield from (tomllib.loads(path.read_text()) for path in (DATA / "toolkits").iterdir())


def results() -> Iterator[Any]:
    """Results of every kind of toolkit, with and without loads."""
    bar = workhold.Workpiece.from_loops("bar", [[[0, 0, 0], [70, 0, 0], [64, 40, 0], [0, 40, 0]]])
    plate = {"pitch": 20, "peg_radius": 3, "columns": 6, "rows": 5}
    clamped = [
        workhold.Plate(**plate),
        workhold.Plate(**plate, travel=(10, 60)),
        workhold.Plate(**plate, clamps=2),
    ]
    fences = [workhold.Fence(**plate, wall_offset=10), workhold.Fence(**plate, wall_offset=10, clamps=2)]
    flat = {"half_width": 2.0, "distance": 2.0}
    flats = [workhold.Plate(**plate, flat=flat), workhold.Fence(**plate, wall_offset=10, clamps=2, flat=flat)]
    for toolkit in (*clamped, *fences, *flats):
        result = workhold.design(bar, toolkit, best=3, seating=2 if toolkit.travel_count > 1 else None)
        assert len(result)
        yield json.loads("".join(write_result_text(result)))
    yield json.loads("".join(write_result_text(fake_result(3, proof=fake_proof(2)))))
    yield json.loads("".join(write_result_text(fake_result(0))))


RESULTS = list(results())


@pytest.mark.parametrize(
    ("name", "contents"), [("part", parts()), ("toolkit", toolkits()), ("result", RESULTS)]
)
def test_files_fit(name: str, contents: Iterator[Any]) -> None:
    """All of those that come with the program, and results as they are written."""
    checked = [FITS[name](content) for content in contents]
    assert len(checked) > 6 and all(checked)


@pytest.mark.parametrize(
    ("name", "wrong"),
    [
        ("part", {"name": "x", "loops": [[[0, 0, 0], [1, 0, 0], [0, 1, 0]]]}),
        ("part", {"units": "mm", "loops": [[[0, 0], [1, 0], [0, 1]]]}),
        ("part", {"units": "mm", "loops": []}),
        ("toolkit", {"unit": "mm", "pitch": 20, "peg_radius": 3}),
        (
            "toolkit",
            {"unit": "mm", "pitch": 20, "peg_radius": 3, "columns": 2, "kind": "plate"} | {"min_gap": 3},
        ),
        ("toolkit", {"unit": "mm", "pitch": "20", "peg_radius": 3, "columns": 2}),
        ("toolkit", {"unit": "mm", "pitch": 20, "peg_radius": 3, "columns": 2, "kind": "fence"}),
        ("query", {"workpiece": {"loops": [[[0, 0, 0], [1, 0, 0], [0, 1, 0]]]}}),
        ("loads", {"load": []}),
    ],
)
def test_what_is_of_another_shape_does_not(name: str, wrong: dict[str, Any]) -> None:
    assert not FITS[name](wrong)


@pytest.mark.parametrize("key", ["format", "workpiece", "counts", "fixtures"])
def test_a_result_needs_its_keys(key: str) -> None:
    assert not FITS["result"]({name: value for name, value in RESULTS[0].items() if name != key})


@pytest.mark.parametrize(
    "content", RESULTS[:6], ids=lambda content: content.get("toolkit", {"kind": "vise"})["kind"]
)
def test_a_fixture_needs_its_numbers(content: dict[str, Any]) -> None:
    """Each key of a peg but what tells which way a clamp pushes, and the pose."""
    for number, peg in enumerate(content["fixtures"][0]["pegs"]):
        for key in set(peg) - {"direction", "row", "column"}:
            wrong = copy.deepcopy(content)
            del wrong["fixtures"][0]["pegs"][number][key]
            assert not FITS["result"](wrong), key
    wrong = copy.deepcopy(content)
    del wrong["fixtures"][-1]["pose"]["x"]
    assert not FITS["result"](wrong)


@pytest.mark.parametrize(
    "load",
    [
        {"force": 200, "at": [10, 5]},
        {"force": "0.2 kN", "at": "10,5", "direction": 30, "name": "drill"},
        {"force": 1, "path": [[0, 0], ["4", 2.5]], "direction": [30, 60]},
        {"force": 1, "path": ["0,0", [4, 2]], "direction": "30..60"},
        {"force": 1, "path": "0,0;40,0", "direction": "any"},
        {"moment": "5 N.m"},
        {"force": 1, "at": [1, 2, 3]},
        {"force": 1, "path": [[0, 0]]},
        {"force": [1], "at": [0, 0]},
        {"force": 1, "at": [0, 0], "where": 3},
        {"force": 1, "at": [0, 0], "direction": [1, 2, 3]},
    ],
)
def test_loads_fit_where_they_are_read(load: dict[str, Any], tmp_path: Path) -> None:
    """The form of the schema takes what the reader takes, and refuses what that refuses for its shape."""
    path = tmp_path / "loads.json"
    path.write_text(json.dumps({"unit": "mm", "load": [load]}))
    try:
        read_loads(path)
        is_read = True
    except InputError:
        is_read = False
    assert FITS["loads"](json.loads(path.read_text())) == is_read


def test_a_query_fits_that_the_server_takes() -> None:
    """For each form of a toolkit."""
    workpiece = {"loops": [[[0, 0, 0], [41, 0, 0], [13, 37, 0]]]}
    plate = {"kind": "translating-clamp", "pitch": [20, 20], "peg_radius": 3}
    for held_in in (
        {"pitch": [15, 15], "columns": 1, "peg_radius": 2},
        plate,
        {**plate, "kind": "edge", "wall_offset": 9},
    ):
        assert FITS["query"]({"workpiece": workpiece, "toolkit": held_in})


def test_the_command_prints_them(run: Any) -> None:
    """By name, each a schema of its own dialect that says what it is of."""
    for one in json.loads(run("schema", "--json").stdout)["schemas"]:
        content = json.loads(run("schema", one["name"].upper()).stdout)
        assert content == SCHEMAS[one["name"]] and content["title"] == f"workhold {one['name']}"
        assert one["of"] in content["description"] and one["name"] in run("schema").stdout
        assert jsonschema.meta.is_valid(content)
    outcome = run("schema", "nothing")
    assert outcome.exit_code == 2 and "give part, toolkit, loads, query or result" in outcome.stderr


@pytest.mark.parametrize("content", RESULTS)
def test_every_key_of_a_fixture_is_told(content: dict[str, Any]) -> None:
    """The schema describes all that is written of a fixture, whatever the toolkit."""
    told = SCHEMAS["result"]["$defs"]["FixturePart"]["properties"]
    assert not {key for fixture in content["fixtures"] for key in fixture} - set(told)
