"""Three pegs on the carrier that stands still, one on the carrier that moves (the paper's Type II).

Three standing pegs are two chords that share their tail: they fit where the tails' parameters on the shared
feature agree at the same orientation. There the workpiece stands still, and each row of the moving carrier
meets each feature in at most two points.
"""

from __future__ import annotations

from math import atan2, ceil, cos, floor, hypot, pi, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from workhold.conventions import GAP_SLACK, LEAST_CLAMPING
from workhold.kernels.base.arrays import grown
from workhold.kernels.base.compiling import compiled_making_arrays, inner
from workhold.kernels.base.feature import (
    AXIS_X,
    AXIS_Y,
    HALF_EXTENT,
    IS_ARC,
    RADIUS,
    SIGN,
    X,
    Y,
    beside_middle,
    exact_dot,
    is_shallow,
    local_size,
    middle_of,
)
from workhold.kernels.base.given import Features, Lattice, Limits
from workhold.kernels.chord.columns import (
    CENTER,
    COLUMN_STEP,
    CURVE,
    HEAD,
    HIGH,
    LENGTH,
    LOW,
    PIECE_LENGTH,
    ROW_STEP,
    SHIFT,
    STEADY,
    TAIL,
    VALUE_LEAST,
    VALUE_MOST,
    X_STANDING,
    Curves,
)
from workhold.kernels.chord.evaluation import POSITION
from workhold.kernels.chord.intervals import share_one_line
from workhold.kernels.contact.record import (
    PEG_FEATURE,
    PEG_RADIUS,
    PEG_X,
    PEG_Y,
    RECORD_LENGTH,
    place_peg,
    write_given_up,
    write_record,
)
from workhold.kernels.contact.rules import is_fixture, is_listed, minor_band, outward_normal, share_a_carrier
from workhold.kernels.curves.piece_bounds import HAIR, kept_edges
from workhold.kernels.curves.pieces import cell_pieces
from workhold.kernels.curves.roots import ROOT_PSI, ROOT_RADIUS, WorkSpace, crossings, may_meet, work_space
from workhold.kernels.curves.two_and_two import (
    CANDIDATES,
    CONTACTS,
    CROSSED,
    PAIRS,
    STOPPED,
    is_among,
    place_chord,
)

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

# Points of an arc this far beyond its ends, in mm, count as points of it: more than ``END_SLACK`` and
# rounding.
SPARE = 1e-6
# Columns of a limb, one of the two chords of a triple: what the pairing of pieces looks at.
LIMB_LOW, LIMB_HIGH, LIMB_VALUE_LEAST, LIMB_VALUE_MOST, LIMB_PIECE, LIMB_TAIL = range(6)
LIMB_LENGTH = 6


@inner
def place_triple(
    pegs: Array, one: int, two: int, psi: float, reach: float, features: Array, curves: Curves
) -> None:
    """Writes the three standing pegs of two curves with a common tail; ``reach`` as for ``place_chord``."""
    place_chord(pegs[:2], one, psi, reach, 0.0, features, curves)
    step, d, alpha = curves.integers[two], curves.reals[two, LENGTH], psi + curves.reals[two, SHIFT]
    x, y, radius = (
        pegs[0, PEG_X] + d * cos(alpha),
        pegs[0, PEG_Y] + d * sin(alpha),
        pegs[0, PEG_RADIUS] + d * reach,
    )
    place_peg(pegs[2], x, y, step[HEAD], float(step[COLUMN_STEP]), float(step[ROW_STEP]), radius)


@inner
def height_range(row: Array, ax: float, ay: float) -> tuple[float, float]:
    """Lowest and highest value of a . q over a feature's points q; those up to ``SPARE`` beyond an arc's
    ends count."""
    if row[IS_ARC] == 0.0:
        middle, reach = ax * row[X] + ay * row[Y], row[HALF_EXTENT] * abs(ax * row[AXIS_X] + ay * row[AXIS_Y])
        return (middle - reach, middle + reach)
    half = row[HALF_EXTENT] + SPARE / row[RADIUS]
    # Its two highest places, from the arc's middle: at the top of its circle, if that belongs to it, and at
    # an end.
    along, across = ax * row[AXIS_X] + ay * row[AXIS_Y], row[AXIS_X] * ay - row[AXIS_Y] * ax
    top = atan2(across, along)
    if half >= pi:
        middle = ax * row[X] + ay * row[Y]
        return (middle - row[RADIUS], middle + row[RADIUS])
    x, y = middle_of(row)
    middle = ax * x + ay * y
    one, two = height_beside(row, half, along, across), height_beside(row, -half, along, across)
    lowest, highest = min(one, two), max(one, two)
    if abs(top) <= half:
        highest = max(highest, height_beside(row, top, along, across))
    if abs(top) >= pi - half:
        lowest = min(lowest, height_beside(row, top + pi, along, across))
    return (middle + lowest, middle + highest)


