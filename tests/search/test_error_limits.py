"""The best by limits of the location error are the first of all, and what a limit rules out is surely beyond it."""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from typing import Any

import numpy as np
import pytest
from attrs import evolve

from cad_parts import cad_part
from workhold import OpeningVise, Plate, Query, Result, Tolerance, Vise, Workpiece, answer, load
from workhold.contact.problem import Problem
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.hull import compute_convex_hull
from workhold.kernels.base.feature import HALF_EXTENT, IS_ARC, X, Y
from workhold.listing.bounds import list_preferred_angles
from workhold.listing.canonical_form import list_each_once
from workhold.listing.collector import InterestLimits, decide_and_list
from workhold.listing.placing import place_candidates
from workhold.listing.ranking import PER_MM, find_usual_errors, make_table_keys, measure_table
from workhold.proof.deciding import DecidingProgress
from workhold.search import design as designing
from workhold.search import shares
from workhold.search.error_limits import (
    LocatorSpots,
    bound_keys_beyond_limit,
    bound_location_errors,
    can_limit_errors,
    choose_next_limit,
    compute_contact_allowances,
    find_outermost_points,
    is_enough,
    measure_distance_from_hull,
)
from workhold.search.lattice_shares import LatticeShares
from workhold.search.shares import make_one_clamp_query
from workhold.search.toolkit_search import ToolkitSearch, limit_precision

TOLERANCE = Tolerance(peg=0.0145, face=0.01)


def rectangle(width: float, height: float) -> Workpiece:
    """A plain rectangle."""
    corners = [(0.0, 0.0, 0.0), (width, 0.0, 0.0), (width, height, 0.0), (0.0, height, 0.0)]
    return Workpiece("rectangle", [np.array(corners)])


def rounded(width: float, height: float, radius: float) -> Workpiece:
    """A rectangle with rounded corners: pegs on whole pitches stand exactly at their ends."""
    x, y, bulge = width - radius, height - radius, np.tan(np.pi / 8)
    corners = [(radius, 0.0), (x, 0.0), (width, radius), (width, y), (x, height), (radius, height)]
    points = [*corners, (0.0, y), (0.0, radius)]
    return Workpiece("rounded", [np.array([(*at, bulge * (k % 2)) for k, at in enumerate(points)])])


PARTS = {
    "flange": load("flange"),
    "widget": load("widget"),
    "bores": cad_part(2),
    "arcs": cad_part(7),
    "rectangle": rectangle(120.0, 80.0),
    "rounded": rounded(120.0, 90.0, 4.0),
}
KITS: dict[str, Toolkit] = {
    "plate": Plate(pitch=16, peg_radius=3),
    "two clamps": Plate(pitch=30, peg_radius=3, clamps=2),
    "vise": Vise(pitch=10, columns=2, peg_radius=3),
    "opening": OpeningVise(pitch=10, columns=2, peg_radius=3),
}


def listed(result: Result, count: int) -> list[Any]:
    """What a file says of the first fixtures."""
    table = result.table.take(slice(count))
    columns = (
        table.arrangement,
        table.column,
        table.row,
        table.face,
        table.theta,
        table.position,
        table.pairs,
    )
    return [None if column is None else np.asarray(column).tolist() for column in columns]


