"""What the algebra leaves undecided is named."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from workhold import Query, Vise, Workpiece
from workhold.algebra import engine, find_fixtures_by_algebra
from workhold.algebra.candidates import SECTORS, EquationSystems
from workhold.algebra.engine import MOST_NAMED, write_undecided_notes
from workhold.algebra.sliding_pairs import find_two_and_two_contacts

WEDGE = Workpiece.from_loops("wedge", [[[0, 0, 0], [41, 0, 0], [13, 37, 0]]])
VISE = Vise(pitch=15, columns=2, peg_radius=2)


def systems(feature: list[int], column: list[int], row: list[int], count: int = 1) -> EquationSystems:
    """One system, or the same several times."""
    ints = (np.tile(np.array(values), (count, 1)) for values in (feature, column, row))
    return EquationSystems(*ints, np.ones((count, SECTORS), np.bool_))


def test_faces_and_holes_are_named() -> None:
    faces = np.array([0, 0, 3, 7])
    found = [systems([1, 2, 3], [0, 1, 0], [0, 0, 2]), systems([0, 1, 2, 3], [0, -1, 0, 1], [0, 2, -3, -3])]
    assert list(map(str, write_undecided_notes(found, faces))) == [
        "Undecided: pegs in left column +0, row +0 on face 0; left column +1, row +0 on face 3; "
        "left column +0, row +2 on face 7.",
        "Undecided: pegs in left column +0, row +0 on face 0; left column -1, row +2 on face 0; "
        "right column +0, row -3 on face 3; right column +1, row -3 on face 7.",
    ]


def test_a_long_list_is_cut() -> None:
    notes = list(
        write_undecided_notes([systems([0, 1, 2], [0, 0, 0], [0, 1, 2], MOST_NAMED + 7)], np.arange(3))
    )
    assert len(notes) == MOST_NAMED + 1
    assert str(notes[-1]) == "Undecided: 7 more systems of pegs and faces."


@pytest.mark.thorough
def test_a_result_without_doubt_has_no_note() -> None:
    result = find_fixtures_by_algebra(Query(WEDGE, VISE))
    assert result.statistics["undecided"] == 0
    assert result.notes == ()


def test_a_resultant_that_vanishes_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """Four pegs of which two on each jaw are the same: sent past the tests that keep such systems away."""
    coinciding = systems([0, 1, 0, 1], [0, 0, 0, 0], [0, 1, 0, 1])

    def only_that(*_: object) -> Iterator[EquationSystems]:
        yield coinciding

    monkeypatch.setitem(engine.GENERATORS, (2, 2), (only_that, find_two_and_two_contacts))
    monkeypatch.setattr(
        engine, "are_alike_on_both_jaws", lambda contacts: np.zeros(len(contacts.rows), np.bool_)
    )
    result = find_fixtures_by_algebra(Query(WEDGE, VISE, "I"))
    assert result.statistics["undecided"] == 1
    assert str(result.notes[-1]).startswith(
        "Undecided: pegs in left column +0, row +0 on face 0; left column +0, row +1 on"
    )
