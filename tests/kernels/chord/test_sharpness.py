"""The constants in the errors of chords are needed: a tenth of each lets an exact chord out. See ``sharpness``."""

from __future__ import annotations

from collections.abc import Callable
from math import acos, asin, atan2, cos, hypot, inf, isfinite, pi, sin
from random import Random
from typing import Any

import numpy as np
import pytest
from flint import arb

from chord_examples import (
    any_ranges,
    chord_intervals,
    coincident_arcs,
    coincident_line,
    curve_row,
    nearly_one_chord_apart,
    nearly_touching,
    random_chord,
    turn_at,
    unlike_arcs,
)
from exact_chords import Point, exact_chord, exact_distance, exactly, minus
from rounding import ROUNDED, Rounded, error_of
from sharpness import Constant, changed, check_sharpness, interpreted
from strategies import random_row
from workhold.conventions import EXACT
from workhold.kernels.base.feature import is_shallow
from workhold.kernels.base.tables import BACKWARD_ERROR, COINCIDENCE, KAPPA, MIDDLE
from workhold.kernels.chord import coincidences, evaluation, intervals
from workhold.kernels.chord.coincidences import NONE, are_concentric, find_coincidence
from workhold.kernels.curves import piece_bounds

Array = np.ndarray[Any, np.dtype[np.float64]]
Pair = tuple[Array, Array, float]
Kernel = Callable[..., Any]

# Entries of a chord's state: the tail, the instant centre, and the bounds of their errors.
TAIL, CENTER, TAIL_ERROR, CENTER_ERROR = 0, 6, 8, 9
EITHER = (-1, 1)


def shifted(row: Array, off: float) -> Array:
    """A feature moved outward by ``off`` mm."""
    out = row.copy()
    if row[0] == 0.0:
        out[1:3] += off * row[4], -off * row[3]
    else:
        out[6] += off
    return out


def apart(place: Point, x: float, y: float) -> float:
    """Distance in mm of an exact point from a computed one."""
    dx, dy = minus(place, (arb(float(x)), arb(float(y))))
    return float((dx * dx + dy * dy).sqrt().upper())


def general(a: Array, b: Array, d: float) -> bool:
    """Whether a chord is at no coincidence."""
    return bool(find_coincidence(a, b, d)[0] == NONE and not are_concentric(a, b))


def toward_an_end(random: Random, low: float, high: float, least: float) -> float:
    """A direction of a range, as likely as not near one of its ends."""
    part = 10 ** random.uniform(least, -0.3)
    return low + (part if random.random() < 0.5 else 1 - part) * (high - low)


def some_chord(random: Random) -> tuple[Array, Array, float, float, float]:
    """A chord at no coincidence: features, length, branch and direction."""
    while True:
        a, b, d, ranges = any_ranges(random, 1e-3)
        if general(a, b, d):
            low, high, branch = (float(v) for v in ranges[random.randrange(len(ranges))][:3])
            return a, b, d, branch, toward_an_end(random, low, high, -6)


def made_chord(
    random: Random, make: Callable[[Random], Pair]
) -> tuple[Array, Array, float, float, float, float, float]:
    """A chord of made features: features, length, branch, direction and its range."""
    while True:
        a, b, d = make(random)
        ranges = chord_intervals(a, b, d)
        ranges = ranges[ranges[:, 1] - ranges[:, 0] > 1e-6]
        if len(ranges):
            low, high, branch = (float(v) for v in ranges[random.randrange(len(ranges))][:3])
            return a, b, d, branch, toward_an_end(random, low, high, -9), low, high


def farthest(
    a: Array, b: Array, d: float, branch: float, directions: list[float], x: float, y: float
) -> float:
    """How far in mm the exact tails of a chord at some directions, if it exists there, are from a point."""
    with exactly():
        chords = [exact_chord(a, b, d, arb(alpha), branch) for alpha in directions]
        return max((apart(chord.tail, x, y) for chord in chords if chord is not None), default=0.0)


