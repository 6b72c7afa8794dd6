"""Where pegs and a wall leave a part free along a way that it can go, and candidates that are one."""

from __future__ import annotations

from math import hypot, inf, pi

import numpy as np
from numpy.typing import NDArray

from workhold.conventions import END_SLACK
from workhold.kernels.base.compiling import compiled, inner
from workhold.kernels.seating.columns import (
    CONTACTS,
    PEG,
    PIECE,
    PLACE_X,
    PLACE_Y,
    SEPARATION,
    THETA,
    Families,
    Obstacles,
    Ways,
)
from workhold.kernels.seating.pieces import nearest_piece, on_piece, place_on_part
from workhold.kernels.seating.roots import gap
from workhold.kernels.seating.walls import SUPPORTS, beside_wall, off_wall

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

# mm. Pegs this near touch, and may be in the part by as much.
TOUCHES = 1e-7
# mm. By this much more than a peg moved it was clear, or in the part, where it surely still is.
SURELY = 1e-6
# How often, and into how many parts, a step is cut to find where freedom ends.
EDGE_ROUNDS, EDGE_PARTS = 5, 32


@inner
def off_peg(config: Array, peg: int, piece: int, around: Obstacles, seen: Array) -> float:
    """Clearance of a peg in mm in a configuration (4,); -inf where it is not on a piece that it has to touch (-1: none).

    Where none, as far as ``seen`` (4,) tells, a place on the part, its clearance and the nearest piece there: no nearer than
    that, and on its side.
    """
    x, y = place_on_part(config, around, peg)
    if piece >= 0 and not on_piece(around.rows[piece], x, y, END_SLACK):
        return -inf
    rest = abs(seen[2]) - hypot(x - seen[0], y - seen[1])
    if piece < 0 and rest > SURELY:
        return rest if seen[2] > 0.0 else -rest
    first, end = around.parts[around.right[peg], 0], around.parts[around.right[peg], 1]
    off, nearest = nearest_piece(x, y, around.rows, first, end, int(seen[3]))
    seen[0], seen[1], seen[2], seen[3] = x, y, off, nearest
    return off


@inner
def write_clearances(config: Array, touched: IntArray, known: int, around: Obstacles, seen: Array, out: Array) -> bool:
    """Write the clearances of all pegs from a number on, and last of a wall, in a configuration; whether all leave the part
    free and those that have to touch pieces (K,) do. Where one does not, what follows it is not written."""
    pegs = around.pegs.shape[0]
    # What stays on its piece seldom hinders.
    for late in range(2):
        for peg in range(pegs):
            if (touched[peg] >= 0) == (late == 1) and not known >> peg & 1:
                out[peg] = off_peg(config, peg, touched[peg], around, seen[peg])
                if out[peg] <= -TOUCHES:
                    return False
    if around.hull.shape[0] > 0:
        out[pegs] = off_wall(config, around, SUPPORTS)
        return bool(out[pegs] > -TOUCHES)
    return True


@inner
def nothing_seen(seen: Array) -> None:
    """Begin anew with what is seen of pegs (K, 4)."""
    for k in range(seen.shape[0]):
        seen[k, 0], seen[k, 1], seen[k, 2], seen[k, 3] = 0.0, 0.0, 0.0, 0.0


@compiled
def keep_free(ways: Ways, around: Obstacles, seen: Array) -> int:
    """Write the clearances of all pegs along ways, or less where they are large; move those along which a part is free
    somewhere to the front, and return how many they are.

    Parameters
    ----------
    seen : (P, 4) work space, of so many pegs.
    """
    count, begin, at = 0, 0, 0
    for w in range(ways.counts.shape[0]):
        nothing_seen(seen)
        length, good = ways.counts[w], 0
        for n in range(begin, begin + length):
            if write_clearances(ways.configs[n], ways.pieces[w], 0, around, seen, ways.clear[n]):
                good += 1
            else:
                ways.clear[n, 0] = -inf
        if good > 0:
            for n in range(length):
                for j in range(4):
                    ways.configs[at + n, j], ways.clear[at + n, j] = (
                        ways.configs[begin + n, j],
                        ways.clear[begin + n, j],
                    )
            for j in range(4):
                ways.pegs[count, j], ways.pieces[count, j] = ways.pegs[w, j], ways.pieces[w, j]
            ways.across[count, 0], ways.across[count, 1] = ways.across[w, 0], ways.across[w, 1]
            ways.counts[count], ways.closed[count] = length, ways.closed[w]
            count, at = count + 1, at + length
        begin += length
    return count


