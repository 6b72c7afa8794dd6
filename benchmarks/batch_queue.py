"""What the queue of a batch costs a task, on processes of this machine and on a cluster of Dask, where that is installed.

The tasks do nothing. Counted are seconds of the processor of who asks, which hands out one task after the other and keeps
its record: of a cluster on this machine its scheduler is part of that. What else the machine does counts little.
"""

from __future__ import annotations

from functools import partial
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Event
from time import process_time
from typing import Any

from attrs import frozen

from batch import Nobody
from report import Column, Section, run_alone
from workhold.batch.durations import TaskDurations
from workhold.batch.store import FolderStore, make_refusal_record
from workhold.batch.tasks import Task
from workhold.batch.workers import LocalWorkers

WORKERS = 2
TASKS, QUICK_TASKS = 3000, 100

COLUMNS = (
    Column("queue", 12, right=False),
    Column("tasks", 6),
    Column("processor s", 11),
    Column("ms a task", 9),
)


@frozen
class Empty(Task):
    """Does nothing."""

    def prepare(self) -> None:
        """Nothing."""

    def make_record(self) -> bytes:
        """A record like any other."""
        return make_refusal_record("nothing was asked")


def run(quick: bool) -> Section:
    """Measure each queue there is."""
    section = Section("batch-queue", "What the queue costs a task", COLUMNS).begin()
    there = queues()
    if "Dask" not in there:
        section.remark("Dask is not installed here, so its queue is not measured.")
    count = QUICK_TASKS if quick else TASKS
    for name in there:
        spent = seconds_of(name, count)
        section.row(name, f"{count:,}", f"{spent:.2f}", f"{1e3 * spent / count:.2f}")
        section.data[name] = spent / count
    return section


def costs(count: int) -> dict[str, float]:
    """Task: seconds that each queue there is takes for a task."""
    return {name: seconds_of(name, count) / count for name in queues()}


def queues() -> dict[str, partial[Any]]:
    """The queues that are installed, by name."""
    found: dict[str, partial[Any]] = {"processes": partial(LocalWorkers, WORKERS, Nobody())}
    if find_spec("distributed") is not None:
        from workhold.batch.cluster import ClusterWorkers

        found["Dask"] = partial(ClusterWorkers, Nobody(), count=WORKERS)
    return found


def seconds_of(name: str, count: int) -> float:
    """Seconds of the processor for so many tasks."""
    with TemporaryDirectory() as folder, queues()[name]() as ready:
        store, measured = FolderStore(Path(folder)), TaskDurations(Path(folder) / "measured.csv")
        for _ in ready.run(iter(tasks("warm", 4 * WORKERS)), Event()):
            pass
        start = process_time()
        for outcome in ready.run(iter(tasks("task", count)), Event()):
            measured.add(outcome)
            store.write(outcome.name, outcome.record)
        spent = process_time() - start
        assert len(measured.known) == count
    return spent


def tasks(name: str, count: int) -> list[Task]:
    """So many tasks that do nothing."""
    return [Empty(f"{name}-{number}", name) for number in range(count)]


if __name__ == "__main__":
    # So that workers can import the task by the name of its module.
    import batch_queue

    run_alone(__doc__, batch_queue.run)
