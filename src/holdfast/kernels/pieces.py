"""Pieces: chord curves cut to a cell of orientations, with what is needed to bound them.

Glossary
--------
cell : a closed range of orientations psi; the work is shared out by cells.
piece : a chord curve over a range inside one cell, with value and derivative at both ends and an enclosure of its second
    derivative ("bend") over the whole range. The bend keeps one sign, or the derivative it allows varies little; so the
    derivative over any part of the piece is bounded by its values at that part's ends.


Columns of a piece: LOW, HIGH (psi in radians), VALUE and SLOPE at both ends, BEND_LOW, BEND_HIGH, CURVE (index), and the
bounds VALUE_ERROR and SLOPE_ERROR of the errors at both ends.
"""

from __future__ import annotations

from math import floor, inf, isfinite, pi

import numpy as np
from numpy.typing import NDArray

from holdfast.kernels.chord import POSITION, chord, curve_value
from holdfast.kernels.chord_bounds import curve_bend, value_disc
from holdfast.kernels.compiling import compiled

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

LOW, HIGH, VALUE_LOW, SLOPE_LOW, VALUE_HIGH, SLOPE_HIGH, BEND_LOW, BEND_HIGH, CURVE = range(9)
VALUE_ERROR_LOW, SLOPE_ERROR_LOW, VALUE_ERROR_HIGH, SLOPE_ERROR_HIGH = range(9, 13)
PIECE_LENGTH = 13

# Columns of a curve's whole numbers and of its real numbers.
TAIL, HEAD, COLUMN_STEP, ROW_STEP, CENTER = range(5)
CURVE_INTEGERS = 5
FROM, TO, BRANCH, TANGENT_FROM, TANGENT_TO, LENGTH, SHIFT = range(7)
CURVE_REALS = 7

TURN = 2.0 * pi
# Ranges of orientation narrower than this, in radians, are not split any further.
NARROWEST = 1e-12


@compiled
def grown(array: Array) -> Array:
    """A copy of a (N, M) array with room for twice as many rows."""
    out = np.empty((2 * array.shape[0], array.shape[1]))
    for i in range(array.shape[0]):
        for j in range(array.shape[1]):
            out[i, j] = array[i, j]
    return out


@compiled
def turn_sign(a: Array, b: Array, d: float, alpha: float, branch: float) -> float:
    """Sign of the cross product X of the two contact directions."""
    c = chord(a, b, d, alpha, branch)
    return 1.0 if c[2] * c[5] - c[3] * c[4] > 0.0 else -1.0


@compiled
def unwrapped(value: float, near: float) -> float:
    """An angle moved by whole turns to be nearest to another."""
    return value + TURN * floor((near - value) / TURN + 0.5)


