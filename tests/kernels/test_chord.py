"""Chords touch both features, and their derivatives are derivatives."""

from __future__ import annotations

from math import cos, hypot, inf, pi, sin
from random import Random

import numpy as np
import pytest

from chord_examples import PAIRS, arc_row, line_row, off_carrier, random_ranges, turn_at
from holdfast.kernels.chord import HEIGHT, POSITION, chord, curve_value, tail_distance
from holdfast.kernels.chord_bounds import curve_bend, over_cube
from holdfast.kernels.through_motion import are_one_chord_apart


def difference(values: np.ndarray, step: float) -> float:
    """First derivative at the middle of seven values a step apart, exact to the sixth power of the step."""
    weights = np.array([-1, 9, -45, 0, 45, -9, 1]) / 60
    return float(weights @ values) / step


@pytest.mark.parametrize("kinds", PAIRS)
def test_tail_and_head_touch_their_features(kinds):
    """u lies on a, u + d (cos alpha, sin alpha) lies on b, and r_a, r_b are the contact directions there."""
    random = Random(1)
    for _ in range(150):
        a, b, d, ranges = random_ranges(random, kinds)
        for low, high, branch, *_ in ranges:
            for part in (1e-9, 0.3, random.random(), 1 - 1e-9):
                alpha = low + part * (high - low)
                ux, uy, rax, ray, rbx, rby = chord(a, b, d, alpha, branch)
                head = np.array([[ux + d * cos(alpha), uy + d * sin(alpha)]])
                assert off_carrier(a, np.array([[ux, uy]])) < 1e-9
                assert off_carrier(b, head) < 1e-9
                for row, point, r in ((a, (ux, uy), (rax, ray)), (b, head[0], (rbx, rby))):
                    expected = (row[4], -row[3]) if row[0] == 0 else (np.array(point) - row[1:3]) / row[6]
                    assert np.allclose(r, expected, atol=1e-9 / max(row[6], 1e-1))


@pytest.mark.parametrize("mode", [HEIGHT, POSITION])
@pytest.mark.parametrize("kinds", PAIRS)
def test_slope_is_the_derivative_of_the_value(kinds, mode):
    """h' = -x . P and s' = -p (over R on an arc) agree with central differences of h and s over psi."""
    random = Random(2)
    checked = 0
    while checked < 150:
        a, b, d, ranges = random_ranges(random, kinds, 1e-2)
        low, high, branch, *_ = ranges[random.randrange(len(ranges))]
        shift = random.uniform(-pi, pi)
        alpha = low + random.uniform(0.05, 0.95) * (high - low)
        step = min(alpha - low, high - alpha, 0.3) / 600
        values = np.array([curve_value(a, b, d, alpha + k * step, branch, shift, mode)[0] for k in range(-3, 4)])
        if mode == POSITION and a[0] != 0.0:
            values = np.unwrap(values)
        slope = curve_value(a, b, d, alpha, branch, shift, mode)[1]
        assert difference(values, step) == pytest.approx(slope, rel=1e-5, abs=1e-7 + 1e-12 / step)
        checked += 1


def test_the_height_of_a_chord_between_square_lines_is_known():
    """A ladder of length d on the axes: u = (0, -d sin alpha) with its head on y = 0, so h = -d sin(alpha) cos(psi)."""
    wall, floor = line_row(0, 0, pi / 2, 50), line_row(0, 0, 0, 50)
    for alpha in np.linspace(0.1, 6.2, 40):
        value, slope, *_ = curve_value(wall, floor, 10.0, alpha, 1.0, 0.0, HEIGHT)
        assert value == pytest.approx(-10 * sin(alpha) * cos(alpha), abs=1e-12)
        assert slope == pytest.approx(-10 * cos(2 * alpha), abs=1e-12)


def test_the_instant_centre_is_where_the_lines_of_action_meet():
    """P = u + p r_a lies on the line through the head along r_b, and every point moves square to its way to P."""
    random = Random(3)
    for kinds in PAIRS:
        for _ in range(40):
            a, b, d, ranges = random_ranges(random, kinds, 1e-2)
            low, high, branch, *_ = ranges[0]
            alpha = low + random.uniform(0.1, 0.9) * (high - low)
            c = chord(a, b, d, alpha, branch)
            p = tail_distance(c, d, alpha)
            gap = (c[0] + p * c[2] - c[0] - d * cos(alpha), c[1] + p * c[3] - c[1] - d * sin(alpha))
            assert abs(gap[0] * c[5] - gap[1] * c[4]) < 1e-9 * (1 + abs(p))


def test_a_tangency_has_an_infinite_tail_distance():
    """Where both normals are parallel (X = 0) the instant centre is at infinity."""
    assert tail_distance((0.0, 0.0, 1.0, 0.0, -1.0, 0.0), 5.0, 1.0) == inf


