"""An undecided entry of a proof is a real place, or a fault."""

from __future__ import annotations

from math import degrees
from typing import Any

import attrs
import pytest

from judged import faults_of
from undecided_examples import as_undecided
from workhold import Fixture, OpeningVise, Query, Result, StrapPlate, Vise, Workpiece, design
from workhold.model.notes import LeftUndecided
from workhold.model.search_report import GIVEN_UP, NEARLY_DOUBLE, UNBOUNDED, UndecidedCandidate
from workhold.verification import verify


def as_chords(fixture: Fixture) -> UndecidedCandidate:
    """Its first two pegs and the others, or of three left pegs those that share the first, as chords that were given up."""
    entry, kind = as_undecided(fixture), fixture.type
    order = (0, 1, 2, 3) if kind == "I" else (0, 1, 0, 2)
    rows = [entry.rows[k] for k in order]
    quartets: list[Any] = [
        tuple(entry.faces[k] for k in order),
        tuple(entry.columns[k] for k in order),
        (0, rows[1], 0, rows[3] - rows[2]),
    ]
    return UndecidedCandidate(kind, *quartets, entry.theta_deg, GIVEN_UP)


def faults(entry: UndecidedCandidate, result: Result) -> list[str]:
    """What is wrong with one entry."""
    return faults_of([entry], result.query)


def test_places_where_fixtures_are_may_be_undecided(widget_result: Result) -> None:
    """As four contacts, as chords, and without a bound."""
    for fixture in widget_result:
        entry = as_undecided(fixture)
        assert faults(entry, widget_result) == []
        assert faults(as_chords(fixture), widget_result) == []
        assert faults(attrs.evolve(entry, reason=UNBOUNDED, reach_deg=None), widget_result) == []


@pytest.mark.parametrize("change", [1e-3, -1e-3, 20.0])
def test_no_contacts_at_another_orientation(widget_result: Result, change: float) -> None:
    """Unless the entry says that its orientation is no better known."""
    for fixture in widget_result:
        entry = as_undecided(fixture)
        other = attrs.evolve(entry, theta_deg=(entry.theta_deg + change) % 360.0)
        assert "of the proof is not a place where" in faults(other, widget_result)[0]
        if abs(change) < 1.0:
            assert faults(attrs.evolve(other, reach_deg=2e-3), widget_result) == []


@pytest.mark.parametrize("key", ["faces", "columns", "rows"])
@pytest.mark.parametrize("peg", range(4))
def test_other_faces_and_holes(widget_result: Result, key: str, peg: int) -> None:
    """Any whole number changed by one. Three left pegs let the right one stand in any row that meets its face."""
    for fixture in widget_result:
        if (fixture.type, key, peg) == ("II", "rows", 3):
            continue
        entry = as_undecided(fixture)
        for change in (1, -1):
            numbers = list(getattr(entry, key))
            numbers[peg] += change
            assert faults(attrs.evolve(entry, **{key: tuple(numbers)}), widget_result), (
                entry,
                key,
                peg,
                change,
            )


def test_chords_that_are_none(widget_result: Result) -> None:
    """A step that the two faces do not have at that orientation, or none."""
    for fixture in widget_result:
        entry = as_chords(fixture)
        rows = (0, entry.rows[1] + 5, 0, entry.rows[3])
        assert "touch their faces" in faults(attrs.evolve(entry, rows=rows), widget_result)[0]
        still = attrs.evolve(entry, rows=(0, 0, *entry.rows[2:]), columns=(0, 0, *entry.columns[2:]))
        assert "two pegs in the same hole" in faults(still, widget_result)[0]


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"type": "III"}, "is of type III, which is not asked for"),
        ({"reason": "because"}, "for a reason that is none"),
        ({"reach_deg": None}, "does not say how far"),
        ({"faces": (0, 1, 2, 777)}, "names a segment that is not a face"),
        ({"columns": (0, 9, 0, 0)}, "spans 10 columns of a jaw with 2"),
        ({"columns": (1, 0, 0, 0)}, "does not count its holes from the first peg"),
    ],
)
def test_what_an_entry_says(widget_result: Result, changes: dict[str, Any], words: str) -> None:
    assert words in faults(attrs.evolve(as_undecided(widget_result[0]), **changes), widget_result)[0]


