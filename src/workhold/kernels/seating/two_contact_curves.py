"""Two contacts of one jaw over the orientation: places, instant centres, cells, rays, and functions with
roots.

The ray of a pair leads from its first contact along the normal there, and the instant centre P lies on it.
With r_a and r_b the unit normals at both contacts, w from the first contact u to the second, of length d,

    P = u + p r_a,    p = cross(w, r_b) / cross(r_a, r_b).

Beside a tangency P runs off, and its speed is of little use. But both cross products change no faster than
the directions in them turn. So p is bounded by their quotient from below, and from above where the divisor
cannot vanish. Seen from the part, a far point lies in a direction that hardly changes. To either side of its
middle a range moves u by max(p) times half its width at most. What rounding does to a computed chord is
bounded in ``chord.evaluation``.

Roots of three functions of the orientation are equilibria.

MISS : height of the foot of the instant centre P on a third peg's piece, less the third peg's own height.
    Zero where the third normal goes through P. Its derivative is x . (P - foot) + y . foot'.
APART : difference of the heights of two pairs. Zero where both hold the part.
GAP : distance of another peg of the same jaw from a piece. Zero where it touches.
"""

from __future__ import annotations

from math import cos, floor, hypot, inf, pi, sin, sqrt
from typing import NamedTuple

from workhold.kernels.base.compiling import (
    Array,
    Matrix,
    compiled,
    inner,
)
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, RADIUS, SIGN, X, Y
from workhold.kernels.base.interval import TURN
from workhold.kernels.base.tables import (
    BACKWARD_ERROR,
    COINCIDENCE,
    END_STRETCH,
    FIRST_STRETCH,
    FROM,
    HEAD,
    KAPPA,
    LENGTH,
    TAIL,
)
from workhold.kernels.chord.coincidences import NONE
from workhold.kernels.chord.evaluation import compute_chord_state
from workhold.kernels.chord.stretches import PARTS, STRETCH_HIGH
from workhold.kernels.chord.stretches import SPEED as STRETCH_SPEED
from workhold.kernels.seating.columns import (
    ANGLE,
    BOTTOM,
    FIRST_PEG,
    HIGH,
    KIND,
    LOW,
    PAIR,
    PIVOT_X,
    PIVOT_Y,
    SOURCE,
    SPEED,
    TOP,
    VAGUE,
    HeldPart,
)
from workhold.kernels.seating.obstacles import (
    compute_angle_from_middle,
    compute_length,
    find_foot,
    is_on_piece,
)


class PairState(NamedTuple):
    """A pair of contacts at one orientation, in the part's frame.

    Parameters
    ----------
    x, y : place of the first peg in mm.
    ax, ay, bx, by : unit outward normals at the first and at the second contact; 0 in a pocket.
    center_x, center_y : the instant centre in mm.
    other_x, other_y : place of the second peg in mm. In a pocket, all places are the pivot.
    """

    x: float
    y: float
    ax: float
    ay: float
    bx: float
    by: float
    center_x: float
    center_y: float
    other_x: float
    other_y: float


# Cells into which a turn about a pocket is cut.
POCKET_CELLS = 16
# How far in mm a contact may lie past the end of its piece: rounding.
END = 1e-9
# mm. Rounding of a height, generously counted.
ROUNDING = 1e-9


@inner
def compute_pair_state(pair: Array, given: HeldPart, psi: float) -> PairState:
    """Return a pair at an orientation psi, in the part's frame.

    See ``seating.columns`` for the layout of ``pair``.
    """
    if pair[KIND] == 1.0:
        x, y = pair[PIVOT_X], pair[PIVOT_Y]
        return PairState(x, y, 0.0, 0.0, 0.0, 0.0, x, y, x, y)
    k = int(pair[SOURCE])
    a, b = given.rows[given.curves[k, TAIL]], given.rows[given.curves[k, HEAD]]
    alpha, d = psi + pair[ANGLE], given.reals[k, LENGTH]
    cosine, sine = cos(alpha), sin(alpha)
    s = compute_chord_state(a, b, given.reals[k], alpha, cosine, sine)
    return PairState(
        s.x,
        s.y,
        a[SIGN] * s.ax,
        a[SIGN] * s.ay,
        b[SIGN] * s.bx,
        b[SIGN] * s.by,
        s.center_x,
        s.center_y,
        s.x + d * cosine,
        s.y + d * sine,
    )


