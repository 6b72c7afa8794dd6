"""Stretches: ranges of direction over which a chord's instant centre P moves at a bounded speed.

All lattice steps of one length share the stretches of their curves: P, seen from the workpiece, depends on the direction
alpha only. Beside a tangency, where P runs off to infinity, a short stretch tells of X^3 P' and X^3 instead (see
``chord.center_speeds``), from which the signs of second derivatives follow.

Columns of a stretch: STRETCH_HIGH (where it ends, alpha in radians; it begins where the one before it ends, the first part
of a stretch where that begins), SPEED (bound of |P'| in mm per radian, infinite beside a tangency), X_LOW, X_HIGH, Y_LOW,
Y_HIGH (of X^3 P'), ALONG_LOW, ALONG_HIGH (of X^3 P' . r_a), LARGEST_CROSS (largest |X|, with the sign of X), LEAST_CUBE
(smallest |X|^3), PART_A, PART_B (largest sizes of the parts of X^3 P' along r_a and r_b), PARTS (how many of the rows that
follow divide this stretch once more, for lattice steps whose curves it tells too little of).
"""

from __future__ import annotations

from math import hypot, inf

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.compiling import inner, inner_making_arrays
from workhold.kernels.base.feature import IS_ARC
from workhold.kernels.base.growing import with_room
from workhold.kernels.chord.center_speeds import center_motion
from workhold.kernels.chord.evaluation import chord
from workhold.kernels.curves.columns import BRANCH, FROM, LENGTH, TANGENT_FROM, TANGENT_TO, TO

Array = NDArray[np.float64]

STRETCH_HIGH, SPEED, X_LOW, X_HIGH, Y_LOW, Y_HIGH, ALONG_LOW, ALONG_HIGH = range(8)
LARGEST_CROSS, LEAST_CUBE, PART_A, PART_B, PARTS = range(8, 13)
STRETCH_LENGTH = 13

# Widest and narrowest stretches in radians, and the length to which those beside a tangency are cut.
WIDEST = 0.25
NARROWEST = 1e-7
BESIDE = 4e-3
# Each part of a stretch beside a tangency is this much shorter than the one before it; the last between two arcs, and
# between a line and an arc, where the chord may run along the line (as at a tangent joint of the part) and pass the
# tangency smoothly.
SHORTER = 4.0
LAST_OF_ARCS, LAST_OF_LINE = 1e-8, 1e-12
# What cannot be bounded is cut no further than this.
LAST = 1e-7
DEPTH = 64
# How far P may move over a stretch, in chord lengths.
MOST_MOTION = 1.0


@inner
def write_stretch(row: Array, a: Array, b: Array, curve: Array, low: float, high: float, sign: float) -> bool:
    """Write the stretch over [low, high] to a (13,) row; whether it is good enough, and not to be cut further.

    The speed is good enough when it is of the order of that in the middle, so that a shorter stretch would tell no more, or
    when P moves no farther than some part of the chord's length.
    """
    turn, x, y, along, part_a, part_b = center_motion(a, b, curve, low, high, sign)
    row[STRETCH_HIGH], row[PARTS] = high, 0.0
    row[X_LOW], row[X_HIGH], row[Y_LOW], row[Y_HIGH] = x[0], x[1], y[0], y[1]
    row[ALONG_LOW], row[ALONG_HIGH] = along
    row[PART_A], row[PART_B] = max(-part_a[0], part_a[1]), max(-part_b[0], part_b[1])
    row[LARGEST_CROSS] = turn[1] if sign > 0.0 else turn[0]
    least, most = min(abs(turn[0]), abs(turn[1])), abs(row[LARGEST_CROSS])
    size = hypot(max(-x[0], x[1]), max(-y[0], y[1]))
    row[SPEED], row[LEAST_CUBE] = inf, least * least * least
    if least > 0.0 and size < inf:
        row[SPEED] = size / row[LEAST_CUBE] * (1.0 + 1e-12)
    middle = (least + most) / 2.0
    typical = hypot(x[0] + x[1], y[0] + y[1]) / (2.0 * middle * middle * middle)
    return row[SPEED] <= max(4.0 * typical + 4.0 * curve[LENGTH], MOST_MOTION * curve[LENGTH] / (high - low))


@inner_making_arrays
def add_parts(
    out: Array,
    count: int,
    a: Array,
    b: Array,
    curve: Array,
    left: float,
    right: float,
    at_low: bool,
    error: float,
    sign: float,
) -> tuple[Array, int]:
    """Append the parts of the last stretch, in order, which begins (``at_low``) or ends at a tangency known to ``error``."""
    width, number = right - left, 1
    last = max(LAST_OF_LINE if a[IS_ARC] + b[IS_ARC] == 1.0 else LAST_OF_ARCS, 8.0 * error)
    while width > last:
        width /= SHORTER
        number += 1
    out[count - 1, PARTS] = number
    low = left
    for k in range(number):
        out = with_room(out, count)
        # The parts grow away from the tangency.
        high = (
            left + (right - left) * SHORTER ** -(number - 1.0 - k)
            if at_low
            else right - (right - left) * SHORTER ** -(k + 1.0)
        )
        if k == number - 1:
            high = right
        write_stretch(out[count], a, b, curve, low, high, sign)
        low = high
        count += 1
    return out, count


@inner_making_arrays
def add_stretches(out: Array, count: int, a: Array, b: Array, curve: Array) -> tuple[Array, int]:
    """Append the stretches of a curve, in order, to ``out`` (grown as needed)."""
    low, high = curve[FROM], curve[TO]
    c = chord(a, b, curve[LENGTH], (low + high) / 2.0, curve[BRANCH])
    sign = 1.0 if c[2] * c[5] - c[3] * c[4] > 0.0 else -1.0
    stack = np.empty(DEPTH)
    depth = 0
    left, right = low, high
    while True:
        out = with_room(out, count)
        width = right - left
        good = write_stretch(out[count], a, b, curve, left, right, sign)
        at_low = left == low and curve[TANGENT_FROM] > 0.0
        at_high = right == high and curve[TANGENT_TO] > 0.0
        if out[count, SPEED] < inf:
            done = (good and width <= WIDEST) or width <= NARROWEST
        else:
            done = width <= BESIDE if at_low != at_high else width <= LAST
        if not done and depth < DEPTH:
            stack[depth] = right
            depth += 1
            if at_low and not at_high:
                right = left + max(width / 4.0, min(width / 2.0, BESIDE))
            elif at_high and not at_low:
                right = right - max(width / 4.0, min(width / 2.0, BESIDE))
            else:
                right = left + width / 2.0
            continue
        count += 1
        if at_low != at_high:
            error = curve[TANGENT_FROM] if at_low else curve[TANGENT_TO]
            out, count = add_parts(out, count, a, b, curve, left, right, at_low, error, sign)
        if depth == 0:
            return out, count
        left = right
        depth -= 1
        right = stack[depth]
