"""The search for two clamps on a lattice, in shares: the seats of one range of orientations after the other.

Three locators alone fix the pose, and both clamps follow in closed form. So pairs are made of the contacts of
three locators and one clamp that the search of each direction proves, not asked to close. Ranges keep no more
than the seats of one of them in memory.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import contextmanager
from functools import partial
from itertools import chain, pairwise
from math import degrees, radians, tau
from threading import Event

import numpy as np
from attrs import define, evolve, field
from numpy.typing import NDArray

from workhold.contact.curves import EVERYWHERE
from workhold.contact.problem import Problem, Progress
from workhold.conventions import SAME_POSE
from workhold.fixels.fields import PITCH
from workhold.kernels.base.tables import NearSpots
from workhold.kernels.curves.block_work import CANDIDATES
from workhold.limits import refuse_much_work
from workhold.listing.bounds import bound_keys_when_tilted, list_preferred_angles
from workhold.listing.canonical_form import Candidates, list_each_once, make_candidates, make_canonical
from workhold.listing.clamp_contacts import make_contacts_of_candidates
from workhold.listing.collector import split_into_blocks
from workhold.listing.contact_groups import PackedContacts
from workhold.listing.placing import are_at_angle
from workhold.listing.ranking import MOST_ERROR, OrderKeys
from workhold.listing.results import Work, make_stage_progress, sum_counts
from workhold.listing.seat_order import make_ordered_groups
from workhold.listing.seats import ClampedSeats, Seats, make_seats
from workhold.model.notes import NoPair
from workhold.model.query import Query
from workhold.proof.deciding import Account, Course, decided
from workhold.search.cells import Block, estimate_cost, run_blocks
from workhold.search.error_limits import ErrorLimit
from workhold.search.shares import bound_tilted_keys, select_one_clamp
from workhold.search.toolkit_search import ANY_ERROR, LEAST_BLOCKS, ToolkitSearch

__all__ = ["LatticeShares", "list_search_blocks", "make_problems", "searches_of", "count_ways"]

Array = NDArray[np.float64]
# Ranges of orientation in radians, from and up to but without the second.
Ranges = Sequence[tuple[float, float]]

# Blocks of one direction's search that are worked on before seats are made of what they found, and most such
# ranges.
BLOCKS_TOGETHER, MOST_RANGES = 48, 256
# Ways to look at in one range, see ``limits.MOST_WAYS``: its contacts take some gigabytes.
WAYS_TOGETHER = 1e7
# Of a range few cells are searched, which the threads are to share.
BLOCKS_PER_HALF_TURN = 2 * LEAST_BLOCKS
# So many contacts are looked at whole, and all is counted, even where only the best are asked for.
COUNTED_WHOLE = 1 << 14
# Radians beside a range that are searched as well, so that a seat on its edge is found whole from either
# side.
OVERLAP = 10 * SAME_POSE


@define(eq=False)
class LatticeShares:
    """Ranges of orientation, see ``search.shares.Locating``.

    Parameters
    ----------
    searches : of each direction of the clamp, for contacts that need not close.
    collector : takes the seats.
    whole_turn : blocks of each search that find everything.
    ranges : those of each share; of the first the square ones where there is a bound.
    bound : the least keys of fixtures at other than preferred angles; None where these do not come first.
    pool : of so many threads.
    cancel : when set, the search stops soon.
    square : the searches of the first share, where that is of square orientations with a limit of their own.
    """

    searches: Sequence[ToolkitSearch]
    collector: ClampedSeats
    whole_turn: Sequence[list[Block]]
    ranges: Sequence[Ranges]
    bound: OrderKeys | None
    pool: Executor
    threads: int
    cancel: Event | None
    square: Sequence[ToolkitSearch] = ()
    accounts: list[Account] = field(factory=list, init=False)
    cells: int = field(default=0, init=False)

    @classmethod
    @contextmanager
    def of(
        cls, query: Query, threads: int, cancel: Event | None, limit: ErrorLimit | None = None
    ) -> Iterator[LatticeShares]:
        """The shares of a query with two clamps, with threads for as long as the context lasts.

        With a limit those of seats with no larger location error, the square ones first.
        """
        if limit is not None:
            first = list_preferred_angles(query)
            square = searches_of(query, threads, cancel, limit, limit.square, first)
            aslant = searches_of(query, threads, cancel, limit, limit.aslant)
            blocks = [list_search_blocks(search) for search in aslant]
            ranges = order_square_ranges_first(ranges_of(blocks), first)
            seats = ClampedSeats(query, square[0].problem, is_limited=True)
            bound = bound_keys_when_tilted(query, square[0].problem)
            seats.ranked.has_dropped = True
            with ThreadPoolExecutor(max_workers=threads) as pool:
                yield cls(aslant, seats, blocks, ranges, bound, pool, threads, cancel, square)
            return
        searches = searches_of(query, threads, cancel)
        blocks = [list_search_blocks(search) for search in searches]
        x0, y0, x1, y1 = query.workpiece.bounds
        refuse_much_work(
            count_ways(blocks),
            (x1 - x0, y1 - y0),
            query.toolkit.carriers[0].pitch,
            partial(estimate_ways_at_pitch, query, threads),
        )
        problem = searches[0].problem
        bound, ranges = bound_tilted_keys(query, problem, count_ways(blocks)), ranges_of(blocks)
        if bound is not None:
            ranges = order_square_ranges_first(ranges, list_preferred_angles(query))
        seats = ClampedSeats(query, problem)
        with ThreadPoolExecutor(max_workers=threads) as pool:
            yield cls(searches, seats, blocks, ranges, bound, pool, threads, cancel)

    @classmethod
    @contextmanager
    def made(
        cls, searches: Sequence[ToolkitSearch], collector: ClampedSeats, threads: int, cancel: Event | None
    ) -> Iterator[LatticeShares]:
        """No shares, for seats of contacts that somebody else finds."""
        with ThreadPoolExecutor(max_workers=threads) as pool:
            yield cls(searches, collector, (), (), None, pool, threads, cancel)

    @property
    def shares(self) -> int:
        """How many shares there are."""
        return len(self.ranges)

    def look(self, share: int, progress: Progress | None) -> tuple[Iterator[Seats], bool]:
        """The seats of a share, some at a time where only the best are asked for.

        None where all of them are tilted, and a bound shows that no such fixture is among the best.
        """
        if share > 0 and self.bound is not None and self.collector.ranked.rules_out(self.bound):
            return iter(()), True
        found, is_whole = list[PackedContacts](), True
        for place, search in enumerate(self.square if self.square and share == 0 else self.searches):
            part = make_stage_progress(progress, place / len(self.searches), (place + 1) / len(self.searches))
            blocks = self.blocks_of(share, search, self.whole_turn[place])
            records, done = run_blocks(
                blocks,
                self.threads,
                counting(part, len(self.collector)),
                self.cancel,
                stop=search.stop,
                pool=self.pool,
            )
            self.cells += sum(block.cells for block in done)
            is_whole = is_whole and len(done) == len(blocks)
            found.append(PackedContacts.from_blocks(records))
        return self.seats(found, share), is_whole

    def blocks_of(self, share: int, search: ToolkitSearch, whole_turn: list[Block]) -> list[Block]:
        """The blocks of a search in which the seats of a share are, given those of a whole turn."""
        if self.shares == 1:
            return whole_turn
        if self.square:
            first = list_preferred_angles(self.collector.query)
            if share == 0:
                return search.blocks(search.problem.toolkit.types, BLOCKS_PER_HALF_TURN, first=first)
        blocks_in = partial(search.blocks, search.problem.toolkit.types, BLOCKS_PER_HALF_TURN)
        if share == 0 and self.bound is not None:
            return blocks_in(first=list_preferred_angles(self.collector.query))
        within = [(degrees(low - OVERLAP), degrees(high + OVERLAP)) for low, high in self.ranges[share]]
        return blocks_in(within=within)

    def seats(self, records: Sequence[PackedContacts], share: int) -> Iterator[Seats]:
        """The seats of contacts of each direction.

        Where only the best are asked for, those that may be at them come first, and none that cannot.
        """
        query, total, within = self.collector.query, sum(map(len, records)), self.ranges[share]
        if query.best is None or (self.shares == 1 and total <= COUNTED_WHOLE):
            yield self.seats_among([part.take(slice(None)) for part in records], within)
            return
        groups = make_ordered_groups(records, [search.problem for search in self.searches], query)
        edges = np.cumsum([0, *map(len, records)])
        for chosen in groups.iterate_batches(self.collector.ranked, self.floor(share)):
            places = np.searchsorted(chosen, edges).tolist()
            some = [
                part.take(chosen[first:end] - start)
                for part, start, (first, end) in zip(records, edges, pairwise(places), strict=False)
            ]
            yield self.seats_among(some, within)

    def floor(self, share: int) -> int:
        """An error in billionths of a mm that no fixture of the shares after this one has less than."""
        if share == self.shares - 1:
            return MOST_ERROR
        return 0 if self.bound is None or self.bound.error is None else int(self.bound.error.min())

    def seats_among(self, records: Sequence[Array], within: Ranges) -> Seats:
        """All seats of contacts (N, 19) of each direction."""
        problems = [search.problem for search in self.searches]
        parts = [
            make_contacts_of_candidates(self.proven(some, problem), problem)
            for some, problem in zip(records, problems, strict=True)
        ]
        return make_seats(parts, problems[0], within, self.collector.is_limited)

    def proven(self, records: Array, problem: Problem) -> Candidates:
        """Contacts of three locators and a clamp that are proven, each once."""
        course, blocks = Course(len(records), cancel=self.cancel), list(split_into_blocks([records]))

        def work(block: Array) -> tuple[Candidates, Account]:
            proven, account = decided(block, problem, course)
            candidates = make_canonical(make_candidates(proven, problem), 0)
            return candidates.take(
                are_at_angle(candidates.theta, problem.restrictions.angles, problem.frame)
            ), account

        parts, accounts = zip(*self.pool.map(work, blocks), strict=True)
        self.accounts += accounts
        return list_each_once(Candidates.concatenate(parts))

    def account(self) -> Account:
        """What became of all contacts so far."""
        return Account.together(self.accounts)

    def work(self, done: int, complete: bool) -> Work:
        """How the search went."""
        searches = [*self.square, *self.searches]
        examined = int(sum(search.totals[CANDIDATES] for search in searches))
        statistics = sum_counts(search.statistics for search in searches)
        return Work(complete and self.account().left == 0, statistics, self.cells, examined)

    def why_none(self) -> NoPair:
        """Why a search that came to its end has no fixture."""
        return NoPair(self.collector.looked_at, self.account().verified)


def searches_of(
    query: Query,
    threads: int,
    cancel: Event | None,
    limit: ErrorLimit | None = None,
    near: NearSpots = EVERYWHERE,
    only: Ranges = (),
) -> list[ToolkitSearch]:
    """The search of each direction of the clamp, for contacts that need not close; with a limit for those
    near some spots, and perhaps at some angles only."""
    precision = ANY_ERROR if limit is None else limit.precision
    return [
        ToolkitSearch.of(problem, threads=threads, cancel=cancel, near=near, precision=precision, only=only)
        for problem in make_problems(query)
    ]


def make_problems(query: Query) -> list[Problem]:
    """The problem of each direction of the clamp, for contacts that need not close."""
    return [Problem.of(select_one_clamp(query, way), pairing=True) for way in query.toolkit.ways]


def list_search_blocks(search: ToolkitSearch) -> list[Block]:
    """The blocks of one direction's search that together find everything."""
    return search.blocks(search.problem.toolkit.types, BLOCKS_PER_HALF_TURN)


