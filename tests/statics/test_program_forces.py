"""What a program asks of a fixture: by the loads that it stands for, and what scaling, shifting and adding do."""

from __future__ import annotations

from functools import cache
from random import Random
from typing import Any

import numpy as np
import pytest
from attrs import evolve

from slow_program import PEG_HEIGHT, kinds_of_toolkit, random_program
from strategies import random_outline
from workhold import Load, Program, Query, Result, answer
from workhold.model.cutting_forces import CuttingForces, compute_cutting_forces
from workhold.model.cutting_tool import CuttingData
from workhold.model.moves import Moves, MoveStretches, compute_path_points
from workhold.model.quality import JAW_FORCE_NEEDED, LOAD_REACTION
from workhold.statics.loads import compute_load_cases
from workhold.statics.program_forces import find_cutting_need
from workhold.statics.quality import measure_quality

KINDS = tuple(kinds_of_toolkit(10.0))


@cache
def result_of(kind: str, **more: Any) -> Result:
    """Some fixtures of a random part in a toolkit of a kind, with a program that presses."""
    random = Random(5)
    part = random_outline(random, 6)
    program = pressing(random_program(random, part))
    toolkit = kinds_of_toolkit(10.0)[kind]
    return answer(Query(part, toolkit, program=program, peg_height=PEG_HEIGHT, best=8, **more), threads=1)


def pressing(program: Program, force: float = 300.0) -> Program:
    """A program whose tools press."""
    data = CuttingData(cutting_force=force)
    return evolve(program, forces=compute_cutting_forces(program.moves, program.tools, data), is_placed=False)


def figures(result: Result, program: Program | None, loads: tuple[Load, ...] = ()) -> np.ndarray:
    """Load reaction and jaw force needed of all fixtures."""
    passed = None if program is None else (program, PEG_HEIGHT)
    quality = measure_quality(result.table, result.workpiece, result.toolkit, loads=loads, passed=passed)
    return np.asarray(quality[:, [LOAD_REACTION, JAW_FORCE_NEEDED]])


def as_loads(program: Program, step: float = 0.05) -> tuple[Load, ...]:
    """The loads that a program stands for, arcs as points near to each other."""
    forces = program.forces
    assert forces is not None
    moves, out = program.moves.cut_into_stretches(forces.stretches), []
    for k, own in enumerate(forces.stretches.move.tolist()):
        count = 2 if moves.bulge[k] == 0.0 else int(moves.length[k] / step) + 2
        share, ones = np.linspace(0, 1, count), np.ones(count)
        ends = (np.outer(ones, one[k, :2]) for one in (moves.start, moves.end))
        points = compute_path_points(*ends, moves.bulge[k] * ones, share)
        for sign in (1, -1):
            out.append(
                Load(points.tolist(), float(forces.force[own]), moment=sign * float(forces.torque[own]))
            )
    return tuple(out)


@pytest.mark.thorough
@pytest.mark.parametrize("kind", KINDS)
def test_a_program_asks_what_its_loads_do(kind: str) -> None:
    result = result_of(kind)
    program = result.query.program
    assert program is not None and len(result) >= 3
    loads = as_loads(program)
    found = figures(result, program)
    assert found == pytest.approx(figures(result, None, loads), rel=1e-4)
    assert (found >= figures(result, None, loads) * (1 - 1e-12)).all()
    # Of a user's load and a program the worse counts.
    heavy = (Load([(0, 0)], force=2000),)
    both = np.maximum(found, figures(result, None, heavy))
    assert figures(result, program, heavy) == pytest.approx(both)
    for index in range(3):
        cases = compute_load_cases(result[index], result.workpiece, result.toolkit, loads, jaw_force=4000.0)
        need = find_cutting_need(result, index, 4000.0)
        assert need is not None
        assert need.jaw.force == pytest.approx(max(case.needed.value for case in cases), rel=1e-4)
        assert need.jaw.force == pytest.approx(found[index, 1], rel=1e-12)
        largest = max(max(case.largest) for case in cases)
        assert need.contact.force == pytest.approx(largest, rel=1e-4) and need.jaw_force == 4000.0
        assert need.room == pytest.approx(4000.0 - need.jaw.force)
        constant = find_cutting_need(result, index, None, "constant")
        assert constant is not None and constant.room is None
        cases = compute_load_cases(result[index], result.workpiece, result.toolkit, loads, jaw="constant")
        assert constant.jaw.force == pytest.approx(cases[0].jaw_force, rel=1e-4)


