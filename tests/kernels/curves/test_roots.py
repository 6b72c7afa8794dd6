"""Crossings of two curves are all found, and lie where they are told to lie."""

from __future__ import annotations

from math import asin, atan2, cos, pi, sin, tau
from random import Random

import numpy as np
import pytest
from flint import arb

from chord_examples import arc_row, line_row
from curve_examples import HEIGHT, POSITION, cross, lattice, pieces_of, random_table, sampled
from exact_chords import exact_chord, exactly
from sharpness import changed
from strategies import random_row
from workhold.contact.curves import make_curve_table
from workhold.kernels.base.tables import (
    BRANCH,
    CURVE,
    HEAD,
    HIGH,
    LENGTH,
    LOW,
    SHIFT,
    SLOPE_LOW,
    STEADY,
    TAIL,
    VALUE_LOW,
)
from workhold.kernels.chord.coincidences import NONE, find_coincidence
from workhold.kernels.curves.piece_bounds import enclose_value
from workhold.kernels.curves.roots import (
    MULTIPLE,
    ROOT_PSI,
    ROOT_RADIUS,
    evaluate_point,
    write_crossings,
    write_monotone_roots,
    write_roots_of_span,
)


def sample_places(low: float, high: float, count: int) -> np.ndarray:
    """Orientations across a range, dense towards both ends, where slopes may be infinite."""
    inner = np.linspace(0.0, 1.0, count)[1:-1]
    ends = np.geomspace(1e-9, 1e-2, 200)
    return low + (high - low) * np.unique(np.concatenate([inner, ends, 1 - ends]))


def check_pair(features, table, first, second, mode, offset, period, samples) -> int:
    """Compare the roots of two pieces with the sign changes of a dense sampling; return the number of roots.

    A root stands for the orientations within its radius, and several may stand for the same one: a target in doubt counts as
    taken. So each sign change must lie in such a range, with the right multiple; a root of a small radius must have a small
    rest; and apart from doubtful ones there are no more roots than two beyond the sign changes (a double root).
    """
    roots = cross(first, second, features, table, mode, offset, period)
    low, high = max(first[LOW], second[LOW]), min(first[HIGH], second[HIGH])
    if high - low < 1e-6:
        return 0
    psis = sample_places(low, high, samples)
    values = [sampled(psis, int(piece[CURVE]), features, table.curves, mode) for piece in (first, second)]
    tail = features[table.curves.integers[int(first[CURVE]), TAIL]]
    circle = mode == POSITION and tail[0] != 0.0 and tail[5] >= pi
    f = values[1][:, 0] - values[0][:, 0] - offset
    if circle:
        f = np.unwrap(f)
    if mode == POSITION and period == 0.0:
        levels = (f > 0).astype(int)
    else:
        levels = np.floor(f / period).astype(int)
    scale = period or 1.0
    doubt = np.maximum(1e-9, (values[0][:, 2] + values[1][:, 2]) / scale)
    near = np.abs(f / scale - np.round(f / scale)) < doubt
    jumps = np.abs(np.diff(levels))
    # Roots of one target that touch are one; the others are counted in the gap between samples that holds their middle.
    apart = merged_roots(roots)
    counted = np.histogram(apart[:, ROOT_PSI], bins=np.concatenate([[-np.inf], psis, [np.inf]]))[0][1:-1]
    exact = apart[:, ROOT_RADIUS] < 1e-9
    vague = np.zeros(len(jumps), bool)
    for psi, radius, _ in apart[~exact]:
        vague |= (psis[1:] >= psi - radius) & (psis[:-1] <= psi + radius)
    doubtful = near[1:] | near[:-1] | vague
    detail = (
        features.tolist(),
        table.curves.integers[[int(first[CURVE]), int(second[CURVE])]].tolist(),
        low,
        high,
        offset,
    )
    for k in np.flatnonzero(jumps):
        reached = (roots[:, ROOT_PSI] + roots[:, ROOT_RADIUS] >= psis[k]) & (
            roots[:, ROOT_PSI] - roots[:, ROOT_RADIUS] <= psis[k + 1]
        )
        if circle or period == 0.0:
            assert reached.any(), ("lost", detail)
        else:
            crossed = set(range(min(levels[k : k + 2]) + 1, max(levels[k : k + 2]) + 1))
            assert crossed <= set(roots[reached, MULTIPLE].astype(int)), ("lost", detail)
    assert (counted[~doubtful] >= jumps[~doubtful]).all(), ("lost", detail)
    assert ((counted - jumps)[~doubtful] % 2 == 0).all(), ("wrong parity", detail)
    assert ((counted - jumps)[~doubtful] <= 2).all(), ("too many", detail)
    for root, radius, multiple in roots:
        assert low <= root <= high and 0.0 < radius <= high - low
        pair = [
            sampled(np.array([root]), int(p[CURVE]), features, table.curves, mode)[0] for p in (first, second)
        ]
        rest = pair[1][0] - pair[0][0] - offset
        assert circle or abs(rest / scale - multiple) < 0.5
        rest -= period * round(rest / period) if period else 0.0
        steep = abs(pair[0][1]) + abs(pair[1][1])
        rough = pair[0][2] + pair[1][2]
        if first[STEADY] * second[STEADY] == 0.0:
            # Beside a tangency what is told is that the discs of both chords leave it in doubt.
            rough = max(
                rough, 2 * sum(disc_size(p, root, radius, features, table, mode) for p in (first, second))
            )
        if radius < 1e-9:
            assert abs(rest) < 1e-9 + 1e-14 * min(steep, 1e9) + rough + 2 * steep * radius, (
                "no root",
                root,
                rest,
                detail,
            )
    return len(apart)


