"""What happens on the terminal while a batch runs: how far it is, and what each worker has in hand."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from attrs import define, field

from workhold.cli.saying import tell
from workhold.plain import plain

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID

__all__ = ["BatchProgress", "batch_progress"]

# Letters of what a worker has in hand.
LONGEST_TITLE = 60


@define(eq=False)
class BatchProgress:
    """Counts along and looks on (``batch.run.Counting``, ``batch.queues.Watcher``); quiet where there are no bars.

    Parameters
    ----------
    bars : on a terminal.
    events : what happened on the way, in sentences.
    """

    bars: Progress | None
    events: list[str] = field(factory=list, init=False)
    whole: TaskID | None = field(default=None, init=False)
    hands: dict[str, TaskID] = field(factory=dict, init=False)
    count: int = field(default=0, init=False)
    done: int = field(default=0, init=False)

    def stage(self, doing: str, count: int, seconds: float) -> None:
        """See :class:`workhold.batch.run.Counting`."""
        self.count, self.done = count, 0
        if self.bars is None or count == 0:
            return
        if self.whole is not None:
            self.bars.remove_task(self.whole)
        self.whole = self.bars.add_task(doing, total=max(seconds, 1e-9), words=self.words)

    @property
    def words(self) -> str:
        """How many tasks are done."""
        return f"{self.done:,} of {self.count:,}"

    def one_done(self, seconds: float) -> None:
        """See :class:`workhold.batch.run.Counting`."""
        self.done += 1
        if self.bars is not None and self.whole is not None:
            self.bars.update(self.whole, advance=seconds, words=self.words)

    def begun(self, worker: str, title: str) -> None:
        """See :class:`workhold.batch.queues.Watcher`."""
        if self.bars is None:
            return
        self.ended(worker)
        words = plain(title)[:LONGEST_TITLE].replace("[", "\\[")
        self.hands[worker] = self.bars.add_task(f"  {worker}: {words}", total=None, words="")

    def ended(self, worker: str) -> None:
        """See :class:`workhold.batch.queues.Watcher`."""
        if self.bars is not None and worker in self.hands:
            self.bars.remove_task(self.hands.pop(worker))

    def told(self, sentence: str) -> None:
        """See :class:`workhold.batch.queues.Watcher`."""
        self.events.append(sentence)
        if self.bars is None:
            tell(sentence)
        else:
            self.bars.console.print(f"workhold: {plain(sentence)}", markup=False, highlight=False)


@contextmanager
def batch_progress() -> Iterator[BatchProgress]:
    """The progress of a batch on stderr; quiet in a pipe, but for what happens to workers."""
    if not sys.stderr.isatty():
        yield BatchProgress(None)
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, ProgressColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn
    from rich.progress import Task as Line
    from rich.text import Text

    class Rest(ProgressColumn):
        """What is left of all tasks; how long a worker is at one."""

        left, spent = TimeRemainingColumn(), TimeElapsedColumn()

        def render(self, task: Line) -> Text:
            return self.spent.render(task) if task.total is None else self.left.render(task)

    class Bar(BarColumn):
        """Of all tasks only."""

        def render(self, task: Line) -> Text:  # type: ignore[override]
            return Text("") if task.total is None else super().render(task)  # type: ignore[return-value]

    columns = TextColumn("{task.description}"), Bar(20), TextColumn("{task.fields[words]}"), Rest()
    with Progress(*columns, console=Console(stderr=True), transient=True) as bars:
        yield BatchProgress(bars)
