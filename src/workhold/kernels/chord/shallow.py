"""Chords one of whose features is a shallow arc (see ``base.feature``), without numbers of the size of its
radius.

Let m be the arcs' middles, t their directions, k their curvatures and q = m_b - m_a. The law of cosines gives
the cosine xi of the angle between both contact directions of a chord w,

    1 - xi = |t_a - t_b|^2 / 2 + (q - w) . (k_b t_a - k_a t_b) + k_a k_b |q - w|^2 / 2,

so X^2 = (1 - xi) (1 + xi), and both are a constant and a multiple of cos(alpha - beta), beta the direction
from centre to centre. Between a line of normal n and an arc X^2 = tau^2 - k e (2 nu + k e). Here nu and tau
are the parts of t along and square to n, and e is how far the contact is from m along n.
"""

from __future__ import annotations

from math import atan2, cos, hypot, sin

from workhold.kernels.base.compiling import Array, inner
from workhold.kernels.base.feature import (
    AXIS_X,
    AXIS_Y,
    IS_ARC,
    RADIUS,
    X,
    Y,
    beside_middle,
    exact_dot,
    middle_of,
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
    outward,
)

Chord = tuple[float, float, float, float, float, float]


@inner
def line_to_shallow(a: Array, b: Array, wx: float, wy: float, branch: float) -> Chord:
    """``evaluation.line_to_arc`` for a shallow arc."""
    nx, ny = a[AXIS_Y], -a[AXIS_X]
    mx, my = middle_of(b)
    off = nx * (a[X] + wx - mx) + ny * (a[Y] + wy - my)
    x, y, rx, ry = beside_middle(
        b, nx, ny, exact_dot(a[AXIS_X], a[AXIS_Y], b[AXIS_X], b[AXIS_Y]), off, branch
    )
    return (mx + x - wx, my + y - wy, nx, ny, rx, ry)


@inner
def shallow_to_arc(a: Array, b: Array, wx: float, wy: float, branch: float) -> Chord:
    """``evaluation.arc_to_arc`` where an arc is shallow: the tail lies where the circle of a meets the line
    on which both circles' equations agree."""
    gx, gy = b[X] - a[X] - wx, b[Y] - a[Y] - wy
    gap = hypot(gx, gy)
    nx, ny = gx / gap, gy / gap
    ax, ay = middle_of(a)
    bx, by = middle_of(b)
    qx, qy = ax + wx - bx, ay + wy - by
    off = ((qx * qx + qy * qy) / 2.0 + b[RADIUS] * (qx * b[AXIS_X] + qy * b[AXIS_Y])) / gap
    # Cross products of c_b - w - c_a = R_a t_a - R_b t_b - q with t_a.
    across = (
        -(
            b[RADIUS] * exact_dot(b[AXIS_X], -b[AXIS_Y], a[AXIS_Y], a[AXIS_X])
            + qx * a[AXIS_Y]
            - qy * a[AXIS_X]
        )
        / gap
    )
    x, y, rx, ry = beside_middle(a, nx, ny, across, off, branch)
    return (ax + x, ay + y, rx, ry, b[AXIS_X] + (x + qx) / b[RADIUS], b[AXIS_Y] + (y + qy) / b[RADIUS])


@inner
def parts_of(line: Array, arc: Array) -> tuple[float, float]:
    """The parts of an arc's direction along a line's normal and along the line: nu and tau."""
    along = line[AXIS_Y] * arc[AXIS_X] - line[AXIS_X] * arc[AXIS_Y]
    return (along, exact_dot(line[AXIS_X], line[AXIS_Y], arc[AXIS_X], arc[AXIS_Y]))


@inner
def tangent_off(line: Array, arc: Array) -> float:
    """e of the tangency at a shallow arc's near side: R tau^2 / (1 + |nu|) towards it."""
    along, across = parts_of(line, arc)
    off = arc[RADIUS] * across * across / (1.0 + abs(along))
    return off if along > 0.0 else -off


