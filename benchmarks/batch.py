"""Target 10: many parts at once: what two workers do against one.

The tasks are searches of a catalogue in three toolkits, given to one process and to two.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from itertools import product
from threading import Event
from time import perf_counter
from typing import Any

from attrs import evolve

from catalogue import catalogue
from report import Column, Section, run_alone
from workhold.batch.run import ANY_PART
from workhold.batch.store import make_part_record
from workhold.batch.tasks import QueryTask, Task
from workhold.batch.workers import LocalWorkers
from workhold.files.toolkit_file import load_toolkit
from workhold.model.query import Query

PRESETS = ("plate-20mm", "clamp-plate-20mm", "fence-20mm")
LENGTH, QUICK_LENGTH = 60, 6
LEAST_GAIN = 1.8

COLUMNS = (
    Column("workers", 7),
    Column("searches", 8),
    Column("seconds", 8),
    Column("ms a search", 11),
    Column("searches a second", 17),
)


class Nobody:
    """Looks away."""

    def note_begun(self, worker: str, title: str) -> None:
        """See ``batch.tasks.TaskObserver``."""

    def note_ended(self, worker: str) -> None:
        """See ``batch.tasks.TaskObserver``."""

    def notify(self, sentence: str) -> None:
        """See ``batch.tasks.TaskObserver``."""


def run(quick: bool) -> Section:
    """Measure throughput."""
    section = Section("batch", "Many parts at once", COLUMNS).begin()
    tasks = list(searching(QUICK_LENGTH if quick else LENGTH))
    spent = {}
    for workers in (1, 2):
        spent[workers] = seconds_of(partial(LocalWorkers, workers, Nobody()), tasks, workers)
        each = 1e3 * spent[workers] / len(tasks)
        section.row(
            str(workers), str(len(tasks)), f"{spent[workers]:.1f}", f"{each:.0f}", f"{1e3 / each:.1f}"
        )
    gain = spent[1] / spent[2]
    words = f"two workers do at least {LEAST_GAIN} times as much as one"
    section.target(10, words, f"{gain:.2f} times", gain >= LEAST_GAIN)
    return section


def searching(length: int) -> Iterator[Task]:
    """Searches of a catalogue in some toolkits."""
    queries = [Query(ANY_PART, load_toolkit(name).toolkit) for name in PRESETS]
    for number, (part, query) in enumerate(product(catalogue(length), queries)):
        yield QueryTask(f"search-{number}", part.name, make_part_record(part, ()), query, 10)


def seconds_of(queue: Callable[[], Any], tasks: list[Task], workers: int) -> float:
    """Seconds that some tasks take; a few before them load what each worker needs."""
    with queue() as ready:
        for _ in ready.run(iter([evolve(tasks[k], name=f"warm-{k}") for k in range(4 * workers)]), Event()):
            pass
        start = perf_counter()
        count = sum(1 for outcome in ready.run(iter(tasks), Event()) if not outcome.failure)
        spent = perf_counter() - start
    assert count == len(tasks)
    return spent


if __name__ == "__main__":
    run_alone(__doc__, run)