@inner
def is_on_its_pieces(pair: Array, given: HeldPart, psi: float, x: float, y: float) -> bool:
    """Return whether both contacts of a pair at psi lie on their pieces, the first peg being at (x, y).

    Curves go a little past the ends of pieces. See ``seating.columns`` for the layout of ``pair``.
    """
    if pair[KIND] == 1.0:
        return True
    k = int(pair[SOURCE])
    alpha, d = psi + pair[ANGLE], given.reals[k, LENGTH]
    return is_on_piece(given.rows[given.curves[k, TAIL]], x, y, END) and is_on_piece(
        given.rows[given.curves[k, HEAD]], x + d * cos(alpha), y + d * sin(alpha), END
    )


@inner
def compute_pair_height(
    pair: Array, given: HeldPart, x: float, y: float, cosine: float, sine: float
) -> float:
    """Return minus the height in mm of the part's origin when a pair holds the part.

    It is the height of the first peg's place (x, y) on the part, above the part's origin, minus the height of
    the peg itself. ``cosine`` and ``sine`` are those of psi. Pairs that hold the part together have equal
    heights. See ``seating.columns`` for the layout of ``pair``.
    """
    return cosine * y - sine * x - given.pegs[int(pair[FIRST_PEG]), 1]


@inner
def write_cell(cell: Array, number: int, low: float, high: float, speed: float, given: HeldPart) -> None:
    """Write the cell (7,) of the pair ``number`` over [low, high] of psi, shifted by whole turns so that LOW
    is in [0, 2 pi).

    ``speed`` bounds that of the instant centre P in mm per radian. The bounds of the height h follow from h'
    = -x . P and h'' = -y . P - x . P'. See ``seating.columns`` for the layout of ``cell``. Symbols are those
    of ``seating.two_contact_curves``.
    """
    pair = given.pairs[number]
    middle, reach = (low + high) / 2.0, (high - low) / 2.0
    cosine, sine = cos(middle), sin(middle)
    s = compute_pair_state(pair, given, middle)
    value = compute_pair_height(pair, given, s.x, s.y, cosine, sine)
    vague = not speed < inf
    if vague:
        # Too short a range, beside a tangency, for the height to leave its ends by more than they are apart.
        spread = 1e-6
        for end in (low, high):
            t = compute_pair_state(pair, given, end)
            spread = max(
                spread, 2.0 * abs(compute_pair_height(pair, given, t.x, t.y, cos(end), sin(end)) - value)
            )
    else:
        bend = hypot(s.center_x, s.center_y) + speed * (1.0 + reach)
        spread = reach * (abs(cosine * s.center_x + sine * s.center_y) + reach * bend) + ROUNDING
    turns = floor(low / TURN) * TURN
    cell[LOW], cell[HIGH], cell[SPEED] = low - turns, high - turns, speed
    cell[BOTTOM], cell[TOP] = value - spread, value + spread
    cell[PAIR], cell[VAGUE] = number, 1.0 if vague else 0.0


@compiled
def make_cells(given: HeldPart, stretches: Matrix, cells: Matrix) -> int:
    """Cut all pairs into cells, written to ``cells`` (C, 7); return their number, -1 when there is no room.

    See ``seating.columns`` for the layout of ``cells``.

    Parameters
    ----------
    stretches : (S, 13) of the curves, see ``chord.stretches``.
    """
    count = 0
    for number in range(given.pairs.shape[0]):
        pair = given.pairs[number]
        if pair[KIND] == 1.0:
            for k in range(POCKET_CELLS):
                if count >= cells.shape[0]:
                    return -1
                low, high = k * TURN / POCKET_CELLS, (k + 1) * TURN / POCKET_CELLS
                write_cell(cells[count], number, low, high, 0.0, given)
                count += 1
            continue
        curve = int(pair[SOURCE])
        low = given.reals[curve, FROM] - pair[ANGLE]
        s = given.curves[curve, FIRST_STRETCH]
        while s < given.curves[curve, END_STRETCH]:
            parts = int(stretches[s, PARTS])
            first = s if parts == 0 else s + 1
            last = first + max(parts, 1)
            for k in range(first, last):
                if count >= cells.shape[0]:
                    return -1
                high = stretches[k, STRETCH_HIGH] - pair[ANGLE]
                write_cell(cells[count], number, low, high, stretches[k, STRETCH_SPEED], given)
                count += 1
                low = high
            s = last
    return count


