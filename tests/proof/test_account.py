"""The account of a search adds up, and nothing is left undecided on the paper's parts."""

from __future__ import annotations

import numpy as np
import pytest
from attrs import evolve

from workhold import Query, Result, Vise, Workpiece, design, load
from workhold.algebra import find_fixtures_by_algebra
from workhold.proof import deciding

PARTS = [
    ("widget", Vise(pitch=8, columns=2, peg_radius=3)),
    ("oblongPart", Vise(pitch=10, columns=2, peg_radius=3)),
    ("small4Handle", Vise(pitch=10, columns=2, peg_radius=3)),
    ("flange", Vise(pitch=8, columns=1, peg_radius=3, rows=9, max_opening=20, row_offset=1.5)),
]


def check_account(result: Result) -> None:
    """candidates = discarded + verified + undecided, none undecided, and every fixture listed is a verified candidate."""
    proof = result.proof
    assert proof is not None
    assert proof.undecided == ()
    assert min(proof.discarded_by_bound, proof.verified, proof.escalated) >= 0
    assert proof.candidates == proof.discarded_by_bound + proof.verified + len(proof.undecided)
    assert proof.verified >= sum(result.found.values())
    assert proof.escalated <= proof.candidates


@pytest.mark.parametrize(("name", "vise"), PARTS)
def test_the_account_of_the_papers_parts(name: str, vise: Vise) -> None:
    result = design(load(name), vise)
    check_account(result)
    assert result.proof is not None
    assert result.proof.cells > 96
    assert result.proof.candidates > result.proof.verified > 0
    assert not result.notes or all("undecided" not in str(note) for note in result.notes)


def test_the_account_of_each_type() -> None:
    """Both types' cells, candidates and fixtures are those of each alone, added."""
    part, vise = load("widget"), Vise(pitch=8, columns=1, peg_radius=3)
    both, one, two = (design(part, vise, types=types).proof for types in (("I", "II"), ("I",), ("II",)))
    assert both is not None and one is not None and two is not None
    for name in ("cells", "candidates", "discarded_by_bound", "verified", "escalated"):
        assert getattr(both, name) == getattr(one, name) + getattr(two, name)


def test_the_account_of_the_best_alone() -> None:
    """A search for the best works on all cells, but discards more and verifies fewer."""
    part, vise = load("widget"), Vise(pitch=8, columns=1, peg_radius=3)
    best, full = design(part, vise, best=3), design(part, vise)
    assert best.proof is not None and full.proof is not None
    assert best.proof.cells == full.proof.cells
    assert 3 <= best.proof.verified <= full.proof.verified
    check_account(full)


def test_a_part_without_fixtures_has_an_account() -> None:
    disc = Workpiece.from_loops("disc", [[[20.0, 0.0, 1.0], [-20.0, 0.0, 1.0]]])
    result = design(disc, Vise(pitch=13, columns=2, peg_radius=3))
    check_account(result)
    assert result.proof is not None
    assert result.proof.verified == 0


def test_what_double_precision_leaves_open_is_decided_without_the_families_as_with_them(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Contacts that merge at a fold, as the arcs of this part have, are escalated, and none is left undecided. Those of a
    family that holds nothing need not be, and every stage after agrees that they are not fixtures."""
    part, vise = load("oblongPart"), Vise(pitch=10, columns=2, peg_radius=3)
    lenient = design(part, vise)
    monkeypatch.setattr(deciding, "cannot_hold", lambda records, _: np.zeros(len(records), np.bool_))
    result = design(part, vise)
    check_account(result)
    assert result.proof is not None and lenient.proof is not None
    assert result.proof.escalated > lenient.proof.escalated
    assert evolve(result.proof, escalated=0) == evolve(lenient.proof, escalated=0)
    assert np.array_equal(result.table.theta, lenient.table.theta)


def test_the_algebra_has_an_account_without_cells() -> None:
    result = find_fixtures_by_algebra(Query(load("oblongPart"), Vise(pitch=12, columns=1, peg_radius=3)))
    check_account(result)
    assert result.proof is not None
    assert result.proof.cells == 0
