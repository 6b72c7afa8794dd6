"""How fast a chord's instant centre moves, and stretches: ranges of direction over which its speed is
bounded.

Let C_a = cross(w, r_a), C_b = cross(w, r_b), X = cross(r_a, r_b), and let k_a and k_b be the features'
curvatures (0 for a line, 1 / R for an arc). Differentiating the two lines of action through the instant
centre P gives

    X^3 P' = (C_a X + k_b C_a^2) r_a - (C_b X + k_a C_b^2) r_b,

The right-hand side stays finite at a tangency, where X = 0, so the sign of the second derivatives made of it,

    h'' = -y . P - x . P'        and        s'' = -P' . r_a      (divided by R_a on an arc),

is bounded there too (see ``curves.pieces``).

Between two arcs of nearly equal radii R_a and R_b whose centres are nearly one chord apart, r_a and r_b
nearly agree, and the terms on the right nearly cancel. Let g = c - w, c from centre to centre. Then R_a r_a -
R_b r_b = g gives the same without cancellation: X = -G / R_b with G = cross(r_a, g), and with W = cross(w,
c), E = C_a - G, rho = R_a / R_b

    R_b X^3 P' = (1 - rho^2) C_a E r_a + rho C_a E g / R_b
                 + (rho C_a W / R_a + (W / R_b) (E - W / R_a)) (rho r_a - g / R_b).

All lattice steps of one length share the stretches of their curves: P, seen from the workpiece, depends on
the direction alpha only. Beside a tangency, where P runs off to infinity, a short stretch holds X^3 P' and
X^3 instead, from which the signs of second derivatives follow.

Columns of a stretch:

- STRETCH_HIGH (where it ends, alpha in radians; it begins where the one before it ends, the first part of a
  stretch where that begins);
- SPEED (bound of |P'| in mm per radian, infinite beside a tangency);
- X_LOW, X_HIGH, Y_LOW, Y_HIGH (of X^3 P'), ALONG_LOW, ALONG_HIGH (of X^3 P' . r_a);
- LARGEST_CROSS (largest |X|, with the sign of X), LEAST_CUBE (smallest |X|^3);
- PART_A, PART_B (largest sizes of the parts of X^3 P' along r_a and r_b);
- PARTS (how many of the rows that follow divide this stretch once more, for lattice steps whose curves it
  bounds too loosely).
"""

from __future__ import annotations

from math import atan2, hypot, inf
from typing import NamedTuple

from workhold.kernels.base.compiling import Array, inner
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, IS_ARC, RADIUS, X, Y, is_shallow
from workhold.kernels.base.interval import (
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
    widen_outward,
)
from workhold.kernels.base.tables import BRANCH, COINCIDENCE, FROM, LENGTH, TANGENT_FROM, TANGENT_TO, TO
from workhold.kernels.chord.coincidences import ARCS, CONCENTRIC, NONE, enclose_motion
from workhold.kernels.chord.evaluation import compute_chord, compute_curvature
from workhold.kernels.chord.shallow import enclose_shallow_turn

# Circles with centres nearer than this part of the smaller radius have nearly the same contact directions.
NEAR = 0.5
# What is not known.
ANYTHING = (-inf, inf)


class ChordBox(NamedTuple):
    """Intervals that enclose the numbers of a ``chord.shallow.Chord``."""

    x: Interval
    y: Interval
    ax: Interval
    ay: Interval
    bx: Interval
    by: Interval


class CenterMotion(NamedTuple):
    """Intervals that enclose the terms that make up the instant centre's velocity P'.

    Near a coincidence they enclose P' itself; then X is given as 1, and terms that cannot be bounded are
    (-inf, inf). Symbols are those of ``chord.stretches``.

    Parameters
    ----------
    turn : X.
    x, y : X^3 P'.
    along : X^3 P' . r_a.
    part_a, part_b : the parts of X^3 P' along r_a and against r_b.
    """

    turn: Interval
    x: Interval
    y: Interval
    along: Interval
    part_a: Interval
    part_b: Interval


