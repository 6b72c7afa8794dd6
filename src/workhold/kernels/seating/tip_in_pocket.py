"""A part that stands on a piece of its hull on a wall, with the tip of a clamp in a pocket of its boundary.

With the tip in a pocket, the distance of the locator from another piece (for an arc, a difference of squares
of distances) is a trigonometric polynomial in theta of second degree. Its derivatives are bounded by its
coefficients. Where the wall is along the tip's travel, the tip's height alone determines the orientation, by
such a polynomial of first degree.
"""

from __future__ import annotations

from math import cos, hypot, sin

from workhold.conventions import SAME_CENTER
from workhold.kernels.base.compiling import (
    Array,
    IntArray,
    IntMatrix,
    Matrix,
    compiled,
    inner,
)
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, IS_ARC, RADIUS, X, Y
from workhold.kernels.seating.candidates import write_pose
from workhold.kernels.seating.columns import CONTACTS, DOUBT, PEG, PIECE, SEPARATION
from workhold.kernels.seating.obstacles import is_on_piece
from workhold.kernels.seating.turning import END, NONE, ROOT, judge_range, push_rest
from workhold.kernels.seating.wall_equilibria import LOCATOR, ON_WALL, TIP, StandingPart, compute_heights

Waves = tuple[float, float, float, float, float]
# Of a sum of coefficients: rounding of the polynomial.
ROUNDING = 2e-15


@inner
def evaluate_waves(waves: Waves, theta: float) -> tuple[float, float]:
    """Return (value, derivative) of a trigonometric polynomial at theta in radians.

    ``waves`` are its coefficients: the constant, then those of cos theta, sin theta, cos 2 theta and sin 2
    theta.
    """
    c, s = cos(theta), sin(theta)
    twice_c, twice_s = c * c - s * s, 2.0 * s * c
    value = waves[0] + waves[1] * c + waves[2] * s + waves[3] * twice_c + waves[4] * twice_s
    return (value, waves[2] * c - waves[1] * s + 2.0 * (waves[4] * twice_c - waves[3] * twice_s))


@inner
def write_zeros(waves: Waves, low: float, high: float, stack: Array, found: Array) -> int:
    """Write the zeros of a trigonometric polynomial in [low, high] to ``found`` (N, 2); return their number.

    The columns are theta in radians, and a flag: 1 where it is undecided whether there is a zero, else 0. At
    most N are written, which may be only some if the polynomial nearly vanishes everywhere.

    Parameters
    ----------
    waves : coefficients, see :func:`evaluate_waves`.
    stack : (DEPTH, 2) work space.
    """
    first, second = hypot(waves[1], waves[2]), hypot(waves[3], waves[4])
    if max(first, second) <= SAME_CENTER:
        return 0
    bend, slack = first + 4.0 * second, ROUNDING * (abs(waves[0]) + first + second) + ROUNDING
    depth, looked, count = 1, 0, 0
    stack[0, 0], stack[0, 1] = low, high
    while depth > 0:
        depth -= 1
        looked += 1
        turn = (stack[depth, 0], stack[depth, 1])
        middle, reach = (turn[0] + turn[1]) / 2.0, (turn[1] - turn[0]) / 2.0
        at, slope = evaluate_waves(waves, middle)
        off = bend * reach * (1.0 + 1e-9) + slack
        verdict, turn = judge_range(turn, middle, (at - slack, at + slack), (slope - off, slope + off))
        if verdict == NONE:
            continue
        more = -1 if verdict >= ROOT else push_rest(verdict, turn, looked, stack, depth)
        if more < 0:
            found[count, 0], found[count, 1] = middle, 0.0 if verdict == ROOT else 1.0
            count += 1
            if count == found.shape[0]:
                return count
        depth = max(depth, more)
    return count


@inner
def make_distance_waves(
    row: Array, ox: float, oy: float, dx: float, dy: float, along: float, above: float
) -> Waves:
    """Return the locator's distance from a line or circle as the coefficients of a trigonometric polynomial
    in theta.

    Two cases: (a) for a line, the signed distance in mm; (b) for a circle, (|locator - centre|^2 - R^2) / (2
    R). The part turns about its point (ox, oy). See :func:`evaluate_waves` for the coefficients,
    ``base.feature`` for the layout of ``row``.

    Parameters
    ----------
    row : the line or arc.
    dx, dy : the pocket from (ox, oy).
    along, above : the locator's coordinate along the tip's travel from (ox, oy), and across it from the tip.
    """
    ex, ey = row[X] - ox, row[Y] - oy
    if row[IS_ARC] == 0.0:
        nx, ny = row[AXIS_Y], -row[AXIS_X]
        return (
            (dx * nx + dy * ny) / 2.0 - (ex * nx + ey * ny),
            along * nx + above * ny,
            above * nx - along * ny,
            (dy * ny - dx * nx) / 2.0,
            (dx * ny + dy * nx) / 2.0,
        )
    # The square of the locator's distance from the centre: that of the tip's share in it and of both.
    ux, uy, unit = dx - 2.0 * ex, dy - 2.0 * ey, 0.5 / row[RADIUS]
    apart = (hypot(ex, ey) - row[RADIUS]) * (hypot(ex, ey) + row[RADIUS])
    return (
        unit * (along * along + above * above + apart + (dx * ux + dy * uy) / 2.0),
        2.0 * unit * (above * (dy - ey) - along * ex),
        2.0 * unit * (above * (dx - ex) + along * ey),
        unit * (dy * uy - dx * ux) / 2.0,
        unit * (dx * uy + dy * ux) / 2.0,
    )


