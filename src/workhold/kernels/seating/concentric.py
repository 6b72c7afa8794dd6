"""Three pegs whose forces meet in the common centre of two arcs.

A peg of each jaw is on the arcs, and a further one where the normal of its piece goes through the centre. No
chord shows where: the normals of the two arcs meet in the centre wherever they are touched. But of the pegs
of one jaw one is as far from the centre as its arc's radius, and the other as the foot of the centre on its
piece. That places the centre, and turns the part.
"""

from __future__ import annotations

from math import atan2, cos, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.compiling import compiled, inner
from workhold.kernels.base.feature import IS_ARC, RADIUS, X, Y
from workhold.kernels.seating.candidates import write_pose
from workhold.kernels.seating.columns import MOTION, PEG, PIECE, SECOND, SEPARATION, Given
from workhold.kernels.seating.pieces import foot, length, on_piece, share_normals
from workhold.kernels.seating.two_contact_curves import END

Array = NDArray[np.float64]

# mm. Feet nearer to the centre than this have no direction from it; centres nearer to the line of two pegs
# are on it.
NEAREST = 1e-6


@inner
def is_touched(piece: Array, theta: float, dx: float, dy: float) -> bool:
    """Whether an arc is there in the direction of a vector from its centre, in the frame of the pegs."""
    c, s, scale = cos(theta), sin(theta), piece[RADIUS] / length(dx, dy)
    return on_piece(piece, piece[X] + scale * (c * dx + s * dy), piece[Y] + scale * (c * dy - s * dx), END)


@inner
def add_about(
    p: int,
    b: int,
    q: int,
    a: int,
    f: int,
    c: int,
    side: float,
    given: Given,
    stop: float,
    widest: float,
    out: Array,
    at: int,
) -> int:
    """Writes the candidates of pegs on arcs of one centre, and on a piece whose normal goes through it.

    Peg p is on arc a and peg b on piece f, both of one jaw. Peg q of the other jaw is on arc c, which has the
    centre of a, and the foot of the centre is on a side of f. Returns the new count, or -1 where they do not
    fit.
    """
    arc, other, piece = given.rows[a], given.rows[c], given.rows[f]
    cx, cy = arc[X], arc[Y]
    touched = foot(piece, cx, cy, side)
    ex, ey = touched[0] - cx, touched[1] - cy
    far = length(ex, ey)
    if far < NEAREST or not on_piece(piece, touched[0], touched[1], END):
        return at
    dx, dy = given.pegs[b, 0] - given.pegs[p, 0], given.pegs[b, 1] - given.pegs[p, 1]
    d = length(dx, dy)
    along = (arc[RADIUS] * arc[RADIUS] - far * far + d * d) / (2.0 * d)
    square = arc[RADIUS] * arc[RADIUS] - along * along
    if square < NEAREST * NEAREST:
        return at
    moving = 1.0 if given.right[q] == 1 else -1.0
    # How fast b's piece goes away from the centre as the part turns: of a line as far as it is, of an arc m /
    # radius times that, with a centre m away, or where the foot is on the far side minus that.
    bend = far if piece[IS_ARC] == 0.0 else side * touched[4] / piece[RADIUS] * far
    for way in range(4):
        off = (1.0 - 2.0 * (way % 2)) * sqrt(square)
        # The centre, at separation 0 of the jaw of p and b, and the two pegs from it.
        x, y = given.pegs[p, 0] + (along * dx - off * dy) / d, given.pegs[p, 1] + (along * dy + off * dx) / d
        px, py, bx, by = given.pegs[p, 0] - x, given.pegs[p, 1] - y, given.pegs[b, 0] - x, given.pegs[b, 1] - y
        theta = atan2(by, bx) - atan2(ey, ex)
        qy = given.pegs[q, 1] - y
        level = other[RADIUS] * other[RADIUS] - qy * qy
        if level < NEAREST * NEAREST:
            continue
        qx = (1.0 - 2.0 * (way // 2)) * sqrt(level)
        s = moving * (x + qx - given.pegs[q, 0])
        if not (stop < s < widest and is_touched(arc, theta, px, py) and is_touched(other, theta, qx, qy)):
            continue
        if at >= out.shape[0]:
            return -1
        row, cosine, sine = out[at], cos(theta), sin(theta)
        x += s * given.right[p]
        turned_x, turned_y = cosine * cx - sine * cy, sine * cx + cosine * cy
        write_pose(row, theta, x - turned_x, y - turned_y, 3)
        row[SEPARATION] = s
        row[PEG], row[PEG + 1], row[PEG + 2] = p, b, q
        row[PIECE], row[PIECE + 1], row[PIECE + 2] = a, f, c
        # The centre stays as the part turns; to second order it moves across p, as b's piece goes away or
        # comes nearer.
        pull = -bend * far / (bx * -py + by * px)
        row[SECOND] = moving * pull * (qx * -py + qy * px) / qx
        row[MOTION], row[MOTION + 1], row[MOTION + 2] = 1.0, turned_y, -turned_x
        at += 1
    return at


@compiled
def about_one_center(given: Given, stop: float, widest: float, out: Array) -> int:
    """Writes the candidates (N, 24) of pegs on two arcs of one centre and a piece with a normal through it.

    The arcs are those of pegs p and q of both jaws, the piece that of peg b of p's jaw. Returns their number,
    or -1 where they do not fit.
    """
    count = 0
    for p in range(given.pegs.shape[0]):
        first, end = given.parts[given.right[p], 0], given.parts[given.right[p], 1]
        for q in range(given.pegs.shape[0]):
            if given.right[q] == given.right[p]:
                continue
            for a in range(first, end):
                if given.rows[a, IS_ARC] == 0.0:
                    continue
                for c in range(given.parts[given.right[q], 0], given.parts[given.right[q], 1]):
                    if not share_normals(given.rows[a], given.rows[c]):
                        continue
                    for b in range(given.pegs.shape[0]):
                        if b == p or given.right[b] != given.right[p]:
                            continue
                        for f in range(first, end):
                            if share_normals(given.rows[a], given.rows[f]):
                                continue
                            for sides in range(1 if given.rows[f, IS_ARC] == 0.0 else 2):
                                side = 1.0 - 2.0 * sides
                                count = add_about(p, b, q, a, f, c, side, given, stop, widest, out, count)
                                if count < 0:
                                    return -1
    return count
