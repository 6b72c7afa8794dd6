"""Set cover: proven least, and the first of all that are."""

from __future__ import annotations

import sys
from itertools import combinations
from math import inf
from random import Random

import numpy as np
import pytest
from numpy.typing import NDArray

from workhold.errors import InputError
from workhold.family.covering import (
    Cover,
    LossTable,
    Point,
    Search,
    bound_cover_size,
    compute_curve,
    convert_bits_to_sets,
    find_first_cover,
    find_greedy_cover,
    find_maximal_sets,
    find_smallest_cover,
    iterate_least_losses,
)
from workhold.family.solver import load_solver

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
    found = find_smallest_cover(sets)
    assert found.is_least and found.at_least == len(every[0])
    assert found.sets in every
    assert find_first_cover(sets, len(found.sets), found.sets) == every[0]
    assert 1 <= bound_cover_size(sets) <= len(every[0])


def test_greedy_is_not_enough_where_the_largest_set_misleads() -> None:
    # Two halves of six, and a set of four across them that greed takes first.
    sets = np.array([[1, 1, 1, 1, 0, 0], [1, 0, 1, 0, 1, 0], [0, 1, 0, 1, 0, 1]], np.bool_)
    assert find_greedy_cover(sets) == (0, 1, 2)
    assert find_smallest_cover(sets) == Cover((1, 2), 2)


def test_without_time_it_is_told_what_is_known() -> None:
    sets = random_sets(Random(5), 40, 30)
    found = find_smallest_cover(sets, deadline=0.0)
    assert sets[list(found.sets)].any(axis=0).all()
    least = find_smallest_cover(sets)
    assert least.is_least
    assert 1 <= found.at_least <= len(least.sets) <= len(found.sets)
    assert find_first_cover(sets, len(found.sets), found.sets, deadline=0.0)


