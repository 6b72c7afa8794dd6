"""Type II: three pegs on the left jaw, one on the right.

Three left pegs are two chords that share their tail: they fit where the tails' parameters on the shared feature agree at
the same orientation. There the workpiece stands still, and each row of the right jaw meets each feature in at most two
points.
"""

from __future__ import annotations

from math import ceil, cos, floor, pi, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.compiling import compiled, inner
from workhold.kernels.base.growing import with_room
from workhold.kernels.chord.evaluation import POSITION
from workhold.kernels.contact.closure import minor_band, outward_normal
from workhold.kernels.contact.rules import (
    GAP_SLACK,
    LEAST_CLAMPING,
    LEAST_MARGIN,
    MIN_GAP,
    PEG_LENGTH,
    RECORD_LENGTH,
    WRENCH_LENGTH,
    is_fixture,
    is_listed,
    place_peg,
    share_a_jaw,
    write_given_up,
    write_record,
)
from workhold.kernels.crossing.roots import MOST_ROOTS, PSI, RADIUS, STACK_DEPTH, STACK_LENGTH, crossings, may_meet
from workhold.kernels.crossing.two_and_two import CANDIDATES, CONTACTS, CROSSED, HAIR, PAIRS, place_chord
from workhold.kernels.curves.columns import CENTER, COLUMN_STEP, HEAD, LENGTH, ROW_STEP, SHIFT, TAIL
from workhold.kernels.curves.piece_columns import CURVE, HIGH, LOW, STEADY, VALUE_LEAST, VALUE_MOST, X_LEFT
from workhold.kernels.curves.pieces import cell_pieces

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

# Columns of a role: what the pairing of pieces looks at.
ROLE_LOW, ROLE_HIGH, ROLE_VALUE_LEAST, ROLE_VALUE_MOST, ROLE_PIECE, ROLE_TAIL = range(6)
ROLE_LENGTH = 6
# Rows of what right pegs need of three left ones.
TRIPLE_ROWS = 8


@inner
def place_triple(
    pegs: Array, one: int, two: int, psi: float, reach: float, features: Array, integers: IntArray, reals: Array
) -> None:
    """Write the three left pegs of two curves with a common tail; ``reach`` as for ``place_chord``."""
    place_chord(pegs[:2], one, psi, reach, 0.0, features, integers, reals)
    d, alpha = reals[two, LENGTH], psi + reals[two, SHIFT]
    x, y, radius = pegs[0, 0] + d * cos(alpha), pegs[0, 1] + d * sin(alpha), pegs[0, 5] + d * reach
    column, row = float(integers[two, COLUMN_STEP]), float(integers[two, ROW_STEP])
    place_peg(pegs[2], x, y, integers[two, HEAD], column, row, radius)


@inner
def height_range(row: Array, ax: float, ay: float) -> tuple[float, float]:
    """Lowest and highest value of a . q over a feature's points q (an arc counts as its whole circle)."""
    middle = ax * row[1] + ay * row[2]
    if row[0] == 0.0:
        reach = row[5] * abs(ax * row[3] + ay * row[4])
    else:
        reach = row[6]
    return (middle - reach, middle + reach)


@inner
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


@inner
def write_triple(triple: Array, pegs: Array, psi: float, features: Array, length: float) -> None:
    """Write what right pegs need of three left pegs in place to (8, 3) rows, the last three of them work space.

    With w_i = (n_i, t_i) the wrenches of the left pegs and D their determinant, rows 0 to 2 hold the cross products of two
    of them, cyclically, with the sign of D; the null vector's entries of the left pegs for a right peg of wrench w, over
    that of the right peg, are minus the scalar products of those rows with w, over abs(D). Row 3 holds the place along x of
    the rightmost left peg, the largest radius of the pegs, and the largest turn of a normal by that, in radians; row 4 holds
    abs(D).
    """
    wrenches, first = triple[:3], triple[5:]
    rightmost = -np.inf
    radius = swing = 0.0
    for k in range(3):
        x, y = pegs[k, 0], pegs[k, 1]
        row = features[int(pegs[k, 2])]
        nx, ny = outward_normal(row, x, y)
        first[k, 0], first[k, 1], first[k, 2] = nx, ny, (x * ny - y * nx) / length
        rightmost = max(rightmost, cos(psi) * x + sin(psi) * y)
        radius = max(radius, pegs[k, 5])
        if row[0] != 0.0:
            swing = max(swing, pegs[k, 5] / row[6])
    for k in range(3):
        one, two = first[(k + 1) % 3], first[(k + 2) % 3]
        wrenches[k, 0] = one[1] * two[2] - one[2] * two[1]
        wrenches[k, 1] = one[2] * two[0] - one[0] * two[2]
        wrenches[k, 2] = one[0] * two[1] - one[1] * two[0]
    determinant = wrenches[0, 0] * first[0, 0] + wrenches[0, 1] * first[0, 1] + wrenches[0, 2] * first[0, 2]
    if determinant < 0.0:
        for k in range(3):
            for n in range(3):
                wrenches[k, n] = -wrenches[k, n]
    triple[3, 0], triple[3, 1], triple[3, 2] = rightmost, radius, swing
    triple[4, 0] = abs(determinant)


