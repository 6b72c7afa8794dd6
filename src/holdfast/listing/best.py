"""The best fixtures of a search while it runs, and the closure margin that a further one must reach."""

from __future__ import annotations

from threading import Event

import numpy as np
from attrs import define, field
from numpy.typing import NDArray

from holdfast.listing.deciding import Account
from holdfast.listing.finish import Candidates, finish, joined, listed_once, twins
from holdfast.listing.problem import Problem

__all__ = ["BestFixtures", "margin_digits"]

# A fixture may fall short of the margin to reach by this much and still be examined: margins are compared to 9 digits.
SLACK = 2e-9
# Records are decided when so many are waiting, or as many as are to be kept if that is more.
WAITING = 64


def margin_digits(null: NDArray[np.float64]) -> NDArray[np.float64]:
    """Closure margins (N,) of null vectors (N, 4), to the 9 digits that count in a ranking."""
    return np.asarray(np.round(null.min(axis=1), 9))


@define(eq=False)
class BestFixtures:
    """The best ``most`` fixtures of those added so far, and those that tie with the last of them.

    Parameters
    ----------
    problem : what is searched.
    most : how many to keep.
    cancel : see ``listing.finish.finish``.
    """

    problem: Problem
    most: int
    cancel: Event | None = None
    margin: float = 0.0
    waiting: list[NDArray[np.float64]] = field(factory=list)
    kept: Candidates | None = None
    accounts: list[Account] = field(factory=list)

    def add(self, records: NDArray[np.float64]) -> float:
        """Take records (N, 19) from the search; the closure margin that further ones must reach."""
        self.waiting.append(records)
        if sum(map(len, self.waiting)) >= max(WAITING, self.most):
            self.decide()
        return self.margin

    def decide(self) -> None:
        """Decide the records that wait, and keep the best."""
        fresh, account = finish(self.waiting, self.problem, None, self.cancel)
        self.waiting = []
        self.accounts.append(account)
        everything = fresh if self.kept is None else listed_once(joined([self.kept, fresh]))
        first, _ = twins(everything, self.problem.faces[everything.feature])
        if len(first) > self.most:
            last = np.sort(margin_digits(everything.null[first]))[-self.most]
            everything = everything.take(margin_digits(everything.null) >= last)
            self.margin = max(float(last) - SLACK, 0.0)
        self.kept = everything

    def finished(self) -> tuple[Candidates, Account]:
        """The fixtures kept and the account of all records, once the search is over."""
        self.decide()
        assert self.kept is not None
        return self.kept, Account.together(self.accounts)
