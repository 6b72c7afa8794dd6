"""A batch from the first drawing to the last answer: its jobs, and how they are done.

A job is a part and what it shall be held in.

What is done is passed over, what is not is given out, longest first. Records alone say what is done.
A run that ends, in whatever way, leaves whole records, and the next one goes on.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from threading import Event
from typing import Any, Protocol, TypeVar

from attrs import define, field, frozen

from workhold.batch.durations import Measured, predict_answering_seconds, predict_reading_seconds
from workhold.batch.store import Store, parse_record
from workhold.batch.tasks import Answering, Outcome, Queue, Reading, Task, name_of
from workhold.errors import InputError
from workhold.files.part.finding import read_bytes
from workhold.files.part_list import ListedPart
from workhold.files.result.writer import make_query_entry
from workhold.model.query import Query
from workhold.model.workpiece import Workpiece

__all__ = ["ANY_PART", "Batch", "BatchRun", "Counting", "HeldIn", "Job", "Part", "Request", "run_batch"]

# Stands for any part in the queries that wait for theirs.
ANY_PART = Workpiece.from_loops("any", [[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]])


@frozen(eq=False, slots=False)
class HeldIn:
    """A toolkit, and what is asked of the fixtures in it.

    Parameters
    ----------
    name : what the toolkit is called.
    query : of :data:`ANY_PART`, whose place the part takes; or why nothing can be asked.
    """

    name: str
    query: Query | InputError

    @cached_property
    def entry(self) -> dict[str, Any]:
        """What is asked as it is written, which distinguishes it from anything else that could be.

        Raises
        ------
        InputError
            When it cannot be asked.
        """
        if isinstance(self.query, InputError):
            raise self.query
        return make_query_entry(self.query)


@frozen(eq=False)
class Request:
    """A part, and all that it shall be held in.

    Parameters
    ----------
    listed : the part.
    options : of reading it, see ``files.part.load.read_workpiece``.
    held_in : the toolkits; most parts share them.
    """

    listed: ListedPart
    options: Mapping[str, Any]
    held_in: Sequence[HeldIn]


@define(eq=False)
class Part:
    """A part as far as it is known.

    Parameters
    ----------
    request : what is asked of it.
    name : of the task that reads it; empty where its file cannot be opened.
    refusal : why it cannot be read; empty where it can.
    content : hash of what was read; empty before.
    faces, size : how many faces it has, and its width and height in mm.
    remarks : what to say about the drawing.
    """

    request: Request
    name: str = ""
    refusal: str = ""
    content: str = ""
    faces: int = 0
    size: tuple[float, float] = (0.0, 0.0)
    remarks: tuple[str, ...] = ()

    @classmethod
    def from_request(cls, request: Request) -> Part:
        try:
            return cls(request, make_reading(request).name)
        except InputError as error:
            return cls(request, refusal=str(error))

    def take(self, record: Mapping[str, Any]) -> None:
        self.refusal = record["refusal"]
        if not self.refusal:
            # What may be touched makes outlines of one shape two parts; a prism is its shape alone.
            solid = [record["solid"], record["bands"]] if record.get("solid") else []
            self.content = name_of(record["loops"], record["departure"], *solid)
            self.faces, self.remarks = record["faces"], tuple(record["remarks"])
            width, height = record["size"]
            self.size = (width, height)


def make_reading(request: Request) -> Reading:
    path = request.listed.path
    content = read_bytes(path)
    ending = Path(path).suffix.lower()
    name = name_of(content, ending, dict(request.options))
    return Reading(name, request.listed.name, ending, content, request.options)


@define(eq=False)
class Job:
    """A part with something it shall be held in.

    Parameters
    ----------
    part, held_in : these.
    name : of its task; empty where there is none.
    refusal : why there is none: the part cannot be read, or this cannot be asked; empty otherwise.
    estimate : predicted seconds of its task.
    failure : why its task has failed, though it might not do so again; empty otherwise.
    """

    part: Part
    held_in: HeldIn
    name: str = ""
    refusal: str = ""
    estimate: float = 0.0
    failure: str = field(default="", init=False)

    @property
    def title(self) -> str:
        """What it is called where people see it."""
        return f"{self.part.request.listed.name} in {self.held_in.name}"

    def make_answering(self, record: bytes, best: int) -> Answering:
        assert isinstance(self.held_in.query, Query)
        return Answering(self.name, self.title, record, self.held_in.query, best)


T = TypeVar("T", Part, Job)


class Counting(Protocol):
    """Who counts along."""

    def begin_stage(self, doing: str, count: int, seconds: float) -> None:
        """Begin a stage of ``count`` tasks, which are predicted to take ``seconds`` of one processor."""

    def count_done(self, seconds: float) -> None:
        """Count one of these tasks as done, which was predicted to take ``seconds``."""


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
class BatchRun:
    """What a run works with.

    Parameters
    ----------
    store : where records are kept.
    queue : which has the workers.
    measured : what tasks took.
    counting : is notified of progress.
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

        Returns the outcome of each task that was done now, by its name, and how many were done before.
        Refuses to go on when a record cannot be kept.
        """
        by_name: dict[str, T] = {}
        for item in items:
            by_name.setdefault(item.name, item)
        reckoned = {name: seconds(item) for name, item in by_name.items() if not self.store.has(name)}
        self.counting.begin_stage(doing, len(reckoned), sum(reckoned.values()))
        outcomes: dict[str, Outcome] = {}

        def tasks() -> Iterator[Task]:
            for name in sorted(reckoned, key=reckoned.__getitem__, reverse=True):
                if self.store.has(name):
                    # Another run has done it meanwhile.
                    self.counting.count_done(reckoned[name])
                    continue
                try:
                    task = task_of(by_name[name])
                except InputError as error:
                    outcomes[name] = Outcome(name, None, str(error))
                    continue
                if task.name != name:
                    outcomes[name] = Outcome(
                        name, None, "The file has changed since this run began: start it again."
                    )
                    continue
                yield task

        for outcome in self.queue.run(tasks(), self.stop):
            if outcome.has_no_room:
                raise InputError(f"{outcome.failure} {GO_ON}")
            if not outcome.failure:
                self.keep(outcome)
            outcomes[outcome.name] = outcome
            self.counting.count_done(reckoned[outcome.name])
        return outcomes, len(by_name) - len(reckoned)

    def keep(self, outcome: Outcome) -> None:
        """Keep the record of a task, unless its worker has, and what it took."""
        try:
            self.measured.add(outcome)
            if outcome.record is not None:
                self.store.write(outcome.name, outcome.record)
        except InputError as error:
            raise InputError(f"{error} {GO_ON}") from error


GO_ON = "The answers so far are kept: make room, and start the same command again to go on."


def run_batch(requests: Iterable[Request], best: int, work: BatchRun) -> Batch:
    """Read all parts and answer all jobs, as far as that is not done.

    Parameters
    ----------
    best : how many fixtures of each job, the best, to keep.

    Raises
    ------
    InputError
        When records cannot be kept, or there are no workers.
    """
    batch = Batch([Part.from_request(request) for request in requests])
    read_parts(batch, work)
    batch.jobs = [job for part in batch.parts for job in list_jobs(part, best)]
    jobs = [job for job in batch.jobs if job.name]
    if not work.stop.is_set():

        def task_of(job: Job) -> Task:
            record = work.store.read(job.part.name)
            if record is None:
                raise InputError("The record of its part is gone: start the batch again.")
            return job.make_answering(record, best)

        outcomes, batch.kept = work.do("Searching", jobs, lambda job: job.estimate, task_of)
        for job in jobs:
            if job.name in outcomes:
                job.failure = outcomes[job.name].failure
        batch.fresh = sum(not outcome.failure for outcome in outcomes.values())
    batch.is_complete = not work.stop.is_set()
    return batch


def read_parts(batch: Batch, work: BatchRun) -> None:
    """Read the parts that are not read yet, and take note of all."""
    parts = [part for part in batch.parts if part.name]

    def seconds(part: Part) -> float:
        path = part.request.listed.path
        return predict_reading_seconds(path.suffix, path.stat().st_size if path.is_file() else 0)

    outcomes, _ = work.do("Reading", parts, seconds, lambda part: make_reading(part.request))
    for part in parts:
        record = work.store.read(part.name)
        if record is not None:
            part.take(parse_record(record))
        elif part.name in outcomes:
            part.refusal = outcomes[part.name].failure


def list_jobs(part: Part, best: int) -> Iterator[Job]:
    """Yield the jobs of a part; those without a name have no task."""
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
        yield Job(
            part,
            held_in,
            name,
            estimate=predict_answering_seconds(part.faces, part.size, held_in.query.toolkit),
        )
