"""Lessons: the fixtures of a lesson are those of the list, and their pegs lie on the chords that they name."""

from __future__ import annotations

import importlib.util
import json
import re
from math import cos, hypot, pi, radians, sin
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import workhold
from workhold import Fixture, Workpiece
from workhold.errors import InputError
from workhold.geometry.segment import Line
from workhold.kernels.chord.evaluation import compute_chord, find_parameter, measure_end_distance
from workhold.presenting.lesson import MOST_FACES, compute_lesson

ROOT = Path(__file__).parents[2]
PARTS = ["widget", "flange", "8Handle", str(ROOT / "examples" / "bracket.dxf")]


@pytest.fixture(scope="module", params=PARTS)
def taught(request: Any) -> tuple[Workpiece, dict[str, Any], list[Fixture]]:
    """A part with its lesson, and all fixtures of its vise with two pegs on each jaw."""
    part = workhold.load(request.param)
    made = compute_lesson(part)
    toolkit = made["toolkit"]
    vise = workhold.Vise(toolkit["pitch"], toolkit["columns"], toolkit["peg_radius"])
    return part, made, list(workhold.design(part, vise, types=["I"]))


def row_of(feature: list[float]) -> Any:
    """A feature's row as the kernels take it."""
    return np.array([*feature, 0.0, 0.0])


def slides(part: Workpiece, fixture: Fixture) -> bool:
    """Whether two pegs of one jaw touch parallel lines, so that they stand on no curve."""
    lines = {face.number: face.segment for face in part.faces}
    for pair in (fixture.pegs[:2], fixture.pegs[2:]):
        one, other = (lines[peg.face] for peg in pair)
        if isinstance(one, Line) and isinstance(other, Line):
            (ax, ay), (bx, by) = one.tangent, other.tangent
            if abs(ax * by - ay * bx) < 1e-9:
                return True
    return False


@pytest.mark.thorough
def test_fixtures_are_those_of_the_list(taught: Any) -> None:
    """All of them but those with pegs on a sliding pair, under their ranks, with pegs, pose and opening."""
    part, made, fixtures = taught
    assert made["found"] == len(fixtures)
    expected = [rank for rank, fixture in enumerate(fixtures, 1) if not slides(part, fixture)]
    assert sorted(one["rank"] for one in made["fixtures"]) == expected
    assert made["on_curves"] == len(expected) > 10
    for one in made["fixtures"]:
        fixture = fixtures[one["rank"] - 1]
        pegs = [[peg.column, peg.row, peg.x, peg.y, peg.face, peg.force] for peg in fixture.pegs]
        assert one["pegs"] == pegs
        assert one["opening"] == fixture.travel
        assert one["pose"] == [radians(fixture.pose.theta_deg), fixture.pose.x, fixture.pose.y]


def test_pegs_stand_on_their_chords(taught: Any) -> None:
    """At the fixture's orientation the chord's tail and head are where the pegs are, on the faces they touch."""
    _, made, fixtures = taught
    for one in made["fixtures"]:
        pose = fixtures[one["rank"] - 1].pose.inverse
        for number, (tail, head, swapped, shift, length, branch, low, high) in enumerate(one["chords"]):
            psi = -one["pose"][0]
            assert low - 1e-6 <= psi <= high + 1e-6
            assert high - low < 2 * pi + 1e-9
            pegs = one["pegs"][2 * number : 2 * number + 2]
            first, second = pegs[::-1] if swapped else pegs
            assert [made["faces"][tail], made["faces"][head]] == [first[4], second[4]]
            ux, uy = compute_chord(
                row_of(made["features"][tail]), row_of(made["features"][head]), length, psi + shift, branch
            )[:2]
            ends = (ux, uy), (ux + length * cos(psi + shift), uy + length * sin(psi + shift))
            for (x, y), peg in zip(ends, (first, second), strict=True):
                px, py = pose.apply(peg[2], peg[3])
                assert hypot(x - px, y - py) < 1e-8


