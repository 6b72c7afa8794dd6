"""Null vectors of four wrenches."""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations
from math import cos, sin
from random import Random

import numpy as np
import pytest
from attrs import frozen
from flint import arb
from hypothesis import given

from closing_forces import null_vectors
from judged import posed, rules_in
from strategies import seeds
from workhold import Vise
from workhold.verification.ball_geometry import Point
from workhold.verification.contacts import Balance, compute_minors, judge_closure, measure_wrench_span

# The part as it is drawn.
HARDWARE = rules_in(Vise(pitch=10, columns=1, peg_radius=0))
UPRIGHT = posed(0)


def make_random_contacts(random: Random) -> tuple[list[tuple[float, float]], list[float]]:
    """Four places in mm and four directions of normals in radians."""
    points = [(random.uniform(-50, 50), random.uniform(-50, 50)) for _ in range(4)]
    return points, [random.uniform(-3.2, 3.2) for _ in range(4)]


@given(seeds)
def test_the_null_vector_balances_forces_and_moments(seed: int) -> None:
    """Sum of lambda_i n_i and of lambda_i q_i x n_i is 0."""
    places, angles = make_random_contacts(Random(seed))
    points = [(arb(x), arb(y)) for x, y in places]
    normals = [(arb(angle).cos(), arb(angle).sin()) for angle in angles]
    vector = compute_minors(points, normals)
    for component in (0, 1):
        assert sum((v * n[component] for v, n in zip(vector, normals, strict=True)), arb(0)).contains(0)
    moments = [p[0] * n[1] - p[1] * n[0] for p, n in zip(points, normals, strict=True)]
    assert sum((v * m for v, m in zip(vector, moments, strict=True)), arb(0)).contains(0)


@given(seeds)
def test_it_is_that_of_the_statics(seed: int) -> None:
    """Point and scale of the moments do not matter to it."""
    places, angles = make_random_contacts(Random(seed))
    points = [(arb(x), arb(y)) for x, y in places]
    vector = compute_minors(points, [(arb(angle).cos(), arb(angle).sin()) for angle in angles])
    total = sum(vector, arb(0))
    if abs(float(total)) < 1e-3:
        return
    normals = np.array([[[cos(angle), sin(angle)] for angle in angles]])
    for middle, length in (((0.0, 0.0), 1.0), ((11.0, -7.0), 23.0)):
        theirs = null_vectors(np.array([places]) - np.array(middle), normals, length)
        np.testing.assert_allclose([float(v / total) for v in vector], theirs[0], rtol=1e-6, atol=1e-9)


def test_three_normals_through_one_point_leave_nothing_to_the_fourth() -> None:
    """Its share is the determinant of three concurrent lines, 0 at every precision."""
    directions = [(arb(3) / 5, arb(4) / 5), (arb(-5) / 13, arb(12) / 13), (arb(8) / 17, arb(-15) / 17)]
    points = [(7 + 21 * x, -2 + 21 * y) for x, y in directions] + [(arb(30), arb(4))]
    vector = compute_minors(points, [*directions, (arb(1), arb(0))])
    assert vector[3].contains(0)
    assert not vector[0].contains(0)


@frozen(eq=False)
class FixedContact:
    """A contact at a place of the part with a normal, whatever the pose."""

    place: tuple[arb, arb]
    normal: tuple[arb, arb]
    way: tuple[int, int]

    @property
    def side(self) -> FixedContact:
        """The touched side: it has one normal everywhere."""
        return self

    def compute_center_in_part(self, pose: object) -> tuple[arb, arb]:
        """The contact's place in the part."""
        return self.place

    def compute_outward_normal(self, point: object) -> tuple[arb, arb]:
        """The outward normal."""
        return self.normal


@pytest.mark.parametrize("length", [0.4, 1.0, 30.0, 700.0])
def test_the_span_is_that_of_wrenches_whose_moments_are_over_the_length_of_the_part(length: float) -> None:
    """Two lines of action along x and two along y, each ``offset`` from (0, 0): with moments over L the four minors are
    2 offset / L in size, so their sum is 8 offset / L, and the rule of 1e-7 turns over where that is 1e-7."""
    ways = [((0, 1), (1, 0)), ((1, 0), (0, 1)), ((0, -1), (-1, 0)), ((-1, 0), (0, -1))]
    for part, spans in ((0.999, False), (1.001, True)):
        offset = arb(part * 1e-7 * length / 8)
        contacts = [
            FixedContact((offset * x, offset * y), (arb(n), arb(m)), (int(k > 1), 0))
            for k, ((x, y), (n, m)) in enumerate(ways)
        ]
        balance = Balance.from_contacts(contacts, UPRIGHT, 1)  # type: ignore[arg-type]
        words = [
            found.reason for found in judge_closure(balance, length, HARDWARE.names, HARDWARE.slack_words)
        ]
        assert any("their wrenches span only" in reason for reason in words) == (not spans)


# Unit vectors with rational components, from Pythagorean triples.
DIRECTIONS = [
    (Fraction(a * sign, c), Fraction(b * other, c))
    for a, b, c in ((3, 4, 5), (4, 3, 5), (5, 12, 13), (15, 8, 17), (1, 0, 1), (0, 1, 1))
    for sign in (1, -1)
    for other in (1, -1)
]


def determinant(rows: list[tuple[Fraction, Fraction, Fraction]]) -> Fraction:
    """Determinant of a 3 x 3 matrix, along its first row."""
    (a, b, c), (d, e, f), (g, h, i) = rows
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)


@given(seeds)
def test_minors_and_span_are_the_exact_ones(seed: int) -> None:
    """The span is the sum of sizes of the minors of the wrenches (n, q x n / L), moments over L: for rational contacts the
    balls hold the rational numbers, and are no wider than rounding."""
    random = Random(seed)
    normals = [random.choice(DIRECTIONS) for _ in range(4)]
    places = [
        (Fraction(random.randint(-400, 400), 8), Fraction(random.randint(-400, 400), 8)) for _ in range(4)
    ]
    length = random.choice([0.125, 3.0, 40.0, 1024.0])
    wrenches = [
        (*n, (q[0] * n[1] - q[1] * n[0]) / Fraction(length)) for q, n in zip(places, normals, strict=True)
    ]
    exact = [determinant(list(three)) for three in reversed(list(combinations(wrenches, 3)))]
    vector = compute_minors([balls(q) for q in places], [balls(n) for n in normals])
    for number, (entry, minor) in enumerate(zip(vector, exact, strict=True)):
        assert agree(entry / length, minor * (-1) ** number)
    assert agree(measure_wrench_span(vector, length), sum((abs(minor) for minor in exact), Fraction(0)))


def balls(pair: tuple[Fraction, Fraction]) -> Point:
    """A pair of rational numbers as balls."""
    x, y = (arb(entry.numerator) / entry.denominator for entry in pair)
    return x, y


def agree(ball: arb, exact: Fraction) -> bool:
    """Whether a narrow ball holds a rational number."""
    return bool((ball * exact.denominator).contains(exact.numerator) and ball.rad() < 1e-9)
