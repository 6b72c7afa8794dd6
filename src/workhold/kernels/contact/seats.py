r"""Seats of three locators: numbers by which they are grouped, and what no pair of clamps at one exceeds.

Contacts of three locators are grouped by seat, whatever the direction of the clamp. The holes of the locators
become one number of 64 bits: that two triples agree only puts them together. The place of the part beside the
holes becomes one number, too.

Bounds of pairs: let the locators carry b_1 f_1 + b_2 f_2, each entry known to within e. Where a force is
larger, no condition that a locator be pressed is stricter. So the interval of f_2 / f_1 for b + e holds the
true one, and that for b - e lies in it. At a ratio t the share of a peg of f_1 + f_2 is
(b_1 + b_2 t) / (1 + t), monotone in t. So over an interval no peg carries less than at one of its ends.
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
from workhold.kernels.contact.clamp_pairs import closure_margin, pressed_range
from workhold.kernels.contact.record import COLUMNS, PSI, ROWS, TAIL_X, TAIL_Y

# What mixes two coordinates to one number.
ASIDE = 0.7548776662
# Odd numbers that mix the holes of three locators; of products the last 64 bits count.
COLUMN_STEP = -7046029254386353131
FIRST, SECOND, THIRD = -4658895280553007687, -7723592293110705685, -2960836687051489901


@compiled
def numbers_of_seats(
    records: Matrix,
    turn: Vector,
    pitch: Vector,
    start: float,
    holes: IntVector,
    theta: Vector,
    places: Vector,
) -> None:
    """What distinguishes the seats of contacts.

    Parameters
    ----------
    records : (N, 19), see ``kernels.contact.record``.
    turn : (3,) cosine, sine and angle in radians by which the frame is turned on the plate.
    pitch : (2,) of the holes in mm.
    start : the angle in radians from which orientations are counted.
    holes : (N,) receives a number for the holes of the locators, the same wherever they are on the plate.
    theta : (N,) receives orientations from ``start`` on.
    places : (N,) receives a number for the place of the part beside the lowest holes in mm.
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


# Columns of forces per unit of a clamp's own: three locators', that on its face, how far they may be off.
LOCATOR, FACE, OFF = 0, 3, 4
FORCE_LENGTH = 5
# Columns of what bounds the pairs of a seat.
FREEDOM, MARGIN, AMPLIFICATION = range(3)
BOUND_LENGTH = 3
# The best that they can be where forces are not known.
FREE, WIDE = 90.0, 0.2


@inner
def widened_range(one: Array, other: Array, off: float, off_other: float) -> tuple[float, float]:
    """The ends of the interval of f2 / f1 in which locators are pressed, were forces larger by ``off``."""
    low, high = 0.0, inf
    for k in range(3):
        low, high = pressed_range(low, high, one[LOCATOR + k] + off, other[LOCATOR + k] + off_other)
    return (low, high)


@inner
def least_amplification(one: Array, other: Array, first: float, last: float) -> float:
    """What some peg carries at least of f1 + f2, the angle of (f1, f2) being from ``first`` to ``last``."""
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
def widen(out: Array, one: Array, other: Array, work: Array, wants_margin: bool) -> None:
    """Widens what bounds the pairs of a seat (3,) by a pair of clamps, if it may close."""
    e, f = one[OFF], other[OFF]
    if e == inf or f == inf:
        out[FREEDOM], out[MARGIN], out[AMPLIFICATION] = FREE, WIDE, 0.0
        return
    low, high = widened_range(one, other, e, f)
    if low >= high:
        return
    first, last = atan(low), atan(high)
    out[FREEDOM] = max(out[FREEDOM], degrees(last - first))
    low, high = widened_range(one, other, -e, -f)
    if low < high:
        # The working ratio is in the middle of an interval whose ends are known so well.
        first, last = (first + atan(high)) / 2.0, (atan(low) + last) / 2.0
    out[AMPLIFICATION] = min(out[AMPLIFICATION], least_amplification(one, other, first, last))
    if not wants_margin:
        out[MARGIN] = WIDE
        return
    for k in range(3):
        work[0, k], work[1, k] = one[LOCATOR + k] / one[FACE], other[LOCATOR + k] / other[FACE]
    margin, _ = closure_margin(work[0], work[1])
    out[MARGIN] = max(out[MARGIN], max(margin, 0.0) + 3.0 * max(e, f))


@compiled
def bounds_of_pairs(
    starts: IntVector,
    directions: IntVector,
    forces: Matrix,
    asked: IntMatrix,
    wants_margin: bool,
    out: Matrix,
    work: Matrix,
) -> None:
    """What no pair of clamps of seats exceeds.

    Parameters
    ----------
    starts : (S + 1,) where the clamps of each seat begin.
    directions : (M,) of the clamps.
    forces : (M, 5), see above; infinitely far off where they are not known.
    asked : (4, 4) 1 for pairs of directions that are asked for, else 0.
    wants_margin : whether closure margins are bounded by their pairs; by 1/5 alone if not.
    out : (S, 3) receives the largest clamp freedom in degrees, the largest closure margin and the least clamp
        amplification of a pair. They are -inf, -inf and inf where none can close.
    work : (2, 3) work space.
    """
    for n in range(len(starts) - 1):
        row = out[n]
        row[FREEDOM], row[MARGIN], row[AMPLIFICATION] = -inf, -inf, inf
        for i in range(starts[n], starts[n + 1]):
            for j in range(i + 1, starts[n + 1]):
                if asked[directions[i], directions[j]] != 0:
                    widen(row, forces[i], forces[j], work, wants_margin)
                elif asked[directions[j], directions[i]] != 0:
                    widen(row, forces[j], forces[i], work, wants_margin)
