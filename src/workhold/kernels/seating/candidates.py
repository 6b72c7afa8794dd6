"""Candidates of equilibria, made from roots, and whether forces balance there."""

from __future__ import annotations

from math import cos, inf, sin, sqrt

from workhold.kernels.base.compiling import (
    Array,
    ByteVector,
    IntArray,
    IntMatrix,
    Matrix,
    compiled,
    inner,
)
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, RADIUS, SIGN, X, Y
from workhold.kernels.base.tables import HEAD, TAIL
from workhold.kernels.seating.columns import (
    ANGLE,
    CANDIDATE_LENGTH,
    CLEAR,
    CONTACTS,
    DOUBT,
    FIRST_PEG,
    FORCE,
    KIND,
    MOTION,
    PEG,
    PIECE,
    PLACE_X,
    PLACE_Y,
    RESIDUAL,
    SECOND,
    SECOND_PEG,
    SEPARATION,
    SOURCE,
    THETA,
    HeldPart,
)
from workhold.kernels.seating.obstacles import (
    FootPoint,
    compute_normal,
    find_foot,
    is_on_piece,
    measure_clearance,
    measure_distance_to_piece,
)
from workhold.kernels.seating.three_contacts import (
    ROOT_DOUBT,
    ROOT_PAIR,
    ROOT_PEG,
    ROOT_PIECE,
    ROOT_PSI,
    ROOT_SIDE,
    compute_slope_range,
    enclose_center_velocity,
)
from workhold.kernels.seating.two_contact_curves import END, PairState, compute_pair_state, is_on_its_pieces

# Pivots of the balance below this are none.
SINGULAR = 1e-14
# mm. Pegs farther than this from what they are said to touch do not touch it.
MISFIT = 1e-6
# No unit. Forces balance to this, per unit of jaw force; each is above the second; in doubt, what bounds left
# so.
BALANCED, LEAST_FORCE, BALANCED_IN_DOUBT = 1e-7, 1e-9, 1e-3
# Verdicts on a candidate: it is no equilibrium, it is one, or it is in doubt.
NO_BALANCE, IN_BALANCE, DOUBTFUL = 0, 1, 2


@inner
def write_pair(row: Array, at: int, pair: Array, given: HeldPart, pocket_pieces: IntArray) -> None:
    """Write the pegs and pieces of a pair to a candidate, as its contacts number ``at`` and ``at`` + 1.

    ``pair`` is a row (7,) of pairs, ``pocket_pieces`` (P, 2) the pieces of each pocket; a pocket's peg is
    written twice. See ``seating.columns`` for the layout of ``row`` and ``pair``.
    """
    k = int(pair[SOURCE])
    row[PEG + at], row[PEG + at + 1] = pair[FIRST_PEG], pair[SECOND_PEG]
    if pair[KIND] == 1.0:
        row[PEG + at + 1] = pair[FIRST_PEG]
        row[PIECE + at], row[PIECE + at + 1] = pocket_pieces[k, 0], pocket_pieces[k, 1]
    else:
        row[PIECE + at], row[PIECE + at + 1] = given.curves[k, TAIL], given.curves[k, HEAD]


@inner
def write_pose(row: Array, theta: float, x: float, y: float, contacts: int) -> None:
    """Reset a candidate (24,) to a pose of the part, with ``contacts`` contacts whose pegs and pieces are
    still -1.

    The pose is theta in radians, x and y in mm. See ``seating.columns`` for the layout of ``row``.
    """
    for k in range(CANDIDATE_LENGTH):
        row[k] = 0.0
    for k in range(4):
        row[PEG + k], row[PIECE + k] = -1.0, -1.0
    row[THETA], row[PLACE_X], row[PLACE_Y], row[CONTACTS] = theta, x, y, contacts