@pytest.fixture
def limited(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """Has every part count as a large one; the limits that are tried."""
    tried: list[float] = []
    plain = LocatorSpots.make_error_limit

    def limit(self: LocatorSpots, most: float) -> Any:
        tried.append(most)
        return plain(self, most)

    monkeypatch.setattr(designing, "LIMITED_FROM", 0.0)
    monkeypatch.setattr(LocatorSpots, "make_error_limit", limit)
    return tried


@pytest.mark.thorough
@pytest.mark.parametrize("kit", ["plate", "two clamps"])
@pytest.mark.parametrize("part", PARTS)
def test_the_best_are_the_first_of_all(part: str, kit: str, limited: list[float]) -> None:
    """Whatever number is asked for, ties and pairs of clamps included."""
    everything = answer(Query(PARTS[part], KITS[kit], tolerance=TOLERANCE))
    for count in (1, 5, 20):
        best = answer(Query(PARTS[part], KITS[kit], tolerance=TOLERANCE, best=count))
        assert listed(best, count) == listed(everything, count)
        assert best.least_effective_error == everything.least_effective_error
        assert best.complete
    assert bool(limited) == bool(len(everything))


@pytest.mark.thorough
@pytest.mark.usefixtures("limited")
@pytest.mark.parametrize("clamps", [1, 2])
def test_a_contact_at_a_joint_is_on_the_face_of_the_lowest_number(clamps: int) -> None:
    """Also where that makes an error too large, and the contact on the other face has a small one."""
    query = Query(
        rounded(100.0, 60.0, 3.0), Plate(pitch=20, peg_radius=3, clamps=clamps), tolerance=TOLERANCE
    )
    everything = answer(query)
    for count in (2, 10, 40):
        assert listed(answer(evolve(query, best=count)), count) == listed(everything, count)


@pytest.mark.thorough
@pytest.mark.parametrize("kit", ["vise", "opening"])
@pytest.mark.parametrize("part", ["widget", "bores", "flange"])
def test_what_is_known_beforehand_does_not_show(part: str, kit: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """In vises some chord curves tell which error is to be reached; the best are the first of all."""
    asked = list[float]()
    plain = ToolkitSearch.run_kernel

    def run(
        self: ToolkitSearch, kernel: Any, low: float, high: float, stats: Any, needed: InterestLimits
    ) -> Any:
        asked.append(needed.error if self.every == 1 else inf)
        return plain(self, kernel, low, high, stats, needed)

    everything = answer(Query(PARTS[part], KITS[kit], tolerance=TOLERANCE))
    monkeypatch.setattr(shares, "SCOUTED_FROM", 0.0)
    monkeypatch.setattr(shares, "SCOUTED", 2)
    monkeypatch.setattr(ToolkitSearch, "run_kernel", run)
    for count in (1, 5, 20):
        asked.clear()
        best = answer(Query(PARTS[part], KITS[kit], tolerance=TOLERANCE, best=count), threads=1)
        assert listed(best, count) == listed(everything, count)
        assert best.least_effective_error == everything.least_effective_error
        assert best.complete
        assert count > 1 or not len(everything) or max(asked[len(asked) // 2 :]) < inf


@pytest.mark.thorough
def test_what_limits_save_is_told(limited: list[float]) -> None:
    """How many boxes were looked at and ruled out, and far fewer contacts than a whole search examines."""
    query = Query(rectangle(150.0, 90.0), Plate(pitch=15, peg_radius=3, clamps=2), tolerance=TOLERANCE)
    best, everything = (
        answer(Query(query.workpiece, query.toolkit, tolerance=TOLERANCE, best=5)),
        answer(query),
    )
    assert 0 < best.statistics["boxes_ruled_out"] < best.statistics["boxes"]
    assert best.statistics["contacts_examined"] < 0.2 * everything.statistics["contacts_examined"]
    assert listed(best, 5) == listed(everything, 5)
    assert limited


def found_errors(search: ToolkitSearch, **asked: Any) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    """Effective errors in mm of the fixtures that a search finds, and which are fit and without a warning."""
    problem = search.problem
    blocks = search.make_blocks(problem.query.types, **asked)
    records = np.concatenate([np.zeros((0, 19)), *(block.work(InterestLimits()) for block in blocks)])
    candidates = list_each_once(decide_and_list(records, problem, DecidingProgress(len(records)))[0])
    keys = make_table_keys(
        measure_table(place_candidates(candidates, problem), problem),
        problem.query,
        find_usual_errors(problem.query),
    )
    assert keys.error is not None
    return keys.error / PER_MM, keys.is_fine


@pytest.mark.thorough
def test_what_lies_aslant_is_bounded_while_square_seats_are_looked_at(
    limited: list[float], monkeypatch: pytest.MonkeyPatch
) -> None:
    """So most contacts of square seats are not even proven, though others may be found up to the limit."""
    floors, looked = list[int](), list[int]()
    plain, proven = LatticeShares.bound_later_errors, LatticeShares.find_seats

    def floor(self: LatticeShares, share: int) -> int:
        floors.append(plain(self, share))
        return floors[-1]

    def seats_among(self: LatticeShares, records: Any, within: Any) -> Any:
        looked.append(sum(map(len, records)))
        return proven(self, records, within)

    monkeypatch.setattr(LatticeShares, "bound_later_errors", floor)
    monkeypatch.setattr(LatticeShares, "find_seats", seats_among)
    query = Query(rounded(300.0, 200.0, 3.0), Plate(pitch=20, peg_radius=3, clamps=2), best=20)
    best = answer(query)
    least = best.least_effective_error
    assert least is not None and min(floors) > least * PER_MM
    assert 0 < 2 * max(looked) < best.statistics["contacts_examined"]


@pytest.mark.thinned(9)
@pytest.mark.parametrize("times", [1.02, 1.2, 1.6])
@pytest.mark.parametrize("kit", ["plate", "vise", "opening"])
@pytest.mark.parametrize("part", ["flange", "widget", "bores", "rectangle"])
def test_a_limit_loses_nothing_below_it(part: str, kit: str, times: float) -> None:
    """Each fixture without a warning that is up to the limit is found, square or aslant, and not all beyond are."""
    query = Query(PARTS[part], KITS[kit], tolerance=TOLERANCE, best=5)
    problem = Problem.from_query(one_way(query))
    errors, fine = found_errors(ToolkitSearch.from_problem(problem))
    if not fine.any():
        pytest.skip("nothing holds it")
    most = times * float(errors[fine].min())
    search = ToolkitSearch.from_problem(
        problem, precision=limit_precision(bound_location_errors(problem), most)
    )
    some, good = found_errors(search)
    assert (some[good] <= most).sum() == (errors[fine] <= most).sum() > 0
    assert len(some) <= len(errors)
    if kit == "plate":
        limit = LocatorSpots.from_problem(problem).make_error_limit(most)
        parts = [
            found_errors(
                ToolkitSearch.from_problem(problem, near=near, precision=limit.precision, only=only),
                first=list_preferred_angles(query),
                rest=not only,
            )
            for near, only in ((limit.square, list_preferred_angles(query)), (limit.aslant, []))
        ]
        # What lies between two shares may be found in both.
        assert sum(((one <= most) & ok).sum() for one, ok in parts) >= (errors[fine] <= most).sum()


def one_way(query: Query) -> Query:
    """A query with the first of its toolkit's ways."""
    ways = query.toolkit.ways
    return query if len(ways) == 1 else make_one_clamp_query(query, ways[0])


@pytest.mark.thorough
def test_spots_join_what_fixtures_touch() -> None:
    """The three spots that locators of a fixture touch are marked at its own error, and hardly any far below."""
    query = Query(PARTS["bores"], KITS["plate"], tolerance=TOLERANCE, best=5)
    problem = Problem.from_query(query)
    spots = LocatorSpots.from_problem(problem)
    assert spots.least_middle_error > 0.0
    shares = [
        spots.make_error_limit(most).square.joined.mean()
        for most in (0.5 * spots.least_middle_error, spots.least_middle_error, 4.0 * spots.least_middle_error)
    ]
    assert shares[0] < shares[1] < shares[2]
    near = spots.make_error_limit(spots.least_middle_error).square
    # Whole circles count as one stretch, which is joined where any of its arcs is.
    rows = problem.rows[slice(*problem.standing)]
    circles = (rows[:, IS_ARC] != 0.0) & (rows[:, HALF_EXTENT] >= np.pi)
    assert circles.any() and (np.diff(near.starts)[circles] == 1).all()
    assert (np.diff(near.starts)[~circles & (rows[:, IS_ARC] == 0.0)] > 1).any()
    assert (near.joined == near.joined.T).all()
    marked = np.argwhere(near.triples)
    assert {tuple(row) for row in marked.tolist()} == {tuple(row) for row in marked[:, [2, 0, 1]].tolist()}


@pytest.mark.parametrize("part", ["bores", "arcs", "flange"])
def test_no_centre_moves_farther_than_its_give_says(part: str) -> None:
    """Where no point of the silhouette moves by more than 1, no centre of an arc does by more than that."""
    problem = Problem.from_query(Query(PARTS[part], KITS["plate"], tolerance=TOLERANCE, best=5))
    points, rows = find_outermost_points(problem), problem.rows[problem.rows[:, IS_ARC] != 0.0]
    gives, nearest = compute_contact_allowances(rows, points), np.zeros(len(rows))
    for seed in range(2000):
        x, y, turn = np.random.default_rng(seed).normal(size=3) * (1.0, 1.0, 1.0 / problem.wrench_length)
        moved, centers = (
            np.hypot(x - turn * at[:, 1], y + turn * at[:, 0]) for at in (points, rows[:, [X, Y]])
        )
        nearest = np.maximum(nearest, centers / moved.max())
    assert (nearest <= gives + 1e-9).all()
    inside = gives == 1.0
    assert inside.any() and (nearest[inside] > 0.6).all()


@pytest.mark.parametrize(
    ("place", "apart"), [((1.0, 1.0), 0.0), ((4.0, 1.0), 2.0), ((5.0, -4.0), 5.0), ((1.0, 2.5), 0.5)]
)
def test_the_distance_from_a_hull_is_that_of_its_nearest_point(
    place: tuple[float, float], apart: float
) -> None:
    corners = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0), (1.0, 0.5)]
    assert measure_distance_from_hull(compute_convex_hull(corners), place) == pytest.approx(apart)


@pytest.mark.thorough
@pytest.mark.parametrize("part", ["flange", "arcs", "bores"])
def test_what_lies_square_is_found_with_the_curves_that_come_there(part: str) -> None:
    query = Query(PARTS[part], KITS["plate"], tolerance=TOLERANCE, best=5)
    problem, first = Problem.from_query(query), list_preferred_angles(query)
    whole, some = (ToolkitSearch.from_problem(problem, only=only) for only in ((), first))
    assert len(some.table) < len(whole.table)
    one, other = (
        np.concatenate(
            [block.work(InterestLimits()) for block in search.make_blocks(query.types, first=first)]
        )
        for search in (whole, some)
    )
    assert len(one) == len(other) and (one == other).all()
    assert some.statistics["crossings_sought"] == whole.statistics["crossings_sought"] > 0


def test_the_next_limit_is_no_larger_than_it_must_be() -> None:
    """A tenth above the last one that is asked for is enough; without enough found it grows, at last without end."""
    query = Query(PARTS["flange"], KITS["plate"], tolerance=TOLERANCE, best=5)
    table = answer(Query(PARTS["flange"], KITS["plate"], tolerance=TOLERANCE)).table
    keys = make_table_keys(table, query, find_usual_errors(query))
    assert keys.error is not None and keys.is_fine.sum() > 5
    last = float(np.sort(keys.error[keys.is_fine])[4]) / PER_MM
    least = float(keys.error.min()) / PER_MM
    assert is_enough(1.2 * last, keys, query) and is_enough(inf, keys, query)
    assert not is_enough(least, keys, query)
    assert least < choose_next_limit(least, keys, query, 1) <= 1.1001 * last
    # Nothing beyond a limit has less than the least keys of its class of angles.
    bound, limit = bound_keys_beyond_limit(1.2 * least, query), 1.2 * least * PER_MM
    beyond = keys.take((keys.error > limit) & keys.is_fine)
    assert len(beyond) > 10
    for row in beyond.rest:
        assert any(tuple(least_row) <= tuple(row) for least_row in bound.rest if least_row[0] == row[0])
    # Of two clamps, whose contacts wait in memory, limits grow slowly.
    few, pair = (
        keys.take(np.flatnonzero(keys.is_fine)[:4]),
        Query(PARTS["flange"], KITS["two clamps"], best=5),
    )
    assert choose_next_limit(1.0, few, pair, 1) < choose_next_limit(1.0, few, query, 1)
    assert 1.0 < choose_next_limit(1.0, few, query, 1) < inf == choose_next_limit(1.0, few, query, 99)


@pytest.mark.parametrize(
    "changed",
    [
        lambda q: Query(q.workpiece, q.toolkit, tolerance=TOLERANCE),
        lambda q: Query(q.workpiece, q.toolkit, tolerance=TOLERANCE, best=3, rank_by=["closure-margin"]),
        lambda q: Query(q.workpiece, q.toolkit, tolerance=Tolerance(0.0, 0.0), best=3),
    ],
    ids=["all", "another order", "no tolerance"],
)
def test_only_the_usual_order_of_the_best_limits_errors(changed: Callable[[Query], Query]) -> None:
    """Not where all are wanted, where other figures count, or where nothing is ever off."""
    query = Query(PARTS["flange"], KITS["plate"], tolerance=TOLERANCE, best=3)
    assert can_limit_errors(query) and not can_limit_errors(changed(query))


@pytest.mark.parametrize("clamps", [1, 2])
def test_nothing_is_sought_on_a_round_part(clamps: int) -> None:
    """All lines of action pass its centre; the reason is said as ever."""
    disc = Workpiece("disc", [np.array([(-30.0, 0.0, 1.0), (30.0, 0.0, 1.0)])])
    result = answer(Query(disc, Plate(pitch=10, peg_radius=3, clamps=clamps), best=3))
    assert len(result) == 0 == result.statistics["contacts_examined"] and result.complete
    assert result.reasons and ("about one centre" in str(result.reasons[0]) or clamps == 2)
