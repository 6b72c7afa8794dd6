"""The task of a search: first a search for the best fixtures only, then for all.

A search for all fixtures may take minutes before it can sort any. The user of the page sees the best fixtures
within seconds, and can look at them while the search goes on.
"""

from __future__ import annotations

import pickle
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Event, Thread
from time import perf_counter

import numpy as np
from attrs import evolve, frozen

from workhold.conventions import SAME_POSE
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture_table import FixtureTable
from workhold.model.notes import Many, Note
from workhold.model.query import Query
from workhold.model.result import Result
from workhold.web.answers import describe_arrangements
from workhold.web.worker import TaskContext

__all__ = ["FIRST", "AskedQueries", "SearchOutcome", "NamedQuery", "search"]

# What a toolkit is called, and the query for it.
NamedQuery = tuple[str, Query]

# So many are sought first. The search for them, and the estimate of all, are given up after so many seconds
# each, or after this share of the time that there is: what was found by then is shown, and the search for all
# begins.
FIRST = 20
MOST_SECONDS, MOST_SHARE = 30.0, 0.25
# The part of the progress bar that is theirs.
SHARE = 0.2
# Seconds between reports of progress.
PAUSE = 0.1
TICK = 0.05


@frozen(eq=False)
class AskedQueries:
    """Queries of a job: pickled by the process that makes them, unpickled by the worker that searches.

    Parameters
    ----------
    sealed : the pickled queries.
    count : number of queries.
    toolkit : toolkit of the first query.
    arrangements : arrangements of that toolkit's fixtures, as plain data.
    """

    sealed: bytes
    count: int
    toolkit: Toolkit
    arrangements: list[dict[str, str]]

    @classmethod
    def from_queries(cls, queries: tuple[NamedQuery, ...]) -> AskedQueries:
        """Return the queries pickled, with their number, and toolkit and arrangements of the first one.

        The server needs these without unpickling the queries.
        """
        toolkit = queries[0][1].toolkit
        sealed = pickle.dumps(queries, pickle.HIGHEST_PROTOCOL)
        return cls(sealed, len(queries), toolkit, describe_arrangements(toolkit))

    @property
    def queries(self) -> tuple[NamedQuery, ...]:
        """Names and queries, unpickled at each access."""
        opened: tuple[NamedQuery, ...] = pickle.loads(self.sealed)
        return opened

    @property
    def query(self) -> Query:
        """First query; the only one where the job is a search."""
        return self.queries[0][1]


@frozen(eq=False)
class SearchOutcome:
    """The outcome of a search; ``left_out`` is the number of fixtures that were found and not kept."""

    result: Result
    left_out: int
    notes: tuple[Note, ...] = ()


def search(payload: tuple[AskedQueries, int, bool], order: TaskContext) -> SearchOutcome:
    """Return the outcome of a search.

    The payload is (query, most fixtures to keep, whether every fixture is wanted). Reports are ("progress",
    fraction, found), ("preview", result) and ("first", result); the last has the best fixtures of all, in
    their order. Reported results belong to the query as it was asked. Of very many fixtures only the best are
    searched for, unless every one is wanted.
    """
    from workhold.limits import choose_thread_count
    from workhold.search.design import answer
    from workhold.search.estimate import ask_for_best_where_many

    asked, most, every = payload
    query = whole = asked.query

    def report(kind: str, result: Result) -> None:
        """Report a result so far."""
        order.report((kind, evolve(result, query=whole, complete=False)))

    first = None
    if query.best is None and query.seating is None:
        first = find_best(query, order, report)
        if order.cancel.is_set() or (first.complete and not len(first)):
            return SearchOutcome(evolve(first, query=query, complete=first.complete and not len(first)), 0)
    known = first if first is not None and first.complete else None
    if known is not None:
        report("first", known)
    notes: tuple[Note, ...] = ()
    if first is not None and not every:
        with limit_time(order) as enough:
            query, about = ask_for_best_where_many(query, choose_thread_count(None), enough)
        if query.best is not None:
            notes = (Many(about or 0, query.best),)
    begun = 0.0 if first is None else SHARE
    result = answer(
        query,
        progress=Reporter(order, begun, 1.0 - begun, 0 if known is None else len(known)),
        cancel=order.cancel,
        preview=None if known is not None else lambda result: report("preview", result),
    )
    if known is not None and not result.complete:
        result = put_best_first(result, known)
    left_out = max(len(result) - most, 0)
    if left_out:
        result = result.slice_rows(slice(0, most))
    return SearchOutcome(result, left_out, notes)


