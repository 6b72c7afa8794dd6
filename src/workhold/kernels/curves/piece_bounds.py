"""Bounds of a piece of a chord curve: discs that hold its tails, the chords at its ends, and directions of
forces.

Glossary
--------
disc : holds the tails of a chord whose orientation is known to a radius only, tangencies included.
edge : a chord at an end of a piece, with what pieces need of it (see ``base.tables``). It serves the pieces
    on both of its sides, also where they are in neighbouring cells. It says for how long after it the curve's
    pegs stand too far along x for another peg to stand farther.
force direction : a direction in which the two pegs of a piece can push together.

Discs: let w be known to e = d reach + eta. Between a line and an arc of radius R, the head's distance from
the line's direction through the arc's centre, ``across``, is known to e. How far its square is from R^2 is
known to q = e (2 R + e), and the root of that, ``half``, to min(sqrt q, q / half). Between two arcs,
g = |c - w| is known to e and the direction of c - w to 1.6 e / g. With D = R_a^2 - R_b^2 so are

    along = (g + D / g) / 2   to  t = e / 2 (1 + |D| / (g (g - e))),
    half = sqrt(R_a^2 - along^2)  to  min(sqrt q, q / half),  q = t (2 R_a + t).

Near a coincidence the tail moves at no more than d + R + 3.2 sqrt(d R) < 2.6 (d + R). There d sin(gamma / 2)
<= 0.7 R between arcs, and d (1 - cos gamma) <= R between a line and an arc. Arcs that touch have a bound of
their own (see ``chord.coincidences``).

Forces: two pegs push together with a force F between the two directions in which each pushes. Where closing
clamps, F must point along +x for standing pegs, and moving pegs push with -F; where opening clamps it is the
other way round. Directions with positive x are given as y / (x + |y|), which grows from -1 to 1 with the
angle at a rate of at most 1.
"""

from __future__ import annotations

from math import cos, hypot, inf, isfinite, nan, sin, sqrt
from typing import NamedTuple

from workhold.conventions import EXACT
from workhold.kernels.base.compiling import Array, inner
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, RADIUS, SIGN, X, Y, is_shallow
from workhold.kernels.base.interval import TURN
from workhold.kernels.base.tables import (
    BACKWARD_ERROR,
    COINCIDENCE,
    EDGE_ACROSS,
    EDGE_ARM,
    EDGE_CENTER,
    EDGE_CENTER_ERROR,
    EDGE_ERROR,
    EDGE_SLOPE,
    EDGE_SLOPE_ERROR,
    EDGE_VALUE,
    EDGE_VALUE_ERROR,
    EDGE_X,
    HEAD_NORMAL_X,
    HEAD_NORMAL_Y,
    KAPPA,
    LEFTWARD_HIGH,
    LEFTWARD_LOW,
    LENGTH,
    MIDDLE,
    RIGHTWARD_HIGH,
    RIGHTWARD_LOW,
    SHIFT,
    SIDE,
    TAIL_NORMAL_X,
    TAIL_NORMAL_Y,
)
from workhold.kernels.chord.coincidences import (
    CONCENTRIC,
    NONE,
    TOUCHING,
    bound_misfit,
    bound_touching_speed,
    get_regular_radius,
    is_regular,
    measure_from_coincidence,
)
from workhold.kernels.chord.evaluation import (
    HEIGHT,
    ChordState,
    bound_regular_error,
    compute_chord_state,
    evaluate_state,
    find_parameter,
)
from workhold.kernels.chord.shallow import compute_shallow_half_chord


class Disc(NamedTuple):
    """A disc that holds a contact: its middle and its radius, in mm."""

    x: float
    y: float
    radius: float


