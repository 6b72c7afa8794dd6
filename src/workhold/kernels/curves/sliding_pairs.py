"""Sliding pairs: chords that fit at one orientation only and slide there.

Two pegs on parallel lines, or on arcs of equal radius whose centres lie exactly one chord apart, fix the
orientation. The workpiece can still slide along the lines or around the arcs, and the other pegs stop it.
Such a chord exists at one orientation alone, so it is no curve over the orientation. Its fixtures are found
by evaluating the other chords at that orientation.

Two sliding pairs at one orientation leave the workpiece a freedom that the contacts do not resist, so they
never make a fixture together. Nor does a sliding pair whose contacts share one line of action.
"""

from __future__ import annotations

from math import acos, atan2, ceil, cos, hypot, pi, sin
from typing import NamedTuple

import numpy as np

from workhold.conventions import PARALLEL, SQUARE
from workhold.kernels.base.compiling import Array, IntArray, IntVector, compiled, inner
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, RADIUS, X, Y, compute_point
from workhold.kernels.base.interval import TURN
from workhold.kernels.base.tables import (
    COLUMN_STEP,
    DIRECTION,
    FROM,
    HEAD,
    LENGTH,
    ORIENTATION,
    ROW_STEP,
    SHIFT,
    SLIDE_FROM,
    SLIDE_TO,
    STEP_LENGTH,
    TAIL,
    TO,
    Curves,
    Features,
    Lattice,
    Limits,
    NearSpots,
    SlidingPairs,
)
from workhold.kernels.chord.coincidences import are_one_chord_apart, shares_a_line
from workhold.kernels.chord.evaluation import bound_backward_error, find_parameter
from workhold.kernels.chord.intervals import SLIVER
from workhold.kernels.contact.record import (
    PEG_LENGTH,
    PEG_RADIUS,
    PEG_ROW,
    PEG_X,
    PEG_Y,
    Angle,
    make_angle,
    place_peg,
)
from workhold.kernels.contact.rules import share_a_carrier
from workhold.kernels.curves.block_work import (
    NO_ROOM_FOR_RECORDS,
    STOPPED,
    BlockSpace,
    BlockWork,
    add_listed,
    is_among,
    make_block_work,
    place_chord,
    place_head,
    place_tail,
)
from workhold.kernels.curves.moving_pegs import (
    add_moving_pegs,
    find_height_range,
    find_lines_between,
    intersect_at_height,
)
from workhold.kernels.curves.near_spots import find_spots, may_be_three
from workhold.kernels.curves.piece_bounds import enclose_tail
from workhold.kernels.curves.three_and_one import heads_share_a_line

# Rounding of a sliding pair's orientation in radians.
ROUNDING = 4e-15
# The most sliding pairs that two features have.
MOST_SLIDES = 4


@inner
def write_line_sliding_pairs(a: Array, b: Array, d: float, out: Array) -> int:
    """Write the sliding pairs of a chord of length d mm between two parallel lines to ``out``; return their
    number.

    There are 0 to 2. ``a`` and ``b`` are the rows of the lines (see ``base.feature``); see
    :func:`write_sliding_pairs` for ``out``.
    """
    nx, ny = a[AXIS_Y], -a[AXIS_X]
    cosine = (nx * (b[X] - a[X]) + ny * (b[Y] - a[Y])) / d
    if abs(cosine) >= 1.0 - SQUARE:
        return 0
    count = 0
    same = 1.0 if a[AXIS_X] * b[AXIS_X] + a[AXIS_Y] * b[AXIS_Y] > 0.0 else -1.0
    for k in range(2):
        alpha = atan2(ny, nx) + (1.0 - 2.0 * k) * acos(cosine)
        # Parameter on b of the head when the tail is in the middle of a; it moves by +-s with the tail.
        middle = same * (
            (a[X] + d * cos(alpha) - b[X]) * b[AXIS_X] + (a[Y] + d * sin(alpha) - b[Y]) * b[AXIS_Y]
        )
        low = max(-a[HALF_EXTENT], -b[HALF_EXTENT] - middle)
        high = min(a[HALF_EXTENT], b[HALF_EXTENT] - middle)
        if low <= high:
            out[count, SLIDE_FROM], out[count, SLIDE_TO], out[count, DIRECTION] = low, high, alpha
            count += 1
    return count


