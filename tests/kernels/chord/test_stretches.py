"""Stretches cover their curves, and what they tell of the instant centre's motion holds at every direction."""

from __future__ import annotations

from math import inf, pi
from random import Random

import numpy as np
import pytest
from flint import arb
from hypothesis import given

from chord_examples import (
    SPECIAL,
    any_ranges,
    chord_intervals,
    curve_row,
    is_rounded_coincidence,
    random_ranges,
    turn_at,
)
from exact_chords import cross, dot, exact_chord, exact_speed, exactly
from strategies import seeds
from workhold.kernels.base.tables import BRANCH, COINCIDENCE, FROM, LENGTH, TO
from workhold.kernels.chord.coincidences import NONE
from workhold.kernels.chord.stretches import (
    ALONG_HIGH,
    ALONG_LOW,
    DEPTH,
    LARGEST_CROSS,
    LEAST_CUBE,
    PART_A,
    PART_B,
    PARTS,
    SPEED,
    STRETCH_HIGH,
    STRETCH_LENGTH,
    X_HIGH,
    X_LOW,
    Y_HIGH,
    Y_LOW,
    add_stretches,
    enclose_center_motion,
    enclose_turn,
    write_stretch,
)

# The step of a central difference is not exact.
EXACT_TO = 1e-15


def stretches_of(a, b, curve) -> tuple[np.ndarray, np.ndarray]:
    """Where the stretches of a curve begin, and the stretches: each where the one before it ends, parts likewise."""
    out = np.empty((4096, STRETCH_LENGTH))
    count = add_stretches(out, 0, a, b, curve, np.empty(DEPTH))
    assert add_stretches(out[: count - 1], 0, a, b, curve, np.empty(DEPTH)) == -1
    lows, at, k = np.empty(count), curve[FROM], 0
    while k < count:
        after = k + 1 + int(out[k, PARTS])
        lows[k : k + 2] = at
        lows[k + 2 : after] = out[k + 1 : after - 1, STRETCH_HIGH]
        at, k = out[k, STRETCH_HIGH], after
    return lows, out[:count]


def curves_of(a, b, d, ranges) -> list[np.ndarray]:
    """Rows of the curve table of all ranges."""
    return [curve_row(a, b, d, row[2], 0.0, tuple(row[:2]), tuple(row[3:5])) for row in ranges]


def places(random: Random, low: float, high: float) -> list[float]:
    """Directions across a range, both ends among them."""
    inner = [low + (high - low) * part for part in (1e-6, 0.1, random.random(), 0.9, 1 - 1e-6)]
    return [low, *(min(max(place, low), high) for place in inner), high]


def exceeds(value: arb, low: float, high: float) -> bool:
    """Whether a number is certainly outside a range, by more than the check's own rounding."""
    slack = abs(value) * EXACT_TO
    return bool(value + slack < low) or bool(value - slack > high)


def check_stretch(a, b, curve, low, row, random: Random) -> int:
    """Hold everything a stretch tells against exact chords inside it; return how many there were."""
    d, branch = float(curve[LENGTH]), float(curve[BRANCH])
    detail = (a.tolist(), b.tolist(), d, branch, low, row.tolist())
    checked = 0
    with exactly():
        for alpha in places(random, float(low), float(row[STRETCH_HIGH])):
            chord, speed = exact_chord(a, b, d, arb(alpha), branch), exact_speed(a, b, d, arb(alpha), branch)
            if chord is None or speed is None or not chord.turn() ** 2 > 0:
                continue
            checked += 1
            size = dot(speed, speed).sqrt()
            if row[SPEED] < inf:
                assert not exceeds(size, -1.0, row[SPEED]), ("speed", alpha, detail)
            # Near a coincidence it is P' itself that is enclosed.
            regular = curve[COINCIDENCE] != NONE and row[LARGEST_CROSS] == 1.0 and row[LEAST_CUBE] == 1.0
            turn = arb(1) if regular else chord.turn()
            assert row[LARGEST_CROSS] != 0.0 and bool(turn * row[LARGEST_CROSS] > 0), ("sign", alpha, detail)
            assert not exceeds(abs(turn), 0.0, abs(row[LARGEST_CROSS])), ("turn", alpha, detail)
            cube = turn**3
            assert not exceeds(abs(cube), row[LEAST_CUBE], inf), ("cube", alpha, detail)
            assert not exceeds(cube * speed[0], row[X_LOW], row[X_HIGH]), ("x", alpha, detail)
            assert not exceeds(cube * speed[1], row[Y_LOW], row[Y_HIGH]), ("y", alpha, detail)
            if regular:
                continue
            along = dot(speed, chord.along_a)
            assert not exceeds(cube * along, row[ALONG_LOW], row[ALONG_HIGH]), ("along", alpha, detail)
            if row[PART_A] < inf:
                # P' = one r_a - two r_b.
                one = cross(speed, chord.along_b) / chord.turn()
                two = cross(speed, chord.along_a) / chord.turn()
                assert not exceeds(abs(cube * one), 0.0, row[PART_A]), ("part a", alpha, detail)
                assert not exceeds(abs(cube * two), 0.0, row[PART_B]), ("part b", alpha, detail)
    return checked


@pytest.mark.thorough
@given(seeds)
def test_what_stretches_tell_holds_at_every_direction(seed):
    """|P'| <= SPEED, X^3 P' in its box, X^3 P' . r_a, |X|, |X|^3 and the parts of X^3 P' along r_a and r_b."""
    random = Random(seed)
    a, b, d, ranges = any_ranges(random)
    for curve in curves_of(a, b, d, ranges):
        lows, rows = stretches_of(a, b, curve)
        chosen = set(random.sample(range(len(rows)), min(6, len(rows)))) | {0, len(rows) - 1}
        for k in chosen | set(np.flatnonzero(rows[:, PARTS]).tolist()):
            check_stretch(a, b, curve, lows[k], rows[k], random)


