"""Chords that run smoothly through a coincidence, where the general formulas divide zero by zero.

Three coincidences are common in drawings whose sizes are whole multiples of the pitch:

- two arcs of equal radius R whose centres are exactly one chord length d apart. At the direction of the
  centres' line the two circles that the tail must lie on coincide;
- a line and an arc of radius R whose centre is d - R beyond the line (or R - d before it). Where the chord is
  square to the line, both tangencies fall together;
- two arcs of radii R_a and R_b whose centres are c apart, as of a boss and a bore of a rod. Here c and d
  differ by as much as the radii, or add up to as much; both tangencies are where the chord is along c.

At the coincidence both contacts share one line of action, so it is never part of a fixture itself; but curves
run through it with finite slopes. Let gamma be the angle from the coincidence, and q = d (1 - cos gamma). For
the arcs let m be the direction half way between the chord and the centres' line. Then everything is regular:

- arcs:       u = c_a + (c - w) / 2 +- sqrt(R^2 - d^2 sin(gamma / 2)^2) m, c from centre to centre;
- line, arc:  u = c_b + eta n + S t - w, eta = +-(R - q), S = +- sin(gamma / 2) sqrt(2 d (2 R - q)),

n the line's normal, t its tangent. Derivatives over alpha follow by differentiating twice. Of arcs that touch
let g be the vector c - w of length sqrt(G). Let D = R_a^2 - R_b^2 and k = 4 c d sin(gamma / 2)^2. Then

- arcs that touch:  u = c_a + (G + D) / (2 G) g +- sin(gamma / 2) sqrt(c d S) / G J g.

Here S is 4 R_a R_b - k. G is (R_a - R_b)^2 + k where the chord runs along c, and (R_a + R_b)^2 - k where it
runs against it. The formulas are used up to k = 2 R_a R_b, so that S is no less than that. The tail turns
about c_a at a rate omega alone. So u' = omega J (u - c_a), and u'' = omega' J (u - c_a) - omega^2 (u - c_a).
With s = 1 in the first case and -1 in the second,

    omega = (1 + (d^2 - c^2) / G) / 2 -+ s sqrt(c d / S) cos(gamma / 2) (1 - D / G).

Where these lengths differ by m, the tail on the part itself is off by m / abs(X), see :func:`bound_misfit`.
"""

from __future__ import annotations

from math import atan2, cos, hypot, pi, sin, sqrt
from typing import NamedTuple

from workhold.conventions import EXACT, SAME_CENTER
from workhold.kernels.base.compiling import Array, inner
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
    widen_outward,
)
from workhold.kernels.base.tables import BRANCH, COINCIDENCE, LENGTH, MIDDLE, SHIFT, SIDE


class Motion(NamedTuple):
    """The tail of a chord and how it moves when psi turns, near a coincidence.

    Parameters
    ----------
    x, y : the tail in mm.
    speed_x, speed_y : its derivative over psi, in mm per radian.
    ray_x, ray_y : vector in mm from an arc's centre to the contact on the arc: that of the tail where the
        tail is on an arc, else that of the head.
    """

    x: float
    y: float
    speed_x: float
    speed_y: float
    ray_x: float
    ray_y: float


class MotionBox(NamedTuple):
    """Intervals that enclose the numbers of a :class:`Motion`."""

    x: Interval
    y: Interval
    speed_x: Interval
    speed_y: Interval
    ray_x: Interval
    ray_y: Interval


# Nearer than this to a coincidence, in radians, a chord's contacts share one line of action.
SHARED = 1e-10
# Kinds of coincidence of a curve; chords between concentric arcs turn about the centre as they are.
NONE, ARCS, LINE_FIRST, ARC_FIRST, CONCENTRIC, TOUCHING = 0.0, 1.0, 2.0, 3.0, 4.0, 5.0
# Circles that touch inside one another count only if their radii differ by this part of the smaller one.
# Lengths of circles that touch agree to this part of EXACT, for what they are off by grows with the radius
# over their difference.
UNEQUAL, CLOSER = 0.25, 0.04
# Rounding of such lengths, relative to them.
EPSILON = 4e-16


