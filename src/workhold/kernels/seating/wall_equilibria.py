"""A part that stands on a piece of its hull on a wall, between a locator and a clamp's tip: orientations at
which the three forces balance.

The part turns about the centre of that piece, which keeps its distance from the wall. The separation S
follows from the orientation, and the forces balance where S' = 0, enclosed with S'' by intervals
(``turning``). Ranges in which S' cannot vanish, or a force cannot press, are dropped, and the roots isolated
in the others.
"""

from __future__ import annotations

from math import ceil, cos, pi, sin
from typing import NamedTuple

from workhold.conventions import SAME_CENTER
from workhold.kernels.base.compiling import (
    Array,
    IntMatrix,
    Matrix,
    Vector,
    compiled,
    inner,
)
from workhold.kernels.base.interval import Interval, imul, ineg, iscale, ishift, isub
from workhold.kernels.seating.candidates import write_pose
from workhold.kernels.seating.columns import DOUBT, MOTION, PEG, PIECE, SECOND, SEPARATION
from workhold.kernels.seating.turning import (
    AWAY,
    CURVATURE,
    HALVES,
    NONE,
    NOTHING,
    ROOT,
    Contact,
    compute_contact,
    has_none,
    judge_range,
    push_rest,
    write_shape,
)

# Radians. Ranges into which a run is cut first.
CELL = 0.3
# The pegs of a pattern on a fence, and the contact with the wall.
LOCATOR, TIP, ON_WALL = range(3)


class Rate(NamedTuple):
    """How the separation S changes over a range of orientations.

    Parameters
    ----------
    is_possible : whether a balance is possible.
    is_smooth : whether S is smooth throughout.
    slope, bend : enclosures of S' and S''.
    """

    is_possible: bool
    is_smooth: bool
    slope: Interval
    bend: Interval


NOWHERE = Rate(False, False, NOTHING, NOTHING)


class StandingPart(NamedTuple):
    """A part that stands on a wall, between a locator and a tip.

    Parameters
    ----------
    rows, discs : (N, 10) pieces of the boundary on which the pegs' centres lie, and (N, 3) discs around them.
    parts : (2, 2) first and past-the-last number of the pieces that the locator (row 0) and the tip (row 1)
        touch.
    hull : (H, 6) pieces of the hull, see ``kernels.seating.obstacles``.
    runs : (M, 3) number of a hull piece, and first and last orientation in which it is on the wall.
    pegs : (2, 2) of the locator, and of the tip at separation 0, in mm.
    half_plane : (3,) unit vector from the wall to the part, along x or y, and the wall's coordinate along it
        in mm.
    """

    rows: Matrix
    discs: Matrix
    parts: IntMatrix
    hull: Matrix
    runs: Matrix
    pegs: Matrix
    half_plane: Vector


@inner
def compute_heights(stood: StandingPart, piece: int) -> tuple[float, float, float]:
    """Return three heights in mm while a hull piece is on the wall: of its centre, the locator and the tip.

    The centre's is its coordinate square to the wall. The locator's is relative to the centre, square to the
    wall. The tip's is relative to the centre or, where the wall is upright, the tip's y relative to the
    locator's.
    """
    ux, uy = stood.half_plane[0], stood.half_plane[1]
    center = (ux + uy) * (stood.half_plane[2] + stood.hull[piece, 2])
    if ux != 0.0:
        return (center, stood.pegs[LOCATOR, 0] - center, stood.pegs[TIP, 1] - stood.pegs[LOCATOR, 1])
    return (center, stood.pegs[LOCATOR, 1] - center, stood.pegs[TIP, 1] - center)


@inner
def compute_both_contacts(
    locator: Array,
    tip: Array,
    high: tuple[float, float, float],
    upright: bool,
    turn: Interval,
    way: float,
    within: bool,
) -> tuple[Contact, Contact]:
    """Return (contact of the locator, contact of the tip) over a range of orientations, see
    ``turning.compute_contact``.

    See ``seating.turning`` for the layout of ``locator`` and ``tip``.

    Parameters
    ----------
    locator, tip : shapes of the pieces that they touch.
    high : see :func:`compute_heights`.
    upright : whether the wall is upright.
    turn : range of theta in radians.
    way : ``facing`` of the locator's contact.
    within : whether only the pieces themselves count, not their whole lines or circles.
    """
    level = (high[1], high[1])
    if not upright:
        one = compute_contact(locator, turn, level, NOTHING, NOTHING, way, within)
        return (one, compute_contact(tip, turn, (high[2], high[2]), NOTHING, NOTHING, 1.0, within))
    one = compute_contact(locator, ishift(pi / 2.0, turn), level, NOTHING, NOTHING, way, within)
    # The part is higher as the locator's contact is lower; a quarter turn makes x of what was -y.
    two = compute_contact(
        tip, turn, ishift(high[2], ineg(one.place)), ineg(one.slope), ineg(one.bend), 1.0, within
    )
    return (one, two if one.is_possible else one)


