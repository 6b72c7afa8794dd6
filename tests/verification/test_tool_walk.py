"""A verification walks along the program itself, and refuses fixtures that a tool comes too near."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest
from attrs import evolve

from slow_program import OFF, PEG_HEIGHT, kinds_of_toolkit, low_points, random_program, slow_clearance
from strategies import random_outline
from workhold import Program, Query, Result, answer, save
from workhold.verification import Judge, verify, verify_file
from workhold.verification.tool_walk import HoldingElement, find_program_fault, list_elements, make_walk

KINDS = tuple(kinds_of_toolkit(10.0))


def result_of(kind: str, seed: int = 5, program: bool = True, **more: Any) -> Result:
    """The answer for a random part and program in a toolkit of a kind."""
    random = Random(seed)
    part = random_outline(random, 6)
    passed = random_program(random, part)
    asked = {"program": passed, "peg_height": PEG_HEIGHT} if program else {}
    return answer(Query(part, kinds_of_toolkit(10.0)[kind], **asked, **more), threads=1)


def program_of_result(result: Result) -> Program:
    """Its program."""
    assert result.query.program is not None
    return result.query.program


@pytest.mark.thorough
@pytest.mark.sampled(2)
@pytest.mark.parametrize("kind", KINDS)
def test_every_fixture_of_a_list_is_proven_in_either_form(kind: str, tmp_path: Path) -> None:
    result = result_of(kind, best=6, rank_by=["program-clearance", "closure-margin"])
    save(result, tmp_path / "a.json")
    save(result, tmp_path / "a.npz")
    for name in ("a.json", "a.npz"):
        found = verify_file(tmp_path / name)
        assert found.proven == len(result) > 0 and not found.faults


@pytest.mark.thorough
@pytest.mark.parametrize("kind", ["vise", "bolted", "bolted fence", "flat"])
def test_what_the_program_rules_out_is_refuted_and_nothing_else(kind: str) -> None:
    some, full = result_of(kind), result_of(kind, program=False)
    program = program_of_result(some)
    low, rules = low_points(program, PEG_HEIGHT), Judge(some.query).hardware
    refused = 0
    for fixture in full[:150]:
        clear = slow_clearance(fixture, full.toolkit, low)
        said = evolve(fixture, quality=fixture.quality | {"program_clearance": clear})
        fault = find_program_fault(said, some.query, rules)
        refused += "of the program brings a tool within" in fault
        if abs(clear - program.clearance) > OFF:
            assert ("brings a tool within" in fault) == (clear < program.clearance)
    assert refused


@pytest.mark.thorough
@pytest.mark.parametrize("rapid", ["straight", "box"])
def test_the_walk_is_between_its_bounds_and_they_are_near(rapid: Any) -> None:
    result = result_of("bolted fence")
    program = evolve(program_of_result(result), rapid=rapid)
    low, rules = low_points(program, PEG_HEIGHT), Judge(result.query).hardware
    for fixture in result[:40]:
        nearest = [make_walk(program).find_nearest(one) for one in list_elements(fixture, rules, PEG_HEIGHT)]
        least = min(one.low for one in nearest)
        assert all(one.low <= one.high + 1e-12 <= one.low + 1.1e-7 for one in nearest)
        walked = slow_clearance(fixture, result.toolkit, low)
        assert least <= walked + 1e-9
        assert rapid == "box" or walked - least < OFF


def test_a_helix_is_walked_down_to_the_height_of_an_element() -> None:
    """Half a turn about an element, the tool reaching its height half way: the rest is in the way."""
    from slow_program import END_MILL, program_of

    program = program_of([(END_MILL, True, (10.0, 0.0, 10.0), (-10.0, 0.0, 4.0), 1.0)])
    for angle, low in ((0.0, False), (0.25, False), (0.75, True)):
        x, y = 14.0 * np.cos(angle * np.pi), 14.0 * np.sin(angle * np.pi)
        near = make_walk(program).find_nearest(HoldingElement("peg", "", (x, y), (x, y), 1.0, 7.0))
        # Down to 7 mm the tool comes at a quarter turn.
        there = 4.0 if low else np.hypot(x, y - 10.0)
        assert near.high == pytest.approx(there - 4.0, abs=1e-6)


def tampered(result: Result, change: Callable[[dict[str, Any]], Any], folder: Path) -> list[str]:
    """What a verification says of a file whose first fixture was changed."""
    save(result, folder / "a.json")
    data = json.loads((folder / "a.json").read_text())
    change(data["fixtures"][0])
    (folder / "b.json").write_text(json.dumps(data))
    return [one.reason for one in verify_file(folder / "b.json").unproven]


@pytest.mark.thinned(4)
@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda f: f["quality"].update(program_clearance=9.0), "its program clearance is 9 in the file"),
        (lambda f: f["quality"].pop("program_clearance"), "its program clearance is missing"),
        (lambda f: f["program_clearance"].update(line=1), "does not come nearest in line 1"),
        (lambda f: f["program_clearance"].update(element="peg L-Z9"), "to the peg L-Z9"),
        (lambda f: f["program_clearance"].update(tool=9), "T9 does not come nearest"),
        (lambda f: f["program_clearance"].update(distance=2.0), "is given twice, and differs"),
        (lambda f: f["program_clearance"].pop("tool"), "does not have distance, line, tool and element"),
    ],
)
def test_a_figure_that_is_not_that_of_the_walk_is_refuted(
    change: Callable[[dict[str, Any]], Any], reason: str, tmp_path: Path
) -> None:
    result = result_of("vise", best=3)
    assert any(reason in said for said in tampered(result, change, tmp_path))


def test_a_figure_without_a_program_is_refuted(tmp_path: Path) -> None:
    def change(fixture: dict[str, Any]) -> None:
        fixture["quality"]["program_clearance"] = 3.0

    (said, *_) = tampered(result_of("vise", program=False, best=3), change, tmp_path)
    assert said == "its program clearance is given, and there is no program"


def test_a_query_of_more_clearance_than_was_kept_is_refuted() -> None:
    result = result_of("vise", best=4, rank_by=["closure-margin"])
    program = evolve(program_of_result(result), clearance=50.0)
    found = verify(evolve(result, query=evolve(result.query, program=program)))
    assert found.refuted == len(result)
    assert all("of the program brings a tool within" in one.reason for one in found.unproven)
