"""The plate with a translating clamp: complete sets, planted fixtures, and the theorems that hold of it."""

from __future__ import annotations

import json
from itertools import product
from math import cos, pi, sin
from pathlib import Path
from random import Random
from typing import Any

import attrs
import numpy as np
import pytest
from numpy.typing import NDArray

from strategies import random_outline
from toolkit_results import MOUTH, NOTCHED, check_and_read_back, checked, part
from workhold import InputError, Plate, Query, Restrictions, Result, Vise, Workpiece, answer, design
from workhold.algebra import find_fixtures_by_algebra
from workhold.search.explaining import explain

TESTS = Path(__file__).parent.parent
# The largest is compared by ``make prove``.
COMPLETE = [
    pytest.param(path, marks=pytest.mark.prove if path.stem == "clamp_rocker_16_plate_travel" else ())
    for path in sorted((TESTS / "data" / "toolkits").glob("clamp_*.json"))
]


def plate_of(truth: dict[str, Any]) -> Plate:
    """The plate of a complete set."""
    fields = dict(truth["toolkit"])
    assert fields.pop("kind") == Plate.kind
    return Plate(**fields)


@pytest.mark.thorough
@pytest.mark.parametrize("path", COMPLETE, ids=lambda path: path.stem)
def test_complete_set_is_reproduced(path: Path, tmp_path: Path) -> None:
    """Every fixture of the set and no other, each by itself beyond reproach; and nothing undecided."""
    truth = json.loads(path.read_text())
    result = design(
        Workpiece.from_loops(truth["workpiece"]["name"], truth["workpiece"]["loops"]), plate_of(truth)
    )
    assert result.proof is not None and result.proof.undecided == ()
    assert result.counts == truth["counts"]
    assert "0 missing, 0 extra" in checked(result, tmp_path / "result.json", path)


@pytest.mark.thorough
@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    "loop", [NOTCHED, pytest.param(MOUTH, marks=pytest.mark.prove)], ids=["notched", "mouth"]
)
@pytest.mark.parametrize(
    "fields",
    [
        {"pitch": (20, 16), "directions": ("-x", "+y"), "clamp_radius": 9.0},
        {"pitch": (12, 10), "columns": 5, "rows": 6, "directions": ("-x",), "clamp_radius": 5.0},
        {"pitch": 20, "columns": 4, "rows": 3, "travel": (4.0, 24.0), "directions": ("+x", "-y")},
        {
            "pitch": (12, 10),
            "columns": 6,
            "rows": 6,
            "travel": (3.0, 40.0),
            "directions": ("-x",),
            "clamp_radius": 4.0,
        },
    ],
)
def test_every_fixture_stands_before_the_checker_and_reads_back(
    fields: dict[str, Any], loop: list[tuple[float, ...]], tmp_path: Path
) -> None:
    """Also with a clamp of another radius than the locators, and in the order of JSON and of columns."""
    result = design(part(loop), Plate(peg_radius=3, **fields))
    assert len(result) > 3
    check_and_read_back(result, tmp_path)
    for fixture in list(result)[:20]:
        assert fixture.direction in {"-x", "+x", "-y", "+y"}
        assert [peg.carrier for peg in fixture.pegs] == ["plate"] * 3 + [f"clamp {fixture.direction}"]


def in_part(result: Result, mirrored: bool = False) -> set[tuple[Any, ...]]:
    """Fixtures as seen from the part: places of locators and tip and the way the clamp pushes, to a thousandth of a mm."""
    seen = set()
    for fixture in result:
        assert fixture.direction is not None
        back = fixture.pose.inverse
        sign, axis = (1 if fixture.direction[0] == "+" else -1), fixture.direction[1]
        push = back.turn(sign * (axis == "x"), sign * (axis == "y"))
        points = [back.apply(peg.x, peg.y) for peg in fixture.pegs]
        flip = -1 if mirrored else 1
        rounded = [(round(flip * x, 3) + 0.0, round(y, 3) + 0.0) for x, y in (*points, push)]
        seen.add((tuple(sorted(rounded[:3])), *rounded[3:]))
    return seen


