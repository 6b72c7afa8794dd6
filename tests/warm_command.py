"""The command ``workhold`` without its start: forked from a process that has all of it loaded, Open CASCADE too.

``python warm_command.py SOCKET`` answers at a socket until its standard input ends. ``script`` is a command for the
shell that asks it: its arguments, folder, environment and streams become those of the fork, signals are handed on,
and it ends as the fork does. For tests of what calls the command, not of how it starts.
"""

from __future__ import annotations

import json
import os
import shlex
import signal
import socket
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from select import select
from subprocess import PIPE, Popen
from typing import Any

__all__ = ["script", "warm_command"]

LARGEST = 1 << 20
# Python without its site-packages, which starts in a fiftieth of a second.
ASK = """
import json, os, signal, socket, sys
asked = socket.socket(socket.AF_UNIX)
asked.connect(sys.argv[1])
order = {"words": sys.argv[2:], "folder": os.getcwd(), "environment": dict(os.environ)}
socket.send_fds(asked, [json.dumps(order).encode()], [0, 1, 2])
for number in (signal.SIGINT, signal.SIGTERM):
    signal.signal(number, lambda number, frame: asked.send(bytes([number])))
code = int(asked.recv(16) or -signal.SIGKILL)
if code < 0:
    signal.signal(-code, signal.SIG_DFL) if -code != signal.SIGKILL else None
    os.kill(os.getpid(), -code)
os._exit(code)
"""


def script(address: Path, **environment: str) -> str:
    """What a file holds that is the command, for the process at an address."""
    given = " ".join(f"{name}={shlex.quote(value)}" for name, value in environment.items())
    return (
        f'#!/bin/sh\n{given} exec {shlex.quote(sys.executable)} -I -S -c {shlex.quote(ASK)} {address} "$@"\n'
    )


@contextmanager
def warm_command(folder: Path) -> Iterator[Path]:
    """A process that answers at the address, as long as it lasts."""
    address = folder / "command"
    with Popen([sys.executable, __file__, address], stdin=PIPE, stdout=PIPE) as process:
        try:
            assert process.stdout is not None and process.stdout.readline() == b"ready\n"
            yield address
        finally:
            assert process.stdin is not None
            process.stdin.close()


def serve(address: str) -> None:
    """Loads the command and answers, each call in a fork of its own."""
    from reading_here import READERS, read_here
    from workhold.cli.main import COMMANDS  # noqa: F401 -- what loads with it
    from workhold.kernels.base.compiling import Kernel

    read_here()
    for room in Kernel.all.values():
        for kernel in room.values():
            assert kernel.entry
    __import__(READERS[0], fromlist=["prepare"]).prepare()
    with socket.socket(socket.AF_UNIX) as listening:
        listening.bind(address)
        listening.listen()
        sys.stdout.write("ready\n")
        sys.stdout.flush()
        # The pipe ends with who started this.
        while select([listening, sys.stdin], [], [])[0] == [listening]:
            asked, _ = listening.accept()
            if os.fork() == 0:
                listening.close()
                answer(asked)
            asked.close()
            # Those that have ended; what they took counts as this process's.
            with suppress(ChildProcessError):
                while os.waitpid(-1, os.WNOHANG)[0]:
                    pass


def answer(asked: socket.socket) -> None:
    """Runs one command in a fork of this process, hands signals on to it, and says how it ended."""
    content, streams, _, _ = socket.recv_fds(asked, LARGEST, 3)
    worker = os.fork()
    if worker == 0:
        run(json.loads(content), streams)
    for stream in streams:
        os.close(stream)
    threading.Thread(target=hand_on, args=(asked, worker), daemon=True).start()
    code = os.waitstatus_to_exitcode(os.waitpid(worker, 0)[1])
    with suppress(OSError):
        asked.send(str(code).encode())
    os._exit(0)


def hand_on(asked: socket.socket, worker: int) -> None:
    """Signals of who asked; one that is gone takes the worker with it."""
    while number := asked.recv(1):
        os.kill(worker, number[0])
    with suppress(ProcessLookupError):
        os.kill(worker, signal.SIGKILL)


def run(order: Any, streams: list[int]) -> None:
    """Becomes the command."""
    for number, stream in enumerate(streams):
        os.dup2(stream, number)
    sys.stdin, sys.stdout, sys.stderr = (os.fdopen(number, mode) for number, mode in enumerate("rww"))
    os.chdir(order["folder"])
    os.environ.clear()
    os.environ.update(order["environment"])
    sys.argv = ["workhold", *order["words"]]
    from workhold.__main__ import run as command

    try:
        command()
    except SystemExit as end:
        for stream in (sys.stdout, sys.stderr):
            stream.flush()
        os._exit(int(end.code or 0))


if __name__ == "__main__":
    serve(sys.argv[1])
