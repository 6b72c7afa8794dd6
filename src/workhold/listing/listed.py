"""From the records of any engine to the result a user sees."""

from __future__ import annotations

from collections.abc import Mapping
from threading import Event

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from workhold.contact.problem import Problem, Progress
from workhold.listing.best import BestFixtures
from workhold.listing.canonical_form import Candidates
from workhold.listing.distinct import count_distinct
from workhold.listing.finish import finish
from workhold.listing.placing import placed
from workhold.listing.ranking import measured, rank
from workhold.model.proof import Proof
from workhold.model.result import Result
from workhold.proof.deciding import Account

__all__ = ["Work", "best_result", "listed_result", "result_of"]


@frozen
class Work:
    """How the search went.

    Parameters
    ----------
    complete : whether it came to its end.
    statistics : see ``Result.statistics``.
    cells, examined : ranges of orientation and sets of four contacts that were examined for the records (None: no more
        than the records).
    """

    complete: bool
    statistics: Mapping[str, int]
    cells: int = 0
    examined: int | None = None


def listed_result(
    problem: Problem,
    records: list[NDArray[np.float64]],
    work: Work,
    *,
    progress: Progress | None = None,
    cancel: Event | None = None,
    threads: int = 1,
) -> Result:
    """Check, list once, rank and count the fixtures that an engine found.

    Parameters
    ----------
    problem : what was searched.
    records : (N, 19) arrays of fixtures, laid out as ``kernels.contact.record`` says.
    progress : called as ``progress(fraction done, records that still may be fixtures)``.
    cancel : when set, records that cannot be decided quickly are left, and the result is incomplete.
    threads : how many threads share the deciding.
    """
    candidates, account = finish(records, problem, progress, cancel, threads)
    result = result_of(problem, candidates, account, work, threads)
    return evolve(result, table=result.table.take(slice(0, problem.query.best)))


def best_result(kept: BestFixtures, work: Work) -> Result:
    """The result of a search for the best fixtures only.

    How many fixtures there are in all is not known: those that could not be among the best were not examined.
    """
    candidates, account = kept.finished()
    result = result_of(kept.problem, candidates, account, work)
    if not (work.complete and kept.has_dropped):
        return result
    note = f"Only the best {kept.most} were sought, so how many fixtures there are in all was not counted."
    return evolve(result, notes=(note, *result.notes))


def result_of(problem: Problem, candidates: Candidates, account: Account, work: Work, threads: int = 1) -> Result:
    """The result of fixtures that are listed once."""
    everything = measured(placed(candidates, problem), problem, threads)
    ranked = everything.take(rank(everything.quality, problem.query.ranking))
    return Result(
        query=problem.query,
        table=ranked,
        found=problem.query.toolkit.arrangements_counted(ranked.arrangement),
        distinct=count_distinct(candidates, problem, threads),
        complete=work.complete and account.left == 0,
        notes=notes(len(account.undecided)),
        statistics=work.statistics,
        proof=proof_of(account, work),
    )


def proof_of(account: Account, work: Work) -> Proof:
    """The account of a search for the result."""
    # A pair of chords that was given up counts as one candidate.
    examined = work.examined
    candidates = account.records if examined is None else examined + account.given_up - account.left
    kept = account.verified + len(account.undecided)
    # One candidate may hold two solutions, which then count as two.
    candidates = max(candidates, kept)
    return Proof(work.cells, candidates, candidates - kept, account.verified, account.escalated, account.undecided)


def notes(undecided_count: int) -> tuple[str, ...]:
    """Remarks on a search that a user should read."""
    if undecided_count == 0:
        return ()
    some = "1 candidate is undecided" if undecided_count == 1 else f"{undecided_count} candidates are undecided"
    return (f"{some}: it cannot be shown whether they are fixtures; the result's proof names them with the reason.",)
