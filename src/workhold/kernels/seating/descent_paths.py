"""Descent paths: where they begin, how far they are free of further pegs, and the places they end in.

The pass at which one place leads to another follows from where both paths of each pass end.
"""

from __future__ import annotations

from math import hypot, inf, pi, sqrt

from workhold.kernels.base.compiling import (
    Array,
    ByteMatrix,
    ByteVector,
    IntArray,
    IntMatrix,
    IntVector,
    Matrix,
    compiled,
    inner,
)
from workhold.kernels.seating.antipodal_step import is_peg_free
from workhold.kernels.seating.closing import AT_REST, AT_THE_STOP
from workhold.kernels.seating.columns import (
    COSINE,
    MOTION,
    MOVED,
    SECOND,
    SEPARATION,
    SINE,
    STEP,
    STEP_ALONG,
    TURNED,
    Manifolds,
    Obstacles,
)
from workhold.kernels.seating.gathering import first_of, lies_in

# mm. How far from a pass a descent path begins, and how near it begins at least; and by which part of its
# length the motion may have bent there.
BESIDE = 0.01
SHORTEST, MOST_BEND = 1e-5, 0.1
# mm. A path that ends less above the stop may end at it.
ABOVE = 1e-6
# Parts of a step that is longer than most, at whose ends it is looked at.
PARTS = 3


@compiled
def begin_descents(rows: Matrix, size: float, starts: Matrix, lengths: Matrix) -> None:
    """Writes where descent paths begin, to both sides of passes (N, 24) along their free motions.

    They begin nearer where the motion bends so much that they would lie elsewhere.

    Parameters
    ----------
    size : of the part in mm, by which turns are counted.
    starts : (2 N, 4) configurations, written here.
    lengths : (2 N, 2) how long their first steps are in mm, half as far as they begin off the pass, written
        here.
    """
    for n in range(rows.shape[0]):
        row = rows[n]
        x, y, second = row[MOTION + 1], row[MOTION + 2], abs(row[SECOND])
        speed = abs(row[MOTION]) * size + hypot(x, y)
        bent, length = 2.0 * MOST_BEND * speed * speed, BESIDE
        if second * BESIDE > bent:
            length = max(bent / second, SHORTEST)
        for side in range(2):
            start, sign = starts[2 * n + side], 1.0 - 2.0 * side
            for k in range(3):
                start[k] = row[k] + sign * (length / speed * row[MOTION + k])
            start[3] = row[3]
            lengths[2 * n + side, 0] = lengths[2 * n + side, 1] = length / 2.0


@inner
def place_at(node: Array, shift: Array, peg: int, obstacles: Obstacles) -> tuple[float, float]:
    """Place of a peg's centre on the part at a node, which is shifted but not turned."""
    x = obstacles.pegs[peg, 0] + obstacles.right[peg] * (node[3] + shift[3]) - (node[1] + shift[1])
    y = obstacles.pegs[peg, 1] - (node[2] + shift[2])
    return (node[COSINE] * x + node[SINE] * y, node[COSINE] * y - node[SINE] * x)


@inner
def is_step_free(
    from_x: float,
    from_y: float,
    to_x: float,
    to_y: float,
    peg: int,
    most: float,
    obstacles: Obstacles,
    known: Array,
) -> bool:
    """Whether a peg is not in the part on a step, at places no farther apart than most but for a few."""
    dx, dy = to_x - from_x, to_y - from_y
    if dx * dx + dy * dy > most * most:
        for part in range(1, PARTS):
            if not is_peg_free(from_x + part / PARTS * dx, from_y + part / PARTS * dy, peg, obstacles, known):
                return False
    return True


@inner
def last_near(nodes: Array, at: int, end: int, x: float, y: float, peg: int, known: Array) -> int:
    """The last node up to which a peg surely stays within the disc in which it is known to be free.

    No place on the part that is as far from its centre moves faster than the part turns and moves.
    """
    dx, dy = x - known[peg, 0], y - known[peg, 1]
    left = known[peg, 2] - sqrt(dx * dx + dy * dy)
    if left > 0.0:
        arm = sqrt(x * x + y * y) + left
        turned, moved = nodes[at, TURNED], nodes[at, MOVED]
        while at + 1 < end and (nodes[at + 1, TURNED] - turned) * arm + nodes[at + 1, MOVED] - moved < left:
            at += 1
    return at


