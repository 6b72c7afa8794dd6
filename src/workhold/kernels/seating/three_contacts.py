"""Three forces in balance: the normal of a third peg, of the other jaw, meets a pair's instant centre.

Over a range of orientations the instant centre P moves no faster than the speed V of its cell, and along a
ray (``two_contact_curves.Ray``). Both bound the foot of P on a piece, the directions of all three forces and
the height missed (``two_contact_curves.MISS``). A range is dropped where the foot is off the piece, the
forces cannot all press, or the height cannot vanish; before that, whole pieces by the discs around them.

By an enclosure of P' (``chord.stretches``) there is no root where the mean value theorem leaves none.
There is one at most where the derivative keeps its sign; else the range is halved. What is too narrow to be
halved is in doubt. Beside a tangency, where V is of no use, three values that hardly differ decide.
"""

from __future__ import annotations

from math import asin, cos, inf, pi, sin

from workhold.kernels.base.compiling import (
    Array,
    Matrix,
    compiled,
    inner,
)
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, RADIUS, SIGN, X, Y
from workhold.kernels.base.interval import Interval, idivide, imul
from workhold.kernels.base.tables import HEAD, TAIL
from workhold.kernels.chord.stretches import enclose_center_motion
from workhold.kernels.seating.columns import (
    ANGLE,
    FIRST_PEG,
    HIGH,
    KIND,
    LOW,
    PAIR,
    SOURCE,
    SPEED,
    VAGUE,
    HeldPart,
)
from workhold.kernels.seating.obstacles import (
    FootPoint,
    compute_angle_from_middle,
    compute_length,
    find_foot,
    share_normals,
)
from workhold.kernels.seating.two_contact_curves import (
    AT_END,
    COSINE,
    END,
    MISS,
    SINE,
    PairState,
    Ray,
    RootFunction,
    compute_pair_state,
    find_root_between,
    is_foot_off,
    is_level,
    make_ray_over,
    read_pair_state,
    read_ray,
)

# Ranges narrower than this, in radians, are not halved, but where values differ over them that are near 0 and
# P moves by more than some mm, as beside a tangency; none is that is as narrow as the last.
NARROWEST, STILL, LAST = 2e-8, 1e-3, 1e-13
# mm. Rounding of a height and of a direction.
ROUNDING = 2e-12
# Columns of what is found: ROOT_PAIR, ROOT_PEG, ROOT_PIECE, ROOT_SIDE, ROOT_PSI, ROOT_DOUBT.
ROOT_PAIR, ROOT_PEG, ROOT_PIECE, ROOT_SIDE, ROOT_PSI, ROOT_DOUBT = range(6)
ROOT_LENGTH = 6
# Verdicts on a range.
NOTHING, HALVES, MAYBE = 0, 1, 2


@inner
def may_balance(s: PairState, nx: float, ny: float, ray: Ray, turn: float) -> bool:
    """Return whether the third contact's force may lie between the other two somewhere in a range.

    (nx, ny) is the third normal in the middle of the range; it turns by at most ``turn`` radians over the
    range, the other two by at most what the ray states.
    """
    sign = 1.0 if s.ax * s.by - s.ay * s.bx >= 0.0 else -1.0
    first, second = sign * (ny * s.bx - nx * s.by), sign * (s.ay * nx - s.ax * ny)
    return first >= -(turn + ray.turn_b) - 1e-9 and second >= -(turn + ray.turn_a) - 1e-9


