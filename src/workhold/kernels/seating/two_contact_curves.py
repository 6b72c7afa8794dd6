"""Two contacts of one jaw over the orientation: places, instant centres, and cells over which both are bounded."""

from __future__ import annotations

from math import cos, floor, hypot, inf, pi, sin

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.compiling import compiled, inner
from workhold.kernels.base.feature import SIGN
from workhold.kernels.chord.evaluation import chord_state
from workhold.kernels.chord.stretches import PARTS, STRETCH_HIGH
from workhold.kernels.chord.stretches import SPEED as STRETCH_SPEED
from workhold.kernels.curves.columns import END_STRETCH, FIRST_STRETCH, FROM, HEAD, LENGTH, TAIL
from workhold.kernels.seating.columns import (
    ANGLE,
    BOTTOM,
    FIRST_PEG,
    HIGH,
    KIND,
    LOW,
    PAIR,
    PIVOT_X,
    PIVOT_Y,
    SOURCE,
    SPEED,
    TOP,
    VAGUE,
    Given,
)
from workhold.kernels.seating.pieces import on_piece

Array = NDArray[np.float64]
PairState = tuple[float, float, float, float, float, float, float, float, float, float]

TURN = 2.0 * pi
# Cells into which a turn about a pocket is cut.
POCKET_CELLS = 16
# How far in mm a contact may lie past the end of its piece: rounding.
END = 1e-9
# mm. Rounding of a height, generously counted.
ROUNDING = 1e-9


@inner
def pair_at(pair: Array, given: Given, psi: float) -> PairState:
    """A pair at an orientation: places, outward normals and instant centre.

    They are the place of its first peg on the part, the normals of both contacts, the centre, and the place
    of the second peg.
    """
    if pair[KIND] == 1.0:
        x, y = pair[PIVOT_X], pair[PIVOT_Y]
        return (x, y, 0.0, 0.0, 0.0, 0.0, x, y, x, y)
    k = int(pair[SOURCE])
    a, b = given.rows[given.curves[k, TAIL]], given.rows[given.curves[k, HEAD]]
    alpha, d = psi + pair[ANGLE], given.reals[k, LENGTH]
    cosine, sine = cos(alpha), sin(alpha)
    s = chord_state(a, b, given.reals[k], alpha, cosine, sine)
    normals = (a[SIGN] * s[2], a[SIGN] * s[3], b[SIGN] * s[4], b[SIGN] * s[5])
    return (s[0], s[1], *normals, s[6], s[7], s[0] + d * cosine, s[1] + d * sine)


@inner
def is_on_its_pieces(pair: Array, given: Given, psi: float, x: float, y: float) -> bool:
    """Whether the contacts of a pair, the first at (x, y), lie on their pieces, past whose ends curves go."""
    if pair[KIND] == 1.0:
        return True
    k = int(pair[SOURCE])
    alpha, d = psi + pair[ANGLE], given.reals[k, LENGTH]
    return on_piece(given.rows[given.curves[k, TAIL]], x, y, END) and on_piece(
        given.rows[given.curves[k, HEAD]], x + d * cos(alpha), y + d * sin(alpha), END
    )


@inner
def height(pair: Array, given: Given, x: float, y: float, cosine: float, sine: float) -> float:
    """The height of the first peg's place on the part less the peg's own.

    It is one number for all pegs that hold one part.
    """
    return cosine * y - sine * x - given.pegs[int(pair[FIRST_PEG]), 1]


@inner
def write_cell(cell: Array, number: int, low: float, high: float, speed: float, given: Given) -> None:
    """Writes the cell of a pair over [low, high], with bounds of its height.

    The height's derivatives are h' = -x . P and h'' = -y . P - x . P'.
    """
    pair = given.pairs[number]
    middle, reach = (low + high) / 2.0, (high - low) / 2.0
    cosine, sine = cos(middle), sin(middle)
    s = pair_at(pair, given, middle)
    value = height(pair, given, s[0], s[1], cosine, sine)
    vague = not speed < inf
    if vague:
        # Too short a range, beside a tangency, for the height to leave its ends by more than they are apart.
        spread = 1e-6
        for end in (low, high):
            t = pair_at(pair, given, end)
            spread = max(spread, 2.0 * abs(height(pair, given, t[0], t[1], cos(end), sin(end)) - value))
    else:
        bend = hypot(s[6], s[7]) + speed * (1.0 + reach)
        spread = reach * (abs(cosine * s[6] + sine * s[7]) + reach * bend) + ROUNDING
    turns = floor(low / TURN) * TURN
    cell[LOW], cell[HIGH], cell[SPEED] = low - turns, high - turns, speed
    cell[BOTTOM], cell[TOP] = value - spread, value + spread
    cell[PAIR], cell[VAGUE] = number, 1.0 if vague else 0.0


@compiled
def make_cells(given: Given, stretches: Array, cells: Array) -> int:
    """Cuts all pairs into cells; returns how many, or -1 where they do not fit into ``cells``.

    Parameters
    ----------
    stretches : (S, 13) of the curves, see ``chord.stretches``.
    """
    count = 0
    for number in range(given.pairs.shape[0]):
        pair = given.pairs[number]
        if pair[KIND] == 1.0:
            for k in range(POCKET_CELLS):
                if count >= cells.shape[0]:
                    return -1
                write_cell(cells[count], number, k * TURN / POCKET_CELLS, (k + 1) * TURN / POCKET_CELLS, 0.0, given)
                count += 1
            continue
        curve = int(pair[SOURCE])
        low = given.reals[curve, FROM] - pair[ANGLE]
        s = given.curves[curve, FIRST_STRETCH]
        while s < given.curves[curve, END_STRETCH]:
            parts = int(stretches[s, PARTS])
            first = s if parts == 0 else s + 1
            last = first + max(parts, 1)
            for k in range(first, last):
                if count >= cells.shape[0]:
                    return -1
                high = stretches[k, STRETCH_HIGH] - pair[ANGLE]
                write_cell(cells[count], number, low, high, stretches[k, STRETCH_SPEED], given)
                count += 1
                low = high
            s = last
    return count
