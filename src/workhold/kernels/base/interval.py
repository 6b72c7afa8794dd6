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
def outward(low: float, high: float) -> Interval:
    """Widens a pair of rounded bounds."""
    return (low - ROUNDING * abs(low) - SMALLEST, high + ROUNDING * abs(high) + SMALLEST)


@inner
def iadd(a: Interval, b: Interval) -> Interval:
    """a + b."""
    return outward(a[0] + b[0], a[1] + b[1])


@inner
def isub(a: Interval, b: Interval) -> Interval:
    """a - b."""
    return outward(a[0] - b[1], a[1] - b[0])


@inner
def ineg(a: Interval) -> Interval:
    """-a."""
    return (-a[1], -a[0])


@inner
def imul(a: Interval, b: Interval) -> Interval:
    """a b."""
    p, q, r, s = a[0] * b[0], a[0] * b[1], a[1] * b[0], a[1] * b[1]
    return outward(min(p, q, r, s), max(p, q, r, s))


@inner
def iscale(c: float, a: Interval) -> Interval:
    """c a for a number c."""
    if c >= 0.0:
        return outward(c * a[0], c * a[1])
    return outward(c * a[1], c * a[0])


@inner
def ishift(c: float, a: Interval) -> Interval:
    """c + a for a number c."""
    low, high = outward(c + a[0], c + a[1])
    return (low - ROUNDING * abs(c), high + ROUNDING * abs(c))


@inner
def isquare(a: Interval) -> Interval:
    """a squared."""
    low, high = a[0] * a[0], a[1] * a[1]
    if a[0] <= 0.0 <= a[1]:
        return outward(0.0, max(low, high))
    return outward(min(low, high), max(low, high))


@inner
def isqrt(a: Interval) -> Interval:
    """Square root of the non-negative part of a."""
    low, high = outward(sqrt(max(a[0], 0.0)), sqrt(max(a[1], 0.0)))
    return (max(low, 0.0), high)


@inner
def idivide(a: Interval, b: Interval) -> Interval:
    """a / b; everything when b contains 0."""
    if b[0] <= 0.0 <= b[1]:
        return (-inf, inf)
    p, q, r, s = a[0] / b[0], a[0] / b[1], a[1] / b[0], a[1] / b[1]
    return outward(min(p, q, r, s), max(p, q, r, s))


@inner
def icos(a: Interval) -> Interval:
    """Cosine of angles in radians."""
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
    """Sine of angles in radians."""
    quarter = pi / 2.0
    return icos(isub(a, (quarter, quarter)))


@inner
def idot(ax: Interval, ay: Interval, bx: Interval, by: Interval) -> Interval:
    """Scalar product of two vectors."""
    return iadd(imul(ax, bx), imul(ay, by))


@inner
def icross(ax: Interval, ay: Interval, bx: Interval, by: Interval) -> Interval:
    """Cross product of two vectors of the plane."""
    return isub(imul(ax, by), imul(ay, bx))


@inner
def slope_range(
    slope_low: float,
    slope_high: float,
    second_derivative_low: float,
    second_derivative_high: float,
    width: float,
) -> tuple[float, float]:
    """Enclosure of a slope over a range from its values at both ends and the second derivative between
    them."""
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
def value_bounds(
    value_low: float, value_high: float, lowest: float, highest: float, width: float
) -> tuple[float, float]:
    """Bounds of a function over a range from its values at both ends and bounds of its slope, finite or
    not."""
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
