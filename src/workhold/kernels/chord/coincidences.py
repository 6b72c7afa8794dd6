"""Chords that run smoothly through a coincidence, where the general formulas divide zero by zero.

Two coincidences are common in drawings whose sizes are whole multiples of the pitch:

- two arcs of equal radius R whose centres are exactly one chord length d apart. At the direction of the
  centres' line the two circles that the tail must lie on coincide;
- a line and an arc of radius R whose centre is d - R beyond the line (or R - d before it). Where the chord is
  square to the line, both tangencies fall together.

At the coincidence both contacts share one line of action, so it is never part of a fixture itself; but curves
run through it with finite slopes. Let gamma be the angle from the coincidence, and q = d (1 - cos gamma). For
the arcs let m be the direction half way between the chord and the centres' line. Then everything is regular:

- arcs:       u = c_a + (c - w) / 2 +- sqrt(R^2 - d^2 sin(gamma / 2)^2) m, c from centre to centre;
- line, arc:  u = c_b + eta n + S t - w, eta = +-(R - q), S = +- sin(gamma / 2) sqrt(2 d (2 R - q)),

n the line's normal, t its tangent. Derivatives over alpha follow by differentiating twice.
"""

from __future__ import annotations

from math import atan2, cos, hypot, pi, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from workhold.conventions import EXACT, SAME_CENTER
from workhold.kernels.base.compiling import compiled, inner
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, IS_ARC, RADIUS, X, Y, is_shallow
from workhold.kernels.base.interval import (
    TURN,
    Interval,
    iadd,
    icos,
    idivide,
    imul,
    ineg,
    iscale,
    ishift,
    isin,
    isqrt,
    isquare,
    isub,
)
from workhold.kernels.chord.columns import BRANCH, COINCIDENCE, LENGTH, MIDDLE, SHIFT, SIDE

Array = NDArray[np.float64]
Motion = tuple[float, float, float, float, float, float]
MotionBox = tuple[Interval, Interval, Interval, Interval, Interval, Interval]

# Nearer than this to a coincidence, in radians, a chord's contacts share one line of action.
SHARED = 1e-10
# Kinds of coincidence a curve may have; chords between concentric arcs turn about the centre without changing
# shape.
NONE, ARCS, LINE_FIRST, ARC_FIRST, CONCENTRIC = 0.0, 1.0, 2.0, 3.0, 4.0


@inner
def beyond_line(line: Array, arc: Array, d: float) -> float:
    """+1 or -1 when a line and an arc coincide along or against the line's normal, 0 when they do not.

    The formulas for shallow arcs divide nothing by zero there.
    """
    if is_shallow(arc):
        return 0.0
    apart = line[AXIS_Y] * (arc[X] - line[X]) - line[AXIS_X] * (arc[Y] - line[Y])
    if abs(d - apart - arc[RADIUS]) <= EXACT:
        return 1.0
    if abs(d + apart - arc[RADIUS]) <= EXACT:
        return -1.0
    return 0.0


@inner
def are_one_chord_apart(a: Array, b: Array, d: float) -> bool:
    """Whether two features are arcs of equal radius with centres one chord length apart."""
    if a[IS_ARC] == 0.0 or b[IS_ARC] == 0.0 or abs(a[RADIUS] - b[RADIUS]) > EXACT:
        return False
    return abs(hypot(b[X] - a[X], b[Y] - a[Y]) - d) <= EXACT


@compiled
def are_concentric(a: Array, b: Array) -> bool:
    """Whether two features are arcs of one centre."""
    return a[IS_ARC] != 0.0 and b[IS_ARC] != 0.0 and hypot(a[X] - b[X], a[Y] - b[Y]) <= SAME_CENTER


@inner
def coincidence(a: Array, b: Array, d: float) -> tuple[float, float, float]:
    """Kind of coincidence of a chord of length d, its direction alpha, and the side of the line (see
    ``beyond_line``)."""
    if are_one_chord_apart(a, b, d):
        return (ARCS, atan2(b[Y] - a[Y], b[X] - a[X]), 0.0)
    if a[IS_ARC] == 0.0 and b[IS_ARC] != 0.0:
        side = beyond_line(a, b, d)
        if side != 0.0:
            return (LINE_FIRST, atan2(-side * a[AXIS_X], side * a[AXIS_Y]), side)
    elif a[IS_ARC] != 0.0 and b[IS_ARC] == 0.0:
        side = beyond_line(b, a, d)
        if side != 0.0:
            return (ARC_FIRST, atan2(side * b[AXIS_X], -side * b[AXIS_Y]), side)
    return (NONE, 0.0, 0.0)


