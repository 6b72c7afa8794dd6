"""A search ends soon in every stage once somebody asks it to: kernels return, and records are left undecided."""

from __future__ import annotations

from itertools import pairwise
from threading import Event

import numpy as np
import pytest

from workhold import Query, Vise, answer, load
from workhold.contact.problem import Problem
from workhold.kernels.curves.block_work import CANDIDATES, CROSSED
from workhold.listing.collector import InterestLimits
from workhold.proof.deciding import DecidingProgress, decide_records
from workhold.search.cells import (
    SearchBlock,
    count_curves_in_cells,
    divide_into_cells,
    find_curves_in_cell,
    run_blocks,
)
from workhold.search.toolkit_search import ToolkitSearch

PROBLEM = Problem.from_query(Query(load("widget"), Vise(pitch=8, columns=2, peg_radius=3)))


def test_kernels_that_are_stopped_seek_nothing() -> None:
    search = ToolkitSearch.from_problem(PROBLEM)
    blocks = search.make_blocks(("I", "II"))
    search.stop()
    assert sum(len(block.work(InterestLimits())) for block in blocks) == 0
    assert search.totals[CROSSED] == search.totals[CANDIDATES] == 0


def test_a_search_cancelled_before_it_begins_makes_no_curves() -> None:
    """And ends without a fixture, incomplete."""
    cancel = Event()
    cancel.set()
    assert (
        len(ToolkitSearch.from_problem(PROBLEM).table)
        > len(ToolkitSearch.from_problem(PROBLEM, cancel=cancel).table)
        == 0
    )
    result = answer(PROBLEM.query, cancel=cancel)
    assert len(result) == 0 and not result.complete and not result.notes


def test_threads_make_the_same_curves() -> None:
    one, other = (ToolkitSearch.from_problem(PROBLEM, threads=threads).table for threads in (1, 3))
    assert len(one.sliding_pairs.reals) > 0
    for mine, its in zip(
        (*one.curves, one.sliding_pairs.reals), (*other.curves, other.sliding_pairs.reals), strict=True
    ):
        np.testing.assert_array_equal(mine, its)


def test_curves_are_counted_for_all_cells_at_once() -> None:
    """As many as there are members of each cell."""
    table, edges = ToolkitSearch.from_problem(PROBLEM).table, divide_into_cells(2, 50)
    members = [len(find_curves_in_cell(table, low, high)) for low, high in pairwise(edges.tolist())]
    assert 0 < min(members) < max(members)
    assert count_curves_in_cells(table, edges[:-1], edges[1:]).tolist() == members


def test_blocks_that_run_when_the_search_is_cancelled_are_stopped_and_not_done() -> None:
    """The block that runs waits until it is stopped; its records count, and those after it are not begun."""
    cancel, stopped = Event(), Event()

    def work(margin: float) -> np.ndarray:
        cancel.set()
        assert stopped.wait(120)
        return np.ones((1, 19))

    records, done = run_blocks([SearchBlock(work, 1.0)] * 9, 1, None, cancel, stop=stopped.set)
    assert stopped.is_set()
    assert done == []
    assert 1 <= len(records) <= 2


def test_blocks_are_stopped_when_a_signal_ends_the_search() -> None:
    """What a signal raises in the thread that waits does not wait for the work."""
    stopped = Event()

    def work(margin: float) -> np.ndarray:
        assert stopped.wait(120)
        return np.ones((1, 19))

    def interrupt(fraction: float, found: int) -> None:
        raise SystemExit

    blocks = [SearchBlock(lambda margin: np.ones((1, 19)), 1.0), SearchBlock(work, 1.0)]
    with pytest.raises(SystemExit):
        run_blocks(blocks, 2, interrupt, None, stop=stopped.set)
    assert stopped.is_set()


def test_what_is_not_decided_soon_after_is_left() -> None:
    search = ToolkitSearch.from_problem(PROBLEM)
    records = np.concatenate([block.work(InterestLimits()) for block in search.make_blocks(("I", "II"))])
    course = DecidingProgress(len(records))
    course.give_up()
    proven, account = decide_records(records, PROBLEM, course)
    assert len(proven) == account.records == 0
    assert account.left == len(records) > 0
