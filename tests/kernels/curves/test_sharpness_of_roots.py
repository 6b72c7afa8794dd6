"""The constants of crossings and sliding pairs are needed: a tenth of each leaves one out. See ``sharpness``."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from math import asin, cos, hypot, inf, pi, sin
from random import Random
from typing import Any

import numpy as np
import pytest
from flint import arb

from chord_examples import arc_row, line_row
from contact_examples import limits
from exact_chords import exactly
from sharpness import Constant, changed, check_sharpness
from workhold.contact.curves import EVERYWHERE
from workhold.kernels.base.feature import FEATURE_LENGTH, SEGMENT_LENGTH
from workhold.kernels.base.tables import (
    CURVE_INTEGERS,
    CURVE_REALS,
    DIRECTION,
    SLIDING_PAIR_REALS,
    STEP_LENGTH,
    Curves,
    Features,
    Lattice,
)
from workhold.kernels.chord.evaluation import CurvePoint
from workhold.kernels.chord.stretches import STRETCH_LENGTH
from workhold.kernels.contact.record import RECORD_LENGTH
from workhold.kernels.curves import moving_pegs, roots, sliding_pairs
from workhold.kernels.curves.block_work import STATISTICS, make_block_space, make_block_work
from workhold.search.toolkit_search import ANY_ERROR

Array = np.ndarray[Any, np.dtype[np.float64]]
Kernel = Callable[..., Any]


def rest_rounded(random: Random, kernel: Kernel) -> float:
    """Rounding of the difference of two values from a target, itself rounded, over what is told for it."""
    one, two = random.uniform(1, 2), -random.uniform(1, 2)
    offset, period = random.uniform(-1, 1), random.uniform(1, 2)
    multiple = round((two - one - offset) / period)
    target = offset + multiple * period
    values = {0: CurvePoint(one, 1.0, 0.0, 0.0), 1: CurvePoint(two, 1.0, 0.0, 0.0)}
    form = changed(kernel, evaluate_point=lambda _, __, ___, curve, *____: values[curve])
    _, told = form(0.0, 1.0, target - 1, target + 1, 0, 1, None, None, 0.0, target, 0.5)
    rest = Fraction(abs(two - one - target))
    exact = abs(Fraction(two) - Fraction(one) - Fraction(offset) - multiple * Fraction(period))
    allowed = Fraction(float(told)) - rest
    return float(abs(exact - rest) / allowed) if allowed else inf


def slid(random: Random, misfit: float) -> tuple[Array, Array, Array]:
    """Two arcs with a sliding pair and its row, equal and one chord apart but for a misfit in mm."""
    angle, away = random.uniform(-pi, pi), random.uniform(3, 40)
    a = arc_row(0, 0, random.uniform(2, 30))
    b = arc_row(away * cos(angle), away * sin(angle), a[6] + random.uniform(-1, 1) * misfit)
    pair = np.zeros(SLIDING_PAIR_REALS)
    pair[DIRECTION], pair[STEP_LENGTH] = (
        np.arctan2(b[2], b[1]),
        hypot(b[1], b[2]) + random.uniform(-1, 1) * misfit,
    )
    return a, b, pair


def direction_rounded(random: Random, kernel: Kernel) -> float:
    """Rounding of a sliding pair's orientation for a lattice step, over what is told for it alone."""
    a, b, pair = slid(random, 0.0)
    column, row = random.randint(-9, 9), random.randint(-9, 9) or 1
    orientation = float(pair[DIRECTION] - np.arctan2(row, column))
    with exactly():
        off = arb.atan2(arb(b[2]), arb(b[1])) - arb.atan2(arb(row), arb(column)) - orientation
        return float(abs(off).upper()) / float(
            changed(kernel, bound_backward_error=lambda *_: 0.0)(a, b, pair)
        )


