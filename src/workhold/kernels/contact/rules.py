"""What is particular to the fixture vise: which pegs move together, along what, and when closing the vise clamps.

The left jaw is fixed and the right jaw slides along the vise's x axis. Four pegs at simultaneous contact are a fixture
when every contact lies inside its feature, the right pegs stand ``min_gap`` to the right of the left ones, and the
wrenches close with the left pegs pushing to the right (model: conditions 1, 3, 4 and 5).

Every rule is decided by bounds: the exact contact is within a radius of the computed one, and only what breaks a rule
everywhere within that radius is discarded.

Columns of a peg: X, Y (centre in the workpiece's frame), FEATURE, COLUMN, ROW, RADIUS (in mm, of its error).
Columns of a record: KIND (1 or 2), FEATURES (4), COLUMNS (4) and ROWS (4) of the pegs on their jaws' lattices counted
from the first left peg (rows) and from each jaw's first peg (columns), PSI, TAIL_X and TAIL_Y (centre of the first peg in
the workpiece's frame), APART (x distance from the first left to the first right peg), REACH (radius of psi in radians),
RADIUS (largest of the pegs' radii in mm). Left pegs come first. A negative KIND tells of a pair of chords that was given
up: its features and steps, with the orientation in PSI.
"""

from __future__ import annotations

from math import cos, pi, sin

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.compiling import inner
from workhold.kernels.chord.evaluation import parameter_on
from workhold.kernels.contact.closure import minor_band, minors, outward_normal
from workhold.kernels.curves.columns import COLUMN_STEP, HEAD, ROW_STEP, TAIL
from workhold.kernels.curves.piece_columns import CURVE, HIGH, LOW

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

KIND = 0
FEATURES = 1
COLUMNS = 5
ROWS = 9
PSI, TAIL_X, TAIL_Y, APART, REACH, RADIUS = range(13, 19)
RECORD_LENGTH = 19
PEG_LENGTH = 6

# Right pegs may stand nearer than the smallest gap by this much, in mm: rounding of a gap that is met exactly.
GAP_SLACK = 1e-9
# The smallest entry of the null vector must exceed this (model: condition 4).
LEAST_CLOSURE = 1e-9
# The clamping force must exceed this (model: condition 5). At an exact double root the force is 0, and the rounding of the
# drawing makes it up to 1e-7 or so; the edge stands clear of both.
LEAST_CLAMPING = 1e-6
# The sizes of the four minors must sum to more than this: with less, the lines of action meet in one point or are parallel
# up to the rounding of the drawing, and the wrenches do not span the space.
LEAST_SPAN = 1e-7

# Indices into the limits handed to the kernels.
MIN_GAP, CONTACT_MARGIN, WRENCH_LENGTH, MOST_COLUMN_STEPS, LEAST_MARGIN, MOST_LISTED = range(6)
LIMITS = 6


@inner
def is_within(row: Array, x: float, y: float, margin: float, radius: float) -> bool:
    """Whether a contact may lie on its feature, at least ``margin`` mm from its ends (a whole circle has none).

    ``row`` has ten entries, the last two how far in mm a contact may lie past the low and the high end.
    """
    if row[0] != 0.0 and row[5] >= pi:
        return True
    scale = 1.0 if row[0] == 0.0 else row[6]
    s = parameter_on(row, x, y)
    slack = row[9] if s > 0.0 else row[8]
    return (row[5] - abs(s)) * scale >= margin - slack - 1.2 * radius


@inner
def place_peg(peg: Array, x: float, y: float, feature: int, column: float, line: float, radius: float) -> None:
    """Write one peg to its (6,) place in a work array."""
    peg[0], peg[1], peg[2], peg[3], peg[4], peg[5] = x, y, feature, column, line, radius