@inner
def last_free(ends: Array, touched: IntArray, around: Obstacles, trial: Array, seen: Array, clear: Array) -> None:
    """Move the first of two configurations (2, 4), which is free, along the straight way to the second, which is not, to the
    last free one.

    Parameters
    ----------
    trial, seen, clear : (4,), (K, 4) and (K,) work space.
    """
    nothing_seen(seen)
    for attempt in range(EDGE_ROUNDS):
        last, end = 0, EDGE_PARTS
        while last + 1 < end:
            # From the first where all of a step is looked at, in the middle where freedom surely ends but once.
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
def touching(clear: Array) -> int:
    """How many of some clearances (K,) are none."""
    count = 0
    for k in range(clear.shape[0]):
        count += abs(clear[k]) < TOUCHES
    return count


@inner
def middle_of(clear: Array, begin: int, length: int, first: int, count: int) -> int:
    """The middle of those configurations of a run at which the most pegs touch.

    Parameters
    ----------
    clear : (M, K) clearances along all ways.
    begin, length : of the way.
    first, count : of the run; it goes on from the last configuration to the first.
    """
    most, number = 0, 0
    for i in range(count):
        touches = touching(clear[begin + (first - begin + i) % length])
        if touches > most or number == 0:
            most, number = touches, 0
        number += touches == most
    seen = 0
    for i in range(count):
        at = begin + (first - begin + i) % length
        if touching(clear[at]) == most:
            if seen == number // 2:
                return at
            seen += 1
    return first


@inner
def touched_piece(config: Array, peg: int, around: Obstacles) -> int:
    """Number of the piece that a peg, or after them the wall, touches in a configuration (4,)."""
    if peg == around.pegs.shape[0]:
        return around.rows.shape[0] + beside_wall(config, around, SUPPORTS)[1]
    x, y = place_on_part(config, around, peg)
    side = around.right[peg]
    nearest, best = around.parts[side, 0], inf
    for k in range(around.parts[side, 0], around.parts[side, 1]):
        away = abs(gap(around.rows[k], x, y))
        if away < best and on_piece(around.rows[k], x, y, END_SLACK):
            nearest, best = k, away
    return nearest


@inner
def write_touching(config: Array, clear: Array, touched: IntArray, around: Obstacles, row: Array) -> None:
    """Write a configuration as a candidate (24,), with the pegs, and last a wall, whose clearances (K,) are none, and the
    pieces that they have to touch (P,), or that are nearest."""
    for j in range(row.shape[0]):
        row[j] = config[j] if j < CONTACTS else 0.0
    for j in range(4):
        row[PEG + j] = row[PIECE + j] = -1.0
    count = 0
    for peg in range(clear.shape[0]):
        if abs(clear[peg]) < TOUCHES:
            known = touched[peg] if peg < touched.shape[0] else -1
            row[PEG + count], row[PIECE + count] = peg, known if known >= 0 else touched_piece(config, peg, around)
            count += 1
    row[CONTACTS] = count


@inner
def write_edge(
    configs: Array,
    inside: int,
    outside: int,
    begin: int,
    end: int,
    touched: IntArray,
    around: Obstacles,
    work: Array,
    seen: Array,
    clear: Array,
    out: Array,
) -> None:
    """Write the last free configuration (4,) from one that is free on to the next of the same way, if there is one."""
    for j in range(4):
        work[0, j] = configs[inside, j]
    if begin <= outside < end:
        for j in range(4):
            work[1, j] = configs[outside, j]
        last_free(work, touched, around, work[2], seen, clear)
    for j in range(4):
        out[j] = work[0, j]


