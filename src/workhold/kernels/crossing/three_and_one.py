"""Three pegs on the carrier that stands still, one on the carrier that moves (the paper's Type II).

Three standing pegs are two chords that share their tail: they fit where the tails' parameters on the shared feature agree at
the same orientation. There the workpiece stands still, and each row of the moving carrier meets each feature in at most two
points.
"""

from __future__ import annotations

from math import ceil, cos, floor, pi, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from workhold.conventions import GAP_SLACK, LEAST_CLAMPING
from workhold.kernels.base.compiling import compiled, inner
from workhold.kernels.base.given import Features, Lattice, Limits
from workhold.kernels.base.growing import with_room
from workhold.kernels.chord.evaluation import POSITION
from workhold.kernels.contact.closure import minor_band, outward_normal
from workhold.kernels.contact.record import (
    PEG_FEATURE,
    PEG_LENGTH,
    PEG_RADIUS,
    PEG_X,
    PEG_Y,
    RECORD_LENGTH,
    place_peg,
    write_given_up,
    write_record,
)
from workhold.kernels.contact.rules import is_fixture, is_listed, share_a_carrier
from workhold.kernels.crossing.roots import (
    MOST_ROOTS,
    ROOT_PSI,
    ROOT_RADIUS,
    STACK_DEPTH,
    STACK_LENGTH,
    crossings,
    may_meet,
)
from workhold.kernels.crossing.two_and_two import CANDIDATES, CONTACTS, CROSSED, HAIR, PAIRS, is_among, place_chord
from workhold.kernels.curves.columns import CENTER, COLUMN_STEP, HEAD, LENGTH, ROW_STEP, SHIFT, TAIL, Curves
from workhold.kernels.curves.piece_columns import CURVE, HIGH, LOW, STEADY, VALUE_LEAST, VALUE_MOST, X_STANDING
from workhold.kernels.curves.pieces import cell_pieces

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

# Columns of a limb, one of the two chords of a triple: what the pairing of pieces looks at.
LIMB_LOW, LIMB_HIGH, LIMB_VALUE_LEAST, LIMB_VALUE_MOST, LIMB_PIECE, LIMB_TAIL = range(6)
LIMB_LENGTH = 6
# Rows of what moving pegs need of three standing ones.
TRIPLE_ROWS = 8


@inner
def place_triple(pegs: Array, one: int, two: int, psi: float, reach: float, features: Array, curves: Curves) -> None:
    """Write the three standing pegs of two curves with a common tail; ``reach`` as for ``place_chord``."""
    place_chord(pegs[:2], one, psi, reach, 0.0, features, curves)
    step, d, alpha = curves.integers[two], curves.reals[two, LENGTH], psi + curves.reals[two, SHIFT]
    x, y, radius = pegs[0, PEG_X] + d * cos(alpha), pegs[0, PEG_Y] + d * sin(alpha), pegs[0, PEG_RADIUS] + d * reach
    place_peg(pegs[2], x, y, step[HEAD], float(step[COLUMN_STEP]), float(step[ROW_STEP]), radius)


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

    Where the feature runs square to the motion, a moving peg cannot push along it: the clamping force is at most
    abs(n . x). Such points are left out.

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
    """Write what moving pegs need of three standing pegs in place to (8, 3) rows, the last three of them work space.

    With w_i = (n_i, t_i) the wrenches of the standing pegs and D their determinant, rows 0 to 2 hold the cross products of
    two of them, cyclically, with the sign of D; the null vector's entries of the standing pegs for a moving peg of wrench w,
    over that of the moving peg, are minus the scalar products of those rows with w, over abs(D). Row 3 holds the place along
    x of the rightmost standing peg, the largest radius of the pegs, and the largest turn of a normal by that, in radians;
    row 4 holds abs(D).
    """
    wrenches, first = triple[:3], triple[5:]
    rightmost = -np.inf
    radius = swing = 0.0
    for k in range(3):
        x, y = pegs[k, PEG_X], pegs[k, PEG_Y]
        row = features[int(pegs[k, PEG_FEATURE])]
        nx, ny = outward_normal(row, x, y)
        first[k, 0], first[k, 1], first[k, 2] = nx, ny, (x * ny - y * nx) / length
        rightmost = max(rightmost, cos(psi) * x + sin(psi) * y)
        radius = max(radius, pegs[k, PEG_RADIUS])
        if row[0] != 0.0:
            swing = max(swing, pegs[k, PEG_RADIUS] / row[6])
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
    triple: Array, row: Array, x: float, y: float, radius: float, cx: float, cy: float, gap: float, limits: Limits
) -> bool:
    """Whether a moving peg may make a fixture with three standing pegs: a quick look before ``is_fixture``.

    Parameters
    ----------
    triple : (8, 3) rows of ``write_triple``.
    row, x, y, radius : the moving peg's feature and place.
    cx, cy : cosine and sine of psi.
    gap : smallest gap in mm, less the doubt of orientation.
    """
    length = limits.wrench_length
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
    return smallest + band > limits.least_margin * (total - 4.0 * band)


