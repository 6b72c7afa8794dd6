"""Two pegs of a jaw that moves towards a wall: complete sets, found by an independent and slow search."""

from __future__ import annotations

import json
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from attrs import evolve

from workhold import Fence, Query, Workpiece
from workhold.contact.problem import Problem
from workhold.model.toolkit import Carrier, Travel
from workhold.search.sliding_pegs import SlidingPegs, outward_rows, sliding_pegs, steps_between
from workhold.search.wall_closure import closure
from workhold.search.wall_search import WallSearch

COMPLETE = sorted((Path(__file__).parent.parent / "data" / "toolkits").glob("flat_*.json"))


def jaw_of(toolkit: dict[str, Any]) -> Carrier:
    """The jaw that moves, whose travel is the height of its first row above the wall."""
    size = tuple(toolkit["pitch"]), toolkit["columns"], toolkit["rows"], toolkit["peg_radius"], toolkit["peg_radius"]
    travel = Travel(pi / 2, toolkit["min_gap"], toolkit["max_opening"])
    return Carrier("jaw", *size, travel=travel, noun="jaw", peg="peg")


def fixtures_of(workpiece: Workpiece, jaw: Carrier) -> list[tuple[float, ...]]:
    """Orientation in degrees, faces and rows of the pegs, columns between them, where the first is along the hull edge, the
    opening, and the forces of wall and pegs per unit of force along the jaw's motion; each fixture once."""
    fence = Fence(jaw.pitch, jaw.peg_radius, wall_offset=jaw.peg_radius, columns=jaw.columns, rows=jaw.rows)
    problem = Problem.of(Query(workpiece, fence))
    search, steps = WallSearch(problem), steps_between(jaw, problem.diameter)
    out = set()
    for edge in search.edges:
        lying = search.laid(edge)
        for pegs in sliding_pegs(lying, problem.standing, jaw, steps, 0.0):
            null, push, held, is_open = closure(lying, pegs.one, pegs.two, np.arange(len(pegs.step)), None, problem)
            assert not is_open.any()
            back, fits = outward_rows(pegs.height, pegs.step, jaw)
            for k in np.flatnonzero(held & fits).tolist():
                out.add(one_fixture(edge, pegs, int(back[k]), null[k] / (null[k, 3] * push[k]), k, problem, jaw))
    return sorted(out)


def one_fixture(
    edge: int, pegs: SlidingPegs, back: int, force: Any, k: int, problem: Problem, jaw: Carrier
) -> tuple[float, ...]:
    """One fixture, rounded."""
    angle = np.degrees(problem.workpiece.flush.theta[edge])
    column, row = pegs.step[k].tolist()
    faces = problem.faces[[pegs.one.feature[k], pegs.two.feature[k]]].tolist()
    opening = pegs.height[k] - back * jaw.pitch[1]
    rows = back - min(row, 0), back + max(row, 0)
    return tuple(np.round([angle, *faces, *rows, column, pegs.one.point[k, 0], opening, *force], 5) + 0.0)


def written(truth: dict[str, Any]) -> list[tuple[float, ...]]:
    """The fixtures of a complete set in the same form."""
    out = []
    for fixture in truth["fixtures"]:
        wall, (one, two) = fixture["wall"], fixture["pegs"]
        place = one["x"] - wall["from"][0], fixture["jaw_separation"]
        forces = *wall["forces"], one["force"], two["force"]
        holes = one["row"], two["row"], two["column"] - one["column"]
        angle = fixture["pose"]["theta_deg"] % 360
        row = [angle, one["segment"], two["segment"], *holes, *place, *forces]
        out.append(tuple(np.round(row, 5) + 0.0))
    return sorted(out)


@pytest.mark.parametrize("path", COMPLETE, ids=lambda path: path.stem)
def test_complete_set_is_reproduced(path: Path) -> None:
    """Every fixture of the set and no other, with its forces; nothing is left open by the bounds of the error."""
    truth = json.loads(path.read_text())
    workpiece = Workpiece.from_loops("part", truth["workpiece"]["loops"])
    found, expected = fixtures_of(workpiece, jaw_of(truth["toolkit"])), written(truth)
    assert len(found) == len(expected) == truth["counts"]["flat"]
    if found:
        np.testing.assert_allclose(np.array(found), np.array(expected), atol=2e-5)


KITE = Workpiece.from_loops("kite", [[[0, 0, 0], [56, 6, 0], [48, 44, 0], [10, 37, 0.3]]])
JAW = jaw_of({"pitch": [12, 10], "columns": 4, "rows": 5, "peg_radius": 2, "min_gap": 12, "max_opening": 45})


def places_of(jaw: Carrier) -> set[tuple[float, ...]]:
    """Fixtures by orientation, faces and the place of the first peg, whatever the numbers of its holes."""
    found = fixtures_of(KITE, jaw)
    return {(*one[:3], round(one[6], 3), round(one[7] + jaw.pitch[1] * one[3], 3)) for one in found}


def test_half_the_pitch_loses_none_and_limits_take_away_only() -> None:
    """Of columns and rows one less than twice as many are as far apart."""
    here = places_of(JAW)
    finer = evolve(JAW, pitch=(6, 5), columns=7, rows=9)
    assert here < places_of(finer) and len(here) > 10
    for limit in ({"rows": 3}, {"columns": 2}, {"travel": Travel(pi / 2, 20, 45)}, {"travel": Travel(pi / 2, 12, 19)}):
        fewer = places_of(evolve(JAW, **limit))
        assert fewer < here and fewer, limit


def test_pegs_stand_back_no_farther_than_the_largest_opening_demands() -> None:
    """Row by row, as long as the jaw has rows and does not come too near."""
    heights = np.array([44.0, 46.0, 56.0, 66.0, 86.0])
    steps = np.array([[0, 1], [0, -1], [2, 2], [1, 2], [1, 0]])
    back, fits = outward_rows(heights, steps, JAW)
    assert back.tolist() == [0, 1, 2, 3, 5] and fits.tolist() == [True, True, True, False, False]
    back, fits = outward_rows(heights[:2], steps[:2], evolve(JAW, travel=Travel(pi / 2, 41.0, 45.0)))
    assert back.tolist() == [0, 1] and fits.tolist() == [True, False]


def test_a_mirrored_part_has_the_mirrored_set() -> None:
    """With the first peg and the second one, and the ends of the wall, in turn."""
    mirrored = Workpiece.from_loops("mirrored", [[[0, 0, 0.3], [-10, 37, 0], [-48, 44, 0], [-56, 6, 0]]])
    jaw = evolve(JAW, columns=None, rows=None)
    here, there = fixtures_of(KITE, jaw), fixtures_of(mirrored, jaw)
    openings = [sorted((one[7], *sorted(one[8:])) for one in found) for found in (here, there)]
    np.testing.assert_allclose(openings[0], openings[1], atol=1e-4)
    assert len(here) > 20
