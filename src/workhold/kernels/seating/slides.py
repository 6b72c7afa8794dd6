"""Equilibria of parts that slide on two pegs of one jaw, along parallel faces or equal arcs, until pegs block
them.

Columns of a slide: the pegs SLIDE_FIRST and SLIDE_SECOND, the pieces SLIDE_ONE and SLIDE_TWO that they touch,
and the parameters SLIDE_LOW and SLIDE_HIGH of the first on its piece. SLIDE_PSI is the orientation of the
pegs seen from the part, in radians. A slide is blocked at two parameters at most, on a circle up to whole
turns: NaN where there is none.
"""

from __future__ import annotations

from math import acos, atan2, ceil, cos, hypot, nan, pi, sin, sqrt

from workhold.conventions import END_SLACK
from workhold.kernels.base.compiling import (
    Array,
    IntMatrix,
    Matrix,
    compiled,
    inner,
)
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, IS_ARC, RADIUS, SIGN, X, Y
from workhold.kernels.base.interval import TURN
from workhold.kernels.base.tables import FROM, TO
from workhold.kernels.seating.candidates import place_third, write_pair, write_pose
from workhold.kernels.seating.columns import (
    ANGLE,
    FIRST_PEG,
    HIGH,
    KIND,
    LOW,
    MOTION,
    PAIR,
    PEG,
    PIECE,
    SECOND,
    SOURCE,
    HeldPart,
    JawCells,
)
from workhold.kernels.seating.obstacles import is_on_piece
from workhold.kernels.seating.two_contact_curves import (
    compute_pair_height,
    compute_pair_state,
    is_on_its_pieces,
)

SLIDE_FIRST, SLIDE_SECOND, SLIDE_ONE, SLIDE_TWO, SLIDE_LOW, SLIDE_HIGH, SLIDE_PSI = range(7)
SLIDE_LENGTH = 7
# Rounding of parameters, in mm or radians; slopes below the second are level.
HAIR, LEVEL = 1e-12, 1e-12
# Radians by which an orientation may be outside a cell that it is looked for in: rounding.
BESIDE = 1e-9
Two = tuple[float, float]
NONE = (nan, nan)


@inner
def turn_parameter_in(slide: Array, row: Array, t: float, turn: int) -> float:
    """Return a parameter t of the first peg, shifted by turns, if it then lies within a slide's range; else
    NaN.

    Two cases: (a) on an arc, t is brought into [-pi, pi) and ``turn`` (-1, 0 or 1) whole turns are added; (b)
    on a line t stays as it is, and the result is NaN unless ``turn`` is 0. See ``seating.slides`` for the
    layout of ``slide``, ``base.feature`` for that of ``row``.
    """
    if row[IS_ARC] != 0.0:
        t = (t + pi) % TURN - pi + turn * TURN
    elif turn != 0:
        return nan
    return t if slide[SLIDE_LOW] - HAIR <= t <= slide[SLIDE_HIGH] + HAIR else nan


@inner
def compute_middle_angle(row: Array) -> float:
    """Return the direction in radians from an arc's centre to its middle, 0 for a line.

    See ``base.feature`` for the layout of ``row``.
    """
    return atan2(row[AXIS_Y], row[AXIS_X]) if row[IS_ARC] != 0.0 else 0.0


@inner
def compute_first_peg_place(row: Array, middle: float, t: float) -> Two:
    """Return the place (x, y) in mm of the first peg at the parameter t of its piece.

    ``middle`` is the result of :func:`compute_middle_angle` for the piece. See ``base.feature`` for the
    layout of ``row``.
    """
    if row[IS_ARC] != 0.0:
        return (row[X] + row[RADIUS] * cos(middle + t), row[Y] + row[RADIUS] * sin(middle + t))
    return (row[X] + t * row[AXIS_X], row[Y] + t * row[AXIS_Y])


@inner
def find_track_crossings(row: Array, middle: float, nx: float, ny: float, level: float) -> Two:
    """Return the two parameters at which a point u of a piece's line or circle has n . u equal to ``level``
    mm.

    (nx, ny) is the unit vector n. NaN stands for a parameter that does not exist; a line has at most one.
    ``middle`` is that of :func:`compute_middle_angle`. See ``base.feature`` for the layout of ``row``.
    """
    start = nx * row[X] + ny * row[Y]
    if row[IS_ARC] != 0.0:
        cosine = (level - start) / row[RADIUS]
        if abs(cosine) > 1.0:
            return NONE
        towards, away = atan2(ny, nx) - middle, acos(cosine)
        return (towards + away, towards - away)
    rise = nx * row[AXIS_X] + ny * row[AXIS_Y]
    return NONE if abs(rise) < LEVEL else ((level - start) / rise, nan)


