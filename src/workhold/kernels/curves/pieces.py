"""Pieces: chord curves cut to a cell of orientations, with what is needed to bound them.

Glossary
--------
cell : a closed range of orientations psi; the work is shared out by cells.
piece : a chord curve over a range inside one cell and inside one stretch. It has value and derivative at both
    ends and an enclosure of its second derivative. From these follow enclosures of its value, of the place of
    its pegs along x, and of the directions in which they can push together.

What encloses a piece stands in ``curves.piece_enclosures``, and columns in ``base.tables``.
"""

from __future__ import annotations

from math import cos, floor, inf, isfinite, pi, sin
from typing import NamedTuple

import numpy as np

from workhold.kernels.base.compiling import Array, IntArray, inner
from workhold.kernels.base.feature import HALF_EXTENT, IS_ARC, compute_local_size
from workhold.kernels.base.interval import TURN
from workhold.kernels.base.tables import (
    COLUMN_STEP,
    CURVE,
    EDGE_LENGTH,
    EDGE_SLOPE,
    EDGE_SLOPE_ERROR,
    EDGE_VALUE,
    EDGE_VALUE_ERROR,
    END_STRETCH,
    FIRST_STRETCH,
    FROM,
    HEAD,
    HIGH,
    LENGTH,
    LOW,
    SHIFT,
    SLOPE_ERROR_HIGH,
    SLOPE_ERROR_LOW,
    SLOPE_HIGH,
    SLOPE_LOW,
    TAIL,
    TANGENT_FROM,
    TANGENT_TO,
    TO,
    VALUE_ERROR_HIGH,
    VALUE_ERROR_LOW,
    VALUE_HIGH,
    VALUE_LOW,
    X_MOVING,
    X_STANDING,
    Curves,
)
from workhold.kernels.chord.evaluation import POSITION, evaluate_curve
from workhold.kernels.chord.stretches import (
    PARTS,
    SPEED,
    STRETCH_HIGH,
)
from workhold.kernels.curves.piece_bounds import is_farther, write_edge
from workhold.kernels.curves.piece_enclosures import (
    enclose_second_derivative_beside,
    write_beside,
    write_steady,
)


class PieceCell(NamedTuple):
    """A cell to cut curves to, with the cosine and the sine of its high end, where most pieces in it end.

    Parameters
    ----------
    low, high : psi in radians.
    pitch_x : column pitch in mm.
    share : see ``piece_bounds.find_shared_force_range``.
    mode : ``HEIGHT`` or ``POSITION``, the value of the curves.
    farthest : pieces whose rightmost peg stands farther right than this, in mm, may be left out.
    edges : (2, 14) work space.
    """

    low: float
    high: float
    cosine: float
    sine: float
    pitch_x: float
    share: float
    mode: float
    farthest: float
    edges: Array


@inner
def unwrap_angle(value: float, near: float) -> float:
    """Return the angle ``value`` + 2 pi k, with whole k, that is nearest to the angle ``near``, in
    radians."""
    return value + TURN * floor((near - value) / TURN + 0.5)


@inner
def add_pieces(
    out: Array,
    count: int,
    features: Array,
    curves: Curves,
    index: int,
    low: float,
    high: float,
    base: float,
    cell: PieceCell,
    kept: Array,
) -> int:
    """Append the pieces of one curve over [low, high] to ``out`` (P, 24); return the new number of pieces.

    ``out`` must have room for one piece for each stretch of the curve. See ``base.feature`` for the layout of
    ``features``, ``piece_bounds.clear_edges`` for that of ``kept``.

    Parameters
    ----------
    count : number of pieces in ``out`` so far.
    index : of the curve.
    low, high : psi in radians, inside the curve's range and inside the cell.
    base : psi at the low end of the curve's range.
    kept : (15,) the last edge that was written of the curve, then its psi: a cell begins where the one before
        it ends. Updated in place.
    """
    integers, stretches, curve = curves.integers, curves.stretches, curves.reals[index]
    a, b = features[integers[index, TAIL]], features[integers[index, HEAD]]
    mode, farthest = cell.mode, cell.farthest
    circles = mode == POSITION and a[IS_ARC] != 0.0 and a[HALF_EXTENT] >= pi
    step = integers[index, COLUMN_STEP] * cell.pitch_x
    span = curve[TO] - curve[FROM]
    # No tail is farther from the centre of the part than this.
    size = compute_local_size(a) + a[HALF_EXTENT]
    at_low, at_high = cell.edges[0], cell.edges[1]
    for n in range(EDGE_LENGTH):
        at_low[n] = kept[n]
    # Where the edge in ``at_low`` is, where the piece begins, and where the stretch does.
    at, left, begin = kept[EDGE_LENGTH], low, base
    for k in range(integers[index, FIRST_STRETCH], integers[index, END_STRETCH]):
        stretch = stretches[k]
        end = base + (stretch[STRETCH_HIGH] - curve[FROM])
        last = stretch[STRETCH_HIGH] >= curve[TO]
        if end <= left and not last:
            begin = end
            continue
        right = high if last else min(end, high)
        if right <= left:
            continue
        if stretch[PARTS] > 0.0:
            # Where the whole stretch shows no sign of the second derivative, its parts, which follow, do.
            second_derivatives = enclose_second_derivative_beside(
                stretch, a, curve[LENGTH], size, left, right, mode
            )
            if second_derivatives[0] < 0.0 < second_derivatives[1]:
                continue
        tangent_low = curve[TANGENT_FROM] if left <= base else 0.0
        tangent_high = curve[TANGENT_TO] if right >= base + span else 0.0
        steady = stretch[SPEED] < inf and tangent_low == 0.0 and tangent_high == 0.0
        skipped = False
        if steady and farthest < inf:
            least = farthest - max(step, 0.0)
            skipped = begin <= at and is_farther(at_low, at, right, stretch[SPEED], least)
            if not skipped and at != left:
                write_edge(at_low, a, b, curve, left, cos(left), sin(left), mode)
                at = left
                skipped = is_farther(at_low, at, right, stretch[SPEED], least)
        if not skipped:
            if at != left:
                write_edge(at_low, a, b, curve, left, cos(left), sin(left), mode)
            cosine, sine = (cell.cosine, cell.sine) if right == cell.high else (cos(right), sin(right))
            write_edge(at_high, a, b, curve, right, cosine, sine, mode)
            row = out[count]
            count += 1
            row[LOW], row[HIGH], row[CURVE] = left, right, index
            row[VALUE_LOW], row[SLOPE_LOW] = at_low[EDGE_VALUE], at_low[EDGE_SLOPE]
            row[VALUE_HIGH], row[SLOPE_HIGH] = at_high[EDGE_VALUE], at_high[EDGE_SLOPE]
            row[VALUE_ERROR_LOW], row[SLOPE_ERROR_LOW] = at_low[EDGE_VALUE_ERROR], at_low[EDGE_SLOPE_ERROR]
            row[VALUE_ERROR_HIGH] = at_high[EDGE_VALUE_ERROR]
            row[SLOPE_ERROR_HIGH] = at_high[EDGE_SLOPE_ERROR]
            steady = steady and isfinite(row[SLOPE_ERROR_LOW]) and isfinite(row[SLOPE_ERROR_HIGH])
            if circles and steady:
                unwind_positions(row, a, b, curve)
            if steady:
                write_steady(row, a, curve, at_low, at_high, stretch, right - left, cell.share, mode)
            else:
                write_beside(row, a, b, curve, stretch, tangent_low, tangent_high, mode)
                if circles:
                    unwind_positions(row, a, b, curve)
            row[X_STANDING] += max(step, 0.0)
            row[X_MOVING] += min(step, 0.0)
            for n in range(EDGE_LENGTH):
                at_low[n] = at_high[n]
            at = right
        left = right
        if right >= high:
            break
    for n in range(EDGE_LENGTH):
        kept[n] = at_low[n]
    kept[EDGE_LENGTH] = at
    return count


