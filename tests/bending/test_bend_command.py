"""The command ``bend``: what it prints, draws, writes and refuses."""

from __future__ import annotations

import json
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from typer.testing import CliRunner, Result

import workhold
from bent_bodies import need_elements
from workhold import Load
from workhold.bending import asking, meshing
from workhold.cli.main import app

need_elements()


@pytest.fixture(autouse=True)
def coarse(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(meshing, "TETRAHEDRA", 150)


@pytest.fixture(scope="module")
def result_file(tmp_path_factory: pytest.TempPathFactory) -> str:
    part = workhold.Workpiece.from_points("plate", [(0, 0), (80, 0), (80, 30), (50, 60), (0, 60)])
    vise = workhold.Vise(pitch=10, columns=3, peg_radius=3)
    result = workhold.design(part, vise, best=4, loads=[Load(points=[(60, 20)], force=150)])
    path = tmp_path_factory.mktemp("bending") / "plate.json"
    workhold.save(result, path)
    return str(path)


def open_glb(content: bytes) -> tuple[dict[str, Any], Callable[[int], NDArray[np.float32]]]:
    """The document of a GLB file, and its vectors by the numbers of their accessors."""
    length = struct.unpack("<I", content[12:16])[0]
    document = json.loads(content[20 : 20 + length])
    data = content[28 + length :]

    def values(number: int) -> NDArray[np.float32]:
        view = document["bufferViews"][document["accessors"][number]["bufferView"]]
        start = view["byteOffset"]
        return np.frombuffer(data[start : start + view["byteLength"]], "<f4").reshape(-1, 3)

    return document, values


def run(*words: str) -> Result:
    return CliRunner().invoke(app, ["bend", *words])


def test_the_best_fixtures_are_bent_and_ordered(result_file: str, tmp_path: Path) -> None:
    picture, model = tmp_path / "bent.png", tmp_path / "bent.glb"
    outcome = run(
        result_file, "--thickness", "8", "--jaw-force", "3000", "--rank-by", "clamp-distortion", "--bend", "0.0001",
        "--draw", str(picture), "--glb", str(model), "--json",
    )  # fmt: skip
    assert outcome.exit_code == 0, outcome.stderr
    told = json.loads(outcome.stdout)
    bends = [one["clamp_distortion"]["value"] for one in told["fixtures"]]
    assert sorted(one["rank"] for one in told["fixtures"]) == [1, 2, 3, 4]
    assert bends == sorted(bends) and bends[0] < bends[-1]
    assert all(one["give"]["load"] == 1 and one["jaw_force"] == 3000.0 for one in told["fixtures"])
    assert told["written"] == [str(picture), str(model)] and told["complete"]
    assert picture.read_bytes()[:4] == b"\x89PNG"
    assert outcome.stderr.count("Clamping bends the part by") == 1
    assert "are bent by more than 0.1 µm, too." in outcome.stderr


def test_the_model_in_three_dimensions_has_colours(result_file: str, tmp_path: Path) -> None:
    model = tmp_path / "bent.glb"
    assert run(result_file, "2", "--thickness", "8", "--glb", str(model)).exit_code == 0
    document, values = open_glb(model.read_bytes())
    (part,) = document["meshes"][0]["primitives"]
    colours = values(part["attributes"]["COLOR_0"])
    assert len(colours) == len(values(part["attributes"]["POSITION"]))
    assert colours.min() >= 0.0 and colours.min() < 0.1
    assert colours.max() <= 1.0 and colours.max() > 0.6
    assert document["materials"][part["material"]]["pbrMetallicRoughness"]["baseColorFactor"] == [1.0] * 4
    assert "times as far" in document["scenes"][0]["name"]


def test_a_table_says_it_in_words(result_file: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "160")
    outcome = run(result_file, "1", "--thickness", "8")
    assert outcome.exit_code == 0, outcome.stderr
    assert "clamping bends µm" in outcome.stdout and "load 1" in outcome.stdout
    assert "springs back" in outcome.stdout


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], "give its thickness"),
        (["--thickness", "8", "--material", "cheese"], "'cheese' is not known"),
        (["--thickness", "8", "--rank-by", "tilt"], "not a figure of bending to rank by"),
        (["--thickness", "8", "--cut", "top,99"], "face 99 of plate does not exist"),
        (["1", "--best", "3", "--thickness", "8"], "leave one of them out"),
        (["--thickness", "8", "--glb", "x.stl"], "let the name end in .glb"),
        (["--thickness", "8", "--part", "none.step"], "none.step"),
    ],
)
def test_what_cannot_be_is_refused_in_a_sentence(result_file: str, words: list[str], said: str) -> None:
    outcome = run(result_file, *words)
    assert outcome.exit_code == 2 and said in outcome.stderr