@inner
def end_of_free(
    nodes: Array,
    first: int,
    end: int,
    shift: Array,
    peg: int,
    most: float,
    obstacles: Obstacles,
    known: Array,
) -> int:
    """The first node at which, or on the step to which, a peg is in the part.

    The end of the nodes if there is none.
    """
    at, from_x, from_y = first, 0.0, 0.0
    while at < end:
        x, y = place_at(nodes[at], shift, peg, obstacles)
        if at > first and not is_step_free(from_x, from_y, x, y, peg, most, obstacles, known):
            return at
        if not is_peg_free(x, y, peg, obstacles, known):
            return at
        last = last_near(nodes, at, end, x, y, peg, known)
        from_x, from_y = (x, y) if last == at else place_at(nodes[last], shift, peg, obstacles)
        at = last + 1
    return end


@compiled
def free_until(
    chosen: IntVector,
    whose: IntVector,
    nodes: Matrix,
    begins: IntVector,
    shifts: Matrix,
    others: ByteMatrix,
    most: float,
    obstacles: Obstacles,
    known: Matrix,
    lasts: IntVector,
) -> None:
    """Writes the last node of each path at which, and before which, none of the other pegs is in the part.

    It is the one before the first node where that is not free.

    Parameters
    ----------
    chosen, whose : (N,) numbers of paths, and of the subsets of pegs whose they are.
    nodes, begins : of all paths, as of ``closing.close_jaws``.
    shifts : (G, 4) to be added to the configurations of each subset.
    others : (G, K) 1 for the pegs that are not in each subset.
    most : how long a step of a peg on the part is that is looked at only where it ends, in mm.
    known : (4, 4) work space.
    lasts : (N,) written here.
    """
    for peg in range(obstacles.pegs.shape[0]):
        known[peg, 2], known[peg, 3] = -1.0, 0.0
    for n in range(chosen.shape[0]):
        subset, first, end = whose[n], begins[chosen[n]], begins[chosen[n] + 1]
        # On a path S only falls.
        while end > first and nodes[end - 1, 3] + shifts[subset, 3] <= obstacles.stop + ABOVE:
            end -= 1
        for peg in range(obstacles.pegs.shape[0]):
            if others[subset, peg] != 0:
                end = end_of_free(nodes, first, end, shifts[subset], peg, most, obstacles, known)
        lasts[n] = end - 1


