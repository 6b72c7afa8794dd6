"""What a queue is: it takes tasks, gives them to workers, and hands over what came of them."""

from __future__ import annotations

from collections.abc import Iterator
from threading import Event
from typing import Protocol

from workhold.batch.tasks import Outcome, Task

__all__ = ["MOST_TRIES", "Queue", "Watcher"]

# A task whose worker died is tried so many times: once more by another one, then it is named.
MOST_TRIES = 2


class Watcher(Protocol):
    """Who looks on."""

    def begun(self, worker: str, title: str) -> None:
        """A worker begins with a task."""

    def ended(self, worker: str) -> None:
        """A worker has nothing to do, or is no more."""

    def told(self, sentence: str) -> None:
        """Something happened that is to be told, such as the death of a worker."""


class Queue(Protocol):
    """What gives tasks to workers."""

    def run(self, tasks: Iterator[Task], stop: Event) -> Iterator[Outcome]:
        """Do tasks, which are taken in their order when there is a worker for them; outcomes come as they do.

        Parameters
        ----------
        stop : when set, no further task is taken, those begun are given up, and the outcomes end.

        Raises
        ------
        InputError
            When there are no workers and there will be none.
        """