@inner
def write_point_heights(
    discs: Array, s: PairState, cosine: float, sine: float, speed: float, reach: float, off: Array
) -> None:
    """Write the heights above the first peg that points in given discs of the part may have over a range of
    psi.

    Seen from the first peg, a point c of the part rises by x . (P - c) per radian; P moves no faster than
    ``speed`` (mm per radian). Symbols are those of ``seating.two_contact_curves``.

    Parameters
    ----------
    discs : (3, N) centre x, centre y and radius in mm.
    s, cosine, sine : pair and orientation in the middle of the range.
    reach : half of the range in radians.
    off : (2, N) receives heights in the middle of the range, and how far from them they may be, in mm.
    """
    xs, ys, radii, heights, slacks = discs[0], discs[1], discs[2], off[0], off[1]
    most = speed * (1.0 + reach)
    for k in range(xs.shape[0]):
        gx, gy = xs[k] - s.center_x, ys[k] - s.center_y
        bend = reach * reach / 2.0 * (abs(gx) + abs(gy) + most)
        heights[k] = cosine * (ys[k] - s.y) - sine * (xs[k] - s.x)
        slacks[k] = radii[k] + bend + END + ROUNDING + reach * abs(cosine * gx + sine * gy)


@inner
def is_behind(
    disc: Array,
    s: PairState,
    cosine: float,
    sine: float,
    speed: float,
    reach: float,
    beyond: float,
    push: float,
) -> bool:
    """Return whether no point in a disc of the part can meet the
    third peg over a range with S above the stop.

    Seen from the first peg, a point c moves along x by y . (c - P) per radian. Symbols are those of
    ``seating.two_contact_curves``. S is the jaw separation in mm.

    Parameters
    ----------
    disc : (3,) centre x, centre y and radius in mm.
    speed, reach : see :func:`write_point_heights`.
    beyond : place of the third peg along x from the first at the stop, in mm.
    push : 1 where the third peg is of the right jaw, -1 where it is of the left one.
    """
    gx, gy = disc[0] - s.center_x, disc[1] - s.center_y
    bend = reach * reach / 2.0 * (abs(gx) + abs(gy) + speed * (1.0 + reach))
    slack = disc[2] + bend + END + ROUNDING + reach * abs(cosine * gy - sine * gx)
    return push * (cosine * (disc[0] - s.x) + sine * (disc[1] - s.y) - beyond) < -slack


@inner
def judge_by_foot(
    piece: Array,
    push: float,
    missed: float,
    cosine: float,
    sine: float,
    s: PairState,
    f: FootPoint,
    speed: float,
    reach: float,
) -> int:
    """Return the verdict on a range of psi by the foot of the perpendicular from the instant centre P to a
    piece alone.

    NOTHING: there is no root; HALVES: halve the range; MAYBE: examine it further. See ``base.feature`` for
    the layout of ``piece``. Symbols are those of ``seating.two_contact_curves``.

    Parameters
    ----------
    push : 1 where the third peg is of the right jaw, -1 where it is of the left one.
    missed : MISS in the middle of the range, in mm.
    s, f : pair, and foot of P on the piece, there.
    speed, reach : bound of P's speed in mm per radian, and half of the range in radians.
    """
    move, turn = speed * reach, 0.0
    if piece[IS_ARC] != 0.0:
        if f.distance <= move * 1.0001 + ROUNDING:
            return HALVES
        turn = asin(move / f.distance)
    if push * (f.normal_x * cosine + f.normal_y * sine) < -(turn + reach):
        return NOTHING
    way = speed if piece[IS_ARC] == 0.0 else piece[RADIUS] * speed / (f.distance - move)
    if abs(missed) > (compute_length(s.center_x - f.x, s.center_y - f.y) + move + way) * reach + ROUNDING:
        return NOTHING
    if piece[IS_ARC] == 0.0:
        at = (f.x - piece[X]) * piece[AXIS_X] + (f.y - piece[Y]) * piece[AXIS_Y]
        return NOTHING if abs(at) > piece[HALF_EXTENT] + move + END else MAYBE
    beyond = piece[HALF_EXTENT] + turn + END / piece[RADIUS]
    is_off = (
        beyond < pi
        and abs(compute_angle_from_middle(piece, piece[SIGN] * f.normal_x, piece[SIGN] * f.normal_y)) > beyond
    )
    return NOTHING if is_off else MAYBE


