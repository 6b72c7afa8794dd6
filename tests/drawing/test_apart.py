"""Names moved apart: none covers another, their order stays, and no one moves farther than it has to."""

from __future__ import annotations

from itertools import pairwise
from random import Random

import numpy as np
import pytest

from workhold.drawing.side_drawing import move_apart


@pytest.mark.parametrize("seed", range(40))
def test_names_stand_apart_in_their_order(seed: int) -> None:
    """Also where many want the same place, and at the ends of the line."""
    chance = Random(seed)
    count = chance.randrange(1, 12)
    wanted = [round(chance.uniform(0, 300), chance.choice((0, -2))) for _ in range(count)]
    sizes = [chance.uniform(5, 40) for _ in range(count)]
    placed = move_apart(wanted, sizes, 3.0, -50.0, 900.0)
    order = sorted(range(count), key=lambda k: (wanted[k], k))
    for one, other in pairwise(order):
        assert placed[other] - placed[one] >= (sizes[one] + sizes[other]) / 2 + 3.0 - 1e-9
    assert min(at - size / 2 for at, size in zip(placed, sizes, strict=True)) >= -50.0 - 1e-9
    assert max(at + size / 2 for at, size in zip(placed, sizes, strict=True)) <= 900.0 + 1e-9


@pytest.mark.parametrize("seed", range(20))
def test_moves_are_the_least(seed: int) -> None:
    """No small change of all places at once that keeps names apart makes the sum of squares less."""
    chance = Random(seed)
    wanted = sorted(chance.uniform(0, 100) for _ in range(5))
    placed = np.array(move_apart(wanted, [12.0] * 5, 2.0, -500.0, 500.0))
    assert (np.diff(placed) >= 14.0 - 1e-9).all()
    best = ((placed - wanted) ** 2).sum()
    for _ in range(400):
        other = placed + np.array([chance.gauss(0, 2.0) for _ in range(5)])
        if (np.diff(other) >= 14.0).all():
            assert ((other - wanted) ** 2).sum() >= best - 1e-9


def test_a_run_stands_about_the_middle_of_its_wishes() -> None:
    """Four names that touch stand where the mean of their moves is nothing: 12.75 before the first wish."""
    assert move_apart([0.0, 0.0, 0.0, 9.0], [10.0] * 4, 0.0, -99.0, 99.0) == [-12.75, -2.75, 7.25, 17.25]


def test_no_names_have_no_places() -> None:
    """Nothing is moved where there is nothing; more than the line holds begin at its low end."""
    assert move_apart([], [], 1.0, 0.0, 10.0) == []
    assert move_apart([5.0, 5.0], [20.0, 20.0], 1.0, 0.0, 30.0) == [10.0, 31.0]
