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
    read_record,
    write_contact_equations,
)
from workhold.kernels.contact.rules import ROUNDING
from workhold.kernels.proof.newton_kantorovich import (
    DISCARDED,
    LEAST_REACH,
    OPEN,
    PROVEN,
    ROUNDINGS,
    measure_sizes,
)
from workhold.kernels.proof.variation import (
    ERROR,
    FORCE_BAND,
    MOMENT_BAND,
    NUMBERS,
    TILT,
    is_broken,
    move_to_part_middle,
    write_variation,
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
    """Work space for contracting a box, made once, so that no part of the box makes an array.

    Parameters
    ----------
    w, pairs : (19, 4) and (3, 4, 2), see ``contact.record`` and ``variation``.
    stack : (DEPTH, 2, 4) parts that wait, as middles and half widths in the box's frame, in mm.
    numbers : (10, 4), see ``variation``.
    slopes : (4, 4, 4), see :func:`write_combined_slopes`.
    place, bounds : (2, 4) the part at hand as middle and half widths, and what remains of it, see
        :func:`contract_box`.
    start : (4,) the middle of the box, as unknowns z.
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
    """Return new work space, not initialized, to contract boxes in."""
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
def write_combined_slopes(
    frame: Array, size: float, length: float, w: Array, b: Array, slopes: Array
) -> None:
    """Write the system that :func:`contract_box` solves to ``slopes`` (4, 4, 4).

    ``slopes[0]`` is U'JV, the Jacobian J in the box's frame, ``slopes[1]`` how much each of its entries
    varies over the part. ``slopes[2, 0]`` are the values U'F at the middle in mm, ``slopes[2, 1]`` their
    error bounds. ``slopes[3]`` is work space.

    Parameters
    ----------
    frame : (2, 4, 4) U and V, the left and right singular vectors of the Jacobian in columns.
    size : size in mm of the numbers in the contact equations F, see ``newton_kantorovich.measure_sizes``.
    length : L in mm, by which moments are divided.
    w, b : of the contacts at the part's middle, see ``contact.record`` and ``proof.variation``.
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
def contract_box(place: Array, slopes: Array, bounds: Array) -> int:
    """Take one step of Hansen and Sengupta on a part of a box.

    Parameters
    ----------
    place : (2, 4) middle and half widths of the part.
    slopes : see :func:`write_combined_slopes`.
    bounds : (2, 4) receives the lower and upper ends of what remains, relative to the middle.

    Returns
    -------
    DISCARDED when the part has no solution, PROVEN when it has exactly one, else OPEN
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
def write_whole_box(record: Array, frame: Array, length: float, place: Array) -> None:
    """Write the box of a record in its frame, enlarged by ``RIM``, to
    ``place`` (2, 4): middle 0 and half widths in mm.

    ``frame`` is (2, 4, 4), left and right singular vectors of the Jacobian in columns. See ``contact.record``
    for the layout of ``record``.
    """
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
    """Write a part with exactly one solution to ``root`` (19,), as a record at the middle of what remains of
    the part.

    ``bounds`` (2, 4) are the lower and upper ends of what remains, relative to the unknowns in ``w``, in the
    directions of ``frame[1]``. REACH (radians) and LARGEST_RADIUS (mm) bound how far the solution may be from
    the middle. See ``contact.record`` for the layout of ``record``, ``w`` and ``root``.
    """
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
    """Push what remains of a part on the stack, undivided or cut in two across its longest side; return the
    new height.

    It stays undivided when ``whole``, or when it became much smaller along an axis where its half width was
    more than ``least`` mm. ``waiting`` is the height before, which must be at most DEPTH - 2.
    """
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
def find_solutions(
    record: Array,
    features: Array,
    setting: Setting,
    frame: Array,
    space: NewtonWorkSpace,
    roots: Array,
) -> int:
    """Find every solution in a box that may be a fixture.

    See ``contact.record`` for the layout of ``record`` and ``roots``, ``base.feature`` for that of
    ``features``.

    Parameters
    ----------
    record : (19,) the box.
    features : (F, 12) rows with the slack of their ends.
    frame : (2, 4, 4) left and right singular vectors of the Jacobian in columns.
    roots : (ROOTS, 19) receives records of boxes with exactly one solution each.

    Returns
    -------
    Number of solutions; -1 when the box is given up
    """
    length = setting.limits.wrench_length
    w, pairs, b, slopes, stack = space.w, space.pairs, space.numbers, space.slopes, space.stack
    place, bounds = space.place, space.bounds
    read_record(record, setting.lattice, w)
    for j in range(4):
        space.start[j] = w[UNKNOWNS, j]
    write_whole_box(record, frame, length, stack[0])
    waiting, found, steps = 1, 0, 0
    for _ in range(MOST_PARTS):
        if waiting == 0:
            return found
        waiting -= 1
        for j in range(4):
            place[0, j], place[1, j] = stack[waiting, 0, j], stack[waiting, 1, j]
        move_to_part_middle(space.start, place, frame, length, w)
        write_contact_equations(record, features, length, w, pairs[0])
        size, _ = measure_sizes(record, features, pairs[0])
        least = ROUNDINGS * (size + length)
        write_variation(record, features, size, setting, place, frame, w, pairs, b)
        if is_broken(record, features, setting, w, pairs, b):
            steps = 0
            continue
        write_combined_slopes(frame, size, length, w, b, slopes)
        verdict = contract_box(place, slopes, bounds)
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
    """Write a verdict on each box to ``verdicts`` and a box around each solution to ``roots``; return the
    number of roots.

    ``verdicts`` (N,) are OPEN for a box that is given up, else DISCARDED: its roots take its place. ``roots``
    must have ROOTS rows for each record. Other parameters are those of :func:`contract_boxes`. See
    ``contact.record`` for the layout of ``records`` and ``roots``, ``base.feature`` for that of ``features``.
    """
    count = int(np.int64(0))
    for n in range(records.shape[0]):
        found = find_solutions(records[n], features, setting, frames[n], space, roots[count : count + ROOTS])
        verdicts[n] = OPEN if found < 0 else DISCARDED
        count += max(found, 0)
    return count


def contract_boxes(
    records: Array, features: Array, setting: Setting, frames: Array
) -> tuple[ByteArray, Array]:
    """Find the solutions in boxes, one box after the other.

    See ``base.feature`` for the layout of ``features``.

    Parameters
    ----------
    records : (N, 19), see ``kernels.contact.record``, with finite REACH and LARGEST_RADIUS.
    features : (F, 12) rows with the slack of their ends.
    frames : (N, 2, 4, 4) left and right singular vectors of each record's Jacobian in columns.

    Returns
    -------
    ((N,) verdicts, OPEN for boxes that are given up and DISCARDED for all others; (M, 19) records of boxes
        with exactly one solution each, which take the place of the discarded boxes)
    """
    verdicts = np.empty(records.shape[0], np.int8)
    roots = np.empty((ROOTS * records.shape[0], records.shape[1]))
    count = write_solutions(records, features, setting, frames, make_newton_space(), verdicts, roots)
    return verdicts, roots[:count].copy()


@compiled
def write_jacobians(
    records: Matrix, features: Matrix, setting: Setting, w: Matrix, points: Matrix, out: Stack
) -> None:
    """Write the Jacobians of the contact equations at the middles of records to ``out`` (N, 4, 4).

    Rows are pegs, columns (L psi, tail x, tail y, separation); no unit. ``w`` (19, 4) and ``points`` (4, 2)
    are work space. See ``contact.record`` for the layout of ``records`` and ``w``, ``base.feature`` for that
    of ``features``.
    """
    for n in range(records.shape[0]):
        read_record(records[n], setting.lattice, w)
        write_contact_equations(records[n], features, setting.limits.wrench_length, w, points)
        for i in range(4):
            for j in range(4):
                out[n, i, j] = w[SLOPES + i, j]


def compute_jacobians(records: Array, features: Array, setting: Setting) -> Array:
    """Return the Jacobians (N, 4, 4) of the contact equations at the middles of records (N, 19).

    Rows are pegs, columns (L psi, tail x, tail y, separation); no unit. See ``contact.record`` for the layout
    of ``records``, ``base.feature`` for that of ``features``.
    """
    out = np.empty((records.shape[0], 4, 4))
    write_jacobians(records, features, setting, np.empty((WORK_LENGTH, 4)), np.empty((4, 2)), out)
    return out
