"""Numbers that carry a bound of their rounding error, so that a machine counts what was counted by hand.

Running error analysis (N. J. Higham, *Accuracy and Stability of Numerical Algorithms*, 2nd ed., SIAM 2002, section 3.3):
every operation adds half a unit in the last place of its result to what its operands' errors come to. The Python form of a
kernel run on such numbers tells how far rounding may at most have put its results off.
"""

from __future__ import annotations

import math
from typing import Any

from attrs import frozen

from sharpness import interpreted
from workhold.kernels.base.feature import is_shallow

__all__ = ["ROUNDED", "Rounded", "error_of"]

HALF_UNIT = 2.0**-53
# Sine, cosine, arc cosine and arc tangent are right to a unit in the last place.
UNIT = 2.0 * HALF_UNIT


@frozen(eq=False)
class Rounded:
    """A double and a bound of its error."""

    value: float
    error: float = 0.0

    def __add__(self, other: Any) -> Rounded:
        return rounded(self.value + float(other), self.error + error_of(other))

    def __sub__(self, other: Any) -> Rounded:
        return rounded(self.value - float(other), self.error + error_of(other))

    def __mul__(self, other: Any) -> Rounded:
        one, two = self.value, float(other)
        return rounded(
            one * two, abs(one) * error_of(other) + abs(two) * self.error + self.error * error_of(other)
        )

    def __truediv__(self, other: Any) -> Rounded:
        two = float(other)
        least = abs(two) - error_of(other)
        quotient = self.value / two
        return rounded(
            quotient, (self.error + abs(quotient) * error_of(other)) / least if least > 0 else math.inf
        )

    def __rsub__(self, other: float) -> Rounded:
        return Rounded(other) - self

    def __rtruediv__(self, other: float) -> Rounded:
        return Rounded(other) / self

    __radd__, __rmul__ = __add__, __mul__

    def __neg__(self) -> Rounded:
        return Rounded(-self.value, self.error)

    def __abs__(self) -> Rounded:
        return Rounded(abs(self.value), self.error)

    def __mod__(self, other: float) -> Rounded:
        return rounded(self.value % other, self.error)

    def __float__(self) -> float:
        return self.value

    def __lt__(self, other: Any) -> bool:
        return self.value < float(other)

    def __le__(self, other: Any) -> bool:
        return self.value <= float(other)

    def __gt__(self, other: Any) -> bool:
        return self.value > float(other)

    def __ge__(self, other: Any) -> bool:
        return self.value >= float(other)

    def __eq__(self, other: object) -> bool:
        return self.value == float(other)  # type: ignore[arg-type]

    __hash__ = None  # type: ignore[assignment]


def rounded(value: float, error: float) -> Rounded:
    """A result, half a unit in the last place off besides, though some come out exact."""
    return Rounded(value, error + HALF_UNIT * abs(value))


def error_of(number: Any) -> float:
    """The bound of a number's error; that of a plain one is 0."""
    return number.error if isinstance(number, Rounded) else 0.0


def sqrt(x: Any) -> Rounded:
    value, error = float(x), error_of(x)
    least = max(value - error, 0.0)
    return rounded(
        math.sqrt(value),
        math.sqrt(value) - math.sqrt(least) if error >= value else error / (2 * math.sqrt(least)),
    )


def hypot(x: Any, y: Any) -> Rounded:
    size = math.hypot(float(x), float(y))
    return Rounded(size, (abs(float(x)) * error_of(x) + abs(float(y)) * error_of(y)) / size + UNIT * size)


def cos(x: Any) -> Rounded:
    value = math.cos(float(x))
    return Rounded(value, error_of(x) + UNIT * abs(value))


def sin(x: Any) -> Rounded:
    value = math.sin(float(x))
    return Rounded(value, error_of(x) + UNIT * abs(value))


def acos(x: Any) -> Rounded:
    value, error = float(x), error_of(x)
    near, far = (math.acos(min(max(value + side * error, -1.0), 1.0)) for side in (-1, 1))
    angle = math.acos(value)
    return Rounded(angle, max(abs(near - angle), abs(far - angle)) + UNIT * angle)


def atan2(y: Any, x: Any) -> Rounded:
    angle, square = math.atan2(float(y), float(x)), float(x) ** 2 + float(y) ** 2
    error = abs(float(x)) * error_of(y) + abs(float(y)) * error_of(x)
    return Rounded(angle, error / square + UNIT * abs(angle))


# What the names of the module ``math`` are to mean to a kernel.
ROUNDED: dict[str, Any] = {
    "sqrt": sqrt,
    "hypot": hypot,
    "cos": cos,
    "sin": sin,
    "acos": acos,
    "atan2": atan2,
    # Asked of rows as lists.
    "is_shallow": interpreted(is_shallow),
}