@inner
def write_clear(
    ways: Ways, w: int, begin: int, touched: IntArray, around: Obstacles, seen: Array, clear: Array
) -> tuple[int, int]:
    """Write the clearances (M, K) of all pegs along a way, -inf first where the part is not free, and the pieces (P,) that
    they have to touch; how many configurations are free, and the first that is not, -1 where none is."""
    bits, bad, good = 0, -1, 0
    for peg in range(touched.shape[0]):
        touched[peg] = -1
    for j in range(4):
        peg = ways.pegs[w, j]
        if peg >= 0:
            bits |= 1 << peg
            if peg < touched.shape[0]:
                touched[peg] = ways.pieces[w, j]
    nothing_seen(seen)
    for n in range(begin, begin + ways.counts[w]):
        free = ways.clear[n, 0] != -inf
        if free:
            for j in range(4):
                if ways.pegs[w, j] >= 0:
                    clear[n, ways.pegs[w, j]] = ways.clear[n, j]
            free = write_clearances(ways.configs[n], touched, bits, around, seen, clear[n])
        if free:
            good += 1
        else:
            clear[n, 0] = -inf
            bad = n if bad < 0 else bad
    return (good, bad)


@inner
def write_along(
    ways: Ways,
    w: int,
    begin: int,
    first: int,
    count: int,
    touched: IntArray,
    around: Obstacles,
    work: Array,
    seen: Array,
    out: Families,
    number: int,
) -> None:
    """Write the configurations along a run of a way, and those of its ends."""
    at, length = out.begins[number], ways.counts[w]
    end, is_closed = begin + length, ways.closed[w] != 0
    if not is_closed:
        write_edge(ways.configs, first, first - 1, begin, end, touched, around, work, seen, work[3], out.configs[at])
        at += 1
    for i in range(count):
        for j in range(4):
            out.configs[at, j] = ways.configs[begin + (first - begin + i) % length, j]
        at += 1
    if not is_closed:
        last = first + count - 1
        write_edge(ways.configs, last, last + 1, begin, end, touched, around, work, seen, work[3], out.configs[at])
        at += 1
    out.begins[number + 1], out.closed[number] = at, 1 if is_closed and count == length else 0


@compiled
def free_runs(
    ways: Ways,
    low: float,
    high: float,
    around: Obstacles,
    clear: Array,
    seen: Array,
    touched: IntArray,
    work: Array,
    out: Families,
) -> int:
    """Write the runs of ways in which a part is free, and return how many there are.

    Parameters
    ----------
    low, high : in mm, between which the separations of ways are that count.
    clear, seen, touched, work : (M, K), (P, 4), (P,) and (4, 4) work space, of so many pegs and, last, a wall.
    out : with room for all, written here.
    """
    count, begin = 0, 0
    for w in range(ways.counts.shape[0]):
        size = ways.counts[w]
        if low < ways.configs[begin, 3] < high:
            good, bad = write_clear(ways, w, begin, touched, around, seen, clear)
            start, length = begin, 0
            # Of what is closed the last and the first are neighbours.
            shift = bad - begin if ways.closed[w] != 0 and bad >= 0 else 0
            for i in range(size + 1 if good > 0 else 0):
                n = begin + (i + shift) % size
                if i < size and clear[n, 0] != -inf:
                    start = n if length == 0 else start
                    length += 1
                elif length > 0:
                    middle = middle_of(clear, begin, size, start, length)
                    write_touching(ways.configs[middle], clear[middle], touched, around, out.rows[count])
                    write_along(ways, w, begin, start, length, touched, around, work, seen, out, count)
                    out.across[count, 0], out.across[count, 1] = ways.across[w, 0], ways.across[w, 1]
                    count, length = count + 1, 0
        begin += size
    return count


@compiled
def first_of_each(rows: Array, turn: float, shift: float, kept: IntArray) -> int:
    """Write the numbers of candidates (N, 24) that are none of those before them; how many they are.

    Parameters
    ----------
    turn, shift : radians and mm by which configurations that are one differ less.
    """
    count = 0
    for n in range(rows.shape[0]):
        row, is_new = rows[n], True
        for k in range(count):
            other = rows[kept[k]]
            if (
                abs(other[SEPARATION] - row[SEPARATION]) < shift
                and abs(other[PLACE_X] - row[PLACE_X]) < shift
                and abs(other[PLACE_Y] - row[PLACE_Y]) < shift
                and abs((other[THETA] - row[THETA] + pi) % (2.0 * pi) - pi) < turn
                and other[CONTACTS] == row[CONTACTS]
            ):
                is_new = False
                break
        if is_new:
            kept[count] = n
            count += 1
    return count