@inner
def compute_rate(one: Contact, two: Contact, wall: Array, way: float) -> Rate:
    """Return (whether wall, locator and tip may all press, whether S
    is smooth throughout, enclosures of S' and S'').

    ``one`` and ``two`` are the contacts of locator and tip, ``wall`` is the half plane (3,). The tip's force
    has the component 1 along x. The locator's force balances the tip's along the wall, and the wall's force
    balances the rest. S is the jaw separation in mm.
    """
    if not (one.is_possible and two.is_possible):
        return NOWHERE
    smooth = one.is_everywhere and two.is_everywhere
    if wall[0] == 0.0:
        pressing = iscale(wall[1], isub(two.tangent, one.tangent))
        return Rate(pressing[1] >= 0.0, smooth, isub(two.slope, one.slope), isub(two.bend, one.bend))
    pressing = iscale(wall[0], ishift(1.0, imul(one.tangent, two.tangent)))
    return Rate(pressing[1] >= 0.0 and iscale(way, two.tangent)[1] >= 0.0, smooth, two.slope, two.bend)


@inner
def write_balances(
    stood: StandingPart,
    m: int,
    i: int,
    j: int,
    way: float,
    cell: Interval,
    shapes: Array,
    stack: Array,
    out: Array,
    count: int,
) -> int:
    """Append the candidates of run m with locator and tip on pieces i
    and j, over a range of theta, to ``out`` (N, 24).

    Return the new number of candidates, -1 when there is no room. ``way`` is ``facing`` of the locator's
    contact, ``cell`` the range in radians, ``shapes`` are those of :func:`write_equilibria`. See
    ``seating.turning`` for the layout of ``shapes``, ``seating.columns`` for that of candidates.
    """
    upright, high = stood.half_plane[0] != 0.0, compute_heights(stood, int(stood.runs[m, 0]))
    depth, looked = 1, 0
    stack[0, 0], stack[0, 1] = cell
    while depth > 0:
        depth -= 1
        looked += 1
        turn = (stack[depth, 0], stack[depth, 1])
        one, two = compute_both_contacts(shapes[i], shapes[j], high, upright, turn, way, True)
        known = compute_rate(one, two, stood.half_plane, way)
        if not known.is_possible or has_none(known.slope):
            continue
        verdict, middle = HALVES, (turn[0] + turn[1]) / 2.0
        one, two = compute_both_contacts(shapes[i], shapes[j], high, upright, turn, way, False)
        known = compute_rate(one, two, stood.half_plane, way)
        if known.is_smooth:
            one, two = compute_both_contacts(
                shapes[i], shapes[j], high, upright, (middle, middle), way, False
            )
            verdict, turn = judge_range(
                turn, middle, compute_rate(one, two, stood.half_plane, way).slope, known.bend
            )
            if verdict == NONE:
                continue
        more = -1 if verdict >= ROOT else push_rest(verdict, turn, looked, stack, depth)
        if more < 0:
            count = write_balance(stood, m, i, j, way, middle, verdict != ROOT, shapes, out, count)
            if count < 0:
                return -1
        depth = max(depth, more)
    return count


