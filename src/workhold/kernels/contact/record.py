"""Pegs in place and records: what kernels write of four contacts that may be a fixture.

Columns of a peg: PEG_X, PEG_Y (centre in the workpiece's frame), PEG_FEATURE, PEG_COLUMN, PEG_ROW, PEG_RADIUS (in mm, of its
error).
Columns of a record: STANDING (how many pegs, the first ones, are on the carrier that stands still; the others are on the one
that moves), FEATURES (4), COLUMNS (4) and ROWS (4) of the pegs on their carriers' lattices counted from the first standing
peg (rows) and from each carrier's first peg (columns), PSI, TAIL_X and TAIL_Y (centre of the first peg in the workpiece's
frame), SEPARATION (x distance from the first standing to the first moving peg), REACH (radius of psi in radians),
LARGEST_RADIUS (of the pegs, in mm). A negative STANDING tells of a pair of chords that was given up: its features and steps,
with the orientation in PSI.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.compiling import inner
from workhold.kernels.curves.columns import COLUMN_STEP, HEAD, ROW_STEP, TAIL
from workhold.kernels.curves.piece_columns import CURVE, HIGH, LOW

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

PEG_X, PEG_Y, PEG_FEATURE, PEG_COLUMN, PEG_ROW, PEG_RADIUS = range(6)
PEG_LENGTH = 6

STANDING = 0
FEATURES = 1
COLUMNS = 5
ROWS = 9
PSI, TAIL_X, TAIL_Y, SEPARATION, REACH, LARGEST_RADIUS = range(13, 19)
RECORD_LENGTH = 19


@inner
def place_peg(peg: Array, x: float, y: float, feature: int, column: float, line: float, radius: float) -> None:
    """Write one peg to its (6,) place in a work array."""
    peg[PEG_X], peg[PEG_Y], peg[PEG_FEATURE] = x, y, feature
    peg[PEG_COLUMN], peg[PEG_ROW], peg[PEG_RADIUS] = column, line, radius


@inner
def write_record(row: Array, standing: float, pegs: Array, psi: float, separation: float, reach: float) -> None:
    """Write four pegs in place to a (19,) row of the records."""
    row[STANDING], row[PSI], row[SEPARATION], row[REACH] = standing, psi, separation, reach
    row[TAIL_X], row[TAIL_Y] = pegs[0, PEG_X], pegs[0, PEG_Y]
    row[LARGEST_RADIUS] = max(pegs[0, PEG_RADIUS], pegs[1, PEG_RADIUS], pegs[2, PEG_RADIUS], pegs[3, PEG_RADIUS])
    for k in range(4):
        row[FEATURES + k] = pegs[k, PEG_FEATURE]
        row[COLUMNS + k] = pegs[k, PEG_COLUMN]
        row[ROWS + k] = pegs[k, PEG_ROW]


@inner
def write_given_up(row: Array, standing: float, first: Array, second: Array, integers: IntArray) -> None:
    """Write a pair of pieces that was given up, with the middle of their common range, to a (19,) row of the records."""
    for k in range(RECORD_LENGTH):
        row[k] = 0.0
    psi = (max(first[LOW], second[LOW]) + min(first[HIGH], second[HIGH])) / 2.0
    row[STANDING], row[PSI], row[REACH], row[LARGEST_RADIUS] = -standing, psi, np.inf, np.inf
    for k in range(2):
        step = integers[int(first[CURVE])] if k == 0 else integers[int(second[CURVE])]
        row[FEATURES + 2 * k], row[FEATURES + 2 * k + 1] = step[TAIL], step[HEAD]
        row[COLUMNS + 2 * k + 1], row[ROWS + 2 * k + 1] = step[COLUMN_STEP], step[ROW_STEP]
