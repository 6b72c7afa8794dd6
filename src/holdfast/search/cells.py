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

from holdfast.contact.curves import CurveTable
from holdfast.kernels.curve_columns import FROM, SHIFT, TO
from holdfast.listing.problem import Progress

__all__ = ["Block", "cell_edges", "members_of_cell", "run_blocks", "thread_count"]

Records = NDArray[np.float64]

# Orientations are counted from here, so that no aligned part has its coincidences at the edge of a cell.
FIRST_ORIENTATION = -0.7320508075688772


@define(frozen=True)
class Block:
    """A piece of work that shares nothing with the others.

    Parameters
    ----------
    work : does it and returns records.
    cost : a guess of how long it takes, in any unit.
    cells : how many cells it works on.
    """

    work: Callable[[], Records]
    cost: float
    cells: int = 1


def cell_edges(half_turns: int, cells: int) -> NDArray[np.float64]:
    """Edges (cells + 1,) in radians of equal cells over one or two half turns of orientations."""
    return FIRST_ORIENTATION + half_turns * pi * np.arange(cells + 1) / cells


def members_of_cell(table: CurveTable, low: float, high: float) -> NDArray[np.int64]:
    """Indices of the curves that exist somewhere in a cell of orientations (or within 1e-9 of it)."""
    slack = 1e-9
    base = table.reals[:, FROM] - table.reals[:, SHIFT]
    span = table.reals[:, TO] - table.reals[:, FROM]
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
    receive: Callable[[Records], None] | None = None,
) -> tuple[list[Records], list[Block]]:
    """Do all blocks on some threads.

    Parameters
    ----------
    receive : called from this thread with the records of each block as it is done; they are then not kept.

    Returns
    -------
    (records of the blocks done, in the order of the blocks; those blocks)
    """
    total = sum(block.cost for block in blocks) or 1.0
    results: list[Records | None] = [None] * len(blocks)
    done_cost, found = 0.0, 0
    done: list[Block] = []
    for index, records in finished_blocks(blocks, threads, cancel):
        if receive is None:
            results[index] = records
        else:
            receive(records)
        done_cost += blocks[index].cost
        found += len(records)
        done.append(blocks[index])
        if progress is not None:
            progress(min(done_cost / total, 1.0), found)
    return [records for records in results if records is not None], done


def finished_blocks(blocks: Sequence[Block], threads: int, cancel: Event | None) -> Iterator[tuple[int, Records]]:
    """Blocks as they finish; no new one is begun once ``cancel`` is set."""
    waiting = iter(range(len(blocks)))
    running: dict[Future[Records], int] = {}
    with ThreadPoolExecutor(max_workers=threads) as pool:
        while True:
            # Short naps between looks at the flag keep Ctrl-C alive; the queue is kept just full enough.
            while len(running) < 2 * threads and not (cancel is not None and cancel.is_set()):
                index = next(waiting, None)
                if index is None:
                    break
                running[pool.submit(blocks[index].work)] = index
            if not running:
                return
            done, _ = wait(running, timeout=0.1, return_when=FIRST_COMPLETED)
            for future in done:
                yield running.pop(future), future.result()
