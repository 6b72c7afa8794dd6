"""Null vectors of four wrenches."""

from __future__ import annotations

from math import cos, sin
from random import Random

import numpy as np
from flint import arb
from hypothesis import given

from closing_forces import null_vectors
from strategies import seeds
from workhold.verification.closure import minors


def random_contacts(random: Random) -> tuple[list[tuple[float, float]], list[float]]:
    """Four places in mm and four directions of normals in radians."""
    points = [(random.uniform(-50, 50), random.uniform(-50, 50)) for _ in range(4)]
    return points, [random.uniform(-3.2, 3.2) for _ in range(4)]


@given(seeds)
def test_the_null_vector_balances_forces_and_moments(seed: int) -> None:
    """Sum of lambda_i n_i and of lambda_i q_i x n_i is 0."""
    places, angles = random_contacts(Random(seed))
    points = [(arb(x), arb(y)) for x, y in places]
    normals = [(arb(angle).cos(), arb(angle).sin()) for angle in angles]
    vector = minors(points, normals)
    for component in (0, 1):
        assert sum((v * n[component] for v, n in zip(vector, normals, strict=True)), arb(0)).contains(0)
    moments = [p[0] * n[1] - p[1] * n[0] for p, n in zip(points, normals, strict=True)]
    assert sum((v * m for v, m in zip(vector, moments, strict=True)), arb(0)).contains(0)


@given(seeds)
def test_it_is_that_of_the_statics(seed: int) -> None:
    """Point and scale of the moments do not matter to it."""
    places, angles = random_contacts(Random(seed))
    points = [(arb(x), arb(y)) for x, y in places]
    vector = minors(points, [(arb(angle).cos(), arb(angle).sin()) for angle in angles])
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
    vector = minors(points, [*directions, (arb(1), arb(0))])
    assert vector[3].contains(0)
    assert not vector[0].contains(0)