@inner
def enclose_line_to_arc(a: Array, b: Array, wx: Interval, wy: Interval, branch: float) -> ChordBox:
    """Return an enclosure of the results of ``evaluation.compute_line_to_arc`` for all chords w in a box (wx,
    wy).

    See ``base.feature`` for the layout of ``a`` and ``b``.
    """
    nx, ny = a[AXIS_Y], -a[AXIS_X]
    moved_x, moved_y = ishift(a[X] - b[X], wx), ishift(a[Y] - b[Y], wy)
    across = iadd(iscale(nx, moved_x), iscale(ny, moved_y))
    inside = imul(isub((b[RADIUS], b[RADIUS]), across), ishift(b[RADIUS], across))
    half = iscale(branch, isqrt(inside))
    rx = iadd(iscale(nx, across), iscale(a[AXIS_X], half))
    ry = iadd(iscale(ny, across), iscale(a[AXIS_Y], half))
    ux, uy = isub(ishift(b[X], rx), wx), isub(ishift(b[Y], ry), wy)
    return ChordBox(ux, uy, (nx, nx), (ny, ny), iscale(1.0 / b[RADIUS], rx), iscale(1.0 / b[RADIUS], ry))


@inner
def enclose_arc_to_arc(
    a: Array, b: Array, wx: Interval, wy: Interval, branch: float, one_chord_apart: bool
) -> ChordBox:
    """Return an enclosure of the results of ``evaluation.compute_arc_to_arc`` for all chords w in a box (wx,
    wy).

    See ``base.feature`` for the layout of ``a`` and ``b``.
    """
    cx, cy = b[X] - a[X], b[Y] - a[Y]
    gx, gy = isub((cx, cx), wx), isub((cy, cy), wy)
    gap = isqrt(iadd(isquare(gx), isquare(gy)))
    if one_chord_apart and cx * wx[0] + cy * wy[0] > 0.0 and cx * wx[1] + cy * wy[1] > 0.0:
        mx, my = ishift(cx, wx), ishift(cy, wy)
        size = isqrt(iadd(isquare(mx), isquare(my)))
        middle_x, middle_y = (wx[0] + wx[1]) / 2.0, (wy[0] + wy[1]) / 2.0
        side = 1.0 if cx * middle_y - cy * middle_x >= 0.0 else -1.0
        dx, dy = iscale(side, idivide(my, size)), iscale(-side, idivide(mx, size))
        along = iscale(0.5, gap)
    else:
        dx, dy = idivide(gx, gap), idivide(gy, gap)
        difference = (a[RADIUS] - b[RADIUS]) * (a[RADIUS] + b[RADIUS])
        along = iscale(0.5, iadd(gap, idivide((difference, difference), gap)))
    inside = imul(isub((a[RADIUS], a[RADIUS]), along), ishift(a[RADIUS], along))
    half = iscale(branch, isqrt(inside))
    rx, ry = isub(imul(along, dx), imul(half, dy)), iadd(imul(along, dy), imul(half, dx))
    one, other = 1.0 / a[RADIUS], 1.0 / b[RADIUS]
    qx, qy = iscale(other, isub(rx, gx)), iscale(other, isub(ry, gy))
    return ChordBox(ishift(a[X], rx), ishift(a[Y], ry), iscale(one, rx), iscale(one, ry), qx, qy)


@inner
def enclose_line_to_line(a: Array, b: Array, wx: Interval, wy: Interval) -> ChordBox:
    """Return an enclosure of the chord between two lines for all w in
    a box, in the form of ``evaluation.compute_chord_along``.

    See ``base.feature`` for the layout of ``a`` and ``b``.
    """
    nx, ny = b[AXIS_Y], -b[AXIS_X]
    reach = iadd(
        iscale(nx, isub((b[X] - a[X], b[X] - a[X]), wx)), iscale(ny, isub((b[Y] - a[Y], b[Y] - a[Y]), wy))
    )
    s = iscale(1.0 / (nx * a[AXIS_X] + ny * a[AXIS_Y]), reach)
    ux, uy = ishift(a[X], iscale(a[AXIS_X], s)), ishift(a[Y], iscale(a[AXIS_Y], s))
    return ChordBox(ux, uy, (a[AXIS_Y], a[AXIS_Y]), (-a[AXIS_X], -a[AXIS_X]), (nx, nx), (ny, ny))