@inner
def write_balance(
    stood: StandingPart,
    m: int,
    i: int,
    j: int,
    way: float,
    theta: float,
    doubt: bool,
    shapes: Array,
    out: Array,
    count: int,
) -> int:
    """Append the candidate of three contacts at orientation ``theta`` to ``out``, if the contacts may lie on
    their pieces.

    Return the new number of candidates, -1 when there is no room. See ``seating.turning`` for the layout of
    ``shapes``.
    """
    piece, upright = int(stood.runs[m, 0]), stood.half_plane[0] != 0.0
    high = compute_heights(stood, piece)
    one, two = compute_both_contacts(shapes[i], shapes[j], high, upright, (theta, theta), way, True)
    if not (one.is_possible and two.is_possible):
        return count
    if count >= out.shape[0]:
        return -1
    c, s = cos(theta), sin(theta)
    hx = c * stood.hull[piece, 0] - s * stood.hull[piece, 1]
    hy = s * stood.hull[piece, 0] + c * stood.hull[piece, 1]
    place, speed = (one.place[0] + one.place[1]) / 2.0, (one.slope[0] + one.slope[1]) / 2.0
    # The centre of the piece, and how it moves as the part turns.
    if upright:
        x, y, vx, vy = high[0], stood.pegs[LOCATOR, 1] + place, 0.0, speed
    else:
        x, y, vx, vy = stood.pegs[LOCATOR, 0] - place, high[0], -speed, 0.0
    known, row = compute_rate(one, two, stood.half_plane, way), out[count]
    write_pose(row, theta, x - hx, y - hy, 3)
    row[SEPARATION] = x + (two.place[0] + two.place[1]) / 2.0 - stood.pegs[TIP, 0]
    row[SECOND], row[DOUBT] = (known.bend[0] + known.bend[1]) / 2.0, 1.0 if doubt else 0.0
    row[MOTION], row[MOTION + 1], row[MOTION + 2] = 1.0, vx + hy, vy - hx
    row[PEG], row[PEG + 1], row[PEG + 2] = LOCATOR, TIP, ON_WALL
    row[PIECE], row[PIECE + 1], row[PIECE + 2] = i, j, stood.rows.shape[0] + piece
    return count + 1


@compiled
def write_equilibria(stood: StandingPart, shapes: Matrix, stack: Matrix, out: Matrix) -> int:
    """Write the candidates of all balances of wall, locator and tip to ``out`` (N, 24).

    Return their number, -1 when there is no room. See ``seating.turning`` for the layout of ``shapes``,
    ``seating.columns`` for that of candidates.

    Parameters
    ----------
    shapes, stack : (N, 11) and (DEPTH, 2) work space.
    """
    count, upright = 0, stood.half_plane[0] != 0.0
    for m in range(stood.runs.shape[0]):
        piece, low, width = int(stood.runs[m, 0]), stood.runs[m, 1], stood.runs[m, 2] - stood.runs[m, 1]
        for k in range(stood.rows.shape[0]):
            write_shape(stood.rows[k], stood.discs[k], stood.hull[piece, 0], stood.hull[piece, 1], shapes[k])
        cells = int(ceil(width / CELL))
        for cell in range(cells):
            turn = (low + cell * width / cells, low + (cell + 1) * width / cells)
            count = write_balances_of_cell(stood, m, turn, upright, shapes, stack, out, count)
            if count < 0:
                return -1
    return count


@inner
def write_balances_of_cell(
    stood: StandingPart,
    m: int,
    turn: Interval,
    upright: bool,
    shapes: Array,
    stack: Array,
    out: Array,
    count: int,
) -> int:
    """Append the candidates of run m over a range of theta, with all pairs of pieces, to ``out`` (N, 24).

    Return the new number of candidates, -1 when there is no room. See ``seating.turning`` for the layout of
    ``shapes``, ``seating.columns`` for that of candidates.
    """
    high = compute_heights(stood, int(stood.runs[m, 0]))
    for i in range(stood.parts[0, 0], stood.parts[0, 1]):
        # Along the wall the locator is pressed from the tip's side, upright from above or from below.
        for ways in range(1 + upright):
            way = 2.0 * ways - 1.0
            seen = compute_contact(
                shapes[i],
                ishift(pi / 2.0, turn) if upright else turn,
                (high[1], high[1]),
                NOTHING,
                NOTHING,
                way,
                True,
            )
            if not seen.is_possible:
                continue
            for j in range(stood.parts[1, 0], stood.parts[1, 1]):
                # Of a round part S does not depend on the orientation.
                if (
                    shapes[i, CURVATURE] != 0.0
                    and shapes[j, CURVATURE] != 0.0
                    and max(shapes[i, AWAY], shapes[j, AWAY]) <= SAME_CENTER
                ):
                    continue
                count = write_balances(stood, m, i, j, way, turn, shapes, stack, out, count)
                if count < 0:
                    return -1
    return count