@inner
def bound_tail_error(curve: Array, state: ChordState, reach: float) -> float:
    """Return how far in mm the exact tail may be from the computed
    one ``state`` if psi may be ``reach`` radians off.

    ``state`` is that of ``chord.evaluation.compute_chord_state``. Return inf too near a tangency, where the
    following bound does not hold. With d the chord's length, the tail moves at a speed of at most d / |X|.
    X^2 changes at a rate of at most 4 d kappa, here by no more than a quarter of itself. So the speed stays
    below 1.16 d / |X|, and the theorem of ``chord.evaluation`` holds with h <= 1 / 3. By it the tail is off
    by no more than 3 eta / |X|. See ``base.tables`` for the layout of ``curve``.
    """
    eta, d = curve[BACKWARD_ERROR], curve[LENGTH]
    kappa = curve[KAPPA]
    turn = abs(state.ax * state.by - state.ay * state.bx)
    square = turn * turn
    if square < 16.0 * kappa * eta or square < 16.0 * d * kappa * reach or turn == 0.0:
        return inf
    return 5.0 * eta / turn + 1.3 * d / turn * reach


@inner
def bound_root_error(square: float, doubt: float) -> float:
    """Return a bound of the error of the square root of ``square``, a number that may be off by ``doubt``.

    Negative numbers count as 0.
    """
    if square <= 0.0:
        return sqrt(doubt)
    return min(sqrt(doubt), doubt / sqrt(square))


@inner
def bound_arc_tail_error(a: Array, b: Array, state: ChordState, e: float, eta: float) -> float:
    """Return how far in mm a chord's tail on arc ``a`` may be from the computed tail, with the head on arc
    ``b``.

    ``state`` is the computed chord. The direction of the exact chord may move its head by up to ``e`` mm
    against the tail; the computed contacts are off their arcs by up to ``eta`` mm. See ``base.feature`` for
    the layout of ``a`` and ``b``. Symbols are those of ``chord.evaluation``.
    """
    gap = hypot(a[RADIUS] * state.ax - b[RADIUS] * state.bx, a[RADIUS] * state.ay - b[RADIUS] * state.by)
    if gap <= 2.0 * e:
        return 2.2 * a[RADIUS]
    difference = abs(a[RADIUS] - b[RADIUS]) * (a[RADIUS] + b[RADIUS])
    shift = e / 2.0 * (1.0 + difference / (gap * (gap - e)))
    along = (gap + (a[RADIUS] - b[RADIUS]) * (a[RADIUS] + b[RADIUS]) / gap) / 2.0
    square = (a[RADIUS] - along) * (a[RADIUS] + along)
    if is_shallow(a) or is_shallow(b):
        square = compute_shallow_half_chord(a, b, state.ax * state.by - state.ay * state.bx, gap) ** 2
    return (
        shift
        + eta
        + 1.01 * bound_root_error(square, shift * (2.0 * a[RADIUS] + shift))
        + 1.6 * a[RADIUS] * e / gap
    )


@inner
def bound_disc_radius(a: Array, b: Array, curve: Array, state: ChordState, psi: float, reach: float) -> float:
    """Return how far in mm the tails of a curve within ``reach``
    radians of psi may be from the computed one at psi.

    See ``base.feature`` for the layout of ``a`` and ``b``, ``base.tables`` for that of ``curve``.
    """
    d, eta, kind = curve[LENGTH], curve[BACKWARD_ERROR], curve[COINCIDENCE]
    if kind == CONCENTRIC:
        # The chord turns about the centre; nearly along a diameter its length is known better than its place.
        return a[RADIUS] * reach + bound_arc_tail_error(a, b, state, eta, eta)
    radius = get_regular_radius(a, b, kind)
    gamma = measure_from_coincidence(psi + curve[SHIFT], curve[MIDDLE])
    if is_regular(kind, radius, d, gamma - reach) and is_regular(kind, radius, d, gamma + reach):
        if kind == TOUCHING:
            off = bound_regular_error(curve) + bound_misfit(a, b, curve, 0.0)
            return off + bound_touching_speed(a, b, curve[SIDE], d) * reach
        return bound_regular_error(curve) + 2.6 * (d + radius) * reach
    e = d * reach + eta
    if is_regular(kind, radius, d, gamma):
        # The computed chord has exactly the lengths of the coincidence, others within reach have not.
        e += EXACT
        eta += bound_regular_error(curve)
    if a[IS_ARC] == 0.0 and b[IS_ARC] == 0.0:
        return 1.1 * e / abs(state.ax * state.by - state.ay * state.bx)
    if a[IS_ARC] == 0.0:
        half = b[RADIUS] * (a[AXIS_X] * state.bx + a[AXIS_Y] * state.by)
        return 2.0 * e + eta + 1.01 * bound_root_error(half * half, e * (2.0 * b[RADIUS] + e))
    if b[IS_ARC] == 0.0:
        half = a[RADIUS] * (b[AXIS_X] * state.ax + b[AXIS_Y] * state.ay)
        return 2.0 * e + eta + 1.01 * bound_root_error(half * half, e * (2.0 * a[RADIUS] + e))
    if is_shallow(a) and a[RADIUS] > b[RADIUS]:
        # Seen from the smaller circle, the contact on the larger one is known better.
        seen = ChordState(0.0, 0.0, state.bx, state.by, state.ax, state.ay, 0.0, 0.0, 0.0, 0.0, 0.0)
        return e + bound_arc_tail_error(b, a, seen, e, eta)
    return bound_arc_tail_error(a, b, state, e, eta)