class Ray(NamedTuple):
    """The half line from a pair's first contact on which the instant centre P lies, over a range of psi.

    Parameters
    ----------
    least, most : least and largest distance of P from the first contact, in mm; 0 and inf where nothing is
        known.
    x, y : the ray's unit vector in the middle of the range.
    off : how far the contact moves to either side of its place in the middle, in mm.
    turn_a, turn_b : how far the normals at both contacts turn, in radians.
    """

    least: float
    most: float
    x: float
    y: float
    off: float
    turn_a: float
    turn_b: float


# No unit. Rounding of a unit vector; and of quotients and products of bounds, generously counted.
OF_DIRECTION, OF_BOUND = 1e-15, 1e-9


@inner
def make_ray(curve: Array, a: Array, b: Array, s: PairState, speed: float, reach: float) -> Ray:
    """Return the ray of a pair over a range of psi: the half line from the first contact on which the instant
    centre P lies.

    See ``base.tables`` for the layout of ``curve``, ``base.feature`` for that of ``a`` and ``b``. Symbols are
    those of ``seating.two_contact_curves``.

    Parameters
    ----------
    curve : reals of the chord curve.
    a, b : rows of the pieces that are touched.
    s : the pair in the middle of the range.
    speed : no less than that of P, in mm per radian.
    reach : half of the range in radians.
    """
    eta, kappa, d = curve[BACKWARD_ERROR], curve[KAPPA], curve[LENGTH]
    px, py, across = s.center_x - s.x, s.center_y - s.y, abs(s.ax * s.by - s.ay * s.bx)
    size = compute_length(px, py)
    is_known = curve[COINCIDENCE] == NONE and across * across > 64.0 * kappa * eta
    # How far off rounding puts the contacts, and P.
    off, move = 0.0, speed * reach
    if is_known:
        off = 6.0 * eta / across
        move += 8.0 * eta / (across * across) * (1.0 + kappa * (d + 2.0 * size))
    # Normals of arcs turn with the contacts, which move about P.
    way, turn_a = reach * (1.0 + 2.0 * reach), off * kappa + OF_DIRECTION
    turn_b = turn_a
    if a[IS_ARC] != 0.0:
        turn_a += (size + move) * way / a[RADIUS]
    if b[IS_ARC] != 0.0:
        turn_b += (compute_length(s.other_x - s.center_x, s.other_y - s.center_y) + move) * way / b[RADIUS]
    if not is_known:
        return Ray(0.0, inf, s.ax, s.ay, 0.0, turn_a, turn_b)
    lever, change = size * across, d * (reach + turn_b)
    least = max((lever - change) / (across + turn_a + turn_b), size - move) * (1.0 - OF_BOUND)
    most = size + move
    if across > turn_a + turn_b:
        most = min(most, (lever + change) / (across - turn_a - turn_b))
    most *= 1.0 + OF_BOUND
    sign = 1.0 if px * s.ax + py * s.ay >= 0.0 else -1.0
    return Ray(max(least, 0.0), most, sign * s.ax, sign * s.ay, most * reach + off, turn_a, turn_b)


# Columns of the middle of a cell, computed once for all that may press against its pair: cosine and sine of
# the orientation, the pair there, and the ray, which stands for nothing in a pocket or beside a tangency.
COSINE, SINE, HELD, RAY = 0, 1, 2, 12
MIDDLE_LENGTH = 19


@inner
def make_ray_over(pair: Array, given: HeldPart, s: PairState, speed: float, reach: float) -> Ray:
    """Return the ray of a pair of two contacts (not a pocket) over a range; see :func:`make_ray`.

    See ``seating.columns`` for the layout of ``pair``.
    """
    k = int(pair[SOURCE])
    a, b = given.rows[given.curves[k, TAIL]], given.rows[given.curves[k, HEAD]]
    return make_ray(given.reals[k], a, b, s, speed, reach)


