"""An estimate of how many fixtures there are, from a part of the search.

Cells of orientation are drawn with a probability that grows with the work in them (Horvitz and Thompson 1952,
*A Generalization of Sampling Without Replacement From a Finite Universe*). A drawn cell is searched as usual,
and its fixtures are weighted by the inverse of its probability. The number of fixtures in a cell grows with
its work, so a few per cent of the work give the total to within some ten per cent. The draw is systematic:
the same query always has the same estimate.
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
from workhold.listing.collector import decide_on_this_thread, split_into_blocks
from workhold.listing.seat_order import number_seats
from workhold.listing.seats import ClampedSeats
from workhold.model.clamps import LOCATORS
from workhold.model.query import Query
from workhold.search.cells import SearchBlock, estimate_cost, run_blocks
from workhold.search.error_limits import bound_location_errors
from workhold.search.lattice_shares import LatticeShares, make_searches
from workhold.search.toolkit_search import MOST_CELLS, ToolkitSearch, sample_numbers

__all__ = ["LISTED", "MANY", "ask_for_best_where_many", "estimate_fixtures"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

# Where there are about more than MANY fixtures, only the best LISTED are listed, unless all are asked for.
MANY, LISTED = 200_000, 1_000
# Searches that cost less, see ``cells.SearchBlock``, surely find fewer.
FEW = 4e6
# Work spent on an estimate with one clamp and with two, and the most with one clamp where cells hold much.
# Then the fewest cells drawn with one clamp and with two, and the most with two, where more add little.
WORK, WORK_OF_TWO, MOST_WORK = 6e6, 2e6, 3e7
FEWEST_DRAWN, FEWEST_OF_TWO, MOST_OF_TWO = 48, 8, 32
# Records decided for an estimate with one clamp, and contacts decided in one cell with two.
DECIDED, CONTACTS_DECIDED = 4000, 3000
# With more work than MOST_IN_CELL in a cell, only one in some triples of stretches is searched; there are
# about STRETCHES stretches.
MOST_IN_CELL, STRETCHES = 3e5, 96
# A contact at the end of a stretch is moved by this part of the stretch, so that rounding does not decide its
# side.
ASIDE = 1e-6
# Where in the first interval a systematic draw begins.
BEGIN = 0.618


def estimate_fixtures(query: Query, threads: int, cancel: Event | None = None) -> int | None:
    """Return the estimated number of all fixtures of a query, whatever its ``best`` is.

    None if they are surely few, or once ``cancel`` is set. None also for queries with a wall, with friction,
    with seating, or with rules that are tested on each fixture by itself: their numbers are not estimated.
    """
    held_flat = WALL_END in query.toolkit.contacts or query.toolkit.holds_by_friction
    if held_flat or query.seating is not None or query.is_sifted:
        return None
    query = evolve(query, best=None)
    if query.toolkit.travel_count > 1:
        return estimate_clamp_pairs(query, threads, cancel)
    ways = [estimate_one_direction(evolve(query, toolkit=way), threads, cancel) for way in query.toolkit.ways]
    known = [count for count in ways if count is not None]
    return sum(known) if known else None


def ask_for_best_where_many(
    query: Query, threads: int, cancel: Event | None = None
) -> tuple[Query, int | None]:
    """Return (the query, the estimated number of fixtures); a query with too many fixtures is replaced by one
    for the best.

    With more than about :data:`MANY` fixtures the best :data:`LISTED` are asked for. The number is None if
    the fixtures are few, if it cannot be estimated, and for a query that already asks for the best.
    """
    if query.best is not None:
        return query, None
    count = estimate_fixtures(query, threads, cancel)
    return (query, count) if count is None or count <= MANY else (evolve(query, best=LISTED), count)


def estimate_one_direction(query: Query, threads: int, cancel: Event | None) -> int | None:
    """Return the estimated number of fixtures in a toolkit with one moving carrier.

    None where they are surely few, or once cancelled.
    """
    problem = Problem.from_query(query)
    search = ToolkitSearch.from_problem(problem, threads=threads, cancel=cancel)
    blocks = search.make_blocks(query.types, MOST_CELLS)
    costs = np.array([block.cost for block in blocks])
    if costs.sum() < FEW:
        return None
    dense = np.array([block.dense for block in blocks])
    finds = costs * dense
    drawn, chances = draw_by_size(finds, max(estimate_draw_count(WORK, costs, finds), FEWEST_DRAWN))
    # Where the drawn cells hold too much work, only some chord curves are used. Crossings are made of two
    # curves, sliding pairs of one.
    search.every = max(int(sqrt(costs[drawn].sum() / MOST_WORK)), 1)
    chances = chances / np.where(dense[drawn] > 1.0, search.every, search.every**2)
    records, _ = run_blocks([blocks[k] for k in drawn], threads, None, cancel, stop=search.stop)
    if len(records) < len(drawn):
        return None
    weights = np.repeat(1.0 / chances, [len(some) for some in records])
    if len(weights) == 0:
        return 0
    # Only some records, drawn by their weights, are decided.
    chosen, again = draw_by_size(weights, DECIDED)
    kept, _ = decide_on_this_thread([np.concatenate(records)[chosen]], problem, cancel)
    proven = len(kept.standing) / len(chosen)
    # The chance of a record grows with its weight, so each stands for as many as any other.
    return round(float((weights[chosen] / again).sum()) * proven)


def estimate_clamp_pairs(query: Query, threads: int, cancel: Event | None) -> int | None:
    """Return the estimated number of listed fixtures with two clamps.

    None where they are surely few, or once cancelled.
    """
    searches = make_searches(query, threads, cancel)
    one = searches[0]
    blocks = one.make_blocks(one.problem.toolkit.types, MOST_CELLS)
    if estimate_cost(blocks) < FEW:
        return None
    starts, costs, finds = sum_up_cells(blocks)
    width, total = float(np.diff(starts, append=starts[0] + tau).min()), 0.0
    count = min(max(estimate_draw_count(WORK_OF_TWO, costs, finds), FEWEST_OF_TWO), MOST_OF_TWO)
    problems = [search.problem for search in searches]
    for cell, chance in zip(*draw_by_size(finds, count), strict=True):
        # The part's angle is -psi, and a quarter turn more for each that the frame of the search is turned.
        high = (one.frame.quarters * pi / 2 - starts[cell]) % tau
        ranges = [(low, low + width) for low in (high - width, high - width + tau, high - width - tau)]
        stretches = FeatureStretches.from_problems(problems, max(int(finds[cell] / MOST_IN_CELL), 1))
        total += estimate_listed(searches, stretches, query, ranges, threads, cancel) / chance
        if cancel is not None and cancel.is_set():
            return None
    return round(total)


@frozen(eq=False)
class FeatureStretches:
    """A random choice among the triples of stretches of features that three locators can touch.

    The choice concerns the locators alone, so that it is the same for all directions of the clamps.

    Parameters
    ----------
    every : about one in ``every`` triples is chosen.
    near : the division of the features into stretches, and the chosen triples of stretches.
    numbers : (M,) a random number for each stretch.
    """

    every: int
    near: NearSpots
    numbers: IntArray

    @classmethod
    def from_problems(cls, problems: Sequence[Problem], every: int) -> FeatureStretches:
        """Return a choice that is valid for the problems of all directions of the clamp.

        The stretches are about equally long.
        """
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

    def select_contacts(self, records: list[Array], problem: Problem) -> Array:
        """Return those records (M, 19) of blocks whose three locators touch a chosen triple of stretches."""
        blocks = split_into_blocks(records)
        if self.every > 1:
            blocks = (block[self.are_chosen(block, problem)] for block in blocks)
        return np.concatenate(list(blocks))

    def are_chosen(self, records: Array, problem: Problem) -> BoolArray:
        """Return a mask (N,): True for records (N, 19) whose three locators touch a chosen triple of
        stretches.
        """
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


def sum_up_cells(blocks: Sequence[SearchBlock]) -> tuple[Array, Array, Array]:
    """Return (starts, costs, finds) of the cells of orientation in which blocks begin, each (C,), starts
    ascending.

    ``starts`` are orientations psi in radians. ``costs`` and ``finds`` are the estimated work and the
    expected number of records, summed over the blocks that begin in the cell.
    """
    starts, number = np.unique([block.start for block in blocks], return_inverse=True)
    costs, finds = np.zeros(len(starts)), np.zeros(len(starts))
    for block, at in zip(blocks, number.tolist(), strict=True):
        costs[at] += block.cost
        finds[at] += block.cost * block.dense
    return starts, costs, finds


def estimate_listed(
    searches: Sequence[ToolkitSearch],
    stretches: FeatureStretches,
    query: Query,
    ranges: Sequence[tuple[float, float]],
    threads: int,
    cancel: Event | None,
) -> float:
    """Return the estimated number of listed fixtures with two clamps whose orientation lies in one range.

    ``ranges`` are three (low, high) in radians: the range itself, a whole turn later, and a whole turn
    earlier.
    """
    low, high = map(degrees, ranges[0])
    # Of cells that only touch the range none is searched.
    inside = [(low + 2.0 * ANGLE_HAIR, high - 2.0 * ANGLE_HAIR)]
    found = []
    for search in searches:
        chosen = evolve(search, near=stretches.near, precision=bound_location_errors(search.problem))
        blocks = chosen.make_blocks(search.problem.toolkit.types, MOST_CELLS, within=inside)
        records = run_blocks(blocks, threads, None, cancel, stop=chosen.stop)[0]
        found.append(stretches.select_contacts(records, search.problem))
    every = sum(map(len, found)) // CONTACTS_DECIDED + 1
    collector = ClampedSeats(query, searches[0].problem)
    some = [
        sample_contacts_by_seat(part, search.problem, every)
        for part, search in zip(found, searches, strict=True)
    ]
    # What is not decided quickly is left out.
    hurry = Event()
    hurry.set()
    with LatticeShares.open_for_contacts(searches, collector, threads, hurry) as shares:
        return float(stretches.every * every * collector.count_fixtures(shares.find_seats(some, ranges)))


def sample_contacts_by_seat(records: Array, problem: Problem, every: int) -> Array:
    """Return the records (M, 19) of about one in ``every`` seats. All records of a chosen seat are kept.

    A seat is the pose that three locators fix.
    """
    holes, theta, *_ = number_seats(records, problem)
    # Seats with the same holes and nearly the same orientation are taken together.
    seats = holes * 0x85EBCA6B + np.round(theta / (100.0 * SAME_POSE)).astype(np.int64)
    return np.asarray(records[sample_numbers(seats, every)])


def draw_by_size(sizes: Array, count: float) -> tuple[IntArray, Array]:
    """Return (1) the indices of drawn items, about ``count`` of N, and (2) the chance of each drawn item.

    Chances are in proportion to ``sizes`` (N,), but at most 1. The draw is systematic: equal arguments give
    an equal draw.
    """
    chances = np.minimum(count * sizes / sizes.sum(), 1.0)
    steps = np.floor(np.cumsum(chances) + BEGIN)
    drawn = np.flatnonzero(np.diff(steps, prepend=np.floor(BEGIN)) > 0)
    return drawn, chances[drawn]


def estimate_draw_count(work: float, costs: Array, finds: Array) -> float:
    """Return how many items to draw so that the drawn items cost ``work`` together on average.

    Items are drawn with chances in proportion to ``finds`` (N,); item k costs ``costs[k]``.
    """
    return work * float(finds.sum() / (finds @ costs))
