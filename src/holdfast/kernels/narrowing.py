r"""Boxes about nearly double solutions, narrowed by the interval Newton method in double precision.

A box is z0 + V s with \|s_j\| <= w_j: V has the right singular vectors of the Jacobian J at the first middle as columns, U
the left ones, for there is a direction that is badly determined. With m the middle of a part of the box and F the distances
of the pegs from their lines and circles, every solution there has, for each k,

    0 = (U'F(m))_k + sum_j S_kj s_j,     \|S - U'J(m)V\| <= D,

by the mean value theorem. A part in which this or a rule (``vise_checks``) cannot hold is dropped; one that the step of
Hansen and Sengupta maps into its own inside holds exactly one solution; others are made smaller, or halved.

How much numbers vary over a part is bounded by norms: a peg's centre moves by at most ``drift``, its unit normal turns by at
most drift / (R - drift) on an arc and not at all on a line, and products vary by the sum of what their factors do.

References: E. Hansen, S. Sengupta, "Bounding solutions of systems of equations using interval analysis", BIT 21 (1981)
203-211; A. Neumaier, *Interval Methods for Systems of Equations*, Cambridge 1990, sections 1.6 and 5.2.
"""

from __future__ import annotations

from math import cos, hypot, inf, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from holdfast.kernels.certifying import DISCARDED, LEAST_REACH, OPEN, PROVEN, ROUNDINGS, end_slack, sizes
from holdfast.kernels.closure import minors
from holdfast.kernels.compiling import compiled, inner
from holdfast.kernels.contacts import (
    BLUR,
    CONTACT_MARGIN,
    MIN_GAP,
    NEWTON,
    OFF,
    SLIDE,
    SLOPES,
    UNKNOWNS,
    WORK_LENGTH,
    WRENCH_LENGTH,
    take_pegs,
    touch,
)
from holdfast.kernels.vise_checks import (
    APART,
    FEATURES,
    GAP_SLACK,
    LEAST_CLAMPING,
    LEAST_CLOSURE,
    LEAST_SPAN,
    PSI,
    RADIUS,
    REACH,
    ROUNDING,
    TAIL_X,
    TAIL_Y,
)

Array = NDArray[np.float64]
Verdicts = NDArray[np.int8]

# A box is given up after so many parts, or when one is as small as this, in mm.
MOST_PARTS = 20000
LEAST_WIDTH = 1e-12
DEPTH = 256
# Half a unit in the last place.
HALF_UNIT = 1.2e-16
# The exact solution of a box may lie on its rim, so boxes are made larger by this part.
RIM = 0.1
# A part is looked at again when a step leaves less than this of a side; halves are a little more than that.
SMALLER = 0.7
HALF = 0.5001
# Most roots handed back for each record.
ROOTS = 4
# Steps taken once it is known that a part has exactly one solution.
SHARPENINGS = 4

# Rows of the numbers (11, 4) of a part, one for each peg: how far its centre moves, how much its normal turns, its arm from
# the first peg and how much that varies, its moment and how much that varies, its push along the vise's x axis and how much
# that varies, the error of its contact equation, and how much the minor without it varies. How much the turn and the opening
# vary comes last.
DRIFT, TILT, ARM, ARM_BAND, MOMENT, MOMENT_BAND, PUSH, PUSH_BAND, ERROR, MINOR_BAND, OTHERS = range(11)
NUMBERS = 11


@inner
def move_to(z: Array, place: Array, frame: Array, length: float, w: Array) -> None:
    """Bring the unknowns to the middle of a part, z0 + V s, with what rounding leaves of the sum, in mm, at NEWTON."""
    for i in range(4):
        step = 0.0
        for j in range(4):
            step += frame[1, i, j] * place[0, j]
        scale = length if i == 0 else 1.0
        step /= scale
        total = z[i] + step
        part = total - z[i]
        w[UNKNOWNS, i] = total
        w[NEWTON, i] = ((z[i] - (total - part)) + (step - part)) * scale


