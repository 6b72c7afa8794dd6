"""A search in shares, each of which is looked at whole before the next: what locators find in it, put
together by the clamping.

Locators fix the pose in one of two ways. On a lattice of holes they are sought by ranges of orientation
(``search.lattice_shares``), beside a wall by the hull edges that may lie on it (``search.wall_shares``). In
each share the contacts of locators with one clamp are found. With one clamp they are the fixtures; of two
clamps they make seats, whose clamps are paired (``listing.clamped_seats``).
"""

from __future__ import annotations

from threading import Event
from typing import Any, Protocol

from attrs import evolve

from workhold.contact.problem import Progress
from workhold.fixels.toolkit import Toolkit
from workhold.listing.listed import Work, stage
from workhold.model.query import Query
from workhold.model.result import Result
from workhold.proof.deciding import Account
from workhold.search.preview import Preview

__all__ = ["Collector", "Locating", "answer_in_shares", "one_clamp"]


# Shares after which what has been found so far is shown.
MOST_PREVIEWS = 8


class Collector(Protocol):
    """What takes the findings of shares and makes a result of them; its length is how many fixtures there are
    so far."""

    def __len__(self) -> int: ...

    def add(self, found: Any) -> None:
        """Takes the findings of a share."""

    def result(self, account: Account, work: Work) -> Result:
        """The result of all."""


class Locating(Protocol):
    """How locators fix the part, share by share."""

    @property
    def shares(self) -> int:
        """How many shares there are."""

    @property
    def collector(self) -> Collector:
        """What takes the findings."""

    def look(self, share: int, progress: Progress | None) -> tuple[Any, bool]:
        """What is found in a share, as the collector takes it, if there is anything; and whether the share
        was looked at to its end."""

    def account(self) -> Account:
        """What became of all contacts so far."""

    def work(self, done: int, complete: bool) -> Work:
        """How the search went, when so many shares were looked at to their end."""

    def why_none(self) -> str:
        """Why a search that came to its end has no fixture."""


def answer_in_shares(
    locating: Locating, progress: Progress | None, cancel: Event | None, preview: Preview | None = None
) -> Result:
    """The fixtures that a search finds share by share, see ``search.design.answer``."""
    kept, done = locating.collector, 0
    for number in range(locating.shares):
        if cancel is not None and cancel.is_set():
            break
        end = (number + 1) / locating.shares
        found, is_whole = locating.look(number, stage(progress, number / locating.shares, end))
        if found is not None:
            kept.add(found)
        done += is_whole
        if progress is not None and is_whole:
            progress(end, len(kept))
        if preview is not None and number < MOST_PREVIEWS:
            preview(kept.result(Account(0, 0, 0, 0, ()), Work(False, {})))
    result = kept.result(locating.account(), locating.work(done, done == locating.shares))
    if not result.complete or any(result.found.values()) or result.reasons:
        return result
    return evolve(result, notes=(locating.why_none(),))


def one_clamp(query: Query, way: Toolkit) -> Query:
    """A query with one clamp of those that are needed together, in one direction."""
    return evolve(query, toolkit=way, arrangements=None, ranking=None, best=None, listing=None)
