"""What interval operations widen their results by is needed: a tenth of it lets the exact result out. See ``sharpness``."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from math import inf
from random import Random
from typing import Any

import pytest
from flint import arb

from exact_chords import exactly
from sharpness import Constant, changed, check_sharpness
from workhold.kernels.base import interval

Kernel = Callable[..., Any]


def scaled(random: Random, kernel: Kernel) -> float:
    """Error of a product with a coefficient that is rounded itself, over what its interval is widened by."""
    number, x = random.uniform(1, 2), random.uniform(1, 2)
    coefficient = 1.0 / number
    exact, (_, high) = Fraction(x) / Fraction(number), kernel(coefficient, (x, x))
    product = Fraction(coefficient * x)
    widened = Fraction(high) - product
    return float(abs(exact - product) / widened) if widened else inf


def cosine(random: Random, kernel: Kernel) -> float:
    """Error of the cosine of an angle that is rounded itself, over what its interval is widened by."""
    one, two = random.uniform(-6, 6), random.uniform(-6, 6)
    angle = one + two
    low, high = kernel((angle, angle))
    with exactly():
        error = abs((arb(one) + arb(two)).cos() - (arb(low) + arb(high)) / 2)
    return float(error.upper()) / ((high - low) / 2)


CONSTANTS = [
    Constant(
        "interval, 6e-16",
        interval.widen_outward,
        scaled,
        symbol="ROUNDING",
        within=lambda form: changed(interval.iscale, widen_outward=form),
    ),
    Constant("interval of a cosine, 6e-16", interval.icos, cosine, symbol="ROUNDING", draws=3000),
]


@pytest.mark.parametrize("constant", CONSTANTS, ids=lambda constant: constant.name)
@pytest.mark.prove
def test_a_tenth_of_a_constant_would_not_do(constant: Constant) -> None:
    """The bound holds on every input, and with a tenth of the constant it does not."""
    check_sharpness(constant)
