"""What 100,000 parts in 20 toolkits would take: a simulation, calibrated on what was measured.

Tasks draw their seconds from those measured for the estimate (``batch_estimate``), the queue's are those measured for the
queue (``batch_queue``): a queue hands out one task after the other, so it can feed only so many workers. Workers are as
fast as the processor that was measured, and never fail.
"""

from __future__ import annotations

import random
from heapq import heapify, heapreplace

from report import Column, Section, kept_figures, run_alone

PARTS, TOOLKITS = 100_000, 20
WORKERS = (2, 16, 64, 256, 1024)
SEED = 2026
# Seconds of an hour, and hours of a day.
HOUR, DAY = 3600.0, 24.0

COLUMNS = (
    Column("workers", 7),
    Column("processes", 12),
    Column("share at work", 13),
    Column("Dask", 12),
    Column("share at work", 13),
)


def run(quick: bool) -> Section:
    """Simulate with more and more workers."""
    section = Section(
        "batch-simulation", f"{PARTS:,} parts in {TOOLKITS} toolkits, simulated", COLUMNS
    ).begin()
    kept = kept_figures()["sections"]
    if not {"batch-queue", "batch-estimate"} <= kept.keys():
        section.remark("Nothing is measured yet to reckon with.")
        return section
    seconds, queue = kept["batch-estimate"]["data"]["seconds"], kept["batch-queue"]["data"]
    count = PARTS * TOOLKITS // (100 if quick else 1)
    tasks = random.Random(SEED).choices(seconds, k=count)
    # Longest first, as a batch does.
    tasks.sort(reverse=True)
    whole = sum(tasks)
    for workers in WORKERS:
        words = [str(workers)]
        for name in ("processes", "Dask"):
            if name not in queue:
                words += ["", ""]
                continue
            end = finished(tasks, workers, queue[name])
            words += [duration(end), f"{whole / (workers * end):.0%}"]
        section.row(*words)
    costs = ", ".join(f"{1e3 * cost:.2f} ms ({name})" for name, cost in queue.items())
    section.remark(
        f"{count:,} tasks of {whole / count:.2f} s on average, {duration(whole)} of one processor."
    )
    section.remark(f"The queue hands out a task in {costs}.")
    return section


def finished(tasks: list[float], workers: int, cost: float) -> float:
    """When the last of some tasks is done: each goes to the worker that is free first, no sooner than the queue is.

    Parameters
    ----------
    tasks : seconds of each, in their order.
    cost : seconds of the queue for each task.
    """
    free = [0.0] * workers
    heapify(free)
    queue = 0.0
    for seconds in tasks:
        # A worker is handed its next task when it is free and the queue has come to it.
        queue = max(queue, free[0] - cost) + cost
        heapreplace(free, max(free[0], queue) + seconds)
    return max(free)


def duration(seconds: float) -> str:
    """A time in the unit that suits it."""
    hours = seconds / HOUR
    return f"{hours / DAY:.1f} days" if hours >= 2 * DAY else f"{hours:.1f} hours"


if __name__ == "__main__":
    run_alone(__doc__, run)
