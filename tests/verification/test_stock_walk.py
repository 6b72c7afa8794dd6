"""A verification walks along the stock by itself, and refuses stretches on which no tool meets it."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from random import Random
from typing import Any

import pytest
from attrs import evolve

from slow_program import PEG_HEIGHT, kinds_of_toolkit, random_program
from strategies import random_outline
from workhold import Program, Query, Workpiece, answer, save
from workhold.model.cutting_forces import compute_cutting_forces
from workhold.model.cutting_tool import CuttingData
from workhold.model.stock import Stock, StockShape
from workhold.verification import verify_file
from workhold.verification.stock_walk import find_stock_faults


def asked(seed: int, side: float = 5.0, shape: StockShape = "outline") -> Query:
    """A query for a random part and program with forces, cut from a stock."""
    random = Random(seed)
    part = random_outline(random, 6)
    program = random_program(random, part)
    forces = compute_cutting_forces(program.moves, program.tools, CuttingData(cutting_force=400, cut_depth=2))
    program = evolve(program, forces=forces, stock=Stock(side, 2.0, shape, 8.0))
    return Query(part, kinds_of_toolkit(10.0)["vise"], program=program, peg_height=PEG_HEIGHT, best=3)


@pytest.mark.parametrize("shape", ["outline", "block"])
@pytest.mark.parametrize("side", [0.0, 5.0])
@pytest.mark.parametrize("seed", range(2))
def test_the_walk_agrees_with_the_closed_form(seed: int, side: float, shape: StockShape) -> None:
    query = asked(seed, side, shape)
    assert query.program is not None and query.program.forces is not None
    assert list(find_stock_faults(query)) == []
    stretches = query.program.forces.stretches
    inner = [k for k in range(len(stretches)) if stretches.first[k] > 0.0 or stretches.last[k] < 1.0]
    # A stretch that is longer or shorter than it is, is refused, and so is a stock of another size.
    for k in inner[:3]:
        for name, by in (("first", 0.02), ("first", -0.02), ("last", 0.02), ("last", -0.02)):
            values = getattr(stretches, name).copy()
            if not 0.0 < values[k] < 1.0:
                continue
            values[k] = min(max(values[k] + by, 0.0), 1.0)
            if stretches.first[k] >= stretches.last[k]:
                continue
            wrong = evolve(stretches, **{name: values})
            program = evolve(query.program, forces=evolve(query.program.forces, stretches=wrong))
            object.__setattr__(other := evolve(query), "program", program)
            assert any("elsewhere than is said" in one for one in find_stock_faults(other)), (k, name, by)


NC = "(T1 D=10)\nG21 G90\nT1 M6\nG0 X-40 Y40 Z20\nG1 Z8 F300\nX130\nY20\nZ4\nG2 X-30 Y20 I-80 J0\nM30\n"
ELL = [(0, 0, 0), (90, 0, 0), (90, 30, 0), (40, 30, 0), (40, 60, 0), (0, 60, 0)]


def milled(folder: Path) -> Query:
    """A query for an L that a program crosses."""
    (folder / "p.nc").write_text(NC)
    how: dict[str, Any] = {"thickness": 10, "z_zero": 0.0, "cutting": {"cutting_force": 100}}
    program = Program.read(folder / "p.nc", **how)
    return Query(
        Workpiece.from_loops("L", [ELL]),
        kinds_of_toolkit(10.0)["vise"],
        program=program,
        peg_height=3,
        best=1,
    )


CHANGES: list[tuple[Callable[[dict[str, Any]], Any], str]] = [
    (lambda p: p["stock"].update(side=9.0), "meets the stock elsewhere"),
    (lambda p: p["stock"].update(height=2.0, top=0.0), "meets the stock elsewhere"),
    (lambda p: p["stock"].update(shape="block"), "meets the stock elsewhere"),
    (
        lambda p: [one["cutting"].update(stretches=[]) for one in p["pieces"] if "cutting" in one],
        "a force, and no stretch",
    ),
    (
        lambda p: [one["cutting"].update(stretches=[[0.0, 0.01]]) for one in p["pieces"] if "cutting" in one],
        "meets the stock elsewhere",
    ),
]


@pytest.mark.thorough
@pytest.mark.parametrize(("change", "said"), CHANGES)
def test_a_file_that_says_otherwise_is_refused(
    change: Callable[[dict[str, Any]], Any], said: str, tmp_path: Path
) -> None:
    path = tmp_path / "a.json"
    save(answer(milled(tmp_path), threads=1), path)
    assert verify_file(path).holds
    data = json.loads(path.read_text())
    change(data["program"])
    path.write_text(json.dumps(data))
    outcome = verify_file(path)
    assert any(said in one for one in outcome.faults) and not outcome.holds


@pytest.mark.thorough
def test_a_file_without_a_stock_is_read_as_it_stands(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    query = asked(1)
    assert query.program is not None
    bare = evolve(query.program, stock=None, is_placed=False)
    forces = compute_cutting_forces(bare.moves, bare.tools, CuttingData(cutting_force=400, cut_depth=2))
    save(answer(evolve(query, program=evolve(bare, forces=forces)), threads=1), path)
    data = json.loads(path.read_text())
    assert "stock" not in data["program"]
    for one in data["program"]["pieces"]:
        one.get("cutting", {}).pop("stretches", None)
        one.get("cutting", {}).pop("kind", None)
    path.write_text(json.dumps(data))
    assert verify_file(path).holds