@compiled
def add_pieces(
    out: Array,
    count: int,
    features: Array,
    integers: IntArray,
    reals: Array,
    curve: int,
    low: float,
    high: float,
    tangent_low: float,
    tangent_high: float,
    mode: float,
    flatness: float,
) -> tuple[Array, int]:
    """Cut one curve over [low, high] into pieces and append them to ``out`` (grown as needed).

    Parameters
    ----------
    low, high : psi in radians, inside the curve's range and inside one cell.
    tangent_low, tangent_high : bound of the error in radians of that end where the chord is a tangency (infinite slope)
        there, 0 where it is not.
    flatness : how much the slope of a piece without a one-signed bend may vary, in mm per radian.
    """
    a, b = features[integers[curve, TAIL]], features[integers[curve, HEAD]]
    d, branch, shift = reals[curve, LENGTH], reals[curve, BRANCH], reals[curve, SHIFT]
    sign = turn_sign(a, b, d, shift + (low + high) / 2.0, branch)
    circles = mode == POSITION and a[0] != 0.0 and a[5] >= pi
    if mode == POSITION and a[0] != 0.0:
        flatness = flatness / a[6]
    left = low
    right = high
    stack = np.empty(200)
    depth = 0
    while True:
        bends = curve_bend(a, b, d, shift + left, shift + right, branch, shift, mode, sign)
        width = right - left
        settled = bends[0] >= 0.0 or bends[1] <= 0.0 or (bends[1] - bends[0]) * width <= flatness
        # Nothing is learnt of a range no longer than the error of its end.
        smallest = NARROWEST
        if left == low:
            smallest = max(smallest, 4.0 * tangent_low)
        if right == high:
            smallest = max(smallest, 4.0 * tangent_high)
        if not settled and width > smallest and depth < 199:
            stack[depth] = right
            depth += 1
            if tangent_low > 0.0 and left == low:
                right = left + width / 8.0
            elif tangent_high > 0.0 and right == high:
                right = right - width / 8.0
            else:
                right = left + width / 2.0
            continue
        if count == out.shape[0]:
            out = grown(out)
        row = out[count]
        count += 1
        value_low, slope_low, error_low, spread_low = curve_value(a, b, d, shift + left, branch, shift, mode)
        value_high, slope_high, error_high, spread_high = curve_value(a, b, d, shift + right, branch, shift, mode)
        # Where the branches meet, or nearly so, the value is bounded by a disc, a hair beyond the end included.
        at_low, at_high = tangent_low > 0.0 and left == low, tangent_high > 0.0 and right == high
        if at_low:
            slope_low, spread_low = end_slope(bends, -1.0)
        if at_high:
            slope_high, spread_high = end_slope(bends, 1.0)
        if at_low or not isfinite(error_low):
            value_low, error_low = value_disc(a, b, d, shift + left, branch, tangent_low, shift, mode)
        if at_high or not isfinite(error_high):
            value_high, error_high = value_disc(a, b, d, shift + right, branch, tangent_high, shift, mode)
        if circles:
            middle = curve_value(a, b, d, shift + left + width / 64.0, branch, shift, mode)[0]
            value_low = unwrapped(value_low, middle)
            middle = curve_value(a, b, d, shift + right - width / 64.0, branch, shift, mode)[0]
            value_high = unwrapped(value_high, middle)
        row[LOW], row[HIGH], row[CURVE] = left, right, curve
        row[VALUE_LOW], row[SLOPE_LOW] = value_low, slope_low
        row[VALUE_HIGH], row[SLOPE_HIGH] = value_high, slope_high
        row[VALUE_ERROR_LOW], row[SLOPE_ERROR_LOW] = error_low, spread_low
        row[VALUE_ERROR_HIGH], row[SLOPE_ERROR_HIGH] = error_high, spread_high
        row[BEND_LOW], row[BEND_HIGH] = bends[0], bends[1]
        if depth == 0:
            return out, count
        left = right
        depth -= 1
        right = stack[depth]


@compiled
def end_slope(bends: tuple[float, float], side: float) -> tuple[float, float]:
    """Slope at a tangency and its error: infinite, with the sign the bend gives it (side -1 at the low end, +1 at the high
    end), or unknown."""
    if bends[0] >= 0.0:
        return (side * inf, 0.0)
    if bends[1] <= 0.0:
        return (-side * inf, 0.0)
    return (0.0, inf)


@compiled
def cell_pieces(
    cell_low: float,
    cell_high: float,
    members: IntArray,
    features: Array,
    integers: IntArray,
    reals: Array,
    mode: float,
    flatness: float,
) -> Array:
    """Pieces of the given curves inside one cell.

    Parameters
    ----------
    cell_low, cell_high : psi in radians, less than a turn apart.
    members : (M,) indices of curves to consider.
    features : (F, 8) rows.
    integers, reals : (C, 5) and (C, 7) curve table.

    Returns
    -------
    (N, 13) array
    """
    out = np.empty((64, PIECE_LENGTH))
    count = int(np.int64(0))
    for curve in members:
        base = reals[curve, FROM] - reals[curve, SHIFT]
        span = reals[curve, TO] - reals[curve, FROM]
        start = base + TURN * floor((cell_low - base) / TURN)
        for lap in range(2):
            low, high = start + lap * TURN, start + lap * TURN + span
            left, right = max(low, cell_low), min(high, cell_high)
            if right - left <= 0.0:
                continue
            tangent_low = reals[curve, TANGENT_FROM] if left == low else 0.0
            tangent_high = reals[curve, TANGENT_TO] if right == high else 0.0
            out, count = add_pieces(
                out, count, features, integers, reals, curve, left, right, tangent_low, tangent_high, mode, flatness
            )
    return out[:count]


@compiled
def slope_range(
    slope_low: float, slope_high: float, bend_low: float, bend_high: float, width: float
) -> tuple[float, float]:
    """Enclosure of a slope over a range from its values at both ends and the bend between them."""
    if bend_low >= 0.0:
        return (slope_low, slope_high)
    if bend_high <= 0.0:
        return (slope_high, slope_low)
    if not (isfinite(bend_low) and isfinite(bend_high)):
        return (-inf, inf)
    # Lowest point of the larger of two falling lines from the ends, and the mirror image.
    spread = bend_high - bend_low
    at = (slope_low - slope_high + bend_high * width) / spread
    lowest = slope_low + bend_low * min(max(at, 0.0), width)
    at = (slope_high - slope_low - bend_low * width) / spread
    highest = slope_low + bend_high * min(max(at, 0.0), width)
    return (min(lowest, slope_low, slope_high), max(highest, slope_low, slope_high))
