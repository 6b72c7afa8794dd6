r"""Chords: two pegs of one jaw touching two features, as a curve over the orientation.

Look from the workpiece's frame: the pegs turn by psi = -theta and move as one rigid set. Two pegs a lattice step
``Delta`` apart, the first on feature a (the chord's tail u) and the second on feature b (its head v = u + w), form a
segment of length d = \|Delta\| and direction alpha = psi + arg Delta. Given alpha, u follows in closed form, with at most
two branches.

Conventions
-----------
r_a, r_b : unit normal of a line, unit vector from the centre for an arc (its sign plays no part in lines of action).
P : the chord's instant centre, where the lines of action through both contacts meet; P = u + p r_a with
    p = cross(w, r_b) / X and X = cross(r_a, r_b). When psi turns, u' = J (u - P), J the quarter turn.
height : h = y . u, with x = (cos psi, sin psi) and y = J x the vise's axes. From u' follows h' = -x . P.
position : s, the parameter of u on feature a. s' = -p on a line, -p / R on an arc of radius R.
A tangency of the chord (X = 0) is where its two branches meet and both derivatives are infinite.
blur : eta, a bound in mm of how far the computed contacts are off their features, from rounding alone.

Errors of computed chords
-------------------------
Let G(u) be the distances of the tail u from the carrier of a and of the head u + w from that of b. A computed tail satisfies
\|G\| <= eta in both entries (backward error). The rows of the Jacobian of G are r_a and r_b, its determinant is X, and its
Lipschitz constant is at most kappa = 1 / R_a + 1 / R_b. The Newton-Kantorovich theorem says that when 64 kappa eta <= X^2
there is exactly one chord within 4 eta / \|X\| of the computed one, on the same branch. The bounds of ``curve_errors``
follow by the chain rule from h' = -x . (u + p r_a) and p = cross(w, r_b) / X.
Reference: J. M. Ortega, "The Newton-Kantorovich theorem", American Mathematical Monthly 75 (1968) 658-660.
"""

from __future__ import annotations

from math import atan2, cos, hypot, inf, isfinite, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from holdfast.kernels.compiling import compiled
from holdfast.kernels.through_motion import EXACT, are_one_chord_apart, motion

Array = NDArray[np.float64]
Errors = tuple[float, float]
Chord = tuple[float, float, float, float, float, float]

# Which value of a curve is meant. (Kernels are compiled anew for every whole number written as such; these are not.)
HEIGHT = 0.0
POSITION = 1.0

# Centres nearer than this, in mm, make arcs concentric.
CONCENTRIC = 1e-9
# Roundings of half a unit in the last place that add up to a contact's distance from its feature, generously counted: those
# of the angle (of up to 9 radians), of its sine and cosine, and of a dozen sums and products.
ROUNDINGS = 32.0 * 1.2e-16


@compiled
def are_concentric(a: Array, b: Array) -> bool:
    """Whether two features are arcs of one centre: their chords turn about it without changing shape."""
    return a[0] != 0.0 and b[0] != 0.0 and hypot(a[1] - b[1], a[2] - b[2]) <= CONCENTRIC


@compiled
def line_to_arc(a: Array, b: Array, wx: float, wy: float, branch: float) -> Chord:
    """Tail on line a, head on arc b: the head lies on the line moved by w, cut with the circle of b."""
    nx, ny = a[4], -a[3]
    across = nx * (a[1] + wx - b[1]) + ny * (a[2] + wy - b[2])
    half = sqrt(max((b[6] - across) * (b[6] + across), 0.0)) * branch
    rx, ry = across * nx + half * a[3], across * ny + half * a[4]
    return (b[1] + rx - wx, b[2] + ry - wy, nx, ny, rx / b[6], ry / b[6])


