"""The ranges over which chords exist are complete and exact."""

from __future__ import annotations

from math import cos, hypot, pi, sin, tau
from random import Random

import numpy as np
import pytest

from chord_examples import (
    PAIRS,
    arc_row,
    chord_intervals,
    line_row,
    off_carrier,
    overshoot,
    random_chord,
    random_ranges,
    solutions,
    touching,
    turn_at,
)
from workhold.kernels.chord.evaluation import compute_chord
from workhold.kernels.chord.intervals import NARROW, share_one_line


def covering(ranges: np.ndarray, alphas: np.ndarray) -> np.ndarray:
    """How many ranges contain each direction."""
    behind = (alphas[:, None] - ranges[:, 0]) % tau
    return (behind <= ranges[:, 1] - ranges[:, 0]).sum(axis=1)


def counts(a, b, d, alphas, slack):
    """How many chords of each direction lie on both features, ends moved out by ``slack`` mm."""
    out = []
    for alpha, tails in zip(alphas, solutions(a, b, d, alphas), strict=True):
        heads = tails + d * np.array([cos(alpha), sin(alpha)])
        out.append(int(((overshoot(a, tails) <= slack) & (overshoot(b, heads) <= slack)).sum()))
    return np.array(out)


@pytest.mark.thorough
@pytest.mark.thinned(9)
@pytest.mark.parametrize("kinds", PAIRS)
def test_ranges_count_the_chords_of_every_direction(kinds):
    """At each direction as many ranges hold as there are solutions of the chord equations inside both features."""
    random = Random(11)
    alive = 0
    for _ in range(40):
        a, b, d = random_chord(random, kinds)
        ranges = chord_intervals(a, b, d)
        alphas = np.arange(80) * tau / 80 + random.random()
        found = covering(ranges, alphas)
        fewest, most = counts(a, b, d, alphas, -1e-6), counts(a, b, d, alphas, 1e-6)
        # Directions beside a tangency have two roots that a rounding may join or part.
        near_tangency = np.zeros(len(alphas), bool)
        for low, high, _, tangent_low, tangent_high in ranges:
            for end, tangent in ((low, tangent_low), (high, tangent_high)):
                if tangent:
                    near_tangency |= np.abs((alphas - end + pi) % tau - pi) < 1e-6
        wrong = ((found < fewest) | (found > most)) & ~near_tangency
        assert not wrong.any(), (list(a), list(b), d, alphas[wrong])
        alive += int(found.sum())
    assert alive > 60


@pytest.mark.thinned(3)
@pytest.mark.parametrize("kinds", PAIRS)
def test_inside_its_range_a_branch_lies_on_both_features(kinds):
    """Every direction of a range gives a chord whose tail and head are on the carriers of their features, ends included,
    and on the features themselves but for the last ``NARROW`` of a range, which may be taken for alive too freely."""
    random = Random(12)
    looked, free = 0, 0
    for _ in range(150):
        a, b, d, ranges = random_ranges(random, kinds)
        for low, high, branch, *_ in ranges:
            for part in (1e-12, 0.01, random.random(), 0.99, 1 - 1e-12):
                alpha = low + part * (high - low)
                c = compute_chord(a, b, d, alpha, branch)
                tail = np.array([c[:2]])
                head = tail + d * np.array([cos(alpha), sin(alpha)])
                assert off_carrier(a, tail) < 1e-9 and off_carrier(b, head) < 1e-9
                on_both = overshoot(a, tail) < 1e-6 and overshoot(b, head) < 1e-6
                assert on_both or not low + NARROW < alpha < high - NARROW
                looked, free = looked + 1, free + (not on_both)
    assert free < 0.005 * looked


@pytest.mark.thorough
def test_arcs_that_touch_leave_out_only_a_sliver():
    """On either side of the coincidence there are as many chords as solutions, and so up to the other tangency."""
    random = Random(15)
    for _ in range(40):
        a, b, d, middle = touching(random)
        ranges = chord_intervals(a, b, d)
        far = np.arange(80) * tau / 80 + random.random()
        assert covering(ranges, far).tolist() == counts(a, b, d, far, 0.0).tolist()
        assert covering(ranges, middle + np.array([1e-11, -1e-11])).tolist() == [2, 2]


