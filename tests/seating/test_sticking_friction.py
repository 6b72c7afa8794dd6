"""Below the friction that is told no three contacts balance the jaw inside their cones; just above it some do."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from scipy.optimize import linprog

from workhold.seating.clamping import find_sticking_friction


def balances(points, normals, right, friction):
    """Whether some three contacts, pressing along the edges of their cones, balance with 1 on the right jaw."""
    tangents = np.stack([-normals[:, 1], normals[:, 0]], axis=1)
    edges = np.stack([-normals + friction * tangents, -normals - friction * tangents], axis=1)
    moments = points[:, None, 0] * edges[..., 1] - points[:, None, 1] * edges[..., 0]
    for triple in combinations(range(4), 3):
        # The right jaw's pegs push the part to the left.
        pushed = edges[triple, :, 0] * np.array(right)[list(triple), None]
        rows = [edges[triple, :, 0], edges[triple, :, 1], moments[triple, :], pushed]
        told = linprog(np.zeros(6), A_eq=np.array([row.ravel() for row in rows]), b_eq=[0.0, 0.0, 0.0, -1.0])
        if told.status == 0:
            return True
    return False


def clamped(generator):
    """Four contacts that hold a part without friction while the jaw of the right ones closes."""
    while True:
        turn = generator.uniform(0.0, 2.0 * np.pi, 4)
        points, normals = generator.normal(size=(4, 2)), np.stack([np.cos(turn), np.sin(turn)], axis=1)
        right = np.array([0, 0, 1, 1]) if generator.random() < 0.5 else np.array([0, 0, 0, 1])
        moments = points[:, 0] * normals[:, 1] - points[:, 1] * normals[:, 0]
        forces = np.linalg.svd(np.array([normals[:, 0], normals[:, 1], moments]))[2][-1]
        forces = forces * np.sign(forces.sum())
        if forces.min() > 0.02 and (forces * right * normals[:, 0]).sum() > 0.02:
            return points, normals, right


@pytest.mark.parametrize("seed", range(4))
def test_friction_is_the_least_at_which_three_contacts_balance(seed):
    generator = np.random.default_rng(seed)
    for _ in range(6):
        points, normals, right = clamped(generator)
        least = find_sticking_friction(points, normals, right)
        assert least < np.inf
        assert not balances(points, normals, right, 0.9999 * least)
        assert balances(points, normals, right, 1.0001 * least)


@pytest.mark.parametrize("one, two", [(0.5, 0.2), (0.2, 0.5)])
def test_two_contacts_balance_where_their_line_lies_in_both_cones(one, two):
    """Pegs that press at one point of a face count as one: mu* is the larger of both tangents."""
    points = np.array([[-10.0, 3.0], [-10.0, 3.0], [10.0, 3.0], [-10.0, 3.0]])
    left = [-np.cos(one), np.sin(one)]
    normals = np.array([left, left, [np.cos(two), np.sin(two)], left])
    least = find_sticking_friction(points, normals, np.array([0, 0, 1, 0]))
    assert least == pytest.approx(max(np.tan(one), np.tan(two)), abs=1e-9)
