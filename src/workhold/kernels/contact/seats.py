r"""Seats of three locators: numbers by which contacts are grouped into seats, and bounds that no pair of
clamps at a seat exceeds.

Contacts of three locators are grouped by seat, whatever the direction of the clamp. The holes of the locators
become one number of 64 bits. Triples of holes with equal numbers are only compared further, so it does no
harm where different triples agree by chance. The place of the part beside the holes becomes one number, too.

Bounds of pairs: let the locators carry b_1 f_1 + b_2 f_2, each entry known to within e. Where a force is
larger, the condition that a locator be pressed is never stricter. So the interval of f_2 / f_1 for b + e
holds the true one, and the interval for b - e lies in it. At a ratio t a peg carries the share (b_1 + b_2 t)
/ (1 + t) of f_1 + f_2, monotone in t. So over an interval no peg carries less than at one of the ends.
"""

from __future__ import annotations

from math import atan, cos, degrees, inf, pi, sin

from workhold.kernels.base.compiling import (
    Array,
    IntMatrix,
    IntVector,
    Matrix,
    Vector,
    compiled,
    inner,
)
from workhold.kernels.contact.clamp_pairs import compute_closure_margin, narrow_pressed_range
from workhold.kernels.contact.record import COLUMNS, PSI, ROWS, TAIL_X, TAIL_Y

# What mixes two coordinates to one number.
ASIDE = 0.7548776662
# Odd numbers that mix the holes of three locators; of products the last 64 bits count.
COLUMN_STEP = -7046029254386353131
FIRST, SECOND, THIRD = -4658895280553007687, -7723592293110705685, -2960836687051489901


@compiled
def write_seat_numbers(
    records: Matrix,
    turn: Vector,
    pitch: Vector,
    start: float,
    holes: IntVector,
    theta: Vector,
    places: Vector,
) -> None:
    """Write, for each record of three locators, three numbers by which records are grouped into seats.

    Parameters
    ----------
    records : (N, 19), see ``kernels.contact.record``.
    turn : (3,) cosine, sine and angle in radians by which the frame is turned on the plate, a multiple of a
        quarter turn.
    pitch : (2,) of the holes in mm, along x and y of the plate.
    start : the orientation in radians that counts as 0.
    holes : (N,) receives a hash of the holes of the locators, the same wherever these are on the plate.
    theta : (N,) receives the orientations of the part, minus ``start``, in [0, 2 pi).
    places : (N,) receives one number in mm for the position of the part beside the lowest holes: x +
        ``ASIDE`` y.
    """
    cosine, sine = int(turn[0]), int(turn[1])
    for n in range(records.shape[0]):
        record = records[n]
        a, b, c = int(record[COLUMNS]), int(record[COLUMNS + 1]), int(record[COLUMNS + 2])
        d, e, f = int(record[ROWS]), int(record[ROWS + 1]), int(record[ROWS + 2])
        a, d = cosine * a - sine * d, sine * a + cosine * d
        b, e = cosine * b - sine * e, sine * b + cosine * e
        c, f = cosine * c - sine * f, sine * c + cosine * f
        column, row = min(a, min(b, c)), min(d, min(e, f))
        a, b, c, d, e, f = a - column, b - column, c - column, d - row, e - row, f - row
        one, two, three = a * COLUMN_STEP + d, b * COLUMN_STEP + e, c * COLUMN_STEP + f
        low, high = min(one, two), max(one, two)
        low, middle = min(low, three), max(low, three)
        middle, high = min(middle, high), max(middle, high)
        holes[n] = low * FIRST + middle * SECOND + high * THIRD
        angle = turn[2] - record[PSI]
        x = cos(angle) * record[TAIL_X] - sin(angle) * record[TAIL_Y]
        y = sin(angle) * record[TAIL_X] + cos(angle) * record[TAIL_Y]
        places[n] = a * pitch[0] - x + ASIDE * (d * pitch[1] - y)
        theta[n] = (angle - start) % (2.0 * pi)


# Columns of forces per unit of a clamp's own force: on three locators, on its face, and their error bound.
LOCATOR, FACE, OFF = 0, 3, 4
FORCE_LENGTH = 5
# Columns of the bounds of the pairs of a seat: freedom in degrees, closure margin, clamp amplification.
FREEDOM, MARGIN, AMPLIFICATION = range(3)
BOUND_LENGTH = 3
# The largest freedom and margin possible, used where forces are not known.
FREE, WIDE = 90.0, 0.2


