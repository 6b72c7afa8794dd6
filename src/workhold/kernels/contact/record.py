"""Four pegs in place: records of contacts that may be a fixture, and their contact equations.

Columns of a peg: PEG_X, PEG_Y (centre in the workpiece's frame), PEG_FEATURE, PEG_COLUMN, PEG_ROW, PEG_RADIUS
(in mm, of its error).

Columns of a record:

- STANDING: how many pegs, the first ones, are on the carrier that stands still; the others are on the one
  that moves;
- FEATURES (4) that the pegs touch;
- COLUMNS (4) and ROWS (4) of the pegs on their carriers' lattices, counted from the first standing peg (rows)
  and from each carrier's first peg (columns);
- PSI, and TAIL_X and TAIL_Y, the centre of the first peg in the workpiece's frame;
- SEPARATION: x distance from the first standing to the first moving peg;
- REACH: radius of psi in radians;
- LARGEST_RADIUS of the pegs, in mm.

A negative STANDING stands for a pair of chords that was given up: the record has its features and steps, and
the orientation in PSI.

The unknowns are z = (psi, tail x, tail y, separation): the turn of the pegs in the workpiece's frame, the
centre of the first peg, and the separation. That is the x distance from the first standing to the first
moving peg (sigma in the paper). The contact equations say that every centre lies on its feature's line or
circle; their Jacobian is taken over (L psi, tail x, tail y, separation), all in mm.

Work space: ``w`` (19, 4), a row of four numbers, one for each peg where nothing else is said, at

- UNKNOWNS: z;
- MOVING: 1 for a peg of the moving carrier, else 0;
- STEP_X, STEP_Y: places in mm from the first peg, without the separation;
- OFF: distances in mm of the centres from their lines and circles, outward positive;
- NEWTON: the Newton step in mm, over (L psi, tail x, tail y, separation);
- SLOPES (4): the Jacobian, a row for each peg;
- REST (4), INVERSE (4): what elimination leaves of the Jacobian, and its inverse;
- NULL: a null vector.

``points`` (4, 2) holds the centres in mm.
"""

from __future__ import annotations

from math import cos, hypot, sin
from typing import NamedTuple

import numpy as np

from workhold.kernels.base.arrays import write_inverse
from workhold.kernels.base.compiling import Array, IntArray, inner
from workhold.kernels.base.feature import (
    AXIS_X,
    AXIS_Y,
    IS_ARC,
    RADIUS,
    X,
    Y,
    is_shallow,
    measure_shallow_offset,
)
from workhold.kernels.base.tables import COLUMN_STEP, CURVE, HEAD, HIGH, LOW, ROW_STEP, TAIL, Lattice


class Angle(NamedTuple):
    """An orientation psi in radians, with its cosine and its sine."""

    psi: float
    cosine: float
    sine: float


PEG_X, PEG_Y, PEG_FEATURE, PEG_COLUMN, PEG_ROW, PEG_RADIUS = range(6)
PEG_LENGTH = 6

STANDING = 0
FEATURES = 1
COLUMNS = 5
ROWS = 9
PSI, TAIL_X, TAIL_Y, SEPARATION, REACH, LARGEST_RADIUS = range(13, 19)
RECORD_LENGTH = 19


@inner
def make_angle(psi: float) -> Angle:
    """Return an orientation psi, in radians, with its cosine and its sine."""
    return Angle(psi, cos(psi), sin(psi))


@inner
def place_peg(
    peg: Array, x: float, y: float, feature: int, column: float, line: float, radius: float
) -> None:
    """Write one peg to the row ``peg`` (6,): centre (x, y) in mm,
    feature, lattice column and row, error radius in mm.

    See ``contact.record`` for the layout of ``peg``.
    """
    peg[PEG_X], peg[PEG_Y], peg[PEG_FEATURE] = x, y, feature
    peg[PEG_COLUMN], peg[PEG_ROW], peg[PEG_RADIUS] = column, line, radius


@inner
def write_record(
    row: Array, standing: float, pegs: Array, psi: float, separation: float, reach: float
) -> None:
    """Write four pegs in place to ``row`` (19,), a row of the records.

    ``pegs`` is (4, 6); the first ``standing`` pegs are on the carrier that stands still. ``psi`` is the
    orientation and ``reach`` its error bound in radians, ``separation`` the x distance in mm from the first
    standing to the first moving peg. See ``contact.record`` for the layout of ``row`` and ``pegs``.
    """
    row[STANDING], row[PSI], row[SEPARATION], row[REACH] = standing, psi, separation, reach
    row[TAIL_X], row[TAIL_Y] = pegs[0, PEG_X], pegs[0, PEG_Y]
    row[LARGEST_RADIUS] = max(
        pegs[0, PEG_RADIUS], pegs[1, PEG_RADIUS], pegs[2, PEG_RADIUS], pegs[3, PEG_RADIUS]
    )
    for k in range(4):
        row[FEATURES + k] = pegs[k, PEG_FEATURE]
        row[COLUMNS + k] = pegs[k, PEG_COLUMN]
        row[ROWS + k] = pegs[k, PEG_ROW]