def is_mere_cut(ranges, branch, alpha):
    """Whether one range of a branch ends and the next one begins at a direction (a circle has a seam to cut at)."""
    mine = ranges[ranges[:, 2] == branch]
    off = [np.abs((mine[:, k] - alpha + pi) % tau - pi).min() for k in range(2)]
    return max(off) < 1e-9


@pytest.mark.thinned(2)
@pytest.mark.parametrize("kinds", PAIRS)
def test_a_range_ends_at_a_tangency_or_at_an_end_of_a_feature(kinds):
    """X = 0 at ends marked as tangencies; at the others the tail or the head is at an end of its feature.

    Whole circles have no ends: there a range may only be cut in two that follow each other.
    """
    random = Random(13)
    for _ in range(150):
        a, b, d, ranges = random_ranges(random, kinds)
        for low, high, branch, tangent_low, tangent_high in ranges:
            if high - low >= tau - 1e-12:
                continue
            for alpha, tangent in ((low, tangent_low), (high, tangent_high)):
                if tangent:
                    assert abs(turn_at(a, b, d, alpha, branch)) < 1e-5
                elif not (abs(hypot(*(b[1:3] - a[1:3])) - d) < 1e-9 and a[6] == b[6]):
                    c = compute_chord(a, b, d, alpha, branch)
                    tail = np.array([c[:2]])
                    head = tail + d * np.array([cos(alpha), sin(alpha)])
                    at_end = min(abs(overshoot(a, tail)[0]), abs(overshoot(b, head)[0]))
                    # A root of a cosine near 1 is worth half the digits.
                    cut = "circle" in kinds and is_mere_cut(chord_intervals(a, b, d), branch, alpha)
                    assert at_end < 1e-6 or cut, (list(a), list(b), d, alpha)


def test_ranges_of_a_branch_do_not_overlap():
    """0 <= low < high, within two turns, and the ranges of one branch are disjoint on the circle of directions."""
    random = Random(14)
    for kinds in PAIRS:
        for _ in range(100):
            ranges = random_ranges(random, kinds, 0.0)[3]
            assert ((ranges[:, 0] >= 0) & (ranges[:, 0] < 2 * tau)).all()
            assert (ranges[:, 1] > ranges[:, 0]).all()
            assert set(ranges[:, 2]) <= {1.0, -1.0}
            for branch in (1.0, -1.0):
                mine = ranges[ranges[:, 2] == branch]
                assert (mine[:, 1] - mine[:, 0]).sum() <= tau + 1e-9
                for k, row in enumerate(mine):
                    others = np.delete(mine, k, axis=0)
                    assert not covering(others, np.array([(row[0] + row[1]) / 2])).any()


def test_parallel_lines_have_no_curve():
    """Chords between parallel lines fit at two directions only: they are sliding pairs, not ranges."""
    assert len(chord_intervals(line_row(0, 0, 0.3, 10), line_row(1, 5, 0.3, 10), 7.0)) == 0
    assert len(chord_intervals(line_row(0, 0, 0.3, 10), line_row(1, 5, 0.3 + pi, 10), 7.0)) == 0
    assert len(chord_intervals(line_row(0, 0, 0.3, 10), line_row(1, 5, 0.3 + 1e-6, 10), 7.0)) > 0


def test_concentric_circles_turn_all_the_way():
    """Between circles about one point a chord of |R_a - R_b| < d < R_a + R_b exists at every direction, twice."""
    a, b = arc_row(1, 2, 5), arc_row(1, 2, 8)
    for d in (3.5, 7.0, 12.5):
        ranges = chord_intervals(a, b, d)
        assert (covering(ranges, np.linspace(0, 6, 50)) == 2).all()
    for d in (2.5, 13.5):
        assert len(chord_intervals(a, b, d)) == 0
    inside = chord_intervals(a, a, 6.0)
    assert (covering(inside, np.linspace(0, 6, 50)) == 2).all()


