"""The first fixtures of a search while it still runs: a part of what was found, decided ahead of the rest."""

from __future__ import annotations

from collections.abc import Callable
from threading import Event
from time import perf_counter

import numpy as np
from attrs import define, field
from numpy.typing import NDArray

from workhold.contact.problem import Problem
from workhold.listing.canonical_form import Candidates, joined, listed_once
from workhold.listing.finish import finish
from workhold.listing.listed import Work, result_of
from workhold.model.result import Result

__all__ = ["Preview", "Previews"]

Preview = Callable[[Result], None]

# Seconds between previews, and how many times longer the search must have run than its previews took.
PAUSE = 0.3
SHARE = 25.0
# Records decided for one preview, and fixtures after which there are no more of them.
MOST_RECORDS = 300
ENOUGH = 1_000


@define(eq=False)
class Previews:
    """Shows fixtures while the search goes on; each preview holds those of the ones before it.

    Only what is decided quickly is shown. The results are marked incomplete, and their counts are of what
    they list.

    Parameters
    ----------
    problem : what is searched.
    show : called with a result from the thread that calls :meth:`add`.
    """

    problem: Problem
    show: Preview
    newest: NDArray[np.float64] | None = field(default=None, init=False)
    shown: Candidates | None = field(default=None, init=False)
    began: float = field(factory=perf_counter, init=False)
    next_time: float = field(init=False)
    spent: float = field(default=0.0, init=False)
    hurry: Event = field(factory=Event, init=False)

    def __attrs_post_init__(self) -> None:
        self.next_time = self.began + PAUSE
        self.hurry.set()

    def add(self, records: NDArray[np.float64]) -> None:
        """Takes records (N, 19) that the search found, and shows some if it is time."""
        if self.shown is not None and len(self.shown.standing) >= ENOUGH:
            return
        if len(records):
            before = records[:0] if self.newest is None else self.newest
            self.newest = np.concatenate([before, records[-MOST_RECORDS:]])[-MOST_RECORDS:]
        start = perf_counter()
        if self.newest is None or start < self.next_time:
            return
        fresh, account = finish([self.newest], self.problem, self.hurry)
        self.newest = None
        together = fresh if self.shown is None else listed_once(joined([self.shown, fresh]))
        if len(fresh.standing):
            self.shown = together
            work = Work(complete=False, statistics={})
            self.show(result_of(self.problem, together, account, work))
        end = perf_counter()
        self.spent += end - start
        self.next_time = max(end + PAUSE, self.began + SHARE * self.spent)
