"""Collection of fixtures during a search, all or the best: they are decided, listed once, measured and
ranked.

Records of the kernels are decided, brought to canonical form, placed in the toolkit and listed once. If the
query asks for the best, only that number is kept, and these determine the closure margin that further
fixtures must reach.

If it asks for all, the fixtures are sorted by holes, so that repetitions are neighbours. Each part of that
order is listed and measured on one of the threads, and the parts are then sorted by rank. Fixtures of equal
rank stay in the order of their identities. With a folder only a few parts are in memory at a time; the
outcome is the same.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Executor, Future, wait
from contextlib import contextmanager
from math import inf
from pathlib import Path
from threading import Event
from typing import NamedTuple

import numpy as np
from attrs import astuple, define, field
from numpy.typing import NDArray

from workhold.contact.problem import Problem, Progress
from workhold.conventions import MARGIN_SLACK
from workhold.kernels.contact import record
from workhold.listing.asked import are_as_asked
from workhold.listing.canonical_form import (
    CandidateFixtures,
    are_lowest,
    bound_holes,
    list_each_once,
    make_candidates,
    make_canonical,
    pack_holes,
)
from workhold.listing.identity import FixtureIdentity
from workhold.listing.placing import are_placeable, place_candidates
from workhold.listing.ranking import (
    A_STEP,
    OrderKeys,
    find_usual_errors,
    make_order_keys,
    make_table_keys,
    measure_table,
)
from workhold.listing.runs import ExternalSort, SortedRun, make_keys, map_in_order
from workhold.model.fixture_table import FixtureTable
from workhold.model.quality import CLOSURE_MARGIN
from workhold.proof.deciding import DecidingProgress, SearchReport, decide_records
from workhold.statics.effective_error import EffectiveErrors, classify_angles
from workhold.statics.judging import are_unfit

__all__ = [
    "BLOCK",
    "RecordBlocks",
    "BestFixtures",
    "InterestLimits",
    "ResultCollector",
    "split_into_blocks",
    "decide_on_this_thread",
    "decide_and_list",
]

Array = NDArray[np.float64]

# Records decided at a time; few enough that threads end together.
BLOCK = 1 << 14


def decide_on_this_thread(
    records: list[Array], problem: Problem, cancel: Event | None = None
) -> tuple[CandidateFixtures, SearchReport]:
    """Decide records on this thread; return (their fixtures in canonical form, each once, a report on all
    records).

    The report counts all records.

    Parameters
    ----------
    records : (N, 19) arrays from the kernels.
    cancel : when set, records that need slow methods such as ball arithmetic are left undecided.
    """
    course = DecidingProgress(sum(map(len, records)), cancel=cancel)
    parts, accounts = zip(
        *(decide_and_list(block, problem, course) for block in split_into_blocks(records)), strict=True
    )
    return list_each_once(CandidateFixtures.concatenate(parts)), SearchReport.sum_up(list(accounts))


def split_into_blocks(records: Iterable[Array]) -> Iterator[Array]:
    """Yield records (N, 19) regrouped in blocks of about
    :data:`BLOCK` rows; at least one block, perhaps empty.
    """
    batches = RecordBlocks()
    for array in records:
        yield from batches.add(array)
    yield batches.take_rest()


def decide_and_list(
    records: Array, problem: Problem, course: DecidingProgress
) -> tuple[CandidateFixtures, SearchReport]:
    """Decide records (N, 19); return (the fixtures that fit the toolkit and the query, a report on all
    records).

    The fixtures are in canonical form; repetitions are not removed.
    """
    proven, account = decide_records(records, problem, course)
    candidates = make_canonical(make_candidates(proven, problem), problem.frame.swapped_peg_count)
    fits = are_placeable(candidates, problem)
    if not fits.all():
        candidates = candidates.take(fits)
    if problem.query.is_sifted:
        candidates = candidates.take(
            are_as_asked(measure_table(place_candidates(candidates, problem), problem), problem.query)
        )
    return candidates, account


@define(eq=False)
class RecordBlocks:
    """A buffer that regroups arrays of records into blocks of :data:`BLOCK` rows."""

    waiting: list[Array] = field(factory=lambda: [np.zeros((0, record.RECORD_LENGTH))], init=False)

    def add(self, records: Array) -> list[Array]:
        """Add records (N, 19); return the blocks that are ready.

        None are ready until :data:`BLOCK` rows wait; then all rows are returned, the last block perhaps
        shorter.
        """
        self.waiting.append(records)
        if sum(map(len, self.waiting)) < BLOCK:
            return []
        together = np.concatenate(self.waiting)
        self.waiting = [together[:0]]
        return [together[k : k + BLOCK] for k in range(0, len(together), BLOCK)]

    def take_rest(self) -> Array:
        """Return the waiting records, perhaps none, as one array; they stay in the buffer."""
        return np.concatenate(self.waiting)


# Number of waiting records, or of fixtures to keep if that is larger, at which records are decided: early
# where they raise the margin that further ones must reach, else in blocks that cost the least.
WAITING, WAITING_LONG = 64, 1 << 13


class InterestLimits(NamedTuple):
    """Limits that fixtures must keep to be of interest to a search.

    They are a least closure margin, and a largest effective location error in mm.
    """

    margin: float = 0.0
    error: float = inf


@define(eq=False)
class BestFixtures:
    """The best of the fixtures added so far, as many as the query asks
    for, and those that tie with the last of them.

    Parameters
    ----------
    problem : the problem that is searched.
    cancel : when set, records that need slow methods are left undecided.
    is_limited : whether the search has a limit of the location error.
    needed : limits that further fixtures must keep to be among the best; may be set beforehand.
    keys : ranking keys of the kept fixtures; None until more fixtures are known than the query asks for.
    """

    problem: Problem
    cancel: Event | None = None
    is_limited: bool = False
    needed: InterestLimits = field(factory=InterestLimits, init=False)
    keys: OrderKeys | None = field(default=None, init=False)
    has_dropped: bool = field(default=False, init=False)
    waiting: list[NDArray[np.float64]] = field(factory=list, init=False)
    kept: CandidateFixtures | None = field(default=None, init=False)
    accounts: list[SearchReport] = field(factory=list, init=False)
    course: DecidingProgress = field(init=False)
    effective: EffectiveErrors | None = field(init=False)

    def __attrs_post_init__(self) -> None:
        self.course, self.effective = (
            DecidingProgress(0, cancel=self.cancel),
            find_usual_errors(self.problem.query),
        )

    @property
    def wanted_count(self) -> int:
        """Number of fixtures that the query asks for."""
        assert self.problem.query.best is not None
        return self.problem.query.best

    def add(self, records: NDArray[np.float64]) -> InterestLimits:
        """Add records (N, 19) from the search; return the limits that further fixtures must keep."""
        self.waiting.append(records)
        least = WAITING if self.problem.query.by_margin_alone else WAITING_LONG
        if sum(map(len, self.waiting)) >= max(least, self.wanted_count):
            self.decide()
        return self.needed

    def decide(self) -> None:
        """Decide all waiting records, and keep those that may be among the best."""
        waiting, self.waiting = self.waiting, []
        parts = [] if self.kept is None else [self.kept]
        fresh = 0
        for block in split_into_blocks(waiting):
            part, account = decide_and_list(block, self.problem, self.course)
            if self.is_limited or self.needed.error < inf:
                part = part.take(are_lowest(part.feature, part.point, self.problem))
            self.accounts.append(account)
            parts.append(part)
            fresh += len(part.standing)
            # Measured in parts, so that a user who cancels does not wait for all.
            if fresh >= max(BLOCK, self.wanted_count):
                parts, fresh = [self.drop_beaten(list_each_once(CandidateFixtures.concatenate(parts)))], 0
        self.kept = self.drop_beaten(list_each_once(CandidateFixtures.concatenate(parts)))

    def drop_beaten(self, everything: CandidateFixtures) -> CandidateFixtures:
        """Return the candidates that may be among the best, or tie with the last of the best.

        Updates ``keys`` and ``needed``. ``everything`` must not contain repetitions.
        """
        if len(everything.standing) <= self.wanted_count:
            return everything
        table = measure_table(place_candidates(everything, self.problem), self.problem)
        query = self.problem.query
        keys = make_table_keys(table, query, self.effective)
        chosen = keys.are_among_best(self.wanted_count)
        self.has_dropped |= not chosen.all()
        self.keys = keys.take(chosen)
        # An unfit fixture is worse than any fit one, whatever its margin.
        if query.by_margin_alone and not are_unfit(table.quality[chosen], query.tolerance).any():
            margin = float(table.quality[chosen, CLOSURE_MARGIN].min()) - MARGIN_SLACK
            self.needed = InterestLimits(margin=max(margin, 0.0))
        # A fixture that is surely a step behind as many as are asked for is not among the best.
        if (last := self.keys.find_last_fine_error(self.wanted_count)) is not None:
            self.needed = InterestLimits(error=min(A_STEP * last, self.needed.error))
        return everything.take(chosen)

    @property
    def found_keys(self) -> OrderKeys:
        """Ranking keys of all fixtures kept; records that wait are decided first."""
        self.decide()
        assert self.kept is not None
        table = measure_table(place_candidates(self.kept, self.problem), self.problem)
        return make_table_keys(table, self.problem.query, self.effective)

    def rules_out(self, bound: OrderKeys) -> bool:
        """Return whether every fixture whose keys are at least ``bound`` is surely not among the best.

        False until more fixtures are known than the query asks for.
        """
        self.decide()
        return self.keys is not None and bool(
            bound.are_beaten(self.keys, self.wanted_count, bound.lowest_error).all()
        )

    def finish(self) -> tuple[CandidateFixtures, SearchReport]:
        """Return all candidates that may be among the best, and the report on all records."""
        self.decide()
        assert self.kept is not None
        self.has_dropped |= len(self.kept.standing) > self.wanted_count
        return self.kept, SearchReport.sum_up(self.accounts)


# Bits of a fixture's place in its part.
PLACE_BITS = 40
# Seconds between looks at how far the threads have come.
NAP = 0.1
# Largest number of fixtures listed after a cancel, unless more are listed already.
LISTED_LATE = 50_000


@define(eq=False)
class ResultCollector:
    """The fixtures of a whole search: decided, listed once, measured and ranked, in part on disk.

    Parameters
    ----------
    problem : the problem that was searched.
    pool : threads that share the work.
    ahead : largest number of pieces of work in progress at the same time.
    cancel : when set, records that need slow methods are left undecided, remaining fixtures are not measured,
        and at most the best ``LISTED_LATE`` measured ones are listed.
    folder : folder for temporary files; None to keep all in memory.
    is_part : whether this is one of several searches that are joined and ranked later; fixtures then come in
        the order of their identities where the ranking counts steps of error.
    course : progress of deciding.
    found : (A,) number of fixtures of each of A arrangements, once measured.
    distinct : (A,) the same; fixtures that the part's symmetry makes equal count once.
    """

    problem: Problem
    pool: Executor
    ahead: int
    cancel: Event | None = None
    folder: Path | None = None
    is_part: bool = False
    course: DecidingProgress = field(init=False)
    found: NDArray[np.int64] = field(init=False)
    distinct: NDArray[np.int64] = field(init=False)
    accounts: list[SearchReport] = field(factory=list, init=False)
    batches: RecordBlocks = field(factory=RecordBlocks, init=False)
    deciding: deque[Future[tuple[SortedRun, SearchReport]]] = field(factory=deque, init=False)
    by_holes: ExternalSort = field(init=False)
    by_turn: ExternalSort = field(init=False)
    by_rank: ExternalSort = field(init=False)
    identity: FixtureIdentity = field(init=False)
    effective: EffectiveErrors | None = field(init=False)
    fine: OrderKeys | None = field(default=None, init=False)

    def __attrs_post_init__(self) -> None:
        self.course, self.effective = (
            DecidingProgress(0, cancel=self.cancel),
            find_usual_errors(self.problem.query),
        )
        self.by_holes, self.by_turn, self.by_rank = (ExternalSort(self.folder) for _ in range(3))
        self.identity = FixtureIdentity(self.problem.query.toolkit, self.problem.workpiece)
        kinds = len(self.problem.query.toolkit.arrangements)
        self.found, self.distinct = np.zeros(kinds, np.int64), np.zeros(kinds, np.int64)

    @contextmanager
    def give_up_on_errors(self) -> Iterator[None]:
        """Yield a context in which any exception makes deciding end soon; the exception is raised again."""
        try:
            yield
        except BaseException:
            self.course.give_up()
            raise

    def take_records(self, records: NDArray[np.float64]) -> InterestLimits:
        """Add records (N, 19), in the order of the search; return the limits that every fixture must keep."""
        self.course.total += len(records)
        for block in self.batches.add(records):
            self.submit_block(block)
        return InterestLimits()

    def submit_block(self, block: NDArray[np.float64]) -> None:
        """Start deciding a block of records on the pool; wait if more than ``ahead`` blocks are in progress."""
        self.deciding.append(self.pool.submit(self.decide_block, block))
        while len(self.deciding) > self.ahead:
            self.keep_run(*self.deciding.popleft().result())

    def decide_block(self, block: NDArray[np.float64]) -> tuple[SortedRun, SearchReport]:
        """Return (1) the fixtures of a block as a run sorted by holes, and (2) the report on its records."""
        candidates, account = decide_and_list(block, self.problem, self.course)
        return self.sort_by_holes(candidates), account

    def sort_by_holes(self, candidates: CandidateFixtures) -> SortedRun:
        """Return candidates as a run sorted by packed holes."""
        key = make_keys(*pack_holes(candidates, bound_holes(self.problem)))
        return SortedRun.from_columns(key, astuple(candidates, recurse=False))

    def keep_run(self, run: SortedRun, account: SearchReport) -> None:
        """Add a run of fixtures sorted by holes, and the report on their records."""
        self.by_holes.add_run(run)
        self.accounts.append(account)

    def add_candidates(self, candidates: CandidateFixtures, account: SearchReport) -> None:
        """Add already decided candidates, and the report on their records."""
        self.keep_run(self.sort_by_holes(candidates), account)

    def finish_deciding(self, progress: Progress | None = None) -> SearchReport:
        """Decide the remaining records, wait for all blocks in progress, and return the report on all
        records.
        """
        self.submit_block(self.batches.take_rest())
        while self.deciding:
            wait([self.deciding[0]], timeout=NAP)
            if progress is not None:
                progress(self.course.fraction, self.course.kept)
            if self.deciding[0].done():
                self.keep_run(*self.deciding.popleft().result())
        return SearchReport.sum_up(self.accounts)

    def measure(self, progress: Progress | None = None) -> bool:
        """List each fixture once, measure, count and rank them.

        Return whether all fixtures were measured before ``cancel``.
        """
        parts, done = self.by_holes.list_parts(), 0
        course = DecidingProgress(len(parts), cancel=self.cancel)
        for table, turned, least in map_in_order(
            self.pool, self.ahead, self.measure_part, list(enumerate(parts))
        ):
            done += 1
            self.fine = least if self.fine is None else self.fine.concatenate(least).least_keys
            self.by_rank.add_run(table)
            self.found += np.bincount(table.columns[0], minlength=len(self.found))
            if turned is not None:
                self.by_turn.add_run(turned)
            if progress is not None:
                progress(done / len(parts), len(self.by_rank))
            if course.is_late:
                break
        self.by_holes.close()
        self.rank()
        if self.identity.is_symmetric:
            for part in map_in_order(self.pool, self.ahead, take_run, self.by_turn.list_parts()):
                arrangement, pose, *words = part.columns
                self.distinct += self.identity.count_sets(words, pose, arrangement)
            self.by_turn.close()
        else:
            self.distinct += self.found
        return done == len(parts)

    def measure_part(
        self, numbered: tuple[int, Callable[[], SortedRun]]
    ) -> tuple[SortedRun, SortedRun | None, OrderKeys]:
        """Return (a part's fixtures, their smallest images, the keys of the fixture with the least error).

        The fixtures are listed once, measured, and sorted by rank, as far as it is known without other parts.
        The smallest images are those under rotations of the part onto itself; None for a part without
        symmetry. The least error is the effective one; the keys are one row, or no row if steps of error do
        not count.

        Parameters
        ----------
        numbered : number of the part of the sort, and a function that reads it.
        """
        number, part = numbered
        candidates = list_each_once(CandidateFixtures(*part().columns))
        table = measure_table(place_candidates(candidates, self.problem), self.problem)
        # Each fixture has a key of its own, however many rank alike, so that parts stay small.
        identity = np.arange(len(table)) + (number << PLACE_BITS)
        keys, columns = make_table_keys(table, self.problem.query, self.effective), table.columns
        if keys.error is None:
            ranked = SortedRun.from_columns(make_keys(*keys.first.T, identity), columns)
        else:
            # The steps of errors are known only when all are measured.
            ranked = SortedRun(make_keys(identity), (*columns, keys.error))
        if not self.identity.is_symmetric:
            return ranked, None, keys.least_keys
        words, pose = self.identity.find_smallest_images(table)
        turned = SortedRun.from_columns(make_keys(*words), (table.arrangement, pose, *words))
        return ranked, turned, keys.least_keys

    @property
    def least_error(self) -> int | None:
        """Least effective error in billionths of a mm, from which steps of error are counted; None if they do
        not count.
        """
        return None if self.fine is None else self.fine.least_error

    def rank(self) -> None:
        """Sort the measured fixtures by their final keys, in which
        errors count in steps above the least error.
        """
        if self.effective is None:
            return
        measured, self.by_rank = self.by_rank, ExternalSort(self.folder)
        for run in map_in_order(self.pool, self.ahead, self.rank_run, measured.iterate_runs()):
            self.by_rank.add_run(run)
        measured.close()

    def rank_run(self, part: Callable[[], SortedRun]) -> SortedRun:
        """Return a measured run sorted by the final keys, without the column of errors.

        With ``is_part`` the order is not changed.
        """
        run = part()
        *columns, error = run.columns
        if self.is_part and not self.course.is_stopped:
            return SortedRun(run.keys, tuple(columns))
        table = FixtureTable(*columns)
        keys = make_order_keys(table.quality, self.problem.query, error, classify_angles(table.theta))
        identity = run.keys.view(">u8").astype(np.int64)
        return SortedRun.from_columns(
            make_keys(*keys.make_order_numbers(self.least_error).T, identity), table.columns
        )

    @property
    def listed_count(self) -> int:
        """Number of measured fixtures that are listed; at most ``LISTED_LATE`` once cancelled."""
        found = int(self.found.sum())
        return min(found, LISTED_LATE) if self.course.is_stopped else found

    def iterate_tables(self, progress: Progress | None = None) -> Iterator[FixtureTable]:
        """Yield the fixtures in tables, best first, up to
        ``listed_count`` in all; the collector is then empty.
        """
        parts, listed = self.by_rank.list_parts(), 0
        for number, part in enumerate(map_in_order(self.pool, self.ahead, take_run, parts), 1):
            rows = min(len(part), max(self.listed_count - listed, 0))
            listed += rows
            yield FixtureTable(*part.columns).take(slice(rows))
            if rows < len(part):
                break
            if progress is not None:
                progress(number / len(parts), len(self.by_rank))
        self.by_rank.close()


def take_run(part: Callable[[], SortedRun]) -> SortedRun:
    """Return the run that a function reads: ``part()``."""
    return part()