def disc_size(piece, psi: float, reach: float, features, table, mode: float) -> float:
    """How far the values of a piece's curve within ``reach`` of an orientation may be from a middle one."""
    curve = int(piece[CURVE])
    a, b = (features[k] for k in table.curves.integers[curve, [TAIL, HEAD]])
    return enclose_value(a, b, table.curves.reals[curve], psi, reach, mode)[1]


def merged_roots(roots: np.ndarray) -> np.ndarray:
    """Roots of one target whose ranges touch, put together."""
    out: list[np.ndarray] = []
    for root in roots[np.lexsort([roots[:, ROOT_PSI], roots[:, MULTIPLE]])]:
        last = out[-1] if out else None
        same = last is not None and last[MULTIPLE] == root[MULTIPLE]
        if same and root[ROOT_PSI] - root[ROOT_RADIUS] <= last[ROOT_PSI] + last[ROOT_RADIUS] + 1e-13:
            low, high = (
                min(last[ROOT_PSI] - last[ROOT_RADIUS], root[ROOT_PSI] - root[ROOT_RADIUS]),
                root[ROOT_PSI] + root[ROOT_RADIUS],
            )
            high = max(high, last[ROOT_PSI] + last[ROOT_RADIUS])
            last[ROOT_PSI], last[ROOT_RADIUS] = (low + high) / 2, (high - low) / 2
            continue
        out.append(root.copy())
    return np.array(out).reshape(-1, 3)


def overlapping(random: Random, pieces: np.ndarray, most: int, least: float = 1e-6) -> list[tuple[int, int]]:
    """Pairs of pieces of different curves with a common range of orientations wider than ``least``, at most so many."""
    low, high, curve = pieces[:, LOW], pieces[:, HIGH], pieces[:, CURVE]
    common = np.minimum(high[:, None], high) - np.maximum(low[:, None], low)
    pairs = np.argwhere((common > least) & (curve[:, None] < curve))
    return [tuple(pairs[k]) for k in random.sample(range(len(pairs)), min(most, len(pairs)))]


@pytest.mark.thorough
def test_heights_cross_wherever_a_dense_sampling_changes_sign():
    """Every k with h_B - h_A = offset + k period between two samples is found between them, none twice, residual < 1e-9."""
    random = Random(41)
    total = 0
    for _ in range(25):
        features, table = random_table(random)
        low = random.uniform(-4, 4)
        pieces = pieces_of(features, table, low, low + random.choice([0.03, 0.3, 2.0]), HEIGHT)
        period = random.uniform(0.5, 4)
        for i, j in overlapping(random, pieces, 40):
            offset = random.uniform(-5, 5)
            total += check_pair(features, table, pieces[i], pieces[j], HEIGHT, offset, period, 300)
    assert total > 100


@pytest.mark.thorough
def test_some_pairs_of_heights_against_a_hundred_thousand_samples():
    """The same, with samples so dense that hardly two roots share a gap."""
    random = Random(101)
    total = 0
    for _ in range(6):
        features, table = random_table(random)
        pieces = pieces_of(features, table, -2.0, 2.0, HEIGHT)
        for i, j in overlapping(random, pieces, 3):
            total += check_pair(features, table, pieces[i], pieces[j], HEIGHT, 0.0, 0.1, 100_000)
    assert total > 30


