"""The order of fixtures: by figures of quality, the first of them counting most.

Every figure but the last counts to two significant digits, so that the next one has a say among fixtures that are about
as good; the last counts to nine. What is equal then stays in the order of types, holes, poses and faces.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from attrs import evolve
from numpy.typing import NDArray

from workhold.contact.problem import Problem
from workhold.model.quality import CLOSURE_MARGIN, FIGURES, figure_number
from workhold.model.result import FixtureTable
from workhold.statics.contact_matrix import Touched
from workhold.statics.quality import quality_of

__all__ = ["best_marked", "measured", "rank"]

FINE_DIGITS = 9
COARSE_DIGITS = 2


def measured(table: FixtureTable, problem: Problem, threads: int = 1) -> FixtureTable:
    """A table with all its figures of quality; the closure margin is that of its null vectors, to the last digit."""
    part, vise, query = problem.workpiece, problem.vise, problem.query
    touched = Touched.of(part, vise, problem.locus, problem.wrench_length)
    quality = quality_of(table, part, vise, query.tolerance, query.loads, threads, touched)
    quality[:, CLOSURE_MARGIN] = table.quality[:, CLOSURE_MARGIN]
    return evolve(table, quality=quality)


def ranking_keys(quality: NDArray[np.float64], ranking: Sequence[str]) -> list[NDArray[np.float64]]:
    """Numbers (N,) to sort by, the first counting most and smaller being better, from figures of quality (N, 6)."""
    keys = []
    for place, key in enumerate(ranking):
        number = figure_number(key)
        assert number is not None
        # Rounding must not tell fixtures apart that are equal, so what is coarse is rounded finely first.
        values = np.round(quality[:, number], FINE_DIGITS)
        if place < len(ranking) - 1:
            values = coarse(values)
        keys.append(-values if FIGURES[number].more_is_better else values)
    return keys


def coarse(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Values (N,) to two significant digits; infinite ones as they are."""
    size = np.abs(values)
    known = np.isfinite(values) & (size > 0.0)
    exponent = np.floor(np.log10(np.where(known, size, 1.0)))
    step = 10.0 ** (exponent - (COARSE_DIGITS - 1))
    return np.where(known, np.rint(values / step) * step, values)


def rank(quality: NDArray[np.float64], ranking: Sequence[str]) -> NDArray[np.intp]:
    """Best first: the order of fixtures that are given in the order of their identities."""
    keys = ranking_keys(quality, ranking)
    if len(keys) == 1:
        return np.argsort(keys[0], kind="stable")
    return np.lexsort(keys[::-1])


def best_marked(quality: NDArray[np.float64], ranking: Sequence[str], most: int, ties: bool) -> NDArray[np.bool_]:
    """Which fixtures (N,), given in the order of their identities, are among the best ``most``.

    With ``ties`` those that tie with the last of them are, too.
    """
    order = rank(quality, ranking)
    chosen = np.zeros(len(order), np.bool_)
    chosen[order[:most]] = True
    if ties and most < len(order):
        keys = ranking_keys(quality, ranking)
        last = order[most - 1]
        chosen |= np.all([key == key[last] for key in keys], axis=0)
    return chosen
