"""Chains of chords and arcs that are one line or arc: what becomes one, what stays, and how far off it is said to be."""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, hypot, pi, sin, tan
from random import Random

import numpy as np
import pytest
from numpy.typing import NDArray

from workhold.conventions import READING
from workhold.geometry.loop import list_loop_faces, make_loop_segments
from workhold.geometry.merged_runs import MergedLoop, merge_chords, put_arcs_on_one_circle


def merged(rows: Sequence[Sequence[float]], fit: float | None = None) -> MergedLoop:
    """What is made of a loop of points, or of vertices with bulges."""
    vertices = np.array([(*row, 0.0)[:3] for row in rows])
    return merge_chords(vertices, fit)


def slot(ends: int, sides: int = 1, digits: int = 6) -> NDArray[np.float64]:
    """A slot 40 long and 20 wide whose ends and sides are so many chords each."""
    right = [(40 + 10 * sin(k * pi / ends), 10 - 10 * cos(k * pi / ends)) for k in range(ends)]
    half = [(40 * k / sides, 0.0) for k in range(sides)] + right
    return np.round(half + [(40 - x, 20 - y) for x, y in half], digits)


@pytest.mark.thinned(3)
@pytest.mark.parametrize(("ends", "sides"), [(120, 1), (700, 1), (300, 50), (300, 7)])
@pytest.mark.parametrize("start", [0, 1, 40, 200])
def test_a_slot_of_chords_is_two_lines_and_two_arcs(ends: int, sides: int, start: int) -> None:
    """Wherever the loop begins, also within a side or an end; lines and arcs meet where they do, to a chord's length."""
    loop = merged(np.roll(slot(ends, sides), start, axis=0).tolist())
    assert len(loop.vertices) == 4
    assert np.sort(np.abs(loop.vertices[:, 2])) == pytest.approx([0, 0, 1, 1], abs=0.02)
    corners = np.array([(0, 0), (0, 20), (40, 0), (40, 20)])
    order = np.lexsort((np.round(loop.vertices[:, 1]), np.round(loop.vertices[:, 0])))
    assert loop.vertices[order, :2] == pytest.approx(corners, abs=1e-5 + 2 * pi * 10 / ends)
    sagitta = 10 * (1 - cos(pi / 2 / ends))
    assert sagitta * 0.9 <= loop.departure <= sagitta + 2e-5
    assert loop.merged == 2 * (ends + sides) - 4


def test_the_loop_keeps_its_beginning_and_its_order() -> None:
    """The first segment drawn is part of the first segment read, unless a longer one goes across the beginning."""
    assert merged(slot(120).tolist()).firsts == (0, 1, 121, 122)


@pytest.mark.thorough
@pytest.mark.parametrize("count", [8, 16, 60, 400])
def test_polygons_stay_polygons(count: int) -> None:
    """Of 50 mm radius and up to 400 sides, 1.5 µm and more off the circle: nothing is changed, not even by a digit."""
    rows = [(50 * cos(2 * pi * k / count), 50 * sin(2 * pi * k / count)) for k in range(count)]
    loop = merged(rows)
    assert loop.merged == 0 and loop.departure == 0
    assert (loop.vertices == np.array([(*row, 0.0) for row in rows])).all()


def test_a_coarse_polygon_is_a_circle_only_with_a_fit_above_its_sagitta() -> None:
    """60 sides are 0.0685 mm off; 12 sides of 30 degrees are corners with any fit."""
    rows = [(50 * cos(2 * pi * k / 60), 50 * sin(2 * pi * k / 60)) for k in range(60)]
    assert merged(rows, 0.068).merged == 0
    loop = merged(rows, 0.07)
    assert len(loop.vertices) == 2 and loop.departure == pytest.approx(50 * (1 - cos(pi / 60)))
    twelve = [(50 * cos(2 * pi * k / 12), 50 * sin(2 * pi * k / 12)) for k in range(12)]
    assert merged(twelve, 5.0).merged == 0


