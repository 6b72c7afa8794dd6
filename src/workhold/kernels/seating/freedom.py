"""Where pegs and a wall leave a part free along a self-motion: a motion at one jaw separation that keeps some
contacts."""

from __future__ import annotations

from math import hypot, inf

from workhold.conventions import END_SLACK
from workhold.kernels.base.compiling import (
    Array,
    IntArray,
    IntVector,
    Matrix,
    compiled,
    inner,
)
from workhold.kernels.seating.columns import (
    CONTACTS,
    PEG,
    PIECE,
    Manifolds,
    Obstacles,
    SelfMotions,
)
from workhold.kernels.seating.obstacles import (
    SUPPORTS,
    compute_cosine_and_sine,
    compute_peg_place,
    compute_turned_place,
    find_nearest_piece,
    find_wall_clearance,
    is_on_piece,
    measure_wall_clearance,
)
from workhold.kernels.seating.two_contact_curves import measure_gap

# mm. Pegs this near touch, and may be in the part by as much.
TOUCHES = 1e-7
# mm. By this much more than a peg moved it was clear, or in the part, where it surely still is.
SURELY = 1e-6
# How often, and into how many parts, a step is cut to find where freedom ends.
EDGE_ROUNDS, EDGE_PARTS = 5, 32


@inner
def measure_peg_clearance(x: float, y: float, peg: int, piece: int, around: Obstacles, seen: Array) -> float:
    """Return the clearance in mm of a peg at (x, y) on the part, or a number of the same sign that is nearer
    to 0.

    Return -inf where the peg is off ``piece``, which it has to touch (-1 for none). ``seen`` (4,) caches a
    place (x, y), its clearance and the nearest piece there. A bound is returned only for a peg without a
    piece to touch, near that place; otherwise the cache is overwritten.
    """
    if piece >= 0 and not is_on_piece(around.rows[piece], x, y, END_SLACK):
        return -inf
    rest = abs(seen[2]) - hypot(x - seen[0], y - seen[1])
    if piece < 0 and rest > SURELY:
        return rest if seen[2] > 0.0 else -rest
    first, end = around.parts[around.right[peg], 0], around.parts[around.right[peg], 1]
    off, nearest = find_nearest_piece(x, y, around.rows, first, end, int(seen[3]))
    seen[0], seen[1], seen[2], seen[3] = x, y, off, nearest
    return off


@inner
def write_clearances(
    config: Array, touched: IntArray, known: int, around: Obstacles, seen: Array, out: Array
) -> bool:
    """Write the clearances in mm of the pegs that are not in ``known`` to ``out``, and last that of a wall if
    there is one.

    Return whether no peg and no wall enters the part and all pegs that have to touch pieces do. Nothing is
    written after the first clearance that breaks this. S is the jaw separation in mm.

    Parameters
    ----------
    config : (4,) theta, x, y, S.
    touched : (P,) the piece that each peg has to touch, or -1.
    known : has bit k set where the clearance of peg k is known.
    seen : (P + 1, 4), see :func:`forget_seen`.
    """
    pegs = around.pegs.shape[0]
    # Along a slide the part does not turn.
    cosine, sine = compute_cosine_and_sine(config[0], seen[pegs])
    # What stays on its piece seldom hinders.
    for late in range(2):
        for peg in range(pegs):
            if (touched[peg] >= 0) == (late == 1) and not known >> peg & 1:
                x, y = compute_turned_place(config, cosine, sine, around, peg)
                out[peg] = measure_peg_clearance(x, y, peg, touched[peg], around, seen[peg])
                if out[peg] <= -TOUCHES:
                    return False
    if around.hull.shape[0] > 0:
        out[pegs] = measure_wall_clearance(config, around, SUPPORTS)
        return bool(out[pegs] > -TOUCHES)
    return True


@inner
def forget_seen(seen: Array) -> None:
    """Reset ``seen`` (P + 1, 4): the cached clearances of P pegs and, in the last row, a cached
    orientation."""
    for k in range(seen.shape[0]):
        seen[k, 0], seen[k, 1], seen[k, 2], seen[k, 3] = 0.0, 0.0, 0.0, 0.0
    seen[seen.shape[0] - 1, 1] = 1.0


