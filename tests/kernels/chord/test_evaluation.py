"""Chords touch both features, and their derivatives are derivatives."""

from __future__ import annotations

from math import cos, hypot, isfinite, pi, sin
from random import Random

import numpy as np
import pytest

from chord_examples import PAIRS, arc_row, curve_row, line_row, off_carrier, random_ranges, turn_at
from workhold.kernels.base.tables import COINCIDENCE
from workhold.kernels.chord.coincidences import NONE, are_one_chord_apart
from workhold.kernels.chord.evaluation import (
    HEIGHT,
    POSITION,
    compute_chord,
    compute_chord_state,
    evaluate_curve,
)
from workhold.kernels.chord.stretches import enclose_center_motion


def difference(values: np.ndarray, step: float) -> float:
    """First derivative at the middle of seven values a step apart, exact to the sixth power of the step."""
    weights = np.array([-1, 9, -45, 0, 45, -9, 1]) / 60
    return float(weights @ values) / step


@pytest.mark.thinned(9)
@pytest.mark.parametrize("kinds", PAIRS)
def test_tail_and_head_touch_their_features(kinds):
    """u lies on a, u + d (cos alpha, sin alpha) lies on b, and r_a, r_b are the contact directions there."""
    random = Random(1)
    for _ in range(150):
        a, b, d, ranges = random_ranges(random, kinds)
        for low, high, branch, *_ in ranges:
            for part in (1e-9, 0.3, random.random(), 1 - 1e-9):
                alpha = low + part * (high - low)
                ux, uy, rax, ray, rbx, rby = compute_chord(a, b, d, alpha, branch)
                head = np.array([[ux + d * cos(alpha), uy + d * sin(alpha)]])
                assert off_carrier(a, np.array([[ux, uy]])) < 1e-9
                assert off_carrier(b, head) < 1e-9
                for row, point, r in ((a, (ux, uy), (rax, ray)), (b, head[0], (rbx, rby))):
                    expected = (row[4], -row[3]) if row[0] == 0 else (np.array(point) - row[1:3]) / row[6]
                    assert np.allclose(r, expected, atol=1e-9 / max(row[6], 1e-1))


@pytest.mark.thinned(2)
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
        curve, alpha = curve_row(a, b, d, branch, shift), low + random.uniform(0.05, 0.95) * (high - low)
        step = min(alpha - low, high - alpha, 0.3) / 600
        values = np.array(
            [evaluate_curve(a, b, curve, alpha - shift + k * step, mode)[0] for k in range(-3, 4)]
        )
        if mode == POSITION and a[0] != 0.0:
            values = np.unwrap(values)
        slope = evaluate_curve(a, b, curve, alpha - shift, mode)[1]
        assert difference(values, step) == pytest.approx(slope, rel=1e-5, abs=1e-7 + 1e-12 / step)
        checked += 1


def test_the_height_of_a_chord_between_square_lines_is_known():
    """A ladder of length d on the axes: u = (0, -d sin alpha) with its head on y = 0, so h = -d sin(alpha) cos(psi)."""
    wall, floor = line_row(0, 0, pi / 2, 50), line_row(0, 0, 0, 50)
    curve = curve_row(wall, floor, 10.0, 1.0)
    for alpha in np.linspace(0.1, 6.2, 40):
        value, slope, *_ = evaluate_curve(wall, floor, curve, alpha, HEIGHT)
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
            shift = random.uniform(-pi, pi)
            curve, psi = curve_row(a, b, d, branch, shift), alpha - shift
            ux, uy, rax, ray, rbx, rby, px, py, *_ = compute_chord_state(a, b, curve, psi, cos(psi), sin(psi))
            size = 1 + hypot(px - ux, py - uy)
            assert abs((px - ux) * ray - (py - uy) * rax) < 1e-9 * size
            assert abs((px - ux - d * cos(alpha)) * rby - (py - uy - d * sin(alpha)) * rbx) < 1e-9 * size


