"""A batch from the first drawing to the last answer: its jobs, and their execution.

A job is a part and a toolkit to hold it in. Jobs that have a record are skipped; the others are handed to
workers, longest first. Records are complete however a run ends, so that the next run can continue.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from threading import Event
from typing import Any, Protocol, TypeVar

from attrs import define, field, frozen

from workhold.batch.durations import TaskDurations, predict_answering_seconds, predict_reading_seconds
from workhold.batch.store import RecordStore, parse_record
from workhold.batch.tasks import DrawingTask, Outcome, QueryTask, Task, TaskQueue, make_task_name
from workhold.errors import InputError
from workhold.files.part.finding import read_bytes
from workhold.files.part_list import ListedPart
from workhold.files.result.writer import make_query_entry
from workhold.model.query import Query
from workhold.model.workpiece import Workpiece

__all__ = [
    "ANY_PART",
    "BatchState",
    "BatchRunner",
    "ProgressCounter",
    "ToolkitQuery",
    "BatchJob",
    "BatchPart",
    "PartRequest",
    "run_batch",
]

# Stands for any part in the queries that wait for theirs.
ANY_PART = Workpiece.from_loops("any", [[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]])


@frozen(eq=False, slots=False)
class ToolkitQuery:
    """A toolkit, and the query for fixtures in it.

    Parameters
    ----------
    name : name of the toolkit.
    query : query for :data:`ANY_PART`, a placeholder that each part replaces; or the error that says why
        there is no query.
    """

    name: str
    query: Query | InputError

    @cached_property
    def entry(self) -> dict[str, Any]:
        """The query as plain data of a result file, which distinguishes it from any other query.

        Raises
        ------
        InputError
            When the query is an error, which then is raised.
        """
        if isinstance(self.query, InputError):
            raise self.query
        return make_query_entry(self.query)


@frozen(eq=False)
class PartRequest:
    """A part, and the toolkits to hold it in.

    Parameters
    ----------
    listed : the part as listed by the user.
    options : options of reading it, see ``files.part.load.read_workpiece``.
    held_in : toolkits with their queries; many parts share one tuple.
    """

    listed: ListedPart
    options: Mapping[str, Any]
    held_in: Sequence[ToolkitQuery]


@define(eq=False)
class BatchPart:
    """A part as far as it is known.

    Parameters
    ----------
    request : the request for this part.
    name : name of the task that reads it; empty where its file cannot be opened.
    refusal : why it cannot be read; empty where it can.
    content : hash of the part as read; empty before it is read.
    faces, size : number of its faces, and its width and height in mm.
    remarks : remarks on the drawing.
    """

    request: PartRequest
    name: str = ""
    refusal: str = ""
    content: str = ""
    faces: int = 0
    size: tuple[float, float] = (0.0, 0.0)
    remarks: tuple[str, ...] = ()

    @classmethod
    def from_request(cls, request: PartRequest) -> BatchPart:
        """Return the part of a request before it is read, with the name of the task that reads it.

        Where its file cannot be opened, the part has a refusal instead.
        """
        try:
            return cls(request, make_reading(request).name)
        except InputError as error:
            return cls(request, refusal=str(error))

    def apply_record(self, record: Mapping[str, Any]) -> None:
        """Copy content, faces, size and remarks, or the refusal, from the record of the part's drawing."""
        self.refusal = record["refusal"]
        if not self.refusal:
            # What may be touched makes outlines of one shape two parts; a prism is its shape alone.
            solid = [record["solid"], record["bands"]] if record.get("solid") else []
            self.content = make_task_name(record["loops"], record["departure"], *solid)
            self.faces, self.remarks = record["faces"], tuple(record["remarks"])
            width, height = record["size"]
            self.size = (width, height)


def make_reading(request: PartRequest) -> DrawingTask:
    """Return the task that reads the file of a request; raise InputError where the file cannot be opened."""
    path = request.listed.path
    content = read_bytes(path)
    ending = Path(path).suffix.lower()
    name = make_task_name(content, ending, dict(request.options))
    return DrawingTask(name, request.listed.name, ending, content, request.options)


@define(eq=False)
class BatchJob:
    """A part together with a toolkit to hold it in.

    Parameters
    ----------
    part, held_in : the part, and the toolkit with its query.
    name : name of the job's task; empty where there is none.
    refusal : reason why there is no task: the part cannot be read, or the query is invalid; empty otherwise.
    estimate : predicted seconds of its task.
    failure : reason of a failure that may not occur again; empty otherwise.
    """

    part: BatchPart
    held_in: ToolkitQuery
    name: str = ""
    refusal: str = ""
    estimate: float = 0.0
    failure: str = field(default="", init=False)

    @property
    def title(self) -> str:
        """Name of the job for people: part and toolkit."""
        return f"{self.part.request.listed.name} in {self.held_in.name}"

    def make_answering(self, record: bytes, best: int) -> QueryTask:
        """Return the task that answers the job.

        ``record`` is the record of the part's drawing, ``best`` the number of fixtures to keep.
        """
        assert isinstance(self.held_in.query, Query)
        return QueryTask(self.name, self.title, record, self.held_in.query, best)


T = TypeVar("T", BatchPart, BatchJob)


class ProgressCounter(Protocol):
    """An observer that counts tasks."""

    def begin_stage(self, doing: str, count: int, seconds: float) -> None:
        """Begin a stage of ``count`` tasks that are predicted to take ``seconds`` of one processor in all."""

    def count_done(self, seconds: float) -> None:
        """Count a task of the stage as done; it was predicted to take ``seconds``."""


