"""What a fixture says in numbers: contacts that balance, its rank, loads, and what only a vise has."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from attrs import evolve

import workhold
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.segment import measure_distance_to_segment
from workhold.model.requirements import Load

PART = workhold.load("widget")
TOOLKITS: list[Toolkit] = [
    workhold.Vise(pitch=8, columns=1, peg_radius=3),
    workhold.Plate.preset("clamp-plate-20mm", columns=8, rows=6),
    workhold.Fence.preset("fence-20mm"),
    workhold.Plate.preset("two-clamp-plate-20mm", columns=6, rows=5),
]


@pytest.mark.thorough
@pytest.mark.parametrize("toolkit", TOOLKITS, ids=lambda one: one.kind)
def test_contacts_lie_on_faces_and_their_forces_balance(toolkit: Toolkit) -> None:
    """In the toolkit's frame, and in the part's by the inverse of the pose."""
    faces = {face.number: face.segment for face in PART.faces}
    for fixture in workhold.design(PART, toolkit, best=8):
        points, normals = fixture.contact_points, fixture.normals
        force = np.array([peg.force for peg in fixture.pegs])
        turn = points[:, 0] * normals[:, 1] - points[:, 1] * normals[:, 0]
        assert np.abs(force @ normals).max() < 1e-7 and abs(force @ turn) < 1e-5
        for peg, at in zip(fixture.pegs, fixture.pose.inverse.apply(points), strict=True):
            assert measure_distance_to_segment(tuple(at.tolist()), faces[peg.face]) < 1e-6


@pytest.mark.thorough
def test_a_fixture_knows_its_rank_loads_and_what_its_jaws_are_at() -> None:
    """Loads and jaw force are those of the query where none are given; a plate has no jaws."""
    load = Load(points=(20, 10), force=80)
    result = workhold.design(PART, TOOLKITS[0], loads=[load], jaw_force=300, best=3)
    fixture = result[2]
    assert fixture.rank == 3 and fixture.jaw_separation == fixture.travel == result.table.jaw_separation[2]
    (case,) = fixture.load_cases()
    assert case.load == load and case.jaw_force == 300
    (free,) = fixture.load_cases([Load(moment=50)], jaw_force=700, friction=0.1, jaw="constant")
    assert free.jaw_force == 700 and free.needed_with_friction is not None and free.jaw_stiffness == 0
    with pytest.raises(workhold.InputError, match="jaw force cannot be '3'"):
        fixture.load_cases(jaw_force="3")  # type: ignore[arg-type]
    with pytest.raises(workhold.InputError, match="not of a result"):
        evolve(fixture, listed=None).load_cases()
    plate = workhold.design(PART, TOOLKITS[1], best=1)[0]
    assert plate.jaw_separation is None and plate.travel != 0


@pytest.mark.thorough
def test_a_notebook_may_show_svg() -> None:
    """Of a part, and of a fixture of a result."""
    fixture = workhold.design(PART, TOOLKITS[0], best=1)[0]
    assert "<svg" in PART._repr_svg_() and fixture._repr_svg_() == fixture.draw()
    assert evolve(fixture, listed=None)._repr_svg_() is None


def test_names_offered_are_those_for_users() -> None:
    """``open`` is there and not brought by a star; what other rooms use is not offered."""
    assert "open" in dir(workhold) and "open" not in workhold.__all__
    fixture = workhold.design(PART, TOOLKITS[0], best=1)[0]
    assert {"rank", "pegs", "pose", "contact_points", "save_sheet"} <= set(dir(fixture))
    for thing, hidden in (
        (fixture, "refuse_others"),
        (PART, "numbered"),
        (fixture.listing.result, "mark_cut_short"),
    ):
        assert hidden not in dir(thing) and hasattr(thing, hidden)


@pytest.mark.skipif(importlib.util.find_spec("shapely") is None, reason="needs shapely")
def test_a_part_becomes_a_polygon() -> None:
    """No chord is farther from its arc than asked, holes are holes, and reading it gives the part again."""
    part = workhold.load(Path(__file__).parents[2] / "examples" / "bracket.dxf")
    for tolerance in (0.5, 0.001):
        polygon = part.to_shapely(tolerance)
        assert polygon.is_valid and len(polygon.interiors) == len(part.hole_segments)
        corners = np.array(polygon.exterior.coords)
        middles = (corners[1:] + corners[:-1]) / 2
        away = [
            min(measure_distance_to_segment(at, one) for one in part.segments) for at in map(tuple, middles)
        ]
        assert tolerance / 4 < max(away) <= tolerance + 1e-9
    again = workhold.load(part.to_shapely(0.0005), fit=0.001)
    assert len(again.faces) == len(part.faces)
    with pytest.raises(workhold.InputError, match="the tolerance 0 of an outline"):
        part.to_shapely(0)


def test_shapely_may_be_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Then it says how to get it."""
    monkeypatch.setitem(__import__("sys").modules, "shapely", None)
    with pytest.raises(workhold.InputError, match="pip install 'shapely>=2'"):
        PART.to_shapely()
