"""The division of a search into cells of orientation, and threads that work on them, with progress and
cancel.
"""

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
from workhold.listing.collector import InterestLimits

__all__ = [
    "SearchBlock",
    "divide_into_cells",
    "estimate_cost",
    "count_curves_in_cells",
    "find_curves_in_cell",
    "run_blocks",
]

Records = NDArray[np.float64]

# Orientations are counted from here, so that no aligned part has its coincidences at the edge of a cell.
FIRST_ORIENTATION = -0.7320508075688772
# A block is passed what fixtures must reach as it was known LAG blocks earlier; so many may run at once.
LAG = 8
ANYTHING = InterestLimits()
# Seconds between looks at running threads: waking for every small block costs them the interpreter, and time.
NAP = 5e-4
# Blocks submitted for each thread beyond those done; more than finish within a nap.
AHEAD = 32
# Radians. A curve that ends within this of a cell counts as in the cell.
SLACK = 1e-9
# Radians. Width of a sector, a whole part of a turn; the curves of a sector's cells are looked up together.
SECTOR = tau / 64


@define(frozen=True)
class SearchBlock:
    """A unit of search work that shares nothing with other blocks.

    Parameters
    ----------
    work : function that takes the limits that fixtures must keep to be of interest, and returns records (N,
        19), see ``kernels.contact.record``.
    cost : estimated time, in units common to all blocks.
    cells : number of cells of orientation that the block covers.
    start : orientation psi in radians at which its first cell begins.
    dense : expected number of records, divided by ``cost``.
    """

    work: Callable[[InterestLimits], Records]
    cost: float
    cells: int = 1
    start: float = 0.0
    dense: float = 1.0


def estimate_cost(blocks: Iterable[SearchBlock]) -> float:
    """Return the sum of the estimated times of blocks, in the unit of ``SearchBlock.cost``."""
    return sum(block.cost for block in blocks)


def divide_into_cells(half_turns: int, cells: int) -> NDArray[np.float64]:
    """Return the edges of equal cells of orientation, as psi in radians, ascending, (cells + 1,).

    The cells together cover ``half_turns`` half turns (1 or 2).
    """
    return FIRST_ORIENTATION + half_turns * pi * np.arange(cells + 1) / cells


def find_curves_in_cell(table: CurveTable, low: float, high: float) -> NDArray[np.int64]:
    """Return the indices, ascending, of the chord curves that exist somewhere between two orientations psi.

    ``low`` and ``high`` are in radians; curves that miss the range by at most 1e-9 are included. The curves
    of each sector (1/64 turn) are cached in ``table.sectors``.
    """
    begin = (low - SLACK) % tau
    end = begin + (high - low) + 2 * SLACK
    sector = int(begin / SECTOR)
    if not (sector * SECTOR <= begin and end <= (sector + 1) * SECTOR):
        return find_curves_between(table.spans, begin, end)
    # The curves of a sector are looked up once for all its cells.
    if sector not in table.sectors:
        table.sectors[sector] = find_curves_between(table.spans, sector * SECTOR, (sector + 1) * SECTOR)
    some = table.sectors[sector]
    first, last = table.spans
    return some[find_curves_between((first[some], last[some]), begin, end)]


def find_curves_between(
    spans: tuple[NDArray[np.float64], NDArray[np.float64]], begin: float, end: float
) -> NDArray[np.int64]:
    """Return the indices, ascending, of the curves that exist at an orientation from ``begin`` to ``end``.

    ``spans`` are the first and the last orientation of each curve, each (N,) in radians. ``begin`` is in [0,
    2 pi). Spans and the range are compared modulo a turn.
    """
    first, last = spans
    # Where the cell runs over a whole turn, or a curve does, the other may be met a turn later.
    there = (first <= end) & (last >= begin)
    return np.flatnonzero(there | (first <= end - tau) | (last >= begin + tau))


def count_curves_in_cells(
    table: CurveTable, low: NDArray[np.float64], high: NDArray[np.float64]
) -> NDArray[np.int64]:
    """Return the number of curves that exist in each of K cells, (K,).

    Cell k extends from ``low[k]`` to ``high[k]``, orientations psi in radians. Unlike
    :func:`find_curves_in_cell` there is no tolerance at the cells' ends.
    """
    first, last = table.sorted_spans
    turns = [-tau, 0.0, tau]
    begun = sum(np.searchsorted(first, high + turn, "right") for turn in turns)
    return np.asarray(begun - sum(np.searchsorted(last, low + turn, "left") for turn in turns))


def run_blocks(
    blocks: Sequence[SearchBlock],
    threads: int,
    progress: Progress | None,
    cancel: Event | None,
    receive: Callable[[Records], InterestLimits] | None = None,
    look: Callable[[Records], None] | None = None,
    stop: Callable[[], None] | None = None,
    pool: Executor | None = None,
    needed: InterestLimits = ANYTHING,
) -> tuple[list[Records], list[SearchBlock]]:
    """Run all blocks on threads; return (their records, the blocks that finished).

    Parameters
    ----------
    progress : called from this thread as ``progress(fraction done, records found)``.
    cancel : when set, no further block is begun.
    receive : called from this thread with the records of each block, in the order of the blocks; the records
        are then not returned. It returns the limits that further fixtures must keep. They are passed to the
        block ``LAG`` places later, so that what a block leaves out does not depend on the threads' speed.
        None to return the records, and to pass no limits to the blocks.
    look : called from this thread with the records of each block as it finishes, in any order.
    stop : called once when the work is cancelled or given up; running blocks then end soon with their records
        so far.
    pool : executor with ``threads`` threads; None to make one.
    needed : limits that fixtures must keep in the first blocks; not used without ``receive``.

    Returns
    -------
    (list of the records (N, 19) of each block in the order of the blocks, stopped blocks included; the
    finished blocks, in the order in which they finished)
    """
    total = sum(block.cost for block in blocks) or 1.0
    results: dict[int, Records] = {}
    # Entry k: what fixtures must reach once k blocks are received.
    margins = [needed]
    done_cost, found = 0.0, 0
    done: list[SearchBlock] = []
    known = margins if receive is not None else None
    for index, records, whole in iterate_finished_blocks(blocks, threads, cancel, known, stop, pool):
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


def iterate_finished_blocks(
    blocks: Sequence[SearchBlock],
    threads: int,
    cancel: Event | None,
    margins: list[InterestLimits] | None,
    stop: Callable[[], None] | None,
    pool: Executor | None,
) -> Iterator[tuple[int, Records, bool]]:
    """Yield (index of a block, its records, whether it ran to its end) as each block ends, in any order.

    No block is begun once ``cancel`` is set; then ``stop`` is called once.

    Parameters
    ----------
    margins : limits that fixtures must keep after 0, 1, 2, … received blocks; the caller appends to the list.
        Block k is begun with entry k - ``LAG`` (at least 0), and waits until the list has it. None for no
        limits.
    pool : executor to use; None to make one with ``threads`` threads.
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
                    # Blocks that wait are cancelled.
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