@inner
def write_arc_sliding_pairs(a: Array, b: Array, d: float, out: Array) -> int:
    """Write the sliding pairs of a chord of length d mm between two arcs to ``out``; return their number.

    There are none unless the arcs have equal radii and centres d apart. ``a`` and ``b`` are the rows of the
    arcs (see ``base.feature``); see :func:`write_sliding_pairs` for ``out``.
    """
    if not are_one_chord_apart(a, b, d):
        return 0
    alpha = atan2(b[Y] - a[Y], b[X] - a[X])
    turned = atan2(
        a[AXIS_X] * b[AXIS_Y] - a[AXIS_Y] * b[AXIS_X], a[AXIS_X] * b[AXIS_X] + a[AXIS_Y] * b[AXIS_Y]
    )
    if b[HALF_EXTENT] >= pi:
        out[0, SLIDE_FROM], out[0, SLIDE_TO], out[0, DIRECTION] = -a[HALF_EXTENT], a[HALF_EXTENT], alpha
        return 1
    count = 0
    for lap in range(-1, 2):
        middle = turned + lap * TURN
        low = max(-a[HALF_EXTENT], middle - b[HALF_EXTENT])
        high = min(a[HALF_EXTENT], middle + b[HALF_EXTENT])
        if low <= high:
            out[count, SLIDE_FROM], out[count, SLIDE_TO], out[count, DIRECTION] = low, high, alpha
            count += 1
    return count


@inner
def write_sliding_pairs(a: Array, b: Array, d: float, out: Array) -> int:
    """Write the sliding pairs of a chord of length d mm to ``out``; return their number.

    The chord's tail is on feature ``a``, its head on feature ``b`` (rows, see ``base.feature``). ``out`` is
    (MOST_SLIDES, 3) with columns SLIDE_FROM and SLIDE_TO (lowest and highest parameter of the tail on ``a``)
    and DIRECTION (alpha of the chord in radians).
    """
    count = 0
    if a[IS_ARC] == 0.0 and b[IS_ARC] == 0.0:
        if abs(a[AXIS_X] * b[AXIS_Y] - a[AXIS_Y] * b[AXIS_X]) <= PARALLEL:
            count = write_line_sliding_pairs(a, b, d, out)
    elif a[IS_ARC] != 0.0 and b[IS_ARC] != 0.0:
        count = write_arc_sliding_pairs(a, b, d, out)
    return count


@inner
def wrap_into_range(curve: int, psi: float, reach: float, reals: Array) -> tuple[bool, float]:
    """Return (whether a curve may exist at psi, psi shifted by whole turns and clamped into the curve's
    range).

    ``curve`` is an index into ``reals`` (see ``base.tables``). Psi, in radians, is known to ``reach``
    radians. The narrow gaps that ranges leave around a coincidence count as part of the range.
    """
    low, high = reals[curve, FROM] - reals[curve, SHIFT], reals[curve, TO] - reals[curve, SHIFT]
    inside = psi + TURN * ceil((low - SLIVER - reach - psi) / TURN)
    return (inside <= high + SLIVER + reach, min(max(inside, low), high))


