"""Four contacts: a pair of pegs of each jaw at one height, or a pair and a third peg of its own jaw that
touches.

Both are roots of functions, APART and GAP of ``two_contact_curves``. Their first derivative is known at a
place, and their second is bounded over a cell by the speed of the instant centres. A range is dropped where
the function cannot vanish, solved where its derivative keeps its sign, and halved otherwise. What is too
narrow to be halved is in doubt. (At a double root, which looks like two or none, nothing clamps.)
"""

from __future__ import annotations

from math import cos, inf, sin

from workhold.kernels.base.compiling import (
    Array,
    IntVector,
    Matrix,
    compiled,
    inner,
)
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, RADIUS, SIGN, X, Y
from workhold.kernels.seating.columns import (
    BOTTOM,
    CELL_LENGTH,
    FIRST_PEG,
    HIGH,
    LOW,
    PAIR,
    SECOND_PEG,
    SPEED,
    TOP,
    VAGUE,
    HeldPart,
    JawCells,
)
from workhold.kernels.seating.obstacles import compute_length
from workhold.kernels.seating.three_contacts import HALVES, MAYBE, NOTHING, write_root
from workhold.kernels.seating.two_contact_curves import (
    APART,
    COSINE,
    END,
    GAP,
    SINE,
    PairState,
    RootFunction,
    compute_pair_height,
    compute_pair_state,
    find_root_between,
    have_no_root,
    is_level,
    measure_gap,
    read_pair_state,
)

# Ranges narrower than this, in radians, are not halved.
NARROWEST = 1e-9
# mm. Rounding of a height or a distance; and how near places are that are one.
ROUNDING, SAME = 2e-12, 1e-7


@inner
def judge_two_cells(p: Array, q: Array, low: float, high: float, given: HeldPart) -> int:
    """Return the verdict NOTHING, HALVES or MAYBE on a range of psi in which two pairs may hold the part at
    one height.

    The pairs' cells ``p`` and ``q``, of different jaws, must not be vague. NOTHING: APART has no root in
    [low, high]; HALVES: halve the range; MAYBE: there is at most one root. See ``seating.columns`` for the
    layout of ``p`` and ``q``. Symbols are those of ``seating.two_contact_curves``.
    """
    one, two = given.pairs[int(p[PAIR])], given.pairs[int(q[PAIR])]
    psi, reach = (low + high) / 2.0, (high - low) / 2.0
    s, t = compute_pair_state(one, given, psi), compute_pair_state(two, given, psi)
    cosine, sine = cos(psi), sin(psi)
    f = compute_pair_height(two, given, t.x, t.y, cosine, sine) - compute_pair_height(
        one, given, s.x, s.y, cosine, sine
    )
    gx, gy, speed = t.center_x - s.center_x, t.center_y - s.center_y, p[SPEED] + q[SPEED]
    apart = compute_length(gx, gy)
    # Two pegs cannot be in one place, and pairs that turn about one centre are loose throughout.
    if (compute_length(t.x - s.x, t.y - s.y) < SAME and abs(f) < SAME) or (apart < SAME and speed == 0.0):
        return NOTHING
    slope, bend = abs(cosine * gx + sine * gy), apart + speed * (1.0 + reach)
    if abs(f) > reach * (slope + bend * reach / 2.0 * 1.001) + ROUNDING:
        return NOTHING
    return MAYBE if slope > bend * reach * 1.001 else HALVES


@inner
def judge_third_peg(
    cell: Array, ox: float, oy: float, piece: Array, low: float, high: float, given: HeldPart
) -> int:
    """Return the verdict NOTHING, HALVES or MAYBE on a range of psi in which another peg may touch a piece.

    The peg is (ox, oy) mm from the first peg of the cell's pair, in the vise frame. The range is [low, high].
    See :func:`judge_two_cells` for the verdicts, ``seating.columns`` for the layout of ``cell``,
    ``base.feature`` for that of ``piece``.
    """
    psi = (low + high) / 2.0
    s = compute_pair_state(given.pairs[int(cell[PAIR])], given, psi)
    x, y = compute_peg_place(s, cos(psi), sin(psi), ox, oy)
    return judge_place(cell, s, x, y, piece, (high - low) / 2.0)


@inner
def compute_peg_place(s: PairState, cosine: float, sine: float, ox: float, oy: float) -> tuple[float, float]:
    """Return the place (x, y) on the part of a peg that is (ox, oy)
    mm from the pair's first peg in the vise frame.
    """
    return (s.x + cosine * ox - sine * oy, s.y + sine * ox + cosine * oy)


