r"""Chords: two pegs of one carrier touching two features, as a curve over the orientation.

Look from the workpiece's frame: the pegs turn by psi = -theta and move as one rigid set. Let two pegs be a
lattice step ``Delta`` apart, the first on feature a (the chord's tail u), the second on feature b (its head v
= u + w). They form a segment of length d = \|Delta\| and direction alpha = psi + arg Delta. Given alpha, u
follows in closed form, with at most two branches.

Conventions
-----------
r_a, r_b : unit normal of a line, unit vector from the centre for an arc (its sign plays no part in lines of
    action).
P : the chord's instant centre, where the lines of action through both contacts meet; P = u + p r_a with
    p = cross(w, r_b) / X and X = cross(r_a, r_b). When psi turns, u' = J (u - P), J the quarter turn.
height : h = y . u, with x = (cos psi, sin psi) and y = J x the axes of the pegs' frame. From u' follows h' =
    -x . P.
position : s, the parameter of u on feature a. s' = -p on a line, -p / R on an arc of radius R.
A tangency of the chord (X = 0) is where its two branches meet and both derivatives are infinite.
backward error : eta, a bound in mm of how far the computed contacts are off their features, from rounding
    alone.

Errors of computed chords
-------------------------
Let G(u) be the distances of the tail u from the carrier of a and of the head u + w from that of b. A computed
tail has \|G\| <= eta in both entries (backward error). The rows of the Jacobian of G are r_a and r_b, its
determinant is X, and its Lipschitz constant is at most kappa = 1 / R_a + 1 / R_b. So its inverse is at most 2
/ \|X\| and the first Newton step at most 2 eta / \|X\|. Let 16 kappa eta <= X^2, so that h of the
Newton-Kantorovich theorem is 1 / 4. Then there is exactly one chord within 2.35 eta / \|X\| of the computed
one, on the same branch. Over that way X changes by a part of 0.15, so the chain rule on P = u + p r_a, p =
cross(w, r_b) / X, applies. It gives an error of P of at most eta / X^2 (2.35 + kappa (2.8 d + 5.2 \|p\|)).
The bounds of ``chord_state`` are a little wider.

Reference: J. M. Ortega, "The Newton-Kantorovich theorem", American Mathematical Monthly 75 (1968) 658-660.
"""

from __future__ import annotations

from math import cos, hypot, inf, pi, sin, sqrt

from workhold.conventions import EXACT
from workhold.kernels.base.compiling import Array, inner
from workhold.kernels.base.feature import (
    AXIS_X,
    AXIS_Y,
    HALF_EXTENT,
    HIGH_SLACK,
    IS_ARC,
    LOW_SLACK,
    RADIUS,
    X,
    Y,
    angle_on,
    is_shallow,
    local_size,
)
from workhold.kernels.base.tables import (
    BACKWARD_ERROR,
    BRANCH,
    COINCIDENCE,
    COSINE,
    KAPPA,
    LENGTH,
    MIDDLE,
    SHIFT,
    SIDE,
    SINE,
)
from workhold.kernels.chord.coincidences import (
    ARCS,
    CONCENTRIC,
    NONE,
    are_concentric,
    are_one_chord_apart,
    coincidence,
    misfit,
    motion,
)
from workhold.kernels.chord.shallow import line_to_shallow, shallow_to_arc

Chord = tuple[float, float, float, float, float, float]
State = tuple[float, float, float, float, float, float, float, float, float, float]

# Which value of a curve is meant. (For every whole number written as such kernels are compiled anew.)
HEIGHT = 0.0
POSITION = 1.0

# Roundings of half a unit in the last place that add up to a contact's distance from its feature, generously
# counted: those of the angle (of up to 9 radians), of its sine and cosine, and of a dozen sums and products.
ROUNDINGS = 32.0 * 1.2e-16


@inner
def line_to_arc(a: Array, b: Array, wx: float, wy: float, branch: float) -> Chord:
    """Tail on line a, head on arc b: the head lies on the line moved by w, cut with the circle of b."""
    if is_shallow(b):
        return line_to_shallow(a, b, wx, wy, branch)
    nx, ny = a[AXIS_Y], -a[AXIS_X]
    across = nx * (a[X] + wx - b[X]) + ny * (a[Y] + wy - b[Y])
    half = sqrt(max((b[RADIUS] - across) * (b[RADIUS] + across), 0.0)) * branch
    rx, ry = across * nx + half * a[AXIS_X], across * ny + half * a[AXIS_Y]
    return (b[X] + rx - wx, b[Y] + ry - wy, nx, ny, rx / b[RADIUS], ry / b[RADIUS])