def test_the_sheet_has_a_page_of_it(result_file: str, tmp_path: Path) -> None:
    sheets = [tmp_path / "bare.svg", tmp_path / "bent.svg"]
    common = [
        "sheet",
        result_file,
        "1",
        "--thickness",
        "8",
        "--jaw-force",
        "3000",
        "--date",
        "2026-01-01",
        "-o",
    ]
    bending = [[], ["--material", "aluminium-6061", "--bend", "0.001mm"]]
    for path, more in zip(sheets, bending, strict=True):
        outcome = CliRunner().invoke(app, [*common, str(path), *more])
        assert outcome.exit_code == 0, outcome.stderr
    bare, bent = (path.read_text() for path in sheets)
    assert "How clamping bends the part" in bent and "How clamping bends" not in bare
    assert "times as far as it is." in bent and "µm" in bent and "Beware: Clamping bends" in bent
    outcome = CliRunner().invoke(app, [*common, str(tmp_path / "x.svg"), "--part", "part.step"])
    assert outcome.exit_code == 2 and "give --material" in outcome.stderr


def test_seats_under_straps_are_bent_where_straps_were_found(tmp_path: Path) -> None:
    part = workhold.Workpiece.from_points("plate", [(0, 0), (80, 0), (80, 50), (0, 50)])
    plate = workhold.StrapPlate(pitch=10, peg_radius=3, columns=14, rows=10, straps=2, tip_radius=4)
    load = Load(points=[(40, 25)], force=150)
    path, bare = tmp_path / "strapped.json", tmp_path / "bare.json"
    workhold.save(workhold.design(part, plate, loads=[load], thickness=8, strapped=1, best=3), path)
    workhold.save(workhold.design(part, plate, thickness=8, strapped=1, best=2), bare)
    outcome = run(str(path))
    assert outcome.exit_code == 0, outcome.stderr
    assert "strap" in outcome.stdout
    told = json.loads(run(str(path), "--json").stdout)
    assert [one["rank"] for one in told["fixtures"]] == [1]
    outcome = run(str(bare))
    assert outcome.exit_code == 2 and "has straps, so that nothing bends its part" in outcome.stderr
    sheet = tmp_path / "strapped.svg"
    words = ["sheet", str(path), "1", "--date", "2026-01-01", "--material", "mild-steel", "-o", str(sheet)]
    outcome = CliRunner().invoke(app, words)
    assert outcome.exit_code == 0, outcome.stderr
    assert "At a strap force of" in sheet.read_text()


def test_a_part_that_would_yield_is_warned_of_unasked(result_file: str, tmp_path: Path) -> None:
    words = [result_file, "1", "--thickness", "8", "--jaw-force", "3000"]
    weak, strong = (run(*words, "--material", f"69000,0.33,{strength}") for strength in (1, 9000))
    assert weak.exit_code == strong.exit_code == 0
    assert "fixture 1: The part would yield" in weak.stderr and "yield" not in strong.stderr
    table = " ".join(strong.stdout.split())
    assert "stress" in table and "reckoned to yield at 9000 MPa" in table
    told = json.loads(run(*words, "--material", "69000,0.33,1", "--json").stdout)["fixtures"][0]
    assert told["yields"] and told["stress"]["value"] > 1.0 and told["strength"] == 1.0
    sheet, model = tmp_path / "weak.svg", tmp_path / "weak.glb"
    outcome = CliRunner().invoke(
        app, ["sheet", *words, "--date", "2026-01-01", "--material", "69000,0.33,1", "-o", str(sheet)]
    )
    assert outcome.exit_code == 0, outcome.stderr
    assert "Beware: The part would yield" in sheet.read_text()
    assert run(*words, "--material", "69000,0.33,1", "--glb", str(model)).exit_code == 0
    document, _ = open_glb(model.read_bytes())
    told = [node["extras"]["bent"] for node in document["nodes"] if "bent" in node.get("extras", {})]
    assert told[0]["warnings"][0].startswith("The part would yield")


@pytest.mark.parametrize("kept", [0, 1])
def test_stopped_on_the_way_it_tells_what_is_found(
    result_file: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kept: int
) -> None:
    bend_all = asking.find_bendings

    def stop_after(result, rows, shape, asked, cancel, tell):
        def watch(fraction: float, count: int) -> None:
            tell(fraction, count)
            if count == kept:
                cancel.set()

        return bend_all(result, rows, shape, asked, cancel, watch)

    monkeypatch.setattr(asking, "find_bendings", stop_after)
    picture = tmp_path / "bent.png"
    outcome = run(result_file, "--thickness", "8", "--draw", str(picture), "--json")
    assert outcome.exit_code == 130
    told = json.loads(outcome.stdout)
    assert len(told["fixtures"]) == kept and not told["complete"]
    assert picture.exists() == bool(kept) and len(list(tmp_path.iterdir())) == kept
