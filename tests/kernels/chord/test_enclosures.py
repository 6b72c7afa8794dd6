"""What the kernels tell of their own errors really holds: computed chords against chords at 200 bits."""

from __future__ import annotations

from collections.abc import Callable
from math import asin, cos, hypot, inf, isfinite, pi, sin
from random import Random

import numpy as np
import pytest
from flint import arb
from hypothesis import assume, given
from hypothesis import strategies as st

from chord_examples import (
    KINDS,
    SPECIAL,
    arc_row,
    chord_intervals,
    curve_row,
    is_rounded_coincidence,
    line_row,
    random_ranges,
    touching,
    turn_at,
)
from exact_chords import ExactChord, dot, exact_chord, exact_distance, exactly, minus, within
from strategies import seeds
from workhold.kernels.base.tables import BACKWARD_ERROR, COINCIDENCE
from workhold.kernels.chord.coincidences import (
    CONCENTRIC,
    NONE,
    TOUCHING,
    get_regular_radius,
    is_regular,
)
from workhold.kernels.chord.evaluation import (
    HEIGHT,
    POSITION,
    bound_regular_error,
    compute_chord_state,
    evaluate_curve,
    evaluate_state,
)
from workhold.kernels.curves.piece_bounds import bound_tail_error, compute_tail, enclose_tail, enclose_value

kinds = st.tuples(st.sampled_from(KINDS), st.sampled_from(KINDS))
positions = kinds | st.sampled_from(SPECIAL)
# How near to an end of its range a chord is looked at, as a part of the range: tangencies are ends.
depths = st.floats(0.0, 13.0).map(lambda exponent: 0.5 * 10.0**-exponent)
modes = st.sampled_from([HEIGHT, POSITION])


Place = tuple[np.ndarray, np.ndarray, float, float, float, tuple[float, float]]


def near_an_end(random: Random, position: tuple[str, str] | Callable, depth: float) -> Place:
    """A chord near an end of a range: features, length, direction, branch, and the range.

    Its features are of two kinds, or in a special position. Coincidences within rounding come further down.
    """
    while True:
        if callable(position):
            a, b, d = position(random)
            ranges = chord_intervals(a, b, d)
            ranges = ranges[ranges[:, 1] - ranges[:, 0] > 1e-6]
        else:
            a, b, d, ranges = random_ranges(random, position)
        if len(ranges) and not is_rounded_coincidence(a, b, d):
            break
    low, high, branch, *_ = (float(v) for v in ranges[random.randrange(len(ranges))])
    part = depth if random.random() < 0.5 else 1.0 - depth
    return a, b, d, low + part * (high - low), branch, (low, high)


def directions(random: Random, alpha: arb, reach: float, ends: tuple[float, float]) -> list[arb]:
    """Directions within ``reach`` of alpha, inside a range."""
    parts = (-1.0, -0.4, 0.0, random.uniform(-1, 1), 1.0)
    return [min(max(alpha + arb(reach) * part, arb(ends[0])), arb(ends[1])) for part in parts]


def difference(mode: float, row: np.ndarray, one: float, two: arb) -> arb:
    """How far two values are apart; positions on arcs modulo whole turns."""
    off = arb(one) - two
    if mode == POSITION and row[0] != 0.0:
        turns = round(float(off.mid()) / (2 * pi))
        off = off - 2 * turns * arb.pi()
    return off


def check_discs(exact: ExactChord, discs: list[tuple[float, float, float]], detail: tuple) -> None:
    """The tail of an exact chord lies in every disc (x, y, radius)."""
    for x, y, radius in discs:
        away = minus(exact.tail, (arb(x), arb(y)))
        assert dot(away, away) <= arb(radius) * arb(radius), detail


