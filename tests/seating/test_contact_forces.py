"""What two or three contacts balance is told by their wrenches: forces that push, with 1 on the jaw."""

from __future__ import annotations

import numpy as np
import pytest

from workhold.seating.contact_forces import is_balanced


def three(generator: np.random.Generator, forces: list[float]) -> np.ndarray:
    """Three wrenches (3, 4) that balance with such forces, scaled to 1 on the jaw, which is the first contact's."""
    while True:
        turn = generator.uniform(0.0, 2.0 * np.pi)
        one = np.array([np.cos(turn), np.sin(turn)])
        # Unit vectors that close a triangle of forces.
        a, b, c = np.abs(forces)
        cosine = (c * c - a * a - b * b) / (2.0 * a * b)
        angle = np.arccos(cosine)
        two = np.array([np.cos(turn + angle), np.sin(turn + angle)])
        third = -(a * one + b * two) / c
        normals = np.array([one, two, third]) * np.sign(forces)[:, None]
        moments = generator.normal(size=3)
        moments[2] = -(forces[0] * moments[0] + forces[1] * moments[1]) / forces[2]
        if abs(normals[0, 0]) > 0.1:
            return np.column_stack(
                [normals, moments, normals[:, 0] * [np.sign(forces[0] * normals[0, 0]), 0.0, 0.0]]
            )


@pytest.mark.parametrize("seed", range(5))
def test_three_that_push_balance_and_none_that_pulls(seed: int) -> None:
    generator = np.random.default_rng(seed)
    wrenches = three(generator, [1.0, 0.8, 0.9])
    assert is_balanced(wrenches.tolist()) and is_balanced(wrenches[[2, 0, 1]].tolist())
    for column in range(3):
        off = wrenches.copy()
        off[1, column] += 1e-6
        assert not is_balanced(off.tolist())
    for pulling in ([1.0, -0.8, 0.9], [1.0, 0.8, -0.9]):
        assert not is_balanced(three(generator, pulling).tolist())
    # The jaw is pushed, and not by nothing.
    assert not is_balanced((wrenches * [1.0, 1.0, 1.0, -1.0]).tolist())
    assert not is_balanced((wrenches * [1.0, 1.0, 1.0, 1e-12]).tolist())


def test_parallel_forces_balance_by_their_moments() -> None:
    """Two beside each other against one between them, wherever the jaw is."""
    for jaw in range(3):
        wrenches = np.array([[0.6, 0.8, 2.0, 0.0], [-0.6, -0.8, 0.5, 0.0], [0.6, 0.8, -3.0, 0.0]])
        wrenches[jaw, 3] = abs(wrenches[jaw, 0])
        assert is_balanced(wrenches.tolist())
        wrenches[1, 2] = 3.5
        assert not is_balanced(wrenches.tolist())


def test_two_balance_on_one_line() -> None:
    line = [[0.6, -0.8, 0.3, 0.6], [-0.6, 0.8, -0.3, 0.0]]
    assert is_balanced(line)
    assert not is_balanced([line[0], [-0.6, 0.8, -0.3 + 1e-6, 0.0]]) and not is_balanced(
        [line[0], [-0.8, 0.6, -0.3, 0.0]]
    )
    assert not is_balanced([[*one[:3], -one[3]] for one in line])
