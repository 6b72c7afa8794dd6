"""Four contacts: pairs of both jaws at one height, or a further peg of a pair's own jaw that touches.

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
    Given,
    JawCells,
)
from workhold.kernels.seating.obstacles import length
from workhold.kernels.seating.three_contacts import HALVES, MAYBE, NOTHING, write_root
from workhold.kernels.seating.two_contact_curves import (
    APART,
    COSINE,
    END,
    GAP,
    SINE,
    Function,
    PairState,
    gap,
    have_no_root,
    height,
    is_level,
    pair_at,
    pair_in,
    root_between,
)

# Ranges narrower than this, in radians, are not halved.
NARROWEST = 1e-9
# mm. Rounding of a height or a distance; and how near places are that are one.
ROUNDING, SAME = 2e-12, 1e-7


@inner
def verdict_on_two(p: Array, q: Array, low: float, high: float, given: Given) -> int:
    """The verdict on a range of two cells: NOTHING there, HALVES to look at, or one root (MAYBE)."""
    one, two = given.pairs[int(p[PAIR])], given.pairs[int(q[PAIR])]
    psi, reach = (low + high) / 2.0, (high - low) / 2.0
    s, t = pair_at(one, given, psi), pair_at(two, given, psi)
    cosine, sine = cos(psi), sin(psi)
    f = height(two, given, t[0], t[1], cosine, sine) - height(one, given, s[0], s[1], cosine, sine)
    gx, gy, speed = t[6] - s[6], t[7] - s[7], p[SPEED] + q[SPEED]
    apart = length(gx, gy)
    # Two pegs cannot be in one place, and pairs that turn about one centre are loose throughout.
    if (length(t[0] - s[0], t[1] - s[1]) < SAME and abs(f) < SAME) or (apart < SAME and speed == 0.0):
        return NOTHING
    slope, bend = abs(cosine * gx + sine * gy), apart + speed * (1.0 + reach)
    if abs(f) > reach * (slope + bend * reach / 2.0 * 1.001) + ROUNDING:
        return NOTHING
    return MAYBE if slope > bend * reach * 1.001 else HALVES


@inner
def verdict_on_third(
    cell: Array, ox: float, oy: float, piece: Array, low: float, high: float, given: Given
) -> int:
    """The verdict on a range in which a peg (ox, oy) from the first may touch a piece."""
    psi = (low + high) / 2.0
    s = pair_at(given.pairs[int(cell[PAIR])], given, psi)
    x, y = place_of(s, cos(psi), sin(psi), ox, oy)
    return verdict_on_place(cell, s, x, y, piece, (high - low) / 2.0)


@inner
def place_of(s: PairState, cosine: float, sine: float, ox: float, oy: float) -> tuple[float, float]:
    """Place on the part of a peg (ox, oy) from the first in the vise frame."""
    return (s[0] + cosine * ox - sine * oy, s[1] + sine * ox + cosine * oy)


@inner
def verdict_on_place(cell: Array, s: PairState, x: float, y: float, piece: Array, reach: float) -> int:
    """The verdict on a range by what is in its middle: the pair, and the peg's place (x, y)."""
    gx, gy = x - s[6], y - s[7]
    speed = (length(gx, gy) + cell[SPEED] * reach) * (1.0 + 2.0 * reach)
    bend = speed + cell[SPEED]
    dx, dy = x - piece[X], y - piece[Y]
    if piece[IS_ARC] == 0.0:
        if abs(dx * piece[AXIS_X] + dy * piece[AXIS_Y]) > piece[HALF_EXTENT] + speed * reach + END:
            return NOTHING
        f, nx, ny = dx * piece[AXIS_Y] - dy * piece[AXIS_X], piece[AXIS_Y], -piece[AXIS_X]
    else:
        size = max(length(dx, dy), 1e-150)
        f, nx, ny = piece[SIGN] * (size - piece[RADIUS]), piece[SIGN] * dx / size, piece[SIGN] * dy / size
        if cell[SPEED] == 0.0 and length(s[6] - piece[X], s[7] - piece[Y]) < SAME:
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
def roots_between(
    kind: float, p: Array, q: Array, peg: int, number: int, given: Given, stack: Array, out: Array, count: int
) -> int:
    """Writes the roots over two cells (APART), or over a cell, a peg and a piece (GAP).

    Returns the new count or -1.
    """
    one, two = given.pairs[int(p[PAIR])], given.pairs[int(q[PAIR])]
    vague = p[VAGUE] != 0.0 or q[VAGUE] != 0.0
    piece, ox, oy = given.rows[0], 0.0, 0.0
    if kind == GAP:
        piece, tail = given.rows[number], int(one[FIRST_PEG])
        ox, oy = given.pegs[peg, 0] - given.pegs[tail, 0], given.pegs[peg, 1] - given.pegs[tail, 1]
    function, depth = Function(kind, one, two, piece, ox, oy, given), 1
    stack[0, 0], stack[0, 1] = max(p[LOW], q[LOW]), min(p[HIGH], q[HIGH])
    while depth > 0:
        depth -= 1
        low, high = stack[depth, 0], stack[depth, 1]
        psi = (low + high) / 2.0
        verdict = MAYBE
        if not vague:
            verdict = (
                verdict_on_two(p, q, low, high, given)
                if kind == APART
                else verdict_on_third(p, ox, oy, piece, low, high, given)
            )
        if verdict == NOTHING:
            continue
        doubt = 0.0
        if verdict == MAYBE:
            found, psi = root_between(function, low, high)
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
def write_in_pattern(number: int, jaw: JawCells, out: Array) -> None:
    """Writes a cell of a jaw as one of the pattern, whose heights count from another peg."""
    for k in range(CELL_LENGTH):
        out[k] = jaw.cells[number, k]
    out[BOTTOM] -= jaw.height
    out[TOP] -= jaw.height
    out[PAIR] += jaw.before