@inner
def arc_to_arc(a: Array, b: Array, wx: float, wy: float, branch: float, one_chord_apart: bool) -> Chord:
    """Tail on arc a, head on arc b: the tail lies on the circle of a and on that of b moved by -w."""
    if (is_shallow(a) or is_shallow(b)) and not one_chord_apart:
        return shallow_to_arc(a, b, wx, wy, branch)
    cx, cy = b[X] - a[X], b[Y] - a[Y]
    gx, gy = cx - wx, cy - wy
    gap = sqrt(gx * gx + gy * gy)
    if one_chord_apart and cx * wx + cy * wy > 0.0:
        # gap = 2 d sin(angle / 2): its direction is exact from the half angle, not from the difference.
        mx, my = cx + wx, cy + wy
        size = sqrt(mx * mx + my * my)
        side = 1.0 if cx * wy - cy * wx >= 0.0 else -1.0
        dx, dy = side * my / size, -side * mx / size
        along = gap / 2.0
    else:
        dx, dy = gx / gap, gy / gap
        along = (gap + (a[RADIUS] - b[RADIUS]) * (a[RADIUS] + b[RADIUS]) / gap) / 2.0
    half = sqrt(max((a[RADIUS] - along) * (a[RADIUS] + along), 0.0)) * branch
    rx, ry = along * dx - half * dy, along * dy + half * dx
    qx, qy = rx - gx, ry - gy
    return (a[X] + rx, a[Y] + ry, rx / a[RADIUS], ry / a[RADIUS], qx / b[RADIUS], qy / b[RADIUS])


@inner
def chord_along(a: Array, b: Array, wx: float, wy: float, branch: float, one_chord_apart: bool) -> Chord:
    """Tail and the two contact directions of a chord w from feature a to feature b.

    Parameters
    ----------
    a, b : (8,) rows of the features of tail and head.
    wx, wy : the chord in mm.
    branch : +1 or -1 where an arc takes part; ignored between lines.
    one_chord_apart : whether the features are equal arcs with centres one chord length apart.

    Returns
    -------
    (ux, uy, r_ax, r_ay, r_bx, r_by)
    """
    if a[IS_ARC] == 0.0:
        if b[IS_ARC] != 0.0:
            return line_to_arc(a, b, wx, wy, branch)
        nx, ny = b[AXIS_Y], -b[AXIS_X]
        s = (nx * (b[X] - a[X] - wx) + ny * (b[Y] - a[Y] - wy)) / (nx * a[AXIS_X] + ny * a[AXIS_Y])
        return (a[X] + s * a[AXIS_X], a[Y] + s * a[AXIS_Y], a[AXIS_Y], -a[AXIS_X], nx, ny)
    if b[IS_ARC] == 0.0:
        vx, vy, rbx, rby, rax, ray = line_to_arc(b, a, -wx, -wy, branch)
        return (vx - wx, vy - wy, rax, ray, rbx, rby)
    return arc_to_arc(a, b, wx, wy, branch, one_chord_apart)


@inner
def chord(a: Array, b: Array, d: float, alpha: float, branch: float) -> Chord:
    """The chord of length d in mm and direction alpha in radians; see ``chord_along``."""
    return chord_along(a, b, d * cos(alpha), d * sin(alpha), branch, are_one_chord_apart(a, b, d))


@inner
def direction_at(row: Array, x: float, y: float) -> tuple[float, float]:
    """Direction of a contact at a point on a feature: the normal of a line, the unit vector from an arc's
    centre."""
    if row[IS_ARC] == 0.0:
        return (row[AXIS_Y], -row[AXIS_X])
    return ((x - row[X]) / row[RADIUS], (y - row[Y]) / row[RADIUS])


