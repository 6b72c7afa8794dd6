"""The wrench radius in balls: distance from the origin to the nearest facet of the hull of the wrenches, no unit.

A wrench here is (n, (q - c) x n / L), c being the centre of the part's bounding box.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

from flint import arb

from workhold.verification.balls import Point, cross, least, root
from workhold.verification.tolerances import FLAT

__all__ = ["radius_of_five", "radius_of_four"]

Wrench = tuple[arb, arb, arb]


def wrenches_about(center: Point, length: float, points: Sequence[Point], normals: Sequence[Point]) -> list[Wrench]:
    """Wrenches of contacts about a centre, moments in parts of a length in mm."""
    return [
        (*normal, cross((x - center[0], y - center[1]), normal) / length)
        for (x, y), normal in zip(points, normals, strict=True)
    ]


def radius_of_four(
    minors: Sequence[arb], center: Point, length: float, points: Sequence[Point], normals: Sequence[Point]
) -> arb:
    """Of four wrenches, with their minors in mm.

    The volume of a facet's tetrahedron with the origin is a minor of the wrenches, so its height is that minor, in parts
    of L, over the size of w_a x w_b + w_b x w_c + w_c x w_a, which is twice the facet's area.
    """
    wrenches = wrenches_about(center, length, points, normals)
    products = {(i, k): vector_product(wrenches[i], wrenches[k]) for i, k in combinations(range(4), 2)}
    heights = []
    for left_out, minor in enumerate(minors):
        a, b, c = (k for k in range(4) if k != left_out)
        sides = zip(products[a, b], products[b, c], products[a, c], strict=True)
        heights.append(abs(minor) / size_of([ab + bc - ac for ab, bc, ac in sides]))
    return least(heights) / length


def radius_of_five(center: Point, length: float, points: Sequence[Point], normals: Sequence[Point]) -> arb | None:
    """Of five wrenches: the nearest plane through three of them that has both others on one side.

    Several may lie in one plane, or two be equal, to ``FLAT``; where that is in doubt the ball holds both cases.
    """
    wrenches, nearest = wrenches_about(center, length, points, normals), None
    for corners in combinations(range(5), 3):
        a, b, c = (wrenches[k] for k in corners)
        across = vector_product(difference(b, a), difference(c, a))
        size = size_of(across)
        if size < FLAT or not size > 0:
            continue
        sides = [scalar(across, difference(wrenches[k], a)) / size for k in range(5) if k not in corners]
        if any(side > FLAT for side in sides) and any(side < -FLAT for side in sides):
            continue
        height = abs(scalar(across, a)) / size
        sure = all(side > -FLAT for side in sides) or all(side < FLAT for side in sides)
        found = height if nearest is None else nearest.min(height)
        nearest = found if sure or nearest is None else found.union(nearest)
    return nearest


def vector_product(a: Sequence[arb], b: Sequence[arb]) -> Wrench:
    """Vector product in space."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def difference(a: Wrench, b: Wrench) -> Wrench:
    """One vector less another."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def scalar(a: Wrench, b: Wrench) -> arb:
    """Scalar product in space."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def size_of(vector: Sequence[arb]) -> arb:
    """Length of a vector in space."""
    return root(sum((entry * entry for entry in vector), arb(0)))