@pytest.mark.thorough
@pytest.mark.thinned(5)
@pytest.mark.parametrize("make", SPECIAL)
def test_what_stretches_tell_holds_in_special_positions(make):
    """The same for every kind of special position, all stretches, those that divide others included."""
    random, checked = Random(51), 0
    while checked < 600:
        a, b, d = make(random)
        if is_rounded_coincidence(a, b, d):
            continue
        for curve in curves_of(a, b, d, chord_intervals(a, b, d)):
            if curve[TO] - curve[FROM] > 1e-9:
                stretches = zip(*stretches_of(a, b, curve), strict=True)
                checked += sum(check_stretch(a, b, curve, low, row, random) for low, row in stretches)


@pytest.mark.thorough
@given(seeds)
def test_stretches_follow_each_other_without_a_gap(seed):
    """The stretches of a curve begin at its low end, go on where the one before ends, and end at its high end; so do the
    parts of a stretch. Each tells just what is written of the range from there."""
    a, b, d, ranges = any_ranges(Random(seed), 1e-12)
    for curve in curves_of(a, b, d, ranges):
        lows, rows = stretches_of(a, b, curve)
        sign = 1.0 if turn_at(a, b, d, (curve[FROM] + curve[TO]) / 2, curve[BRANCH]) > 0.0 else -1.0
        told = np.empty(STRETCH_LENGTH)
        for low, row in zip(lows, rows, strict=True):
            assert low < row[STRETCH_HIGH]
            write_stretch(told, a, b, curve, low, row[STRETCH_HIGH], sign)
            told[PARTS] = row[PARTS]
            assert np.array_equal(told, row, equal_nan=True)
        k = 0
        while k < len(rows):
            parts = rows[k + 1 : k + 1 + int(rows[k, PARTS])]
            assert not parts[:, PARTS].any()
            assert len(parts) == 0 or parts[-1, STRETCH_HIGH] == rows[k, STRETCH_HIGH]
            at = rows[k, STRETCH_HIGH]
            k += len(parts) + 1
        assert at == curve[TO]


@pytest.mark.thorough
@given(seeds)
def test_stretches_tell_something(seed):
    """Away from the ends of a curve the speed is bounded, and by no more than a hundredfold of what it is."""
    random = Random(seed)
    a, b, d, ranges = random_ranges(random, ("line", "arc"), 1e-2)
    for curve in curves_of(a, b, d, ranges):
        lows, rows = stretches_of(a, b, curve)
        inside = (lows >= curve[FROM] + 1e-2) & (rows[:, STRETCH_HIGH] <= curve[TO] - 1e-2)
        for low, row in zip(lows[inside], rows[inside], strict=True):
            with exactly():
                speeds = [
                    exact_speed(a, b, d, arb(float(low + part * (row[STRETCH_HIGH] - low))), curve[BRANCH])
                    for part in (0.0, 0.5, 1.0)
                ]
                most = max(float(dot(speed, speed).sqrt()) for speed in speeds if speed is not None)
            assert row[SPEED] <= 100 * (most + 2 * d / (row[STRETCH_HIGH] - low))


@pytest.mark.thorough
@given(seeds)
def test_the_size_of_the_turn_is_enclosed_over_any_range(seed):
    """|X| by the sides of a triangle, and X^3 P' over ranges of any width down to rounding, next to the ends too."""
    random = Random(seed)
    for _ in range(4):
        a, b, d, ranges = any_ranges(random)
        first, last, branch, *_ = (float(v) for v in ranges[random.randrange(len(ranges))])
        width = (last - first) * 10 ** random.uniform(-13, 0)
        depth = (last - first) * 10 ** random.uniform(-12, 0)
        low = min(first + depth, last) if random.random() < 0.5 else max(last - depth - width, first)
        high = min(low + width, last)
        curve = curve_row(a, b, d, branch)
        if low > high or curve[COINCIDENCE] != NONE:
            continue
        turns = enclose_turn(a, b, d, low, high)
        sign = 1.0 if turn_at(a, b, d, (first + last) / 2, branch) > 0 else -1.0
        turn, x, y, along, _, _ = enclose_center_motion(a, b, curve, low, high, sign)
        with exactly():
            for alpha in places(random, low, high):
                chord, speed = (
                    exact_chord(a, b, d, arb(alpha), branch),
                    exact_speed(a, b, d, arb(alpha), branch),
                )
                if chord is None or speed is None:
                    continue
                detail = (a.tolist(), b.tolist(), d, branch, low, high, alpha)
                size, cube = chord.turn(), chord.turn() ** 3
                assert not exceeds(abs(size), *turns), ("size", detail)
                assert not exceeds(size, *turn), ("turn", detail)
                for value, bounds in zip((*speed, dot(speed, chord.along_a)), (x, y, along), strict=True):
                    assert not exceeds(cube * value, *bounds), ("motion", detail)


def test_the_speed_between_square_lines_is_known():
    """A ladder of length d on the axes: P = (d cos alpha, -d sin alpha) from the corner, so |P'| = d and X = 1."""
    wall, floor = np.array([0, 0, 0, 0, 1, 50, 0, 1.0]), np.array([0, 0, 0, 1, 0, 50, 0, 1.0])
    curve = curve_row(wall, floor, 10.0, 1.0, 0.0, (0.2, pi / 2 - 0.2))
    for row in stretches_of(wall, floor, curve)[1]:
        assert 10.0 <= row[SPEED] < 15.0
        assert abs(row[LARGEST_CROSS]) == pytest.approx(1.0)
