"""Progress on the terminal: a bar while a search runs, and a line for each process while a batch runs."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter
from typing import TYPE_CHECKING, cast

from attrs import define, field

from workhold.cli.commands import print_remark
from workhold.cli.ending import note_results_to_keep
from workhold.errors import make_printable

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID

__all__ = ["BatchProgress", "show_batch_progress", "show_progress", "show_search_progress"]

# Seconds without a bar; loading it takes a tenth of one.
MOMENT = 1.0
ONLY_TASK = cast("TaskID", 0)


@contextmanager
def show_search_progress(keeps: bool = True) -> Iterator[Callable[[float, int], None]]:
    """Yield a function that shows progress: call it with the fraction done and the number of fixtures found.

    Where ``keeps`` is true, an interrupted search that has found fixtures gets time to return them.
    """
    with show_progress("Searching", "found") as show:

        def report_progress(fraction: float, found: int) -> None:
            """Show progress, and note that there are findings to keep."""
            if found and keeps:
                note_results_to_keep()
            show(fraction, found)

        yield report_progress


@contextmanager
def show_progress(
    doing: str, counted: str, first: str | None = None
) -> Iterator[Callable[[float, int], None]]:
    """Yield a function that shows a progress bar on stderr:
    call it with the fraction done and a count; silent in a pipe.

    The bar appears at the first call after :data:`MOMENT` seconds, or at once where ``first`` is given.

    Parameters
    ----------
    doing : phrase on the work in progress.
    counted : word shown after the count.
    first : text shown until the first call; None to show nothing until then.
    """
    if not sys.stderr.isatty():
        yield lambda fraction, count: None
        return
    begun = perf_counter()
    bars = [make_progress_bar(first, counted)] if first else []

    def progress(fraction: float, count: int) -> None:
        """Advance the bar, making it if its time has come."""
        if not bars:
            if perf_counter() - begun < MOMENT:
                return
            bars.append(make_progress_bar(doing, counted))
        bars[0].update(ONLY_TASK, completed=fraction, count=count, description=doing)

    try:
        yield progress
    finally:
        for bar in bars:
            bar.stop()


def make_progress_bar(words: str, counted: str) -> Progress:
    """Return a started bar of rich with one task from 0 to 1, the word ``counted`` behind its count."""
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


# Letters of what a worker has in hand.
LONGEST_TITLE = 60


@define(eq=False)
class BatchProgress:
    """The progress of a batch (``batch.run.ProgressCounter``, ``batch.tasks.TaskObserver``); silent without bars.

    Parameters
    ----------
    bars : the bars on a terminal; None where there is no terminal.
    events : sentences on events of the run.
    """

    bars: Progress | None
    events: list[str] = field(factory=list, init=False)
    whole: TaskID | None = field(default=None, init=False)
    hands: dict[str, TaskID] = field(factory=dict, init=False)
    count: int = field(default=0, init=False)
    done: int = field(default=0, init=False)

    def begin_stage(self, doing: str, count: int, seconds: float) -> None:
        """Begin a stage of ``count`` tasks that take about ``seconds`` in all.

        Its bar replaces that of the stage before.
        """
        self.count, self.done = count, 0
        if self.bars is None or count == 0:
            return
        if self.whole is not None:
            self.bars.remove_task(self.whole)
        self.whole = self.bars.add_task(doing, total=max(seconds, 1e-9), words=self.words)

    @property
    def words(self) -> str:
        """Text such as "3 of 12": tasks done of those in the stage."""
        return f"{self.done:,} of {self.count:,}"

    def count_done(self, seconds: float) -> None:
        """Count a task as done, and advance the bar by the seconds it was expected to take."""
        self.done += 1
        if self.bars is not None and self.whole is not None:
            self.bars.update(self.whole, advance=seconds, words=self.words)

    def note_begun(self, worker: str, title: str) -> None:
        """Show the task that a worker has begun, on a separate line."""
        if self.bars is None:
            return
        self.note_ended(worker)
        words = make_printable(title)[:LONGEST_TITLE].replace("[", "\\[")
        self.hands[worker] = self.bars.add_task(f"  {worker}: {words}", total=None, words="")

    def note_ended(self, worker: str) -> None:
        """Remove the line of a worker's task, if there is one."""
        if self.bars is not None and worker in self.hands:
            self.bars.remove_task(self.hands.pop(worker))

    def notify(self, sentence: str) -> None:
        """Keep a sentence among the events, and print it."""
        self.events.append(sentence)
        if self.bars is None:
            print_remark(sentence)
        else:
            self.bars.console.print(f"workhold: {make_printable(sentence)}", markup=False, highlight=False)


@contextmanager
def show_batch_progress() -> Iterator[BatchProgress]:
    """Yield the progress of a batch, with bars on stderr at a terminal; in a pipe only events are printed."""
    if not sys.stderr.isatty():
        yield BatchProgress(None)
        return
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        Progress,
        ProgressColumn,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )
    from rich.progress import Task as Line
    from rich.text import Text

    class Rest(ProgressColumn):
        """The time left of all tasks, and the time that a worker has spent on its task."""

        left, spent = TimeRemainingColumn(), TimeElapsedColumn()

        def render(self, task: Line) -> Text:
            return self.spent.render(task) if task.total is None else self.left.render(task)

    class Bar(BarColumn):
        """A bar in the line of all tasks, and none in the lines of workers."""

        def render(self, task: Line) -> Text:  # type: ignore[override]
            return Text("") if task.total is None else super().render(task)  # type: ignore[return-value]

    columns = TextColumn("{task.description}"), Bar(20), TextColumn("{task.fields[words]}"), Rest()
    with Progress(*columns, console=Console(stderr=True), transient=True) as bars:
        yield BatchProgress(bars)