@inner
def begin_candidate(out: Array, slide: Array, x: float, y: float, contacts: int, given: HeldPart) -> None:
    """Write a candidate that has the two contacts of a slide to ``out`` (24,), with ``contacts`` contacts in
    all.

    The first peg is at (x, y) in the part's frame; the part is placed as at separation 0. See
    ``seating.slides`` for the layout of ``slide``, ``seating.columns`` for that of candidates.
    """
    c, s = cos(slide[SLIDE_PSI]), sin(slide[SLIDE_PSI])
    first = int(slide[SLIDE_FIRST])
    px, py = given.pegs[first, 0] - (c * x + s * y), given.pegs[first, 1] - (c * y - s * x)
    write_pose(out, -slide[SLIDE_PSI], px, py, contacts)
    out[PEG], out[PEG + 1] = slide[SLIDE_FIRST], slide[SLIDE_SECOND]
    out[PIECE], out[PIECE + 1] = slide[SLIDE_ONE], slide[SLIDE_TWO]


@inner
def find_parallel_normals(
    slide: Array, row: Array, middle: float, piece: Array, side: float, above: float
) -> Two:
    """Return the two parameters of a slide at which a third peg touches a piece with a normal parallel to the
    first peg's normal.

    The third peg is ``above`` mm over the first; ``side`` (1 or -1) selects the sense of the normal. NaN
    stands for those that do not exist. See ``seating.slides`` for the layout of ``slide``, ``base.feature``
    for that of ``row`` and ``piece``.
    """
    ux, uy = -sin(slide[SLIDE_PSI]), cos(slide[SLIDE_PSI])
    if row[IS_ARC] == 0.0:
        if piece[IS_ARC] == 0.0:
            return NONE
        x, y = piece[X] + side * piece[RADIUS] * row[AXIS_Y], piece[Y] - side * piece[RADIUS] * row[AXIS_X]
        return find_track_crossings(row, middle, ux, uy, ux * x + uy * y - above)
    if piece[IS_ARC] == 0.0:
        return (atan2(-side * piece[AXIS_X], side * piece[AXIS_Y]) - middle, nan)
    apart = side * piece[RADIUS] - row[RADIUS]
    if abs(apart) <= HAIR:
        return NONE
    level = (above - ux * (piece[X] - row[X]) - uy * (piece[Y] - row[Y])) / apart
    return find_track_crossings(row, middle, ux, uy, ux * row[X] + uy * row[Y] + row[RADIUS] * level)


@inner
def compute_third_peg_place(
    slide: Array, row: Array, middle: float, piece: Array, side: float, above: float, t: float
) -> Two:
    """Return the place (x, y) on the part of the third peg of
    :func:`find_parallel_normals` at parameter t, NaN for none.

    See ``seating.slides`` for the layout of ``slide``, ``base.feature`` for that of ``row`` and ``piece``.
    """
    if row[IS_ARC] == 0.0:
        return (piece[X] + side * piece[RADIUS] * row[AXIS_Y], piece[Y] - side * piece[RADIUS] * row[AXIS_X])
    if piece[IS_ARC] == 0.0:
        ux, uy = -sin(slide[SLIDE_PSI]), cos(slide[SLIDE_PSI])
        x, y = compute_first_peg_place(row, middle, t)
        rise = ux * piece[AXIS_X] + uy * piece[AXIS_Y]
        if abs(rise) <= LEVEL:
            return NONE
        along = (ux * (x - piece[X]) + uy * (y - piece[Y]) + above) / rise
        return (piece[X] + along * piece[AXIS_X], piece[Y] + along * piece[AXIS_Y])
    ex, ey = cos(middle + t), sin(middle + t)
    return (piece[X] + side * piece[RADIUS] * ex, piece[Y] + side * piece[RADIUS] * ey)


