"""Worker processes that are kept ready, and the tasks that wait for them.

Glossary
--------
task : a job for a worker: a function's name, its argument, and a time limit.
client : the address that asks for a task; clients take turns, and none gets all the workers.
slot : a place for one worker; a worker that dies is replaced in its slot.
"""

from __future__ import annotations

import asyncio
import signal
import threading
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from itertools import count
from multiprocessing import get_context
from multiprocessing.connection import Connection
from typing import Any

from attrs import define, field

from workhold.errors import InputError, WorkholdError
from workhold.web.tasks import run_worker
from workhold.web.worker import CANCEL, discard_folders

__all__ = ["BusyError", "FailedError", "WorkerPool", "PoolTask", "StoppedError"]

# Seconds before the worker of a task is ended: after its user asked it to stop, and after it ran out of time.
STOP_GRACE = 2.0
TIME_GRACE = 10.0
# Workers that end before they are ready, one after the other, before waiting tasks are given up; and the
# pause between.
MOST_FAILED_STARTS = 3
START_PAUSE = 1.0
# Clients whose last turn is remembered.
MOST_TURNS = 4096

Message = tuple[str, int, Any]


class BusyError(WorkholdError):
    """A task that was refused because too many wait already."""


class FailedError(WorkholdError):
    """A task that failed; the message is a sentence for the user."""


class StoppedError(WorkholdError):
    """A task that was asked to stop and has no outcome."""


@define(eq=False)
class PoolTask:
    """A task for a worker.

    Parameters
    ----------
    name : name of the task in ``web.tasks.TASKS``.
    payload : argument of the task; must be picklable.
    seconds : time limit once it has begun.
    client : address of the client who asked for it.
    stops_well : whether the task, when asked to stop, returns its findings so far; if not, its worker is
        ended at once.
    report : called with each value that the worker sends before the task is done.
    begun : called when a worker begins with the task.
    """

    name: str
    payload: Any
    seconds: float
    client: str = ""
    stops_well: bool = False
    report: Callable[[Any], None] | None = None
    begun: Callable[[], None] | None = None
    stop: asyncio.Event = field(factory=asyncio.Event, init=False)
    outcome: asyncio.Future[Any] = field(init=False)

    def __attrs_post_init__(self) -> None:
        self.outcome = asyncio.get_running_loop().create_future()

    def settle(self, value: Any = None, error: Exception | None = None) -> None:
        """Set the outcome to a value or an error, unless the task has one already or was cancelled."""
        if self.outcome.done():
            return
        if error is None:
            self.outcome.set_result(value)
        else:
            self.outcome.set_exception(error)


@define(eq=False)
class PoolWorker:
    """A worker process and the server's end of its pipe."""

    process: Any
    connection: Connection
    inbox: asyncio.Queue[Message] = field(factory=asyncio.Queue)
    gone: asyncio.Event = field(factory=asyncio.Event)

    @classmethod
    def start(cls, kind: str, memory_bytes: int) -> PoolWorker:
        """Return a worker whose process is started, and a thread of the server that receives its messages is
        running.
        """
        context = get_context("spawn")
        ours, theirs = context.Pipe()
        process = context.Process(target=run_worker, args=(theirs, kind, memory_bytes), daemon=True)
        with ignore_interrupts():
            process.start()
        theirs.close()
        worker = cls(process, ours)
        loop = asyncio.get_running_loop()
        threading.Thread(target=worker.receive_messages, args=(loop,), daemon=True).start()
        return worker

    def receive_messages(self, loop: asyncio.AbstractEventLoop) -> None:
        """Put messages of the worker into its inbox until the pipe ends,
        then set ``gone``; runs in a thread of its own.
        """
        try:
            while True:
                message = self.connection.recv()
                loop.call_soon_threadsafe(self.inbox.put_nowait, message)
                # A result may be large, and the next message long in coming.
                del message
        except Exception:
            # The end of the pipe, or half a message of a worker that was ended.
            with suppress(RuntimeError):
                loop.call_soon_threadsafe(self.gone.set)

    async def send(self, message: Any) -> None:
        """Send a message to the worker; it is lost if the worker has ended."""
        with suppress(OSError, ValueError):
            await asyncio.to_thread(self.connection.send, message)

    async def end(self) -> None:
        """End the process at once, close its pipe and remove its temporary folder."""
        self.process.kill()
        await asyncio.to_thread(self.process.join, 5.0)
        with suppress(OSError):
            self.connection.close()
        await asyncio.to_thread(discard_folders, self.process.pid)


