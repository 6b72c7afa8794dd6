"""The middle of each cell of a pair of contacts, computed once for all that may press against the pair.

Columns of a middle: COSINE and SINE of the orientation, ten numbers from HELD on
(``two_contact_curves.PairState``), and seven from RAY on (``two_contact_curves.Ray``). The last stand for
nothing in a cell of a pocket or beside a tangency.
"""

from __future__ import annotations

from math import cos, inf, sin

from workhold.kernels.base.compiling import Array, compiled, inner
from workhold.kernels.base.tables import HEAD, TAIL
from workhold.kernels.seating.columns import HIGH, KIND, LOW, PAIR, SOURCE, SPEED, VAGUE, Given
from workhold.kernels.seating.two_contact_curves import PairState, Ray, pair_at, ray_of

COSINE, SINE, HELD, RAY = 0, 1, 2, 12
MIDDLE_LENGTH = 19


@inner
def ray_over(pair: Array, given: Given, s: PairState, speed: float, reach: float) -> Ray:
    """The ray of a pair of two contacts; see ``two_contact_curves.ray_of``."""
    k = int(pair[SOURCE])
    a, b = given.rows[given.curves[k, TAIL]], given.rows[given.curves[k, HEAD]]
    return ray_of(given.reals[k], a, b, s, speed, reach)


@compiled
def write_middles(cells: Array, given: Given, out: Array) -> None:
    """Writes the middles (C, 19) of cells (C, 7)."""
    for number in range(cells.shape[0]):
        cell, row = cells[number], out[number]
        pair = given.pairs[int(cell[PAIR])]
        psi, reach = (cell[LOW] + cell[HIGH]) / 2.0, (cell[HIGH] - cell[LOW]) / 2.0
        s, ray = pair_at(pair, given, psi), (0.0, inf, 0.0, 0.0, 0.0, 0.0, 0.0)
        if pair[KIND] == 0.0 and cell[VAGUE] == 0.0:
            ray = ray_over(pair, given, s, cell[SPEED], reach)
        row[COSINE], row[SINE] = cos(psi), sin(psi)
        for k in range(10):
            row[HELD + k] = s[k]
        for k in range(7):
            row[RAY + k] = ray[k]


@inner
def pair_in(middle: Array) -> PairState:
    """The pair in the middle of a cell."""
    h = middle[HELD:RAY]
    return (h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], h[8], h[9])


@inner
def ray_in(middle: Array) -> Ray:
    """The ray over a cell."""
    r = middle[RAY:]
    return (r[0], r[1], r[2], r[3], r[4], r[5], r[6])
