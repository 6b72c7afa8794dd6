r"""Boxes about nearly double solutions, contracted by the interval Newton method in double precision.

A box is z0 + V s with \|s_j\| <= w_j: V has the right singular vectors of the Jacobian J at the first middle
as columns, U the left ones. A direction may be badly determined. With m the middle of a part of the box and F
the distances of the pegs from their lines and circles, every solution there has, for each k,

    0 = (U'F(m))_k + sum_j S_kj s_j,     \|S - U'J(m)V\| <= D,

by the mean value theorem. A part in which this or a rule (``contact.rules``) cannot hold is dropped. One that
the step of Hansen and Sengupta maps into its own inside holds exactly one solution; others are made smaller,
or halved.

How much contacts vary over a part, ``variation`` bounds.

References: E. Hansen, S. Sengupta, "Bounding solutions of systems of equations using interval analysis", BIT
21 (1981) 203-211; A. Neumaier, *Interval Methods for Systems of Equations*, Cambridge 1990, sections 1.6 and
5.2.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from workhold.kernels.base.compiling import (
    Array,
    ByteArray,
    ByteVector,
    Matrix,
    Stack,
    Stacks,
    Vector,
    compiled,
    inner,
)
from workhold.kernels.base.tables import Setting
from workhold.kernels.contact.record import (
    LARGEST_RADIUS,
    MOVING,
    NEWTON,
    OFF,
    PSI,
    REACH,
    SEPARATION,
    SLOPES,
    TAIL_X,
    TAIL_Y,
    UNKNOWNS,
    WORK_LENGTH,
    take_pegs,
    touch,
)
from workhold.kernels.contact.rules import ROUNDING
from workhold.kernels.proof.newton_kantorovich import DISCARDED, LEAST_REACH, OPEN, PROVEN, ROUNDINGS, sizes
from workhold.kernels.proof.variation import (
    ERROR,
    FORCE_BAND,
    MOMENT_BAND,
    NUMBERS,
    TILT,
    is_broken,
    move_to,
    spread,
)

# A box is given up after so many parts; sides of what remains are made larger by this part, for rounding.
MOST_PARTS = 200_000
WIDER = 1e-12
DEPTH = 256
# The exact solution of a box may lie on its rim, so boxes are made larger by this part.
RIM = 0.1
# A part is looked at again when a step leaves less than this of a side; halves are a little more than that.
SMALLER = 0.7
HALF = 0.5001
# Most roots handed back for each record.
ROOTS = 4
# Steps taken once it is known that a part has exactly one solution.
SHARPENINGS = 4


class NewtonWorkSpace(NamedTuple):
    """What parts of a box are worked with; made once, so that no part makes an array.

    Parameters
    ----------
    w, pairs : (19, 4) and (3, 4, 2), see ``contact.record`` and ``variation``.
    stack : (DEPTH, 2, 4) parts that wait, as middles and half widths.
    numbers : (10, 4), see ``variation``.
    slopes : (4, 4, 4), see :func:`combine`.
    place, bounds : (2, 4) the part that is looked at, and what remains of it.
    start : (4,) the middle of the box.
    """

    w: Matrix
    pairs: Stack
    stack: Stack
    numbers: Matrix
    slopes: Stack
    place: Matrix
    bounds: Matrix
    start: Vector


def make_newton_space() -> NewtonWorkSpace:
    """Return memory to contract boxes in."""
    return NewtonWorkSpace(
        np.empty((WORK_LENGTH, 4)),
        np.empty((3, 4, 2)),
        np.empty((DEPTH, 2, 4)),
        np.empty((NUMBERS, 4)),
        np.empty((4, 4, 4)),
        np.empty((2, 4)),
        np.empty((2, 4)),
        np.empty(4),
    )


@inner
def combine(frame: Array, size: float, length: float, w: Array, b: Array, slopes: Array) -> None:
    """Fills in ``slopes`` (4, 4, 4).

    They are the Jacobian in the frame, how much each entry varies over a part, and of the combined values
    (row 0) and their errors (row 1). The last is work space.
    """
    for k in range(4):
        tilt, moment, push = b[TILT, k], b[MOMENT_BAND, k], w[MOVING, k] * b[FORCE_BAND, k]
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
            slopes[2, 1, i] += abs(frame[0, k, i]) * (b[ERROR, k] + ROUNDINGS * abs(off))


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
                far = slopes[1, k, j] * max(-bounds[0, j], bounds[1, j]) + ROUNDINGS * max(abs(one), abs(two))
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
        least = -high / (slope - band if high > 0.0 else slope + band) - WIDER * place[1, k]
        most = -low / (slope - band if low < 0.0 else slope + band) + WIDER * place[1, k]
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
    radius = record[LARGEST_RADIUS] + LEAST_REACH
    for j in range(4):
        place[0, j] = 0.0
        tail = abs(frame[1, 1, j]) + abs(frame[1, 2, j]) + 2.0 * abs(frame[1, 3, j])
        place[1, j] = (1.0 + RIM) * (
            abs(frame[1, 0, j]) * turn + tail * radius + 2.0 * abs(frame[1, 3, j]) * turn
        )


@inner
def write_root(record: Array, frame: Array, length: float, w: Array, bounds: Array, root: Array) -> None:
    """Writes a part with exactly one solution as a record: its middle, and how far the solution may be from
    there."""
    for k in range(PSI):
        root[k] = record[k]
    root[PSI], root[TAIL_X] = w[UNKNOWNS, 0], w[UNKNOWNS, 1]
    root[TAIL_Y], root[SEPARATION] = w[UNKNOWNS, 2], w[UNKNOWNS, 3]
    root[REACH] = root[LARGEST_RADIUS] = 0.0
    for j in range(4):
        width = max(-bounds[0, j], bounds[1, j])
        root[REACH] += abs(frame[1, 0, j]) * width / length
        root[LARGEST_RADIUS] += (
            max(max(abs(frame[1, 1, j]), abs(frame[1, 2, j])), abs(frame[1, 3, j]) / 2.0) * width
        )


@inner
def push_parts(stack: Array, waiting: int, place: Array, bounds: Array, least: float, whole: bool) -> int:
    """Puts what remains of a part on the stack: ``whole`` or when it became much smaller in a direction where
    it was more than ``least`` mm wide, else in halves. Returns the new height."""
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
            # Middles are rounded.
            stack[waiting + half, 1, j] = (1.0 + WIDER) * width + ROUNDINGS * (abs(place[0, j]) + width)
        if not smaller:
            width = stack[waiting + half, 1, longest]
            stack[waiting + half, 0, longest] += width / 2.0 if half else -width / 2.0
            stack[waiting + half, 1, longest] = HALF * width
    return waiting + (1 if smaller else 2)


@inner
def solutions_in(
    record: Array,
    features: Array,
    setting: Setting,
    frame: Array,
    space: NewtonWorkSpace,
    roots: Array,
) -> int:
    """Finds every solution of a box that may be a fixture.

    Parameters
    ----------
    record : (19,) the box.
    frame : (2, 4, 4) U and V.
    roots : (ROOTS, 19) receives boxes with exactly one solution each.

    Returns
    -------
    How many there are; -1 when the box is given up
    """
    length = setting.limits.wrench_length
    w, pairs, b, slopes, stack = space.w, space.pairs, space.numbers, space.slopes, space.stack
    place, bounds = space.place, space.bounds
    take_pegs(record, setting.lattice, w)
    for j in range(4):
        space.start[j] = w[UNKNOWNS, j]
    begin(record, frame, length, stack[0])
    waiting, found, steps = 1, 0, 0
    for _ in range(MOST_PARTS):
        if waiting == 0:
            return found
        waiting -= 1
        for j in range(4):
            place[0, j], place[1, j] = stack[waiting, 0, j], stack[waiting, 1, j]
        move_to(space.start, place, frame, length, w)
        touch(record, features, length, w, pairs[0])
        size, _ = sizes(record, features, pairs[0])
        least = ROUNDINGS * (size + length)
        spread(record, features, size, setting, place, frame, w, pairs, b)
        if is_broken(record, features, setting, w, pairs, b):
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
def write_solutions(
    records: Matrix,
    features: Matrix,
    setting: Setting,
    frames: Stacks,
    space: NewtonWorkSpace,
    verdicts: ByteVector,
    roots: Matrix,
) -> int:
    """Write the verdict on each box and the roots of all, see :func:`interval_newton`, and return how many
    there are."""
    count = int(np.int64(0))
    for n in range(records.shape[0]):
        found = solutions_in(records[n], features, setting, frames[n], space, roots[count : count + ROOTS])
        verdicts[n] = OPEN if found < 0 else DISCARDED
        count += max(found, 0)
    return count


def interval_newton(
    records: Array, features: Array, setting: Setting, frames: Array
) -> tuple[ByteArray, Array]:
    """Contract boxes one by one.

    Parameters
    ----------
    records : (N, 19), see ``kernels.contact.record``; where their contacts may be is finite.
    features : (F, 12) rows with the slack of their ends.
    frames : (N, 2, 4, 4) U and V of each.

    Returns
    -------
    ((N,) verdicts, open for boxes that are given up; (M, 19) boxes in place of the others, with exactly one
    solution each)
    """
    verdicts = np.empty(records.shape[0], np.int8)
    roots = np.empty((ROOTS * records.shape[0], records.shape[1]))
    count = write_solutions(records, features, setting, frames, make_newton_space(), verdicts, roots)
    return verdicts, roots[:count].copy()


@compiled
def write_jacobians(
    records: Matrix, features: Matrix, setting: Setting, w: Matrix, points: Matrix, out: Stack
) -> None:
    """Write the Jacobians (N, 4, 4) of the contact equations at the middles of records."""
    for n in range(records.shape[0]):
        take_pegs(records[n], setting.lattice, w)
        touch(records[n], features, setting.limits.wrench_length, w, points)
        for i in range(4):
            for j in range(4):
                out[n, i, j] = w[SLOPES + i, j]


def jacobians(records: Array, features: Array, setting: Setting) -> Array:
    """Return the Jacobians (N, 4, 4) of the contact equations at the middles of records."""
    out = np.empty((records.shape[0], 4, 4))
    write_jacobians(records, features, setting, np.empty((WORK_LENGTH, 4)), np.empty((4, 2)), out)
    return out
