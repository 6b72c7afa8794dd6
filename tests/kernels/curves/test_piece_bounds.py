"""Everything a piece tells is true at every orientation inside it: held against chords at 200 bits."""

from __future__ import annotations

from math import cos, hypot, inf, isfinite, pi, sin
from random import Random

import numpy as np
import pytest
from flint import arb
from hypothesis import given, settings

from chord_examples import SPECIAL, is_rounded_coincidence
from curve_examples import HEIGHT, POSITION, pieces_of, pitch_of, random_table, special_table, steps_of
from exact_chords import dot, exact_chord, exact_speed, exactly, plus
from strategies import seeds
from workhold.contact.curves import make_curve_table
from workhold.kernels.base.interval import enclose_slope
from workhold.kernels.base.tables import (
    ACROSS_LEAST,
    ACROSS_MOST,
    BRANCH,
    COLUMN_STEP,
    CURVE,
    EDGE_LENGTH,
    FROM,
    HEAD,
    HEAD_NORMAL_X,
    HEAD_NORMAL_Y,
    HIGH,
    LEFTWARD_HIGH,
    LEFTWARD_LOW,
    LENGTH,
    LOW,
    PIECE_LENGTH,
    RIGHTWARD_HIGH,
    RIGHTWARD_LOW,
    SECOND_DERIVATIVE_HIGH,
    SECOND_DERIVATIVE_LOW,
    SHIFT,
    SLOPE_ERROR_HIGH,
    SLOPE_ERROR_LOW,
    SLOPE_HIGH,
    SLOPE_LOW,
    STEADY,
    TAIL,
    TAIL_NORMAL_X,
    TAIL_NORMAL_Y,
    TANGENT_FROM,
    TANGENT_TO,
    TO,
    VALUE_LEAST,
    VALUE_MOST,
    X_MOVING,
    X_STANDING,
)
from workhold.kernels.chord.evaluation import compute_chord_state
from workhold.kernels.curves.piece_bounds import find_force_range, write_force_directions
from workhold.kernels.curves.piece_enclosures import find_largest_part

# The check's own rounding: a number at 200 bits, doubled orientation and places as doubles.
EXACT_TO = 1e-15


def exceeds(value: arb, low: float, high: float) -> bool:
    """Whether a number is certainly outside a range, by more than the check's own rounding."""
    slack = abs(value) * EXACT_TO
    return bool(value + slack < low) or bool(value - slack > high)


def places(random: Random, low: float, high: float) -> list[float]:
    """Orientations across a piece, both ends among them."""
    inner = (low + (high - low) * part for part in (1e-5, 0.2, 0.5, random.random(), 0.8, 1 - 1e-5))
    return [low, *(min(max(place, low), high) for place in inner), high]


def beyond(piece, curve) -> list[float]:
    """Orientations beyond a piece that ends at a tangency, by as much as the tangency may be off."""
    out = []
    if piece[STEADY] == 0.0:
        for end, tangency, error in (
            (piece[LOW], curve[FROM] - curve[SHIFT], -curve[TANGENT_FROM]),
            (piece[HIGH], curve[TO] - curve[SHIFT], curve[TANGENT_TO]),
        ):
            if error and abs((end - tangency + pi) % (2 * pi) - pi) < 4e-15:
                out += [float(end + error), float(end + error / 2)]
    return out


def slope_bounds(piece) -> tuple[float, float]:
    """Bounds of the slope over a piece, the errors at its ends included; none beside a tangency."""
    if piece[STEADY] == 0.0:
        return -inf, inf
    ends = (float(piece[k]) for k in (SLOPE_LOW, SLOPE_HIGH, SECOND_DERIVATIVE_LOW, SECOND_DERIVATIVE_HIGH))
    least, most = enclose_slope(*ends, float(piece[HIGH] - piece[LOW]))
    doubt = max(piece[SLOPE_ERROR_LOW], piece[SLOPE_ERROR_HIGH])
    return least - doubt, most + doubt


def outward(row, point) -> tuple[arb, arb]:
    """Outward normal of a contact direction."""
    sign = 1 if row[0] == 0.0 else int(row[7])
    return point[0] * sign, point[1] * sign


def fronts(one, two, x) -> list[arb]:
    """Directions y / (x + abs(y)) of the forces between two directions that have a part along x."""
    out = []
    y = (-x[1], x[0])
    for k in range(11):
        force = plus((one[0] * (10 - k), one[1] * (10 - k)), two, k)
        along, beside = dot(x, force), dot(y, force)
        if along > 1e-30:
            out.append(beside / (along + abs(beside)))
    return out


