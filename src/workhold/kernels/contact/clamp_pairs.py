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

# Columns of a clamp: TAKEN (3), the force of each locator per unit of the clamp's force on its face; PUSH,
# that force per unit of the clamp's own force; DOUBT, the error bound of TAKEN; TIP (2), its tip on the plate
# in mm.
TAKEN, PUSH, DOUBT, TIP = 0, 3, 4, 5
CLAMP_LENGTH = 7
# Whole numbers of a clamp: direction (0 and 1 along x, 2 and 3 along y), lattice row or column of its line,
# first and past-the-last of its holes.
DIRECTION, LINE, FIRST_HOLE, END_HOLE = range(4)
# Columns of a hole: column and row, place in mm, travel in mm.
HOLE_COLUMN, HOLE_ROW, HOLE_X, HOLE_Y, TRAVEL = range(5)
# Columns of a pair: index of its seat, its kind (``Hardware.kinds``), indices of its clamps (2) and holes
# (2), how many pairs it stands for, clamp freedom in degrees, closure margin, and 1 where it is undecided
# whether it closes.
SEAT, KIND, CLAMPS, HOLES, COUNT, FREEDOM, MARGIN, OPEN = 0, 1, 2, 4, 6, 7, 8, 9
PAIR_LENGTH = 10
# Of pairs whose freedom (in degrees) and then margin differ by less, the first is taken.
SAME_FREEDOM, SAME_MARGIN = 1e-4, 1e-9
PAIR_CAPACITY = Capacity(64)
ALONG_X = 2
# Rounding of an entry, besides what it may be off.
ROUNDING = 1e-14


class Clamps(NamedTuple):
    """The clamps of S seats, seat by seat, those of a seat in the order of directions.

    Parameters
    ----------
    starts : (S + 1,) index of the first clamp of each seat, then M.
    integers : (M, 4) with columns DIRECTION, LINE, FIRST_HOLE, END_HOLE.
    reals : (M, 7) with columns TAKEN (3): locators' forces per unit of force on the clamp's face, PUSH: that
        force per unit of the clamp's own, DOUBT: error bound of TAKEN, TIP (2): in mm.
    holes : (H, 5) in which the clamps may be bolted, each clamp's in order of distance; columns HOLE_COLUMN,
        HOLE_ROW, HOLE_X, HOLE_Y, TRAVEL.
    """

    starts: IntVector
    integers: IntMatrix
    reals: Matrix
    holes: Matrix


class Hardware(NamedTuple):
    """Limits on a pair of clamps and their places on the plate.

    Parameters
    ----------
    kinds : (4, 4) number of each pair of directions, -1 where the pair is not asked for.
    apart : least distance in mm between the centre lines of two clamps.
    columns, rows : largest difference of columns and of rows of the holes in use, inf where unbounded.
    bolted : whether clamps stand in holes.
    """

    kinds: IntMatrix
    apart: float
    columns: float
    rows: float
    bolted: bool


@inner
def get_null_entry(clamp: Array, k: int, own: int) -> float:
    """Return entry k (0 to 4) of a clamp's null vector: (a, 1, 0) if ``own`` is 3, (a, 0, 1) if ``own`` is 4.

    ``clamp`` is a (7,) row of ``Clamps.reals``; the three numbers a are in its columns TAKEN. See
    ``contact.clamp_pairs`` for the layout of ``clamp``.
    """
    return clamp[TAKEN + k] if k < 3 else (1.0 if k == own else 0.0)