@inner
def compute_slope_of_miss(
    pair: Array,
    piece: Array,
    side: float,
    s: PairState,
    f: FootPoint,
    cosine: float,
    sine: float,
    psi: float,
    given: HeldPart,
) -> float:
    """Return the derivative of MISS over psi in mm per radian; inf or
    NaN where the velocity of P is not known.

    It is not computed by differences, because beside a tangency a curve may end within any step. See
    ``seating.columns`` for the layout of ``pair``, ``base.feature`` for that of ``piece``. Symbols are those
    of ``seating.two_contact_curves``.
    """
    motion = ((0.0, 0.0), (0.0, 0.0))
    if pair[KIND] == 0.0:
        k, alpha = int(pair[SOURCE]), psi + pair[ANGLE]
        a, b = given.rows[given.curves[k, TAIL]], given.rows[given.curves[k, HEAD]]
        sign = 1.0 if s.ax * s.by - s.ay * s.bx >= 0.0 else -1.0
        motion = enclose_center_velocity(a, b, given.reals[k], alpha, alpha, sign)
    slope, doubt = compute_slope_range(piece, side, cosine, sine, s, f, motion, 0.0, 0.0)
    return slope if doubt < inf else inf


@compiled
def complete_three(roots: Matrix, given: HeldPart, pocket_pieces: IntMatrix, out: Matrix) -> int:
    """Write the candidates of three contacts at roots of MISS (R, 6)
    to ``out`` (at least R rows); return their number.

    MISS is 0 where the normal of a third peg goes through the instant centre of a pair. Roots at which a
    contact is off its piece are left out. With beta the distance of the third contact from the foot of P,
    along the face, S' = beta / (n . x). So at the foot S'' = beta' / (n . x). Here beta is the height missed
    over -(n . x), times 1 + kappa (P - foot) . n on an arc of curvature kappa. For a third peg that stands
    still the sign is the other. See ``seating.three_contacts`` for the layout of ``roots``. Symbols are those
    of ``seating.two_contact_curves``. S is the jaw separation in mm.
    """
    count = 0
    for r in range(roots.shape[0]):
        root = roots[r]
        pair, piece = given.pairs[int(root[ROOT_PAIR])], given.rows[int(root[ROOT_PIECE])]
        third, psi, tail = int(root[ROOT_PEG]), root[ROOT_PSI], int(pair[FIRST_PEG])
        s = compute_pair_state(pair, given, psi)
        f = find_foot(piece, s.center_x, s.center_y, root[ROOT_SIDE])
        if not (is_on_piece(piece, f.x, f.y, END) and is_on_its_pieces(pair, given, psi, s.x, s.y)):
            continue
        cosine, sine = cos(psi), sin(psi)
        x = given.pegs[tail, 0] - (cosine * s.x + sine * s.y)
        y = given.pegs[tail, 1] - (cosine * s.y - sine * s.x)
        row = out[count]
        write_pose(row, -psi, x, y, 3)
        write_pair(row, 0, pair, given, pocket_pieces)
        row[PEG + 2], row[PIECE + 2], row[DOUBT] = third, root[ROOT_PIECE], root[ROOT_DOUBT]
        place_third(row, cosine * f.x + sine * f.y, third, given)
        slope = compute_slope_of_miss(pair, piece, root[ROOT_SIDE], s, f, cosine, sine, psi, given)
        if not abs(slope) < inf:
            slope, row[DOUBT] = 0.0, 1.0
        bend = 0.0 if piece[IS_ARC] == 0.0 else piece[SIGN] / piece[RADIUS]
        level = max(abs(f.normal_x * cosine + f.normal_y * sine), 1e-9)
        second = -slope * (1.0 + bend * ((s.center_x - f.x) * f.normal_x + (s.center_y - f.y) * f.normal_y))
        row[SECOND] = (second if given.right[third] == 1 else -second) / (level * level)
        # The part turns about the instant centre.
        row[MOTION] = 1.0
        row[MOTION + 1] = cosine * s.center_y - sine * s.center_x
        row[MOTION + 2] = -(cosine * s.center_x + sine * s.center_y)
        count += 1
    return count


