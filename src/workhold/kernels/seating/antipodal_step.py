"""A step of a part between two pegs, one of each jaw, along both pieces on which their distance d falls.

With both pegs at fixed heights the separation grows with d alone, whose slopes and curvatures along the
pieces are known in closed form. With t the tangents and u the unit vector from one place to the other, the
slopes are d' = -u . t and u . t. Along a piece d'' is (1 - (u . t)^2) / d, plus a term for the piece's own
curvature. With the tangents t_1 and t_2 of both pieces, the mixed second derivative is -(t_1 . t_2 - (u .
t_1) (u . t_2)) / d. A Newton step, its curvatures taken as above 0 (P. E. Gill and W. Murray, Mathematical
Programming 7, 1974), leads along narrow valleys in which linear programs go to and fro.
"""

from __future__ import annotations

from math import atan2, cos, floor, hypot, pi, sin, sqrt

from workhold.kernels.base.compiling import Array, inner
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, RADIUS, X, Y
from workhold.kernels.seating.columns import DescentWorkSpace, Obstacles
from workhold.kernels.seating.obstacles import (
    compute_angle_from_middle,
    compute_cosine_and_sine,
    compute_turned_place,
    find_nearest_piece,
    measure_wall_clearance,
)

# mm. Pegs this near to a piece touch it; shorter steps and smaller gains are none; how deep pegs may enter.
TOUCHES, SHORTEST, GAIN, ENTERED = 1e-9, 1e-9, 1e-12, 1e-9
# 1 / mm. Curvatures below this are counted as this.
FLATTEST = 1e-9
# How often a step is halved, at how many places it is looked at, and how much farther than both contacts the
# part may move.
HALVINGS, PARTS, FARTHER = 3, 3, 3.0


@inner
def compute_tangent(row: Array, x: float, y: float) -> tuple[float, float]:
    """Return the unit tangent (x, y) of a piece at the point (x, y):
    along a line's axis, counter-clockwise on an arc.

    See ``base.feature`` for the layout of ``row``.
    """
    if row[IS_ARC] == 0.0:
        return (row[AXIS_X], row[AXIS_Y])
    return (-(y - row[Y]) / row[RADIUS], (x - row[X]) / row[RADIUS])


@inner
def compute_bend(row: Array, x: float, y: float, ux: float, uy: float) -> float:
    """Return the scalar product of the curvature vector of a piece at
    (x, y) with the vector (ux, uy), in 1 / mm.

    The curvature vector is the second derivative of the point over arc length, 0 on a line. See
    ``base.feature`` for the layout of ``row``.
    """
    if row[IS_ARC] == 0.0:
        return 0.0
    return -(ux * (x - row[X]) + uy * (y - row[Y])) / (row[RADIUS] * row[RADIUS])


@inner
def move_along(row: Array, x: float, y: float, s: float) -> tuple[float, float]:
    """Return the point s mm further along a piece's line or circle
    from (x, y), counter-clockwise on a circle.

    See ``base.feature`` for the layout of ``row``.
    """
    if row[IS_ARC] == 0.0:
        return (x + s * row[AXIS_X], y + s * row[AXIS_Y])
    dx, dy = x - row[X], y - row[Y]
    c, d = cos(s / row[RADIUS]), sin(s / row[RADIUS])
    return (row[X] + c * dx - d * dy, row[Y] + c * dy + d * dx)


@inner
def find_parameter(row: Array, x: float, y: float) -> float:
    """Return the parameter of a point on a piece's line (mm) or circle (radians), 0 at the piece's middle.

    See ``base.feature`` for the layout of ``row``.
    """
    dx, dy = x - row[X], y - row[Y]
    return (
        dx * row[AXIS_X] + dy * row[AXIS_Y] if row[IS_ARC] == 0.0 else compute_angle_from_middle(row, dx, dy)
    )


@inner
def is_peg_free(x: float, y: float, peg: int, obstacles: Obstacles, known: Array) -> bool:
    """Return whether a peg with its centre at (x, y) of the part's
    frame is outside the part, to within ``ENTERED`` mm.

    ``known`` (4, 4) caches for each peg a place (x, y), its clearance and the nearest piece. A place within
    that clearance of the cached one is free without a search; otherwise the row of the peg is overwritten.
    """
    dx, dy = x - known[peg, 0], y - known[peg, 1]
    if known[peg, 2] > 0.0 and dx * dx + dy * dy < known[peg, 2] * known[peg, 2]:
        return True
    first, end = obstacles.parts[obstacles.right[peg], 0], obstacles.parts[obstacles.right[peg], 1]
    free, piece = find_nearest_piece(x, y, obstacles.rows, first, end, int(known[peg, 3]))
    known[peg, 0], known[peg, 1], known[peg, 2], known[peg, 3] = x, y, free, piece
    return free >= -ENTERED