def test_at_a_tangency_no_error_is_told():
    """Where both normals are parallel (X = 0) the instant centre is at infinity: tail and slope have no finite error."""
    wall, circle = line_row(0, 0, pi / 2, 40), arc_row(10, 0, 4)
    # A peg 6 to the right of the wall touches the circle in (6, 0); one 14 to the right of it does on the other side.
    for d in (6.0, 14.0):
        curve = curve_row(wall, circle, d, 1.0)
        curve[COINCIDENCE] = NONE
        state = compute_chord_state(wall, circle, curve, 0.0, 1.0, 0.0)
        assert not isfinite(state[8]) and not isfinite(state[9])
        for mode in (HEIGHT, POSITION):
            _, _, error, slope_error = evaluate_curve(wall, circle, curve, 0.0, mode)
            assert not isfinite(error) and not isfinite(slope_error)


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
                    ux, uy, *_ = compute_chord(a, b, 12.0, alpha, branch)
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
    start = (
        low if place < 0.2 else high - width if place > 0.8 else low + random.random() * (high - low - width)
    )
    return max(start, low), min(start + width, high)


def center(a, b, curve, psi) -> tuple[float, float]:
    """The instant centre."""
    return compute_chord_state(a, b, curve, psi, cos(psi), sin(psi))[6:8]


@pytest.mark.thorough
@pytest.mark.thinned(2)
@pytest.mark.parametrize("kinds", PAIRS)
def test_center_motion_encloses_every_divided_difference_of_the_instant_centre(kinds):
    """(P(t) - P(s)) / (t - s) is a mean of P' between s and t, so each of its entries lies in the enclosure over X^3."""
    random = Random(4)
    bounded = 0
    for _ in range(400):
        a, b, d, ranges = random_ranges(random, kinds)
        first, last, branch, *_ = ranges[random.randrange(len(ranges))]
        low, high = sub_range(random, first, last)
        sign = 1.0 if turn_at(a, b, d, (low + high) / 2, branch) > 0 else -1.0
        curve = curve_row(a, b, d, branch)
        turn, *numerator = enclose_center_motion(a, b, curve, low, high, sign)[:3]
        assert turn[0] <= turn[1]
        if not turn[0] > 0.0 and not turn[1] < 0.0:
            continue
        bounded += 1
        for _ in range(4):
            s, t = sorted(low + (high - low) * random.random() for _ in range(2))
            end = min(s - first, last - t)
            if t - s < 1e-9 or end < 1e-8:
                continue
            one, two = center(a, b, curve, s), center(a, b, curve, t)
            for k, (bottom, top) in enumerate(numerator):
                quotients = [n / x**3 for n in (bottom, top) for x in turn]
                rounding = 2e-14 * (100 + abs(one[k]) + abs(two[k])) / min(end, 1.0) / (t - s)
                mean = (two[k] - one[k]) / (t - s)
                assert min(quotients) - rounding <= mean <= max(quotients) + rounding, (
                    list(a),
                    list(b),
                    d,
                    low,
                    high,
                    branch,
                    sign,
                )
    assert bounded > 150


@pytest.mark.parametrize("kinds", PAIRS)
def test_center_motion_closes_in_on_the_speed(kinds):
    """Away from tangencies the enclosure's width tends to 0 with the range: over 1e-7 rad it is the derivative itself."""
    random = Random(5)
    checked = 0
    for _ in range(100):
        a, b, d, ranges = random_ranges(random, kinds, 0.1)
        first, last, branch, *_ = ranges[0]
        alpha = first + random.uniform(0.3, 0.7) * (last - first)
        turn = turn_at(a, b, d, alpha, branch)
        if abs(turn) < 0.2 or are_one_chord_apart(a, b, d):
            continue
        curve, step = curve_row(a, b, d, branch), min(alpha - first, last - alpha, 0.3) / 300
        centers = np.array([center(a, b, curve, alpha + k * step) for k in range(-3, 4)])
        size, *numerator = enclose_center_motion(a, b, curve, alpha - 5e-8, alpha + 5e-8, np.sign(turn))[:3]
        for k, (low, high) in enumerate(numerator):
            speed = difference(centers[:, k], step)
            quotients = [n / x**3 for n in (low, high) for x in size]
            slack = 1e-4 * (1 + abs(speed)) + 1e-10 / step
            assert min(quotients) - slack <= speed <= max(quotients) + slack
            assert max(quotients) - min(quotients) < 0.05 * (
                1 + hypot(*(difference(c, step) for c in centers.T))
            )
        checked += 1
    assert checked > 20