@inner
def place_third(row: Array, along: float, peg: int, given: HeldPart) -> None:
    """Set the separation of a candidate so that ``peg``, of the other jaw than its pair, meets the part.

    The peg touches the part where it is ``along`` mm in x from the part's place. The place of a part held by
    the moving jaw, written for separation 0, moves with that jaw. See ``seating.columns`` for the layout of
    ``row``.
    """
    if given.right[peg] == 1:
        row[SEPARATION] = row[PLACE_X] + along - given.pegs[peg, 0]
    else:
        row[SEPARATION] = given.pegs[peg, 0] - (row[PLACE_X] + along)
        row[PLACE_X] += row[SEPARATION]


@compiled
def complete_two(roots: Matrix, given: HeldPart, pocket_pieces: IntMatrix, out: Matrix) -> int:
    """Write the candidates of four contacts, two of each jaw, at roots of APART (R, 6) to ``out``; return
    their number.

    APART is 0 where the pairs of both jaws hold the part at one height. Roots at which a contact is off its
    piece are left out. See ``seating.three_contacts`` for the layout of ``roots``. Symbols are those of
    ``seating.two_contact_curves``.
    """
    count = 0
    for r in range(roots.shape[0]):
        psi = roots[r, ROOT_PSI]
        one, two = given.pairs[int(roots[r, ROOT_PAIR])], given.pairs[int(roots[r, ROOT_PIECE])]
        s, t = compute_pair_state(one, given, psi), compute_pair_state(two, given, psi)
        if not (is_on_its_pieces(one, given, psi, s.x, s.y) and is_on_its_pieces(two, given, psi, t.x, t.y)):
            continue
        cosine, sine = cos(psi), sin(psi)
        p, q = int(one[FIRST_PEG]), int(two[FIRST_PEG])
        x = given.pegs[p, 0] - (cosine * s.x + sine * s.y)
        y = given.pegs[p, 1] - (cosine * s.y - sine * s.x)
        row = out[count]
        write_pose(row, -psi, x, y, 4)
        row[SEPARATION] = x - (given.pegs[q, 0] - (cosine * t.x + sine * t.y))
        write_pair(row, 0, one, given, pocket_pieces)
        write_pair(row, 2, two, given, pocket_pieces)
        row[DOUBT] = roots[r, ROOT_DOUBT]
        count += 1
    return count


@inner
def add_fourths(fixed: Array, jaw: int, given: HeldPart, out: Array, count: int) -> int:
    """Append candidates with four contacts: the three of ``fixed``, and that of a peg of the other jaw with a
    piece.

    Every peg of the other jaw, at its height, is tried with every piece that it can touch. See
    ``seating.columns`` for the layout of ``fixed``.

    Parameters
    ----------
    fixed : (24,) candidate with three contacts that fix the part to a jaw; its place is that at separation 0.
    jaw : 0 for the left jaw, 1 for the right one.
    count : number of candidates in ``out`` so far.

    Returns
    -------
    New number of candidates, -1 when there is no room
    """
    theta = fixed[THETA]
    cosine, sine = cos(theta), sin(theta)
    for k in range(given.pegs.shape[0]):
        if given.right[k] == jaw:
            continue
        level = given.pegs[k, 1] - fixed[PLACE_Y]
        for number in range(given.parts[given.right[k], 0], given.parts[given.right[k], 1]):
            piece = given.rows[number]
            # The turned piece, level with the peg.
            cx, up = cosine * piece[X] - sine * piece[Y], level - (sine * piece[X] + cosine * piece[Y])
            for side in range(1 if piece[IS_ARC] == 0.0 else 2):
                if piece[IS_ARC] == 0.0:
                    ax = cosine * piece[AXIS_X] - sine * piece[AXIS_Y]
                    ay = sine * piece[AXIS_X] + cosine * piece[AXIS_Y]
                    if abs(ay) < 1e-12 or abs(up) > (piece[HALF_EXTENT] + END) * abs(ay):
                        continue
                    along = cx + up / ay * ax
                else:
                    if abs(up) > piece[RADIUS]:
                        continue
                    along = cx + (1.0 - 2.0 * side) * sqrt((piece[RADIUS] - up) * (piece[RADIUS] + up))
                    if not is_on_piece(
                        piece, cosine * along + sine * level, cosine * level - sine * along, END
                    ):
                        continue
                if count >= out.shape[0]:
                    return -1
                row = out[count]
                for j in range(CANDIDATE_LENGTH):
                    row[j] = fixed[j]
                row[CONTACTS], row[PEG + 3], row[PIECE + 3] = 4.0, k, number
                place_third(row, along, k, given)
                count += 1
    return count