@inner
def may_close(
    triple: Array, row: Array, x: float, y: float, radius: float, cx: float, cy: float, gap: float, limits: Array
) -> bool:
    """Whether a right peg may make a fixture with three left pegs: a quick look before ``is_fixture``.

    Parameters
    ----------
    triple : (8, 3) rows of ``write_triple``.
    row, x, y, radius : the right peg's feature and place.
    cx, cy : cosine and sine of psi.
    gap : smallest gap in mm, less the doubt of orientation.
    """
    length = limits[WRENCH_LENGTH]
    doubt = max(triple[3, 1], radius)
    if cx * x + cy * y - triple[3, 0] < gap - 2.0 * doubt:
        return False
    nx, ny = outward_normal(row, x, y)
    swing = max(triple[3, 2], 0.0 if row[0] == 0.0 else radius / row[6])
    t = (x * ny - y * nx) / length
    band = minor_band(swing, doubt, length)
    determinant = triple[4, 0]
    if determinant <= band:
        return True
    smallest = total = determinant
    for k in range(3):
        entry = -(triple[k, 0] * nx + triple[k, 1] * ny + triple[k, 2] * t)
        smallest, total = min(smallest, entry), total + abs(entry)
    return smallest + band > limits[LEAST_MARGIN] * (total - 4.0 * band)


@inner
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
    counting: bool,
    work: Array,
    null: Array,
    stats: IntArray,
) -> tuple[Array, int]:
    """Try every right peg for three left pegs in place; append the fixtures to ``out`` (grown as needed)."""
    cx, cy = cos(psi), sin(psi)
    base = cx * pegs[0, 1] - cy * pegs[0, 0] + row_offset
    # Points of the part are at most 2 L apart.
    error = pegs[0, 5] + 4.0 * limits[WRENCH_LENGTH] * reach
    slack = 1e-9 + error / pitch_y
    gap = limits[MIN_GAP] - GAP_SLACK - HAIR - 4.0 * limits[WRENCH_LENGTH] * reach
    triple = np.empty((TRIPLE_ROWS, 3))
    write_triple(triple, pegs, psi, features, limits[WRENCH_LENGTH])
    for e in range(features.shape[0]):
        row = features[e]
        # A straight feature that faces left cannot be pushed to the left.
        if row[0] == 0.0 and not counting and row[4] * cx - row[3] * cy < -HAIR - reach:
            continue
        lowest, highest = height_range(row, -cy, cx)
        first = int(ceil((lowest - base) / pitch_y - slack))
        last = int(floor((highest - base) / pitch_y + slack))
        # Nor does the side of an arc count that faces left.
        sides = 2 if counting or row[0] == 0.0 else 1
        begin = 0 if sides == 2 or row[7] > 0.0 else 1
        for line in range(first, last + 1):
            for k in range(begin, begin + sides):
                meets, x, y, radius = row_meets(row, -cy, cx, base + line * pitch_y, error, 1.0 - 2.0 * k)
                if not meets:
                    continue
                if not counting and not may_close(triple, row, x, y, radius, cx, cy, gap, limits):
                    continue
                place_peg(pegs[3], x, y, e, 0.0, float(line), radius)
                verdict, apart = is_fixture(pegs, 3.0, psi, reach, features, limits, work, null)
                stats[CANDIDATES] += 1
                if verdict > 0:
                    stats[CONTACTS] += 1
                if is_listed(verdict, counting, count, limits):
                    out = with_room(out, count)
                    write_record(out[count], 2.0, pegs, psi, apart, reach)
                    count += 1
    return out, count


@inner
def farthest_right(features: Array, low: float, high: float) -> float:
    """How far right in mm along x a peg that touches the part may stand, for psi in [low, high] (arcs as whole circles)."""
    psi, half = (low + high) / 2.0, (high - low) / 2.0
    most = -np.inf
    for k in range(features.shape[0]):
        _, highest = height_range(features[k], cos(psi), sin(psi))
        size = abs(features[k, 1]) + abs(features[k, 2]) + features[k, 5] + features[k, 6]
        most = max(most, highest + size * half)
    return most