@inner
def enclose_tail(a: Array, b: Array, curve: Array, psi: float, reach: float) -> Disc:
    """Return a disc that holds the tails of a
    curve for all orientations within ``reach`` of psi.

    ``a`` and ``b`` are the features of tail and head, ``curve`` the reals (16,) of the curve; angles are in
    radians. See ``base.feature`` for the layout of ``a`` and ``b``, ``base.tables`` for that of ``curve``.
    """
    state = compute_chord_state(a, b, curve, psi, cos(psi), sin(psi))
    return Disc(state.x, state.y, bound_disc_radius(a, b, curve, state, psi, reach + 1e-15))


@inner
def compute_tail(
    a: Array, b: Array, curve: Array, psi: float, cosine: float, sine: float, reach: float
) -> Disc:
    """Return the disc of a chord's tail: the computed
    tail, and how far the exact one may be from it.

    The orientation psi, given with its cosine and sine, is off by up to ``reach`` radians. As only tails on
    their feature matter, the radius is cut to about the feature's size. See ``base.feature`` for the layout
    of ``a`` and ``b``, ``base.tables`` for that of ``curve``.
    """
    state = compute_chord_state(a, b, curve, psi, cosine, sine)
    radius = bound_tail_error(curve, state, reach)
    coincides = curve[COINCIDENCE] != NONE
    if coincides:
        radius += bound_regular_error(curve) + bound_misfit(
            a, b, curve, state.ax * state.by - state.ay * state.bx
        )
    if coincides or not isfinite(radius):
        radius = min(radius, bound_disc_radius(a, b, curve, state, psi, reach + 1e-15))
    # A tail that counts is on its feature.
    if a[IS_ARC] != 0.0:
        return Disc(state.x, state.y, min(radius, 2.2 * a[RADIUS]))
    if radius <= 2.2 * a[HALF_EXTENT]:
        return Disc(state.x, state.y, radius)
    return Disc(a[X], a[Y], 1.1 * a[HALF_EXTENT])


@inner
def enclose_value(
    a: Array, b: Array, curve: Array, psi: float, reach: float, mode: float
) -> tuple[float, float]:
    """Return (value, doubt): the values of a curve within ``reach`` radians of psi differ from ``value`` by
    at most ``doubt``.

    ``mode`` is HEIGHT (values in mm) or POSITION (parameter of the tail on ``a``, mm or radians). See
    ``base.feature`` for the layout of ``a`` and ``b``, ``base.tables`` for that of ``curve``.
    """
    x, y, radius = enclose_tail(a, b, curve, psi, reach)
    if mode == HEIGHT:
        return (cos(psi) * y - sin(psi) * x, radius + (abs(x) + abs(y) + radius) * reach)
    if a[IS_ARC] == 0.0:
        return (find_parameter(a, x, y), radius)
    # From an arc's centre a disc of up to half its radius R is seen under 1.1 radius / R to either side.
    return (find_parameter(a, x, y), 1.1 * radius / a[RADIUS] if radius <= 0.5 * a[RADIUS] else TURN)


