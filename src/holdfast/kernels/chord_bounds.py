"""Enclosures of a chord curve's second derivative over a range of orientations.

With C_a = cross(w, r_a), C_b = cross(w, r_b), X = cross(r_a, r_b), k_a and k_b the features' curvatures (0 for a line,
1 / R for an arc), differentiating the two lines of action through the instant centre P gives

    X^3 P' = (C_a X + k_b C_a^2) r_a - (C_b X + k_a C_b^2) r_b,

and with h' = -x . P and s' = -p (times k_a on an arc)

    X^3 h'' = -X^3 y . u - X^2 C_b y . r_a + (C_b X + k_a C_b^2) x . r_b - (C_a X + k_b C_a^2) x . r_a
    X^3 s'' = (C_b X + k_a C_b^2) r_a . r_b - (C_a X + k_b C_a^2)      (times k_a on an arc).

The right-hand sides stay finite at a tangency, where X = 0, so the sign of a second derivative is bounded there too.

Between two arcs of nearly equal radii R_a and R_b whose centres are nearly one chord apart, r_a and r_b nearly agree, and
the terms on the right nearly cancel. With g = c - w, c from centre to centre, R_a r_a - R_b r_b = g gives the same without
cancellation: X = -G / R_b with G = cross(r_a, g), and with W = cross(w, c), E = C_a - G, rho = R_a / R_b

    R_b X^3 P' = (1 - rho^2) C_a E r_a + rho C_a E g / R_b
                 + (rho C_a W / R_a + (W / R_b) (E - W / R_a)) (rho r_a - g / R_b).
"""

from __future__ import annotations

from math import cos, hypot, inf, isfinite, sin

import numpy as np
from numpy.typing import NDArray

from holdfast.kernels.chord import (
    HEIGHT,
    are_concentric,
    blur,
    chord,
    parameter_on,
    regular_error,
    tail_radius,
)
from holdfast.kernels.compiling import compiled
from holdfast.kernels.interval import (
    TURN,
    Interval,
    iadd,
    icos,
    icross,
    idivide,
    idot,
    imul,
    ineg,
    iscale,
    ishift,
    isin,
    isqrt,
    isquare,
    isub,
)
from holdfast.kernels.through_motion import MotionBox, are_one_chord_apart, motion, motion_box

Array = NDArray[np.float64]
# Circles whose centres are nearer than this part of the smaller radius have nearly the same directions of contact.
NEAR = 0.5
# A range of directions in radians over which the regular formulas of a coincidence are linear for all purposes.
SHORT = 1e-6
ChordBox = tuple[Interval, Interval, Interval, Interval, Interval, Interval]


@compiled
def line_to_arc_box(a: Array, b: Array, wx: Interval, wy: Interval, branch: float) -> ChordBox:
    """Enclosure of ``line_to_arc``."""
    nx, ny = a[4], -a[3]
    moved_x, moved_y = ishift(a[1] - b[1], wx), ishift(a[2] - b[2], wy)
    across = iadd(iscale(nx, moved_x), iscale(ny, moved_y))
    inside = imul(isub((b[6], b[6]), across), ishift(b[6], across))
    half = iscale(branch, isqrt(inside))
    rx = iadd(iscale(nx, across), iscale(a[3], half))
    ry = iadd(iscale(ny, across), iscale(a[4], half))
    ux, uy = isub(ishift(b[1], rx), wx), isub(ishift(b[2], ry), wy)
    return (ux, uy, (nx, nx), (ny, ny), iscale(1.0 / b[6], rx), iscale(1.0 / b[6], ry))