@inner
def write_pocket_candidate(
    stood: StandingPart, m: int, pocket: Array, pieces: IntArray, found: Array, row: Array
) -> tuple[float, float]:
    """Write the candidate of a part on a wall with the tip in a pocket at an orientation to ``row`` (24,).

    ``found`` (2,) is a row of :func:`write_zeros`, m the number of the run. The place is that at separation
    0, unless the wall is upright; then contact 0 is left for the locator. Return the place (x, y) of the
    centre of the piece on the wall. See ``seating.columns`` for the layout of ``row``.
    """
    piece, theta = int(stood.runs[m, 0]), found[0]
    c, s = cos(theta), sin(theta)
    hx = c * stood.hull[piece, 0] - s * stood.hull[piece, 1]
    hy = s * stood.hull[piece, 0] + c * stood.hull[piece, 1]
    ahead, up = c * pocket[0] - s * pocket[1], s * pocket[0] + c * pocket[1]
    x, y = stood.pegs[TIP, 0] - ahead, stood.pegs[TIP, 1] - up
    at = 0
    if stood.half_plane[0] != 0.0:
        x, at = compute_heights(stood, piece)[0] - hx, 1
    write_pose(row, theta, x, y, 3)
    row[SEPARATION], row[DOUBT] = x + ahead - stood.pegs[TIP, 0], found[1]
    row[PEG + at], row[PIECE + at] = ON_WALL, stood.rows.shape[0] + piece
    row[PEG + at + 1], row[PIECE + at + 1] = TIP, pieces[0]
    row[PEG + at + 2], row[PIECE + at + 2] = TIP, pieces[1]
    return (x + hx, y + hy)


@compiled
def write_tip_in_pocket(
    stood: StandingPart, pockets: Matrix, pieces: IntMatrix, stack: Matrix, found: Matrix, out: Matrix
) -> int:
    """Write the candidates (N, 24) of a part on a wall with the tip in a pocket to ``out``.

    Return their number, -1 when there is no room. Where the wall is upright, they include the locator's
    contact. Otherwise tip and wall fix all but the part's position along the wall. Then its place is that at
    separation 0, and the locator is still to be added. See ``seating.columns`` for the layout of candidates.

    Parameters
    ----------
    pockets, pieces : (V, 2) places on the part, and (V, 2) numbers of the two pieces that the tip touches in
        each.
    stack, found : (DEPTH, 2) and (64, 2) work space.
    """
    count, upright = 0, stood.half_plane[0] != 0.0
    for m in range(stood.runs.shape[0]):
        piece, low, last = int(stood.runs[m, 0]), stood.runs[m, 1], stood.runs[m, 2]
        ox, oy, high = stood.hull[piece, 0], stood.hull[piece, 1], compute_heights(stood, piece)
        for v in range(pockets.shape[0]):
            dx, dy = pockets[v, 0] - ox, pockets[v, 1] - oy
            for i in range(stood.parts[0, 0], stood.parts[0, 1] if upright else stood.parts[0, 0] + 1):
                if upright:
                    waves = make_distance_waves(stood.rows[i], ox, oy, dx, dy, high[1], -high[2])
                else:
                    waves = (-high[2], dy, dx, 0.0, 0.0)
                many = write_zeros(waves, low, last, stack, found)
                if count + many > out.shape[0]:
                    return -1
                for k in range(many):
                    row = out[count]
                    x, y = write_pocket_candidate(stood, m, pockets[v], pieces[v], found[k], row)
                    if upright:
                        c, s = cos(found[k, 0]), sin(found[k, 0])
                        wx, wy = stood.pegs[LOCATOR, 0] - x, stood.pegs[LOCATOR, 1] - y
                        if not is_on_piece(stood.rows[i], c * wx + s * wy + ox, c * wy - s * wx + oy, END):
                            continue
                        row[CONTACTS], row[PEG], row[PIECE] = 4.0, LOCATOR, i
                    count += 1
    return count
