"""Chord curves of a workpiece for a toolkit's lattice steps (chords: ``kernels.chord.evaluation``)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from math import pi, tau
from threading import Event, Thread
from typing import Any

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.conventions import LOOSE
from workhold.kernels.base.capacity import Capacity
from workhold.kernels.base.feature import HALF_EXTENT, IS_ARC, RADIUS
from workhold.kernels.base.tables import (
    CENTER,
    END_STRETCH,
    FIRST_STRETCH,
    HEAD,
    NEAR_FROM,
    NEAR_TO,
    SHIFT,
    TAIL,
    Curves,
    NearSpots,
    SlidingPairs,
)
from workhold.kernels.chord.coincidences import are_concentric
from workhold.kernels.curves.table import make_curve_space, write_tail_curves

__all__ = [
    "ANY_TURN",
    "CurveTable",
    "LatticeSteps",
    "number_centers",
    "make_curve_table",
    "join_curve_tables",
    "loosen_rows",
]

CURVE_CAPACITY = Capacity(256)
# Rules nothing out.
EVERYWHERE = NearSpots(np.zeros(1, np.int64), np.zeros((0, 0), np.int8), np.zeros((0, 0, 0), np.int8))
ANY_TURN = np.zeros((0, 2))


@define(frozen=True, eq=False)
class LatticeSteps:
    """Differences between two holes of one carrier, grouped by their lengths.

    Parameters
    ----------
    lengths : (D,) lengths in mm, ascending.
    starts : (D + 1,) index of the first step of each length, then S.
    steps : (S, 2) column and row differences, both directions of every step.
    angles : (S,) directions in radians.
    """

    lengths: NDArray[np.float64]
    starts: NDArray[np.int64]
    steps: NDArray[np.int64]
    angles: NDArray[np.float64]

    @property
    def without_steps(self) -> LatticeSteps:
        """The same type without any lengths and steps."""
        return LatticeSteps(self.lengths[:0], self.starts[:1], self.steps[:0], self.angles[:0])


@define(frozen=True, eq=False)
class CurveTable:
    """Chord curves and sliding pairs of pairs of features, see ``kernels.base.tables``."""

    curves: Curves
    sliding_pairs: SlidingPairs

    def __len__(self) -> int:
        return len(self.curves.integers)

    @cached_property
    def spans(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The orientations psi in radians at which the use of each curve begins (N,), in [0, 2 pi), and ends
        (N,).
        """
        reals = self.curves.reals
        first = (reals[:, NEAR_FROM] - reals[:, SHIFT]) % tau
        return first, first + (reals[:, NEAR_TO] - reals[:, NEAR_FROM])

    @cached_property
    def sectors(self) -> dict[int, NDArray[np.int64]]:
        """A cache, empty at first: by sector of orientations (see ``search.cells``), the indices of the
        curves that exist there."""
        return {}

    @cached_property
    def sorted_spans(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The beginnings (N,) and the ends (N,) of :attr:`spans`, each ascending."""
        first, last = self.spans
        return np.sort(first), np.sort(last)


def loosen_rows(rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a copy of feature rows (F, 10) with their ends moved out
    by ``LOOSE`` mm; whole circles stay as they are.

    See ``kernels.base.feature`` for the layout of rows.
    """
    out = np.array(rows)
    lines, arcs = rows[:, IS_ARC] == 0.0, (rows[:, IS_ARC] != 0.0) & (rows[:, HALF_EXTENT] < pi)
    out[lines, HALF_EXTENT] += LOOSE
    out[arcs, HALF_EXTENT] = np.minimum(rows[arcs, HALF_EXTENT] + LOOSE / rows[arcs, RADIUS], pi)
    return out


def number_centers(rows: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return, for each of (F, 10) rows, the index of the first arc
    with the same centre, -1 for lines; shape (F,).

    See ``kernels.base.feature`` for the layout of rows.
    """
    numbers = np.full(len(rows), -1, dtype=np.int64)
    arcs = np.flatnonzero(rows[:, IS_ARC] != 0.0)
    for position, k in enumerate(arcs):
        numbers[k] = next((int(j) for j in arcs[:position] if are_concentric(rows[j], rows[k])), int(k))
    return numbers


def make_curve_table(
    rows: NDArray[np.float64],
    steps: LatticeSteps,
    tails: Sequence[int] | None = None,
    threads: int = 1,
    cancel: Event | None = None,
    centers: NDArray[np.int64] | None = None,
    near: NearSpots = EVERYWHERE,
    within: NDArray[np.float64] = ANY_TURN,
) -> CurveTable:
    """Return the chord curves and sliding pairs between (F, 10) loosened feature rows.

    See ``kernels.base.feature`` for the layout of rows.

    Parameters
    ----------
    tails : indices of the features to take as tails; None for all.
    threads : number of threads; the result does not depend on it.
    cancel : when set, tails not yet begun get no curves.
    centers : result of :func:`number_centers`, for callers that ask repeatedly.
    near : spots that locators may touch together; curves with other contacts are left out.
    within : (K, 2) ranges of psi in radians outside which curves may be left out; (0, 2) for no limit.
    """
    centers = number_centers(rows) if centers is None else centers

    def make_curves_from(tail: int) -> tuple[NDArray[Any], ...]:
        """Return five arrays for the tails on one feature: integers and reals of curves, integers and reals
        of sliding pairs, and stretches."""
        few = steps if cancel is None or not cancel.is_set() else steps.without_steps
        given = tail, rows, centers, few.lengths, few.starts, few.steps, few.angles, near, within

        def write(size: int) -> tuple[NDArray[Any], ...] | None:
            """Return the five arrays, computed with room for ``size`` rows each; None where that is not
            enough room."""
            space = make_curve_space(size)
            count, pair_count, stretch_count = write_tail_curves(*given, space)
            if count < 0:
                return None
            return (
                space.integers[:count].copy(),
                space.reals[:count].copy(),
                space.pair_integers[:pair_count].copy(),
                space.pair_reals[:pair_count].copy(),
                space.stretches[:stretch_count].copy(),
            )

        return CURVE_CAPACITY.call_with_room(write)

    parts = map_in_threads(make_curves_from, range(len(rows)) if tails is None else tails, threads)
    before = 0
    for integers, _, _, _, stretches in parts:
        integers[:, [FIRST_STRETCH, END_STRETCH]] += before
        before += len(stretches)
    integers, reals, whole, sliding, stretches = (
        np.concatenate(columns) for columns in zip(*parts, strict=True)
    )
    return CurveTable(Curves(integers, reals, stretches), SlidingPairs(whole, sliding))


def map_in_threads(make: Callable[[int], Any], numbers: Sequence[int], threads: int) -> list[Any]:
    """Return ``[make(number) for number in numbers]``, computed by
    this thread and up to ``threads - 1`` more.

    ``make`` must not return None. (An executor is not used: where memory runs out a thread may end without a
    word, and an executor would wait for it for ever.)

    Raises
    ------
    MemoryError
        When there is not enough memory; and what ``make`` raises.
    """
    made: list[Any] = [None] * len(numbers)
    turns, errors = iter(range(len(numbers))), list[BaseException]()

    def map_numbers() -> None:
        """Take numbers until none is left or an error occurred; store results and the error."""
        try:
            for turn in turns:
                if errors:
                    return
                made[turn] = make(numbers[turn])
        except BaseException as error:
            errors.append(error)

    others = []
    for _ in range(threads - 1):
        other = Thread(target=map_numbers)
        try:
            other.start()
        except RuntimeError:
            # There is no room for another thread.
            break
        others.append(other)
    map_numbers()
    for other in others:
        other.join()
    if errors:
        raise errors[0]
    if any(one is None for one in made):
        raise MemoryError
    return made


def join_curve_tables(one: CurveTable, other: CurveTable, before: int) -> CurveTable:
    """Return one table with the curves of both; the features of ``other`` get the numbers from ``before`` on.

    ``other`` is changed in place and must not be used afterwards.
    """
    for table in (other.curves.integers, other.sliding_pairs.integers):
        table[:, [TAIL, HEAD]] += before
        table[:, CENTER] += before * (table[:, CENTER] >= 0)
    other.curves.integers[:, [FIRST_STRETCH, END_STRETCH]] += len(one.curves.stretches)
    integers, reals, stretches = (np.concatenate(pair) for pair in zip(one.curves, other.curves, strict=True))
    whole, sliding = (
        np.concatenate(pair) for pair in zip(one.sliding_pairs, other.sliding_pairs, strict=True)
    )
    return CurveTable(Curves(integers, reals, stretches), SlidingPairs(whole, sliding))
