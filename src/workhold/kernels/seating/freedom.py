"""Where pegs and a wall leave a part free along a way that it can go, and candidates that are one."""

from __future__ import annotations

from math import atan2, cos, inf, pi, sin

import numpy as np
from numpy.typing import NDArray

from workhold.conventions import END_SLACK
from workhold.kernels.base.compiling import compiled, inner
from workhold.kernels.seating.columns import CONTACTS, PLACE_X, PLACE_Y, SEPARATION, THETA, Obstacles
from workhold.kernels.seating.pieces import clearance, on_piece

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

# mm. Pegs this near touch, and may be in the part by as much.
TOUCHES = 1e-7
# What supports a part on a wall may fall short of it by this much: rounding.
SUPPORTS = 1e-12
# How often, and into how many parts, a step is cut to find where freedom ends.
EDGE_ROUNDS, EDGE_PARTS = 5, 32


@inner
def off_peg(config: Array, peg: int, piece: int, around: Obstacles) -> float:
    """Clearance of a peg in mm in a configuration (4,); -inf where it is not on a piece that it has to touch (-1: none)."""
    c, s = cos(config[0]), sin(config[0])
    qx = around.pegs[peg, 0] + around.right[peg] * config[3] - config[1]
    qy = around.pegs[peg, 1] - config[2]
    x, y = c * qx + s * qy, c * qy - s * qx
    if piece >= 0 and not on_piece(around.rows[piece], x, y, END_SLACK):
        return -inf
    side = around.right[peg]
    return clearance(x, y, around.rows, around.parts[side, 0], around.parts[side, 1])


@inner
def off_the_wall(config: Array, around: Obstacles) -> float:
    """Clearance of a wall in mm in a configuration (4,)."""
    ux, uy = around.wall[0], around.wall[1]
    angle, reach = atan2(-uy, -ux) - config[0], -inf
    nx, ny = cos(angle), sin(angle)
    for k in range(around.hull.shape[0]):
        row = around.hull[k]
        if nx * row[3] + ny * row[4] >= row[5] - SUPPORTS:
            reach = max(reach, nx * row[0] + ny * row[1] + row[2])
    return config[1] * ux + config[2] * uy - around.wall[2] - reach


@inner
def write_clearances(config: Array, touched: IntArray, around: Obstacles, out: Array) -> bool:
    """Write the clearances of all pegs, and last of a wall, in a configuration; whether all leave the part free and those
    that have to touch pieces (K,) do. Where one does not, what follows it is not written."""
    pegs = around.pegs.shape[0]
    # What stays on its piece seldom hinders.
    for late in range(2):
        for peg in range(pegs):
            if (touched[peg] >= 0) == (late == 1):
                out[peg] = off_peg(config, peg, touched[peg], around)
                if out[peg] <= -TOUCHES:
                    return False
    if around.hull.shape[0] > 0:
        out[pegs] = off_the_wall(config, around)
        return bool(out[pegs] > -TOUCHES)
    return True


@compiled
def free_ones(configs: Array, touched: IntArray, around: Obstacles, clear: Array, good: NDArray[np.int8]) -> int:
    """Write 1 where a part is free in configurations (N, 4), and the clearances (N, K) there; how many there are.

    Parameters
    ----------
    touched : (K,) piece that each peg has to touch, -1 where none.
    """
    count = 0
    for n in range(configs.shape[0]):
        good[n] = 1 if write_clearances(configs[n], touched, around, clear[n]) else 0
        count += good[n]
    return count


@compiled
def last_free(ends: Array, touched: IntArray, around: Obstacles, trial: Array, clear: Array) -> None:
    """Move the first of two configurations (2, 4), which is free, along the straight way to the second, which is not, to the
    last free one.

    Parameters
    ----------
    trial, clear : (4,) and (K,) work space.
    """
    for _ in range(EDGE_ROUNDS):
        last = 0
        for part in range(1, EDGE_PARTS):
            for k in range(4):
                trial[k] = ends[0, k] + part / EDGE_PARTS * (ends[1, k] - ends[0, k])
            if not write_clearances(trial, touched, around, clear):
                break
            last = part
        for k in range(4):
            low, way = ends[0, k], ends[1, k] - ends[0, k]
            ends[0, k] = low + last / EDGE_PARTS * way
            ends[1, k] = low + (last + 1) / EDGE_PARTS * way


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
