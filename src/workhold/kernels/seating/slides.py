"""Equilibria of parts that slide on two pegs of one jaw, on parallel faces or equal arcs, until pegs block
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
    Given,
    JawCells,
)
from workhold.kernels.seating.obstacles import on_piece
from workhold.kernels.seating.two_contact_curves import height, is_on_its_pieces, pair_at

SLIDE_FIRST, SLIDE_SECOND, SLIDE_ONE, SLIDE_TWO, SLIDE_LOW, SLIDE_HIGH, SLIDE_PSI = range(7)
SLIDE_LENGTH = 7
# Rounding of parameters, in mm or radians; slopes below the second are level.
HAIR, LEVEL = 1e-12, 1e-12
# Radians by which an orientation may be outside a cell that it is looked for in: rounding.
BESIDE = 1e-9
Two = tuple[float, float]
NONE = (nan, nan)


@inner
def turned_in(slide: Array, row: Array, t: float, turn: int) -> float:
    """A parameter that a slide has, of a circle moved by -1, 0 or 1 whole turns; NaN where it has not."""
    if row[IS_ARC] != 0.0:
        t = (t + pi) % TURN - pi + turn * TURN
    elif turn != 0:
        return nan
    return t if slide[SLIDE_LOW] - HAIR <= t <= slide[SLIDE_HIGH] + HAIR else nan


@inner
def middle_of(row: Array) -> float:
    """Direction in radians of the middle of an arc, 0 of a line."""
    return atan2(row[AXIS_Y], row[AXIS_X]) if row[IS_ARC] != 0.0 else 0.0


@inner
def track_at(row: Array, middle: float, t: float) -> Two:
    """Place of the first peg at a parameter."""
    if row[IS_ARC] != 0.0:
        return (row[X] + row[RADIUS] * cos(middle + t), row[Y] + row[RADIUS] * sin(middle + t))
    return (row[X] + t * row[AXIS_X], row[Y] + t * row[AXIS_Y])


@inner
def track_crossing(row: Array, middle: float, nx: float, ny: float, level: float) -> Two:
    """Parameters at which n . u has a value, n a unit vector."""
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
def begin(out: Array, slide: Array, x: float, y: float, contacts: int, given: Given) -> None:
    """Begins a candidate with both contacts of a slide, the first at (x, y), placed as at separation 0."""
    c, s = cos(slide[SLIDE_PSI]), sin(slide[SLIDE_PSI])
    first = int(slide[SLIDE_FIRST])
    px, py = given.pegs[first, 0] - (c * x + s * y), given.pegs[first, 1] - (c * y - s * x)
    write_pose(out, -slide[SLIDE_PSI], px, py, contacts)
    out[PEG], out[PEG + 1] = slide[SLIDE_FIRST], slide[SLIDE_SECOND]
    out[PIECE], out[PIECE + 1] = slide[SLIDE_ONE], slide[SLIDE_TWO]


@inner
def square_to(slide: Array, row: Array, middle: float, piece: Array, side: float, above: float) -> Two:
    """The parameters at which a third peg, ``above`` mm over the first, is on a piece of parallel normal."""
    ux, uy = -sin(slide[SLIDE_PSI]), cos(slide[SLIDE_PSI])
    if row[IS_ARC] == 0.0:
        if piece[IS_ARC] == 0.0:
            return NONE
        x, y = piece[X] + side * piece[RADIUS] * row[AXIS_Y], piece[Y] - side * piece[RADIUS] * row[AXIS_X]
        return track_crossing(row, middle, ux, uy, ux * x + uy * y - above)
    if piece[IS_ARC] == 0.0:
        return (atan2(-side * piece[AXIS_X], side * piece[AXIS_Y]) - middle, nan)
    apart = side * piece[RADIUS] - row[RADIUS]
    if abs(apart) <= HAIR:
        return NONE
    level = (above - ux * (piece[X] - row[X]) - uy * (piece[Y] - row[Y])) / apart
    return track_crossing(row, middle, ux, uy, ux * row[X] + uy * row[Y] + row[RADIUS] * level)


@inner
def met_at(slide: Array, row: Array, middle: float, piece: Array, side: float, above: float, t: float) -> Two:
    """Where the third peg then is."""
    if row[IS_ARC] == 0.0:
        return (piece[X] + side * piece[RADIUS] * row[AXIS_Y], piece[Y] - side * piece[RADIUS] * row[AXIS_X])
    if piece[IS_ARC] == 0.0:
        ux, uy = -sin(slide[SLIDE_PSI]), cos(slide[SLIDE_PSI])
        x, y = track_at(row, middle, t)
        rise = ux * piece[AXIS_X] + uy * piece[AXIS_Y]
        if abs(rise) <= LEVEL:
            return NONE
        along = (ux * (x - piece[X]) + uy * (y - piece[Y]) + above) / rise
        return (piece[X] + along * piece[AXIS_X], piece[Y] + along * piece[AXIS_Y])
    ex, ey = cos(middle + t), sin(middle + t)
    return (piece[X] + side * piece[RADIUS] * ex, piece[Y] + side * piece[RADIUS] * ey)


@compiled
def slides_squared(slides: Matrix, given: Given, out: Matrix) -> int:
    """Writes the candidates of slides (S, 7) with a third peg, of the other jaw, whose normal is parallel.

    It is on an arc or, if the part goes round, on a line. Returns their number, -1 where they do not fit.
    """
    count = 0
    for n in range(slides.shape[0]):
        slide = slides[n]
        row, first = given.rows[int(slide[SLIDE_ONE])], int(slide[SLIDE_FIRST])
        middle, c, s = middle_of(row), cos(slide[SLIDE_PSI]), sin(slide[SLIDE_PSI])
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
                        ts = square_to(slide, row, middle, piece, side, above)
                    t = turned_in(slide, row, ts[0] if way // 3 % 2 == 0 else ts[1], turn)
                    if t != t:
                        continue
                    x, y = met_at(slide, row, middle, piece, side, above, t)
                    if x != x or not on_piece(piece, x, y, END_SLACK):
                        continue
                    if count >= out.shape[0]:
                        return -1
                    one = out[count]
                    begin(one, slide, *track_at(row, middle, t), 3, given)
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
def inside(pair: Array, given: Given, psi: float) -> float:
    """An orientation moved by whole turns into the range of a pair."""
    if pair[KIND] == 1.0:
        return psi
    k = int(pair[SOURCE])
    low, high = given.reals[k, FROM] - pair[ANGLE], given.reals[k, TO] - pair[ANGLE]
    return min(max(psi + TURN * ceil((low - BESIDE - psi) / TURN), low), high)


@compiled
def slides_held(
    slides: Matrix, left: JawCells, right: JawCells, given: Given, pocket_pieces: IntMatrix, out: Matrix
) -> int:
    """Writes the candidates of slides (S, 7) with two contacts of the other jaw at their height.

    Returns their number, -1 where they do not fit.
    """
    count = 0
    for n in range(slides.shape[0]):
        slide = slides[n]
        row, first, psi = given.rows[int(slide[SLIDE_ONE])], int(slide[SLIDE_FIRST]), slide[SLIDE_PSI]
        middle, c, s, within = middle_of(row), cos(psi), sin(psi), psi % TURN
        jaw = left if given.right[first] == 1 else right
        for number in range(jaw.cells.shape[0]):
            cell = jaw.cells[number]
            if cell[LOW] - BESIDE > within:
                break
            if cell[HIGH] + BESIDE < within:
                continue
            pair = given.pairs[int(cell[PAIR]) + jaw.before]
            exact = inside(pair, given, psi)
            there = pair_at(pair, given, exact)
            if not is_on_its_pieces(pair, given, exact, there[0], there[1]):
                continue
            level = height(pair, given, there[0], there[1], cos(exact), sin(exact)) + given.pegs[first, 1]
            ts = track_crossing(row, middle, -s, c, level)
            for way in range(6):
                t = turned_in(slide, row, ts[0] if way < 3 else ts[1], way % 3 - 1)
                if t != t:
                    continue
                if count >= out.shape[0]:
                    return -1
                one = out[count]
                begin(one, slide, *track_at(row, middle, t), 4, given)
                place_third(one, c * there[0] + s * there[1], int(pair[FIRST_PEG]), given)
                write_pair(one, 2, pair, given, pocket_pieces)
                count += 1
    return count


@inner
def blocked(row: Array, middle: float, piece: Array, ox: float, oy: float) -> Two:
    """Parameters at which a peg (ox, oy) from the first is on the carrier of a piece."""
    if piece[IS_ARC] == 0.0:
        nx, ny = piece[AXIS_Y], -piece[AXIS_X]
        return track_crossing(row, middle, nx, ny, nx * (piece[X] - ox) + ny * (piece[Y] - oy))
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
def slides_blocked(slides: Matrix, given: Given, out: Matrix) -> int:
    """Writes candidates of slides (S, 7) with a third contact, where a peg of their own jaw blocks them.

    Their place is that at separation 0. Returns their number, -1 where they do not fit.
    """
    count = 0
    for n in range(slides.shape[0]):
        slide = slides[n]
        row, first = given.rows[int(slide[SLIDE_ONE])], int(slide[SLIDE_FIRST])
        middle, c, s = middle_of(row), cos(slide[SLIDE_PSI]), sin(slide[SLIDE_PSI])
        jaw = given.right[first]
        for third in range(given.pegs.shape[0]):
            if given.right[third] != jaw or third == first or third == int(slide[SLIDE_SECOND]):
                continue
            dx, dy = given.pegs[third, 0] - given.pegs[first, 0], given.pegs[third, 1] - given.pegs[first, 1]
            ox, oy = c * dx - s * dy, s * dx + c * dy
            for number in range(given.parts[jaw, 0], given.parts[jaw, 1]):
                piece = given.rows[number]
                ts = blocked(row, middle, piece, ox, oy)
                for way in range(6):
                    t = turned_in(slide, row, ts[0] if way < 3 else ts[1], way % 3 - 1)
                    if t != t:
                        continue
                    x, y = track_at(row, middle, t)
                    if not on_piece(piece, x + ox, y + oy, END_SLACK):
                        continue
                    if count >= out.shape[0]:
                        return -1
                    begin(out[count], slide, x, y, 3, given)
                    out[count, PEG + 2], out[count, PIECE + 2] = third, number
                    count += 1
    return count
