"""Design: every fixture of a workpiece in a toolkit."""

from __future__ import annotations

from collections.abc import Sequence
from threading import Event

import numpy as np
from attrs import evolve
from numpy.typing import NDArray

from workhold.contact.curves import center_numbers
from workhold.contact.problem import Problem, Progress
from workhold.kernels.crossing.two_and_two import CANDIDATES, CONTACTS, CROSSED, PAIRS
from workhold.listing.best import BestFixtures
from workhold.listing.listed import Work, best_result, listed_result
from workhold.model.load import Load
from workhold.model.query import Query, counting_number
from workhold.model.restrictions import Restrictions
from workhold.model.result import Result
from workhold.model.tolerance import Tolerance
from workhold.model.toolkit import Toolkit
from workhold.model.workpiece import Workpiece
from workhold.search.cells import run_blocks, thread_count
from workhold.search.contacts import contacts_of
from workhold.search.preview import Preview, Previews
from workhold.search.toolkit_search import LEAST_BLOCKS, ToolkitSearch

__all__ = ["answer", "design"]

# The part of the work, as progress tells it, that finding records is; the rest is deciding which of them are fixtures.
SEARCH = 0.9


def design(
    workpiece: Workpiece,
    toolkit: Toolkit,
    *,
    types: str | Sequence[str] | None = None,
    contact_margin: float = 0.0,
    restrictions: Restrictions | None = None,
    rank_by: str | Sequence[str] | None = None,
    tolerance: Tolerance | None = None,
    loads: Sequence[Load] = (),
    best: int | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
    cancel: Event | None = None,
    preview: Preview | None = None,
) -> Result:
    """Find every fixture of a workpiece in a toolkit, such as a vise.

    Parameters
    ----------
    workpiece, toolkit, contact_margin, restrictions, tolerance, loads, best : see :class:`workhold.model.query.Query`.
    types : names of arrangements: of a vise "I" (two pegs on each jaw), "II" (three and one), or both; None is all.
    rank_by : the query's ranking.
    threads, progress, cancel, preview : see :func:`answer`.

    Returns
    -------
    Result
        As of :func:`answer`.

    Raises
    ------
    InputError
        As :class:`workhold.model.query.Query` and :func:`answer`.

    Examples
    --------
    >>> import workhold
    >>> widget = workhold.load("widget")
    >>> vise = workhold.Vise(pitch=8, columns=1, peg_radius=3)
    >>> result = workhold.design(widget, vise, rank_by="closure-margin")
    >>> result.counts
    {'I': 459, 'II': 46}
    >>> [peg.hole for peg in result[0].pegs]
    ['L-A1', 'L-A2', 'R-A1', 'R-A2']
    """
    query = Query(workpiece, toolkit, types, contact_margin, restrictions, rank_by, tolerance, loads, best)
    return answer(query, threads=threads, progress=progress, cancel=cancel, preview=preview)


def answer(
    query: Query,
    *,
    threads: int | None = None,
    progress: Progress | None = None,
    cancel: Event | None = None,
    preview: Preview | None = None,
) -> Result:
    """Find every fixture that a query asks for, or the best of them.

    Parameters
    ----------
    threads : how many threads share the work; None for one on each processor. The result does not depend on it.
    progress : called from this thread as ``progress(fraction done, fixtures found so far)``.
    cancel : when set, the search stops soon and the result, marked incomplete, holds what was found.
    preview : called from this thread now and then with some fixtures found so far, as a result marked incomplete; not in the
        first 0.3 s.

    Returns
    -------
    Result
        Fixtures best first (see ``listing.ranking``); those that are equally good in the order of their holes,
        orientation, faces and place.

    Raises
    ------
    InputError
        For faces that do not exist, a peg that fits nowhere along the part, restrictions that leave nothing to touch, and
        a number of threads that is none.

    Examples
    --------
    >>> from workhold import Query, Vise, answer, load
    >>> query = Query(load("widget"), Vise(pitch=8, columns=1, peg_radius=3), arrangements="II", best=3)
    >>> len(answer(query)), answer(query).query == query
    (3, True)
    """
    problem = Problem.of(query)
    workers = thread_count(counting_number("threads", threads))
    search = ToolkitSearch.of(problem)
    # Smaller blocks learn earlier what margin is to be reached.
    blocks = search.blocks(query.arrangements, LEAST_BLOCKS if query.best is None else 2 * LEAST_BLOCKS)
    kept = None if query.best is None else BestFixtures(problem, cancel)
    receive = None if kept is None else kept.add
    look = None if preview is None else Previews(problem, preview).add
    records, done = run_blocks(blocks, workers, stage(progress, 0.0, SEARCH), cancel, receive, look)
    totals = search.totals
    work = Work(
        complete=len(done) == len(blocks),
        statistics=statistics(search, totals),
        cells=sum(block.cells for block in done),
        examined=int(totals[CANDIDATES]),
    )
    if kept is not None:
        result = best_result(kept, work)
    else:
        rest = stage(progress, SEARCH, 1.0)
        result = listed_result(problem, records, work, progress=rest, cancel=cancel, threads=workers)
    if result.complete and not any(result.found.values()) and not result.notes:
        proven = 0 if result.proof is None else result.proof.verified
        return evolve(result, notes=(why_none(search, int(totals[CONTACTS]), proven, workers),))
    return result


def stage(progress: Progress | None, low: float, high: float) -> Progress | None:
    """The progress of one stage of the work, from one fraction of the whole to another."""
    if progress is None:
        return None
    return lambda fraction, found: progress(low + (high - low) * fraction, found)


def why_none(search: ToolkitSearch, contacts: int, proven: int, threads: int) -> str:
    """The reason when a search finds no fixture, in one sentence."""
    problem, table = search.problem, search.table
    arcs = problem.rows[:, 0] != 0.0
    if arcs.all() and len(set(center_numbers(problem.rows).tolist())) == 1:
        return (
            "Every face is an arc about one centre, so the forces of all pegs meet in that point and nothing keeps the part "
            "from turning."
        )
    if len(table) + len(table.sliding_pairs.integers) == 0:
        return "No two pegs of one jaw can touch the part together: the pitch is too large for it."
    # What cannot be a fixture was left out early; whether pegs can touch at all is then asked once more.
    if contacts == 0 and contacts_of(problem, threads) == 0:
        return "No four pegs of the two jaws can touch the part at the same time inside their faces."
    if proven:
        return (
            f"{proven} sets of four pegs would hold the part, but none of them can stand in the jaws as asked: with the "
            "rows, opening, angles, shoulders and blocked holes given."
        )
    return "Four pegs can touch the part at the same time, but no such set keeps the smallest gap, closes and clamps."


def statistics(search: ToolkitSearch, totals: NDArray[np.int64]) -> dict[str, int]:
    """Counts that tell how much work a search was (see ``Result.statistics``)."""
    return {
        "features": len(search.problem.rows),
        "chord_curves": len(search.table),
        "sliding_pairs": len(search.table.sliding_pairs.integers),
        "curve_pairs": int(totals[PAIRS]),
        "crossings_sought": int(totals[CROSSED]),
        "contacts_examined": int(totals[CONTACTS]),
    }