def check_piece(features, table, piece, mode, random: Random) -> int:
    """Hold a piece against exact chords inside it; return how many there were."""
    curve = int(piece[CURVE])
    a, b = (features[k] for k in table.curves.integers[curve, [TAIL, HEAD]])
    d, branch, shift = (float(table.curves.reals[curve, k]) for k in (LENGTH, BRANCH, SHIFT))
    step = float(table.curves.integers[curve, COLUMN_STEP]) * pitch_of(table)
    circle = mode == POSITION and a[0] != 0.0 and a[5] >= pi
    scale = 1.0 if a[0] == 0.0 else arb(float(a[6]))
    checked = 0
    with exactly():
        for place in places(random, float(piece[LOW]), float(piece[HIGH])) + beyond(
            piece, table.curves.reals[curve]
        ):
            psi = arb(place)
            chord, speed = (
                exact_chord(a, b, d, psi + shift, branch),
                exact_speed(a, b, d, psi + shift, branch),
            )
            if chord is None or speed is None:
                continue
            checked += 1
            detail = (a.tolist(), b.tolist(), d, branch, shift, mode, piece.tolist(), place)
            x, y = (psi.cos(), psi.sin()), (-psi.sin(), psi.cos())
            center = chord.center()
            value, slope = chord.height(psi) if mode == HEIGHT else chord.position()
            if mode == HEIGHT:
                second_derivative = -dot(y, center) - dot(x, speed)
            else:
                second_derivative = -dot(speed, chord.along_a) / scale
            if not circle:
                assert not exceeds(value, piece[VALUE_LEAST], piece[VALUE_MOST]), ("value", detail)
            assert not exceeds(slope, *slope_bounds(piece)), ("slope", detail)
            if piece[LOW] <= place <= piece[HIGH]:
                assert not exceeds(
                    second_derivative, piece[SECOND_DERIVATIVE_LOW], piece[SECOND_DERIVATIVE_HIGH]
                ), (
                    "second derivative",
                    detail,
                )
            tail = dot(x, chord.tail)
            tail_and_head = (tail, tail + step)
            assert not max(tail_and_head) < piece[X_STANDING] - 1e-12, ("left", detail)
            assert not min(tail_and_head) > piece[X_MOVING] + 1e-12, ("right", detail)
            assert not exceeds(dot(y, center), piece[ACROSS_LEAST], piece[ACROSS_MOST]), ("across", detail)
            if mode == HEIGHT:
                one, two = outward(a, chord.along_a), outward(b, chord.along_b)
                for low, high, sign in (
                    (piece[RIGHTWARD_LOW], piece[RIGHTWARD_HIGH], -1),
                    (piece[LEFTWARD_LOW], piece[LEFTWARD_HIGH], 1),
                ):
                    force_directions = ((one[0] * sign, one[1] * sign), (two[0] * sign, two[1] * sign))
                    for direction in fronts(*force_directions, x):
                        assert not exceeds(direction, low, high), ("push", sign, detail)
    return checked


