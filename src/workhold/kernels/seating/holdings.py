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
    HOLDING,
    KIND,
    LOW,
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
Held = tuple[float, float, float, float, float, float, float, float, float, float]

TURN = 2.0 * pi
# Cells into which a turn about a pocket is cut.
POCKET_CELLS = 16
# How far in mm a contact may lie past the end of its piece: rounding.
END = 1e-9
# mm. Rounding of a height, generously counted.
ROUNDING = 1e-9


@inner
def held(holding: Array, given: Given, psi: float) -> Held:
    """A holding at an orientation: place of its first peg on the part, outward normals of both contacts, instant centre, and
    place of its second peg."""
    if holding[KIND] == 1.0:
        x, y = holding[PIVOT_X], holding[PIVOT_Y]
        return (x, y, 0.0, 0.0, 0.0, 0.0, x, y, x, y)
    k = int(holding[SOURCE])
    a, b = given.rows[given.curves[k, TAIL]], given.rows[given.curves[k, HEAD]]
    alpha, d = psi + holding[ANGLE], given.reals[k, LENGTH]
    cosine, sine = cos(alpha), sin(alpha)
    s = chord_state(a, b, given.reals[k], alpha, cosine, sine)
    normals = (a[SIGN] * s[2], a[SIGN] * s[3], b[SIGN] * s[4], b[SIGN] * s[5])
    return (s[0], s[1], *normals, s[6], s[7], s[0] + d * cosine, s[1] + d * sine)


@inner
def is_on_its_pieces(holding: Array, given: Given, psi: float, x: float, y: float) -> bool:
    """Whether the contacts of a holding lie on their pieces, the first at (x, y); curves go on past the ends by a hair."""
    if holding[KIND] == 1.0:
        return True
    k = int(holding[SOURCE])
    alpha, d = psi + holding[ANGLE], given.reals[k, LENGTH]
    return on_piece(given.rows[given.curves[k, TAIL]], x, y, END) and on_piece(
        given.rows[given.curves[k, HEAD]], x + d * cos(alpha), y + d * sin(alpha), END
    )


@inner
def height(holding: Array, given: Given, x: float, y: float, cosine: float, sine: float) -> float:
    """y of the place of the first peg on the part less the peg's own: one number for all pegs that hold one part."""
    return cosine * y - sine * x - given.pegs[int(holding[FIRST_PEG]), 1]


@inner
def write_cell(cell: Array, number: int, low: float, high: float, speed: float, given: Given) -> None:
    """Write the cell of a holding over [low, high], with bounds of its height: h' = -x . P, h'' = -y . P - x . P'."""
    holding = given.holdings[number]
    middle, reach = (low + high) / 2.0, (high - low) / 2.0
    cosine, sine = cos(middle), sin(middle)
    s = held(holding, given, middle)
    value = height(holding, given, s[0], s[1], cosine, sine)
    vague = not speed < inf
    if vague:
        # Too short a range, beside a tangency, for the height to leave its ends by more than they are apart.
        spread = 1e-6
        for end in (low, high):
            t = held(holding, given, end)
            spread = max(spread, 2.0 * abs(height(holding, given, t[0], t[1], cos(end), sin(end)) - value))
    else:
        bend = hypot(s[6], s[7]) + speed * (1.0 + reach)
        spread = reach * (abs(cosine * s[6] + sine * s[7]) + reach * bend) + ROUNDING
    turns = floor(low / TURN) * TURN
    cell[LOW], cell[HIGH], cell[SPEED] = low - turns, high - turns, speed
    cell[BOTTOM], cell[TOP] = value - spread, value + spread
    cell[HOLDING], cell[VAGUE] = number, 1.0 if vague else 0.0


@compiled
def make_cells(given: Given, stretches: Array, cells: Array) -> int:
    """Cut all holdings into cells; return how many, or -1 where they do not fit into ``cells``.

    Parameters
    ----------
    stretches : (S, 13) of the curves, see ``chord.stretches``.
    """
    count = 0
    for number in range(given.holdings.shape[0]):
        holding = given.holdings[number]
        if holding[KIND] == 1.0:
            for k in range(POCKET_CELLS):
                if count >= cells.shape[0]:
                    return -1
                write_cell(cells[count], number, k * TURN / POCKET_CELLS, (k + 1) * TURN / POCKET_CELLS, 0.0, given)
                count += 1
            continue
        curve = int(holding[SOURCE])
        low = given.reals[curve, FROM] - holding[ANGLE]
        s = given.curves[curve, FIRST_STRETCH]
        while s < given.curves[curve, END_STRETCH]:
            parts = int(stretches[s, PARTS])
            first = s if parts == 0 else s + 1
            last = first + max(parts, 1)
            for k in range(first, last):
                if count >= cells.shape[0]:
                    return -1
                high = stretches[k, STRETCH_HIGH] - holding[ANGLE]
                write_cell(cells[count], number, low, high, stretches[k, STRETCH_SPEED], given)
                count += 1
                low = high
            s = last
    return count