@inner
def enclose_chord(a: Array, b: Array, curve: Array, wx: Interval, wy: Interval) -> ChordBox:
    """Return an enclosure of the results of ``evaluation.compute_chord_along`` for all chords w in a box (wx,
    wy).

    See ``base.feature`` for the layout of ``a`` and ``b``, ``base.tables`` for that of ``curve``.
    """
    branch = curve[BRANCH]
    if a[IS_ARC] == 0.0:
        if b[IS_ARC] == 0.0:
            return enclose_line_to_line(a, b, wx, wy)
        return enclose_line_to_arc(a, b, wx, wy, branch)
    if b[IS_ARC] == 0.0:
        vx, vy, rbx, rby, rax, ray = enclose_line_to_arc(b, a, ineg(wx), ineg(wy), branch)
        return ChordBox(isub(vx, wx), isub(vy, wy), rax, ray, rbx, rby)
    if a[RADIUS] <= b[RADIUS]:
        return enclose_arc_to_arc(a, b, wx, wy, branch, curve[COINCIDENCE] == ARCS)
    # Seen from the smaller circle, the contact on the larger one is known better.
    vx, vy, rbx, rby, rax, ray = enclose_arc_to_arc(
        b, a, ineg(wx), ineg(wy), -branch, curve[COINCIDENCE] == ARCS
    )
    return ChordBox(isub(vx, wx), isub(vy, wy), rax, ray, rbx, rby)


@inner
def cut_to_side(turn: Interval, sign: float) -> Interval:
    """Return the part of an interval with the sign ``sign``: its non-negative numbers if that is positive,
    else the others.

    The interval encloses a cross product that keeps its sign and is 0 at a tangency. 0 is in both parts.
    """
    if sign > 0.0:
        return (max(turn[0], 0.0), max(turn[1], 0.0))
    return (min(turn[0], 0.0), min(turn[1], 0.0))


@inner
def enclose_turn(a: Array, b: Array, d: float, low: float, high: float) -> Interval:
    """Return an enclosure of abs(X) for alpha in [low, high], by the sides of a triangle.

    Between a line and an arc X^2 = 1 - (across / R)^2. Between two arcs let g = |c - w|, and gamma the angle
    between w and c. Then X^2 = (g^2 - (R_a - R_b)^2) ((R_a + R_b)^2 - g^2) / (2 R_a R_b)^2 and g^2 =
    (|c| - d)^2 + 4 |c| d sin(gamma / 2)^2. See ``base.feature`` for the layout of ``a`` and ``b``. Symbols
    are those of ``chord.stretches``.
    """
    if is_shallow(a) or is_shallow(b):
        return enclose_shallow_turn(a, b, d, low, high)
    # Differences of coordinates are intervals too: beside a tangency only their rounding is left of them.
    cx, cy = widen_outward(b[X] - a[X], b[X] - a[X]), widen_outward(b[Y] - a[Y], b[Y] - a[Y])
    if a[IS_ARC] == 0.0 and b[IS_ARC] == 0.0:
        turn = icross(
            (a[AXIS_X], a[AXIS_X]), (a[AXIS_Y], a[AXIS_Y]), (b[AXIS_X], b[AXIS_X]), (b[AXIS_Y], b[AXIS_Y])
        )
        return isqrt(isquare(turn))
    if a[IS_ARC] == 0.0 or b[IS_ARC] == 0.0:
        line, arc = (a, b) if a[IS_ARC] == 0.0 else (b, a)
        # The arc's centre from the line's middle along the normal, less the head's way along it.
        fixed = isub(iscale(line[AXIS_Y], cx), iscale(line[AXIS_X], cy))
        normal = atan2(-line[AXIS_X], line[AXIS_Y])
        across = isub(fixed, iscale(d, icos((low - normal, high - normal))))
        inside = imul(isub((arc[RADIUS], arc[RADIUS]), across), ishift(arc[RADIUS], across))
        return iscale(1.0 / arc[RADIUS], isqrt(inside))
    apart, middle = isqrt(iadd(isquare(cx), isquare(cy))), atan2(b[Y] - a[Y], b[X] - a[X])
    half = isin(((low - middle) / 2.0, (high - middle) / 2.0))
    square = iadd(isquare(ishift(-d, apart)), iscale(4.0 * d, imul(apart, isquare(half))))
    difference, total = a[RADIUS] - b[RADIUS], a[RADIUS] + b[RADIUS]
    less, more = widen_outward(difference, difference), widen_outward(total, total)
    inside = imul(isub(square, isquare(less)), isub(isquare(more), square))
    return iscale(0.5 / (a[RADIUS] * b[RADIUS]), isqrt(inside))