@compiled
def arc_to_arc(a: Array, b: Array, d: float, wx: float, wy: float, branch: float) -> Chord:
    """Tail on arc a, head on arc b: the tail lies on the circle of a and on that of b moved by -w."""
    cx, cy = b[1] - a[1], b[2] - a[2]
    gx, gy = cx - wx, cy - wy
    gap = hypot(gx, gy)
    if are_one_chord_apart(a, b, d) and cx * wx + cy * wy > 0.0:
        # gap = 2 d sin(angle / 2): its direction is exact from the half angle, not from the difference.
        mx, my = cx + wx, cy + wy
        size = hypot(mx, my)
        side = 1.0 if cx * wy - cy * wx >= 0.0 else -1.0
        dx, dy = side * my / size, -side * mx / size
        along = gap / 2.0
    else:
        dx, dy = gx / gap, gy / gap
        along = (gap + (a[6] - b[6]) * (a[6] + b[6]) / gap) / 2.0
    half = sqrt(max((a[6] - along) * (a[6] + along), 0.0)) * branch
    rx, ry = along * dx - half * dy, along * dy + half * dx
    qx, qy = rx - gx, ry - gy
    return (a[1] + rx, a[2] + ry, rx / a[6], ry / a[6], qx / b[6], qy / b[6])


@compiled
def chord(a: Array, b: Array, d: float, alpha: float, branch: float) -> Chord:
    """Tail and the two contact directions of a chord of length d and direction alpha.

    Parameters
    ----------
    a, b : (8,) rows of the features of tail and head.
    d, alpha : length in mm and direction in radians.
    branch : +1 or -1 where an arc takes part; ignored between lines.

    Returns
    -------
    (ux, uy, r_ax, r_ay, r_bx, r_by)
    """
    wx, wy = d * cos(alpha), d * sin(alpha)
    if a[0] == 0.0:
        if b[0] != 0.0:
            return line_to_arc(a, b, wx, wy, branch)
        nx, ny = b[4], -b[3]
        s = (nx * (b[1] - a[1] - wx) + ny * (b[2] - a[2] - wy)) / (nx * a[3] + ny * a[4])
        return (a[1] + s * a[3], a[2] + s * a[4], a[4], -a[3], nx, ny)
    if b[0] == 0.0:
        vx, vy, rbx, rby, rax, ray = line_to_arc(b, a, -wx, -wy, branch)
        return (vx - wx, vy - wy, rax, ray, rbx, rby)
    return arc_to_arc(a, b, d, wx, wy, branch)


@compiled
def tail_distance(c: Chord, d: float, alpha: float) -> float:
    """p: distance from the tail to the instant centre along r_a, infinite at a tangency."""
    turn = c[2] * c[5] - c[3] * c[4]
    across = d * (cos(alpha) * c[5] - sin(alpha) * c[4])
    if turn == 0.0:
        return inf
    return across / turn


@compiled
def parameter_on(row: Array, x: float, y: float) -> float:
    """Parameter of a point on a feature: mm on a line, radians in (-pi, pi] on an arc."""
    dx, dy = x - row[1], y - row[2]
    if row[0] == 0.0:
        return dx * row[3] + dy * row[4]
    return atan2(row[3] * dy - row[4] * dx, row[3] * dx + row[4] * dy)


@compiled
def blur(a: Array, b: Array, d: float) -> float:
    """Bound in mm of how far rounding puts the contacts of a computed chord off their features."""
    size = abs(a[1]) + abs(a[2]) + abs(b[1]) + abs(b[2]) + a[6] + b[6] + d
    spread = 1.0
    if a[0] != 0.0 and b[0] != 0.0:
        # The head's distance from its circle is found from that of the tail: an error grows with the ratio of radii.
        spread = max(a[6] / b[6], b[6] / a[6])
        if are_concentric(a, b):
            return ROUNDINGS * size * spread + hypot(a[1] - b[1], a[2] - b[2])
    return ROUNDINGS * size * spread


