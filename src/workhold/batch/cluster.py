"""A queue on a cluster of Dask: a scheduler hands tasks to workers on any number of machines.

Workers need this program and nothing else: a task is sent whole, and its record comes back, or goes where it
is kept. The tasks of a lost worker go to other workers, if there are any; when the scheduler is lost, the run
ends with the outcomes that it has.

M. Rocklin, "Dask: Parallel Computation with Blocked algorithms and Task Scheduling", SciPy 2015.
"""

from __future__ import annotations

import logging
from collections import deque
from collections.abc import Iterator
from contextlib import ExitStack, suppress
from queue import Empty, SimpleQueue
from threading import Event
from time import monotonic
from typing import Any

from attrs import define, evolve, field

from workhold.batch.store import RecordStore
from workhold.batch.tasks import Outcome, Task, TaskObserver, run_task
from workhold.batch.workers import block_interrupts_in_children
from workhold.errors import InputError

__all__ = ["ClusterWorkers"]

# Seconds between looks at whether to stop, between counts of the workers, and without any worker, or on this
# machine with too few, before something is done about it.
LOOK, COUNT, PATIENCE = 0.1, 2.0, 20.0
# Seconds for a scheduler to answer.
ANSWER = 20
# Tasks at the scheduler for each thread of a worker, so that none waits for the next one.
AHEAD = 3
# What the library says of a task that was done and is to be done again.
UNDONE = ("pending", "lost")
# What ends the key of a task that is tried alone.
ALONE = "-alone"