@inner
def write_given_up(row: Array, standing: float, first: Array, second: Array, integers: IntArray) -> None:
    """Write a row (19,) of the records for a pair of pieces of chord curves whose crossings were not found.

    STANDING is ``-standing``, PSI the middle of the pieces' common range, the error radii are inf. ``first``
    and ``second`` are piece rows, ``integers`` the whole numbers of the curves. See ``contact.record`` for
    the layout of ``row``, ``base.tables`` for that of ``first``, ``second`` and ``integers``.
    """
    for k in range(RECORD_LENGTH):
        row[k] = 0.0
    psi = (max(first[LOW], second[LOW]) + min(first[HIGH], second[HIGH])) / 2.0
    row[STANDING], row[PSI], row[REACH], row[LARGEST_RADIUS] = -standing, psi, np.inf, np.inf
    for k in range(2):
        step = integers[int(first[CURVE])] if k == 0 else integers[int(second[CURVE])]
        row[FEATURES + 2 * k], row[FEATURES + 2 * k + 1] = step[TAIL], step[HEAD]
        row[COLUMNS + 2 * k + 1], row[ROWS + 2 * k + 1] = step[COLUMN_STEP], step[ROW_STEP]


UNKNOWNS, MOVING, STEP_X, STEP_Y, OFF, NEWTON, SLOPES, REST, INVERSE, NULL = 0, 1, 2, 3, 4, 5, 6, 10, 14, 18
WORK_LENGTH = 19


@inner
def read_record(record: Array, lattice: Lattice, w: Array) -> None:
    """Copy a record (19,) to the work space ``w``: its unknowns, which pegs move, and the pegs' lattice
    places in mm.

    They go to the rows UNKNOWNS, MOVING, STEP_X and STEP_Y. See ``contact.record`` for the layout of
    ``record`` and ``w``.
    """
    w[UNKNOWNS, 0], w[UNKNOWNS, 1] = record[PSI], record[TAIL_X]
    w[UNKNOWNS, 2], w[UNKNOWNS, 3] = record[TAIL_Y], record[SEPARATION]
    for k in range(4):
        w[MOVING, k] = 1.0 if k >= record[STANDING] else 0.0
        w[STEP_X, k] = record[COLUMNS + k] * lattice.pitch_x
        w[STEP_Y, k] = record[ROWS + k] * lattice.pitch_y + w[MOVING, k] * lattice.row_offset


@inner
def write_contact_equations(record: Array, features: Array, length: float, w: Array, points: Array) -> None:
    """Compute the contacts at the unknowns in ``w``: write the rows
    OFF and SLOPES of ``w``, and the centres to ``points``.

    OFF is each peg's distance in mm from its feature's line or circle, SLOPES its derivatives over (L psi,
    tail x, tail y, separation). ``points`` (4, 2) is in the workpiece's frame, in mm. ``features`` are
    (F, 12) rows, ``length`` is L in mm, by which moments are divided. In the centre of an arc, which has no
    direction, the slopes of the peg are 0. See ``contact.record`` for the layout of ``record`` and ``w``,
    ``base.feature`` for that of ``features``.
    """
    cosine, sine = cos(w[UNKNOWNS, 0]), sin(w[UNKNOWNS, 0])
    for k in range(4):
        row = features[int(record[FEATURES + k])]
        across, along = w[STEP_X, k] + w[MOVING, k] * w[UNKNOWNS, 3], w[STEP_Y, k]
        turned_x, turned_y = cosine * across - sine * along, sine * across + cosine * along
        x, y = w[UNKNOWNS, 1] + turned_x, w[UNKNOWNS, 2] + turned_y
        points[k, 0], points[k, 1] = x, y
        gx, gy = row[AXIS_Y], -row[AXIS_X]
        dx, dy = x - row[X], y - row[Y]
        if row[IS_ARC] == 0.0:
            w[OFF, k] = dx * gx + dy * gy
        elif is_shallow(row):
            w[OFF, k], gx, gy = measure_shallow_offset(row, x, y)
        else:
            size = hypot(dx, dy)
            w[OFF, k] = size - row[RADIUS]
            # In its very centre no direction of an arc is nearer than another, and none is given.
            gx, gy = (dx / size, dy / size) if size > 0.0 else (0.0, 0.0)
        w[SLOPES + k, 0] = (gy * turned_x - gx * turned_y) / length
        w[SLOPES + k, 1], w[SLOPES + k, 2] = gx, gy
        w[SLOPES + k, 3] = w[MOVING, k] * (gx * cosine + gy * sine)


@inner
def invert_jacobian(w: Array) -> float:
    """Invert the Jacobian in ``w`` (rows SLOPES) to its rows INVERSE,
    and write the Newton step to its row NEWTON.

    The step is INVERSE times OFF in mm, to be subtracted from (L psi, tail x, tail y, separation). See
    ``contact.record`` for the layout of ``w``.

    Returns
    -------
    float
        Absolute value of the determinant; where it is 0 or NaN, INVERSE and NEWTON are no result.
    """
    for i in range(4):
        for j in range(4):
            w[REST + i, j] = w[SLOPES + i, j]
    determinant = write_inverse(w[REST : REST + 4], w[INVERSE : INVERSE + 4])
    for i in range(4):
        w[NEWTON, i] = 0.0
        for j in range(4):
            w[NEWTON, i] += w[INVERSE + i, j] * w[OFF, j]
    return determinant
