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
The bounds of ``compute_chord_state`` are a little wider.

Reference: J. M. Ortega, "The Newton-Kantorovich theorem", American Mathematical Monthly 75 (1968) 658-660.
"""

from __future__ import annotations

from math import cos, hypot, inf, isfinite, pi, sin, sqrt
from typing import NamedTuple

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
    compute_local_size,
    find_arc_parameter,
    is_shallow,
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
    bound_misfit,
    compute_motion,
    find_coincidence,
)
from workhold.kernels.chord.shallow import Chord, compute_line_to_shallow, compute_shallow_to_arc


class ChordState(NamedTuple):
    """A chord of a curve at one orientation, with its instant centre and bounds of its errors.

    Parameters
    ----------
    x, y : the chord's tail in mm.
    ax, ay : unit contact direction at the tail: the normal of a line, the direction from an arc's centre.
    bx, by : the same at the head.
    center_x, center_y : the instant centre P in mm.
    error : bound in mm of the error of the tail; inf where nothing is known, too near a tangency.
    center_error : bound in mm of the error of P, over the chord's own directions; inf likewise.
    off : bound in mm of how far the computed contacts are off their features.
    """

    x: float
    y: float
    ax: float
    ay: float
    bx: float
    by: float
    center_x: float
    center_y: float
    error: float
    center_error: float
    off: float


class CurvePoint(NamedTuple):
    """Value and derivative over psi of a curve at one orientation, and bounds of their errors.

    The errors are inf where nothing is known, too near a tangency.
    """

    value: float
    slope: float
    error: float
    slope_error: float


# Which value of a curve is meant. (For every whole number written as such kernels are compiled anew.)
HEIGHT = 0.0
POSITION = 1.0

# Roundings of half a unit in the last place that add up to a contact's distance from its feature, generously
# counted: those of the angle (of up to 9 radians), of its sine and cosine, and of a dozen sums and products.
ROUNDINGS = 32.0 * 1.2e-16


@inner
def compute_line_to_arc(a: Array, b: Array, wx: float, wy: float, branch: float) -> Chord:
    """Return the chord w, with its tail on line ``a`` and its head on arc ``b``, in the form of
    :func:`compute_chord_along`.

    The head lies where the line, moved by w, meets the circle of ``b``. See ``base.feature`` for the layout
    of ``a`` and ``b``.
    """
    if is_shallow(b):
        return compute_line_to_shallow(a, b, wx, wy, branch)
    nx, ny = a[AXIS_Y], -a[AXIS_X]
    across = nx * (a[X] + wx - b[X]) + ny * (a[Y] + wy - b[Y])
    half = sqrt(max((b[RADIUS] - across) * (b[RADIUS] + across), 0.0)) * branch
    rx, ry = across * nx + half * a[AXIS_X], across * ny + half * a[AXIS_Y]
    return Chord(b[X] + rx - wx, b[Y] + ry - wy, nx, ny, rx / b[RADIUS], ry / b[RADIUS])


@inner
def compute_arc_to_arc(
    a: Array, b: Array, wx: float, wy: float, branch: float, one_chord_apart: bool
) -> Chord:
    """Return the chord w, with its tail on arc ``a`` and its head on arc ``b``, in the form of
    :func:`compute_chord_along`.

    The tail lies where the circle of ``a`` meets the circle of ``b`` moved by -w. See ``base.feature`` for
    the layout of ``a`` and ``b``.
    """
    if (is_shallow(a) or is_shallow(b)) and not one_chord_apart:
        return compute_shallow_to_arc(a, b, wx, wy, branch)
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
    return Chord(a[X] + rx, a[Y] + ry, rx / a[RADIUS], ry / a[RADIUS], qx / b[RADIUS], qy / b[RADIUS])


@inner
def compute_chord_along(
    a: Array, b: Array, wx: float, wy: float, branch: float, one_chord_apart: bool
) -> Chord:
    """Return the tail and the two contact directions of a chord w from feature a to feature b.

    The features count as whole lines and circles. Where no chord w fits between these, the nearest chord at a
    tangency is given. See ``base.feature`` for the layout of ``a`` and ``b``.

    Parameters
    ----------
    a, b : rows of the features of tail and head.
    wx, wy : the chord in mm.
    branch : 1 or -1 where an arc takes part; ignored between lines.
    one_chord_apart : whether the features are equal arcs with centres one chord length apart.

    Returns
    -------
    (ux, uy, r_ax, r_ay, r_bx, r_by): tail in mm, and unit contact directions at tail and head
    """
    if a[IS_ARC] == 0.0:
        if b[IS_ARC] != 0.0:
            return compute_line_to_arc(a, b, wx, wy, branch)
        nx, ny = b[AXIS_Y], -b[AXIS_X]
        s = (nx * (b[X] - a[X] - wx) + ny * (b[Y] - a[Y] - wy)) / (nx * a[AXIS_X] + ny * a[AXIS_Y])
        return Chord(a[X] + s * a[AXIS_X], a[Y] + s * a[AXIS_Y], a[AXIS_Y], -a[AXIS_X], nx, ny)
    if b[IS_ARC] == 0.0:
        vx, vy, rbx, rby, rax, ray = compute_line_to_arc(b, a, -wx, -wy, branch)
        return Chord(vx - wx, vy - wy, rax, ray, rbx, rby)
    return compute_arc_to_arc(a, b, wx, wy, branch, one_chord_apart)


@inner
def compute_chord(a: Array, b: Array, d: float, alpha: float, branch: float) -> Chord:
    """Return the chord of length d in mm and direction alpha in radians, in the form of
    :func:`compute_chord_along`.

    See ``base.feature`` for the layout of ``a`` and ``b``.
    """
    return compute_chord_along(a, b, d * cos(alpha), d * sin(alpha), branch, are_one_chord_apart(a, b, d))


@inner
def compute_contact_direction(row: Array, x: float, y: float) -> tuple[float, float]:
    """Return the contact direction (x, y) at a point on a feature: a
    line's normal, the unit vector from an arc's centre.

    See ``base.feature`` for the layout of ``row``.
    """
    if row[IS_ARC] == 0.0:
        return (row[AXIS_Y], -row[AXIS_X])
    return ((x - row[X]) / row[RADIUS], (y - row[Y]) / row[RADIUS])


@inner
def find_parameter(row: Array, x: float, y: float) -> float:
    """Return the parameter of a point on a feature: mm on a line,
    radians in [-pi, pi] on an arc, 0 at its middle.

    See ``base.feature`` for the layout of ``row``.
    """
    if row[IS_ARC] == 0.0:
        return (x - row[X]) * row[AXIS_X] + (y - row[Y]) * row[AXIS_Y]
    return find_arc_parameter(row, x, y)


@inner
def measure_end_distance(row: Array, s: float) -> float:
    """Return the distance in mm along a feature from the parameter s
    to the nearer end; negative beyond an end.

    A whole circle has no end: half its circumference is given, the farthest that a contact could be from any
    point. See ``base.feature`` for the layout of ``row``.
    """
    if row[IS_ARC] == 0.0:
        return row[HALF_EXTENT] - abs(s)
    return pi * row[RADIUS] if row[HALF_EXTENT] >= pi else (row[HALF_EXTENT] - abs(s)) * row[RADIUS]


@inner
def measure_end_slack(row: Array, x: float, y: float) -> float:
    """Return the least distance in mm along a feature from a contact to an end, plus that end's slack.

    The contact breaks the rule of ends where this is below the margin. Return inf on a whole circle, which
    has no ends. ``row`` is a feature row (12,) with LOW_SLACK and HIGH_SLACK. See ``base.feature`` for the
    layout of ``row``.
    """
    if row[IS_ARC] != 0.0 and row[HALF_EXTENT] >= pi:
        return inf
    s, half = find_parameter(row, x, y), row[HALF_EXTENT]
    scale = 1.0 if row[IS_ARC] == 0.0 else row[RADIUS]
    # Where a zone cut the feature, the farther end may be the one whose margin is broken.
    return min((half - s) * scale + row[HIGH_SLACK], (half + s) * scale + row[LOW_SLACK])


@inner
def bound_backward_error(a: Array, b: Array, d: float) -> float:
    """Return a bound in mm of how far rounding puts the contacts of a computed chord off their features.

    See ``base.feature`` for the layout of ``a`` and ``b``.
    """
    if (is_shallow(a) or is_shallow(b)) and not are_one_chord_apart(a, b, d):
        apart = hypot(a[X] - b[X], a[Y] - b[Y]) if are_concentric(a, b) else 0.0
        return ROUNDINGS * (compute_local_size(a) + compute_local_size(b) + d) + apart
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
def compute_curvature(row: Array) -> float:
    """Return the curvature of a feature in 1 / mm: 0 for a line, 1 / R for an arc.

    See ``base.feature`` for the layout of ``row``.
    """
    return 0.0 if row[IS_ARC] == 0.0 else 1.0 / row[RADIUS]


@inner
def bound_regular_error(curve: Array) -> float:
    """Return a bound in mm of the error of a tail that the regular formulas for coincidences compute.

    See ``chord.coincidences`` for these formulas, ``base.tables`` for the layout of ``curve``.
    """
    return 2.0 * curve[BACKWARD_ERROR] + 4.0 * EXACT


@inner
def write_shift(row: Array, shift: float) -> None:
    """Write SHIFT, COSINE and SINE to a curve's reals (16,), which depend on the lattice step.

    ``shift`` is arg Delta in radians (psi = alpha - shift). See ``base.tables`` for the layout of ``row``.
    Symbols are those of ``chord.evaluation``.
    """
    row[SHIFT], row[COSINE], row[SINE] = shift, cos(shift), sin(shift)


@inner
def write_curve(row: Array, a: Array, b: Array, d: float, branch: float, shift: float) -> None:
    """Write to a curve's reals (16,) all that does not change along the curve, except its range of alpha.

    See ``base.tables`` for the layout of ``row``, ``base.feature`` for that of ``a`` and ``b``. Symbols are
    those of ``chord.evaluation``.

    Parameters
    ----------
    d, branch : length in mm and branch of the chord from feature a to feature b.
    shift : arg Delta in radians, so that psi = alpha - shift.
    """
    row[LENGTH], row[BRANCH] = d, branch
    write_shift(row, shift)
    row[BACKWARD_ERROR] = bound_backward_error(a, b, d)
    row[COINCIDENCE], row[MIDDLE], row[SIDE] = find_coincidence(a, b, d)
    row[KAPPA] = compute_curvature(a) + compute_curvature(b)
    if are_concentric(a, b):
        row[COINCIDENCE] = CONCENTRIC


@inner
def compute_chord_state(
    a: Array, b: Array, curve: Array, psi: float, cosine: float, sine: float
) -> ChordState:
    """Return a chord of a curve at an orientation.

    See ``base.feature`` for the layout of ``a`` and ``b``, ``base.tables`` for that of ``curve``. Symbols are
    those of ``chord.evaluation``.

    Parameters
    ----------
    a, b : rows of the features of tail and head.
    curve : reals (16,) of the curve.
    psi, cosine, sine : orientation in radians and its cosine and sine.

    Returns
    -------
    ChordState
    """
    d = curve[LENGTH]
    wx = d * (cosine * curve[COSINE] - sine * curve[SINE])
    wy = d * (sine * curve[COSINE] + cosine * curve[SINE])
    kappa, kind = curve[KAPPA], curve[COINCIDENCE]
    if kind != NONE and kind != CONCENTRIC:
        regular, u = compute_motion(a, b, curve, psi)
        if regular:
            rax, ray = compute_contact_direction(a, u.x, u.y)
            rbx, rby = compute_contact_direction(b, u.x + wx, u.y + wy)
            error = bound_regular_error(curve) + bound_misfit(a, b, curve, rax * rby - ray * rbx)
            slope_error = error * (1.0 + d * kappa)
            px, py = u.x - u.speed_y, u.y + u.speed_x
            return ChordState(u.x, u.y, rax, ray, rbx, rby, px, py, error, slope_error, error)
    c = compute_chord_along(a, b, wx, wy, curve[BRANCH], kind == ARCS)
    turn = c.ax * c.by - c.ay * c.bx
    if kind == CONCENTRIC:
        p = -a[RADIUS]
    elif turn != 0.0:
        p = (wx * c.by - wy * c.bx) / turn
    else:
        p = 0.0
    eta, square = curve[BACKWARD_ERROR], turn * turn
    error, slope_error = inf, inf
    if square >= 16.0 * kappa * eta and square > 0.0:
        inverse = 1.0 / abs(turn)
        error = 6.0 * eta * inverse
        slope_error = 8.0 * eta * inverse * inverse * (1.0 + kappa * (d + 2.0 * abs(p)))
    px, py = c.x + p * c.ax, c.y + p * c.ay
    return ChordState(c.x, c.y, c.ax, c.ay, c.bx, c.by, px, py, error, slope_error, eta)


@inner
def evaluate_state(
    a: Array, b: Array, state: ChordState, cosine: float, sine: float, mode: float
) -> CurvePoint:
    """Return the point of a curve that belongs to a computed chord.

    ``state`` is that of :func:`compute_chord_state`; see :func:`evaluate_curve` for ``mode`` and units. See
    ``base.feature`` for the layout of ``a`` and ``b``.
    """
    ux, uy, px, py = state.x, state.y, state.center_x, state.center_y
    if mode == HEIGHT:
        error, doubt = state.error, state.center_error
        if a[IS_ARC] + b[IS_ARC] == 1.0 and isfinite(error):
            # P lies on the line of action through the straight feature, which turns with nothing: of its
            # error along that line only the part along x counts. The chord moves along the straight feature,
            # computed and exact alike but for what the contact is off it: of its error only the part along y
            # counts, which is as large.
            nx, ny = (state.ax, state.ay) if a[IS_ARC] == 0.0 else (state.bx, state.by)
            share = abs(cosine * nx + sine * ny)
            doubt = min(doubt, error + share * (doubt + error))
            error = min(error, share * error + 4.0 * state.off)
        return CurvePoint(cosine * uy - sine * ux, -(cosine * px + sine * py), error, doubt)
    s = find_parameter(a, ux, uy)
    p = (px - ux) * state.ax + (py - uy) * state.ay
    if a[IS_ARC] == 0.0:
        return CurvePoint(s, -p, state.error, state.center_error)
    return CurvePoint(s, -p / a[RADIUS], state.error / a[RADIUS] + 1e-15, state.center_error / a[RADIUS])


@inner
def evaluate_curve(a: Array, b: Array, curve: Array, psi: float, mode: float) -> CurvePoint:
    """Return the point of a chord curve at psi.

    See ``base.feature`` for the layout of ``a`` and ``b``, ``base.tables`` for that of ``curve``.

    Parameters
    ----------
    curve : reals (16,) of the curve.
    psi : orientation in radians.
    mode : ``HEIGHT`` for the height of the tail along the pegs' y axis in mm, ``POSITION`` for the tail's
        parameter on a (mm on a line, radians on an arc).
    """
    cosine, sine = cos(psi), sin(psi)
    return evaluate_state(a, b, compute_chord_state(a, b, curve, psi, cosine, sine), cosine, sine, mode)