@inner
def parameter_on(row: Array, x: float, y: float) -> float:
    """Parameter of a point on a feature: mm on a line, radians in (-pi, pi] on an arc."""
    if row[IS_ARC] == 0.0:
        return (x - row[X]) * row[AXIS_X] + (y - row[Y]) * row[AXIS_Y]
    return angle_on(row, x, y)


@inner
def distance_to_end(row: Array, s: float) -> float:
    """Distance in mm along a feature from a parameter to the nearer end; negative beyond it.

    A whole circle has no end: half its circumference is given, the farthest that a contact could be from any
    point.
    """
    if row[IS_ARC] == 0.0:
        return row[HALF_EXTENT] - abs(s)
    return pi * row[RADIUS] if row[HALF_EXTENT] >= pi else (row[HALF_EXTENT] - abs(s)) * row[RADIUS]


@inner
def end_slack(row: Array, x: float, y: float) -> float:
    """How far in mm a contact on a feature is from breaking the rule of ends; infinite on a whole circle,
    which has none.

    ``row`` has ten entries.
    """
    if row[IS_ARC] != 0.0 and row[HALF_EXTENT] >= pi:
        return inf
    s, half = parameter_on(row, x, y), row[HALF_EXTENT]
    scale = 1.0 if row[IS_ARC] == 0.0 else row[RADIUS]
    # Where a zone cut the feature, the farther end may be the one whose margin is broken.
    return min((half - s) * scale + row[HIGH_SLACK], (half + s) * scale + row[LOW_SLACK])


@inner
def backward_error(a: Array, b: Array, d: float) -> float:
    """Bound in mm of how far rounding puts the contacts of a computed chord off their features."""
    if (is_shallow(a) or is_shallow(b)) and not are_one_chord_apart(a, b, d):
        apart = hypot(a[X] - b[X], a[Y] - b[Y]) if are_concentric(a, b) else 0.0
        return ROUNDINGS * (local_size(a) + local_size(b) + d) + apart
    size = abs(a[X]) + abs(a[Y]) + abs(b[X]) + abs(b[Y]) + a[RADIUS] + b[RADIUS] + d
    if a[IS_ARC] == 0.0 and b[IS_ARC] == 0.0:
        # Nearly parallel lines are touched far from their middles.
        size = min(
            size / abs(a[AXIS_X] * b[AXIS_Y] - a[AXIS_Y] * b[AXIS_X]), size + a[HALF_EXTENT] + b[HALF_EXTENT]
        )
    spread = 1.0
    if a[IS_ARC] != 0.0 and b[IS_ARC] != 0.0:
        # The head's distance is found from that of the tail: an error grows with the ratio of radii.
        spread = max(a[RADIUS] / b[RADIUS], b[RADIUS] / a[RADIUS])
        if are_concentric(a, b):
            return ROUNDINGS * size * spread + hypot(a[X] - b[X], a[Y] - b[Y])
    return ROUNDINGS * size * spread


@inner
def curvature(row: Array) -> float:
    """How fast in 1 / mm the unit vector towards a contact turns when the contact moves off or along its
    feature."""
    return 0.0 if row[IS_ARC] == 0.0 else 1.0 / row[RADIUS]


@inner
def regular_error(curve: Array) -> float:
    """Bound in mm of the error of a tail found by the regular formulas near a coincidence."""
    return 2.0 * curve[BACKWARD_ERROR] + 4.0 * EXACT


@inner
def write_shift(row: Array, shift: float) -> None:
    """Writes to a row of the curve table what depends on the lattice step: arg Delta in radians (psi = alpha
    - shift)."""
    row[SHIFT], row[COSINE], row[SINE] = shift, cos(shift), sin(shift)


@inner
def write_curve(row: Array, a: Array, b: Array, d: float, branch: float, shift: float) -> None:
    """Writes to a row of the curve table what does not change along the curve.

    Parameters
    ----------
    d, branch : length in mm and branch of the chord from feature a to feature b.
    shift : arg Delta in radians, so that psi = alpha - shift.
    """
    row[LENGTH], row[BRANCH] = d, branch
    write_shift(row, shift)
    row[BACKWARD_ERROR] = backward_error(a, b, d)
    row[COINCIDENCE], row[MIDDLE], row[SIDE] = coincidence(a, b, d)
    row[KAPPA] = curvature(a) + curvature(b)
    if are_concentric(a, b):
        row[COINCIDENCE] = CONCENTRIC