@inner
def faces_away(row: Array, cx: float, cy: float, clamping: float, doubt: float) -> bool:
    """Whether a moving peg cannot clamp on a feature: it is straight and faces the way that the peg would push."""
    return row[0] == 0.0 and clamping * (row[4] * cx - row[3] * cy) < -HAIR - doubt


@inner
def add_moving_pegs(
    out: Array,
    count: int,
    pegs: Array,
    psi: float,
    reach: float,
    features: Features,
    lattice: Lattice,
    limits: Limits,
    counting: bool,
    work: Array,
    null: Array,
    stats: IntArray,
) -> tuple[Array, int]:
    """Try every moving peg for three standing pegs in place; append the fixtures to ``out`` (grown as needed)."""
    cx, cy = cos(psi), sin(psi)
    pitch_y, length, rows = lattice.pitch_y, limits.wrench_length, features.rows
    base = cx * pegs[0, PEG_Y] - cy * pegs[0, PEG_X] + lattice.row_offset
    # Points of the part are at most 2 L apart.
    error = pegs[0, PEG_RADIUS] + 4.0 * length * reach
    slack = 1e-9 + error / pitch_y
    gap = limits.gap - GAP_SLACK - HAIR - 4.0 * length * reach
    triple = np.empty((TRIPLE_ROWS, 3))
    write_triple(triple, pegs, psi, rows, length)
    for e in range(features.moving[0], features.moving[1]):
        row = rows[e]
        if not counting and faces_away(row, cx, cy, limits.clamping, reach):
            continue
        lowest, highest = height_range(row, -cy, cx)
        first = int(ceil((lowest - base) / pitch_y - slack))
        last = int(floor((highest - base) / pitch_y + slack))
        # Nor does the side of an arc count that faces away.
        sides = 2 if counting or row[0] == 0.0 else 1
        begin = 0 if sides == 2 or limits.clamping * row[7] > 0.0 else 1
        for line in range(first, last + 1):
            for k in range(begin, begin + sides):
                meets, x, y, radius = row_meets(row, -cy, cx, base + line * pitch_y, error, 1.0 - 2.0 * k)
                if not meets:
                    continue
                if not counting and not may_close(triple, row, x, y, radius, cx, cy, gap, limits):
                    continue
                place_peg(pegs[3], x, y, e, 0.0, float(line), radius)
                verdict, separation = is_fixture(pegs, 3.0, psi, reach, features, limits, work, null)
                stats[CANDIDATES] += 1
                if verdict > 0:
                    stats[CONTACTS] += 1
                if is_listed(verdict, counting, count, limits):
                    out = with_room(out, count)
                    write_record(out[count], 3.0, pegs, psi, separation, reach)
                    count += 1
    return out, count


@inner
def farthest_right(features: Features, low: float, high: float) -> float:
    """How far right in mm along x a moving peg that touches the part may stand, for psi in [low, high] (arcs as whole
    circles)."""
    psi, half = (low + high) / 2.0, (high - low) / 2.0
    most = -np.inf
    for k in range(features.moving[0], features.moving[1]):
        row = features.loose[k]
        _, highest = height_range(row, cos(psi), sin(psi))
        size = abs(row[1]) + abs(row[2]) + row[5] + row[6]
        most = max(most, highest + size * half)
    return most


