"""Where two chord curves cross: roots of f = (second curve) - (first curve) - offset, modulo a period.

Over the common range of two pieces the slope of f is enclosed by the pieces' slopes. Where the enclosure has one sign, f
is monotone and its values at both ends tell how many targets it takes, each exactly once. Where it has not, the range is
dropped if no target lies between the bounds of f, and split otherwise. Nothing is sampled.

A range over which f stays within rounding of a target without being monotone is a touch: the slope of f vanishes there.
It carries no clamping force (the slope of f is minus the x distance between the jaws' instant centres, through which the
clamping force acts), so it is no fixture. Touches are counted, not followed. Curves that run on top of each other are
touches all along.
"""

from __future__ import annotations

from math import ceil, floor, isfinite, isinf

import numpy as np
from numpy.typing import NDArray

from holdfast.kernels.chord import curve_value
from holdfast.kernels.compiling import compiled
from holdfast.kernels.pieces import (
    BEND_HIGH,
    BEND_LOW,
    BRANCH,
    CURVE,
    HEAD,
    HIGH,
    LENGTH,
    LOW,
    SHIFT,
    SLOPE_HIGH,
    SLOPE_LOW,
    TAIL,
    VALUE_HIGH,
    VALUE_LOW,
    slope_range,
)

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

# Ranges narrower than this, in radians, are not split any further.
NARROWEST = 1e-13
# Where f stays this near to a target, in mm or radians, it touches it: a hundred times the rounding of f.
TOUCHING = 2e-12
# A guard against endless work; what is left after so many splits of one pair counts as a touch.
MOST_SPLITS = 4096
STACK_DEPTH = 256
MOST_ROOTS = 1024


@compiled
def value_at(
    psi: float, curve: int, features: Array, integers: IntArray, reals: Array, mode: float
) -> tuple[float, float]:
    """Value and slope of a curve of the table at an orientation."""
    return curve_value(
        features[integers[curve, TAIL]],
        features[integers[curve, HEAD]],
        reals[curve, LENGTH],
        psi + reals[curve, SHIFT],
        reals[curve, BRANCH],
        reals[curve, SHIFT],
        mode,
    )


@compiled
def value_bounds(
    value_low: float, value_high: float, lowest: float, highest: float, width: float
) -> tuple[float, float]:
    """Bounds of a function over a range from its values at both ends and bounds of its slope, finite or not."""
    low, high = min(value_low, value_high), max(value_low, value_high)
    if lowest >= 0.0 or highest <= 0.0:
        return (low, high)
    if isfinite(lowest) and isfinite(highest):
        # The function lies above the falling line from the low end and the rising line into the high end.
        spread = highest - lowest
        at = (value_low - value_high + highest * width) / spread
        bottom = value_low + lowest * min(max(at, 0.0), width)
        at = (value_high - value_low - lowest * width) / spread
        top = value_low + highest * min(max(at, 0.0), width)
        return (min(bottom, low), max(top, high))
    if isfinite(lowest):
        return (value_low + lowest * width, value_high - lowest * width)
    if isfinite(highest):
        return (value_high - highest * width, value_low + highest * width)
    return (-np.inf, np.inf)


@compiled
def solve(
    low: float,
    high: float,
    f_low: float,
    f_high: float,
    one: int,
    two: int,
    features: Array,
    integers: IntArray,
    reals: Array,
    mode: float,
    target: float,
) -> float:
    """The orientation at which a monotone f takes a target it brackets: Newton steps kept inside the bracket."""
    rising = f_high > f_low
    psi = low + (high - low) * (target - f_low) / (f_high - f_low)
    before = high - low
    for _ in range(100):
        if not low < psi < high:
            psi = (low + high) / 2.0
        value_one, slope_one = value_at(psi, one, features, integers, reals, mode)
        value_two, slope_two = value_at(psi, two, features, integers, reals, mode)
        rest = value_two - value_one - target
        if rest == 0.0:
            return psi
        if (rest > 0.0) == rising:
            high = psi
        else:
            low = psi
        step = rest / (slope_two - slope_one) if slope_two != slope_one else np.inf
        if abs(step) <= 2e-16 * max(1.0, abs(psi)) or high - low <= 4e-16 * max(1.0, abs(psi)):
            return psi
        if not abs(step) < before / 2.0:
            before = (high - low) / 2.0
            psi = (low + high) / 2.0
        else:
            before = abs(step)
            psi = psi - step
    return psi


