"""The search for two clamps on a lattice, in shares: the seats of one range of orientations after the other.

Three locators alone fix the pose, and both clamps then follow in closed form. So for each direction of a
clamp the search proves contacts of three locators and one clamp, whether or not they close. Pairs of clamps
are then formed from these. With ranges of orientation, only the seats of one range are in memory.
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
from workhold.limits import refuse_long_search
from workhold.listing.bounds import bound_keys_when_tilted, list_preferred_angles
from workhold.listing.canonical_form import CandidateFixtures, list_each_once, make_candidates, make_canonical
from workhold.listing.clamp_contacts import make_contacts_of_candidates
from workhold.listing.collector import split_into_blocks
from workhold.listing.contact_groups import PackedContacts
from workhold.listing.placing import are_at_angle
from workhold.listing.ranking import MOST_ERROR, OrderKeys
from workhold.listing.results import SearchWork, make_stage_progress, sum_counts
from workhold.listing.seat_order import make_ordered_groups
from workhold.listing.seats import ClampedSeats, Seats, make_seats
from workhold.model.notes import NoPair
from workhold.model.query import Query
from workhold.proof.deciding import DecidingProgress, SearchReport, decide_records
from workhold.search.cells import SearchBlock, estimate_cost, run_blocks
from workhold.search.error_limits import ErrorLimit
from workhold.search.shares import bound_tilted_keys, make_one_clamp_query
from workhold.search.toolkit_search import ANY_ERROR, LEAST_BLOCKS, ToolkitSearch

__all__ = ["LatticeShares", "list_search_blocks", "make_problems", "make_searches", "count_ways"]

Array = NDArray[np.float64]
# Ranges of orientation in radians, from and up to but without the second.
Ranges = Sequence[tuple[float, float]]

# Blocks of one direction's search in a range, and the largest number of ranges.
BLOCKS_TOGETHER, MOST_RANGES = 48, 256
# Work in one range, see ``limits.MOST_WAYS``: its contacts take some gigabytes.
WAYS_TOGETHER = 1e7
# Blocks per half turn: enough for the threads to share the few cells of a range.
BLOCKS_PER_HALF_TURN = 2 * LEAST_BLOCKS
# Up to this many contacts all seats are found and counted, even where only the best are asked for.
COUNTED_WHOLE = 1 << 14
# Radians beside a range that are searched as well, so that a seat on its edge is found whole from either
# side.
OVERLAP = 10 * SAME_POSE


@define(eq=False)
class LatticeShares:
    """The search for two clamps by ranges of orientation, a ``search.shares.ShareSearch``.

    Parameters
    ----------
    searches : one for each direction of a clamp, for contacts that need not close.
    collector : takes the seats.
    whole_turn : for each search, the blocks that cover all orientations.
    ranges : for each share its ranges (low, high) of orientation in radians. Where there is a ``bound``, the
        first share has the preferred angles.
    bound : lower bounds of the ranking keys at all angles but the preferred ones; None where the preferred
        angles are not searched first.
    pool : executor with ``threads`` threads.
    cancel : when set, the search stops soon.
    square : searches of the first share, where the preferred angles have an error limit of their own; else
        empty.
    """

    searches: Sequence[ToolkitSearch]
    collector: ClampedSeats
    whole_turn: Sequence[list[SearchBlock]]
    ranges: Sequence[Ranges]
    bound: OrderKeys | None
    pool: Executor
    threads: int
    cancel: Event | None
    square: Sequence[ToolkitSearch] = ()
    accounts: list[SearchReport] = field(factory=list, init=False)
    cells: int = field(default=0, init=False)

    @classmethod
    @contextmanager
    def open_for_query(
        cls, query: Query, threads: int, cancel: Event | None, limit: ErrorLimit | None = None
    ) -> Iterator[LatticeShares]:
        """Yield the shares of a query with two clamps; the context owns the threads.

        With a limit, only seats whose location error is within it are searched, those at preferred angles
        first. Without a limit, raises InputError for too much work.
        """
        if limit is not None:
            first = list_preferred_angles(query)
            square = make_searches(query, threads, cancel, limit, limit.square, first)
            aslant = make_searches(query, threads, cancel, limit, limit.aslant)
            blocks = [list_search_blocks(search) for search in aslant]
            ranges = order_square_ranges_first(split_whole_turn(blocks), first)
            seats = ClampedSeats(query, square[0].problem, is_limited=True)
            bound = bound_keys_when_tilted(query, square[0].problem)
            seats.ranked.has_dropped = True
            with ThreadPoolExecutor(max_workers=threads) as pool:
                yield cls(aslant, seats, blocks, ranges, bound, pool, threads, cancel, square)
            return
        searches = make_searches(query, threads, cancel)
        blocks = [list_search_blocks(search) for search in searches]
        x0, y0, x1, y1 = query.workpiece.bounds
        refuse_long_search(
            count_ways(blocks),
            (x1 - x0, y1 - y0),
            query.toolkit.carriers[0].pitch,
            partial(estimate_ways_at_pitch, query, threads),
        )
        problem = searches[0].problem
        bound, ranges = bound_tilted_keys(query, problem, count_ways(blocks)), split_whole_turn(blocks)
        if bound is not None:
            ranges = order_square_ranges_first(ranges, list_preferred_angles(query))
        seats = ClampedSeats(query, problem)
        with ThreadPoolExecutor(max_workers=threads) as pool:
            yield cls(searches, seats, blocks, ranges, bound, pool, threads, cancel)

    @classmethod
    @contextmanager
    def open_for_contacts(
        cls, searches: Sequence[ToolkitSearch], collector: ClampedSeats, threads: int, cancel: Event | None
    ) -> Iterator[LatticeShares]:
        """Yield an object without shares of its own, which forms seats from contacts that the caller found.

        The context owns the threads.
        """
        with ThreadPoolExecutor(max_workers=threads) as pool:
            yield cls(searches, collector, (), (), None, pool, threads, cancel)

    @property
    def share_count(self) -> int:
        """Number of shares."""
        return len(self.ranges)

    def search_share(self, share: int, progress: Progress | None) -> tuple[Iterator[Seats], bool]:
        """Search one share; return (an iterator over its seats, whether it was searched to its end).

        The seats come in one batch, or in several where only the best are asked for. There are none if a
        bound shows that no fixture of the share is among the best; such a share counts as searched.
        """
        if share > 0 and self.bound is not None and self.collector.ranked.rules_out(self.bound):
            return iter(()), True
        found, is_whole = list[PackedContacts](), True
        for place, search in enumerate(self.square if self.square and share == 0 else self.searches):
            part = make_stage_progress(progress, place / len(self.searches), (place + 1) / len(self.searches))
            blocks = self.make_blocks(share, search, self.whole_turn[place])
            records, done = run_blocks(
                blocks,
                self.threads,
                make_counting_progress(part, len(self.collector)),
                self.cancel,
                stop=search.stop,
                pool=self.pool,
            )
            self.cells += sum(block.cells for block in done)
            is_whole = is_whole and len(done) == len(blocks)
            found.append(PackedContacts.from_blocks(records))
        return self.iterate_seats(found, share), is_whole

    def make_blocks(
        self, share: int, search: ToolkitSearch, whole_turn: list[SearchBlock]
    ) -> list[SearchBlock]:
        """Return the blocks of one search that cover a share.

        ``whole_turn`` are the blocks of the same search that cover all orientations.
        """
        if self.share_count == 1:
            return whole_turn
        if self.square:
            first = list_preferred_angles(self.collector.query)
            if share == 0:
                return search.make_blocks(search.problem.toolkit.types, BLOCKS_PER_HALF_TURN, first=first)
        blocks_in = partial(search.make_blocks, search.problem.toolkit.types, BLOCKS_PER_HALF_TURN)
        if share == 0 and self.bound is not None:
            return blocks_in(first=list_preferred_angles(self.collector.query))
        within = [(degrees(low - OVERLAP), degrees(high + OVERLAP)) for low, high in self.ranges[share]]
        return blocks_in(within=within)

    def iterate_seats(self, records: Sequence[PackedContacts], share: int) -> Iterator[Seats]:
        """Yield, in batches, the seats formed by the contacts of a share.

        ``records`` has the contacts of each direction of the clamp. Where only the best are asked for,
        promising seats come first, and contacts that cannot be among the best are left out.
        """
        query, total, within = self.collector.query, sum(map(len, records)), self.ranges[share]
        if query.best is None or (self.share_count == 1 and total <= COUNTED_WHOLE):
            yield self.find_seats([part.take(slice(None)) for part in records], within)
            return
        groups = make_ordered_groups(records, [search.problem for search in self.searches], query)
        edges = np.cumsum([0, *map(len, records)])
        for chosen in groups.iterate_batches(self.collector.ranked, self.bound_later_errors(share)):
            places = np.searchsorted(chosen, edges).tolist()
            some = [
                part.take(chosen[first:end] - start)
                for part, start, (first, end) in zip(records, edges, pairwise(places), strict=False)
            ]
            yield self.find_seats(some, within)

    def bound_later_errors(self, share: int) -> int:
        """Return a lower bound, in billionths of a mm, of the location
        errors in all shares after ``share``.
        """
        if share == self.share_count - 1:
            return MOST_ERROR
        return 0 if self.bound is None or self.bound.error is None else int(self.bound.error.min())

    def find_seats(self, records: Sequence[Array], within: Ranges) -> Seats:
        """Return all seats formed by given contacts, with orientations in the ranges ``within`` in radians.

        ``records`` has an array (N, 19) of contacts for each direction of the clamp.
        """
        problems = [search.problem for search in self.searches]
        parts = [
            make_contacts_of_candidates(self.prove_contacts(some, problem), problem)
            for some, problem in zip(records, problems, strict=True)
        ]
        return make_seats(parts, problems[0], within, self.collector.is_limited)

    def prove_contacts(self, records: Array, problem: Problem) -> CandidateFixtures:
        """Return the contacts of three locators and a clamp that are proven and at allowed angles, each once.

        They are selected from ``records`` (N, 19). The report on all records is appended to ``accounts``.
        """
        course, blocks = (
            DecidingProgress(len(records), cancel=self.cancel),
            list(split_into_blocks([records])),
        )

        def prove_block(block: Array) -> tuple[CandidateFixtures, SearchReport]:
            """Return the proven contacts of one block of records, and the report on the block."""
            proven, account = decide_records(block, problem, course)
            candidates = make_canonical(make_candidates(proven, problem), 0)
            return candidates.take(
                are_at_angle(candidates.theta, problem.restrictions.angles, problem.frame)
            ), account

        parts, accounts = zip(*self.pool.map(prove_block, blocks), strict=True)
        self.accounts += accounts
        return list_each_once(CandidateFixtures.concatenate(parts))

    def make_account(self) -> SearchReport:
        """Return the report on all contacts decided so far."""
        return SearchReport.sum_up(self.accounts)

    def describe_work(self, done: int, complete: bool) -> SearchWork:
        """Return the statistics of the search.

        The search counts as complete if ``complete`` is True and no contact is undecided. ``done`` is not
        used.
        """
        searches = [*self.square, *self.searches]
        examined = int(sum(search.totals[CANDIDATES] for search in searches))
        statistics = sum_counts(search.statistics for search in searches)
        return SearchWork(complete and self.make_account().left == 0, statistics, self.cells, examined)

    def explain_no_fixture(self) -> NoPair:
        """Return the note that says why a search that came to its end has no fixture."""
        return NoPair(self.collector.looked_at, self.make_account().verified)


def make_searches(
    query: Query,
    threads: int,
    cancel: Event | None,
    limit: ErrorLimit | None = None,
    near: NearSpots = EVERYWHERE,
    only: Ranges = (),
) -> list[ToolkitSearch]:
    """Return one search for each direction of the clamp, for contacts of three locators and one clamp.

    The contacts need not close. With a limit only contacts within its error are searched, and only those
    whose locators touch spots that ``near`` allows. ``only`` are ranges of the part's angle in degrees; empty
    for all angles.
    """
    precision = ANY_ERROR if limit is None else limit.precision
    return [
        ToolkitSearch.from_problem(
            problem, threads=threads, cancel=cancel, near=near, precision=precision, only=only
        )
        for problem in make_problems(query)
    ]


def make_problems(query: Query) -> list[Problem]:
    """Return one problem for each direction of the clamp, each with
    one clamp, for contacts that need not close.
    """
    return [Problem.from_query(make_one_clamp_query(query, way), pairing=True) for way in query.toolkit.ways]


def list_search_blocks(search: ToolkitSearch) -> list[SearchBlock]:
    """Return the blocks that together cover all orientations of one search."""
    return search.make_blocks(search.problem.toolkit.types, BLOCKS_PER_HALF_TURN)


def estimate_ways_at_pitch(query: Query, threads: int, pitch: float) -> float:
    """Return the estimated work of a query's search in a toolkit with another pitch, given in mm.

    The work is counted as by :func:`count_ways`.
    """
    asked = evolve(query, toolkit=query.toolkit.with_fields({PITCH.name: (pitch, pitch)}))
    return count_ways(map(list_search_blocks, make_searches(asked, threads, None)))


def split_whole_turn(whole_turn: Sequence[list[SearchBlock]]) -> list[Ranges]:
    """Return equal ranges of orientation in radians that together cover a whole turn, one list per share.

    The number of shares is chosen so that the work in each is bounded. ``whole_turn`` has the blocks of each
    search.
    """
    large, many = int(count_ways(whole_turn) / WAYS_TOGETHER), max(map(len, whole_turn))
    count = min(max(many // BLOCKS_TOGETHER, large, 1), MOST_RANGES)
    return [[pair] for pair in pairwise((np.linspace(0.0, tau, count + 1) - SAME_POSE).tolist())]


def order_square_ranges_first(ranges: Sequence[Ranges], square: Ranges) -> list[Ranges]:
    """Return ranges with a new first entry, the preferred angles, which are cut out of all other entries.

    ``ranges`` are in radians and cover a whole turn. ``square`` are the preferred angles, as ranges in
    degrees.
    """
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


def make_counting_progress(progress: Progress | None, found: int) -> Progress | None:
    """Return a progress callback that passes the fraction on and always reports ``found`` fixtures.

    None where ``progress`` is None.
    """
    return None if progress is None else lambda fraction, _: progress(fraction, found)


def count_ways(blocks: Iterable[Iterable[SearchBlock]]) -> float:
    """Return the summed cost of all blocks: about the number of pairs of chord curves that may be combined."""
    return estimate_cost(chain.from_iterable(blocks))
