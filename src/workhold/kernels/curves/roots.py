"""Where two chord curves cross: roots of f = (second curve) - (first curve) - offset, modulo a period.

Over the common range of two pieces the slope of f is enclosed by the pieces' slopes and their errors. Where
the enclosure has one sign, f is monotone and its values at both ends determine how many targets it can take,
each at most once. Where it has not, the range is dropped if no target lies between the bounds of f, and split
otherwise. Nothing is sampled. A target that the errors leave in doubt counts as taken: what comes of it is
decided by those who examine the contacts there.

Every root is given with a radius: the exact root, if there is one, is no farther from it. A range
too narrow to split in which f may take a target, monotone or not, is given as one root with half the range as
its radius. So is every range where two curves run on top of each other.
"""

from __future__ import annotations

from math import ceil, cos, floor, isfinite, isinf, sin

import numpy as np

from workhold.kernels.base.compiling import Array, inner
from workhold.kernels.base.interval import slope_range, value_bounds
from workhold.kernels.base.tables import (
    CURVE,
    HEAD,
    HIGH,
    LOW,
    SECOND_DERIVATIVE_HIGH,
    SECOND_DERIVATIVE_LOW,
    SLOPE_ERROR_HIGH,
    SLOPE_ERROR_LOW,
    SLOPE_HIGH,
    SLOPE_LOW,
    TAIL,
    VALUE_ERROR_HIGH,
    VALUE_ERROR_LOW,
    VALUE_HIGH,
    VALUE_LOW,
    Curves,
)
from workhold.kernels.chord.evaluation import chord_state, valued
from workhold.kernels.curves.piece_bounds import SAME, value_disc

# Ranges narrower than this, in radians, are not split any further: at a double root the clamping force is
# then below ``conventions.LEAST_CLAMPING`` throughout.
NARROWEST = 1e-8
# A range over which a curve moves farther than this, in mm or radians, is split beyond the narrowest.
FARTHEST = 1e-6
# A guard against endless work; what is left after so many splits of one pair is given as it is.
MOST_SPLITS = 4096
# Splits after which chords themselves are bounded, also where something is known of the slopes.
MANY_SPLITS = 256
STACK_DEPTH = 256
MOST_ROOTS = 1 << 15
# Rounding of an interpolated value in mm or radians, generously counted.
HAIR = 1e-9
# Radians. Ranges from which on chords of unknown slopes are bounded as discs, and to which they are split.
WIDEST_DISC = 0.1
NARROWEST_DISC = 1e-13
# Columns of a root: ROOT_PSI and ROOT_RADIUS in radians, MULTIPLE (k of the target offset + k period).
ROOT_PSI, ROOT_RADIUS, MULTIPLE = range(3)
STACK_LENGTH = 18
# Rounding of a difference of values from a target, relative to them, in half units in the last place: of the
# difference, of the target's product and sum, and of the difference from it.
ROUNDINGS = 4.0 * 1.2e-16


@inner
def value_at(
    psi: float, curve: int, features: Array, curves: Curves, mode: float
) -> tuple[float, float, float, float]:
    """Value and slope of a curve of the table at an orientation, and bounds of their errors (that of the
    slope may be infinite)."""
    return value_turned(psi, cos(psi), sin(psi), curve, features, curves, mode)


@inner
def value_turned(
    psi: float, cosine: float, sine: float, curve: int, features: Array, curves: Curves, mode: float
) -> tuple[float, float, float, float]:
    """What ``value_at`` returns at an orientation of known cosine and sine, which two curves share."""
    a, b = features[curves.integers[curve, TAIL]], features[curves.integers[curve, HEAD]]
    row = curves.reals[curve]
    state = chord_state(a, b, row, psi, cosine, sine)
    value, slope, error, spread = valued(a, b, state, cosine, sine, mode)
    if not isfinite(error):
        value, error = value_disc(a, b, row, psi, SAME, mode)
    return value, slope, error, spread


@inner
def first_guess(
    low: float, high: float, f_low: float, f_high: float, slope_low: float, slope_high: float
) -> float:
    """Where a monotone function from f_low to f_high is 0: the cubic through the ends of its inverse, or the
    straight line where its slopes vary too much for that."""
    width, rise = high - low, f_high - f_low
    along = -f_low / rise
    one, two = rise / (width * slope_low), rise / (width * slope_high)
    if 0.0 < one < 3.0 and 0.0 < two < 3.0:
        rest = 1.0 - along
        along = along * along * (3.0 - 2.0 * along) + along * rest * (rest * one - along * two)
    return low + width * along


