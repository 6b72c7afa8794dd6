"""Where pegs and a wall leave a part free along a way that it can go, and candidates that are one."""

from __future__ import annotations

from math import hypot, inf, pi

import numpy as np
from numpy.typing import NDArray

from workhold.conventions import END_SLACK
from workhold.kernels.base.compiling import compiled, inner
from workhold.kernels.seating.columns import CONTACTS, PLACE_X, PLACE_Y, SEPARATION, THETA, Obstacles
from workhold.kernels.seating.pieces import clearance, on_piece, place_on_part
from workhold.kernels.seating.walls import SUPPORTS, off_wall

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

# A run of configurations of a way, in columns: number of the way, of the first configuration among those of all ways, how
# many there are, the middle of those with the most contacts, a bit for each peg (and last a wall) that touches there, and,
# of what is not closed, the last free configurations at both ends.
RUN_WAY, RUN_FIRST, RUN_COUNT, RUN_MIDDLE, RUN_TOUCHES, RUN_START = range(6)
RUN_END, RUN_LENGTH = 9, 13
# mm. Pegs this near touch, and may be in the part by as much.
TOUCHES = 1e-7
# mm. By this much more than a peg moved it was clear, or in the part, where it surely still is.
SURELY = 1e-6
# mm. How much farther than to the next of its steps a place may be from a way on which it lies.
BESIDE = 0.02
# How often, and into how many parts, a step is cut to find where freedom ends.
EDGE_ROUNDS, EDGE_PARTS = 5, 32


@inner
def off_peg(config: Array, peg: int, piece: int, around: Obstacles, seen: Array) -> float:
    """Clearance of a peg in mm in a configuration (4,); -inf where it is not on a piece that it has to touch (-1: none).

    Where none, as far as ``seen`` (3,), a place on the part and its clearance, tells: no nearer than that, and on its side.
    """
    x, y = place_on_part(config, around, peg)
    if piece >= 0 and not on_piece(around.rows[piece], x, y, END_SLACK):
        return -inf
    rest = abs(seen[2]) - hypot(x - seen[0], y - seen[1])
    if piece < 0 and rest > SURELY:
        return rest if seen[2] > 0.0 else -rest
    side = around.right[peg]
    seen[0], seen[1] = x, y
    seen[2] = clearance(x, y, around.rows, around.parts[side, 0], around.parts[side, 1])
    return seen[2]


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
    """Begin anew with what is seen of pegs (K, 3)."""
    for k in range(seen.shape[0]):
        seen[k, 0], seen[k, 1], seen[k, 2] = 0.0, 0.0, 0.0


@compiled
def free_ones(
    configs: Array, touched: IntArray, around: Obstacles, seen: Array, clear: Array, good: NDArray[np.int8]
) -> None:
    """Write to ``good`` (N,) whether a part is free in configurations (N, 4), and the clearances (N, K) where it is, or less
    where they are large.

    Parameters
    ----------
    touched : (K,) piece that each peg has to touch, -1 where none.
    seen : (K, 3) work space.
    """
    nothing_seen(seen)
    for n in range(configs.shape[0]):
        good[n] = 1 if write_clearances(configs[n], touched, 0, around, seen, clear[n]) else 0


