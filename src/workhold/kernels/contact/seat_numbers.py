"""Numbers by which contacts of three locators are grouped by seat, whatever the direction of the clamp.

The holes of the locators become one number of 64 bits: that two triples agree only puts them together. The
place of the part beside the holes becomes one number, too.
"""

from __future__ import annotations

from math import cos, pi, sin

from workhold.kernels.base.compiling import Array, IntArray, compiled
from workhold.kernels.contact.record import COLUMNS, PSI, ROWS, TAIL_X, TAIL_Y

__all__ = ["ASIDE", "numbers_of_seats"]


# What mixes two coordinates to one number.
ASIDE = 0.7548776662
# Odd numbers that mix the holes of three locators; of products the last 64 bits count.
COLUMN_STEP = -7046029254386353131
FIRST, SECOND, THIRD = -4658895280553007687, -7723592293110705685, -2960836687051489901


@compiled
def numbers_of_seats(
    records: Array, turn: Array, pitch: Array, start: float, holes: IntArray, theta: Array, places: Array
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