@pytest.mark.thorough
@given(seeds, positions, depths, modes)
def test_values_and_slopes_are_within_their_errors(seed, position, depth, mode):
    """|value - exact| <= told error, and the same for the slope; where no error is told, a disc holds the value."""
    random = Random(seed)
    for _ in range(20):
        a, b, d, alpha, branch, _ = near_an_end(random, position, depth)
        shift = random.uniform(-pi, pi)
        curve, psi = curve_row(a, b, d, branch, shift), alpha - shift
        value, slope, error, spread = evaluate_curve(a, b, curve, psi, mode)
        with exactly():
            exact = exact_chord(a, b, d, arb(psi) + shift, branch)
            if exact is None:
                assert not isfinite(error)
                continue
            expected = exact.height(arb(psi)) if mode == HEIGHT else exact.position()
            detail = (a.tolist(), b.tolist(), d, psi, branch, shift, mode)
            if isfinite(error):
                assert abs(difference(mode, a, value, expected[0])) <= error, detail
                assert within(slope, expected[1], spread) or spread == inf, detail
            else:
                value, error = enclose_value(a, b, curve, psi, 2e-15, mode)
                assert abs(difference(mode, a, value, expected[0])) <= error, detail


@pytest.mark.thorough
@given(seeds, positions, depths)
def test_computed_contacts_are_off_their_features_by_no_more_than_the_blur(seed, position, depth):
    """The distances of a computed tail and head from the carriers of their features are within the backward error told."""
    random = Random(seed)
    for _ in range(20):
        a, b, d, alpha, branch, _ = near_an_end(random, position, depth)
        shift = random.uniform(-pi, pi)
        curve, psi = curve_row(a, b, d, branch, shift), alpha - shift
        if curve[COINCIDENCE] not in (NONE, CONCENTRIC):
            continue
        ux, uy, *_ = compute_chord_state(a, b, curve, psi, cos(psi), sin(psi))
        with exactly():
            place = arb(psi) + shift
            if exact_chord(a, b, d, place, branch) is None:
                continue
            head = (ux + d * place.cos(), uy + d * place.sin())
            for row, point in ((a, (arb(ux), arb(uy))), (b, head)):
                assert exact_distance(row, point) <= curve[BACKWARD_ERROR], (
                    a.tolist(),
                    b.tolist(),
                    d,
                    psi,
                    shift,
                    branch,
                )


@pytest.mark.parametrize("tail_on_line", [True, False])
@pytest.mark.parametrize("away", [1e-3, 1e-5])
def test_along_a_level_face_the_height_is_known_beside_a_tangency(tail_on_line, away):
    """The chord slides along the face, by an error that grows without bound, and the height does not change."""
    wall, circle, d = line_row(0, 0, 0, 60), arc_row(0, 0, 20), 25.0
    # The head is nearly at the top of the circle, where this runs along the face.
    a, b, alpha = (wall, circle, asin(0.8) - away) if tail_on_line else (circle, wall, asin(0.8) - away - pi)
    curve = curve_row(a, b, d, 1.0)
    state = compute_chord_state(a, b, curve, alpha, cos(alpha), sin(alpha))
    level, turned = (
        evaluate_state(a, b, state, cosine, sine, HEIGHT).error for cosine, sine in ((1.0, 0.0), (0.0, 1.0))
    )
    assert level <= 4.1 * curve[BACKWARD_ERROR] < 0.1 * state.error
    assert turned == state.error


@given(seeds, kinds)
def test_errors_are_small_away_from_tangencies(seed, pair):
    """The bounds are of use: in the middle of things a value is known to 1e-9 mm, and its slope nearly so."""
    random = Random(seed)
    a, b, d, ranges = random_ranges(random, pair, 1e-2)
    low, high, branch, *_ = ranges[0]
    alpha = (low + high) / 2.0
    assume(abs(turn_at(a, b, d, alpha, branch)) > 0.1)
    _, _, error, spread = evaluate_curve(a, b, curve_row(a, b, d, branch, 0.3), alpha - 0.3, HEIGHT)
    assert error < 1e-9
    assert spread < 1e-6


