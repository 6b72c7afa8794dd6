"""Tasks for workers, their names and outcomes, and the interface of a queue of workers.

A worker turns a task into its record, and needs only the task and this program. The bytes of a record depend
only on the task; durations are kept elsewhere. A name is the hash of everything that determines a record:
version, number of answers (``version.ANSWERS``), forms of records, conventions, part, toolkit and query. So
the same work has the same name on every machine. A queue takes tasks, gives them to workers, and yields their
outcomes.
"""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from hashlib import sha256
from math import inf
from pathlib import Path
from threading import Event
from time import perf_counter
from typing import Any, Protocol

import numpy as np
from attrs import define, evolve, field, frozen

from workhold import conventions
from workhold.batch.store import (
    PART,
    REFUSAL,
    make_part_record,
    make_refusal_record,
    parse_record,
    read_workpiece_record,
)
from workhold.errors import NO_ROOM, InputError, WorkholdError, lacks_memory
from workhold.files.budget import LIMITS
from workhold.files.result.writer import FORMAT
from workhold.model.fixture_table import FixtureTable
from workhold.model.query import Query
from workhold.model.result import Result
from workhold.version import ANSWERS, __version__

__all__ = [
    "QueryTask",
    "Outcome",
    "TaskQueue",
    "DrawingTask",
    "Task",
    "TaskObserver",
    "run_task",
    "make_task_name",
    "identify_program",
]

# The clock's seconds for each of the processor's on a machine that others use too.
MOST_BUSY = 10.0
# Letters of a name: 128 bits, so that no two of any number of tasks share one.
LETTERS = 32


@cache
def identify_program() -> str:
    """Return the program's version and a hash of everything in it that decides outcomes; equal on every
    machine.
    """
    numbers = sorted((name, value) for name, value in vars(conventions).items() if name.isupper())
    content = repr((ANSWERS, FORMAT, PART, REFUSAL, numbers))
    return f"{__version__} {sha256(content.encode()).hexdigest()[:LETTERS]}"


def make_task_name(*content: Any) -> str:
    """Return the name of a task: 32 hexadecimal digits of a hash of this program and ``content``.

    ``content`` are bytes and plain data; their order counts.

    >>> make_task_name(b"part", {"best": 3}) == make_task_name(b"part", {"best": 3}), len(make_task_name())
    (True, 32)
    """
    digest = sha256(identify_program().encode())
    for item in content:
        data = item if isinstance(item, bytes) else json.dumps(item, sort_keys=True).encode()
        # Its length in front, so that what belongs to one item cannot be taken for the next.
        digest.update(f"{len(data)}:".encode() + data)
    return digest.hexdigest()[:LETTERS]


@frozen
class Task:
    """A piece of work.

    Parameters
    ----------
    name : hash of all that decides the record, see ``batch.tasks``.
    title : name of the task for people.
    program : identity of the sender's program; a worker with another one would give other outcomes.
    """

    name: str
    title: str
    program: str = field(factory=identify_program, kw_only=True)

    @property
    def most_seconds(self) -> float:
        """Time limit of the task in seconds; inf without a limit."""
        return inf

    def prepare(self) -> None:
        """Import the libraries that the work needs.

        Raises
        ------
        InputError
            When this machine lacks a library or anything else that the work needs.
        """
        raise NotImplementedError

    def make_record(self) -> bytes:
        """Return the record of the work; raise InputError if the part cannot be read or the query is invalid."""
        raise NotImplementedError


@frozen
class DrawingTask(Task):
    """A task that reads a drawing.

    Parameters
    ----------
    ending : ending of the file's name, which tells the format.
    content : content of the file.
    options : keyword arguments of ``files.part.load.read_workpiece``.
    """

    ending: str
    content: bytes = field(repr=False)
    options: Mapping[str, Any]

    @property
    def most_seconds(self) -> float:
        """Ten times the processor time after which readers give up the file,
        which allows for a busy machine.
        """
        return MOST_BUSY * max(one.allow_seconds_for(len(self.content)) or 0.0 for one in LIMITS.values())

    def prepare(self) -> None:
        """Import the readers' kernels."""
        import workhold.geometry.loop
        import workhold.kernels.base.distance  # noqa: F401

    def make_record(self) -> bytes:
        """Return the record of the part; raise InputError where it cannot be read."""
        from workhold.files.part_list import ListedPart, read_listed

        with tempfile.TemporaryDirectory(prefix="workhold-") as folder:
            path = Path(folder) / f"part{self.ending}"
            path.write_bytes(self.content)
            read = read_listed(ListedPart("part", path), **self.options)
        if read.loaded is None:
            # Its user knows the file by another name.
            raise InputError(read.refusal.removeprefix(f"{path.name}: "))
        return make_part_record(read.loaded.workpiece, read.loaded.remarks)