@define(eq=False)
class ClusterWorkers:
    """A queue of the workers of a cluster; use it in a ``with`` block.

    Parameters
    ----------
    watcher : observer that is notified of events.
    address : address of a scheduler, such as ``tcp://10.0.0.5:8786``; None starts a cluster on this machine.
    count : number of worker processes of a cluster on this machine.
    store : store that workers write records to; None where records come back with the outcomes.
    gone : sentence on why the scheduler was lost; empty while it is there.
    """

    watcher: TaskObserver
    address: str | None = None
    count: int = 0
    store: RecordStore | None = None
    gone: str = field(default="", init=False)
    client: Any = field(default=None, init=False)
    own: Any = field(default=None, init=False)
    stack: ExitStack = field(factory=ExitStack, init=False)
    threads: int = field(default=0, init=False)
    counted_at: float = field(default=0.0, init=False)
    idle_since: float = field(default=0.0, init=False)

    def __enter__(self) -> ClusterWorkers:
        from distributed import Client, LocalCluster

        at: Any = None if self.address is None else check_address(self.address)
        # What Dask has to say of what is lost is said in sentences of this program's own.
        self.stack.callback(logging.disable, logging.root.manager.disable)
        logging.disable(logging.CRITICAL)
        try:
            if at is None:
                with block_interrupts_in_children():
                    cluster = LocalCluster(
                        n_workers=self.count,
                        threads_per_worker=1,
                        dashboard_address=None,
                        silence_logs=logging.CRITICAL,
                    )
                self.own = at = self.stack.enter_context(cluster)
            self.client = self.stack.enter_context(Client(at, timeout=ANSWER, set_as_default=False))
        except (OSError, RuntimeError, ValueError, TimeoutError) as error:
            self.stack.close()
            if self.address is None:
                words = " ".join(str(error).split())
                raise InputError(f"a cluster cannot be started on this machine: {words}.") from error
            raise InputError(
                f"no scheduler answers at {self.address}: start one with dask scheduler, or correct the "
                "address."
            ) from error
        self.client.subscribe_topic("all", self.note_worker_event)
        return self

    def __exit__(self, *error: object) -> None:
        with suppress(Exception):
            self.client.unsubscribe_topic("all")
        with suppress(Exception):
            self.stack.close()

    def note_worker_event(self, event: tuple[float, Any]) -> None:
        """Notify the watcher if an event of the scheduler tells that a worker is lost.

        Runs in a thread of the Dask client.
        """
        report = event[1]
        if isinstance(report, dict) and report.get("action") == "remove-worker":
            busy = report.get("processing-tasks") or {}
            again = f" Other workers get the {len(busy)} tasks that it had in hand." if busy else ""
            self.watcher.notify(f"The worker at {report.get('worker')} is lost.{again}")

    def run(self, tasks: Iterator[Task], stop: Event) -> Iterator[Outcome]:
        """Yield the outcomes of tasks as they come; see :class:`workhold.batch.tasks.TaskQueue`.

        A task whose workers died is tried once more, alone. When the scheduler is lost, ``stop`` is set and
        the outcomes end.
        """
        finished: SimpleQueue[Any] = SimpleQueue()
        pending: dict[str, tuple[Any, Task]] = {}
        # Given up by the scheduler, perhaps only because of what the same workers had in hand: tried once
        # more, each alone.
        suspects: deque[Task] = deque()
        # Lost with their workers before they were fetched: others make them anew.
        remade: list[Any] = []
        exhausted = False
        self.idle_since = monotonic()
        while not stop.is_set():
            room = max(AHEAD * self.count_threads(), 1)
            while not exhausted and not self.gone and len(pending) < room:
                task = next(tasks, None)
                if task is None:
                    exhausted = True
                else:
                    pending[task.name] = (self.submit(task, task.name, finished), task)
            if not pending and suspects and not self.gone:
                task = suspects.popleft()
                pending[f"{task.name}{ALONE}"] = (self.submit(task, f"{task.name}{ALONE}", finished), task)
            if not pending and not self.gone:
                return
            for future in [future for future in remade if future.status not in UNDONE]:
                remade.remove(future)
                finished.put(future)
            with suppress(Empty):
                future = finished.get(timeout=LOOK)
                if future.status in UNDONE:
                    remade.append(future)
                    continue
                taken = pending.pop(future.key, None)
                if taken is None:
                    continue
                if is_killed(future) and not future.key.endswith(ALONE):
                    suspects.append(taken[1])
                    continue
                try:
                    outcome = self.get_outcome(future, taken[1])
                except OSError:
                    # Its worker or the scheduler was lost before the record was fetched; with another
                    # worker it is made anew.
                    pending[future.key] = taken
                    remade.append(future)
                    outcome = None
                if outcome is not None:
                    yield outcome
            if self.gone or self.client.status != "running":
                self.give_up(stop)
        with suppress(Exception):
            self.client.cancel([future for future, _ in pending.values()])

    def submit(self, task: Task, key: str, finished: SimpleQueue[Any]) -> Any:
        """Return the future of a task, sent to the cluster under ``key``.

        The future is put into ``finished`` when it is done.
        """
        future = self.client.submit(run_on_worker, task, self.store, key=key, pure=False)
        future.add_done_callback(finished.put)
        return future

    def count_threads(self) -> int:
        """Return the number of threads of the workers, counted anew every :data:`COUNT` seconds.

        After a while without a worker the watcher is told; workers missing from a cluster on this machine are
        started again.
        """
        now = monotonic()
        if now < self.counted_at + COUNT or self.gone:
            return self.threads
        self.counted_at = now
        try:
            self.threads = sum(self.client.nthreads().values())
        except Exception:
            # Whatever a client whose scheduler is going may raise.
            self.threads = 0
        if self.threads >= (1 if self.own is None else self.count):
            self.idle_since = now
        elif now > self.idle_since + PATIENCE:
            self.idle_since = now
            if self.own is None:
                self.watcher.notify("The cluster has no worker: the run waits for one.")
            else:
                # Dask gives up a worker that takes long to come back, as one does where much else is going
                # on.
                self.own.scale(self.count)
        return self.threads

    def get_outcome(self, future: Any, task: Task) -> Outcome | None:
        """Return the outcome of a task whose future is done.

        Return None, and set ``gone``, if the scheduler has lost the task.

        Raises
        ------
        OSError
            When the record does not come in time, or its connection ends: waiting for ever would keep lost
            workers from being started again.
        """
        if future.status == "finished":
            outcome: Outcome = future.result(timeout=PATIENCE)
            return outcome
        if future.status == "error":
            error = future.exception()
            if is_killed(future):
                times = error.allowed_failures + 1
                self.watcher.notify(
                    f"{times} workers ended while they worked on {task.title}, so it is given up."
                )
                words = f"{times} workers ended while they worked on this: it may need more memory than they have."
                return Outcome(task.name, None, words)
            words = " ".join(str(error).split())
            return Outcome(
                task.name, None, f"The cluster refused this task ({type(error).__name__}: {words})."
            )
        self.gone = self.gone or "lost"
        return None

    def give_up(self, stop: Event) -> None:
        """End the run because the scheduler is lost: set ``gone`` and ``stop``, and notify the watcher."""
        self.gone = (
            f"the scheduler at {self.address or 'this machine'} is lost. The answers so far are kept: "
            "start the scheduler, and then the same command again to go on."
        )
        self.watcher.notify(f"T{self.gone[1:]}")
        stop.set()


def is_killed(future: Any) -> bool:
    """Return whether the scheduler has given up a task because its workers died."""
    return future.status == "error" and type(future.exception()).__name__ == "KilledWorker"


def check_address(address: str) -> str:
    """Return the address of a scheduler, with "tcp://" in front where no protocol is given.

    Raises
    ------
    InputError
        For text that is no such address.

    Examples
    --------
    >>> check_address("10.0.0.5:8786")
    'tcp://10.0.0.5:8786'
    """
    kind, _, place = address.strip().rpartition("://")
    host, _, port = place.rpartition(":")
    is_port = port.isascii() and port.isdigit() and int(port[:6]) < 1 << 16
    if kind not in ("", "tcp", "tls", "ws", "wss", "ucx") or not (host and is_port):
        raise InputError(
            f"{address!r} is not an address of a scheduler: give the address that the scheduler printed, "
            "such as tcp://10.0.0.5:8786."
        )
    return f"{kind or 'tcp'}://{place}"


def run_on_worker(task: Task, store: RecordStore | None) -> Outcome:
    """Run a task in this process and return its outcome.

    If there is a store, the record is written to it instead of being returned.
    """
    from distributed import get_worker

    outcome = run_task(task, str(get_worker().address))
    if store is None or outcome.record is None:
        return outcome
    try:
        store.write(task.name, outcome.record)
    except InputError as error:
        return evolve(outcome, record=None, failure=str(error))
    return evolve(outcome, record=None)