@inner
def spread(
    record: Array,
    features: Array,
    size: float,
    setting: Array,
    place: Array,
    frame: Array,
    w: Array,
    pairs: Array,
    b: Array,
) -> None:
    """Fill in how much the contacts in place vary over a part: drifts, tilts and arms, with the arms and normals
    themselves in ``pairs`` (3, 4, 2) behind the centres."""
    length, blur = setting[WRENCH_LENGTH], setting[BLUR]
    cosine, sine = cos(w[UNKNOWNS, 0]), sin(w[UNKNOWNS, 0])
    turn = slide = 0.0
    for j in range(4):
        turn += abs(frame[1, 0, j]) * place[1, j] / length
        slide += abs(frame[1, 3, j]) * place[1, j]
    b[OTHERS, 0], b[OTHERS, 1] = turn, slide
    for k in range(4):
        row = features[int(record[FEATURES + k])]
        right = w[SLIDE, k]
        x, y = pairs[0, k, 0] - w[UNKNOWNS, 1], pairs[0, k, 1] - w[UNKNOWNS, 2]
        arm = sqrt(x * x + y * y)
        drift = turn * (arm * turn + right * slide) + ROUNDINGS * size
        for j in range(4):
            about = frame[1, 0, j] / length
            along = right * frame[1, 3, j]
            away_x = frame[1, 1, j] + along * cosine - about * y
            away_y = frame[1, 2, j] + along * sine + about * x
            drift += place[1, j] * sqrt(away_x * away_x + away_y * away_y)
        tilt, sign = 0.0, 1.0
        ray = abs(pairs[0, k, 0]) + abs(pairs[0, k, 1]) + abs(row[1]) + abs(row[2])
        # Seven roundings of each coordinate of the arm, one of the sum with the tail's, one of the difference from the
        # feature's middle, and four of products and root.
        b[ERROR, k] = HALF_UNIT * (10.0 * arm + 6.0 * ray) + blur
        if row[0] != 0.0:
            ray = row[6] + w[OFF, k]
            tilt = drift / (ray - drift) + ROUNDING if 2.0 * drift < ray else 4.0
            sign = row[7]
        b[DRIFT, k], b[TILT, k], b[ARM, k], b[ARM_BAND, k] = drift, tilt, arm, arm * turn + right * slide
        pairs[1, k, 0], pairs[1, k, 1] = x, y
        pairs[2, k, 0], pairs[2, k, 1] = sign * w[SLOPES + k, 1], sign * w[SLOPES + k, 2]
        moment = (x * pairs[2, k, 1] - y * pairs[2, k, 0]) / length
        b[MOMENT, k] = abs(moment)
        b[MOMENT_BAND, k] = ((arm + b[ARM_BAND, k]) * tilt + b[ARM_BAND, k] + ROUNDINGS * size) / length
        b[PUSH, k] = pairs[2, k, 0] * cosine + pairs[2, k, 1] * sine
        b[PUSH_BAND, k] = tilt + turn + ROUNDINGS


@inner
def turned_by(record: Array, features: Array, i: int, j: int, pairs: Array, w: Array, b: Array) -> tuple[float, float]:
    """Size of the cross product of two normals, and how much it varies over a part."""
    one, other = pairs[2, i, 0] * pairs[2, j, 1], pairs[2, i, 1] * pairs[2, j, 0]
    cross = one - other
    band = b[TILT, i] + b[TILT, j] + b[TILT, i] * b[TILT, j]
    if abs(pairs[2, i, 0]) != abs(pairs[2, j, 0]) or abs(pairs[2, i, 1]) != abs(pairs[2, j, 1]) or cross != 0.0:
        # Normals of exactly the same or opposite direction, as lines have, are parallel without error.
        band += ROUNDINGS * (abs(one) + abs(other))
    return (abs(cross), min(band, arcs_turned_by(record, features, i, j, pairs, w, b)))


@inner
def arcs_turned_by(record: Array, features: Array, i: int, j: int, pairs: Array, w: Array, b: Array) -> float:
    """How much the cross product of the normals of two arcs varies over a part; infinite for others.

    Only the difference of the rays from their centres counts, which depends on the orientation alone where both pegs are on
    one jaw: parallel normals stay so wherever the part slides.
    """
    one, two = features[int(record[FEATURES + i])], features[int(record[FEATURES + j])]
    if one[0] == 0.0 or two[0] == 0.0:
        return inf
    x, y = pairs[1, j, 0] - pairs[1, i, 0], pairs[1, j, 1] - pairs[1, i, 1]
    varies = hypot(x, y) * b[OTHERS, 0] + abs(w[SLIDE, i] - w[SLIDE, j]) * b[OTHERS, 1]
    apart = hypot(x - two[1] + one[1], y - two[2] + one[2])
    return (b[TILT, i] * (apart + varies) + varies) / two[6] + ROUNDING