@pytest.mark.parametrize(("escalated", "said"), [(0, True), (1, False)])
def test_what_is_undecided_was_escalated(widget_result: Result, escalated: int, said: bool) -> None:
    """Nothing is left open before ball arithmetic has tried."""
    assert widget_result.proof is not None
    counts = {"candidates": widget_result.proof.candidates + 1, "escalated": escalated}
    proof = attrs.evolve(widget_result.proof, undecided=(as_undecided(widget_result[0]),), **counts)
    result = attrs.evolve(widget_result, proof=proof, notes=(*widget_result.notes, LeftUndecided(1)))
    words = "the proof says that 1 candidates are undecided, but none was escalated"
    assert (words in verify(result).faults) == said


# What a search of a plate with four holes left open: two pegs a hair farther apart than two of its holes let them stand.
NEARLY = [
    ((8, 10, 10, 8), (0, -2, -2, 0), (0, 7, 6, 0), 294.39014311339105, 0.013995803483447906),
    ((8, 10, 10, 4), (0, 2, 2, 0), (0, -7, -6, -4), 114.36015210775835, 0.015995203858968774),
    ((8, 10, 10, 4), (0, -2, -3, 0), (0, -7, -6, -6), 82.4973519111698, 0.011996403107927043),
]


@pytest.mark.parametrize(("faces", "columns", "rows", "theta", "reach"), NEARLY)
def test_what_is_undecided_need_not_be_a_solution(
    faces: Any, columns: Any, rows: Any, theta: float, reach: float
) -> None:
    """It may miss one by as much as pegs move within its range of orientations, and by no more."""
    holes = [
        [[x - r, y, 1], [x + r, y, 1]] for x, y, r in ((26, 24, 9), (78, 23, 11), (85, 55, 10), (14, 66, 11))
    ]
    part = Workpiece.from_loops("plate", [[[0, 0, 0], [100, 0, 0], [100, 80, 0], [0, 80, 0]], *holes])
    query = Query(part, OpeningVise(pitch=10, columns=4, peg_radius=3))
    entry = UndecidedCandidate("II", faces, columns, rows, theta, NEARLY_DOUBLE, reach)
    assert faults_of([entry], query) == []
    known = attrs.evolve(entry, reach_deg=1e-8)
    assert "is not a place where" in faults_of([known], query)[0]


@pytest.mark.parametrize(("farther", "real"), [(0.02, True), (0.04, False)])
def test_pegs_at_both_ends_may_miss_by_what_they_move_against_each_other(farther: float, real: bool) -> None:
    """A rod 20 mm long has pegs of radius 5 mm at its ends, 30 mm apart: 0.03 mm in a milliradian of its orientation."""
    rod = Workpiece.from_loops("rod", [[[2, -8, 0], [2, 8, 1], [-2, 8, 0], [-2, -8, 1]]])
    query = Query(rod, Vise(pitch=(20.0, 10.0 + farther / 3), columns=2, peg_radius=5))
    flat, top, bottom = 0, 1, 3
    faces, rows = (bottom, top, flat, flat), (0, 3, 1, 2)
    entry = UndecidedCandidate("I", faces, (0, 0, 0, 0), rows, 0.0, NEARLY_DOUBLE, degrees(1e-3))
    assert (faults_of([entry], query) == []) == real


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({}, ""),
        ({"faces": (0, 1)}, "has not 3 faces and holes"),
        ({"rows": (0, 0, 0, 0)}, "has not 3 faces and holes"),
        ({"reason": GIVEN_UP}, "has not 4 faces and holes"),
        ({"columns": (1, 1, 1)}, "does not count its holes from the first peg"),
        ({"theta_deg": 17.0}, "is not a place where its pegs touch their faces"),
    ],
)
def test_three_locators_alone_are_looked_at_likewise(changes: dict[str, Any], words: str) -> None:
    """Under straps nothing moves, so that an entry has three pegs; of two chords it has the ends of both."""
    part = Workpiece.from_loops("block", [[[0, 0, 0], [100, 0, 0], [100, 60, 0], [0, 60, 0]]])
    result = design(part, StrapPlate(20, 3, 8, 6), best=1)
    entry = attrs.evolve(as_undecided(result[0]), **changes)
    found = faults_of([entry], result.query)
    assert words in found[0] if words else found == []
