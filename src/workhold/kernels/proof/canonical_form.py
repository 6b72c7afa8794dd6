"""Proven contacts as fixtures: their places and forces, and the one form in which each fixture is listed."""

from __future__ import annotations

from math import pi

from workhold.conventions import LEAST_SPAN
from workhold.kernels.base.compiling import (
    IntArray,
    IntMatrix,
    IntVector,
    Matrix,
    Stack,
    Vector,
    compiled,
    inner,
)
from workhold.kernels.base.tables import Setting
from workhold.kernels.contact.record import NULL, read_record, write_contact_equations
from workhold.kernels.proof.newton_kantorovich import compute_clamping, write_wrenches


@compiled
def write_contacts(
    records: Matrix,
    rows: Matrix,
    setting: Setting,
    points: Stack,
    gaps: Vector,
    nulls: Matrix,
    forces: Matrix,
    w: Matrix,
    pairs: Stack,
) -> None:
    """Write the peg centres, gap, null vector and peg forces of each record.

    See ``base.feature`` for the layout of ``rows``.

    Parameters
    ----------
    records : (N, 19), see ``kernels.contact.record``.
    rows : (F, 12) of the features.
    points : (N, 4, 2) receives the pegs' centres in the workpiece's frame, in mm.
    gaps : (N,) receives the x distance in mm from the rightmost standing to the leftmost moving peg.
    nulls : (N, 4) receives the null vectors divided by the sum of their absolute values, with a sum that is
        not negative; all -1 where the wrenches do not span the space.
    forces : (N, 4) receives the peg forces per unit of clamping force.
    w, pairs : (19, 4) and (2, 4, 2) work space, see ``contact.record``.
    """
    length, null = setting.limits.wrench_length, w[NULL]
    for n in range(records.shape[0]):
        read_record(records[n], setting.lattice, w)
        write_contact_equations(records[n], rows, length, w, pairs[0])
        write_wrenches(records[n], rows, length, w, pairs)
        total = null[0] + null[1] + null[2] + null[3]
        size = abs(null[0]) + abs(null[1]) + abs(null[2]) + abs(null[3])
        sign = 1.0 if total >= 0.0 else -1.0
        for k in range(4):
            null[k] = sign * null[k] / size if size > LEAST_SPAN else -1.0
        gaps[n], push = compute_clamping(w, pairs)
        push *= setting.limits.clamping
        for k in range(4):
            points[n, k, 0], points[n, k, 1] = pairs[0, k, 0], pairs[0, k, 1]
            nulls[n, k], forces[n, k] = null[k], null[k] / push


@compiled
def to_canonical_form(
    standing: IntVector,
    theta: Vector,
    columns: IntMatrix,
    rows: IntMatrix,
    orders: IntMatrix,
    swapped: int,
    hair: float,
) -> None:
    """Bring fixtures to the form in which they are listed; change
    ``theta``, ``columns`` and ``rows`` in place.

    Orientations are brought to [0, 2 pi), or to [0, pi) where a half turn that swaps the carriers leaves the
    arrangement as it is, each to within ``hair``. Columns are counted from the leftmost peg of each carrier,
    rows from the lowest peg of all. Pegs of a carrier are sorted by column, then row.

    Parameters
    ----------
    standing : (N,) how many of the four pegs, the first ones, are on the carrier that stands still.
    theta : (N,) orientation of the workpiece in radians.
    columns, rows : (N, 4) lattice places of the pegs.
    orders : (N, 4) receives the former index of the peg that is now at each place.
    swapped : number of pegs on each carrier of the arrangement that a half turn, which swaps the carriers,
        leaves as it is; 0 where there is no such arrangement.
    hair : orientations that differ by less than this, in radians, count as equal.
    """
    for n in range(len(standing)):
        angle = (theta[n] + hair) % (2.0 * pi) - hair
        # Everything turned half way round: the carriers swap, rows and columns run the other way.
        turned = standing[n] == swapped and angle >= pi - hair
        theta[n] = angle - pi if turned else angle
        order, column, row = orders[n], columns[n], rows[n]
        for k in range(4):
            order[k] = 3 - k if turned else k
            if turned:
                column[k], row[k] = -column[k], -row[k]
        lowest = min(min(row[0], row[1]), min(row[2], row[3]))
        for carrier in range(2):
            first, last = (0, standing[n]) if carrier == 0 else (standing[n], 4)
            base = column[order[first]]
            for k in range(first, last):
                base = min(base, column[order[k]])
            for k in range(first, last):
                column[order[k]] -= base
                row[order[k]] -= lowest
            for k in range(first + 1, last):
                m = k
                while m > first and comes_before(column, row, order[m], order[m - 1]):
                    order[m - 1], order[m] = order[m], order[m - 1]
                    m -= 1
        a, b, c, d = order[0], order[1], order[2], order[3]
        column[0], column[1], column[2], column[3] = column[a], column[b], column[c], column[d]
        row[0], row[1], row[2], row[3] = row[a], row[b], row[c], row[d]


@inner
def comes_before(column: IntArray, row: IntArray, one: int, other: int) -> bool:
    """Return whether peg ``one`` comes before peg ``other`` in the order of column, then row."""
    return column[one] < column[other] or (column[one] == column[other] and row[one] < row[other])