@inner
def bound_orientation_error(a: Array, b: Array, sliding_pair: Array) -> float:
    """Return how far in radians the orientation of a sliding pair may be off.

    ``a`` and ``b`` are the features of tail and head, ``sliding_pair`` the reals (5,).

    Between lines the distance h across gives the angle off square by cos = h / d, so an error of h counts by
    1 / (d sin). The sine is at least 8.9e-8 (``conventions.SQUARE``).

    Let two arcs have centres a misfit m from one chord apart, and radii that differ by r. The chord whose
    contacts lie in the direction phi from the centres' line is then (r + m cos phi) / (d sin phi) off. That
    is no more than the bound returned where the lines of action are 15 degrees from the chord or more. Nearer
    to the chord the bound still holds when it is weighted with the share of the forces that such contacts
    leave to the others. See ``base.feature`` for the layout of ``a`` and ``b``, ``base.tables`` for that of
    ``sliding_pair``.
    """
    d = sliding_pair[STEP_LENGTH]
    error = bound_backward_error(a, b, d)
    if a[IS_ARC] == 0.0:
        nx, ny = a[AXIS_Y], -a[AXIS_X]
        along = abs(cos(sliding_pair[DIRECTION]) * ny - sin(sliding_pair[DIRECTION]) * nx)
        tilt = abs(a[AXIS_X] * b[AXIS_Y] - a[AXIS_Y] * b[AXIS_X]) + ROUNDING
        return ROUNDING + (error + tilt * (a[HALF_EXTENT] + b[HALF_EXTENT] + d)) / (d * along)
    return (
        ROUNDING + (error + 4.0 * (abs(hypot(b[X] - a[X], b[Y] - a[Y]) - d) + abs(a[RADIUS] - b[RADIUS]))) / d
    )


class PlacedPair(NamedTuple):
    """A sliding pair at its orientation, as shared by all fixtures that rest on it.

    Parameters
    ----------
    number : its row in the tables of sliding pairs.
    angle, reach : its orientation, and how far in radians that may be off.
    x, y : head minus tail in the part's frame, in mm.
    swing : by how much in mm the head's error may exceed the tail's.
    """

    number: int
    angle: Angle
    reach: float
    x: float
    y: float
    swing: float


@inner
def place_pair(number: int, sliding_pairs: SlidingPairs, loose: Array) -> PlacedPair:
    """Return a sliding pair by its row number; ``loose`` are the features' rows.

    See ``base.feature`` for the layout of ``loose``.
    """
    whole, real = sliding_pairs.integers[number], sliding_pairs.reals[number]
    reach = bound_orientation_error(loose[whole[TAIL]], loose[whole[HEAD]], real)
    d, alpha = real[STEP_LENGTH], real[DIRECTION]
    angle = make_angle(real[ORIENTATION])
    return PlacedPair(number, angle, reach, d * cos(alpha), d * sin(alpha), d * reach)


@inner
def place_sliding_pair(
    pegs: Array, x: float, y: float, line: float, radius: float, whole: IntArray, pair: PlacedPair
) -> None:
    """Write the pegs of a sliding pair to ``pegs`` (2, 6), with its
    tail at (x, y) in lattice row ``line`` and column 0.

    ``whole`` are the pair's whole numbers (7,), ``radius`` the tail's error radius in mm. See
    ``contact.record`` for the layout of ``pegs``, ``base.tables`` for that of ``whole``.
    """
    place_peg(pegs[0], x, y, whole[TAIL], 0.0, line, radius)
    column, row = float(whole[COLUMN_STEP]), line + whole[ROW_STEP]
    place_peg(pegs[1], x + pair.x, y + pair.y, whole[HEAD], column, row, radius + pair.swing)


@inner
def is_tail_inside(row: Array, sliding_pair: Array, x: float, y: float, radius: float) -> bool:
    """Return whether the tail of a sliding pair at (x, y), in mm, may lie in the pair's range on its feature
    ``row``.

    The place is known to ``radius`` mm. See ``base.feature`` for the layout of ``row``, ``base.tables`` for
    that of ``sliding_pair``.
    """
    spare = radius + 1e-10
    if row[IS_ARC] != 0.0:
        spare = 1.2 * spare / row[RADIUS]
    s = find_parameter(row, x, y)
    return sliding_pair[SLIDE_FROM] - spare <= s <= sliding_pair[SLIDE_TO] + spare