@inner
def last_free(ends: Array, touched: IntArray, around: Obstacles, trial: Array, seen: Array, clear: Array) -> None:
    """Move the first of two configurations (2, 4), which is free, along the straight way to the second, which is not, to the
    last free one.

    Parameters
    ----------
    trial, seen, clear : (4,), (K, 3) and (K,) work space.
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
def write_run(clear: Array, begin: int, end: int, first: int, count: int, out: Array) -> None:
    """Write a run of a way from ``begin`` to ``end``: RUN_FIRST, RUN_COUNT, RUN_MIDDLE and RUN_TOUCHES."""
    most, number = 0, 0
    for i in range(count):
        touches = touching(clear[begin + (first - begin + i) % (end - begin)])
        if touches > most or number == 0:
            most, number = touches, 0
        number += touches == most
    middle, seen = first, 0
    for i in range(count):
        at = begin + (first - begin + i) % (end - begin)
        if touching(clear[at]) == most:
            if seen == number // 2:
                middle = at
            seen += 1
    bits = 0
    for k in range(clear.shape[1]):
        if abs(clear[middle, k]) < TOUCHES:
            bits |= 1 << k
    out[RUN_FIRST], out[RUN_COUNT], out[RUN_MIDDLE], out[RUN_TOUCHES] = first, count, middle, bits


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


@compiled
def free_runs(
    configs: Array,
    begins: IntArray,
    closed: NDArray[np.int8],
    touched: IntArray,
    names: IntArray,
    known: Array,
    around: Obstacles,
    clear: Array,
    seen: Array,
    work: Array,
    out: Array,
) -> int:
    """Write the runs of ways in which a part is free, and return how many there are, or -1 where they do not fit.

    Parameters
    ----------
    configs, begins : (M, 4) of all ways, one after the other, and (W + 1,) where each begins.
    closed : (W,) 1 for those of which the last configuration is beside the first.
    touched : (W, P) piece that each peg has to touch, -1 where none.
    names : (W, 4) pegs whose clearances are known, -1 of none.
    known : (M, 4) their clearances in mm, -inf first where one of them hinders.
    clear, seen, work : (M, K), (P, 3) and (4, 4) work space.
    out : (N, 13) runs, see above, written here.
    """
    count = 0
    for w in range(begins.shape[0] - 1):
        begin, end, bits = begins[w], begins[w + 1], 0
        for j in range(names.shape[1]):
            bits |= 1 << names[w, j] if names[w, j] >= 0 else 0
        nothing_seen(seen)
        bad, good = -1, 0
        for n in range(begin, end):
            free = bits == 0 or known[n, 0] != -inf
            if free:
                for j in range(names.shape[1]):
                    if names[w, j] >= 0:
                        clear[n, names[w, j]] = known[n, j]
                free = write_clearances(configs[n], touched[w], bits, around, seen, clear[n])
            if not free:
                clear[n, 0] = -inf
                bad = n if bad < 0 else bad
            good += free
        start, length = begin, 0
        # Of what is closed the last and the first are neighbours.
        shift = bad - begin if closed[w] != 0 and bad >= 0 else 0
        for i in range(end - begin + 1):
            n = begin + (i + shift) % (end - begin)
            free = i < end - begin and clear[n, 0] != -inf
            if free:
                start = n if length == 0 else start
                length += 1
            elif length > 0:
                if count >= out.shape[0]:
                    return -1
                row = out[count]
                row[RUN_WAY] = w
                write_run(clear, begin, end, start, length, row)
                if closed[w] == 0:
                    last, room = start + length - 1, work[3]
                    write_edge(
                        configs, start, start - 1, begin, end, touched[w], around, work, seen, room, row[RUN_START:]
                    )
                    write_edge(configs, last, last + 1, begin, end, touched[w], around, work, seen, room, row[RUN_END:])
                count, length = count + 1, 0
    return count


@compiled
def lie_along(
    configs: Array, sets: Array, begins: IntArray, levels: Array, arm: float, most: float, out: NDArray[np.int8]
) -> None:
    """Write whether places of the part are as near to one of a set's configurations as these are to each other.

    Parameters
    ----------
    configs : (N, 4) the places.
    sets, begins, levels : configurations (M, 4) along all sets, one after the other, where those of each begin and, last,
        end (F + 1,), and their separations (F,) in mm.
    arm : in mm, by which turns are counted.
    most : by how much in mm the separation of a place may differ from a set's.
    out : (N, F) written here.
    """
    for k in range(levels.shape[0]):
        longest = -1.0
        for m in range(configs.shape[0]):
            out[m, k] = 0
            if not abs(configs[m, 3] - levels[k]) < most:
                continue
            if longest < 0.0:
                longest = longest_step(sets, begins[k], begins[k + 1], arm)
            nearest = inf
            for n in range(begins[k], begins[k + 1]):
                turn = (sets[n, 0] - configs[m, 0] + pi) % (2.0 * pi) - pi
                nearest = min(nearest, abs(turn) * arm + hypot(sets[n, 1] - configs[m, 1], sets[n, 2] - configs[m, 2]))
            out[m, k] = 1 if nearest <= longest + BESIDE else 0


@inner
def longest_step(sets: Array, begin: int, end: int, arm: float) -> float:
    """The longest in mm of the steps along a set."""
    longest = 0.0
    for n in range(begin + 1, end):
        dx, dy = sets[n, 1] - sets[n - 1, 1], sets[n, 2] - sets[n - 1, 2]
        longest = max(longest, abs(sets[n, 0] - sets[n - 1, 0]) * arm + abs(dx) + abs(dy))
    return longest


@compiled
def nearest_of(configs: Array, others: Array, arm: float, most: float, level: float, out: IntArray) -> None:
    """Write the number of the nearest of some configurations (M, 4), ordered by S, to each of others (N, 4); -1 where there
    is none.

    Parameters
    ----------
    arm : in mm, by which turns are counted.
    most, level : how far in mm it may be at most, and how much its S may differ, in mm.
    out : (N,) written here.
    """
    for n in range(configs.shape[0]):
        config, nearest, low, high = configs[n], most, 0, others.shape[0]
        out[n] = -1
        while low < high:
            middle = (low + high) // 2
            if others[middle, 3] < config[3] - level:
                low = middle + 1
            else:
                high = middle
        while low < others.shape[0] and others[low, 3] < config[3] + level:
            turn = abs((config[0] - others[low, 0] + pi) % (2.0 * pi) - pi)
            away = turn * arm + hypot(config[1] - others[low, 1], config[2] - others[low, 2])
            if away < nearest:
                nearest, out[n] = away, low
            low += 1


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
