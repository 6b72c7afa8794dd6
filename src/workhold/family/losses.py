"""The loss of each fixture, and which fixtures may be used at all."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, isfinite

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.conventions import FIGURE_DECIMALS
from workhold.errors import InputError
from workhold.model.quality import FIGURES, Figure, figure_number
from workhold.model.query import DEFAULT_RANKING, PAIR_RANKING
from workhold.model.result import FixtureTable
from workhold.model.tolerance import Tolerance
from workhold.statics.judging import unfit

__all__ = ["RANKINGS", "Threshold", "loss_text", "losses", "may_be_used", "threshold"]

# A family is asked for what it loses in location; after that what a machinist looks at counts, by how many things move.
LOCATION = "location_error"
RANKINGS = {1: (LOCATION, *DEFAULT_RANKING), 2: (LOCATION, *PAIR_RANKING)}
# Losses are told apart to so many decimals.
LOSS_DECIMALS = 9


@frozen
class Threshold:
    """What a figure of every fixture used must reach.

    Parameters
    ----------
    figure : which figure.
    value : the largest it may be, or the smallest where more is better; in the figure's unit.
    """

    figure: Figure
    value: float


def threshold(name: str, value: float) -> Threshold:
    """The threshold of a figure named as a user writes it.

    Raises
    ------
    InputError
        For a name that is no figure.
    """
    number = figure_number(name)
    if number is None:
        raise InputError(f"{name!r} is no figure: choose among {', '.join(figure.option for figure in FIGURES)}.")
    return Threshold(FIGURES[number], value)


def losses(values: NDArray[np.float64], figure: Figure) -> NDArray[np.float64]:
    """The losses (N,) of fixtures with values (N,) of a figure: over the best of them, 1 or more.

    Beside a best of zero everything else is infinitely worse; what is no number is so, too.
    """
    values = np.round(values, FIGURE_DECIMALS)
    known = values[~np.isnan(values)]
    if len(known) == 0:
        return np.full(len(values), np.inf)
    best = known.max() if figure.more_is_better else known.min()
    above, below = (
        (np.full(len(values), best), values) if figure.more_is_better else (values, np.full(len(values), best))
    )
    usable = (below > 0.0) & np.isfinite(above) & np.isfinite(below)
    ratio = np.full(len(values), np.inf)
    np.divide(above, below, out=ratio, where=usable)
    return np.where(values == best, 1.0, np.maximum(np.round(ratio, LOSS_DECIMALS), 1.0))


def loss_text(loss: float) -> str:
    """A loss as it is shown, rounded up, so that what is shown is one within which it is.

    >>> loss_text(1.0), loss_text(1.1871), loss_text(float("inf"))
    ('1.000', '1.188', 'any')
    """
    return f"{ceil(loss * 1000 - 1e-6) / 1000:.3f}" if isfinite(loss) else "any"


def may_be_used(
    table: FixtureTable, thresholds: Sequence[Threshold], tolerance: Tolerance, with_unfit: bool
) -> NDArray[np.bool_]:
    """Which fixtures (N,) may be used: those for a workshop, unless all are asked for, that reach every threshold."""
    good = np.ones(len(table), np.bool_) if with_unfit else ~unfit(table.quality, tolerance)
    for one in thresholds:
        values = np.round(table.quality[:, FIGURES.index(one.figure)], FIGURE_DECIMALS)
        good &= values >= one.value if one.figure.more_is_better else values <= one.value
    return good
