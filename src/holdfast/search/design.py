"""Design: every fixture of a workpiece in a vise."""

from __future__ import annotations

from collections.abc import Sequence
from threading import Event

import numpy as np
from attrs import evolve
from numpy.typing import NDArray

from holdfast.contact.curves import CurveTable, center_numbers, curve_table, loosened
from holdfast.kernels.type_one import CANDIDATES, CONTACTS, CROSSED, PAIRS, STATISTICS
from holdfast.listing.best import BestFixtures
from holdfast.listing.listed import best_result, listed_result
from holdfast.listing.problem import TYPES, Problem, Progress, check_options
from holdfast.model.result import Result
from holdfast.model.vise import Vise
from holdfast.model.workpiece import Workpiece
from holdfast.search.cells import run_blocks, thread_count
from holdfast.search.contacts import count_contacts
from holdfast.search.vise_search import ViseSearch, lattice_steps

__all__ = ["design"]

# The part of the work, as progress tells it, that finding records is; the rest is deciding which of them are fixtures.
SEARCH = 0.9


def design(
    workpiece: Workpiece,
    vise: Vise,
    *,
    types: Sequence[str] = TYPES,
    contact_margin: float = 0.0,
    best: int | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
    cancel: Event | None = None,
) -> Result:
    """Find every fixture of a workpiece in a vise.

    Parameters
    ----------
    workpiece, vise : what to hold and what to hold it in.
    types : "I" (two pegs on each jaw), "II" (three and one), or both.
    contact_margin : smallest distance in mm between a contact and the end of its feature.
    best : seek and list only this many, the best ones; None lists all.
    threads : how many threads share the work; None for one on each processor. The result does not depend on it.
    progress : called from this thread as ``progress(fraction done, fixtures found so far)``.
    cancel : when set, the search stops soon and the result, marked incomplete, holds what was found.

    Returns
    -------
    Result
        Fixtures ranked by closure margin, largest first; fixtures of equal margin (to 9 digits) in the order of their
        holes, pose and faces.

    Raises
    ------
    InputError
        For an unknown type, numbers out of range, and a peg that fits nowhere along the part.

    Examples
    --------
    >>> import holdfast
    >>> widget = holdfast.load("widget")
    >>> result = holdfast.design(widget, holdfast.Vise(pitch=8, columns=1, peg_radius=3))
    >>> result.counts
    {'I': 459, 'II': 46}
    >>> [peg.hole for peg in result[0].pegs]
    ['L-A1', 'L-A2', 'R-A1', 'R-A2']
    """
    check_options(types, contact_margin, best, threads)
    problem = Problem.of(workpiece, vise, contact_margin)
    loose = loosened(problem.rows[:, :8])
    table = curve_table(loose, lattice_steps(vise, problem.diameter + 1e-6))
    search = ViseSearch(vise, problem.rows, loose, table, contact_margin, problem.wrench_length)
    blocks = search.blocks(types)
    kept = None if best is None else BestFixtures(problem, best, cancel)
    receive = None if kept is None else lambda records: search.seek(kept.add(records))
    records, done = run_blocks(blocks, thread_count(threads), stage(progress, 0.0, SEARCH), cancel, receive)
    work = np.array(search.stats, np.int64).reshape(-1, STATISTICS).sum(axis=0)
    complete, figures, examined = len(done) == len(blocks), statistics(search, table, work), int(work[CANDIDATES])
    cells = sum(block.cells for block in done)
    if kept is not None:
        result = best_result(problem, kept, complete=complete, statistics=figures, cells=cells, examined=examined)
    else:
        result = listed_result(
            problem,
            records,
            complete=complete,
            statistics=figures,
            cells=cells,
            examined=examined,
            progress=stage(progress, SEARCH, 1.0),
            cancel=cancel,
        )
    if result.complete and not any(result.found.values()) and not result.notes:
        return evolve(result, notes=(why_none(problem, table, int(work[CONTACTS]), threads),))
    return result


def stage(progress: Progress | None, low: float, high: float) -> Progress | None:
    """The progress of one stage of the work, from one fraction of the whole to another."""
    if progress is None:
        return None
    return lambda fraction, found: progress(low + (high - low) * fraction, found)


def why_none(problem: Problem, table: CurveTable, contacts: int, threads: int | None) -> str:
    """The reason when a search finds no fixture, in one sentence."""
    arcs = problem.rows[:, 0] != 0.0
    if arcs.all() and len(set(center_numbers(problem.rows).tolist())) == 1:
        return (
            "Every face is an arc about one centre, so the forces of all pegs meet in that point and nothing keeps the part "
            "from turning."
        )
    if len(table) + len(table.upright_integers) == 0:
        return "No two pegs of one jaw can touch the part together: the pitch is too large for it."
    # What cannot be a fixture was left out early; whether pegs can touch at all is then asked once more.
    if contacts == 0 and count_contacts(problem.workpiece, problem.vise, threads=threads) == 0:
        return "No four pegs of the two jaws can touch the part at the same time inside their faces."
    return "Four pegs can touch the part at the same time, but no such set keeps the smallest gap, closes and clamps."


def statistics(search: ViseSearch, table: CurveTable, work: NDArray[np.int64]) -> dict[str, int]:
    """Counts that tell how much work a search was (see ``Result.statistics``)."""
    return {
        "features": len(search.features),
        "chord_curves": len(table),
        "uprights": len(table.upright_integers),
        "curve_pairs": int(work[PAIRS]),
        "crossings_sought": int(work[CROSSED]),
        "contacts_examined": int(work[CONTACTS]),
    }
