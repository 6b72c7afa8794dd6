"""Sharing the search out: cells of orientation, worked on by threads, with progress and cancel."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from contextlib import nullcontext
from math import pi, tau
from queue import Empty, SimpleQueue
from threading import Event
from time import sleep

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.contact.curves import CurveTable
from workhold.contact.problem import Progress
from workhold.listing.collector import Needed

__all__ = [
    "Block",
    "divide_into_cells",
    "estimate_cost",
    "count_curves_in_cells",
    "find_curves_in_cell",
    "run_blocks",
]

Records = NDArray[np.float64]

# Orientations are counted from here, so that no aligned part has its coincidences at the edge of a cell.
FIRST_ORIENTATION = -0.7320508075688772
# A block is given what is needed as known so many blocks before it; as many may run at the same time.
LAG = 8
ANYTHING = Needed()
# Seconds in which threads are left alone: waking for every small block takes the interpreter from them, and
# time to wake up.
NAP = 5e-4
# Blocks handed out for each thread beyond those that are done: more than end in a nap.
AHEAD = 32
# Curves are of a cell that they end so near to.
SLACK = 1e-9
# Radians, of which there are whole numbers in a turn: curves of neighbouring cells are sought together.
SECTOR = tau / 64


@define(frozen=True)
class Block:
    """A piece of work that shares nothing with the others.

    Parameters
    ----------
    work : does it, given what fixtures must reach to be of interest, and returns records.
    cost : a guess of how long it takes, in any unit.
    cells : how many cells it works on.
    start : the orientation in radians at which the first of them begins.
    dense : how many records it finds, relative to its cost.
    """

    work: Callable[[Needed], Records]
    cost: float
    cells: int = 1
    start: float = 0.0
    dense: float = 1.0


def estimate_cost(blocks: Iterable[Block]) -> float:
    """A guess of how long blocks take, in the unit of ``Block.cost``."""
    return sum(block.cost for block in blocks)


def divide_into_cells(half_turns: int, cells: int) -> NDArray[np.float64]:
    """Edges (cells + 1,) in radians of equal cells over one or two half turns of orientations."""
    return FIRST_ORIENTATION + half_turns * pi * np.arange(cells + 1) / cells


def find_curves_in_cell(table: CurveTable, low: float, high: float) -> NDArray[np.int64]:
    """Indices of the curves that exist somewhere in a cell of orientations (or within 1e-9 of it)."""
    begin = (low - SLACK) % tau
    end = begin + (high - low) + 2 * SLACK
    sector = int(begin / SECTOR)
    if not (sector * SECTOR <= begin and end <= (sector + 1) * SECTOR):
        return find_curves_between(table.spans, begin, end)
    # Those of a sector are sought once for all of its cells.
    if sector not in table.sectors:
        table.sectors[sector] = find_curves_between(table.spans, sector * SECTOR, (sector + 1) * SECTOR)
    some = table.sectors[sector]
    first, last = table.spans
    return some[find_curves_between((first[some], last[some]), begin, end)]


def find_curves_between(
    spans: tuple[NDArray[np.float64], NDArray[np.float64]], begin: float, end: float
) -> NDArray[np.int64]:
    """Which curves, given their spans (N,), exist somewhere from one orientation in [0, 2 pi) to another."""
    first, last = spans
    # Where the cell runs over a whole turn, or a curve does, the other may be met a turn later.
    there = (first <= end) & (last >= begin)
    return np.flatnonzero(there | (first <= end - tau) | (last >= begin + tau))


def count_curves_in_cells(
    table: CurveTable, low: NDArray[np.float64], high: NDArray[np.float64]
) -> NDArray[np.int64]:
    """How many curves exist somewhere in each of some cells (K,), but for a hair at their ends."""
    first, last = table.sorted_spans
    turns = [-tau, 0.0, tau]
    begun = sum(np.searchsorted(first, high + turn, "right") for turn in turns)
    return np.asarray(begun - sum(np.searchsorted(last, low + turn, "left") for turn in turns))


def run_blocks(
    blocks: Sequence[Block],
    threads: int,
    progress: Progress | None,
    cancel: Event | None,
    receive: Callable[[Records], Needed] | None = None,
    look: Callable[[Records], None] | None = None,
    stop: Callable[[], None] | None = None,
    pool: Executor | None = None,
    needed: Needed = ANYTHING,
) -> tuple[list[Records], list[Block]]:
    """Does all blocks on some threads.

    Parameters
    ----------
    receive : called from this thread with the records of each block, in the order of the blocks; they are
        then not kept. It returns what further fixtures must reach. The block ``LAG``
        places later is given it, so what a block leaves out does not depend on how fast the others are.
    look : called from this thread with the records of each block as it finishes, in any order.
    stop : called once when the work is cancelled or given up: blocks that run then end soon, with what they
        have found.
    pool : of so many threads, where there is one already.
    needed : what fixtures must reach as is known before any is received.

    Returns
    -------
    (records of the blocks, also of those that were stopped, in the order of the blocks; the blocks done)
    """
    total = sum(block.cost for block in blocks) or 1.0
    results: dict[int, Records] = {}
    # What is needed once so many blocks have been received.
    margins = [needed]
    done_cost, found = 0.0, 0
    done: list[Block] = []
    known = margins if receive is not None else None
    for index, records, whole in finished_blocks(blocks, threads, cancel, known, stop, pool):
        results[index] = records
        while receive is not None and len(margins) - 1 in results:
            margins.append(receive(results.pop(len(margins) - 1)))
        done_cost += blocks[index].cost
        found += len(records)
        if whole:
            done.append(blocks[index])
        if progress is not None:
            progress(min(done_cost / total, 1.0), found)
        if look is not None:
            look(records)
    rest = [results[index] for index in sorted(results)]
    if receive is not None:
        # Blocks that were done when others before them were cancelled.
        for records in rest:
            receive(records)
        rest = []
    return rest, done


def finished_blocks(
    blocks: Sequence[Block],
    threads: int,
    cancel: Event | None,
    margins: list[Needed] | None,
    stop: Callable[[], None] | None,
    pool: Executor | None,
) -> Iterator[tuple[int, Records, bool]]:
    """Blocks as they finish: number, records, and whether they came to their end; no new one is begun once
    ``cancel`` is set.

    Parameters
    ----------
    margins : grows by one for each block received; a block waits for the one ``LAG`` places before it. None
        for no margins.
    """
    first, running, whole = 0, dict[Future[Records], int](), True
    # Other work in the pool is not to wait behind many blocks, and blocks are given margins as these become
    # known.
    alone = pool is None and margins is None
    most = threads * (AHEAD if alone else 2)
    # The threads report it themselves: asking each future what has become of it takes longer than a small
    # block.
    ended = SimpleQueue[Future[Records]]()
    with ThreadPoolExecutor(max_workers=threads) if pool is None else nullcontext(pool) as workers:
        try:
            while True:
                if whole and cancel is not None and cancel.is_set():
                    whole = False
                    # Those that wait are not begun.
                    running = {future: index for future, index in running.items() if not future.cancel()}
                    if stop is not None:
                        stop()
                # Short naps between looks at the flag keep Ctrl-C alive; the queue is kept just full enough.
                while whole and first < len(blocks) and len(running) < most:
                    known = max(first - LAG, 0)
                    if margins is not None and known >= len(margins):
                        break
                    needed = ANYTHING if margins is None else margins[known]
                    future = workers.submit(blocks[first].work, needed)
                    running[future] = first
                    future.add_done_callback(ended.put)
                    first += 1
                if not running:
                    return
                if alone and ended.empty():
                    sleep(NAP)
                try:
                    future = ended.get(timeout=0.1)
                except Empty:
                    continue
                if future in running:
                    yield running.pop(future), future.result(), whole
        finally:
            # The pool waits for its threads, also when this is left by a signal.
            for future in running:
                future.cancel()
            if running and stop is not None:
                stop()