@compiled
def complete_third(roots: Matrix, given: HeldPart, pocket_pieces: IntMatrix, out: Matrix) -> int:
    """Write the candidates of three contacts of one jaw at roots of GAP (R, 6) to ``out``; return their
    number.

    GAP is 0 where a third peg of the same jaw touches a piece. The part's place is that at separation 0.
    Roots at which a contact is off its piece are left out. See ``seating.three_contacts`` for the layout of
    ``roots``. Symbols are those of ``seating.two_contact_curves``.
    """
    count = 0
    for r in range(roots.shape[0]):
        root = roots[r]
        pair, psi = given.pairs[int(root[ROOT_PAIR])], root[ROOT_PSI]
        third, piece, tail = int(root[ROOT_PEG]), given.rows[int(root[ROOT_PIECE])], int(pair[FIRST_PEG])
        s = compute_pair_state(pair, given, psi)
        cosine, sine = cos(psi), sin(psi)
        ox, oy = given.pegs[third, 0] - given.pegs[tail, 0], given.pegs[third, 1] - given.pegs[tail, 1]
        if not (
            is_on_its_pieces(pair, given, psi, s.x, s.y)
            and is_on_piece(piece, s.x + cosine * ox - sine * oy, s.y + sine * ox + cosine * oy, END)
        ):
            continue
        x = given.pegs[tail, 0] - (cosine * s.x + sine * s.y)
        y = given.pegs[tail, 1] - (cosine * s.y - sine * s.x)
        row = out[count]
        write_pose(row, -psi, x, y, 3)
        write_pair(row, 0, pair, given, pocket_pieces)
        row[PEG + 2], row[PIECE + 2], row[DOUBT] = third, root[ROOT_PIECE], root[ROOT_DOUBT]
        count += 1
    return count


@compiled
def write_fourths(fixed: Matrix, jaw: int, given: HeldPart, out: Matrix) -> int:
    """Write the candidates of :func:`add_fourths` for each candidate in ``fixed`` (N, 24) to ``out``.

    Return their number, -1 when there is no room. See ``seating.columns`` for the layout of ``fixed``.
    """
    count = 0
    for n in range(fixed.shape[0]):
        count = add_fourths(fixed[n], jaw, given, out, count)
        if count < 0:
            return -1
    return count


