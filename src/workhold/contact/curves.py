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

__all__ = ["ANY_TURN", "CurveTable", "LatticeSteps", "number_centers", "curve_table", "joined", "loosened"]

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
    starts : (D + 1,) where the steps of each length begin.
    steps : (S, 2) column and row differences.
    angles : (S,) directions in radians.
    """

    lengths: NDArray[np.float64]
    starts: NDArray[np.int64]
    steps: NDArray[np.int64]
    angles: NDArray[np.float64]

    @property
    def none(self) -> LatticeSteps:
        """No steps."""
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
        """The orientations (N,) in radians from and to which curves are of interest, the former in
        [0, 2 pi)."""
        reals = self.curves.reals
        first = (reals[:, NEAR_FROM] - reals[:, SHIFT]) % tau
        return first, first + (reals[:, NEAR_TO] - reals[:, NEAR_FROM])

    @cached_property
    def sectors(self) -> dict[int, NDArray[np.int64]]:
        """Which curves exist in each sector of orientations that was asked for (``search.cells``)."""
        return {}

    @cached_property
    def sorted_spans(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The beginnings (N,) and the ends (N,) of :attr:`spans`, each ascending."""
        first, last = self.spans
        return np.sort(first), np.sort(last)


def loosened(rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """Feature rows (F, 10) with their ends moved out by a hair; whole circles have none."""
    out = np.array(rows)
    lines, arcs = rows[:, IS_ARC] == 0.0, (rows[:, IS_ARC] != 0.0) & (rows[:, HALF_EXTENT] < pi)
    out[lines, HALF_EXTENT] += LOOSE
    out[arcs, HALF_EXTENT] = np.minimum(rows[arcs, HALF_EXTENT] + LOOSE / rows[arcs, RADIUS], pi)
    return out


def number_centers(rows: NDArray[np.float64]) -> NDArray[np.int64]:
    """Index of the first feature with the same centre for each of (F, 10) rows, -1 for lines."""
    numbers = np.full(len(rows), -1, dtype=np.int64)
    arcs = np.flatnonzero(rows[:, IS_ARC] != 0.0)
    for position, k in enumerate(arcs):
        numbers[k] = next((int(j) for j in arcs[:position] if are_concentric(rows[j], rows[k])), int(k))
    return numbers


def curve_table(
    rows: NDArray[np.float64],
    steps: LatticeSteps,
    tails: Sequence[int] | None = None,
    threads: int = 1,
    cancel: Event | None = None,
    centers: NDArray[np.int64] | None = None,
    near: NearSpots = EVERYWHERE,
    within: NDArray[np.float64] = ANY_TURN,
) -> CurveTable:
    """Chord curves between (F, 10) loosened feature rows, or those with their tails on some features.

    Parameters
    ----------
    threads : how many threads share the work; the outcome does not depend on it.
    cancel : when set, curves whose turn has not come are left out.
    centers : as of ``number_centers``, for who asks again and again.
    near : leaves out what no locators of interest touch.
    within : (K, 2) ranges of psi in radians beside which curves may be left out; none for everywhere.
    """
    centers = number_centers(rows) if centers is None else centers

    def curves_from(tail: int) -> tuple[NDArray[Any], ...]:
        few = steps if cancel is None or not cancel.is_set() else steps.none
        given = tail, rows, centers, few.lengths, few.starts, few.steps, few.angles, near, within

        def write(size: int) -> tuple[NDArray[Any], ...] | None:
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

        return CURVE_CAPACITY.give(write)

    parts = map_in_threads(curves_from, range(len(rows)) if tails is None else tails, threads)
    before = 0
    for integers, _, _, _, stretches in parts:
        integers[:, [FIRST_STRETCH, END_STRETCH]] += before
        before += len(stretches)
    integers, reals, whole, sliding, stretches = (
        np.concatenate(columns) for columns in zip(*parts, strict=True)
    )
    return CurveTable(Curves(integers, reals, stretches), SlidingPairs(whole, sliding))


def map_in_threads(make: Callable[[int], Any], numbers: Sequence[int], threads: int) -> list[Any]:
    """What is made of each number, by this thread and some more.

    Where memory runs out a thread may end without a word, and an executor would wait for it for ever.

    Raises
    ------
    MemoryError
        When there is not enough memory; and what ``make`` raises.
    """
    made: list[Any] = [None] * len(numbers)
    turns, errors = iter(range(len(numbers))), list[BaseException]()

    def work() -> None:
        try:
            for turn in turns:
                if errors:
                    return
                made[turn] = make(numbers[turn])
        except BaseException as error:
            errors.append(error)

    others = []
    for _ in range(threads - 1):
        other = Thread(target=work)
        try:
            other.start()
        except RuntimeError:
            # There is no room for another thread.
            break
        others.append(other)
    work()
    for other in others:
        other.join()
    if errors:
        raise errors[0]
    if any(one is None for one in made):
        raise MemoryError
    return made


def joined(one: CurveTable, other: CurveTable, before: int) -> CurveTable:
    """Two tables as one, the second of features that begin at number ``before``."""
    for table in (other.curves.integers, other.sliding_pairs.integers):
        table[:, [TAIL, HEAD]] += before
        table[:, CENTER] += before * (table[:, CENTER] >= 0)
    other.curves.integers[:, [FIRST_STRETCH, END_STRETCH]] += len(one.curves.stretches)
    integers, reals, stretches = (np.concatenate(pair) for pair in zip(one.curves, other.curves, strict=True))
    whole, sliding = (
        np.concatenate(pair) for pair in zip(one.sliding_pairs, other.sliding_pairs, strict=True)
    )
    return CurveTable(Curves(integers, reals, stretches), SlidingPairs(whole, sliding))
