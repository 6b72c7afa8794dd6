"""Interval operations enclose: f(x) lies in F(X) for every x in X."""

from __future__ import annotations

from fractions import Fraction
from math import cos, inf, nextafter, pi, sin
from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from workhold.kernels.base.interval import (
    iadd,
    icos,
    icross,
    idivide,
    idot,
    imul,
    ineg,
    iscale,
    ishift,
    isin,
    isqrt,
    isquare,
    isub,
)

numbers = st.floats(-1e6, 1e6, allow_subnormal=False)
intervals = st.tuples(numbers, numbers).map(lambda pair: tuple(sorted(pair)))


def ends(a):
    """Both ends as exact fractions."""
    return Fraction(a[0]), Fraction(a[1])


def holds(interval, low: Fraction, high: Fraction) -> bool:
    """Whether an interval contains [low, high], compared exactly."""
    return Fraction(interval[0]) <= low and high <= Fraction(interval[1])


@given(intervals, intervals)
def test_sum_difference_and_product_contain_the_exact_range(a, b):
    """[a] + [b], [a] - [b], [a] [b] and [a]^2 contain the exact ranges, computed with fractions."""
    (p, q), (r, s) = ends(a), ends(b)
    assert holds(iadd(a, b), p + r, q + s)
    assert holds(isub(a, b), p - s, q - r)
    products = (p * r, p * s, q * r, q * s)
    assert holds(imul(a, b), min(products), max(products))
    assert holds(isquare(a), Fraction(0) if p <= 0 <= q else min(p * p, q * q), max(p * p, q * q))
    assert ineg(a) == (-a[1], -a[0])


@given(numbers, intervals)
def test_scaling_and_shifting_contain_the_exact_range(c, a):
    """c [a] and c + [a] for either sign of c."""
    (p, q), e = ends(a), Fraction(c)
    assert holds(iscale(c, a), min(e * p, e * q), max(e * p, e * q))
    assert holds(ishift(c, a), e + p, e + q)


@pytest.mark.thorough
@given(intervals, intervals)
def test_quotient_contains_the_exact_range(a, b):
    """[a] / [b] contains the exact range, and is everything when [b] contains 0."""
    if b[0] <= 0.0 <= b[1]:
        assert idivide(a, b) == (-inf, inf)
        return
    (p, q), (r, s) = ends(a), ends(b)
    quotients = (p / r, p / s, q / r, q / s)
    assert holds(idivide(a, b), min(quotients), max(quotients))


@given(intervals)
def test_root_contains_the_exact_range(a):
    """low^2 <= max(a, 0) <= high^2 for the ends of sqrt [a]."""
    low, high = isqrt(a)
    p, q = (max(x, Fraction(0)) for x in ends(a))
    assert low >= 0 and Fraction(low) ** 2 <= p and q <= Fraction(high) ** 2


@pytest.mark.thorough
@given(
    st.floats(-50, 50), st.one_of(st.floats(0, 1e-6), st.floats(0, 8)), st.lists(st.floats(0, 1), max_size=20)
)
def test_sine_and_cosine_contain_their_values(start, width, places):
    """cos x and sin x lie in cos [X] and sin [X] for x anywhere in X, over many turns."""
    box = (start, start + width)
    for place in (0.0, 1.0, *places):
        x = min(max(start + place * width, box[0]), box[1])
        assert icos(box)[0] <= cos(x) <= icos(box)[1]
        assert isin(box)[0] <= sin(x) <= isin(box)[1]
    assert -1.0 <= icos(box)[0] <= icos(box)[1] <= 1.0


def test_extremes_at_multiples_of_half_a_turn_are_inside():
    """An interval that holds k pi (the nearest numbers on either side of it) has (-1)^k in its cosine, likewise sine."""
    for k in range(-40, 41):
        at = k * pi
        assert icos((nextafter(at, -inf), nextafter(at, inf)))[k % 2 == 0] == (-1.0) ** k
        at = (k + 0.5) * pi
        assert isin((nextafter(at, -inf), nextafter(at, inf)))[k % 2 == 0] == (-1.0) ** k


def test_bounds_are_tight():
    """Enclosures of thin intervals are thin: a few units in the last place, those of the angle (up to 9) included."""
    random = Random(3)
    for _ in range(500):
        x, y = random.uniform(-9, 9), random.uniform(0.1, 9)
        for low, high in (
            iadd((x, x), (y, y)),
            imul((x, x), (y, y)),
            idivide((x, x), (y, y)),
            icos((x, x)),
            isin((x, x)),
            isqrt((y, y)),
        ):
            assert high - low <= 3e-14 * max(1.0, abs(low))


@pytest.mark.thorough
@given(intervals, intervals, intervals, intervals, st.lists(st.floats(0, 1), min_size=4, max_size=4))
def test_products_of_vectors_contain_their_values(ax, ay, bx, by, places):
    """a . b and a x b for vectors anywhere in their boxes, in exact arithmetic."""
    picked = [
        Fraction(min(max(low + t * (high - low), low), high))
        for (low, high), t in zip((ax, ay, bx, by), places, strict=True)
    ]
    p, q, r, s = picked
    assert holds(idot(ax, ay, bx, by), p * r + q * s, p * r + q * s)
    assert holds(icross(ax, ay, bx, by), p * s - q * r, p * s - q * r)


def test_random_expressions_contain_their_values():
    """Composed expressions enclose (inclusion is inherited): compared with plain evaluation at points inside."""
    random = Random(4)
    unary = [(icos, cos), (isin, sin), (isquare, lambda x: x * x), (lambda a: isqrt(isquare(a)), abs)]
    binary = [(iadd, lambda x, y: x + y), (isub, lambda x, y: x - y), (imul, lambda x, y: x * y)]
    for _ in range(1500):
        boxes, values = [], []
        for _ in range(3):
            low = random.uniform(-5, 5)
            high = low + 10 ** random.uniform(-8, 1)
            x = random.uniform(low, high)
            boxes.append((low, high))
            values.append(x)
        for _ in range(6):
            if random.random() < 0.5:
                (enclose, value), k = random.choice(unary), random.randrange(len(boxes))
                boxes.append(enclose(boxes[k]))
                values.append(value(values[k]))
            else:
                (enclose, value), k, m = random.choice(binary), *random.choices(range(len(boxes)), k=2)
                boxes.append(enclose(boxes[k], boxes[m]))
                values.append(value(values[k], values[m]))
            # Plain evaluation itself is rounded.
            slack = 1e-13 * (1 + abs(values[-1])) * (1 + max(map(abs, values)))
            assert boxes[-1][0] - slack <= values[-1] <= boxes[-1][1] + slack