def test_half_a_turn_of_the_plate_makes_the_one_way_into_the_other() -> None:
    """The same fixtures as seen from the part; and both ways asked for list none twice."""
    one, other = (design(part(NOTCHED), Plate(20, 3, directions=[name])) for name in ("-x", "+x"))
    assert in_part(one) == in_part(other) and len(one) > 50
    both = design(part(NOTCHED), Plate(20, 3, directions=["+x", "-x"]))
    assert in_part(both) == in_part(one) and len(both) == len(one)
    assert {fixture.direction for fixture in both} == {"-x"}


def test_a_quarter_turn_swaps_pitch_and_limits() -> None:
    """Pushing along -y on one pitch is pushing along -x on the other, with columns and rows swapped."""
    upright = Plate((14, 20), 3, columns=3, rows=4, directions=["-y"], travel=(3, 18))
    lying = Plate((20, 14), 3, columns=4, rows=3, directions=["-x"], travel=(3, 18))
    one, other = design(part(NOTCHED), upright), design(part(NOTCHED), lying)
    assert in_part(one) == in_part(other) and len(one) > 10


def test_turning_and_moving_the_part_changes_poses_only_and_a_mirrored_part_has_the_mirrored_set() -> None:
    plate = Plate(20, 3)
    here = design(part(NOTCHED), plate)
    c, s = cos(0.7), sin(0.7)
    there = design(part([(c * x - s * y + 300, s * x + c * y - 40, b) for x, y, b in NOTCHED]), plate)
    assert there.counts == here.counts
    assert np.allclose(
        np.sort(here.table.null_vector.min(axis=1)), np.sort(there.table.null_vector.min(axis=1))
    )
    # The mirrored part, its loop run the other way, and the mirrored plate: a clamp along -y stays one.
    loop = NOTCHED[::-1]
    flipped = [(-x, y, loop[(k + 1) % len(loop)][2]) for k, (x, y, _) in enumerate(loop)]
    upright = attrs.evolve(plate, directions=["-y"])
    assert in_part(design(part(flipped), upright), mirrored=True) == in_part(design(part(NOTCHED), upright))


def test_larger_plates_and_longer_strokes_hold_all_that_smaller_ones_hold() -> None:
    """Columns, rows and travel are limits only."""
    small = Plate(20, 3, columns=4, rows=3, travel=(5, 12), directions=["-x"])
    few = in_part(design(part(NOTCHED), small))
    assert few
    for change in (
        {"columns": 5},
        {"rows": 4},
        {"travel": (5, 20)},
        {"travel": (2, 12)},
        {"columns": None, "rows": None},
    ):
        assert few <= in_part(design(part(NOTCHED), attrs.evolve(small, **change)))
    every = in_part(design(part(NOTCHED), Plate(20, 3)))
    assert few < every


@pytest.mark.thorough
def test_a_rectilinear_part_is_touched_from_all_four_sides_and_a_plain_rectangle_never_square() -> None:
    """Each fixture touches one face of each of the four directions."""
    ell = [(0, 0, 0), (60, 0, 0), (60, 24, 0), (26, 24, 0), (26, 58, 0), (0, 58, 0)]
    workpiece = part(ell)
    result = design(workpiece, Plate(20, 3))
    assert len(result) > 20
    normals = {face.number: face.segment.compute_normal(0.0) for face in workpiece.faces}
    for fixture in result:
        assert len({tuple(np.round(normals[peg.face], 6)) for peg in fixture.pegs}) == 4
    rectangle = design(
        part([(0, 0, 0), (100, 0, 0), (100, 60, 0), (0, 60, 0)]), Plate(20, 3, columns=8, rows=6)
    )
    assert len(rectangle) > 0
    assert all(abs(fixture.pose.theta_deg % 90 - 45) < 44.9 for fixture in rectangle)


def test_a_part_of_arcs_about_one_centre_is_held_by_nothing() -> None:
    ring = design(part([(-20, 0, 1), (20, 0, 1)], [(-8, 0, -1), (8, 0, -1)]), Plate(10, 2))
    assert len(ring) == 0 and ring.complete
    assert ring.notes


