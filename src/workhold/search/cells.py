"""Sharing the search out: cells of orientation, worked on by threads, with progress and cancel."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from math import pi, tau
from threading import Event

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.contact.curves import CurveTable
from workhold.contact.problem import Progress
from workhold.kernels.curves.columns import FROM, SHIFT, TO

__all__ = ["Block", "cell_edges", "members_of_cell", "run_blocks", "thread_count"]

Records = NDArray[np.float64]

# Orientations are counted from here, so that no aligned part has its coincidences at the edge of a cell.
FIRST_ORIENTATION = -0.7320508075688772
# A block is told the closure margin known so many blocks before it; as many may run at the same time.
LAG = 8


@define(frozen=True)
class Block:
    """A piece of work that shares nothing with the others.

    Parameters
    ----------
    work : does it, given a closure margin that is to be reached, and returns records.
    cost : a guess of how long it takes, in any unit.
    cells : how many cells it works on.
    """

    work: Callable[[float], Records]
    cost: float
    cells: int = 1


def cell_edges(half_turns: int, cells: int) -> NDArray[np.float64]:
    """Edges (cells + 1,) in radians of equal cells over one or two half turns of orientations."""
    return FIRST_ORIENTATION + half_turns * pi * np.arange(cells + 1) / cells


def members_of_cell(table: CurveTable, low: float, high: float) -> NDArray[np.int64]:
    """Indices of the curves that exist somewhere in a cell of orientations (or within 1e-9 of it)."""
    slack, reals = 1e-9, table.curves.reals
    base = reals[:, FROM] - reals[:, SHIFT]
    span = reals[:, TO] - reals[:, FROM]
    behind = (low - slack - base) % tau
    return np.flatnonzero((behind <= span) | (behind + (high - low) + 2 * slack >= tau))


def thread_count(threads: int | None) -> int:
    """The number of threads to use: as asked for, or one for each processor this process may use."""
    if threads is not None:
        return threads
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def run_blocks(
    blocks: Sequence[Block],
    threads: int,
    progress: Progress | None,
    cancel: Event | None,
    receive: Callable[[Records], float] | None = None,
    look: Callable[[Records], None] | None = None,
) -> tuple[list[Records], list[Block]]:
    """Do all blocks on some threads.

    Parameters
    ----------
    receive : called from this thread with the records of each block, in the order of the blocks; they are then not kept. It
        returns the closure margin that further fixtures must reach, which is told to the block ``LAG`` places later: so what
        a block leaves out does not depend on how fast the others are.
    look : called from this thread with the records of each block as it finishes, in any order.

    Returns
    -------
    (records of the blocks done, in the order of the blocks; those blocks)
    """
    total = sum(block.cost for block in blocks) or 1.0
    results: dict[int, Records] = {}
    # The margin to reach once so many blocks have been received.
    margins = [0.0]
    done_cost, found = 0.0, 0
    done: list[Block] = []
    for index, records in finished_blocks(blocks, threads, cancel, margins if receive is not None else None):
        results[index] = records
        while receive is not None and len(margins) - 1 in results:
            margins.append(receive(results.pop(len(margins) - 1)))
        done_cost += blocks[index].cost
        found += len(records)
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
    blocks: Sequence[Block], threads: int, cancel: Event | None, margins: list[float] | None
) -> Iterator[tuple[int, Records]]:
    """Blocks as they finish; no new one is begun once ``cancel`` is set.

    Parameters
    ----------
    margins : grows by one for each block received; a block waits for the one ``LAG`` places before it. None for no margins.
    """
    first, running = 0, dict[Future[Records], int]()
    with ThreadPoolExecutor(max_workers=threads) as pool:
        while True:
            # Short naps between looks at the flag keep Ctrl-C alive; the queue is kept just full enough.
            while first < len(blocks) and len(running) < 2 * threads and not (cancel is not None and cancel.is_set()):
                known = max(first - LAG, 0)
                if margins is not None and known >= len(margins):
                    break
                margin = 0.0 if margins is None else margins[known]
                running[pool.submit(blocks[first].work, margin)] = first
                first += 1
            if not running:
                return
            done, _ = wait(running, timeout=0.1, return_when=FIRST_COMPLETED)
            for future in done:
                yield running.pop(future), future.result()
