"""A search in shares, each looked at whole before the next, and the first fixtures while a search runs.

Locators fix the pose in one of two ways. On a lattice of holes they are sought by ranges of orientation
(``search.lattice_shares``), beside a wall by the hull edges that may lie on it (``search.wall_shares``). In
each share the contacts of locators with one clamp are found. With one clamp they are the fixtures; of two
clamps they make seats, whose clamps are paired (``listing.seats``). A preview shows a part of what was found,
decided ahead of the rest.

Where only the best are asked for and tilt counts, a bound of all tilted fixtures is known beforehand
(``listing.bounds``). So what lies square is one share, and all else the other. If the last of the best square
ones ranks before the bound, no other orientation is searched.
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
from workhold.listing.canonical_form import Candidates, list_each_once
from workhold.listing.collector import BestFixtures, finish
from workhold.listing.ranking import OrderKeys
from workhold.listing.results import Work, make_result, make_stage_progress, sum_counts
from workhold.model.notes import Note
from workhold.model.query import Query
from workhold.model.result import Result
from workhold.proof.deciding import Account
from workhold.search.cells import Block, estimate_cost, run_blocks
from workhold.search.error_limits import ErrorLimit
from workhold.search.toolkit_search import LEAST_BLOCKS, ToolkitSearch

__all__ = [
    "Collector",
    "Locating",
    "Preview",
    "Previews",
    "answer_by_shares",
    "best_first",
    "has_body_to_pass",
    "limited_work",
    "select_one_clamp",
    "bound_tilted_keys",
    "work_of",
]

Preview = Callable[[Result], None]

# Seconds between previews, and how many times longer the search must have run than its previews took.
PAUSE = 0.3
SHARE = 25.0
# Records decided for one preview, and fixtures after which there are no more of them.
MOST_RECORDS = 300
ENOUGH = 1_000


@define(eq=False)
class Previews:
    """Shows fixtures while the search goes on; each preview holds those of the ones before it.

    Only what is decided quickly is shown. The results are marked incomplete, and their counts are of what
    they list.

    Parameters
    ----------
    problem : what is searched.
    show : called with a result from the thread that calls :meth:`add`.
    """

    problem: Problem
    show: Preview
    newest: NDArray[np.float64] | None = field(default=None, init=False)
    shown: Candidates | None = field(default=None, init=False)
    began: float = field(factory=perf_counter, init=False)
    next_time: float = field(init=False)
    spent: float = field(default=0.0, init=False)
    hurry: Event = field(factory=Event, init=False)

    def __attrs_post_init__(self) -> None:
        self.next_time = self.began + PAUSE
        self.hurry.set()

    def add(self, records: NDArray[np.float64]) -> None:
        """Takes records (N, 19) that the search found, and shows some if it is time."""
        if self.shown is not None and len(self.shown.standing) >= ENOUGH:
            return
        if len(records):
            before = records[:0] if self.newest is None else self.newest
            self.newest = np.concatenate([before, records[-MOST_RECORDS:]])[-MOST_RECORDS:]
        start = perf_counter()
        if self.newest is None or start < self.next_time:
            return
        fresh, account = finish([self.newest], self.problem, self.hurry)
        self.newest = None
        together = (
            fresh if self.shown is None else list_each_once(Candidates.concatenate([self.shown, fresh]))
        )
        if len(fresh.standing):
            self.shown = together
            work = Work(complete=False, statistics={})
            self.show(make_result(self.problem, together, account, work))
        end = perf_counter()
        self.spent += end - start
        self.next_time = max(end + PAUSE, self.began + SHARE * self.spent)


# Shares after which what has been found so far is shown.
MOST_PREVIEWS = 8


class Collector(Protocol):
    """What takes the findings of shares and makes a result of them; its length is how many fixtures there are
    so far."""

    def __len__(self) -> int: ...

    def add(self, found: Any) -> None:
        """Takes the findings of a share."""

    def make_result(self, account: Account, work: Work) -> Result:
        """The result of all."""


class Locating(Protocol):
    """How locators fix the part, share by share."""

    @property
    def shares(self) -> int:
        """How many shares there are."""

    @property
    def collector(self) -> Collector:
        """What takes the findings."""

    def look(self, share: int, progress: Progress | None) -> tuple[Iterable[Any], bool]:
        """What is found in a share, in parts as the collector takes them, each taken before the next is made;
        and whether the share was looked at to its end."""

    def account(self) -> Account:
        """What became of all contacts so far."""

    def work(self, done: int, complete: bool) -> Work:
        """How the search went, when so many shares were looked at to their end."""

    def why_none(self) -> Note:
        """Why a search that came to its end has no fixture."""


def answer_by_shares(
    locating: Locating, progress: Progress | None, cancel: Event | None, preview: Preview | None = None
) -> Result:
    """The fixtures that a search finds share by share, see ``search.design.answer``."""
    kept, done = locating.collector, 0
    for number in range(locating.shares):
        if cancel is not None and cancel.is_set():
            break
        end = (number + 1) / locating.shares
        found, is_whole = locating.look(number, make_stage_progress(progress, number / locating.shares, end))
        for part in found:
            kept.add(part)
        done += is_whole
        if progress is not None and is_whole:
            progress(end, len(kept))
        if preview is not None and number < MOST_PREVIEWS:
            preview(kept.make_result(Account(0, 0, 0, 0, ()), Work(False, {})))
    result = kept.make_result(locating.account(), locating.work(done, done == locating.shares))
    if not result.complete or any(result.found.values()) or result.reasons:
        return result
    return evolve(result, notes=(locating.why_none(),))


def select_one_clamp(query: Query, way: Toolkit) -> Query:
    """A query with one clamp of those that are needed together, in one direction."""
    return evolve(query, toolkit=way, types=None, rank_by=None, best=None, listing=None)


def has_body_to_pass(query: Query) -> bool:
    """Whether a clamp has a body, which its stroke gives it, that a program's tools may come too near to."""
    return query.program is not None and query.toolkit.moving.on is not None


