"""Compiling on a first run, shared with a second process, where the package was not built with its kernels.

The second process compiles the kernels of the search while this one compiles those that come before and after it; the cache
folder hands the code over, and a bar tells how many are done. It changes nothing but the wait.
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
from workhold.kernels.base.compiling import LIBRARY, cache_folder

__all__ = ["compile_kernels", "compile_seating", "is_seating_compiled"]

WORDS = "Compiling the kernels, on the first run only"
SEATING_WORDS = "Compiling the kernels of seating, on the first run only"
# The last of them to be compiled, as its file is called.
LAST_OF_SEATING = "leaving.leave"
# The part for the second process; the first compiles all others.
LONGEST = "crossings"
# Writes a line for each kernel that is done, and ends with this process, however that ends.
SECOND_PROCESS = f"""
from workhold.files.apart import end_with_starter
from workhold.kernels.preparing import prepared
end_with_starter()
for _ in prepared({LONGEST!r}): print(flush=True)
"""
# Seconds between looks at the second process.
NAP = 0.05


def compile_kernels(cancel: Event) -> None:
    """Compile the kernels of a search, with the help of another process if there is a processor for it.

    Parameters
    ----------
    cancel : when set, the rest is left to the search.
    """
    from workhold.kernels.preparing import KERNEL_COUNT, LATER, PARTS, prepared

    done, counting = 0, Lock()
    with progress_bar(WORDS, f"of {KERNEL_COUNT} kernels", WORDS) as progress:

        def one_more() -> None:
            nonlocal done
            with counting:
                done += 1
                progress(done / KERNEL_COUNT, done)

        helped = (os.cpu_count() or 1) > 1 and cache_folder() is not None and bool(sys.executable)
        process, listener = second_process(one_more) if helped else (None, None)
        try:
            for part in PARTS:
                for _ in () if part in LATER or (helped and part == LONGEST) else prepared(part):
                    one_more()
                    if cancel.is_set():
                        return
            while process is not None and process.poll() is None and not cancel.is_set():
                sleep(NAP)
        finally:
            if process is not None and listener is not None:
                process.terminate()
                process.wait()
                listener.join()


def is_seating_compiled() -> bool:
    """Whether the kernels of seating need not be compiled any more, a matter of half a minute or so."""
    if LIBRARY is not None:
        return True
    folder = cache_folder()
    return folder is not None and next(folder.rglob(f"{LAST_OF_SEATING}-*.nbi"), None) is not None


def compile_seating(cancel: Event) -> None:
    """Compile the kernels of seating, which searches do without, if that has not been done.

    Parameters
    ----------
    cancel : when set, the rest is left to who needs it.
    """
    if is_seating_compiled():
        return
    from workhold.kernels.preparing import LATER, PARTS, prepared

    count = sum(1 for part in LATER for _ in PARTS[part]())
    with progress_bar(SEATING_WORDS, f"of {count} kernels", SEATING_WORDS) as progress:
        for done, _ in enumerate((kernel for part in LATER for kernel in prepared(part)), 1):
            progress(done / count, done)
            if cancel.is_set():
                return


def second_process(one_more: Callable[[], None]) -> tuple[subprocess.Popen[bytes], Thread]:
    """Start the second process, and a thread that calls ``one_more`` for each kernel that it has compiled."""
    path = os.pathsep.join(entry for entry in sys.path if entry)
    process = subprocess.Popen(
        [sys.executable, "-P", "-c", SECOND_PROCESS],
        env={**os.environ, "PYTHONPATH": path},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
    )

    def listen() -> None:
        with suppress(ValueError):
            for _ in process.stdout or ():
                one_more()

    listener = Thread(target=listen, daemon=True)
    listener.start()
    return process, listener
