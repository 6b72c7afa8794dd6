"""A command run with its stderr on a terminal of our own, as a person would see it, watched and perhaps interrupted."""

from __future__ import annotations

import os
import pty
import re
import select
import signal
import subprocess
import sys
from pathlib import Path
from time import perf_counter

from attrs import frozen

from report import child_environment

__all__ = ["WORKHOLD", "Watched", "watch"]

SCRIPT = Path(sys.executable).with_name("workhold")
WORKHOLD = [str(SCRIPT)] if SCRIPT.exists() else [sys.executable, "-m", "workhold"]

# How often the process is looked after, in seconds, and how long it has to end after an interrupt.
LOOK = 0.02
PATIENCE = 60.0


@frozen
class Watched:
    """What came of a command.

    Parameters
    ----------
    seconds : how long it ran.
    code : its exit code; -9 when it had to be killed.
    shown : everything it wrote to the terminal.
    first_shown : seconds until it wrote there; infinite if it never did.
    stopping : seconds from the interrupt to the end; 0 if there was none.
    memory : peak memory in MiB.
    """

    seconds: float
    code: int
    shown: str
    first_shown: float
    stopping: float
    memory: float

    def last(self, pattern: str) -> str:
        """The last thing on the terminal of a pattern's first group, or nothing."""
        found = re.findall(pattern, self.shown)
        return str(found[-1]) if found else ""


def watch(command: list[str], interrupt_after: float | None = None, **environment: str) -> Watched:
    """Run a command; with ``interrupt_after``, press Ctrl-C after so many seconds if it still runs then."""
    ours, theirs = pty.openpty()
    start = perf_counter()
    process = subprocess.Popen(
        command,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=theirs,
        env=child_environment(TERM="xterm", COLUMNS="100", **environment),
    )
    os.close(theirs)
    shown, first_shown, interrupted = b"", float("inf"), float("inf")
    while True:
        ready, _, _ = select.select([ours], [], [], LOOK)
        content = read(ours) if ready else b""
        now = perf_counter() - start
        if content and not shown:
            first_shown = now
        shown += content
        # wait4 tells the memory of exactly this process; after it the process is no more.
        done, status, usage = os.wait4(process.pid, os.WNOHANG)
        if done:
            break
        if interrupt_after is not None and now > interrupt_after and interrupted == float("inf"):
            interrupted = now
            process.send_signal(signal.SIGINT)
        if now > interrupted + PATIENCE:
            process.kill()
    shown += read(ours)
    os.close(ours)
    process.returncode = os.waitstatus_to_exitcode(status)
    stopping = max(now - interrupted, 0.0)
    return Watched(
        now, process.returncode, shown.decode(errors="replace"), first_shown, stopping, usage.ru_maxrss / 1024
    )


def read(terminal: int) -> bytes:
    """What is waiting to be read from a terminal; nothing at its end."""
    try:
        return os.read(terminal, 65536) if select.select([terminal], [], [], 0.0)[0] else b""
    except OSError:
        return b""