# Rounding of an orientation in radians.
SAME = 2e-15
# Rounding of places in mm, generously counted.
HAIR = 1e-6


@inner
def clear_edges(kept: Array) -> None:
    """Set ``kept`` (M, 15) to NaN, which means that no edge of any of M member curves is written yet.

    A row of ``kept`` holds the edge (14 columns) that was written last for a member curve, then the edge's
    psi. Neighbouring cells, worked on in ascending order and in one mode, share these edges.
    """
    for k in range(kept.shape[0]):
        for n in range(kept.shape[1]):
            kept[k, n] = nan


@inner
def write_edge(
    edge: Array, a: Array, b: Array, curve: Array, psi: float, cosine: float, sine: float, mode: float
) -> None:
    """Write a chord at one end of a piece to ``edge`` (14,), with the
    columns EDGE_... and normals of ``base.tables``.

    ``psi`` is the orientation in radians, given with its cosine and sine; ``mode`` is HEIGHT or POSITION. See
    ``base.feature`` for the layout of ``a`` and ``b``.
    """
    state = compute_chord_state(a, b, curve, psi, cosine, sine)
    edge[EDGE_VALUE], edge[EDGE_SLOPE], edge[EDGE_VALUE_ERROR], edge[EDGE_SLOPE_ERROR] = evaluate_state(
        a, b, state, cosine, sine, mode
    )
    edge[EDGE_X] = cosine * state.x + sine * state.y
    px, py, ax, ay = state.center_x, state.center_y, state.center_x - state.x, state.center_y - state.y
    edge[EDGE_CENTER] = sqrt(px * px + py * py)
    edge[EDGE_ARM] = sqrt(ax * ax + ay * ay) + curve[LENGTH]
    edge[EDGE_ERROR] = state.error
    edge[EDGE_ACROSS] = cosine * py - sine * px
    edge[EDGE_CENTER_ERROR] = state.center_error
    side_a = 1.0 if a[IS_ARC] == 0.0 else a[SIGN]
    side_b = 1.0 if b[IS_ARC] == 0.0 else b[SIGN]
    edge[TAIL_NORMAL_X] = side_a * (cosine * state.ax + sine * state.ay)
    edge[TAIL_NORMAL_Y] = side_a * (cosine * state.ay - sine * state.ax)
    edge[HEAD_NORMAL_X] = side_b * (cosine * state.bx + sine * state.by)
    edge[HEAD_NORMAL_Y] = side_b * (cosine * state.by - sine * state.bx)


@inner
def is_farther(edge: Array, at: float, right: float, speed: float, farthest: float) -> bool:
    """Return whether all tails of a curve, for psi from ``at`` to ``right``, are certainly right of x =
    ``farthest`` mm.

    ``edge`` is the curve's edge at psi = ``at``; ``speed`` bounds how fast the instant centre P moves between
    ``at`` and ``right``, in mm per radian.

    The tail's place along x has a slope of at most |P|, and |P| grows by no more than the speed. The test
    allows at least the slack of a piece's own bound of its place (see ``pieces.write_steady``), so it leaves
    out nothing that the piece's bound would keep. See ``base.tables`` for the layout of ``edge``. Symbols are
    those of ``chord.evaluation``.
    """
    width = right - at
    center = edge[EDGE_CENTER] + edge[EDGE_CENTER_ERROR] + 2.0 * speed * width
    away = center * width + (center + speed) * width * width / 8.0
    return edge[EDGE_X] - away - 2.0 * edge[EDGE_ERROR] - HAIR > farthest


# Rounding of directions, places in mm and slopes, generously counted.
DIRECTION_HAIR = 1e-9
# Directions of sums of two normals are given only if the normals turn by less than this, in radians.
LITTLE_TURN = 0.3


@inner
def project_direction(x: float, y: float) -> float:
    """Return y / (x + abs(y)), which encodes a direction with positive x as a number from -1 to 1."""
    return y / (x + abs(y))


