"""One peg on the carrier that moves, tried for three standing pegs in place.

The workpiece stands still there, and each row of the moving carrier meets each feature in at most two points.
"""

from __future__ import annotations

import numpy as np

from workhold.conventions import GAP_SLACK
from workhold.kernels.base.compiling import Array, inner
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, IS_ARC, RADIUS, SIGN
from workhold.kernels.base.given import Limits
from workhold.kernels.contact.record import PEG_FEATURE, PEG_RADIUS, PEG_X, PEG_Y, Angle, place_peg
from workhold.kernels.contact.rules import minor_band, outward_normal
from workhold.kernels.curves.block_work import BlockWork, add_listed
from workhold.kernels.curves.piece_bounds import HAIR
from workhold.kernels.curves.rows import height_range, lines_between, row_meets


@inner
def write_triple(triple: Array, pegs: Array, cx: float, cy: float, features: Array, length: float) -> None:
    """Writes what moving pegs need of three standing pegs in place to (8, 3) rows, the last three of them
    work space. The x axis of the pegs lies along (cx, cy).

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
        rightmost = max(rightmost, cx * x + cy * y)
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
def add_moving_pegs(out: Array, count: int, angle: Angle, reach: float, work: BlockWork) -> int:
    """Tries every moving peg for the three standing pegs in place, and appends the fixtures to ``out``.

    Returns
    -------
    how many records there are, -1 when there is no room for another
    """
    pegs, triple, lattice, limits, features = work.pegs, work.triple, work.lattice, work.limits, work.features
    _, cx, cy = angle
    pitch_y, length, rows = lattice.pitch_y, limits.wrench_length, features.rows
    base = cx * pegs[0, PEG_Y] - cy * pegs[0, PEG_X] + lattice.row_offset
    # Points of the part are at most 2 L apart.
    error = pegs[0, PEG_RADIUS] + 4.0 * length * reach
    gap = limits.gap - GAP_SLACK - HAIR - 4.0 * length * reach
    write_triple(triple, pegs, cx, cy, rows, length)
    asks_closure = not work.counting and limits.pairing == 0.0
    for e in range(features.moving[0], features.moving[1]):
        row = rows[e]
        if not work.counting and faces_away(row, cx, cy, limits.clamping, reach):
            continue
        lowest, highest = height_range(row, -cy, cx)
        first, last = lines_between(lowest, highest, base, pitch_y, error)
        # Nor does the side of an arc count that faces away.
        sides = 2 if work.counting or row[IS_ARC] == 0.0 else 1
        begin = 0 if sides == 2 or limits.clamping * row[SIGN] > 0.0 else 1
        for line in range(first, last + 1):
            for k in range(begin, begin + sides):
                meets, x, y, radius = row_meets(row, -cy, cx, base + line * pitch_y, error, 1.0 - 2.0 * k)
                if not meets:
                    continue
                if asks_closure and not may_close(triple, row, x, y, radius, cx, cy, gap, limits):
                    continue
                place_peg(pegs[3], x, y, e, 0.0, float(line), radius)
                count = add_listed(out, count, 3.0, angle, reach, True, work)
                if count < 0:
                    return count
    return count
