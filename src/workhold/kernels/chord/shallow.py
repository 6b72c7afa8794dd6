"""Chords between two features of which one or both are shallow arcs (see ``base.feature``), computed without
numbers of the size of the radius.

Let m be the arcs' middles, t their directions, k their curvatures and q = m_b - m_a. The law of cosines gives
the cosine xi of the angle between both contact directions of a chord w,

    1 - xi = |t_a - t_b|^2 / 2 + (q - w) . (k_b t_a - k_a t_b) + k_a k_b |q - w|^2 / 2,

so X^2 = (1 - xi) (1 + xi). Each factor is the sum of a constant and a multiple of cos(alpha - beta), where
beta is the direction from centre to centre. Between a line of normal n and an arc X^2 = tau^2 - k e (2 nu + k
e). Here nu and tau are the components of t along n and square to n, and e is how far the contact is from m
along n.
"""

from __future__ import annotations

from math import atan2, cos, hypot, sin
from typing import NamedTuple

from workhold.kernels.base.compiling import Array, inner
from workhold.kernels.base.feature import (
    AXIS_X,
    AXIS_Y,
    IS_ARC,
    RADIUS,
    X,
    Y,
    compute_exact_dot,
    find_arc_middle,
    intersect_near_middle,
)
from workhold.kernels.base.interval import (
    Interval,
    iadd,
    icos,
    imul,
    iscale,
    ishift,
    isqrt,
    isquare,
    isub,
    widen_outward,
)


class Chord(NamedTuple):
    """A chord from a feature a to a feature b.

    Parameters
    ----------
    x, y : its tail in mm.
    ax, ay : unit contact direction at the tail: the normal of a line, the direction from an arc's centre.
    bx, by : the same at the head.
    """

    x: float
    y: float
    ax: float
    ay: float
    bx: float
    by: float


@inner
def compute_line_to_shallow(a: Array, b: Array, wx: float, wy: float, branch: float) -> Chord:
    """Return the chord w from line ``a`` to the shallow arc ``b``, in the form of
    ``evaluation.compute_line_to_arc``.

    See ``base.feature`` for the layout of ``a`` and ``b``.
    """
    nx, ny = a[AXIS_Y], -a[AXIS_X]
    mx, my = find_arc_middle(b)
    off = nx * (a[X] + wx - mx) + ny * (a[Y] + wy - my)
    x, y, rx, ry = intersect_near_middle(
        b, nx, ny, compute_exact_dot(a[AXIS_X], a[AXIS_Y], b[AXIS_X], b[AXIS_Y]), off, branch
    )
    return Chord(mx + x - wx, my + y - wy, nx, ny, rx, ry)


@inner
def compute_shallow_to_arc(a: Array, b: Array, wx: float, wy: float, branch: float) -> Chord:
    """Return the chord w from arc ``a`` to arc ``b``, one or both shallow, in the form of
    ``evaluation.compute_arc_to_arc``.

    The tail lies where the circle of a meets the line on which both circles' equations agree. See
    ``base.feature`` for the layout of ``a`` and ``b``.
    """
    gx, gy = b[X] - a[X] - wx, b[Y] - a[Y] - wy
    gap = hypot(gx, gy)
    nx, ny = gx / gap, gy / gap
    ax, ay = find_arc_middle(a)
    bx, by = find_arc_middle(b)
    qx, qy = ax + wx - bx, ay + wy - by
    off = ((qx * qx + qy * qy) / 2.0 + b[RADIUS] * (qx * b[AXIS_X] + qy * b[AXIS_Y])) / gap
    # Cross products of c_b - w - c_a = R_a t_a - R_b t_b - q with t_a.
    across = (
        -(
            b[RADIUS] * compute_exact_dot(b[AXIS_X], -b[AXIS_Y], a[AXIS_Y], a[AXIS_X])
            + qx * a[AXIS_Y]
            - qy * a[AXIS_X]
        )
        / gap
    )
    x, y, rx, ry = intersect_near_middle(a, nx, ny, across, off, branch)
    return Chord(ax + x, ay + y, rx, ry, b[AXIS_X] + (x + qx) / b[RADIUS], b[AXIS_Y] + (y + qy) / b[RADIUS])


@inner
def split_direction(line: Array, arc: Array) -> tuple[float, float]:
    """Return (nu, tau), the components of an arc's direction along a line's normal and along the line.

    See ``base.feature`` for the layout of ``line`` and ``arc``. Symbols are those of ``chord.shallow``.
    """
    along = line[AXIS_Y] * arc[AXIS_X] - line[AXIS_X] * arc[AXIS_Y]
    return (along, compute_exact_dot(line[AXIS_X], line[AXIS_Y], arc[AXIS_X], arc[AXIS_Y]))


@inner
def compute_tangent_offset(line: Array, arc: Array) -> float:
    """Return e in mm at the tangency of a line and a shallow arc, on the near side of the arc.

    e is measured along the line's normal from the arc's middle; its size is R tau^2 / (1 + |nu|). See
    ``base.feature`` for the layout of ``line`` and ``arc``. Symbols are those of ``chord.shallow``.
    """
    along, across = split_direction(line, arc)
    off = arc[RADIUS] * across * across / (1.0 + abs(along))
    return off if along > 0.0 else -off