@frozen
class QueryTask(Task):
    """A task that finds the fixtures of a part in a toolkit.

    Parameters
    ----------
    part : record of the part's drawing.
    query : the query, for a placeholder part that this part replaces.
    best : number of best fixtures to keep; all fixtures are counted or, if very many, estimated.
    """

    part: bytes = field(repr=False)
    query: Query
    best: int

    def prepare(self) -> None:
        """Import the search."""
        import workhold.search.design  # noqa: F401

    def make_record(self) -> bytes:
        """Return the result file with the best fixtures; raise InputError for an invalid query."""
        from workhold.files.result.writer import write_result_text
        from workhold.model.notes import Many
        from workhold.search.design import answer
        from workhold.search.estimate import MANY, estimate_fixtures

        query = evolve(self.query, workpiece=read_workpiece_record(parse_record(self.part)))
        count = estimate_fixtures(query, threads=1)
        if count is not None and count > MANY:
            result = answer(evolve(query, best=self.best), threads=1)
            made = evolve(result, notes=(Many(count, len(result)), *result.notes))
            return "".join(write_result_text(made)).encode()
        with tempfile.TemporaryDirectory(prefix="workhold-") as folder:
            kept = FirstFixtures(self.best, Path(folder))
            result = answer(query, threads=1, sink=kept)
        table = FixtureTable.make_empty(query.toolkit) if kept.table is None else kept.table
        made = evolve(kept.result or result, query=evolve(query, best=self.best), table=table)
        return "".join(write_result_text(made)).encode()


@define(eq=False)
class FirstFixtures:
    """A receiver of fixtures in blocks that keeps only the first few, to save memory.

    Parameters
    ----------
    most : number of fixtures to keep.
    folder : folder with room for sorting.
    table : the fixtures kept.
    result : the result that they belong to, with their seating if it is known.
    """

    most: int
    folder: Path
    table: FixtureTable | None = None
    result: Result | None = None

    def receive(self, result: Result, listed: int, tables: Iterable[FixtureTable]) -> None:
        """Keep the first ``most`` fixtures of an answer,
        whose ``tables`` come best first; ``listed`` is not used.
        """
        self.result = evolve(result, seating=result.seating[: self.most])
        for table in tables:
            first = table.take(np.arange(min(self.most - self.count, len(table))))
            self.table = first if self.table is None else FixtureTable.concatenate([self.table, first])
            if self.count == self.most:
                return

    @property
    def count(self) -> int:
        """Number of fixtures kept."""
        return 0 if self.table is None else len(self.table)


@frozen
class Outcome:
    """Outcome of a task.

    Parameters
    ----------
    name : name of the task.
    record : record to keep; None if the task failed in a way that may not occur again, or if the worker has
        already written the record to the store.
    failure : a sentence that says why there is no record; empty otherwise.
    seconds : seconds that the work took.
    worker : name of the worker.
    has_no_room : whether it failed because a disk is full, so that other tasks will fail too.
    """

    name: str
    record: bytes | None = field(repr=False)
    failure: str = ""
    seconds: float = 0.0
    worker: str = ""
    has_no_room: bool = False


def run_task(task: Task, worker: str = "") -> Outcome:
    """Run a task in this process and return its outcome.

    Errors are not raised: they become a refusal's record or a failure.
    """
    start = perf_counter()
    record, failure, has_no_room = None, "", False
    try:
        prepare_process(task)
        record = task.make_record()
    except InputError as error:
        record = make_refusal_record(str(error))
    except UnfitWorkerError as error:
        failure = str(error)
    except Exception as error:
        if lacks_memory(error):
            failure = (
                "This task needs more memory than its worker may take: use fewer workers, or a larger "
                "machine."
            )
        elif isinstance(error, OSError):
            failure = (
                f"The operating system refused something that this task needs: {error.strerror or error}."
            )
            has_no_room = error.errno in NO_ROOM
        else:
            failure = (
                f"workhold has a fault ({type(error).__name__}: {error}), which is not your mistake; "
                "please report it."
            )
    return Outcome(task.name, record, failure, perf_counter() - start, worker, has_no_room)


class UnfitWorkerError(WorkholdError):
    """A worker cannot do a task that others can."""


def prepare_process(task: Task) -> None:
    """Prepare this process for a task.

    Raises UnfitWorkerError where this process runs another program than the sender, or lacks something.
    """
    if task.program != identify_program():
        raise UnfitWorkerError(
            f"The worker has another version of workhold than the command ({identify_program()} and "
            f"{task.program}): install the same version on both."
        )
    try:
        task.prepare()
    except InputError as error:
        raise UnfitWorkerError(str(error)) from error


class TaskObserver(Protocol):
    """An observer of workers."""

    def note_begun(self, worker: str, title: str) -> None:
        """Note that a worker has begun a task with this title."""

    def note_ended(self, worker: str) -> None:
        """Note that a worker is idle or has ended."""

    def notify(self, sentence: str) -> None:
        """Pass on a sentence about an event, such as the death of a worker."""


class TaskQueue(Protocol):
    """A queue that gives tasks to workers."""

    def run(self, tasks: Iterator[Task], stop: Event) -> Iterator[Outcome]:
        """Yield the outcomes of tasks as they come;
        tasks are taken in their order when a worker is free for them.

        Parameters
        ----------
        stop : when set, no further task is taken, those begun are given up, and the outcomes end.

        Raises
        ------
        InputError
            When there are no workers and none can be started.
        """