@inner
def write_limbs(pieces: Array, integers: IntArray, touched: tuple[int, int], farthest: float, out: Array) -> int:
    """Write the (N, 6) limbs, what their pairing looks at, of the pieces of standing pegs that leave room for a moving peg;
    return their number."""
    count = int(np.int64(0))
    for k in range(pieces.shape[0]):
        row = pieces[k]
        tail = integers[int(row[CURVE]), TAIL]
        if row[X_STANDING] > farthest or not is_among(tail, touched):
            continue
        limb = out[count]
        limb[LIMB_VALUE_LEAST], limb[LIMB_VALUE_MOST] = row[VALUE_LEAST] - HAIR, row[VALUE_MOST] + HAIR
        limb[LIMB_LOW], limb[LIMB_HIGH], limb[LIMB_PIECE] = row[LOW], row[HIGH], k
        limb[LIMB_TAIL] = tail
        count += 1
    return count


@compiled
def three_and_one_cells(
    edges: Array,
    members: IntArray,
    features: Features,
    curves: Curves,
    lattice: Lattice,
    limits: Limits,
    counting: bool,
    stats: IntArray,
) -> Array:
    """All fixtures of three and one peg with psi in some neighbouring cells whose chords from the shared tail are no sliding
    pairs.

    Parameters and result as for ``two_and_two_cells``. The shared tail is on the feature of the lowest number, so that each
    triple of pegs shows up once; the curves, and so the pieces, are in the order of their tails.
    """
    out = np.empty((64, RECORD_LENGTH))
    count = int(np.int64(0))
    stack, roots = np.empty((STACK_DEPTH, STACK_LENGTH)), np.empty((MOST_ROOTS, 3))
    pegs, work, null = np.empty((4, PEG_LENGTH)), np.empty((8, 2)), np.empty(4)
    loose, rows, integers = features.loose, features.rows, curves.integers
    for cell in range(edges.shape[0] - 1):
        pieces = cell_pieces(edges[cell], edges[cell + 1], members, loose, curves, lattice.pitch_x, 0.0, POSITION)
        farthest = farthest_right(features, edges[cell], edges[cell + 1]) - limits.gap + GAP_SLACK + HAIR
        limbs = np.empty((pieces.shape[0], LIMB_LENGTH))
        limb_count = write_limbs(pieces, integers, features.standing, np.inf if counting else farthest, limbs)
        for i in range(limb_count):
            limb = limbs[i]
            first = pieces[int(limb[LIMB_PIECE])]
            one = int(first[CURVE])
            tail = integers[one, TAIL]
            # A tail on a whole circle may be counted from either side of the seam.
            circle = loose[tail, 0] != 0.0 and loose[tail, 5] >= pi
            period = 2.0 * pi if circle else 0.0
            for j in range(i - 1, -1, -1):
                other = limbs[j]
                if other[LIMB_TAIL] != limb[LIMB_TAIL]:
                    break
                stats[PAIRS] += 1
                if limb[LIMB_LOW] >= other[LIMB_HIGH] or other[LIMB_LOW] >= limb[LIMB_HIGH]:
                    continue
                if not circle and (
                    limb[LIMB_VALUE_LEAST] > other[LIMB_VALUE_MOST] or other[LIMB_VALUE_LEAST] > limb[LIMB_VALUE_MOST]
                ):
                    continue
                second = pieces[int(other[LIMB_PIECE])]
                two = int(second[CURVE])
                if not share_a_carrier(integers[one], integers[two], limits):
                    continue
                if integers[one, CENTER] >= 0 and integers[one, CENTER] == integers[two, CENTER]:
                    continue
                steady = first[STEADY] * second[STEADY] == 1.0 and not circle
                if steady and not may_meet(first, second, 0.0, 0.0):
                    continue
                stats[CROSSED] += 1
                number = crossings(first, second, loose, curves, POSITION, 0.0, period, 0.0, stack, roots)
                if number < 0:
                    out = with_room(out, count)
                    write_given_up(out[count], 3.0, first, second, integers)
                    count += 1
                for root in range(number):
                    psi, reach = roots[root, ROOT_PSI], roots[root, ROOT_RADIUS]
                    place_triple(pegs, one, two, psi, reach, rows, curves)
                    out, count = add_moving_pegs(
                        out, count, pegs, psi, reach, features, lattice, limits, counting, work, null, stats
                    )
    return out[:count]