def off_features(entry: int, told: int) -> Callable[[Random, Kernel], float]:
    """Error of a tail or an instant centre whose contacts may be off their features by the backward error."""

    def ratio(random: Random, kernel: Kernel) -> float:
        a, b, d, branch, alpha = some_chord(random)
        curve = curve_row(a, b, d, branch)
        square, kappa = turn_at(a, b, d, alpha, branch) ** 2, float(curve[KAPPA])
        eta = min(square / (kappa * 10 ** random.uniform(0, 4)) if kappa else 1e-4, 1e-2)
        curve[BACKWARD_ERROR] = eta
        state = kernel(a, b, curve, alpha, cos(alpha), sin(alpha))
        if eta < 1e-9 or not isfinite(state[told]):
            return 0.0
        worst = 0.0
        with exactly():
            for one in EITHER:
                for two in EITHER:
                    chord = exact_chord(shifted(a, one * eta), shifted(b, two * eta), d, arb(alpha), branch)
                    if chord is None:
                        return inf
                    place = chord.tail if entry == TAIL else chord.center()
                    worst = max(worst, apart(place, state[entry], state[entry + 1]))
        return worst / float(state[told])

    return ratio


def off_features_or_turned(turned: bool) -> Callable[[Random, Kernel], float]:
    """How far a tail may be when its contacts are off by the backward error, or when its direction is off."""

    def ratio(random: Random, kernel: Kernel) -> float:
        a, b, d, branch, alpha = some_chord(random)
        curve = curve_row(a, b, d, branch)
        square, kappa = turn_at(a, b, d, alpha, branch) ** 2, float(curve[KAPPA])
        part = 10 ** random.uniform(0, 4)
        away = min(square / (kappa * part * (d if turned else 1.0)) if kappa else 1e-4, 1e-2)
        eta, reach = (0.0, away) if turned else (away, 0.0)
        curve[BACKWARD_ERROR] = eta
        state = evaluation.compute_chord_state(a, b, curve, alpha, cos(alpha), sin(alpha))
        radius = kernel(curve, state, reach)
        if away < 1e-9 or not isfinite(radius):
            return 0.0
        worst = 0.0
        with exactly():
            for one in EITHER:
                for two in EITHER:
                    place = arb(alpha) + one * reach
                    chord = exact_chord(shifted(a, one * eta), shifted(b, two * eta), d, place, branch)
                    if chord is None:
                        return inf
                    worst = max(worst, apart(chord.tail, state[0], state[1]))
        return worst / float(radius)

    return ratio


def in_disc(make: Callable[[Random], Pair], arcs: bool = False) -> Callable[[Random, Kernel], float]:
    """How far tails within some radians are from one, over the radius of the disc that is to hold them."""

    def ratio(random: Random, kernel: Kernel) -> float:
        a, b, d, branch, alpha, low, high = made_chord(random, make)
        curve = curve_row(a, b, d, branch)
        curve[BACKWARD_ERROR] = 0.0
        reach = 10 ** random.uniform(-7, -0.5) * min(1, high - low)
        state = evaluation.compute_chord_state(a, b, curve, alpha, cos(alpha), sin(alpha))
        radius = kernel(a, b, state, d * reach, 0.0) if arcs else kernel(a, b, curve, state, alpha, reach)
        directions = [min(max(alpha + part * reach, low), high) for part in (-1, -0.5, 0.5, 1)]
        return farthest(a, b, d, branch, directions, state[0], state[1]) / float(radius)

    return ratio


