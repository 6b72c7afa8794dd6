"""A step of a part between two pegs, one of each jaw, along both pieces on which their distance d falls.

With both pegs at fixed heights the separation grows with d alone, whose slopes and curvatures along the
pieces are known in closed form. With t the tangents and u the unit vector from one place to the other, the
slopes are d' = -u . t and u . t. Along a piece d'' is (1 - (u . t)^2) / d, with the piece's own bend, and
across it is -(t . t - (u . t) (u . t)) / d. A Newton step, its curvatures taken as above 0 (P. E. Gill and W.
Murray, Mathematical Programming 7, 1974), leads along narrow valleys in which linear programs go to and fro.
"""

from __future__ import annotations

from math import atan2, cos, floor, hypot, pi, sin, sqrt

from workhold.kernels.base.compiling import Array, inner
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, RADIUS, X, Y
from workhold.kernels.seating.columns import DescentWorkSpace, Obstacles
from workhold.kernels.seating.obstacles import (
    angle_from_middle,
    cosine_and_sine,
    nearest_piece,
    off_wall,
    turned_place,
)

# mm. Pegs this near to a piece touch it; shorter steps and smaller gains are none; how deep pegs may enter.
TOUCHES, SHORTEST, GAIN, ENTERED = 1e-9, 1e-9, 1e-12, 1e-9
# 1 / mm. Curvatures below this are counted as this.
FLATTEST = 1e-9
# How often a step is halved, at how many places it is looked at, and how much farther than both contacts the
# part may move.
HALVINGS, PARTS, FARTHER = 3, 3, 3.0


@inner
def tangent_at(row: Array, x: float, y: float) -> tuple[float, float]:
    """Unit tangent of a piece, counter-clockwise on an arc."""
    if row[IS_ARC] == 0.0:
        return (row[AXIS_X], row[AXIS_Y])
    return (-(y - row[Y]) / row[RADIUS], (x - row[X]) / row[RADIUS])


@inner
def bend_at(row: Array, x: float, y: float, ux: float, uy: float) -> float:
    """Second derivative of the place along a piece, times u, in 1 / mm."""
    if row[IS_ARC] == 0.0:
        return 0.0
    return -(ux * (x - row[X]) + uy * (y - row[Y])) / (row[RADIUS] * row[RADIUS])


@inner
def moved_along(row: Array, x: float, y: float, s: float) -> tuple[float, float]:
    """The place s mm further along a piece's carrier."""
    if row[IS_ARC] == 0.0:
        return (x + s * row[AXIS_X], y + s * row[AXIS_Y])
    dx, dy = x - row[X], y - row[Y]
    c, d = cos(s / row[RADIUS]), sin(s / row[RADIUS])
    return (row[X] + c * dx - d * dy, row[Y] + c * dy + d * dx)


@inner
def parameter(row: Array, x: float, y: float) -> float:
    """The parameter of a place of a piece's carrier."""
    dx, dy = x - row[X], y - row[Y]
    return dx * row[AXIS_X] + dy * row[AXIS_Y] if row[IS_ARC] == 0.0 else angle_from_middle(row, dx, dy)


@inner
def is_peg_free(x: float, y: float, peg: int, obstacles: Obstacles, known: Array) -> bool:
    """Whether a peg at a place of the part is not in it.

    A place within a disc that is known to be free is free, too. The disc (x, y, radius) stands in ``known``,
    with the piece that was the nearest.
    """
    dx, dy = x - known[peg, 0], y - known[peg, 1]
    if known[peg, 2] > 0.0 and dx * dx + dy * dy < known[peg, 2] * known[peg, 2]:
        return True
    first, end = obstacles.parts[obstacles.right[peg], 0], obstacles.parts[obstacles.right[peg], 1]
    free, piece = nearest_piece(x, y, obstacles.rows, first, end, int(known[peg, 3]))
    known[peg, 0], known[peg, 1], known[peg, 2], known[peg, 3] = x, y, free, piece
    return free >= -ENTERED


