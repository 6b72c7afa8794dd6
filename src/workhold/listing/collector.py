"""Fixtures collected while a search goes on: decided, listed once, measured, counted and ranked.

Records come in the order of the search. Those decided are sorted by holes, so that fixtures found twice lie
together; each part of that order is listed and measured on some thread; and the parts are sorted by rank.
Rows of equal rank stay in the order of their identities. With a folder no more than a few parts are in memory
at a time; the outcome does not depend on it.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, wait
from contextlib import contextmanager
from pathlib import Path
from threading import Event

import numpy as np
from attrs import astuple, define, field
from numpy.typing import NDArray

from workhold.contact.problem import Problem, Progress
from workhold.listing.canonical_form import Candidates, listed_once, most_holes, packed_holes
from workhold.listing.finish import Batches, listed_form
from workhold.listing.identity import Identity
from workhold.listing.placing import placed
from workhold.listing.ranking import measured, ranking_keys
from workhold.listing.runs import Runs, SortedRun, in_order, key_of
from workhold.model.result import FixtureTable
from workhold.proof.deciding import Account, Course

__all__ = ["ResultCollector"]

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
    course : how far the deciding has come.
    found, distinct : numbers of fixtures and of sets of each arrangement, once they are measured.
    """

    problem: Problem
    pool: Executor
    ahead: int
    cancel: Event | None = None
    folder: Path | None = None
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

    def __attrs_post_init__(self) -> None:
        self.course = Course(0, cancel=self.cancel)
        self.by_holes, self.by_turn, self.by_rank = (Runs(self.folder) for _ in range(3))
        self.identity = Identity(self.problem.query.toolkit, self.problem.workpiece)
        kinds = len(self.problem.query.toolkit.arrangements)
        self.found, self.distinct = np.zeros(kinds, np.int64), np.zeros(kinds, np.int64)

    @contextmanager
    def given_up_on_errors(self) -> Iterator[None]:
        """Ends soon what is being decided when the block ends by an error or a signal: the pool waits for
        it."""
        try:
            yield
        except BaseException:
            self.course.give_up()
            raise

    def take(self, records: NDArray[np.float64]) -> float:
        """Takes records (N, 19) of the search, in its order; 0, the closure margin that further ones must
        reach."""
        self.course.total += len(records)
        for block in self.batches.add(records):
            self.decide(block)
        return 0.0

    def decide(self, block: NDArray[np.float64]) -> None:
        """Has a block decided."""
        self.deciding.append(self.pool.submit(self.decided, block))
        while len(self.deciding) > self.ahead:
            self.keep(*self.deciding.popleft().result())

    def decided(self, block: NDArray[np.float64]) -> tuple[SortedRun, Account]:
        """The fixtures of a block sorted by their holes, and what became of its records."""
        candidates, account = listed_form(block, self.problem, self.course)
        return self.by_their_holes(candidates), account

    def by_their_holes(self, candidates: Candidates) -> SortedRun:
        """Fixtures sorted by their holes."""
        key = key_of(*packed_holes(candidates, most_holes(self.problem)))
        return SortedRun.of(key, astuple(candidates, recurse=False))

    def keep(self, run: SortedRun, account: Account) -> None:
        """Keeps decided fixtures."""
        self.by_holes.add(run)
        self.accounts.append(account)

    def add(self, candidates: Candidates, account: Account) -> None:
        """Takes fixtures that are decided already."""
        self.keep(self.by_their_holes(candidates), account)

    def finish_deciding(self, progress: Progress | None = None) -> Account:
        """Waits for what is being decided; the account of all records."""
        self.decide(self.batches.rest())
        while self.deciding:
            wait([self.deciding[0]], timeout=NAP)
            if progress is not None:
                progress(self.course.fraction, self.course.kept)
            if self.deciding[0].done():
                self.keep(*self.deciding.popleft().result())
        return Account.together(self.accounts)

    def measure(self, progress: Progress | None = None) -> bool:
        """Lists once, measures and counts; whether nothing was left because somebody asked to stop."""
        parts, done = self.by_holes.parts(), 0
        course = Course(len(parts), cancel=self.cancel)
        for table, turned in in_order(self.pool, self.ahead, self.measured_part, list(enumerate(parts))):
            done += 1
            self.by_rank.add(table)
            self.found += np.bincount(table.columns[0], minlength=len(self.found))
            if turned is not None:
                self.by_turn.add(turned)
            if progress is not None:
                progress(done / len(parts), len(self.by_rank))
            if course.is_late:
                break
        self.by_holes.close()
        if self.identity.is_symmetric:
            for part in in_order(self.pool, self.ahead, taken, self.by_turn.parts()):
                arrangement, pose, *words = part.columns
                self.distinct += self.identity.count(words, pose, arrangement)
            self.by_turn.close()
        else:
            self.distinct += self.found
        return done == len(parts)

    def measured_part(self, numbered: tuple[int, Callable[[], SortedRun]]) -> tuple[SortedRun, SortedRun | None]:
        """The fixtures of a part in the order of their ranks; and of a symmetric workpiece the smallest of
        the forms that its turns give them."""
        number, part = numbered
        candidates = listed_once(Candidates(*part().columns))
        table = measured(placed(candidates, self.problem), self.problem)
        # However many rank alike, each has a key of its own, so that parts stay small.
        identity = np.arange(len(table)) + (number << PLACE_BITS)
        query = self.problem.query
        keys = key_of(*ranking_keys(table.quality, query.ranking, query.tolerance), identity)
        ranked = SortedRun.of(keys, table.columns)
        if not self.identity.is_symmetric:
            return ranked, None
        words, pose = self.identity.smallest(table)
        return ranked, SortedRun.of(key_of(*words), (table.arrangement, pose, *words))

    @property
    def listed(self) -> int:
        """How many of the measured fixtures are listed, unless somebody asks to stop after this."""
        found = int(self.found.sum())
        return min(found, LISTED_LATE) if self.course.is_stopped else found

    def tables(self, progress: Progress | None = None) -> Iterator[FixtureTable]:
        """The fixtures, best first, in tables one after the other; when somebody asks to stop, the first of
        them."""
        parts, listed = self.by_rank.parts(), 0
        for number, part in enumerate(in_order(self.pool, self.ahead, taken, parts), 1):
            rows = min(len(part), max(self.listed - listed, 0))
            listed += rows
            yield FixtureTable(*part.columns).take(slice(rows))
            if rows < len(part):
                break
            if progress is not None:
                progress(number / len(parts), len(self.by_rank))
        self.by_rank.close()


def taken(part: Callable[[], SortedRun]) -> SortedRun:
    """A part of some runs, read and merged."""
    return part()