@compiled
def write_middles(cells: Matrix, given: HeldPart, out: Matrix) -> None:
    """Write the middles of cells (C, 7) to ``out`` (C, 19): COSINE
    and SINE of psi, the pair (10), and its ray (7).

    See ``seating.columns`` for the layout of ``cells``.
    """
    for number in range(cells.shape[0]):
        cell, row = cells[number], out[number]
        pair = given.pairs[int(cell[PAIR])]
        psi, reach = (cell[LOW] + cell[HIGH]) / 2.0, (cell[HIGH] - cell[LOW]) / 2.0
        s, ray = compute_pair_state(pair, given, psi), Ray(0.0, inf, 0.0, 0.0, 0.0, 0.0, 0.0)
        if pair[KIND] == 0.0 and cell[VAGUE] == 0.0:
            ray = make_ray_over(pair, given, s, cell[SPEED], reach)
        row[COSINE], row[SINE] = cos(psi), sin(psi)
        for k in range(10):
            row[HELD + k] = s[k]
        for k in range(7):
            row[RAY + k] = ray[k]


@inner
def read_pair_state(middle: Array) -> PairState:
    """Return the pair in the middle of a cell from its row (19,), in the form of :func:`compute_pair_state`.

    See ``seating.two_contact_curves`` for the layout of ``middle``.
    """
    h = middle[HELD:RAY]
    return PairState(h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], h[8], h[9])


@inner
def read_ray(middle: Array) -> Ray:
    """Return the ray over a cell from the row (19,) of its middle.

    See ``seating.two_contact_curves`` for the layout of ``middle``.
    """
    r = middle[RAY:]
    return Ray(r[0], r[1], r[2], r[3], r[4], r[5], r[6])


@inner
def is_foot_off(
    piece: Array,
    side: float,
    push: float,
    above: float,
    cosine: float,
    sine: float,
    s: PairState,
    ray: Ray,
    reach: float,
) -> bool:
    """Return whether a third contact at the foot of P certainly cannot balance a pair anywhere in a range of
    psi.

    It cannot where the foot is off the piece, or not at the third peg's height, or where the force there
    cannot balance the other two. Bounds follow from the ray. See ``base.feature`` for the layout of
    ``piece``. Symbols are those of ``seating.two_contact_curves``.

    Parameters
    ----------
    side : which foot on a circle, see ``obstacles.find_foot``.
    push : 1 where the third peg is of the right jaw, -1 where it is of the left one.
    above : height of the third peg over the first, in mm.
    s, cosine, sine : pair and orientation in the middle of the range.
    reach : half of the range in radians.
    """
    least, most, rx, ry, drift, turn_a, turn_b = ray
    if least <= 0.0:
        return False
    gx, gy = s.x - piece[X], s.y - piece[Y]
    if piece[IS_ARC] == 0.0:
        along, at = rx * piece[AXIS_X] + ry * piece[AXIS_Y], gx * piece[AXIS_X] + gy * piece[AXIS_Y]
        if along < 0.0:
            along, at = -along, -at
        beyond = piece[HALF_EXTENT] + END + drift
        return at + most * (along + turn_a) < -beyond or (
            along > turn_a and at + least * (along - turn_a) > beyond
        )
    # P from the arc's centre, in the frame of the ray: the contact moves across it.
    ahead, across = rx * gx + ry * gy, rx * gy - ry * gx
    slack = turn_a * (abs(ahead) + abs(across) + drift) + END
    near, far = least + ahead - slack, most + ahead + slack
    if near <= 0.0:
        return False
    low, high = across - drift - slack, across + drift + slack
    low, high = low / (near if low < 0.0 else far), high / (near if high > 0.0 else far)
    tangent, turn = (low + high) / 2.0, (high - low) / 2.0 + turn_a
    size = side / sqrt(1.0 + tangent * tangent)
    ex, ey = (rx - tangent * ry) * size, (ry + tangent * rx) * size
    nx, ny = piece[SIGN] * ex, piece[SIGN] * ey
    if push * (nx * cosine + ny * sine) < -(turn + reach):
        return True
    # The force balances two that press along their normals, so it is against the sum of those.
    if nx * (s.ax + s.bx) + ny * (s.ay + s.by) > 2.0 * turn + turn_a + turn_b:
        return True
    fx, fy = piece[RADIUS] * ex - gx, piece[RADIUS] * ey - gy
    play = piece[RADIUS] * turn + drift
    if abs(cosine * fy - sine * fx - above) > play + reach * (abs(fx) + abs(fy) + play) + END:
        return True
    beyond = piece[HALF_EXTENT] + turn + END / piece[RADIUS]
    return beyond < pi and abs(compute_angle_from_middle(piece, ex, ey)) > beyond