class Reporter:
    """Reports progress of one part of a task as progress of the whole, now and then.

    Parameters
    ----------
    begin, share : where this part begins, and its size, both as fractions of the whole.
    least : number of fixtures known before this part.
    """

    def __init__(self, order: TaskContext, begin: float, share: float, least: int = 0) -> None:
        self.order, self.begin, self.share, self.least = order, begin, share, least
        self.last = 0.0

    def __call__(self, fraction: float, found: int) -> None:
        """Report progress of this part as progress of the whole,
        at most every :data:`PAUSE` seconds and at the end.
        """
        now = perf_counter()
        if now >= self.last + PAUSE or fraction >= 1.0:
            self.last = now
            self.order.report(("progress", self.begin + self.share * fraction, max(found, self.least)))


def find_best(query: Query, order: TaskContext, report: Callable[[str, Result], None]) -> Result:
    """Return the best :data:`FIRST` fixtures of a query.

    The result is incomplete where that takes long or the order is cancelled.
    """
    from workhold.search.design import answer

    with limit_time(order) as enough:
        return answer(
            evolve(query, best=FIRST),
            progress=Reporter(order, 0.0, SHARE),
            cancel=enough,
            preview=lambda result: report("preview", result.slice_rows(slice(0, FIRST))),
        )


@contextmanager
def limit_time(order: TaskContext) -> Iterator[Event]:
    """Yield an event that is set when the order is cancelled or when a certain part of its time has passed."""
    enough, done = Event(), Event()
    seconds = min(MOST_SECONDS, MOST_SHARE * order.seconds)

    def watch() -> None:
        """Set the event when its time has come; runs in a thread."""
        end = perf_counter() + seconds
        while not done.wait(TICK) and not order.cancel.is_set() and perf_counter() < end:
            pass
        enough.set()

    watching = Thread(target=watch, daemon=True)
    watching.start()
    try:
        yield enough
    finally:
        done.set()
        watching.join()


def put_best_first(result: Result, best: Result) -> Result:
    """Return the incomplete result of a stopped search with the fixtures of ``best`` put first, each fixture
    once.

    For fixtures that friction holds, ``result`` is returned unchanged.
    """
    if result.holds:
        return result
    marks = {make_fixture_mark(best.table, k) for k in range(len(best))}
    others = np.array([make_fixture_mark(result.table, k) not in marks for k in range(len(result))], bool)
    table = FixtureTable.concatenate([best.table, result.table.take(others)])
    joined = evolve(result, table=table)
    counts = joined.counts
    found = {kind: max(result.found.get(kind, 0), counts.get(kind, 0)) for kind in {**result.found, **counts}}
    distinct = {kind: max(result.distinct.get(kind, 0), best.distinct.get(kind, 0)) for kind in found}
    return evolve(joined, found=found, distinct=distinct)


def make_fixture_mark(table: FixtureTable, index: int) -> tuple[object, ...]:
    """Return a key that identifies a fixture of a table:
    arrangement, holes, faces, and the rounded angle of the part.
    """
    whole = (table.arrangement[index], *table.column[index], *table.row[index], *table.face[index])
    return (*map(int, whole), round(float(table.theta[index]) / SAME_POSE))