@pytest.mark.thorough
def test_equal_circles_one_chord_apart_leave_out_only_a_sliver():
    """Their chord exists at |2 d sin(t / 2)| < 2 R about the coincidence, on either side of it but for 1e-12 rad."""
    radius, d = 5.0, 13.0
    a, b = arc_row(0, 0, radius), arc_row(d, 0, radius)
    widest = 2 * np.arcsin(radius / d)
    ranges = chord_intervals(a, b, d)
    alphas = np.array([1e-11, -1e-11, widest - 1e-6, -widest + 1e-6, widest + 1e-6, -widest - 1e-6, pi])
    assert covering(ranges, alphas).tolist() == [2, 2, 2, 2, 0, 0, 0]


def test_a_circle_that_a_line_just_reaches_keeps_both_sides_of_the_touch():
    """Line y = 0, circle of radius 5 about (0, 15), d = 20: the chord exists on both sides of straight up."""
    for turn in np.linspace(0, 6, 25):
        c, s = cos(turn), sin(turn)
        line, circle = line_row(0, 0, turn, 40), arc_row(-15 * s, 15 * c, 5)
        ranges = chord_intervals(line, circle, 20.0)
        alphas = turn + pi / 2 + np.array([-0.3, -1e-3, 1e-3, 0.3])
        assert covering(ranges, alphas).tolist() == [2, 2, 2, 2]
        assert covering(ranges, np.array([turn + pi / 2 + 2.0])).tolist() == [0]


def test_the_known_range_of_a_ladder():
    """d = 10 with its tail on 0 <= y <= 8 of the wall and its head on 0 <= x <= 9 of the floor: -sin <= 0.8, cos <= 0.9."""
    wall, floor = line_row(0, 4, pi / 2, 4), line_row(4.5, 0, 0, 4.5)
    ((low, high, *_),) = chord_intervals(wall, floor, 10.0)
    assert low == pytest.approx(tau - np.arcsin(0.8)) and high == pytest.approx(tau - np.arccos(0.9))


SQUARE_PAIRS = [
    (
        line_row(0.0, 0.0, 0.3, 20.0),
        line_row(-8.0 * sin(0.3) + 3.0 * cos(0.3), 8.0 * cos(0.3) + 3.0 * sin(0.3), 0.3 + pi, 9.0),
        8.0,
    ),
    (arc_row(1.0, 2.0, 5.0), arc_row(1.0, 2.0, 3.0, 0.4, 1.0, -1.0), 8.0),
    (arc_row(1.0, 2.0, 5.0), arc_row(1.0, 2.0, 3.0, 0.4, 1.0, -1.0), 2.0),
    (arc_row(1.0, 2.0, 5.0), arc_row(1.0, 2.0, 5.0), 10.0),
    (arc_row(0.0, 0.0, 5.0), arc_row(20.0, 0.0, 3.0), 12.0),
    (line_row(0.0, 0.0, 0.0, 20.0), arc_row(2.0, 9.0, 3.0), 6.0),
]


@pytest.mark.parametrize("pair", SQUARE_PAIRS)
def test_pegs_share_one_line_where_they_always_stand_square(pair):
    """They do at their distance, either way round, and not at one that differs by a hair."""
    a, b, d = pair
    assert share_one_line(a, b, d) and share_one_line(b, a, d)
    for hair in (1e-8, -1e-8):
        off = share_one_line(a, b, d + hair)
        # With too short a chord carriers do not even touch.
        assert not off or (hair < 0 and len(chord_intervals(a, b, d + hair)) == 0)
    assert len(chord_intervals(a, b, d)) == 0


def test_pegs_on_other_features_share_no_line():
    """Nor do those nearer to parallel lines than these are apart, which touch one of them at most."""
    low, high = line_row(0.0, 0.0, 0.0, 20.0), line_row(0.0, 8.0, 0.0, 20.0)
    assert share_one_line(low, high, 7.0)
    assert not share_one_line(low, high, 9.0)
    assert not share_one_line(low, line_row(0.0, 8.0, 1e-6, 20.0), 8.0)
    assert not share_one_line(arc_row(0.0, 0.0, 5.0), arc_row(1e-6, 0.0, 5.0), 10.0 - 1e-7)
    assert not share_one_line(low, arc_row(0.0, 8.0, 3.0), 8.0)
