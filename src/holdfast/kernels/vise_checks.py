"""What is particular to the fixture vise: which pegs move together, along what, and when closing the vise clamps.

The left jaw is fixed and the right jaw slides along the vise's x axis. Four pegs at simultaneous contact are a fixture
when every contact lies inside its feature, the right pegs stand ``min_gap`` to the right of the left ones, and the
wrenches close with the left pegs pushing to the right (model: conditions 1, 3, 4 and 5).

Columns of a record: KIND (1 or 2), FEATURES (4), COLUMNS (4) and ROWS (4) of the pegs on their jaws' lattices counted
from the first left peg (rows) and from each jaw's first peg (columns), PSI, TAIL_X and TAIL_Y (centre of the first peg in
the workpiece's frame), APART (x distance from the first left to the first right peg), NULL (4). Left pegs come first.
"""

from __future__ import annotations

from math import cos, pi, sin

import numpy as np
from numpy.typing import NDArray

from holdfast.kernels.chord import parameter_on
from holdfast.kernels.closure import null_vector, outward_normal
from holdfast.kernels.compiling import compiled
from holdfast.kernels.pieces import COLUMN_STEP, ROW_STEP

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

KIND = 0
FEATURES = 1
COLUMNS = 5
ROWS = 9
PSI, TAIL_X, TAIL_Y, APART = 13, 14, 15, 16
NULL = 17
RECORD_LENGTH = 21

# Right pegs may stand nearer than the smallest gap by this much, in mm: rounding of a gap that is met exactly.
GAP_SLACK = 1e-9
# The smallest entry of the null vector and the clamping force must exceed this (model: conditions 4 and 5).
LEAST_CLOSURE = 1e-9

# Indices into the limits handed to the kernels.
MIN_GAP, CONTACT_MARGIN, WRENCH_LENGTH, MOST_COLUMN_STEPS = range(4)


@compiled
def is_within(row: Array, x: float, y: float, margin: float) -> bool:
    """Whether a contact lies on its feature, at least ``margin`` mm from its ends (a whole circle has none).

    ``row`` has ten entries, the last two how far in mm a contact may lie past the low and the high end.
    """
    if row[0] != 0.0 and row[5] >= pi:
        return True
    scale = 1.0 if row[0] == 0.0 else row[6]
    s = parameter_on(row, x, y)
    slack = row[9] if s > 0.0 else row[8]
    return (row[5] - abs(s)) * scale >= margin - slack


@compiled
def place_peg(peg: Array, x: float, y: float, feature: int, column: float, line: float) -> None:
    """Write one peg to its (5,) place in a work array: centre, feature, column and row."""
    peg[0], peg[1], peg[2], peg[3], peg[4] = x, y, feature, column, line


@compiled
def is_fixture(
    pegs: Array, lefts: float, psi: float, features: Array, limits: Array, work: Array, null: Array
) -> tuple[int, float]:
    """Check four pegs at simultaneous contact.

    Parameters
    ----------
    pegs : (4, 5) centre x, y in the workpiece's frame, feature, column, row; the first ``lefts`` on the left jaw.
    psi : orientation of the pegs in the workpiece's frame.
    features : (F, 10) rows with the slack of their ends.
    limits : min gap, contact margin and wrench length in mm, and the largest column difference on one jaw.
    work : (8, 2) work space.
    null : (4,) receives the null vector.

    Returns
    -------
    (2 for a fixture, 1 for a simultaneous contact inside all four features, 0 for neither;
     x distance from the first left to the first right peg)
    """
    cx, cy = cos(psi), sin(psi)
    leftmost_right, rightmost_left = np.inf, -np.inf
    points, normals = work[:4], work[4:]
    first_left = first_right = 0.0
    for k in range(4):
        x, y = pegs[k, 0], pegs[k, 1]
        row = features[int(pegs[k, 2])]
        if not is_within(row, x, y, limits[CONTACT_MARGIN]):
            return (0, 0.0)
        points[k, 0], points[k, 1] = x, y
        normals[k, 0], normals[k, 1] = outward_normal(row, x, y)
        along = cx * x + cy * y
        if k < lefts:
            rightmost_left = max(rightmost_left, along)
            if k == 0:
                first_left = along
        else:
            leftmost_right = min(leftmost_right, along)
            if k == int(lefts):
                first_right = along
    if leftmost_right - rightmost_left < limits[MIN_GAP] - GAP_SLACK:
        return (1, 0.0)
    if null_vector(points, normals, limits[WRENCH_LENGTH], null) <= LEAST_CLOSURE:
        return (1, 0.0)
    clamp = 0.0
    for k in range(int(lefts)):
        clamp -= null[k] * (normals[k, 0] * cx + normals[k, 1] * cy)
    if clamp <= LEAST_CLOSURE:
        return (1, 0.0)
    return (2, first_right - first_left)


@compiled
def share_a_jaw(one: IntArray, two: IntArray, limits: Array) -> bool:
    """Whether the heads of two chords with a common tail, given by their whole numbers, are different holes of one jaw."""
    k, m = one[COLUMN_STEP], two[COLUMN_STEP]
    if k == m and one[ROW_STEP] == two[ROW_STEP]:
        return False
    return max(k, m, 0) - min(k, m, 0) <= limits[MOST_COLUMN_STEPS]


@compiled
def write_record(row: Array, kind: float, pegs: Array, psi: float, apart: float, null: Array) -> None:
    """Write a fixture to its (21,) row of the records."""
    row[KIND], row[PSI], row[APART] = kind, psi, apart
    row[TAIL_X], row[TAIL_Y] = pegs[0, 0], pegs[0, 1]
    for k in range(4):
        row[FEATURES + k] = pegs[k, 2]
        row[COLUMNS + k] = pegs[k, 3]
        row[ROWS + k] = pegs[k, 4]
        row[NULL + k] = null[k]
