"""Sliding pairs: chords that slide at one orientation."""

from __future__ import annotations

from math import cos, hypot, pi, sin, sqrt
from random import Random

import numpy as np
import pytest

from chord_examples import arc_row, line_row, off_carrier, overshoot, sliding_pairs_between
from workhold.kernels.base.feature import compute_point
from workhold.kernels.base.tables import COLUMN_STEP, HEAD, ROW_STEP, TAIL, SlidingPairs
from workhold.kernels.contact.record import (
    PEG_COLUMN,
    PEG_FEATURE,
    PEG_LENGTH,
    PEG_RADIUS,
    PEG_ROW,
    PEG_X,
    PEG_Y,
)
from workhold.kernels.curves.sliding_pairs import place_pair, place_sliding_pair


def random_sliding_pair(random: Random) -> tuple[np.ndarray, np.ndarray, float]:
    """Two features that may have a sliding pair: parallel lines, or equal arcs one chord apart."""
    x, y, d, angle = (
        random.uniform(-9, 9),
        random.uniform(-9, 9),
        random.uniform(4, 20),
        random.uniform(-pi, pi),
    )
    if random.random() < 0.5:
        a = line_row(x, y, angle, random.uniform(2, 15))
        b = line_row(random.uniform(-9, 9), random.uniform(-9, 9), angle, random.uniform(2, 15))
        if random.random() < 0.5:
            b[3:5] *= -1
        return a, b, d
    x2, y2 = random.uniform(-9, 9), random.uniform(-9, 9)
    radius, halves = random.uniform(1, 9), [random.choice([pi, random.uniform(0.2, 3.1)]) for _ in range(2)]
    a = arc_row(x, y, radius, random.uniform(-pi, pi), halves[0], random.choice([1, -1]))
    b = arc_row(x2, y2, radius, random.uniform(-pi, pi), halves[1], random.choice([1, -1]))
    return a, b, hypot(x2 - x, y2 - y)


def touches(a, b, d, s, alpha, slack):
    """Whether the chord with its tail at parameter s of a touches both features, ends moved out by slack mm."""
    tail = np.array([compute_point(a, s)])
    head = tail + d * np.array([cos(alpha), sin(alpha)])
    on = overshoot(a, tail)[0] <= slack and overshoot(b, head)[0] <= slack
    return on and off_carrier(b, head)[0] < 1e-9


@pytest.mark.thorough
def test_sliding_along_an_sliding_pair_keeps_both_contacts():
    """For every s in [from, to], tail a(s) and head a(s) + d (cos alpha, sin alpha) are on their features."""
    random = Random(21)
    found = 0
    for _ in range(600):
        a, b, d = random_sliding_pair(random)
        for low, high, alpha in sliding_pairs_between(a, b, d):
            found += 1
            for s in np.linspace(low, high, 7):
                assert touches(a, b, d, s, alpha, 1e-9)
    assert found > 300


@pytest.mark.thorough
def test_the_head_of_a_pair_in_place_is_as_far_off_as_it_may_be_turned():
    """Its disc holds the head of a tail at the rim of its own, at each orientation within reach of the pair's."""
    random, pegs = Random(22), np.zeros((2, PEG_LENGTH))
    for _ in range(200):
        a, b, d = random_sliding_pair(random)
        psi, shift, radius = random.uniform(-pi, pi), random.uniform(-pi, pi), 10 ** random.uniform(-9, -3)
        tables = SlidingPairs(np.zeros((1, 7), np.int64), np.array([[-1.0, 1.0, psi + shift, d, psi]]))
        tables.integers[0, [TAIL, HEAD, COLUMN_STEP, ROW_STEP]] = 0, 1, 2, 3
        pair = place_pair(0, tables, np.stack([a, b]))
        assert pair.angle == (psi, cos(psi), sin(psi)) and pair.reach > 0.0
        wide = pair._replace(reach=1e-3, swing=1e-3 * pair.swing / pair.reach)
        place_sliding_pair(pegs, 1.0, 2.0, 4.0, radius, tables.integers[0], wide)
        assert pegs[:, [PEG_FEATURE, PEG_COLUMN, PEG_ROW]].tolist() == [[0.0, 0.0, 4.0], [1.0, 2.0, 7.0]]
        (x, y, off), (head_x, head_y, head_off) = pegs[:, [PEG_X, PEG_Y, PEG_RADIUS]]
        assert (x, y, off) == (1.0, 2.0, radius)
        for turn in (-1e-3, 0.0, 1e-3):
            way = random.uniform(-pi, pi)
            exact = (
                x + radius * cos(way) + d * cos(psi + shift + turn),
                y + radius * sin(way) + d * sin(psi + shift + turn),
            )
            assert hypot(exact[0] - head_x, exact[1] - head_y) <= head_off + 1e-12


@pytest.mark.thorough
def test_sliding_pairs_are_complete():
    """A tail outside all the ranges of a direction has its head off b, and no other direction fits at all."""
    random = Random(22)
    for _ in range(300):
        a, b, d = random_sliding_pair(random)
        ranges = sliding_pairs_between(a, b, d)
        if a[0] == 0.0:
            across = (b[1] - a[1]) * a[4] - (b[2] - a[2]) * a[3]
            if abs(across) >= d:
                assert len(ranges) == 0
                continue
            along = sqrt(d * d - across * across)
            w = [across * np.array([a[4], -a[3]]) + side * along * a[3:5] for side in (1, -1)]
            directions = [np.arctan2(v[1], v[0]) for v in w]
        else:
            directions = [np.arctan2(b[2] - a[2], b[1] - a[1])]
        for alpha in directions:
            mine = [r for r in ranges if abs((r[2] - alpha + pi) % (2 * pi) - pi) < 1e-7]
            for s in np.linspace(-a[5], a[5], 60):
                listed = any(low <= s <= high for low, high, _ in mine)
                near_end = any(min(abs(low - s), abs(high - s)) < 1e-6 for low, high, _ in mine)
                assert near_end or listed == touches(a, b, d, s, alpha, 0.0)


def test_a_chord_square_to_its_lines_is_no_sliding_pair():
    """Both contacts then share one line of action, so they can never be part of a fixture."""
    a, b = line_row(0, 0, 0, 10), line_row(3, 8, pi, 10)
    assert len(sliding_pairs_between(a, b, 8.0)) == 0
    assert len(sliding_pairs_between(a, b, 7.0)) == 0
    assert len(sliding_pairs_between(a, b, 9.0)) == 2


def test_a_line_with_itself_has_the_chord_along_it():
    """Two pegs on one face of length 20, 6 apart, slide over 14 mm in either direction."""
    a = line_row(0, 0, 0, 10)
    ranges = sorted((low, high, cos(alpha)) for low, high, alpha in sliding_pairs_between(a, a, 6.0))
    assert np.array(ranges) == pytest.approx(np.array([[-10, 4, 1], [-4, 10, -1]]))


def test_general_features_have_no_sliding_pair():
    """Lines that are not parallel, a line and an arc, unequal arcs and arcs at another distance do not slide."""
    line, circle = line_row(0, 0, 0, 10), arc_row(10, 0, 4)
    assert len(sliding_pairs_between(line, line_row(0, 5, 1e-6, 10), 8.0)) == 0
    assert len(sliding_pairs_between(line, circle, 8.0)) == 0
    assert len(sliding_pairs_between(arc_row(0, 0, 4.001), circle, 10.0)) == 0
    assert len(sliding_pairs_between(arc_row(0, 0, 4), circle, 10.001)) == 0
    assert len(sliding_pairs_between(arc_row(0, 0, 4), circle, 10.0)) == 1
