"""A program in a result file, with the clearance of each fixture, comes back the same from either form."""

from __future__ import annotations

import json
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest
from attrs import evolve

import workhold
from slow_program import END_MILL, PEG_HEIGHT, kinds_of_toolkit, path, program_of, random_program
from strategies import random_outline
from workhold import InputError, Query, Result, answer, answer_to_file
from workhold.files.result.fixture_text import write_result_csv
from workhold.files.result.reader import read_result
from workhold.model.quality import FIGURES

KINDS = ("vise", "bolted", "bolted fence", "bolted pair", "flat")


def result_of(kind: str, rapid: Any = "straight", **more: Any) -> Result:
    """The answer for a random part and program in a toolkit of a kind."""
    random = Random(5)
    part = random_outline(random, 6)
    program = evolve(random_program(random, part), rapid=rapid)
    toolkit = kinds_of_toolkit(10.0)[kind]
    return answer(Query(part, toolkit, program=program, peg_height=PEG_HEIGHT, **more), threads=1)


@pytest.mark.thinned(7)
@pytest.mark.parametrize("rapid", ["straight", "box"])
@pytest.mark.parametrize("kind", KINDS)
def test_either_form_gives_the_bytes_of_the_other(kind: str, rapid: str, tmp_path: Path) -> None:
    result = result_of(kind, rapid, best=12)
    for name in ("a.json", "a.npz"):
        workhold.save(result, tmp_path / name)
    workhold.save(workhold.open(tmp_path / "a.npz"), tmp_path / "b.json")
    workhold.save(workhold.open(tmp_path / "a.json"), tmp_path / "b.npz")
    for form in ("json", "npz"):
        assert (tmp_path / f"a.{form}").read_bytes() == (tmp_path / f"b.{form}").read_bytes()
    asked, read = result.query, read_result(tmp_path / "a.json").query
    assert (read.peg_height, read.rank_by) == (asked.peg_height, asked.rank_by)
    assert read.program is not None and asked.program is not None
    assert read.program.to_dict() == asked.program.to_dict()


def test_a_search_into_a_file_writes_what_one_in_memory_does(tmp_path: Path) -> None:
    result = result_of("vise")
    workhold.save(result, tmp_path / "a.npz")
    streamed = answer_to_file(result.query, tmp_path / "b.npz", threads=1)
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes() and len(streamed)


@pytest.mark.thorough
@pytest.mark.parametrize("kind", KINDS)
def test_each_fixture_has_its_clearance_with_line_tool_and_element(kind: str, tmp_path: Path) -> None:
    result = result_of(kind, best=12)
    workhold.save(result, tmp_path / "a.json")
    program = result.query.program
    assert program is not None
    lines, names = set(program.moves.line.tolist()), set()
    for fixture, entry in zip(result, json.loads((tmp_path / "a.json").read_text())["fixtures"], strict=True):
        said = entry["program_clearance"]
        assert said["distance"] == entry["quality"]["program_clearance"] >= program.clearance - 1e-9
        assert said["distance"] == pytest.approx(fixture.quality["program_clearance"], rel=1e-11)
        assert said["line"] in lines and said["tool"] in program.tools
        walls = [one.noun for one in result.toolkit.carriers if one.is_wall]
        known = [peg.hole for peg in fixture.pegs]
        assert any(said["element"].endswith(name) for name in (*known, *walls))
        names.add(said["element"])
    assert names


def test_of_one_move_beside_a_fixture_the_nearest_peg_is_named(tmp_path: Path) -> None:
    """The cut goes past the leftmost peg, so that is the nearest."""
    part = random_outline(Random(5), 6)
    free = answer(Query(part, kinds_of_toolkit(10.0)["vise"], best=5), threads=1)
    for place, fixture in enumerate(free):
        back = fixture.pose.inverse
        seen = {peg.hole: back.apply(peg.x, peg.y) for peg in fixture.pegs}
        first = min(seen, key=lambda name: float(seen[name][0]))
        x, y = (float(v) for v in seen[first])
        program = program_of(path(END_MILL, [(x - 40.0, y - 9.0, 2.0), (x - 40.0, y + 9.0, 2.0)]))
        asked = evolve(free.query, program=program, peg_height=PEG_HEIGHT)
        table = free.table.take(slice(place, place + 1))
        one = Result(asked, table.with_figure_columns(len(FIGURES) + 1), {"I": 1, "II": 1}, {"I": 1, "II": 1})
        workhold.save(one, tmp_path / "a.json")
        said = json.loads((tmp_path / "a.json").read_text())["fixtures"][0]["program_clearance"]
        assert said["element"] == f"peg {first}" and said["line"] in (3, 4, 5)


def test_columns_without_a_program_are_as_wide_as_ever(tmp_path: Path) -> None:
    result = result_of("vise", best=4)
    free = evolve(
        result,
        query=result.query.without_program,
        table=evolve(result.table, quality=result.table.quality[:, :-1]),
    )
    for name, one, wide in (("a", result, len(FIGURES) + 1), ("b", free, len(FIGURES))):
        workhold.save(one, tmp_path / f"{name}.npz")
        assert np.load(tmp_path / f"{name}.npz")["quality"].shape == (4, wide)
    assert "program_clearance" not in (tmp_path / "b.npz").read_bytes().decode("latin-1")
    assert "program_clearance" in next(write_result_csv(result))


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda data: data["program"].pop("pieces"), "its program cannot be used"),
        (lambda data: data["program"].update(clearance=-1.0), "clearance"),
        (lambda data: data.pop("peg_height"), "give its thickness"),
        (lambda data: data["program"]["pieces"].pop(0), "are not those of its tool"),
    ],
)
def test_a_program_that_is_none_is_refused(change: Any, reason: str, tmp_path: Path) -> None:
    workhold.save(result_of("vise", best=3), tmp_path / "a.json")
    data = json.loads((tmp_path / "a.json").read_text())
    change(data)
    (tmp_path / "a.json").write_text(json.dumps(data))
    with pytest.raises(InputError, match=reason):
        read_result(tmp_path / "a.json")
