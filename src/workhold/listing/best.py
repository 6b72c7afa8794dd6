"""The best fixtures of a search while it runs, and the closure margin that a further one must reach."""

from __future__ import annotations

from threading import Event

import numpy as np
from attrs import define, field
from numpy.typing import NDArray

from workhold.contact.problem import Problem
from workhold.conventions import MARGIN_SLACK
from workhold.listing.canonical_form import Candidates, joined, listed_once
from workhold.listing.finish import BLOCK, blocks_of, listed_form
from workhold.listing.placing import placed
from workhold.listing.ranking import best_marked, measured
from workhold.model.quality import CLOSURE_MARGIN
from workhold.proof.deciding import Account, Course
from workhold.statics.judging import unfit

__all__ = ["BestFixtures"]

# Records are decided when so many are waiting, or as many as are to be kept if that is more: soon where they
# tell a margin that further ones must reach, else in blocks that cost the least.
WAITING, WAITING_LONG = 64, 1 << 13


@define(eq=False)
class BestFixtures:
    """The best of the fixtures added so far, as many as the query asks for, and those that tie with the last
    of them.

    Parameters
    ----------
    problem : what is searched.
    cancel : when set, only what needs no ball arithmetic and the like is decided, and soon after nothing.
    """

    problem: Problem
    cancel: Event | None = None
    margin: float = field(default=0.0, init=False)
    has_dropped: bool = field(default=False, init=False)
    waiting: list[NDArray[np.float64]] = field(factory=list, init=False)
    kept: Candidates | None = field(default=None, init=False)
    accounts: list[Account] = field(factory=list, init=False)
    course: Course = field(init=False)

    def __attrs_post_init__(self) -> None:
        self.course = Course(0, cancel=self.cancel)

    @property
    def most(self) -> int:
        """How many to keep."""
        assert self.problem.query.best is not None
        return self.problem.query.best

    def add(self, records: NDArray[np.float64]) -> float:
        """Takes records (N, 19) from the search; the closure margin that further ones must reach."""
        self.waiting.append(records)
        least = WAITING if self.problem.query.by_margin_alone else WAITING_LONG
        if sum(map(len, self.waiting)) >= max(least, self.most):
            self.decide()
        return self.margin

    def decide(self) -> None:
        """Decides the records that wait, and keeps the best."""
        waiting, self.waiting = self.waiting, []
        parts = [] if self.kept is None else [self.kept]
        fresh = 0
        for block in blocks_of(waiting):
            part, account = listed_form(block, self.problem, self.course)
            self.accounts.append(account)
            parts.append(part)
            fresh += len(part.standing)
            # Measured a share at a time, so that one who asks to stop does not wait for all.
            if fresh >= max(BLOCK, self.most):
                parts, fresh = [self.cut(listed_once(joined(parts)), ties=True)], 0
        self.kept = self.cut(listed_once(joined(parts)), ties=True)

    def cut(self, everything: Candidates, ties: bool) -> Candidates:
        """The best ``most`` of fixtures that are listed once, and those that tie with the last."""
        if len(everything.standing) <= self.most:
            return everything
        table = measured(placed(everything, self.problem), self.problem)
        query = self.problem.query
        chosen = best_marked(table.quality, query.ranking, query.tolerance, self.most, ties)
        self.has_dropped |= not chosen.all()
        # One that is none for a workshop is worse than any that is, whatever its margin.
        if query.by_margin_alone and not unfit(table.quality[chosen], query.tolerance).any():
            self.margin = max(float(table.quality[chosen, CLOSURE_MARGIN].min()) - MARGIN_SLACK, 0.0)
        return everything.take(chosen)

    def finished(self) -> tuple[Candidates, Account]:
        """The best fixtures and the account of all records, once the search is over."""
        self.decide()
        assert self.kept is not None
        return self.cut(self.kept, ties=False), Account.together(self.accounts)