@inner
def height_beside(row: Array, parameter: float, along: float, across: float) -> float:
    """How far above its middle an arc's point at a parameter is, in a direction of parts along and square to
    it."""
    sine = sin(parameter / 2.0)
    return row[RADIUS] * (sin(parameter) * across - 2.0 * sine * sine * along)


@inner
def row_meets(
    row: Array, ax: float, ay: float, height: float, error: float, side: float
) -> tuple[bool, float, float, float]:
    """A point of a feature's carrier at a height y . q, with (ax, ay) = y; ``side`` picks one of an arc's
    two.

    Where the feature runs square to the motion, a moving peg cannot push along it: the clamping force is at
    most abs(n . x). Such points are left out.

    Returns
    -------
    (whether there may be one that clamps, x, y, how far in mm it may be off when the height is off by
    ``error``)
    """
    if row[IS_ARC] == 0.0:
        slope = ax * row[AXIS_X] + ay * row[AXIS_Y]
        if side < 0.0 or abs(slope) <= 0.5 * LEAST_CLAMPING:
            return (False, 0.0, 0.0, 0.0)
        s = (height - ax * row[X] - ay * row[Y]) / slope
        return (True, row[X] + s * row[AXIS_X], row[Y] + s * row[AXIS_Y], 1.1 * error / abs(slope))
    if is_shallow(row):
        return row_meets_shallow(row, ax, ay, height, error, side)
    rise = height - ax * row[X] - ay * row[Y]
    square = (row[RADIUS] - rise) * (row[RADIUS] + rise)
    # The square is off by at most 2.2 R error.
    most = square + 2.2 * row[RADIUS] * error
    if most <= (0.5 * LEAST_CLAMPING * row[RADIUS]) ** 2:
        return (False, 0.0, 0.0, 0.0)
    along = sqrt(max(square, 0.0))
    radius = 1.3 * row[RADIUS] * error / along if square > 16.0 * row[RADIUS] * error else 2.0 * sqrt(most)
    along *= side
    # x = (ay, -ax) when y = (ax, ay).
    return (True, row[X] + rise * ax + along * ay, row[Y] + rise * ay - along * ax, radius + error)


@inner
def row_meets_shallow(
    row: Array, ax: float, ay: float, height: float, error: float, side: float
) -> tuple[bool, float, float, float]:
    """``row_meets`` for a shallow arc."""
    x, y = middle_of(row)
    along, across = ax * row[AXIS_X] + ay * row[AXIS_Y], exact_dot(ax, -ay, row[AXIS_Y], row[AXIS_X])
    off, inverse = height - ax * x - ay * y, 1.0 / row[RADIUS]
    # All squares over that of the radius.
    square = across * across - inverse * off * (2.0 * along + inverse * off)
    most = square + 2.2 * inverse * error
    if most <= (0.5 * LEAST_CLAMPING) ** 2:
        return (False, 0.0, 0.0, 0.0)
    radius = 1.3 * error / sqrt(square) if square > 16.0 * inverse * error else 2.0 * row[RADIUS] * sqrt(most)
    dx, dy, _, _ = beside_middle(row, ax, ay, across, off, -side)
    return (True, x + dx, y + dy, radius + error)


