"""When four pegs in place may be a fixture: ends of features, the gap, force closure and clamping.

The wrench of a contact at q with outward unit normal n is w = (n, (q - c) x n / L). Four wrenches of the
plane's three-dimensional wrench space have a null vector. Up to a common factor its entries are the signed
3x3 minors of [w1 w2 w3 w4] (Cramer's rule). The wrenches positively span the space exactly when all entries
have one sign and none is 0.

Reference: B. Mishra, J. T. Schwartz, M. Sharir, *On the existence and synthesis of multifinger positive
grips*, Algorithmica 2 (1987); the construction from minors is linear algebra.

Four pegs at simultaneous contact are a fixture under three rules (model: conditions 1, 3, 4 and 5). Every
contact lies inside its feature. The pegs of the moving carrier stand the smallest gap to the right of the
standing ones. The wrenches close with the standing pegs pushing to the right, or to the left where opening
clamps. Where the moving peg is one of two clamps, the wrenches need not close. Instead, the three standing
pegs must fix the pose, which the last of the four minors decides, and the clamp must push.

Every rule is decided by bounds: the exact contact is within a radius of the computed one, and only what
breaks a rule everywhere within that radius is discarded.
"""

from __future__ import annotations

import numpy as np

from workhold.conventions import (
    GAP_SLACK,
    LEAST_CLAMPING,
    LEAST_CLOSURE,
    LEAST_PUSH,
    LEAST_SEAT,
    LEAST_SPAN,
    PARALLEL,
)
from workhold.kernels.base.compiling import Array, IntArray, inner
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, IS_ARC, RADIUS, SIGN, X, Y
from workhold.kernels.base.tables import COLUMN_STEP, ROW_STEP, Features, Limits
from workhold.kernels.chord.evaluation import measure_end_slack
from workhold.kernels.contact.record import PEG_FEATURE, PEG_RADIUS, PEG_X, PEG_Y, Angle

# Rounding of a minor.
ROUNDING = 1e-14


@inner
def cross(ax: float, ay: float, bx: float, by: float) -> float:
    """Return the cross product ax by - ay bx of two plane vectors."""
    return ax * by - ay * bx


@inner
def write_minors(points: Array, normals: Array, length: float, out: Array) -> float:
    """Write the signed 3x3 minors of four wrenches to ``out``: a null vector of the wrenches, not scaled.

    Parameters
    ----------
    points : (4, 2) contact points (or peg centres: they lie on the same lines of action) about the centre c,
        in mm.
    normals : (4, 2) outward unit normals.
    length : L in mm, by which moments are divided.
    out : (4,) receives the minors; entry k is that of the wrenches other than k.

    Returns
    -------
    float
        The sum of the absolute values; 0 when the wrenches do not span the space.
    """
    t0 = cross(points[0, 0], points[0, 1], normals[0, 0], normals[0, 1]) / length
    t1 = cross(points[1, 0], points[1, 1], normals[1, 0], normals[1, 1]) / length
    t2 = cross(points[2, 0], points[2, 1], normals[2, 0], normals[2, 1]) / length
    t3 = cross(points[3, 0], points[3, 1], normals[3, 0], normals[3, 1]) / length
    m01 = cross(normals[0, 0], normals[0, 1], normals[1, 0], normals[1, 1])
    m02 = cross(normals[0, 0], normals[0, 1], normals[2, 0], normals[2, 1])
    m03 = cross(normals[0, 0], normals[0, 1], normals[3, 0], normals[3, 1])
    m12 = cross(normals[1, 0], normals[1, 1], normals[2, 0], normals[2, 1])
    m13 = cross(normals[1, 0], normals[1, 1], normals[3, 0], normals[3, 1])
    m23 = cross(normals[2, 0], normals[2, 1], normals[3, 0], normals[3, 1])
    out[0] = t1 * m23 - t2 * m13 + t3 * m12
    out[1] = -(t0 * m23 - t2 * m03 + t3 * m02)
    out[2] = t0 * m13 - t1 * m03 + t3 * m01
    out[3] = -(t0 * m12 - t1 * m02 + t2 * m01)
    return abs(out[0]) + abs(out[1]) + abs(out[2]) + abs(out[3])


@inner
def bound_minor_error(swing: float, away: float, length: float) -> float:
    """Return an error bound of a minor when normals are off by up to
    ``swing`` radians and points by up to ``away`` mm.

    Moments over L, of size 1.42 at most, are off by away / L + 1.42 swing, and products of two normals by 2
    swing. A minor is three products of one with the other, so it is off by 12.8 swing + 3 away / L; the rest
    is for the second order.
    """
    return 20.0 * swing + 4.0 * away / length + ROUNDING


@inner
def compute_outward_normal(row: Array, x: float, y: float) -> tuple[float, float]:
    """Return the outward unit normal (x, y) of a feature at the point (x, y) on it, in the part's frame.

    See ``base.feature`` for the layout of ``row``.
    """
    if row[IS_ARC] == 0.0:
        return (row[AXIS_Y], -row[AXIS_X])
    scale = row[SIGN] / row[RADIUS]
    return (scale * (x - row[X]), scale * (y - row[Y]))


@inner
def is_within(row: Array, x: float, y: float, margin: float, radius: float) -> bool:
    """Return whether a contact at (x, y), known to ``radius`` mm, may lie on its feature and ``margin`` mm
    from its ends.

    Coordinates are in mm. See ``base.feature`` for the layout of ``row``.
    """
    return measure_end_slack(row, x, y) >= margin - 1.2 * radius


