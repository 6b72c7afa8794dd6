"""Type I: two pegs on each jaw, found as crossings of the heights of two chords, modulo the row pitch.

Work on half a turn of orientations and on unordered pairs of chords: turning the vise half way round swaps its jaws, so
each fixture shows up once, with either chord on the left.
"""

from __future__ import annotations

from math import cos, floor, sin

import numpy as np
from numpy.typing import NDArray

from holdfast.kernels.chord import HEIGHT, chord
from holdfast.kernels.compiling import compiled
from holdfast.kernels.crossing import MOST_ROOTS, STACK_DEPTH, crossings
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
from holdfast.kernels.vise_checks import RECORD_LENGTH, is_fixture, place_peg, write_record

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

# Columns of the statistics a cell returns.
PAIRS, CONTACTS, FOUND, TOUCHES = range(4)


@compiled
def place_chord(
    pegs: Array, curve: int, psi: float, line: float, features: Array, integers: IntArray, reals: Array
) -> None:
    """Write the pegs of a curve's chord at an orientation to (2, 5) places, the tail in row ``line`` of column 0."""
    tail, head = integers[curve, TAIL], integers[curve, HEAD]
    d, alpha = reals[curve, LENGTH], psi + reals[curve, SHIFT]
    c = chord(features[tail], features[head], d, alpha, reals[curve, BRANCH])
    column, row = float(integers[curve, COLUMN_STEP]), float(integers[curve, ROW_STEP])
    place_peg(pegs[0], c[0], c[1], tail, 0.0, line)
    place_peg(pegs[1], c[0] + d * cos(alpha), c[1] + d * sin(alpha), head, column, line + row)


@compiled
def rows_between(pegs: Array, psi: float, pitch_y: float, row_offset: float) -> float:
    """Row of the third peg on the right jaw, counted from that of the first on the left."""
    rise = -sin(psi) * (pegs[2, 0] - pegs[0, 0]) + cos(psi) * (pegs[2, 1] - pegs[0, 1])
    return floor((rise - row_offset) / pitch_y + 0.5)


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
    pieces : (N, 9) pieces of one cell, of the curves' heights.
    loose, features : (F, 8) rows of the features, with ends moved out by a hair (to search) and as they are (to check).
    integers, reals : the curve table.
    stats : (4,) counts to add to: pairs of pieces, simultaneous contacts, fixtures, touches.

    Returns
    -------
    (N, 21) array of records
    """
    out = np.empty((64, RECORD_LENGTH))
    count = int(np.int64(0))
    stack, roots = np.empty((STACK_DEPTH, 10)), np.empty(MOST_ROOTS)
    pegs, work, null = np.empty((4, 5)), np.empty((8, 2)), np.empty(4)
    # Which chord is on the left decides the sign of the row offset; where both signs mean the same rows, look once.
    twice = abs(floor(2.0 * row_offset / pitch_y + 0.5) - 2.0 * row_offset / pitch_y) > 1e-12
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
                number, touches = crossings(
                    pieces[i], pieces[j], loose, integers, reals, HEIGHT, offset, pitch_y, stack, roots
                )
                # Chords of one step that touch are one chord, seen from two faces at their joint.
                if (
                    integers[one, COLUMN_STEP] != integers[two, COLUMN_STEP]
                    or integers[one, ROW_STEP] != integers[two, ROW_STEP]
                ):
                    stats[TOUCHES] += touches
                for k in range(number):
                    psi = roots[k]
                    contact = 0
                    for order in range(2):
                        # Without a second pass either order may be on the left; with it, each pass is for one order.
                        if twice and order != side:
                            continue
                        left, right = (one, two) if order == 0 else (two, one)
                        place_chord(pegs[:2], left, psi, 0.0, features, integers, reals)
                        place_chord(pegs[2:], right, psi, 0.0, features, integers, reals)
                        line = rows_between(pegs, psi, pitch_y, row_offset)
                        pegs[2, 4] += line
                        pegs[3, 4] += line
                        verdict, apart = is_fixture(pegs, 2.0, psi, features, limits, work, null)
                        contact = max(contact, verdict)
                        if verdict == 2:
                            if count == out.shape[0]:
                                out = grown(out)
                            write_record(out[count], 1.0, pegs, psi, apart, null)
                            count += 1
                    if contact > 0:
                        stats[CONTACTS] += 1
    stats[FOUND] += count
    return out[:count]