@inner
def is_turned(a: Array, b: Array, wx: float, wy: float) -> bool:
    """Whether the carriers of two features, one of them a shallow arc, meet for a chord: whether X^2 is
    positive."""
    if a[IS_ARC] != 0.0 and b[IS_ARC] != 0.0:
        near, far, swing, beta = arcs_cosine(a, b, hypot(wx, wy))
        part = swing * (wx * cos(beta) + wy * sin(beta)) / hypot(wx, wy)
        return near[0] / 2.0 + near[1] / 2.0 > part and far[0] / 2.0 + far[1] / 2.0 > -part
    line, arc = (a, b) if a[IS_ARC] == 0.0 else (b, a)
    mx, my = middle_of(arc)
    sign = 1.0 if a[IS_ARC] == 0.0 else -1.0
    off = line[AXIS_Y] * (line[X] + sign * wx - mx) - line[AXIS_X] * (line[Y] + sign * wy - my)
    along, across = parts_of(line, arc)
    k = 1.0 / arc[RADIUS]
    return across * across > k * off * (2.0 * along + k * off)


@inner
def arcs_cosine(a: Array, b: Array, d: float) -> tuple[Interval, Interval, float, float]:
    """What xi is made of between two arcs: 1 - xi = near - swing cos(alpha - beta), 1 + xi = far + swing
    cos(alpha - beta).

    Returns
    -------
    (enclosures of near and far, swing, beta in radians)
    """
    ax, ay = middle_of(a)
    bx, by = middle_of(b)
    ka, kb = 1.0 / a[RADIUS], 1.0 / b[RADIUS]
    # Middles and differences are rounded once or so.
    qx, qy = isub(outward(bx, bx), outward(ax, ax)), isub(outward(by, by), outward(ay, ay))
    vx = isub(iscale(kb, outward(a[AXIS_X], a[AXIS_X])), iscale(ka, outward(b[AXIS_X], b[AXIS_X])))
    vy = isub(iscale(kb, outward(a[AXIS_Y], a[AXIS_Y])), iscale(ka, outward(b[AXIS_Y], b[AXIS_Y])))
    drift = iadd(imul(qx, vx), imul(qy, vy))
    bend = iscale(0.5 * ka * kb, ishift(d * d, iadd(isquare(qx), isquare(qy))))
    both = iadd(drift, bend)
    lx, ly = a[AXIS_X] - b[AXIS_X], a[AXIS_Y] - b[AXIS_Y]
    mx, my = a[AXIS_X] + b[AXIS_X], a[AXIS_Y] + b[AXIS_Y]
    less = iscale(0.5, iadd(isquare(outward(lx, lx)), isquare(outward(ly, ly))))
    more = iscale(0.5, iadd(isquare(outward(mx, mx)), isquare(outward(my, my))))
    swing = d * ka * kb * hypot(b[X] - a[X], b[Y] - a[Y])
    return (iadd(less, both), isub(more, both), swing, atan2(b[Y] - a[Y], b[X] - a[X]))


@inner
def shallow_turn_size(a: Array, b: Array, d: float, low: float, high: float) -> Interval:
    """Enclosure of abs(X) for alpha in [low, high]; see ``stretches.turn_size``."""
    if a[IS_ARC] != 0.0 and b[IS_ARC] != 0.0:
        near, far, swing, beta = arcs_cosine(a, b, d)
        part = imul(outward(swing, swing), icos((low - beta, high - beta)))
        return isqrt(imul(isub(near, part), iadd(far, part)))
    line, arc = (a, b) if a[IS_ARC] == 0.0 else (b, a)
    mx, my = middle_of(arc)
    fixed = iadd(
        iscale(line[AXIS_Y], isub(outward(mx, mx), (line[X], line[X]))),
        iscale(-line[AXIS_X], isub(outward(my, my), (line[Y], line[Y]))),
    )
    normal = atan2(-line[AXIS_X], line[AXIS_Y])
    # The contact's way from the arc's middle: w counts towards an arc that is touched by the head.
    sign = 1.0 if a[IS_ARC] == 0.0 else -1.0
    off = isub(iscale(sign * d, icos((low - normal, high - normal))), fixed)
    along, across = parts_of(line, arc)
    k = 1.0 / arc[RADIUS]
    rise = imul(off, iadd(outward(2.0 * along, 2.0 * along), iscale(k, off)))
    return isqrt(isub(isquare(outward(across, across)), iscale(k, rise)))


@inner
def shallow_half(a: Array, b: Array, turn: float, gap: float) -> float:
    """Half the chord that two circles have in common, by X, where an arc is shallow
    (``piece_bounds.arcs_radius``)."""
    return a[RADIUS] * b[RADIUS] * abs(turn) / gap