@inner
def enclose_center_motion_of_arcs(
    a: Array, b: Array, wx: Interval, wy: Interval, chord: ChordBox, turn_sign: float
) -> CenterMotion:
    """Return the result of :func:`enclose_center_motion` for a chord between two arcs with nearly equal
    contact directions.

    ``chord`` is its enclosure; the last two intervals, which are not bounded here, are infinite. See
    ``base.feature`` for the layout of ``a`` and ``b``.
    """
    _, _, rx, ry, _, _ = chord
    cx, cy = b[X] - a[X], b[Y] - a[Y]
    gx, gy = isub((cx, cx), wx), isub((cy, cy), wy)
    rho, inverse, own = a[RADIUS] / b[RADIUS], 1.0 / b[RADIUS], 1.0 / a[RADIUS]
    swing = icross(rx, ry, gx, gy)
    turn = cut_to_side(iscale(-inverse, swing), turn_sign)
    cross_a = icross(wx, wy, rx, ry)
    across = icross(wx, wy, (cx, cx), (cy, cy))
    rest = isub(cross_a, swing)
    unequal = -(a[RADIUS] - b[RADIUS]) * (a[RADIUS] + b[RADIUS]) * inverse * inverse
    product = imul(cross_a, rest)
    last = iadd(
        iscale(rho / a[RADIUS], imul(cross_a, across)),
        iscale(inverse, imul(across, isub(rest, iscale(own, across)))),
    )
    hx, hy = isub(iscale(rho, rx), iscale(inverse, gx)), isub(iscale(rho, ry), iscale(inverse, gy))
    # R_b X^3 P' is along * r_a + product * rho g / R_b + last * h.
    along, beside = iscale(unequal, product), iscale(rho * inverse, product)
    nx = iscale(inverse, iadd(imul(along, rx), iadd(imul(beside, gx), imul(last, hx))))
    ny = iscale(inverse, iadd(imul(along, ry), iadd(imul(beside, gy), imul(last, hy))))
    return CenterMotion(turn, nx, ny, idot(nx, ny, rx, ry), ANYTHING, ANYTHING)