@pytest.mark.thorough
@pytest.mark.parametrize("columns", [2, 3])
def test_which_fixtures_of_a_plate_a_vise_can_hold(columns: int) -> None:
    """The paper's claim, made exact: with the same pitch and radius, a vise's fixtures of Type II are those of a plate whose
    tip is the smallest gap or more to the right of every locator and whose locators span no more columns."""
    gap = 9.0
    vise = design(part(NOTCHED), Vise(pitch=10, columns=columns, peg_radius=3, min_gap=gap), types="II")
    plate = design(part(NOTCHED), Plate(10, 3, directions=["-x"]))
    as_clamps = set()
    for fixture in vise:
        back = fixture.pose.inverse
        points = [back.apply(peg.x, peg.y) for peg in fixture.pegs]
        rounded = [(round(x, 3) + 0.0, round(y, 3) + 0.0) for x, y in (*points, back.turn(-1, 0))]
        as_clamps.add((tuple(sorted(rounded[:3])), *rounded[3:]))
    held, rest = set(), 0
    for fixture, seen in zip(plate, (in_part([one]) for one in plate), strict=True):  # type: ignore[arg-type]
        *locators, tip = fixture.pegs
        wide = max(peg.column for peg in locators) - min(peg.column for peg in locators) < columns
        if wide and tip.x - max(peg.x for peg in locators) >= gap - 1e-9:
            held |= seen
        else:
            rest += 1
    assert as_clamps == held and len(held) > 5
    # Most a vise cannot hold.
    assert rest > len(held)


@pytest.mark.thorough
@pytest.mark.parametrize(
    "seed", [1, *(pytest.param(seed, marks=pytest.mark.prove) for seed in (2, 5, *range(6, 60)))]
)
def test_planted_fixtures_are_found(seed: int) -> None:
    """Triangles and quadrangles cut around four chosen pegs on a plate: that fixture is listed."""
    random = np.random.default_rng(seed)
    found = 0
    while found < 3:
        pitch, radius = random.uniform(12, 20, 2), 3.0
        holes = random.integers(0, 4, (3, 2))
        tip = np.array([random.uniform(0, 70), float(random.integers(0, 4)) * pitch[1]])
        places = np.vstack([holes * pitch, tip])
        apart = np.hypot(*(places[:, None] - places[None]).T)[np.triu_indices(4, 1)]
        normals = random.uniform(0, 2 * pi, 4)
        outward = np.stack([np.cos(normals), np.sin(normals)], axis=1)
        if apart.min() < 2 * radius + 1 or -outward[3, 0] > -0.1:
            continue
        corners = polygon(outward, ((places - radius * outward) * outward).sum(axis=1))
        if corners is None:
            continue
        try:
            workpiece = part([(*corner, 0.0) for corner in corners])
        except InputError:
            continue
        wrenches = np.column_stack([outward, places[:, 0] * outward[:, 1] - places[:, 1] * outward[:, 0]])
        null = np.linalg.svd(wrenches.T)[2][-1]
        if not (np.all(null > 0.02) or np.all(null < -0.02)) or not stands(corners, places, outward, radius):
            continue
        seen = in_part(design(workpiece, Plate(tuple(pitch), radius, directions=["-x"])))
        wanted = [(round(x, 3) + 0.0, round(y, 3) + 0.0) for x, y in places]
        assert (tuple(sorted(wanted[:3])), wanted[3], (-1.0, 0.0)) in {
            (locators, tip, push) for locators, tip, push in seen
        }
        found += 1


def polygon(normals: np.ndarray, offsets: np.ndarray) -> np.ndarray | None:
    """Corners of the bounded polygon n . q <= offset with an edge for each half plane, or None."""
    order = np.argsort(np.arctan2(normals[:, 1], normals[:, 0]))
    corners = []
    for k, m in zip(order, np.roll(order, -1), strict=True):
        if normals[k, 0] * normals[m, 1] - normals[k, 1] * normals[m, 0] < 0.1:
            return None
        corners.append(np.linalg.solve(normals[[k, m]], offsets[[k, m]]))
    inside = np.array(corners) @ normals.T <= offsets + 1e-9
    return np.array(corners) if inside.all() else None


