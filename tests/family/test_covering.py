"""Set cover: proven least, and the first of all that are."""

from __future__ import annotations

import sys
from itertools import combinations
from random import Random

import numpy as np
import pytest
from numpy.typing import NDArray

from workhold.errors import InputError
from workhold.family.covering import Cover, as_sets, cover, first_cover, greedy, load_solver, maximal, packing

pytest.importorskip("scipy", reason="the extra [batch] is not installed")


def random_sets(random: Random, count: int, members: int) -> NDArray[np.bool_]:
    """Sets (S, M) that together hold every member."""
    sets = np.array([[random.random() < 0.35 for _ in range(members)] for _ in range(count)])
    for member in range(members):
        sets[random.randrange(count), member] = True
    return sets


def all_covers(sets: NDArray[np.bool_]) -> list[tuple[int, ...]]:
    """The covers with the fewest sets, by trying everything, in lexicographic order."""
    for size in range(1, len(sets) + 1):
        found = [some for some in combinations(range(len(sets)), size) if sets[list(some)].any(axis=0).all()]
        if found:
            return found
    raise AssertionError("no cover")


@pytest.mark.parametrize("seed", range(25))
def test_covers_are_the_fewest_and_the_first(seed: int) -> None:
    random = Random(seed)
    sets = random_sets(random, random.randint(3, 11), random.randint(2, 9))
    every = all_covers(sets)
    found = cover(sets)
    assert found.is_least and found.at_least == len(every[0])
    assert found.sets in every
    assert first_cover(sets, len(found.sets), found.sets) == every[0]
    assert 1 <= packing(sets) <= len(every[0])


def test_greedy_is_not_enough_where_the_largest_set_misleads() -> None:
    # Two halves of six, and a set of four across them that greed takes first.
    sets = np.array([[1, 1, 1, 1, 0, 0], [1, 0, 1, 0, 1, 0], [0, 1, 0, 1, 0, 1]], np.bool_)
    assert greedy(sets) == (0, 1, 2)
    assert cover(sets) == Cover((1, 2), 2)


def test_without_time_it_is_told_what_is_known() -> None:
    sets = random_sets(Random(5), 40, 30)
    found = cover(sets, deadline=0.0)
    assert sets[list(found.sets)].any(axis=0).all()
    least = cover(sets)
    assert least.is_least
    assert 1 <= found.at_least <= len(least.sets) <= len(found.sets)
    assert first_cover(sets, len(found.sets), found.sets, deadline=0.0)


def test_sets_inside_others_go() -> None:
    masks = np.array([[0b011], [0b111], [0b100], [0b1000], [0b111], [0b0]], np.uint64)
    assert maximal(masks).tolist() == [1, 3]
    # Members beyond the 64th are in a word of their own.
    wide = np.array([[1, 0], [1, 1], [0, 2], [0, 3]], np.uint64)
    assert sorted(maximal(wide).tolist()) == [1, 3]
    assert as_sets(wide, 66)[:, [0, 64, 65]].tolist() == [
        [True, False, False],
        [True, True, False],
        [False, False, True],
        [False, True, True],
    ]


def test_without_scipy_the_remedy_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "scipy.optimize", None)
    with pytest.raises(InputError, match=r"pip install 'scipy>=1\.13'"):
        load_solver()


def test_a_bound_of_the_solver_is_rounded_up(monkeypatch: pytest.MonkeyPatch) -> None:
    from scipy import optimize

    class Outcome:
        x = None
        mip_dual_bound = 2.3

    monkeypatch.setattr(optimize, "milp", lambda *arguments, **options: Outcome())
    # Greed takes four sets here, of which every two share a member.
    sets = np.array(
        [
            [1, 1, 1, 1, 0, 0, 0, 0],
            [0, 0, 0, 1, 1, 1, 0, 0],
            [0, 1, 0, 0, 0, 1, 1, 0],
            [0, 0, 1, 0, 1, 0, 0, 1],
        ],
        np.bool_,
    )
    assert greedy(sets) == (0, 1, 2, 3)
    monkeypatch.setattr("workhold.family.covering.packing", lambda sets: 1)
    assert cover(sets) == Cover((0, 1, 2, 3), 3)


@pytest.mark.parametrize("seed", range(3))
def test_larger_covers_are_proven_too(seed: int) -> None:
    random = Random(seed)
    sets = np.array([[random.random() < 0.08 for _ in range(60)] for _ in range(120)])
    sets[range(60), range(60)] = True
    found = cover(sets)
    assert found.is_least and len(found.sets) < len(greedy(sets))
    assert sets[list(found.sets)].any(axis=0).all()
