"""Tasks: what a worker does, under which name, and what a queue of workers is.

A task comes in, its record goes out.

A worker needs nothing but the task and this program. Outcomes depend on nothing but the task, to the byte;
only what they took is kept beside them. A name is the hash of what decides an outcome: version, number of
answers (``version.ANSWERS``), forms of records, conventions, part, toolkit and what is asked. So the same
work has the same name wherever it is done. A queue takes tasks, gives them to workers, and hands over
what came of them.
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
    """Return the version of the program and a hash of all in it that decides outcomes;
    equal on every machine.
    """
    numbers = sorted((name, value) for name, value in vars(conventions).items() if name.isupper())
    content = repr((ANSWERS, FORMAT, PART, REFUSAL, numbers))
    return f"{__version__} {sha256(content.encode()).hexdigest()[:LETTERS]}"


def make_task_name(*content: Any) -> str:
    """Return the name of a task:
    a hash of this program and of bytes and plain data, in order, as 32 hexadecimal digits.

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
    name : see ``batch.tasks``.
    title : what it is called where people see it.
    program : of the sender; a worker with another one would give other outcomes.
    """

    name: str
    title: str
    program: str = field(factory=identify_program, kw_only=True)

    @property
    def most_seconds(self) -> float:
        """Seconds within which the task is done or never will be; inf without such a limit."""
        return inf

    def prepare(self) -> None:
        """Import what the work needs.

        Raises
        ------
        InputError
            When this machine lacks a library or anything else that the work needs.
        """
        raise NotImplementedError

    def make_record(self) -> bytes:
        """Return the record of the work; raise InputError for what cannot be read or asked."""
        raise NotImplementedError


@frozen
class DrawingTask(Task):
    """Reads a drawing.

    Parameters
    ----------
    ending : of its file's name, which shows what it is.
    content : of the file.
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
    """Finds the fixtures of a part in a toolkit.

    Parameters
    ----------
    part : the record of its drawing.
    query : what is asked, of another part whose place it takes.
    best : how many of the fixtures, the best, to keep; all are counted, or where they are very many, estimated.
    """

    part: bytes = field(repr=False)
    query: Query
    best: int

    def prepare(self) -> None:
        """Import the search."""
        import workhold.search.design  # noqa: F401

    def make_record(self) -> bytes:
        """Return the result file with the best fixtures; raise InputError for what cannot be asked."""
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
    """Takes the fixtures of an answer in blocks, and keeps the first few, to save memory.

    Parameters
    ----------
    most : how many to keep.
    folder : where there is room for what is being sorted.
    table : those kept.
    result : that they are of, with their seating, where it is known.
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
    name : of the task.
    record : to keep; None where there is none, because the task failed in a way that may not come again, or
        because the worker has put it where it belongs.
    failure : why there is none, in a sentence; empty otherwise.
    seconds : that the work took.
    worker : who did it.
    has_no_room : whether it failed for want of room on a disk, as others will.
    """

    name: str
    record: bytes | None = field(repr=False)
    failure: str = ""
    seconds: float = 0.0
    worker: str = ""
    has_no_room: bool = False


def run_task(task: Task, worker: str = "") -> Outcome:
    """Return the outcome of a task that is done here;
    errors become a refusal's record or a failure, and are not raised.
    """
    start = perf_counter()
    record, failure, has_no_room = None, "", False
    try:
        make_ready(task)
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


def make_ready(task: Task) -> None:
    """Prepare this process for a task;
    raise UnfitWorkerError where its program is another one or lacks something.
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
        """Note that a worker has nothing to do, or has ended."""

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
