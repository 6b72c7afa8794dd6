"""A batch from the first drawing to the last answer: what is done is passed over, what is not is given out, longest first.

Nothing but records tells what is done. A run that ends, in whatever way, leaves whole records, and the next one goes on.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from threading import Event
from typing import Protocol, TypeVar

from attrs import define, field, frozen

from workhold.batch.estimate import answering_seconds, reading_seconds
from workhold.batch.jobs import Job, Part, Request
from workhold.batch.measured import Measured
from workhold.batch.naming import name_of
from workhold.batch.queues import Queue
from workhold.batch.records import plain_record
from workhold.batch.store import Store
from workhold.batch.tasks import Outcome, Task
from workhold.errors import InputError
from workhold.model.query import Query

__all__ = ["Batch", "Counting", "Work", "run_batch"]

T = TypeVar("T", Part, Job)


class Counting(Protocol):
    """Who counts along."""

    def stage(self, doing: str, count: int, seconds: float) -> None:
        """So many tasks are to be done, which will take a processor so long, as far as that can be told."""

    def one_done(self, seconds: float) -> None:
        """One of them is done, for which so many seconds were reckoned."""


@define(eq=False)
class Batch:
    """What a run knows of its jobs.

    Parameters
    ----------
    parts, jobs : all of them, in the order asked for.
    fresh, kept : how many jobs were answered now, and how many were before; equal ones count once.
    is_complete : whether it came to its end.
    """

    parts: list[Part]
    jobs: list[Job] = field(factory=list)
    fresh: int = 0
    kept: int = 0
    is_complete: bool = False


@frozen(eq=False)
class Work:
    """What a run works with.

    Parameters
    ----------
    store : where records are kept.
    queue : which has the workers.
    measured : what tasks took.
    counting : is told how far it is.
    stop : when set, the run ends soon.
    """

    store: Store
    queue: Queue
    measured: Measured
    counting: Counting
    stop: Event

    def do(
        self, doing: str, items: Sequence[T], seconds: Callable[[T], float], task_of: Callable[[T], Task]
    ) -> tuple[dict[str, Outcome], int]:
        """Do the tasks of items that are not done, longest first, each name once.

        Returns
        -------
        The outcome of each task that was done now, by its name, and how many were done before.

        Raises
        ------
        InputError
            When a record cannot be kept.
        """
        by_name: dict[str, T] = {}
        for item in items:
            by_name.setdefault(item.name, item)
        reckoned = {name: seconds(item) for name, item in by_name.items() if not self.store.has(name)}
        self.counting.stage(doing, len(reckoned), sum(reckoned.values()))
        outcomes: dict[str, Outcome] = {}

        def tasks() -> Iterator[Task]:
            for name in sorted(reckoned, key=reckoned.__getitem__, reverse=True):
                if self.store.has(name):
                    # Another run has done it meanwhile.
                    self.counting.one_done(reckoned[name])
                    continue
                try:
                    task = task_of(by_name[name])
                except InputError as error:
                    outcomes[name] = Outcome(name, None, str(error))
                    continue
                if task.name != name:
                    outcomes[name] = Outcome(name, None, "The file has changed since this run began: start it again.")
                    continue
                yield task

        for outcome in self.queue.run(tasks(), self.stop):
            if outcome.has_no_room:
                raise InputError(f"{outcome.failure} {GO_ON}")
            if not outcome.failure:
                self.keep(outcome)
            outcomes[outcome.name] = outcome
            self.counting.one_done(reckoned[outcome.name])
        return outcomes, len(by_name) - len(reckoned)

    def keep(self, outcome: Outcome) -> None:
        """Keep the record of a task, unless its worker has, and what it took.

        Raises
        ------
        InputError
            When that cannot be written.
        """
        try:
            self.measured.add(outcome)
            if outcome.record is not None:
                self.store.write(outcome.name, outcome.record)
        except InputError as error:
            raise InputError(f"{error} {GO_ON}") from error


GO_ON = "What is done is kept: make room, and start the same command again to go on."


def run_batch(requests: Iterable[Request], best: int, work: Work) -> Batch:
    """Read all parts and answer all jobs, as far as that is not done.

    Parameters
    ----------
    best : how many fixtures of each job, the best, to keep.

    Raises
    ------
    InputError
        When records cannot be kept, or there are no workers.
    """
    batch = Batch([Part.of(request) for request in requests])
    read_parts(batch, work)
    batch.jobs = [job for part in batch.parts for job in jobs_of(part, best)]
    jobs = [job for job in batch.jobs if job.name]
    if not work.stop.is_set():

        def task_of(job: Job) -> Task:
            record = work.store.read(job.part.name)
            if record is None:
                raise InputError("The record of its part is no more: start the batch again.")
            return job.answering(record, best)

        outcomes, batch.kept = work.do("Searching", jobs, lambda job: job.estimate, task_of)
        for job in jobs:
            if job.name in outcomes:
                job.failure = outcomes[job.name].failure
        batch.fresh = len(outcomes)
    batch.is_complete = not work.stop.is_set()
    return batch


def read_parts(batch: Batch, work: Work) -> None:
    """Read the parts that are not read yet, and take note of all."""
    parts = [part for part in batch.parts if part.name]

    def seconds(part: Part) -> float:
        path = part.request.listed.path
        return reading_seconds(path.suffix, path.stat().st_size if path.is_file() else 0)

    outcomes, _ = work.do("Reading", parts, seconds, lambda part: part.reading())
    for part in parts:
        record = work.store.read(part.name)
        if record is not None:
            part.take(plain_record(record))
        elif part.name in outcomes:
            part.refusal = outcomes[part.name].failure


def jobs_of(part: Part, best: int) -> Iterator[Job]:
    """The jobs of a part; those without a name have no task."""
    for held_in in part.request.held_in:
        if part.refusal or not part.content:
            yield Job(part, held_in, refusal=part.refusal)
            continue
        try:
            name = name_of(part.content, held_in.entry, best)
        except InputError as error:
            yield Job(part, held_in, refusal=str(error))
            continue
        assert isinstance(held_in.query, Query)
        yield Job(part, held_in, name, estimate=answering_seconds(part.faces, part.size, held_in.query.toolkit))
