"""An estimate of how many fixtures there are, from a part of the search.

Cells of orientation are drawn with a chance that grows with the work in them (Horvitz and Thompson 1952, *A
Generalization of Sampling Without Replacement From a Finite Universe*). Each cell is searched as always, and
what it holds counts as often as its chance is small. Fixtures lie where there is work, so a few per cent of
the work show the number within some tenths of it. The draw is systematic: the same query has the same
estimate.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees, pi, sqrt, tau
from threading import Event

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from workhold.contact.curves import EVERYWHERE
from workhold.contact.problem import Problem
from workhold.conventions import ANGLE_HAIR, SAME_POSE
from workhold.fixels.contacts import WALL_END
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, RADIUS, X, Y
from workhold.kernels.base.tables import NearSpots
from workhold.listing.canonical_form import make_candidates
from workhold.listing.collector import finish, split_into_blocks
from workhold.listing.seat_order import seat_numbers
from workhold.listing.seats import ClampedSeats
from workhold.model.clamps import LOCATORS
from workhold.model.query import Query
from workhold.search.cells import Block, estimate_cost, run_blocks
from workhold.search.error_limits import bound_location_errors
from workhold.search.lattice_shares import LatticeShares, searches_of
from workhold.search.toolkit_search import MOST_CELLS, ToolkitSearch, sample_numbers

__all__ = ["LISTED", "MANY", "ask_for_best_where_many", "estimate_fixtures"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

# Of more fixtures than this only so many are listed, the best, unless all are asked for.
MANY, LISTED = 200_000, 1_000
# Searches that cost less, see ``cells.Block``, surely find fewer.
FEW = 4e6
# Work that is done for an estimate with one clamp and with two, and the fewest cells that are drawn for it.
# Of cells for two clamps, more add little. So much more work is done with one clamp where cells hold more.
WORK, WORK_OF_TWO, MOST_WORK = 6e6, 2e6, 3e7
FEWEST_DRAWN, FEWEST_OF_TWO, MOST_OF_TWO = 48, 8, 32
# Records that are decided for an estimate, and contacts of two clamps in one cell.
DECIDED, CONTACTS_DECIDED = 4000, 3000
# Of more work for two clamps in one cell one triple of stretches in some is looked at. There are about so many
# stretches.
MOST_IN_CELL, STRETCHES = 3e5, 96
# Parts of a stretch by which a contact at its end is moved, so that rounding does not say on which side it is.
ASIDE = 1e-6
# Where in the first interval a systematic draw begins.
BEGIN = 0.618


def estimate_fixtures(query: Query, threads: int, cancel: Event | None = None) -> int | None:
    """How many fixtures a query has, about.

    None where they are surely few, beside a wall, with rules for their seating or for each by itself, and once
    ``cancel`` is set.
    """
    held_flat = WALL_END in query.toolkit.contacts or query.toolkit.holds_by_friction
    if held_flat or query.seating is not None or query.is_sifted:
        return None
    query = evolve(query, best=None)
    if query.toolkit.travels > 1:
        return estimate_clamp_pairs(query, threads, cancel)
    ways = [estimate_one_direction(evolve(query, toolkit=way), threads, cancel) for way in query.toolkit.ways]
    known = [count for count in ways if count is not None]
    return sum(known) if known else None


def ask_for_best_where_many(
    query: Query, threads: int, cancel: Event | None = None
) -> tuple[Query, int | None]:
    """A query for all fixtures, or for the best where there are more than anybody reads.

    With it comes how many there are, about; None where they are few, or the query is for the best already.
    """
    if query.best is not None:
        return query, None
    count = estimate_fixtures(query, threads, cancel)
    return (query, count) if count is None or count <= MANY else (evolve(query, best=LISTED), count)


def estimate_one_direction(query: Query, threads: int, cancel: Event | None) -> int | None:
    """How many fixtures there are about in a toolkit of which one carrier moves; None where they are few."""
    problem = Problem.of(query)
    search = ToolkitSearch.of(problem, threads=threads, cancel=cancel)
    blocks = search.blocks(query.types, MOST_CELLS)
    costs = np.array([block.cost for block in blocks])
    if costs.sum() < FEW:
        return None
    dense = np.array([block.dense for block in blocks])
    finds = costs * dense
    drawn, chances = draw_by_size(finds, max(number_for(WORK, costs, finds), FEWEST_DRAWN))
    # Where these cells hold too much work, only some chord curves are looked at. What crosses is made of two
    # of them, what slides of one.
    search.every = max(int(sqrt(costs[drawn].sum() / MOST_WORK)), 1)
    chances = chances / np.where(dense[drawn] > 1.0, search.every, search.every**2)
    records, _ = run_blocks([blocks[k] for k in drawn], threads, None, cancel, stop=search.stop)
    if len(records) < len(drawn):
        return None
    weights = np.repeat(1.0 / chances, [len(some) for some in records])
    if len(weights) == 0:
        return 0
    # Of all records so many are decided, drawn by their weights.
    chosen, again = draw_by_size(weights, DECIDED)
    kept, _ = finish([np.concatenate(records)[chosen]], problem, cancel)
    proven = len(kept.standing) / len(chosen)
    # The chance of a record grows with its weight, so each stands for as many as any other.
    return round(float((weights[chosen] / again).sum()) * proven)


def estimate_clamp_pairs(query: Query, threads: int, cancel: Event | None) -> int | None:
    """How many fixtures two clamps have, about, as they are listed; None where they are few."""
    searches = searches_of(query, threads, cancel)
    one = searches[0]
    blocks = one.blocks(one.problem.toolkit.types, MOST_CELLS)
    if estimate_cost(blocks) < FEW:
        return None
    starts, costs, finds = cells_of(blocks)
    width, total = float(np.diff(starts, append=starts[0] + tau).min()), 0.0
    count = min(max(number_for(WORK_OF_TWO, costs, finds), FEWEST_OF_TWO), MOST_OF_TWO)
    problems = [search.problem for search in searches]
    for cell, chance in zip(*draw_by_size(finds, count), strict=True):
        # The part's angle is -psi, and a quarter turn more for each that the frame of the search is turned.
        high = (one.frame.quarters * pi / 2 - starts[cell]) % tau
        ranges = [(low, low + width) for low in (high - width, high - width + tau, high - width - tau)]
        stretches = Stretches.of(problems, max(int(finds[cell] / MOST_IN_CELL), 1))
        total += listed_in(searches, stretches, query, ranges, threads, cancel) / chance
        if cancel is not None and cancel.is_set():
            return None
    return round(total)


@frozen(eq=False)
class Stretches:
    """Of three locators, which stretches of features they touch; of triples of stretches one in some is chosen.

    The locators of a seat touch the same ones whatever the directions of its clamps are.

    Parameters
    ----------
    every : one in so many triples is chosen.
    near : the stretches, and which triples are chosen.
    numbers : (M,) of each stretch one as if drawn.
    """

    every: int
    near: NearSpots
    numbers: IntArray

    @classmethod
    def of(cls, problems: Sequence[Problem], every: int) -> Stretches:
        """Stretches of the features of the problems of each direction, about equally long."""
        rows = problems[0].rows[slice(*problems[0].standing)]
        lengths = rows[:, HALF_EXTENT] * np.where(rows[:, IS_ARC] != 0.0, rows[:, RADIUS], 1.0)
        counts = np.maximum(np.rint(STRETCHES * lengths / lengths.sum()), 1).astype(np.int64)
        starts = np.cumsum([0, *counts.tolist()])
        numbers = np.random.default_rng(0).integers(1 << 60, size=int(starts[-1]))
        if every == 1:
            return cls(every, EVERYWHERE, numbers)
        # A sum does not tell in which order locators are.
        sums = numbers[:, None] + numbers
        triples = np.stack([sample_numbers(sums + number, every) for number in numbers.tolist()])
        joined = np.ones(sums.shape, np.int8)
        return cls(every, NearSpots(starts, joined, triples.astype(np.int8)), numbers)

    def chosen(self, records: list[Array], problem: Problem) -> Array:
        """The contacts (M, 19) of blocks whose locators touch three stretches that are chosen."""
        blocks = split_into_blocks(records)
        if self.every > 1:
            blocks = (block[self.are_chosen(block, problem)] for block in blocks)
        return np.concatenate(list(blocks))

    def are_chosen(self, records: Array, problem: Problem) -> BoolArray:
        """Whether the locators of contacts (N, 19) touch three stretches that are chosen."""
        c = make_candidates(records, problem)
        feature, rows = c.feature[:, :LOCATORS], problem.rows[c.feature[:, :LOCATORS]]
        axis, ray = rows[..., AXIS_X : AXIS_Y + 1], c.point[:, :LOCATORS] - rows[..., X : Y + 1]
        along = (axis * ray).sum(axis=2)
        turned = np.arctan2(axis[..., 0] * ray[..., 1] - axis[..., 1] * ray[..., 0], along)
        at = np.where(rows[..., IS_ARC] != 0.0, turned, along) / rows[..., HALF_EXTENT]
        starts = self.near.starts
        count = starts[feature + 1] - starts[feature]
        place = np.floor((at + 1.0) / 2.0 * count + ASIDE).astype(np.int64)
        return sample_numbers(
            self.numbers[starts[feature] + np.clip(place, 0, count - 1)].sum(axis=1), self.every
        )


def cells_of(blocks: Sequence[Block]) -> tuple[Array, Array, Array]:
    """Where the cells of blocks begin, in radians, the work in each, and how much is found there."""
    starts, number = np.unique([block.start for block in blocks], return_inverse=True)
    costs, finds = np.zeros(len(starts)), np.zeros(len(starts))
    for block, at in zip(blocks, number.tolist(), strict=True):
        costs[at] += block.cost
        finds[at] += block.cost * block.dense
    return starts, costs, finds


def listed_in(
    searches: Sequence[ToolkitSearch],
    stretches: Stretches,
    query: Query,
    ranges: Sequence[tuple[float, float]],
    threads: int,
    cancel: Event | None,
) -> float:
    """How many fixtures of two clamps are listed, about, with orientations in a range in radians.

    The range is given with those a whole turn before and after it.
    """
    low, high = map(degrees, ranges[0])
    # Of cells that only touch the range none is searched.
    inside = [(low + 2.0 * ANGLE_HAIR, high - 2.0 * ANGLE_HAIR)]
    found = []
    for search in searches:
        chosen = evolve(search, near=stretches.near, precision=bound_location_errors(search.problem))
        blocks = chosen.blocks(search.problem.toolkit.types, MOST_CELLS, within=inside)
        records = run_blocks(blocks, threads, None, cancel, stop=chosen.stop)[0]
        found.append(stretches.chosen(records, search.problem))
    every = sum(map(len, found)) // CONTACTS_DECIDED + 1
    collector = ClampedSeats(query, searches[0].problem)
    some = [thinned(part, search.problem, every) for part, search in zip(found, searches, strict=True)]
    # What is not decided quickly is left out.
    hurry = Event()
    hurry.set()
    with LatticeShares.made(searches, collector, threads, hurry) as shares:
        return float(stretches.every * every * collector.count(shares.seats_among(some, ranges)))


def thinned(records: Array, problem: Problem, every: int) -> Array:
    """Of contacts (N, 19) those (M, 19) of one seat in so many."""
    holes, theta, *_ = seat_numbers(records, problem)
    # Seats with the same holes and nearly the same orientation are taken together.
    seats = holes * 0x85EBCA6B + np.round(theta / (100.0 * SAME_POSE)).astype(np.int64)
    return np.asarray(records[sample_numbers(seats, every)])


def draw_by_size(sizes: Array, count: float) -> tuple[IntArray, Array]:
    """About so many numbers, drawn with chances that grow with their sizes (N,), and the chances."""
    chances = np.minimum(count * sizes / sizes.sum(), 1.0)
    steps = np.floor(np.cumsum(chances) + BEGIN)
    drawn = np.flatnonzero(np.diff(steps, prepend=np.floor(BEGIN)) > 0)
    return drawn, chances[drawn]


def number_for(work: float, costs: Array, finds: Array) -> float:
    """How many of some costs (N,), drawn by what they find (N,), have together so much work."""
    return work * float(finds.sum() / (finds @ costs))