@inner
def find_widened_range(one: Array, other: Array, off: float, off_other: float) -> tuple[float, float]:
    """Return (low, high), the interval of f2 / f1 in which three locators are pressed if their forces are
    increased.

    ``one`` and ``other`` are (5,) rows of forces per unit of f1 and f2, see :func:`write_pair_bounds`.
    ``off`` is added to each locator's force in ``one``, ``off_other`` to each in ``other``. Where there is no
    such ratio, low >= high.
    """
    low, high = 0.0, inf
    for k in range(3):
        low, high = narrow_pressed_range(low, high, one[LOCATOR + k] + off, other[LOCATOR + k] + off_other)
    return (low, high)


@inner
def bound_amplification(one: Array, other: Array, first: float, last: float) -> float:
    """Return a lower bound of (largest peg force) / (f1 + f2) over a range of ratios of two clamps' forces f1
    and f2.

    The range is given as angles of the vector (f1, f2), from ``first`` to ``last`` in radians, within [0, pi
    / 2]. ``one`` and ``other`` are (5,) rows of forces per unit of f1 and f2, see :func:`write_pair_bounds`.
    """
    c, s, d, t = cos(first), sin(first), cos(last), sin(last)
    most = max(
        min(c / (c + s), d / (d + t)) * one[FACE],
        min(s / (c + s), t / (d + t)) * other[FACE],
    )
    for k in range(3):
        a, b = one[LOCATOR + k], other[LOCATOR + k]
        most = max(most, min((c * a + s * b) / (c + s), (d * a + t * b) / (d + t)))
    return most - max(one[OFF], other[OFF])


@inner
def widen_bounds(out: Array, one: Array, other: Array, work: Array, wants_margin: bool) -> None:
    """Widen the bounds ``out`` (3,) of a seat in place so that they also hold for one pair of clamps.

    A pair that cannot close changes nothing. ``one`` and ``other`` are the clamps' (5,) rows of forces, see
    :func:`write_pair_bounds`; where they are not known (OFF is inf), the bounds become the best possible
    ones. ``out`` has the columns FREEDOM, MARGIN, AMPLIFICATION; ``work`` is (2, 3) work space.
    """
    e, f = one[OFF], other[OFF]
    if e == inf or f == inf:
        out[FREEDOM], out[MARGIN], out[AMPLIFICATION] = FREE, WIDE, 0.0
        return
    low, high = find_widened_range(one, other, e, f)
    if low >= high:
        return
    first, last = atan(low), atan(high)
    out[FREEDOM] = max(out[FREEDOM], degrees(last - first))
    low, high = find_widened_range(one, other, -e, -f)
    if low < high:
        # The working ratio is in the middle of an interval whose ends are known so well.
        first, last = (first + atan(high)) / 2.0, (atan(low) + last) / 2.0
    out[AMPLIFICATION] = min(out[AMPLIFICATION], bound_amplification(one, other, first, last))
    if not wants_margin:
        out[MARGIN] = WIDE
        return
    for k in range(3):
        work[0, k], work[1, k] = one[LOCATOR + k] / one[FACE], other[LOCATOR + k] / other[FACE]
    margin, _ = compute_closure_margin(work[0], work[1])
    out[MARGIN] = max(out[MARGIN], max(margin, 0.0) + 3.0 * max(e, f))


@compiled
def write_pair_bounds(
    starts: IntVector,
    directions: IntVector,
    forces: Matrix,
    asked: IntMatrix,
    wants_margin: bool,
    out: Matrix,
    work: Matrix,
) -> None:
    """Write, for each of S seats, bounds of three figures that hold for every pair of the seat's clamps.

    Parameters
    ----------
    starts : (S + 1,) index of the first clamp of each seat, then M.
    directions : (M,) number of each clamp's direction, 0 to 3.
    forces : (M, 5) forces per unit of the clamp's own force, with columns LOCATOR (3): of the locators, FACE:
        of the clamp on its face, OFF: error bound of these forces, inf where they are not known.
    asked : (4, 4) 1 for each pair of directions of clamps that is asked for, else 0.
    wants_margin : whether to bound closure margins by the pairs; if not, the bound is ``WIDE`` for each seat
        with a pair.
    out : (S, 3) receives the largest clamp freedom in degrees, the largest closure margin and the least clamp
        amplification of a pair. They are -inf, -inf and inf where no pair can close.
    work : (2, 3) work space.
    """
    for n in range(len(starts) - 1):
        row = out[n]
        row[FREEDOM], row[MARGIN], row[AMPLIFICATION] = -inf, -inf, inf
        for i in range(starts[n], starts[n + 1]):
            for j in range(i + 1, starts[n + 1]):
                if asked[directions[i], directions[j]] != 0:
                    widen_bounds(row, forces[i], forces[j], work, wants_margin)
                elif asked[directions[j], directions[i]] != 0:
                    widen_bounds(row, forces[j], forces[i], work, wants_margin)