@compiled
def arc_to_arc_box(a: Array, b: Array, d: float, wx: Interval, wy: Interval, branch: float) -> ChordBox:
    """Enclosure of ``arc_to_arc``."""
    cx, cy = b[1] - a[1], b[2] - a[2]
    gx, gy = isub((cx, cx), wx), isub((cy, cy), wy)
    gap = isqrt(iadd(isquare(gx), isquare(gy)))
    if are_one_chord_apart(a, b, d) and cx * wx[0] + cy * wy[0] > 0.0 and cx * wx[1] + cy * wy[1] > 0.0:
        mx, my = ishift(cx, wx), ishift(cy, wy)
        size = isqrt(iadd(isquare(mx), isquare(my)))
        middle_x, middle_y = (wx[0] + wx[1]) / 2.0, (wy[0] + wy[1]) / 2.0
        side = 1.0 if cx * middle_y - cy * middle_x >= 0.0 else -1.0
        dx, dy = iscale(side, idivide(my, size)), iscale(-side, idivide(mx, size))
        along = iscale(0.5, gap)
    else:
        dx, dy = idivide(gx, gap), idivide(gy, gap)
        difference = (a[6] - b[6]) * (a[6] + b[6])
        along = iscale(0.5, iadd(gap, idivide((difference, difference), gap)))
    inside = imul(isub((a[6], a[6]), along), ishift(a[6], along))
    half = iscale(branch, isqrt(inside))
    rx, ry = isub(imul(along, dx), imul(half, dy)), iadd(imul(along, dy), imul(half, dx))
    qx, qy = iscale(1.0 / b[6], isub(rx, gx)), iscale(1.0 / b[6], isub(ry, gy))
    return (ishift(a[1], rx), ishift(a[2], ry), iscale(1.0 / a[6], rx), iscale(1.0 / a[6], ry), qx, qy)


@compiled
def line_to_line_box(a: Array, b: Array, wx: Interval, wy: Interval) -> ChordBox:
    """Enclosure of the chord between two lines."""
    nx, ny = b[4], -b[3]
    reach = iadd(iscale(nx, isub((b[1] - a[1], b[1] - a[1]), wx)), iscale(ny, isub((b[2] - a[2], b[2] - a[2]), wy)))
    s = iscale(1.0 / (nx * a[3] + ny * a[4]), reach)
    ux, uy = ishift(a[1], iscale(a[3], s)), ishift(a[2], iscale(a[4], s))
    return (ux, uy, (a[4], a[4]), (-a[3], -a[3]), (nx, nx), (ny, ny))


@compiled
def chord_box(a: Array, b: Array, d: float, wx: Interval, wy: Interval, branch: float) -> ChordBox:
    """Enclosure of ``chord`` for all w in a box."""
    if a[0] == 0.0:
        if b[0] == 0.0:
            return line_to_line_box(a, b, wx, wy)
        return line_to_arc_box(a, b, wx, wy, branch)
    if b[0] == 0.0:
        vx, vy, rbx, rby, rax, ray = line_to_arc_box(b, a, ineg(wx), ineg(wy), branch)
        return (isub(vx, wx), isub(vy, wy), rax, ray, rbx, rby)
    return arc_to_arc_box(a, b, d, wx, wy, branch)


@compiled
def tail_disc(a: Array, b: Array, d: float, alpha: float, branch: float, reach: float) -> tuple[float, float, float]:
    """A disc (x, y, radius in mm) that holds the tails of a branch for all directions within ``reach`` of alpha."""
    angles = (alpha - reach - 1e-15, alpha + reach + 1e-15)
    wx, wy = iscale(d, icos(angles)), iscale(d, isin(angles))
    ux, uy, _, _, _, _ = chord_box(a, b, d, wx, wy, branch)
    eta = blur(a, b, d)
    half_width, half_height = (ux[1] - ux[0]) / 2.0, (uy[1] - uy[0]) / 2.0
    return ((ux[0] + ux[1]) / 2.0, (uy[0] + uy[1]) / 2.0, 1.1 * hypot(half_width, half_height) + 4.0 * eta)


@compiled
def chord_tail(a: Array, b: Array, d: float, alpha: float, branch: float, reach: float) -> tuple[float, float, float]:
    """The tail of a chord, and how far in mm the exact one may be from it when alpha is off by up to ``reach``."""
    regular, u = motion(a, b, d, alpha, branch)
    if regular and reach <= SHORT:
        # The second derivative is bounded by a few d (1 + d / R): no matter over so short a reach.
        return (u[0], u[1], regular_error(a, b, d) + 2.0 * (hypot(u[2], u[3]) + d) * reach)
    c = chord(a, b, d, alpha, branch)
    radius = tail_radius(a, b, d, c, reach)
    if not isfinite(radius):
        x, y, radius = tail_disc(a, b, d, alpha, branch, reach)
        radius += hypot(c[0] - x, c[1] - y)
    # A tail that counts is on its feature.
    if a[0] != 0.0:
        return (c[0], c[1], min(radius, 2.2 * a[6]))
    if radius <= 2.2 * a[5]:
        return (c[0], c[1], radius)
    return (a[1], a[2], 1.1 * a[5])