@inner
def is_broken(record: Array, features: Array, setting: Array, w: Array, pairs: Array, null: Array, b: Array) -> bool:
    """Whether some rule is broken everywhere in a part."""
    reach = 0.0
    right, left = inf, -inf
    for k in range(4):
        row = features[int(record[FEATURES + k])]
        reach = max(reach, b[DRIFT, k] if row[0] == 0.0 else row[6] * b[TILT, k])
        if w[SLIDE, k] == 0.0:
            left = max(left, w[2, k])
        else:
            right = min(right, w[2, k] + w[UNKNOWNS, 3])
    if right - left + b[OTHERS, 1] + LEAST_WIDTH < setting[MIN_GAP] - GAP_SLACK:
        return True
    if end_slack(record, features, pairs[0], setting[CONTACT_MARGIN]) + reach + LEAST_WIDTH < 0.0:
        return True
    size = minors(pairs[1], pairs[2], setting[WRENCH_LENGTH], null)
    for k in range(4):
        b[MINOR_BAND, k] = 0.0
    for i in range(4):
        for j in range(i + 1, 4):
            cross, band = turned_by(record, features, i, j, pairs, w, b)
            for a in range(4):
                if a != i and a != j:
                    moment = b[MOMENT_BAND, a] + ROUNDINGS * b[MOMENT, a]
                    b[MINOR_BAND, 6 - i - j - a] += b[MOMENT, a] * band + cross * moment + band * moment
    doubt = b[MINOR_BAND, 0] + b[MINOR_BAND, 1] + b[MINOR_BAND, 2] + b[MINOR_BAND, 3]
    if size + doubt < LEAST_SPAN:
        return True
    size = max(size - doubt, 0.0)
    return not (may_clamp(1.0, size, w, null, b) or may_clamp(-1.0, size, w, null, b))


@inner
def may_clamp(sign: float, size: float, w: Array, null: Array, b: Array) -> bool:
    """Whether forces of one sign may close, and closing the vise clamp; the force is the left jaw's push, and as well what
    the right jaw takes up. ``size`` is the least that the sizes of the minors add up to."""
    left = right = 0.0
    for k in range(4):
        band = b[MINOR_BAND, k]
        if sign * null[k] + band < LEAST_CLOSURE * size:
            return False
        push = sign * null[k] * b[PUSH, k]
        doubt = abs(null[k]) * b[PUSH_BAND, k] + band * abs(b[PUSH, k]) + band * b[PUSH_BAND, k]
        if w[SLIDE, k] == 0.0:
            left += doubt - push
        else:
            right += doubt + push
    return left >= LEAST_CLAMPING * size and right >= LEAST_CLAMPING * size


@inner
def combine(frame: Array, size: float, length: float, w: Array, b: Array, slopes: Array) -> None:
    """Fill in ``slopes`` (4, 4, 4): the Jacobian in the frame, how much each entry varies over a part, and of the combined
    values (row 0) and their errors (row 1); the last is work space."""
    for k in range(4):
        tilt, moment, push = b[TILT, k], b[MOMENT_BAND, k], w[SLIDE, k] * b[PUSH_BAND, k]
        for j in range(4):
            along = 0.0
            for n in range(4):
                along += w[SLOPES + k, n] * frame[1, n, j]
            slopes[3, k, j] = along
            flat = abs(frame[1, 1, j]) + abs(frame[1, 2, j])
            slopes[2, k, j] = moment * abs(frame[1, 0, j]) + tilt * flat + push * abs(frame[1, 3, j])
    for i in range(4):
        for j in range(4):
            slopes[0, i, j], slopes[1, i, j] = 0.0, ROUNDING * (1.0 + size / length)
        for k in range(4):
            weight = frame[0, k, i]
            for j in range(4):
                slopes[0, i, j] += weight * slopes[3, k, j]
                slopes[1, i, j] += abs(weight) * slopes[2, k, j]
    for i in range(4):
        slopes[2, 0, i] = slopes[2, 1, i] = 0.0
        for k in range(4):
            # The middle itself is rounded: by so much are the values there off those at the true one.
            off = w[OFF, k]
            for n in range(4):
                off += w[SLOPES + k, n] * w[NEWTON, n]
            slopes[2, 0, i] += frame[0, k, i] * off
            slopes[2, 1, i] += abs(frame[0, k, i]) * b[ERROR, k]


