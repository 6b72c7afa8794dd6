"""All chord curves of a workpiece for one toolkit's lattice steps (see ``kernels.chord.evaluation`` for what a chord is)."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.conventions import LOOSE
from workhold.kernels.chord.coincidences import are_concentric
from workhold.kernels.curves.columns import (
    CENTER,
    END_STRETCH,
    FIRST_STRETCH,
    HEAD,
    TAIL,
    Curves,
    SlidingPairs,
)
from workhold.kernels.curves.table import tail_curves

__all__ = ["CurveTable", "LatticeSteps", "center_numbers", "curve_table", "joined", "loosened"]


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


@define(frozen=True, eq=False)
class CurveTable:
    """Chord curves and sliding pairs of pairs of features, see ``kernels.curves.columns``."""

    curves: Curves
    sliding_pairs: SlidingPairs

    def __len__(self) -> int:
        return len(self.curves.integers)


def loosened(rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """Feature rows (F, 8) with their ends moved out by a hair; whole circles have none."""
    out = np.array(rows)
    lines, arcs = rows[:, 0] == 0.0, (rows[:, 0] != 0.0) & (rows[:, 5] < pi)
    out[lines, 5] += LOOSE
    out[arcs, 5] = np.minimum(rows[arcs, 5] + LOOSE / rows[arcs, 6], pi)
    return out


def center_numbers(rows: NDArray[np.float64]) -> NDArray[np.int64]:
    """For (F, 8) rows the index of the first feature with the same centre, -1 for lines."""
    numbers = np.full(len(rows), -1, dtype=np.int64)
    arcs = np.flatnonzero(rows[:, 0] != 0.0)
    for position, k in enumerate(arcs):
        numbers[k] = next((int(j) for j in arcs[:position] if are_concentric(rows[j], rows[k])), int(k))
    return numbers


def curve_table(rows: NDArray[np.float64], steps: LatticeSteps, tails: Sequence[int] | None = None) -> CurveTable:
    """Chord curves between (F, 8) loosened feature rows, or those with their tails on some features."""
    centers = center_numbers(rows)
    parts = [
        tail_curves(tail, rows, centers, steps.lengths, steps.starts, steps.steps, steps.angles)
        for tail in (range(len(rows)) if tails is None else tails)
    ]
    before = 0
    for integers, _, _, _, stretches in parts:
        integers[:, [FIRST_STRETCH, END_STRETCH]] += before
        before += len(stretches)
    integers, reals, whole, sliding, stretches = (np.concatenate(columns) for columns in zip(*parts, strict=True))
    return CurveTable(Curves(integers, reals, stretches), SlidingPairs(whole, sliding))


def joined(one: CurveTable, other: CurveTable, before: int) -> CurveTable:
    """Two tables as one, the second of features that begin at number ``before``."""
    for table in (other.curves.integers, other.sliding_pairs.integers):
        table[:, [TAIL, HEAD]] += before
        table[:, CENTER] += before * (table[:, CENTER] >= 0)
    other.curves.integers[:, [FIRST_STRETCH, END_STRETCH]] += len(one.curves.stretches)
    integers, reals, stretches = (np.concatenate(pair) for pair in zip(one.curves, other.curves, strict=True))
    whole, sliding = (np.concatenate(pair) for pair in zip(one.sliding_pairs, other.sliding_pairs, strict=True))
    return CurveTable(Curves(integers, reals, stretches), SlidingPairs(whole, sliding))
