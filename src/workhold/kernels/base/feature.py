"""Segments and contact features as kernels take them: the columns of a row, points on it, and shallow arcs.

Columns of a row (``geometry.segment.segment_rows``):

IS_ARC : 0 for a line, 1 for an arc.
X, Y : middle of a line, centre of an arc, in mm.
AXIS_X, AXIS_Y : unit vector along a line, or from an arc's centre to its middle: parameters are 0 there.
HALF_EXTENT : largest parameter, in mm on a line and in radians on an arc; pi or more on a whole circle.
RADIUS : in mm, 0 for a line.
SIGN : whether the outward normal points away from an arc's centre (1) or towards it (-1); 1 for a line.
REST_X, REST_Y : what rounding has left of an arc's centre, in mm, which counts where the arc is shallow.
LOW_SLACK, HIGH_SLACK : how far in mm a contact may lie past either end (of features alone).

Shallow arcs are those whose centre is so far away that numbers of its size would drown the arc's own. A
crowned edge of 60 mm with a sagitta of a hundredth of a millimetre has a radius of 45 m. Coordinates of its
centre are rounded by more than the edge's own points need be. All that counts is therefore measured from the
arc's middle m, with the curvature k = 1 / R. With t the unit vector from the centre to m, square to which the
arc goes through m, a point m + z is

    k |z|^2 / 2 + t . z

off the circle, but for a factor near 1, however small k is; a line is the case k = 0.

Products and sums whose rounding counts are made without any: T. J. Dekker, "A floating-point technique for
extending the available precision", Numerische Mathematik 18 (1971) 224-242.
"""

from __future__ import annotations

from math import atan2, cos, sin, sqrt

from workhold.kernels.base.compiling import Array, inner

IS_ARC, X, Y, AXIS_X, AXIS_Y, HALF_EXTENT, RADIUS, SIGN, REST_X, REST_Y, LOW_SLACK, HIGH_SLACK = range(12)
SEGMENT_LENGTH, FEATURE_LENGTH = 10, 12


# Half sweeps in radians below which arcs are shallow: radii of more than fifty half chords.
SHALLOW = 0.02
# 2^27 + 1, which halves the digits of a number.
SPLITTER = 134217729.0


@inner
def is_shallow(row: Array) -> bool:
    """Whether a feature is a shallow arc."""
    return row[IS_ARC] != 0.0 and row[HALF_EXTENT] < SHALLOW


@inner
def exact_product(one: float, other: float) -> tuple[float, float]:
    """A product and what rounding takes from it (Dekker 1971)."""
    product = one * other
    c = SPLITTER * one
    high = c - (c - one)
    low = one - high
    c = SPLITTER * other
    top = c - (c - other)
    rest = other - top
    return (product, ((high * top - product) + high * rest + low * top) + low * rest)


@inner
def exact_dot(ax: float, ay: float, bx: float, by: float) -> float:
    """Scalar product of two vectors of the plane, rounded once or so however much cancels."""
    one, one_rest = exact_product(ax, bx)
    two, two_rest = exact_product(ay, by)
    total = one + two
    part = total - one
    return total + ((one - (total - part)) + (two - part) + (one_rest + two_rest))


@inner
def from_center(center: float, center_rest: float, radius: float, along: float, excess: float) -> float:
    """A coordinate of an arc's middle, for a direction whose square is 1 + ``excess``, rounded once or so."""
    way, rest = exact_product(radius, along)
    total = center + way
    part = total - center
    return total + ((center - (total - part)) + (way - part) + (rest - 0.5 * way * excess + center_rest))


@inner
def middle_of(row: Array) -> tuple[float, float]:
    """The middle of an arc: the point of its circle, as its row has it, in the direction of its row."""
    tx, ty = row[AXIS_X], row[AXIS_Y]
    xx, xx_rest = exact_product(tx, tx)
    yy, yy_rest = exact_product(ty, ty)
    excess = ((max(xx, yy) - 1.0) + min(xx, yy)) + (xx_rest + yy_rest)
    return (
        from_center(row[X], row[REST_X], row[RADIUS], tx, excess),
        from_center(row[Y], row[REST_Y], row[RADIUS], ty, excess),
    )


