"""How a part lies on a wall."""

from __future__ import annotations

from math import cos, pi, sin

import numpy as np
import pytest

from workhold import Pose, Workpiece


@pytest.mark.parametrize("turned", [0.0, 0.01, 1.0, 5.0])
def test_the_hull_edge_nearest_to_the_wall_is_told_of_any_orientation(turned: float) -> None:
    """Its own is nearest to each, whole turns apart too, and none is nearer than the one told, also around 0 degrees."""
    angles = turned + np.array([0.0, 0.7, 1.9, 2.0, 3.3, 5.9])
    part = Workpiece.from_loops("part", [[(30 * cos(a), 30 * sin(a), 0) for a in angles]])
    theta, numbers = part.flush.theta, np.arange(6)
    for laps in (-2, -1, 0, 1):
        assert (part.flush.find_nearest_edges(theta + laps * 2 * pi) == numbers).all()
    some = np.linspace(-7.0, 7.0, 500)
    off = np.abs((some[:, None] - theta + pi) % (2 * pi) - pi)
    told = part.flush.find_nearest_edges(some)
    assert (off[np.arange(500), told] <= off.min(axis=1) + 1e-12).all()
    assert set(told.tolist()) == set(range(6))


def test_a_turn_is_written_clockwise_below_an_eighth() -> None:
    """An eighth itself and more is counted on; next to a whole turn people write what is left of it."""
    assert [Pose(turn, 0.0, 0.0).written_deg for turn in (314.0, 315.0, 316.0, 359.75)] == [
        314.0,
        315.0,
        -44.0,
        -0.25,
    ]