@compiled
def value_disc(
    a: Array, b: Array, d: float, alpha: float, branch: float, reach: float, shift: float, mode: float
) -> tuple[float, float]:
    """A middle value of a branch for directions within ``reach`` of alpha, and how far its values may be from it."""
    x, y, radius = tail_disc(a, b, d, alpha, branch, reach)
    psi = alpha - shift
    if mode == HEIGHT:
        return (cos(psi) * y - sin(psi) * x, radius + (abs(x) + abs(y) + radius) * reach)
    if a[0] == 0.0:
        return (parameter_on(a, x, y), radius)
    # A disc of up to half the arc's radius is seen from its centre under at most 1.1 radius / R to either side.
    return (parameter_on(a, x, y), 1.1 * radius / a[6] if radius <= 0.5 * a[6] else TURN)


@compiled
def over_cube(numerator: Interval, turn: Interval) -> Interval:
    """numerator / turn^3; when turn reaches 0 from one side, a one-signed quotient is still bounded on one side."""
    cube = imul(turn, isquare(turn))
    if turn[0] > 0.0 or turn[1] < 0.0:
        return idivide(numerator, cube)
    positive = turn[1] > -turn[0]
    size = cube[1] if positive else -cube[0]
    if not positive:
        numerator = ineg(numerator)
    if size <= 0.0:
        return (-inf, inf)
    if numerator[0] > 0.0:
        return (numerator[0] / size * (1.0 - 1e-15), inf)
    if numerator[1] < 0.0:
        return (-inf, numerator[1] / size * (1.0 - 1e-15))
    return (-inf, inf)


@compiled
def one_sided(turn: Interval, sign: float) -> Interval:
    """Cut a cross product known to keep its sign (0 at a tangency) to that side."""
    if sign > 0.0:
        return (max(turn[0], 0.0), max(turn[1], 0.0))
    return (min(turn[0], 0.0), min(turn[1], 0.0))


@compiled
def regular_bend(a: Array, u: MotionBox, r: MotionBox, psi: Interval, mode: float) -> Interval:
    """Enclosure of the second derivative from those of u, u' and u'' (h'' = -y.u - 2 x.u' + y.u'')."""
    if mode != HEIGHT:
        if a[0] == 0.0:
            return iadd(iscale(a[3], u[4]), iscale(a[4], u[5]))
        return iscale(1.0 / (a[6] * a[6]), icross(r[0], r[1], r[4], r[5]))
    x, y = icos(psi), isin(psi)
    fall = isub(imul(y, isub(u[0], u[4])), imul(x, isub(u[1], u[5])))
    return isub(fall, iscale(2.0, idot(x, y, u[2], u[3])))