def estimate_ways_at_pitch(query: Query, threads: int, pitch: float) -> float:
    """The ways in which two pairs of contacts may go together with another pitch in mm."""
    asked = evolve(query, toolkit=query.toolkit.changed({PITCH.name: (pitch, pitch)}))
    return count_ways(map(list_search_blocks, searches_of(asked, threads, None)))


def ranges_of(whole_turn: Sequence[list[Block]]) -> list[Ranges]:
    """Equal ranges of a whole turn, each with no more work than is to be done at a time."""
    large, many = int(count_ways(whole_turn) / WAYS_TOGETHER), max(map(len, whole_turn))
    count = min(max(many // BLOCKS_TOGETHER, large, 1), MOST_RANGES)
    return [[pair] for pair in pairwise((np.linspace(0.0, tau, count + 1) - SAME_POSE).tolist())]


def order_square_ranges_first(ranges: Sequence[Ranges], square: Ranges) -> list[Ranges]:
    """Ranges of a whole turn with those, in degrees, before them in which the part lies square, and without
    these."""
    begin, end = ranges[0][0][0], ranges[-1][-1][1]
    turned = [
        (radians(low) + turn, radians(high) + turn) for low, high in square for turn in (-tau, 0.0, tau)
    ]
    first = sorted((max(low, begin), min(high, end)) for low, high in turned if low < end and high > begin)
    cuts = [begin, *(cut for pair in first for cut in pair), end]
    rest = [
        [(max(low, cuts[k]), min(high, cuts[k + 1])) for low, high in each for k in range(0, len(cuts), 2)]
        for each in ranges
    ]
    return [first, *([(low, high) for low, high in each if low < high] for each in rest)]


def counting(progress: Progress | None, found: int) -> Progress | None:
    """A progress that reports so many fixtures."""
    return None if progress is None else lambda fraction, _: progress(fraction, found)


def count_ways(blocks: Iterable[Iterable[Block]]) -> float:
    """The ways in which two pairs of contacts may go together in the blocks of some searches."""
    return estimate_cost(chain.from_iterable(blocks))
