"""Compiling on a first run, shared with a second process, where the package was not built with its kernels.

The second process compiles one half of the kernels while this one compiles the other. The cache folder hands
the code over, and a bar shows how many are done. If the second process was ended, what it has left is
compiled here.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress
from threading import Event, Lock, Thread
from time import sleep

from workhold.cli.progress import progress_bar
from workhold.kernels.base.compiling import are_stored, cache_folder

__all__ = [
    "begin_compiling",
    "compile_kernels",
    "compile_on_first_run",
    "compile_seating",
    "is_seating_compiled",
]

WORDS = "Compiling the kernels, on the first run only"
SEATING_WORDS = "Compiling the kernels of seating, on the first run only"
# The last of seating to be compiled, of each process, as their files are called.
LAST_OF_SEATING = ("free_space.leave", "sticking.least_friction")
# Writes a line for each kernel that is done, and ends with this process, however that ends.
PROGRAM = """
import sys
from workhold.files.apart import end_with_starter
end_with_starter()
from workhold.kernels import preparing
for _ in preparing.prepared(*getattr(preparing, sys.argv[1])[1]): print(flush=True)
"""
# Of the second process alone: numba would colour messages of errors that it never shows.
PLAIN = {"NUMBA_DISABLE_ERROR_MESSAGE_HIGHLIGHTING": "1"}
# Seconds between looks at the second process.
NAP = 0.05


class SecondProcess:
    """A process that compiles kernels, and ends when this one does, or when nothing refers to it any more.

    Parameters
    ----------
    shares : the name of two shares in ``workhold.kernels.preparing``; the process compiles the second.
    """

    def __init__(self, shares: str) -> None:
        path = os.pathsep.join(entry for entry in sys.path if entry)
        self.done = 0
        self.process = subprocess.Popen(
            [sys.executable, "-P", "-c", PROGRAM, shares],
            env={**os.environ, **PLAIN, "PYTHONPATH": path},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
        )

    def listen(self, one_more: Callable[[], None]) -> Thread:
        """Starts a thread that calls ``one_more`` for each kernel that is done."""

        def lines() -> None:
            with suppress(ValueError):
                for _ in self.process.stdout or ():
                    self.done += 1
                    one_more()

        listener = Thread(target=lines, daemon=True)
        listener.start()
        return listener

    def end(self) -> None:
        """Ends the process, whatever it is doing."""
        self.process.terminate()
        self.process.wait()


def begin_compiling() -> SecondProcess | None:
    """Begins to compile a search's kernels in a second process, if there is a processor and a place for it.

    What is done until :func:`compile_kernels`, such as reading a part, is done meanwhile.
    """
    return second_process("SEARCH")


def compile_kernels(cancel: Event, second: SecondProcess | None = None) -> None:
    """Compiles the kernels of a search; ``second`` is the process that :func:`begin_compiling` began.

    When ``cancel`` is set, the rest is left to the search.
    """
    share("SEARCH", WORDS, cancel, second)


def compile_on_first_run(cancel: Event) -> None:
    """Compiles the kernels of a search where that has not been done on this machine."""
    from workhold.kernels.base.compiling import is_first_run

    if is_first_run():
        compile_kernels(cancel)


def is_seating_compiled() -> bool:
    """Whether the kernels of seating are compiled, which takes ten seconds or so."""
    return are_stored(LAST_OF_SEATING)


def compile_seating(cancel: Event) -> None:
    """Compiles the kernels of seating, which searches do without, if that has not been done.

    When ``cancel`` is set, the rest is left to who needs it.
    """
    if is_seating_compiled():
        return
    share("SEATING", SEATING_WORDS, cancel)


def share(shares: str, words: str, cancel: Event, second: SecondProcess | None = None) -> None:
    """Compiles the kernels of two shares with a bar, the second in another process where there can be one."""
    second = second or second_process(shares)
    from workhold.kernels import preparing

    done, counting = 0, Lock()
    mine, others = getattr(preparing, shares)
    apart = preparing.kernel_count(others)
    count = preparing.kernel_count(mine) + apart
    with progress_bar(words, f"of {count} kernels", words) as progress:

        def one_more() -> None:
            nonlocal done
            with counting:
                done += 1
                progress(done / count, done)

        listener = None if second is None else second.listen(one_more)
        try:
            for _ in preparing.prepared(*mine):
                one_more()
                if cancel.is_set():
                    return
            while second is not None and second.process.poll() is None and not cancel.is_set():
                sleep(NAP)
        finally:
            if second is not None and listener is not None:
                second.end()
                listener.join()
        ready = 0 if second is None else second.done
        # Where there was no second process, or it was ended by others; what it had done is read.
        if ready < apart and not cancel.is_set():
            for number, _ in enumerate(preparing.prepared(*others)):
                if number >= ready:
                    one_more()
                if cancel.is_set():
                    return


def second_process(shares: str) -> SecondProcess | None:
    """Starts a process that compiles the second of two shares, given a processor and a cache folder."""
    helped = (os.cpu_count() or 1) > 1 and cache_folder() is not None and bool(sys.executable)
    return SecondProcess(shares) if helped else None