Array = NDArray[np.float64]

# Searches that cost more begin with what lies square, see ``cells.Block``: those of a tenth of a second.
SQUARE_FIRST = 1e6
# Searches that cost more look at one chord curve in so many beforehand, to know which error is to be reached.
SCOUTED_FROM, SCOUTED = 1.5e7, 8
# Searches that cost more limit errors; those of two clamps, where seats are paired besides, from this part
# of it.
LIMITED_FROM, OF_TWO = 1.5e7, 0.5


def best_first(
    search: ToolkitSearch,
    kept: BestFixtures,
    threads: int,
    progress: Progress | None,
    cancel: Event | None,
    look: Callable[[Array], None] | None,
) -> Work:
    """Hands what may be among the best to those kept, see ``search.design.answer``."""
    query, problem = search.problem.query, search.problem
    # Smaller blocks learn earlier what margin is to be reached.
    blocks_in = partial(ToolkitSearch.blocks, types=query.types, least=4 * LEAST_BLOCKS)
    total = estimate_cost(blocks_in(search))
    bound = bound_tilted_keys(query, problem, total)
    first = () if bound is None else list_preferred_angles(query)
    if total > SCOUTED_FROM and len(search.precision.probes):
        scout, known = evolve(search, every=SCOUTED), BestFixtures(problem, cancel)
        run_blocks(blocks_in(scout, first=first), threads, None, cancel, known.add, stop=scout.stop)
        known.decide()
        if known.needed.error < inf:
            # So many are known that nothing beyond this error is among the best.
            kept.needed, kept.has_dropped = known.needed, True
    parts = [blocks_in(search, first=first, rest=rest) for rest in ((False, True) if first else (False,))]
    begun, done = list[Block](), list[Block]()
    for part in parts:
        if begun and bound is not None and kept.rules_out(bound):
            break
        before, begun = estimate_cost(begun) / total if begun else 0.0, begun + part
        share = make_stage_progress(
            progress, before, 1.0 if part is parts[-1] else estimate_cost(begun) / total
        )
        done += run_blocks(part, threads, share, cancel, kept.add, look, search.stop, needed=kept.needed)[1]
    return work_of(search, begun, done)


def limited_work(
    limit: ErrorLimit,
    problem: Problem,
    kept: BestFixtures,
    threads: int,
    progress: Progress | None,
    cancel: Event | None,
    look: Callable[[Array], None] | None,
) -> Work:
    """Hands all fixtures up to a limit of the location error to those kept, and perhaps some beyond."""
    query, works = problem.query, list[Work]()
    first = list_preferred_angles(query)
    for number, near in enumerate((limit.square, limit.aslant)):
        share = make_stage_progress(progress, number / 2, (number + 1) / 2)
        search = ToolkitSearch.of(
            problem,
            threads=threads,
            cancel=cancel,
            near=near,
            precision=limit.precision,
            only=first if number == 0 else (),
        )
        blocks = search.blocks(query.types, 4 * LEAST_BLOCKS, first=first, rest=number > 0)
        done = run_blocks(blocks, threads, share, cancel, kept.add, look, search.stop)[1]
        works.append(work_of(search, blocks, done))
    statistics = sum_counts([work.statistics for work in works])
    return Work(
        all(work.complete for work in works),
        {**statistics, "features": len(problem.rows), **limit.statistics},
        sum(work.cells for work in works),
        sum(work.examined or 0 for work in works),
    )


def bound_tilted_keys(query: Query, problem: Problem, cost: float) -> OrderKeys | None:
    """The least keys of fixtures at other than preferred angles, where a search of a cost begins with these.

    None where it does not.
    """
    return bound_keys_when_tilted(query, problem) if query.best is not None and cost > SQUARE_FIRST else None


def work_of(search: ToolkitSearch, blocks: Sequence[Block], done: Sequence[Block]) -> Work:
    """How a search went."""
    return Work(
        complete=len(done) == len(blocks),
        statistics=search.statistics,
        cells=sum(block.cells for block in done),
        examined=int(search.totals[CANDIDATES]),
    )