@inner
def is_fixture(
    pegs: Array, lefts: float, psi: float, reach: float, features: Array, limits: Array, work: Array, null: Array
) -> tuple[int, float]:
    """Check four pegs at simultaneous contact.

    Parameters
    ----------
    pegs : (4, 6) places; the first ``lefts`` on the left jaw.
    psi, reach : orientation of the pegs in the workpiece's frame, and how far it may be off, in radians.
    features : (F, 10) rows with the slack of their ends.
    limits : min gap, contact margin and wrench length in mm, the largest column difference on one jaw, the smallest
        closure margin of interest, and how many contacts a block lists when it counts them.
    work : (8, 2) work space.
    null : (4,) receives the null vector, not scaled.

    Returns
    -------
    (2 when it may be a fixture, 1 when the four contacts may be inside their features, 0 when they are not;
     x distance from the first left to the first right peg, but 0 for verdict 0)
    """
    cx, cy = cos(psi), sin(psi)
    leftmost_right, rightmost_left = np.inf, -np.inf
    points, normals = work[:4], work[4:]
    first_left = first_right = 0.0
    radius = swing = 0.0
    for k in range(4):
        x, y = pegs[k, 0], pegs[k, 1]
        row = features[int(pegs[k, 2])]
        if not is_within(row, x, y, limits[CONTACT_MARGIN], pegs[k, 5]):
            return (0, 0.0)
        radius = max(radius, pegs[k, 5])
        points[k, 0], points[k, 1] = x, y
        normals[k, 0], normals[k, 1] = outward_normal(row, x, y)
        if row[0] != 0.0:
            swing = max(swing, pegs[k, 5] / row[6])
        along = cx * x + cy * y
        if k < lefts:
            rightmost_left = max(rightmost_left, along)
            if k == 0:
                first_left = along
        else:
            leftmost_right = min(leftmost_right, along)
            if k == int(lefts):
                first_right = along
    length, apart = limits[WRENCH_LENGTH], first_right - first_left
    if leftmost_right - rightmost_left < limits[MIN_GAP] - GAP_SLACK - 2.0 * (radius + length * reach):
        return (1, apart)
    size = minors(points, normals, length, null)
    band = minor_band(swing, radius, length)
    low, high = min(null[0], null[1], null[2], null[3]), max(null[0], null[1], null[2], null[3])
    sign = 1.0 if high >= -low else -1.0
    smallest = low if sign > 0.0 else -high
    least = max(LEAST_CLOSURE, limits[LEAST_MARGIN])
    if smallest + band <= least * (size - 4.0 * band) or size + 4.0 * band <= LEAST_SPAN:
        return (1, apart)
    clamp = 0.0
    for k in range(int(lefts)):
        clamp -= sign * null[k] * (normals[k, 0] * cx + normals[k, 1] * cy)
    if clamp + 3.0 * band + size * (swing + reach) <= LEAST_CLAMPING * (size - 4.0 * band):
        return (1, apart)
    if lefts == 3.0:
        # What the single right peg takes up is the product of two numbers, and small when either is.
        push = abs(normals[3, 0] * cx + normals[3, 1] * cy) + swing + reach
        if (abs(null[3]) + band) * push <= LEAST_CLAMPING * (size - 4.0 * band):
            return (1, apart)
    return (2, apart)


@inner
def is_listed(verdict: int, counting: bool, count: int, limits: Array) -> bool:
    """Whether four contacts with a verdict of :func:`is_fixture` are written to the records, ``count`` of which there are:
    what may be a fixture, or, when contacts are counted, all up to so many."""
    if counting:
        return verdict > 0 and count < limits[MOST_LISTED]
    return verdict == 2


@inner
def share_a_jaw(one: IntArray, two: IntArray, limits: Array) -> bool:
    """Whether the heads of two chords with a common tail, given by their whole numbers, are different holes of one jaw."""
    k, m = one[COLUMN_STEP], two[COLUMN_STEP]
    if k == m and one[ROW_STEP] == two[ROW_STEP]:
        return False
    return max(k, m, 0) - min(k, m, 0) <= limits[MOST_COLUMN_STEPS]


@inner
def write_record(row: Array, kind: float, pegs: Array, psi: float, apart: float, reach: float) -> None:
    """Write four pegs in place to a (19,) row of the records."""
    row[KIND], row[PSI], row[APART], row[REACH] = kind, psi, apart, reach
    row[TAIL_X], row[TAIL_Y] = pegs[0, 0], pegs[0, 1]
    row[RADIUS] = max(pegs[0, 5], pegs[1, 5], pegs[2, 5], pegs[3, 5])
    for k in range(4):
        row[FEATURES + k] = pegs[k, 2]
        row[COLUMNS + k] = pegs[k, 3]
        row[ROWS + k] = pegs[k, 4]


@inner
def write_given_up(row: Array, kind: float, first: Array, second: Array, integers: IntArray) -> None:
    """Write a pair of pieces that was given up, with the middle of their common range, to a (19,) row of the records."""
    for k in range(RECORD_LENGTH):
        row[k] = 0.0
    psi = (max(first[LOW], second[LOW]) + min(first[HIGH], second[HIGH])) / 2.0
    row[KIND], row[PSI], row[REACH], row[RADIUS] = -kind, psi, np.inf, np.inf
    for k in range(2):
        step = integers[int(first[CURVE])] if k == 0 else integers[int(second[CURVE])]
        row[FEATURES + 2 * k], row[FEATURES + 2 * k + 1] = step[TAIL], step[HEAD]
        row[COLUMNS + 2 * k + 1], row[ROWS + 2 * k + 1] = step[COLUMN_STEP], step[ROW_STEP]
