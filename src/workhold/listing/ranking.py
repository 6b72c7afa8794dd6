"""The order of fixtures, in keys of which the first count most.

Where somebody names figures, these count: all but the last to two significant digits, so that the next one
has a say among fixtures that are about as good, the last to nine decimals. A fixture's place depends on no
other fixture then.

In the usual order a warning counts first. Then steps count, of a tenth each, by which the effective location
error is above the least one. That is the least of all fixtures that are fit and without warning, or as near
to that as any is. Then comes the angle as written, and then the figures. So a place depends on the least
error, which is known at the end. Parts of a list are kept and left out by what holds whatever it is
(:meth:`OrderKeys.are_beaten`):

- One fixture comes before another one whose effective error is a tenth larger or more, if it is fit and has
  no warning: steps count from an error no larger than either, so that the other has a step more.
- It does so, too, if its effective error is no larger, and all that comes after the steps is better.

What as many fixtures come before as are asked for is not among the best. The fixture with the least error is
never left out, for only one with an error no larger comes before it for certain.

Fixtures that are none for a workshop come after all others. What is equal stays in the order of types, holes,
poses and faces.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from heapq import heappushpop
from math import ceil, inf

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from workhold.contact.problem import Problem
from workhold.conventions import FIGURE_DECIMALS, STEP_TENTHS
from workhold.model.first_choice import list_ranking_figures
from workhold.model.fixture_table import FixtureTable
from workhold.model.quality import (
    CLAMP_FREEDOM,
    CLOSURE_MARGIN,
    COARSE_DIGITS,
    FIGURES,
    PROGRAM_CLEARANCE,
    PROGRAM_FIGURE,
    RANKED,
    WARNINGS,
    find_ranked_number,
)
from workhold.model.query import Query
from workhold.statics.contact_matrix import Touched
from workhold.statics.effective_error import EffectiveErrors, classify_angles
from workhold.statics.judging import unfit
from workhold.statics.quality import measure_quality

__all__ = [
    "A_STEP",
    "MOST_ERROR",
    "OrderKeys",
    "make_best_possible_figures",
    "convert_to_billionths",
    "count_error_steps",
    "make_figure_keys",
    "convert_to_mm",
    "is_worse",
    "make_order_keys",
    "measure_table",
    "measure_table_as_touched",
    "order_keys",
    "find_usual_errors",
]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

# Effective errors are whole billionths of a millimetre, no more than an integer holds eleven times.
PER_MM, MOST_ERROR = 10.0**FIGURE_DECIMALS, 4 * 10**17
# A location error so many times another, and more than rounding takes, is a step above it for certain.
A_STEP = STEP_TENTHS[0] / STEP_TENTHS[1] * (1.0 + 1e-7)
# Rows compared with others at a time.
TOGETHER = 1 << 22


def measure_table(table: FixtureTable, problem: Problem) -> FixtureTable:
    touched = Touched.of(problem.workpiece, problem.toolkit, problem.loci, problem.wrench_length)
    return measure_table_as_touched(table, problem.query, touched)


def measure_table_as_touched(table: FixtureTable, query: Query, touched: Touched) -> FixtureTable:
    """Return a table with all its figures of quality; those of closure are as the search found them, to the
    last digit.
    """
    quality = measure_quality(
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


@frozen(eq=False)
class OrderKeys:
    """What N fixtures, or bounds of some, are ordered by.

    Parameters
    ----------
    first : (N, A) numbers that count before any steps, smaller being better. In the usual order these are
        whether a fixture is unfit, and whether there is a warning; else they are all numbers there are.
    error : (N,) effective location errors in billionths of a millimetre; None where steps do not count.
    rest : (N, B) numbers that count after the steps.
    """

    first: Array
    error: IntArray | None
    rest: Array

    def __len__(self) -> int:
        return len(self.first)

    def take(self, chosen: NDArray[np.integer] | BoolArray | slice) -> OrderKeys:
        error = None if self.error is None else self.error[chosen]
        return OrderKeys(self.first[chosen], error, self.rest[chosen])

    def concatenate(self, other: OrderKeys) -> OrderKeys:
        error = None
        if self.error is not None and other.error is not None:
            error = np.concatenate([self.error, other.error])
        first, rest = (np.concatenate(both) for both in ((self.first, other.first), (self.rest, other.rest)))
        return OrderKeys(first, error, rest)

    @property
    def width(self) -> int:
        """How many numbers :meth:`make_order_numbers` gives."""
        return int(self.first.shape[1] + self.rest.shape[1] + (self.error is not None))

    @property
    def lowest(self) -> int:
        """The least error of any that may be fit and without warning; the largest there is without one."""
        if self.error is None:
            return MOST_ERROR
        return int(min(self.error[(self.first <= 0.0).all(axis=1)].tolist(), default=MOST_ERROR))

    @property
    def is_known(self) -> BoolArray:
        """Which (N,) bounds say anything."""
        return np.asarray(self.first[:, 0] != -inf)

    @property
    def nothing(self) -> OrderKeys:
        """The keys, in one row, of what holds nothing."""
        error = None if self.error is None else np.full(1, MOST_ERROR)
        return OrderKeys(np.full((1, self.first.shape[1]), inf), error, np.full((1, self.rest.shape[1]), inf))

    def choose(self, chosen: BoolArray, other: OrderKeys) -> OrderKeys:
        """Return the keys of those chosen (N,), and other ones of the rest."""
        error = None
        if self.error is not None and other.error is not None:
            error = np.where(chosen, self.error, other.error)
        first, rest = (
            np.where(chosen[:, None], *both) for both in ((self.first, other.first), (self.rest, other.rest))
        )
        return OrderKeys(first, error, rest)

    def drop_bounds_where(self, chosen: BoolArray) -> OrderKeys:
        """Return the keys, those chosen (N,) without any bound."""
        error = None if self.error is None else np.where(chosen, 0, self.error)
        first, rest = (np.where(chosen[:, None], -inf, rows) for rows in (self.first, self.rest))
        return OrderKeys(first, error, rest)

    def find_least_of_groups(self, groups: IntArray) -> OrderKeys:
        """Return the least numbers before steps, least error and least numbers after steps, of each of some
        groups.

        The groups (N,) are numbered from 0 in ascending order.
        """

        def least(rows: Array) -> Array:
            ordered = np.lexsort([*rows.T[::-1], groups])
            return rows[ordered[np.diff(groups[ordered], prepend=-1) > 0]]

        error = self.error
        if error is not None:
            error = np.minimum.reduceat(error, np.flatnonzero(np.diff(groups, prepend=-1) > 0))
        return OrderKeys(least(self.first), error, least(self.rest))

    @property
    def is_fine(self) -> BoolArray:
        """Which (N,) are fit and without a warning, as far as known; none where that does not count."""
        return np.asarray((self.first <= 0.0).all(axis=1)) & (self.error is not None)

    @property
    def least_of_all(self) -> OrderKeys:
        """The keys, in one row if there is any, of one with the least error of those that count for it."""
        if self.error is None:
            return self.take(slice(0))
        return self.take(np.lexsort([self.error, *self.first.T[::-1]])[:1])

    @property
    def least(self) -> int | None:
        """The least effective error of those that no other is better than before steps count; None if there
        is none."""
        if self.error is None or len(self) == 0:
            return None
        best = self.first[np.lexsort(self.first.T[::-1])[0]]
        return int(self.error[(self.first == best).all(axis=1)].min())

    def find_last_fine_error(self, count: int) -> float | None:
        """Return the ``count``-th least effective error in mm of the fit fixtures without a warning; None if
        there are fewer.
        """
        if self.error is None or (errors := self.error[self.is_fine]).size < count:
            return None
        return float(np.partition(errors, count - 1)[count - 1]) / PER_MM

    def make_order_numbers(self, least: int | None) -> Array:
        """Return the numbers (N, R) to order by, given the least effective error of all."""
        if self.error is None:
            return self.first
        steps = count_error_steps(self.error, 0 if least is None else least)
        return np.column_stack([self.first, steps.astype(np.float64), self.rest])

    def order(self, least: int | None) -> NDArray[np.intp]:
        """Return the best first: the order of fixtures that are given in the order of their identities."""
        return np.lexsort(self.make_order_numbers(least).T[::-1])

    def are_among_best(self, most: int) -> BoolArray:
        """Return which (N,) may be among the best ``most``, or tie with the last of them, whatever the least
        error is.
        """
        if len(self) <= most:
            return np.ones(len(self), np.bool_)
        if self.error is None:
            numbers = self.first
            return ~is_worse(numbers, numbers[self.order(None)[most - 1]])
        rest, first = rank_rows(self.rest), rank_rows(self.first)
        out, before = np.zeros(len(self), np.bool_), 0
        for number in range(int(first.max()) + 1):
            if before >= most:
                break
            there = np.flatnonzero(first == number)
            out[there] = self.are_among_best_of(there, rest[there], most - before)
            before += len(there)
        return out

    def are_among_best_of(self, there: NDArray[np.intp], rest: IntArray, most: int) -> BoolArray:
        """Return the same of some (T,) that nothing distinguishes before the steps."""
        assert self.error is not None
        error, out = self.error[there], np.ones(len(there), np.bool_)
        if len(there) <= most:
            return out
        if self.is_fine[there[0]]:
            out = ~has_a_step_more(error, np.partition(error, most - 1)[most - 1])
        chosen = np.flatnonzero(out)
        chosen = chosen[np.argsort(rest[chosen], kind="stable")]
        # The least errors, as many as are asked for, of all whose rest is better; a heap has the largest first.
        ranks, errors = rest[chosen].tolist(), error[chosen].tolist()
        heap, waiting, largest = [-MOST_ERROR - 1] * most, list[int](), MOST_ERROR + 1
        marks = np.ones(len(chosen), np.bool_)
        for place, one in enumerate(errors):
            if place and ranks[place] != ranks[place - 1]:
                for other in waiting:
                    heappushpop(heap, -other)
                waiting, largest = [], -heap[0]
            marks[place] = one < largest
            if one < largest:
                waiting.append(one)
        out[chosen] = marks
        return out

    def are_beaten(self, kept: OrderKeys, most: int, floor: int) -> BoolArray:
        """Return which (N,) of these bounds surely come after ``most`` of some fixtures.

        Parameters
        ----------
        kept : of the fixtures found so far that may be among the best.
        floor : an error that no fixture has less than which is not found yet.
        """
        if len(kept) < most or len(self) == 0:
            return np.zeros(len(self), np.bool_)
        least = kept.least
        if self.error is None or kept.is_known_above(floor):
            numbers = kept.make_order_numbers(least)
            return is_worse(self.make_order_numbers(least), numbers[np.lexsort(numbers.T[::-1])[most - 1]])
        together = self.concatenate(kept)
        assert together.error is not None
        count = len(self)
        first, rest, fine = rank_rows(together.first), rank_rows(together.rest), kept.is_fine
        error, errors = self.error, together.error[count:]
        out = np.zeros(count, np.bool_)
        size = max(TOGETHER // len(kept), 1)
        for start in range(0, count, size):
            some = slice(start, min(start + size, count))
            alike = first[some, None] == first[count:]
            steps = has_a_step_more(error[some, None], errors) & fine
            after = (error[some, None] >= errors) & (rest[some, None] > rest[count:])
            before = (first[some, None] > first[count:]) | (alike & (steps | after))
            out[some] = before.sum(axis=1) >= most
        return out

    def is_known_above(self, floor: int) -> bool:
        """Return whether the least error of these is that of all, if no other has less than ``floor``."""
        if self.error is None or not self.is_fine.any():
            return False
        return (self.least or 0) <= floor


def has_a_step_more(error: IntArray, than: IntArray | np.int64) -> BoolArray:
    """Return where an error surely is a step above others, none of which is below the least of all."""
    eleven, ten = STEP_TENTHS
    return np.asarray((ten * error >= eleven * than) & (than > 0))


def rank_rows(rows: Array) -> IntArray:
    """Return the ranks (N,) of rows (N, K) in lexicographic order, equal ones alike."""
    if len(rows) == 0 or rows.shape[1] == 0:
        return np.zeros(len(rows), np.int64)
    order = np.lexsort(rows.T[::-1])
    ordered = rows[order]
    fresh = np.zeros(len(rows), np.int64)
    fresh[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    out = np.empty(len(rows), np.int64)
    out[order] = np.cumsum(fresh)
    return out


def count_error_steps(error: IntArray, least: int) -> IntArray:
    """Return how many steps (N,) errors (N,) are above the least of all, both in billionths of a millimetre.

    So many numbers j from 1 on have error >= 1.1^j least, in whole numbers.

    Examples
    --------
    >>> count_error_steps(np.array([100, 109, 110, 121, 122, 90]), 100).tolist()
    [0, 0, 1, 2, 2, 0]
    """
    edges, most = list[int](), int(error.max(initial=0))
    # Errors of nothing have no tenth; then steps count from the least that is something.
    step, edge = Fraction(*STEP_TENTHS), Fraction(max(least, 1))
    while (edge := edge * step) <= most:
        edges.append(ceil(edge))
    return np.searchsorted(np.array(edges, np.int64), error, side="right").astype(np.int64)


def convert_to_billionths(error: Array) -> IntArray:
    """Return the errors (N,) in mm as whole billionths; the largest there is for what is no number."""
    known = np.minimum(np.where(np.isnan(error), inf, error), MOST_ERROR / PER_MM)
    return np.rint(known * PER_MM).astype(np.int64)


def convert_to_mm(error: int | None) -> float | None:
    """Return an error in billionths as files have it, in mm."""
    return None if error is None or error >= MOST_ERROR else round(error / PER_MM, FIGURE_DECIMALS)


def find_usual_errors(query: Query) -> EffectiveErrors | None:
    """Return what gives effective errors, where these count in the order of a query; else None."""
    return EffectiveErrors.of(query) if query.has_house_order else None


def order_keys(table: FixtureTable, query: Query, effective: EffectiveErrors | None) -> OrderKeys:
    """Return the keys of a table of fixtures with all its figures; ``effective`` as of :func:`find_usual_errors`."""
    error = None if effective is None else effective.errors(table)
    return make_order_keys(table.quality, query, error, classify_angles(table.theta))


def make_order_keys(
    quality: Array, query: Query, error: Array | IntArray | None, angle: IntArray
) -> OrderKeys:
    """Return the keys of N fixtures.

    Parameters
    ----------
    quality : (N, Q) figures.
    error : (N,) effective errors, in mm or as whole billionths; None where they do not count.
    angle : (N,) classes of angles.
    """
    bad = unfit(quality, query.tolerance).astype(np.float64)
    # What is no number counts as the worst there is.
    figures = [np.where(np.isnan(key), inf, key) for key in make_figure_keys(quality, query.rank_by)]
    if error is None:
        return OrderKeys(np.column_stack([bad, *figures]), None, np.zeros((len(bad), 0)))
    first = np.column_stack([bad, quality[:, WARNINGS] > 0.0])
    rest = np.column_stack([angle.astype(np.float64), *figures])
    whole = (
        error.astype(np.int64) if error.dtype.kind == "i" else convert_to_billionths(error.astype(np.float64))
    )
    return OrderKeys(first, whole, rest)


def make_figure_keys(quality: NDArray[np.float64], ranking: Sequence[str]) -> list[NDArray[np.float64]]:
    """Return the numbers (N,) to sort by for the figures of a ranking, the first counting most."""
    keys, ranking = [], list_ranking_figures(ranking)
    for place, key in enumerate(ranking):
        number = find_ranked_number(key)
        assert number is not None
        # Rounding must not separate fixtures that are equal, so what is coarse is rounded finely first.
        column = PROGRAM_CLEARANCE if RANKED[number] is PROGRAM_FIGURE else number
        values = np.round(quality[:, column], FIGURE_DECIMALS)
        if place < len(ranking) - 1:
            values = round_coarsely(values)
        keys.append(-values if RANKED[number].more_is_better else values)
    return keys


def round_coarsely(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the values (N,) to two significant digits; infinite ones as they are."""
    size = np.abs(values)
    known = np.isfinite(values) & (size > 0.0)
    exponent = np.floor(np.log10(np.where(known, size, 1.0)))
    step = 10.0 ** (exponent - (COARSE_DIGITS - 1))
    return np.where(known, np.rint(values / step) * step, values)


def make_best_possible_figures(count: int, query: Query) -> NDArray[np.float64]:
    """Return figures of quality (N, F) that no fixture of a query exceeds.

    The closure margin is a share of one, so of all pegs at most an equal one, and clamp freedom 90 degrees.
    """
    best = np.array([inf if figure.more_is_better else 0.0 for figure in FIGURES])
    best[[CLOSURE_MARGIN, CLAMP_FREEDOM]] = 1.0 / query.toolkit.peg_count, 90.0
    # With a program the clearance of its tools stands behind.
    return np.tile(best if query.program is None else np.append(best, inf), (count, 1))


def is_worse(keys: NDArray[np.float64], last: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return which keys (N, R) come after others (R,) in lexicographic order."""
    worse, equal = np.zeros(len(keys), np.bool_), np.ones(len(keys), np.bool_)
    for values, one in zip(keys.T, last.tolist(), strict=True):
        worse |= equal & (values > one)
        equal &= values == one
    return worse
