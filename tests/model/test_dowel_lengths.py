"""Dowels are named as they are sold, and sit at least 1.5 diameters deep."""

from __future__ import annotations

import pytest

from workhold.conventions import DOWEL_DEPTH
from workhold.model.dowel_lengths import (
    find_dowel_lengths,
    find_shortest_dowel,
    list_sold_dowels,
    list_standouts,
)


def test_lengths_are_those_of_the_standards() -> None:
    """ISO 8734, table 1, and ASME B18.8.2."""
    six, quarter = find_dowel_lengths(6.0), find_dowel_lengths(6.35)
    assert six is not None and quarter is not None
    assert (six.standard, six.lengths[0], six.lengths[-1], len(six.lengths)) == ("ISO 8734", 14, 60, 16)
    assert (quarter.standard, quarter.lengths[0], quarter.lengths[-1]) == ("ASME B18.8.2", 12.7, 63.5)
    assert find_dowel_lengths(7.0) is None and list_standouts(7.0) == ()
    for one in list_sold_dowels():
        assert list(one.lengths) == sorted(set(one.lengths)) and one.lengths


@pytest.mark.parametrize(
    ("diameter", "standout", "name", "depth"),
    [
        (6.0, 11.0, "6 × 20 mm", 9.0),
        (6.0, 11.5, "6 × 22 mm", 10.5),
        (6.0, 38.0, "6 × 50 mm", 12.0),
        (16.0, 31.0, "16 × 55 mm", 24.0),
        (6.35, 12.7, "1/4 × 7/8 in", 9.525),
        (6.35, 13.0, "1/4 × 1 in", 12.4),
        (12.7, 25.4, "1/2 × 1-3/4 in", 19.05),
    ],
)
def test_the_shortest_that_sits_deep_enough(
    diameter: float, standout: float, name: str, depth: float
) -> None:
    dowel = find_shortest_dowel(diameter, standout)
    assert dowel is not None
    assert (dowel.name, dowel.standout) == (name, standout)
    assert dowel.depth == pytest.approx(depth)
    assert dowel.depth >= DOWEL_DEPTH * diameter - 1e-5
    known = find_dowel_lengths(diameter)
    assert known is not None
    shorter = [one for one in known.lengths if one < dowel.length]
    assert all(one - standout < DOWEL_DEPTH * diameter for one in shorter)


def test_what_is_not_sold_has_none() -> None:
    """A diameter between two, and more than the longest stands out."""
    assert find_shortest_dowel(7.0, 5.0) is None
    assert find_shortest_dowel(6.0, 51.1) is None
    assert list_standouts(6.0)[-1] == 51.0
