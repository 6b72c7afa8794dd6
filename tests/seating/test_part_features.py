"""A part covers its place again where all of its outline lies on the outline, and nowhere else."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

from workhold import Workpiece, load
from workhold.kernels.base.distance import measure_outline_distances
from workhold.seating.part_features import SAME_PLACE, Silhouette

PLATE = Workpiece.from_loops("plate", [[[0, 0, 0], [40, 0, 0], [40, 60, 0], [0, 60, 0]]])
DISC = Workpiece.from_loops("disc", [[[-15, 0, 1], [15, 0, 1]]])
# Crowned by a hundredth of a millimetre, and with its lower end round.
CROWNED = Workpiece.from_loops("crowned", [[[0, 0, 1], [40, 0, 0], [40, 60, 5e-4], [0, 60, 0]]])
HERE = np.array([0.4, 12.0, -7.0, 30.0])


def covers(part: Workpiece, turn: float, x: float, y: float, turned_over: bool = False) -> bool:
    """Whether a part covers its place after a turn about its middle and a shift in mm along its own axes."""
    c, s = np.cos(HERE[0]), np.sin(HERE[0])
    there = HERE + np.array([turn, c * x - s * y, s * x + c * y, 5.0])
    return bool(
        Silhouette.from_workpiece(part).find_same_cover(HERE, there[None], np.array([turned_over]))[0]
    )


@pytest.mark.parametrize("part", [PLATE, DISC, CROWNED], ids=lambda part: part.name)
def test_a_part_covers_its_place_up_to_a_shift_that_is_none(part: Workpiece) -> None:
    """On some face the shift is square to it, and so as far as points are off the outline."""
    for x, y in ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)):
        assert covers(part, 0.0, 0.99 * SAME_PLACE * x, 0.99 * SAME_PLACE * y)
        assert not covers(part, 0.0, 1.01 * SAME_PLACE * x, 1.01 * SAME_PLACE * y)


def test_what_is_alike_after_a_turn_covers_its_place() -> None:
    assert covers(PLATE, pi, 0.0, 0.0) and covers(PLATE, 0.0, 0.0, 0.0, True)
    assert not covers(PLATE, pi / 2.0, 0.0, 0.0) and not covers(PLATE, 1e-3, 0.0, 0.0)
    assert all(covers(DISC, turn, 0.0, 0.0, over) for turn in (0.1, 2.0, -3.0) for over in (False, True))
    assert covers(CROWNED, 0.0, 0.0, 0.0, True) and not covers(CROWNED, pi, 0.0, 0.0)


def test_turned_over_means_in_the_frame_of_the_part() -> None:
    """x to -x, and only then turned and moved: a leaning part does not cover its place as its mirror image does."""
    leaning = Workpiece.from_loops("leaning", [[[0, 0, 0], [40, 0, 0], [60, 30, 0], [20, 30, 0]]])
    assert covers(leaning, pi, 0.0, 0.0) and not covers(leaning, 0.0, 0.0, 0.0, True)
    assert not covers(leaning, pi, 0.0, 0.0, True)


def test_all_is_as_the_distances_of_all_points_say() -> None:
    """Of many configurations near the place and far from it, as drawn and turned over, of a part with all sorts of faces."""
    part, generator = load("widget"), np.random.default_rng(3)
    outline, count = Silhouette.from_workpiece(part), 400
    over, near = generator.random(count) < 0.3, 10.0 ** generator.uniform(-6.0, 1.0, count)
    others = HERE + near[:, None] * generator.normal(size=(count, 4)) * np.array([0.01, 1.0, 1.0, 1.0])
    told = outline.find_same_cover(HERE, others, over)
    right = []
    for other, is_over in zip(others, over, strict=True):
        (c, s), (d, t) = ((np.cos(theta), np.sin(theta)) for theta in (other[0], HERE[0]))
        points = (
            outline.points * ([-1.0, 1.0] if is_over else [1.0, 1.0]) @ np.array([[c, s], [-s, c]])
            + other[1:3]
        )
        back = (points - HERE[1:3]) @ np.array([[d, -t], [t, d]])
        right.append(measure_outline_distances(back, outline.rows).max() <= SAME_PLACE)
    assert told.tolist() == right and 20 < sum(right) < count - 20
