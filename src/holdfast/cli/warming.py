"""A second process that compiles kernels beside the search on a first run.

Numba compiles one kernel at a time in a process. While the search compiles what it needs first, another process compiles
what it needs last and leaves it in the cache folder, where the search finds it in time. It changes nothing but the wait.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

__all__ = ["second_compiler"]

SEARCH = (
    "import holdfast; "
    "holdfast.design(holdfast.load('oblongPart'), holdfast.Vise(pitch=10, columns=1, peg_radius=3), types=['II'], threads=1)"
)


@contextmanager
def second_compiler(first_run: bool) -> Iterator[None]:
    """Compile the kernels of Type II in another process while the context lasts, if there is a processor for it."""
    if not first_run or (os.cpu_count() or 1) < 2:
        yield
        return
    silent = subprocess.DEVNULL
    process = subprocess.Popen([sys.executable, "-c", SEARCH], stdin=silent, stdout=silent, stderr=silent)
    try:
        yield
    finally:
        process.terminate()
        process.wait()