@inner
def enclose_center_motion(
    a: Array, b: Array, curve: Array, low: float, high: float, turn_sign: float
) -> CenterMotion:
    """Return enclosures, over alpha in [low, high], of the terms that make up the instant centre's velocity
    P'.

    See ``base.feature`` for the layout of ``a`` and ``b``, ``base.tables`` for that of ``curve``. Symbols are
    those of ``chord.stretches``.

    Parameters
    ----------
    curve : reals (16,) of the curve.
    low, high : range of alpha in radians.
    turn_sign : sign of X inside the range (X vanishes at most at its ends).

    Returns
    -------
    CenterMotion
    """
    unit, zero = (1.0, 1.0), (0.0, 0.0)
    if curve[COINCIDENCE] == CONCENTRIC:
        # The instant centre is the common centre.
        return CenterMotion(unit, zero, zero, zero, zero, zero)
    if curve[COINCIDENCE] != NONE:
        regular, u = enclose_motion(a, b, curve, low, high)
        if regular:
            # P = u + J u', J the quarter turn.
            return CenterMotion(
                unit, isub(u.speed_x, u.ray_y), iadd(u.speed_y, u.ray_x), ANYTHING, ANYTHING, ANYTHING
            )
    d = curve[LENGTH]
    wx, wy = iscale(d, icos((low, high))), iscale(d, isin((low, high)))
    box = enclose_chord(a, b, curve, wx, wy)
    if a[IS_ARC] != 0.0 and b[IS_ARC] != 0.0:
        gap = hypot(b[X] - a[X] - (wx[0] + wx[1]) / 2.0, b[Y] - a[Y] - (wy[0] + wy[1]) / 2.0)
        if gap < NEAR * min(a[RADIUS], b[RADIUS]):
            return enclose_center_motion_of_arcs(a, b, wx, wy, box, turn_sign)
    _, _, rax, ray, rbx, rby = box
    turn = enclose_turn(a, b, d, low, high)
    if turn_sign < 0.0:
        turn = ineg(turn)
    cross_a, cross_b = icross(wx, wy, rax, ray), icross(wx, wy, rbx, rby)
    part_a = imul(cross_a, iadd(turn, iscale(compute_curvature(b), cross_a)))
    part_b = imul(cross_b, iadd(turn, iscale(compute_curvature(a), cross_b)))
    nx, ny = isub(imul(part_a, rax), imul(part_b, rbx)), isub(imul(part_a, ray), imul(part_b, rby))
    along = isub(part_a, imul(part_b, idot(rax, ray, rbx, rby)))
    return CenterMotion(turn, nx, ny, along, part_a, part_b)


STRETCH_HIGH, SPEED, X_LOW, X_HIGH, Y_LOW, Y_HIGH, ALONG_LOW, ALONG_HIGH = range(8)
LARGEST_CROSS, LEAST_CUBE, PART_A, PART_B, PARTS = range(8, 13)
STRETCH_LENGTH = 13

# Widest and narrowest stretches in radians, and the length to which those beside a tangency are cut.
WIDEST = 0.25
NARROWEST = 1e-7
BESIDE = 4e-3
# Each part of a stretch beside a tangency is this much shorter than the one before it; the last between two
# arcs, and between a line and an arc, where the chord may run along the line (as at a tangent joint of the
# part) and pass the tangency smoothly.
SHORTER = 4.0
LAST_OF_ARCS, LAST_OF_LINE = 1e-8, 1e-12
# What cannot be bounded is cut no further than this.
LAST = 1e-7
DEPTH = 64
# How far P may move over a stretch, in chord lengths.
MOST_MOTION = 1.0


@inner
def write_stretch(row: Array, a: Array, b: Array, curve: Array, low: float, high: float, sign: float) -> bool:
    """Write the stretch over [low, high] to ``row`` (13,); return
    whether it is good enough not to be divided.

    ``sign`` is that of X. It is good enough in two cases: (a) the bound of the speed of P is of the order of
    the speed in the middle, so that a shorter stretch would bound it no better; (b) P moves no farther than
    ``MOST_MOTION`` chord lengths. See ``chord.stretches`` for the layout of ``row``, ``base.feature`` for
    that of ``a`` and ``b``, ``base.tables`` for that of ``curve``. Symbols are those of ``chord.stretches``.
    """
    turn, x, y, along, part_a, part_b = enclose_center_motion(a, b, curve, low, high, sign)
    row[STRETCH_HIGH], row[PARTS] = high, 0.0
    row[X_LOW], row[X_HIGH], row[Y_LOW], row[Y_HIGH] = x[0], x[1], y[0], y[1]
    row[ALONG_LOW], row[ALONG_HIGH] = along
    row[PART_A], row[PART_B] = max(-part_a[0], part_a[1]), max(-part_b[0], part_b[1])
    row[LARGEST_CROSS] = turn[1] if sign > 0.0 else turn[0]
    least, most = min(abs(turn[0]), abs(turn[1])), abs(row[LARGEST_CROSS])
    size = hypot(max(-x[0], x[1]), max(-y[0], y[1]))
    row[SPEED], row[LEAST_CUBE] = inf, least * least * least
    if least > 0.0 and size < inf:
        row[SPEED] = size / row[LEAST_CUBE] * (1.0 + 1e-12)
    middle = (least + most) / 2.0
    typical = hypot(x[0] + x[1], y[0] + y[1]) / (2.0 * middle * middle * middle)
    return row[SPEED] <= max(4.0 * typical + 4.0 * curve[LENGTH], MOST_MOTION * curve[LENGTH] / (high - low))


