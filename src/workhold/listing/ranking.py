"""The ranking of fixtures by keys, the first of which count most.

If the query names figures, these are the keys. All but the last are rounded to two significant digits, so
that the next one decides among fixtures that are about as good; the last is rounded to nine decimals. Then a
fixture's rank does not depend on other fixtures.

In the usual ranking a warning counts first. Then comes the number of steps, of a tenth each, by which the
effective location error is above the least error. The least error is taken over all fixtures that are fit and
without warning or, if there are none, over the best of the other classes (fit with a warning, then unfit).
Then comes the class of the angle, and then the figures. So a rank depends on the least error, which is known
only at the end. Until then fixtures are kept or dropped by rules that hold for every least error
(:meth:`OrderKeys.are_beaten`):

- One fixture comes before another one whose effective error is a tenth larger or more, if it is fit and has
  no warning: steps count from an error no larger than either, so that the other has a step more.
- One fixture also comes before another one if its effective error is no larger, and all keys after the steps
  are better.

A fixture that surely comes after as many others as are asked for is not among the best. The fixture with the
least error is never dropped, for only a fixture with an error no larger surely comes before it.

Fixtures unfit for a workshop come last. Equal fixtures stay in the order of types, holes, poses and faces.
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
from workhold.statics.contact_matrix import TouchableFeatures
from workhold.statics.effective_error import EffectiveErrors, classify_angles
from workhold.statics.judging import are_unfit
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
    "make_table_keys",
    "find_usual_errors",
]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

# Effective errors are integers, billionths of a mm; eleven times the largest fits 64 bits.
PER_MM, MOST_ERROR = 10.0**FIGURE_DECIMALS, 4 * 10**17
# An error this many times another is surely a step above it, rounding included.
A_STEP = STEP_TENTHS[0] / STEP_TENTHS[1] * (1.0 + 1e-7)
# Rows compared with others at a time.
TOGETHER = 1 << 22


def measure_table(table: FixtureTable, problem: Problem) -> FixtureTable:
    """Return a table with all figures of quality computed.

    Closure margin and clamp freedom keep the values from the search.
    """
    touched = TouchableFeatures.from_workpiece(
        problem.workpiece, problem.toolkit, problem.loci, problem.wrench_length
    )
    return measure_table_as_touched(table, problem.query, touched)


def measure_table_as_touched(table: FixtureTable, query: Query, touched: TouchableFeatures) -> FixtureTable:
    """Return a table with all figures of quality computed, given the features that pegs can touch.

    Closure margin and clamp freedom keep the values that the search gave them.
    """
    quality = measure_quality(
        table,
        query.workpiece,
        query.toolkit,
        query.tolerance,
        query.loads,
        touched=touched,
        jaw_force=query.jaw_force,
        passed=query.program_to_clear,
        pressed_top=query.pressed_top,
    )
    quality[:, [CLOSURE_MARGIN, CLAMP_FREEDOM]] = table.quality[:, [CLOSURE_MARGIN, CLAMP_FREEDOM]]
    return evolve(table, quality=quality)


@frozen(eq=False)
class OrderKeys:
    """Ranking keys of N fixtures, or lower bounds of such keys; smaller is better.

    Parameters
    ----------
    first : (N, A) numbers that count first. In the usual ranking these are two flags, 0 or 1: whether the
        fixture is unfit, and whether it has a warning. In any other ranking they are all numbers. -inf in an
        empty bound.
    error : (N,) effective location errors in billionths of a mm, which count after ``first``, in steps above
        the least error; None if steps do not count.
    rest : (N, B) numbers that count after the steps; no columns if steps do not count.
    """

    first: Array
    error: IntArray | None
    rest: Array

    def __len__(self) -> int:
        return len(self.first)

    def take(self, chosen: NDArray[np.integer] | BoolArray | slice) -> OrderKeys:
        """Return the keys of the rows that an index array, mask or slice selects."""
        error = None if self.error is None else self.error[chosen]
        return OrderKeys(self.first[chosen], error, self.rest[chosen])

    def concatenate(self, other: OrderKeys) -> OrderKeys:
        """Return these keys followed by ``other``; both must be of the same ranking."""
        error = None
        if self.error is not None and other.error is not None:
            error = np.concatenate([self.error, other.error])
        first, rest = (np.concatenate(both) for both in ((self.first, other.first), (self.rest, other.rest)))
        return OrderKeys(first, error, rest)

    @property
    def width(self) -> int:
        """Number of columns that :meth:`make_order_numbers` returns."""
        return int(self.first.shape[1] + self.rest.shape[1] + (self.error is not None))

    @property
    def lowest_error(self) -> int:
        """Least error in billionths of a mm of the rows that may be fit and
        without warning; ``MOST_ERROR`` without any.
        """
        if self.error is None:
            return MOST_ERROR
        return int(min(self.error[(self.first <= 0.0).all(axis=1)].tolist(), default=MOST_ERROR))

    @property
    def is_known(self) -> BoolArray:
        """Mask (N,): False for empty bounds, which bound nothing."""
        return np.asarray(self.first[:, 0] != -inf)

    @property
    def keys_of_nothing(self) -> OrderKeys:
        """One row of the worst keys, for a group without fixtures."""
        error = None if self.error is None else np.full(1, MOST_ERROR)
        return OrderKeys(np.full((1, self.first.shape[1]), inf), error, np.full((1, self.rest.shape[1]), inf))

    def choose(self, chosen: BoolArray, other: OrderKeys) -> OrderKeys:
        """Return keys whose row k is taken from this object if ``chosen[k]``, else from ``other``."""
        error = None
        if self.error is not None and other.error is not None:
            error = np.where(chosen, self.error, other.error)
        first, rest = (
            np.where(chosen[:, None], *both) for both in ((self.first, other.first), (self.rest, other.rest))
        )
        return OrderKeys(first, error, rest)

    def drop_bounds_where(self, chosen: BoolArray) -> OrderKeys:
        """Return keys in which the rows selected by the mask ``chosen`` (N,) are replaced by empty bounds."""
        error = None if self.error is None else np.where(chosen, 0, self.error)
        first, rest = (np.where(chosen[:, None], -inf, rows) for rows in (self.first, self.rest))
        return OrderKeys(first, error, rest)

    def find_least_of_groups(self, groups: IntArray) -> OrderKeys:
        """Return one row for each group: its least ``first``, its least
        error, and its least ``rest``, each by itself.

        ``groups`` (N,) are group numbers from 0, ascending.
        """

        def find_least(rows: Array) -> Array:
            """Return the lexicographically least row of each group."""
            ordered = np.lexsort([*rows.T[::-1], groups])
            return rows[ordered[np.diff(groups[ordered], prepend=-1) > 0]]

        error = self.error
        if error is not None:
            error = np.minimum.reduceat(error, np.flatnonzero(np.diff(groups, prepend=-1) > 0))
        return OrderKeys(find_least(self.first), error, find_least(self.rest))

    @property
    def is_fine(self) -> BoolArray:
        """Mask (N,): True for rows that are fit and without a warning; all False if steps do not count."""
        return np.asarray((self.first <= 0.0).all(axis=1)) & (self.error is not None)

    @property
    def least_keys(self) -> OrderKeys:
        """Keys, in one row, of the fixture with the best ``first`` and, among equals, the least error.

        No row without fixtures, and where steps do not count.
        """
        if self.error is None:
            return self.take(slice(0))
        return self.take(np.lexsort([self.error, *self.first.T[::-1]])[:1])

    @property
    def least_error(self) -> int | None:
        """Least error, in billionths of a mm, among the rows with the best ``first``.

        None without rows, and if steps do not count.
        """
        if self.error is None or len(self) == 0:
            return None
        best = self.first[np.lexsort(self.first.T[::-1])[0]]
        return int(self.error[(self.first == best).all(axis=1)].min())

    def find_last_fine_error(self, count: int) -> float | None:
        """Return the ``count``-th least effective error in mm among rows that are fit and without a warning.

        None with fewer such rows.
        """
        if self.error is None or (errors := self.error[self.is_fine]).size < count:
            return None
        return float(np.partition(errors, count - 1)[count - 1]) / PER_MM

    def make_order_numbers(self, least: int | None) -> Array:
        """Return the numbers (N, R) by which rows are sorted
        lexicographically, with errors as steps above ``least``.

        ``least`` is in billionths of a mm; None counts as 0.
        """
        if self.error is None:
            return self.first
        steps = count_error_steps(self.error, 0 if least is None else least)
        return np.column_stack([self.first, steps.astype(np.float64), self.rest])

    def sort(self, least: int | None) -> NDArray[np.intp]:
        """Return the indices (N,) that put fixtures best first; equal ones keep their order.

        ``least`` is the error in billionths of a mm from which steps count; None counts as 0.
        """
        return np.lexsort(self.make_order_numbers(least).T[::-1])

    def are_among_best(self, most: int) -> BoolArray:
        """Return a mask (N,): True for rows that may be among the best
        ``most``, or tie with the last of these.

        The mask holds whatever the least error of all fixtures turns out to be.
        """
        if len(self) <= most:
            return np.ones(len(self), np.bool_)
        if self.error is None:
            numbers = self.first
            return ~is_worse(numbers, numbers[self.sort(None)[most - 1]])
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
        """Return a mask (T,): True for those of the rows ``there`` that
        may be among the best ``most`` of these rows.

        The rows ``there`` (T,), given by index, have equal ``first``; ``rest`` (T,) are the ranks of their
        ``rest``.
        """
        assert self.error is not None
        error, out = self.error[there], np.ones(len(there), np.bool_)
        if len(there) <= most:
            return out
        if self.is_fine[there[0]]:
            out = ~has_a_step_more(error, np.partition(error, most - 1)[most - 1])
        chosen = np.flatnonzero(out)
        chosen = chosen[np.argsort(rest[chosen], kind="stable")]
        # The ``most`` smallest errors of the fixtures with a better rest; the heap has the largest of them
        # first.
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
        """Return a mask (N,): True for rows that surely rank after at
        least ``most`` of the fixtures in ``kept``.

        The rows of this object are bounds.

        Parameters
        ----------
        kept : keys of the fixtures found so far that may be among the best.
        floor : a lower bound of the errors, in billionths of a mm, of all fixtures not yet found.
        """
        if len(kept) < most or len(self) == 0:
            return np.zeros(len(self), np.bool_)
        least = kept.least_error
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
        """Return whether no fixture outside this set can have a smaller error than the least one here.

        The fixtures outside have errors of at least ``floor``, in billionths of a mm. False if steps do not
        count, and if no row is fit and without warning.
        """
        if self.error is None or not self.is_fine.any():
            return False
        return (self.least_error or 0) <= floor


def has_a_step_more(error: IntArray, than: IntArray | np.int64) -> BoolArray:
    """Return a mask: True where ``error`` surely counts at least one step (a tenth) more than ``than``.

    Steps are counted from the least error of all fixtures. The answer is certain even if that error is
    unknown. Both are in billionths of a mm.
    """
    eleven, ten = STEP_TENTHS
    return np.asarray((ten * error >= eleven * than) & (than > 0))


def rank_rows(rows: Array) -> IntArray:
    """Return the rank of each row in lexicographic order, (N,), counted from 0; equal rows have equal ranks.

    Ranks have no gaps. ``rows`` is (N, K).
    """
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
    """Return by how many steps each error is above the least one, (N,); all errors in billionths of a mm.

    The number of steps is the number of integers j from 1 up with error >= 1.1^j ``least``, in exact
    arithmetic.

    Examples
    --------
    >>> count_error_steps(np.array([100, 109, 110, 121, 122, 90]), 100).tolist()
    [0, 0, 1, 2, 2, 0]
    """
    edges, most = list[int](), int(error.max(initial=0))
    # Steps above a least error of 0 count from one billionth.
    step, edge = Fraction(*STEP_TENTHS), Fraction(max(least, 1))
    while (edge := edge * step) <= most:
        edges.append(ceil(edge))
    return np.searchsorted(np.array(edges, np.int64), error, side="right").astype(np.int64)


def convert_to_billionths(error: Array) -> IntArray:
    """Return errors (N,) in mm as integers in billionths of a mm;
    ``MOST_ERROR`` for NaN and for larger errors.
    """
    known = np.minimum(np.where(np.isnan(error), inf, error), MOST_ERROR / PER_MM)
    return np.rint(known * PER_MM).astype(np.int64)


def convert_to_mm(error: int | None) -> float | None:
    """Return an error in billionths of a mm as mm, rounded as in files.

    None for None and for ``MOST_ERROR``.
    """
    return None if error is None or error >= MOST_ERROR else round(error / PER_MM, FIGURE_DECIMALS)


def find_usual_errors(query: Query) -> EffectiveErrors | None:
    """Return the computation of effective errors for a query with the usual ranking; None for any other
    query.
    """
    return EffectiveErrors.from_query(query) if query.has_house_order else None


def make_table_keys(table: FixtureTable, query: Query, effective: EffectiveErrors | None) -> OrderKeys:
    """Return the ranking keys of a measured table.

    ``effective`` is the result of :func:`find_usual_errors` for the query.
    """
    error = None if effective is None else effective.compute_errors(table)
    return make_order_keys(table.quality, query, error, classify_angles(table.theta))


def make_order_keys(
    quality: Array, query: Query, error: Array | IntArray | None, angle: IntArray
) -> OrderKeys:
    """Return the ranking keys of N fixtures.

    Parameters
    ----------
    quality : (N, Q) figures; NaN ranks worst.
    error : (N,) effective errors, as floats in mm or integers in billionths of a mm; None if they do not
        count.
    angle : (N,) class of the angle: 0 as drawn, 1 quarter turn, 2 other.
    """
    bad = are_unfit(quality, query.tolerance).astype(np.float64)
    # NaN ranks worst.
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
    """Return arrays (N,) to sort fixtures by the figures of a
    ranking; the first counts most, smaller is better.

    All but the last are rounded to two significant digits. ``quality`` (N, Q) are the figures.
    """
    keys, ranking = [], list_ranking_figures(ranking)
    for place, key in enumerate(ranking):
        number = find_ranked_number(key)
        assert number is not None
        # Rounded finely before coarsely, so that rounding errors do not separate equal fixtures.
        column = PROGRAM_CLEARANCE if RANKED[number] is PROGRAM_FIGURE else number
        values = np.round(quality[:, column], FIGURE_DECIMALS)
        if place < len(ranking) - 1:
            values = round_coarsely(values)
        keys.append(-values if RANKED[number].more_is_better else values)
    return keys


def round_coarsely(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the values (N,) rounded to two significant digits; 0, inf and NaN unchanged."""
    size = np.abs(values)
    known = np.isfinite(values) & (size > 0.0)
    exponent = np.floor(np.log10(np.where(known, size, 1.0)))
    step = 10.0 ** (exponent - (COARSE_DIGITS - 1))
    return np.where(known, np.rint(values / step) * step, values)


def make_best_possible_figures(count: int, query: Query) -> NDArray[np.float64]:
    """Return ``count`` equal rows of figures of quality that no fixture of a query can surpass, (count, F).

    The closure margin is the least of the pegs' shares, so at most 1 / number of pegs; clamp freedom is at
    most 90 degrees.
    """
    best = np.array([inf if figure.more_is_better else 0.0 for figure in FIGURES])
    best[[CLOSURE_MARGIN, CLAMP_FREEDOM]] = 1.0 / query.toolkit.peg_count, 90.0
    # With a program the last column is the clearance of its tools.
    return np.tile(best if query.program is None else np.append(best, inf), (count, 1))


def is_worse(keys: NDArray[np.float64], last: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return a mask (N,): True for rows of ``keys`` (N, R) that come
    lexicographically after the row ``last`` (R,).
    """
    worse, equal = np.zeros(len(keys), np.bool_), np.ones(len(keys), np.bool_)
    for values, one in zip(keys.T, last.tolist(), strict=True):
        worse |= equal & (values > one)
        equal &= values == one
    return worse
