"""Random chord curves and their pieces for the tests of the kernels."""

from __future__ import annotations

from collections.abc import Callable
from math import cos, hypot, sin
from random import Random

import numba
import numpy as np
from numpy.typing import NDArray

from chord_examples import KINDS, random_chord
from strategies import random_row
from workhold.contact.curves import CurveTable, LatticeSteps, make_curve_table
from workhold.kernels.base.tables import COLUMN_STEP, EDGE_LENGTH, LENGTH, PIECE_LENGTH, ROW_STEP
from workhold.kernels.chord.evaluation import HEIGHT, POSITION
from workhold.kernels.curves.pieces import write_pieces
from workhold.kernels.curves.roots import (
    MOST_ROOTS,
    STACK_DEPTH,
    STACK_LENGTH,
    evaluate_point,
    write_crossings,
)

Array = NDArray[np.float64]


def lattice(pitch: float, columns: int, rows: int) -> LatticeSteps:
    """All steps of a square lattice, grouped by length."""
    steps = [(k, m) for k in range(1 - columns, columns) for m in range(-rows, rows + 1) if (k, m) != (0, 0)]
    steps.sort(key=lambda step: (round(hypot(*step), 9), step))
    sizes = np.array([round(pitch * hypot(*step), 9) for step in steps])
    lengths, starts = np.unique(sizes, return_index=True)
    whole = np.array(steps, np.int64)
    return LatticeSteps(lengths, np.append(starts, len(steps)), whole, np.arctan2(whole[:, 1], whole[:, 0]))


def random_table(random: Random, count: int = 4, first: str = "") -> tuple[Array, CurveTable]:
    """Features of random kinds (the first of a given one) and all their chord curves on a small lattice."""
    rows = [random_row(random, random.choice(KINDS)) for _ in range(count)]
    if random.random() < 0.3:
        pair = random_chord(random, (random.choice(KINDS), random.choice(KINDS)))
        rows[:2] = [tuple(row) for row in pair[:2]]
    if first:
        rows[0] = random_row(random, first)
    features = np.array(rows)
    return features, make_curve_table(features, lattice(random.uniform(8, 14), 2, 2))


def special_table(
    random: Random, make: Callable[[Random], tuple[Array, Array, float]]
) -> tuple[Array, CurveTable]:
    """Two features in a special position (see ``chord_examples.SPECIAL``) and their chords on a lattice of that pitch."""
    a, b, d = make(random)
    features = np.array([a, b])
    return features, make_curve_table(features, lattice(d / random.choice([1, 1, 2]), 2, 2))


def steps_of(table: CurveTable) -> LatticeSteps:
    """The lattice steps of one length that a table's first curve has."""
    length, pitch = float(table.curves.reals[0, LENGTH]), pitch_of(table)
    whole = np.array(
        [(k, m) for k in range(-2, 3) for m in range(-2, 3) if abs(hypot(k, m) * pitch - length) < 1e-9],
        np.int64,
    )
    return LatticeSteps(
        np.array([length]), np.array([0, len(whole)]), whole, np.arctan2(whole[:, 1], whole[:, 0])
    )


def pitch_of(table: CurveTable) -> float:
    """Pitch in mm of the square lattice of a table's curves."""
    steps = table.curves.integers[0, [COLUMN_STEP, ROW_STEP]]
    return float(table.curves.reals[0, LENGTH] / hypot(*steps))


def pieces_of(features: Array, table: CurveTable, low: float, high: float, mode: float) -> Array:
    """All pieces of a table's curves in a cell."""
    members = np.arange(len(table))
    pitch = pitch_of(table) if len(table) else 1.0
    kept, edges = np.full((len(members), EDGE_LENGTH + 1), np.nan), np.empty((2, EDGE_LENGTH))
    pieces = np.empty((1 << 16, PIECE_LENGTH))
    count = write_pieces(
        low, high, members, features, table.curves, pitch, 0.0, mode, np.inf, kept, edges, pieces
    )
    assert count >= 0
    return pieces[:count].copy()


def cross(first, second, features, table, mode, offset, period, flat=0.0, kernel=write_crossings) -> Array:
    """Roots (N, 3) of two pieces, found by a form of the kernel: orientation, radius and multiple of the period."""
    stack, roots = np.empty((STACK_DEPTH, STACK_LENGTH)), np.empty((MOST_ROOTS, 3))
    number = kernel(first, second, features, table.curves, mode, offset, period, flat, stack, roots)
    assert number >= 0
    return roots[:number].copy()


@numba.njit
def sampled(psis, curve, features, curves, mode):
    """Values and slopes of a curve at many orientations, and bounds of their errors, shape (N, 4)."""
    out = np.empty((psis.shape[0], 4))
    for k in range(psis.shape[0]):
        psi = psis[k]
        point = evaluate_point(psi, cos(psi), sin(psi), curve, features, curves, mode)
        out[k, 0], out[k, 1], out[k, 2], out[k, 3] = point
    return out


__all__ = ["HEIGHT", "POSITION", "cross", "lattice", "pieces_of", "random_table", "sampled"]