@inner
def compute_closure_margin(one: Array, other: Array) -> tuple[float, float]:
    """Return (closure margin, lead) of three locators and two clamps.

    ``one`` and ``other`` are (7,) clamp rows, of which only the columns TAKEN are read: a_1 and a_2, the
    locators' forces per unit of each clamp's force. A null vector holds forces of locators and clamps that
    balance: (a_1, 1, 0), (a_2, 0, 1) and their combinations.

    Returns
    -------
    (closure margin: the largest least entry of null vectors scaled to sum 1, or -1 where no null vector has a
        positive sum; lead: the most by which the least entry of a null vector (1 - s) (a_1, 1, 0) + s (a_2,
        0, 1) exceeds ``LEAST_CLOSURE`` times its sum)

    The sign of the lead decides whether the five close. The lead is off by no more than the entries of a_1
        and a_2 are.
    """
    best, lead = -1.0, -inf
    for i in range(5):
        for j in range(i):
            at_one = get_null_entry(one, i, 3) - get_null_entry(one, j, 3)
            at_other = get_null_entry(other, i, 4) - get_null_entry(other, j, 4)
            if at_one == at_other:
                continue
            share = at_one / (at_one - at_other)
            if not 0.0 <= share <= 1.0:
                continue
            total, least = 0.0, inf
            for k in range(5):
                value = (1.0 - share) * get_null_entry(one, k, 3) + share * get_null_entry(other, k, 4)
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
def narrow_pressed_range(low: float, high: float, a: float, b: float) -> tuple[float, float]:
    """Return the part (low, high) of an open interval of ratios t in which a locator with the force a + b t
    is pressed.

    A locator is pressed where a + b t > 0. Where it is pressed nowhere, low >= high.
    """
    if b > 0.0:
        low = max(low, -a / b)
    elif b < 0.0:
        high = min(high, -a / b)
    elif a <= 0.0:
        high = 0.0
    return (low, high)


@inner
def find_ratio_range(one: Array, other: Array) -> tuple[float, float]:
    """Return (low, high), the open interval of the ratio f2 / f1 in which all three locators are pressed.

    ``one`` and ``other`` are (7,) rows of the clamps that push with forces f1 and f2; low >= high where there
    is no such ratio. See ``contact.clamp_pairs`` for the layout of ``one`` and ``other``.
    """
    low, high = 0.0, inf
    for k in range(3):
        a, b = one[TAKEN + k] / one[PUSH], other[TAKEN + k] / other[PUSH]
        a, b = (0.0 if abs(a) < NO_REACTION else a), (0.0 if abs(b) < NO_REACTION else b)
        low, high = narrow_pressed_range(low, high, a, b)
    return (low, high)


@inner
def measure_box_distance(one: Array, hole: Array, other: Array, other_hole: Array) -> float:
    """Return the distance in mm between the bounding boxes of two clamps, each reaching from its tip to its
    hole.

    ``one`` and ``other`` are (7,) clamp rows, ``hole`` and ``other_hole`` (5,) hole rows, see
    :class:`Clamps`. Boxes are parallel to the plate's axes.
    """
    ax, ay, bx, by = one[TIP], one[TIP + 1], hole[HOLE_X], hole[HOLE_Y]
    cx, cy, dx, dy = other[TIP], other[TIP + 1], other_hole[HOLE_X], other_hole[HOLE_Y]
    across = max(min(ax, bx) - max(cx, dx), min(cx, dx) - max(ax, bx), 0.0)
    along = max(min(ay, by) - max(cy, dy), min(cy, dy) - max(ay, by), 0.0)
    return hypot(across, along)


@inner
def widen_spread(clamps: Clamps, m: int, hole: Array, bolted: bool, out: IntArray) -> None:
    """Widen ``out`` in place to hold clamp number ``m`` in a hole.

    ``out`` (4,) holds the least and largest column, then the least and largest row, of what stands on the
    plate. Along the clamp's push, its hole counts only if ``bolted``. See ``contact.clamp_pairs`` for the
    layout of ``hole``.
    """
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
    """A seat of three locators, and what is needed to pair its clamps.

    Parameters
    ----------
    number : index among the seats.
    largest : (2,) largest column and row of its locators, whose lowest are 0.
    spread : (4,) work space.
    """

    number: int
    largest: IntArray
    clamps: Clamps
    hardware: Hardware
    spread: IntArray


@inner
def find_best_holes(seat: ClampedSeat, i: int, j: int) -> tuple[int, int]:
    """Return the indices of the holes of clamps i and j with the least total travel, (-1, -1) for none.

    Only holes count in which both clamps fit on the plate and keep their distance from each other.
    """
    clamps, hardware, spread = seat.clamps, seat.hardware, seat.spread
    best, one, other = inf, -1, -1
    holes, tips = clamps.holes, clamps.reals
    for a in range(clamps.integers[i, FIRST_HOLE], clamps.integers[i, END_HOLE]):
        for b in range(clamps.integers[j, FIRST_HOLE], clamps.integers[j, END_HOLE]):
            travel = holes[a, TRAVEL] + holes[b, TRAVEL]
            if travel >= best:
                continue
            spread[0], spread[1], spread[2], spread[3] = 0, seat.largest[0], 0, seat.largest[1]
            widen_spread(clamps, i, holes[a], hardware.bolted, spread)
            widen_spread(clamps, j, holes[b], hardware.bolted, spread)
            if spread[1] - spread[0] > hardware.columns or spread[3] - spread[2] > hardware.rows:
                continue
            apart = measure_box_distance(tips[i], holes[a], tips[j], holes[b])
            if apart >= hardware.apart - GAP_SLACK:
                best, one, other = travel, a, b
    return (one, other)