@inner
def newton_step(haa: float, hab: float, hbb: float, ga: float, gb: float, most: float) -> tuple[float, float]:
    """The step down of slopes g and curvatures h, each counted as above 0, no longer than ``most``."""
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
def antipodal_pose(
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
    """Writes the configuration in which pegs p and q stand at two places of the part.

    Returns whether there is one above the stop, and the cosine and the sine of its orientation, which itself
    is written only where it is asked for.
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
    """Whether no peg but two is in the part, and no wall, at an orientation of known cosine and sine."""
    for peg in range(obstacles.pegs.shape[0]):
        if peg in (p, q):
            continue
        x, y = turned_place(config, cosine, sine, obstacles, peg)
        if not is_peg_free(x, y, peg, obstacles, known):
            return False
    return off_wall(config, obstacles, 0.0) >= -ENTERED


@inner
def keeps_to(piece: int, at: float, peg: int, x: float, y: float, obstacles: Obstacles, known: Array) -> bool:
    """Whether a peg at a parameter of a piece's carrier touches the piece and is not in the part.

    Past a pocket it is in it.
    """
    half = obstacles.rows[piece, HALF_EXTENT]
    if obstacles.rows[piece, IS_ARC] != 0.0 and half >= pi:
        return True
    if not obstacles.spans[piece, 0] <= at <= obstacles.spans[piece, 1]:
        return False
    return abs(at) <= half or is_peg_free(x, y, peg, obstacles, known)


@inner
def antipodal_step(
    config: Array, count: int, longest: float, most: float, obstacles: Obstacles, work: DescentWorkSpace
) -> float:
    """Writes a configuration further down to ``trial`` where one peg of each jaw touches one piece.

    Returns how far both contacts go: negative where something is in the way of a longer step, 0 where there
    is none.

    Parameters
    ----------
    count : how many clearances ``near`` has.
    longest, most : how far both contacts may go together, and the part by some more, in mm.
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
    cosine, sine = cosine_and_sine(config[0], work.turn)
    ax, ay = turned_place(config, cosine, sine, obstacles, p)
    bx, by = turned_place(config, cosine, sine, obstacles, q)
    d = hypot(bx - ax, by - ay)
    ux, uy = (bx - ax) / d, (by - ay) / d
    sx, sy = tangent_at(a, ax, ay)
    tx, ty = tangent_at(b, bx, by)
    us, ut = ux * sx + uy * sy, ux * tx + uy * ty
    haa = (1.0 - us * us) / d - bend_at(a, ax, ay, ux, uy)
    hbb = (1.0 - ut * ut) / d + bend_at(b, bx, by, ux, uy)
    along_a, along_b = newton_step(haa, -(sx * tx + sy * ty - us * ut) / d, hbb, -us, ut, longest)
    asked = hypot(along_a, along_b)
    a_unit = a[RADIUS] if a[IS_ARC] != 0.0 else 1.0
    b_unit = b[RADIUS] if b[IS_ARC] != 0.0 else 1.0
    a_at, b_at = parameter(a, ax, ay), parameter(b, bx, by)
    for _ in range(HALVINGS):
        length = hypot(along_a, along_b)
        if length <= SHORTEST:
            return 0.0
        level, good = config[3], True
        # No ridge lies between: the way falls, and is free, also before its end.
        for part in range(1, PARTS + 1):
            s, t = along_a * part / PARTS, along_b * part / PARTS
            x, y = moved_along(a, ax, ay, s)
            v, w = moved_along(b, bx, by, t)
            # A wall sees the part as it is turned.
            turned = part == PARTS or obstacles.hull.shape[0] > 0
            good, cosine, sine = antipodal_pose(config, p, q, x, y, v, w, obstacles, turned, trial)
            good = (
                good
                and trial[3] < level - GAIN
                and keeps_to(a_number, a_at + s / a_unit, p, x, y, obstacles, known)
                and keeps_to(b_number, b_at + t / b_unit, q, v, w, obstacles, known)
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
