"""A process kept ready that forks one for each piece of work, because to load a large library takes longest.

It is one for all work of the process that starts it, and loads what a piece of work needs before it forks. It
ends with its starter, and when nothing was asked of it for a while. There is one on Linux alone: elsewhere a
library may not work in a process that was forked.

Each piece of work has a process of its own, as with :class:`subprocess.Popen`, and a second one that waits
for its end and says how it ended. Unlike ``multiprocessing``'s fork server it never runs the main module of
its starter, so that it works from any script.
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
    """A process of a fork server: its streams, and its end.

    Parameters
    ----------
    stdin, stdout : its streams at this end.
    status : where its number comes from first and its exit code at its end, each on a line.
    number : its process number; 0 until it is read.
    returncode : its exit code, negative the signal that ended it; None while it runs.
    """

    stdin: BinaryIO
    stdout: BinaryIO
    status: BinaryIO
    number: int = 0
    returncode: int | None = None

    def wait(self) -> int:
        """Wait until it has ended, and return its exit code; the code of SIGKILL if the real one is not known."""
        if self.returncode is None:
            self.returncode = int(self.status.readline() or -signal.SIGKILL)
        return self.returncode

    def kill(self) -> None:
        """End it at once, unless it has ended."""
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
    """A server that runs, and what it was started with.

    Parameters
    ----------
    process : the server.
    line : where it takes orders from.
    surroundings : the number of its starter, and what of its surroundings its work depends on.
    """

    process: subprocess.Popen[bytes]
    line: socket.socket
    surroundings: tuple[int, Sequence[str], Mapping[str, str]]

    @classmethod
    def start(cls, command: Sequence[str]) -> ForkServer:
        """Start a server by a command whose process calls :func:`serve`."""
        ours, its = socket.socketpair()
        with its:
            process = subprocess.Popen(
                command, stdin=its.fileno(), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
            )
        return cls(process, ours, (os.getpid(), tuple(command), dict(os.environ)))

    def fork_process(self, module: str) -> ForkedProcess | None:
        """Have it fork a process for a module's work; None where the server has ended."""
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
        """End the server, where it is this process's own; what it has forked goes on."""
        self.line.close()
        if self.surroundings[0] == os.getpid():
            self.process.kill()
            self.process.wait()


# The server of this process, and who may ask it or start it.
SERVERS: list[ForkServer] = []
ASKING = Lock()


def fork_from_server(module: str, command: Sequence[str]) -> ForkedProcess | None:
    """Return a process for a module's work, forked by the server that a command starts, or has started
    before.

    None where even a new server ends before it has forked.
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
    while SERVERS:
        SERVERS.pop().end()


def serve(load: Callable[[str], object], work: Callable[[], None]) -> None:
    """Fork a process for each order, until standard input is closed or nothing is asked; the server's main.

    ``load`` loads what the work of a module needs. ``work`` is what each process does, with streams of its
    own; it never returns.
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
    """Fork the process that does the work, and say its number and how it ended; never returns."""
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
