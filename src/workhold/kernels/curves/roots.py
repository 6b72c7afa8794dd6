"""Orientations at which two chord curves cross: where f = (second curve) - (first curve) is offset + k
period, k whole.

Glossary: a *target* is such a number offset + k period. A *span* is a range of orientations psi in radians
that is still to be examined.

Over the common range of two pieces the slope of f is enclosed by the pieces' slopes and their errors. Two
cases: (a) the enclosure has one sign: f is monotone, and its values at both ends determine how many targets
it can take, each at most once; (b) otherwise the range is dropped if no target lies between the bounds of f,
and split if one does. Nothing is sampled. A target that the errors leave in doubt counts as taken: the
contacts there are examined later.

Every root is given with a radius: the exact root, if there is one, is no farther from the root given. A range
too narrow to split in which f may take a target, monotone or not, is given as one root with half the range as
its radius. So is every range where two curves run on top of each other.
"""

from __future__ import annotations

from math import ceil, cos, floor, isfinite, isinf, sin
from typing import NamedTuple

import numpy as np

from workhold.kernels.base.compiling import Array, inner
from workhold.kernels.base.interval import bound_values, enclose_slope
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
from workhold.kernels.chord.evaluation import CurvePoint, compute_chord_state, evaluate_state
from workhold.kernels.curves.piece_bounds import SAME, enclose_value

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
def evaluate_point(
    psi: float, cosine: float, sine: float, curve: int, features: Array, curves: Curves, mode: float
) -> CurvePoint:
    """Return the point of a curve at psi, also where its value must be enclosed by itself.

    ``curve`` is the curve's index in ``curves``; psi is in radians, ``cosine`` and ``sine`` are given to be
    computed once for two curves. ``mode`` and units are those of ``evaluate_curve``. The bound of the slope's
    error may be inf.
    """
    a, b = features[curves.integers[curve, TAIL]], features[curves.integers[curve, HEAD]]
    row = curves.reals[curve]
    point = evaluate_state(a, b, compute_chord_state(a, b, row, psi, cosine, sine), cosine, sine, mode)
    if not isfinite(point.error):
        value, error = enclose_value(a, b, row, psi, SAME, mode)
        return CurvePoint(value, point.slope, error, point.slope_error)
    return point


@inner
def guess_root(
    low: float, high: float, f_low: float, f_high: float, slope_low: float, slope_high: float
) -> float:
    """Return an estimate of the zero in [low, high] of a monotone function, from its values and slopes at
    both ends.

    It is the value at 0 of the cubic that interpolates the inverse function, or the zero of the straight line
    between the ends where the slopes differ too much from that line's.
    """
    width, rise = high - low, f_high - f_low
    along = -f_low / rise
    one, two = rise / (width * slope_low), rise / (width * slope_high)
    if 0.0 < one < 3.0 and 0.0 < two < 3.0:
        rest = 1.0 - along
        along = along * along * (3.0 - 2.0 * along) + along * rest * (rest * one - along * two)
    return low + width * along