@inner
def compute_newton_step(
    haa: float, hab: float, hbb: float, ga: float, gb: float, most: float
) -> tuple[float, float]:
    """Return the Newton step that lowers a function of two variables
    with slopes (ga, gb), no longer than ``most``.

    ``haa``, ``hab``, ``hbb`` are its second derivatives. The absolute values of their eigenvalues are used,
    at least ``FLATTEST``, so that the step leads down.
    """
    mean, half = (haa + hbb) / 2.0, hypot((haa - hbb) / 2.0, hab)
    ca, cb = 1.0, 0.0
    if half > 0.0:
        # The eigenvector of mean + half, from the column that is not nearly none.
        ca, cb = (half + (haa - hbb) / 2.0, hab) if haa >= hbb else (hab, half + (hbb - haa) / 2.0)
        size = hypot(ca, cb)
        ca, cb = ca / size, cb / size
    one = -(ca * ga + cb * gb) / max(abs(mean + half), FLATTEST)
    two = -(ca * gb - cb * ga) / max(abs(mean - half), FLATTEST)
    scale = min(1.0, most / max(hypot(one, two), SHORTEST))
    return (scale * (ca * one - cb * two), scale * (cb * one + ca * two))


@inner
def write_antipodal_pose(
    config: Array,
    p: int,
    q: int,
    x: float,
    y: float,
    v: float,
    w: float,
    obstacles: Obstacles,
    with_angle: bool,
    trial: Array,
) -> tuple[bool, float, float]:
    """Write the configuration in which pegs p and q are at two points
    of the part to ``trial`` (4,): theta, x, y, S.

    Peg p is at (x, y), peg q at (v, w), in the part's frame in mm. Return (whether such a configuration
    exists with S above the stop, cosine of theta, sine of theta). Theta itself, within half a turn of that in
    ``config``, is written only ``with_angle``. S is the jaw separation in mm.
    """
    run, rise = obstacles.pegs[q, 0] - obstacles.pegs[p, 0], obstacles.pegs[q, 1] - obstacles.pegs[p, 1]
    dx, dy = v - x, w - y
    square = dx * dx + dy * dy
    if square <= rise * rise:
        return (False, 1.0, 0.0)
    # From the direction of both places on the part to that of both pegs.
    along = sqrt(square - rise * rise)
    cosine, sine = (along * dx + rise * dy) / square, (rise * dx - along * dy) / square
    if with_angle:
        theta = atan2(sine, cosine)
        trial[0] = theta + 2.0 * pi * floor((config[0] - theta) / (2.0 * pi) + 0.5)
    trial[3] = along - run
    trial[1] = obstacles.pegs[p, 0] - (cosine * x - sine * y)
    trial[2] = obstacles.pegs[p, 1] - (sine * x + cosine * y)
    return (trial[3] > obstacles.stop, cosine, sine)


@inner
def is_free(
    config: Array, cosine: float, sine: float, p: int, q: int, obstacles: Obstacles, known: Array
) -> bool:
    """Return whether all pegs except p and q, and the wall, are clear of the part, to within ``ENTERED`` mm.

    ``cosine`` and ``sine`` are those of the orientation of ``config``; ``known`` is described at
    :func:`is_peg_free`. A configuration is theta in radians, x, y and the jaw separation S in mm.
    """
    for peg in range(obstacles.pegs.shape[0]):
        if peg in (p, q):
            continue
        x, y = compute_turned_place(config, cosine, sine, obstacles, peg)
        if not is_peg_free(x, y, peg, obstacles, known):
            return False
    return measure_wall_clearance(config, obstacles, 0.0) >= -ENTERED