def in_disc_with_a_small_gap(random: Random, kernel: Kernel) -> float:
    """The same for arcs of nearly equal radii whose centres are nearly one chord apart: all of the circle is reached."""
    a, b, d = nearly_one_chord_apart(random)
    if not general(a, b, d) or a[6] == b[6]:
        return 0.0
    # The triangle of chord, centres and gap, with the gap a little over the difference of the radii.
    away, gap = hypot(b[1] - a[1], b[2] - a[2]), abs(b[6] - a[6]) * (1 + 10 ** random.uniform(-6, 1))
    cosine = (away * away + d * d - gap * gap) / (2 * away * d)
    if abs(cosine) > 1:
        return 0.0
    alpha = atan2(b[2] - a[2], b[1] - a[1]) + acos(cosine)
    if not intervals.carriers_meet(a, b, d, alpha):
        return 0.0
    reach = gap / d * random.uniform(0.3, 4)
    state = evaluation.compute_chord_state(a, b, curve_row(a, b, d, 1.0), alpha, cos(alpha), sin(alpha))
    try:
        radius = kernel(a, b, state, d * reach, 0.0)
    except ValueError:
        # The root of a negative number.
        return inf
    directions = [alpha + part * reach for part in (-1, -0.5, 0.5, 1)]
    return farthest(a, b, d, 1.0, directions, state[0], state[1]) / float(radius) if radius > 0 else inf


def like_arcs(random: Random) -> Pair:
    a, b, d = nearly_one_chord_apart(random)
    if random.random() < 0.5:
        b[6] = a[6]
    return a, b, d


def two_arcs(random: Random) -> Pair:
    while True:
        kinds = (unlike_arcs, nearly_touching, like_arcs, lambda r: random_chord(r, ("circle", "circle")))
        a, b, d = random.choice(kinds)(random)
        if general(a, b, d):
            return a, b, d


def line_and_arc(random: Random, kinds: tuple[str, str]) -> Pair:
    while True:
        a, b, d = random_chord(random, kinds)
        if general(a, b, d):
            return a, b, d


def two_lines(random: Random) -> Pair:
    return random_chord(random, ("line", "line"))


def at_a_coincidence(random: Random) -> Pair:
    return random.choice([coincident_arcs, coincident_line])(random)


def contacts_rounded(random: Random, kernel: Kernel) -> float:
    """Rounding of a tail, counted by machine, where it is not enlarged by a tangency near by."""
    a, b, d, branch, alpha = some_chord(random)
    if abs(turn_at(a, b, d, alpha, branch)) < 0.8:
        return 0.0
    shift = random.uniform(-pi, pi)
    c, s, shift_c, shift_s = (ROUNDED[name](x) for x in (alpha - shift, shift) for name in ("cos", "sin"))
    wx, wy = d * (c * shift_c - s * shift_s), d * (s * shift_c + c * shift_s)
    x, y, *_ = ROUNDED_CHORD(a.tolist(), b.tolist(), wx, wy, branch, False)
    return hypot(error_of(x), error_of(y)) / float(kernel(a, b, d))


def rounded_chord() -> Kernel:
    inner = {
        name: changed(getattr(evaluation, name), **ROUNDED)
        for name in ("compute_line_to_arc", "compute_arc_to_arc")
    }
    return changed(evaluation.compute_chord_along, **inner, **ROUNDED)


ROUNDED_CHORD = rounded_chord()


class Rows(list):  # type: ignore[type-arg]
    """Rows of numbers of any kind, written as a kernel writes an array."""

    def __setitem__(self, place: Any, value: Any) -> None:
        self[place[0]][place[1]] = value


def tangency_rounded(kinds: tuple[str, str]) -> Callable[[Random, Kernel], float]:
    """Rounding of a tangency's direction, counted by machine, over its error as told."""

    def ratio(random: Random, kernel: Kernel) -> float:
        a, b = (np.array(random_row(random, kind)) for kind in kinds)
        # Opposite each other, so that differences are as large as the numbers.
        b[1:3] = -a[1:3] + np.array([random.uniform(-1, 1), random.uniform(-1, 1)])
        d = random.uniform(1.0, 60.0)
        if not general(a, b, d):
            return 0.0
        events = Rows([0.0, 0.0, 0.0] for _ in range(intervals.MOST_EVENTS))
        rest = (d, 0.0) if kinds[0] == "line" else (d,)
        count = kernel(events, 0, a.tolist(), b.tolist(), *rest)
        return max((error_of(events[k][0]) / float(events[k][2]) for k in range(count)), default=0.0)

    return ratio


