"""The constants in what a piece tells are needed: a tenth of each leaves out an exact chord. See ``sharpness``."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from math import cos, inf, isfinite, pi, sin
from random import Random
from typing import Any

import numpy as np
import pytest
from flint import arb

from chord_examples import any_ranges, curve_row
from exact_chords import dot, exact_chord, exactly
from sharpness import Constant, changed, check_sharpness
from workhold.kernels.base.tables import (
    BACKWARD_ERROR,
    EDGE_LENGTH,
    EDGE_VALUE,
    EDGE_VALUE_ERROR,
    EDGE_X,
    HEAD_NORMAL_X,
    KAPPA,
    LEFTWARD_HIGH,
    LEFTWARD_LOW,
    PIECE_LENGTH,
    RIGHTWARD_HIGH,
    RIGHTWARD_LOW,
    SHIFT,
    TAIL_NORMAL_X,
    VALUE_ERROR_HIGH,
    VALUE_ERROR_LOW,
    VALUE_HIGH,
    VALUE_LOW,
    VALUE_MOST,
    X_MOVING,
)
from workhold.kernels.chord.coincidences import NONE, find_coincidence
from workhold.kernels.chord.evaluation import HEIGHT
from workhold.kernels.chord.stretches import SPEED, STRETCH_LENGTH, write_stretch
from workhold.kernels.curves import piece_bounds, piece_enclosures
from workhold.kernels.curves.piece_bounds import write_edge

Array = np.ndarray[Any, np.dtype[np.float64]]
Kernel = Callable[..., Any]


def edges_of(a: Array, b: Array, curve: Array, low: float, high: float) -> tuple[Array, Array, Array]:
    """Both edges of a piece, and its row with the values there."""
    edges, row = np.zeros((2, EDGE_LENGTH)), np.zeros(PIECE_LENGTH)
    for edge, psi in zip(edges, (low, high), strict=True):
        write_edge(edge, a, b, curve, psi, cos(psi), sin(psi), HEIGHT)
    row[[VALUE_LOW, VALUE_HIGH]] = edges[:, EDGE_VALUE]
    row[[VALUE_ERROR_LOW, VALUE_ERROR_HIGH]] = edges[:, EDGE_VALUE_ERROR]
    return edges[0], edges[1], row


def steady_chord(random: Random) -> tuple[Array, Array, float, float, float, float, Array]:
    """A chord over a range with a bounded speed: features, length, branch, middle and width of directions, stretch."""
    while True:
        a, b, d, ranges = any_ranges(random, 1e-2)
        if find_coincidence(a, b, d)[0] != NONE:
            continue
        low, high, branch = (float(v) for v in ranges[random.randrange(len(ranges))][:3])
        width = (high - low) * 10 ** random.uniform(-4, -1)
        alpha = random.uniform(low + width, high - width)
        stretch, curve = np.zeros(STRETCH_LENGTH), curve_row(a, b, d, branch)
        with exactly():
            chord = exact_chord(a, b, d, arb(alpha), branch)
            if chord is None or abs(float(chord.turn().mid())) < 1e-3:
                continue
            sign = 1.0 if chord.turn() > 0 else -1.0
        write_stretch(stretch, a, b, curve, alpha - width / 2, alpha + width / 2, sign)
        if isfinite(stretch[SPEED]):
            return a, b, d, branch, alpha, width, stretch


def between_ends(random: Random, kernel: Kernel) -> float:
    """How far height and place along x leave their values at the ends of a piece about the largest, over how far they may
    as told."""
    a, b, d, branch, alpha, width, stretch = steady_chord(random)
    with exactly():
        chord = exact_chord(a, b, d, arb(alpha), branch)
        assert chord is not None
        # The height h, of slope -x . P, is largest where y points along P, and the place along x where x does.
        x, y = (float(v.mid()) for v in chord.center())
    upward = random.random() < 0.5
    psi = np.arctan2(y, x) - (pi / 2 if upward else 0.0)
    curve = curve_row(a, b, d, branch, alpha - psi)
    low, high, row = edges_of(a, b, curve, psi - width / 2, psi + width / 2)
    kernel(row, a, curve, low, high, stretch, width, 0.0, HEIGHT)
    with exactly():
        exact = exact_chord(a, b, d, arb(psi) + float(curve[SHIFT]), branch)
        assert exact is not None
        turned = arb(psi)
        place = exact.height(turned)[0] if upward else dot((turned.cos(), turned.sin()), exact.tail)
        most = max(row[VALUE_LOW], row[VALUE_HIGH]) if upward else max(low[EDGE_X], high[EDGE_X])
        beyond = float((place - float(most)).upper())
    return beyond / float(row[VALUE_MOST if upward else X_MOVING] - most)


def normals_off(random: Random, kernel: Kernel) -> float:
    """Angle between computed normals and those of contacts off their features, over how far directions may sag as told."""
    a, b, d, branch, alpha, width, stretch = steady_chord(random)
    curve, width = curve_row(a, b, d, branch), 0.0
    if not curve[KAPPA]:
        return 0.0
    told: list[float] = []
    curve[BACKWARD_ERROR] = eta = 1e-7
    low, high, row = edges_of(a, b, curve, alpha, alpha)
    kernel_with = changed(kernel, write_force_directions=lambda *given: told.append(given[4]))
    kernel_with(row, a, curve, low, high, stretch, width, 0.0, HEIGHT)
    if not told or not isfinite(told[0]):
        return 0.0
    worst = 0.0
    with exactly():
        one = exact_chord(a, b, d, arb(alpha), branch)
        assert one is not None
        for sides in ((-1, -1), (-1, 1), (1, -1), (1, 1)):
            other = exact_chord(shifted(a, sides[0] * eta), shifted(b, sides[1] * eta), d, arb(alpha), branch)
            if other is None:
                return inf
            for p, q in ((one.along_a, other.along_a), (one.along_b, other.along_b)):
                worst = max(worst, float(abs(p[0] * q[1] - p[1] * q[0]).upper()))
    return worst / told[0]


def shifted(row: Array, off: float) -> Array:
    """A feature moved outward by ``off`` mm."""
    out = row.copy()
    if row[0] == 0.0:
        out[1:3] += off * row[4], -off * row[3]
    else:
        out[6] += off
    return out


def turn_told(random: Random, kernel: Kernel) -> float:
    """How far a normal turns from end to end, by up to a radian, over how far as told."""
    angles, turn = [random.uniform(-pi, pi) for _ in range(2)], random.uniform(0, 1)
    return turn / float(kernel(*(edge_of([angles[0], angles[1] + part]) for part in (0.0, turn))))


def edge_of(angles: list[float]) -> Array:
    """An edge with normals in two directions."""
    edge = np.zeros(EDGE_LENGTH)
    edge[TAIL_NORMAL_X : TAIL_NORMAL_X + 2] = cos(angles[0]), sin(angles[0])
    edge[HEAD_NORMAL_X : HEAD_NORMAL_X + 2] = cos(angles[1]), sin(angles[1])
    return edge


def forces(angles: list[float], share: float, sign: float) -> list[float]:
    """Directions, as ``front`` tells them, of the forces of two pegs neither of which is less than a share of the other."""
    one, two, out = complex(cos(angles[0]), sin(angles[0])), complex(cos(angles[1]), sin(angles[1])), []
    for part in (0.0, 0.01, 0.5, 0.99, 1.0):
        force = sign * ((share + part * (1 - share)) * one + (1 - part * (1 - share)) * two)
        if force.real > 1e-12:
            out.append(force.imag / (force.real + abs(force.imag)))
    return out


def sagging(shared: bool) -> Callable[[Random, Kernel], float]:
    """Normals that turn evenly over a piece, but for a sag: how far their forces leave what is told without the sag, over
    how far they may as told."""

    def ratio(random: Random, kernel: Kernel) -> float:
        share, doubt = random.uniform(0.5, 0.99) if shared else 0.0, 10 ** random.uniform(-5, -2)
        start, turns = (
            [random.uniform(-pi, pi) for _ in range(2)],
            [random.uniform(-0.25, 0.25) for _ in range(2)],
        )
        if shared:
            # Nearly opposite, so that their sums turn most.
            start[1], turns = start[0] + random.choice([-1, 1]) * random.uniform(2.4, 2.8), [0.0, 0.0]
        elif random.random() < 0.5:
            # About square to x, where directions with a part along x begin.
            start[1] = random.choice([-1, 1]) * pi / 2 + 2 * random.uniform(-1, 1) * doubt
            turns = [part * random.choice([0.0, 1.0]) for part in turns]
        edges = [edge_of([a + part * t for a, t in zip(start, turns, strict=True)]) for part in (0, 1)]
        bare, told = np.zeros((2, PIECE_LENGTH))
        kernel(told, *edges, share, doubt)
        piece_bounds.write_hull(bare, *edges, share, 0.0)
        worst, signs = 0.0, set()
        for part, one, two in product((0.0, 0.2, 0.5, 0.8, 1.0), (-1, 1), (-1, 1)):
            sag = 4 * part * (1 - part) * doubt
            angles = [a + part * t + s * sag for a, t, s in zip(start, turns, (one, two), strict=True)]
            signs.add(sin(angles[1] - angles[0]) > 0.0)
            for sign, low, high in ((-1, RIGHTWARD_LOW, RIGHTWARD_HIGH), (1, LEFTWARD_LOW, LEFTWARD_HIGH)):
                for force in forces(angles, share, sign):
                    worst = max(worst, left(force, bare[low], bare[high], told[low], told[high]))
        # Normals do not pass through parallel ones.
        return worst if len(signs) == 1 else 0.0

    return ratio


def left(force: float, bare_low: float, bare_high: float, low: float, high: float) -> float:
    """How far a number is outside one range, over how much farther out the ends of a wider one are; infinite outside an
    empty one."""
    if low > high:
        return inf
    if bare_low > bare_high or (low <= -1.0 and high >= 1.0):
        return 0.0
    below, above = bare_low - low, high - bare_high
    return max(
        (bare_low - force) / below if below > 0 else 0.0,
        (force - bare_high) / above if above > 0 else 0.0,
    )


CONSTANTS = [
    Constant("between ends, w² / 8", piece_enclosures.write_steady, between_ends, 8.0, draws=60, times=10.0),
    Constant(
        "directions of a piece, 2 errors", piece_enclosures.write_steady, normals_off, 2.0, 0, draws=150
    ),
    Constant("turn of normals, 1.06", piece_bounds.bound_normal_turn, turn_told, 1.06),
    Constant("hull of forces, 4 doubts", piece_bounds.write_hull, sagging(False), 4.0, draws=600),
    Constant("forces at both ends, 2 doubts", piece_bounds.write_hull, sagging(False), 2.0, 0, draws=600),
    Constant("sums of forces, 2.6", piece_bounds.write_force_directions, sagging(True), 2.6, draws=600),
]


@pytest.mark.parametrize("constant", CONSTANTS, ids=lambda constant: constant.name)
@pytest.mark.prove
def test_a_tenth_of_a_constant_would_not_do(constant: Constant) -> None:
    """The bound holds on every input, and with a tenth of the constant it does not."""
    check_sharpness(constant)
