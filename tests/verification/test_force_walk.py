"""A verification finds the forces along a program by itself, and refuses figures and places that are not its own."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest
from attrs import evolve
from flint import arb

import workhold
from slow_program import PEG_HEIGHT, kinds_of_toolkit, random_program
from strategies import random_outline
from workhold import Program, Query, Result, answer, save
from workhold.model.cutting_forces import compute_cutting_forces
from workhold.model.cutting_tool import CuttingData, CuttingDirection
from workhold.statics.path_forces import list_path_forces
from workhold.verification import verify_file
from workhold.verification.force_walk import ForceWalk

KINDS = tuple(kinds_of_toolkit(10.0))


def with_forces(program: Program, direction: CuttingDirection = "any", force: float = 400.0) -> Program:
    """A program whose tools press with a force."""
    cutting = CuttingData(cutting_force=force, cut_depth=2, direction=direction)
    return evolve(program, forces=compute_cutting_forces(program.moves, program.tools, cutting))


def result_of(kind: str, seed: int = 5, direction: CuttingDirection = "any", **more: Any) -> Result:
    """The answer for a random part and program with forces, in a toolkit of a kind."""
    random = Random(seed)
    part = random_outline(random, 6)
    program = with_forces(random_program(random, part), direction)
    toolkit = kinds_of_toolkit(10.0)[kind]
    return answer(Query(part, toolkit, program=program, peg_height=PEG_HEIGHT, **more), threads=1)


@pytest.mark.parametrize("direction", ["any", "feed"])
@pytest.mark.parametrize("seed", range(6))
def test_the_walk_agrees_with_the_closed_form(seed: int, direction: CuttingDirection) -> None:
    random = Random(seed)
    program = with_forces(random_program(random, random_outline(random, 6)), direction)
    assert program.forces is not None
    walk, path = ForceWalk.from_program(program, program.forces), list_path_forces(program, (0.0, 0.0))
    functions = np.random.default_rng(seed).normal(size=(20, 3)) / [1, 1, 40]
    found = path.find_worst(functions[:, None])
    for k, (a, b, c) in enumerate(functions.tolist()):
        ball = walk.find_worst(arb(a), arb(b), arb(c))
        assert ball.overlaps(arb(found.value[k], 1e-9 * found.value[k])) and ball.rad() < 1e-6
        wide = walk.find_worst(arb(a, 1e-3), arb(b), arb(c))
        assert wide.contains(ball.mid()) and (wide.rad() > 1e-4 or not program.forces.force.any())


@pytest.mark.thorough
@pytest.mark.sampled(2)
@pytest.mark.parametrize("kind", KINDS)
def test_every_fixture_of_a_list_with_forces_is_proven(kind: str, tmp_path: Path) -> None:
    result = result_of(kind, best=5, jaw_force=2500.0, direction="feed" if kind == "vise" else "any")
    save(result, tmp_path / "a.json")
    save(result, tmp_path / "a.npz")
    for name in ("a.json", "a.npz"):
        found = verify_file(tmp_path / name)
        assert found.proven == len(result) > 0 and not found.faults, [one.reason for one in found.unproven]
    read = workhold.open(tmp_path / "a.json")
    save(read, tmp_path / "b.json")
    assert (tmp_path / "a.json").read_bytes() == (tmp_path / "b.json").read_bytes()


CHANGES: list[tuple[Callable[[dict[str, Any]], Any], str]] = [
    (lambda f: f["quality"].update(jaw_force_needed=9.0), "its jaw force needed is 9 in the file"),
    (lambda f: f["quality"].update(load_reaction=9.0), "its load reaction is 9 in the file"),
    (lambda f: f["quality"].pop("load_reaction"), "its load reaction is missing"),
    (lambda f: f["program_forces"]["jaw"].update(force=9.0), "the jaw force of its program is 9 in the file"),
    (lambda f: f["program_forces"]["jaw"].update(line=3), "line 3 is not where the program asks most"),
    (lambda f: f["program_forces"]["jaw"].update(tool=9), "T9 in line"),
    (lambda f: f["program_forces"]["jaw"].update(element="peg L-Z9"), "asks most of the peg L-Z9"),
    (lambda f: f["program_forces"]["contact"].update(force=9.0), "the largest force of a contact is 9"),
    (lambda f: f["program_forces"]["contact"].update(line=3), "line 3 is not where the program asks most"),
    (lambda f: f["program_forces"].update(jaw_force=9.0), "the jaw force stated with it is 9"),
    (lambda f: f["program_forces"].update(room=9.0), "the room of its jaw force is 9"),
    (lambda f: f["program_forces"].update(room=None), "the room of its jaw force is given without one"),
    (lambda f: f["program_forces"].pop("room"), "do not have jaw, contact, jaw_force, room"),
    (lambda f: f["program_forces"]["jaw"].pop("line"), "do not say force, line, tool, element"),
]


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """A file of three fixtures."""
    path = tmp_path_factory.mktemp("forces") / "a.json"
    save(result_of("vise", best=3, jaw_force=2500.0), path)
    data: dict[str, Any] = json.loads(path.read_text())
    return data


@pytest.mark.thorough
@pytest.mark.parametrize(("change", "reason"), CHANGES)
def test_what_is_not_that_of_the_walk_is_refuted(
    change: Callable[[dict[str, Any]], Any], reason: str, written: dict[str, Any], tmp_path: Path
) -> None:
    data = json.loads(json.dumps(written))
    change(data["fixtures"][0])
    (tmp_path / "b.json").write_text(json.dumps(data))
    said = [one.reason for one in verify_file(tmp_path / "b.json").unproven]
    assert any(reason in one for one in said), said


def test_forces_of_a_program_without_any_are_refuted(written: dict[str, Any], tmp_path: Path) -> None:
    data = json.loads(json.dumps(written))
    del data["program"]["forces"]
    data["ranking"] = ["closure_margin"]
    (tmp_path / "b.json").write_text(json.dumps(data))
    said = [one.reason for one in verify_file(tmp_path / "b.json").unproven]
    assert said and all("no loads" in one or "the program has none" in one for one in said)
