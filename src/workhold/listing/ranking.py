"""The order of fixtures: by figures of quality, the first of them counting most.

Every figure but the last counts to two significant digits, so that the next one has a say among fixtures that
are about as good. The last counts to nine decimals. Fixtures that are none for a workshop come after all
others. What is equal then stays in the order of types, holes, poses and faces. A fixture's place depends on
no other fixture. So the best of a part of a list are those of the whole that are in it, and ``--best`` needs
a part at a time.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

import numpy as np
from attrs import evolve
from numpy.typing import NDArray

from workhold.contact.problem import Problem
from workhold.conventions import FIGURE_DECIMALS
from workhold.model.fixture_table import FixtureTable
from workhold.model.quality import (
    CLAMP_FREEDOM,
    CLOSURE_MARGIN,
    FIGURES,
    PROGRAM_CLEARANCE,
    PROGRAM_FIGURE,
    RANKED,
    ranked_number,
)
from workhold.model.query import Query
from workhold.model.requirements import Tolerance
from workhold.statics.contact_matrix import Touched
from workhold.statics.judging import unfit
from workhold.statics.quality import quality_of

__all__ = [
    "best_marked",
    "best_possible",
    "figure_keys",
    "is_behind",
    "is_worse",
    "last_keys",
    "measured",
    "measured_as",
    "rank",
    "ranking_keys",
]

COARSE_DIGITS = 2


def measured(table: FixtureTable, problem: Problem) -> FixtureTable:
    """A table of fixtures of a problem with all its figures of quality."""
    touched = Touched.of(problem.workpiece, problem.toolkit, problem.loci, problem.wrench_length)
    return measured_as(table, problem.query, touched)


def measured_as(table: FixtureTable, query: Query, touched: Touched) -> FixtureTable:
    """A table with all its figures of quality; those of closure are as the search found them, to the last
    digit."""
    quality = quality_of(
        table,
        query.workpiece,
        query.toolkit,
        query.tolerance,
        query.loads,
        touched=touched,
        jaw_force=query.jaw_force,
        passed=query.passed,
        pressed_up_to=query.pressed_up_to,
    )
    quality[:, [CLOSURE_MARGIN, CLAMP_FREEDOM]] = table.quality[:, [CLOSURE_MARGIN, CLAMP_FREEDOM]]
    return evolve(table, quality=quality)


def ranking_keys(
    quality: NDArray[np.float64], ranking: Sequence[str], tolerance: Tolerance
) -> list[NDArray[np.float64]]:
    """Numbers (N,) to sort by, the first counting most and smaller being better, from figures of quality (N,
    12)."""
    return [unfit(quality, tolerance).astype(np.float64), *figure_keys(quality, ranking)]


def figure_keys(quality: NDArray[np.float64], ranking: Sequence[str]) -> list[NDArray[np.float64]]:
    """Numbers (N,) to sort by, as of :func:`ranking_keys`, without regard to what is no fixture for a
    workshop."""
    keys = []
    for place, key in enumerate(ranking):
        number = ranked_number(key)
        assert number is not None
        # Rounding must not separate fixtures that are equal, so what is coarse is rounded finely first.
        column = PROGRAM_CLEARANCE if RANKED[number] is PROGRAM_FIGURE else number
        values = np.round(quality[:, column], FIGURE_DECIMALS)
        if place < len(ranking) - 1:
            values = coarse(values)
        keys.append(-values if RANKED[number].more_is_better else values)
    return keys


def coarse(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Values (N,) to two significant digits; infinite ones as they are."""
    size = np.abs(values)
    known = np.isfinite(values) & (size > 0.0)
    exponent = np.floor(np.log10(np.where(known, size, 1.0)))
    step = 10.0 ** (exponent - (COARSE_DIGITS - 1))
    return np.where(known, np.rint(values / step) * step, values)


def rank(quality: NDArray[np.float64], ranking: Sequence[str], tolerance: Tolerance) -> NDArray[np.intp]:
    """Best first: the order of fixtures that are given in the order of their identities."""
    return np.lexsort(ranking_keys(quality, ranking, tolerance)[::-1])


def best_marked(
    quality: NDArray[np.float64], ranking: Sequence[str], tolerance: Tolerance, most: int, ties: bool
) -> NDArray[np.bool_]:
    """Which fixtures (N,), given in the order of their identities, are among the best ``most``.

    With ``ties`` those that tie with the last of them are, too.
    """
    order = rank(quality, ranking, tolerance)
    chosen = np.zeros(len(order), np.bool_)
    chosen[order[:most]] = True
    if ties and most < len(order):
        keys = ranking_keys(quality, ranking, tolerance)
        last = order[most - 1]
        chosen |= np.all([key == key[last] for key in keys], axis=0)
    return chosen


def best_possible(count: int, query: Query) -> NDArray[np.float64]:
    """Figures of quality of so many fixtures (N, F), none of any fixture of a query being better.

    The closure margin is a share of one, so of all pegs at most an equal one, and clamp freedom 90 degrees.
    """
    best = np.array([inf if figure.more_is_better else 0.0 for figure in FIGURES])
    best[[CLOSURE_MARGIN, CLAMP_FREEDOM]] = 1.0 / query.toolkit.peg_count, 90.0
    # With a program the clearance of its tools stands behind.
    return np.tile(best if query.program is None else np.append(best, inf), (count, 1))


def last_keys(quality: NDArray[np.float64], query: Query, most: int) -> NDArray[np.float64]:
    """The keys (R,) of the last of the best ``most`` of as many fixtures or more, infinite for NaN."""
    keys = np.stack(ranking_keys(quality, query.ranking, query.tolerance), axis=1)
    worst = keys[rank(quality, query.ranking, query.tolerance)[most - 1]]
    return np.asarray(np.where(np.isnan(worst), np.inf, worst))


def is_behind(bound: NDArray[np.float64], last: NDArray[np.float64] | None) -> bool:
    """Whether keys (R,) come after those of the last of the best; not while there are too few to have one."""
    return last is not None and bool(is_worse(bound[None], last)[0])


def is_worse(keys: NDArray[np.float64], last: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which keys (N, R) come after others (R,) in lexicographic order."""
    worse, equal = np.zeros(len(keys), np.bool_), np.ones(len(keys), np.bool_)
    for values, one in zip(keys.T, last.tolist(), strict=True):
        worse |= equal & (values > one)
        equal &= values == one
    return worse
