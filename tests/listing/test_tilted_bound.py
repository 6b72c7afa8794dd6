"""What no tilted fixture ranks before: no location error is small, and a tilt costs points."""

from __future__ import annotations

from collections.abc import Mapping
from math import hypot, sqrt
from random import Random
from typing import Any

import numpy as np
import pytest

from cad_parts import cad_part
from workhold import OpeningVise, Plate, Query, Result, Tolerance, Vise, Workpiece, answer, load
from workhold.contact.problem import Problem
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.segment import Arc
from workhold.listing.bounds import bound_keys_when_tilted, list_preferred_angles
from workhold.listing.ranking import find_usual_errors, is_worse, make_table_keys
from workhold.model.quality import LOCATION_ERROR, PREFERENCES, TILT

TOLERANCES = [Tolerance(), Tolerance(peg=0.03, face=0.0), Tolerance(peg=0.0, face=0.02)]
TOOLKITS: list[Toolkit] = [
    Vise(pitch=10, columns=2, peg_radius=3),
    OpeningVise(pitch=10, columns=2, peg_radius=3),
    Plate(pitch=20, peg_radius=3),
    Plate(pitch=30, peg_radius=3, clamps=2),
]
PARTS = [load("widget"), load("flange"), load("oblongPart"), cad_part(2), cad_part(7)]


def share_an_arc(result: Result) -> np.ndarray[Any, np.dtype[np.bool_]]:
    """Which fixtures (N,) touch some arc with two pegs or more."""
    faces = result.table.face
    arcs = [face.number for face in result.workpiece.numbered.faces if isinstance(face.segment, Arc)]
    return np.array([any((row == arc).sum() > 1 for arc in arcs) for row in faces], np.bool_)


@pytest.mark.thorough
@pytest.mark.sampled(3)
@pytest.mark.parametrize("toolkit", TOOLKITS, ids=["vise", "opening", "plate", "two clamps"])
@pytest.mark.parametrize("tolerance", TOLERANCES, ids=str)
def test_no_location_error_is_below_what_tolerances_make(toolkit: Toolkit, tolerance: Tolerance) -> None:
    """It is the contact's own error and as much along its tangent, or that of the peg where an arc is shared."""
    off, shared = tolerance.peg + tolerance.face, []
    for part in PARTS:
        result = answer(Query(part, toolkit, tolerance=tolerance))
        shares = share_an_arc(result)
        least = np.where(shares, hypot(off, tolerance.peg), sqrt(2.0) * off)
        assert (result.table.quality[:, LOCATION_ERROR] >= least * (1.0 - 1e-9)).all()
        shared.append(shares)
    assert {True, False} == set(np.concatenate(shared).tolist())


RANKINGS: dict[str, Mapping[str, Any]] = {
    "usual": {},
    "tilt": {"rank_by": ["tilt", "end-distance"]},
    "penalty": {"rank_by": ["penalty", "wrench-radius"]},
    **{name: {"rank_by": [key.replace("_", "-") for key in keys]} for name, keys in PREFERENCES.items()},
}


@pytest.mark.thorough
@pytest.mark.sampled(3)
@pytest.mark.parametrize("toolkit", TOOLKITS, ids=["vise", "opening", "plate", "two clamps"])
@pytest.mark.parametrize("ranking", RANKINGS)
def test_no_tilted_fixture_ranks_before_the_bound(toolkit: Toolkit, ranking: str) -> None:
    """And what lies square is at one of the angles that are searched first."""
    tilts = 0
    for part in PARTS:
        query = Query(part, toolkit, **RANKINGS[ranking])
        bound, result = bound_keys_when_tilted(query, Problem.from_query(one_way(query))), answer(query)
        keys = make_table_keys(result.table, query, find_usual_errors(query))
        # In the usual order the angle as written counts, else how the part's main direction lies.
        tilted = result.table.quality[:, TILT] > 0.0
        if query.has_house_order:
            off = np.abs((np.degrees(result.table.theta) + 45.0) % 90.0 - 45.0)
            tilted = off > 0.0111
        assert bound is not None
        for rows, least in ((keys.first, bound.first), (keys.rest, bound.rest)):
            assert not any(is_worse(least, key)[0] for key in np.unique(rows[tilted], axis=0))
        assert keys.error is None or (keys.error[tilted] >= bound.error).all()
        angles = np.degrees(result.table.theta[~tilted])
        near = [(angles - low) % 360.0 < high - low - 1.9e-3 for low, high in list_preferred_angles(query)]
        assert np.any(near, axis=0).all()
        tilts += int(tilted.sum())
    assert tilts > 0


def one_way(query: Query) -> Query:
    """The query in the toolkit's first way."""
    return Query(query.workpiece, query.toolkit.ways[0])


def test_the_points_of_a_tilted_part_are_those_of_the_theorem() -> None:
    """Nine for the tilt, and four for the location error of a part without arcs; with small or large ones less."""
    vise = Vise(pitch=10, columns=2, peg_radius=3)
    outer = [(0, 0, 0), (80, 0, 0), (80, 80, 0), (0, 80, 0)]
    holes = ([], [[(32, 40, 1), (48, 40, 1)]], [[(10, 40, 1), (70, 40, 1)]])
    square, small, large = (Workpiece.from_loops("square", [outer, *hole]) for hole in holes)
    points = []
    for part in (square, small, large):
        query = Query(part, vise, rank_by=["penalty"])
        bound = bound_keys_when_tilted(query, Problem.from_query(query))
        assert bound is not None
        points.append(float(bound.first[0, 1]))
    assert points == [13.0, 12.0, 10.0]


def test_where_tilt_has_no_say_there_is_no_bound() -> None:
    """Nor of flat jaws, and of pegs that meet other outlines than the silhouette."""
    part, vise = load("widget"), Vise(pitch=8, columns=1, peg_radius=3)
    for ranking in (["closure-margin"], ["clamp-amplification", "location-error"]):
        query = Query(part, vise, rank_by=ranking)
        assert bound_keys_when_tilted(query, Problem.from_query(query)) is None
    flat = Query(part, Vise(pitch=8, columns=1, peg_radius=3, flat=(2.5, 1.5)))
    assert bound_keys_when_tilted(flat, Problem.from_query(flat)) is None


def test_a_bound_never_counts_as_worse_than_itself() -> None:
    """What ranks exactly as the bound is looked at."""
    query = Query(PARTS[Random(1).randrange(len(PARTS))], TOOLKITS[0])
    bound = bound_keys_when_tilted(query, Problem.from_query(query))
    assert bound is not None and not bound.are_beaten(bound, 1, bound.lowest_error)[0]