@inner
def add_curve_fixtures(
    out: Array,
    count: int,
    pair: PlacedPair,
    curve: int,
    inside: Angle,
    sliding_pairs: SlidingPairs,
    work: BlockWork,
) -> int:
    """Append the fixtures of a sliding pair on one carrier and a curve's chord on the other carrier to
    ``out``.

    There is one for each row of holes of the moving carrier in which the two chords can meet.

    Parameters
    ----------
    out, count : (R, 19) records, of which the first ``count`` are written.
    curve : index of the curve.
    inside : the pair's orientation, shifted into the curve's range.

    Returns
    -------
    New number of records, or NO_ROOM_FOR_RECORDS (-1)
    """
    whole, real = sliding_pairs.integers[pair.number], sliding_pairs.reals[pair.number]
    features, curves, lattice = work.features, work.curves, work.lattice
    reach, pegs = pair.reach, work.pegs
    ax, ay, pitch_y = -pair.angle.sine, pair.angle.cosine, lattice.pitch_y
    row = features.loose[whole[TAIL]]
    lowest, highest = find_height_range(row, ax, ay)
    tail = curves.integers[curve, TAIL]
    place_chord(pegs[2:], curve, inside, 2.0 * reach + SLIVER, 0.0, features.rows, curves)
    height, rise = ax * pegs[2, PEG_X] + ay * pegs[2, PEG_Y], pegs[3, PEG_ROW]
    error = pegs[2, PEG_RADIUS] + 4.0 * work.limits.wrench_length * reach
    for order in range(2):
        # The sliding pair stands still for order 0, and is on the moving carrier for order 1.
        one, two = (whole[TAIL], tail) if order == 0 else (tail, whole[TAIL])
        if not (is_among(one, features.standing) and is_among(two, features.moving)):
            continue
        sign = 1.0 if order == 0 else -1.0
        at, other = 2 * order, 2 - 2 * order
        if order == 1:
            for n in range(PEG_LENGTH):
                pegs[0, n], pegs[1, n] = pegs[2, n], pegs[3, n]
        base = height - sign * lattice.row_offset
        first, last = find_lines_between(lowest, highest, base, pitch_y, error)
        for line in range(first, last + 1):
            for k in range(2):
                meets, x, y, radius = intersect_at_height(
                    row, ax, ay, base + line * pitch_y, error, 1.0 - 2.0 * k
                )
                if not meets or not is_tail_inside(row, real, x, y, radius):
                    continue
                # The first peg of the standing chord is in row 0.
                slid, turned = (0.0, float(-line)) if order == 0 else (float(line), 0.0)
                place_sliding_pair(pegs[at : at + 2], x, y, slid, radius, whole, pair)
                pegs[other, PEG_ROW], pegs[other + 1, PEG_ROW] = turned, turned + rise
                count = add_listed(out, count, 2.0, pair.angle, reach, order == 0, work)
                if count < 0:
                    return count
    return count


@inner
def add_fixtures_with_third_peg(
    out: Array,
    count: int,
    pair: PlacedPair,
    curve: int,
    inside: Angle,
    sliding_pairs: SlidingPairs,
    work: BlockWork,
) -> int:
    """Append the fixtures of three standing pegs and one moving peg to ``out``.

    The standing pegs are those of a sliding pair and the head of a curve's chord, whose tail is the pair's
    tail. Parameters and result are those of :func:`add_curve_fixtures`.
    """
    whole, real = sliding_pairs.integers[pair.number], sliding_pairs.reals[pair.number]
    features, curves, pegs, wide = work.features, work.curves, work.pegs, 2.0 * pair.reach + SLIVER
    if not work.counting and heads_share_a_line(whole, curves.integers[curve], features.loose, work.lattice):
        return count
    place_tail(pegs, curve, inside, wide, 0.0, features.rows, curves)
    x, y, radius = pegs[0, PEG_X], pegs[0, PEG_Y], pegs[0, PEG_RADIUS]
    if not is_tail_inside(features.loose[whole[TAIL]], real, x, y, radius):
        return count
    place_head(pegs, 2, curve, inside, wide, curves)
    place_sliding_pair(pegs[:2], x, y, 0.0, radius, whole, pair)
    return add_moving_pegs(out, count, pair.angle, pair.reach, work)


