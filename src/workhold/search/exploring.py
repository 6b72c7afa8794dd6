"""Which toolkit to buy: the same part tried in many, with the number of fixtures and the best quality in each."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from threading import Event

import numpy as np
from attrs import frozen

from workhold.errors import InputError
from workhold.model.quality import FIGURES, figure_number
from workhold.model.query import Query
from workhold.model.result import FixtureTable
from workhold.search.design import answer

__all__ = ["Explored", "best_of", "explore"]


@frozen
class Explored:
    """What one toolkit can do for a part.

    Parameters
    ----------
    name : what it is called.
    found : fixtures of each arrangement; empty for a toolkit that cannot be.
    best : the best value of each figure of quality over all fixtures; empty when there is none.
    reason : why there is no fixture, or why the toolkit cannot be; empty otherwise.
    """

    name: str
    found: Mapping[str, int]
    best: Mapping[str, float]
    reason: str = ""

    @property
    def fixtures(self) -> int:
        """How many fixtures there are."""
        return sum(self.found.values())


def explore(queries: Iterable[tuple[str, Query | InputError]], cancel: Event | None = None) -> Iterator[Explored]:
    """Answer the same query for one toolkit after the other.

    Parameters
    ----------
    queries : what each toolkit is called, and the query, or why there is none.
    cancel : when set, no further query is answered.
    """
    for name, query in queries:
        if cancel is not None and cancel.is_set():
            return
        try:
            if isinstance(query, InputError):
                raise query
            result = answer(query, cancel=cancel)
        except InputError as error:
            yield Explored(name, {}, {}, str(error))
            continue
        if not result.complete:
            return
        reason = "" if len(result) else " ".join(result.notes)
        yield Explored(name, dict(result.found), best_values(result.table), reason)


def best_values(table: FixtureTable) -> dict[str, float]:
    """The best value of each known figure of quality of a table, by its key."""
    if len(table) == 0:
        return {}
    best = {}
    for number, figure in enumerate(FIGURES):
        values = table.quality[:, number]
        if np.isfinite(values).all():
            best[figure.key] = float(values.max() if figure.more_is_better else values.min())
    return best


def best_of(explored: Sequence[Explored], key: str) -> Explored | None:
    """The toolkit with the best value of a figure; None when none has a fixture."""
    number = figure_number(key)
    assert number is not None
    figure = FIGURES[number]
    able = [item for item in explored if key in item.best]
    if not able:
        return None
    return (max if figure.more_is_better else min)(able, key=lambda item: round(item.best[key], 9))
