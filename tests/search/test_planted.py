"""Planted fixtures are found: a part is built around four pegs, so one of its fixtures is known beforehand."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count, islice

import pytest
from planting import Plant, plant

from fixture_sets import Judge, listed, missing
from holdfast import design


def valid_plants(first_seed: int) -> Iterator[tuple[Plant, Judge]]:
    """Plants that the independent checker accepts and that are not marginal."""
    for seed in count(first_seed):
        planted = plant(seed)
        if planted is not None:
            judge = Judge(planted.workpiece, planted.vise)
            faults, marginal = judge.check(planted.fixture)
            if not faults and not marginal:
                yield planted, judge


def test_planted_fixtures_are_found() -> None:
    """The search lists each of 60 planted fixtures, over lines, convex and concave arcs and both types."""
    kinds = set()
    for planted, judge in islice(valid_plants(0), 60):
        result = design(planted.workpiece, planted.vise, types=[planted.fixture["type"]])
        assert missing(listed(result), [planted.fixture], judge) == []
        kinds.add(planted.fixture["type"])
    assert kinds == {"I", "II"}


@pytest.mark.prove
def test_thousands_of_planted_fixtures_are_found() -> None:
    """The search lists each of 3,000 planted fixtures."""
    for planted, judge in islice(valid_plants(1_000_000), 3000):
        result = design(planted.workpiece, planted.vise, types=[planted.fixture["type"]])
        assert missing(listed(result), [planted.fixture], judge) == []