@inner
def is_peg_on_piece(
    piece: int, at: float, peg: int, x: float, y: float, obstacles: Obstacles, known: Array
) -> bool:
    """Return whether a peg at the parameter ``at`` of a piece's line or circle, at (x, y), touches the piece.

    Two cases: (a) between the piece's ends it does; (b) beyond the ends, up to the piece's span, the peg must
    also be free, as past a pocket it is inside the part.
    """
    half = obstacles.rows[piece, HALF_EXTENT]
    if obstacles.rows[piece, IS_ARC] != 0.0 and half >= pi:
        return True
    if not obstacles.spans[piece, 0] <= at <= obstacles.spans[piece, 1]:
        return False
    return abs(at) <= half or is_peg_free(x, y, peg, obstacles, known)


@inner
def write_antipodal_step(
    config: Array, count: int, longest: float, most: float, obstacles: Obstacles, work: DescentWorkSpace
) -> float:
    """Write a configuration with a lower separation to
    ``work.trial``, where one peg of each jaw touches one piece.

    Return how far in mm both contacts moved together; negated where obstacles made the step shorter than the
    Newton step; 0 where there is no step (then ``work.trial`` is undefined). A configuration is theta in
    radians, x, y and the jaw separation S in mm.

    Parameters
    ----------
    count : number of clearances in ``work.near``.
    longest : greatest length of the step of both contacts together, in mm.
    most : the part may move by up to ``FARTHER`` times this, in mm.
    """
    near, trial, known = work.near, work.trial, work.known
    one, two = -1, -1
    for i in range(count):
        if near[i, 4] < TOUCHES:
            if near[i, 5] < 0.0:
                return 0.0
            if obstacles.right[int(near[i, 5])] == 1:
                if two >= 0:
                    return 0.0
                two = i
            elif one >= 0:
                return 0.0
            else:
                one = i
    if one < 0 or two < 0:
        return 0.0
    p, q, a_number, b_number = int(near[one, 5]), int(near[two, 5]), int(near[one, 6]), int(near[two, 6])
    if obstacles.pegs[q, 0] + config[3] <= obstacles.pegs[p, 0]:
        # The peg that moves pushes outward.
        return 0.0
    a, b = obstacles.rows[a_number], obstacles.rows[b_number]
    cosine, sine = compute_cosine_and_sine(config[0], work.turn)
    ax, ay = compute_turned_place(config, cosine, sine, obstacles, p)
    bx, by = compute_turned_place(config, cosine, sine, obstacles, q)
    d = hypot(bx - ax, by - ay)
    ux, uy = (bx - ax) / d, (by - ay) / d
    sx, sy = compute_tangent(a, ax, ay)
    tx, ty = compute_tangent(b, bx, by)
    us, ut = ux * sx + uy * sy, ux * tx + uy * ty
    haa = (1.0 - us * us) / d - compute_bend(a, ax, ay, ux, uy)
    hbb = (1.0 - ut * ut) / d + compute_bend(b, bx, by, ux, uy)
    along_a, along_b = compute_newton_step(haa, -(sx * tx + sy * ty - us * ut) / d, hbb, -us, ut, longest)
    asked = hypot(along_a, along_b)
    a_unit = a[RADIUS] if a[IS_ARC] != 0.0 else 1.0
    b_unit = b[RADIUS] if b[IS_ARC] != 0.0 else 1.0
    a_at, b_at = find_parameter(a, ax, ay), find_parameter(b, bx, by)
    for _ in range(HALVINGS):
        length = hypot(along_a, along_b)
        if length <= SHORTEST:
            return 0.0
        level, good = config[3], True
        # No ridge lies between: the way falls, and is free, also before its end.
        for part in range(1, PARTS + 1):
            s, t = along_a * part / PARTS, along_b * part / PARTS
            x, y = move_along(a, ax, ay, s)
            v, w = move_along(b, bx, by, t)
            # A wall sees the part as it is turned.
            turned = part == PARTS or obstacles.hull.shape[0] > 0
            good, cosine, sine = write_antipodal_pose(config, p, q, x, y, v, w, obstacles, turned, trial)
            good = (
                good
                and trial[3] < level - GAIN
                and is_peg_on_piece(a_number, a_at + s / a_unit, p, x, y, obstacles, known)
                and is_peg_on_piece(b_number, b_at + t / b_unit, q, v, w, obstacles, known)
                and is_free(trial, cosine, sine, p, q, obstacles, known)
            )
            if not good:
                break
            level = trial[3]
        motion = abs(trial[0] - config[0]) * obstacles.size
        for j in range(1, 4):
            motion += abs(trial[j] - config[j])
        if good and motion < FARTHER * most:
            return length if length == asked else -length
        along_a, along_b = along_a / 2.0, along_b / 2.0
    return 0.0