@inner
def write_triple(triple: Array, pegs: Array, psi: float, features: Array, length: float) -> None:
    """Writes what moving pegs need of three standing pegs in place to (8, 3) rows, the last three of them
    work space.

    Let w_i = (n_i, t_i) be the wrenches of the standing pegs and D their determinant. Rows 0 to 2 hold the
    cross products of two of them, cyclically, with the sign of D. Let a moving peg have the wrench w. The
    null vector's entries of the standing pegs over that of the moving peg are minus the scalar products of
    those rows with w, over abs(D). Row 3 holds the place along x of the rightmost standing peg, the largest
    radius of the pegs, and the largest turn of a normal by that, in radians. Row 4 holds abs(D).
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
        if row[IS_ARC] != 0.0:
            swing = max(swing, pegs[k, PEG_RADIUS] / row[RADIUS])
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
    triple: Array,
    row: Array,
    x: float,
    y: float,
    radius: float,
    cx: float,
    cy: float,
    gap: float,
    limits: Limits,
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
    swing = max(triple[3, 2], 0.0 if row[IS_ARC] == 0.0 else radius / row[RADIUS])
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
    """Whether a moving peg cannot clamp on a feature: it is straight and faces the way that the peg would
    push."""
    return row[IS_ARC] == 0.0 and clamping * (row[AXIS_Y] * cx - row[AXIS_X] * cy) < -HAIR - doubt


@inner
def add_moving_pegs(
    out: Array,
    count: int,
    psi: float,
    reach: float,
    features: Features,
    lattice: Lattice,
    limits: Limits,
    counting: bool,
    space: WorkSpace,
    stats: IntArray,
) -> int:
    """Tries every moving peg for the three standing pegs in place, and appends the fixtures to ``out``.

    Returns
    -------
    how many records there are, -1 when there is no room for another
    """
    pegs, triple = space.pegs, space.triple
    cx, cy = cos(psi), sin(psi)
    pitch_y, length, rows = lattice.pitch_y, limits.wrench_length, features.rows
    base = cx * pegs[0, PEG_Y] - cy * pegs[0, PEG_X] + lattice.row_offset
    # Points of the part are at most 2 L apart.
    error = pegs[0, PEG_RADIUS] + 4.0 * length * reach
    slack = 1e-9 + error / pitch_y
    gap = limits.gap - GAP_SLACK - HAIR - 4.0 * length * reach
    write_triple(triple, pegs, psi, rows, length)
    asks_closure = not counting and limits.pairing == 0.0
    for e in range(features.moving[0], features.moving[1]):
        row = rows[e]
        if not counting and faces_away(row, cx, cy, limits.clamping, reach):
            continue
        lowest, highest = height_range(row, -cy, cx)
        first = int(ceil((lowest - base) / pitch_y - slack))
        last = int(floor((highest - base) / pitch_y + slack))
        # Nor does the side of an arc count that faces away.
        sides = 2 if counting or row[IS_ARC] == 0.0 else 1
        begin = 0 if sides == 2 or limits.clamping * row[SIGN] > 0.0 else 1
        for line in range(first, last + 1):
            for k in range(begin, begin + sides):
                meets, x, y, radius = row_meets(row, -cy, cx, base + line * pitch_y, error, 1.0 - 2.0 * k)
                if not meets:
                    continue
                if asks_closure and not may_close(triple, row, x, y, radius, cx, cy, gap, limits):
                    continue
                place_peg(pegs[3], x, y, e, 0.0, float(line), radius)
                verdict, separation = is_fixture(
                    pegs, 3.0, psi, reach, features, limits, space.contacts, space.null
                )
                stats[CANDIDATES] += 1
                if verdict > 0:
                    stats[CONTACTS] += 1
                if is_listed(verdict, counting, count, limits):
                    if count == out.shape[0]:
                        return -1
                    write_record(out[count], 3.0, pegs, psi, separation, reach)
                    count += 1
    return count


@inner
def farthest_right(features: Features, low: float, high: float) -> float:
    """How far right in mm along x a moving peg that touches the part may stand, for psi in [low, high] (arcs
    as whole circles)."""
    psi, half = (low + high) / 2.0, (high - low) / 2.0
    most = -np.inf
    for k in range(features.moving[0], features.moving[1]):
        row = features.loose[k]
        _, highest = height_range(row, cos(psi), sin(psi))
        size = local_size(row) + row[HALF_EXTENT]
        most = max(most, highest + size * half)
    return most


@inner
def write_limbs(
    pieces: Array, integers: IntArray, touched: tuple[int, int], farthest: float, out: Array
) -> int:
    """Writes the (N, 6) limbs, what their pairing looks at, of the pieces of standing pegs that leave room
    for a moving peg; return their number."""
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


@inner
def add_triples(
    out: Array,
    count: int,
    number: int,
    one: int,
    two: int,
    features: Features,
    curves: Curves,
    lattice: Lattice,
    limits: Limits,
    counting: bool,
    space: WorkSpace,
    stats: IntArray,
) -> int:
    """Tries every moving peg at each of a ``number`` of crossings of two curves with a common tail, and
    appends the fixtures to ``out``; result as for :func:`add_moving_pegs`."""
    for root in range(number):
        psi, reach = space.roots[root, ROOT_PSI], space.roots[root, ROOT_RADIUS]
        place_triple(space.pegs, one, two, psi, reach, features.rows, curves)
        count = add_moving_pegs(out, count, psi, reach, features, lattice, limits, counting, space, stats)
        if count < 0:
            break
    return count


@inner
def heads_share_a_line(one: IntArray, two: IntArray, features: Array, lattice: Lattice) -> bool:
    """Whether the heads of two chords with a common tail, given by their whole numbers, push along one line.

    Chords of which tail and head do are no curves. Left in, such heads make thousands of crossings that no
    rounding keeps apart, for all their curves nearly agree where the pegs stand square to the features.
    """
    x = (two[COLUMN_STEP] - one[COLUMN_STEP]) * lattice.pitch_x
    y = (two[ROW_STEP] - one[ROW_STEP]) * lattice.pitch_y
    return share_one_line(features[one[HEAD]], features[two[HEAD]], hypot(x, y))


@inner
def add_limb_pairs(
    out: Array,
    count: int,
    limbs: Array,
    pieces: Array,
    features: Features,
    curves: Curves,
    lattice: Lattice,
    limits: Limits,
    counting: bool,
    space: WorkSpace,
    stats: IntArray,
) -> int:
    """Appends what comes of the pairs of (N, 6) limbs with a common tail, from the one at ``space.at`` on
    (see ``work_space``)."""
    at, loose, integers = space.at, features.loose, curves.integers
    for i in range(at[0], limbs.shape[0]):
        if stats[STOPPED] != 0:
            break
        limb = limbs[i]
        first = pieces[int(limb[LIMB_PIECE])]
        one = int(first[CURVE])
        tail = integers[one, TAIL]
        # A tail on a whole circle may be counted from either side of the seam.
        circle = loose[tail, IS_ARC] != 0.0 and loose[tail, HALF_EXTENT] >= pi
        period = 2.0 * pi if circle else 0.0
        for back in range(at[1], i):
            j = i - 1 - back
            other = limbs[j]
            if other[LIMB_TAIL] != limb[LIMB_TAIL]:
                break
            stats[PAIRS] += 1
            # Most pairs differ by this.
            if not circle and (
                limb[LIMB_VALUE_LEAST] > other[LIMB_VALUE_MOST]
                or other[LIMB_VALUE_LEAST] > limb[LIMB_VALUE_MOST]
            ):
                continue
            if limb[LIMB_LOW] >= other[LIMB_HIGH] or other[LIMB_LOW] >= limb[LIMB_HIGH]:
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
            if not counting and heads_share_a_line(integers[one], integers[two], loose, lattice):
                continue
            if stats[STOPPED] != 0:
                break
            candidates, contacts = stats[CANDIDATES], stats[CONTACTS]
            number = crossings(
                first, second, loose, curves, POSITION, 0.0, period, 0.0, space.stack, space.roots
            )
            more = -1
            if number >= 0:
                more = add_triples(
                    out, count, number, one, two, features, curves, lattice, limits, counting, space, stats
                )
            elif count < out.shape[0]:
                write_given_up(out[count], 3.0, first, second, integers)
                more = count + 1
            if more < 0:
                at[0], at[1] = i, back
                stats[PAIRS] -= 1
                stats[CANDIDATES], stats[CONTACTS] = candidates, contacts
                return count
            stats[CROSSED] += 1
            count = more
        at[1] = 0
    at[0] = limbs.shape[0]
    return count


@compiled_making_arrays
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
    """All fixtures of three and one peg with psi in some neighbouring cells whose chords from the shared tail
    are no sliding pairs.

    Parameters and result as for ``two_and_two_cells``. The shared tail is on the feature of the lowest
    number, so that each triple of pegs shows up once. The curves, and so the pieces, are in the order of
    their tails.
    """
    out = np.empty((64, RECORD_LENGTH))
    count = int(np.int64(0))
    space, kept, room = work_space(), kept_edges(members.shape[0]), np.empty((64, PIECE_LENGTH))
    loose, integers = features.loose, curves.integers
    for cell in range(edges.shape[0] - 1):
        if stats[STOPPED] != 0:
            break
        farthest = np.inf
        if not counting:
            farthest = farthest_right(features, edges[cell], edges[cell + 1]) - limits.gap + GAP_SLACK + HAIR
        room, number = cell_pieces(
            edges[cell],
            edges[cell + 1],
            members,
            loose,
            curves,
            lattice.pitch_x,
            0.0,
            POSITION,
            kept,
            farthest,
            room,
        )
        pieces = room[:number]
        limbs = np.empty((pieces.shape[0], LIMB_LENGTH))
        limb_count = write_limbs(pieces, integers, features.standing, farthest, limbs)
        limbs, space.at[0] = limbs[:limb_count], 0
        while True:
            count = add_limb_pairs(
                out, count, limbs, pieces, features, curves, lattice, limits, counting, space, stats
            )
            if space.at[0] == limb_count:
                break
            out = grown(out)
    return out[:count]