def test_corners_and_short_edges_stay() -> None:
    """A rectangle, its corners broken by 0.01 mm, and a step of 0.002 mm."""
    step = [(0, 0), (30, 0), (30, 0.002), (60, 0.002), (60, 40), (0, 40)]
    broken = [(0.01, 0), (59.99, 0), (60, 0.01), (60, 39.99), (59.99, 40), (0.01, 40), (0, 39.99), (0, 0.01)]
    for rows in (step, broken):
        assert merged(rows).merged == 0


def test_vertices_on_a_side_go_when_they_are_on_it() -> None:
    """A vertex 0.4 µm off is part of the side, one 4 µm off a corner."""
    near, far = ([(0, 0), (30, off), (60, 0), (60, 40), (0, 40)] for off in (0.0004, 0.004))
    assert merged(near).departure == pytest.approx(0.0004)
    assert merged(near).firsts == (0, 2, 3, 4)
    assert merged(far).merged == 0


def test_a_line_that_runs_back_is_kept() -> None:
    """Points of a line that are out of order are not a line."""
    assert merged([(0, 0), (40, 0), (30, 0.0002), (60, 0), (60, 40), (0, 40)]).merged == 0


def test_a_hairpin_smaller_than_the_tolerance_is_kept() -> None:
    """A line that turns round in small steps, runs back by half its length and turns again is within 0.001 mm of a line."""
    turn = [(0.0002 * sin(k * pi / 12), 0.0002 - 0.0002 * cos(k * pi / 12)) for k in range(13)]
    there = [(40 + x, y) for x, y in turn]
    back = [(20 - x, 0.0004 + y) for x, y in turn]
    loop = merged([(0, 0), *there, *back, (60, 0.0008), (60, 40), (0, 40)])
    assert {20, 40} <= {round(float(x), 2) for x in loop.vertices[:, 0]}


def test_arcs_of_one_circle_become_one() -> None:
    """Four quarters with four digits, a half circle in two parts, and none of two fillets of different radius."""
    rough = merged([(10, 0, 0.4142), (0, 10.0003, 0.4143), (-10, 0, 0.41415), (0, -10, 0.4142)])
    assert len(rough.vertices) == 2 and 1e-4 < rough.departure < 1e-3
    part = tan(pi / 16)
    stadium = [
        (0, 0, 0),
        (40, 0, part),
        (40 + 10 * sin(pi / 4), 10 - 10 * cos(pi / 4), tan(3 * pi / 16)),
        (40, 20, 0),
        (0, 20, 1),
    ]
    loop = merged(stadium)
    assert loop.firsts == (0, 1, 3, 4) and loop.departure < 1e-12
    assert loop.vertices[1, 2] == pytest.approx(1)
    s = hypot(1, 1) / 2
    fillets = [
        (0, 0, 0),
        (40, 0, tan(pi / 16)),
        (40 + 10 * s, 10 - 10 * s, tan(pi / 16)),
        (40 + 20 * s - 10, 20, 0),
        (0, 20, 0),
    ]
    assert merged(fillets).merged == 0


def test_what_is_to_stay_stays() -> None:
    """Biarcs of a true curve are not taken together, whatever their neighbours do."""
    rows = np.array([(50 * cos(k * pi / 360), 50 * sin(k * pi / 360), 0.0) for k in range(720)])
    kept = [100 <= k < 110 for k in range(720)]
    loop = merge_chords(rows, None, kept)
    assert set(range(100, 110)) <= set(loop.firsts)
    # What is left is 355 degrees, which one bulge would hold badly.
    assert len(loop.vertices) == 12
    assert merge_chords(rows, None, [True] * 720).merged == 0


def test_noise_is_left_alone() -> None:
    """Of a random walk hardly anything is taken together, and no more than a micrometre off."""
    rows = np.cumsum(np.random.default_rng(0).normal(size=(2000, 2)), axis=0)
    loop = merged(rows.tolist())
    assert loop.merged < 10 and loop.departure <= 1e-3


