"""A search in shares, one finished before the next begins, and previews of fixtures while a search runs.

Locators fix the pose in one of two ways. On a lattice of holes they are searched by ranges of orientation
(``search.lattice_shares``), beside a wall by the hull edges that may lie on it (``search.wall_shares``). In
each share the contacts of locators with one clamp are found. With one clamp these are the fixtures; with two
they form seats, whose clamps are then paired (``listing.seats``). A preview shows some of the findings before
the rest is decided.

If only the best are asked for and tilt counts, a bound of all tilted fixtures is known in advance
(``listing.bounds``). Then square orientations are the first share. If the last of the best square fixtures
ranks before the bound, no other orientation is searched.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial
from math import inf
from threading import Event
from time import perf_counter
from typing import Any, Protocol

import numpy as np
from attrs import define, evolve, field
from numpy.typing import NDArray

from workhold.contact.problem import Problem, Progress
from workhold.fixels.toolkit import Toolkit
from workhold.kernels.curves.block_work import CANDIDATES
from workhold.listing.bounds import bound_keys_when_tilted, list_preferred_angles
from workhold.listing.canonical_form import CandidateFixtures, list_each_once
from workhold.listing.collector import BestFixtures, decide_on_this_thread
from workhold.listing.ranking import OrderKeys
from workhold.listing.results import SearchWork, make_result, make_stage_progress, sum_counts
from workhold.model.notes import Note
from workhold.model.query import Query
from workhold.model.result import Result
from workhold.proof.deciding import SearchReport
from workhold.search.cells import SearchBlock, estimate_cost, run_blocks
from workhold.search.error_limits import ErrorLimit
from workhold.search.toolkit_search import LEAST_BLOCKS, ToolkitSearch

__all__ = [
    "Collector",
    "ShareSearch",
    "Preview",
    "Previews",
    "answer_by_shares",
    "search_best_first",
    "has_body_to_pass",
    "search_within_error",
    "make_one_clamp_query",
    "bound_tilted_keys",
    "summarize_work",
]

Preview = Callable[[Result], None]

# Seconds between previews, and the least ratio of the search's time to that of its previews.
PAUSE = 0.3
SHARE = 25.0
# Records decided for one preview, and the number of shown fixtures after which previews end.
MOST_RECORDS = 300
ENOUGH = 1_000


@define(eq=False)
class Previews:
    """Previews of a running search: results of the fixtures known so far.

    Each preview contains the fixtures of earlier ones. Only contacts that are decided quickly are shown. The
    results are marked incomplete, and their counts are those of the listed fixtures.

    Parameters
    ----------
    problem : the problem that is searched.
    show : called with a result from the thread that calls :meth:`add`.
    """

    problem: Problem
    show: Preview
    newest: NDArray[np.float64] | None = field(default=None, init=False)
    shown: CandidateFixtures | None = field(default=None, init=False)
    began: float = field(factory=perf_counter, init=False)
    next_time: float = field(init=False)
    spent: float = field(default=0.0, init=False)
    hurry: Event = field(factory=Event, init=False)

    def __attrs_post_init__(self) -> None:
        self.next_time = self.began + PAUSE
        self.hurry.set()

    def add(self, records: NDArray[np.float64]) -> None:
        """Take new records (N, 19) of contacts, and show the fixtures
        known so far if the next preview is due.

        Only the newest records are decided. Nothing more is shown once :data:`ENOUGH` fixtures are.
        """
        if self.shown is not None and len(self.shown.standing) >= ENOUGH:
            return
        if len(records):
            before = records[:0] if self.newest is None else self.newest
            self.newest = np.concatenate([before, records[-MOST_RECORDS:]])[-MOST_RECORDS:]
        start = perf_counter()
        if self.newest is None or start < self.next_time:
            return
        fresh, account = decide_on_this_thread([self.newest], self.problem, self.hurry)
        self.newest = None
        together = (
            fresh
            if self.shown is None
            else list_each_once(CandidateFixtures.concatenate([self.shown, fresh]))
        )
        if len(fresh.standing):
            self.shown = together
            work = SearchWork(complete=False, statistics={})
            self.show(make_result(self.problem, together, account, work))
        end = perf_counter()
        self.spent += end - start
        self.next_time = max(end + PAUSE, self.began + SHARE * self.spent)


# Number of shares after which a preview is shown.
MOST_PREVIEWS = 8


class Collector(Protocol):
    """A receiver of the findings of shares, which makes a result of them.

    Its length is the number of fixtures so far.
    """

    def __len__(self) -> int: ...

    def add(self, found: Any) -> None:
        """Add one batch of the findings of a share."""

    def make_result(self, account: SearchReport, work: SearchWork) -> Result:
        """Return the result of everything added so far."""


class ShareSearch(Protocol):
    """A search that proceeds share by share."""

    @property
    def share_count(self) -> int:
        """Number of shares."""

    @property
    def collector(self) -> Collector:
        """Receiver of the findings."""

    def search_share(self, share: int, progress: Progress | None) -> tuple[Iterable[Any], bool]:
        """Search share number ``share``; return (its findings, whether it was searched to its end).

        The findings are batches for the collector. Pass each batch to it before asking for the next one.
        """

    def make_account(self) -> SearchReport:
        """Return the report on all contacts decided so far."""

    def describe_work(self, done: int, complete: bool) -> SearchWork:
        """Return the statistics of the search.

        ``done`` is the number of shares searched to their end, ``complete`` whether these are all.
        """

    def explain_no_fixture(self) -> Note:
        """Return the note that says why a search that came to its end has no fixture."""


def answer_by_shares(
    locating: ShareSearch, progress: Progress | None, cancel: Event | None, preview: Preview | None = None
) -> Result:
    """Run a search share by share, and return the result; if it has no fixture, the result has the reason.

    Parameters as in ``search.design.answer``.
    """
    kept, done = locating.collector, 0
    for number in range(locating.share_count):
        if cancel is not None and cancel.is_set():
            break
        end = (number + 1) / locating.share_count
        found, is_whole = locating.search_share(
            number, make_stage_progress(progress, number / locating.share_count, end)
        )
        for part in found:
            kept.add(part)
        done += is_whole
        if progress is not None and is_whole:
            progress(end, len(kept))
        if preview is not None and number < MOST_PREVIEWS:
            preview(kept.make_result(SearchReport(0, 0, 0, 0, ()), SearchWork(False, {})))
    result = kept.make_result(
        locating.make_account(), locating.describe_work(done, done == locating.share_count)
    )
    if not result.complete or any(result.found.values()) or result.reasons:
        return result
    return evolve(result, notes=(locating.explain_no_fixture(),))


def make_one_clamp_query(query: Query, way: Toolkit) -> Query:
    """Return a query in the toolkit ``way``, which has one clamp in one direction.

    Types, ranking, number of best fixtures and listing go back to their defaults.
    """
    return evolve(query, toolkit=way, types=None, rank_by=None, best=None, listing=None)


def has_body_to_pass(query: Query) -> bool:
    """Return whether a query has a program whose tools may come too near the body of a bolted clamp."""
    return query.program is not None and query.toolkit.moving.on is not None


Array = NDArray[np.float64]

# Searches with a larger cost, see ``cells.SearchBlock``, begin with square orientations; it is that of a
# tenth of a second.
SQUARE_FIRST = 1e6
# Searches with a larger cost first use one in SCOUTED chord curves, to learn which error must be reached.
SCOUTED_FROM, SCOUTED = 1.5e7, 8
# Searches with a larger cost are done within limits of the error; with two clamps, where seats are paired
# besides, already from this part of it.
LIMITED_FROM, OF_TWO = 1.5e7, 0.5


def search_best_first(
    search: ToolkitSearch,
    kept: BestFixtures,
    threads: int,
    progress: Progress | None,
    cancel: Event | None,
    look: Callable[[Array], None] | None,
) -> SearchWork:
    """Search for the best fixtures, add every fixture that may be
    among them to ``kept``, and return statistics.

    Preferred angles come first. The other angles are left out where a bound shows that none of their fixtures
    can be among the best.

    Parameters
    ----------
    kept : collects the best, and provides the limits that further fixtures must keep.
    look : called with the records (N, 19) of each block; None for no previews.
    """
    query, problem = search.problem.query, search.problem
    # Smaller blocks learn earlier what margin is to be reached.
    blocks_in = partial(ToolkitSearch.make_blocks, types=query.types, least=4 * LEAST_BLOCKS)
    total = estimate_cost(blocks_in(search))
    bound = bound_tilted_keys(query, problem, total)
    first = () if bound is None else list_preferred_angles(query)
    if total > SCOUTED_FROM and len(search.precision.probes):
        scout, known = evolve(search, every=SCOUTED), BestFixtures(problem, cancel)
        run_blocks(blocks_in(scout, first=first), threads, None, cancel, known.add, stop=scout.stop)
        known.decide()
        if known.needed.error < inf:
            # Enough fixtures are known that none with a larger error is among the best.
            kept.needed, kept.has_dropped = known.needed, True
    parts = [blocks_in(search, first=first, rest=rest) for rest in ((False, True) if first else (False,))]
    begun, done = list[SearchBlock](), list[SearchBlock]()
    for part in parts:
        if begun and bound is not None and kept.rules_out(bound):
            break
        before, begun = estimate_cost(begun) / total if begun else 0.0, begun + part
        share = make_stage_progress(
            progress, before, 1.0 if part is parts[-1] else estimate_cost(begun) / total
        )
        done += run_blocks(part, threads, share, cancel, kept.add, look, search.stop, needed=kept.needed)[1]
    return summarize_work(search, begun, done)


def search_within_error(
    limit: ErrorLimit,
    problem: Problem,
    kept: BestFixtures,
    threads: int,
    progress: Progress | None,
    cancel: Event | None,
    look: Callable[[Array], None] | None,
) -> SearchWork:
    """Search for all fixtures within a limit of the location error,
    add them to ``kept``, and return statistics.

    Some fixtures beyond the limit may be added, too. ``look`` is called with the records (N, 19) of each
    block; None for no previews.
    """
    query, works = problem.query, list[SearchWork]()
    first = list_preferred_angles(query)
    for number, near in enumerate((limit.square, limit.aslant)):
        share = make_stage_progress(progress, number / 2, (number + 1) / 2)
        search = ToolkitSearch.from_problem(
            problem,
            threads=threads,
            cancel=cancel,
            near=near,
            precision=limit.precision,
            only=first if number == 0 else (),
        )
        blocks = search.make_blocks(query.types, 4 * LEAST_BLOCKS, first=first, rest=number > 0)
        done = run_blocks(blocks, threads, share, cancel, kept.add, look, search.stop)[1]
        works.append(summarize_work(search, blocks, done))
    statistics = sum_counts([work.statistics for work in works])
    return SearchWork(
        all(work.complete for work in works),
        {**statistics, "features": len(problem.rows), **limit.statistics},
        sum(work.cells for work in works),
        sum(work.examined or 0 for work in works),
    )


def bound_tilted_keys(query: Query, problem: Problem, cost: float) -> OrderKeys | None:
    """Return lower bounds of the ranking keys of fixtures at all angles but the preferred ones.

    None if preferred angles are not searched first: without ``best``, and if the search's ``cost`` is too
    small for that to pay.
    """
    return bound_keys_when_tilted(query, problem) if query.best is not None and cost > SQUARE_FIRST else None


def summarize_work(
    search: ToolkitSearch, blocks: Sequence[SearchBlock], done: Sequence[SearchBlock]
) -> SearchWork:
    """Return the statistics of a search; it is complete if as many
    blocks are ``done`` as there are ``blocks``.
    """
    return SearchWork(
        complete=len(done) == len(blocks),
        statistics=search.statistics,
        cells=sum(block.cells for block in done),
        examined=int(search.totals[CANDIDATES]),
    )