@inner
def add_pair(out: Array, count: int, kind: int, i: int, j: int, seat: ClampedSeat) -> int:
    """Append the pair of clamps i and j to row ``count`` of ``out``
    if it closes, or may close, and has a place.

    Return the new number of rows. ``out`` must have room for one more row (10,).
    """
    one, other = seat.clamps.reals[i], seat.clamps.reals[j]
    margin, lead = compute_closure_margin(one, other)
    doubt = 1.1 * max(one[DOUBT], other[DOUBT]) + ROUNDING
    if lead + doubt <= 0.0:
        return count
    low, high = find_ratio_range(one, other)
    if low >= high and lead - doubt > 0.0:
        # Reactions that are zero to rounding.
        return count
    first, second = find_best_holes(seat, i, j)
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
    """Reduce the rows ``first`` to ``count`` - 1 of ``out`` in place to the undecided pairs and the best
    decided one.

    The rows are all pairs of one seat and kind. The best pair's column COUNT becomes the number of decided
    pairs. Return the new number of rows.
    """
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
    """Append the pairs of a clamp with direction ``one`` and a clamp
    with direction ``two`` at a seat to ``out``.

    Return the new number of rows, -1 when ``out`` is full.
    """
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
    """Append the pairs of clamps of a seat to ``out``, see :func:`write_pairs`.

    ``count`` rows are written already. Return the new number of rows, -1 when ``out`` is full. ``half`` tells
    whether the orientation is in the first half turn: elsewhere, pairs of opposite directions are left out,
    as half a turn makes of such a pair one of the same kind.
    """
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


def list_pairs(seats: IntArray, halves: IntArray, clamps: Clamps, hardware: Hardware, every: bool) -> Array:
    """Return the pairs of clamps that close, or may close, and have a place: (N, 10) rows, seat by seat.

    Columns are SEAT (index), KIND (see ``Hardware.kinds``), CLAMPS (2 indices), HOLES (2 indices), COUNT of
    the pairs that the row stands for, FREEDOM in degrees, MARGIN (closure margin), and OPEN: 1 where it is
    undecided whether the pair closes. Parameters are those of :func:`write_pairs`.
    """

    def write(rows: int) -> Array | None:
        """Return the pairs, written to an array with room for ``rows`` rows; None where that is not enough
        room."""
        out = np.empty((rows, PAIR_LENGTH))
        count = write_pairs(seats, halves, clamps, hardware, every, np.empty(4, np.int64), out)
        return None if count < 0 else out[:count].copy()

    return PAIR_CAPACITY.call_with_room(write)


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
    """Write the pairs of clamps that close, or may close, and have a place to ``out``, seat by seat.

    Return their number, or -1 when ``out`` has too few rows.

    Parameters
    ----------
    seats : (S, 2) the largest column and row of each seat's locators, whose lowest are 0.
    halves : (S,) 1 where the orientation is in the first half turn, else 0; negative where the seat is left
        out.
    every : whether to write all pairs; if not, of each seat and kind the undecided ones and the best, which
        is the one of the largest clamp freedom, then of the largest closure margin, then the first.
    spread : (4,) work space.
    out : (N, 10) receives the pairs, see :func:`list_pairs`.
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
def write_closures(clamps: Stack, out: Matrix) -> None:
    """Write the closure margins and clamp freedoms (degrees) of N fixtures with two clamps to ``out``.

    Parameters
    ----------
    clamps : (N, 2, 7) clamp rows, of which only the columns TAKEN and PUSH are read.
    out : (N, 2) receives margins (no unit, -1 where none) and freedoms in degrees.
    """
    for n in range(clamps.shape[0]):
        out[n, 0], _ = compute_closure_margin(clamps[n, 0], clamps[n, 1])
        low, high = find_ratio_range(clamps[n, 0], clamps[n, 1])
        out[n, 1] = max(degrees(atan(high) - atan(low)), 0.0)