@compiled
def write_parallel_third_contacts(slides: Matrix, given: HeldPart, out: Matrix) -> int:
    """Write the candidates in which a slide (S, 7) is stopped by a peg of the other jaw with a parallel
    normal to ``out``.

    The third peg is on an arc or, if the part moves round an arc, on a line. Return the number of candidates
    (N, 24), -1 when there is no room. See ``seating.slides`` for the layout of ``slides``,
    ``seating.columns`` for that of candidates.
    """
    count = 0
    for n in range(slides.shape[0]):
        slide = slides[n]
        row, first = given.rows[int(slide[SLIDE_ONE])], int(slide[SLIDE_FIRST])
        middle, c, s = compute_middle_angle(row), cos(slide[SLIDE_PSI]), sin(slide[SLIDE_PSI])
        for third in range(given.pegs.shape[0]):
            if given.right[third] == given.right[first]:
                continue
            above = given.pegs[third, 1] - given.pegs[first, 1]
            for number in range(given.parts[given.right[third], 0], given.parts[given.right[third], 1]):
                piece = given.rows[number]
                # The part moves on one circle, the peg on another: the sum of radii gives the curvature.
                total = piece[SIGN] * piece[RADIUS] if piece[IS_ARC] != 0.0 else 0.0
                total += row[SIGN] * row[RADIUS] if row[IS_ARC] != 0.0 else 0.0
                ts = NONE
                for way in range(12):
                    side, turn = 1.0 - 2.0 * (way // 6), way % 3 - 1
                    if way % 6 == 0:
                        ts = find_parallel_normals(slide, row, middle, piece, side, above)
                    t = turn_parameter_in(slide, row, ts[0] if way // 3 % 2 == 0 else ts[1], turn)
                    if t != t:
                        continue
                    x, y = compute_third_peg_place(slide, row, middle, piece, side, above, t)
                    if x != x or not is_on_piece(piece, x, y, END_SLACK):
                        continue
                    if count >= out.shape[0]:
                        return -1
                    one = out[count]
                    begin_candidate(one, slide, *compute_first_peg_place(row, middle, t), 3, given)
                    one[PEG + 2], one[PIECE + 2] = third, number
                    one[SECOND] = -1.0 / total if abs(total) > HAIR else 0.0
                    place_third(one, c * x + s * y, third, given)
                    mx, my = row[AXIS_X], row[AXIS_Y]
                    if row[IS_ARC] != 0.0:
                        mx, my = -sin(middle + t), cos(middle + t)
                    one[MOTION + 1], one[MOTION + 2] = c * mx + s * my, c * my - s * mx
                    count += 1
    return count


@inner
def turn_into_range(pair: Array, given: HeldPart, psi: float) -> float:
    """Return an orientation psi shifted by whole turns and clamped into the range of a pair.

    For a pocket, which has no range, psi is returned unchanged. See ``seating.columns`` for the layout of
    ``pair``.
    """
    if pair[KIND] == 1.0:
        return psi
    k = int(pair[SOURCE])
    low, high = given.reals[k, FROM] - pair[ANGLE], given.reals[k, TO] - pair[ANGLE]
    return min(max(psi + TURN * ceil((low - BESIDE - psi) / TURN), low), high)


@compiled
def write_held_slides(
    slides: Matrix, left: JawCells, right: JawCells, given: HeldPart, pocket_pieces: IntMatrix, out: Matrix
) -> int:
    """Write the candidates in which a slide (S, 7) and a pair of the other jaw hold the part to ``out`` (N,
    24).

    Slide and pair then fit the part at one height. Return the number of candidates, -1 when there is no room.
    See ``seating.slides`` for the layout of ``slides``, ``seating.columns`` for that of candidates.
    """
    count = 0
    for n in range(slides.shape[0]):
        slide = slides[n]
        row, first, psi = given.rows[int(slide[SLIDE_ONE])], int(slide[SLIDE_FIRST]), slide[SLIDE_PSI]
        middle, c, s, within = compute_middle_angle(row), cos(psi), sin(psi), psi % TURN
        jaw = left if given.right[first] == 1 else right
        for number in range(jaw.cells.shape[0]):
            cell = jaw.cells[number]
            if cell[LOW] - BESIDE > within:
                break
            if cell[HIGH] + BESIDE < within:
                continue
            pair = given.pairs[int(cell[PAIR]) + jaw.before]
            exact = turn_into_range(pair, given, psi)
            there = compute_pair_state(pair, given, exact)
            if not is_on_its_pieces(pair, given, exact, there.x, there.y):
                continue
            level = (
                compute_pair_height(pair, given, there.x, there.y, cos(exact), sin(exact))
                + given.pegs[first, 1]
            )
            ts = find_track_crossings(row, middle, -s, c, level)
            for way in range(6):
                t = turn_parameter_in(slide, row, ts[0] if way < 3 else ts[1], way % 3 - 1)
                if t != t:
                    continue
                if count >= out.shape[0]:
                    return -1
                one = out[count]
                begin_candidate(one, slide, *compute_first_peg_place(row, middle, t), 4, given)
                place_third(one, c * there.x + s * there.y, int(pair[FIRST_PEG]), given)
                write_pair(one, 2, pair, given, pocket_pieces)
                count += 1
    return count


@inner
def find_blocking_parameters(row: Array, middle: float, piece: Array, ox: float, oy: float) -> Two:
    """Return the two parameters of a slide at which another peg is on the line or circle of a piece; NaN for
    none.

    The other peg is (ox, oy) mm from the slide's first peg, in the part's frame. ``row`` is the first peg's
    piece, ``middle`` its :func:`compute_middle_angle`. See ``base.feature`` for the layout of ``row`` and
    ``piece``.
    """
    if piece[IS_ARC] == 0.0:
        nx, ny = piece[AXIS_Y], -piece[AXIS_X]
        return find_track_crossings(row, middle, nx, ny, nx * (piece[X] - ox) + ny * (piece[Y] - oy))
    gx, gy = piece[X] - ox - row[X], piece[Y] - oy - row[Y]
    if row[IS_ARC] == 0.0:
        along, across = gx * row[AXIS_X] + gy * row[AXIS_Y], gx * row[AXIS_Y] - gy * row[AXIS_X]
        square = (piece[RADIUS] - across) * (piece[RADIUS] + across)
        return (along + sqrt(square), along - sqrt(square)) if square >= 0.0 else NONE
    size = hypot(gx, gy)
    if size < HAIR:
        return NONE
    cosine = (size * size + row[RADIUS] ** 2 - piece[RADIUS] ** 2) / (2.0 * size * row[RADIUS])
    if abs(cosine) > 1.0:
        return NONE
    towards, away = atan2(gy, gx) - middle, acos(cosine)
    return (towards + away, towards - away)


@compiled
def write_blocked_slides(slides: Matrix, given: HeldPart, out: Matrix) -> int:
    """Write the candidates in which a slide (S, 7) is blocked by a third peg of its own jaw to ``out``.

    The part's place is that at separation 0. Return the number of candidates (N, 24), -1 when there is no
    room. See ``seating.slides`` for the layout of ``slides``, ``seating.columns`` for that of candidates.
    """
    count = 0
    for n in range(slides.shape[0]):
        slide = slides[n]
        row, first = given.rows[int(slide[SLIDE_ONE])], int(slide[SLIDE_FIRST])
        middle, c, s = compute_middle_angle(row), cos(slide[SLIDE_PSI]), sin(slide[SLIDE_PSI])
        jaw = given.right[first]
        for third in range(given.pegs.shape[0]):
            if given.right[third] != jaw or third == first or third == int(slide[SLIDE_SECOND]):
                continue
            dx, dy = given.pegs[third, 0] - given.pegs[first, 0], given.pegs[third, 1] - given.pegs[first, 1]
            ox, oy = c * dx - s * dy, s * dx + c * dy
            for number in range(given.parts[jaw, 0], given.parts[jaw, 1]):
                piece = given.rows[number]
                ts = find_blocking_parameters(row, middle, piece, ox, oy)
                for way in range(6):
                    t = turn_parameter_in(slide, row, ts[0] if way < 3 else ts[1], way % 3 - 1)
                    if t != t:
                        continue
                    x, y = compute_first_peg_place(row, middle, t)
                    if not is_on_piece(piece, x + ox, y + oy, END_SLACK):
                        continue
                    if count >= out.shape[0]:
                        return -1
                    begin_candidate(out[count], slide, x, y, 3, given)
                    out[count, PEG + 2], out[count, PIECE + 2] = third, number
                    count += 1
    return count
