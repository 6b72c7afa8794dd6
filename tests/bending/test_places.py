"""Where tools and loads press on a part, and with what."""

from __future__ import annotations

import numpy as np
import pytest
from attrs import evolve

import workhold
from bent_bodies import METAL, need_elements
from workhold import Load, Program, Result
from workhold.bending import meshing, places
from workhold.bending.asking import BendingQuestion, find_bendings
from workhold.bending.places import CutterLoads, list_cutter_loads
from workhold.bending.shape import PrismShape
from workhold.model.cutting_forces import compute_cutting_forces
from workhold.model.cutting_tool import CuttingData, Cylinder, Tool
from workhold.model.moves import Moves
from workhold.units import MILLIMETRE

need_elements()

HIGH = 8.0
CORNERS = [(0, 0), (80, 0), (80, 30), (50, 60), (0, 60)]


@pytest.fixture(autouse=True)
def coarse(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(meshing, "TETRAHEDRA", 150)


def result_with(*loads: Load) -> Result:
    part = workhold.Workpiece.from_points("plate", CORNERS)
    vise = workhold.Vise(pitch=10, columns=3, peg_radius=3)
    return workhold.design(part, vise, best=1, thickness=HIGH, loads=list(loads), jaw_force=3000.0)


def loads_at(points: list[tuple[float, float, float]], row: int = 0) -> CutterLoads:
    """A tool that presses with 10 N in any direction, 3 to 5 N down and 7 N mm, at some points."""
    count = len(points)
    return CutterLoads(
        np.array(points), np.full(count, 10.0), np.full(count, 7.0), np.tile([3.0, 5.0], (count, 1)),
        np.zeros(count), np.full(count, np.pi), np.full(count, row),
    )  # fmt: skip


def test_a_tool_presses_every_way_down_and_either_way_round() -> None:
    vectors = loads_at([(0, 0, 0)]).list_vectors(0)
    assert len(vectors) == places.DIRECTIONS * 4
    assert np.hypot(*vectors[:, :2].T) == pytest.approx(10.0)
    assert set(vectors[:, 2]) == {-3.0, -5.0} and set(vectors[:, 3]) == {7.0, -7.0}
    # A load turns the one way that is told.
    assert set(loads_at([(0, 0, 0)], -1).list_vectors(0)[:, 3]) == {7.0}


def test_places_far_apart_are_chosen_and_others_are_looked_at_at_the_nearest() -> None:
    random = np.random.default_rng(2)
    points = random.uniform(0, 50, size=(60, 3))
    loads = loads_at([tuple(one) for one in points.tolist()])
    assert len(set(loads.chosen.tolist())) == len(loads.chosen) == places.MOST_PLACES
    away = np.linalg.norm(points[:, None] - points[loads.chosen], axis=2)
    assert away[np.arange(60), loads.owner] == pytest.approx(away.min(axis=1))


def test_a_load_acts_at_its_height_and_pulls_up_as_told() -> None:
    up = Load(points=[(20, 20), (60, 10)], force=50, directions=30, height=2.0, upward=40.0, moment=300.0)
    high = Load(points=[(20, 20)], force=50, height=99.0)
    part = workhold.Workpiece.from_points("plate", CORNERS)
    vise = workhold.PlainVise(jaw_width=150, max_opening=120, jaw_height=40)
    found = list_cutter_loads(
        workhold.design(part, vise, best=1, thickness=HIGH, loads=[up, high]).query, HIGH
    )
    assert found is not None and found.row.tolist() == [-1, -1, -2]
    assert found.points[:, 2].tolist() == [2.0, 2.0, HIGH]
    (vector,) = found.list_vectors(0).tolist()
    angle = np.radians(30)
    assert vector == pytest.approx([50 * np.cos(angle), 50 * np.sin(angle), 40.0, 300.0])


def test_a_program_presses_from_end_to_end_of_its_cuts_and_names_the_line() -> None:
    result = result_with()
    rows = [((5, 30, 7), (70, 30, 7), 0.0), ((5, 5, 7), (10, 5, 7), 0.0)]
    moves = Moves.from_rows(
        [(line, 1, True, *row, 100.0, 900.0) for line, row in zip((6, 10), rows, strict=True)]
    )
    tools = {1: Tool(1, [Cylinder(0, 60, 5)], 10)}
    bare = Program("p.nc", "0" * 64, "mm", (0.0, 0.0), HIGH, tools=tools, moves=moves)
    forces = compute_cutting_forces(moves, tools, CuttingData(cutting_force=400, cut_depth=1))
    query = evolve(result.query, program=evolve(bare, forces=forces), peg_height=HIGH)
    found = list_cutter_loads(query, HIGH)
    assert found is not None and found.points[:, 0].max() == pytest.approx(70.0)
    apart = np.diff(np.unique(found.points[np.abs(found.points[:, 1] - 30.0) < 1e-6, 0]))
    assert apart.max() <= places.APART + 1e-9
    question = BendingQuestion(METAL, HIGH, 3000.0)
    give = find_bendings(evolve(result, query=query), [0], PrismShape(result.workpiece, HIGH), question)[
        0
    ].give
    assert give is not None and give.tool == 1 and give.load is None
    lines = {6: 30.0, 10: 5.0}
    assert give.line in lines and give.at[1] == pytest.approx(lines[give.line])
    assert f"in line {give.line} with T1" in give.describe(MILLIMETRE)
