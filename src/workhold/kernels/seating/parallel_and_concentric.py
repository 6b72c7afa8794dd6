"""Three pegs in special position: their forces are parallel, or meet in the common centre of two arcs.

Forces are parallel at the tangencies of a chord, and on three parallel faces along which the part slides.

About the common centre of two arcs a peg of each jaw is on the arcs, and a further one where the normal of
its piece goes through the centre. Chords do not tell where: the normals of the two arcs meet in the centre
wherever the arcs are touched. But of two pegs of one jaw, one is at the distance of its arc's radius from the
centre, and the other is at the foot of the perpendicular from the centre to its piece. That places the
centre, and turns the part.
"""

from __future__ import annotations

from math import atan2, cos, hypot, sin, sqrt

import numpy as np

from workhold.conventions import END_SLACK
from workhold.kernels.base.compiling import (
    Array,
    Matrix,
    compiled,
    inner,
)
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, RADIUS, X, Y
from workhold.kernels.chord.intervals import are_parallel
from workhold.kernels.seating.candidates import write_pose
from workhold.kernels.seating.columns import MOTION, PEG, PIECE, SECOND, SEPARATION, HeldPart
from workhold.kernels.seating.obstacles import compute_length, find_foot, is_on_piece, share_normals
from workhold.kernels.seating.slides import (
    SLIDE_FIRST,
    SLIDE_HIGH,
    SLIDE_LOW,
    SLIDE_ONE,
    SLIDE_PSI,
    SLIDE_SECOND,
    SLIDE_TWO,
)
from workhold.kernels.seating.two_contact_curves import END

# Radians by which the orientation is changed to see on which side a chord goes on.
STEP = 1e-6
# No unit: faces whose normals have less along x are level, not pressed. mm: forces this near are in line.
LEVEL, SHORTEST = 1e-9, 1e-6
# Columns of tangencies: line and arc, the chord's tail on the line, its direction on the part in radians.
ON_LINE, ON_ARC, TAIL_X, TAIL_Y, ALPHA = range(5)
# Columns of what slides on three faces: number of the slide, third peg and its face, orientation, S,
# parameters between which the first peg slides.
OF_SLIDE, THIRD, ON_THIRD, AT_THETA, AT_SEPARATION, AT_LOW, AT_HIGH = range(7)
THREE_FACES = 7