def of_lines(form: Kernel) -> Kernel:
    names = {
        "add_event": changed(intervals.add_event),
        "find_line_side": changed(intervals.find_line_side, **ROUNDED),
    }
    return changed(form, add_pair=changed(intervals.add_pair, **names, **ROUNDED), **names, **ROUNDED)


def of_pair(form: Kernel) -> Kernel:
    names = {
        "add_event": changed(intervals.add_event),
        "find_line_side": changed(intervals.find_line_side, **ROUNDED),
    }
    return changed(
        intervals.add_line_tangencies, add_pair=changed(form, **names, **ROUNDED), **names, **ROUNDED
    )


def of_arcs(form: Kernel) -> Kernel:
    names = {
        "add_event": changed(intervals.add_event),
        "are_one_chord_apart": interpreted(intervals.are_one_chord_apart),
        "find_touching_side": changed(coincidences.find_touching_side, is_shallow=interpreted(is_shallow)),
    }
    return changed(
        intervals.add_arc_tangencies, add_gap=changed(form, **names, **ROUNDED), **names, **ROUNDED
    )


def turn_rounded(random: Random, kernel: Kernel) -> float:
    """Rounding of the angle of a range's middle from a coincidence, over what is added for it."""
    low, middle = random.uniform(0, 4 * pi), random.uniform(-pi, pi)
    high = low + 10 ** random.uniform(-9, -1)
    center, (first, last) = kernel(low, high, middle)
    with exactly():
        off = (arb(low) + arb(high)) / 2 - middle - center
        off -= round(float(off.mid()) / (2 * pi)) * 2 * arb.pi()
        added = (arb(last) - arb(first) - (arb(high) - arb(low))) / 2
        return float((abs(off) / added).upper())


def place_rounded(random: Random, kernel: Kernel) -> float:
    """Rounding of a place on an arc, counted by machine, over its error as told."""
    row, angle = np.array(random_row(random, "circle")), random.uniform(-pi, pi)
    x, y = row[1] + row[6] * cos(angle), row[2] + row[6] * sin(angle)
    told = kernel(row, row, (x, y, *[1.0] * 6, 0.0, 0.0), 1.0, 0.0, evaluation.POSITION)[2]
    return error_of(ROUNDED_PLACE(row.tolist(), Rounded(float(x)), Rounded(float(y)))) / float(told)


ROUNDED_PLACE = changed(
    evaluation.find_parameter, find_arc_parameter=changed(evaluation.find_arc_parameter, **ROUNDED), **ROUNDED
)


def regular_rounded(random: Random, kernel: Kernel) -> float:
    """Rounding of a tail found by the regular formulas, counted by machine, over its error as told."""
    a, b, d = at_a_coincidence(random)
    curve = curve_row(a, b, d, random.choice([1.0, -1.0]))
    psi = float(curve[MIDDLE]) + random.choice([-1, 1]) * 10 ** random.uniform(-4, 0)
    applies, motion = ROUNDED_MOTION(a.tolist(), b.tolist(), curve.tolist(), Rounded(psi, 9e-16))
    if not applies:
        return 0.0
    x, y, dx, dy = motion[:4]
    tail, center = (hypot(error_of(one), error_of(two)) for one, two in ((x, y), (x - dy, y + dx)))
    return max(tail, center / (1 + d * float(curve[KAPPA]))) / float(kernel(curve))


ROUNDED_MOTION = changed(
    coincidences.compute_motion,
    measure_from_coincidence=interpreted(coincidences.measure_from_coincidence),
    is_regular=changed(coincidences.is_regular, **ROUNDED),
    get_regular_radius=changed(coincidences.get_regular_radius, **ROUNDED),
    **ROUNDED,
)