@inner
def may_decide(
    piece: Array,
    missed: float,
    cosine: float,
    sine: float,
    s: PairState,
    f: FootPoint,
    speed: float,
    reach: float,
) -> bool:
    """Return whether :func:`compute_slope_range` may show that a range has at most one root, or none.

    If False, that function need not be called: its doubt is too large even where P' is taken as 0. See
    ``base.feature`` for the layout of ``piece``. Symbols are those of ``seating.two_contact_curves``.
    """
    move, gx, gy = speed * reach, s.center_x - f.x, s.center_y - f.y
    turn, ratio = (
        (0.0, 1.0) if piece[IS_ARC] == 0.0 else (asin(move / f.distance), piece[RADIUS] / f.distance)
    )
    doubt = move + (compute_length(gx, gy) + move) * (turn + reach)
    return abs(cosine * gx + sine * gy) + ratio * speed > doubt or abs(missed) > doubt * reach


@inner
def compute_slope_range(
    piece: Array,
    side: float,
    cosine: float,
    sine: float,
    s: PairState,
    f: FootPoint,
    motion: tuple[Interval, Interval],
    speed: float,
    reach: float,
) -> tuple[float, float]:
    """Return (slope, doubt): the derivative of MISS in the middle of
    a range and its largest deviation over the range.

    Both are in mm per radian; (0, inf) where P' is not bounded. ``motion`` encloses x and y of P' over the
    range; ``s`` and ``f`` are the pair and the foot of P in its middle, ``reach`` is half of the range in
    radians. See ``base.feature`` for the layout of ``piece``. Symbols are those of
    ``seating.two_contact_curves``.
    """
    qx, qy = motion
    if not (qx[1] - qx[0] < inf and qy[1] - qy[0] < inf):
        return (0.0, inf)
    mx, my, spread = (
        (qx[0] + qx[1]) / 2.0,
        (qy[0] + qy[1]) / 2.0,
        compute_length(qx[1] - qx[0], qy[1] - qy[0]) / 2.0,
    )
    move, size = speed * reach, min(compute_length(mx, my) + spread, speed)
    gx, gy = s.center_x - f.x, s.center_y - f.y
    far = compute_length(gx, gy) + move
    slope = cosine * gx + sine * gy
    if piece[IS_ARC] == 0.0:
        tx, ty = -f.normal_y, f.normal_x
        slope += (mx * tx + my * ty) * (cosine * ty - sine * tx)
        return (slope, (move + reach * (far + size) + spread) * (1.0 + 1e-6) + ROUNDING)
    # foot' is the part of P' across the way from the centre, in proportion; the way turns by up to ``turn``.
    turn = asin(move / f.distance)
    ex, ey = (f.x - piece[X]) / piece[RADIUS], (f.y - piece[Y]) / piece[RADIUS]
    ratio, worst = piece[RADIUS] / f.distance, piece[RADIUS] / (f.distance - move)
    slope += side * ratio * (my * ex - mx * ey) * (cosine * ex + sine * ey)
    doubt = (
        move + far * (turn + reach) + worst * (spread + size * (2.0 * turn + reach)) + size * (worst - ratio)
    )
    return (slope, doubt * (1.0 + 1e-6) + ROUNDING)


@inner
def enclose_center_velocity(
    a: Array, b: Array, reals: Array, low: float, high: float, sign: float
) -> tuple[Interval, Interval]:
    """Return enclosures of x and y of P' (mm per radian) over alpha in [low, high].

    ``reals`` are those of the chord curve, ``sign`` is that of the cross product of the outward normals. See
    ``base.feature`` for the layout of ``a`` and ``b``, ``base.tables`` for that of ``reals``. Symbols are
    those of ``seating.two_contact_curves``.
    """
    motion = enclose_center_motion(a, b, reals, low, high, sign * a[SIGN] * b[SIGN])
    cube = imul(motion.turn, imul(motion.turn, motion.turn))
    return (idivide(motion.x, cube), idivide(motion.y, cube))


