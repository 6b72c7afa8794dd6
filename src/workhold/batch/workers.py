"""Workers on this machine: processes kept ready, each doing one task after the other.

They are started anew, not forked, and hear no Ctrl-C. They end when the pipe to them does: so none is left
behind, however this process ends (``web.worker``).
"""

from __future__ import annotations

import os
import signal
from collections import Counter, deque
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from itertools import islice
from math import inf
from multiprocessing import get_context, resource_tracker
from multiprocessing.connection import Connection, wait
from threading import Event
from time import monotonic
from typing import Any

from attrs import define, evolve, field

from workhold.batch.tasks import Outcome, Task, TaskObserver, run_task
from workhold.errors import InputError
from workhold.web.worker import discard_folders, run_tasks

__all__ = ["LocalWorkers"]

# Seconds between looks at whether to stop.
LOOK = 0.1
# A task whose worker died is tried so many times: once more by another one, then it is named.
MOST_TRIES = 2
# Workers that end before they are ready, one after the other, before all is given up.
MOST_FAILED_STARTS = 3
# Bytes of address space that a worker has at least; it takes a third of this before any work.
LEAST_MEMORY = 2 << 30
# Seconds that no task takes, where there is no limit to its time.
ENDLESS = 1e8


def compute_memory_share(workers: int) -> int:
    """Return the bytes for each of ``workers``:
    an equal share of this machine's memory, at least :data:`LEAST_MEMORY`.
    """
    try:
        whole = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, OSError, ValueError):
        whole = 0
    return max(whole // workers, LEAST_MEMORY)


def run_worker(connection: Connection, memory_bytes: int) -> None:
    """Run tasks that come through a pipe until it ends; the main function of a worker process."""
    run_tasks(connection, memory_bytes, {"task": lambda task, _: run_task(task)}, lambda: None)


@define(eq=False)
class Worker:
    """A worker process and the task that it is doing."""

    title: str
    process: Any
    connection: Connection
    is_ready: bool = False
    task: Task | None = None
    seconds: float = ENDLESS
    ends_at: float = inf

    def end(self) -> None:
        """End the process at once, close its pipe and remove its temporary folder."""
        self.process.kill()
        self.process.join()
        with suppress(OSError):
            self.connection.close()
        discard_folders(self.process.pid)


@define(eq=False)
class LocalWorkers:
    """A queue of worker processes; use it in a ``with`` block, which ends them.

    Parameters
    ----------
    count : number of processes.
    watcher : observer that is notified of events.
    memory_bytes : bytes that each process may take; None for an equal share of this machine's memory.
    seconds : seconds that a task may take; then its worker is ended and the task has failed.
    """

    count: int
    watcher: TaskObserver
    memory_bytes: int | None = None
    seconds: float = ENDLESS
    workers: list[Worker] = field(factory=list, init=False)
    failed_starts: int = field(default=0, init=False)

    def __enter__(self) -> LocalWorkers:
        return self

    def __exit__(self, *error: object) -> None:
        while self.workers:
            self.workers.pop().end()

    def run(self, tasks: Iterator[Task], stop: Event) -> Iterator[Outcome]:
        """Yield the outcomes of tasks as they come; see :class:`workhold.batch.tasks.TaskQueue`."""
        waiting: deque[Task] = deque()
        deaths = Counter[str]()
        while not stop.is_set():
            waiting.extend(islice(tasks, max(self.count - len(waiting), 0)))
            self.hand_out(waiting)
            if not any(one.task for one in self.workers) and not waiting:
                return
            for one in self.wait_for_workers():
                outcome = self.receive_outcome(one)
                if outcome is None and one.task is not None and one not in self.workers:
                    deaths[one.task.name] += 1
                    outcome = self.replace_lost_worker(one, one.task, deaths[one.task.name])
                    if outcome is None:
                        waiting.appendleft(one.task)
                if outcome is not None:
                    yield outcome
            yield from self.end_late_workers()
        # What was begun is given up; its worker could not be stopped at once.
        for one in [one for one in self.workers if one.task is not None]:
            self.remove_worker(one)

    def end_late_workers(self) -> Iterator[Outcome]:
        """End the workers whose tasks have run out of time, and yield the failures of these tasks."""
        for one in [one for one in self.workers if one.task is not None and monotonic() > one.ends_at]:
            task = one.task
            assert task is not None
            self.remove_worker(one)
            words = (
                f"This task was stopped after {one.seconds:,.0f} s, the longest time that it may take: "
                "allow more seconds, or simplify the part or the question."
            )
            self.watcher.notify(
                f"{one.title} was ended, because {task.title} took longer than {one.seconds:,.0f} s."
            )
            yield Outcome(task.name, None, words, one.seconds, one.title)

    def hand_out(self, waiting: deque[Task]) -> None:
        """Give waiting tasks to idle workers, and start workers for the rest, up to ``count``."""
        for one in self.workers:
            if waiting and one.is_ready and one.task is None:
                self.give_task(one, waiting.popleft())
        free = sum(one.task is None for one in self.workers)
        for _ in range(min(len(waiting) - free, self.count - len(self.workers))):
            self.workers.append(self.start_worker(self.find_free_title()))

    def find_free_title(self) -> str:
        """Return the first of "worker 1", "worker 2" … that is not the title of a worker."""
        taken = {one.title for one in self.workers}
        return next(
            title for title in (f"worker {k}" for k in range(1, self.count + 1)) if title not in taken
        )

    def start_worker(self, title: str) -> Worker:
        """Return a worker whose process has been started; it need not be ready yet."""
        context = get_context("spawn")
        ours, theirs = context.Pipe()
        memory = compute_memory_share(self.count) if self.memory_bytes is None else self.memory_bytes
        process = context.Process(target=run_worker, args=(theirs, memory), daemon=True)
        with block_interrupts_in_children():
            process.start()
        theirs.close()
        return Worker(title, process, ours)

    def give_task(self, one: Worker, task: Task) -> None:
        """Send a task to an idle worker and start its clock.

        That a worker is dead is noticed later, in :meth:`wait_for_workers`.
        """
        one.task, one.seconds = task, min(self.seconds, task.most_seconds)
        one.ends_at = monotonic() + one.seconds
        self.watcher.note_begun(one.title, task.title)
        with suppress(OSError):
            one.connection.send((1, "task", ENDLESS, task))

    def wait_for_workers(self) -> list[Worker]:
        """Return the workers that have sent something or ended, after at most :data:`LOOK` seconds."""
        ready = wait([one.connection for one in self.workers], LOOK)
        return [one for one in self.workers if one.connection in ready]

    def receive_outcome(self, one: Worker) -> Outcome | None:
        """Return the outcome that a worker has sent.

        Return None if the worker reports that it is ready. Return None as well, and remove the worker, if it
        has ended. Raises InputError if too many workers in a row end before they are ready.
        """
        try:
            kind, _, value = one.connection.recv()
        except Exception:
            # The end of the pipe, or half a message of a worker that was ended.
            self.remove_worker(one)
            if not one.is_ready:
                self.refuse_failed_starts(one)
            return None
        if kind == "ready":
            one.is_ready, self.failed_starts = True, 0
            return None
        task, one.task = one.task, None
        self.watcher.note_ended(one.title)
        assert task is not None
        if kind != "done":
            return Outcome(task.name, None, str(value), worker=one.title)
        outcome: Outcome = value
        return evolve(outcome, worker=one.title)

    def remove_worker(self, one: Worker) -> None:
        """End a worker and remove it."""
        self.workers.remove(one)
        one.end()
        self.watcher.note_ended(one.title)

    def refuse_failed_starts(self, one: Worker) -> None:
        """Count a worker that ended before it was ready; raise InputError when too many do so in a row."""
        self.failed_starts += 1
        if self.failed_starts >= MOST_FAILED_STARTS:
            raise InputError(
                f"worker processes cannot be started: {self.failed_starts} in a row ended {explain_worker_end(one)} "
                "before they were ready; give them more memory, or fewer of them."
            )

    def replace_lost_worker(self, one: Worker, task: Task, times: int) -> Outcome | None:
        """Notify the watcher that a worker died during a task, and return the task's failure or None.

        The failure is returned where the task has been tried before; otherwise it is tried again.
        """
        how = explain_worker_end(one)
        if times < MOST_TRIES:
            self.watcher.notify(
                f"{one.title} ended {how} while it worked on {task.title}. Another worker tries it again."
            )
            return None
        self.watcher.notify(
            f"{one.title} ended {how} while it worked on {task.title}. This is the second time."
        )
        words = (
            f"Two workers ended, the last one {how}, while they worked on this: it may need more "
            "memory than there is."
        )
        return Outcome(task.name, None, words, worker=one.title)


def explain_worker_end(one: Worker) -> str:
    """Return words on the end of a worker's process, such as "by signal 9" or "with code 1"."""
    code = one.process.exitcode
    return f"by signal {-code}" if code is not None and code < 0 else f"with code {code}"


@contextmanager
def block_interrupts_in_children() -> Iterator[None]:
    """Make processes that are started within the block never receive Ctrl-C;
    this process receives it after the block.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    # It would let Ctrl-C through again when it is started.
    resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