@inner
def solve(
    low: float,
    high: float,
    f_low: float,
    f_high: float,
    one: int,
    two: int,
    features: Array,
    curves: Curves,
    mode: float,
    target: float,
    start: float,
) -> tuple[float, float]:
    """The orientation at which a monotone f takes a target: Newton steps from ``start``, kept inside the
    bracket.

    Returns
    -------
    (psi, bound of how far f is from the target there, in mm or radians); the nearer end where the target is
    not bracketed
    """
    rising = f_high > f_low
    before = high - low
    if not min(f_low, f_high) < target < max(f_low, f_high):
        psi = low if abs(f_low - target) <= abs(f_high - target) else high
        return (psi, abs((f_low if psi == low else f_high) - target))
    psi = start
    error = np.inf
    rest = np.inf
    for _ in range(100):
        if not low < psi < high:
            psi = (low + high) / 2.0
        cosine, sine = cos(psi), sin(psi)
        value_one, slope_one, error_one, _ = value_turned(psi, cosine, sine, one, features, curves, mode)
        value_two, slope_two, error_two, _ = value_turned(psi, cosine, sine, two, features, curves, mode)
        rest = value_two - value_one - target
        error = error_one + error_two + ROUNDINGS * (abs(value_one) + abs(value_two) + abs(target))
        # Nothing is gained where rounding is the larger part of what is left.
        if abs(rest) <= 0.05 * error:
            break
        if (rest > 0.0) == rising:
            high = psi
        else:
            low = psi
        step = rest / (slope_two - slope_one) if slope_two != slope_one else np.inf
        if abs(step) <= 2e-16 * max(1.0, abs(psi)) or high - low <= 4e-16 * max(1.0, abs(psi)):
            break
        if not abs(step) < before / 2.0:
            before = (high - low) / 2.0
            psi = (low + high) / 2.0
        else:
            before = abs(step)
            psi = psi - step
    return (psi, abs(rest) + error)


@inner
def targets(low: float, high: float, offset: float, period: float) -> tuple[int, int]:
    """First and last k with offset + k period in a closed range; a period of 0 stands for k = 0 alone."""
    if period == 0.0:
        return (0, 0) if low <= offset <= high else (1, 0)
    return (int(ceil((low - offset) / period)), int(floor((high - offset) / period)))


@inner
def disc_bounds(
    low: float, high: float, curve: int, features: Array, curves: Curves, mode: float
) -> tuple[float, float]:
    """Bounds of a curve's values over a range from a disc that holds its chords, whatever its slopes."""
    a, b = features[curves.integers[curve, TAIL]], features[curves.integers[curve, HEAD]]
    middle, reach = low + (high - low) / 2.0, (high - low) / 2.0 + SAME
    value, radius = value_disc(a, b, curves.reals[curve], middle, reach, mode)
    return (value - radius, value + radius)


@inner
def value_between(piece: Array, psi: float) -> float:
    """Linear interpolation of a piece's value."""
    along = (psi - piece[LOW]) / (piece[HIGH] - piece[LOW])
    return piece[VALUE_LOW] + along * (piece[VALUE_HIGH] - piece[VALUE_LOW])


@inner
def sag(piece: Array) -> float:
    """How far a steady piece may be from its linear interpolation, by its second derivative and by the errors
    at its ends."""
    width = piece[HIGH] - piece[LOW]
    return piece[SECOND_DERIVATIVE_HIGH] * width * width / 8.0 + max(
        piece[VALUE_ERROR_LOW], piece[VALUE_ERROR_HIGH]
    )


@inner
def may_meet(first: Array, second: Array, offset: float, period: float) -> bool:
    """Whether f may take a target, as seen from the ends of two steady pieces alone."""
    low, high = max(first[LOW], second[LOW]), min(first[HIGH], second[HIGH])
    doubt = sag(first) + sag(second) + HAIR
    f_low = value_between(second, low) - value_between(first, low)
    f_high = value_between(second, high) - value_between(first, high)
    k, last = targets(min(f_low, f_high) - doubt, max(f_low, f_high) + doubt, offset, period)
    return k <= last


