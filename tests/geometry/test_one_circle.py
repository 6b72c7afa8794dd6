"""Arcs that lie on one circle but for less than a drawing can mean become one, and no other."""

from __future__ import annotations

from math import cos, hypot, pi, sin, tan
from random import Random

import numpy as np
import pytest
from numpy.typing import NDArray

from workhold.conventions import READING
from workhold.geometry.loop import faces_of_loop, loop_segments
from workhold.geometry.merged_runs import on_one_circle

RADIUS = 20.0


def arcs(count: int, off: float, turn: float, seed: int = 0) -> NDArray[np.float64]:
    """A circle as arcs between places on it, run counter-clockwise, whose sweeps are off by up to ``off`` radians."""
    random, step = Random(seed), 2 * pi / count
    angles = [turn + k * step for k in range(count)]
    bulges = [tan((step + off * random.uniform(-1, 1)) / 4) for _ in angles]
    return np.array([[RADIUS * cos(a), RADIUS * sin(a), b] for a, b in zip(angles, bulges, strict=True)])


def away(vertices: NDArray[np.float64], others: NDArray[np.float64]) -> float:
    """How far in mm vertices and the arcs' middles of two loops are apart, at most."""
    pairs = zip(loop_segments(vertices), loop_segments(others), strict=True)
    points = [
        (p, q) for one, other in pairs for p, q in ((one.start, other.start), (one.at(0.0), other.at(0.0)))
    ]
    return max(hypot(p[0] - q[0], p[1] - q[1]) for p, q in points)


@pytest.mark.parametrize("count", [3, 16, 200])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_whole_circle_is_one_face_and_stays_so(count: int, sign: float) -> None:
    loop = arcs(count, 0.4 * READING, 0.7)
    if sign < 0:
        loop = np.column_stack([loop[::-1, :2], -np.roll(loop[::-1, 2], -1)])
    out, changed = on_one_circle(loop, loop_segments(loop))
    assert changed == count
    assert away(loop, out) <= 2 * READING
    assert len(faces_of_loop(loop_segments(out), 0)) == 1
    again, changed = on_one_circle(out, loop_segments(out))
    assert changed == 0 and (again == out).all()


def test_an_arc_in_pieces_keeps_its_ends() -> None:
    loop = arcs(16, READING, 0.3)[:7]
    loop[-1, 2] = 0.0
    out, changed = on_one_circle(loop, loop_segments(loop))
    assert changed == 6
    assert (out[[0, 6], :2] == loop[[0, 6], :2]).all()
    assert [len(face.segments) for face in faces_of_loop(loop_segments(out), 0)] == [6, 1]


@pytest.mark.parametrize("off", [5e-6, 1e-4, 1e-2])
def test_arcs_that_a_drawing_keeps_apart_stay(off: float) -> None:
    loop = arcs(16, off, 0.3)
    out, changed = on_one_circle(loop, loop_segments(loop))
    assert changed == 0 and (out == loop).all()


def test_arcs_of_two_circles_that_join_smoothly_stay() -> None:
    """Half a circle of radius 20 and, tangent to it, half one of radius 20.001 mm, joined by a short line."""
    loop = np.array([[20.0, 0.0, 1.0], [-20.0, 0.0, 1.0], [20.002, 0.0, 0.0]])
    out, changed = on_one_circle(loop, loop_segments(loop))
    assert changed == 0 and (out == loop).all()
