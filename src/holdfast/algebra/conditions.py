"""From simultaneous contacts to fixtures: ends of features, jaws apart, force closure, clamping (paper, section 3, test).

The conditions are those of the model; each is one line of array arithmetic. What passes is written as records, in the
layout of the compiled kernels, for the closing steps that both engines share.
"""

from __future__ import annotations

from math import pi

import numpy as np
from attrs import define
from numpy.typing import NDArray

from holdfast.algebra.constraints import Complex
from holdfast.kernels import vise_checks as record
from holdfast.model.vise import Vise
from holdfast.statics.wrenches import outward_normals

__all__ = ["Held", "fourth_pegs", "joined", "records_of", "row_points"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

# Rows this near, in pitches, to the reach of a feature are looked at.
ROUNDING = 1e-9
# A double root carries no clamping force, or its wrenches do not span, and it is never a fixture. It can be met only to the
# square root of rounding, and so shows up with a force, or with minors, of some 1e-8; the model calls anything within 1e-6
# of a rule's edge marginal.
DOUBLE = 1e-7


@define(frozen=True, eq=False)
class Held:
    """N parts touched by four pegs, lengths in mm.

    Parameters
    ----------
    lefts : how many pegs, the first ones, are on the left jaw.
    feature, column, row : (N, 4), see ``Systems``.
    psi : (N,) orientation of the pegs in radians.
    center : (N, 4) peg centres in the workpiece's frame as complex numbers.
    """

    lefts: int
    feature: IntArray
    column: IntArray
    row: IntArray
    psi: Array
    center: Complex

    def take(self, which: BoolArray | IntArray) -> Held:
        """The parts of an index array or mask."""
        return Held(
            self.lefts, self.feature[which], self.column[which], self.row[which], self.psi[which], self.center[which]
        )


def within_ends(rows: Array, center: Complex, margin: float) -> BoolArray:
    """Whether contacts are inside their features, ``margin`` mm from the ends (model: condition 1).

    Parameters
    ----------
    rows : (..., 10) feature rows, the last two entries how far in mm a contact may lie past the low and the high end.
    center : (...) peg centres.
    """
    off = (center - rows[..., 1] - 1j * rows[..., 2]) * (rows[..., 3] - 1j * rows[..., 4])
    straight = rows[..., 0] == 0.0
    parameter = np.where(straight, off.real, np.angle(off))
    inside = (rows[..., 5] - np.abs(parameter)) * np.where(straight, 1.0, rows[..., 6])
    whole = ~straight & (rows[..., 5] >= pi)
    return np.asarray(whole | (inside >= margin - np.where(parameter > 0.0, rows[..., 9], rows[..., 8])))


def closure(points: Array, normals: Array, length: float) -> Array:
    """Null vectors (N, 4) of the wrenches scaled to sum 1, NaN where they do not span (model: condition 4)."""
    moments = (points[..., 0] * normals[..., 1] - points[..., 1] * normals[..., 0]) / length
    wrenches = np.concatenate([normals, moments[..., None]], axis=-1)
    minors = [(-1) ** k * np.linalg.det(np.delete(wrenches, k, axis=1)) for k in range(4)]
    null = np.stack(minors, axis=1)
    total = null.sum(axis=1, keepdims=True)
    none = np.abs(total) <= DOUBLE
    return np.asarray(np.where(none, np.nan, null / np.where(none, 1.0, total)))


def records_of(held: Held, rows: Array, vise: Vise, margin: float, length: float) -> Array:
    """The fixtures among parts touched by four pegs, as records (M, 21).

    Parameters
    ----------
    rows : (F, 10) features about the centre of the part with the slack of their ends.
    margin : smallest distance in mm from a contact to the end of its feature.
    length : L of the wrenches in mm.
    """
    inside = within_ends(rows[held.feature], held.center, margin)
    held = held.take(np.asarray(inside.all(axis=1)))
    along = (held.center * np.exp(-1j * held.psi)[:, None]).real
    gap = along[:, held.lefts :].min(axis=1, initial=np.inf) - along[:, : held.lefts].max(axis=1, initial=-np.inf)
    apart = np.asarray(gap >= vise.min_gap - record.GAP_SLACK)
    held, along = held.take(apart), along[apart]
    points = np.stack([held.center.real, held.center.imag], axis=-1)
    normals = outward_normals(rows[held.feature][..., :8], points)
    null = closure(points, normals, length)
    facing = normals[..., 0] * np.cos(held.psi)[:, None] + normals[..., 1] * np.sin(held.psi)[:, None]
    clamp = -(null * facing)[:, : held.lefts].sum(axis=1)
    good = (null.min(axis=1) > record.LEAST_CLOSURE) & (clamp > DOUBLE)
    out = np.zeros((len(held.psi), record.RECORD_LENGTH))
    out[:, record.KIND] = 1.0 if held.lefts == 2 else 2.0
    out[:, record.FEATURES : record.FEATURES + 4] = held.feature
    out[:, record.COLUMNS : record.COLUMNS + 4] = held.column
    out[:, record.ROWS : record.ROWS + 4] = held.row
    out[:, record.PSI] = held.psi
    out[:, record.TAIL_X : record.TAIL_Y + 1] = points[:, 0]
    out[:, record.APART] = along[:, held.lefts] - along[:, 0]
    out[:, record.NULL : record.NULL + 4] = null
    return np.asarray(out[good])


def row_points(row: Array, psi: Array, height: Array) -> tuple[IntArray, Complex]:
    """Where a feature's line or circle meets horizontals of the vise.

    Parameters
    ----------
    row : (8,) feature row.
    psi, height : (N,) orientation of the pegs in radians, and height along the vise's y axis in mm.

    Returns
    -------
    (indices of horizontals, points in the workpiece's frame)
    """
    z = np.exp(1j * psi)
    middle = (row[1] + 1j * row[2]) / z
    rise = height - middle.imag
    if row[0] == 0.0:
        tangent = (row[3] + 1j * row[4]) / z
        index = np.flatnonzero(np.abs(tangent.imag) > 1e-12)
        along = rise[index] / tangent.imag[index]
        return index, (middle[index] + along * tangent[index]) * z[index]
    index = np.flatnonzero(np.abs(rise) < row[6])
    half = np.sqrt((row[6] - rise[index]) * (row[6] + rise[index]))
    both = [(middle[index] + sign * half + 1j * rise[index]) * z[index] for sign in (1.0, -1.0)]
    return np.concatenate([index, index]), np.concatenate(both)


def fourth_pegs(triples: Held, rows: Array, vise: Vise, margin: float) -> Held:
    """Type II: the fourth pegs on rows that overlap the transformed fourth features (section 3.5).

    Parameters
    ----------
    triples : three left pegs each, ``center`` and the others of shape (N, 3).
    rows, margin : see :func:`records_of`.
    """
    inside = within_ends(rows[triples.feature], triples.center, margin)
    triples = triples.take(np.asarray(inside.all(axis=1)))
    turn = np.exp(-1j * triples.psi)
    base = (triples.center[:, 0] * turn).imag + vise.row_offset
    found = []
    for e, row in enumerate(rows):
        middle = ((row[1] + 1j * row[2]) * turn).imag - base
        tangent = ((row[3] + 1j * row[4]) * turn).imag
        half = np.abs(row[5] * tangent) if row[0] == 0.0 else np.full(len(middle), row[6])
        lowest = np.ceil((middle - half) / vise.pitch[1] - ROUNDING).astype(np.int64)
        highest = np.floor((middle + half) / vise.pitch[1] + ROUNDING).astype(np.int64)
        steps = np.arange(int((highest - lowest).max(initial=-1)) + 1)
        owner, step = np.nonzero(lowest[:, None] + steps <= highest[:, None])
        line = lowest[owner] + step
        index, point = row_points(row, triples.psi[owner], base[owner] + line * vise.pitch[1])
        chosen, line = triples.take(owner[index]), line[index]
        found.append(
            Held(
                3,
                np.column_stack([chosen.feature, np.full(len(index), e)]),
                np.column_stack([chosen.column, np.zeros(len(index), np.int64)]),
                np.column_stack([chosen.row, line]),
                chosen.psi,
                np.column_stack([chosen.center, point]),
            )
        )
    return joined(found)


def joined(parts: list[Held]) -> Held:
    """Several sets, at least one, as one."""
    names = ("feature", "column", "row", "psi", "center")
    return Held(parts[0].lefts, *(np.concatenate([getattr(p, name) for p in parts]) for name in names))
