"""Which toolkit to buy: the same part tried in many, with the number of fixtures and the first choice in
each."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from threading import Event

import numpy as np
from attrs import frozen

from workhold.errors import InputError
from workhold.listing.ranking import figure_keys
from workhold.model.quality import FIGURES
from workhold.model.query import Query
from workhold.search.design import answer
from workhold.statics.judging import unfit

__all__ = ["Explored", "explore", "first_choice"]


@frozen
class Explored:
    """What one toolkit can do for a part.

    Parameters
    ----------
    name : what it is called.
    found : fixtures of each arrangement; empty for a toolkit that cannot be.
    figures : of the first fixture, the one to set up; empty when there is none.
    fit : whether that is a fixture for a workshop.
    reason : why there is no fixture, or why the toolkit cannot be; empty otherwise.
    """

    name: str
    found: Mapping[str, int]
    figures: Mapping[str, float]
    reason: str = ""
    fit: bool = False

    @property
    def fixtures(self) -> int:
        """How many fixtures there are."""
        return sum(self.found.values())


def explore(
    queries: Iterable[tuple[str, Query | InputError]], cancel: Event | None = None
) -> Iterator[Explored]:
    """Answers the same query for one toolkit after the other.

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
        reason = "" if len(result) else " ".join(result.reasons)
        figures = dict(result[0].quality) if len(result) else {}
        fit = bool(figures) and not unfit(result.table.quality[:1], result.query.tolerance)[0]
        yield Explored(name, dict(result.found), figures, reason, fit)


def first_choice(
    explored: Sequence[Explored], ranking: Sequence[str], is_sold: Callable[[str], bool] = lambda name: True
) -> Explored | None:
    """The toolkit whose first fixture stands first among those of all; None when none has a fixture.

    A fixture for a workshop goes before one that is none, and what is sold, as ``is_sold`` says of a name,
    before what nobody sells.
    """
    able = [item for item in explored if item.figures]
    if not able:
        return None
    quality = np.array([[item.figures.get(figure.key, np.nan) for figure in FIGURES] for item in able])
    keys = [(not item.fit, not is_sold(item.name)) for item in able]
    order = sorted(
        range(len(able)), key=lambda k: (keys[k], *(key[k] for key in figure_keys(quality, ranking)))
    )
    return able[order[0]]
