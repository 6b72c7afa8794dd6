"""Planted fixtures are found: a part is built around four pegs, so one of its fixtures is known beforehand."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count, islice

import pytest
from planting import Plant, plant

from fixture_sets import Judge, listed, missing
from workhold import design


def valid_plants(first_seed: int) -> Iterator[tuple[Plant, Judge]]:
    """Plants that the independent checker accepts and that are not marginal."""
    for seed in count(first_seed):
        planted = plant(seed)
        if planted is not None:
            judge = Judge(planted.workpiece, planted.vise)
            faults, marginal = judge.check(planted.fixture)
            if not faults and not marginal:
                yield planted, judge


def assert_found(first_seed: int, plants: int) -> set[str]:
    """The search lists each of some planted fixtures; return their types."""
    kinds = set()
    for planted, judge in islice(valid_plants(first_seed), plants):
        result = design(planted.workpiece, planted.vise, types=[planted.fixture["type"]])
        assert missing(listed(result), [planted.fixture], judge) == []
        assert result.proof is not None
        assert result.proof.undecided == ()
        kinds.add(planted.fixture["type"])
    return kinds


@pytest.mark.parametrize("plants", [7, pytest.param(12, marks=pytest.mark.prove)])
def test_planted_fixtures_are_found(plants: int) -> None:
    """Each of some planted fixtures is listed, over lines, convex and concave arcs and both types."""
    assert assert_found(10_000, plants) == {"I", "II"}


@pytest.mark.prove
@pytest.mark.parametrize("batch", range(15))
def test_thousands_of_planted_fixtures_are_found(batch: int) -> None:
    """Each of 1,500 planted fixtures is listed."""
    assert_found(1_000_000 + 10_000 * batch, 100)
