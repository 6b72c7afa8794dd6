"""Triangles of polygons with holes: they cover the polygon once, and use its sides once and no other vertex."""

from __future__ import annotations

from collections import Counter
from math import cos, pi, sin

import numpy as np
import pytest

from workhold.geometry.triangulation import triangulate

Loop = list[tuple[float, float]]


def area(loop: Loop) -> float:
    """Signed area of a loop."""
    return sum(p[0] * q[1] - p[1] * q[0] for p, q in zip(loop, loop[1:] + loop[:1], strict=True)) / 2


def circle(x: float, y: float, radius: float, count: int) -> Loop:
    """A hole, clockwise."""
    return [
        (x + radius * cos(2 * pi * k / count), y - radius * sin(2 * pi * k / count)) for k in range(count)
    ]


def assert_is_triangulated(*loops: Loop) -> None:
    """Every side is a side of one triangle, every other edge one of two; areas add up, none is negative; Euler's count."""
    triangles, points = triangulate(loops), [point for loop in loops for point in loop]
    areas = [area([points[k] for k in triangle]) for triangle in triangles]
    whole = sum(map(area, loops))
    assert sum(areas) == pytest.approx(whole, rel=1e-12) and min(areas) > -1e-12 * whole
    edges = Counter(edge for a, b, c in triangles for edge in ((a, b), (b, c), (c, a)))
    assert set(edges.values()) == {1}
    sides, first = set(), 0
    for loop in loops:
        sides |= {(first + k, first + (k + 1) % len(loop)) for k in range(len(loop))}
        first += len(loop)
    assert {edge for edge in edges if edge[::-1] not in edges} == sides
    assert len(triangles) == len(points) + 2 * (len(loops) - 1) - 2


@pytest.mark.parametrize("count", [4, 12, 17])
@pytest.mark.parametrize("radius", [3.0, 4.999])
def test_a_plate_with_rows_of_holes(count: int, radius: float) -> None:
    """Many vertices at one height, and holes that nearly touch each other and the border."""
    border = [(-5.0, -5.0), (115.0, -5.0), (115.0, 75.0), (-5.0, 75.0)]
    holes = [circle(10.0 * i, 10.0 * j, radius, count) for i in range(12) for j in range(8)]
    assert_is_triangulated(border, *holes)


def test_stars_with_holes() -> None:
    """Random stars about random holes, from a seed."""
    random = np.random.default_rng(5)
    for _ in range(150):
        count = int(random.integers(9, 40))
        sizes = random.uniform(5, 10, count)
        star = [(r * cos(2 * pi * k / count), r * sin(2 * pi * k / count)) for k, r in enumerate(sizes)]
        holes = [
            circle(x, y, float(random.uniform(0.2, 0.45)), int(random.integers(3, 9)))
            for x in (-1, 0, 1)
            for y in (-1, 0, 1)
            if random.random() < 0.6
        ]
        assert_is_triangulated(star, *holes)


@pytest.mark.parametrize("turned", range(4))
def test_combs_with_level_sides(turned: int) -> None:
    """Stairs and notches along the axes: sides that lie along the sweep, vertices that continue a line."""
    random = np.random.default_rng(turned)
    for _ in range(50):
        count = int(random.integers(2, 9))
        tops = [(k - d, int(random.integers(1, 4))) for k in range(count, 0, -1) for d in (0, 1)]
        tops = [(x, tops[2 * (k // 2)][1]) for k, (x, _) in enumerate(tops)]
        comb: Loop = []
        for point in [(0, 0), (count, 0), *tops]:
            if not comb or comb[-1] != point:
                comb.append((float(point[0]), float(point[1])))
        for _ in range(turned):
            comb = [(-y, x) for x, y in comb]
        assert_is_triangulated(comb)
