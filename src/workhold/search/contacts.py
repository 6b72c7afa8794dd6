"""Counting simultaneous contacts, the measure of how much there is to search (paper, section 5)."""

from __future__ import annotations

from threading import Event

from workhold.contact.problem import Problem
from workhold.fixels.toolkit import Toolkit
from workhold.kernels.crossing.two_and_two import CONTACTS
from workhold.limits import thread_count
from workhold.model.query import Query
from workhold.model.workpiece import Workpiece
from workhold.search.cells import run_blocks
from workhold.search.toolkit_search import ToolkitSearch

__all__ = ["contacts_of", "count_contacts"]


def count_contacts(workpiece: Workpiece, toolkit: Toolkit, *, threads: int | None = None) -> int:
    """How many sets of four pegs of the two jaws touch a workpiece at the same time, each contact inside its
    feature.

    Nothing else is asked of them: neither the gap between the jaws nor closure nor clamping. Sets that rest
    on a chord of parallel faces and right pegs on faces square to the jaws' motion count only where they can
    be told apart.

    Parameters
    ----------
    threads : how many threads share the work; None for one on each processor.

    Raises
    ------
    InputError
        For a peg that fits nowhere along the part.
    """
    return contacts_of(Problem.of(Query(workpiece, toolkit)), threads)


def contacts_of(problem: Problem, threads: int | None, cancel: Event | None = None) -> int:
    """Simultaneous contacts of a problem, see :func:`count_contacts`; fewer once ``cancel`` is set."""
    workers = thread_count(threads)
    search = ToolkitSearch.of(problem, counting=True, threads=workers, cancel=cancel)
    run_blocks(search.blocks(problem.query.arrangements), workers, None, cancel, stop=search.stop)
    return int(search.totals[CONTACTS])
