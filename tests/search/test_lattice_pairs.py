"""Pairs of pegs of a sliding lattice: doubles with their bounds and balls, which share no formula's rounding, agree."""

from __future__ import annotations

from math import inf
from threading import Event

import numpy as np
import pytest

from toolkit_results import NOTCHED, part
from workhold import FlatJaw, Query, Workpiece
from workhold.contact.problem import Problem
from workhold.proof.flush import decide_pair
from workhold.search.flush_search import lay_part_on_wall
from workhold.search.lattice_pairs import compute_pair_closure, find_pairs_on_edge, select_pressed_pairs
from workhold.search.wall_shares import LatticePairSearch, WallShares

KITE = [(0, 0, 0), (56, 6, 0), (48, 44, 0), (10, 37, 0)]
ROCKER = [(0, 0, 0), (14, 0, 0), (20, 8, 0), (40, 8, 0), (46, 0, 0), (60, 0, 0.5), (60, 40, 0.2), (0, 40, 0)]
# Bosses of one radius whose centres are a step of the lattice apart, and holes.
BOSSES = [(0, 0, 0), (60, 0, 0), (60, 20, 0), (50, 20, 1), (30, 20, 0), (20, 20, 1), (0, 20, 0)]


def problem_of(workpiece: Workpiece, margin: float = 0.0, pitch: float = 8.0) -> Problem:
    """The search of a part in a flat-jaw vise."""
    return Problem.from_query(Query(workpiece, FlatJaw(pitch=pitch, peg_radius=2), contact_margin=margin))


@pytest.mark.parametrize("margin", [0.0, 3.0])
@pytest.mark.parametrize("loop", [KITE, ROCKER, NOTCHED, BOSSES], ids=["kite", "rocker", "notched", "bosses"])
def test_balls_find_the_same_places_forces_and_verdicts(loop: list[tuple[float, ...]], margin: float) -> None:
    """Of every pair of which a bound is known; the bound holds, and what doubles decide is so."""
    problem = problem_of(part(loop), margin)
    looked = sharp_ones = 0
    for edge in range(len(problem.workpiece.hull_edges)):
        lying = lay_part_on_wall(problem, edge)
        for pairs in find_pairs_on_edge(lying, (8.0, 8.0), (inf, inf), margin):
            closed, held, open_ = compute_pair_closure(pairs, lying, problem)
            for k in range(0, len(pairs), 3):
                verdict, sharp = decide_pair(pairs.make_candidate(k, edge), problem)
                looked += 1
                if not open_[k]:
                    assert verdict is bool(held[k])
                if sharp is not None and np.isfinite(pairs.reach[k]):
                    sharp_ones += 1
                    assert np.abs(np.array(sharp.points) - pairs.point[k]).max() <= pairs.reach[k] + 1e-12
                    assert np.allclose(sharp.null, closed.null[k], atol=1e-9)
    assert looked > 20 and (sharp_ones > 3 or margin > 0)


def test_where_curves_only_graze_no_bound_is_known_and_balls_decide() -> None:
    """Two bosses a step apart: circles that touch have one normal, so nothing closes, and nothing stays open."""
    problem = problem_of(part(BOSSES), pitch=15.0)
    unknown = 0
    for edge in range(len(problem.workpiece.hull_edges)):
        lying = lay_part_on_wall(problem, edge)
        for pairs in find_pairs_on_edge(lying, (15.0, 15.0), (inf, inf), 0.0):
            unknown += int(np.isinf(pairs.reach).sum())
            good, undecided, sharpened = select_pressed_pairs(pairs, edge, lying, problem)
            assert len(undecided) == 0
            assert np.isfinite(good.point).all() and np.isfinite(good.null).all()
            assert sharpened >= int((np.isinf(pairs.reach) & (pairs.slack > 0)).sum())
    assert unknown > 0


def test_what_doubles_are_too_coarse_for_is_taken_from_balls() -> None:
    """Forced to be coarse: every pair is decided again, and the same fixtures are found."""
    search = LatticePairSearch(problem_of(part(ROCKER)))
    for edge in search.edges:
        lying = lay_part_on_wall(search.problem, edge)
        for pairs in find_pairs_on_edge(lying, (8.0, 8.0), (inf, inf), 0.0):
            fine, _, _ = select_pressed_pairs(pairs, edge, lying, search.problem)
            coarse = pairs.take(np.arange(len(pairs)))
            coarse.point[:] += 1e-9
            coarse.reach[:], coarse.swing[:] = np.inf, np.inf
            sharp, undecided, count = select_pressed_pairs(coarse, edge, lying, search.problem)
            assert len(undecided) == 0 and count >= len(fine)
            assert np.allclose(sharp.point, fine.point, atol=1e-11) and np.allclose(
                sharp.null, fine.null, atol=1e-9
            )


def test_places_that_are_told_too_coarsely_are_taken_from_balls() -> None:
    """Also where the verdict is clear: with a bound above what one place is, the ball's place stands in the list."""
    problem = problem_of(part(KITE))
    lying = lay_part_on_wall(problem, 0)
    (pairs,) = find_pairs_on_edge(lying, (8.0, 8.0), (inf, inf), 0.0)
    fine, _, _ = select_pressed_pairs(pairs, 0, lying, problem)
    pairs.point[:] += 1e-8
    pairs.reach[:] = 1e-6
    sharp, _, _ = select_pressed_pairs(pairs, 0, lying, problem)
    assert len(sharp) == len(fine) > 0 and np.allclose(sharp.point, fine.point, rtol=0.0, atol=1e-11)


def test_a_search_that_is_cancelled_within_a_hull_edge_says_so() -> None:
    """What was found in it so far is kept."""
    cancel = Event()
    shares = WallShares.from_query(Query(part(KITE), FlatJaw(pitch=8, peg_radius=2)), cancel)
    _, whole = shares.search_share(0, None)
    assert whole
    cancel.set()
    found, whole = shares.search_share(0, None)
    assert not whole and found is not None and len(found) > 0