@inner
def step(place: Array, slopes: Array, bounds: Array) -> int:
    """A step of Hansen and Sengupta.

    Parameters
    ----------
    place : (2, 4) middle and half widths of a part.
    slopes : see :func:`combine`.
    bounds : (2, 4) receives the lower and upper ends of what remains, from the middle.

    Returns
    -------
    DISCARDED without solutions, PROVEN with exactly one, else OPEN
    """
    verdict = PROVEN
    for k in range(4):
        bounds[0, k], bounds[1, k] = -place[1, k], place[1, k]
    for k in range(4):
        low, high = slopes[2, 0, k] - slopes[2, 1, k], slopes[2, 0, k] + slopes[2, 1, k]
        for j in range(4):
            if j != k:
                one, two = slopes[0, k, j] * bounds[0, j], slopes[0, k, j] * bounds[1, j]
                far = slopes[1, k, j] * max(-bounds[0, j], bounds[1, j])
                low, high = low + min(one, two) - far, high + max(one, two) + far
        slope, band = slopes[0, k, k], slopes[1, k, k]
        if slope < 0.0:
            slope, low, high = -slope, -high, -low
        if slope <= band:
            far = (slope + band) * place[1, k]
            if low > far or high < -far:
                return DISCARDED
            verdict = OPEN
            continue
        # The image is -[low, high] / [slope - band, slope + band].
        least = -high / (slope - band if high > 0.0 else slope + band) - LEAST_WIDTH * place[1, k]
        most = -low / (slope - band if low < 0.0 else slope + band) + LEAST_WIDTH * place[1, k]
        if least > bounds[1, k] or most < bounds[0, k]:
            return DISCARDED
        if least <= bounds[0, k] or most >= bounds[1, k]:
            verdict = OPEN
        bounds[0, k], bounds[1, k] = max(least, bounds[0, k]), min(most, bounds[1, k])
    return verdict


@inner
def begin(record: Array, frame: Array, length: float, place: Array) -> None:
    """The whole box of a record in its frame, a little larger."""
    turn = length * record[REACH] + LEAST_REACH
    radius = record[RADIUS] + LEAST_REACH
    for j in range(4):
        place[0, j] = 0.0
        tail = abs(frame[1, 1, j]) + abs(frame[1, 2, j]) + 2.0 * abs(frame[1, 3, j])
        place[1, j] = (1.0 + RIM) * (abs(frame[1, 0, j]) * turn + tail * radius + 2.0 * abs(frame[1, 3, j]) * turn)


@inner
def write_root(record: Array, frame: Array, length: float, w: Array, bounds: Array, root: Array) -> None:
    """Write a part with exactly one solution as a record: its middle, and how far the solution may be from there."""
    for k in range(PSI):
        root[k] = record[k]
    root[PSI], root[TAIL_X] = w[UNKNOWNS, 0], w[UNKNOWNS, 1]
    root[TAIL_Y], root[APART] = w[UNKNOWNS, 2], w[UNKNOWNS, 3]
    root[REACH] = root[RADIUS] = 0.0
    for j in range(4):
        width = max(-bounds[0, j], bounds[1, j])
        root[REACH] += abs(frame[1, 0, j]) * width / length
        root[RADIUS] += max(max(abs(frame[1, 1, j]), abs(frame[1, 2, j])), abs(frame[1, 3, j]) / 2.0) * width


@inner
def push_parts(stack: Array, waiting: int, place: Array, bounds: Array, least: float, whole: bool) -> int:
    """Put what remains of a part on the stack: ``whole`` or when it became much smaller in a direction where it was more
    than ``least`` mm wide, else in halves; the new height."""
    longest, smaller = 0, False
    for j in range(4):
        side = bounds[1, j] - bounds[0, j]
        smaller = smaller or (place[1, j] > least and side < SMALLER * 2.0 * place[1, j])
        if side > bounds[1, longest] - bounds[0, longest]:
            longest = j
    smaller = smaller or whole
    for half in range(1 if smaller else 2):
        for j in range(4):
            width = (bounds[1, j] - bounds[0, j]) / 2.0
            stack[waiting + half, 0, j] = place[0, j] + (bounds[0, j] + bounds[1, j]) / 2.0
            stack[waiting + half, 1, j] = (1.0 + 1e-12) * width
        if not smaller:
            width = stack[waiting + half, 1, longest]
            stack[waiting + half, 0, longest] += width / 2.0 if half else -width / 2.0
            stack[waiting + half, 1, longest] = HALF * width
    return waiting + (1 if smaller else 2)


