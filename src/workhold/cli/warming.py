"""Compiling on a first run, shared with a second process.

The second process compiles the kernels of the search while this one compiles those that come before and after it; the cache
folder hands the code over. It changes nothing but the wait.
"""

from __future__ import annotations

import os
import subprocess
import sys
from threading import Event
from time import sleep

from workhold.kernels.base.compiling import cache_folder

__all__ = ["compile_kernels"]

SECOND_PROCESS = "from workhold.kernels.preparing import prepare_crossings; prepare_crossings()"
# Seconds between looks at the second process.
NAP = 0.05


def compile_kernels(cancel: Event) -> None:
    """Compile the kernels of a search, with the help of another process if there is a processor for it.

    Parameters
    ----------
    cancel : when set, the rest is left to the search.
    """
    if (os.cpu_count() or 1) < 2 or cache_folder() is None or not sys.executable:
        return
    from workhold.kernels.preparing import prepare_table_and_listing

    silent = subprocess.DEVNULL
    path = os.pathsep.join(entry for entry in sys.path if entry)
    process = subprocess.Popen(
        [sys.executable, "-P", "-c", SECOND_PROCESS],
        env={**os.environ, "PYTHONPATH": path},
        stdin=silent,
        stdout=silent,
        stderr=silent,
    )
    try:
        prepare_table_and_listing()
        while process.poll() is None and not cancel.is_set():
            sleep(NAP)
    finally:
        process.terminate()
        process.wait()