@inner
def are_on_parallel_lines(pegs: Array, count: int, rows: Array) -> bool:
    """Return whether three of the first ``count`` pegs (3 or 4) touch parallel lines.

    The forces of these three then have one direction, and nothing balances the fourth force. ``pegs`` (4, 6)
    are in the layout of ``contact.record``, ``rows`` are the rows of all features (see ``base.feature``).
    """
    for k in range(count):
        three = True
        for i in range(count):
            a = rows[int(pegs[i, PEG_FEATURE])]
            for j in range(i):
                # Of four pegs one is left out; of three none.
                if count == 4 and (i == k or j == k):
                    continue
                b = rows[int(pegs[j, PEG_FEATURE])]
                three = three and a[IS_ARC] == 0.0 and b[IS_ARC] == 0.0
                three = three and abs(cross(a[AXIS_X], a[AXIS_Y], b[AXIS_X], b[AXIS_Y])) <= PARALLEL
        if three:
            return True
    return False


@inner
def is_fixture(
    pegs: Array,
    standing: float,
    angle: Angle,
    reach: float,
    features: Features,
    limits: Limits,
    work: Array,
    null: Array,
) -> tuple[int, float]:
    """Return the verdict on four pegs at simultaneous contact, and their separation.

    Parameters
    ----------
    pegs : (4, 6) rows, see ``contact.record``; the first ``standing`` on the carrier that stands still.
    angle : orientation of the pegs in the workpiece's frame, with its cosine and sine.
    reach : how far in radians the orientation may be off.
    work : (8, 2) work space.
    null : (4,) receives the null vector, not scaled, unless the function returns before.

    Returns
    -------
    (verdict; x distance in mm from the first standing to the first moving peg, but 0 for verdict 0)

    The verdict is 2 when the pegs may be a fixture, 1 when all four contacts may be inside their features but
    another rule is broken, 0 when some contact is outside its feature.
    """
    _, cx, cy = angle
    rows, length = features.rows, limits.wrench_length
    leftmost_moving, rightmost_standing = np.inf, -np.inf
    points, normals = work[:4], work[4:]
    first_standing = first_moving = 0.0
    radius = swing = 0.0
    for k in range(4):
        x, y = pegs[k, PEG_X], pegs[k, PEG_Y]
        row = rows[int(pegs[k, PEG_FEATURE])]
        if not is_within(row, x, y, limits.contact_margin, pegs[k, PEG_RADIUS]):
            return (0, 0.0)
        radius = max(radius, pegs[k, PEG_RADIUS])
        points[k, 0], points[k, 1] = x, y
        normals[k, 0], normals[k, 1] = compute_outward_normal(row, x, y)
        if row[IS_ARC] != 0.0:
            swing = max(swing, pegs[k, PEG_RADIUS] / row[RADIUS])
        along = cx * x + cy * y
        if k < standing:
            rightmost_standing = max(rightmost_standing, along)
            if k == 0:
                first_standing = along
        else:
            leftmost_moving = min(leftmost_moving, along)
            if k == int(standing):
                first_moving = along
    separation = first_moving - first_standing
    if leftmost_moving - rightmost_standing < limits.gap - GAP_SLACK - 2.0 * (radius + length * reach):
        return (1, separation)
    if are_on_parallel_lines(pegs, 4 if limits.pairing == 0.0 else 3, rows):
        return (1, separation)
    size = write_minors(points, normals, length, null)
    band = bound_minor_error(swing, radius, length)
    if limits.pairing != 0.0:
        push = limits.clamping * (normals[3, 0] * cx + normals[3, 1] * cy)
        sure = abs(null[3]) + band > LEAST_SEAT and push + swing + reach > LEAST_PUSH
        return (2 if sure else 1, separation)
    low, high = min(null[0], null[1], null[2], null[3]), max(null[0], null[1], null[2], null[3])
    sign = 1.0 if high >= -low else -1.0
    smallest = low if sign > 0.0 else -high
    least = max(LEAST_CLOSURE, limits.least_margin)
    if smallest + band <= least * (size - 4.0 * band) or size + 4.0 * band <= LEAST_SPAN:
        return (1, separation)
    clamp = 0.0
    for k in range(int(standing)):
        clamp -= sign * limits.clamping * null[k] * (normals[k, 0] * cx + normals[k, 1] * cy)
    if clamp + 3.0 * band + size * (swing + reach) <= LEAST_CLAMPING * (size - 4.0 * band):
        return (1, separation)
    if standing == 3.0:
        # What a single moving peg takes up is the product of two numbers, and small when either is.
        push = abs(normals[3, 0] * cx + normals[3, 1] * cy) + swing + reach
        if (abs(null[3]) + band) * push <= LEAST_CLAMPING * (size - 4.0 * band):
            return (1, separation)
    return (2, separation)


@inner
def is_to_be_listed(verdict: int, counting: bool, count: int, limits: Limits) -> bool:
    """Return whether four contacts with this verdict of :func:`is_fixture` are to be written to the records.

    Contacts that may be a fixture (verdict 2) are. When ``counting``, those with verdict 1 are as well, but
    none once ``count``, the number of contacts so far, has reached ``limits.most_listed``.
    """
    if counting:
        return verdict > 0 and count < limits.most_listed
    return verdict == 2


@inner
def share_a_carrier(one: IntArray, two: IntArray, limits: Limits) -> bool:
    """Return whether the heads of two chords with a common tail can be different holes of one carrier.

    ``one`` and ``two`` are the whole numbers (7,) of the chords' curves. The columns of tail and heads may
    differ by at most ``limits.most_column_steps``. See ``base.tables`` for the layout of ``one`` and ``two``.
    """
    k, m = one[COLUMN_STEP], two[COLUMN_STEP]
    if k == m and one[ROW_STEP] == two[ROW_STEP]:
        return False
    return max(k, m, 0) - min(k, m, 0) <= limits.most_column_steps
