"""A queue in this process, tasks that fail in chosen ways, and what looks on; importable by worker processes too."""

from __future__ import annotations

import os
import signal
import tempfile
from collections.abc import Iterator
from pathlib import Path
from threading import Event

from attrs import define, field, frozen

from workhold import Query, Vise
from workhold.batch.durations import TaskDurations
from workhold.batch.report import Report, Summary, write_results
from workhold.batch.run import ANY_PART, BatchRunner, BatchState, PartRequest, ToolkitQuery, run_batch
from workhold.batch.store import FolderStore, RecordStore, make_refusal_record
from workhold.batch.tables import JobRow, list_job_rows
from workhold.batch.tasks import Outcome, Task, run_task
from workhold.errors import InputError
from workhold.files.part_list import list_parts

COARSE = ToolkitQuery("coarse", Query(ANY_PART, Vise(pitch=16, columns=1, peg_radius=3)))
FINE = ToolkitQuery("fine", Query(ANY_PART, Vise(pitch=12, columns=1, peg_radius=3)))
IMPOSSIBLE = ToolkitQuery("impossible", InputError("there is no such vise."))


@define
class Onlooker:
    """Counts along and remembers what it was told."""

    stages: list[tuple[str, int]] = field(factory=list)
    done: int = 0
    sentences: list[str] = field(factory=list)

    def begin_stage(self, doing: str, count: int, seconds: float) -> None:
        self.stages.append((doing, count))

    def count_done(self, seconds: float) -> None:
        self.done += 1

    def note_begun(self, worker: str, title: str) -> None:
        pass

    def note_ended(self, worker: str) -> None:
        pass

    def notify(self, sentence: str) -> None:
        self.sentences.append(sentence)


@define
class InlineQueue:
    """Does tasks in this process, until it has done so many; remembers their titles."""

    most: int | None = None
    titles: list[str] = field(factory=list)

    def run(self, tasks: Iterator[Task], stop: Event) -> Iterator[Outcome]:
        for task in tasks:
            if self.most is not None and len(self.titles) >= self.most:
                stop.set()
                return
            self.titles.append(task.title)
            yield self.outcome(task)

    def outcome(self, task: Task) -> Outcome:
        return run_task(task, "inline")


def run_in(
    folder: Path,
    *given: object,
    queue: InlineQueue,
    held_in: tuple[ToolkitQuery, ...] = (COARSE,),
    best: int = 3,
    store: RecordStore | None = None,
) -> BatchState:
    """Run a batch of parts into a folder."""
    requests = [PartRequest(part, {}, held_in) for part in list_parts([str(one) for one in given])]
    store = FolderStore(folder / "work") if store is None else store
    measured = TaskDurations(folder / "measured.csv")
    return run_batch(requests, best, BatchRunner(store, queue, measured, Onlooker(), Event()))


def rows_of(batch: BatchState, folder: Path) -> Iterator[JobRow]:
    """What is known of each job of a batch that was run into a folder."""
    return list_job_rows(batch.jobs, FolderStore(folder / "work"), TaskDurations(folder / "measured.csv"))


def reported(
    batch: BatchState,
    folder: Path,
    out: Path,
    *,
    summary: tuple[str, list[str], list[str]] = ("x", [], []),
    sheets: Path | None = None,
    store: RecordStore | None = None,
) -> Report:
    """The page ``r.html``, the tables and the sheets of a batch that was run into a folder."""
    store = FolderStore(folder / "work") if store is None else store
    measured = TaskDurations(folder / "measured.csv")
    return write_results(batch, store, measured, out, "r.html", Summary(*summary), sheets)


def records_in(folder: Path) -> dict[str, bytes]:
    """All records of a folder, by their paths."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("work/*/*.json"))
    }


@frozen
class Fatal(Task):
    """Ends its own process, as often as it is told to."""

    folder: Path
    times: int

    def prepare(self) -> None:
        pass

    def make_record(self) -> bytes:
        for time in range(self.times):
            try:
                (self.folder / f"{self.name}-{time}").touch(exist_ok=False)
            except FileExistsError:
                continue
            os.kill(os.getpid(), signal.SIGKILL)
        return make_refusal_record(f"{self.name} was done.")


@frozen
class Hanging(Task):
    """Writes a file for a time, and never ends."""

    def prepare(self) -> None:
        pass

    def make_record(self) -> bytes:
        with tempfile.TemporaryDirectory(prefix="workhold-") as folder:
            (Path(folder) / "scratch").write_bytes(b"much")
            Event().wait()
        return b""


@frozen
class Failing(Task):
    """Raises an error."""

    error: Exception

    def prepare(self) -> None:
        pass

    def make_record(self) -> bytes:
        raise self.error


@frozen
class Unprepared(Failing):
    """Lacks something that it needs."""

    def prepare(self) -> None:
        raise self.error


def ends_at_once(connection: object, memory_bytes: int) -> None:
    """The main function of a worker that ends before it is ready."""
    os._exit(3)