def nearly_at_a_coincidence(random: Random, kernel: Kernel) -> float:
    """How far the contacts of the regular formulas are off features that miss a coincidence by up to ``EXACT``, over how
    far they may be as told."""
    a, b, d = at_a_coincidence(random)
    arc = a if a[0] else b
    arc[1:3] += EXACT * random.uniform(0.9, 1) * np.array([random.choice([-1, 1]), random.choice([-1, 0, 1])])
    curve = curve_row(a, b, d, random.choice([1.0, -1.0]))
    alpha = float(curve[MIDDLE]) + random.choice([-1, 1]) * 10 ** random.uniform(-3, 0)
    applies, motion = coincidences.compute_motion(a, b, curve, alpha)
    if not applies:
        return 0.0
    with exactly():
        tail = arb(motion[0]), arb(motion[1])
        head = tail[0] + d * arb(alpha).cos(), tail[1] + d * arb(alpha).sin()
        off = max(float(exact_distance(a, tail).upper()), float(exact_distance(b, head).upper()))
    return off / float(kernel(curve))


def within_a_disc(random: Random, kernel: Kernel) -> float:
    """How far the places on an arc of the points of a disc may be, over how far as told."""
    row = np.array(random_row(random, "circle"))
    radius, angle = row[6] * random.uniform(0.01, 0.5), random.uniform(-pi, pi)
    disc = (*(row[1:3] + row[6] * np.array([cos(angle), sin(angle)])), radius)
    _, told = changed(kernel, enclose_tail=lambda *_: disc)(
        row, row, np.zeros(0), 0.0, 0.0, evaluation.POSITION
    )
    return asin(radius / row[6]) / float(told)


def anywhere(line: bool) -> Callable[[Random, Kernel], float]:
    """How far a tail anywhere on its feature may be from one told without a bound, over how far as told."""

    def ratio(random: Random, kernel: Kernel) -> float:
        row, angle = np.array(random_row(random, "line" if line else "circle")), random.uniform(-pi, pi)
        axis, part = row[3:5], random.uniform(-1, 1)
        place = row[1:3] + (part * row[5] * axis if line else row[6] * np.array([cos(angle), sin(angle)]))
        stub = {"compute_chord_state": lambda *_: (*place, *[0.0] * 8), "bound_tail_error": lambda *_: inf}
        curve = curve_row(row, row, 1.0, 1.0)
        curve[COINCIDENCE] = NONE
        x, y, radius = changed(kernel, **stub, bound_disc_radius=lambda *_: inf)(
            row, row, curve, 0.0, 1.0, 0.0, 0.0
        )
        ends = [row[1:3] + side * row[5] * axis for side in (-1, 1)] if line else [2 * row[1:3] - place]
        return max(hypot(*(end - (x, y))) for end in ends) / float(radius)

    return ratio