def test_sets_inside_others_go() -> None:
    masks = np.array([[0b011], [0b111], [0b100], [0b1000], [0b111], [0b0]], np.uint64)
    assert find_maximal_sets(masks).tolist() == [1, 3]
    # Members beyond the 64th are in a word of their own.
    wide = np.array([[1, 0], [1, 1], [0, 2], [0, 3]], np.uint64)
    assert sorted(find_maximal_sets(wide).tolist()) == [1, 3]
    assert convert_bits_to_sets(wide, 66)[:, [0, 64, 65]].tolist() == [
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
    assert find_greedy_cover(sets) == (0, 1, 2, 3)
    monkeypatch.setattr("workhold.family.covering.bound_cover_size", lambda sets: 1)
    assert find_smallest_cover(sets) == Cover((0, 1, 2, 3), 3)


@pytest.mark.thorough
@pytest.mark.parametrize("seed", range(3))
def test_larger_covers_are_proven_too(seed: int) -> None:
    random = Random(seed)
    sets = np.array([[random.random() < 0.08 for _ in range(60)] for _ in range(120)])
    sets[range(60), range(60)] = True
    found = find_smallest_cover(sets)
    assert found.is_least and len(found.sets) < len(find_greedy_cover(sets))
    assert sets[list(found.sets)].any(axis=0).all()


# The curve against trying everything, on families of six.
pytest.importorskip("scipy", reason="the extra [batch] is not installed")


def table_from(losses: NDArray[np.float64]) -> LossTable:
    """The table of losses (P, M), NaN where a pattern does not hold a member; patterns are named by their numbers."""
    pattern, member = np.nonzero(~np.isnan(losses))
    loss = losses[pattern, member]
    order = np.argsort(loss, kind="stable")
    number = np.arange(len(losses))
    return LossTable(losses.shape[1], number[:, None], number, pattern[order], member[order], loss[order])


def random_losses(random: Random, patterns: int, members: int) -> NDArray[np.float64]:
    """Losses (P, M) of which many tie; every member has a pattern that loses nothing."""
    losses = np.full((patterns, members), np.nan)
    for pattern in range(patterns):
        for member in range(members):
            if random.random() < 0.5:
                losses[pattern, member] = random.choice([1.0, 1.1, 1.1, 1.25, 1.5, 2.0, 3.0, inf])
    for member in range(members):
        losses[random.randrange(patterns), member] = 1.0
    return losses


def least_losses(losses: NDArray[np.float64]) -> dict[int, float]:
    """For each number of patterns that can hold all the least worst loss, by trying everything."""
    worst = np.where(np.isnan(losses), np.nan, losses)
    out: dict[int, float] = {}
    for size in range(1, losses.shape[1] + 1):
        for some in combinations(range(len(losses)), size):
            with np.errstate(all="ignore"):
                held = worst[list(some)]
            if np.isnan(held).all(axis=0).any():
                continue
            out[size] = min(out.get(size, inf), float(np.nanmin(held, axis=0).max()))
        if out.get(size) == 1.0:
            break
    return out


def worst_loss(losses: NDArray[np.float64], point: Point) -> float:
    """The worst loss of the patterns of a point."""
    return float(np.nanmin(losses[list(point.patterns)], axis=0).max())


@pytest.mark.thinned(2)
@pytest.mark.parametrize("seed", range(30))
def test_families_of_six_by_trying_everything(seed: int) -> None:
    random = Random(seed)
    losses = random_losses(random, random.randint(4, 12), 6)
    points = compute_curve(table_from(losses))
    expected = least_losses(losses)
    steps = {k: loss for k, loss in expected.items() if k - 1 not in expected or loss < expected[k - 1]}
    assert {point.setups: point.loss for point in points} == steps
    for point in points:
        assert point.is_least and point.at_least == point.setups == len(point.patterns)
        assert worst_loss(losses, point) == point.loss
        assert point.patterns == first_patterns(losses, point)


def first_patterns(losses: NDArray[np.float64], point: Point) -> tuple[int, ...]:
    """Of the sets of patterns of a point's size and loss, each the first of those that hold the same and nothing more than
    another, the first in lexicographic order."""
    sets = losses <= point.loss
    inside = [
        any((one <= other).all() and ((one != other).any() or b < a) for b, other in enumerate(sets))
        for a, one in enumerate(sets)
    ]
    chosen = [number for number in range(len(sets)) if not inside[number]]
    return next(some for some in combinations(chosen, point.setups) if sets[list(some)].any(axis=0).all())


def test_a_largest_loss_ends_the_curve() -> None:
    losses = random_losses(Random(3), 9, 6)
    whole = compute_curve(table_from(losses))
    bounded = compute_curve(table_from(losses), 1.2)
    assert [point for point in whole if point.loss <= 1.2][1:] == list(bounded[1:])
    assert bounded[0].setups == min(point.setups for point in whole if point.loss <= 1.2)
    assert len(bounded) < len(whole)


def test_seventy_members_take_two_words() -> None:
    # Pattern k holds members k to k + 34; the two that are best for all are the ends.
    losses = np.full((36, 70), np.nan)
    for pattern in range(36):
        losses[pattern, pattern : pattern + 35] = 1.0 + pattern / 100
    (point,) = compute_curve(table_from(losses))
    assert (point.setups, point.patterns, point.loss) == (2, (0, 35), 1.35)


@pytest.mark.thorough
def test_when_time_is_over_it_is_told_what_is_known() -> None:
    # Every pair of twelve members: greed finds six pairs, or more, and packing proves what it can.
    random = Random(11)
    losses = np.full((40, 24), np.nan)
    for pattern in range(40):
        for member in random.sample(range(24), 4):
            losses[pattern, member] = random.choice([1.0, 1.2, 1.5])
    losses[range(24), range(24)] = 1.0
    known, proven = compute_curve(table_from(losses), deadline=0.0), compute_curve(table_from(losses))
    assert not all(point.is_least and point.at_least == point.setups for point in known)
    for point in known:
        assert worst_loss(losses, point) <= point.loss
        assert len(point.patterns) <= point.setups
        best = next(one for one in proven if one.loss <= point.loss)
        assert point.at_least <= best.setups <= point.setups


def test_progress_ends_at_one() -> None:
    told: list[float] = []
    compute_curve(table_from(random_losses(Random(1), 12, 6)), progress=told.append)
    assert told == sorted(told) and told[-1] == pytest.approx(1.0)


def test_a_number_is_the_least_where_the_bound_before_needs_more() -> None:
    losses = np.array([[1.0, np.nan], [np.nan, 1.0], [1.5, 1.5]])
    search = Search(table_from(losses), np.array([1.0, 1.5]), None, lambda fraction: None)
    search.covers = {0: Cover((0, 1), 2), 1: Cover((2,), 1)}
    assert [point.is_least for point in iterate_least_losses(search)] == [True, True]
    # One set-up is not ruled out at the smaller bound.
    search.covers = {0: Cover((0, 1), 1), 1: Cover((2,), 1)}
    assert [(point.at_least, point.is_least) for point in iterate_least_losses(search)] == [
        (1, True),
        (1, False),
    ]
