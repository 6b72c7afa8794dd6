"""The wrench radius in balls: distance from the origin to the nearest facet of the hull of the wrenches, no unit.

A wrench here is (n, (q - c) x n / L), c being the centre of the part's bounding box.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

from flint import arb

from workhold.verification.balls import Point, cross, root
from workhold.verification.tolerances import FLAT

__all__ = ["wrench_radius"]

Wrench = tuple[arb, arb, arb]


def wrench_radius(center: Point, length: float, points: Sequence[Point], normals: Sequence[Point]) -> arb | None:
    """The wrench radius of contacts, about a centre with L in mm; None where all wrenches may lie in one line.

    The nearest plane through three wrenches counts that has all others on one side. Several may lie in one plane, or two be
    equal, to ``FLAT``; where that is in doubt the ball holds both cases.
    """
    (x, y), nearest = center, None
    arms = [(px - x, py - y) for px, py in points]
    wrenches = [(*normal, cross(arm, normal) / length) for arm, normal in zip(arms, normals, strict=True)]
    for corners in combinations(range(len(wrenches)), 3):
        a, b, c = (wrenches[k] for k in corners)
        across = vector_product(difference(b, a), difference(c, a))
        size = root(scalar(across, across))
        if size < FLAT or not size > 0:
            continue
        others = (wrench for k, wrench in enumerate(wrenches) if k not in corners)
        sides = [scalar(across, difference(wrench, a)) / size for wrench in others]
        if any(side > FLAT for side in sides) and any(side < -FLAT for side in sides):
            continue
        height = abs(scalar(across, a)) / size
        sure = all(side > -FLAT for side in sides) or all(side < FLAT for side in sides)
        found = height if nearest is None else nearest.min(height)
        nearest = found if sure or nearest is None else found.union(nearest)
    return nearest


def vector_product(a: Wrench, b: Wrench) -> Wrench:
    """Vector product in space."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def difference(a: Wrench, b: Wrench) -> Wrench:
    """One vector less another."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def scalar(a: Wrench, b: Wrench) -> arb:
    """Scalar product in space."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
