"""Segments and contact features as kernels take them: the columns of a row, points on it, and shallow arcs.

Columns of a row (``geometry.segment.make_segment_rows``):

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
    """Return whether a segment or feature is a shallow arc: an arc
    with a half sweep under ``SHALLOW`` radians.

    Its centre is so far away that coordinates of that size would drown the arc's own. See ``base.feature``
    for the layout of ``row``.
    """
    return row[IS_ARC] != 0.0 and row[HALF_EXTENT] < SHALLOW


@inner
def multiply_exactly(one: float, other: float) -> tuple[float, float]:
    """Return (p, e): the rounded product p and its rounding error e,
    with p + e the exact product (Dekker 1971).
    """
    product = one * other
    c = SPLITTER * one
    high = c - (c - one)
    low = one - high
    c = SPLITTER * other
    top = c - (c - other)
    rest = other - top
    return (product, ((high * top - product) + high * rest + low * top) + low * rest)


@inner
def compute_exact_dot(ax: float, ay: float, bx: float, by: float) -> float:
    """Return the scalar product of two plane vectors, accurate to
    about one rounding even where terms cancel.
    """
    one, one_rest = multiply_exactly(ax, bx)
    two, two_rest = multiply_exactly(ay, by)
    total = one + two
    part = total - one
    return total + ((one - (total - part)) + (two - part) + (one_rest + two_rest))


@inner
def compute_middle_coordinate(
    center: float, center_rest: float, radius: float, along: float, excess: float
) -> float:
    """Return one coordinate of an arc's middle: centre + radius times a unit direction, accurate to about one
    rounding.

    ``center`` + ``center_rest`` is the coordinate of the centre. ``along`` is the coordinate of a vector in
    the direction of the middle, whose squared length is 1 + ``excess``.
    """
    way, rest = multiply_exactly(radius, along)
    total = center + way
    part = total - center
    return total + ((center - (total - part)) + (way - part) + (rest - 0.5 * way * excess + center_rest))


@inner
def find_arc_middle(row: Array) -> tuple[float, float]:
    """Return x and y in mm of the middle of an arc, accurate to about
    one rounding even where its centre is far away.

    See ``base.feature`` for the layout of ``row``.
    """
    tx, ty = row[AXIS_X], row[AXIS_Y]
    xx, xx_rest = multiply_exactly(tx, tx)
    yy, yy_rest = multiply_exactly(ty, ty)
    excess = ((max(xx, yy) - 1.0) + min(xx, yy)) + (xx_rest + yy_rest)
    return (
        compute_middle_coordinate(row[X], row[REST_X], row[RADIUS], tx, excess),
        compute_middle_coordinate(row[Y], row[REST_Y], row[RADIUS], ty, excess),
    )


@inner
def compute_local_size(row: Array) -> float:
    """Return a length in mm to which rounding errors of coordinates of a feature's points are relative.

    See ``base.feature`` for the layout of ``row``.
    """
    if not is_shallow(row):
        return abs(row[X]) + abs(row[Y]) + row[RADIUS]
    x, y = find_arc_middle(row)
    return abs(x) + abs(y) + row[HALF_EXTENT] * row[RADIUS]


@inner
def find_largest_number(row: Array) -> float:
    """Return the largest absolute value in mm among the numbers of a feature that formulas use.

    See ``base.feature`` for the layout of ``row``.
    """
    if not is_shallow(row):
        return max(row[RADIUS], abs(row[X]), abs(row[Y]))
    x, y = find_arc_middle(row)
    return max(row[HALF_EXTENT] * row[RADIUS], abs(x), abs(y))


@inner
def compute_point(row: Array, parameter: float) -> tuple[float, float]:
    """Return x and y in mm of the point of a feature at a parameter:
    mm on a line, radians on an arc, 0 at its middle.

    See ``base.feature`` for the layout of ``row``.
    """
    if row[IS_ARC] == 0.0:
        return (row[X] + parameter * row[AXIS_X], row[Y] + parameter * row[AXIS_Y])
    if is_shallow(row):
        x, y = find_arc_middle(row)
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
def find_arc_parameter(row: Array, x: float, y: float) -> float:
    """Return the parameter on an arc in radians, in [-pi, pi], of the
    direction from its centre to the point (x, y).

    See ``base.feature`` for the layout of ``row``.
    """
    dx, dy = x - row[X], y - row[Y]
    if is_shallow(row):
        mx, my = find_arc_middle(row)
        dx, dy = x - mx, y - my
        return atan2(row[AXIS_X] * dy - row[AXIS_Y] * dx, row[RADIUS] + row[AXIS_X] * dx + row[AXIS_Y] * dy)
    return atan2(row[AXIS_X] * dy - row[AXIS_Y] * dx, row[AXIS_X] * dx + row[AXIS_Y] * dy)


@inner
def measure_shallow_offset(row: Array, x: float, y: float) -> tuple[float, float, float]:
    """Return (distance, x, y): a point's signed distance in mm off a
    shallow arc's circle, and the unit vector to it.

    The distance is positive outside the circle; the unit vector points from the circle's centre to the point.
    See ``base.feature`` for the layout of ``row``.
    """
    mx, my = find_arc_middle(row)
    dx, dy, k = x - mx, y - my, 1.0 / row[RADIUS]
    rise = k * (dx * dx + dy * dy) + 2.0 * (row[AXIS_X] * dx + row[AXIS_Y] * dy)
    size = sqrt(1.0 + k * rise)
    return (rise / (1.0 + size), (row[AXIS_X] + k * dx) / size, (row[AXIS_Y] + k * dy) / size)


@inner
def intersect_near_middle(
    row: Array, nx: float, ny: float, across: float, off: float, branch: float
) -> tuple[float, float, float, float]:
    """Return the point where an arc's circle meets a straight line, on one of its two branches.

    Let m be the arc's middle, t the unit vector from its centre to m, R its radius and k = 1 / R. The line
    consists of the points with distance ``off`` from m along the unit normal n. With T = (-ny, nx), nu = n .
    t and tau = T . t, the circle's point lies ``half`` R along T from the foot of the centre on the line, and
    R (half - tau) along T from the foot of m, where

        half^2 = tau^2 - k off (2 nu + k off),      R (half - tau) = -off (2 nu + k off) / (half + tau)

    See ``base.feature`` for the layout of ``row``.

    Parameters
    ----------
    row : of an arc, shallow or not.
    nx, ny : unit normal n of the line.
    across : tau, given because it must be known more accurately than n is.
    off : in mm.
    branch : the sign of ``half``, 1 or -1.

    Returns
    -------
    (x and y of the point from the arc's middle in mm, x and y of the unit vector from the centre to it)
    """
    k, along = 1.0 / row[RADIUS], nx * row[AXIS_X] + ny * row[AXIS_Y]
    rise = off * (2.0 * along + k * off)
    half = branch * sqrt(max(across * across - k * rise, 0.0))
    way = -rise / (half + across) if half * across > 0.0 else row[RADIUS] * (half - across)
    ahead = along + k * off
    return (off * nx - way * ny, off * ny + way * nx, ahead * nx - half * ny, ahead * ny + half * nx)
