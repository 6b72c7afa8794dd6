"""The best K of searches that begin with what lies square: the first K of all, though most is not searched."""

from __future__ import annotations

from itertools import pairwise
from math import pi, tau
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cad_parts import cad_part
from toolkit_results import NOTCHED, part
from workhold import (
    OpeningVise,
    Plate,
    Query,
    Restrictions,
    Result,
    Vise,
    Workpiece,
    answer,
    design,
    load,
    save,
)
from workhold.contact.problem import Problem
from workhold.conventions import SQUARE_TILT
from workhold.fixels.toolkit import Toolkit
from workhold.listing.bounds import list_preferred_angles
from workhold.listing.collector import InterestLimits
from workhold.model.notes import BestOnly
from workhold.model.quality import TILT
from workhold.search.lattice_shares import LatticeShares, order_square_ranges_first
from workhold.search.toolkit_search import ToolkitSearch
from workhold.verification import verify_file

VISE = Vise(pitch=10, columns=2, peg_radius=3)
CLAMPS = Plate(pitch=30, peg_radius=3, clamps=2)
# Parts that lie square in many ways, and parts that lie so in few or none.
CASES: list[tuple[Workpiece, Toolkit, int]] = [
    (part(NOTCHED), VISE, 5),
    (part(NOTCHED), OpeningVise(pitch=10, columns=2, peg_radius=3), 2),
    (part(NOTCHED), CLAMPS, 4),
    (cad_part(0), VISE, 20),
    (cad_part(0), Plate(pitch=20, peg_radius=3), 10),
    (cad_part(0), CLAMPS, 10),
    (cad_part(7), VISE, 300),
    (load("flange"), VISE, 12),
    (load("widget"), CLAMPS, 7),
]
RANKINGS: dict[str, dict[str, Any]] = {
    "usual": {},
    "square": {"prefer": "square"},
    "precise": {"prefer": "precise"},
    "penalty": {"rank_by": ["penalty", "edge-distance"]},
}


@pytest.fixture(autouse=True)
def searches_of_any_size_begin_so(monkeypatch: pytest.MonkeyPatch) -> None:
    """Not only those that take long."""
    monkeypatch.setattr("workhold.search.shares.SQUARE_FIRST", 0.0)


@pytest.mark.thorough
@pytest.mark.sampled(3)
@pytest.mark.parametrize("ranking", RANKINGS)
def test_the_best_are_the_first_of_all(ranking: str) -> None:
    """Whether the bound ends the search or not, which the account says; and both happen."""
    ended = []
    for workpiece, toolkit, most in CASES:
        full = design(workpiece, toolkit, **RANKINGS[ranking])
        best = design(workpiece, toolkit, best=most, **RANKINGS[ranking])
        assert list(best) == list(full)[:most]
        assert best.complete and best.proof is not None and full.proof is not None
        ended.append(best.proof.cells < full.proof.cells)
        if ended[-1]:
            assert best.notes == (BestOnly(most),)
            assert best.found == best.counts
    # Where the location error counts before the tilt, square ones are no better.
    assert set(ended) == ({False} if ranking in ("usual", "precise") else {True, False})


@pytest.mark.thorough
@pytest.mark.parametrize(("seed", "toolkit", "most"), [(1, VISE, 100), (9, CLAMPS, 20), (41, CLAMPS, 15)])
def test_tilted_ones_between_square_ones_are_found(seed: int, toolkit: Toolkit, most: int) -> None:
    """The best is square and the last is, so that there are enough; but tilted ones rank between."""
    full = design(cad_part(seed), toolkit)
    is_square = full.table.quality[:, TILT] < SQUARE_TILT
    assert is_square[0] and not is_square[:most].all() and is_square.sum() > most
    assert list(design(cad_part(seed), toolkit, best=most)) == list(full)[:most]


@pytest.mark.thorough
def test_the_file_of_such_a_search_holds_and_does_not_depend_on_threads(tmp_path: Path) -> None:
    """For one clamp and for two, counts of the work included."""
    for workpiece, toolkit in ((cad_part(0), VISE), (cad_part(0), CLAMPS)):
        files = []
        for threads in (1, 3):
            files.append(tmp_path / f"{threads}.json")
            save(design(workpiece, toolkit, best=8, threads=threads), files[-1])
        assert files[0].read_bytes() == files[1].read_bytes()
        assert verify_file(files[0]).proven == 8


