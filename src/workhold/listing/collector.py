"""Fixtures collected while a search goes on, all or the best: decided, listed once, measured and ranked.

Records of the kernels are decided, brought to the listed form, placed in the toolkit and listed once. Of the
best alone as many are kept as the query asks for, and they say which closure margin a further one must reach.

Of all, records come in the order of the search. Those decided are sorted by holes, so that fixtures found
twice lie together. Each part of that order is listed and measured on some thread, and the parts are sorted by
rank. Rows of equal rank stay in the order of their identities. With a folder no more than a few parts are in
memory at a time; the outcome does not depend on it.
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
    Candidates,
    are_lowest,
    bound_holes,
    list_each_once,
    make_candidates,
    make_canonical,
    pack_holes,
)
from workhold.listing.identity import Identity
from workhold.listing.placing import are_placeable, place_candidates
from workhold.listing.ranking import (
    A_STEP,
    OrderKeys,
    find_usual_errors,
    make_order_keys,
    measure_table,
    order_keys,
)
from workhold.listing.runs import Runs, SortedRun, make_keys, map_in_order
from workhold.model.fixture_table import FixtureTable
from workhold.model.quality import CLOSURE_MARGIN
from workhold.proof.deciding import Account, Course, decided
from workhold.statics.effective_error import EffectiveErrors, classify_angles
from workhold.statics.judging import unfit

__all__ = [
    "BLOCK",
    "Batches",
    "BestFixtures",
    "Needed",
    "ResultCollector",
    "split_into_blocks",
    "finish",
    "decide_and_list",
]

Array = NDArray[np.float64]

# Records decided at a time; few enough that threads end together.
BLOCK = 1 << 14


def finish(records: list[Array], problem: Problem, cancel: Event | None = None) -> tuple[Candidates, Account]:
    """Decide records, bring them to the listed form and list them once, on this thread.

    Parameters
    ----------
    records : (N, 19) arrays from the kernels.
    cancel : when set, only what needs no ball arithmetic and the like is decided.

    Returns
    -------
    (the fixtures, an account of all records)
    """
    course = Course(sum(map(len, records)), cancel=cancel)
    parts, accounts = zip(
        *(decide_and_list(block, problem, course) for block in split_into_blocks(records)), strict=True
    )
    return list_each_once(Candidates.concatenate(parts)), Account.together(list(accounts))


def split_into_blocks(records: Iterable[Array]) -> Iterator[Array]:
    """Yield the records (N, 19) in blocks, of which there is at least one."""
    batches = Batches()
    for array in records:
        yield from batches.add(array)
    yield batches.rest()


def decide_and_list(records: Array, problem: Problem, course: Course) -> tuple[Candidates, Account]:
    """Return the records (N, 19) decided: the fixtures among them that fit the toolkit and are as asked, in
    the form they are listed in, and an account of all.
    """
    proven, account = decided(records, problem, course)
    candidates = make_canonical(make_candidates(proven, problem), problem.frame.swapped)
    fits = are_placeable(candidates, problem)
    if not fits.all():
        candidates = candidates.take(fits)
    if problem.query.is_sifted:
        candidates = candidates.take(
            are_as_asked(measure_table(place_candidates(candidates, problem), problem), problem.query)
        )
    return candidates, account


@define(eq=False)
class Batches:
    """Records put together and cut into blocks, for fewer steps of array arithmetic."""

    waiting: list[Array] = field(factory=lambda: [np.zeros((0, record.RECORD_LENGTH))], init=False)

    def add(self, records: Array) -> list[Array]:
        """Take records (N, 19); return the blocks that are full."""
        self.waiting.append(records)
        if sum(map(len, self.waiting)) < BLOCK:
            return []
        together = np.concatenate(self.waiting)
        self.waiting = [together[:0]]
        return [together[k : k + BLOCK] for k in range(0, len(together), BLOCK)]

    def rest(self) -> Array:
        """Return the records that fill no block, which may be none."""
        return np.concatenate(self.waiting)


# Records are decided when so many are waiting, or as many as are to be kept if that is more: soon where they
# give a margin that further ones must reach, else in blocks that cost the least.
WAITING, WAITING_LONG = 64, 1 << 13


class Needed(NamedTuple):
    """What fixtures must reach to be of interest: a closure margin, and an effective location error in mm."""

    margin: float = 0.0
    error: float = inf


@define(eq=False)
class BestFixtures:
    """The best of the fixtures added so far, as many as the query asks for, and those that tie with the last
    of them.

    Parameters
    ----------
    problem : what is searched.
    cancel : when set, only what needs no ball arithmetic and the like is decided, and soon after nothing.
    is_limited : whether what comes was found up to a limit of the location error.
    needed : what further fixtures must reach; may be known beforehand.
    keys : of those kept, once more were decided than are.
    """

    problem: Problem
    cancel: Event | None = None
    is_limited: bool = False
    needed: Needed = field(factory=Needed, init=False)
    keys: OrderKeys | None = field(default=None, init=False)
    has_dropped: bool = field(default=False, init=False)
    waiting: list[NDArray[np.float64]] = field(factory=list, init=False)
    kept: Candidates | None = field(default=None, init=False)
    accounts: list[Account] = field(factory=list, init=False)
    course: Course = field(init=False)
    effective: EffectiveErrors | None = field(init=False)

    def __attrs_post_init__(self) -> None:
        self.course, self.effective = Course(0, cancel=self.cancel), find_usual_errors(self.problem.query)

    @property
    def most(self) -> int:
        assert self.problem.query.best is not None
        return self.problem.query.best

    def add(self, records: NDArray[np.float64]) -> Needed:
        """Take records (N, 19) from the search; what further ones must reach."""
        self.waiting.append(records)
        least = WAITING if self.problem.query.by_margin_alone else WAITING_LONG
        if sum(map(len, self.waiting)) >= max(least, self.most):
            self.decide()
        return self.needed

    def decide(self) -> None:
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
            # Measured a share at a time, so that one who asks to stop does not wait for all.
            if fresh >= max(BLOCK, self.most):
                parts, fresh = [self.cut(list_each_once(Candidates.concatenate(parts)))], 0
        self.kept = self.cut(list_each_once(Candidates.concatenate(parts)))

    def cut(self, everything: Candidates) -> Candidates:
        """Return the fixtures of those listed once that may be among the best, or tie with the last of these."""
        if len(everything.standing) <= self.most:
            return everything
        table = measure_table(place_candidates(everything, self.problem), self.problem)
        query = self.problem.query
        keys = order_keys(table, query, self.effective)
        chosen = keys.are_among_best(self.most)
        self.has_dropped |= not chosen.all()
        self.keys = keys.take(chosen)
        # One that is none for a workshop is worse than any that is, whatever its margin.
        if query.by_margin_alone and not unfit(table.quality[chosen], query.tolerance).any():
            margin = float(table.quality[chosen, CLOSURE_MARGIN].min()) - MARGIN_SLACK
            self.needed = Needed(margin=max(margin, 0.0))
        # What is surely a step behind so many is not among the best.
        if (last := self.keys.find_last_fine_error(self.most)) is not None:
            self.needed = Needed(error=min(A_STEP * last, self.needed.error))
        return everything.take(chosen)

    @property
    def found_keys(self) -> OrderKeys:
        self.decide()
        assert self.kept is not None
        table = measure_table(place_candidates(self.kept, self.problem), self.problem)
        return order_keys(table, self.problem.query, self.effective)

    def rules_out(self, bound: OrderKeys) -> bool:
        """Return whether a fixture with keys no less than a bound cannot be among the best; True only once
        some were dropped.
        """
        self.decide()
        return self.keys is not None and bool(bound.are_beaten(self.keys, self.most, bound.lowest).all())

    def finish(self) -> tuple[Candidates, Account]:
        """Return all that may be among the best, and the account of all records, once the search is over."""
        self.decide()
        assert self.kept is not None
        self.has_dropped |= len(self.kept.standing) > self.most
        return self.kept, Account.together(self.accounts)


# Bits of a fixture's place in its part.
PLACE_BITS = 40
# Seconds between looks at how far the threads have come.
NAP = 0.1
# After somebody asked to stop: fixtures that are listed, unless more are already.
LISTED_LATE = 50_000


@define(eq=False)
class ResultCollector:
    """The fixtures of a search.

    Parameters
    ----------
    problem : what was searched.
    pool : of threads that share the work.
    ahead : how many pieces of work may be under way.
    cancel : when set, records that cannot be decided quickly are left, fixtures that are not measured soon
        are, and of those measured no more than the best ``LISTED_LATE`` are listed.
    folder : of what does not stay in memory; None for memory alone.
    is_part : whether this is a part of a search, from which steps do not count: then fixtures come in the
        order of their identities.
    course : how far the deciding has come.
    found, distinct : numbers of fixtures and of sets of each arrangement, once they are measured.
    """

    problem: Problem
    pool: Executor
    ahead: int
    cancel: Event | None = None
    folder: Path | None = None
    is_part: bool = False
    course: Course = field(init=False)
    found: NDArray[np.int64] = field(init=False)
    distinct: NDArray[np.int64] = field(init=False)
    accounts: list[Account] = field(factory=list, init=False)
    batches: Batches = field(factory=Batches, init=False)
    deciding: deque[Future[tuple[SortedRun, Account]]] = field(factory=deque, init=False)
    by_holes: Runs = field(init=False)
    by_turn: Runs = field(init=False)
    by_rank: Runs = field(init=False)
    identity: Identity = field(init=False)
    effective: EffectiveErrors | None = field(init=False)
    fine: OrderKeys | None = field(default=None, init=False)

    def __attrs_post_init__(self) -> None:
        self.course, self.effective = Course(0, cancel=self.cancel), find_usual_errors(self.problem.query)
        self.by_holes, self.by_turn, self.by_rank = (Runs(self.folder) for _ in range(3))
        self.identity = Identity(self.problem.query.toolkit, self.problem.workpiece)
        kinds = len(self.problem.query.toolkit.arrangements)
        self.found, self.distinct = np.zeros(kinds, np.int64), np.zeros(kinds, np.int64)

    @contextmanager
    def give_up_on_errors(self) -> Iterator[None]:
        """End soon what is being decided when the block ends by an error or a signal: the pool waits for
        it."""
        try:
            yield
        except BaseException:
            self.course.give_up()
            raise

    def take(self, records: NDArray[np.float64]) -> Needed:
        """Take records (N, 19) of the search, in its order; what further ones must reach, which is
        nothing."""
        self.course.total += len(records)
        for block in self.batches.add(records):
            self.decide(block)
        return Needed()

    def decide(self, block: NDArray[np.float64]) -> None:
        self.deciding.append(self.pool.submit(self.decide_block, block))
        while len(self.deciding) > self.ahead:
            self.keep(*self.deciding.popleft().result())

    def decide_block(self, block: NDArray[np.float64]) -> tuple[SortedRun, Account]:
        """Return the fixtures of a block sorted by their holes, and what became of its records."""
        candidates, account = decide_and_list(block, self.problem, self.course)
        return self.sort_by_holes(candidates), account

    def sort_by_holes(self, candidates: Candidates) -> SortedRun:
        key = make_keys(*pack_holes(candidates, bound_holes(self.problem)))
        return SortedRun.from_columns(key, astuple(candidates, recurse=False))

    def keep(self, run: SortedRun, account: Account) -> None:
        self.by_holes.add(run)
        self.accounts.append(account)

    def add(self, candidates: Candidates, account: Account) -> None:
        """Take fixtures that are decided already."""
        self.keep(self.sort_by_holes(candidates), account)

    def finish_deciding(self, progress: Progress | None = None) -> Account:
        """Wait for what is being decided; the account of all records."""
        self.decide(self.batches.rest())
        while self.deciding:
            wait([self.deciding[0]], timeout=NAP)
            if progress is not None:
                progress(self.course.fraction, self.course.kept)
            if self.deciding[0].done():
                self.keep(*self.deciding.popleft().result())
        return Account.together(self.accounts)

    def measure(self, progress: Progress | None = None) -> bool:
        """List once, measure and count; return whether nothing was left because the user asked to stop."""
        parts, done = self.by_holes.list_parts(), 0
        course = Course(len(parts), cancel=self.cancel)
        for table, turned, least in map_in_order(
            self.pool, self.ahead, self.measure_part, list(enumerate(parts))
        ):
            done += 1
            self.fine = least if self.fine is None else self.fine.concatenate(least).least_of_all
            self.by_rank.add(table)
            self.found += np.bincount(table.columns[0], minlength=len(self.found))
            if turned is not None:
                self.by_turn.add(turned)
            if progress is not None:
                progress(done / len(parts), len(self.by_rank))
            if course.is_late:
                break
        self.by_holes.close()
        self.rank()
        if self.identity.is_symmetric:
            for part in map_in_order(self.pool, self.ahead, take_run, self.by_turn.list_parts()):
                arrangement, pose, *words = part.columns
                self.distinct += self.identity.count(words, pose, arrangement)
            self.by_turn.close()
        else:
            self.distinct += self.found
        return done == len(parts)

    def measure_part(
        self, numbered: tuple[int, Callable[[], SortedRun]]
    ) -> tuple[SortedRun, SortedRun | None, OrderKeys]:
        """Return the fixtures of a part in the order of their ranks, as far as these depend on no other part.

        Beside them, of a symmetric workpiece the smallest of the forms that its turns give them, and the keys
        of the one with the least effective error.
        """
        number, part = numbered
        candidates = list_each_once(Candidates(*part().columns))
        table = measure_table(place_candidates(candidates, self.problem), self.problem)
        # However many rank alike, each has a key of its own, so that parts stay small.
        identity = np.arange(len(table)) + (number << PLACE_BITS)
        keys, columns = order_keys(table, self.problem.query, self.effective), table.columns
        if keys.error is None:
            ranked = SortedRun.from_columns(make_keys(*keys.first.T, identity), columns)
        else:
            # Steps are known when all are measured.
            ranked = SortedRun(make_keys(identity), (*columns, keys.error))
        if not self.identity.is_symmetric:
            return ranked, None, keys.least_of_all
        words, pose = self.identity.find_smallest_images(table)
        turned = SortedRun.from_columns(make_keys(*words), (table.arrangement, pose, *words))
        return ranked, turned, keys.least_of_all

    @property
    def least(self) -> int | None:
        """The least effective error of all in billionths of a mm; None where none counts."""
        return None if self.fine is None else self.fine.least

    def rank(self) -> None:
        """Order what is measured by the steps above the least error of all."""
        if self.effective is None:
            return
        measured, self.by_rank = self.by_rank, Runs(self.folder)
        for run in map_in_order(self.pool, self.ahead, self.rank_run, measured.iterate_runs()):
            self.by_rank.add(run)
        measured.close()

    def rank_run(self, part: Callable[[], SortedRun]) -> SortedRun:
        run = part()
        *columns, error = run.columns
        if self.is_part and not self.course.is_stopped:
            return SortedRun(run.keys, tuple(columns))
        table = FixtureTable(*columns)
        keys = make_order_keys(table.quality, self.problem.query, error, classify_angles(table.theta))
        identity = run.keys.view(">u8").astype(np.int64)
        return SortedRun.from_columns(
            make_keys(*keys.make_order_numbers(self.least).T, identity), table.columns
        )

    @property
    def listed(self) -> int:
        """How many of the measured fixtures are listed, unless somebody asks to stop after this."""
        found = int(self.found.sum())
        return min(found, LISTED_LATE) if self.course.is_stopped else found

    def iterate_tables(self, progress: Progress | None = None) -> Iterator[FixtureTable]:
        """Yield the fixtures, best first, in tables; when the user asks to stop, the first fixtures alone."""
        parts, listed = self.by_rank.list_parts(), 0
        for number, part in enumerate(map_in_order(self.pool, self.ahead, take_run, parts), 1):
            rows = min(len(part), max(self.listed - listed, 0))
            listed += rows
            yield FixtureTable(*part.columns).take(slice(rows))
            if rows < len(part):
                break
            if progress is not None:
                progress(number / len(parts), len(self.by_rank))
        self.by_rank.close()


def take_run(part: Callable[[], SortedRun]) -> SortedRun:
    return part()