def test_forces_twice_as_large_ask_for_twice_as_much() -> None:
    result = result_of("vise")
    program = result.query.program
    assert program is not None
    strong = pressing(program, 600.0).keep_forces_on(result.workpiece.outer_loops)
    once, twice = figures(result, program), figures(result, strong)
    assert twice == pytest.approx(2 * once) and (once > 0).all()


def test_a_path_shifted_with_its_zero_changes_nothing(tmp_path: Any) -> None:
    result = result_of("bolted")
    lines = ["G21 G90", "T1 M6", "G0 X{0} Y{1} Z3", "G1 Z-2 F100", "G1 X{2}", "G2 X{3} Y{4} I5 J0", "M30"]
    numbers = np.array([5.0, 3, 25, 35, 3])
    way = np.array([40.0, -7, 40, 40, -7])
    programs = []
    for name, shift, zero in (("a", 0, (0.0, 0.0)), ("b", 1, (-40.0, 7.0))):
        (tmp_path / name).write_text("\n".join(lines).format(*(numbers + shift * way)))
        programs.append(
            Program.read(tmp_path / name, {1: 8}, zero=zero, z_zero=12.0, cutting={"cutting_force": 300})
        )
    assert figures(result, programs[0]) == pytest.approx(figures(result, programs[1]))


@pytest.mark.parametrize("direction", ["any", "feed"])
def test_a_longer_path_never_asks_for_less(direction: Any) -> None:
    result = result_of("fence")
    program = result.query.program
    assert program is not None and program.forces is not None
    before = np.zeros((len(result), 2))
    names = ("line", "tool", "cutting", "start", "end", "bulge", "feed", "spindle")
    for count in (*range(1, len(program.moves), 3), len(program.moves)):
        part = Moves(*(getattr(program.moves, name)[:count] for name in names))
        whole = program.forces
        some = whole.stretches
        own = some.move < count
        cut = MoveStretches(some.move[own], some.first[own], some.last[own])
        columns = (whole.force[:count], whole.torque[:count], whole.axial[:count], whole.height[:count])
        forces = CuttingForces(*columns, direction, stretches=cut)
        found = figures(result, evolve(program, moves=part, forces=forces))
        assert (found >= before * (1 - 1e-12)).all()
        before = found
    every = figures(result, program)
    assert (before <= every * (1 + 1e-12)).all() and before.max() > 0
    assert (before == pytest.approx(every)) == (direction == "any")


def test_loads_of_a_program_rank_like_other_loads() -> None:
    result = result_of("vise")
    assert result.query.rank_by[5] == "load_reaction"
    bare = evolve(result.query.program, forces=None)
    assert evolve(result.query, program=bare, rank_by=None).rank_by[5] == "clamp_amplification"
    assert "load_reaction" not in result.query.without_program.rank_by
    weak = result_of("vise", jaw_force=1.0)
    assert weak[0].quality["warnings"] >= 1 and weak[0].quality["jaw_force_needed"] > 1


def test_words_say_who_asks() -> None:
    need = find_cutting_need(result_of("vise"), 0)
    program = result_of("vise").query.program
    assert need is not None and program is not None
    assert need.jaw.line in program.moves.line and need.jaw.tool in program.tools
    holes = [peg.hole for peg in result_of("vise")[0].pegs]
    assert need.jaw.element is not None and need.jaw.element.removeprefix("peg ") in holes
    still = evolve(
        program, forces=compute_cutting_forces(program.moves, program.tools, CuttingData(cutting_force=0))
    )
    none = find_cutting_need(
        evolve(result_of("vise"), query=evolve(result_of("vise").query, program=still)), 0
    )
    assert none is not None and none.jaw.line is None and none.jaw.force == 0
