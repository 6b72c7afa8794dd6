"""Convex hull of points."""

from __future__ import annotations

from collections.abc import Iterable

from workhold.geometry.segment import Point

__all__ = ["convex_hull"]


def convex_hull(points: Iterable[Point]) -> list[Point]:
    """Corners of the convex hull, counter-clockwise from the leftmost; points on its sides are left out.

    Reference: A. M. Andrew, *Another efficient algorithm for convex hulls in two dimensions*, Information Processing
    Letters 9 (1979).

    Examples
    --------
    >>> convex_hull([(0, 0), (2, 0), (1, 1), (2, 2), (0, 2), (1, 0)])
    [(0, 0), (2, 0), (2, 2), (0, 2)]
    """
    ordered = sorted(set(points))
    if len(ordered) <= 2:
        return ordered
    lower, upper = half_hull(ordered), half_hull(ordered[::-1])
    return lower[:-1] + upper[:-1]


def half_hull(ordered: list[Point]) -> list[Point]:
    """The chain of left turns from the first of some ordered points to the last."""
    chain: list[Point] = []
    for x, y in ordered:
        while len(chain) >= 2:
            (ax, ay), (bx, by) = chain[-2:]
            if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0:
                break
            chain.pop()
        chain.append((x, y))
    return chain
