"""Type II: three pegs on the left jaw, one on the right.

Three left pegs are two chords that share their tail: they fit where the tails' parameters on the shared feature agree at
the same orientation. There the workpiece stands still, and each row of the right jaw meets each feature in at most two
points.
"""

from __future__ import annotations

from math import ceil, cos, floor, pi, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from holdfast.kernels.chord import POSITION
from holdfast.kernels.compiling import compiled
from holdfast.kernels.crossing import MOST_ROOTS, PSI, RADIUS, STACK_DEPTH, STACK_LENGTH, crossings
from holdfast.kernels.pieces import (
    CENTER,
    COLUMN_STEP,
    CURVE,
    HEAD,
    HIGH,
    LENGTH,
    LOW,
    ROW_STEP,
    SHIFT,
    TAIL,
    grown,
)
from holdfast.kernels.type_one import CANDIDATES, CONTACTS, FOUND, PAIRS, place_chord
from holdfast.kernels.vise_checks import (
    LEAST_CLAMPING,
    PEG_LENGTH,
    RECORD_LENGTH,
    WRENCH_LENGTH,
    is_fixture,
    place_peg,
    share_a_jaw,
    write_given_up,
    write_record,
)

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


@compiled
def place_triple(
    pegs: Array, one: int, two: int, psi: float, reach: float, features: Array, integers: IntArray, reals: Array
) -> None:
    """Write the three left pegs of two curves with a common tail; ``reach`` as for ``place_chord``."""
    place_chord(pegs[:2], one, psi, reach, 0.0, features, integers, reals)
    d, alpha = reals[two, LENGTH], psi + reals[two, SHIFT]
    x, y, radius = pegs[0, 0] + d * cos(alpha), pegs[0, 1] + d * sin(alpha), pegs[0, 5] + d * reach
    column, row = float(integers[two, COLUMN_STEP]), float(integers[two, ROW_STEP])
    place_peg(pegs[2], x, y, integers[two, HEAD], column, row, radius)


@compiled
def height_range(row: Array, ax: float, ay: float) -> tuple[float, float]:
    """Lowest and highest value of a . q over a feature's points q (an arc counts as its whole circle)."""
    middle = ax * row[1] + ay * row[2]
    if row[0] == 0.0:
        reach = row[5] * abs(ax * row[3] + ay * row[4])
    else:
        reach = row[6]
    return (middle - reach, middle + reach)


@compiled
def row_meets(
    row: Array, ax: float, ay: float, height: float, error: float, side: float
) -> tuple[bool, float, float, float]:
    """A point of a feature's carrier at a height y . q, with (ax, ay) = y; ``side`` picks one of an arc's two.

    Where the feature runs square to the jaws' motion, a peg of the right jaw cannot push along it: the clamping force is at
    most abs(n . x). Such points are left out.

    Returns
    -------
    (whether there may be one that clamps, x, y, how far in mm it may be off when the height is off by ``error``)
    """
    if row[0] == 0.0:
        slope = ax * row[3] + ay * row[4]
        if side < 0.0 or abs(slope) <= 0.5 * LEAST_CLAMPING:
            return (False, 0.0, 0.0, 0.0)
        s = (height - ax * row[1] - ay * row[2]) / slope
        return (True, row[1] + s * row[3], row[2] + s * row[4], 1.1 * error / abs(slope))
    rise = height - ax * row[1] - ay * row[2]
    square = (row[6] - rise) * (row[6] + rise)
    # The square is off by at most 2.2 R error.
    most = square + 2.2 * row[6] * error
    if most <= (0.5 * LEAST_CLAMPING * row[6]) ** 2:
        return (False, 0.0, 0.0, 0.0)
    along = sqrt(max(square, 0.0))
    radius = 1.3 * row[6] * error / along if square > 16.0 * row[6] * error else 2.0 * sqrt(most)
    along *= side
    # x = (ay, -ax) when y = (ax, ay).
    return (True, row[1] + rise * ax + along * ay, row[2] + rise * ay - along * ax, radius + error)


