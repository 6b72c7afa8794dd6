"""Results that a user sees, made of the records of any engine."""

from __future__ import annotations

from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from threading import Event

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from workhold.contact.problem import Problem, Progress
from workhold.listing.best import BestFixtures
from workhold.listing.canonical_form import Candidates
from workhold.listing.collector import ResultCollector
from workhold.model.notes import best_note, undecided_note
from workhold.model.proof import Proof
from workhold.model.result import FixtureTable, Result
from workhold.proof.deciding import Account

__all__ = ["MEASURED", "Work", "best_result", "collected_result", "listed_result", "result_of", "stage"]


# The parts of the work after the search, as progress tells it, when all is decided and when all is measured.
DECIDED, MEASURED = 0.5, 0.8


@frozen
class Work:
    """How the search went.

    Parameters
    ----------
    complete : whether it came to its end.
    statistics : see ``Result.statistics``.
    cells, examined : ranges of orientation and sets of four contacts that were examined for the records
        (None: no more than the records).
    """

    complete: bool
    statistics: Mapping[str, int]
    cells: int = 0
    examined: int | None = None


def stage(progress: Progress | None, low: float, high: float) -> Progress | None:
    """The progress of one stage of the work, from one fraction of the whole to another."""
    if progress is None:
        return None
    return lambda fraction, found: progress(low + (high - low) * fraction, found)


def listed_result(
    problem: Problem,
    records: list[NDArray[np.float64]],
    work: Work,
    *,
    progress: Progress | None = None,
    cancel: Event | None = None,
    threads: int = 1,
) -> Result:
    """Checks, lists once, ranks and counts the fixtures that an engine found.

    Parameters
    ----------
    problem : what was searched.
    records : (N, 19) arrays of fixtures, laid out as ``kernels.contact.record`` says.
    progress : called as ``progress(fraction done, records that still may be fixtures)``.
    cancel : when set, records that cannot be decided quickly are left, and the result is incomplete.
    threads : how many threads share the deciding.
    """
    with ThreadPoolExecutor(max_workers=threads) as pool:
        collector = ResultCollector(problem, pool, 2 * threads, cancel)
        with collector.given_up_on_errors():
            for array in records:
                collector.take(array)
            result = collected_result(collector, work, stage(progress, 0.0, MEASURED))
            result = with_table(result, collector, stage(progress, MEASURED, 1.0))
    return evolve(result, table=result.table.take(slice(0, problem.query.best)))


def collected_result(collector: ResultCollector, work: Work, progress: Progress | None = None) -> Result:
    """The result of what a collector was given, without its fixtures; those it hands over.

    Parameters
    ----------
    progress : called as ``progress(fraction done, records that still may be fixtures)``.
    """
    account = collector.finish_deciding(stage(progress, 0.0, DECIDED))
    whole = collector.measure(stage(progress, DECIDED, 1.0))
    query = collector.problem.query
    names = [one.name for one in query.toolkit.arrangements]
    found, distinct = (
        dict(zip(names, counts.tolist(), strict=True)) for counts in (collector.found, collector.distinct)
    )
    return Result(
        query=query,
        table=FixtureTable.empty(query.toolkit),
        found=found,
        distinct=distinct,
        complete=work.complete and account.left == 0 and whole,
        notes=(undecided_note(len(account.undecided)),) if account.undecided else (),
        statistics=work.statistics,
        proof=proof_of(account, work),
    )


def with_table(result: Result, collector: ResultCollector, progress: Progress | None = None) -> Result:
    """The result of what a collector was given, with its fixtures."""
    tables, listed = list(collector.tables(progress)), collector.listed
    # If somebody asked to stop since, millions are not put together any more.
    enough = 1 + int(np.searchsorted(np.cumsum([len(table) for table in tables]), listed))
    table = FixtureTable.joined(tables[:enough]).take(slice(listed))
    result = evolve(result, table=table)
    return result if len(table) == sum(result.found.values()) else result.cut_short(len(table))


def best_result(kept: BestFixtures, work: Work) -> Result:
    """The result of a search for the best fixtures only.

    How many fixtures there are in all is not known: those that could not be among the best were not examined.
    """
    candidates, account = kept.finished()
    result = result_of(kept.problem, candidates, account, work)
    if not (work.complete and kept.has_dropped):
        return result
    return evolve(result, notes=(best_note(kept.most), *result.notes))


def result_of(problem: Problem, candidates: Candidates, account: Account, work: Work) -> Result:
    """The result of fixtures that are decided."""
    with ThreadPoolExecutor(max_workers=1) as pool:
        collector = ResultCollector(problem, pool, 1)
        collector.add(candidates, account)
        return with_table(collected_result(collector, work), collector)


def proof_of(account: Account, work: Work) -> Proof:
    """The account of a search for the result."""
    # A pair of chords that was given up counts as one candidate.
    examined = work.examined
    candidates = account.records if examined is None else examined + account.given_up - account.left
    kept = account.verified + len(account.undecided)
    # One candidate may hold two solutions, which then count as two.
    candidates = max(candidates, kept)
    return Proof(work.cells, candidates, candidates - kept, account.verified, account.escalated, account.undecided)