@pytest.mark.thorough
@given(seeds, positions, depths, st.floats(3.0, 16.0).map(lambda exponent: 10.0**-exponent) | st.just(0.0))
def test_tails_are_within_their_radius(seed, position, depth, reach):
    """The exact tail at every direction within ``reach`` lies in the disc told by ``bound_tail_error``, ``compute_tail`` and
    ``enclose_tail``."""
    random = Random(seed)
    for _ in range(20):
        a, b, d, alpha, branch, ends = near_an_end(random, position, depth)
        shift = random.choice([0.0, random.uniform(-pi, pi)])
        curve, psi = curve_row(a, b, d, branch, shift), alpha - shift
        state = compute_chord_state(a, b, curve, psi, cos(psi), sin(psi))
        near = bound_tail_error(curve, state, reach)
        discs = [
            (state[0], state[1], near),
            compute_tail(a, b, curve, psi, cos(psi), sin(psi), reach),
            enclose_tail(a, b, curve, psi, reach),
        ]
        with exactly():
            for place in directions(random, arb(psi) + shift, reach, ends):
                exact = exact_chord(a, b, d, place, branch)
                if exact is None:
                    # Within ``reach`` there is no tangency where a radius is known.
                    assert not isfinite(near)
                    continue
                # Of a chord past the end of its feature only the disc is told.
                inside = a[0] != 0.0 or abs(exact.position()[0]) <= float(a[5])
                detail = (a.tolist(), b.tolist(), d, psi, shift, branch, reach, place)
                check_discs(exact, discs if inside else discs[::2], detail)


@pytest.mark.thorough
@given(seeds, positions, depths, st.floats(2.0, 15.0).map(lambda exponent: 10.0**-exponent), modes)
def test_discs_hold_the_values_of_a_branch(seed, position, depth, reach, mode):
    """|value - exact| <= radius for all directions within ``reach``, tangency or not, which lie on the branch."""
    random = Random(seed)
    for _ in range(20):
        a, b, d, alpha, branch, ends = near_an_end(random, position, depth)
        shift = random.uniform(-pi, pi)
        curve, psi = curve_row(a, b, d, branch, shift), alpha - shift
        value, radius = enclose_value(a, b, curve, psi, reach, mode)
        with exactly():
            for place in directions(random, arb(psi) + shift, reach, ends):
                exact = exact_chord(a, b, d, place, branch)
                if exact is None or not isfinite(radius):
                    continue
                expected = exact.height(place - shift)[0] if mode == HEIGHT else exact.position()[0]
                assert abs(difference(mode, a, value, expected)) <= radius, (
                    a.tolist(),
                    b.tolist(),
                    d,
                    psi,
                    shift,
                    branch,
                )


def coincident(random: Random, off: float) -> tuple[np.ndarray, np.ndarray, float, float]:
    """Features whose chord runs through a coincidence, up to ``off`` mm, and the coincidence's direction."""
    radius, d = random.uniform(2.0, 15.0), random.uniform(4.0, 25.0)
    if random.random() < 0.4:
        a, b, d, turn = touching(random)
        b[1] += off
        return a, b, d, turn
    if random.random() < 0.5:
        # Whole quarters of millimetres: centre to centre is exactly one chord.
        radius, step = random.randint(8, 60) / 4, random.choice([(3, 4), (-4, 3), (5, 12), (8, -15)])
        a = arc_row(1.0, -2.0, radius)
        b = arc_row(1.0 + step[0], -2.0 + step[1], radius)
        d = hypot(*step)
        b[1] += off
        return a, b, d, float(np.arctan2(step[1], step[0]))
    line = line_row(0.5, -3.0, 0.0, 40.0)
    radius, d = random.randint(8, 60) / 4, random.randint(16, 100) / 4
    # The line's normal points down: the arc's centre is d - R beyond it.
    arc = arc_row(2.0, -3.0 - (d - radius) + off, radius)
    if random.random() < 0.5:
        return line, arc, d, -pi / 2
    return arc, line, d, pi / 2


