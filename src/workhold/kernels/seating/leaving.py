"""Whether a part can be taken straight away from all pegs."""

from __future__ import annotations

from math import cos, hypot, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.compiling import compiled, inner
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, IS_ARC, RADIUS, SIGN, X, Y
from workhold.kernels.seating.columns import Obstacles
from workhold.kernels.seating.pieces import normal_at, on_piece, place_on_part

Array = NDArray[np.float64]
# mm. A peg this near to a piece touches it; so it does a hair inside. No unit: ways this near to a face go along it.
TOUCHED, LEVEL = 1e-4, 1e-12
# mm. How far past the end of a piece a peg meets it: rounding.
END = 1e-9


@inner
def meets(row: Array, x: float, y: float, wx: float, wy: float) -> bool:
    """Whether a point moved along a direction enters the part through a piece, be it at once."""
    dx, dy = x - row[X], y - row[Y]
    if row[IS_ARC] == 0.0:
        entering, off = wx * row[AXIS_Y] - wy * row[AXIS_X], dx * row[AXIS_Y] - dy * row[AXIS_X]
        if not entering < -LEVEL:
            return False
        if abs(off) < TOUCHED and on_piece(row, x, y, TOUCHED):
            return True
        t, least = -off / entering, TOUCHED
    else:
        size = hypot(dx, dy)
        if abs(size - row[RADIUS]) < TOUCHED:
            nx, ny = normal_at(row, x, y)
            # Along a concave arc there is no way.
            level = -LEVEL if row[SIGN] > 0.0 else TOUCHED
            if wx * nx + wy * ny < level and on_piece(row, x, y, TOUCHED):
                return True
        middle = wx * dx + wy * dy
        square = middle * middle - (size - row[RADIUS]) * (size + row[RADIUS])
        if square <= 0.0:
            return False
        # Into a convex arc from without; into a concave one from within, also from where it is touched.
        t = -middle - row[SIGN] * sqrt(square)
        least = TOUCHED if row[SIGN] > 0.0 else 0.0
    return t > least and on_piece(row, x + t * wx, y + t * wy, END)


@inner
def first_met(obstacles: Obstacles, wx: float, wy: float, places: Array, last: int) -> int:
    """The number of the peg and the piece that meet as all pegs move away along a direction of the part's frame, -1 where
    none do.

    Parameters
    ----------
    places : (K, 2) of the pegs on the part.
    last : what was met on another way, which is looked at first, or -1.
    """
    pieces = obstacles.rows.shape[0]
    if last >= 0:
        peg = last // pieces
        if meets(obstacles.rows[last % pieces], places[peg, 0], places[peg, 1], wx, wy):
            return last
    for peg in range(obstacles.pegs.shape[0]):
        side = obstacles.right[peg]
        for piece in range(obstacles.parts[side, 0], obstacles.parts[side, 1]):
            if meets(obstacles.rows[piece], places[peg, 0], places[peg, 1], wx, wy):
                return peg * pieces + piece
    return -1


@inner
def leads_away(config: Array, obstacles: Obstacles, ways: Array, places: Array) -> bool:
    """See ``leave``, of one configuration."""
    cosine, sine = cos(config[0]), sin(config[0])
    for peg in range(obstacles.pegs.shape[0]):
        places[peg, 0], places[peg, 1] = place_on_part(config, obstacles, peg)
    met = -1
    for k in range(ways.shape[0]):
        wx, wy = ways[k, 0], ways[k, 1]
        vx, vy = cosine * wx - sine * wy, sine * wx + cosine * wy
        if vx * obstacles.wall[0] + vy * obstacles.wall[1] <= LEVEL:
            met = first_met(obstacles, wx, wy, places, met)
            if met < 0:
                return True
    return False


@compiled
def leave(configs: Array, obstacles: Obstacles, ways: Array, places: Array, out: NDArray[np.int8]) -> None:
    """Whether pegs can all move away from a part, in configurations (N, 4), in one of some directions without entering it,
    and without coming nearer to a wall.

    Parameters
    ----------
    ways : (D, 2) unit vectors of the directions.
    places : (K, 2) work space.
    out : (N,) 1 where it is asked; 0 is written where they cannot.
    """
    for n in range(configs.shape[0]):
        if out[n] != 0 and not leads_away(configs[n], obstacles, ways, places):
            out[n] = 0
