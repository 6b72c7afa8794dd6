"""From the records of any engine to the result a user sees."""

from __future__ import annotations

from collections.abc import Mapping
from threading import Event

import numpy as np
from attrs import evolve
from numpy.typing import NDArray

from holdfast.listing.best import BestFixtures, margin_digits
from holdfast.listing.deciding import Account
from holdfast.listing.distinct import count_distinct
from holdfast.listing.finish import Candidates, finish, placed, twins
from holdfast.listing.problem import TYPES, Problem, Progress
from holdfast.model.proof import Proof
from holdfast.model.result import FixtureTable, Result

__all__ = ["best_result", "listed_result"]


def listed_result(
    problem: Problem,
    records: list[NDArray[np.float64]],
    *,
    complete: bool,
    best: int | None = None,
    statistics: Mapping[str, int],
    cells: int = 0,
    examined: int | None = None,
    progress: Progress | None = None,
    cancel: Event | None = None,
) -> Result:
    """Check, list once, rank and count the fixtures that an engine found.

    Parameters
    ----------
    problem : what was searched.
    records : (N, 19) arrays of fixtures, laid out as ``kernels.vise_checks`` says.
    complete : whether the search came to its end.
    best : list only this many, the best ones.
    statistics : see ``Result.statistics``.
    cells, examined : ranges of orientation and sets of four contacts that were examined for the records (None: no more
        than the records).
    progress : called as ``progress(fraction done, records that still may be fixtures)``.
    cancel : when set, records that cannot be decided quickly are left, and the result is incomplete.
    """
    candidates, account = finish(records, problem, progress, cancel)
    result = result_of(
        problem, candidates, account, complete=complete, statistics=statistics, cells=cells, examined=examined
    )
    return result if best is None else evolve(result, table=result.table.take(slice(0, best)))


def best_result(
    problem: Problem,
    kept: BestFixtures,
    *,
    complete: bool,
    statistics: Mapping[str, int],
    cells: int,
    examined: int,
) -> Result:
    """The result of a search for the best fixtures only; parameters as for :func:`listed_result`.

    How many fixtures there are in all is not known: those that could not be among the best were not examined.
    """
    candidates, account = kept.finished()
    faces = problem.faces[candidates.feature]
    first, others = twins(candidates, faces)
    order = first[np.lexsort([np.arange(len(first)), -margin_digits(candidates.null[first])])][: kept.most]
    chosen = np.zeros(len(candidates.kind), np.bool_)
    chosen[order] = True
    # A twin is kept with the fixture it resembles.
    holes = np.concatenate([candidates.kind[:, None], faces, candidates.column, candidates.row], axis=1)
    listed = {tuple(row) for row in holes[order].tolist()}
    chosen[others] = [tuple(row) in listed for row in holes[others].tolist()]
    result = result_of(
        problem,
        candidates.take(chosen),
        account,
        complete=complete,
        statistics=statistics,
        cells=cells,
        examined=examined,
    )
    if not complete or (len(first) <= kept.most and kept.margin == 0.0):
        return result
    note = f"Only the best {kept.most} were sought, so how many fixtures there are in all was not counted."
    return evolve(result, notes=(note, *result.notes))


def result_of(
    problem: Problem,
    candidates: Candidates,
    account: Account,
    *,
    complete: bool,
    statistics: Mapping[str, int],
    cells: int,
    examined: int | None,
) -> Result:
    """The result of fixtures that are listed once; parameters as for :func:`listed_result`."""
    first, others = twins(candidates, problem.faces[candidates.feature])
    listed = candidates.take(first)
    center = problem.workpiece.center
    everything = placed(listed, problem.faces, problem.vise, center)
    kept_apart = FixtureTable.empty()
    if len(others):
        kept_apart = placed(candidates.take(others), problem.faces, problem.vise, center)
    ranked = everything.take(rank(everything))
    return Result(
        workpiece=problem.workpiece,
        vise=problem.vise,
        table=ranked,
        found={name: int((ranked.type == k + 1).sum()) for k, name in enumerate(TYPES)},
        distinct=count_distinct(listed, problem.faces[listed.feature], problem.workpiece),
        complete=complete and account.left == 0,
        contact_margin=problem.contact_margin,
        notes=notes(len(kept_apart), len(account.undecided)),
        statistics=statistics,
        twins=kept_apart,
        proof=proof_of(account, cells, examined),
    )


def proof_of(account: Account, cells: int, examined: int | None) -> Proof:
    """The account of a search for the result."""
    # A pair of chords that was given up counts as one candidate.
    candidates = account.records if examined is None else examined + account.given_up - account.left
    kept = account.verified + len(account.undecided)
    # One candidate may hold two solutions, which then count as two.
    candidates = max(candidates, kept)
    return Proof(cells, candidates, candidates - kept, account.verified, account.escalated, account.undecided)


def rank(table: FixtureTable) -> NDArray[np.intp]:
    """Order of a table in identity order by closure margin, largest first; equal to 9 digits stay in order."""
    if len(table) == 0:
        return np.zeros(0, np.intp)
    return np.argsort(-margin_digits(table.null_vector), kind="stable")


def notes(twin_count: int, undecided_count: int) -> tuple[str, ...]:
    """Remarks on a search that a user should read."""
    out = []
    if twin_count:
        some = "1 fixture has a twin" if twin_count == 1 else f"{twin_count} fixtures have twins"
        out.append(
            f"{some}: the same holes, faces and orientation with the part in another place, kept apart from the list."
        )
    if undecided_count:
        some = "1 candidate is undecided" if undecided_count == 1 else f"{undecided_count} candidates are undecided"
        out.append(
            f"{some}: it cannot be shown whether they are fixtures; the result's proof names them with the reason."
        )
    return tuple(out)
