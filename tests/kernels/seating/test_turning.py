"""Bounds of a contact of a part that turns, and of roots, against plain formulas and sampling."""

from __future__ import annotations

from math import cos, pi, sin

import numpy as np
import pytest

from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, RADIUS, SIGN, X, Y
from workhold.kernels.seating.columns import DEPTH
from workhold.kernels.seating.tip_in_pocket import evaluate_waves, write_zeros
from workhold.kernels.seating.turning import (
    HALVES,
    NONE,
    ROOT,
    SHAPE_LENGTH,
    compute_contact,
    judge_range,
    write_shape,
)


def random_shape(random):
    """A piece and its shape about a point of the part, which may be a long way from an arc's centre."""
    row, angle = np.zeros(10), random.uniform(-pi, pi)
    row[IS_ARC], row[SIGN] = float(random.random() < 0.6), 1.0
    row[[AXIS_X, AXIS_Y]], middle = (cos(angle), sin(angle)), random.uniform(-40.0, 40.0, 2)
    row[[X, Y]], row[HALF_EXTENT] = middle, random.uniform(1.0, 30.0)
    if row[IS_ARC]:
        row[RADIUS], row[SIGN] = 10.0 ** random.uniform(0.5, 4.0), random.choice([-1.0, 1.0])
        row[HALF_EXTENT] = min(row[HALF_EXTENT] / row[RADIUS], pi)
        row[[X, Y]] = middle - row[RADIUS] * row[[AXIS_X, AXIS_Y]]
    shape = np.empty(SHAPE_LENGTH)
    write_shape(row, np.array([*middle, 2.0 * row[RADIUS] + 100.0]), 0.0, 0.0, shape)
    return row, shape


def places(row, facing, theta, wave):
    """B (N,) on a whole line or circle in orientations, its derivative by a complex step, and the normal; the level is a
    height, and a multiple of the sine of the orientation and an angle."""
    t = theta + 1e-30j
    c, s = np.cos(t), np.sin(t)
    cx, up = c * row[X] - s * row[Y], wave[0] + wave[1] * np.sin(t + wave[2]) - (s * row[X] + c * row[Y])
    with np.errstate(all="ignore"):
        if row[IS_ARC] == 0.0:
            mx, my = c * row[AXIS_X] - s * row[AXIS_Y], s * row[AXIS_X] + c * row[AXIS_Y]
            along, nx, ny = cx + up / my * mx, my.real, -mx.real
        else:
            dx = facing * row[SIGN] * np.sqrt((row[RADIUS] - up) * (row[RADIUS] + up))
            along, nx, ny = cx + dx, row[SIGN] * dx.real / row[RADIUS], row[SIGN] * up.real / row[RADIUS]
    return along.real, along.imag / 1e-30, nx, ny


def on_its_piece(row, theta, x, y):
    """Whether places (N,) from the part's are between the ends of a piece."""
    c, s = np.cos(theta), np.sin(theta)
    dx, dy = c * x + s * y - row[X], c * y - s * x - row[Y]
    ahead, across = row[AXIS_X] * dx + row[AXIS_Y] * dy, row[AXIS_X] * dy - row[AXIS_Y] * dx
    return np.abs(np.arctan2(across, ahead) if row[IS_ARC] else ahead) <= row[HALF_EXTENT]


@pytest.mark.thorough
@pytest.mark.parametrize("within", [True, False])
def test_bounds_of_a_contact_enclose_it_over_its_range(within):
    """Its place, both derivatives and the tangent of its normal, the level being a wave, wherever it is on the piece."""
    random, seen = np.random.default_rng(5), 0
    for _ in range(1200):
        row, shape = random_shape(random)
        low, width, facing = (
            random.uniform(-4.0, 4.0),
            10.0 ** random.uniform(-6.0, 0.0),
            random.choice([-1.0, 1.0]),
        )
        wave = random.uniform(-30.0, 30.0), random.choice([0.0, 15.0]), random.uniform(-pi, pi)
        thetas = np.linspace(low, low + width, 41)
        b, slope, nx, ny = places(row, facing, thetas, wave)
        step = 1e-5 * np.maximum(np.abs(nx), 1e-9)
        after, before = (places(row, facing, thetas + d, wave)[1] for d in (step, -step))
        k, rise = wave[0] + wave[1] * np.sin(thetas + wave[2]), wave[1] * np.cos(thetas + wave[2])
        there = np.isfinite(b) & (facing * nx > 1e-4)
        if within:
            there &= on_its_piece(row, thetas, b, k)
        intervals = [(float(v.min()), float(v.max())) for v in (k, rise, wave[0] - k)]
        told = compute_contact(shape, (low, low + width), *intervals, facing, within)
        if not there.any():
            continue
        seen += 1
        # Where it is said to be there throughout, it is.
        assert told[0] and (within or not told[1] or (np.isfinite(b) & (facing * nx > 0.0)).all())
        exact = b, slope, (after - before) / (2.0 * step), ny / nx
        for (least, most), values, off in zip(told[2:], exact, (1e-8, 1e-8, 1e-3, 1e-8), strict=True):
            slack = off * (1.0 / np.abs(nx[there]) ** 3 + 1e-4 * np.abs(values[there]))
            assert (values[there] >= least - slack).all() and (values[there] <= most + slack).all()
    assert seen > 150