@inner
def judge_place(cell: Array, s: PairState, x: float, y: float, piece: Array, reach: float) -> int:
    """Return the verdict NOTHING, HALVES or MAYBE on a range of psi in which another peg may touch a piece.

    In the middle of the range, whose half width is ``reach``, the pair is ``s`` and the peg's place on the
    part is (x, y). See :func:`judge_two_cells` for the verdicts, ``seating.columns`` for the layout of
    ``cell``, ``base.feature`` for that of ``piece``.
    """
    gx, gy = x - s.center_x, y - s.center_y
    speed = (compute_length(gx, gy) + cell[SPEED] * reach) * (1.0 + 2.0 * reach)
    bend = speed + cell[SPEED]
    dx, dy = x - piece[X], y - piece[Y]
    if piece[IS_ARC] == 0.0:
        if abs(dx * piece[AXIS_X] + dy * piece[AXIS_Y]) > piece[HALF_EXTENT] + speed * reach + END:
            return NOTHING
        f, nx, ny = dx * piece[AXIS_Y] - dy * piece[AXIS_X], piece[AXIS_Y], -piece[AXIS_X]
    else:
        size = max(compute_length(dx, dy), 1e-150)
        f, nx, ny = piece[SIGN] * (size - piece[RADIUS]), piece[SIGN] * dx / size, piece[SIGN] * dy / size
        if cell[SPEED] == 0.0 and compute_length(s.center_x - piece[X], s.center_y - piece[Y]) < SAME:
            return NOTHING
        least = size - speed * reach
        bend += speed * speed / least if least > 0.0 else inf
    if abs(f) > speed * reach + ROUNDING:
        return NOTHING
    slope = abs(ny * gx - nx * gy)
    if abs(f) > reach * (slope + bend * reach / 2.0 * 1.001) + ROUNDING:
        return NOTHING
    return MAYBE if slope > bend * reach * 1.001 else HALVES


@inner
def write_roots_between(
    kind: float,
    p: Array,
    q: Array,
    peg: int,
    number: int,
    given: HeldPart,
    stack: Array,
    out: Array,
    count: int,
) -> int:
    """Append the roots of APART over two cells, or of GAP over a cell, a peg and a piece, to ``out`` (N, 6).

    Return the new number of roots, or -1 when there is no room. See ``seating.columns`` for the layout of
    ``p`` and ``q``. Symbols are those of ``seating.two_contact_curves``.

    Parameters
    ----------
    kind : APART (two pairs at one height) or GAP (another peg touches), see ``two_contact_curves``.
    p, q : cells; the same cell twice for GAP.
    peg, number : peg and piece for GAP, else -1.
    stack : (DEPTH, 2) work space.
    """
    one, two = given.pairs[int(p[PAIR])], given.pairs[int(q[PAIR])]
    vague = p[VAGUE] != 0.0 or q[VAGUE] != 0.0
    piece, ox, oy = given.rows[0], 0.0, 0.0
    if kind == GAP:
        piece, tail = given.rows[number], int(one[FIRST_PEG])
        ox, oy = given.pegs[peg, 0] - given.pegs[tail, 0], given.pegs[peg, 1] - given.pegs[tail, 1]
    function, depth = RootFunction(kind, one, two, piece, ox, oy, given), 1
    stack[0, 0], stack[0, 1] = max(p[LOW], q[LOW]), min(p[HIGH], q[HIGH])
    while depth > 0:
        depth -= 1
        low, high = stack[depth, 0], stack[depth, 1]
        psi = (low + high) / 2.0
        verdict = MAYBE
        if not vague:
            verdict = (
                judge_two_cells(p, q, low, high, given)
                if kind == APART
                else judge_third_peg(p, ox, oy, piece, low, high, given)
            )
        if verdict == NOTHING:
            continue
        doubt = 0.0
        if verdict == MAYBE:
            found, psi = find_root_between(function, low, high)
            if not found:
                continue
        elif high - low > 2.0 * NARROWEST and depth < stack.shape[0] - 1:
            stack[depth, 0], stack[depth, 1] = low, psi
            stack[depth + 1, 0], stack[depth + 1, 1] = psi, high
            depth += 2
            continue
        else:
            if is_level(function, low, high, ROUNDING):
                continue
            doubt = 1.0
        count = write_root(out, count, p[PAIR], peg, number if kind == GAP else int(q[PAIR]), 0.0, psi, doubt)
        if count < 0:
            return -1
    return count


@inner
def write_cell_in_pattern(number: int, jaw: JawCells, out: Array) -> None:
    """Write the cell ``number`` of a jaw to ``out`` (7,), converted from the jaw's own frame to the pattern
    of both jaws.

    The heights and the number of the pair change.
    """
    for k in range(CELL_LENGTH):
        out[k] = jaw.cells[number, k]
    out[BOTTOM] -= jaw.height
    out[TOP] -= jaw.height
    out[PAIR] += jaw.before


