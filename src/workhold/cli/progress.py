"""What happens on the terminal while a search runs: a progress bar, and Ctrl-C.

The first Ctrl-C asks the search to stop and hand over what it has; the second ends the program at once.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter
from types import FrameType
from typing import TYPE_CHECKING, cast

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID

__all__ = ["ask_to_stop", "progress_bar", "search_progress"]

INTERRUPTED = 130
# Seconds without a bar; loading it takes a tenth of one.
MOMENT = 1.0
ONLY_TASK = cast("TaskID", 0)


@contextmanager
def search_progress(first_run: bool) -> Iterator[Callable[[float, int], None]]:
    """The progress bar of a search, as a function of the fraction done and the fixtures found."""
    first = "Compiling the kernels, on the first run only" if first_run else None
    with progress_bar("Searching", "found", first) as progress:
        yield progress


@contextmanager
def progress_bar(doing: str, counted: str, first: str | None = None) -> Iterator[Callable[[float, int], None]]:
    """A progress bar on stderr, as a function of the fraction done and a count; quiet in a pipe.

    It appears when there is progress after a moment, so that what is done at once is not kept waiting for it.

    Parameters
    ----------
    doing : what is being done.
    counted : what the count is of, the word behind the number.
    first : what is said until the first progress; the bar appears with it at once.
    """
    if not sys.stderr.isatty():
        yield lambda fraction, count: None
        return
    begun = perf_counter()
    bars = [shown_bar(first, counted)] if first else []

    def progress(fraction: float, count: int) -> None:
        if not bars:
            if perf_counter() - begun < MOMENT:
                return
            bars.append(shown_bar(doing, counted))
        bars[0].update(ONLY_TASK, completed=fraction, count=count, description=doing)

    try:
        yield progress
    finally:
        for bar in bars:
            running.remove(bar)
            bar.stop()


def shown_bar(words: str, counted: str) -> Progress:
    """A bar on the terminal, with its one task."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

    bar = Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        TaskProgressColumn(),
        TextColumn(f"{{task.fields[count]}} {counted}"),
        TimeRemainingColumn(),
        console=Console(stderr=True),
        transient=True,
    )
    bar.add_task(words, total=1.0, count=0)
    bar.start()
    running.append(bar)
    return bar


# Bars on the terminal now; an abrupt end must give the cursor back.
running: list[Progress] = []


@contextmanager
def ask_to_stop() -> Iterator[threading.Event]:
    """An event that the first Ctrl-C within the block sets; another one ends the program."""
    event = threading.Event()
    if threading.current_thread() is not threading.main_thread():
        yield event
        return

    def interrupt(number: int, frame: FrameType | None) -> None:
        if event.is_set():
            for bar in running:
                bar.stop()
            os.write(2, b"workhold: interrupted; nothing was written.\n")
            # Threads of the search may be deep in compiled code: no orderly end waits for them.
            os._exit(INTERRUPTED)
        event.set()
        os.write(2, b"\nworkhold: stopping; what was found so far is kept (Ctrl-C again ends at once).\n")

    before = signal.signal(signal.SIGINT, interrupt)
    try:
        yield event
    finally:
        signal.signal(signal.SIGINT, before)
