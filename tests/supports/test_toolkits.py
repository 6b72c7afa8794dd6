"""Supports in every kind of toolkit: what is listed is derived again from the six equations of balance."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import workhold
from own_heights import STEM, stepped
from workhold import Fence, FlatJaw, OpeningVise, Plate, Vise, Workpiece, design
from workhold.files.supports_file import read_supports, write_supports
from workhold.model.support_request import SpatialLoad, SupportRequest
from workhold.supports.clamp_point import ClampPlaces
from workhold.supports.faces import LevelRegions, TouchableFace
from workhold.supports.listing import find_supports
from workhold.verification.support_listing import measure_room_on
from workhold.verification.supports import verify_supports_file

KITE = Workpiece.from_loops("kite", [[[0, 0, 0], [70, -8, 0.1], [88, 40, 0], [22, 66, 0]]])
WINDOW = Workpiece.from_loops(
    "window", [[[0, 0, 0], [90, 0, 0], [90, 70, 0], [0, 70, 0]], [[30, 20, 0], [70, 26, 0], [44, 58, 0]]]
)
LOADS = (
    SpatialLoad(points=[(30, 20), (50, 30)], force=40, directions=(20, 160), heights=(6, 14), axial=(-9, 70)),
    SpatialLoad(points=[(40, 25)], axial=300, tilt=(500, -900), moment=700),
)
TOOLKITS = [
    (KITE, Vise(pitch=15, columns=4, peg_radius=3)),
    (
        KITE,
        Vise(
            pitch=15, columns=5, peg_radius=3, rows=6, max_opening=60, row_offset=4, blocked=("L-C2", "R-A")
        ),
    ),
    (WINDOW, OpeningVise(pitch=12, columns=5, peg_radius=2, min_gap=6)),
    (KITE, Plate(pitch=20, peg_radius=3, columns=6, rows=6)),
    (KITE, Plate(pitch=20, peg_radius=3, travel=(10, 40), columns=8, rows=8)),
    (KITE, Plate(pitch=20, peg_radius=3, clamps=2)),
    (KITE, Fence(pitch=15, wall_offset=8, peg_radius=3)),
    (KITE, Fence(pitch=15, wall_offset=8, peg_radius=3, clamps=2)),
    (KITE, FlatJaw(pitch=15, peg_radius=3, max_opening=40)),
]


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("part", "toolkit"), TOOLKITS, ids=lambda one: getattr(one, "kind", one.__class__.__name__)
)
def test_what_is_listed_is_derived_again(part, toolkit, tmp_path):
    result = workhold.design(part, toolkit, best=2)
    assert len(result)
    asked = SupportRequest(15, 3, 4, band=(3, 11), inside=3)
    listed = 0
    for fixture in result:
        found = find_supports(fixture, result.query, asked, LOADS, best=4)
        path = tmp_path / "supports.json"
        write_supports(found, path)
        outcome = verify_supports_file(path)
        assert outcome.holds and outcome.proven == len(found.triples), (outcome.faults, outcome.unproven[:1])
        assert [one.best for one in read_supports(path).triples] == [one.best for one in found.triples]
        listed += len(found.triples)
    assert listed


def test_points_on_the_diameter_of_a_hole_lie_in_it() -> None:
    """A hole of two half circles holds the points between its ends, on which chords and arcs say nothing."""
    square = np.array([[0, 0, 0], [20, 0, 0], [20, 20, 0], [0, 20, 0]], dtype=float)
    hole = np.array([[6, 10, -1], [14, 10, -1]], dtype=float)
    face = TouchableFace.from_loops([square, hole])
    points = np.array([[9.0, 10.0], [10.0, 10.0], [3.0, 10.0]])
    assert face.measure_room(points).tolist() == [-3.0, -4.0, 3.0]


def test_a_clamp_stands_as_near_to_what_rises_as_its_head_lets_it() -> None:
    """On the lower 60 mm of a stepped plate of 90 x 60 mm, with a tip of 5 mm and a head of 7, around a boss of 3."""
    plate = np.array([[0, 0, 0], [90, 0, 0], [90, 60, 0], [0, 60, 0]], dtype=float)
    step = np.array([[0, 0, 0], [30, 0, 0], [30, 60, 0], [0, 60, 0]], dtype=float)
    boss = np.array([[58, 30, 1], [64, 30, 1]], dtype=float)
    rising = LevelRegions.from_loops([step, boss], [20.0, 20.0])
    places = ClampPlaces(
        TouchableFace.from_loops([plate], heights=[20.0]), 5.0, None, kept_off=((rising, 7.0),)
    )
    assert sorted(places.corners.tolist()) == [[37, 5], [37, 55], [85, 5], [85, 55]]
    assert places.bent.curves.tolist() == [[61, 30, 10]]


def test_loops_side_by_side_are_faces_of_their_own() -> None:
    """A disc lies on one of two faces wholly; a loop within one of them is an opening, however it is run."""
    one = np.array([[0, 0, 0], [20, 0, 0], [20, 20, 0], [0, 20, 0]], dtype=float)
    other = one + np.array([30.0, 0.0, 0.0])
    opening = np.array([[34, 4, 0], [36, 4, 0], [36, 6, 0], [34, 6, 0]], dtype=float)
    face = TouchableFace.from_loops([one, other, opening])
    points = np.array([[10.0, 10.0], [25.0, 10.0], [40.0, 5.0], [35.0, 5.0], [18.0, 10.0]])
    expected = [10.0, -5.0, 4.0, -1.0, 2.0]
    assert face.measure_room(points).tolist() == expected
    assert [measure_room_on([one, other, opening], [], (x, y)) for x, y in points.tolist()] == expected
    low, high = face.box
    assert (low.tolist(), high.tolist()) == ([0.0, 0.0], [50.0, 20.0])


def test_faces_that_meet_and_the_top_of_a_boss_are_faces_of_their_own() -> None:
    """Of a solid loops run clockwise around openings: a boss fills its opening, a neighbour shares a side."""
    step = np.array([[20, 0, 0], [40, 0, 0], [40, 20, 0], [20, 20, 0]], dtype=float)
    floor = np.array([[0, 0, 0], [20, 0, 0], [20, 20, 0], [0, 20, 0]], dtype=float)
    boss = np.array([[6, 10, 1], [14, 10, 1]], dtype=float)
    around = np.array([[14, 10, -1], [6, 10, -1]], dtype=float)
    points = [(10.0, 10.5), (3.0, 10.0), (30.0, 8.0), (16.5, 10.0), (20.0, 5.0), (50.0, 10.0)]
    expected = [3.5, 3.0, 8.0, 2.5, 0.0, -10.0]
    for loops in ([floor, around, boss, step], [step, boss, floor, around], [boss, around, step, floor]):
        assert TouchableFace.from_loops(loops).measure_room(np.array(points)).tolist() == expected
        assert [measure_room_on(loops, [], point) for point in points] == expected
    pocket = [floor[::-1], [[2, 2, 0], [18, 2, 0], [18, 18, 0], [2, 18, 0]], around[::-1]]
    inside = [[2, 18, 0], [18, 18, 0], [18, 2, 0], [2, 2, 0]]
    assert TouchableFace.from_loops(pocket).measure_room(np.array(points[:2])).tolist() == [-7.5, -1.0]
    assert TouchableFace.from_loops([floor, inside, pocket[1], around]).measure_room(
        np.array(points[:2])
    ).tolist() == [
        -3.5,
        1.0,
    ]
    assert measure_room_on([floor, inside, pocket[1], around], [], points[0]) == -3.5


@pytest.mark.thorough
def test_a_file_of_supports_has_the_outlines_of_carriers(tmp_path: Path) -> None:
    """A clamp with heights of its own touches the outline that is written; the file is read back and proven."""
    toolkit = Plate(pitch=10, peg_radius=3, clamp_heights=(11.0, 18.0))
    part = stepped({"clamp": ((11.0, 18.0), STEM)})
    held = design(part, toolkit, best=10).supports(best=10, pad_radius=2, tip_radius=2)
    found = next(one for one in held if one.triples)
    write_supports(found, tmp_path / "s.json")
    assert read_supports(tmp_path / "s.json").query.workpiece.outlines == part.outlines
    judged = verify_supports_file(tmp_path / "s.json")
    assert judged.faults == () and judged.proven == len(found.triples)
