"""What happens on the terminal while a search runs: a progress bar."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter
from typing import TYPE_CHECKING, cast

from workhold.cli.ending import keep_what_is_found

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID

__all__ = ["progress_bar", "search_progress"]

# Seconds without a bar; loading it takes a tenth of one.
MOMENT = 1.0
ONLY_TASK = cast("TaskID", 0)


@contextmanager
def search_progress(keeps: bool = True) -> Iterator[Callable[[float, int], None]]:
    """The progress bar of a search, as a function of the fraction done and the fixtures found, which are to be kept where
    ``keeps`` says so."""
    with progress_bar("Searching", "found") as show:

        def progress(fraction: float, found: int) -> None:
            if found and keeps:
                keep_what_is_found()
            show(fraction, found)

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
    return bar