@inner
def does_shallow_chord_fit(a: Array, b: Array, wx: float, wy: float) -> bool:
    """Return whether a chord w fits between the whole lines or circles of two features, one of them a shallow
    arc.

    It fits where X^2 is positive. See ``base.feature`` for the layout of ``a`` and ``b``. Symbols are those
    of ``chord.shallow``.
    """
    if a[IS_ARC] != 0.0 and b[IS_ARC] != 0.0:
        near, far, swing, beta = enclose_arcs_cosine(a, b, hypot(wx, wy))
        part = swing * (wx * cos(beta) + wy * sin(beta)) / hypot(wx, wy)
        return near[0] / 2.0 + near[1] / 2.0 > part and far[0] / 2.0 + far[1] / 2.0 > -part
    line, arc = (a, b) if a[IS_ARC] == 0.0 else (b, a)
    mx, my = find_arc_middle(arc)
    sign = 1.0 if a[IS_ARC] == 0.0 else -1.0
    off = line[AXIS_Y] * (line[X] + sign * wx - mx) - line[AXIS_X] * (line[Y] + sign * wy - my)
    along, across = split_direction(line, arc)
    k = 1.0 / arc[RADIUS]
    return across * across > k * off * (2.0 * along + k * off)


@inner
def enclose_arcs_cosine(a: Array, b: Array, d: float) -> tuple[Interval, Interval, float, float]:
    """Return four terms of the cosine xi of the angle between the contact directions on two arcs.

    1 - xi = near - swing cos(alpha - beta), and 1 + xi = far + swing cos(alpha - beta). See ``base.feature``
    for the layout of ``a`` and ``b``. Symbols are those of ``chord.shallow``.

    Returns
    -------
    (enclosures of near and far, swing, beta in radians)
    """
    ax, ay = find_arc_middle(a)
    bx, by = find_arc_middle(b)
    ka, kb = 1.0 / a[RADIUS], 1.0 / b[RADIUS]
    # Middles and differences are rounded once or so.
    qx, qy = (
        isub(widen_outward(bx, bx), widen_outward(ax, ax)),
        isub(widen_outward(by, by), widen_outward(ay, ay)),
    )
    vx = isub(
        iscale(kb, widen_outward(a[AXIS_X], a[AXIS_X])), iscale(ka, widen_outward(b[AXIS_X], b[AXIS_X]))
    )
    vy = isub(
        iscale(kb, widen_outward(a[AXIS_Y], a[AXIS_Y])), iscale(ka, widen_outward(b[AXIS_Y], b[AXIS_Y]))
    )
    drift = iadd(imul(qx, vx), imul(qy, vy))
    bend = iscale(0.5 * ka * kb, ishift(d * d, iadd(isquare(qx), isquare(qy))))
    both = iadd(drift, bend)
    lx, ly = a[AXIS_X] - b[AXIS_X], a[AXIS_Y] - b[AXIS_Y]
    mx, my = a[AXIS_X] + b[AXIS_X], a[AXIS_Y] + b[AXIS_Y]
    less = iscale(0.5, iadd(isquare(widen_outward(lx, lx)), isquare(widen_outward(ly, ly))))
    more = iscale(0.5, iadd(isquare(widen_outward(mx, mx)), isquare(widen_outward(my, my))))
    swing = d * ka * kb * hypot(b[X] - a[X], b[Y] - a[Y])
    return (iadd(less, both), isub(more, both), swing, atan2(b[Y] - a[Y], b[X] - a[X]))


@inner
def enclose_shallow_turn(a: Array, b: Array, d: float, low: float, high: float) -> Interval:
    """Return an enclosure of abs(X) for alpha in [low, high] where an
    arc is shallow; see ``stretches.enclose_turn``.

    See ``base.feature`` for the layout of ``a`` and ``b``. Symbols are those of ``chord.shallow``.
    """
    if a[IS_ARC] != 0.0 and b[IS_ARC] != 0.0:
        near, far, swing, beta = enclose_arcs_cosine(a, b, d)
        part = imul(widen_outward(swing, swing), icos((low - beta, high - beta)))
        return isqrt(imul(isub(near, part), iadd(far, part)))
    line, arc = (a, b) if a[IS_ARC] == 0.0 else (b, a)
    mx, my = find_arc_middle(arc)
    fixed = iadd(
        iscale(line[AXIS_Y], isub(widen_outward(mx, mx), (line[X], line[X]))),
        iscale(-line[AXIS_X], isub(widen_outward(my, my), (line[Y], line[Y]))),
    )
    normal = atan2(-line[AXIS_X], line[AXIS_Y])
    # The contact's way from the arc's middle: w counts towards an arc that is touched by the head.
    sign = 1.0 if a[IS_ARC] == 0.0 else -1.0
    off = isub(iscale(sign * d, icos((low - normal, high - normal))), fixed)
    along, across = split_direction(line, arc)
    k = 1.0 / arc[RADIUS]
    rise = imul(off, iadd(widen_outward(2.0 * along, 2.0 * along), iscale(k, off)))
    return isqrt(isub(isquare(widen_outward(across, across)), iscale(k, rise)))


@inner
def compute_shallow_half_chord(a: Array, b: Array, turn: float, gap: float) -> float:
    """Return half the length in mm of the common chord of two circles, one of them a shallow arc's, from X.

    ``turn`` is X, ``gap`` the distance of the circles' centres in mm. See ``base.feature`` for the layout of
    ``a`` and ``b``. Symbols are those of ``chord.shallow``.
    """
    return a[RADIUS] * b[RADIUS] * abs(turn) / gap