@pytest.mark.thorough
def test_angles_that_are_asked_for_stay_so() -> None:
    """Also where no square orientation is among them."""
    for angles in (((20.0, 60.0),), ((80.0, 100.0), (200.0, 210.0))):
        query = {"restrictions": Restrictions(angles=angles)}
        for toolkit in (VISE, CLAMPS):
            full, best = (design(cad_part(0), toolkit, best=most, **query) for most in (None, 6))
            assert list(best) == list(full)[:6]


def make_records(search: ToolkitSearch, **asked: Any) -> np.ndarray[Any, np.dtype[np.float64]]:
    """All that some blocks of a search find, each record once."""
    blocks = search.make_blocks(search.problem.query.types, **asked)
    return np.unique(np.concatenate([block.work(InterestLimits()) for block in blocks]), axis=0)


@pytest.mark.thorough
@pytest.mark.parametrize("loose", [False, True])
def test_the_first_blocks_and_the_rest_find_everything(loose: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Together, and the first alone all that lies square; with pairs that slide at any angle as well."""
    if loose:
        # Pairs whose orientation is not known are among the first, whatever their cell.
        monkeypatch.setattr("workhold.search.toolkit_search.VAGUE", 0.0)
    query = Query(cad_part(0), VISE)
    search = ToolkitSearch.from_problem(Problem.from_query(query))
    angles = list_preferred_angles(query)
    everything = make_records(search)
    first, rest = (make_records(search, first=angles, rest=rest) for rest in (False, True))
    assert np.array_equal(np.unique(np.concatenate([first, rest]), axis=0), everything)
    assert 0 < len(first) < len(everything)
    psi = np.degrees(-rest[:, 13])
    assert all(((psi - low) % 360.0 > high - low).all() for low, high in angles)
    assert len(rest) + len(first) == len(everything)


def test_pairs_that_slide_at_any_angle_are_in_the_first_share(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of two clamps as well: such a pair may be square though its cell is not."""
    tilted = []
    for vague in (1.0, 0.0):
        monkeypatch.setattr("workhold.search.toolkit_search.VAGUE", vague)
        with LatticeShares.open_for_query(Query(part(NOTCHED), CLAMPS, best=4), 1, None) as shares:
            blocks = shares.make_blocks(0, shares.searches[0], shares.whole_turn[0])
        psi = np.degrees(-np.concatenate([block.work(InterestLimits()) for block in blocks])[:, 13])
        tilted.append(int((np.abs((psi + 45.0) % 90.0 - 45.0) > 5.0).sum()))
    assert tilted[0] == 0 < tilted[1]


def test_square_ranges_come_first_and_all_others_after_them() -> None:
    """Each orientation is in one range; shares stay apart, and a range that begins before the first one is cut."""
    edges = np.linspace(0.0, tau, 4) - 0.1
    shares = [[pair] for pair in pairwise(edges.tolist())]
    square = [(-8.0, -5.0), (82.0, 85.0), (172.0, 175.0), (262.0, 265.0)]
    ranges = order_square_ranges_first(shares, square)
    assert len(ranges) == 4
    pieces = sorted(pair for each in ranges for pair in each)
    assert pieces[0][0] == edges[0] and pieces[-1][1] == edges[-1]
    assert all(one[1] == other[0] for one, other in pairwise(pieces))
    assert sum(high - low for low, high in ranges[0]) == pytest.approx(4 * 3.0 * pi / 180.0)
    for share, each in zip(shares, ranges[1:], strict=True):
        assert all(share[0][0] <= low < high <= share[0][1] for low, high in each)


@pytest.mark.thorough
def test_small_searches_and_whole_lists_begin_anywhere(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing is left out of these, so that all is counted."""
    query = Query(part(NOTCHED), CLAMPS, best=4)
    with LatticeShares.open_for_query(query, 1, None) as shares:
        assert shares.bound is not None
        assert len(shares.ranges[0]) >= 4
    monkeypatch.setattr("workhold.search.shares.SQUARE_FIRST", 1e12)
    for asked in (query, Query(part(NOTCHED), CLAMPS)):
        with LatticeShares.open_for_query(asked, 1, None) as shares:
            assert shares.bound is None and shares.share_count == 1
    result: Result = answer(Query(cad_part(0), VISE, best=20))
    whole = design(cad_part(0), VISE)
    assert result.proof is not None and whole.proof is not None
    assert result.proof.cells == whole.proof.cells