@inner
def narrow(
    record: Array,
    features: Array,
    setting: Array,
    frame: Array,
    stack: Array,
    w: Array,
    pairs: Array,
    null: Array,
    roots: Array,
) -> int:
    """Find every solution of a box that may be a fixture.

    Parameters
    ----------
    record : (19,) the box.
    frame : (2, 4, 4) U and V.
    roots : (ROOTS, 19) receives boxes with exactly one solution each.

    Returns
    -------
    How many there are; -1 when the box is given up
    """
    length = setting[WRENCH_LENGTH]
    b, slopes = np.empty((NUMBERS, 4)), np.empty((4, 4, 4))
    place, bounds, z = np.empty((2, 4)), np.empty((2, 4)), np.empty(4)
    take_pegs(record, setting, w)
    for j in range(4):
        z[j] = w[UNKNOWNS, j]
    begin(record, frame, length, stack[0])
    waiting, found, steps = 1, 0, 0
    for _ in range(MOST_PARTS):
        if waiting == 0:
            return found
        waiting -= 1
        for j in range(4):
            place[0, j], place[1, j] = stack[waiting, 0, j], stack[waiting, 1, j]
        move_to(z, place, frame, length, w)
        touch(record, features, length, w, pairs[0])
        size, _ = sizes(record, features, pairs[0])
        least = ROUNDINGS * (size + length)
        spread(record, features, size, setting, place, frame, w, pairs, b)
        if is_broken(record, features, setting, w, pairs, null, b):
            steps = 0
            continue
        combine(frame, size, length, w, b, slopes)
        verdict = step(place, slopes, bounds)
        if verdict == DISCARDED:
            steps = 0
            continue
        # A part with exactly one solution is made smaller for some more steps.
        steps = steps + 1 if verdict == PROVEN or steps > 0 else 0
        if steps > SHARPENINGS:
            if found == ROOTS:
                return -1
            write_root(record, frame, length, w, bounds, roots[found])
            found, steps = found + 1, 0
            continue
        if steps == 0 and (
            waiting + 2 > DEPTH or max(max(place[1, 0], place[1, 1]), max(place[1, 2], place[1, 3])) < least
        ):
            return -1
        waiting = push_parts(stack, waiting, place, bounds, least, steps > 0)
    return -1


@compiled
def narrowed(records: Array, features: Array, setting: Array, frames: Array) -> tuple[Verdicts, Array]:
    """Narrow boxes one by one.

    Parameters
    ----------
    records : (N, 19), see ``kernels.vise_checks``; where their contacts may be is finite.
    features : (F, 10) rows with the slack of their ends.
    setting : see ``kernels.contacts``.
    frames : (N, 2, 4, 4) U and V of each.

    Returns
    -------
    ((N,) verdicts, open for boxes that are given up; (M, 19) boxes in place of the others, with exactly one solution each)
    """
    verdicts = np.empty(records.shape[0], np.int8)
    roots = np.empty((ROOTS * records.shape[0], records.shape[1]))
    stack, w = np.empty((DEPTH, 2, 4)), np.empty((WORK_LENGTH, 4))
    pairs, null = np.empty((3, 4, 2)), np.empty(4)
    count = 0
    for n in range(records.shape[0]):
        found = narrow(records[n], features, setting, frames[n], stack, w, pairs, null, roots[count : count + ROOTS])
        verdicts[n] = OPEN if found < 0 else DISCARDED
        count += max(found, 0)
    return verdicts, roots[:count].copy()


@compiled
def jacobians(records: Array, features: Array, setting: Array) -> Array:
    """Jacobians (N, 4, 4) of the contact equations at the middles of records."""
    out = np.empty((records.shape[0], 4, 4))
    w, points = np.empty((WORK_LENGTH, 4)), np.empty((4, 2))
    for n in range(records.shape[0]):
        take_pegs(records[n], setting, w)
        touch(records[n], features, setting[WRENCH_LENGTH], w, points)
        for i in range(4):
            for j in range(4):
                out[n, i, j] = w[SLOPES + i, j]
    return out
