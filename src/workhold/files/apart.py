"""Reading of foreign data in a child process, for libraries that a damaged file can crash.

The parent survives whatever happens to the child: a crash, a time-out and a lack of memory each become one
sentence. The process is started through pipes rather than by ``multiprocessing``, so that it works from any
script, and its answer is JSON, which cannot execute anything. It ends with its parent, even if the parent is
killed or a library ignores signals. On systems that can fork, a process that has loaded the library is kept
ready (``files.fork_server``), since loading takes longer than reading most files.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Mapping
from contextlib import suppress
from importlib import import_module
from threading import Event, Timer
from types import ModuleType
from typing import Any

from workhold.errors import InputError, lacks_memory
from workhold.files.budget import LIMITS, OverBudgetError
from workhold.files.fork_server import CAN_FORK, ForkedProcess, fork_from_server

__all__ = ["limit_memory", "limit_processor", "run_apart"]

# Address space that the libraries themselves take is a third of this; a large file needs some fifty times its
# size.
MEMORY_BYTES, MEMORY_FACTOR = 5 << 29, 50
# Wall time is longer, since the machine may be busy; it counts from when the process is prepared, which may
# mean to compile the program's own code.
WALL_FACTOR = 10.0
# What the process writes then.
PREPARED = b"\n"
# The same modules as here, and none from the folder that happens to be the current one.
START = (
    "import signal, sys; sys.path[:] = sys.argv[1:]; signal.signal(signal.SIGINT, signal.SIG_DFL); "
    "from workhold.files import apart, fork_server; "
)
ANSWER, SERVE = "apart.run_child()", "fork_server.serve(apart.load_prepared_module, apart.run_child)"


def run_apart(module: str, content: bytes, options: Mapping[str, Any], what: str) -> Any:
    """Return ``module.read_as_plain_data(content, **options)``, called in a child process.

    The module's ``prepare`` is called there first.

    Parameters
    ----------
    module : its full name; ``prepare`` loads what the work needs and has no limit of time.
    content : foreign data.
    options : plain data (as JSON has it); so is the result.
    what : words for the data that can begin a sentence of an error message.

    Raises
    ------
    InputError
        The InputError that the work raised, or a sentence that the process crashed, took too long or took too
        much memory.
    RuntimeError
        For any other error of the work, with its traceback.
    """
    seconds = LIMITS["step"].allow_seconds_for(len(content))
    assert seconds is not None
    memory = MEMORY_BYTES + MEMORY_FACTOR * len(content)
    order = {
        "module": module,
        "options": dict(options),
        "seconds": seconds,
        "memory": memory,
        "size": len(content),
    }
    with start_process(module) as process:
        assert process.stdin is not None and process.stdout is not None
        late = Event()

        def give_up() -> None:
            """Kill the process because time is up."""
            late.set()
            process.kill()

        clock = Timer(WALL_FACTOR * seconds, give_up)
        try:
            with suppress(BrokenPipeError):
                process.stdin.write(json.dumps(order).encode() + b"\n" + content)
                process.stdin.flush()
            first = process.stdout.read(len(PREPARED))
            clock.start()
            # Its pipe stays open until it has answered: the process ends when it closes.
            answered = first + process.stdout.read()
            code = process.wait()
        finally:
            process.kill()
            clock.cancel()
            with suppress(BrokenPipeError):
                process.stdin.close()
    given_up = late.is_set() or code == -getattr(signal, "SIGXCPU", 0)
    return read_outcome(answered, code, given_up, (seconds, memory), what)


def start_process(module: str) -> ForkedProcess | subprocess.Popen[bytes]:
    """Return a child process that executes one order of work for a module."""
    process = fork_from_server(module, make_python_command(SERVE)) if CAN_FORK else None
    return process or subprocess.Popen(
        make_python_command(ANSWER), stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
    )


def make_python_command(doing: str) -> list[str]:
    """Return the command that starts Python with the module path of this process and executes ``doing``."""
    return [sys.executable, "-P", "-c", START + doing, *sys.path]


def read_outcome(answered: bytes, code: int, given_up: bool, limits: tuple[float, int], what: str) -> Any:
    """Return the result that an ended child has written; raise the errors of :func:`run_apart`.

    Parameters
    ----------
    answered : bytes written by the child.
    code : its exit code.
    given_up : whether it was ended because time was up.
    limits : its seconds and bytes of memory, for messages.
    """
    kind, value = "", ""
    seconds, memory = limits
    with suppress(ValueError):
        kind, value = json.loads(answered)
    if kind == "done":
        return value
    if kind == "refused":
        raise InputError(value)
    if kind == "fault":
        raise RuntimeError(f"in the process that reads {what}:\n{value}")
    if kind == "memory":
        raise OverBudgetError(
            f"{what} needs more than {memory / 1e9:.1f} GB of memory to read: save less in it."
        )
    if given_up:
        raise OverBudgetError(
            f"{what} was given up after {seconds:.0f} s of reading: it is damaged, or holds too much; save "
            "less in it."
        )
    if code == -getattr(signal, "SIGKILL", 0):
        # Nobody else ends a process so: the system does, when it has no memory left for all.
        raise InputError(
            f"{what} ran out of memory while it was read: close other programs, or save less in it."
        )
    raise InputError(f"{what} is damaged so that the library that reads it breaks down: save it anew.")


def run_child() -> None:
    """Run the main program of a child: do the work ordered on
    standard input, write its outcome to standard output, exit.
    """
    # Libraries write what they like to the usual output, which nobody reads from now on.
    out = os.dup(1)
    os.dup2(2, 1)
    order = json.loads(sys.stdin.buffer.readline())
    content = sys.stdin.buffer.read(order["size"])
    end_with_starter()
    try:
        limit_memory(order["memory"])
        reply = ("done", run_order(order, content, out))
    except InputError as error:
        reply = ("refused", str(error))
    except Exception as error:
        import traceback

        reply = ("memory", "") if lacks_memory(error) else ("fault", traceback.format_exc())
    with os.fdopen(out, "wb") as stream:
        stream.write(json.dumps(reply).encode())
    # A library that a damaged file has upset may break down while it tidies up.
    os._exit(0)


def run_order(order: Mapping[str, Any], content: bytes, out: int) -> Any:
    """Return the result of an order's work; ``PREPARED`` is written to the
    file descriptor ``out`` when the work begins.
    """
    module = load_prepared_module(order["module"])
    os.write(out, PREPARED)
    limit_processor(order["seconds"])
    return module.read_as_plain_data(content, **order["options"])


def load_prepared_module(name: str) -> ModuleType:
    """Import a module, call its ``prepare`` and return it."""
    module = import_module(name)
    prepare: Callable[[], None] = module.prepare
    prepare()
    return module


def end_with_starter() -> None:
    """Make the system end this process when its parent closes the pipe to it; do nothing on Windows."""
    if sys.platform == "win32":
        return
    import fcntl

    # The default action of SIGIO, which comes when the other end of the pipe closes, is to end the process.
    fcntl.fcntl(0, fcntl.F_SETOWN, os.getpid())
    fcntl.fcntl(0, fcntl.F_SETFL, fcntl.fcntl(0, fcntl.F_GETFL) | os.O_ASYNC)


def limit_memory(size: int) -> None:
    """Limit the process's address space to ``size`` bytes, and write no core dumps; do nothing on systems
    without such a limit.
    """
    try:
        import resource
    except ImportError:
        return
    most = resource.getrlimit(resource.RLIMIT_AS)[1]
    size = size if most == resource.RLIM_INFINITY else min(size, most)
    resource.setrlimit(resource.RLIMIT_AS, (size, size))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def limit_processor(seconds: float) -> None:
    """Make the system end this process after ``seconds`` more of processor time; do nothing on systems
    without such a limit.
    """
    try:
        import resource
    except ImportError:
        return
    used = resource.getrusage(resource.RUSAGE_SELF)
    most = resource.getrlimit(resource.RLIMIT_CPU)[1]
    soft = int(used.ru_utime + used.ru_stime + seconds) + 1
    soft = soft if most == resource.RLIM_INFINITY else min(soft, most)
    resource.setrlimit(resource.RLIMIT_CPU, (soft, most))