@compiled
def write_tangent_chords(rows: Matrix, first: int, end: int, d: float, out: Matrix) -> int:
    """Write the tangencies of chords of length d mm from lines to arcs to ``out`` (C, 5).

    Return their number, -1 when there is no room. Both are pieces from ``first`` to ``end``, and the arc's
    normal at the head is parallel to the line's. Columns: ON_LINE and ON_ARC (numbers of the pieces), TAIL_X
    and TAIL_Y of the tail on the line in mm, and ALPHA, the chord's direction on the part in radians. See
    ``base.feature`` for the layout of ``rows``.
    """
    count = 0
    for a in range(first, end):
        line = rows[a]
        if line[IS_ARC] != 0.0:
            continue
        nx, ny = line[AXIS_Y], -line[AXIS_X]
        for number in range(2 * first, 2 * end):
            arc, side = rows[number // 2], 1.0 - 2.0 * (number % 2)
            if arc[IS_ARC] == 0.0:
                continue
            x, y = arc[X] + side * arc[RADIUS] * nx, arc[Y] + side * arc[RADIUS] * ny
            rise = (x - line[X]) * nx + (y - line[Y]) * ny
            if abs(rise) >= d or not is_on_piece(arc, x, y, END_SLACK):
                continue
            for way in range(2):
                run = (1.0 - 2.0 * way) * sqrt(d * d - rise * rise)
                wx, wy = rise * nx + run * line[AXIS_X], rise * ny + run * line[AXIS_Y]
                if not is_on_piece(line, x - wx, y - wy, END_SLACK):
                    continue
                if count >= out.shape[0]:
                    return -1
                row = out[count]
                row[ON_LINE], row[ON_ARC], row[ALPHA] = a, number // 2, atan2(wy, wx)
                row[TAIL_X], row[TAIL_Y] = x - wx, y - wy
                count += 1
    return count


@inner
def find_separation(
    theta: float, line: Array, other: Array, first: int, third: int, given: HeldPart
) -> tuple[bool, float]:
    """Return (whether the forces have an x component, jaw separation S in mm) for two pegs on parallel lines.

    Peg ``first`` is on ``line``, peg ``third`` of the other jaw on ``other``. ``theta`` is the part's
    orientation. Where the lines are level, S is not determined, and 0 is returned. See ``base.feature`` for
    the layout of ``line`` and ``other``.
    """
    nx = cos(theta) * line[AXIS_Y] + sin(theta) * line[AXIS_X]
    ny = sin(theta) * line[AXIS_Y] - cos(theta) * line[AXIS_X]
    moving = nx * (given.right[third] - given.right[first])
    if abs(moving) < LEVEL:
        return (False, 0.0)
    gap = (other[X] - line[X]) * line[AXIS_Y] - (other[Y] - line[Y]) * line[AXIS_X]
    run, rise = given.pegs[third, 0] - given.pegs[first, 0], given.pegs[third, 1] - given.pegs[first, 1]
    return (True, (gap - run * nx - rise * ny) / moving)


@compiled
def write_at_tangencies(
    first: int, second: int, chords: Matrix, stop: float, widest: float, given: HeldPart, out: Matrix
) -> int:
    """Write the candidates of two pegs of one jaw at tangencies of
    their chord, with a third peg, to ``out`` (N, 24).

    The third peg, of the other jaw, is on a line parallel to the first's, or on the same line. Return the
    number of candidates, -1 when there is no room. See ``seating.parallel_and_concentric`` for the layout of
    ``chords``, ``seating.columns`` for that of candidates.

    Parameters
    ----------
    first, second : numbers of the chord's pegs.
    chords : (C, 5), see :func:`write_tangent_chords`.
    stop, widest : separations in mm between which S must lie.
    """
    count = 0
    dx, dy = given.pegs[second, 0] - given.pegs[first, 0], given.pegs[second, 1] - given.pegs[first, 1]
    d = hypot(dx, dy)
    for n in range(chords.shape[0]):
        chord = chords[n]
        theta = atan2(dy, dx) - chord[ALPHA]
        c, e = cos(theta), sin(theta)
        line, arc = given.rows[int(chord[ON_LINE])], given.rows[int(chord[ON_ARC])]
        for third in range(given.pegs.shape[0]):
            if given.right[third] == given.right[first]:
                continue
            for number in range(given.parts[given.right[third], 0], given.parts[given.right[third], 1]):
                other = given.rows[number]
                if not are_parallel(line, other):
                    continue
                known, s = find_separation(theta, line, other, first, third, given)
                if not known or not (stop < s < widest):
                    continue
                run = (
                    given.pegs[third, 0]
                    - given.pegs[first, 0]
                    + s * (given.right[third] - given.right[first])
                )
                rise = given.pegs[third, 1] - given.pegs[first, 1]
                if not is_on_piece(
                    other, chord[TAIL_X] + c * run + e * rise, chord[TAIL_Y] + c * rise - e * run, END_SLACK
                ):
                    continue
                if count >= out.shape[0]:
                    return -1
                row = out[count]
                x = given.pegs[first, 0] + s * given.right[first] - (c * chord[TAIL_X] - e * chord[TAIL_Y])
                y = given.pegs[first, 1] - (e * chord[TAIL_X] + c * chord[TAIL_Y])
                write_pose(row, theta, x, y, 3)
                row[SEPARATION] = s
                row[PEG], row[PEG + 1], row[PEG + 2] = first, second, third
                row[PIECE], row[PIECE + 1], row[PIECE + 2] = chord[ON_LINE], chord[ON_ARC], number
                # The chord goes on to the side on which the arc is met.
                nx, ny, turn = line[AXIS_Y], -line[AXIS_X], -STEP
                for way in range(2):
                    step = STEP - 2.0 * STEP * way
                    alpha = atan2(dy, dx) - (theta + step)
                    wx, wy = d * cos(alpha), d * sin(alpha)
                    if abs((line[X] + wx - arc[X]) * nx + (line[Y] + wy - arc[Y]) * ny) < arc[RADIUS]:
                        turn = step
                known, after = find_separation(theta + turn, line, other, first, third, given)
                row[SECOND] = (after - s) / STEP if known else 0.0
                row[MOTION + 1] = c * line[AXIS_X] - e * line[AXIS_Y]
                row[MOTION + 2] = e * line[AXIS_X] + c * line[AXIS_Y]
                count += 1
    return count


@inner
def is_between(p: float, q: float, r: float, one: float, two: float, three: float) -> bool:
    """Return whether, of three parallel forces, the middle one has the sign opposite to both others.

    p, q, r are the positions of the forces in mm; ``one``, ``two``, ``three`` their signs (1 or -1). Forces
    must be more than ``SHORTEST`` apart.
    """
    if p > q:
        p, q, one, two = q, p, two, one
    if q > r:
        q, r, two, three = r, q, three, two
    if p > q:
        p, q, one, two = q, p, two, one
    return q - p > SHORTEST and r - q > SHORTEST and one == three == -two


@compiled
def write_on_three_faces(slides: Matrix, given: HeldPart, stop: float, widest: float, out: Matrix) -> int:
    """Write the self-motions along three parallel faces, where the middle force opposes the outer two, to
    ``out`` (N, 7).

    Two pegs of one jaw are on a slide (S, 7), and the third is of the other jaw. Return their number, -1 when
    there is no room. Columns: OF_SLIDE (number of the slide), THIRD peg, ON_THIRD (its piece), AT_THETA in
    radians, AT_SEPARATION in mm, AT_LOW and AT_HIGH (parameters in mm between which the first peg slides).
    See ``seating.slides`` for the layout of ``slides``.
    """
    count = 0
    for n in range(slides.shape[0]):
        slide = slides[n]
        first, second = int(slide[SLIDE_FIRST]), int(slide[SLIDE_SECOND])
        one, mate = given.rows[int(slide[SLIDE_ONE])], given.rows[int(slide[SLIDE_TWO])]
        theta = -slide[SLIDE_PSI]
        c, d = cos(theta), sin(theta)
        # The face's direction and its outward normal in the frame of the pegs.
        tx, ty = c * one[AXIS_X] - d * one[AXIS_Y], d * one[AXIS_X] + c * one[AXIS_Y]
        nx, ny = ty, -tx
        if one[IS_ARC] != 0.0 or abs(nx) < LEVEL:
            continue
        for k in range(given.pegs.shape[0]):
            if given.right[k] == given.right[first]:
                continue
            for number in range(given.parts[given.right[k], 0], given.parts[given.right[k], 1]):
                two = given.rows[number]
                if not are_parallel(one, two):
                    continue
                facing = two[AXIS_X] * one[AXIS_X] + two[AXIS_Y] * one[AXIS_Y]
                beside = mate[AXIS_X] * one[AXIS_X] + mate[AXIS_Y] * one[AXIS_Y]
                moving = 1.0 if given.right[k] == 1 else -1.0
                if np.sign(facing) * moving * nx <= 0.0:
                    continue
                thick = (one[X] - two[X]) * one[AXIS_Y] - (one[Y] - two[Y]) * one[AXIS_X]
                run, rise = given.pegs[k, 0] - given.pegs[first, 0], given.pegs[k, 1] - given.pegs[first, 1]
                s = -(thick + run * nx + rise * ny) / (moving * nx)
                if not (stop < s < widest):
                    continue
                p = (given.pegs[first, 0] + s * given.right[first]) * tx + given.pegs[first, 1] * ty
                q = (given.pegs[second, 0] + s * given.right[second]) * tx + given.pegs[second, 1] * ty
                r = (given.pegs[k, 0] + s * given.right[k]) * tx + given.pegs[k, 1] * ty
                if not is_between(p, q, r, 1.0, np.sign(beside), np.sign(facing)):
                    continue
                shift = (two[X] - one[X]) * one[AXIS_X] + (two[Y] - one[Y]) * one[AXIS_Y] - (r - p)
                low = max(slide[SLIDE_LOW], shift - two[HALF_EXTENT])
                high = min(slide[SLIDE_HIGH], shift + two[HALF_EXTENT])
                if high - low < SHORTEST:
                    continue
                if count >= out.shape[0]:
                    return -1
                row = out[count]
                row[OF_SLIDE], row[THIRD], row[ON_THIRD], row[AT_THETA] = n, k, number, theta
                row[AT_SEPARATION] = s
                row[AT_LOW], row[AT_HIGH] = low, high
                count += 1
    return count


# mm. Feet nearer to the centre have no direction from it; centres nearer to the line of two pegs are on it.
NEAREST = 1e-6


@inner
def is_touched(piece: Array, theta: float, dx: float, dy: float) -> bool:
    """Return whether the direction (dx, dy) from an arc's centre leads to a point of the arc itself, not only
    of its circle.

    The direction is in the frame of the pegs, theta the part's orientation. See ``base.feature`` for the
    layout of ``piece``.
    """
    c, s, scale = cos(theta), sin(theta), piece[RADIUS] / compute_length(dx, dy)
    return is_on_piece(piece, piece[X] + scale * (c * dx + s * dy), piece[Y] + scale * (c * dy - s * dx), END)


@inner
def add_about_one_center(
    p: int,
    b: int,
    q: int,
    a: int,
    f: int,
    c: int,
    side: float,
    given: HeldPart,
    stop: float,
    widest: float,
    out: Array,
    at: int,
) -> int:
    """Append the candidates of pegs on two arcs with one centre and
    on a piece whose normal goes through it to ``out``.

    Peg p is on arc a and peg b on piece f, both of one jaw. Peg q of the other jaw is on arc c, which has the
    centre of a. ``side`` selects the foot of the centre on f, see ``obstacles.find_foot``. Return the new
    number of candidates (``at`` before), -1 when there is no room.
    """
    arc, other, piece = given.rows[a], given.rows[c], given.rows[f]
    cx, cy = arc[X], arc[Y]
    touched = find_foot(piece, cx, cy, side)
    ex, ey = touched.x - cx, touched.y - cy
    far = compute_length(ex, ey)
    if far < NEAREST or not is_on_piece(piece, touched.x, touched.y, END):
        return at
    dx, dy = given.pegs[b, 0] - given.pegs[p, 0], given.pegs[b, 1] - given.pegs[p, 1]
    d = compute_length(dx, dy)
    along = (arc[RADIUS] * arc[RADIUS] - far * far + d * d) / (2.0 * d)
    square = arc[RADIUS] * arc[RADIUS] - along * along
    if square < NEAREST * NEAREST:
        return at
    moving = 1.0 if given.right[q] == 1 else -1.0
    # How fast b's piece goes away from the centre as the part turns: of a line as far as it is, of an arc m /
    # radius times that, with a centre m away, or where the foot is on the far side minus that.
    bend = far if piece[IS_ARC] == 0.0 else side * touched.distance / piece[RADIUS] * far
    for way in range(4):
        off = (1.0 - 2.0 * (way % 2)) * sqrt(square)
        # The centre, at separation 0 of the jaw of p and b, and the two pegs from it.
        x, y = given.pegs[p, 0] + (along * dx - off * dy) / d, given.pegs[p, 1] + (along * dy + off * dx) / d
        px, py = given.pegs[p, 0] - x, given.pegs[p, 1] - y
        bx, by = given.pegs[b, 0] - x, given.pegs[b, 1] - y
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
        # The centre stays as the part turns; to second order it moves across p, as b's distance changes.
        pull = -bend * far / (bx * -py + by * px)
        row[SECOND] = moving * pull * (qx * -py + qy * px) / qx
        row[MOTION], row[MOTION + 1], row[MOTION + 2] = 1.0, turned_y, -turned_x
        at += 1
    return at


@compiled
def write_about_one_center(given: HeldPart, stop: float, widest: float, out: Matrix) -> int:
    """Write all candidates of pegs on two arcs with one centre and on
    a piece with a normal through it to ``out`` (N, 24).

    The arcs are touched by a peg of each jaw, the piece by another peg of either jaw. Return their number, -1
    when there is no room. ``stop`` and ``widest`` are separations in mm between which S must lie. See
    ``seating.columns`` for the layout of candidates.
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
                                count = add_about_one_center(
                                    p, b, q, a, f, c, side, given, stop, widest, out, count
                                )
                                if count < 0:
                                    return -1
    return count