@inner
def find_first_of_tail(members: IntArray, integers: IntArray, tail: int) -> int:
    """Return the first index m such that the curve ``members[m]`` has a tail feature numbered ``tail`` or
    higher.

    ``members`` are indices of curves in ascending order of their tails. Return ``len(members)`` where there
    is no such curve. See ``base.tables`` for the layout of ``integers``.
    """
    low, high = int(np.int64(0)), members.shape[0]
    while low < high:
        middle = (low + high) // 2
        if integers[members[middle], TAIL] < tail:
            low = middle + 1
        else:
            high = middle
    return low


@inner
def write_member_spots(
    members: IntArray, psi: float, half: float, features: Features, curves: Curves, out: IntArray
) -> None:
    """Write, for each member curve, the spots (stretches of features) that its tail and its head may touch
    near psi.

    ``out`` (M, 4) receives the first and past-the-last number of the tail's spots, then of the head's, for
    orientations within ``half`` radians of psi. The tail's range is (0, 0), which is empty, where the curve
    does not exist there.
    """
    near, loose = features.near, features.loose
    for m in range(members.shape[0]):
        curve = members[m]
        whole, real = curves.integers[curve], curves.reals[curve]
        exists, there = wrap_into_range(curve, psi, half, curves.reals)
        out[m, 1] = out[m, 0] = 0
        if not exists:
            continue
        a, b = loose[whole[TAIL]], loose[whole[HEAD]]
        x, y, radius = enclose_tail(a, b, real, there, half + SLIVER)
        alpha, d = there + real[SHIFT], real[LENGTH]
        out[m, 0], out[m, 1] = find_spots(a, whole[TAIL], near, x, y, radius)
        x, y, radius = x + d * cos(alpha), y + d * sin(alpha), radius + d * (half + SLIVER)
        out[m, 2], out[m, 3] = find_spots(b, whole[HEAD], near, x, y, radius)


@inner
def write_slide_spots(
    pair: PlacedPair, sliding_pairs: SlidingPairs, features: Features, out: IntArray
) -> None:
    """Write the spots (stretches of features) that both pegs of a sliding pair may touch, for N equal parts
    of its range.

    ``out`` (N, 4) receives the first and past-the-last number of the tail's spots, then of the head's, for
    each part.
    """
    whole, real, near = sliding_pairs.integers[pair.number], sliding_pairs.reals[pair.number], features.near
    a, b = features.loose[whole[TAIL]], features.loose[whole[HEAD]]
    size = (real[SLIDE_TO] - real[SLIDE_FROM]) / out.shape[0]
    half = 0.5 * size * (1.0 if a[IS_ARC] == 0.0 else a[RADIUS])
    for k in range(out.shape[0]):
        x, y = compute_point(a, real[SLIDE_FROM] + (k + 0.5) * size)
        out[k, 0], out[k, 1] = find_spots(a, whole[TAIL], near, x, y, half)
        out[k, 2], out[k, 3] = find_spots(b, whole[HEAD], near, x + pair.x, y + pair.y, half + pair.swing)


@inner
def may_be_third(slides: IntArray, member: IntArray, near: NearSpots) -> bool:
    """Return whether a curve's head may be the third locator beside a sliding pair, by the triples of spots
    allowed.

    ``slides`` (N, 4) are the pair's spots, see :func:`write_slide_spots`; ``member`` (4,) is the curve's row
    of :func:`write_member_spots`; ``near`` tells which spots three locators may touch together.
    """
    for k in range(slides.shape[0]):
        for i in range(max(slides[k, 0], member[0]), min(slides[k, 1], member[1])):
            for j in range(slides[k, 2], slides[k, 3]):
                for n in range(member[2], member[3]):
                    if may_be_three(near, i, j, n):
                        return True
    return False