@inner
def write_roots_of_cell(
    cell: Array,
    third: int,
    number: int,
    side: float,
    middle: Array,
    given: HeldPart,
    stack: Array,
    out: Array,
    count: int,
) -> int:
    """Append the orientations in a cell at which the pair and peg ``third`` on piece ``number`` may balance
    to ``out`` (N, 6).

    These are the roots of MISS. Return the new number of roots, -1 when there is no room. ``middle`` (19,) is
    the cell's row of ``write_middles``, ``side`` selects the foot on a circle (see ``obstacles.find_foot``).
    See ``seating.columns`` for the layout of ``cell``, ``seating.two_contact_curves`` for that of ``middle``.
    Symbols are those of ``seating.two_contact_curves``.
    """
    pair, piece = given.pairs[int(cell[PAIR])], given.rows[number]
    k, tail, speed = int(pair[SOURCE]), int(pair[FIRST_PEG]), cell[SPEED]
    a, b = given.rows[given.curves[k, TAIL]], given.rows[given.curves[k, HEAD]]
    # Forces press the left jaw to the left, the right one to the right.
    push = 1.0 if given.right[third] == 1 else -1.0
    above = given.pegs[third, 1] - given.pegs[tail, 1]
    s, ray, cosine, sine = read_pair_state(middle), read_ray(middle), middle[COSINE], middle[SINE]
    function, depth = RootFunction(MISS, pair, pair, piece, above, side, given), 1
    stack[0, 0], stack[0, 1] = cell[LOW], cell[HIGH]
    while depth > 0:
        depth -= 1
        low, high = stack[depth, 0], stack[depth, 1]
        psi, reach = (low + high) / 2.0, (high - low) / 2.0
        if reach < (cell[HIGH] - cell[LOW]) / 2.0:
            s, cosine, sine = compute_pair_state(pair, given, psi), cos(psi), sin(psi)
            ray = make_ray_over(pair, given, s, speed, reach)
        if is_foot_off(piece, side, push, above, cosine, sine, s, ray, reach):
            continue
        f = find_foot(piece, s.center_x, s.center_y, side)
        missed = cosine * (f.y - s.y) - sine * (f.x - s.x) - above
        verdict = judge_by_foot(piece, push, missed, cosine, sine, s, f, speed, reach)
        if verdict == NOTHING:
            continue
        if verdict == MAYBE:
            turn = 0.0 if piece[IS_ARC] == 0.0 else asin(speed * reach / f.distance)
            if not may_balance(s, f.normal_x, f.normal_y, ray, turn):
                continue
            slope, doubt = 0.0, inf
            if may_decide(piece, missed, cosine, sine, s, f, speed, reach):
                sign = 1.0 if s.ax * s.by - s.ay * s.bx >= 0.0 else -1.0
                motion = enclose_center_velocity(
                    a, b, given.reals[k], low + pair[ANGLE], high + pair[ANGLE], sign
                )
                slope, doubt = compute_slope_range(piece, side, cosine, sine, s, f, motion, speed, reach)
            if abs(missed) > (abs(slope) + doubt) * reach + AT_END:
                continue
            if abs(slope) > doubt:
                found, psi = find_root_between(function, low, high)
                if found:
                    count = write_root(out, count, cell[PAIR], third, number, side, psi, 0.0)
                if count < 0:
                    return -1
                continue
        halved = reach > NARROWEST
        if not halved:
            if verdict == MAYBE and is_level(function, low, high, 0.0):
                continue
            halved = reach > LAST and speed * reach > STILL
        if halved and depth < stack.shape[0] - 1:
            stack[depth, 0], stack[depth, 1] = low, psi
            stack[depth + 1, 0], stack[depth + 1, 1] = psi, high
            depth += 2
        elif verdict == MAYBE:
            count = write_root(out, count, cell[PAIR], third, number, side, psi, 1.0)
            if count < 0:
                return -1
    return count