@pytest.mark.thorough
@pytest.mark.parametrize("circles", [False, True])
def test_positions_on_a_shared_tail_cross_wherever_a_dense_sampling_changes_sign(circles):
    """Two chords share their tail where s_A = s_B (modulo 2 pi on a whole circle, also across the circle's seam)."""
    random = Random(42)
    total = 0
    for _ in range(60):
        features, table = random_table(random, first="circle" if circles else "arc")
        whole = (features[:, 0] != 0.0) & (features[:, 5] >= pi)
        low = random.uniform(-4, 4)
        pieces = pieces_of(features, table, low, low + random.choice([0.03, 0.3, 1.0]), POSITION)
        tails = table.curves.integers[pieces[:, CURVE].astype(int), TAIL]
        for tail in np.flatnonzero(whole == circles):
            mine = pieces[tails == tail]
            for i, j in overlapping(random, mine, 40):
                period = tau if circles else 0.0
                total += check_pair(features, table, mine[i], mine[j], POSITION, 0.0, period, 400)
    assert total > 30


def shared_tails(features, steps, low: float, high: float) -> set[tuple[float, float]]:
    """(direction from the centre, psi) of all tails on feature 0, a circle, that two chords share."""
    table = make_curve_table(features, steps, [0])
    pieces = pieces_of(features, table, low, high, POSITION)
    start = atan2(features[0, 4], features[0, 3])
    found = set()
    for i, j in overlapping(Random(0), pieces, 10**6, 0.0):
        if integers_agree(table, int(pieces[i, CURVE]), int(pieces[j, CURVE])):
            continue
        for root in cross(pieces[i], pieces[j], features, table, POSITION, 0.0, tau)[:, ROOT_PSI]:
            value = sampled(np.array([root]), int(pieces[i, CURVE]), features, table.curves, POSITION)
            found.add((round((value[0, 0] + start) % tau, 6), round(root, 6)))
    return found


@pytest.mark.thorough
def test_shared_tails_do_not_depend_on_where_a_circle_has_its_seam():
    """Turning the parameter of a whole circle changes no contact: the roots are the same points at the same psi."""
    random = Random(43)
    for _ in range(6):
        features = np.array([random_row(random, kind) for kind in ("circle", "arc", "circle")])
        steps, low = lattice(random.uniform(8, 14), 2, 2), random.uniform(-4, 4)
        first = shared_tails(features, steps, low, low + 0.3)
        for place, _ in sorted(first)[:5]:
            seam = place + pi + 1e-3
            features[0, 3:5] = cos(seam), sin(seam)
            again = shared_tails(features, steps, low, low + 0.3)
            for one, other in ((first, again), (again, first)):
                for s, psi in one:
                    assert any(
                        abs((s - t + pi) % tau - pi) < 1e-5 and abs(psi - phi) < 1e-5 for t, phi in other
                    ), f"tail at {s}, psi {psi} is found with one seam only"


@pytest.mark.thorough
def test_a_crossing_at_a_tangency_is_found():
    """Where two branches begin, at a tangency, with exactly the height of another chord, a root is found there."""
    random = Random(44)
    seen = 0
    for _ in range(12):
        features, table = random_table(random)
        pieces = pieces_of(features, table, -2.0, 2.0, HEIGHT)
        for piece in pieces[np.isinf(pieces[:, SLOPE_LOW])][:4]:
            psi, curve = piece[LOW], int(piece[CURVE])
            for other in pieces[
                (pieces[:, LOW] < psi) & (pieces[:, HIGH] > psi) & (pieces[:, CURVE] != curve)
            ][:6]:
                if integers_agree(table, curve, int(other[CURVE])):
                    continue
                there = sampled(np.array([psi]), int(other[CURVE]), features, table.curves, HEIGHT)
                roots = cross(piece, other, features, table, HEIGHT, there[0, 0] - piece[VALUE_LOW], 0.0)
                assert len(roots) and (abs(roots[:, ROOT_PSI] - psi) <= roots[:, ROOT_RADIUS] + 1e-9).any()
                seen += 1
    assert seen > 20


def integers_agree(table, one: int, two: int) -> bool:
    """Whether two curves are branches of one chord."""
    return bool((table.curves.integers[one, :4] == table.curves.integers[two, :4]).all())