def test_equal_arcs_one_chord_apart_turn_smoothly_through_the_coincidence():
    """With equal radii and centres d apart, both branches touch both circles arbitrarily near the coincidence.

    There u - c_a is square to the half-way direction: the tails of the branches tend to the two ends of a diameter.
    """
    for angle in (0.0, 0.4, 2.0, -3.0):
        a, b = arc_row(1, 2, 5), arc_row(1 + 12 * cos(angle), 2 + 12 * sin(angle), 5)
        assert are_one_chord_apart(a, b, 12.0)
        for away in (1e-11, 1e-8, 1e-4, 0.3):
            for side in (1, -1):
                tails = []
                for branch in (1.0, -1.0):
                    alpha = angle + side * away
                    ux, uy, *_ = chord(a, b, 12.0, alpha, branch)
                    head = np.array([[ux + 12 * cos(alpha), uy + 12 * sin(alpha)]])
                    assert off_carrier(a, np.array([[ux, uy]])) < 1e-12
                    assert off_carrier(b, head) < 1e-12
                    tails.append((ux, uy))
                apart = hypot(tails[0][0] - tails[1][0], tails[0][1] - tails[1][1])
                assert apart == pytest.approx(2 * (25 - (12 * sin(away / 2)) ** 2) ** 0.5, rel=1e-9)


def sub_range(random: Random, low: float, high: float) -> tuple[float, float]:
    """A part of a range: its width spread over six powers of ten, now and then touching an end."""
    width = (high - low) * 10 ** random.uniform(-6, 0)
    place = random.random()
    start = low if place < 0.2 else high - width if place > 0.8 else low + random.random() * (high - low - width)
    return max(start, low), min(start + width, high)


@pytest.mark.parametrize("mode", [HEIGHT, POSITION])
@pytest.mark.parametrize("kinds", PAIRS)
def test_bend_encloses_every_divided_difference_of_the_slope(kinds, mode):
    """(f'(t) - f'(s)) / (t - s) is a second derivative between s and t (mean value theorem), so it lies in the bend."""
    random = Random(4)
    bounded = 0
    for _ in range(400):
        a, b, d, ranges = random_ranges(random, kinds)
        first, last, branch, *_ = ranges[random.randrange(len(ranges))]
        shift = random.uniform(-pi, pi)
        low, high = sub_range(random, first, last)
        sign = 1.0 if turn_at(a, b, d, (low + high) / 2, branch) > 0 else -1.0
        bottom, top = curve_bend(a, b, d, low, high, branch, shift, mode, sign)
        assert not bottom > top
        if bottom == -inf and top == inf:
            continue
        bounded += 1
        for _ in range(4):
            s, t = sorted(low + (high - low) * random.random() for _ in range(2))
            end = min(s - first, last - t)
            if t - s < 1e-9 or end < 1e-8:
                continue
            f, g = (curve_value(a, b, d, x, branch, shift, mode)[1] for x in (s, t))
            rounding = 2e-14 * (100 + abs(f) + abs(g)) / min(end, 1.0) / (t - s)
            second = (g - f) / (t - s)
            assert bottom - rounding <= second <= top + rounding, (list(a), list(b), d, low, high, branch, shift, sign)
    assert bounded > 150


@pytest.mark.parametrize("mode", [HEIGHT, POSITION])
@pytest.mark.parametrize("kinds", PAIRS)
def test_bend_closes_in_on_the_second_derivative(kinds, mode):
    """Away from tangencies the enclosure's width tends to 0 with the range: over 1e-7 rad it is the derivative itself."""
    random = Random(5)
    for _ in range(100):
        a, b, d, ranges = random_ranges(random, kinds, 0.1)
        first, last, branch, *_ = ranges[0]
        alpha = first + random.uniform(0.3, 0.7) * (last - first)
        turn = turn_at(a, b, d, alpha, branch)
        if abs(turn) < 0.2 or are_one_chord_apart(a, b, d):
            continue
        shift, step = random.uniform(-pi, pi), min(alpha - first, last - alpha, 0.3) / 300
        slopes = [curve_value(a, b, d, alpha + k * step, branch, shift, mode)[1] for k in range(-3, 4)]
        second = difference(np.array(slopes), step)
        bottom, top = curve_bend(a, b, d, alpha - 5e-8, alpha + 5e-8, branch, shift, mode, np.sign(turn))
        slack = 1e-4 * (1 + abs(second)) + 1e-10 / step
        assert bottom - slack <= second <= top + slack
        assert top - bottom < 0.05 * (1 + abs(second))


def test_over_cube_bounds_a_quotient_on_one_side_of_zero():
    """n / t^3 for n and t in intervals, t of one sign or reaching 0 from one side, lies in the enclosure."""
    random = Random(6)
    for _ in range(3000):
        n = tuple(sorted(random.uniform(-3, 5) for _ in range(2)))
        t = tuple(sorted((random.choice([0.0, random.uniform(0, 2)]), random.uniform(0, 2))))
        if random.random() < 0.5:
            t = (-t[1], -t[0])
        bottom, top = over_cube(n, t)
        for _ in range(5):
            x, y = random.uniform(*n), random.uniform(*t)
            if y != 0.0:
                assert bottom <= x / y**3 * (1 + 1e-15) or bottom <= x / y**3 * (1 - 1e-15)
                assert x / y**3 * (1 - 1e-15) <= top or x / y**3 * (1 + 1e-15) <= top