@inner
def find_line_side(line: Array, arc: Array, d: float) -> float:
    """Return the side of the coincidence of a chord between a line and an arc: 1 or -1 where the chord is
    then along or against the line's normal, 0 where there is no coincidence.

    Return 0 for a shallow arc as well: the formulas for shallow arcs do not divide by zero there. See
    ``base.feature`` for the layout of ``line`` and ``arc``.
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
    """Return whether two features are arcs of equal radius with
    centres one chord length d apart, each to within ``EXACT``.

    See ``base.feature`` for the layout of ``a`` and ``b``.
    """
    if a[IS_ARC] == 0.0 or b[IS_ARC] == 0.0 or abs(a[RADIUS] - b[RADIUS]) > EXACT:
        return False
    return abs(hypot(b[X] - a[X], b[Y] - a[Y]) - d) <= EXACT


@inner
def find_touching_side(a: Array, b: Array, d: float) -> float:
    """Return the side of the coincidence of a chord between two arcs that touch each other when one is moved
    by the chord.

    It is 1 or -1 where they do so with the chord along or against the line from the centre of ``a`` to that
    of ``b``, 0 where they never do. See ``base.feature`` for the layout of ``a`` and ``b``.
    """
    if a[IS_ARC] == 0.0 or b[IS_ARC] == 0.0 or is_shallow(a) or is_shallow(b):
        return 0.0
    apart, difference = hypot(b[X] - a[X], b[Y] - a[Y]), abs(a[RADIUS] - b[RADIUS])
    is_unequal = difference > UNEQUAL * min(a[RADIUS], b[RADIUS])
    if is_unequal and abs(abs(apart - d) - difference) <= CLOSER * EXACT:
        return 1.0
    return -1.0 if abs(apart + d - a[RADIUS] - b[RADIUS]) <= CLOSER * EXACT else 0.0


@inner
def are_concentric(a: Array, b: Array) -> bool:
    """Return whether two features are arcs with the same centre, to within ``SAME_CENTER``.

    See ``base.feature`` for the layout of ``a`` and ``b``.
    """
    return a[IS_ARC] != 0.0 and b[IS_ARC] != 0.0 and hypot(a[X] - b[X], a[Y] - b[Y]) <= SAME_CENTER


@inner
def find_coincidence(a: Array, b: Array, d: float) -> tuple[float, float, float]:
    """Return (kind, alpha, side) of the coincidence of a chord of length d mm; (NONE, 0, 0) without one.

    Alpha is the chord's direction there in radians. The side is that of :func:`find_line_side` or
    :func:`find_touching_side`. See ``base.feature`` for the layout of ``a`` and ``b``.
    """
    if are_one_chord_apart(a, b, d):
        return (ARCS, atan2(b[Y] - a[Y], b[X] - a[X]), 0.0)
    side = find_touching_side(a, b, d)
    if side != 0.0:
        return (TOUCHING, atan2(side * (b[Y] - a[Y]), side * (b[X] - a[X])), side)
    if a[IS_ARC] == 0.0 and b[IS_ARC] != 0.0:
        side = find_line_side(a, b, d)
        if side != 0.0:
            return (LINE_FIRST, atan2(-side * a[AXIS_X], side * a[AXIS_Y]), side)
    elif a[IS_ARC] != 0.0 and b[IS_ARC] == 0.0:
        side = find_line_side(b, a, d)
        if side != 0.0:
            return (ARC_FIRST, atan2(side * b[AXIS_X], -side * b[AXIS_Y]), side)
    return (NONE, 0.0, 0.0)


@inner
def measure_from_coincidence(alpha: float, middle: float) -> float:
    """Return the angle gamma = ``alpha`` - ``middle`` from the coincidence, in [-pi, pi).

    Symbols are those of ``chord.coincidences``.
    """
    return (alpha - middle + pi) % TURN - pi


@inner
def get_regular_radius(a: Array, b: Array, kind: float) -> float:
    """Return the ``radius`` in mm to pass to :func:`is_regular` for a kind of coincidence.

    See ``base.feature`` for the layout of ``a`` and ``b``.
    """
    if kind == TOUCHING:
        return a[RADIUS] * b[RADIUS] / hypot(b[X] - a[X], b[Y] - a[Y])
    return a[RADIUS] if a[IS_ARC] != 0.0 else b[RADIUS]


@inner
def bound_touching_speed(a: Array, b: Array, side: float, d: float) -> float:
    """Return an upper bound in mm per radian of a tail's speed where
    the regular formulas of touching arcs apply.

    It is R_a times the bounds of both rates: g is no shorter than at the coincidence, or than
    sqrt(R_a^2 + R_b^2), and S no less than 2 R_a R_b. See ``base.feature`` for the layout of ``a`` and ``b``.
    Symbols are those of ``chord.coincidences``.
    """
    one, other = a[RADIUS], b[RADIUS]
    apart, difference = hypot(b[X] - a[X], b[Y] - a[Y]), abs(one - other)
    least = difference * difference if side > 0.0 else one * one + other * other
    ratio = 1.0 + difference * (one + other) / least
    return 1.01 * one * (d / sqrt(least) + sqrt(apart * d / (2.0 * one * other)) * ratio)


@inner
def bound_misfit(a: Array, b: Array, curve: Array, turn: float) -> float:
    """Return a bound in mm of the distance between a tail on arcs that nearly touch and the tail on arcs that
    touch exactly.

    ``turn`` is X of the chord; return 0 for curves of other kinds. The part of the tail along J g is the root
    of a square that is off by 2 m R_a R_b / g, so it is off by m / abs(X). So near to the coincidence that
    this bound says nothing, a fixed bound is used. See ``base.feature`` for the layout of ``a`` and ``b``,
    ``base.tables`` for that of ``curve``. Symbols are those of ``chord.coincidences``.
    """
    if curve[COINCIDENCE] != TOUCHING:
        return 0.0
    apart, d = hypot(b[X] - a[X], b[Y] - a[Y]), curve[LENGTH]
    off = abs(abs(apart - d) - abs(a[RADIUS] - b[RADIUS]))
    if curve[SIDE] < 0.0:
        off = abs(apart + d - a[RADIUS] - b[RADIUS])
    off += EPSILON * (apart + d + a[RADIUS] + b[RADIUS])
    return 3.0 * off / max(abs(turn), sqrt(off * (1.0 / a[RADIUS] + 1.0 / b[RADIUS])))


@inner
def is_regular(kind: float, radius: float, d: float, gamma: float) -> bool:
    """Return whether to use the regular formulas at an angle
    ``gamma`` in radians from a coincidence of this kind.

    ``radius`` is that of :func:`get_regular_radius`, d the chord's length in mm. Symbols are those of
    ``chord.coincidences``.
    """
    if kind in (NONE, CONCENTRIC) or abs(gamma) > 1.0:
        return False
    if kind == ARCS:
        return d * abs(sin(gamma / 2.0)) <= 0.7 * radius
    return d * (1.0 - cos(gamma)) <= radius


@inner
def shares_a_line(curve: Array, psi: float) -> bool:
    """Return whether a chord is so near its coincidence that both contacts share one line of action.

    See ``base.tables`` for the layout of ``curve``.
    """
    kind = curve[COINCIDENCE]
    if kind in (NONE, CONCENTRIC):
        return False
    return abs(measure_from_coincidence(psi + curve[SHIFT], curve[MIDDLE])) <= SHARED


@inner
def compute_motion(a: Array, b: Array, curve: Array, psi: float) -> tuple[bool, Motion]:
    """Return the tail and its derivative over psi near a coincidence, by the regular formulas.

    See ``base.feature`` for the layout of ``a`` and ``b``, ``base.tables`` for that of ``curve``. Symbols are
    those of ``chord.coincidences``.

    Parameters
    ----------
    curve : reals (16,) of a curve that has a coincidence.
    psi : in radians.

    Returns
    -------
    (whether the regular formulas apply; the motion, of which all numbers are 0 where they do not)
    """
    kind, middle, side, d = curve[COINCIDENCE], curve[MIDDLE], curve[SIDE], curve[LENGTH]
    alpha = psi + curve[SHIFT]
    gamma = measure_from_coincidence(alpha, middle)
    radius = get_regular_radius(a, b, kind)
    if not is_regular(kind, radius, d, gamma):
        return (False, Motion(0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    wx, wy = d * cos(alpha), d * sin(alpha)
    way = curve[BRANCH] if gamma >= 0.0 else -curve[BRANCH]
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
        return (True, Motion(a[X] + rx, a[Y] + ry, vx, vy, rx, ry))
    if kind == TOUCHING:
        rx, ry, rate = compute_touching_tail(a, b, d, side, gamma, wx, wy, way)
        return (True, Motion(a[X] + rx, a[Y] + ry, -rate * ry, rate * rx, rx, ry))
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
        return (True, Motion(arc[X] + rx - wx, arc[Y] + ry - wy, vx + wy, vy - wx, rx, ry))
    return (True, Motion(arc[X] + rx, arc[Y] + ry, vx, vy, rx, ry))


@inner
def compute_touching_tail(
    a: Array, b: Array, d: float, side: float, gamma: float, wx: float, wy: float, way: float
) -> tuple[float, float, float]:
    """Return (x, y, rate) of a tail on touching arcs: its position
    from the centre of a in mm, and how fast it turns.

    The rate is in radians per radian of psi. (wx, wy) is the chord in mm, ``way`` the sign of the tail's
    branch there. See ``base.feature`` for the layout of ``a`` and ``b``.
    """
    cx, cy = b[X] - a[X], b[Y] - a[Y]
    apart, total, difference = hypot(cx, cy), a[RADIUS] + b[RADIUS], a[RADIUS] - b[RADIUS]
    sine, cosine = sin(gamma / 2.0), cos(gamma / 2.0)
    k = 4.0 * apart * d * sine * sine
    square = difference * difference + k if side > 0.0 else total * total - k
    rest = 4.0 * a[RADIUS] * b[RADIUS] - k
    gx, gy = cx - wx, cy - wy
    gap = hypot(gx, gy)
    ratio = difference * total / square
    along, half = (1.0 + ratio) / 2.0, way * sine * sqrt(apart * d * rest) / square
    size = sqrt(square) / gap
    rx, ry = size * (along * gx - half * gy), size * (along * gy + half * gx)
    turn = (1.0 + (d - apart) * (d + apart) / square) / 2.0
    return (rx, ry, turn - side * way * sqrt(apart * d / rest) * cosine * (1.0 - ratio))


@inner
def enclose_touching_motion(
    a: Array, b: Array, d: float, side: float, middle: float, gamma: Interval, way: float
) -> MotionBox:
    """Return enclosures (x and y each) of u - c_a, u' and u'' where two arcs touch, for gamma in an interval.

    See ``base.feature`` for the layout of ``a`` and ``b``. Symbols are those of ``chord.coincidences``.
    """
    cx, cy = widen_outward(b[X] - a[X], b[X] - a[X]), widen_outward(b[Y] - a[Y], b[Y] - a[Y])
    apart = isqrt(iadd(isquare(cx), isquare(cy)))
    total, difference = a[RADIUS] + b[RADIUS], a[RADIUS] - b[RADIUS]
    sum_, less = widen_outward(total, total), widen_outward(difference, difference)
    half = iscale(0.5, gamma)
    sine, cosine, product = isin(half), icos(half), iscale(d, apart)
    k = iscale(4.0, imul(product, isquare(sine)))
    square = iadd(isquare(less), k) if side > 0.0 else isub(isquare(sum_), k)
    rest = isub(iscale(4.0 * a[RADIUS], widen_outward(b[RADIUS], b[RADIUS])), k)
    alpha = ishift(middle, gamma)
    gx, gy = isub(cx, iscale(d, icos(alpha))), isub(cy, iscale(d, isin(alpha)))
    ratio = idivide(imul(less, sum_), square)
    along = iscale(0.5, ishift(1.0, ratio))
    across = iscale(way, imul(sine, idivide(isqrt(imul(product, rest)), square)))
    rx, ry = isub(imul(along, gx), imul(across, gy)), iadd(imul(along, gy), imul(across, gx))
    # Rates of G and S, of g, and of the tail from it.
    grown = iscale(2.0 * side, imul(product, isin(gamma)))
    shrunk = iscale(-side, grown)
    away = isub((d * d, d * d), isquare(apart))
    turn = iscale(0.5, ishift(1.0, idivide(away, square)))
    dturn = iscale(-0.5, idivide(imul(away, grown), isquare(square)))
    one, two, three = imul(isqrt(product), cosine), ishift(1.0, ineg(ratio)), isqrt(rest)
    done = imul(isqrt(product), iscale(-0.5, sine))
    dtwo, dthree = idivide(imul(ratio, grown), square), iscale(0.5, idivide(shrunk, three))
    swing = idivide(imul(one, two), three)
    dswing = isub(idivide(iadd(imul(done, two), imul(one, dtwo)), three), idivide(imul(swing, dthree), three))
    rate, drate = iadd(turn, iscale(-side * way, swing)), iadd(dturn, iscale(-side * way, dswing))
    vx, vy = ineg(imul(rate, ry)), imul(rate, rx)
    faster = isquare(rate)
    ax = ineg(iadd(imul(drate, ry), imul(faster, rx)))
    ay = isub(imul(drate, rx), imul(faster, ry))
    return MotionBox(rx, ry, vx, vy, ax, ay)


@inner
def enclose_arcs_motion(
    a: Array, b: Array, d: float, middle: float, gamma: Interval, way: float
) -> MotionBox:
    """Return enclosures (x and y each) of u - c_a, u' and u'' between
    two equal arcs, for gamma in an interval.

    See ``base.feature`` for the layout of ``a`` and ``b``. Symbols are those of ``chord.coincidences``.
    """
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
    return MotionBox(rx, ry, vx, vy, ax, ay)


@inner
def enclose_line_motion(
    line: Array, radius: float, d: float, side: float, gamma: Interval, way: float
) -> MotionBox:
    """Return enclosures (x and y each) of a contact on an arc and its
    two derivatives, for a chord from or to a line.

    The contact is taken from the arc's centre. ``gamma`` is an interval of the angle from the coincidence.
    See ``base.feature`` for the layout of ``line``. Symbols are those of ``chord.coincidences``.
    """
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
    return MotionBox(
        iadd(iscale(nx, across), iscale(tx, along)),
        iadd(iscale(ny, across), iscale(ty, along)),
        iadd(iscale(nx, dacross), iscale(tx, dalong)),
        iadd(iscale(ny, dacross), iscale(ty, dalong)),
        iadd(iscale(nx, ddacross), iscale(tx, ddalong)),
        iadd(iscale(ny, ddacross), iscale(ty, ddalong)),
    )


@inner
def enclose_angle(low: float, high: float, middle: float) -> tuple[float, Interval]:
    """Return the angle gamma from the coincidence to the middle of
    [low, high], and an enclosure of gamma over the range.

    Directions must be below 16 radians; each of three sums is then off by at most half a unit in the last
    place of 16. Symbols are those of ``chord.coincidences``.
    """
    center, reach = (
        measure_from_coincidence((low + high) / 2.0, middle),
        (high - low) / 2.0 * (1.0 + 1e-15) + 3e-15,
    )
    return (center, (center - reach, center + reach))


@inner
def enclose_motion(a: Array, b: Array, curve: Array, low: float, high: float) -> tuple[bool, MotionBox]:
    """Return enclosures of the tail u and its derivatives over alpha in [low, high] near a coincidence.

    See ``base.feature`` for the layout of ``a`` and ``b``, ``base.tables`` for that of ``curve``. Symbols are
    those of ``chord.coincidences``.

    Returns
    -------
    (whether the regular formulas apply; intervals (ux, uy, u'x, u'y, u''x, u''y), all (0, 0) where they do
        not)
    """
    kind, middle, side, d = curve[COINCIDENCE], curve[MIDDLE], curve[SIDE], curve[LENGTH]
    center, gamma = enclose_angle(low, high, middle)
    radius = get_regular_radius(a, b, kind)
    if not (is_regular(kind, radius, d, gamma[0]) and is_regular(kind, radius, d, gamma[1])):
        zero = (0.0, 0.0)
        return (False, MotionBox(zero, zero, zero, zero, zero, zero))
    way = curve[BRANCH] if center >= 0.0 else -curve[BRANCH]
    if kind == LINE_FIRST:
        r = enclose_line_motion(a, radius, d, side, gamma, way)
        alpha = ishift(middle, gamma)
        wx, wy = iscale(d, icos(alpha)), iscale(d, isin(alpha))
        x, y = isub(ishift(b[X], r.x), wx), isub(ishift(b[Y], r.y), wy)
        return (
            True,
            MotionBox(
                x, y, iadd(r.speed_x, wy), iadd(r.speed_y, ineg(wx)), iadd(r.ray_x, wx), iadd(r.ray_y, wy)
            ),
        )
    if kind == ARCS:
        r = enclose_arcs_motion(a, b, d, middle, gamma, way)
    elif kind == TOUCHING:
        r = enclose_touching_motion(a, b, d, side, middle, gamma, way)
    else:
        r = enclose_line_motion(b, radius, d, side, gamma, way)
    return (True, MotionBox(ishift(a[X], r.x), ishift(a[Y], r.y), r.speed_x, r.speed_y, r.ray_x, r.ray_y))