def test_chords_exist_just_between_their_ends(taught: Any) -> None:
    """Inside the range both ends lie on their features; a little outside one does not, or there is no chord."""
    _, made, _ = taught
    seen = 0
    for one in made["fixtures"]:
        for tail, head, _, shift, length, branch, low, high in one["chords"]:
            a, b = row_of(made["features"][tail]), row_of(made["features"][head])

            def fits(psi: float, a: Any = a, b: Any = b, given: Any = (shift, length, branch)) -> bool:
                shift, length, branch = given
                w = length * cos(psi + shift), length * sin(psi + shift)
                ux, uy, *_ = compute_chord(a, b, length, psi + shift, branch)
                ends = (
                    measure_end_distance(a, find_parameter(a, ux, uy)),
                    measure_end_distance(b, find_parameter(b, ux + w[0], uy + w[1])),
                )
                return bool(
                    min(ends) >= -1e-5 and abs(off(a, ux, uy)) + abs(off(b, ux + w[0], uy + w[1])) < 1e-6
                )

            assert all(fits(low + share * (high - low)) for share in (1e-4, 0.3, 0.7, 1 - 1e-4))
            seen += not fits(low - 0.02) and not fits(high + 0.02)
    assert seen > len(made["fixtures"])


def off(row: Any, x: float, y: float) -> float:
    """The distance in mm of a point from the line or circle of a feature."""
    if row[0] == 0.0:
        return float((x - row[1]) * row[4] - (y - row[2]) * row[3])
    return float(hypot(x - row[1], y - row[2]) - row[6])


def test_a_part_that_nothing_holds_is_refused() -> None:
    """A disc turns between any pegs."""
    disc = Workpiece.from_loops("disc", [[[0.0, 0.0, 1.0], [30.0, 0.0, 1.0]]])
    with pytest.raises(
        InputError, match=r"no vise that was tried holds disc .* choose a part with more sides"
    ):
        compute_lesson(disc)


def test_short_faces_of_a_detailed_part_are_left_alone() -> None:
    """No peg touches them, so the search ends soon, and the lesson says how many they are."""
    teeth = 30
    corners = [[2.0 * k, 0.0 if k % 2 else 1.0, 0.0] for k in range(teeth)]
    comb = Workpiece.from_loops("comb", [[*corners, [70.0, 0.0, 0.0], [75.0, 40.0, 0.0], [-8.0, 50.0, 0.0]]])
    longer = comb.loops[0].tolist()
    assert len(comb.faces) <= MOST_FACES and compute_lesson(comb)["faces_left_out"] == 0
    more = [[1.0 * k, 0.0 if k % 2 else 1.0, 0.0] for k in range(2 * teeth)]
    fine = Workpiece.from_loops("fine", [[*more, *longer[-3:]]])
    made = compute_lesson(fine)
    assert made["faces_left_out"] == len(fine.faces) - MOST_FACES > 10
    lengths = {face.number: face.segment.length for face in fine.faces}
    least = sorted(lengths.values())[-MOST_FACES]
    assert all(lengths[peg[4]] >= least for one in made["fixtures"] for peg in one["pegs"])


@pytest.mark.thorough
def test_the_examples_of_the_page_are_what_the_program_says() -> None:
    """The script that the page brings along holds the lessons of today, number by number."""
    place = ROOT / "building" / "lessons.py"
    spec = importlib.util.spec_from_file_location("lessons", place)
    assert spec is not None and spec.loader is not None
    lessons = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(lessons)
    found = re.search(r"const EXAMPLES = (.*);", lessons.PLACE.read_text(encoding="utf-8"))
    assert found is not None
    kept = json.loads(found[1])
    assert alike(kept, lessons.make_examples())


def alike(one: Any, other: Any) -> bool:
    """Whether plain data agree, numbers to within 1e-9."""
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(alike(one[key], other[key]) for key in one)
    if isinstance(one, list):
        return len(one) == len(other) and all(map(alike, one, other))
    if isinstance(one, float | int) and not isinstance(one, bool):
        return bool(abs(one - other) <= 1e-9 * max(1.0, abs(one)))
    return bool(one == other)
