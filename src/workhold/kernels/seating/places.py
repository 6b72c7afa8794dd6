"""The places that descent paths end in, and the pass at which one leads to another."""

from __future__ import annotations

from math import hypot, inf, pi

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.compiling import compiled, inner
from workhold.kernels.seating.closing import AT_REST, AT_THE_STOP
from workhold.kernels.seating.columns import SEPARATION, Manifolds
from workhold.kernels.seating.equilibrium_manifolds import first_of, lies_in

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

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
    ends: Array,
    how: NDArray[np.int8],
    leaves: NDArray[np.int8],
    manifolds: Manifolds,
    lying: IntArray,
    falling: IntArray,
    seats: Array,
    numbers: IntArray,
    first: int,
    size: float,
    doubtful: Array,
    count: int,
    fallen: IntArray,
    out: IntArray,
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
            place = rest_at(ends[last], how[last], leaves[last], manifolds, lying, seats, numbers, first, size)
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
def leads_out(joins: IntArray, place: int, groups: IntArray) -> int:
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
