"""Interval arithmetic on pairs (low, high) with outward rounding, and bounds between the ends of a range.

Every operation widens its result by a few units in the last place of each bound. That covers the rounding of
the operation itself and that of a number that enters it as a coefficient (sine and cosine: also that of the
angle).

Reference: R. E. Moore, R. B. Kearfott, M. J. Cloud, *Introduction to Interval Analysis*, SIAM 2009, chapters
2 and 3.

A slope or a value over a range is bounded by those at both ends and by bounds of the derivative between them.
"""

from __future__ import annotations

from math import ceil, cos, floor, inf, isfinite, pi, sqrt

from workhold.kernels.base.compiling import inner

Interval = tuple[float, float]

ROUNDING = 6e-16
SMALLEST = 1e-300
TURN = 2.0 * pi


@inner
def widen_outward(low: float, high: float) -> Interval:
    """Return the bounds widened by ``ROUNDING`` of their size each,
    which covers the rounding of one operation.
    """
    return (low - ROUNDING * abs(low) - SMALLEST, high + ROUNDING * abs(high) + SMALLEST)


@inner
def iadd(a: Interval, b: Interval) -> Interval:
    """Return an enclosure of a + b."""
    return widen_outward(a[0] + b[0], a[1] + b[1])


@inner
def isub(a: Interval, b: Interval) -> Interval:
    """Return an enclosure of a - b."""
    return widen_outward(a[0] - b[1], a[1] - b[0])


@inner
def ineg(a: Interval) -> Interval:
    """Return the interval -a, exactly."""
    return (-a[1], -a[0])


@inner
def imul(a: Interval, b: Interval) -> Interval:
    """Return an enclosure of a b."""
    p, q, r, s = a[0] * b[0], a[0] * b[1], a[1] * b[0], a[1] * b[1]
    return widen_outward(min(p, q, r, s), max(p, q, r, s))


@inner
def iscale(c: float, a: Interval) -> Interval:
    """Return an enclosure of c times a for an exact or rounded number c."""
    if c >= 0.0:
        return widen_outward(c * a[0], c * a[1])
    return widen_outward(c * a[1], c * a[0])


@inner
def ishift(c: float, a: Interval) -> Interval:
    """Return an enclosure of c + a for a number c, which may itself be rounded."""
    low, high = widen_outward(c + a[0], c + a[1])
    return (low - ROUNDING * abs(c), high + ROUNDING * abs(c))


@inner
def isquare(a: Interval) -> Interval:
    """Return an enclosure of a squared."""
    low, high = a[0] * a[0], a[1] * a[1]
    if a[0] <= 0.0 <= a[1]:
        return widen_outward(0.0, max(low, high))
    return widen_outward(min(low, high), max(low, high))


@inner
def isqrt(a: Interval) -> Interval:
    """Return an enclosure of the square roots of the non-negative numbers in a; about (0, 0) where a has
    none."""
    low, high = widen_outward(sqrt(max(a[0], 0.0)), sqrt(max(a[1], 0.0)))
    return (max(low, 0.0), high)


@inner
def idivide(a: Interval, b: Interval) -> Interval:
    """Return an enclosure of a / b, (-inf, inf) where b contains 0."""
    if b[0] <= 0.0 <= b[1]:
        return (-inf, inf)
    p, q, r, s = a[0] / b[0], a[0] / b[1], a[1] / b[0], a[1] / b[1]
    return widen_outward(min(p, q, r, s), max(p, q, r, s))


@inner
def icos(a: Interval) -> Interval:
    """Return an enclosure, within [-1, 1], of the cosines of the angles a in radians."""
    if a[1] - a[0] >= TURN:
        return (-1.0, 1.0)
    low, high = cos(a[0]), cos(a[1])
    if low > high:
        low, high = high, low
    # Extremes inside, with slack for the rounding of the angles themselves.
    slack = ROUNDING * max(abs(a[0]), abs(a[1]), 1.0)
    low, high = low - ROUNDING - slack, high + ROUNDING + slack
    if floor((a[1] + slack) / TURN) >= ceil((a[0] - slack) / TURN):
        high = 1.0
    if floor((a[1] + slack - pi) / TURN) >= ceil((a[0] - slack - pi) / TURN):
        low = -1.0
    return (max(low, -1.0), min(high, 1.0))


@inner
def isin(a: Interval) -> Interval:
    """Return an enclosure, within [-1, 1], of the sines of the angles a in radians."""
    quarter = pi / 2.0
    return icos(isub(a, (quarter, quarter)))


@inner
def idot(ax: Interval, ay: Interval, bx: Interval, by: Interval) -> Interval:
    """Return an enclosure of the scalar product of the plane vectors (ax, ay) and (bx, by)."""
    return iadd(imul(ax, bx), imul(ay, by))


@inner
def icross(ax: Interval, ay: Interval, bx: Interval, by: Interval) -> Interval:
    """Return an enclosure of the cross product ax by - ay bx of two plane vectors."""
    return isub(imul(ax, by), imul(ay, bx))


@inner
def enclose_slope(
    slope_low: float,
    slope_high: float,
    second_derivative_low: float,
    second_derivative_high: float,
    width: float,
) -> tuple[float, float]:
    """Return (low, high) bounds of a slope over a range of a width.

    ``slope_low`` and ``slope_high`` are the slopes at the lower and upper end of the range. Between them the
    second derivative lies in [second_derivative_low, second_derivative_high]; unless it has one sign,
    infinite bounds give (-inf, inf). Bounds are not widened for rounding.
    """
    if second_derivative_low >= 0.0:
        return (slope_low, slope_high)
    if second_derivative_high <= 0.0:
        return (slope_high, slope_low)
    if not (isfinite(second_derivative_low) and isfinite(second_derivative_high)):
        return (-inf, inf)
    # Lowest point of the larger of two falling lines from the ends, and the mirror image.
    spread = second_derivative_high - second_derivative_low
    at = (slope_low - slope_high + second_derivative_high * width) / spread
    lowest = slope_low + second_derivative_low * min(max(at, 0.0), width)
    at = (slope_high - slope_low - second_derivative_low * width) / spread
    highest = slope_low + second_derivative_high * min(max(at, 0.0), width)
    return (min(lowest, slope_low, slope_high), max(highest, slope_low, slope_high))


@inner
def bound_values(
    value_low: float, value_high: float, lowest: float, highest: float, width: float
) -> tuple[float, float]:
    """Return (low, high) bounds of a function over a range of a width.

    ``value_low`` and ``value_high`` are the values at the lower and upper end of the range; its slope lies in
    [lowest, highest], which may be infinite. Bounds are not widened for rounding.
    """
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
    return (-inf, inf)
