"""The test of simultaneous contacts: ends of features, gap rule, force closure, clamping (section 3).

The conditions are those of the model, widened by the contacts' error bounds, so that only contacts are
excluded that the later proofs would exclude too. Contacts that pass are written as records, in the layout of
the compiled kernels. The proofs, which both engines share, decide them.
"""

from __future__ import annotations

from math import pi

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.algebra.resultants import ArrayTable, Complex
from workhold.contact.problem import SearchFrame
from workhold.conventions import GAP_SLACK, LEAST_CLAMPING, LEAST_CLOSURE, LEAST_SPAN, RISES, ROW_SLACK
from workhold.kernels.base.feature import (
    AXIS_X,
    AXIS_Y,
    HALF_EXTENT,
    HIGH_SLACK,
    IS_ARC,
    LOW_SLACK,
    RADIUS,
    SEGMENT_LENGTH,
    X,
    Y,
)
from workhold.kernels.contact import record, rules
from workhold.statics.contact_matrix import compute_outward_normals

__all__ = ["SimultaneousContacts", "find_fourth_pegs", "make_records", "find_row_points"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

# Where a horizontal nearly touches a circle, the contact moves this much more than the orientation, at most.
STEEPEST = 1e6


@define(frozen=True, eq=False)
class SimultaneousContacts(ArrayTable):
    """N poses of the part at which all pegs touch it; lengths in mm.

    Parameters
    ----------
    standing : number of pegs on the fixed jaw; these are the first ones.
    feature, column, row : (N, 4), or (N, 3) before the fourth peg is found, see ``EquationSystems``.
    psi : (N,) orientation of the pegs in radians.
    reach : (N,) error bound of psi in radians, and of the centres as a fraction of the part's size.
    center : (N, 4) or (N, 3) peg centres in the workpiece's frame as complex numbers.
    """

    standing: int
    feature: IntArray
    column: IntArray
    row: IntArray
    psi: Array
    reach: Array
    center: Complex


def are_within_ends(rows: Array, center: Complex, margin: float, radius: Array) -> BoolArray:
    """Return whether contacts may be inside their features, ``margin`` mm from the ends (model: condition 1).

    This is not ``contact.features.measure_end_distances``: the algebra is a second opinion and evaluates the
    rules on its own. The last two columns of ``rows`` (..., 12) are the tolerances in mm past the low and the
    high end. Peg centres ``center`` (...) have the error bound ``radius`` in mm.
    """
    off = (center - rows[..., X] - 1j * rows[..., Y]) * (rows[..., AXIS_X] - 1j * rows[..., AXIS_Y])
    straight = rows[..., IS_ARC] == 0.0
    parameter = np.where(straight, off.real, np.angle(off))
    unit, half = np.where(straight, 1.0, rows[..., RADIUS]), rows[..., HALF_EXTENT]
    ends = (half - parameter) * unit + rows[..., HIGH_SLACK], (half + parameter) * unit + rows[..., LOW_SLACK]
    whole = ~straight & (half >= pi)
    return np.asarray(whole | (np.minimum(*ends) >= margin - 2.0 * radius))


def make_records(
    held: SimultaneousContacts, rows: Array, frame: SearchFrame, margin: float, length: float
) -> Array:
    """Return those simultaneous contacts that may be fixtures as
    records (M, 19), see ``kernels.contact.record``.

    See ``kernels.base.feature`` for the layout of rows.

    Parameters
    ----------
    held : with four pegs each.
    rows : (F, 12) features about the centre of the part, with the slack of their ends.
    margin : smallest distance in mm from a contact to the end of its feature.
    length : L of the wrenches in mm, half the part's size.
    """
    radius = 4.0 * length * held.reach
    inside = are_within_ends(rows[held.feature], held.center, margin, radius[:, None])
    held = held.take(np.asarray(inside.all(axis=1)))
    along = (held.center * np.exp(-1j * held.psi)[:, None]).real
    gap = along[:, held.standing :].min(axis=1, initial=np.inf) - along[:, : held.standing].max(
        axis=1, initial=-np.inf
    )
    clear = np.asarray(gap >= frame.gap - GAP_SLACK - 8.0 * length * held.reach)
    held, along = held.take(clear), along[clear]
    points = np.stack([held.center.real, held.center.imag], axis=-1)
    held_rows = rows[held.feature][..., :SEGMENT_LENGTH]
    good = may_close_and_clamp(
        held, held_rows, compute_outward_normals(held_rows, points), points, length, frame.toolkit.clamping
    )
    out = np.zeros((len(held.psi), record.RECORD_LENGTH))
    out[:, record.STANDING] = held.standing
    out[:, record.FEATURES : record.PSI] = np.hstack([held.feature, held.column, held.row])
    out[:, record.PSI] = held.psi
    out[:, record.TAIL_X : record.TAIL_Y + 1] = points[:, 0]
    out[:, record.SEPARATION] = along[:, held.standing] - along[:, 0]
    out[:, record.REACH] = held.reach
    out[:, record.LARGEST_RADIUS] = 4.0 * length * held.reach
    return np.asarray(out[good])


def may_close_and_clamp(
    held: SimultaneousContacts, held_rows: Array, normals: Array, points: Array, length: float, clamping: int
) -> BoolArray:
    """Return whether the forces may close and clamp (model: conditions 4 and 5), (N,).

    Normals on arcs of radius R are off by at most radius / R, and every minor by
    ``contact.rules.bound_minor_error``.

    Parameters
    ----------
    held_rows : (N, 4, 10) rows of the features touched.
    normals, points : (N, 4, 2) outward unit normals, and peg centres in mm.
    length : L in mm, by which moments are divided.
    clamping : 1 or -1, see ``Limits``.
    """
    radius = 4.0 * length * held.reach
    curvature = np.where(
        held_rows[..., IS_ARC] == 0.0,
        0.0,
        1.0 / np.where(held_rows[..., RADIUS] == 0.0, 1.0, held_rows[..., RADIUS]),
    )
    swing = radius * curvature.max(axis=1, initial=0.0)
    band = 20.0 * swing + 4.0 * radius / length + rules.ROUNDING
    minors = compute_wrench_minors(points, normals, length)
    minors = minors * np.where(minors.max(axis=1) >= -minors.min(axis=1), 1.0, -1.0)[:, None]
    size = np.abs(minors).sum(axis=1)
    facing = normals[..., 0] * np.cos(held.psi)[:, None] + normals[..., 1] * np.sin(held.psi)[:, None]
    clamp = -clamping * (minors * facing)[:, : held.standing].sum(axis=1)
    return np.asarray(
        (minors.min(axis=1) + band > LEAST_CLOSURE * (size - 4.0 * band))
        & (size + 4.0 * band > LEAST_SPAN)
        & (clamp + 4.0 * band + size * (swing + held.reach) > LEAST_CLAMPING * (size - 4.0 * band))
    )


def compute_wrench_minors(points: Array, normals: Array, length: float) -> Array:
    """Return null vectors (N, 4) of wrenches (n, (q - c) x n / L),
    not scaled: signed 3x3 minors (Cramer's rule).

    This is not ``kernels.contact.rules.write_minors``: the algebra is a second opinion and tests closure on
    its own. ``points`` (N, 4, 2) are peg centres about c in mm, ``normals`` (N, 4, 2) outward unit normals,
    ``length`` is L in mm, by which moments are divided.
    """
    moments = (points[..., 0] * normals[..., 1] - points[..., 1] * normals[..., 0]) / length
    out = np.empty(moments.shape)
    for k in range(4):
        a, b, c = (i for i in range(4) if i != k)
        minor = sum(
            sign * moments[:, i] * (normals[:, j, 0] * normals[:, m, 1] - normals[:, j, 1] * normals[:, m, 0])
            for sign, i, j, m in ((1.0, a, b, c), (-1.0, b, a, c), (1.0, c, a, b))
        )
        out[:, k] = (-1) ** k * np.asarray(minor)
    return out


def find_row_points(row: Array, psi: Array, height: Array) -> tuple[IntArray, Complex, Array]:
    """Return the points where a feature's whole line or circle meets horizontals of the frame.

    Parameters
    ----------
    row : the feature.
    psi : (N,) orientations of the pegs in radians.
    height : (N,) of the horizontals along the frame's y axis, in mm.

    Returns
    -------
    (indices (M,) of horizontals, points (M,) in the workpiece's frame as complex numbers, bounds (M,) of how
        much they move per change of height or psi)
    """
    z = np.exp(1j * psi)
    middle = (row[X] + 1j * row[Y]) / z
    rise = height - middle.imag
    if row[IS_ARC] == 0.0:
        tangent = (row[AXIS_X] + 1j * row[AXIS_Y]) / z
        index = np.flatnonzero(np.abs(tangent.imag) > RISES)
        along = rise[index] / tangent.imag[index]
        slope = np.minimum(3.0 / np.abs(tangent.imag[index]), STEEPEST)
        return index, (middle[index] + along * tangent[index]) * z[index], slope
    index = np.flatnonzero(np.abs(rise) < row[RADIUS])
    half = np.sqrt((row[RADIUS] - rise[index]) * (row[RADIUS] + rise[index]))
    both = [(middle[index] + sign * half + 1j * rise[index]) * z[index] for sign in (1.0, -1.0)]
    slope = np.minimum(3.0 * row[RADIUS] / np.maximum(half, row[RADIUS] / STEEPEST), STEEPEST)
    return np.concatenate([index, index]), np.concatenate(both), np.concatenate([slope, slope])


def find_fourth_pegs(
    triples: SimultaneousContacts, rows: Array, frame: SearchFrame, margin: float, length: float
) -> SimultaneousContacts:
    """Return every completion of triples of left pegs by a right peg in a row of holes that meets a feature
    (Type II, section 3.5).

    ``triples`` have three pegs each. Other parameters are those of :func:`make_records`.
    """
    radius = 4.0 * length * triples.reach
    inside = are_within_ends(rows[triples.feature], triples.center, margin, radius[:, None])
    triples = triples.take(np.asarray(inside.all(axis=1)))
    turn = np.exp(-1j * triples.psi)
    base = (triples.center[:, 0] * turn).imag + frame.lattice.row_offset
    found = []
    for e, row in enumerate(rows):
        middle = ((row[X] + 1j * row[Y]) * turn).imag - base
        tangent = ((row[AXIS_X] + 1j * row[AXIS_Y]) * turn).imag
        half = np.abs(row[HALF_EXTENT] * tangent) if row[IS_ARC] == 0.0 else np.full(len(middle), row[RADIUS])
        lowest = np.ceil((middle - half) / frame.lattice.pitch_y - ROW_SLACK).astype(np.int64)
        highest = np.floor((middle + half) / frame.lattice.pitch_y + ROW_SLACK).astype(np.int64)
        steps = np.arange(int((highest - lowest).max(initial=-1)) + 1)
        owner, step = np.nonzero(lowest[:, None] + steps <= highest[:, None])
        line = lowest[owner] + step
        index, point, slope = find_row_points(
            row, triples.psi[owner], base[owner] + line * frame.lattice.pitch_y
        )
        chosen, line = triples.take(owner[index]), line[index]
        found.append(
            SimultaneousContacts(
                3,
                np.column_stack([chosen.feature, np.full(len(index), e)]),
                np.column_stack([chosen.column, np.zeros(len(index), np.int64)]),
                np.column_stack([chosen.row, line]),
                chosen.psi,
                chosen.reach * slope,
                np.column_stack([chosen.center, point]),
            )
        )
    return SimultaneousContacts.concatenate(found)
