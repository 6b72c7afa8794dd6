r"""Two clamps at one seat: which pairs close, in which ratio their forces may be, and which pair is the best.

Let w_i be the wrenches of three locators, W = [w1 w2 w3], and w_k that of clamp k. The locators take up a_k =
-W^-1 w_k per unit of its force on the face. The null vectors of all five wrenches are u (a_1, 1, 0) + v (a_2,
0, 1): scaled to sum 1 a line, on which each entry is linear. So the largest least entry, the closure margin,
is where two of the five are equal, at one of ten points.

Reference: B. Mishra, J. T. Schwartz, M. Sharir, *On the existence and synthesis of multifinger positive
grips*, Algorithmica 2 (1987), for closure; the rest is linear algebra.
"""

from __future__ import annotations

from math import atan, degrees, hypot, inf
from typing import NamedTuple

import numpy as np

from workhold.conventions import GAP_SLACK, LEAST_CLOSURE, NO_REACTION
from workhold.kernels.base.capacity import Capacity
from workhold.kernels.base.compiling import (
    Array,
    IntArray,
    IntMatrix,
    IntVector,
    Matrix,
    Stack,
    compiled,
    inner,
)

# Columns of a clamp: what locators take up per unit of force on its face (3), its push per unit of its own
# force, how far the former may be off, and the place of its tip in mm.
TAKEN, PUSH, DOUBT, TIP = 0, 3, 4, 5
CLAMP_LENGTH = 7
# Whole numbers of a clamp: direction, the number of its line, first and past-the-last of its holes.
DIRECTION, LINE, FIRST_HOLE, END_HOLE = range(4)
# Columns of a hole: column and row, place in mm, travel in mm.
HOLE_COLUMN, HOLE_ROW, HOLE_X, HOLE_Y, TRAVEL = range(5)
# Columns of a pair: seat, kind, clamps (2), holes (2), how many pairs it stands for, clamp freedom in
# degrees, closure margin, and 1 where it is not decided whether it closes.
SEAT, KIND, CLAMPS, HOLES, COUNT, FREEDOM, MARGIN, OPEN = 0, 1, 2, 4, 6, 7, 8, 9
PAIR_LENGTH = 10
# Of pairs whose freedom (in degrees) and then margin differ by less, the first is taken.
SAME_FREEDOM, SAME_MARGIN = 1e-4, 1e-9
PAIR_CAPACITY = Capacity(64)
ALONG_X = 2
# Rounding of an entry, besides what it may be off.
ROUNDING = 1e-14


class Clamps(NamedTuple):
    """The clamps of some seats, one seat after the other and each seat's in the order of directions.

    Parameters
    ----------
    starts : (S + 1,) where those of each seat begin.
    integers, reals : (M, 4) and (M, 7), see above.
    holes : (H, 5) in which they may be bolted, each clamp's nearest first.
    """

    starts: IntVector
    integers: IntMatrix
    reals: Matrix
    holes: Matrix


class Hardware(NamedTuple):
    """What bounds pairs.

    Parameters
    ----------
    kinds : (4, 4) number of each pair of directions, -1 where it is not asked for.
    apart : least distance in mm between the centre lines of two clamps.
    columns, rows : most columns and rows of holes less one, infinite where there is no end.
    bolted : whether clamps stand in holes.
    """

    kinds: IntMatrix
    apart: float
    columns: float
    rows: float
    bolted: bool


@inner
def entry(clamp: Array, k: int, own: int) -> float:
    """Entry k of a clamp's null vector (a, 1, 0) or (a, 0, 1); its own is entry ``own``."""
    return clamp[TAKEN + k] if k < 3 else (1.0 if k == own else 0.0)


@inner
def closure_margin(one: Array, other: Array) -> tuple[float, float]:
    """How well three locators and two clamps close.

    Returns
    -------
    (the largest least entry of null vectors that sum to 1, -1 where none is positive; the lead)

    The lead is the most by which the least entry of a null vector (1 - s) (a_1, 1, 0) + s (a_2, 0, 1) exceeds
    ``LEAST_CLOSURE`` of its sum. Its sign decides whether they close, and it is off by no more than entries
    of a_1 and a_2 are.
    """
    best, lead = -1.0, -inf
    for i in range(5):
        for j in range(i):
            at_one = entry(one, i, 3) - entry(one, j, 3)
            at_other = entry(other, i, 4) - entry(other, j, 4)
            if at_one == at_other:
                continue
            share = at_one / (at_one - at_other)
            if not 0.0 <= share <= 1.0:
                continue
            total, least = 0.0, inf
            for k in range(5):
                value = (1.0 - share) * entry(one, k, 3) + share * entry(other, k, 4)
                total, least = total + value, min(least, value)
            if total > 0.0:
                best = max(best, least / total)
            lead = max(lead, least - LEAST_CLOSURE * total)
    # At either end of the line one entry is zero.
    for side in (one, other):
        total, least = 1.0, 0.0
        for k in range(3):
            total, least = total + side[TAKEN + k], min(least, side[TAKEN + k])
        lead = max(lead, least - LEAST_CLOSURE * total)
    return (best, lead)


