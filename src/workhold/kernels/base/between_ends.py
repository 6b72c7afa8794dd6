"""What a function's values at both ends of a range and bounds of its derivative tell of it between them."""

from __future__ import annotations

from math import inf, isfinite

from workhold.kernels.base.compiling import inner


@inner
def slope_range(
    slope_low: float, slope_high: float, second_derivative_low: float, second_derivative_high: float, width: float
) -> tuple[float, float]:
    """Enclosure of a slope over a range from its values at both ends and the second derivative between them."""
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
    return (-inf, inf)
