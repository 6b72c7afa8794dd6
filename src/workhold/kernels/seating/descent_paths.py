"""Descent paths of a part as jaws close: their starts, how far other pegs leave them free, and where they
end.

A pass between two places is found from the ends of its two descent paths.
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
from workhold.kernels.seating.gathering import find_first_manifold, is_in_manifold

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
    """Write the configurations in which the two descent paths from each pass (N, 24) begin, on both sides of
    the pass along its free motion.

    A path begins nearer to the pass where its free motion bends so much that the usual start would lie off
    it. See ``seating.columns`` for the layout of ``rows``.

    Parameters
    ----------
    size : of the part in mm; a turn times this is compared with shifts.
    starts : (2 N, 4) receives configurations; those of pass n are rows 2 n and 2 n + 1.
    lengths : (2 N, 2) receives the lengths of their first steps in mm, half their distance from the pass.
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
def compute_shifted_place(node: Array, shift: Array, peg: int, obstacles: Obstacles) -> tuple[float, float]:
    """Return the place (x, y) in mm of a peg's centre on the part, with ``shift`` added to the configuration
    of a node.

    Only x, y and the separation are shifted, not the orientation. See ``seating.columns`` for the layout of
    ``node``.
    """
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
    """Return whether a peg is outside the part at intermediate points
    of a step longer than ``most`` mm on the part.

    A shorter step is not examined: the result is True. The step's ends are never examined here.
    """
    dx, dy = to_x - from_x, to_y - from_y
    if dx * dx + dy * dy > most * most:
        for part in range(1, PARTS):
            if not is_peg_free(from_x + part / PARTS * dx, from_y + part / PARTS * dy, peg, obstacles, known):
                return False
    return True


@inner
def find_last_near(nodes: Array, at: int, end: int, x: float, y: float, peg: int, known: Array) -> int:
    """Return the last node, from ``at`` on, up to which a peg certainly stays in the disc ``known[peg]``
    where it is free.

    (x, y) is the peg's place on the part at node ``at``. Between nodes a place moves by no more than the part
    turns, times the place's distance from the part's centre, plus the part's shift. See ``seating.columns``
    for the layout of ``nodes``.
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
def find_end_of_free(
    nodes: Array,
    first: int,
    end: int,
    shift: Array,
    peg: int,
    most: float,
    obstacles: Obstacles,
    known: Array,
) -> int:
    """Return the first node in [first, end) that a peg hinders; ``end`` where there is none.

    The peg is in the part at that node or on the step to it. See ``seating.columns`` for the layout of
    ``nodes``.
    """
    at, from_x, from_y = first, 0.0, 0.0
    while at < end:
        x, y = compute_shifted_place(nodes[at], shift, peg, obstacles)
        if at > first and not is_step_free(from_x, from_y, x, y, peg, most, obstacles, known):
            return at
        if not is_peg_free(x, y, peg, obstacles, known):
            return at
        last = find_last_near(nodes, at, end, x, y, peg, known)
        from_x, from_y = (x, y) if last == at else compute_shifted_place(nodes[last], shift, peg, obstacles)
        at = last + 1
    return end


@compiled
def write_last_free_nodes(
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
    """Write, for each of N paths, the last node up to which no peg outside the path's subset of pegs is in
    the part.

    See ``seating.columns`` for the layout of ``nodes``.

    Parameters
    ----------
    chosen, whose : (N,) numbers of paths, and of the subset of pegs that each is tested for.
    nodes, begins : of all paths, see ``closing.close_jaws``.
    shifts : (G, 4) to be added to the configurations of each subset.
    others : (G, K) 1 for the pegs that are not in each subset.
    most : steps of a peg on the part up to this length, in mm, are examined only at their ends.
    known : (4, 4) work space.
    lasts : (N,) receives the nodes; where even the path's first node is not free, the number before it.
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
                end = find_end_of_free(nodes, first, end, shifts[subset], peg, most, obstacles, known)
        lasts[n] = end - 1