@compiled
def take_up(
    passes: IntVector,
    chosen: IntVector,
    whose: IntVector,
    lasts: IntVector,
    nodes: Matrix,
    begins: IntVector,
    how: ByteVector,
    shifts: Matrix,
    ends: Matrix,
    lengths: Matrix,
    left: ByteVector,
) -> None:
    """Writes where paths off both sides of passes come without leaving what is known, and which are left.

    Parameters
    ----------
    passes : (N,) their numbers.
    chosen, whose, nodes, begins, shifts, lasts : of the 2 N paths, as of ``free_until``, which wrote the
        last.
    how : of all paths, how each ends.
    ends, lengths : (2 P, 4) configurations and (2 P, 2) lengths of the next steps of the paths off all
        passes.
    left : (2 P,) 0 for paths of which nothing is left to be followed.
    """
    for n in range(chosen.shape[0]):
        way, last, place = chosen[n], lasts[n], 2 * passes[n // 2] + n % 2
        if last < begins[way]:
            continue
        for k in range(4):
            ends[place, k] = nodes[last, k] + shifts[whose[n], k]
        lengths[place, 0], lengths[place, 1] = nodes[last, STEP], nodes[last, STEP_ALONG]
        if last + 1 == begins[way + 1] and how[way] == AT_REST:
            left[place] = 0


# Places that are none of the part's: all pegs left behind, and what moves at its stop.
OUTSIDE, STOP, UNKNOWN = -1, -2, -3
# mm. A descent path that ends this near to a seat, with a separation this near, ended in it.
AT_SEAT, SAME_LEVEL = 0.05, 1e-3
# mm. What ends lower than a loose set by this much fell off it; what is not settled is one as near as the
# second.
FALLS, ONE_DOUBT = 1e-6, 10.0 * AT_SEAT


@inner
def apart(config: Array, other: Array, size: float) -> float:
    """How far in mm two configurations (4,) are apart, turns counted by the size."""
    turn = abs((config[0] - other[0] + pi) % (2.0 * pi) - pi)
    return turn * size + hypot(config[1] - other[1], config[2] - other[2])


@inner
def seat_at(config: Array, seats: Array, size: float) -> int:
    """The number of the nearest seat of some (M, 4), ordered by S, in which a configuration is, or -1."""
    nearest, number, low, high = AT_SEAT, -1, 0, seats.shape[0]
    while low < high:
        middle = (low + high) // 2
        if seats[middle, 3] < config[3] - SAME_LEVEL:
            low = middle + 1
        else:
            high = middle
    while low < seats.shape[0] and seats[low, 3] < config[3] + SAME_LEVEL:
        away = apart(config, seats[low], size)
        if away < nearest:
            nearest, number = away, low
        low += 1
    return number


@inner
def fall_at(config: Array, how: int, manifolds: Manifolds, falling: IntArray, size: float) -> int:
    """The falling manifold on which a path ended, or -1.

    On flat faces no step leads down; the path goes on, lower, where the part slides off them.
    """
    if how == AT_REST:
        for k in range(falling.shape[0]):
            is_above = config[3] >= manifolds.rows[falling[k], SEPARATION] - FALLS
            if is_above and lies_in(config, manifolds, falling[k], size, SAME_LEVEL):
                return k
    return -1


@inner
def rest_at(
    config: Array,
    how: int,
    leaves: int,
    manifolds: Manifolds,
    lying: IntArray,
    seats: Array,
    numbers: IntArray,
    first: int,
    size: float,
) -> int:
    """The place of the end of a path that does not lead on, or ``UNKNOWN``.

    Arguments as of ``write_places``.
    """
    if how == AT_THE_STOP:
        return OUTSIDE if leaves != 0 else STOP
    if how != AT_REST:
        return UNKNOWN
    seat = seat_at(config, seats, size)
    if seat >= 0:
        return numbers[seat]
    loose = first_of(config, manifolds, lying, size, SAME_LEVEL)
    return first - lying.shape[0] + loose if loose >= 0 else UNKNOWN


@inner
def doubt_at(config: Array, doubtful: Array, count: int, size: float) -> int:
    """The number of the nearest of ``count`` configurations that are not settled, or ``count``."""
    nearest, number = inf, count
    for k in range(count):
        away = apart(doubtful[k], config, size)
        if away < nearest:
            nearest, number = away, k
    return number if nearest < ONE_DOUBT else count


@compiled
def write_places(
    ends: Matrix,
    how: ByteVector,
    leaves: ByteVector,
    manifolds: Manifolds,
    lying: IntVector,
    falling: IntVector,
    seats: Matrix,
    numbers: IntVector,
    first: int,
    size: float,
    doubtful: Matrix,
    count: int,
    fallen: IntVector,
    out: IntVector,
) -> int:
    """Writes the places that descent paths end in, and returns how many configurations are not settled then.

    Parameters
    ----------
    ends, how, leaves : (N + G, 4) and (N + G,) where paths end, how, and 1 where a part can be taken away.
        The last G are one path off each falling manifold.
    manifolds : equilibrium manifolds.
    lying, falling : (L,) numbers of manifolds off which no path leads, with the places before ``first``, and
        (G,) of the others.
    seats, numbers : (M, 4) configurations of seats, ordered by S, and their places.
    first : the place of the first that is not settled.
    size : of the part in mm, by which turns are counted.
    doubtful, count : configurations that are not settled, the first so many before and with room for N + G
        more.
    fallen : (G,) work space.
    out : (N,) written here.
    """
    ways = out.shape[0]
    for k in range(falling.shape[0]):
        fallen[k] = UNKNOWN
    for n in range(ways):
        # From set to set, each lower than the one before, to what is known or leads no further.
        last, fall = n, fall_at(ends[n], how[n], manifolds, falling, size)
        while fall >= 0 and fallen[fall] == UNKNOWN:
            last = ways + fall
            fall = fall_at(ends[last], how[last], manifolds, falling, size)
        if fall >= 0:
            place = fallen[fall]
        else:
            place = rest_at(
                ends[last], how[last], leaves[last], manifolds, lying, seats, numbers, first, size
            )
            if place == UNKNOWN:
                number = doubt_at(ends[last], doubtful, count, size)
                if number == count:
                    for j in range(4):
                        doubtful[count, j] = ends[last, j]
                    count += 1
                place = first + number
        out[n], at = place, n
        while at != last:
            fall = fall_at(ends[at], how[at], manifolds, falling, size)
            fallen[fall], at = place, ways + fall
    return count


@compiled
def leads_out(joins: IntMatrix, place: int, groups: IntVector) -> int:
    """The number of the first pass, by separation, from which on a place is joined with the outside, or -1.

    Parameters
    ----------
    joins : (J, 2) places that each joins.
    groups : (P + 2,) work space for all places, of which the last two are the negative ones.
    """
    for k in range(groups.shape[0]):
        groups[k] = k
    for n in range(joins.shape[0]):
        one, two = root(joins[n, 0], groups), root(joins[n, 1], groups)
        groups[one] = two
        if root(place, groups) == root(OUTSIDE, groups):
            return n
    return -1


@inner
def root(place: int, groups: IntArray) -> int:
    """The place that stands for all that are joined with a place."""
    at = place if place >= 0 else groups.shape[0] + place
    while groups[at] != at:
        at = groups[at]
    return at