def stands(corners: np.ndarray, places: np.ndarray, normals: np.ndarray, radius: float) -> bool:
    """Whether every peg touches inside an edge of the polygon and none is in it."""
    edges = np.roll(corners, -1, axis=0) - corners
    lengths = np.hypot(*edges.T)
    if lengths.min() < 8 or lengths.max() > 200:
        return False
    for place, normal in zip(places, normals, strict=True):
        touching = place - radius * normal
        along = ((touching - corners) * edges).sum(axis=1) / lengths
        off = (
            np.abs((touching - corners)[:, 0] * edges[:, 1] - (touching - corners)[:, 1] * edges[:, 0])
            / lengths
        )
        if not any(
            o < 1e-9 and 0.5 < a < length - 0.5 for o, a, length in zip(off, along, lengths, strict=True)
        ):
            return False
    return True


@pytest.mark.thorough
def test_the_best_are_those_of_the_whole_list_and_threads_change_nothing() -> None:
    plate = Plate((20, 16), 3, directions=["-x", "-y"])
    whole = design(part(NOTCHED), plate, threads=1)
    best = design(part(NOTCHED), plate, best=7, threads=2)
    assert list(best) == list(whole)[:7]
    assert design(part(NOTCHED), plate, threads=2).table == whole.table


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"pitch": 0, "peg_radius": 3}, "pitch 0"),
        ({"pitch": 5, "peg_radius": 3}, "overlap"),
        ({"pitch": 20, "peg_radius": 3, "travel": (5, 2)}, "travel 5 to 2"),
        ({"pitch": 20, "peg_radius": 3, "travel": 5}, "not two lengths"),
        ({"pitch": 20, "peg_radius": 3, "directions": ["left"]}, "'left'"),
        ({"pitch": 20, "peg_radius": 3, "directions": []}, "no direction"),
        ({"pitch": 20, "peg_radius": 3, "columns": 0}, "columns 0"),
        ({"pitch": 20, "peg_radius": 3, "columns": 10**6, "rows": 10**6}, "holes is beyond"),
        ({"pitch": 20, "peg_radius": 3, "clamp_radius": -1}, "clamp radius -1"),
        ({"pitch": 20, "peg_radius": float("nan")}, "peg radius nan"),
    ],
)
def test_plates_that_cannot_be_are_refused_in_one_sentence(fields: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        Plate(**fields)


@pytest.mark.thorough
def test_restrictions_leave_what_filtering_the_whole_list_leaves() -> None:
    """Faces to avoid and angles, with both directions."""
    plate = Plate((20, 16), 3, directions=["-x", "-y"])
    whole = design(part(NOTCHED), plate)
    for face, (low, high) in product((1, 4), ((20.0, 140.0), (0.0, 360.0))):
        asked = Restrictions(avoid=(face,), angles=((low, high),))
        some = design(part(NOTCHED), plate, restrictions=asked)
        wanted = [
            fixture
            for fixture in whole
            if all(peg.face != face for peg in fixture.pegs) and low <= fixture.pose.theta_deg <= high
        ]
        assert in_part(some) == in_part(wanted) and wanted  # type: ignore[arg-type]


def test_directions_left_out_are_those_that_a_turn_of_the_plate_does_not_make() -> None:
    """One where a quarter turn leaves the plate as it is, two where it does not."""
    assert Plate(20, 3).directions == Plate(20, 3, columns=5, rows=5).directions == ("-x",)
    for fields in ({"pitch": (20, 16)}, {"pitch": 20, "columns": 5, "rows": 4}, {"pitch": 20, "columns": 5}):
        assert Plate(peg_radius=3, **fields).directions == ("-x", "-y")


@pytest.mark.thorough
@pytest.mark.parametrize("loop", [NOTCHED, [(0, 0, 0), (60, 0, 0), (60, 40, 0.2), (0, 40, 0)]])
def test_both_engines_list_the_same_fixtures(loop: list[tuple[float, ...]]) -> None:
    """The paper's algebra knows three pegs and one: with a clamp of the locators' radius it serves a plate."""
    query = Query(part(loop), Plate((20, 16), 3, columns=4, rows=4, travel=(4, 40)))
    one, other = find_fixtures_by_algebra(query), answer(query)
    assert one.counts == other.counts and len(other) > 20
    assert in_part(one) == in_part(other)
    with pytest.raises(InputError, match="carriers are not alike"):
        find_fixtures_by_algebra(attrs.evolve(query, toolkit=Plate(20, 3, clamp_radius=4)))


@pytest.mark.thorough
def test_why_there_is_none_is_told_in_the_words_of_a_plate() -> None:
    """Over both directions together; no jaw is spoken of, but that a plain vise holds what no pegs can."""
    query = Query(
        part([(0, 0, 0), (100, 0, 0), (100, 60, 0), (0, 60, 0)]), Plate((20, 16), 3, columns=3, rows=3)
    )
    explanation = explain(attrs.evolve(query, restrictions=Restrictions(angles=((0.0, 0.0),))))
    rules = [removal.rule for removal in explanation.removals]
    assert {"angles of the part", "closure", "holes that the plate does not have"} <= set(rules)
    assert sum(removal.removed for removal in explanation.removals) == explanation.removals[0].before
    assert explanation.nearest is not None
    assert [peg.carrier for peg in explanation.nearest.fixture.pegs][:3] == ["plate"] * 3
    far = design(part([(0, 0, 0), (30, 0, 0), (30, 20, 0), (0, 20, 0)]), Plate(200, 3))
    ring = design(part([(-20, 0, 1), (20, 0, 1)]), Plate(20, 3))
    for words in (
        *map(str, (*far.notes, *ring.notes)),
        *(help.change for help in explanation.helps),
        explanation.nearest.words,
    ):
        left = words.replace("as in a plain vise", "")
        assert "jaw" not in left and "vise" not in left
    assert any("as in a plain vise" in str(note) for note in ring.notes)


def in_order(result: Result) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Directions, holes and faces of fixtures (N, 13), and angle, place and travel (N, 4), in an order of their own."""
    table = result.table
    whole = np.column_stack([table.arrangement, table.column, table.row, table.face]).astype(np.int64)
    turn = np.cos(table.theta) + 2.0 * np.sin(table.theta)
    poses = np.column_stack([turn, table.position, table.jaw_separation])
    order = np.lexsort([np.round(poses[:, 0], 4), *whole.T[::-1]])
    return whole[order], poses[order]


def compare(seed: int, path: Path) -> None:
    """One part on one plate: the same list by both engines, each fixture beyond reproach."""
    random = Random(seed)
    workpiece = random_outline(random, 3 + seed % 8)
    pitch = random.choice([12.0, 15.0, 20.0]), random.choice([12.0, 15.0, 20.0])
    travel = random.choice([None, None, (2.0, 15.0), (5.0, 40.0)])
    columns, rows = random.choice([(None, None), (5, 4), (3, 6)])
    radius = random.choice([1.0, 2.0, 3.5])
    directions = random.choice([["-x"], ["+x"], ["-y"], ["-x", "+y"]])
    plate = Plate(pitch, radius, columns=columns, rows=rows, travel=travel, directions=directions)
    one, other = answer(Query(workpiece, plate)), find_fixtures_by_algebra(Query(workpiece, plate))
    assert one.proof is not None and one.proof.undecided == ()
    (whole, poses), (whole_too, poses_too) = in_order(one), in_order(other)
    assert np.array_equal(whole, whole_too)
    assert np.allclose(poses, poses_too, atol=1e-6)
    checked(one, path)


@pytest.mark.thorough
@pytest.mark.sampled(2)
@pytest.mark.parametrize("seed", range(3))
def test_the_algebra_lists_the_same(seed: int, tmp_path: Path) -> None:
    compare(seed, tmp_path / "result.json")


@pytest.mark.prove
@pytest.mark.parametrize("seed", range(3, 43))
def test_the_algebra_lists_the_same_of_many(seed: int, tmp_path: Path) -> None:
    compare(seed, tmp_path / "result.json")