@compiled
def write_two_pairs(
    left: JawCells,
    right: JawCells,
    given: HeldPart,
    two_cells: Matrix,
    stack: Matrix,
    reaching: IntVector,
    out: Matrix,
) -> int:
    """Write the roots at which a pair of the left jaw and one of the
    right jaw have the same height to ``out``.

    Return their number, or -1 when there is no room.

    Parameters
    ----------
    two_cells, stack : (2, 7) and (DEPTH, 2) work space.
    reaching : work space, as many entries as there are right cells.
    out : (N, 6) receives the roots, see ``three_contacts``; the right pair stands in the column ROOT_PIECE.
    """
    p, others, lifted = two_cells[0], right.cells, right.height
    count = known = begun = 0
    for i in range(left.cells.shape[0]):
        write_cell_in_pattern(i, left, p)
        # Few right cells began before this one and reach into it; then come those that begin in it.
        kept = 0
        for k in range(known):
            if others[reaching[k], HIGH] >= p[LOW]:
                reaching[kept] = reaching[k]
                kept += 1
        known = kept
        while begun < others.shape[0] and others[begun, LOW] < p[LOW]:
            if others[begun, HIGH] >= p[LOW]:
                reaching[known] = begun
                known += 1
            begun += 1
        for k in range(known + others.shape[0] - begun):
            number = reaching[k] if k < known else begun + k - known
            if others[number, LOW] > p[HIGH]:
                break
            if others[number, BOTTOM] - lifted > p[TOP] or others[number, TOP] - lifted < p[BOTTOM]:
                continue
            write_cell_in_pattern(number, right, two_cells[1])
            count = write_roots_between(APART, p, two_cells[1], -1, -1, given, stack, out, count)
            if count < 0:
                return -1
    return count


@compiled
def write_third_of_jaw(
    cells: Matrix, middles: Matrix, given: HeldPart, discs: Matrix, stack: Matrix, out: Matrix
) -> int:
    """Write the roots of GAP, where a third peg of a pair's own jaw touches a piece, to ``out`` (N, 6).

    Return their number, or -1 when there is no room. See ``seating.columns`` for the layout of ``cells``.

    Parameters
    ----------
    cells, middles : (C, 7) and (C, 19) of one jaw; see ``two_contact_curves`` for the middles.
    discs : (N, 3) disc around each piece: centre x, y and radius in mm.
    stack : (DEPTH, 2) work space.
    """
    count = 0
    for number in range(cells.shape[0]):
        cell, middle = cells[number], middles[number]
        pair = given.pairs[int(cell[PAIR])]
        tail, head = int(pair[FIRST_PEG]), int(pair[SECOND_PEG])
        reach, s = (cell[HIGH] - cell[LOW]) / 2.0, read_pair_state(middle)
        at_low, at_high = s, s
        if cell[VAGUE] != 0.0:
            at_low, at_high = (
                compute_pair_state(pair, given, cell[LOW]),
                compute_pair_state(pair, given, cell[HIGH]),
            )
        for third in range(given.pegs.shape[0]):
            if given.right[third] != given.right[tail] or third in (tail, head):
                continue
            ox, oy = given.pegs[third, 0] - given.pegs[tail, 0], given.pegs[third, 1] - given.pegs[tail, 1]
            x, y = compute_peg_place(s, middle[COSINE], middle[SINE], ox, oy)
            low = high = (x, y)
            if cell[VAGUE] != 0.0:
                low = compute_peg_place(at_low, cos(cell[LOW]), sin(cell[LOW]), ox, oy)
                high = compute_peg_place(at_high, cos(cell[HIGH]), sin(cell[HIGH]), ox, oy)
            play = (
                (compute_length(x - s.center_x, y - s.center_y) + cell[SPEED] * reach)
                * (1.0 + 2.0 * reach)
                * reach
                + END
                + ROUNDING
            )
            for piece in range(given.parts[given.right[tail], 0], given.parts[given.right[tail], 1]):
                row = given.rows[piece]
                if cell[VAGUE] != 0.0:
                    if have_no_root(measure_gap(row, low[0], low[1]), measure_gap(row, high[0], high[1])):
                        continue
                else:
                    dx, dy, far = x - discs[piece, 0], y - discs[piece, 1], discs[piece, 2] + play
                    if dx * dx + dy * dy > far * far or judge_place(cell, s, x, y, row, reach) == NOTHING:
                        continue
                count = write_roots_between(GAP, cell, cell, third, piece, given, stack, out, count)
                if count < 0:
                    return -1
    return count