@inner
def solve_for_target(
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
    """Return the orientation at which a monotone f takes a target, by Newton's method kept inside a bracket.

    Here f = (curve ``two``) - (curve ``one``), without an offset.

    Parameters
    ----------
    low, high : bracket of psi in radians.
    f_low, f_high : values of f at both.
    one, two : indices of the curves in ``curves``.
    mode : value of the curves, see ``evaluate_curve``.
    target : value that f is to take.
    start : psi to begin with.

    Returns
    -------
    (psi, bound of how far f is from the target there, in mm or radians). Where the target is not between
        f_low and f_high, psi is the end of the bracket at which f is nearer to it.
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
        at_one = evaluate_point(psi, cosine, sine, one, features, curves, mode)
        at_two = evaluate_point(psi, cosine, sine, two, features, curves, mode)
        rest = at_two.value - at_one.value - target
        error = (
            at_one.error + at_two.error + ROUNDINGS * (abs(at_one.value) + abs(at_two.value) + abs(target))
        )
        # Nothing is gained where rounding is the larger part of what is left.
        if abs(rest) <= 0.05 * error:
            break
        if (rest > 0.0) == rising:
            high = psi
        else:
            low = psi
        step = rest / (at_two.slope - at_one.slope) if at_two.slope != at_one.slope else np.inf
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
def find_targets(low: float, high: float, offset: float, period: float) -> tuple[int, int]:
    """Return the first and the last whole k with offset + k period in [low, high]; first > last where there
    is none.

    With a period of 0, only k = 0 is considered.
    """
    if period == 0.0:
        return (0, 0) if low <= offset <= high else (1, 0)
    return (int(ceil((low - offset) / period)), int(floor((high - offset) / period)))


@inner
def bound_values_by_disc(
    low: float, high: float, curve: int, features: Array, curves: Curves, mode: float
) -> tuple[float, float]:
    """Return (low, high) bounds of a curve's values over the range [low, high] of psi, whatever its slopes.

    They follow from a disc that holds the tails of all chords of the range; ``curve`` is an index into
    ``curves``.
    """
    a, b = features[curves.integers[curve, TAIL]], features[curves.integers[curve, HEAD]]
    middle, reach = low + (high - low) / 2.0, (high - low) / 2.0 + SAME
    value, radius = enclose_value(a, b, curves.reals[curve], middle, reach, mode)
    return (value - radius, value + radius)


@inner
def interpolate_value(piece: Array, psi: float) -> float:
    """Return a piece's value at psi, interpolated linearly between the values at its ends."""
    along = (psi - piece[LOW]) / (piece[HIGH] - piece[LOW])
    return piece[VALUE_LOW] + along * (piece[VALUE_HIGH] - piece[VALUE_LOW])


@inner
def bound_sag(piece: Array) -> float:
    """Return how far a steady piece may be from its linear interpolation, in the unit of its value.

    It follows from the second derivative and from the errors of the values at both ends.
    """
    width = piece[HIGH] - piece[LOW]
    return piece[SECOND_DERIVATIVE_HIGH] * width * width / 8.0 + max(
        piece[VALUE_ERROR_LOW], piece[VALUE_ERROR_HIGH]
    )


@inner
def may_meet(first: Array, second: Array, offset: float, period: float) -> bool:
    """Return whether two steady pieces may cross: whether f may take a target offset + k period in their
    common range.

    Only the values at the ends of the range and the pieces' second derivatives are used.
    """
    low, high = max(first[LOW], second[LOW]), min(first[HIGH], second[HIGH])
    doubt = bound_sag(first) + bound_sag(second) + HAIR
    f_low = interpolate_value(second, low) - interpolate_value(first, low)
    f_high = interpolate_value(second, high) - interpolate_value(first, high)
    k, last = find_targets(min(f_low, f_high) - doubt, max(f_low, f_high) + doubt, offset, period)
    return k <= last


class Span(NamedTuple):
    """Range of orientations in radians, and both curves (one, two) at both ends (low, high)."""

    low: float
    high: float
    one_low: CurvePoint
    two_low: CurvePoint
    one_high: CurvePoint
    two_high: CurvePoint


class Crossing(NamedTuple):
    """Arguments of :func:`write_crossings`, and the indices ``one`` and ``two`` of both pieces' curves."""

    first: Array
    second: Array
    one: int
    two: int
    features: Array
    curves: Curves
    mode: float
    offset: float
    period: float


class Slopes(NamedTuple):
    """Lower and upper bounds of the slopes of both curves over a span."""

    one_low: float
    one_high: float
    two_low: float
    two_high: float


@inner
def write_point(row: Array, column: int, point: CurvePoint) -> None:
    """Write a point to the four columns of a row from ``column`` on."""
    row[column], row[column + 1] = point.value, point.slope
    row[column + 2], row[column + 3] = point.error, point.slope_error


@inner
def read_point(row: Array, column: int) -> CurvePoint:
    """Return the point that :func:`write_point` has written from ``column`` on."""
    return CurvePoint(row[column], row[column + 1], row[column + 2], row[column + 3])


@inner
def write_span(row: Array, span: Span) -> None:
    """Write a span to a row (18,) of the stack."""
    row[0], row[1] = span.low, span.high
    write_point(row, 2, span.one_low)
    write_point(row, 6, span.two_low)
    write_point(row, 10, span.one_high)
    write_point(row, 14, span.two_high)


@inner
def read_span(row: Array) -> Span:
    """Return the span that :func:`write_span` has written to a row (18,) of the stack."""
    return Span(
        row[0], row[1], read_point(row, 2), read_point(row, 6), read_point(row, 10), read_point(row, 14)
    )


@inner
def is_inside(psi: float, end: float, slope: float) -> bool:
    """Return whether psi differs from the end ``end`` of a piece.

    An end with an infinite ``slope`` is a tangency, known to rounding only: psi within ``SAME`` of it counts
    as the end.
    """
    return psi != end and not (isinf(slope) and abs(psi - end) <= SAME)


@inner
def make_point_of_piece(psi: float, piece: Array, at_low: bool, asked: Crossing) -> CurvePoint:
    """Return a piece's curve at psi: the values stored in the piece where psi is its end, else computed ones.

    ``at_low`` tells which end is meant: the low or the high one.
    """
    end = piece[LOW] if at_low else piece[HIGH]
    point = (
        CurvePoint(piece[VALUE_LOW], piece[SLOPE_LOW], piece[VALUE_ERROR_LOW], piece[SLOPE_ERROR_LOW])
        if at_low
        else CurvePoint(
            piece[VALUE_HIGH], piece[SLOPE_HIGH], piece[VALUE_ERROR_HIGH], piece[SLOPE_ERROR_HIGH]
        )
    )
    if is_inside(psi, end, point.slope):
        point = evaluate_point(
            psi, cos(psi), sin(psi), int(piece[CURVE]), asked.features, asked.curves, asked.mode
        )
    return point


@inner
def bound_slopes(span: Span, first: Array, second: Array) -> Slopes:
    """Return bounds of the slopes of two curves over a span, widened by their errors; ``first``, ``second``
    are pieces."""
    width = span.high - span.low
    one_low, one_high = enclose_slope(
        span.one_low.slope,
        span.one_high.slope,
        first[SECOND_DERIVATIVE_LOW],
        first[SECOND_DERIVATIVE_HIGH],
        width,
    )
    two_low, two_high = enclose_slope(
        span.two_low.slope,
        span.two_high.slope,
        second[SECOND_DERIVATIVE_LOW],
        second[SECOND_DERIVATIVE_HIGH],
        width,
    )
    one = max(span.one_low.slope_error, span.one_high.slope_error)
    two = max(span.two_low.slope_error, span.two_high.slope_error)
    return Slopes(one_low - one, one_high + one, two_low - two, two_high + two)


@inner
def write_monotone_roots(
    span: Span, slopes: Slopes, error: float, asked: Crossing, roots: Array, found: int
) -> int:
    """Write a root for each target that f may take over a span in which f is monotone.

    ``found`` roots are written to ``roots`` already. Return the new number of roots, or -1 when they do not
    fit. ``error`` is a bound of the error of f at the ends of the span.
    """
    f_low = span.two_low.value - span.one_low.value
    f_high = span.two_high.value - span.one_high.value
    lowest, highest = slopes.two_low - slopes.one_high, slopes.two_high - slopes.one_low
    bottom, top = min(f_low, f_high) - error, max(f_low, f_high) + error
    steepness = max(lowest, -highest)
    k, last = find_targets(bottom, top, asked.offset, asked.period)
    if last - k >= roots.shape[0] - found:
        return -1
    low, high = span.low, span.high
    slope_low = span.two_low.slope - span.one_low.slope
    slope_high = span.two_high.slope - span.one_high.slope
    while k <= last:
        target = asked.offset + k * asked.period
        start = guess_root(low, high, f_low - target, f_high - target, slope_low, slope_high)
        psi, rest = solve_for_target(
            low,
            high,
            f_low,
            f_high,
            asked.one,
            asked.two,
            asked.features,
            asked.curves,
            asked.mode,
            target,
            start,
        )
        if psi in (low, high):
            rest += error
        roots[found, ROOT_PSI], roots[found, MULTIPLE] = psi, k
        # The target itself is rounded.
        reach = min((rest + ROUNDINGS * abs(asked.offset)) / steepness, high - low) + SAME
        roots[found, ROOT_RADIUS] = reach
        found += 1
        k += 1
    return found


@inner
def bound_span(
    span: Span, slopes: Slopes, error: float, splits: int, asked: Crossing
) -> tuple[float, float, float]:
    """Return (low bound of f, high bound of f, width in radians below which the span is not split any more).

    ``error`` is a bound of the error of f at the ends of the span, ``splits`` the number of splits made so
    far.
    """
    low, high, width = span.low, span.high, span.high - span.low
    bottom1, top1 = bound_values(
        span.one_low.value, span.one_high.value, slopes.one_low, slopes.one_high, width
    )
    bottom2, top2 = bound_values(
        span.two_low.value, span.two_high.value, slopes.two_low, slopes.two_high, width
    )
    # Where a curve is steep, as beside a tangency, chords move far over the narrowest range.
    steepest = max(max(-slopes.one_low, slopes.one_high), max(-slopes.two_low, slopes.two_high))
    smallest = NARROWEST_DISC if steepest * width > FARTHEST else NARROWEST
    # Where nothing is known of a curve's slopes, as beside a tangency, its chords themselves are bounded, and
    # where so little is known that many splits have not helped.
    blind1 = not (isfinite(bottom1) and isfinite(top1))
    blind2 = not (isfinite(bottom2) and isfinite(top2))
    if width <= WIDEST_DISC and (blind1 or splits >= MANY_SPLITS):
        least, most = bound_values_by_disc(low, high, asked.one, asked.features, asked.curves, asked.mode)
        bottom1, top1 = (least, most) if blind1 else (max(bottom1, least), min(top1, most))
    if width <= WIDEST_DISC and (blind2 or splits >= MANY_SPLITS):
        least, most = bound_values_by_disc(low, high, asked.two, asked.features, asked.curves, asked.mode)
        bottom2, top2 = (least, most) if blind2 else (max(bottom2, least), min(top2, most))
    if width <= WIDEST_DISC and (blind1 or blind2):
        smallest = NARROWEST_DISC
    bottom, top = bottom2 - top1 - error, top2 - bottom1 + error
    lowest, highest = slopes.two_low - slopes.one_high, slopes.two_high - slopes.one_low
    if isfinite(lowest) or isfinite(highest):
        f_low = span.two_low.value - span.one_low.value
        f_high = span.two_high.value - span.one_high.value
        below, above = bound_values(f_low, f_high, lowest, highest, width)
        bottom, top = max(bottom, below - error), min(top, above + error)
    return bottom, top, smallest


@inner
def is_vague(span: Span, slopes: Slopes, error: float) -> bool:
    """Return whether splitting a span would gain nothing, as its bounds come mostly from errors.

    ``error`` is a bound of the error of f at the ends of the span.
    """
    lowest, highest = slopes.two_low - slopes.one_high, slopes.two_high - slopes.one_low
    one = max(span.one_low.slope_error, span.one_high.slope_error)
    two = max(span.two_low.slope_error, span.two_high.slope_error)
    doubt = 2.0 * (one + two)
    return 2.0 * doubt >= highest - lowest and max(-lowest, highest) * (span.high - span.low) <= error


@inner
def write_wide_roots(span: Span, first: int, last: int, roots: Array, found: int) -> int:
    """Write one root for each target from number ``first`` to ``last``, in the middle of a span, with half of
    it as radius.

    ``found`` roots are written to ``roots`` already. Return the new number of roots, or -1 when they do not
    fit.
    """
    if last - first >= roots.shape[0] - found:
        return -1
    width = span.high - span.low
    for k in range(first, last + 1):
        roots[found, ROOT_PSI], roots[found, MULTIPLE] = span.low + width / 2.0, k
        roots[found, ROOT_RADIUS] = width / 2.0 * (1.0 + 1e-15) + SAME
        found += 1
    return found


@inner
def find_split_point(span: Span) -> float:
    """Return psi at which to split a span: its middle, or a quarter of its width from an end with an infinite
    slope."""
    low, high = span.low, span.high
    width = high - low
    if isinf(span.one_low.slope) or isinf(span.two_low.slope):
        return low + width / 4.0
    if isinf(span.one_high.slope) or isinf(span.two_high.slope):
        return high - width / 4.0
    return low + width / 2.0


@inner
def make_first_span(low: float, high: float, asked: Crossing) -> Span:
    """Return the span over the whole common range [low, high] of two pieces."""
    return Span(
        low,
        high,
        make_point_of_piece(low, asked.first, True, asked),
        make_point_of_piece(low, asked.second, True, asked),
        make_point_of_piece(high, asked.first, False, asked),
        make_point_of_piece(high, asked.second, False, asked),
    )


@inner
def bound_rounding(span: Span, offset: float) -> float:
    """Return a bound of the rounding of the values of f, and of their differences from targets, over a span."""
    low = abs(span.one_low.value) + abs(span.two_low.value)
    return ROUNDINGS * (low + abs(span.one_high.value) + abs(span.two_high.value) + abs(offset))


@inner
def write_roots_of_span(
    span: Span,
    rounding: float,
    splits: int,
    can_split: bool,
    flat: float,
    asked: Crossing,
    roots: Array,
    found: int,
) -> tuple[int, bool]:
    """Write the roots of a span, or find that it must be split.

    ``found`` roots are written to ``roots`` already, after ``splits`` splits. Return (the new number of
    roots, or -1 when they do not fit; whether the span must be split).

    Parameters
    ----------
    rounding : bound of the rounding of f, see :func:`bound_rounding`.
    can_split : whether there is room for another span. Without it a span of unknown bounds gives -1.
    flat : see :func:`write_crossings`.
    """
    slopes = bound_slopes(span, asked.first, asked.second)
    lowest, highest = slopes.two_low - slopes.one_high, slopes.two_high - slopes.one_low
    if not max(-lowest, highest) > flat:
        return found, False
    error = max(span.one_low.error + span.two_low.error, span.one_high.error + span.two_high.error) + rounding
    if lowest > 0.0 or highest < 0.0:
        return write_monotone_roots(span, slopes, error, asked, roots, found), False
    bottom, top, smallest = bound_span(span, slopes, error, splits, asked)
    if not (isfinite(bottom) and isfinite(top)):
        return (found, True) if can_split else (-1, False)
    k, last = find_targets(bottom, top, asked.offset, asked.period)
    if last < k:
        return found, False
    is_narrow = span.high - span.low <= smallest or is_vague(span, slopes, error)
    if is_narrow or splits >= MOST_SPLITS or not can_split:
        return write_wide_roots(span, k, last, roots, found), False
    return found, True


@inner
def write_crossings(
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
    """Write the orientations in the common range of two pieces at which their curves may cross to ``roots``.

    The curves cross where (second curve) - (first curve) is a target offset + k period.

    Parameters
    ----------
    first, second : (24,) pieces, see ``base.tables``.
    mode : which value of the curves is compared, see ``evaluate_curve``.
    offset, period : targets are offset + k period for all whole k; only k = 0 where the period is 0.
    flat : crossings at which the difference of the curves has a slope of this size or less may be left out.
    stack : (STACK_DEPTH, STACK_LENGTH) work space.
    roots : (MOST_ROOTS, 3) receives ROOT_PSI, ROOT_RADIUS (both in radians) and MULTIPLE (k) of each
        crossing.

    Returns
    -------
    int
    Number of roots written to ``roots``, or -1 when they do not fit.
    """
    low, high = max(first[LOW], second[LOW]), min(first[HIGH], second[HIGH])
    if not low < high:
        return 0
    asked = Crossing(
        first, second, int(first[CURVE]), int(second[CURVE]), features, curves, mode, offset, period
    )
    span = make_first_span(low, high, asked)
    rounding = bound_rounding(span, offset)
    found = depth = splits = int(np.int64(0))
    while True:
        can_split = depth < stack.shape[0]
        found, must_split = write_roots_of_span(span, rounding, splits, can_split, flat, asked, roots, found)
        if found < 0:
            return -1
        if must_split:
            splits += 1
            middle = find_split_point(span)
            cosine, sine = cos(middle), sin(middle)
            one = evaluate_point(middle, cosine, sine, asked.one, features, curves, mode)
            two = evaluate_point(middle, cosine, sine, asked.two, features, curves, mode)
            write_span(stack[depth], Span(middle, span.high, one, two, span.one_high, span.two_high))
            depth += 1
            span = Span(span.low, middle, span.one_low, span.two_low, one, two)
        elif depth > 0:
            depth -= 1
            span = read_span(stack[depth])
        else:
            return found