@compiled
def write_forces_and_clearance(
    candidates: Matrix, given: HeldPart, size: float, balance: Matrix, normal: Matrix
) -> None:
    """Write the columns FORCE, RESIDUAL and CLEAR of candidates (N, 24) in place.

    They are the forces of the contacts per unit of jaw force, how far these are from a balance, and the least
    clearance in mm of the pegs that do not touch. RESIDUAL is inf, and CLEAR is not written, where pegs are
    off their pieces or forces are not determined. Forces, moments over ``size`` in mm and the jaw give four
    equations; they are met by least squares. See ``seating.columns`` for the layout of ``candidates``.

    Parameters
    ----------
    balance, normal : (4, 4) and (4, 5) work space.
    """
    for number in range(candidates.shape[0]):
        row = candidates[number]
        n = int(row[CONTACTS])
        cosine, sine = cos(row[THETA]), sin(row[THETA])
        misfit = 0.0
        for i in range(n):
            peg, piece = int(row[PEG + i]), given.rows[int(row[PIECE + i])]
            qx = given.pegs[peg, 0] + given.right[peg] * row[SEPARATION] - row[PLACE_X]
            qy = given.pegs[peg, 1] - row[PLACE_Y]
            x, y = cosine * qx + sine * qy, cosine * qy - sine * qx
            misfit = max(misfit, abs(measure_distance_to_piece(piece, x, y)))
            nx, ny = compute_normal(piece, x, y)
            vx, vy = cosine * nx - sine * ny, sine * nx + cosine * ny
            balance[i, 0], balance[i, 1], balance[i, 2] = vx, vy, (qx * vy - qy * vx) / size
            balance[i, 3] = vx if given.right[peg] == 1 else 0.0
        row[RESIDUAL] = inf
        # Beyond a tangency there is no chord, whatever the formulas say.
        if misfit > MISFIT or not eliminate_normal_equations(balance, normal, n):
            continue
        for i in range(n):
            row[FORCE + i] = normal[i, n] / normal[i, i]
        residual = 0.0
        for e in range(4):
            total = -1.0 if e == 3 else 0.0
            for i in range(n):
                total += balance[i, e] * row[FORCE + i]
            residual = max(residual, abs(total))
        row[RESIDUAL] = residual
        row[CLEAR] = inf
        for peg in range(given.pegs.shape[0]):
            touching = False
            for i in range(n):
                touching = touching or int(row[PEG + i]) == peg
            if not touching:
                qx = given.pegs[peg, 0] + given.right[peg] * row[SEPARATION] - row[PLACE_X]
                qy = given.pegs[peg, 1] - row[PLACE_Y]
                first, end = given.parts[given.right[peg], 0], given.parts[given.right[peg], 1]
                x, y = cosine * qx + sine * qy, cosine * qy - sine * qx
                row[CLEAR] = min(row[CLEAR], measure_clearance(x, y, given.rows, first, end))


@compiled
def judge_balance(candidates: Matrix, slack: float, slack_in_doubt: float, verdicts: ByteVector) -> None:
    """Write a verdict for each candidate (N, 24): NO_BALANCE, IN_BALANCE or DOUBTFUL.

    In balance, all contacts press, forces balance, and no other peg is in the part. Candidates whose column
    DOUBT is 1 can only be DOUBTFUL or NO_BALANCE. See ``seating.columns`` for the layout of ``candidates``.

    Parameters
    ----------
    slack, slack_in_doubt : depth in mm to which pegs that do not touch may be in the part; the second for
        candidates whose column DOUBT is 1.
    verdicts : (N,) receives the verdicts.
    """
    for number in range(candidates.shape[0]):
        row = candidates[number]
        pressed, verdicts[number] = True, NO_BALANCE
        for k in range(int(row[CONTACTS])):
            pressed = pressed and row[FORCE + k] > LEAST_FORCE
        if pressed and row[DOUBT] == 0.0 and row[RESIDUAL] < BALANCED and row[CLEAR] > -slack:
            verdicts[number] = IN_BALANCE
        elif (
            pressed
            and row[DOUBT] != 0.0
            and row[RESIDUAL] < BALANCED_IN_DOUBT
            and row[CLEAR] > -slack_in_doubt
        ):
            verdicts[number] = DOUBTFUL


@inner
def eliminate_normal_equations(balance: Array, normal: Array, n: int) -> bool:
    """Write the normal equations of n forces, eliminated to diagonal form, to ``normal`` (4, 5).

    ``balance`` (n, 4) has a row for each contact. Force i is then normal[i, n] / normal[i, i]. Return False
    where the forces are not determined.
    """
    for i in range(n):
        for j in range(n):
            normal[i, j] = 0.0
            for e in range(4):
                normal[i, j] += balance[i, e] * balance[j, e]
        normal[i, n] = balance[i, 3]
    for i in range(n):
        best = i
        for j in range(i + 1, n):
            if abs(normal[j, i]) > abs(normal[best, i]):
                best = j
        if abs(normal[best, i]) < SINGULAR:
            return False
        if best != i:
            for e in range(n + 1):
                normal[i, e], normal[best, e] = normal[best, e], normal[i, e]
        for j in range(n):
            if j != i:
                factor = normal[j, i] / normal[i, i]
                for e in range(i, n + 1):
                    normal[j, e] -= factor * normal[i, e]
    return True
