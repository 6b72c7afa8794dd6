"""Counting simultaneous contacts, the measure of how much there is to search (paper, section 5)."""

from __future__ import annotations

import numpy as np

from holdfast.contact.curves import curve_table, loosened
from holdfast.kernels.type_one import CONTACTS, STATISTICS
from holdfast.listing.problem import TYPES, Problem
from holdfast.model.vise import Vise
from holdfast.model.workpiece import Workpiece
from holdfast.search.cells import run_blocks, thread_count
from holdfast.search.vise_search import ViseSearch, lattice_steps

__all__ = ["count_contacts"]


def count_contacts(workpiece: Workpiece, vise: Vise, *, threads: int | None = None) -> int:
    """How many sets of four pegs of the two jaws touch a workpiece at the same time, each contact inside its feature.

    Nothing else is asked of them: neither the gap between the jaws nor closure nor clamping. Sets that rest on a chord of
    parallel faces and right pegs on faces square to the jaws' motion count only where they can be told apart.

    Parameters
    ----------
    threads : how many threads share the work; None for one on each processor.

    Raises
    ------
    InputError
        For a peg that fits nowhere along the part.
    """
    problem = Problem.of(workpiece, vise)
    loose = loosened(problem.rows[:, :8])
    table = curve_table(loose, lattice_steps(vise, problem.diameter + 1e-6))
    search = ViseSearch(vise, problem.rows, loose, table, 0.0, problem.wrench_length, counting=True)
    run_blocks(search.blocks(TYPES), thread_count(threads), None, None)
    return int(np.array(search.stats, np.int64).reshape(-1, STATISTICS)[:, CONTACTS].sum())