@compiled
def targets(f_low: float, f_high: float, offset: float, period: float, closed: bool) -> tuple[int, int]:
    """First and last k with offset + k period in the range that a monotone f runs through.

    The value at the low end of psi is left out (unless ``closed``) and that at the high end is taken in, so that a root
    exactly where two ranges meet is found once. A tangency, where two branches begin, is closed: a root there is found on
    both. A period of 0 stands for the single target ``offset`` (k = 0).
    """
    if period == 0.0:
        hit = f_low < offset <= f_high or f_high <= offset < f_low or (closed and f_low == offset)
        return (0, 0) if hit else (1, 0)
    t_low, t_high = (f_low - offset) / period, (f_high - offset) / period
    if closed and t_low == floor(t_low):
        first, last = (t_low, floor(t_high)) if f_low <= f_high else (ceil(t_high), t_low)
        return (int(first), int(last))
    if f_low <= f_high:
        return (int(floor(t_low)) + 1, int(floor(t_high)))
    return (int(ceil(t_high)), int(ceil(t_low)) - 1)


@compiled
def crossings(
    first: Array,
    second: Array,
    features: Array,
    integers: IntArray,
    reals: Array,
    mode: float,
    offset: float,
    period: float,
    stack: Array,
    roots: Array,
) -> tuple[int, int]:
    """All orientations in the common range of two pieces at which f is a target.

    Parameters
    ----------
    first, second : (9,) pieces.
    mode : which value of the curves is compared, see ``curve_value``.
    offset, period : targets are offset + k period for whole k; a period of 0 allows k = 0 only.
    stack, roots : (STACK_DEPTH, 10) and (MOST_ROOTS,) work space.

    Returns
    -------
    (number of roots written to ``roots``, number of touches met)
    """
    low, high = max(first[LOW], second[LOW]), min(first[HIGH], second[HIGH])
    if not low < high:
        return (0, 0)
    one, two = int(first[CURVE]), int(second[CURVE])
    v1, s1, v2, s2 = first[VALUE_LOW], first[SLOPE_LOW], second[VALUE_LOW], second[SLOPE_LOW]
    w1, t1, w2, t2 = first[VALUE_HIGH], first[SLOPE_HIGH], second[VALUE_HIGH], second[SLOPE_HIGH]
    if low != first[LOW]:
        v1, s1 = value_at(low, one, features, integers, reals, mode)
    if low != second[LOW]:
        v2, s2 = value_at(low, two, features, integers, reals, mode)
    if high != first[HIGH]:
        w1, t1 = value_at(high, one, features, integers, reals, mode)
    if high != second[HIGH]:
        w2, t2 = value_at(high, two, features, integers, reals, mode)
    found = 0
    touches = 0
    depth = 0
    splits = 0
    while True:
        width = high - low
        low1, high1 = slope_range(s1, t1, first[BEND_LOW], first[BEND_HIGH], width)
        low2, high2 = slope_range(s2, t2, second[BEND_LOW], second[BEND_HIGH], width)
        lowest, highest = low2 - high1, high2 - low1
        f_low, f_high = v2 - v1, w2 - w1
        done = False
        if lowest > 0.0 or highest < 0.0:
            k, last = targets(f_low, f_high, offset, period, isinf(s1) or isinf(s2))
            while k <= last:
                if found < roots.shape[0]:
                    roots[found] = solve(
                        low, high, f_low, f_high, one, two, features, integers, reals, mode, offset + k * period
                    )
                    found += 1
                k += 1
            done = True
        else:
            if isfinite(lowest) or isfinite(highest):
                bottom, top = value_bounds(f_low, f_high, lowest, highest, width)
            else:
                bottom1, top1 = value_bounds(v1, w1, low1, high1, width)
                bottom2, top2 = value_bounds(v2, w2, low2, high2, width)
                bottom, top = bottom2 - top1, top2 - bottom1
            if period == 0.0:
                done = bottom > offset or top < offset
            else:
                done = floor((top - offset) / period) < ceil((bottom - offset) / period)
            if not done and (
                width <= NARROWEST or top - bottom <= TOUCHING or splits >= MOST_SPLITS or depth >= stack.shape[0]
            ):
                touches += 1
                done = True
        if done:
            if depth == 0:
                return (found, touches)
            depth -= 1
            item = stack[depth]
            low, high = item[0], item[1]
            v1, s1, v2, s2, w1, t1, w2, t2 = (
                item[2],
                item[3],
                item[4],
                item[5],
                item[6],
                item[7],
                item[8],
                item[9],
            )
            continue
        splits += 1
        middle = low + width / 2.0
        if isinf(s1) or isinf(s2):
            middle = low + width / 4.0
        elif isinf(t1) or isinf(t2):
            middle = high - width / 4.0
        m1, n1 = value_at(middle, one, features, integers, reals, mode)
        m2, n2 = value_at(middle, two, features, integers, reals, mode)
        item = stack[depth]
        item[0], item[1] = middle, high
        item[2], item[3], item[4], item[5] = m1, n1, m2, n2
        item[6], item[7], item[8], item[9] = w1, t1, w2, t2
        depth += 1
        high = middle
        w1, t1, w2, t2 = m1, n1, m2, n2