@inner
def write_triple_roles(pieces: Array, integers: IntArray, farthest: float, out: Array) -> int:
    """Write the (N, 6) roles, what their pairing looks at, of the pieces that leave room for a right peg; return their
    number."""
    count = int(np.int64(0))
    for k in range(pieces.shape[0]):
        row = pieces[k]
        if row[X_LEFT] > farthest:
            continue
        role = out[count]
        role[ROLE_VALUE_LEAST], role[ROLE_VALUE_MOST] = row[VALUE_LEAST] - HAIR, row[VALUE_MOST] + HAIR
        role[ROLE_LOW], role[ROLE_HIGH], role[ROLE_PIECE] = row[LOW], row[HIGH], k
        role[ROLE_TAIL] = integers[int(row[CURVE]), TAIL]
        count += 1
    return count


@compiled
def three_and_one_cells(
    edges: Array,
    members: IntArray,
    loose: Array,
    features: Array,
    integers: IntArray,
    reals: Array,
    stretches: Array,
    pitch_x: float,
    pitch_y: float,
    row_offset: float,
    limits: Array,
    counting: bool,
    stats: IntArray,
) -> Array:
    """All Type II fixtures with psi in some neighbouring cells whose left chords from the shared tail are not sliding pairs.

    Parameters and result as for ``two_and_two_cells``. The shared tail is on the feature of the lowest number, so that each
    triple of pegs shows up once; the curves, and so the pieces, are in the order of their tails.
    """
    out = np.empty((64, RECORD_LENGTH))
    count = int(np.int64(0))
    stack, roots = np.empty((STACK_DEPTH, STACK_LENGTH)), np.empty((MOST_ROOTS, 3))
    pegs, work, null = np.empty((4, PEG_LENGTH)), np.empty((8, 2)), np.empty(4)
    for cell in range(edges.shape[0] - 1):
        pieces = cell_pieces(
            edges[cell], edges[cell + 1], members, loose, integers, reals, stretches, pitch_x, 0.0, POSITION
        )
        farthest = farthest_right(loose, edges[cell], edges[cell + 1]) - limits[MIN_GAP] + GAP_SLACK + HAIR
        roles = np.empty((pieces.shape[0], ROLE_LENGTH))
        role_count = write_triple_roles(pieces, integers, np.inf if counting else farthest, roles)
        for i in range(role_count):
            role = roles[i]
            first = pieces[int(role[ROLE_PIECE])]
            one = int(first[CURVE])
            tail = integers[one, TAIL]
            # A tail on a whole circle may be counted from either side of the seam.
            circle = loose[tail, 0] != 0.0 and loose[tail, 5] >= pi
            period = 2.0 * pi if circle else 0.0
            for j in range(i - 1, -1, -1):
                other = roles[j]
                if other[ROLE_TAIL] != role[ROLE_TAIL]:
                    break
                stats[PAIRS] += 1
                if role[ROLE_LOW] >= other[ROLE_HIGH] or other[ROLE_LOW] >= role[ROLE_HIGH]:
                    continue
                if not circle and (
                    role[ROLE_VALUE_LEAST] > other[ROLE_VALUE_MOST] or other[ROLE_VALUE_LEAST] > role[ROLE_VALUE_MOST]
                ):
                    continue
                second = pieces[int(other[ROLE_PIECE])]
                two = int(second[CURVE])
                if not share_a_jaw(integers[one], integers[two], limits):
                    continue
                if integers[one, CENTER] >= 0 and integers[one, CENTER] == integers[two, CENTER]:
                    continue
                steady = first[STEADY] * second[STEADY] == 1.0 and not circle
                if steady and not may_meet(first, second, 0.0, 0.0):
                    continue
                stats[CROSSED] += 1
                number = crossings(first, second, loose, integers, reals, POSITION, 0.0, period, 0.0, stack, roots)
                if number < 0:
                    out = with_room(out, count)
                    write_given_up(out[count], 2.0, first, second, integers)
                    count += 1
                for root in range(number):
                    psi, reach = roots[root, PSI], roots[root, RADIUS]
                    place_triple(pegs, one, two, psi, reach, features, integers, reals)
                    out, count = add_right_pegs(
                        out, count, pegs, psi, reach, features, pitch_y, row_offset, limits, counting, work, null, stats
                    )
    return out[:count]