@inner
def add_fixtures_of_pair(
    out: Array,
    count: int,
    pair: PlacedPair,
    standing: int,
    sliding_pairs: SlidingPairs,
    members: IntArray,
    spots: IntArray,
    slides: IntArray,
    work: BlockWork,
) -> int:
    """Append the fixtures of a sliding pair and the member curves to ``out``.

    Return the new number of records, or NO_ROOM_FOR_RECORDS (-1).

    Parameters
    ----------
    standing : how many pegs stand still: 2, or 3, where the third is the head of a curve with the pair's tail
        feature.
    members : (M,) indices of curves in the order of their tails.
    spots, slides : results of :func:`write_member_spots` and :func:`write_slide_spots`; ``spots`` is (0, 4)
        where no curve is to be ruled out by spots.
    """
    stats, curves = work.stats, work.curves
    psi, whole = pair.angle.psi, sliding_pairs.integers[pair.number]
    near, asks_spots = work.features.near, spots.shape[0] > 0
    first, end = int(np.int64(0)), members.shape[0]
    if standing == 3:
        # Curves are in the order of their tails.
        first = find_first_of_tail(members, curves.integers, whole[TAIL])
        end = find_first_of_tail(members, curves.integers, whole[TAIL] + 1)
    for m in range(first, end):
        if stats[STOPPED] != 0:
            break
        curve = members[m]
        one = curves.integers[curve]
        if asks_spots and not may_be_third(slides, spots[m], near):
            continue
        if standing == 3 and not share_a_carrier(whole, one, work.limits):
            continue
        exists, there = wrap_into_range(curve, psi, pair.reach, curves.reals)
        if not exists or shares_a_line(curves.reals[curve], there):
            continue
        inside = pair.angle if there == psi else make_angle(there)
        if standing == 2:
            count = add_curve_fixtures(out, count, pair, curve, inside, sliding_pairs, work)
        else:
            count = add_fixtures_with_third_peg(out, count, pair, curve, inside, sliding_pairs, work)
        if count < 0:
            break
    return count


@compiled
def write_sliding_fixtures(
    standing: int,
    chosen: IntVector,
    sliding_pairs: SlidingPairs,
    members: IntVector,
    features: Features,
    curves: Curves,
    lattice: Lattice,
    limits: Limits,
    counting: bool,
    stats: IntVector,
    space: BlockSpace,
) -> int:
    """Write all fixtures that rest on one of the ``chosen`` sliding
    pairs and on curves of ``members`` to ``space.out``.

    ``chosen`` are row numbers of ``sliding_pairs``. ``standing`` is the number of standing pegs. Two cases:
    (a) 2: the pair is on one carrier, a curve's chord on the other; (b) 3: the pair and the head of a curve's
    chord stand, where pair and chord share their tail. Other parameters and the result are those of
    ``write_two_and_two``.
    """
    work = make_block_work(features, curves, lattice, limits, counting, stats, space)
    count, least, most = int(np.int64(0)), np.inf, -np.inf
    asks_spots = standing == 3 and features.near.joined.shape[0] > 0
    spots = space.spots[: members.shape[0] if asks_spots else 0]
    if asks_spots:
        for k in range(chosen.shape[0]):
            pair = place_pair(chosen[k], sliding_pairs, features.loose)
            least, most = min(least, pair.angle.psi - pair.reach), max(most, pair.angle.psi + pair.reach)
        write_member_spots(members, (least + most) / 2.0, (most - least) / 2.0, features, curves, spots)
    for k in range(chosen.shape[0]):
        number = chosen[k]
        if standing == 3 and not is_among(sliding_pairs.integers[number, TAIL], features.standing):
            continue
        pair = place_pair(number, sliding_pairs, features.loose)
        if asks_spots:
            write_slide_spots(pair, sliding_pairs, features, space.slides)
        count = add_fixtures_of_pair(
            space.out, count, pair, standing, sliding_pairs, members, spots, space.slides, work
        )
        if count < 0:
            return NO_ROOM_FOR_RECORDS
    return count