@compiled
def arcs_bend(
    a: Array, b: Array, wx: Interval, wy: Interval, chord: ChordBox, psi: Interval, mode: float, turn_sign: float
) -> Interval:
    """Enclosure of the second derivative between arcs of which each contact direction is nearly the other."""
    ux, uy, rx, ry, _, _ = chord
    cx, cy = b[1] - a[1], b[2] - a[2]
    gx, gy = isub((cx, cx), wx), isub((cy, cy), wy)
    rho, inverse = a[6] / b[6], 1.0 / b[6]
    swing = icross(rx, ry, gx, gy)
    turn = one_sided(iscale(-inverse, swing), turn_sign)
    cross_a = icross(wx, wy, rx, ry)
    across = icross(wx, wy, (cx, cx), (cy, cy))
    rest = isub(cross_a, swing)
    unequal = -(a[6] - b[6]) * (a[6] + b[6]) * inverse * inverse
    product = imul(cross_a, rest)
    last = iadd(
        iscale(rho / a[6], imul(cross_a, across)), iscale(inverse, imul(across, isub(rest, iscale(1.0 / a[6], across))))
    )
    hx, hy = isub(iscale(rho, rx), iscale(inverse, gx)), isub(iscale(rho, ry), iscale(inverse, gy))
    # R_b X^3 P' is along * r_a + product * rho g / R_b + last * h.
    along, beside = iscale(unequal, product), iscale(rho * inverse, product)
    nx = iadd(imul(along, rx), iadd(imul(beside, gx), imul(last, hx)))
    ny = iadd(imul(along, ry), iadd(imul(beside, gy), imul(last, hy)))
    if mode != HEIGHT:
        return iscale(1.0 / a[6], over_cube(iscale(-inverse, idot(nx, ny, rx, ry)), turn))
    x, y = icos(psi), isin(psi)
    cross_b = isub(iscale(rho, cross_a), iscale(inverse, across))
    pull = imul(imul(isquare(turn), cross_b), isub(imul(x, ry), imul(y, rx)))
    swung = ineg(iadd(iscale(inverse, idot(x, y, nx, ny)), pull))
    return iadd(over_cube(swung, turn), isub(imul(y, ux), imul(x, uy)))


@compiled
def curve_bend(
    a: Array, b: Array, d: float, low: float, high: float, branch: float, shift: float, mode: float, turn_sign: float
) -> Interval:
    """Enclosure of a chord curve's second derivative for alpha in [low, high].

    Parameters
    ----------
    turn_sign : sign of X inside the range (X vanishes at most at its ends).

    Returns
    -------
    (lowest, highest), infinite where nothing is known.
    """
    alpha = (low, high)
    if are_concentric(a, b):
        # The instant centre is the common centre: h'' = -y . P and s'' = 0.
        if mode != HEIGHT:
            return (0.0, 0.0)
        psi = isub(alpha, (shift, shift))
        return isub(iscale(a[1], isin(psi)), iscale(a[2], icos(psi)))
    regular, u, r = motion_box(a, b, d, low, high, branch)
    if regular:
        return regular_bend(a, u, r, isub(alpha, (shift, shift)), mode)
    wx, wy = iscale(d, icos(alpha)), iscale(d, isin(alpha))
    box = chord_box(a, b, d, wx, wy, branch)
    if a[0] != 0.0 and b[0] != 0.0:
        gap = hypot(b[1] - a[1] - (wx[0] + wx[1]) / 2.0, b[2] - a[2] - (wy[0] + wy[1]) / 2.0)
        if gap < NEAR * min(a[6], b[6]):
            return arcs_bend(a, b, wx, wy, box, isub(alpha, (shift, shift)), mode, turn_sign)
    ux, uy, rax, ray, rbx, rby = box
    turn = one_sided(icross(rax, ray, rbx, rby), turn_sign)
    cross_a, cross_b = icross(wx, wy, rax, ray), icross(wx, wy, rbx, rby)
    bend_a = 0.0 if a[0] == 0.0 else 1.0 / a[6]
    bend_b = 0.0 if b[0] == 0.0 else 1.0 / b[6]
    part_a = imul(cross_a, iadd(turn, iscale(bend_b, cross_a)))
    part_b = imul(cross_b, iadd(turn, iscale(bend_a, cross_b)))
    if mode == HEIGHT:
        psi = isub(alpha, (shift, shift))
        x, y = icos(psi), isin(psi)
        square = isquare(turn)
        swing = isub(imul(part_b, idot(x, y, rbx, rby)), imul(part_a, idot(x, y, rax, ray)))
        swing = isub(swing, imul(imul(square, cross_b), isub(imul(x, ray), imul(y, rax))))
        # -X^3 y.u is kept outside the quotient: it needs no division.
        fixed = isub(imul(y, ux), imul(x, uy))
        return iadd(over_cube(swing, turn), fixed)
    swing = isub(imul(part_b, idot(rax, ray, rbx, rby)), part_a)
    bend = over_cube(swing, turn)
    return bend if a[0] == 0.0 else iscale(bend_a, bend)