@inner
def pressed_range(low: float, high: float, a: float, b: float) -> tuple[float, float]:
    """The ends of the part of an interval of ratios t in which a locator that carries a + b t is pressed."""
    if b > 0.0:
        low = max(low, -a / b)
    elif b < 0.0:
        high = min(high, -a / b)
    elif a <= 0.0:
        high = 0.0
    return (low, high)


@inner
def ratio_range(one: Array, other: Array) -> tuple[float, float]:
    """The ends of the open interval of f2 / f1 in which all locators are pressed."""
    low, high = 0.0, inf
    for k in range(3):
        a, b = one[TAKEN + k] / one[PUSH], other[TAKEN + k] / other[PUSH]
        a, b = (0.0 if abs(a) < NO_REACTION else a), (0.0 if abs(b) < NO_REACTION else b)
        low, high = pressed_range(low, high, a, b)
    return (low, high)


@inner
def boxes_apart(one: Array, hole: Array, other: Array, other_hole: Array) -> float:
    """Distance in mm between the pieces along the axes from the tips of two clamps to their holes."""
    ax, ay, bx, by = one[TIP], one[TIP + 1], hole[HOLE_X], hole[HOLE_Y]
    cx, cy, dx, dy = other[TIP], other[TIP + 1], other_hole[HOLE_X], other_hole[HOLE_Y]
    across = max(min(ax, bx) - max(cx, dx), min(cx, dx) - max(ax, bx), 0.0)
    along = max(min(ay, by) - max(cy, dy), min(cy, dy) - max(ay, by), 0.0)
    return hypot(across, along)


@inner
def spread_of(clamps: Clamps, m: int, hole: Array, bolted: bool, out: IntArray) -> None:
    """Widens ``out``, the least and largest column and row of what stands on the plate, by a clamp in a
    hole."""
    line = clamps.integers[m, LINE]
    if clamps.integers[m, DIRECTION] < ALONG_X:
        out[2], out[3] = min(out[2], line), max(out[3], line)
        if bolted:
            out[0], out[1] = min(out[0], int(hole[HOLE_COLUMN])), max(out[1], int(hole[HOLE_COLUMN]))
    else:
        out[0], out[1] = min(out[0], line), max(out[1], line)
        if bolted:
            out[2], out[3] = min(out[2], int(hole[HOLE_ROW])), max(out[3], int(hole[HOLE_ROW]))


class ClampedSeat(NamedTuple):
    """A seat and what its pairs are made of.

    Parameters
    ----------
    number : among the seats.
    largest : (2,) column and row of its locators, whose lowest are 0.
    spread : (4,) work space.
    """

    number: int
    largest: IntArray
    clamps: Clamps
    hardware: Hardware
    spread: IntArray


@inner
def best_holes(seat: ClampedSeat, i: int, j: int) -> tuple[int, int]:
    """The holes of two clamps with the least total travel in which they have a place together, (-1, -1) for
    none."""
    clamps, hardware, spread = seat.clamps, seat.hardware, seat.spread
    best, one, other = inf, -1, -1
    holes, tips = clamps.holes, clamps.reals
    for a in range(clamps.integers[i, FIRST_HOLE], clamps.integers[i, END_HOLE]):
        for b in range(clamps.integers[j, FIRST_HOLE], clamps.integers[j, END_HOLE]):
            travel = holes[a, TRAVEL] + holes[b, TRAVEL]
            if travel >= best:
                continue
            spread[0], spread[1], spread[2], spread[3] = 0, seat.largest[0], 0, seat.largest[1]
            spread_of(clamps, i, holes[a], hardware.bolted, spread)
            spread_of(clamps, j, holes[b], hardware.bolted, spread)
            if spread[1] - spread[0] > hardware.columns or spread[3] - spread[2] > hardware.rows:
                continue
            apart = boxes_apart(tips[i], holes[a], tips[j], holes[b])
            if apart >= hardware.apart - GAP_SLACK:
                best, one, other = travel, a, b
    return (one, other)


@inner
def add_pair(out: Array, count: int, kind: int, i: int, j: int, seat: ClampedSeat) -> int:
    """Appends a pair of clamps of a seat if it closes and has a place, and returns how many rows there
    are."""
    one, other = seat.clamps.reals[i], seat.clamps.reals[j]
    margin, lead = closure_margin(one, other)
    doubt = 1.1 * max(one[DOUBT], other[DOUBT]) + ROUNDING
    if lead + doubt <= 0.0:
        return count
    low, high = ratio_range(one, other)
    if low >= high and lead - doubt > 0.0:
        # Reactions that are zero to rounding.
        return count
    first, second = best_holes(seat, i, j)
    if first < 0:
        return count
    row = out[count]
    row[SEAT], row[KIND] = seat.number, kind
    row[CLAMPS], row[CLAMPS + 1], row[HOLES], row[HOLES + 1] = i, j, first, second
    row[COUNT], row[FREEDOM], row[MARGIN] = 1.0, max(degrees(atan(high) - atan(low)), 0.0), margin
    row[OPEN] = 1.0 if lead - doubt <= 0.0 else 0.0
    return count + 1