def some(random: Random, pieces: np.ndarray, most: int) -> np.ndarray:
    """Some of the pieces, unsteady ones as likely as steady ones."""
    chosen = []
    for steady in (0.0, 1.0):
        mine = np.flatnonzero(pieces[:, STEADY] == steady)
        chosen += random.sample(mine.tolist(), min(most // 2, len(mine)))
    return pieces[chosen]


def check_table(features, table, random: Random, most: int) -> int:
    """Check some pieces of a table in a cell as wide as the search's or a part of one."""
    if not len(table):
        return 0
    low, width = random.uniform(-4, 4), random.choice([pi / 96, 0.3, 10 ** random.uniform(-8, -1.5)])
    mode = random.choice([HEIGHT, POSITION])
    checked = 0
    for piece in some(random, pieces_of(features, table, low, low + width, mode), most):
        curve = int(piece[CURVE])
        pair = [features[k] for k in table.curves.integers[curve, [TAIL, HEAD]]]
        if not is_rounded_coincidence(*pair, float(table.curves.reals[curve, LENGTH])):
            checked += check_piece(features, table, piece, mode, random)
    return checked


@pytest.mark.thorough
@given(seeds)
def test_pieces_of_random_parts_bound_what_they_tell(seed):
    """Value, slope, second derivative, place along x, y . P and directions of push at orientations all over a piece."""
    random = Random(seed)
    check_table(*random_table(random), random, 12)


@pytest.mark.thorough
@pytest.mark.parametrize("make", SPECIAL)
def test_pieces_in_special_positions_bound_what_they_tell(make):
    """The same for nearly parallel lines, coincidences, tangent joints, unlike arcs, narrow ranges and the like."""
    random, checked = Random(61), 0
    while checked < 1500:
        checked += check_table(*special_table(random, make), random, 40)


@pytest.mark.thorough
@pytest.mark.parametrize("make", SPECIAL)
def test_pieces_next_to_the_ends_of_a_curve_bound_what_they_tell(make):
    """The same in cells that begin or end at any small distance from the end of a curve, where tangencies are."""
    random, checked = Random(62), 0
    while checked < 1500:
        features, table = special_table(random, make)
        for curve in random.sample(range(len(table)), min(4, len(table))):
            pair = [features[k] for k in table.curves.integers[curve, [TAIL, HEAD]]]
            if is_rounded_coincidence(*pair, float(table.curves.reals[curve, LENGTH])):
                continue
            first, last, shift = (float(table.curves.reals[curve, k]) for k in (0, 1, SHIFT))
            depth, width = 10 ** random.uniform(-13, -1), 10 ** random.uniform(-10, -1)
            low = first - shift + depth if random.random() < 0.5 else last - shift - depth - width
            for mode in (HEIGHT, POSITION):
                pieces = pieces_of(features, table, low, low + width, mode)
                for piece in some(random, pieces[pieces[:, CURVE] == curve], 6):
                    checked += check_piece(features, table, piece, mode, random)


@pytest.mark.thorough
@given(seeds)
@settings(max_examples=25)
def test_a_small_part_between_lines_of_action_near_the_middle(seed):
    """The same where the instant centre passes near the centre of the part, so that only its motion bends
    the height."""
    random = Random(seed)
    features, table = special_table(random, random.choice(SPECIAL))
    if not len(table):
        return
    curve = random.randrange(len(table))
    a, b = (features[k].copy() for k in table.curves.integers[curve, [TAIL, HEAD]])
    first, last, branch, d = (float(table.curves.reals[curve, k]) for k in (0, 1, BRANCH, LENGTH))
    alpha = first + random.random() * (last - first)
    if is_rounded_coincidence(a, b, d):
        return
    chord = exact_chord(a, b, d, arb(alpha), branch)
    if chord is None:
        return
    center = [float(entry.mid()) for entry in chord.center()]
    if not all(isfinite(entry) and abs(entry) < 1e4 for entry in center):
        return
    moved = features.copy()
    moved[:, 1:3] -= center
    table = make_curve_table(moved, steps_of(table))
    for step in range(len(table)):
        psi = alpha - float(table.curves.reals[step, SHIFT])
        width = 10 ** random.uniform(-3, -0.5)
        for piece in pieces_of(moved, table, psi - width / 2, psi + width / 2, HEIGHT):
            if int(piece[CURVE]) == step:
                pair = [moved[k] for k in table.curves.integers[step, [TAIL, HEAD]]]
                if not is_rounded_coincidence(*pair, float(table.curves.reals[step, LENGTH])):
                    check_piece(moved, table, piece, HEIGHT, random)


def angle_range(one: float, two: float) -> list[float]:
    """Angles of directions between two angles, the shorter way round, that have a part along x."""
    turn = (two - one + pi) % (2 * pi) - pi
    angles = [(one + turn * k / 40 + pi) % (2 * pi) - pi for k in range(41)]
    return [angle for angle in angles if abs(angle) < pi / 2]


@pytest.mark.thorough
def test_what_the_errors_of_the_instant_centre_allow_is_told():
    """y . P at the ends of a steady piece is enclosed with its error, and the second derivative allows for an instant
    centre that is as far off: both errors grow without bound towards a tangency."""
    random, checked = Random(63), 0
    while checked < 300:
        features, table = special_table(random, random.choice(SPECIAL))
        for curve in random.sample(range(len(table)), min(4, len(table))):
            a, b = (features[k] for k in table.curves.integers[curve, [TAIL, HEAD]])
            low = float(
                table.curves.reals[curve, 0] - table.curves.reals[curve, SHIFT]
            ) + 10 ** random.uniform(-12, -3)
            pieces = pieces_of(features, table, low, low + 10 ** random.uniform(-9, -4), HEIGHT)
            for piece in pieces[(pieces[:, CURVE] == curve) & (pieces[:, STEADY] == 1.0)]:
                for psi in (float(piece[LOW]), float(piece[HIGH])):
                    state = compute_chord_state(a, b, table.curves.reals[curve], psi, cos(psi), sin(psi))
                    across = cos(psi) * state[7] - sin(psi) * state[6]
                    assert piece[ACROSS_LEAST] <= across - state[9] <= across + state[9] <= piece[ACROSS_MOST]
                    assert piece[SECOND_DERIVATIVE_HIGH] >= (hypot(state[6], state[7]) + state[9]) * (
                        1 - 1e-12
                    )
                    checked += 1


@given(seeds)
def test_largest_part_bounds_a_direction_that_turns(seed):
    """A direction that turns evenly from one to another, by less than half a turn, has no larger part along x between."""
    random = Random(seed)
    for _ in range(100):
        one = random.choice([random.uniform(-pi, pi), 0.0, pi / 2, pi])
        turn = random.uniform(-1, 1)
        told = find_largest_part(cos(one), sin(one), cos(one + turn), sin(one + turn))
        most = max(abs(cos(one + turn * k / 50)) for k in range(51))
        assert told >= most - 1e-12
        if most < 0.7:
            assert told <= most + 1e-12


@pytest.mark.thorough
@given(seeds)
def test_push_range_holds_every_direction_between(seed):
    """All directions within ``doubt`` of both ends: every direction between them with a part along x is told."""
    random = Random(seed)
    for _ in range(200):
        doubt = random.choice([0.0, 1e-9, 1e-3, 0.1])
        one = random.choice([random.uniform(-pi, pi), pi / 2, -pi / 2, 0.0])
        two = random.choice(
            [random.uniform(-pi, pi), one + pi, one, one + pi + random.uniform(-2, 2) * doubt]
        )
        bottom, top = find_force_range(np.cos(one), np.sin(one), np.cos(two), np.sin(two), doubt)
        off = [random.uniform(-1, 1) * doubt / 2 for _ in range(2)]
        for angle in angle_range(one + off[0], two + off[1]):
            told = np.sin(angle) / (np.cos(angle) + abs(np.sin(angle)))
            assert bottom - 2 * doubt - 1e-9 <= told <= top + 2 * doubt + 1e-9, (one, two, doubt, angle)


def turning_edges(random: Random) -> list[tuple[np.ndarray, float, float]]:
    """Normals of tail and head at both ends of a piece and between, each turning evenly by less than one radian."""
    corners = (0.0, pi / 2, -pi / 2, pi)
    starts = [
        random.choice([random.uniform(-pi, pi), random.choice(corners) + random.uniform(-0.2, 0.2)])
        for _ in "ab"
    ]
    turns = [random.choice([random.uniform(-0.5, 0.5), random.uniform(-0.05, 0.05)]) for _ in "ab"]
    if random.random() < 0.4:
        starts[1] = starts[0] + pi + random.uniform(-0.2, 0.2)
    out = []
    for part in np.linspace(0.0, 1.0, 21):
        one, two = (start + part * turn for start, turn in zip(starts, turns, strict=True))
        edge = np.zeros(EDGE_LENGTH)
        edge[TAIL_NORMAL_X], edge[TAIL_NORMAL_Y], edge[HEAD_NORMAL_X], edge[HEAD_NORMAL_Y] = (
            cos(one),
            sin(one),
            cos(two),
            sin(two),
        )
        out.append((edge, one, two))
    return out


@pytest.mark.thorough
@given(seeds)
def test_pushes_of_a_piece_hold_those_at_every_orientation_between(seed):
    """Where both normals turn evenly, the directions told from the two ends hold every direction on the way; none are told
    only where there are none. Normals do not pass through parallel ones: X keeps its sign along a curve."""
    random = Random(seed)
    for _ in range(60):
        edges, row = turning_edges(random), np.zeros(PIECE_LENGTH)
        if len({sin(two - one) > 0.0 for _, one, two in edges}) == 2:
            continue
        write_force_directions(row, edges[0][0], edges[-1][0], 0.0, 0.0)
        for _, one, two in edges:
            for turn, low, high in (
                (pi, row[RIGHTWARD_LOW], row[RIGHTWARD_HIGH]),
                (0.0, row[LEFTWARD_LOW], row[LEFTWARD_HIGH]),
            ):
                for angle in angle_range(one + turn, two + turn):
                    told = sin(angle) / (cos(angle) + abs(sin(angle)))
                    assert low - 1e-9 <= told <= high + 1e-9, (edges[0][1:], edges[-1][1:], turn, angle)


def test_push_range_is_known():
    """Forces up and to the right, forces that all point left, and forces to either side of straight right."""
    assert find_force_range(1.0, 0.0, 0.0, 1.0, 0.0) == pytest.approx((0.0, 1.0))
    assert find_force_range(-1.0, 0.1, -1.0, -0.1, 0.0) == (1.0, -1.0)
    assert find_force_range(1.0, 1.0, 1.0, -1.0, 0.0) == pytest.approx((-0.5, 0.5))
    # The shorter way from up and right to down and left leads over the right side or the left one.
    assert find_force_range(1.0, 2.0, -1.0, -1.0, 0.0) == pytest.approx((2 / 3, 1.0))
    assert find_force_range(2.0, 1.0, -1.0, -1.0, 0.0) == pytest.approx((-1.0, 1 / 3))
    assert find_force_range(1.0, 1.0, -1.0, -1.0, 0.0) == (-1.0, 1.0)