@pytest.mark.thorough
@pytest.mark.parametrize("mode", [HEIGHT, POSITION])
@pytest.mark.parametrize("off", [0.0, 1e-15, 1e-13, 5e-12, 1e-10])
def test_errors_hold_through_a_coincidence(mode, off):
    """The regular formulas near a coincidence tell their errors too: where lengths agree to 1e-11 mm, against the chords of
    a part in which they agree, which is what the search takes the part for."""
    random = Random(7)
    finite = 0
    for _ in range(300):
        state = random.getstate()
        snapped = coincident(random, 0.0)[:2]
        random.setstate(state)
        a, b, d, middle = coincident(random, off)
        gamma = random.choice([1, -1]) * 10.0 ** random.uniform(-9, -0.3)
        alpha, branch, shift = middle + gamma, random.choice([1.0, -1.0]), random.uniform(-pi, pi)
        curve, psi = curve_row(a, b, d, branch, shift), alpha - shift
        value, slope, error, spread = evaluate_curve(a, b, curve, psi, mode)
        if curve[COINCIDENCE] != NONE:
            a, b = snapped
        with exactly():
            exact = exact_chord(a, b, d, arb(psi) + shift, branch)
            if exact is None or not isfinite(error):
                continue
            expected = exact.height(arb(psi)) if mode == HEIGHT else exact.position()
            finite += 1
            detail = (a.tolist(), b.tolist(), d, alpha, branch, shift)
            off_by = abs(difference(mode, a, value, expected[0]))
            assert off_by <= error, ("value", float(off_by), error, gamma, detail)
            assert within(slope, expected[1], spread) or spread == inf, ("slope", gamma, detail)
    assert finite > 30


def test_errors_hold_for_arcs_that_nearly_touch():
    """Where lengths agree to less than counts, the error holds for the chords of the part itself, too, but next to the
    coincidence, where it says nothing of them."""
    random = Random(9)
    checked, needed = 0, 0
    for _ in range(400):
        a, b, d, middle = touching(random)
        b[1] += 3e-13 * random.choice([1, -1])
        gamma = random.choice([1, -1]) * 10.0 ** random.uniform(-5, -2)
        branch = random.choice([1.0, -1.0])
        curve = curve_row(a, b, d, branch, 0.0)
        assert curve[COINCIDENCE] == TOUCHING
        value, _, error, _ = evaluate_curve(a, b, curve, middle + gamma, HEIGHT)
        with exactly():
            exact = exact_chord(a, b, d, arb(middle + gamma), branch)
            if exact is None:
                continue
            off_by = abs(difference(HEIGHT, a, value, exact.height(arb(middle + gamma))[0]))
            checked, needed = checked + 1, needed + bool(off_by > bound_regular_error(curve))
            assert off_by <= error, (float(off_by), error, gamma, a.tolist(), b.tolist(), d)
    assert checked > 300 and needed > 30


@pytest.mark.thorough
@pytest.mark.parametrize("off", [0.0, 1e-13, 5e-12])
def test_tails_hold_through_a_coincidence(off):
    """The exact tail within ``reach`` of an orientation is within the radius told: of the part in which lengths agree near
    the coincidence, where the regular formulas apply, and of the part itself farther off."""
    random = Random(8)
    checked = 0
    for _ in range(600):
        state = random.getstate()
        snapped = coincident(random, 0.0)[:2]
        random.setstate(state)
        a, b, d, middle = coincident(random, off)
        gamma = random.choice([1, -1]) * 10.0 ** random.uniform(-9, 0.4)
        reach = 10.0 ** random.uniform(-15, -2)
        branch, shift = random.choice([1.0, -1.0]), random.uniform(-pi, pi)
        curve, psi = curve_row(a, b, d, branch, shift), middle + gamma - shift
        discs = [
            enclose_tail(a, b, curve, psi, reach),
            compute_tail(a, b, curve, psi, cos(psi), sin(psi), reach),
        ]
        with exactly():
            for part in (-1.0, 0.0, 0.7, 1.0):
                place = arb(psi) + shift + reach * part
                if (gamma > 0) != bool(place - middle > 0):
                    continue
                radius = get_regular_radius(a, b, curve[COINCIDENCE])
                near = is_regular(curve[COINCIDENCE], radius, d, float(place - middle))
                exact = exact_chord(*(snapped if near else (a, b)), d, place, branch)
                if exact is None:
                    continue
                checked += 1
                check_discs(exact, discs, (a.tolist(), b.tolist(), d, psi, shift, branch, reach, gamma))
    assert checked > 500