ARC_FIRST, LINE_FIRST = ("circle", "line"), ("line", "circle")
CONSTANTS = [
    Constant("tail, 6 η", evaluation.compute_chord_state, off_features(TAIL, TAIL_ERROR), 6.0),
    Constant("instant centre, 8 η", evaluation.compute_chord_state, off_features(CENTER, CENTER_ERROR), 8.0),
    Constant("chord, 16 κη", evaluation.compute_chord_state, off_features(CENTER, CENTER_ERROR), 16.0),
    Constant("chord, 32 half units", evaluation.bound_backward_error, contacts_rounded, symbol="ROUNDINGS"),
    Constant("tail radius, 5 η", piece_bounds.bound_tail_error, off_features_or_turned(False), 5.0),
    Constant("tail radius, 16 κη", piece_bounds.bound_tail_error, off_features_or_turned(False), 16.0, 0),
    Constant("tail radius, 16 dκ", piece_bounds.bound_tail_error, off_features_or_turned(True), 16.0, 1),
    Constant("tail radius, 1.3 d", piece_bounds.bound_tail_error, off_features_or_turned(True), 1.3),
    Constant("disc of lines, 1.1 e", piece_bounds.bound_disc_radius, in_disc(two_lines), 1.1),
    Constant("disc at a coincidence, 2.6", piece_bounds.bound_disc_radius, in_disc(at_a_coincidence), 2.6),
    Constant(
        "disc from line to arc, 2 R",
        piece_bounds.bound_disc_radius,
        in_disc(lambda r: line_and_arc(r, LINE_FIRST)),
        2.0,
        1,
    ),
    Constant(
        "disc from line to arc, 1.01",
        piece_bounds.bound_disc_radius,
        in_disc(lambda r: line_and_arc(r, LINE_FIRST)),
        1.01,
        0,
    ),
    Constant(
        "disc from arc to line, 2 R",
        piece_bounds.bound_disc_radius,
        in_disc(lambda r: line_and_arc(r, ARC_FIRST)),
        2.0,
        3,
    ),
    Constant(
        "disc from arc to line, 1.01",
        piece_bounds.bound_disc_radius,
        in_disc(lambda r: line_and_arc(r, ARC_FIRST)),
        1.01,
        1,
    ),
    Constant("disc of arcs, gap of 2 e", piece_bounds.bound_arc_tail_error, in_disc_with_a_small_gap, 2.0, 0),
    Constant("disc of arcs, 2.2 R", piece_bounds.bound_arc_tail_error, in_disc(like_arcs, True), 2.2),
    Constant(
        "disc of arcs, e / 2", piece_bounds.bound_arc_tail_error, in_disc(two_arcs, True), 2.0, 1, times=10.0
    ),
    Constant("disc of arcs, 1.01", piece_bounds.bound_arc_tail_error, in_disc(two_arcs, True), 1.01),
    Constant("disc of arcs, 1.6 e", piece_bounds.bound_arc_tail_error, in_disc(like_arcs, True), 1.6),
    Constant("place on an arc, 1e-15", evaluation.evaluate_state, place_rounded, 1e-15),
    Constant("angle from a coincidence, 3e-15", coincidences.enclose_angle, turn_rounded, 3e-15, draws=1000),
    Constant("regular chord, 4 misfits", evaluation.bound_regular_error, nearly_at_a_coincidence, 4.0),
    Constant(
        "regular chord, 2 η",
        evaluation.bound_regular_error,
        regular_rounded,
        2.0,
        within=lambda form: changed(form, EXACT=0.0),
    ),
    Constant("place in a disc, 1.1", piece_bounds.enclose_value, within_a_disc, 1.1),
    Constant("tail anywhere on an arc, 2.2 R", piece_bounds.compute_tail, anywhere(False), 2.2, 0, draws=50),
    Constant("tail anywhere on a line, 1.1", piece_bounds.compute_tail, anywhere(True), 1.1, draws=50),
    Constant(
        "tangency of line and arc, 2 roundings",
        intervals.add_pair,
        tangency_rounded(LINE_FIRST),
        2.0,
        within=of_pair,
        draws=1000,
    ),
    Constant(
        "tangency of arcs, 2 errors",
        intervals.add_gap,
        tangency_rounded(("circle", "circle")),
        2.0,
        2,
        within=of_arcs,
        draws=3000,
    ),
    Constant(
        "tangency of line and arc, 10 half units",
        intervals.add_line_tangencies,
        tangency_rounded(LINE_FIRST),
        symbol="ROUNDINGS",
        within=of_lines,
        draws=1000,
    ),
    Constant(
        "tangency of arcs, 10 half units",
        intervals.add_gap,
        tangency_rounded(("circle", "circle")),
        symbol="ROUNDINGS",
        within=of_arcs,
        draws=3000,
    ),
]


@pytest.mark.parametrize("constant", CONSTANTS, ids=lambda constant: constant.name)
@pytest.mark.prove
def test_a_tenth_of_a_constant_would_not_do(constant: Constant) -> None:
    """The bound holds on every input, and with a tenth of the constant it does not."""
    check_sharpness(constant)
