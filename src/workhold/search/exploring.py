"""Which vise to buy: the same part tried in many vises, with the number of fixtures and the best quality in each."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from threading import Event
from typing import Any

import numpy as np
from attrs import frozen

from workhold.errors import InputError
from workhold.model.quality import FIGURES, figure_number
from workhold.model.result import FixtureTable
from workhold.model.vise import Vise
from workhold.model.workpiece import Workpiece
from workhold.search.design import design

__all__ = ["Explored", "best_of", "explore"]


@frozen
class Explored:
    """What one vise can do for a part.

    Parameters
    ----------
    name : what the vise is called.
    found : fixtures of each type.
    best : the best value of each figure of quality over all fixtures; empty when there is none.
    reason : why there is no fixture, or why the vise cannot be; empty otherwise.
    """

    name: str
    found: Mapping[str, int]
    best: Mapping[str, float]
    reason: str = ""

    @property
    def fixtures(self) -> int:
        """How many fixtures there are."""
        return sum(self.found.values())


def explore(
    workpiece: Workpiece,
    vises: Iterable[tuple[str, Mapping[str, Any]]],
    *,
    tolerances: Mapping[str, Any] | None = None,
    cancel: Event | None = None,
    **options: Any,
) -> Iterator[Explored]:
    """Try vises one after the other.

    Parameters
    ----------
    vises : names and keyword arguments of each vise.
    tolerances : what is known of how far pegs and faces may be off, by the vise's name.
    cancel : when set, no further vise is tried.
    options : as for ``workhold.design``.

    Raises
    ------
    InputError
        For options that no vise could make good.
    """
    for name, fields in vises:
        if cancel is not None and cancel.is_set():
            return
        given = dict(options)
        if tolerances is not None and name in tolerances:
            given["tolerance"] = tolerances[name]
        try:
            result = design(workpiece, Vise(**fields), cancel=cancel, **given)
        except InputError as error:
            yield Explored(name, {"I": 0, "II": 0}, {}, str(error))
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
    """The vise with the best value of a figure; None when no vise has a fixture."""
    number = figure_number(key)
    assert number is not None
    figure = FIGURES[number]
    able = [item for item in explored if key in item.best]
    if not able:
        return None
    return (max if figure.more_is_better else min)(able, key=lambda item: round(item.best[key], 9))