def test_known_crossings_of_two_ladders():
    """h = -d sin a cos a on square lines, d = 5 and d = 10 along x: they differ by 5/2 sin 2 psi, so by 2 at four angles."""
    features = np.array([line_row(0, 0, pi / 2, 40), line_row(0, 0, 0, 40)])
    steps = lattice(5.0, 3, 1)
    table = make_curve_table(features, steps, [0])
    pick = [
        int(np.flatnonzero((table.curves.integers[:, :4] == [0, 1, columns, 0]).all(axis=1))[0])
        for columns in (1, 2)
    ]
    pieces = pieces_of(features, table, -0.1, 6.1, HEIGHT)
    roots = []
    for a in pieces[pieces[:, CURVE] == pick[0]]:
        for b in pieces[pieces[:, CURVE] == pick[1]]:
            roots += merged_roots(cross(a, b, features, table, HEIGHT, 2.0, 0.0)).tolist()
    half = asin(-0.8) / 2
    expected = sorted(x % pi + k * pi for x in (half, pi / 2 - half) for k in (0, 1))
    assert sorted(root[ROOT_PSI] for root in roots) == pytest.approx(expected, abs=1e-12)
    assert max(root[ROOT_RADIUS] for root in roots) < 1e-11


def test_curves_on_top_of_each_other_are_told_as_ranges_and_not_given_up():
    """Two chords with the same height everywhere meet at every orientation: the roots told cover the whole common range."""
    line, arc = line_row(0, 0, 0, 40), arc_row(0, 15, 10, 0.0, 3.0)
    features = np.array([line, arc, arc])
    table = make_curve_table(features, lattice(12.0, 1, 1), [0])
    pieces = pieces_of(features, table, 0.95, 0.95 + 2e-6, HEIGHT)
    heads = table.curves.integers[pieces[:, CURVE].astype(int)]
    branch = table.curves.reals[pieces[:, CURVE].astype(int), 2]
    seen = 0
    for i in np.flatnonzero(heads[:, 1] == 1):
        for j in np.flatnonzero((heads[:, 1] == 2) & (heads[:, 3] == heads[i, 3]) & (branch == branch[i])):
            low, high = max(pieces[i, LOW], pieces[j, LOW]), min(pieces[i, HIGH], pieces[j, HIGH])
            if high > low:
                roots = merged_roots(cross(pieces[i], pieces[j], features, table, HEIGHT, 0.0, 12.0))
                assert len(roots) == 1 and roots[0, MULTIPLE] == 0
                assert abs(roots[0, ROOT_PSI] - (low + high) / 2) < 1e-12
                assert roots[0, ROOT_RADIUS] >= (high - low) / 2 * (1 - 1e-9)
                seen += 1
    assert seen > 0


@pytest.mark.thorough
def test_the_exact_root_is_within_the_radius():
    """f - target, by 200 bits, has opposite signs at both ends of a root's range, if the root is simple; double roots of a
    whole range are told from them by their radius."""
    random = Random(45)
    simple = 0
    for _ in range(40):
        features, table = random_table(random)
        pieces = pieces_of(features, table, -2.0, 2.0, HEIGHT)
        period = random.uniform(0.5, 4)
        for i, j in overlapping(random, pieces, 25):
            curves = [int(pieces[k, CURVE]) for k in (i, j)]
            if any(is_coincident(features, table, curve) for curve in curves):
                continue
            # Rounding of a far target counts too.
            offset = random.uniform(-5, 5) * random.choice([1.0, 1e5])
            low, high = max(pieces[i, LOW], pieces[j, LOW]), min(pieces[i, HIGH], pieces[j, HIGH])
            for psi, radius, multiple in cross(pieces[i], pieces[j], features, table, HEIGHT, offset, period):
                if radius > 1e-9 or psi - radius <= low or psi + radius >= high:
                    continue
                with exactly():
                    target = arb(offset) + arb(float(multiple)) * period
                    ends = [
                        exact_difference(features, table, curves, arb(float(psi)) + side * float(radius))
                        for side in (-1, 1)
                    ]
                    if None in ends:
                        continue
                    assert (ends[0] - target) * (ends[1] - target) < 0, (
                        features.tolist(),
                        curves,
                        psi,
                        radius,
                        multiple,
                    )
                simple += 1
    assert simple > 100


def is_coincident(features, table, curve: int) -> bool:
    """Whether a curve's chord is at a coincidence, taken as exact when it is so within rounding."""
    a, b = (features[k] for k in table.curves.integers[curve, [TAIL, HEAD]])
    return bool(find_coincidence(a, b, float(table.curves.reals[curve, LENGTH]))[0] != NONE)