@compiled
def add_right_pegs(
    out: Array,
    count: int,
    pegs: Array,
    psi: float,
    reach: float,
    features: Array,
    pitch_y: float,
    row_offset: float,
    limits: Array,
    work: Array,
    null: Array,
    stats: IntArray,
) -> tuple[Array, int]:
    """Try every right peg for three left pegs in place; append the fixtures to ``out`` (grown as needed)."""
    ax, ay = -sin(psi), cos(psi)
    base = ax * pegs[0, 0] + ay * pegs[0, 1] + row_offset
    # Points of the part are at most 2 L apart.
    error = pegs[0, 5] + 4.0 * limits[WRENCH_LENGTH] * reach
    slack = 1e-9 + error / pitch_y
    for e in range(features.shape[0]):
        row = features[e]
        lowest, highest = height_range(row, ax, ay)
        first = int(ceil((lowest - base) / pitch_y - slack))
        last = int(floor((highest - base) / pitch_y + slack))
        for line in range(first, last + 1):
            for k in range(2):
                meets, x, y, radius = row_meets(row, ax, ay, base + line * pitch_y, error, 1.0 - 2.0 * k)
                if not meets:
                    continue
                place_peg(pegs[3], x, y, e, 0.0, float(line), radius)
                verdict, apart = is_fixture(pegs, 3.0, psi, reach, features, limits, work, null)
                stats[CANDIDATES] += 1
                if verdict > 0:
                    stats[CONTACTS] += 1
                if verdict == 2:
                    if count == out.shape[0]:
                        out = grown(out)
                    write_record(out[count], 2.0, pegs, psi, apart, reach)
                    count += 1
                    stats[FOUND] += 1
    return out, count


@compiled
def type_two_cell(
    pieces: Array,
    loose: Array,
    features: Array,
    integers: IntArray,
    reals: Array,
    pitch_y: float,
    row_offset: float,
    limits: Array,
    stats: IntArray,
) -> Array:
    """All Type II fixtures with psi in one cell whose left chords from the shared tail are not uprights.

    Parameters and result as for ``type_one_cell``. The shared tail is on the feature of the lowest number, so that each
    triple of pegs shows up once; the pieces, of the tails' positions, are sorted by it.
    """
    out = np.empty((64, RECORD_LENGTH))
    count = int(np.int64(0))
    stack, roots = np.empty((STACK_DEPTH, STACK_LENGTH)), np.empty((MOST_ROOTS, 3))
    pegs, work, null = np.empty((4, PEG_LENGTH)), np.empty((8, 2)), np.empty(4)
    for i in range(pieces.shape[0]):
        one = int(pieces[i, CURVE])
        tail = integers[one, TAIL]
        # A tail on a whole circle may be counted from either side of the seam.
        circle = loose[tail, 0] != 0.0 and loose[tail, 5] >= pi
        period = 2.0 * pi if circle else 0.0
        for j in range(i - 1, -1, -1):
            two = int(pieces[j, CURVE])
            if integers[two, TAIL] != tail:
                break
            if pieces[i, LOW] >= pieces[j, HIGH] or pieces[j, LOW] >= pieces[i, HIGH]:
                continue
            if not share_a_jaw(integers[one], integers[two], limits):
                continue
            if integers[one, CENTER] >= 0 and integers[one, CENTER] == integers[two, CENTER]:
                continue
            stats[PAIRS] += 1
            number = crossings(pieces[i], pieces[j], loose, integers, reals, POSITION, 0.0, period, stack, roots)
            if number < 0:
                if count == out.shape[0]:
                    out = grown(out)
                write_given_up(out[count], 2.0, pieces[i], pieces[j], integers)
                count += 1
            for root in range(number):
                psi, reach = roots[root, PSI], roots[root, RADIUS]
                place_triple(pegs, one, two, psi, reach, features, integers, reals)
                out, count = add_right_pegs(
                    out, count, pegs, psi, reach, features, pitch_y, row_offset, limits, work, null, stats
                )
    return out[:count]