@inner
def is_inside(psi: float, end: float, slope: float) -> bool:
    """Whether an orientation is not an end of a piece.

    The end at a tangency, known to no better, counts within rounding.
    """
    return psi != end and not (isinf(slope) and abs(psi - end) <= SAME)


@inner
def crossings(
    first: Array,
    second: Array,
    features: Array,
    curves: Curves,
    mode: float,
    offset: float,
    period: float,
    flat: float,
    stack: Array,
    roots: Array,
) -> int:
    """All orientations in the common range of two pieces at which f may be a target.

    Parameters
    ----------
    first, second : (26,) pieces.
    mode : which value of the curves is compared, see ``curve_value``.
    offset, period : targets are offset + k period for whole k; a period of 0 allows k = 0 only.
    flat : crossings at which the slope of f is no steeper than this are of no interest, and may be left out.
    stack, roots : (STACK_DEPTH, STACK_LENGTH) and (MOST_ROOTS, 3) work space.

    Returns
    -------
    number of roots written to ``roots``, or -1 when they do not fit
    """
    low, high = max(first[LOW], second[LOW]), min(first[HIGH], second[HIGH])
    if not low < high:
        return 0
    one, two = int(first[CURVE]), int(second[CURVE])
    v1, s1, v2, s2 = first[VALUE_LOW], first[SLOPE_LOW], second[VALUE_LOW], second[SLOPE_LOW]
    w1, t1, w2, t2 = first[VALUE_HIGH], first[SLOPE_HIGH], second[VALUE_HIGH], second[SLOPE_HIGH]
    # Errors of values (e) and slopes (g) at the low end, and at the high end (c and q).
    e1, g1 = first[VALUE_ERROR_LOW], first[SLOPE_ERROR_LOW]
    e2, g2 = second[VALUE_ERROR_LOW], second[SLOPE_ERROR_LOW]
    c1, q1 = first[VALUE_ERROR_HIGH], first[SLOPE_ERROR_HIGH]
    c2, q2 = second[VALUE_ERROR_HIGH], second[SLOPE_ERROR_HIGH]
    if is_inside(low, first[LOW], first[SLOPE_LOW]):
        v1, s1, e1, g1 = value_at(low, one, features, curves, mode)
    if is_inside(low, second[LOW], second[SLOPE_LOW]):
        v2, s2, e2, g2 = value_at(low, two, features, curves, mode)
    if is_inside(high, first[HIGH], first[SLOPE_HIGH]):
        w1, t1, c1, q1 = value_at(high, one, features, curves, mode)
    if is_inside(high, second[HIGH], second[SLOPE_HIGH]):
        w2, t2, c2, q2 = value_at(high, two, features, curves, mode)
    rounding = ROUNDINGS * (abs(v1) + abs(v2) + abs(w1) + abs(w2) + abs(offset))
    found = 0
    depth = 0
    splits = 0
    while True:
        width = high - low
        low1, high1 = slope_range(s1, t1, first[SECOND_DERIVATIVE_LOW], first[SECOND_DERIVATIVE_HIGH], width)
        low2, high2 = slope_range(
            s2, t2, second[SECOND_DERIVATIVE_LOW], second[SECOND_DERIVATIVE_HIGH], width
        )
        low1, high1 = low1 - max(g1, q1), high1 + max(g1, q1)
        low2, high2 = low2 - max(g2, q2), high2 + max(g2, q2)
        lowest, highest = low2 - high1, high2 - low1
        f_low, f_high = v2 - v1, w2 - w1
        error = max(e1 + e2, c1 + c2) + rounding
        done = max(-lowest, highest) <= flat
        if done:
            pass
        elif lowest > 0.0 or highest < 0.0:
            bottom, top = min(f_low, f_high) - error, max(f_low, f_high) + error
            steepness = max(lowest, -highest)
            k, last = targets(bottom, top, offset, period)
            if last - k >= roots.shape[0] - found:
                return -1
            while k <= last:
                target = offset + k * period
                start = first_guess(low, high, f_low - target, f_high - target, s2 - s1, t2 - t1)
                psi, rest = solve(low, high, f_low, f_high, one, two, features, curves, mode, target, start)
                if psi in (low, high):
                    rest += error
                roots[found, ROOT_PSI], roots[found, MULTIPLE] = psi, k
                # The target itself is rounded.
                roots[found, ROOT_RADIUS] = min((rest + ROUNDINGS * abs(offset)) / steepness, width) + SAME
                found += 1
                k += 1
            done = True
        else:
            bottom1, top1 = value_bounds(v1, w1, low1, high1, width)
            bottom2, top2 = value_bounds(v2, w2, low2, high2, width)
            # Where a curve is steep, as beside a tangency, chords move far over the narrowest range.
            steep = max(max(-low1, high1), max(-low2, high2)) * width > FARTHEST
            smallest = NARROWEST_DISC if steep else NARROWEST
            # Where nothing is known of a curve's slopes, as beside a tangency, its chords themselves are
            # bounded, and where so little is known that many splits have not helped.
            blind1 = not (isfinite(bottom1) and isfinite(top1))
            blind2 = not (isfinite(bottom2) and isfinite(top2))
            if width <= WIDEST_DISC and (blind1 or splits >= MANY_SPLITS):
                least, most = disc_bounds(low, high, one, features, curves, mode)
                bottom1, top1 = (least, most) if blind1 else (max(bottom1, least), min(top1, most))
            if width <= WIDEST_DISC and (blind2 or splits >= MANY_SPLITS):
                least, most = disc_bounds(low, high, two, features, curves, mode)
                bottom2, top2 = (least, most) if blind2 else (max(bottom2, least), min(top2, most))
            if width <= WIDEST_DISC and (blind1 or blind2):
                smallest = NARROWEST_DISC
            # Where the errors are the larger part of what is known, splitting gains nothing.
            doubt = 2.0 * (max(g1, q1) + max(g2, q2))
            vague = 2.0 * doubt >= highest - lowest and max(-lowest, highest) * width <= error
            bottom, top = bottom2 - top1 - error, top2 - bottom1 + error
            if isfinite(lowest) or isfinite(highest):
                below, above = value_bounds(f_low, f_high, lowest, highest, width)
                bottom, top = max(bottom, below - error), min(top, above + error)
            if isfinite(bottom) and isfinite(top):
                k, last = targets(bottom, top, offset, period)
                done = last < k
                if not done and (
                    width <= smallest or vague or splits >= MOST_SPLITS or depth >= stack.shape[0]
                ):
                    if last - k >= roots.shape[0] - found:
                        return -1
                    while k <= last:
                        roots[found, ROOT_PSI], roots[found, MULTIPLE] = low + width / 2.0, k
                        roots[found, ROOT_RADIUS] = width / 2.0 * (1.0 + 1e-15) + SAME
                        found += 1
                        k += 1
                    done = True
            elif depth >= stack.shape[0]:
                return -1
        if done:
            if depth == 0:
                return found
            depth -= 1
            item = stack[depth]
            low, high = item[0], item[1]
            v1, s1, v2, s2 = item[2], item[3], item[4], item[5]
            w1, t1, w2, t2 = item[6], item[7], item[8], item[9]
            e1, g1, e2, g2 = item[10], item[11], item[12], item[13]
            c1, q1, c2, q2 = item[14], item[15], item[16], item[17]
            continue
        splits += 1
        middle = low + width / 2.0
        if isinf(s1) or isinf(s2):
            middle = low + width / 4.0
        elif isinf(t1) or isinf(t2):
            middle = high - width / 4.0
        cosine, sine = cos(middle), sin(middle)
        m1, n1, error1, spread1 = value_turned(middle, cosine, sine, one, features, curves, mode)
        m2, n2, error2, spread2 = value_turned(middle, cosine, sine, two, features, curves, mode)
        item = stack[depth]
        item[0], item[1] = middle, high
        item[2], item[3], item[4], item[5] = m1, n1, m2, n2
        item[6], item[7], item[8], item[9] = w1, t1, w2, t2
        item[10], item[11], item[12], item[13] = error1, spread1, error2, spread2
        item[14], item[15], item[16], item[17] = c1, q1, c2, q2
        depth += 1
        high = middle
        w1, t1, w2, t2 = m1, n1, m2, n2
        c1, q1, c2, q2 = error1, spread1, error2, spread2