def exact_difference(features, table, curves: list[int], psi: arb) -> arb | None:
    """Height of the second curve less that of the first."""
    heights = []
    for curve in curves:
        a, b = (features[k] for k in table.curves.integers[curve, [TAIL, HEAD]])
        d, branch, shift = (float(table.curves.reals[curve, k]) for k in (LENGTH, BRANCH, SHIFT))
        chord = exact_chord(a, b, d, psi + shift, branch)
        if chord is None:
            return None
        heights.append(chord.height(psi)[0])
    return heights[1] - heights[0]


@pytest.mark.parametrize("rest", [0.0, 1e-30, 1e-14, 1e-12, -1e-30, -1e-14, -1e-11, 1e-6, -1e-6])
def test_planted_double_roots_are_told(rest):
    """The ladders' difference 5/2 sin 2 psi touches its largest value 5/2 at pi / 4: a target there, or less than it by a
    rest, is met within the ranges told; one above it by far more than rounding is not told at all."""
    features = np.array([line_row(0, 0, pi / 2, 40), line_row(0, 0, 0, 40)])
    table = make_curve_table(features, lattice(5.0, 3, 1), [0])
    pick = [
        int(np.flatnonzero((table.curves.integers[:, :4] == [0, 1, columns, 0]).all(axis=1))[0])
        for columns in (1, 2)
    ]
    # The height of the second over the first is -5/2 sin 2 psi: least where sin 2 psi = 1.
    pieces = pieces_of(features, table, 0.5, 1.1, HEIGHT)
    roots = np.concatenate(
        [
            cross(a, b, features, table, HEIGHT, -2.5 + rest, 0.0)
            for a in pieces[pieces[:, CURVE] == pick[0]]
            for b in pieces[pieces[:, CURVE] == pick[1]]
        ]
    )
    if rest <= -1e-11:
        assert len(roots) == 0
        return
    if rest < 0:
        return
    away = float(np.sqrt(rest / 5)) if rest else 0.0
    for psi in (pi / 4 - away, pi / 4 + away):
        assert (np.abs(roots[:, ROOT_PSI] - psi) <= roots[:, ROOT_RADIUS] + 1e-15).any()
    assert (np.abs(roots[:, ROOT_PSI] - pi / 4) <= away + 1e-6).all()


@pytest.mark.thorough
def test_a_root_s_radius_holds_wherever_newtons_method_stops():
    """Told at the first guess, without a single Newton step, a root is as far from the exact one as its value is from the
    target over the slope between them, which may be the least slope of the range: the radius allows for that. Some come
    within a half of it, so that a radius over any steeper slope would not do."""
    random, worst = Random(46), 0.0

    def first_guess(low, high, f_low, f_high, one, two, features, curves, mode, target, start):
        psi = min(max(low + 0.1 * (high - low), low), high) if random.random() < 0.5 else start
        value_one, value_two = (
            evaluate_point(psi, cos(psi), sin(psi), curve, features, curves, mode).value
            for curve in (one, two)
        )
        return psi, abs(value_two - value_one - target)

    monotone = changed(write_monotone_roots, solve_for_target=first_guess)
    early = changed(
        write_crossings, write_roots_of_span=changed(write_roots_of_span, write_monotone_roots=monotone)
    )
    for _ in range(60):
        features, table = random_table(random)
        low = random.uniform(-4, 4)
        pieces = pieces_of(features, table, low, low + 1.0, HEIGHT)
        for i, j in overlapping(random, pieces[pieces[:, STEADY] == 1.0], 12, 1e-2):
            pair = [pieces[pieces[:, STEADY] == 1.0][k] for k in (i, j)]
            found = cross(*pair, features, table, HEIGHT, 0.3, 2.0)
            stopped = cross(*pair, features, table, HEIGHT, 0.3, 2.0, kernel=early)
            assert len(found) == len(stopped) and (found[:, MULTIPLE] == stopped[:, MULTIPLE]).all()
            off, radius = (
                np.abs(found[:, ROOT_PSI] - stopped[:, ROOT_PSI]),
                stopped[:, ROOT_RADIUS] + found[:, ROOT_RADIUS],
            )
            assert (off <= radius).all()
            worst = max(worst, (off / radius)[found[:, ROOT_RADIUS] < 1e-9].max(initial=0.0))
    assert worst > 0.5
