"""Type I: two pegs on each jaw, found as crossings of the heights of two chords, modulo the row pitch.

Half a turn of orientations is enough: turning the vise half way round swaps its jaws, so each fixture shows up once, with
the one chord or the other on the left.

Before crossings are sought, three bounds of the pieces are compared, each by a few additions: the right chord must be
able to stand the smallest gap to the right of the left one, both must be able to push against each other along x, and the
difference of their heights must be able to be a whole number of pitches.
"""

from __future__ import annotations

from math import ceil, cos, floor, sin

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.compiling import compiled, inner
from workhold.kernels.base.growing import with_room
from workhold.kernels.chord.discs import chord_tail
from workhold.kernels.chord.evaluation import HEIGHT
from workhold.kernels.contact.rules import (
    GAP_SLACK,
    LEAST_CLAMPING,
    LEAST_MARGIN,
    MIN_GAP,
    MOST_LISTED,
    PEG_LENGTH,
    RECORD_LENGTH,
    is_fixture,
    is_listed,
    place_peg,
    write_given_up,
    write_record,
)
from workhold.kernels.crossing.roots import (
    MOST_ROOTS,
    MULTIPLE,
    PSI,
    RADIUS,
    STACK_DEPTH,
    STACK_LENGTH,
    crossings,
    may_meet,
)
from workhold.kernels.curves.columns import CENTER, COLUMN_STEP, HEAD, LENGTH, ROW_STEP, SHIFT, TAIL
from workhold.kernels.curves.piece_columns import (
    ACROSS_LEAST,
    ACROSS_MOST,
    CURVE,
    FORCE_LEFT_LOW,
    HIGH,
    LOW,
    STEADY,
    VALUE_LEAST,
    VALUE_MOST,
    X_LEFT,
)
from workhold.kernels.curves.pieces import cell_pieces

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

# Columns of the statistics a block returns: pairs of pieces looked at, pairs whose crossings were sought, four contacts
# examined, and those that may be inside their features.
PAIRS, CROSSED, CANDIDATES, CONTACTS = range(4)
STATISTICS = 4
# Rounding of places along x in mm, generously counted.
HAIR = 1e-6
# Columns of a role: what the pairing of pieces looks at, one row for each piece that may be on that jaw.
ROLE_X, ROLE_FORCE_LOW, ROLE_FORCE_HIGH, ROLE_VALUE_LEAST, ROLE_VALUE_MOST, ROLE_LOW, ROLE_HIGH, ROLE_PIECE = range(8)
ROLE_LENGTH = 8


@inner
def place_chord(
    pegs: Array, curve: int, psi: float, reach: float, line: float, features: Array, integers: IntArray, reals: Array
) -> None:
    """Write the pegs of a curve's chord to (2, 6) places, the tail in row ``line`` of column 0.

    ``reach`` tells how far in radians psi may be off; the pegs' radii follow from it.
    """
    tail, head = integers[curve, TAIL], integers[curve, HEAD]
    d, alpha = reals[curve, LENGTH], psi + reals[curve, SHIFT]
    x, y, radius = chord_tail(features[tail], features[head], reals[curve], psi, reach)
    column, row = float(integers[curve, COLUMN_STEP]), float(integers[curve, ROW_STEP])
    place_peg(pegs[0], x, y, tail, 0.0, line, radius)
    place_peg(pegs[1], x + d * cos(alpha), y + d * sin(alpha), head, column, line + row, radius + d * reach)


@inner
def write_roles(pieces: Array, x_column: int, force_column: int, counting: bool, out: Array) -> int:
    """Write the (N, 8) roles of the pieces that may be on one jaw; return their number."""
    count = int(np.int64(0))
    for k in range(pieces.shape[0]):
        row = pieces[k]
        if row[force_column] > row[force_column + 1] and not counting:
            continue
        role = out[count]
        role[ROLE_X], role[ROLE_FORCE_LOW], role[ROLE_FORCE_HIGH] = (
            row[x_column],
            row[force_column],
            row[force_column + 1],
        )
        role[ROLE_VALUE_LEAST], role[ROLE_VALUE_MOST] = row[VALUE_LEAST], row[VALUE_MOST]
        role[ROLE_LOW], role[ROLE_HIGH], role[ROLE_PIECE] = row[LOW], row[HIGH], k
        count += 1
    return count


@inner
def sort_roles(roles: Array, count: int, keys: Array, order: IntArray) -> None:
    """Write the order of roles by their places along x, the rightmost first (Shell's sort)."""
    for k in range(count):
        keys[k], order[k] = roles[k, ROLE_X], k
    step = 1
    while step < count // 3:
        step = 3 * step + 1
    while step > 0:
        for k in range(step, count):
            key, item, at = keys[k], order[k], k
            while at >= step and keys[at - step] < key:
                keys[at], order[at] = keys[at - step], order[at - step]
                at -= step
            keys[at], order[at] = key, item
        step //= 3


@inner
def flat_slope(first: Array, second: Array) -> float:
    """A slope of the difference of heights below which two pieces do not clamp hard enough anywhere.

    The forces of each jaw's pegs act together along the line through the instant centres, so of a force of size 1 the part
    x . (P_B - P_A) / |P_B - P_A| clamps, and x . (P_B - P_A) is minus the slope.
    """
    apart = max(first[ACROSS_LEAST] - second[ACROSS_MOST], second[ACROSS_LEAST] - first[ACROSS_MOST])
    return 0.9 * LEAST_CLAMPING * max(apart, 0.0)


