"""A server process that forks one process per piece of work, because loading a large library takes longer
than the work.

There is one server for all work of the process that starts it; it loads what a piece of work needs before it
forks. It ends with the process that started it, and after some idle time. It exists on Linux only: elsewhere
a library may not work in a forked process.

Each piece of work has a process of its own, as with :class:`subprocess.Popen`, and a second one that waits
for its end and reports its exit code. Unlike ``multiprocessing``'s fork server it never runs the main module
of its starter, so that it works from any script.
"""

from __future__ import annotations

import atexit
import os
import select
import signal
import socket
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from threading import Lock
from typing import BinaryIO

from attrs import define, frozen

__all__ = ["CAN_FORK", "ForkedProcess", "fork_from_server", "serve"]

CAN_FORK = sys.platform == "linux"
# Seconds after which a server that nobody asks ends.
IDLE_SECONDS = 30.0
# Bytes of a message: the name of a module.
LONGEST_NAME = 1 << 12


@define(eq=False)
class ForkedProcess:
    """A process forked by the server: its streams, and its end. As a context manager it waits for the end.

    Parameters
    ----------
    stdin, stdout : the caller's ends of the pipes to the process's standard input and output.
    status : pipe that gives its process number at its start and its exit code at its end, each on a line.
    number : its process number; 0 until it is read.
    returncode : its exit code, or minus the number of the signal that ended it; None while it runs.
    """

    stdin: BinaryIO
    stdout: BinaryIO
    status: BinaryIO
    number: int = 0
    returncode: int | None = None

    def wait(self) -> int:
        """Wait until the process has ended, and return its exit code;
        -SIGKILL if the exit code is not known.
        """
        if self.returncode is None:
            self.returncode = int(self.status.readline() or -signal.SIGKILL)
        return self.returncode

    def kill(self) -> None:
        """Kill the process, unless it has ended."""
        if self.returncode is None:
            with suppress(ProcessLookupError):
                os.kill(self.number, signal.SIGKILL)

    def __enter__(self) -> ForkedProcess:
        return self

    def __exit__(self, *_: object) -> None:
        self.wait()
        for stream in (self.stdin, self.stdout, self.status):
            with suppress(BrokenPipeError):
                stream.close()


@frozen(eq=False)
class ForkServer:
    """A running server, with the settings under which it was started.

    Parameters
    ----------
    process : the server.
    line : socket through which it takes orders.
    surroundings : process number of the process that started it, the command, and the environment variables
        at the start.
    """

    process: subprocess.Popen[bytes]
    line: socket.socket
    surroundings: tuple[int, Sequence[str], Mapping[str, str]]

    @classmethod
    def start(cls, command: Sequence[str]) -> ForkServer:
        """Start a server by a command whose process calls :func:`serve`, and return the server."""
        ours, its = socket.socketpair()
        with its:
            process = subprocess.Popen(
                command, stdin=its.fileno(), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
            )
        return cls(process, ours, (os.getpid(), tuple(command), dict(os.environ)))

    def fork_process(self, module: str) -> ForkedProcess | None:
        """Have the server fork a process for a module's
        work, and return it; None where the server has ended.
        """
        pipes = [os.pipe() for _ in range(3)]
        (order, stdin), (stdout, answer), (status, ended) = pipes
        its = [order, answer, ended]
        try:
            socket.send_fds(self.line, [module.encode()], its)
        except OSError:
            its += [stdin, stdout, status]
            return None
        finally:
            for number in its:
                os.close(number)
        process = ForkedProcess(os.fdopen(stdin, "wb"), os.fdopen(stdout, "rb"), os.fdopen(status, "rb"))
        process.number = int(process.status.readline() or 0)
        if process.number:
            return process
        process.returncode = 0
        with process:
            return None

    def end(self) -> None:
        """Close the line to the server, and kill the server if this process started it; the processes that it
        forked continue.
        """
        self.line.close()
        if self.surroundings[0] == os.getpid():
            self.process.kill()
            self.process.wait()


# The server of this process, and who may ask it or start it.
SERVERS: list[ForkServer] = []
ASKING = Lock()


def fork_from_server(module: str, command: Sequence[str]) -> ForkedProcess | None:
    """Return a process for a module's work, forked by the running server or by a new one.

    The server is replaced by a new one where this process's number, the command or the environment have
    changed. None where even a new server ends before it has forked.

    Parameters
    ----------
    command : starts a server; its process calls :func:`serve`.
    """
    with ASKING:
        for _ in range(2):
            surroundings = os.getpid(), tuple(command), dict(os.environ)
            if SERVERS and SERVERS[0].surroundings != surroundings:
                SERVERS.pop().end()
            if not SERVERS:
                SERVERS.append(ForkServer.start(command))
            process = SERVERS[0].fork_process(module)
            if process is not None:
                return process
            SERVERS.pop().end()
    return None


@atexit.register
def end_servers() -> None:
    """End the servers of this process; called when it exits."""
    while SERVERS:
        SERVERS.pop().end()


def serve(load: Callable[[str], object], work: Callable[[], None]) -> None:
    """Fork a process for each order that comes through standard input, which is a socket.

    When the socket is closed, or has been idle for ``IDLE_SECONDS``, end this process; the function does not
    return.

    Parameters
    ----------
    load : called before the fork with a module's name; loads what the work of that module needs.
    work : does the work in the forked process, with standard input and output from the order; it must not
        return.
    """
    line = socket.socket(fileno=0)
    # Nobody waits for the processes that wait for others.
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)
    while select.select([line], [], [], IDLE_SECONDS)[0]:
        name, numbers, _, _ = socket.recv_fds(line, LONGEST_NAME, 3)
        if not name:
            break
        # What cannot be loaded is said by the process that is forked, which tries again.
        with suppress(Exception):
            load(name.decode())
        if os.fork() == 0:
            watch(work, *numbers)
        for number in numbers:
            os.close(number)
    os._exit(0)


def watch(work: Callable[[], None], order: int, answer: int, status: int) -> None:
    """Fork the process that does the work, and report its number and, when it ends, its exit code, each on a
    line of ``status``.

    Never returns.

    Parameters
    ----------
    order, answer, status : file descriptors: input and output of the work, and where to report.
    """
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
    number = os.fork()
    if number == 0:
        os.dup2(order, 0)
        os.dup2(answer, 1)
        for one in (order, answer, status):
            os.close(one)
        work()
    for one in (0, order, answer):
        os.close(one)
    try:
        os.write(status, b"%d\n" % number)
    except BrokenPipeError:
        os.kill(number, signal.SIGKILL)
    code = os.waitstatus_to_exitcode(os.waitpid(number, 0)[1])
    with suppress(BrokenPipeError):
        os.write(status, b"%d\n" % code)
    os._exit(0)
