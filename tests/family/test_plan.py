"""The order of set-ups against trying all of them."""

from __future__ import annotations

from itertools import pairwise, permutations, product
from random import Random

import pytest

from workhold import Fence, Plate, Vise
from workhold.family import plan as module
from workhold.family.patterns import NOTHING, Hole
from workhold.family.plan import SetUpFreedom, find_best_order, find_cheapest_move, find_freedom


def random_holes(random: Random) -> list[Hole]:
    """Two pegs on each of two carriers."""
    return [(carrier, random.randrange(2), random.randrange(4)) for carrier in (0, 0, 1, 1)]


def fewest_moved(one: list[Hole], other: list[Hole], freedom: SetUpFreedom) -> int:
    """Pegs to place for one set-up after another, by trying every move."""
    reach = range(-5, 6)
    tried = []
    for columns, rows in product(reach if freedom.columns else [0], reach if freedom.rows else [0]):
        left = list(one)
        for carrier, column, row in other:
            hole = (carrier, column + columns, row + rows)
            if hole in left:
                left.remove(hole)
        tried.append(len(left))
    return min(tried)


@pytest.mark.thorough
@pytest.mark.parametrize(
    "freedom", [SetUpFreedom(False, False), SetUpFreedom(False, True), SetUpFreedom(True, True)]
)
@pytest.mark.parametrize("seed", range(6))
def test_no_other_order_moves_fewer(seed: int, freedom: SetUpFreedom) -> None:
    random = Random(seed)
    setups = [random_holes(random) for _ in range(5)]
    steps = find_best_order(setups, freedom)
    assert sorted(step.setup for step in steps) == list(range(5))
    least = min(
        sum(fewest_moved(setups[a], setups[b], freedom) for a, b in pairwise(order))
        for order in permutations(range(5))
    )
    assert sum(step.moved for step in steps[1:]) == least
    assert steps[0].moved == 4


@pytest.mark.parametrize("seed", range(6))
def test_what_is_told_to_be_moved_is_what_does_not_stand_yet(seed: int) -> None:
    random = Random(seed)
    setups = [[(c, x + 5, y + 7) for c, x, y in random_holes(random)] for _ in range(6)]
    steps = find_best_order(setups, SetUpFreedom(True, True))
    stood = [[(c, x + step.columns, y + step.rows) for c, x, y in setups[step.setup]] for step in steps]
    for step, before, after in zip(steps[1:], stood, stood[1:], strict=False):
        for hole in before:
            if hole in after:
                after = [one for place, one in enumerate(after) if place != after.index(hole)]
        assert len(after) == step.moved
    for axis in (1, 2):
        assert min(hole[axis] for holes in stood for hole in holes) == 0


def test_what_tells_nothing_stays() -> None:
    clamp = (1, NOTHING, 2)
    pegs, columns, rows = find_cheapest_move(
        [(0, 0, 0), (0, 1, 0), clamp], [(0, 3, 1), (0, 4, 1), (1, NOTHING, 3)], SetUpFreedom(True, True)
    )
    assert (pegs, columns, rows) == (0, -3, -1)


def test_beyond_what_is_tried_the_way_goes_to_the_nearest(monkeypatch: pytest.MonkeyPatch) -> None:
    random = Random(4)
    setups = [random_holes(random) for _ in range(6)]
    exact = sum(step.moved for step in find_best_order(setups, SetUpFreedom(False, True))[1:])
    monkeypatch.setattr(module, "MOST_EXACT", 3)
    steps = find_best_order(setups, SetUpFreedom(False, True))
    assert sorted(step.setup for step in steps) == list(range(6))
    assert sum(step.moved for step in steps[1:]) >= exact


@pytest.mark.parametrize(
    ("toolkit", "expected"),
    [
        (Vise(pitch=10, columns=2, peg_radius=3), (False, True)),
        (Vise(pitch=10, columns=2, peg_radius=3, rows=6), (False, False)),
        (Vise(pitch=10, columns=2, peg_radius=3, blocked=["L-A1"]), (False, False)),
        (Plate(pitch=20, peg_radius=3), (True, True)),
        (Plate(pitch=20, peg_radius=3, columns=8), (False, True)),
        (Fence(pitch=20, peg_radius=3, wall_offset=10), (True, False)),
    ],
)
def test_set_ups_move_where_the_toolkit_has_no_end(
    toolkit: Vise | Plate, expected: tuple[bool, bool]
) -> None:
    assert find_freedom(toolkit) == SetUpFreedom(*expected)