@compiled
def two_pairs(
    left: JawCells,
    right: JawCells,
    given: Given,
    two_cells: Matrix,
    stack: Matrix,
    reaching: IntVector,
    out: Matrix,
) -> int:
    """Orientations at which a pair of the left jaw and one of the right have one height; how many, or -1.

    Parameters
    ----------
    two_cells, stack : (2, 7) and (DEPTH, 2) work space.
    reaching : as many as right cells: work space.
    out : (N, 6) roots, written here: the right pair stands in the column of the piece.
    """
    p, others, lifted = two_cells[0], right.cells, right.height
    count = known = begun = 0
    for i in range(left.cells.shape[0]):
        write_in_pattern(i, left, p)
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
            write_in_pattern(number, right, two_cells[1])
            count = roots_between(APART, p, two_cells[1], -1, -1, given, stack, out, count)
            if count < 0:
                return -1
    return count


@compiled
def third_of_jaw(
    cells: Matrix, middles: Matrix, given: Given, discs: Matrix, stack: Matrix, out: Matrix
) -> int:
    """Writes orientations at which a third peg of a pair's own jaw touches a piece.

    Returns how many, or -1.

    Parameters
    ----------
    cells, middles : (C, 7) and (C, 19) of one jaw.
    discs : (N, 3) around the pieces: middle and radius in mm.
    """
    count = 0
    for number in range(cells.shape[0]):
        cell, middle = cells[number], middles[number]
        pair = given.pairs[int(cell[PAIR])]
        tail, head = int(pair[FIRST_PEG]), int(pair[SECOND_PEG])
        reach, s = (cell[HIGH] - cell[LOW]) / 2.0, pair_in(middle)
        at_low, at_high = s, s
        if cell[VAGUE] != 0.0:
            at_low, at_high = pair_at(pair, given, cell[LOW]), pair_at(pair, given, cell[HIGH])
        for third in range(given.pegs.shape[0]):
            if given.right[third] != given.right[tail] or third in (tail, head):
                continue
            ox, oy = given.pegs[third, 0] - given.pegs[tail, 0], given.pegs[third, 1] - given.pegs[tail, 1]
            x, y = place_of(s, middle[COSINE], middle[SINE], ox, oy)
            low = high = (x, y)
            if cell[VAGUE] != 0.0:
                low = place_of(at_low, cos(cell[LOW]), sin(cell[LOW]), ox, oy)
                high = place_of(at_high, cos(cell[HIGH]), sin(cell[HIGH]), ox, oy)
            play = (
                (length(x - s[6], y - s[7]) + cell[SPEED] * reach) * (1.0 + 2.0 * reach) * reach
                + END
                + ROUNDING
            )
            for piece in range(given.parts[given.right[tail], 0], given.parts[given.right[tail], 1]):
                row = given.rows[piece]
                if cell[VAGUE] != 0.0:
                    if have_no_root(gap(row, low[0], low[1]), gap(row, high[0], high[1])):
                        continue
                else:
                    dx, dy, far = x - discs[piece, 0], y - discs[piece, 1], discs[piece, 2] + play
                    if (
                        dx * dx + dy * dy > far * far
                        or verdict_on_place(cell, s, x, y, row, reach) == NOTHING
                    ):
                        continue
                count = roots_between(GAP, cell, cell, third, piece, given, stack, out, count)
                if count < 0:
                    return -1
    return count