@compiled
def curvature(row: Array) -> float:
    """How fast in 1 / mm the unit vector towards a contact turns when the contact moves off or along its feature."""
    return 0.0 if row[0] == 0.0 else 1.0 / row[6]


@compiled
def curve_errors(a: Array, b: Array, d: float, turn: float, p: float, mode: float) -> Errors:
    """Bounds of the errors of a computed value and slope.

    Parameters
    ----------
    turn, p : computed X and p (see the conventions above).

    Returns
    -------
    (error of the value, error of the slope), infinite too near a tangency
    """
    eta = blur(a, b, d)
    kappa = curvature(a) + curvature(b)
    square = turn * turn
    if square < 64.0 * kappa * eta or square == 0.0:
        return (inf, inf)
    value, slope = 6.0 * eta / abs(turn), 8.0 * eta / square * (1.0 + kappa * (d + 2.0 * abs(p)))
    if mode != HEIGHT and a[0] != 0.0:
        return (value / a[6] + 1e-15, slope / a[6])
    return (value, slope)


@compiled
def tail_radius(a: Array, b: Array, d: float, c: Chord, reach: float) -> float:
    """How far in mm the exact tail may be from a computed one when the orientation may be ``reach`` radians off.

    The tail moves at a speed of at most d / |X|, and X^2 changes at a rate of at most 4 d kappa. Infinite where this does
    not bound it, too near a tangency.
    """
    eta = blur(a, b, d)
    kappa = curvature(a) + curvature(b)
    turn = abs(c[2] * c[5] - c[3] * c[4])
    square = turn * turn
    if square < 64.0 * kappa * eta or square < 16.0 * d * kappa * reach or turn == 0.0:
        return inf
    return 5.0 * eta / turn + 1.3 * d / turn * reach


@compiled
def regular_error(a: Array, b: Array, d: float) -> float:
    """Bound in mm of the error of a tail found by the regular formulas near a coincidence."""
    return 8.0 * blur(a, b, d) + 4.0 * EXACT


@compiled
def curve_value(
    a: Array, b: Array, d: float, alpha: float, branch: float, shift: float, mode: float
) -> tuple[float, float, float, float]:
    """Value and derivative over psi of a chord curve.

    Parameters
    ----------
    shift : arg Delta in radians, so that psi = alpha - shift.
    mode : ``HEIGHT`` for h in mm, ``POSITION`` for s of the tail on a (mm on a line, radians on an arc).

    Returns
    -------
    (value, derivative, bound of the value's error, bound of the derivative's error), the errors infinite where these
    formulas do not bound them, too near a tangency
    """
    psi = alpha - shift
    x, y = cos(psi), sin(psi)
    regular, u = motion(a, b, d, alpha, branch)
    if regular:
        error = regular_error(a, b, d)
        slope_error = error * (1.0 + d * (curvature(a) + curvature(b)))
        if mode == HEIGHT:
            return (x * u[1] - y * u[0], -(x * u[0] + y * u[1]) + x * u[3] - y * u[2], error, slope_error)
        s = parameter_on(a, u[0], u[1])
        if a[0] == 0.0:
            return (s, a[3] * u[2] + a[4] * u[3], error, slope_error)
        return (s, (u[4] * u[3] - u[5] * u[2]) / (a[6] * a[6]), error / a[6], slope_error / a[6])
    c = chord(a, b, d, alpha, branch)
    p = -a[6] if are_concentric(a, b) else tail_distance(c, d, alpha)
    if not isfinite(p):
        p = 0.0
    errors = curve_errors(a, b, d, c[2] * c[5] - c[3] * c[4], p, mode)
    if mode == HEIGHT:
        slope = -(x * (c[0] + p * c[2]) + y * (c[1] + p * c[3]))
        return (x * c[1] - y * c[0], slope, errors[0], errors[1])
    s = parameter_on(a, c[0], c[1])
    if a[0] == 0.0:
        return (s, -p, errors[0], errors[1])
    return (s, -p / a[6], errors[0], errors[1])