@compiled
def keep_free(motions: SelfMotions, around: Obstacles, seen: Matrix) -> int:
    """Move the self-motions that have a free configuration to the front, in place; return their number.

    The clearances of all pegs along these motions are written to ``motions.clear``; a large clearance may be
    replaced by a lower bound. The first column is -inf for a configuration that is not free.

    Parameters
    ----------
    seen : (P + 1, 4) work space, for P pegs.
    """
    count, begin, at = 0, 0, 0
    for w in range(motions.counts.shape[0]):
        forget_seen(seen)
        length, good = motions.counts[w], 0
        for n in range(begin, begin + length):
            if write_clearances(motions.configs[n], motions.pieces[w], 0, around, seen, motions.clear[n]):
                good += 1
            else:
                motions.clear[n, 0] = -inf
        if good > 0:
            for n in range(length):
                for j in range(4):
                    motions.configs[at + n, j] = motions.configs[begin + n, j]
                    motions.clear[at + n, j] = motions.clear[begin + n, j]
            for j in range(4):
                motions.pegs[count, j], motions.pieces[count, j] = motions.pegs[w, j], motions.pieces[w, j]
            motions.across[count, 0], motions.across[count, 1] = motions.across[w, 0], motions.across[w, 1]
            motions.counts[count], motions.closed[count] = length, motions.closed[w]
            count, at = count + 1, at + length
        begin += length
    return count


@inner
def move_to_last_free(ends: Array, touched: IntArray, around: Obstacles, seen: Array) -> None:
    """Move the free configuration ``ends[0]`` in place to the last
    free one on the straight line to ``ends[1]``.

    ``ends[1]``, which is not free, is moved to just beyond it.

    Parameters
    ----------
    ends : (4, 4); its last two rows are work space.
    touched : (P,) the piece that each peg has to touch, or -1.
    seen : (P + 1, 4) work space.
    """
    trial, clear = ends[2], ends[3]
    forget_seen(seen)
    for attempt in range(EDGE_ROUNDS):
        last, end = 0, EDGE_PARTS
        while last + 1 < end:
            # One after the other in the whole step, by halves where freedom surely ends but once.
            part = last + 1 if attempt == 0 else (last + end) // 2
            for k in range(4):
                trial[k] = ends[0, k] + part / EDGE_PARTS * (ends[1, k] - ends[0, k])
            if write_clearances(trial, touched, 0, around, seen, clear):
                last = part
            else:
                end = part
        for k in range(4):
            low, way = ends[0, k], ends[1, k] - ends[0, k]
            ends[0, k] = low + last / EDGE_PARTS * way
            ends[1, k] = low + (last + 1) / EDGE_PARTS * way


@inner
def count_touching(clear: Array) -> int:
    """Return how many of the clearances (K,) are less than ``TOUCHES`` mm in size."""
    count = 0
    for k in range(clear.shape[0]):
        count += abs(clear[k]) < TOUCHES
    return count


@inner
def find_middle(clear: Array, begin: int, length: int, first: int, count: int) -> int:
    """Return the number of the middle one among the configurations of a free run at which the most pegs
    touch.

    Parameters
    ----------
    clear : (M, K) clearances along all self-motions.
    begin, length : number of the first configuration, and how many there are, of the self-motion.
    first, count : of the run; it continues from the self-motion's last configuration to its first.
    """
    most, number = 0, 0
    for i in range(count):
        touches = count_touching(clear[begin + (first - begin + i) % length])
        if touches > most or number == 0:
            most, number = touches, 0
        number += touches == most
    seen = 0
    for i in range(count):
        at = begin + (first - begin + i) % length
        if count_touching(clear[at]) == most:
            if seen == number // 2:
                return at
            seen += 1
    return first


@inner
def find_touched_piece(config: Array, peg: int, around: Obstacles) -> int:
    """Return the number of the piece that a peg touches in a configuration (4,).

    The peg number after the last one stands for the wall; the result is then the number of pieces plus that
    of the row of the hull. A configuration is theta in radians, x, y and the jaw separation S in mm.
    """
    if peg == around.pegs.shape[0]:
        return around.rows.shape[0] + find_wall_clearance(config, around, SUPPORTS)[1]
    x, y = compute_peg_place(config, around, peg)
    side = around.right[peg]
    nearest, best = around.parts[side, 0], inf
    for k in range(around.parts[side, 0], around.parts[side, 1]):
        away = abs(measure_gap(around.rows[k], x, y))
        if away < best and is_on_piece(around.rows[k], x, y, END_SLACK):
            nearest, best = k, away
    return nearest


@inner
def write_touching(config: Array, clear: Array, touched: IntArray, around: Obstacles, row: Array) -> None:
    """Write a configuration as a candidate (24,) whose contacts are the pegs (and the wall) that have
    clearance 0.

    ``touched`` (P,) names the piece that each peg has to touch; where it is -1, the nearest piece is written.
    A configuration is theta in radians, x, y and the jaw separation S in mm. See ``seating.columns`` for the
    layout of ``row``.
    """
    for j in range(row.shape[0]):
        row[j] = config[j] if j < CONTACTS else 0.0
    for j in range(4):
        row[PEG + j] = row[PIECE + j] = -1.0
    count = 0
    for peg in range(clear.shape[0]):
        if abs(clear[peg]) < TOUCHES:
            known = touched[peg] if peg < touched.shape[0] else -1
            row[PEG + count] = peg
            row[PIECE + count] = known if known >= 0 else find_touched_piece(config, peg, around)
            count += 1
    row[CONTACTS] = count