@inner
def find_force_range(ax: float, ay: float, bx: float, by: float, doubt: float) -> tuple[float, float]:
    """Return (low, high), the range of encoded directions with positive x between two directions; (1, -1) for
    none.

    The directions (ax, ay) and (bx, by) are unit vectors known to ``doubt`` radians; see
    :func:`project_direction` for the encoding. Where they are nearly opposite, so that it is in doubt which
    side is "between", return (-1, 1), all directions.
    """
    turn = ax * by - ay * bx
    if ax * bx + ay * by < 0.0 and abs(turn) <= doubt + DIRECTION_HAIR:
        return (-1.0, 1.0)
    ax, bx = ax + doubt, bx + doubt
    if ax <= 0.0 and bx <= 0.0:
        return (1.0, -1.0)
    if ax > 0.0 and bx > 0.0:
        one, two = project_direction(ax, ay), project_direction(bx, by)
        return (min(one, two), max(one, two))
    if ax > 0.0:
        return (project_direction(ax, ay), 1.0) if turn > 0.0 else (-1.0, project_direction(ax, ay))
    return (-1.0, project_direction(bx, by)) if turn > 0.0 else (project_direction(bx, by), 1.0)


@inner
def find_shared_force_range(
    ax: float, ay: float, bx: float, by: float, share: float, doubt: float
) -> tuple[float, float]:
    """Return the encoded range (low, high) of the directions of sums p a + q b of two unit vectors a and b.

    Of the non-negative factors p and q, neither is less than ``share`` times the other; a = (ax, ay) and b =
    (bx, by) are known to ``doubt`` radians. See :func:`find_force_range` for the encoding, and for no range.
    """
    if share <= 0.0:
        return find_force_range(ax, ay, bx, by, doubt)
    px, py, qx, qy = ax + share * bx, ay + share * by, bx + share * ax, by + share * ay
    one, two = sqrt(px * px + py * py), sqrt(qx * qx + qy * qy)
    return find_force_range(px / one, py / one, qx / two, qy / two, doubt)


@inner
def is_sum_long(edge: Array, share: float) -> bool:
    """Return whether the sum of one normal of an edge and ``share`` times its other normal is at least 0.5
    long.

    See ``base.tables`` for the layout of ``edge``.
    """
    cosine = edge[TAIL_NORMAL_X] * edge[HEAD_NORMAL_X] + edge[TAIL_NORMAL_Y] * edge[HEAD_NORMAL_Y]
    return 1.0 + 2.0 * share * cosine + share * share >= 0.25


@inner
def bound_normal_turn(low: Array, high: Array) -> float:
    """Return an upper bound in radians of the angle between the normals at both ends of a piece.

    ``low`` and ``high`` are the edges. The bound holds when the normals turn by less than 1 radian. See
    ``base.tables`` for the layout of ``low`` and ``high``.
    """
    tail_x, tail_y = high[TAIL_NORMAL_X] - low[TAIL_NORMAL_X], high[TAIL_NORMAL_Y] - low[TAIL_NORMAL_Y]
    head_x, head_y = high[HEAD_NORMAL_X] - low[HEAD_NORMAL_X], high[HEAD_NORMAL_Y] - low[HEAD_NORMAL_Y]
    # A chord of up to 1 radian is no shorter than 0.95 times its arc.
    return 1.06 * sqrt(max(tail_x * tail_x + tail_y * tail_y, head_x * head_x + head_y * head_y))


