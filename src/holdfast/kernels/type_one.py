"""Type I: two pegs on each jaw, found as crossings of the heights of two chords, modulo the row pitch.

Work on half a turn of orientations and on unordered pairs of chords: turning the vise half way round swaps its jaws, so
each fixture shows up once, with either chord on the left.
"""

from __future__ import annotations

from math import cos, floor, sin

import numpy as np
from numpy.typing import NDArray

from holdfast.kernels.chord import HEIGHT
from holdfast.kernels.chord_bounds import chord_tail
from holdfast.kernels.compiling import compiled
from holdfast.kernels.crossing import MOST_ROOTS, MULTIPLE, PSI, RADIUS, STACK_DEPTH, STACK_LENGTH, crossings
from holdfast.kernels.pieces import (
    BRANCH,
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
from holdfast.kernels.vise_checks import (
    PEG_LENGTH,
    RECORD_LENGTH,
    is_fixture,
    place_peg,
    write_given_up,
    write_record,
)

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

# Columns of the statistics a cell returns: pairs of pieces, four contacts examined, those that may be inside their features,
# and those kept as possible fixtures.
PAIRS, CANDIDATES, CONTACTS, FOUND = range(4)
STATISTICS = 4


@compiled
def place_chord(
    pegs: Array, curve: int, psi: float, reach: float, line: float, features: Array, integers: IntArray, reals: Array
) -> None:
    """Write the pegs of a curve's chord to (2, 6) places, the tail in row ``line`` of column 0.

    ``reach`` tells how far in radians psi may be off; the pegs' radii follow from it.
    """
    tail, head = integers[curve, TAIL], integers[curve, HEAD]
    a, b = features[tail], features[head]
    d, alpha = reals[curve, LENGTH], psi + reals[curve, SHIFT]
    x, y, radius = chord_tail(a, b, d, alpha, reals[curve, BRANCH], reach)
    column, row = float(integers[curve, COLUMN_STEP]), float(integers[curve, ROW_STEP])
    place_peg(pegs[0], x, y, tail, 0.0, line, radius)
    place_peg(pegs[1], x + d * cos(alpha), y + d * sin(alpha), head, column, line + row, radius + d * reach)


@compiled
def type_one_cell(
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
    """All Type I fixtures with psi in one cell, but those that rest on an upright chord.

    Parameters
    ----------
    pieces : (N, 13) pieces of one cell, of the curves' heights.
    loose, features : (F, 8) rows of the features, with ends moved out by a hair (to search) and as they are (to check).
    integers, reals : the curve table.
    stats : (4,) counts to add to.

    Returns
    -------
    (N, 19) array of records
    """
    out = np.empty((64, RECORD_LENGTH))
    count = int(np.int64(0))
    stack, roots = np.empty((STACK_DEPTH, STACK_LENGTH)), np.empty((MOST_ROOTS, 3))
    pegs, work, null = np.empty((4, PEG_LENGTH)), np.empty((8, 2)), np.empty(4)
    # Which chord is on the left decides the sign of the row offset; where both signs mean the same rows, look once.
    both_offsets = floor(2.0 * row_offset / pitch_y + 0.5)
    twice = abs(both_offsets - 2.0 * row_offset / pitch_y) > 1e-12
    for i in range(pieces.shape[0]):
        one = int(pieces[i, CURVE])
        for j in range(i):
            two = int(pieces[j, CURVE])
            if one == two or pieces[i, LOW] >= pieces[j, HIGH] or pieces[j, LOW] >= pieces[i, HIGH]:
                continue
            if integers[one, CENTER] >= 0 and integers[one, CENTER] == integers[two, CENTER]:
                continue
            stats[PAIRS] += 1
            for side in range(2):
                if side == 1 and not twice:
                    continue
                offset = row_offset if side == 0 else -row_offset
                number = crossings(pieces[i], pieces[j], loose, integers, reals, HEIGHT, offset, pitch_y, stack, roots)
                if number < 0:
                    if count == out.shape[0]:
                        out = grown(out)
                    write_given_up(out[count], 1.0, pieces[i], pieces[j], integers)
                    count += 1
                for root in range(number):
                    psi, reach, multiple = roots[root, PSI], roots[root, RADIUS], roots[root, MULTIPLE]
                    contact = 0
                    for order in range(2):
                        # Without a second pass either order may be on the left; with it, each pass is for one order.
                        if twice and order != side:
                            continue
                        # The height of chord two over chord one is offset + multiple pitches.
                        left, right, line = one, two, multiple
                        if order == 1:
                            left, right = two, one
                            line = -multiple if side == 1 else -multiple - both_offsets
                        place_chord(pegs[:2], left, psi, reach, 0.0, features, integers, reals)
                        place_chord(pegs[2:], right, psi, reach, line, features, integers, reals)
                        verdict, apart = is_fixture(pegs, 2.0, psi, reach, features, limits, work, null)
                        contact = max(contact, verdict)
                        stats[CANDIDATES] += 1
                        if verdict == 2:
                            if count == out.shape[0]:
                                out = grown(out)
                            write_record(out[count], 1.0, pegs, psi, apart, reach)
                            count += 1
                            stats[FOUND] += 1
                    if contact > 0:
                        stats[CONTACTS] += 1
    return out[:count]
