"""Least costs of linear programs agree with another solver, also where nothing solves one."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import linprog

from workhold.supports.friction import find_least_costs


@pytest.mark.thinned(3)
@pytest.mark.parametrize("seed", range(12))
def test_least_costs_are_those_of_another_solver(seed: int) -> None:
    """Few rows, many columns, several right sides at once; some of which nothing solves, some degenerate."""
    random = np.random.default_rng(seed)
    rows, columns = int(random.integers(2, 8)), int(random.integers(9, 40))
    matrix = random.normal(size=(rows, columns))
    # Without columns that point downward in the first row, a side below 0 there has no solution.
    matrix[0] = np.abs(matrix[0])
    costs = np.where(random.random(columns) < 0.5, 0.0, random.random(columns))
    sides = random.normal(size=(25, rows)) * 10.0 ** random.integers(-2, 4)
    # A solution of a single column, in which all other forces are 0.
    sides[0] = 3.0 * matrix[:, 4]
    sides[1] = 0.0
    found = find_least_costs(matrix, costs, sides)
    for value, side in zip(found, sides, strict=True):
        size = max(np.abs(side).max(), 1e-3)
        answer = linprog(costs, A_eq=matrix, b_eq=side / size, method="highs")
        if answer.status == 2:
            assert np.isinf(value)
        else:
            assert answer.status == 0 and value == pytest.approx(answer.fun * size, rel=1e-7, abs=1e-7 * size)
    assert np.isinf(found).any() and np.isfinite(found).any() and found[1] == 0
