"""Contacts on lines are looked for where features are."""

from __future__ import annotations

from math import cos, pi, sin
from random import Random

import numpy as np
import pytest

from chord_examples import arc_row
from workhold.search.flush_search import PartOnWall
from workhold.search.wall_contacts import bound_heights, compute_half_angles, find_pin_contacts


@pytest.mark.parametrize("upright", [False, True])
def test_an_arc_reaches_from_its_lowest_to_its_highest_point(upright: bool) -> None:
    """And no farther than is to spare; and every line between meets it, once or twice, where its points are."""
    random, across = Random(5), (4, 3) if upright else (3, 4)
    for _ in range(100):
        half = random.choice([pi, random.uniform(0.01, pi)])
        row = arc_row(3.0, -2.0, random.uniform(0.5, 300.0), random.uniform(-pi, pi), half)
        rows = np.append(row, [1e-9, 1e-9])[None]
        low, high = bound_heights(rows, across, np.array([1e-3]))
        reach = compute_half_angles(rows)[0]
        middle = np.arctan2(row[4], row[3])
        angles = middle + np.linspace(-reach, reach, 4001)
        points = row[6] * (np.cos(angles) if upright else np.sin(angles))
        assert low[0] <= points.min() - 9e-4 and points.max() + 9e-4 <= high[0]
        assert (
            low[0] >= points.min() - 1.1e-3 - 1e-5 * row[6]
            and high[0] <= points.max() + 1.1e-3 + 1e-5 * row[6]
        )
        laid = PartOnWall(rows, 50.0, 1e-15, 1e-13)
        inside = middle + np.array([random.uniform(-0.99, 0.99) * half for _ in range(5)])
        x, y = 3.0 + row[6] * np.cos(inside), -2.0 + row[6] * np.sin(inside)
        found = find_pin_contacts(laid, (0, 1), x if upright else y, upright, 0.0)
        for k in range(5):
            there = found.point[found.line == k]
            assert 1 <= len(there) <= 2 and np.hypot(*(there - [x[k], y[k]]).T).min() < 1e-6 * row[6]


def test_a_line_is_met_up_to_its_ends() -> None:
    """One that rises gently, by lines through its middle, just inside its ends, and beyond them."""
    row = np.array([[0.0, 10.0, 5.0, cos(0.01), sin(0.01), 40.0, 0.0, 1.0, 0.0, 0.0, -1e-9, -1e-9]])
    levels = 5.0 + np.array([0.0, -39.999, 39.999, -40.001, 40.001, 60.0]) * sin(0.01)
    found = find_pin_contacts(PartOnWall(row, 50.0, 1e-15, 1e-13), (0, 1), levels, False, 0.0)
    assert found.line.tolist() == [0, 1, 2]
    assert found.slack == pytest.approx([40.0, 1e-3, 1e-3], abs=1e-8)