@inner
def may_cross(left: Array, right: Array, row_offset: float, pitch_y: float, counting: bool) -> bool:
    """Whether two roles far enough apart may make a fixture: their pushes and their heights allow it.

    For ``counting`` it is asked only whether the four contacts may be simultaneous.
    """
    if not counting and (
        right[ROLE_FORCE_LOW] > left[ROLE_FORCE_HIGH] or right[ROLE_FORCE_HIGH] < left[ROLE_FORCE_LOW]
    ):
        return False
    if right[ROLE_LOW] >= left[ROLE_HIGH] or left[ROLE_LOW] >= right[ROLE_HIGH]:
        return False
    lowest = right[ROLE_VALUE_LEAST] - left[ROLE_VALUE_MOST] - row_offset - HAIR
    highest = right[ROLE_VALUE_MOST] - left[ROLE_VALUE_LEAST] - row_offset + HAIR
    return ceil(lowest / pitch_y) * pitch_y <= highest


@compiled
def two_and_two_cells(
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
    """All Type I fixtures with psi in some neighbouring cells, but those that rest on a sliding pair chord.

    Parameters
    ----------
    edges : (K + 1,) edges of K cells, psi in radians.
    members : (M,) indices of the curves that exist in some of them, ascending.
    loose, features : (F, 8) rows of the features, with ends moved out by a hair (to search) and as they are (to check).
    integers, reals, stretches : the curve table.
    counting : count all simultaneous contacts (in ``stats``) instead of looking for fixtures only; those that are listed,
        if any, are listed with either chord on the left.
    stats : (4,) counts to add to.

    Returns
    -------
    (N, 19) array of records
    """
    out = np.empty((64, RECORD_LENGTH))
    count = int(np.int64(0))
    stack, roots = np.empty((STACK_DEPTH, STACK_LENGTH)), np.empty((MOST_ROOTS, 3))
    pegs, work, null = np.empty((4, PEG_LENGTH)), np.empty((8, 2)), np.empty(4)
    gap = limits[MIN_GAP] - GAP_SLACK - HAIR
    # Where both signs of the row offset mean the same rows, a contact counts once, whichever chord is on the left.
    both_offsets = floor(2.0 * row_offset / pitch_y + 0.5)
    once = abs(both_offsets - 2.0 * row_offset / pitch_y) <= 1e-12
    for cell in range(edges.shape[0] - 1):
        pieces = cell_pieces(
            edges[cell],
            edges[cell + 1],
            members,
            loose,
            integers,
            reals,
            stretches,
            pitch_x,
            limits[LEAST_MARGIN],
            HEIGHT,
        )
        roles, counts = np.empty((2, pieces.shape[0], ROLE_LENGTH)), np.empty(2, np.int64)
        for side in range(2):
            counts[side] = write_roles(pieces, X_LEFT + side, FORCE_LEFT_LOW + 2 * side, counting, roles[side])
        lefts, rights, left_count, right_count = roles[0], roles[1], counts[0], counts[1]
        keys, order = np.empty(right_count), np.empty(right_count, np.int64)
        sort_roles(rights, right_count, keys, order)
        sorted_rights = np.empty((right_count, ROLE_LENGTH))
        for j in range(right_count):
            for k in range(ROLE_LENGTH):
                sorted_rights[j, k] = rights[order[j], k]
        for i in range(left_count):
            left = lefts[i]
            first = pieces[int(left[ROLE_PIECE])]
            one = int(first[CURVE])
            for j in range(right_count):
                right = sorted_rights[j]
                if not counting and right[ROLE_X] - left[ROLE_X] < gap:
                    break
                stats[PAIRS] += 1
                if not may_cross(left, right, row_offset, pitch_y, counting):
                    continue
                second = pieces[int(right[ROLE_PIECE])]
                two = int(second[CURVE])
                if one == two or (integers[one, CENTER] >= 0 and integers[one, CENTER] == integers[two, CENTER]):
                    continue
                if counting and once and one > two and limits[MOST_LISTED] == 0.0:
                    continue
                steady = first[STEADY] * second[STEADY] == 1.0
                if steady and not may_meet(first, second, row_offset, pitch_y):
                    continue
                stats[CROSSED] += 1
                flat = 0.0 if counting else flat_slope(first, second)
                number = crossings(
                    first, second, loose, integers, reals, HEIGHT, row_offset, pitch_y, flat, stack, roots
                )
                if number < 0:
                    out = with_room(out, count)
                    write_given_up(out[count], 1.0, first, second, integers)
                    count += 1
                for root in range(number):
                    psi, reach = roots[root, PSI], roots[root, RADIUS]
                    # The height of the right chord over the left one is the row offset and so many pitches.
                    place_chord(pegs[:2], one, psi, reach, 0.0, features, integers, reals)
                    place_chord(pegs[2:], two, psi, reach, roots[root, MULTIPLE], features, integers, reals)
                    verdict, apart = is_fixture(pegs, 2.0, psi, reach, features, limits, work, null)
                    stats[CANDIDATES] += 1
                    if verdict > 0:
                        stats[CONTACTS] += 1
                    if is_listed(verdict, counting, count, limits):
                        out = with_room(out, count)
                        write_record(out[count], 1.0, pegs, psi, apart, reach)
                        count += 1
    return out[:count]
