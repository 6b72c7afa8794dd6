"""A worker process: runs the tasks that come through a pipe, within limits of memory and time.

It is started anew, not forked, so that it shares nothing with the server. Its kernels are loaded before it
reports that it is ready. When the server ends, the pipe ends and so does the worker.

Temporary files of tasks are in the worker's own folder. The process that ends a worker removes this folder; a
worker that ends because the server is gone removes it itself.
"""

from __future__ import annotations

import ctypes
import gc
import os
import shutil
import signal
import sys
import tempfile
import traceback
from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import cache
from multiprocessing.connection import Connection
from pathlib import Path
from queue import SimpleQueue
from threading import Event, Thread
from typing import Any

from attrs import frozen

from workhold.errors import InputError, lacks_memory
from workhold.files.apart import limit_memory, limit_processor

__all__ = ["CANCEL", "TaskContext", "Tasks", "discard_folders", "return_memory", "run_tasks"]

# The name of a message that asks a task to stop.
CANCEL = "cancel"
# Processor seconds beyond the wall time of a task, for each processor, before the system ends the process.
SPARE_SECONDS = 30.0


@frozen
class TaskContext:
    """The access of a running task to its process: reports, cancellation and time limit.

    Parameters
    ----------
    report : function that sends a value to the server before the task is done.
    cancel : event, set when the task should stop.
    seconds : time limit of the task.
    """

    report: Callable[[Any], None]
    cancel: Event
    seconds: float


Tasks = Mapping[str, Callable[[Any, TaskContext], Any]]


def run_tasks(connection: Connection, memory_bytes: int, tasks: Tasks, warm_up: Callable[[], object]) -> None:
    """Run tasks until the pipe ends; this is the main function of the process and does not return.

    Parameters
    ----------
    connection : messages in are (number, name of the task, seconds, payload). The first message out is
        ("ready", 0, None). Each task sends ("report", number, value) any number of times, then one of
        ("done", number, value), ("refused", number, sentence) and ("failed", number, sentence).
    memory_bytes : the most address space the process may take.
    tasks : functions that run the tasks, by name.
    warm_up : called first, with the memory limit set.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    limit_memory(memory_bytes)
    orders: SimpleQueue[tuple[int, str, float, Any, Event]] = SimpleQueue()
    Thread(target=receive_orders, args=(connection, orders), daemon=True).start()
    warm_up()
    make_own_folder()
    connection.send(("ready", 0, None))
    while True:
        number, name, seconds, payload, cancel = orders.get()
        # Far more than the wall time allows means that the task is deaf.
        limit_processor((os.cpu_count() or 1) * (seconds + SPARE_SECONDS))

        def report(value: Any, number: int = number) -> None:
            """Send a report of the task."""
            connection.send(("report", number, value))

        try:
            answer = ("done", number, tasks[name](payload, TaskContext(report, cancel, seconds)))
        except InputError as error:
            answer = ("refused", number, str(error))
        except Exception as error:
            answer = ("failed", number, explain_task_error(error, memory_bytes))
        del payload
        connection.send(answer)
        # What was found is the server's now; waiting for the next order takes no memory.
        del answer, report
        return_memory()


# The folder of this process, once it has one.
folders: list[str] = []


def make_own_folder() -> None:
    """Make a temporary folder for this process and its tasks, if possible. tempfile uses it from then on."""
    with suppress(OSError):
        folders.append(tempfile.mkdtemp(prefix=make_folder_prefix(os.getpid())))
        tempfile.tempdir = folders[0]


def make_folder_prefix(process: int) -> str:
    """Return the beginning of the name of a worker's folder, by its process id."""
    return f"workhold-worker-{process}-"


def discard_folders(process: int | None) -> None:
    """Remove the temporary folders, with their content, of a worker process that has ended.

    ``process`` is its id, None for a process that was never started.
    """
    for path in Path(tempfile.gettempdir()).glob(f"{make_folder_prefix(process or 0)}*"):
        shutil.rmtree(path, ignore_errors=True)


@cache
def find_memory_trimmer() -> Any:
    """Return the C library's ``malloc_trim``; None where it has none."""
    with suppress(OSError, AttributeError, TypeError):
        return ctypes.CDLL(None).malloc_trim
    return None


def return_memory() -> None:
    """Give freed memory back to the system, which takes milliseconds.

    The C library by itself keeps most of the memory of large results, because small pieces in use prevent it
    from returning whole blocks.
    """
    gc.collect()
    trim = find_memory_trimmer()
    if trim is not None:
        trim(ctypes.c_size_t(0))


def explain_task_error(error: Exception, memory_bytes: int) -> str:
    """Return a sentence for the client of a task that failed.

    The traceback is printed on stderr unless memory ran out.
    """
    if lacks_memory(error):
        return f"This needs more than the {memory_bytes >> 20} MiB of memory the server gives."
    traceback.print_exception(error, file=sys.stderr)
    if isinstance(error, OSError):
        # The server is gone, or the disk is full; neither can be distinguished here.
        return "The system refused something the work needs."
    return "The program has a mistake that this request brought out; please report it."


def receive_orders(connection: Connection, orders: SimpleQueue[tuple[int, str, float, Any, Event]]) -> None:
    """Put tasks from the pipe into the queue, and set the event of the newest task when it is cancelled.

    Runs in a thread, and ends the process when the server has ended.
    """
    newest, cancel = 0, Event()
    while True:
        try:
            message = connection.recv()
        except (EOFError, OSError):
            if folders:
                shutil.rmtree(folders[0], ignore_errors=True)
            os._exit(0)
        if message[1] == CANCEL:
            if message[0] == newest:
                cancel.set()
            continue
        newest, cancel = message[0], Event()
        orders.put((*message, cancel))