@inner
def from_coincidence(alpha: float, middle: float) -> float:
    """Angle in [-pi, pi) from the coincidence."""
    return (alpha - middle + pi) % TURN - pi


@inner
def is_regular(kind: float, radius: float, d: float, gamma: float) -> bool:
    """Whether the regular formulas are the better ones at an angle from the coincidence."""
    if kind in (NONE, CONCENTRIC) or abs(gamma) > 1.0:
        return False
    if kind == ARCS:
        return d * abs(sin(gamma / 2.0)) <= 0.7 * radius
    return d * (1.0 - cos(gamma)) <= radius


@inner
def shares_a_line(curve: Array, psi: float) -> bool:
    """Whether a chord is so near its coincidence that both contacts share one line of action."""
    kind = curve[COINCIDENCE]
    if kind in (NONE, CONCENTRIC):
        return False
    return abs(from_coincidence(psi + curve[SHIFT], curve[MIDDLE])) <= SHARED


@inner
def motion(a: Array, b: Array, curve: Array, psi: float) -> tuple[bool, Motion]:
    """Tail and its derivative over psi near a coincidence.

    Parameters
    ----------
    curve : row of the curve table, of a curve that has a coincidence.

    Returns
    -------
    (whether the regular formulas apply, (ux, uy, u'x, u'y, r_ax R, r_ay R)), the last two only for an arc
    tail
    """
    kind, middle, side, d = curve[COINCIDENCE], curve[MIDDLE], curve[SIDE], curve[LENGTH]
    alpha = psi + curve[SHIFT]
    gamma = from_coincidence(alpha, middle)
    radius = a[RADIUS] if a[IS_ARC] != 0.0 else b[RADIUS]
    if not is_regular(kind, radius, d, gamma):
        return (False, (0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    wx, wy = d * cos(alpha), d * sin(alpha)
    branch = curve[BRANCH]
    way = branch if gamma >= 0.0 else -branch
    half_angle = gamma / 2.0
    if kind == ARCS:
        mx, my = cos(middle + half_angle), sin(middle + half_angle)
        sine = d * sin(half_angle)
        y = way * sqrt(radius * radius - sine * sine)
        # y y' = -d^2 sin(gamma) / 4
        dy = -d * d * sin(gamma) / (4.0 * y)
        rx, ry = (b[X] - a[X] - wx) / 2.0 + y * mx, (b[Y] - a[Y] - wy) / 2.0 + y * my
        vx = wy / 2.0 + dy * mx - y * my / 2.0
        vy = -wx / 2.0 + dy * my + y * mx / 2.0
        return (True, (a[X] + rx, a[Y] + ry, vx, vy, rx, ry))
    line, arc = (a, b) if kind == LINE_FIRST else (b, a)
    nx, ny, tx, ty = line[AXIS_Y], -line[AXIS_X], line[AXIS_X], line[AXIS_Y]
    q, dq = d * (1.0 - cos(gamma)), d * sin(gamma)
    g = sqrt(2.0 * d * (2.0 * radius - q))
    across, dacross = side * (radius - q), -side * dq
    along = way * sin(half_angle) * g
    dalong = way * (cos(half_angle) * g / 2.0 - sin(half_angle) * d * dq / g)
    rx, ry = across * nx + along * tx, across * ny + along * ty
    vx, vy = dacross * nx + dalong * tx, dacross * ny + dalong * ty
    if kind == LINE_FIRST:
        return (True, (arc[X] + rx - wx, arc[Y] + ry - wy, vx + wy, vy - wx, rx, ry))
    return (True, (arc[X] + rx, arc[Y] + ry, vx, vy, rx, ry))


@inner
def arcs_box(a: Array, b: Array, d: float, middle: float, gamma: Interval, way: float) -> MotionBox:
    """Enclosure of u - c_a, u' and u'' between two arcs."""
    radius = a[RADIUS]
    half = iscale(0.5, gamma)
    direction = ishift(middle, half)
    mx, my = icos(direction), isin(direction)
    alpha = ishift(middle, gamma)
    wx, wy = iscale(d, icos(alpha)), iscale(d, isin(alpha))
    sine = iscale(d, isin(half))
    y = iscale(way, isqrt(isub((radius * radius, radius * radius), isquare(sine))))
    dy = idivide(iscale(-0.25 * d * d, isin(gamma)), y)
    ddy = idivide(isub(iscale(-0.25 * d * d, icos(gamma)), isquare(dy)), y)
    cx, cy = b[X] - a[X], b[Y] - a[Y]
    rx = iadd(iscale(0.5, isub((cx, cx), wx)), imul(y, mx))
    ry = iadd(iscale(0.5, isub((cy, cy), wy)), imul(y, my))
    vx = iadd(iscale(0.5, wy), isub(imul(dy, mx), iscale(0.5, imul(y, my))))
    vy = iadd(iscale(-0.5, wx), iadd(imul(dy, my), iscale(0.5, imul(y, mx))))
    second_derivative = isub(ddy, iscale(0.25, y))
    ax = iadd(iscale(0.5, wx), isub(imul(second_derivative, mx), imul(dy, my)))
    ay = iadd(iscale(0.5, wy), iadd(imul(second_derivative, my), imul(dy, mx)))
    return (rx, ry, vx, vy, ax, ay)


@inner
def line_box(line: Array, radius: float, d: float, side: float, gamma: Interval, way: float) -> MotionBox:
    """Enclosure of the contact on the arc from its centre, and its two derivatives, for a line and an arc."""
    nx, ny, tx, ty = line[AXIS_Y], -line[AXIS_X], line[AXIS_X], line[AXIS_Y]
    half = iscale(0.5, gamma)
    sine, cosine = isin(half), icos(half)
    q = iscale(2.0 * d, isquare(sine))
    dq, ddq = iscale(d, isin(gamma)), iscale(d, icos(gamma))
    g = isqrt(iscale(2.0 * d, isub((2.0 * radius, 2.0 * radius), q)))
    dg = idivide(iscale(-d, dq), g)
    ddg = idivide(isub(iscale(-d, ddq), isquare(dg)), g)
    across, dacross, ddacross = iscale(side, isub((radius, radius), q)), iscale(-side, dq), iscale(-side, ddq)
    along = iscale(way, imul(sine, g))
    dalong = iscale(way, iadd(iscale(0.5, imul(cosine, g)), imul(sine, dg)))
    ddalong = iscale(way, iadd(iadd(iscale(-0.25, imul(sine, g)), imul(cosine, dg)), imul(sine, ddg)))
    return (
        iadd(iscale(nx, across), iscale(tx, along)),
        iadd(iscale(ny, across), iscale(ty, along)),
        iadd(iscale(nx, dacross), iscale(tx, dalong)),
        iadd(iscale(ny, dacross), iscale(ty, dalong)),
        iadd(iscale(nx, ddacross), iscale(tx, ddalong)),
        iadd(iscale(ny, ddacross), iscale(ty, ddalong)),
    )


@inner
def angle_box(low: float, high: float, middle: float) -> tuple[float, Interval]:
    """Angle from the coincidence of the middle of [low, high], and an enclosure of the angles between.

    Directions are below 16 radians, so three sums are off by half a unit in the last place of that each.
    """
    center, reach = from_coincidence((low + high) / 2.0, middle), (high - low) / 2.0 * (1.0 + 1e-15) + 3e-15
    return (center, (center - reach, center + reach))


@inner
def motion_box(a: Array, b: Array, curve: Array, low: float, high: float) -> tuple[bool, MotionBox]:
    """Enclosures over alpha in [low, high] near a coincidence.

    Returns
    -------
    (whether the regular formulas apply, (u, u', u''))
    """
    kind, middle, side, d = curve[COINCIDENCE], curve[MIDDLE], curve[SIDE], curve[LENGTH]
    center, gamma = angle_box(low, high, middle)
    radius = a[RADIUS] if a[IS_ARC] != 0.0 else b[RADIUS]
    zero = (0.0, 0.0)
    nothing = (zero, zero, zero, zero, zero, zero)
    if not (is_regular(kind, radius, d, gamma[0]) and is_regular(kind, radius, d, gamma[1])):
        return (False, nothing)
    way = curve[BRANCH] if center >= 0.0 else -curve[BRANCH]
    if kind == ARCS:
        r = arcs_box(a, b, d, middle, gamma, way)
        return (True, (ishift(a[X], r[0]), ishift(a[Y], r[1]), r[2], r[3], r[4], r[5]))
    if kind == ARC_FIRST:
        r = line_box(b, radius, d, side, gamma, way)
        return (True, (ishift(a[X], r[0]), ishift(a[Y], r[1]), r[2], r[3], r[4], r[5]))
    r = line_box(a, radius, d, side, gamma, way)
    alpha = ishift(middle, gamma)
    wx, wy = iscale(d, icos(alpha)), iscale(d, isin(alpha))
    u = (
        isub(ishift(b[X], r[0]), wx),
        isub(ishift(b[Y], r[1]), wy),
        iadd(r[2], wy),
        iadd(r[3], ineg(wx)),
        iadd(r[4], wx),
        iadd(r[5], wy),
    )
    return (True, u)