@pytest.mark.thorough
def test_bounds_of_a_contact_at_one_orientation_are_as_good_as_exact():
    random, seen = np.random.default_rng(6), 0
    for _ in range(200):
        _, shape = random_shape(random)
        theta, k, facing = random.uniform(-4.0, 4.0), random.uniform(-30.0, 30.0), random.choice([-1.0, 1.0])
        told = compute_contact(shape, (theta, theta), (k, k), (0.0, 0.0), (0.0, 0.0), facing, False)
        if told[0] and abs(told[5][0]) < 10.0:
            seen += 1
            assert told[1] and all(high - low < 1e-7 * (1.0 + abs(high)) for low, high in told[2:])
    assert seen > 50


@pytest.mark.thorough
def test_zeros_of_waves_are_those_of_their_polynomial():
    """On the unit circle of complex numbers, with z for exp(i theta)."""
    random = np.random.default_rng(7)
    stack, found, seen = np.empty((DEPTH, 2)), np.empty((64, 2)), 0
    for _ in range(300):
        waves = tuple(random.uniform(-1.0, 1.0, 5) * [1.0, 1.0, 1.0, 0.5, 0.5])
        a0, a1, b1, a2, b2 = waves
        every = np.roots([(a2 - 1j * b2) / 2, (a1 - 1j * b1) / 2, a0, (a1 + 1j * b1) / 2, (a2 + 1j * b2) / 2])
        angles = np.sort(np.angle(every[np.abs(np.abs(every) - 1.0) < 1e-9]))
        count = write_zeros(waves, -pi, pi, stack, found)
        assert np.sort(found[:count, 0]) == pytest.approx(angles, abs=1e-9) and not found[:count, 1].any()
        seen += count
    assert seen > 300
    # One that only touches 0, at 1, is in doubt.
    count = write_zeros((1.0, -cos(1.0), -sin(1.0), 0.0, 0.0), -pi, pi, stack, found)
    assert count and found[:count, 1].all() and found[:count, 0] == pytest.approx(1.0, abs=1e-6)
    assert evaluate_waves((1.0, 2.0, 3.0, 4.0, 5.0), 0.0) == (7.0, 13.0)


def test_what_is_told_of_a_range_keeps_its_roots():
    """Of (t - r)(t - q): not dropped where a root is inside, which stays where it is cut."""
    random, verdicts = np.random.default_rng(8), set()
    for _ in range(500):
        r, q = random.uniform(-1.0, 1.0, 2)
        low, high = np.sort(random.uniform(-1.0, 1.0, 2))
        middle = (low + high) / 2.0
        value, slope = (middle - r) * (middle - q), (2.0 * low - r - q, 2.0 * high - r - q)
        verdict, rest = judge_range((low, high), middle, (value - 1e-15, value + 1e-15), slope)
        inside = [root for root in (r, q) if low <= root <= high]
        assert verdict != NONE if inside else verdict != ROOT
        assert all(rest[0] <= root <= rest[1] for root in inside)
        # Cut only where there is one at most.
        assert len(inside) < 2 or verdict == HALVES
        verdicts.add(verdict)
    assert verdicts >= {NONE, HALVES}
    assert judge_range((1.0, 1.0 + 1e-15), 1.0, (-1e-16, 1e-16), (1.0, 1.0))[0] == ROOT