@compiled
def write_known_path_ends(
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
    """Write how far the two descent paths from each pass are known from other paths, and which remain to be
    followed.

    See ``seating.columns`` for the layout of ``nodes``.

    Parameters
    ----------
    passes : (N,) numbers of the passes.
    chosen, whose, nodes, begins, shifts, lasts : of the 2 N paths, see :func:`write_last_free_nodes`, which
        wrote the last of these.
    how : how each of all paths ended, see ``closing``.
    ends, lengths : (2 P, 4) configurations and (2 P, 2) lengths of the next steps of the paths of all passes;
        updated for paths of which a part is known.
    left : (2 P,) set to 0 for paths that are known to their end.
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
def measure_distance(config: Array, other: Array, size: float) -> float:
    """Return the distance in mm between two configurations: of
    (x, y), plus the turn (mod 2 pi) times ``size``.

    Separations are not compared. A configuration is theta in radians, x, y and the jaw separation S in mm.
    """
    turn = abs((config[0] - other[0] + pi) % (2.0 * pi) - pi)
    return turn * size + hypot(config[1] - other[1], config[2] - other[2])


@inner
def find_seat(config: Array, seats: Array, size: float) -> int:
    """Return the index of the nearest seat within ``AT_SEAT`` mm and ``SAME_LEVEL`` mm of separation, or -1
    for none.

    ``seats`` (M, 4) are configurations in ascending order of S. A configuration is theta in radians, x, y and
    the jaw separation S in mm.
    """
    nearest, number, low, high = AT_SEAT, -1, 0, seats.shape[0]
    while low < high:
        middle = (low + high) // 2
        if seats[middle, 3] < config[3] - SAME_LEVEL:
            low = middle + 1
        else:
            high = middle
    while low < seats.shape[0] and seats[low, 3] < config[3] + SAME_LEVEL:
        away = measure_distance(config, seats[low], size)
        if away < nearest:
            nearest, number = away, low
        low += 1
    return number


@inner
def find_falling_manifold(
    config: Array, how: int, manifolds: Manifolds, falling: IntArray, size: float
) -> int:
    """Return the position in ``falling`` of the manifold on which a path ended, or -1.

    ``falling`` are the numbers of the manifolds off which the part slides. On their flat faces no step leads
    down, so a path ends there, though the part goes on down. A configuration is theta in radians, x, y and
    the jaw separation S in mm.
    """
    if how == AT_REST:
        for k in range(falling.shape[0]):
            is_above = config[3] >= manifolds.rows[falling[k], SEPARATION] - FALLS
            if is_above and is_in_manifold(config, manifolds, falling[k], size, SAME_LEVEL):
                return k
    return -1


@inner
def find_place_of_rest(
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
    """Return the number of the place in which a path that does not lead on ended, or ``UNKNOWN``.

    ``how`` tells how the path ended, ``leaves`` is 1 where the part can be taken away. Other parameters are
    those of :func:`write_places`. A configuration is theta in radians, x, y and the jaw separation S in mm.
    """
    if how == AT_THE_STOP:
        return OUTSIDE if leaves != 0 else STOP
    if how != AT_REST:
        return UNKNOWN
    seat = find_seat(config, seats, size)
    if seat >= 0:
        return numbers[seat]
    loose = find_first_manifold(config, manifolds, lying, size, SAME_LEVEL)
    return first - lying.shape[0] + loose if loose >= 0 else UNKNOWN


@inner
def find_doubtful(config: Array, doubtful: Array, count: int, size: float) -> int:
    """Return the index of a doubtful configuration near ``config`` among the first ``count``, or ``count`` if
    none is near.

    The nearest one is chosen. A configuration is theta in radians, x, y and the jaw separation S in mm.
    """
    nearest, number = inf, count
    for k in range(count):
        away = measure_distance(doubtful[k], config, size)
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
    """Write the place in which each descent path ends to ``out``; return the new number of doubtful
    configurations.

    A place is a number, OUTSIDE or STOP. An end that is in no known place becomes a new place, whose
    configuration is added to ``doubtful``. A configuration is theta in radians, x, y and the jaw separation S
    in mm.

    Parameters
    ----------
    ends, how, leaves : (N + G, 4) and (N + G,): where paths end, how (see ``closing``), and 1 where a part
        can be taken away. The last G are one path from each falling manifold.
    manifolds : equilibrium manifolds.
    lying : (L,) numbers of manifolds from which no path leads on; their places are the last L before
        ``first``.
    falling : (G,) numbers of the other manifolds.
    seats, numbers : (M, 4) configurations of seats, in ascending order of S, and their places.
    first : the place of the first doubtful configuration.
    size : of the part in mm; a turn times this is compared with shifts.
    doubtful, count : (K, 4) configurations that are not known to be equilibria; ``count`` of them are given,
        and there must be room for N + G more.
    fallen : (G,) work space.
    out : (N,) receives the places.
    """
    ways = out.shape[0]
    for k in range(falling.shape[0]):
        fallen[k] = UNKNOWN
    for n in range(ways):
        # From set to set, each lower than the one before, to what is known or leads no further.
        last, fall = n, find_falling_manifold(ends[n], how[n], manifolds, falling, size)
        while fall >= 0 and fallen[fall] == UNKNOWN:
            last = ways + fall
            fall = find_falling_manifold(ends[last], how[last], manifolds, falling, size)
        if fall >= 0:
            place = fallen[fall]
        else:
            place = find_place_of_rest(
                ends[last], how[last], leaves[last], manifolds, lying, seats, numbers, first, size
            )
            if place == UNKNOWN:
                number = find_doubtful(ends[last], doubtful, count, size)
                if number == count:
                    for j in range(4):
                        doubtful[count, j] = ends[last, j]
                    count += 1
                place = first + number
        out[n], at = place, n
        while at != last:
            fall = find_falling_manifold(ends[at], how[at], manifolds, falling, size)
            fallen[fall], at = place, ways + fall
    return count


@compiled
def find_pass_to_outside(joins: IntMatrix, place: int, groups: IntVector) -> int:
    """Return the index of the first join with which a place becomes connected to OUTSIDE, or -1.

    Parameters
    ----------
    joins : (J, 2) the two places that each pass joins, in order of separation.
    place : a number, or -2 for STOP.
    groups : (P + 2,) work space for all places, of which the last two are the negative ones.
    """
    for k in range(groups.shape[0]):
        groups[k] = k
    for n in range(joins.shape[0]):
        one, two = find_root(joins[n, 0], groups), find_root(joins[n, 1], groups)
        groups[one] = two
        if find_root(place, groups) == find_root(OUTSIDE, groups):
            return n
    return -1


@inner
def find_root(place: int, groups: IntArray) -> int:
    """Return the representative of the group of places that a place was joined with.

    A negative place counts from the end of ``groups``.
    """
    at = place if place >= 0 else groups.shape[0] + place
    while groups[at] != at:
        at = groups[at]
    return at
