"""A program's forces on supports: thrust, pull and heights by hand, and the clamp that they ask for."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from attrs import evolve

from workhold import Program, Query, Vise, Workpiece, answer
from workhold.model.cutting_forces import compute_cutting_forces
from workhold.model.cutting_tool import CuttingData, Cylinder, Tool
from workhold.model.moves import Moves
from workhold.model.support_request import SpatialLoad
from workhold.supports.program import list_acting_loads, make_cutting_loads

PART = Workpiece.from_loops("part", [[[0, 0, 0], [100, 0, 0], [96, 60, 0], [4, 55, 0]]])
VISE = Vise(pitch=20, columns=5, peg_radius=3)


def program_of(rows: list[tuple[Any, ...]], kind: str = "", **cutting: Any) -> Program:
    """A program of one tool of 10 mm from rows of start, end and bulge, whose Z0 is 20 mm up."""
    moves = Moves.from_rows([(k, 1, True, *row, 100.0, 900.0) for k, row in enumerate(rows, 1)])
    tools = {1: Tool(1, [Cylinder(0, 60, 5)], 10, kind=kind)}
    bare = Program("p.nc", "0" * 64, "mm", (0.0, 0.0), 20.0, tools=tools, moves=moves)
    return evolve(
        bare, forces=compute_cutting_forces(moves, tools, CuttingData(cutting_force=400, **cutting))
    )


SLOT = [((20, 30, 15), (80, 30, 15), 0.0)]
HOLE = [((50, 30, 22), (50, 30, -2), 0.0)]


def test_loads_by_hand() -> None:
    one, other = make_cutting_loads(program_of(SLOT, cut_depth=4, helix_angle=45), 20.0)
    assert one.points == ((20.0, 30.0), (80.0, 30.0)) and one.force == 400 and one.heights == (17.0, 17.0)
    assert one.axial == pytest.approx((-400.0, 0.0)) and (one.moment, other.moment) == (2000.0, -2000.0)
    drill, _ = make_cutting_loads(program_of(HOLE, "drill"), 20.0)
    # What comes out below acts on the part at its lower side.
    assert drill.force == 0 and drill.axial == pytest.approx((0.0, 560.0)) and drill.heights == (0.0, 20.0)
    assert drill.points == ((50.0, 30.0),) and drill.name == "T1 drilling"
    # Any other tool plunges: what it mills with presses down.
    plunge, _ = make_cutting_loads(program_of(HOLE), 20.0)
    assert (plunge.axial, plunge.moment, plunge.name) == ((0.0, 400.0), 2000.0, "T1 plunging")


def test_an_arc_lies_inside_its_load() -> None:
    (load, _) = make_cutting_loads(program_of([((30, 30, 15), (70, 30, 15), 1.0)]), 20.0)
    angle = np.linspace(np.pi, 2 * np.pi, 50)
    for x, y in zip(50 + 20 * np.cos(angle), 30 + 20 * np.sin(angle), strict=True):
        corners = np.array([*load.points, load.points[0]])
        side, off = np.diff(corners, axis=0), np.array([x, y]) - corners[:-1]
        assert (side[:, 0] * off[:, 1] - side[:, 1] * off[:, 0] >= -1e-9).all()
    assert np.hypot(*(np.array(load.points) - [50, 30]).T).max() < 20 * 1.09


@pytest.mark.thorough
def test_a_program_holds_the_clamp_down_as_its_loads_do() -> None:
    program = program_of([*SLOT, *HOLE], cut_depth=4)
    query = Query(PART, VISE, program=program, peg_height=8.0, best=60)
    result = answer(query, threads=1)
    fixture = next(one for one in result if one.supports(20.0, best=1).triples)
    mine = fixture.supports(20.0, best=1)
    assert mine.loads == make_cutting_loads(program, 20.0) == list_acting_loads(query, 20.0)
    given = fixture.supports(20.0, best=1, loads=list(mine.loads))
    assert mine.triples[0].best.clamp_needed == given.triples[0].best.clamp_needed > 0
    twice = [evolve(one, force=2 * one.force, moment=2 * one.moment) for one in mine.loads]
    twice = [evolve(one, axial=(2 * one.axial[0], 2 * one.axial[1])) for one in twice]
    double = fixture.supports(20.0, best=1, loads=twice)
    assert double.triples[0].best.clamp_needed == pytest.approx(2 * mine.triples[0].best.clamp_needed)
    assert all(isinstance(one, SpatialLoad) for one in mine.loads)