@contextmanager
def ignore_interrupts() -> Iterator[None]:
    """Make processes that are started within the block ignore Ctrl-C, which is for the server."""
    try:
        before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    except ValueError:
        # Not in the main thread.
        yield
        return
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


@define(eq=False)
class WorkerPool:
    """Workers of one kind.

    Parameters
    ----------
    kind : kind of the workers, see ``web.tasks.warm_up``.
    size : number of workers.
    memory_bytes : address space of each worker, in bytes.
    most_waiting : number of tasks that may wait; a single client may take three quarters of these places.
    """

    kind: str
    size: int
    memory_bytes: int
    most_waiting: int
    waiting: list[PoolTask] = field(factory=list, init=False)
    running: Counter[str] = field(factory=Counter, init=False)
    turns: dict[str, int] = field(factory=dict, init=False)
    bell: asyncio.Event = field(factory=asyncio.Event, init=False)
    slots: list[asyncio.Task[None]] = field(factory=list, init=False)
    workers: dict[int, PoolWorker] = field(factory=dict, init=False)
    numbers: Iterator[int] = field(factory=lambda: count(1), init=False)
    ready: asyncio.Event = field(factory=asyncio.Event, init=False)
    busy: int = field(default=0, init=False)

    def open(self) -> None:
        """Start the workers."""
        self.slots = [asyncio.create_task(self.keep_slot_filled(slot)) for slot in range(self.size)]

    async def close(self) -> None:
        """End the workers, and fail the tasks that wait."""
        for slot in self.slots:
            slot.cancel()
        await asyncio.gather(*self.slots, return_exceptions=True)
        for worker in list(self.workers.values()):
            await worker.end()
        self.give_up("The server was stopped.")

    def refuse_more(self, client: str) -> None:
        """Raise BusyError where too many tasks wait, of all clients or of this one."""
        of_client = sum(task.client == client for task in self.waiting)
        if len(self.waiting) >= self.most_waiting or of_client >= self.most_waiting - self.most_waiting // 4:
            raise BusyError("The server is busy: try again in a moment.")

    def give_up(self, sentence: str) -> None:
        """Fail all waiting tasks with a sentence."""
        while self.waiting:
            self.waiting.pop().settle(error=FailedError(sentence))

    async def run(self, task: PoolTask) -> Any:
        """Run a task when it is its client's turn, and return the outcome.

        If the caller is cancelled, so is the task.

        Raises
        ------
        BusyError
            When too many tasks wait.
        InputError
            When the worker refuses the task's input.
        StoppedError
            When the task was asked to stop and has no outcome.
        FailedError
            When the task failed, or its worker ended.
        """
        self.refuse_more(task.client)
        self.waiting.append(task)
        self.bell.set()
        try:
            return await task.outcome
        except asyncio.CancelledError:
            self.cancel(task)
            raise

    def cancel(self, task: PoolTask) -> None:
        """Ask a task to stop; a task that still waits ends at once, with StoppedError."""
        task.stop.set()
        if task in self.waiting:
            self.waiting.remove(task)
            task.settle(error=StoppedError())

    def choose_next_task(self) -> PoolTask | None:
        """Return the next task to run, without removing it from those waiting; None where none may run now.

        It belongs to the client with the fewest workers and, among equals, with the oldest last turn. If
        there are several workers, no single client may occupy all of them, so that other clients need not
        wait for its searches.
        """
        most = max(self.size - 1, 1)
        may = [task for task in self.waiting if self.running[task.client] < most]
        return min(
            may, key=lambda task: (self.running[task.client], self.turns.get(task.client, 0)), default=None
        )

    async def wait_for_task(self) -> PoolTask:
        """Wait for a task that may run, remove it from those waiting and return it.

        From then on it counts as one more worker of its client.
        """
        while (task := self.choose_next_task()) is None:
            self.bell.clear()
            await self.bell.wait()
        self.waiting.remove(task)
        self.running[task.client] += 1
        self.turns.pop(task.client, None)
        self.turns[task.client] = next(self.numbers)
        while len(self.turns) > MOST_TURNS:
            self.turns.pop(next(iter(self.turns)))
        return task

    def release_worker(self, task: PoolTask) -> None:
        """Count one worker less for the client of a task."""
        self.running[task.client] -= 1
        self.running += Counter()
        self.bell.set()

    async def keep_slot_filled(self, slot: int) -> None:
        """Keep a worker running in a slot and give it tasks,
        until cancelled; a worker that ends is replaced.
        """
        failed = 0
        while True:
            worker = self.workers[slot] = PoolWorker.start(self.kind, self.memory_bytes)
            if await wait_for_first(worker.inbox.get(), worker.gone.wait()) is None:
                await worker.end()
                failed += 1
                if failed >= MOST_FAILED_STARTS:
                    self.give_up("The server cannot start its worker processes: give them more memory.")
                await asyncio.sleep(START_PAUSE)
                continue
            failed = 0
            self.ready.set()
            try:
                await self.serve(worker)
            finally:
                await asyncio.shield(worker.end())

    async def serve(self, worker: PoolWorker) -> None:
        """Give tasks to a worker, one after the other, until the worker has ended."""
        while not worker.gone.is_set():
            task = await wait_for_first(self.wait_for_task(), worker.gone.wait())
            if task is None:
                return
            if worker.gone.is_set():
                self.release_worker(task)
                self.waiting.insert(0, task)
                return
            self.busy += 1
            try:
                await self.run_task(worker, task)
            except asyncio.CancelledError:
                task.settle(error=FailedError("The server was stopped."))
                raise
            finally:
                self.busy -= 1
                self.release_worker(task)
                # Its outcome is its caller's now.
                del task

    async def run_task(self, worker: PoolWorker, task: PoolTask) -> None:
        """Have a worker run a task, and set the task's outcome.

        A worker that does not stop in time is marked as gone.
        """
        clock, number, is_asked = asyncio.get_running_loop().time, next(self.numbers), False
        if task.begun is not None:
            task.begun()
        await worker.send((number, task.name, task.seconds, task.payload))
        end = clock() + task.seconds
        late = FailedError(f"This took longer than {task.seconds:g} s and was stopped.")
        while True:
            waits = [worker.inbox.get(), worker.gone.wait()] + ([] if is_asked else [task.stop.wait()])
            message = await wait_for_first(*waits, timeout=max(end - clock(), 0.0))
            if message is not None:
                kind, of, value = message
                if of != number:
                    continue
                if kind != "report":
                    if kind == "done":
                        task.settle(value)
                    else:
                        task.settle(error=(InputError if kind == "refused" else FailedError)(value))
                    return
                if task.report is not None and not task.stop.is_set():
                    task.report(value)
            elif worker.gone.is_set():
                task.settle(
                    error=FailedError(
                        "The process that worked on this ended unexpectedly; others are not affected."
                    )
                )
                return
            elif is_asked or not task.stops_well:
                task.settle(error=StoppedError() if task.stop.is_set() else late)
                worker.gone.set()
                return
            else:
                is_asked = True
                end = clock() + (STOP_GRACE if task.stop.is_set() else TIME_GRACE)
                await worker.send((number, CANCEL))


async def wait_for_first(*waits: Any, timeout: float | None = None) -> Any:
    """Wait until one of several coroutines is done or the time is up. Return the value of ``waits[0]`` if
    that is done, else None.

    Coroutines that are not done are cancelled.
    """
    tasks = [asyncio.ensure_future(wait) for wait in waits]
    try:
        await asyncio.wait(tasks, timeout=timeout, return_when=asyncio.FIRST_COMPLETED)
        return tasks[0].result() if tasks[0].done() else None
    finally:
        for task in tasks:
            task.cancel()
