"""Which plane maps keep circles circles."""

from __future__ import annotations

from math import cos, pi, sin
from random import Random

from hypothesis import given

from strategies import seeds
from workhold.files.outline.chain import Placement


def singular_ratio(map_: Placement) -> float:
    """Smaller over larger half axis of the ellipse that a circle becomes."""
    half, twist = (map_.a**2 + map_.b**2 + map_.c**2 + map_.d**2) / 2, map_.determinant
    rest = max(half * half - twist * twist, 0.0) ** 0.5
    return ((half - rest) / (half + rest)) ** 0.5


@given(seeds)
def test_circles_stay_circles_exactly_when_the_image_has_equal_axes(seed: int) -> None:
    """Turned, mirrored and scaled maps keep circles. Others do not: with unequal axes, with axes of one length that are not
    square to each other, and with both."""
    random = Random(seed)
    turn, size, mirror = random.uniform(-pi, pi), 10 ** random.uniform(-3, 3), random.choice([1, -1])
    ratio, skew = (
        random.choice([1.0, 1.0, random.uniform(0.3, 0.999)]),
        random.choice([0.0, 0.0, random.uniform(1e-3, 1.4)]),
    )
    other = turn + mirror * (pi / 2 - random.choice([1, -1]) * skew)
    map_ = Placement(size * cos(turn), size * sin(turn), ratio * size * cos(other), ratio * size * sin(other))
    assert map_.keeps_circles == (ratio == 1.0 and skew == 0.0)
    assert map_.keeps_circles == (singular_ratio(map_) > 1 - 1e-4)
