"""The order of fixtures: by figures of quality, the first of them counting most.

Every figure but the last counts to two significant digits, so that the next one has a say among fixtures that are about
as good; the last counts to nine. What is equal then stays in the order of types, holes, poses and faces.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from attrs import evolve, field, frozen
from numpy.typing import NDArray

from workhold.contact.problem import Problem
from workhold.errors import InputError
from workhold.model.load import Load
from workhold.model.quality import CLOSURE_MARGIN, FIGURES, LOAD_REACTION, figure_number
from workhold.model.result import FixtureTable
from workhold.model.tolerance import Tolerance
from workhold.statics.contact_matrix import Touched
from workhold.statics.quality import quality_of

__all__ = ["DEFAULT_RANKING", "Preference", "best_marked", "preference_of", "rank"]

# Repeatable first: a fixture that places every part alike; then strong: one that does not press the part out of shape.
DEFAULT_RANKING = ("location_error", "clamp_amplification", "closure_margin")
LOADED_RANKING = ("location_error", "load_reaction", "closure_margin")
FINE_DIGITS = 9
COARSE_DIGITS = 2


@frozen
class Preference:
    """What makes one fixture better than another.

    Parameters
    ----------
    ranking : keys of figures of quality, the first counting most.
    tolerance : how far pegs and faces may be off.
    loads : what the fixture must resist.
    """

    ranking: tuple[str, ...] = DEFAULT_RANKING
    tolerance: Tolerance = field(factory=Tolerance)
    loads: tuple[Load, ...] = ()

    @property
    def by_margin_alone(self) -> bool:
        """Whether fixtures are ranked by the closure margin and nothing else, which a search can bound."""
        return self.ranking == (FIGURES[CLOSURE_MARGIN].key,)

    def measured(self, table: FixtureTable, problem: Problem, threads: int = 1) -> FixtureTable:
        """A table with all its figures of quality; the closure margin is that of its null vectors, to the last digit."""
        part, vise = problem.workpiece, problem.vise
        touched = Touched.of(part, vise, problem.locus, problem.wrench_length)
        quality = quality_of(table, part, vise, self.tolerance, self.loads, threads, touched)
        quality[:, CLOSURE_MARGIN] = table.quality[:, CLOSURE_MARGIN]
        return evolve(table, quality=quality)


def preference_of(
    names: Sequence[str] | None = None, tolerance: Tolerance | None = None, loads: Sequence[Load] = ()
) -> Preference:
    """A preference from the names of figures as a user writes them; None is the default ranking.

    Raises
    ------
    InputError
        For a name that is no figure, one given twice, and the load reaction without loads.
    """
    tolerance, loads = tolerance or Tolerance(), tuple(loads)
    if names is None:
        return Preference(LOADED_RANKING if loads else DEFAULT_RANKING, tolerance, loads)
    keys = []
    for name in names:
        number = figure_number(name)
        if number is None:
            known = ", ".join(figure.option for figure in FIGURES)
            raise InputError(f"{name!r} is no figure to rank by: choose among {known}.")
        if number == LOAD_REACTION and not loads:
            raise InputError("there is no load to rank by the load reaction: give one with --load or --loads.")
        keys.append(FIGURES[number].key)
    if not keys:
        raise InputError("there is no figure to rank by: name at least one, such as closure-margin.")
    if len(set(keys)) < len(keys):
        raise InputError(f"the figures to rank by, {', '.join(names)}, name one twice: name each once.")
    return Preference(tuple(keys), tolerance, loads)


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