@inner
def local_size(row: Array) -> float:
    """What roundings of a feature's numbers are relative to, in mm."""
    if not is_shallow(row):
        return abs(row[X]) + abs(row[Y]) + row[RADIUS]
    x, y = middle_of(row)
    return abs(x) + abs(y) + row[HALF_EXTENT] * row[RADIUS]


@inner
def largest_number(row: Array) -> float:
    """The largest of a feature's numbers that formulas use, in mm."""
    if not is_shallow(row):
        return max(row[RADIUS], abs(row[X]), abs(row[Y]))
    x, y = middle_of(row)
    return max(row[HALF_EXTENT] * row[RADIUS], abs(x), abs(y))


@inner
def point_at(row: Array, parameter: float) -> tuple[float, float]:
    """Point of a feature at a parameter: mm on a line, radians on an arc."""
    if row[IS_ARC] == 0.0:
        return (row[X] + parameter * row[AXIS_X], row[Y] + parameter * row[AXIS_Y])
    if is_shallow(row):
        x, y = middle_of(row)
        # 1 - cos s = 2 sin(s / 2)^2
        half = sin(parameter / 2.0)
        beside, back = row[RADIUS] * sin(parameter), 2.0 * row[RADIUS] * half * half
        return (x - beside * row[AXIS_Y] - back * row[AXIS_X], y + beside * row[AXIS_X] - back * row[AXIS_Y])
    c, s = cos(parameter), sin(parameter)
    return (
        row[X] + row[RADIUS] * (c * row[AXIS_X] - s * row[AXIS_Y]),
        row[Y] + row[RADIUS] * (s * row[AXIS_X] + c * row[AXIS_Y]),
    )


@inner
def angle_on(row: Array, x: float, y: float) -> float:
    """Parameter in radians of a point seen from an arc's centre."""
    dx, dy = x - row[X], y - row[Y]
    if is_shallow(row):
        mx, my = middle_of(row)
        dx, dy = x - mx, y - my
        return atan2(row[AXIS_X] * dy - row[AXIS_Y] * dx, row[RADIUS] + row[AXIS_X] * dx + row[AXIS_Y] * dy)
    return atan2(row[AXIS_X] * dy - row[AXIS_Y] * dx, row[AXIS_X] * dx + row[AXIS_Y] * dy)


@inner
def off_shallow(row: Array, x: float, y: float) -> tuple[float, float, float]:
    """Distance in mm of a point from a shallow arc's circle, outward positive, and the unit vector from its
    centre."""
    mx, my = middle_of(row)
    dx, dy, k = x - mx, y - my, 1.0 / row[RADIUS]
    rise = k * (dx * dx + dy * dy) + 2.0 * (row[AXIS_X] * dx + row[AXIS_Y] * dy)
    size = sqrt(1.0 + k * rise)
    return (rise / (1.0 + size), (row[AXIS_X] + k * dx) / size, (row[AXIS_Y] + k * dy) / size)


@inner
def beside_middle(
    row: Array, nx: float, ny: float, across: float, off: float, branch: float
) -> tuple[float, float, float, float]:
    """Where an arc's circle meets a straight line.

    The line's points are ``off`` from the arc's middle along the unit normal n. With T = (-ny, nx), nu = n .
    t and tau = T . t, the point that is ``half`` R beside the centre's foot on the line has

        half^2 = tau^2 - k off (2 nu + k off),      R (half - tau) = -off (2 nu + k off) / (half + tau)

    from the middle's foot on.

    Parameters
    ----------
    row : of an arc, shallow or not.
    across : tau, which is given because it must be known better than n is.
    branch : the sign of ``half``.

    Returns
    -------
    (x and y of the point from the arc's middle, x and y of the unit vector from the centre to it)
    """
    k, along = 1.0 / row[RADIUS], nx * row[AXIS_X] + ny * row[AXIS_Y]
    rise = off * (2.0 * along + k * off)
    half = branch * sqrt(max(across * across - k * rise, 0.0))
    way = -rise / (half + across) if half * across > 0.0 else row[RADIUS] * (half - across)
    ahead = along + k * off
    return (off * nx - way * ny, off * ny + way * nx, ahead * nx - half * ny, ahead * ny + half * nx)
