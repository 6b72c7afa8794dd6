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
    configs: Array,
    touched: IntArray,
    known: int,
    around: Obstacles,
    seen: Array,
    clear: Array,
    good: NDArray[np.int8],
) -> int:
    """Leave 1 where a part is free in configurations (N, 4), and write the clearances (N, K) there, or less where they are
    large; how many there are.

    Parameters
    ----------
    touched : (K,) piece that each peg has to touch, -1 where none.
    known : a bit for each peg that is known to leave the part free where 1 stands.
    seen : (K, 3) work space.
    """
    count = 0
    nothing_seen(seen)
    for n in range(configs.shape[0]):
        if good[n] != 0:
            good[n] = 1 if write_clearances(configs[n], touched, known, around, seen, clear[n]) else 0
            count += good[n]
    return count


@compiled
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


@compiled
def lies_along(theta: float, x: float, y: float, configs: Array, arm: float) -> bool:
    """Whether a place of the part is as near to one of some configurations (N, 4) as they are to each other.

    Parameters
    ----------
    arm : in mm, by which turns are counted.
    """
    nearest, longest = inf, 0.0
    for n in range(configs.shape[0]):
        turn = (configs[n, 0] - theta + pi) % (2.0 * pi) - pi
        nearest = min(nearest, abs(turn) * arm + hypot(configs[n, 1] - x, configs[n, 2] - y))
        if n > 0:
            dx, dy = configs[n, 1] - configs[n - 1, 1], configs[n, 2] - configs[n - 1, 2]
            longest = max(longest, abs(configs[n, 0] - configs[n - 1, 0]) * arm + abs(dx) + abs(dy))
    return nearest <= longest + BESIDE


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