@define(eq=False)
class BatchState:
    """Parts and jobs of a run, with their outcomes so far.

    Parameters
    ----------
    parts, jobs : all of them, in the order asked for.
    fresh, kept : numbers of jobs answered now, and of jobs answered by earlier runs; jobs with the same task
        count once.
    is_complete : whether the run came to its end.
    """

    parts: list[BatchPart]
    jobs: list[BatchJob] = field(factory=list)
    fresh: int = 0
    kept: int = 0
    is_complete: bool = False


@frozen(eq=False)
class BatchRunner:
    """Store, queue, durations and observer that a run works with.

    Parameters
    ----------
    store : store that keeps the records.
    queue : queue that runs tasks on workers.
    measured : durations of tasks.
    counting : observer that is notified of progress.
    stop : when set, the run ends soon.
    """

    store: RecordStore
    queue: TaskQueue
    measured: TaskDurations
    counting: ProgressCounter
    stop: Event

    def run_missing_tasks(
        self, doing: str, items: Sequence[T], seconds: Callable[[T], float], task_of: Callable[[T], Task]
    ) -> tuple[dict[str, Outcome], int]:
        """Run the tasks of those items that have no record, longest first; items with the same name share one
        task.

        Return (outcomes by name of the task, number of tasks that had a record before). Raises InputError
        when a record cannot be kept.

        Parameters
        ----------
        doing : words for the stage.
        items : parts or jobs, each with the name of its task.
        seconds : predicts how long the task of an item takes.
        task_of : makes the task of an item; an InputError becomes its outcome.
        """
        by_name: dict[str, T] = {}
        for item in items:
            by_name.setdefault(item.name, item)
        reckoned = {name: seconds(item) for name, item in by_name.items() if not self.store.has(name)}
        self.counting.begin_stage(doing, len(reckoned), sum(reckoned.values()))
        outcomes: dict[str, Outcome] = {}

        def yield_tasks() -> Iterator[Task]:
            """Yield the tasks, longest first, skipping those that another run has done meanwhile."""
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

        for outcome in self.queue.run(yield_tasks(), self.stop):
            if outcome.has_no_room:
                raise InputError(f"{outcome.failure} {GO_ON}")
            if not outcome.failure:
                self.keep_outcome(outcome)
            outcomes[outcome.name] = outcome
            self.counting.count_done(reckoned[outcome.name])
        return outcomes, len(by_name) - len(reckoned)

    def keep_outcome(self, outcome: Outcome) -> None:
        """Keep the duration of a task, and its record unless the worker has kept it already.

        Raises InputError if the disk is full.
        """
        try:
            self.measured.add(outcome)
            if outcome.record is not None:
                self.store.write(outcome.name, outcome.record)
        except InputError as error:
            raise InputError(f"{error} {GO_ON}") from error


GO_ON = "The answers so far are kept: make room, and start the same command again to go on."


def run_batch(requests: Iterable[PartRequest], best: int, work: BatchRunner) -> BatchState:
    """Return the state of a batch after reading all parts and answering all jobs without a record.

    The state is incomplete where ``work.stop`` was set.

    Parameters
    ----------
    best : number of fixtures to keep for each job, the best ones.

    Raises
    ------
    InputError
        When records cannot be kept, or there are no workers.
    """
    batch = BatchState([BatchPart.from_request(request) for request in requests])
    read_parts(batch, work)
    batch.jobs = [job for part in batch.parts for job in list_jobs(part, best)]
    jobs = [job for job in batch.jobs if job.name]
    if not work.stop.is_set():

        def make_task(job: BatchJob) -> Task:
            """Return the task of a job; raise InputError where the record of its part is gone."""
            record = work.store.read(job.part.name)
            if record is None:
                raise InputError("The record of its part is gone: start the batch again.")
            return job.make_answering(record, best)

        outcomes, batch.kept = work.run_missing_tasks("Searching", jobs, lambda job: job.estimate, make_task)
        for job in jobs:
            if job.name in outcomes:
                job.failure = outcomes[job.name].failure
        batch.fresh = sum(not outcome.failure for outcome in outcomes.values())
    batch.is_complete = not work.stop.is_set()
    return batch


def read_parts(batch: BatchState, work: BatchRunner) -> None:
    """Read the parts that have no record yet, and fill in all parts from their records."""
    parts = [part for part in batch.parts if part.name]

    def predict_seconds(part: BatchPart) -> float:
        """Return the predicted seconds to read a part."""
        path = part.request.listed.path
        return predict_reading_seconds(path.suffix, path.stat().st_size if path.is_file() else 0)

    outcomes, _ = work.run_missing_tasks(
        "Reading", parts, predict_seconds, lambda part: make_reading(part.request)
    )
    for part in parts:
        record = work.store.read(part.name)
        if record is not None:
            part.apply_record(parse_record(record))
        elif part.name in outcomes:
            part.refusal = outcomes[part.name].failure


def list_jobs(part: BatchPart, best: int) -> Iterator[BatchJob]:
    """Yield a job for each toolkit of a part.

    A job with an invalid query, or with a part that cannot be read, has a refusal and no name.
    """
    for held_in in part.request.held_in:
        if part.refusal or not part.content:
            yield BatchJob(part, held_in, refusal=part.refusal)
            continue
        try:
            name = make_task_name(part.content, held_in.entry, best)
        except InputError as error:
            yield BatchJob(part, held_in, refusal=str(error))
            continue
        assert isinstance(held_in.query, Query)
        yield BatchJob(
            part,
            held_in,
            name,
            estimate=predict_answering_seconds(part.faces, part.size, held_in.query.toolkit, held_in.query),
        )