@inner
def chord_state(a: Array, b: Array, curve: Array, psi: float, cosine: float, sine: float) -> State:
    """A chord of a curve at an orientation.

    Parameters
    ----------
    a, b : (8,) rows of the features of tail and head.
    curve : row of the curve table.
    psi, cosine, sine : orientation in radians and its cosine and sine.

    Returns
    -------
    (ux, uy, r_ax, r_ay, r_bx, r_by, Px, Py, bound of the tail's error in mm, bound of the error of P over the
    chord's own directions). The errors are infinite where these formulas do not bound them, too near a
    tangency
    """
    d = curve[LENGTH]
    wx = d * (cosine * curve[COSINE] - sine * curve[SINE])
    wy = d * (sine * curve[COSINE] + cosine * curve[SINE])
    kappa, kind = curve[KAPPA], curve[COINCIDENCE]
    if kind != NONE and kind != CONCENTRIC:
        regular, u = motion(a, b, curve, psi)
        if regular:
            rax, ray = direction_at(a, u[0], u[1])
            rbx, rby = direction_at(b, u[0] + wx, u[1] + wy)
            error = regular_error(curve) + misfit(a, b, curve, rax * rby - ray * rbx)
            slope_error = error * (1.0 + d * kappa)
            return (u[0], u[1], rax, ray, rbx, rby, u[0] - u[3], u[1] + u[2], error, slope_error)
    c = chord_along(a, b, wx, wy, curve[BRANCH], kind == ARCS)
    turn = c[2] * c[5] - c[3] * c[4]
    if kind == CONCENTRIC:
        p = -a[RADIUS]
    elif turn != 0.0:
        p = (wx * c[5] - wy * c[4]) / turn
    else:
        p = 0.0
    eta, square = curve[BACKWARD_ERROR], turn * turn
    error, slope_error = inf, inf
    if square >= 16.0 * kappa * eta and square > 0.0:
        inverse = 1.0 / abs(turn)
        error = 6.0 * eta * inverse
        slope_error = 8.0 * eta * inverse * inverse * (1.0 + kappa * (d + 2.0 * abs(p)))
    return (c[0], c[1], c[2], c[3], c[4], c[5], c[0] + p * c[2], c[1] + p * c[3], error, slope_error)


@inner
def valued(
    a: Array, b: Array, state: State, cosine: float, sine: float, mode: float
) -> tuple[float, float, float, float]:
    """Value and derivative over psi of a chord in place, and bounds of their errors; see ``curve_value``."""
    ux, uy, px, py = state[0], state[1], state[6], state[7]
    if mode == HEIGHT:
        doubt = state[9]
        if a[IS_ARC] + b[IS_ARC] == 1.0:
            # P lies on the line of action through the straight feature, which turns with nothing: of its
            # error along that line only the part along x counts.
            nx, ny = (state[2], state[3]) if a[IS_ARC] == 0.0 else (state[4], state[5])
            share = abs(cosine * nx + sine * ny)
            doubt = min(doubt, state[8] + share * (doubt + state[8]))
        return (cosine * uy - sine * ux, -(cosine * px + sine * py), state[8], doubt)
    s = parameter_on(a, ux, uy)
    p = (px - ux) * state[2] + (py - uy) * state[3]
    if a[IS_ARC] == 0.0:
        return (s, -p, state[8], state[9])
    return (s, -p / a[RADIUS], state[8] / a[RADIUS] + 1e-15, state[9] / a[RADIUS])


@inner
def curve_value(
    a: Array, b: Array, curve: Array, psi: float, mode: float
) -> tuple[float, float, float, float]:
    """Value and derivative over psi of a chord curve.

    Parameters
    ----------
    curve : row of the curve table.
    psi : orientation in radians.
    mode : ``HEIGHT`` for h in mm, ``POSITION`` for s of the tail on a (mm on a line, radians on an arc).

    Returns
    -------
    (value, derivative, bound of the value's error, bound of the derivative's error), the errors infinite
    where these formulas do not bound them, too near a tangency
    """
    cosine, sine = cos(psi), sin(psi)
    return valued(a, b, chord_state(a, b, curve, psi, cosine, sine), cosine, sine, mode)
