"""Directions in which the two pegs of a piece can push together.

Two pegs push together with a force F between the two directions in which each pushes. Where closing clamps, F must point
along +x for standing pegs, and moving pegs push with -F; where opening clamps it is the other way round. Directions with
positive x are told as y / (x + |y|), which grows from -1 to 1 with the angle at a rate of at most 1.
"""

from __future__ import annotations

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.compiling import inner
from workhold.kernels.curves.piece_columns import (
    HEAD_NORMAL_X,
    HEAD_NORMAL_Y,
    LEFTWARD_HIGH,
    LEFTWARD_LOW,
    RIGHTWARD_HIGH,
    RIGHTWARD_LOW,
    TAIL_NORMAL_X,
    TAIL_NORMAL_Y,
)

Array = NDArray[np.float64]

# Rounding of directions, places in mm and slopes, generously counted.
HAIR = 1e-9
# Directions of sums of two normals are told only if the normals turn by less than this, in radians.
LITTLE_TURN = 0.3


@inner
def front(x: float, y: float) -> float:
    """A direction with positive x as y / (x + abs(y))."""
    return y / (x + abs(y))


@inner
def force_range(ax: float, ay: float, bx: float, by: float, doubt: float) -> tuple[float, float]:
    """Directions with positive x between two directions, known to ``doubt`` in radians; (1, -1) when there are none.

    Where it is in doubt which way round "between" is, all directions are told.
    """
    turn = ax * by - ay * bx
    if ax * bx + ay * by < 0.0 and abs(turn) <= doubt + HAIR:
        return (-1.0, 1.0)
    ax, bx = ax + doubt, bx + doubt
    if ax <= 0.0 and bx <= 0.0:
        return (1.0, -1.0)
    if ax > 0.0 and bx > 0.0:
        one, two = front(ax, ay), front(bx, by)
        return (min(one, two), max(one, two))
    if ax > 0.0:
        return (front(ax, ay), 1.0) if turn > 0.0 else (-1.0, front(ax, ay))
    return (-1.0, front(bx, by)) if turn > 0.0 else (front(bx, by), 1.0)


@inner
def shared_force(ax: float, ay: float, bx: float, by: float, share: float, doubt: float) -> tuple[float, float]:
    """``force_range`` of two unit vectors when neither force is less than ``share`` of the other."""
    if share <= 0.0:
        return force_range(ax, ay, bx, by, doubt)
    px, py, qx, qy = ax + share * bx, ay + share * by, bx + share * ax, by + share * ay
    one, two = sqrt(px * px + py * py), sqrt(qx * qx + qy * qy)
    return force_range(px / one, py / one, qx / two, qy / two, doubt)


@inner
def sum_is_long(edge: Array, share: float) -> bool:
    """Whether the sum of one normal of an edge and ``share`` of the other is at least half as long as a normal."""
    cosine = edge[TAIL_NORMAL_X] * edge[HEAD_NORMAL_X] + edge[TAIL_NORMAL_Y] * edge[HEAD_NORMAL_Y]
    return 1.0 + 2.0 * share * cosine + share * share >= 0.25


@inner
def largest_turn(low: Array, high: Array) -> float:
    """How far in radians the normals of a piece turn from end to end, at most, when they turn by less than 1."""
    tail_x, tail_y = high[TAIL_NORMAL_X] - low[TAIL_NORMAL_X], high[TAIL_NORMAL_Y] - low[TAIL_NORMAL_Y]
    head_x, head_y = high[HEAD_NORMAL_X] - low[HEAD_NORMAL_X], high[HEAD_NORMAL_Y] - low[HEAD_NORMAL_Y]
    # A chord of up to 1 radian is no shorter than 0.95 times its arc.
    return 1.06 * sqrt(max(tail_x * tail_x + tail_y * tail_y, head_x * head_x + head_y * head_y))


@inner
def write_force_directions(row: Array, low: Array, high: Array, share: float, turned: float) -> None:
    """Write the directions of the forces of a piece's pegs, from the normals at its ends.

    Inside a curve X keeps its sign, so the normals do not pass through opposite directions: the lowest and the highest
    direction between the forces are where one of them is at an end of the piece, or square to x. So the hull of both ends
    is told, widened by as much as directions may sag between them. A normal sags by no more than ``turned``. With a
    ``share`` (see ``shared_force``) sums p of two normals are meant: normals turn at a rate that changes by at most
    8 turned / w^2, so w times the rate is at most the turn from end to end and 4 turned; abs(p'') w^2 / 8 is at most the
    square of that over 4 and 2 turned, by less than 0.17, and p, nowhere shorter than 0.4, is seen under 2.6 times that.
    """
    write_hull(row, low, high, 0.0, turned)
    turn = largest_turn(low, high) + 4.0 * turned
    if share <= 0.0 or turn > LITTLE_TURN or not (sum_is_long(low, share) and sum_is_long(high, share)):
        return
    wide = row[RIGHTWARD_LOW], row[RIGHTWARD_HIGH], row[LEFTWARD_LOW], row[LEFTWARD_HIGH]
    write_hull(row, low, high, share, 2.6 * (2.0 * turned + turn * turn / 4.0))
    # Both are bounds.
    row[RIGHTWARD_LOW], row[RIGHTWARD_HIGH] = max(row[RIGHTWARD_LOW], wide[0]), min(row[RIGHTWARD_HIGH], wide[1])
    row[LEFTWARD_LOW], row[LEFTWARD_HIGH] = (
        max(row[LEFTWARD_LOW], wide[2]),
        min(row[LEFTWARD_HIGH], wide[3]),
    )


@inner
def write_hull(row: Array, low: Array, high: Array, share: float, doubt: float) -> None:
    """Write the hull of the forces (see ``shared_force``) at both ends of a piece, widened for a ``doubt`` of directions."""
    at_ends, between = 2.0 * doubt, 4.0 * doubt + HAIR
    for k in range(2):
        # Pegs push against the outward normals: rightward as told, leftward as the opposite.
        sign = -1.0 if k == 0 else 1.0
        bottom, top = edge_force(low, sign, share, at_ends)
        first, last = edge_force(high, sign, share, at_ends)
        row[RIGHTWARD_LOW + 2 * k], row[RIGHTWARD_HIGH + 2 * k] = min(bottom, first) - between, max(top, last) + between
        if bottom > top and first > last:
            row[RIGHTWARD_LOW + 2 * k], row[RIGHTWARD_HIGH + 2 * k] = 2.0, -2.0
        elif bottom > top or first > last:
            row[RIGHTWARD_LOW + 2 * k], row[RIGHTWARD_HIGH + 2 * k] = -1.0, 1.0


@inner
def edge_force(edge: Array, sign: float, share: float, doubt: float) -> tuple[float, float]:
    """``shared_force`` of the normals of an edge, times a sign."""
    ax, ay = sign * edge[TAIL_NORMAL_X], sign * edge[TAIL_NORMAL_Y]
    return shared_force(ax, ay, sign * edge[HEAD_NORMAL_X], sign * edge[HEAD_NORMAL_Y], share, doubt)


@inner
def write_all_force_directions(row: Array) -> None:
    """Write that a piece's pegs may push in any direction."""
    row[RIGHTWARD_LOW], row[RIGHTWARD_HIGH], row[LEFTWARD_LOW], row[LEFTWARD_HIGH] = -1.0, 1.0, -1.0, 1.0
