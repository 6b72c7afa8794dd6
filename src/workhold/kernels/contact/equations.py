"""Four pegs in place: their centres, how far those are off their features, and how that changes when they move.

The unknowns are z = (psi, tail x, tail y, separation): the turn of the pegs in the workpiece's frame, the centre of the
first peg, and the x distance from the first standing to the first moving peg (sigma in the paper). The contact equations say
that every centre lies on its feature's line or circle; their Jacobian is taken over (L psi, tail x, tail y, separation), all
in mm.

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

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.compiling import inner
from workhold.kernels.base.elimination import eliminate
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, IS_ARC, RADIUS, X, Y
from workhold.kernels.base.given import Lattice
from workhold.kernels.base.shallow import is_shallow, off_shallow
from workhold.kernels.contact.record import COLUMNS, FEATURES, PSI, ROWS, SEPARATION, STANDING, TAIL_X, TAIL_Y

Array = NDArray[np.float64]

UNKNOWNS, MOVING, STEP_X, STEP_Y, OFF, NEWTON, SLOPES, REST, INVERSE, NULL = 0, 1, 2, 3, 4, 5, 6, 10, 14, 18
WORK_LENGTH = 19


@inner
def take_pegs(record: Array, lattice: Lattice, w: Array) -> None:
    """Bring the pegs of a (19,) record to their places on the carriers, and the unknowns to its own."""
    w[UNKNOWNS, 0], w[UNKNOWNS, 1] = record[PSI], record[TAIL_X]
    w[UNKNOWNS, 2], w[UNKNOWNS, 3] = record[TAIL_Y], record[SEPARATION]
    for k in range(4):
        w[MOVING, k] = 1.0 if k >= record[STANDING] else 0.0
        w[STEP_X, k] = record[COLUMNS + k] * lattice.pitch_x
        w[STEP_Y, k] = record[ROWS + k] * lattice.pitch_y + w[MOVING, k] * lattice.row_offset


@inner
def touch(record: Array, features: Array, length: float, w: Array, points: Array) -> None:
    """Fill in centres, distances and Jacobian for the unknowns in place; ``length`` is L in mm."""
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
            w[OFF, k], gx, gy = off_shallow(row, x, y)
        else:
            size = hypot(dx, dy)
            w[OFF, k] = size - row[RADIUS]
            # In its very centre no direction of an arc is nearer than another, and none is told.
            gx, gy = (dx / size, dy / size) if size > 0.0 else (0.0, 0.0)
        w[SLOPES + k, 0] = (gy * turned_x - gx * turned_y) / length
        w[SLOPES + k, 1], w[SLOPES + k, 2] = gx, gy
        w[SLOPES + k, 3] = w[MOVING, k] * (gx * cosine + gy * sine)


@inner
def invert(w: Array) -> float:
    """Invert the Jacobian and make the Newton step.

    Returns
    -------
    float
        The size of the determinant; where it is 0 or NaN there is no inverse.
    """
    for i in range(4):
        for j in range(4):
            w[REST + i, j] = w[SLOPES + i, j]
    determinant = eliminate(w[REST : REST + 4], w[INVERSE : INVERSE + 4])
    for i in range(4):
        w[NEWTON, i] = 0.0
        for j in range(4):
            w[NEWTON, i] += w[INVERSE + i, j] * w[OFF, j]
    return determinant