@inner
def unwind_positions(row: Array, a: Array, b: Array, curve: Array) -> None:
    """Shift the positions at both ends of a piece on a whole circle in place by whole turns, to join those in
    between.

    Where a position is at the circle's seam, its parameter may be a turn off. See ``base.tables`` for the
    layout of ``row`` and ``curve``, ``base.feature`` for that of ``a`` and ``b``.
    """
    width = row[HIGH] - row[LOW]
    for k in range(2):
        psi = row[LOW] + width / 64.0 if k == 0 else row[HIGH] - width / 64.0
        middle = evaluate_curve(a, b, curve, psi, POSITION).value
        column = VALUE_LOW if k == 0 else VALUE_HIGH
        row[column] = unwrap_angle(row[column], middle)


@inner
def add_members(
    out: Array,
    count: int,
    members: IntArray,
    features: Array,
    curves: Curves,
    cell: PieceCell,
    kept: Array,
) -> int:
    """Append the pieces of the curves ``members`` inside a cell to ``out`` (P, 24).

    Return the new number of pieces, or -1 when there may not be room for all pieces of one curve. ``kept``
    (M, 15) is described at ``piece_bounds.clear_edges``. See ``base.feature`` for the layout of ``features``.
    """
    integers, reals = curves.integers, curves.reals
    for n in range(members.shape[0]):
        index = members[n]
        # A curve of nearly a turn may enter the cell at both of its ends.
        if count + 2 * (integers[index, END_STRETCH] - integers[index, FIRST_STRETCH]) > out.shape[0]:
            return -1
        base = reals[index, FROM] - reals[index, SHIFT]
        span = reals[index, TO] - reals[index, FROM]
        start = base + TURN * floor((cell.low - base) / TURN)
        for lap in range(2):
            low = start + lap * TURN
            left, right = max(low, cell.low), min(low + span, cell.high)
            if right - left > 0.0:
                count = add_pieces(out, count, features, curves, index, left, right, low, cell, kept[n])
    return count


@inner
def write_pieces(
    cell_low: float,
    cell_high: float,
    members: IntArray,
    features: Array,
    curves: Curves,
    pitch_x: float,
    least_margin: float,
    mode: float,
    farthest: float,
    kept: Array,
    edges: Array,
    out: Array,
) -> int:
    """Write the pieces of curves inside one cell to ``out``; return
    their number, or -1 when there is no room.

    See ``base.feature`` for the layout of ``features``.

    Parameters
    ----------
    cell_low, cell_high : psi in radians, less than a turn apart.
    members : (M,) indices of the curves to consider, ascending.
    features : (F, 10) rows.
    pitch_x : column pitch in mm.
    least_margin : the smallest closure margin that a fixture may have. Of four forces that sum to 1, none
        less than m, each is at least m / (1 - 3 m) of any other.
    mode : ``HEIGHT`` or ``POSITION``, the value of the curves.
    farthest : pieces may be left out whose rightmost peg stands farther right than this, in mm.
    kept : (M, 15) of the members, see ``piece_bounds.clear_edges``.
    edges : (2, 14) work space.
    out : (P, 24) receives the pieces in the order of the curves; columns in ``base.tables``.
    """
    share = least_margin / (1.0 - 3.0 * least_margin)
    cell = PieceCell(
        cell_low, cell_high, cos(cell_high), sin(cell_high), pitch_x, share, mode, farthest, edges
    )
    return add_members(out, int(np.int64(0)), members, features, curves, cell, kept)