@pytest.mark.parametrize("along", ["line", "arc"])
def test_a_chain_that_turns_back_is_no_run(along: str) -> None:
    """A loop of 0.4 mm in 40 chords where the fit is 0.5 mm, no corner in it: near the line or arc, but it runs back."""
    if along == "line":
        before, after = [(2.0 * k, 0.0) for k in range(11)], [(20.0 + 2.0 * k, 0.0) for k in range(1, 11)]
        rest, here, away = [(40.0, 30.0), (0.0, 30.0)], (20.0, 0.0), 0.0
    else:
        turns = [pi / 360 * k for k in range(181)]
        before, after = ([(50 * sin(a), 50 - 50 * cos(a)) for a in some] for some in (turns[:91], turns[91:]))
        rest, here, away = [(50.0, 80.0), (0.0, 80.0)], before[-1], pi / 4
    # An ellipse, which is not an arc to the digits of a file.
    a, b, c, s = 0.2, 0.12, cos(away), sin(away)
    around = [(a * sin(2 * pi * k / 40), b * (1 - cos(2 * pi * k / 40))) for k in range(1, 41)]
    curl = [(here[0] + c * x - s * y, here[1] + s * x + c * y) for x, y in around]
    straight, curled = (merged([*before, *some, *after, *rest], 0.5) for some in ([], curl))
    assert len(straight.vertices) == 4
    assert len(curled.vertices) > len(straight.vertices)


# Arcs that lie on one circle but for less than a drawing can mean become one, and no other.
RADIUS = 20.0


def arcs(count: int, off: float, turn: float, seed: int = 0) -> NDArray[np.float64]:
    """A circle as arcs between places on it, run counter-clockwise, whose sweeps are off by up to ``off`` radians."""
    random, step = Random(seed), 2 * pi / count
    angles = [turn + k * step for k in range(count)]
    bulges = [tan((step + off * random.uniform(-1, 1)) / 4) for _ in angles]
    return np.array([[RADIUS * cos(a), RADIUS * sin(a), b] for a, b in zip(angles, bulges, strict=True)])


def away(vertices: NDArray[np.float64], others: NDArray[np.float64]) -> float:
    """How far in mm vertices and the arcs' middles of two loops are apart, at most."""
    pairs = zip(make_loop_segments(vertices), make_loop_segments(others), strict=True)
    points = [
        (p, q)
        for one, other in pairs
        for p, q in ((one.start, other.start), (one.compute_point(0.0), other.compute_point(0.0)))
    ]
    return max(hypot(p[0] - q[0], p[1] - q[1]) for p, q in points)


@pytest.mark.thorough
@pytest.mark.parametrize("count", [3, 16, 200])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_whole_circle_is_one_face_and_stays_so(count: int, sign: float) -> None:
    loop = arcs(count, 0.4 * READING, 0.7)
    if sign < 0:
        loop = np.column_stack([loop[::-1, :2], -np.roll(loop[::-1, 2], -1)])
    out, changed = put_arcs_on_one_circle(loop, make_loop_segments(loop))
    assert changed == count
    assert away(loop, out) <= 2 * READING
    assert len(list_loop_faces(make_loop_segments(out), 0)) == 1
    again, changed = put_arcs_on_one_circle(out, make_loop_segments(out))
    assert changed == 0 and (again == out).all()


def test_an_arc_in_pieces_keeps_its_ends() -> None:
    loop = arcs(16, READING, 0.3)[:7]
    loop[-1, 2] = 0.0
    out, changed = put_arcs_on_one_circle(loop, make_loop_segments(loop))
    assert changed == 6
    assert (out[[0, 6], :2] == loop[[0, 6], :2]).all()
    assert [len(face.segments) for face in list_loop_faces(make_loop_segments(out), 0)] == [6, 1]


@pytest.mark.parametrize("off", [5e-6, 1e-4, 1e-2])
def test_arcs_that_a_drawing_keeps_apart_stay(off: float) -> None:
    loop = arcs(16, off, 0.3)
    out, changed = put_arcs_on_one_circle(loop, make_loop_segments(loop))
    assert changed == 0 and (out == loop).all()


def test_arcs_of_two_circles_that_join_smoothly_stay() -> None:
    """Half a circle of radius 20 and, tangent to it, half one of radius 20.001 mm, joined by a short line."""
    loop = np.array([[20.0, 0.0, 1.0], [-20.0, 0.0, 1.0], [20.002, 0.0, 0.0]])
    out, changed = put_arcs_on_one_circle(loop, make_loop_segments(loop))
    assert changed == 0 and (out == loop).all()
