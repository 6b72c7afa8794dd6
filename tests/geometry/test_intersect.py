"""Where segments meet, and the boxes around them."""

from __future__ import annotations

from math import cos, pi, sin
from random import Random

import numpy as np
import pytest
from hypothesis import given

from strategies import seeds
from workhold.geometry.segment import (
    Arc,
    Line,
    bounding_box,
    circle_circle,
    common_points,
    contains_parameter,
)


@given(seeds)
def test_a_box_holds_its_arc_and_touches_it_on_all_sides(seed: int) -> None:
    """Of arcs of any sweep, also of those that hardly pass an extreme point or nearly close: points all along lie in the
    box, and some on each of its sides."""
    random = Random(seed)
    half = random.choice([random.uniform(0.01, pi), pi - 10 ** random.uniform(-6, -1)])
    middle = random.choice(
        [random.uniform(-pi, pi), random.randrange(4) * pi / 2 + half - 10 ** random.uniform(-6, -1)]
    )
    arc = Arc((3.0, -2.0), 7.0, middle, half, random.choice([1.0, -1.0]))
    low_x, low_y, high_x, high_y = bounding_box(arc)
    angles = middle + half * np.concatenate([np.linspace(-1, 1, 2001), 1 - np.geomspace(1e-9, 1e-2, 60)])
    extremes = np.arange(-12, 13) * pi / 2
    angles = np.concatenate([angles, extremes[np.abs(extremes - middle) <= half]])
    x, y = 3.0 + 7.0 * np.cos(angles), -2.0 + 7.0 * np.sin(angles)
    assert (low_x - 1e-12 <= x).all() and (x <= high_x + 1e-12).all()
    assert (low_y - 1e-12 <= y).all() and (y <= high_y + 1e-12).all()
    assert [x.min(), y.min(), x.max(), y.max()] == pytest.approx([low_x, low_y, high_x, high_y], abs=1e-4)


def test_a_segment_that_lies_in_another_meets_it_at_both_its_ends() -> None:
    """On one line and on one circle the carriers have no common points to list: the ends do, whichever comes first."""
    inner, outer = Line((2.0, 1.0), (5.0, 1.0)), Line((0.0, 1.0), (10.0, 1.0))
    wide, narrow = Arc((0.0, 0.0), 5.0, 1.0, 1.2, 1.0), Arc((0.0, 0.0), 5.0, 0.9, 0.3, -1.0)
    for whole, part in ((outer, inner), (wide, narrow)):
        for pair in ((whole, part), (part, whole)):
            assert {(round(x, 9), round(y, 9)) for x, y in common_points(*pair, 1e-7)} == {
                (round(x, 9), round(y, 9)) for x, y in (part.start, part.end)
            }
    assert common_points(outer, Line((0.0, 1.1), (10.0, 1.1)), 1e-7) == []
    apart = Arc((0.0, 0.0), 5.0, 1.0 + pi, 0.3, 1.0)
    assert common_points(narrow, apart, 1e-7) == []
    assert common_points(narrow, Line((cos(0.9), sin(0.9)), (9 * cos(0.9), 9 * sin(0.9))), 1e-7) == [
        pytest.approx((5 * cos(0.9), 5 * sin(0.9)))
    ]


def test_circles_that_touch_have_one_common_point_and_one_inside_another_none() -> None:
    """Whichever of them comes first; a touch from inside lies beyond the centre of the smaller one."""
    wide, narrow = ((0.0, 0.0), 5.0), ((2.0, 0.0), 3.0)
    for one, two in ((wide, narrow), (narrow, wide)):
        assert circle_circle(*one, *two) == [pytest.approx((5.0, 0.0))]
        assert circle_circle(*one, two[0], two[1] + 1e-6 * (1 if two is wide else -1)) == []
    assert circle_circle(*wide, (8.0, 0.0), 3.0) == [pytest.approx((5.0, 0.0))]
    assert circle_circle(*wide, (8.0 + 1e-6, 0.0), 3.0) == []


def test_a_tolerance_at_the_end_of_an_arc_is_a_length() -> None:
    """So much along the arc, whatever its radius."""
    arc = Arc((0.0, 0.0), 100.0, 0.0, 0.5, 1.0)
    assert contains_parameter(arc, 0.5 + 0.9e-5, 1e-3)
    assert not contains_parameter(arc, 0.5 + 1.1e-5, 1e-3)