@inner
def add_parts(
    out: Array,
    count: int,
    a: Array,
    b: Array,
    curve: Array,
    left: float,
    right: float,
    at_low: bool,
    error: float,
    sign: float,
) -> int:
    """Append the parts of the last stretch in ``out``, in ascending
    order; return the new number of rows, -1 for no room.

    The stretch [left, right] begins (``at_low``) or ends at a tangency known to ``error`` in radians. Its
    PARTS are set. See ``base.feature`` for the layout of ``a`` and ``b``, ``base.tables`` for that of
    ``curve``.
    """
    width, number = right - left, 1
    last = max(LAST_OF_LINE if a[IS_ARC] + b[IS_ARC] == 1.0 else LAST_OF_ARCS, 8.0 * error)
    while width > last:
        width /= SHORTER
        number += 1
    out[count - 1, PARTS] = number
    low = left
    for k in range(number):
        if count == out.shape[0]:
            return -1
        # The parts grow away from the tangency.
        high = (
            left + (right - left) * SHORTER ** -(number - 1.0 - k)
            if at_low
            else right - (right - left) * SHORTER ** -(k + 1.0)
        )
        if k == number - 1:
            high = right
        write_stretch(out[count], a, b, curve, low, high, sign)
        low = high
        count += 1
    return count


@inner
def add_stretches(out: Array, count: int, a: Array, b: Array, curve: Array, stack: Array) -> int:
    """Append the stretches of a curve, in ascending order of alpha, to ``out`` (S, 13).

    Return the new number of rows, -1 when there is no room. ``curve`` are its reals (16,), ``stack`` is
    (DEPTH,) work space. See ``base.feature`` for the layout of ``a`` and ``b``, ``base.tables`` for that of
    ``curve``.
    """
    low, high = curve[FROM], curve[TO]
    c = compute_chord(a, b, curve[LENGTH], (low + high) / 2.0, curve[BRANCH])
    sign = 1.0 if c.ax * c.by - c.ay * c.bx > 0.0 else -1.0
    depth = 0
    left, right = low, high
    while True:
        if count == out.shape[0]:
            return -1
        width = right - left
        good = write_stretch(out[count], a, b, curve, left, right, sign)
        at_low = left == low and curve[TANGENT_FROM] > 0.0
        at_high = right == high and curve[TANGENT_TO] > 0.0
        if out[count, SPEED] < inf:
            done = (good and width <= WIDEST) or width <= NARROWEST
        else:
            done = width <= BESIDE if at_low != at_high else width <= LAST
        if not done and depth < stack.shape[0]:
            stack[depth] = right
            depth += 1
            if at_low and not at_high:
                right = left + max(width / 4.0, min(width / 2.0, BESIDE))
            elif at_high and not at_low:
                right = right - max(width / 4.0, min(width / 2.0, BESIDE))
            else:
                right = left + width / 2.0
            continue
        count += 1
        if at_low != at_high:
            error = curve[TANGENT_FROM] if at_low else curve[TANGENT_TO]
            count = add_parts(out, count, a, b, curve, left, right, at_low, error, sign)
        if depth == 0 or count < 0:
            return count
        left = right
        depth -= 1
        right = stack[depth]