MISS, APART, GAP = 0.0, 1.0, 2.0
# mm. A function this near to 0 at an end has a root there: rounding.
AT_END = 1e-10
MOST_HALVINGS = 80


class RootFunction(NamedTuple):
    """A function of the orientation whose roots are sought.

    Parameters
    ----------
    kind : MISS, APART or GAP.
    one, two : pairs; ``two`` is read for APART only.
    piece : row; read for MISS and GAP.
    first, second : for MISS the height in mm of the third peg above the first, and the side of the foot. For
        GAP x and y in mm of the other peg in the vise frame, from the first.
    """

    kind: float
    one: Array
    two: Array
    piece: Array
    first: float
    second: float
    given: HeldPart


@inner
def evaluate_root_function(function: RootFunction, psi: float) -> float:
    """Return the value of a root function at psi, in mm."""
    kind, one, two, piece, first, second, given = function
    s = compute_pair_state(one, given, psi)
    cosine, sine = cos(psi), sin(psi)
    if kind == APART:
        t = compute_pair_state(two, given, psi)
        return compute_pair_height(two, given, t.x, t.y, cosine, sine) - compute_pair_height(
            one, given, s.x, s.y, cosine, sine
        )
    if kind == MISS:
        f = find_foot(piece, s.center_x, s.center_y, second)
        return cosine * (f.y - s.y) - sine * (f.x - s.x) - first
    return measure_gap(piece, s.x + cosine * first - sine * second, s.y + sine * first + cosine * second)


@inner
def measure_gap(piece: Array, x: float, y: float) -> float:
    """Return the signed distance in mm of a point from a piece's line or circle, negative on the part's side.

    See ``base.feature`` for the layout of ``piece``.
    """
    dx, dy = x - piece[X], y - piece[Y]
    if piece[IS_ARC] == 0.0:
        return dx * piece[AXIS_Y] - dy * piece[AXIS_X]
    return piece[SIGN] * (compute_length(dx, dy) - piece[RADIUS])


@inner
def have_no_root(f_low: float, f_high: float) -> bool:
    """Return whether two values of a function have one sign and neither is within ``AT_END`` of 0."""
    return f_low * f_high > 0.0 and min(abs(f_low), abs(f_high)) > AT_END


@inner
def find_root_between(function: RootFunction, low: float, high: float) -> tuple[bool, float]:
    """Return (found, psi): whether the function has a root in [low, high], and such a root.

    A root is found where the values at the ends differ in sign, or one of them is within ``AT_END`` of 0.
    Where none is found, psi is the end with the value nearer to 0.
    """
    f_low = evaluate_root_function(function, low)
    f_high = evaluate_root_function(function, high)
    if f_low * f_high > 0.0:
        return (not have_no_root(f_low, f_high), low if abs(f_low) < abs(f_high) else high)
    psi = (low + high) / 2.0
    for step in range(MOST_HALVINGS):
        f = evaluate_root_function(function, psi)
        if (f > 0.0) == (f_high > 0.0):
            high, f_high = psi, f
        else:
            low, f_low = psi, f
        if f == 0.0 or high - low < 1e-15:
            break
        # The straight line's root, and every third time the middle, so that the range surely shrinks.
        psi = low - f_low * (high - low) / (f_high - f_low) if f_high != f_low else (low + high) / 2.0
        if step % 3 == 2 or not low < psi < high:
            psi = (low + high) / 2.0
    return (True, psi)


@inner
def is_level(function: RootFunction, low: float, high: float, least: float) -> bool:
    """Return whether a function clearly has no root in a range too narrow to be cut.

    That is so where the absolute value in the middle exceeds ``least`` and twice the differences from the
    values at both ends.
    """
    f = evaluate_root_function(function, (low + high) / 2.0)
    f_low = evaluate_root_function(function, low)
    f_high = evaluate_root_function(function, high)
    return abs(f) > least and abs(f) > 2.0 * max(abs(f - f_low), abs(f - f_high))