@inner
def keep_best(out: Array, first: int, count: int) -> int:
    """Keeps of the rows from ``first`` on, pairs of one seat and kind, the best one, which stands for all,
    and those that are not decided. Returns how many rows there are then."""
    pairs = 0
    freest, widest = -inf, -inf
    for k in range(first, count):
        if out[k, OPEN] == 0.0:
            pairs += 1
            freest = max(freest, out[k, FREEDOM])
    for k in range(first, count):
        if out[k, OPEN] == 0.0 and out[k, FREEDOM] > freest - SAME_FREEDOM:
            widest = max(widest, out[k, MARGIN])
    kept, chosen = first, False
    for k in range(first, count):
        is_open = out[k, OPEN] != 0.0
        is_best = out[k, FREEDOM] > freest - SAME_FREEDOM and out[k, MARGIN] > widest - SAME_MARGIN
        if is_open or (is_best and not chosen):
            chosen = chosen or not is_open
            for n in range(PAIR_LENGTH):
                out[kept, n] = out[k, n]
            if not is_open:
                out[kept, COUNT] = pairs
            kept += 1
    return kept


@inner
def add_pairs_of_kind(out: Array, count: int, one: int, two: int, seat: ClampedSeat) -> int:
    """Appends the pairs of two directions at a seat, and returns how many rows there are, -1 when there is
    no room for more."""
    clamps, kind = seat.clamps, seat.hardware.kinds[one, two]
    end = clamps.starts[seat.number + 1]
    for i in range(clamps.starts[seat.number], end):
        if clamps.integers[i, DIRECTION] != one:
            continue
        for j in range(i + 1, end):
            if clamps.integers[j, DIRECTION] != two:
                continue
            if count == out.shape[0]:
                return -1
            count = add_pair(out, count, kind, i, j, seat)
    return count


@inner
def add_pairs(out: Array, count: int, half: bool, seat: ClampedSeat, every: bool) -> int:
    """Appends the pairs of a seat, see :func:`pairs_of`, and returns how many rows there are, -1 when there
    is no room for more."""
    for one in range(4):
        for two in range(one, 4):
            # Opposite directions: half a turn makes such a pair one of the same kind.
            opposed = two == one + 1 and one % 2 == 0
            if seat.hardware.kinds[one, two] < 0 or (opposed and not half):
                continue
            first = count
            count = add_pairs_of_kind(out, count, one, two, seat)
            if count < 0:
                return -1
            if not every:
                count = keep_best(out, first, count)
    return count


def pairs_of(seats: IntArray, halves: IntArray, clamps: Clamps, hardware: Hardware, every: bool) -> Array:
    """Return the pairs of clamps that close and have a place, seat by seat: (N, 10) rows, see above.

    Parameters are those of :func:`write_pairs`.
    """

    def write(rows: int) -> Array | None:
        out = np.empty((rows, PAIR_LENGTH))
        count = write_pairs(seats, halves, clamps, hardware, every, np.empty(4, np.int64), out)
        return None if count < 0 else out[:count].copy()

    return PAIR_CAPACITY.give(write)


@compiled
def write_pairs(
    seats: IntMatrix,
    halves: IntVector,
    clamps: Clamps,
    hardware: Hardware,
    every: bool,
    spread: IntVector,
    out: Matrix,
) -> int:
    """Write the pairs of clamps that close and have a place, and return their number, -1 when there is no
    room.

    Parameters
    ----------
    seats : (S, 2) the largest column and row of their locators, whose lowest are 0.
    halves : (S,) 1 where the orientation is in the first half turn, else 0; less where the seat is left out.
    every : all pairs, or of each seat and kind the best, which is the one of the largest clamp freedom, then
        of the largest closure margin, then the first.
    spread : (4,) work space.
    out : (N, 10) receives the pairs.
    """
    count = int(np.int64(0))
    for number in range(seats.shape[0]):
        if halves[number] >= 0:
            seat = ClampedSeat(number, seats[number], clamps, hardware, spread)
            count = add_pairs(out, count, halves[number] != 0, seat, every)
            if count < 0:
                break
    return count


@compiled
def closures_of(clamps: Stack, out: Matrix) -> None:
    """Closure margins and clamp freedoms in degrees of N fixtures with two clamps.

    Parameters
    ----------
    clamps : (N, 2, 7) rows of both clamps, of which only the first four columns count.
    out : (N, 2) receives margins and freedoms.
    """
    for n in range(clamps.shape[0]):
        out[n, 0], _ = closure_margin(clamps[n, 0], clamps[n, 1])
        low, high = ratio_range(clamps[n, 0], clamps[n, 1])
        out[n, 1] = max(degrees(atan(high) - atan(low)), 0.0)