def arcs_off(random: Random, kernel: Kernel) -> float:
    """How far a chord of arcs that miss a sliding pair by a millionth is turned where it slides, its lines of action 15
    degrees from it or more, over how far it may as told."""
    a, b, pair = slid(random, 1e-6)
    told = changed(kernel, bound_backward_error=lambda *_: 0.0)(a, b, pair)
    phi = random.choice([-1, 1]) * random.uniform(asin(0.25), pi - asin(0.25)) + pair[DIRECTION]
    tail, d = a[1:3] + a[6] * np.array([cos(phi), sin(phi)]), pair[STEP_LENGTH]
    # The head beside it: where the circle about the tail meets the other arc, by Newton's method.
    alpha = pair[DIRECTION]
    for _ in range(20):
        way = tail + d * np.array([cos(alpha), sin(alpha)]) - b[1:3]
        along = d * np.array([-sin(alpha), cos(alpha)])
        alpha -= (hypot(*way) - b[6]) / float(way @ along / hypot(*way))
    return abs(float(alpha - pair[DIRECTION])) / float(told)


def past_a_sliding_end(random: Random, kernel: Kernel) -> float:
    """A tail at the end of where it slides on an arc, moved along by part of a radius: the radius that must be told."""
    row = arc_row(0, 0, 10 ** random.uniform(-1, 2))
    off = row[6] * random.uniform(0.01, 0.7)
    angle = 0.5 + 2 * asin(off / 2 / row[6])
    pair = np.array([-0.5, 0.5, 0.0, 1.0, 0.0])
    low, high = 0.0, off
    for _ in range(20):
        middle = (low + high) / 2
        keeps = kernel(row, pair, row[6] * cos(angle), row[6] * sin(angle), middle)
        low, high = (low, middle) if keeps else (middle, high)
    return inf if not kernel(row, pair, row[6] * cos(angle), row[6] * sin(angle), off) else high / off


def moving_peg_off(name: str) -> Callable[[Random, Kernel], float]:
    """How far the height of a peg 2 L away, or its place along x, changes with the orientation, over how far as told."""

    def ratio(random: Random, kernel: Kernel) -> float:
        length, reach = random.uniform(5, 50), 10 ** random.uniform(-9, -4)
        told: list[float] = []

        def meets(row: Array, ax: float, ay: float, height: float, error: float, side: float) -> Any:
            told.append(error)
            return True, 0.0, 0.0, 0.0

        def closes(*given: Any) -> bool:
            told.append(-given[7] - moving_pegs.GAP_SLACK - moving_pegs.HAIR)
            return False

        rows = np.zeros((4, FEATURE_LENGTH))
        rows[:, :SEGMENT_LENGTH] = line_row(0, 0, 1.0, length)
        form = changed(kernel, intersect_at_height=meets, may_close=closes)
        features = Features(rows[:, :SEGMENT_LENGTH], rows, (0, 4), (0, 4), ANY_ERROR, EVERYWHERE)
        curves = Curves(
            np.zeros((0, CURVE_INTEGERS), np.int64),
            np.zeros((0, CURVE_REALS)),
            np.zeros((0, STRETCH_LENGTH)),
        )
        given = features, curves, Lattice(1.0, 1.0, 0.0), limits(length, 0.0), False
        work = make_block_work(*given, np.zeros(STATISTICS, np.int64), make_block_space(1, 1, 1))
        out = np.zeros((16, RECORD_LENGTH))
        work.pegs[:] = 0.0
        form(out, 0, (0.0, 1.0, 0.0), reach, work)
        error, gap = told[:2]
        return 2 * length * sin(reach) / (error if name == "height" else gap)

    return ratio


CONSTANTS = [
    Constant("crossing, 4 half units", roots.solve_for_target, rest_rounded, symbol="ROUNDINGS", draws=400),
    Constant(
        "sliding pair, 4e-15",
        sliding_pairs.bound_orientation_error,
        direction_rounded,
        symbol="ROUNDING",
        draws=300,
    ),
    Constant("sliding arcs, 4 misfits", sliding_pairs.bound_orientation_error, arcs_off, 4.0),
    Constant("sliding tail, 1.2", sliding_pairs.is_tail_inside, past_a_sliding_end, 1.2),
    Constant(
        "moving peg's height, 4 L", moving_pegs.add_moving_pegs, moving_peg_off("height"), 4.0, 0, draws=20
    ),
    Constant("moving peg's gap, 4 L", moving_pegs.add_moving_pegs, moving_peg_off("gap"), 4.0, 1, draws=20),
]


@pytest.mark.parametrize("constant", CONSTANTS, ids=lambda constant: constant.name)
@pytest.mark.prove
def test_a_tenth_of_a_constant_would_not_do(constant: Constant) -> None:
    """The bound holds on every input, and with a tenth of the constant it does not."""
    check_sharpness(constant)