@inner
def write_run_clearances(
    motions: SelfMotions, w: int, begin: int, touched: IntArray, around: Obstacles, seen: Array, clear: Array
) -> tuple[int, int]:
    """Write the clearances of all pegs and the wall along self-motion
    ``w`` to ``clear`` (M, K), known ones included.

    -inf in the first column marks a configuration that is not free. ``touched`` (P,) receives the pieces that
    the pegs have to touch, or -1. Return (number of free configurations, number of the first that is not free
    or -1).
    """
    bits, bad, good = 0, -1, 0
    for peg in range(touched.shape[0]):
        touched[peg] = -1
    for j in range(4):
        peg = motions.pegs[w, j]
        if peg >= 0:
            bits |= 1 << peg
            if peg < touched.shape[0]:
                touched[peg] = motions.pieces[w, j]
    forget_seen(seen)
    for n in range(begin, begin + motions.counts[w]):
        free = motions.clear[n, 0] != -inf
        if free:
            for j in range(4):
                if motions.pegs[w, j] >= 0:
                    clear[n, motions.pegs[w, j]] = motions.clear[n, j]
            free = write_clearances(motions.configs[n], touched, bits, around, seen, clear[n])
        if free:
            good += 1
        else:
            clear[n, 0] = -inf
            bad = n if bad < 0 else bad
    return (good, bad)


@inner
def write_free_run(
    motions: SelfMotions,
    w: int,
    begin: int,
    first: int,
    count: int,
    touched: IntArray,
    around: Obstacles,
    work: Array,
    seen: Array,
    out: Manifolds,
    number: int,
) -> None:
    """Write the configurations of a free run of a self-motion, with the exact ends of the run, as set
    ``number`` of ``out``.

    Parameters
    ----------
    w, begin : the self-motion, and the number of its first configuration.
    first, count : number of the first configuration of the run, and how many it has.
    touched : (P,) the piece that each peg has to touch, or -1.
    work, seen : (4, 4) and (P + 1, 4) work space.
    """
    at, length = out.begins[number], motions.counts[w]
    # What is closed has no ends.
    end, ends = begin + length, 1 if motions.closed[w] == 0 else 0
    for i in range(count):
        for j in range(4):
            out.configs[at + ends + i, j] = motions.configs[begin + (first - begin + i) % length, j]
    for side in range(2 * ends):
        inside, step = (first, -1) if side == 0 else (first + count - 1, 1)
        for j in range(4):
            work[0, j] = motions.configs[inside, j]
        if begin <= inside + step < end:
            for j in range(4):
                work[1, j] = motions.configs[inside + step, j]
            move_to_last_free(work, touched, around, seen)
        for j in range(4):
            out.configs[at + side * (count + 1), j] = work[0, j]
    out.begins[number + 1] = at + count + 2 * ends
    out.closed[number] = 1 if ends == 0 and count == length else 0


@compiled
def write_free_runs(
    motions: SelfMotions,
    low: float,
    high: float,
    around: Obstacles,
    clear: Matrix,
    seen: Matrix,
    touched: IntVector,
    work: Matrix,
    out: Manifolds,
) -> int:
    """Write the runs of self-motions in which a part is free to ``out``, each as a set; return their number.

    Parameters
    ----------
    low, high : in mm; only self-motions with a separation between them count.
    clear, seen, touched, work : (M, K), (P + 1, 4), (P,) and (4, 4) work space, for P pegs; K counts the
        wall, last.
    out : receives the sets, with room for all.
    """
    count, begin = 0, 0
    for w in range(motions.counts.shape[0]):
        size = motions.counts[w]
        if low < motions.configs[begin, 3] < high:
            good, bad = write_run_clearances(motions, w, begin, touched, around, seen, clear)
            start, length = begin, 0
            # Of what is closed the last and the first are neighbours.
            shift = bad - begin if motions.closed[w] != 0 and bad >= 0 else 0
            for i in range(size + 1 if good > 0 else 0):
                n = begin + (i + shift) % size
                if i < size and clear[n, 0] != -inf:
                    start = n if length == 0 else start
                    length += 1
                elif length > 0:
                    middle = find_middle(clear, begin, size, start, length)
                    write_touching(motions.configs[middle], clear[middle], touched, around, out.rows[count])
                    write_free_run(motions, w, begin, start, length, touched, around, work, seen, out, count)
                    out.across[count, 0], out.across[count, 1] = motions.across[w, 0], motions.across[w, 1]
                    count, length = count + 1, 0
        begin += size
    return count