@inner
def write_force_directions(row: Array, low: Array, high: Array, share: float, turned: float) -> None:
    """Write enclosures of the force directions of a piece's pegs, from the normals at its ends, to ``row``.

    The columns are RIGHTWARD_LOW to LEFTWARD_HIGH; ``low`` and ``high`` are the edges. ``turned`` bounds in
    radians how far a normal sags from its interpolation between the ends.

    Inside a curve X keeps its sign, so the normals do not pass through opposite directions. The lowest and
    the highest direction occur where a force is at an end of the piece, or square to x. So the hull of both
    ends is given, widened by as much as directions may sag between them. With a ``share`` (see
    :func:`find_shared_force_range`) the directions are of sums p of two normals. Normals turn at a rate that
    changes by at most 8 turned / w^2, so w times the rate is at most the turn from end to end and 4 turned.
    Then p is off its interpolation by abs(p'') w^2 / 8, which is at most turn^2 / 4 + 2 turned. As p is
    nowhere shorter than 0.4, its direction is off by at most 2.6 times that. See ``base.tables`` for the
    layout of ``row``, ``low`` and ``high``. Symbols are those of ``chord.evaluation``.
    """
    write_hull(row, low, high, 0.0, turned)
    turn = bound_normal_turn(low, high) + 4.0 * turned
    if share <= 0.0 or turn > LITTLE_TURN or not (is_sum_long(low, share) and is_sum_long(high, share)):
        return
    wide = row[RIGHTWARD_LOW], row[RIGHTWARD_HIGH], row[LEFTWARD_LOW], row[LEFTWARD_HIGH]
    write_hull(row, low, high, share, 2.6 * (2.0 * turned + turn * turn / 4.0))
    # Both are bounds.
    row[RIGHTWARD_LOW], row[RIGHTWARD_HIGH] = (
        max(row[RIGHTWARD_LOW], wide[0]),
        min(row[RIGHTWARD_HIGH], wide[1]),
    )
    row[LEFTWARD_LOW], row[LEFTWARD_HIGH] = (
        max(row[LEFTWARD_LOW], wide[2]),
        min(row[LEFTWARD_HIGH], wide[3]),
    )


@inner
def write_hull(row: Array, low: Array, high: Array, share: float, doubt: float) -> None:
    """Write the smallest range that holds the force directions at both ends of a piece, widened by ``doubt``
    radians.

    It goes to the columns RIGHTWARD_LOW to LEFTWARD_HIGH of ``row``; (2, -2) where there are no directions.
    ``low`` and ``high`` are the edges of the piece; ``share`` is described at
    :func:`find_shared_force_range`. See ``base.tables`` for the layout of ``row``, ``low`` and ``high``.
    """
    at_ends, between = 2.0 * doubt, 4.0 * doubt + DIRECTION_HAIR
    for k in range(2):
        # Pegs push against the outward normals: rightward as given, leftward as the opposite.
        sign = -1.0 if k == 0 else 1.0
        bottom, top = find_edge_force_range(low, sign, share, at_ends)
        first, last = find_edge_force_range(high, sign, share, at_ends)
        row[RIGHTWARD_LOW + 2 * k] = min(bottom, first) - between
        row[RIGHTWARD_HIGH + 2 * k] = max(top, last) + between
        if bottom > top and first > last:
            row[RIGHTWARD_LOW + 2 * k], row[RIGHTWARD_HIGH + 2 * k] = 2.0, -2.0
        elif bottom > top or first > last:
            row[RIGHTWARD_LOW + 2 * k], row[RIGHTWARD_HIGH + 2 * k] = -1.0, 1.0


@inner
def find_edge_force_range(edge: Array, sign: float, share: float, doubt: float) -> tuple[float, float]:
    """Return the result of :func:`find_shared_force_range` for the two normals of an edge, both multiplied by
    ``sign``.

    See ``base.tables`` for the layout of ``edge``.
    """
    ax, ay = sign * edge[TAIL_NORMAL_X], sign * edge[TAIL_NORMAL_Y]
    return find_shared_force_range(
        ax, ay, sign * edge[HEAD_NORMAL_X], sign * edge[HEAD_NORMAL_Y], share, doubt
    )


@inner
def write_all_force_directions(row: Array) -> None:
    """Set the columns RIGHTWARD_LOW to LEFTWARD_HIGH of a piece's row to the range of all directions.

    See ``base.tables`` for the layout of ``row``.
    """
    row[RIGHTWARD_LOW], row[RIGHTWARD_HIGH], row[LEFTWARD_LOW], row[LEFTWARD_HIGH] = -1.0, 1.0, -1.0, 1.0