@inner
def write_root(
    out: Array, count: int, pair: float, peg: int, piece: int, side: float, psi: float, doubt: float
) -> int:
    """Append a root (6,) to ``out``; return the new number of roots, or -1 when there is no room.

    Columns are ROOT_PAIR to ROOT_DOUBT; psi is in radians, ``doubt`` 1 where it is undecided whether the root
    exists.
    """
    if count >= out.shape[0]:
        return -1
    row = out[count]
    row[ROOT_PAIR], row[ROOT_PEG], row[ROOT_PIECE], row[ROOT_SIDE] = pair, peg, piece, side
    row[ROOT_PSI], row[ROOT_DOUBT] = psi, doubt
    return count + 1


@compiled
def write_three_contacts(
    cells: Matrix,
    middles: Matrix,
    given: HeldPart,
    discs: Matrix,
    stop: float,
    stack: Matrix,
    work: Matrix,
    out: Matrix,
) -> int:
    """Write the orientations at which two pegs of one jaw and one of the other may balance (roots of MISS) to
    ``out``.

    Return their number, -1 when there is no room. See ``seating.columns`` for the layout of ``cells``.
    Symbols are those of ``seating.two_contact_curves``.

    Parameters
    ----------
    cells, middles : (C, 7) and (C, 19) of the pairs of one jaw, see ``two_contact_curves``; pockets and vague
        cells are left out.
    discs : (N, 3) disc around each piece: centre x, y and radius in mm.
    stop : the smallest jaw separation in mm.
    stack, work : (DEPTH, 2) and (5, N) work space.
    out : (N, 6) receives the roots, see :func:`write_root`.
    """
    # The same number of each disc in a row, for loops that work out several at a time.
    for piece in range(discs.shape[0]):
        for k in range(3):
            work[k, piece] = discs[piece, k]
    count = 0
    for number in range(cells.shape[0]):
        cell, middle = cells[number], middles[number]
        pair = given.pairs[int(cell[PAIR])]
        if cell[VAGUE] != 0.0 or pair[KIND] == 1.0:
            continue
        k, tail, reach = int(pair[SOURCE]), int(pair[FIRST_PEG]), (cell[HIGH] - cell[LOW]) / 2.0
        a, b = given.rows[given.curves[k, TAIL]], given.rows[given.curves[k, HEAD]]
        s, ray, cosine, sine = read_pair_state(middle), read_ray(middle), middle[COSINE], middle[SINE]
        write_point_heights(work[:3], s, cosine, sine, cell[SPEED], reach, work[3:])
        for third in range(given.pegs.shape[0]):
            if given.right[third] == given.right[tail]:
                continue
            push = 1.0 if given.right[third] == 1 else -1.0
            above = given.pegs[third, 1] - given.pegs[tail, 1]
            beyond = given.pegs[third, 0] - given.pegs[tail, 0] + push * stop
            for piece in range(given.parts[given.right[third], 0], given.parts[given.right[third], 1]):
                if abs(work[3, piece] - above) > work[4, piece]:
                    continue
                c = given.rows[piece]
                # The normal of a line is one, wherever it is touched.
                if c[IS_ARC] == 0.0 and not may_balance(s, c[AXIS_Y], -c[AXIS_X], ray, 0.0):
                    continue
                if is_behind(discs[piece], s, cosine, sine, cell[SPEED], reach, beyond, push):
                    continue
                # Where its normal is that of another contact throughout, the one that is left has no force.
                if share_normals(a, c) or share_normals(b, c):
                    continue
                for sides in range(1 if c[IS_ARC] == 0.0 else 2):
                    side = 1.0 - 2.0 * sides
                    count = write_roots_of_cell(cell, third, piece, side, middle, given, stack, out, count)
                    if count < 0:
                        return -1
    return count
