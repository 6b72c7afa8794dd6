"""Pieces: chord curves cut to a cell of orientations, with what is needed to bound them.

Glossary
--------
cell : a closed range of orientations psi; the work is shared out by cells.
piece : a chord curve over a range inside one cell and inside one stretch. It has value and derivative at both
    ends and an enclosure of its second derivative. From these follow enclosures of its value, of the place of
    its pegs along x, and of the directions in which they can push together.

Second derivatives: with P the instant centre and K >= |P'| (see ``stretches``)

    |h''| = |y . P + x . P'| <= |P| + K      and      |s''| = |P' . r_a| <= K      (divided by R_a on an arc);

the place along x, x . u, has the slope y . P and so the second derivative |x . P - y . P'| <= |P| + K, and a
contact direction turns at the rate p / R, which changes by at most K / R. A function of such a second
derivative B is within B w^2 / 8 of its linear interpolation over a range w. Beside a tangency the second
derivative is bounded on one side only, by X^3 P'.

Directions of forces are described in ``curves.piece_bounds``, and columns in ``chord.columns``.
"""

from __future__ import annotations

from math import cos, floor, hypot, inf, isfinite, pi, sin

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.arrays import grown
from workhold.kernels.base.compiling import inner, inner_making_arrays
from workhold.kernels.base.feature import HALF_EXTENT, IS_ARC, RADIUS, local_size
from workhold.kernels.base.interval import TURN
from workhold.kernels.chord.columns import (
    ACROSS_LEAST,
    ACROSS_MOST,
    COLUMN_STEP,
    CURVE,
    EDGE_ACROSS,
    EDGE_ARM,
    EDGE_CENTER,
    EDGE_CENTER_ERROR,
    EDGE_ERROR,
    EDGE_LENGTH,
    EDGE_SLOPE,
    EDGE_SLOPE_ERROR,
    EDGE_VALUE,
    EDGE_VALUE_ERROR,
    EDGE_X,
    END_STRETCH,
    FIRST_STRETCH,
    FROM,
    HEAD,
    HEAD_NORMAL_X,
    HEAD_NORMAL_Y,
    HIGH,
    KAPPA,
    LENGTH,
    LOW,
    SECOND_DERIVATIVE_HIGH,
    SECOND_DERIVATIVE_LOW,
    SHIFT,
    SLOPE_ERROR_HIGH,
    SLOPE_ERROR_LOW,
    SLOPE_HIGH,
    SLOPE_LOW,
    STEADY,
    TAIL,
    TAIL_NORMAL_X,
    TAIL_NORMAL_Y,
    TANGENT_FROM,
    TANGENT_TO,
    TO,
    VALUE_ERROR_HIGH,
    VALUE_ERROR_LOW,
    VALUE_HIGH,
    VALUE_LEAST,
    VALUE_LOW,
    VALUE_MOST,
    X_MOVING,
    X_STANDING,
    Curves,
)
from workhold.kernels.chord.evaluation import HEIGHT, POSITION, curve_value
from workhold.kernels.chord.stretches import (
    ALONG_HIGH,
    ALONG_LOW,
    LARGEST_CROSS,
    LEAST_CUBE,
    PART_A,
    PART_B,
    PARTS,
    SPEED,
    STRETCH_HIGH,
    X_HIGH,
    X_LOW,
    Y_HIGH,
    Y_LOW,
)
from workhold.kernels.curves.piece_bounds import (
    DIRECTION_HAIR,
    is_farther,
    tail_disc,
    value_disc,
    write_all_force_directions,
    write_edge,
    write_force_directions,
)

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

# Rounding of an orientation in radians.
SAME = 2e-15
# The directions of a piece are given only if its pegs' contacts turn by less than this, in radians.
MOST_TURN = 1.0


@inner
def unwrapped(value: float, near: float) -> float:
    """An angle moved by whole turns to be nearest to another."""
    return value + TURN * floor((near - value) / TURN + 0.5)


@inner
def second_derivative_beside(
    stretch: Array, a: Array, d: float, reach: float, low: float, high: float, mode: float
) -> tuple[float, float]:
    """Enclosure of the second derivative beside a tangency, one of whose bounds is infinite.

    X^3 h'' = -x . X^3 P' - X^2 C_b y . r_a - X^3 y . u, with |C_b| <= d and |u| <= ``reach``;
    X^3 s'' = -X^3 P' . r_a.
    """
    cube = stretch[LARGEST_CROSS] * stretch[LARGEST_CROSS] * stretch[LARGEST_CROSS]
    if mode == HEIGHT:
        psi, half = (low + high) / 2.0, (high - low) / 2.0
        x, y = cos(psi), sin(psi)
        first = min(x * stretch[X_LOW], x * stretch[X_HIGH]) + min(y * stretch[Y_LOW], y * stretch[Y_HIGH])
        last = max(x * stretch[X_LOW], x * stretch[X_HIGH]) + max(y * stretch[Y_LOW], y * stretch[Y_HIGH])
        size = hypot(max(-stretch[X_LOW], stretch[X_HIGH]), max(-stretch[Y_LOW], stretch[Y_HIGH]))
        doubt = size * (half + DIRECTION_HAIR) + stretch[LARGEST_CROSS] * stretch[LARGEST_CROSS] * d
        swing_low, swing_high, fixed = -last - doubt, -first + doubt, reach
    else:
        scale = 1.0 if a[IS_ARC] == 0.0 else 1.0 / a[RADIUS]
        swing_low, swing_high, fixed = -scale * stretch[ALONG_HIGH], -scale * stretch[ALONG_LOW], 0.0
        swing_low -= DIRECTION_HAIR * abs(swing_low)
        swing_high += DIRECTION_HAIR * abs(swing_high)
    if cube < 0.0:
        swing_low, swing_high, cube = -swing_high, -swing_low, -cube
    if swing_low > 0.0 and cube > 0.0:
        return (swing_low / cube * (1.0 - DIRECTION_HAIR) - fixed, inf)
    if swing_high < 0.0 and cube > 0.0:
        return (-inf, swing_high / cube * (1.0 - DIRECTION_HAIR) + fixed)
    return (-inf, inf)


@inner
def largest_part(one_x: float, one_y: float, two_x: float, two_y: float) -> float:
    """Largest size of the part along x of a unit vector that turns evenly from one to another, less than
    half way round."""
    if one_y * two_y <= 0.0:
        return 1.0
    return max(abs(one_x), abs(two_x))


@inner
def write_steady(
    row: Array,
    a: Array,
    curve: Array,
    low: Array,
    high: Array,
    stretch: Array,
    width: float,
    share: float,
    mode: float,
) -> None:
    """Writes the enclosures of a piece whose instant centre moves at a bounded speed."""
    speed, sag = stretch[SPEED], width * width / 8.0
    error, with_backward_error = (
        max(low[EDGE_ERROR], high[EDGE_ERROR]),
        max(low[EDGE_CENTER_ERROR], high[EDGE_CENTER_ERROR]),
    )
    center = max(low[EDGE_CENTER], high[EDGE_CENTER]) + speed * width + with_backward_error
    arm = max(low[EDGE_ARM], high[EDGE_ARM]) + speed * width + with_backward_error
    curved = curve[KAPPA]
    turns_little = (curved * arm + 1.0) * width <= MOST_TURN
    turned = curved * (speed * sag + 2.0 * error) + DIRECTION_HAIR * width + SAME
    if mode == HEIGHT:
        # x . P' by its parts along the contact directions, whose parts along x are small where the chord runs
        # along a line.
        tail = head = 1.0
        if turns_little:
            tail = largest_part(
                low[TAIL_NORMAL_X], low[TAIL_NORMAL_Y], high[TAIL_NORMAL_X], high[TAIL_NORMAL_Y]
            )
            head = largest_part(
                low[HEAD_NORMAL_X], low[HEAD_NORMAL_Y], high[HEAD_NORMAL_X], high[HEAD_NORMAL_Y]
            )
        swing = (stretch[PART_A] * (tail + turned) + stretch[PART_B] * (head + turned)) / stretch[LEAST_CUBE]
        second_derivative = (center + min(speed, swing)) * (1.0 + DIRECTION_HAIR)
    else:
        second_derivative = (speed if a[IS_ARC] == 0.0 else speed / a[RADIUS]) * (1.0 + DIRECTION_HAIR)
    row[SECOND_DERIVATIVE_LOW], row[SECOND_DERIVATIVE_HIGH] = -second_derivative, second_derivative
    doubt = second_derivative * sag + max(row[VALUE_ERROR_LOW], row[VALUE_ERROR_HIGH])
    row[VALUE_LEAST] = min(row[VALUE_LOW], row[VALUE_HIGH]) - doubt
    row[VALUE_MOST] = max(row[VALUE_LOW], row[VALUE_HIGH]) + doubt
    doubt = (center + speed) * sag + error + DIRECTION_HAIR
    row[X_STANDING] = min(low[EDGE_X], high[EDGE_X]) - doubt
    row[X_MOVING] = max(low[EDGE_X], high[EDGE_X]) + doubt
    if mode == HEIGHT:
        if turns_little:
            write_force_directions(row, low, high, share, turned)
        else:
            write_all_force_directions(row)
    # The slope of y . P is bounded by |P| + K.
    doubt = 0.5 * (center + speed) * width + with_backward_error + DIRECTION_HAIR
    row[ACROSS_LEAST] = min(low[EDGE_ACROSS], high[EDGE_ACROSS]) - doubt
    row[ACROSS_MOST] = max(low[EDGE_ACROSS], high[EDGE_ACROSS]) + doubt
    row[STEADY] = 1.0


@inner
def write_beside(
    row: Array,
    a: Array,
    b: Array,
    curve: Array,
    stretch: Array,
    tangent_low: float,
    tangent_high: float,
    mode: float,
) -> None:
    """Writes the enclosures of a piece beside a tangency; the tangency is at an end whose error is not 0."""
    middle = (row[LOW] + row[HIGH]) / 2.0
    # The end at a tangency may lie a hair beyond.
    reach = (row[HIGH] - row[LOW]) / 2.0 + max(tangent_low, tangent_high)
    x, y, radius = tail_disc(a, b, curve, middle, reach)
    size = hypot(x, y) + radius
    row[SECOND_DERIVATIVE_LOW], row[SECOND_DERIVATIVE_HIGH] = second_derivative_beside(
        stretch, a, curve[LENGTH], size, row[LOW], row[HIGH], mode
    )
    # Where the branches meet the slope is infinite, with the sign the second derivative gives it.
    if tangent_low > 0.0:
        row[SLOPE_LOW], row[SLOPE_ERROR_LOW] = end_slope(
            row[SECOND_DERIVATIVE_LOW], row[SECOND_DERIVATIVE_HIGH], -1.0
        )
    if tangent_high > 0.0:
        row[SLOPE_HIGH], row[SLOPE_ERROR_HIGH] = end_slope(
            row[SECOND_DERIVATIVE_LOW], row[SECOND_DERIVATIVE_HIGH], 1.0
        )
    # There, or nearly there, the value is bounded by a disc, a hair beyond the end included.
    if tangent_low > 0.0 or not isfinite(row[VALUE_ERROR_LOW]):
        row[VALUE_LOW], row[VALUE_ERROR_LOW] = value_disc(a, b, curve, row[LOW], tangent_low + SAME, mode)
    if tangent_high > 0.0 or not isfinite(row[VALUE_ERROR_HIGH]):
        row[VALUE_HIGH], row[VALUE_ERROR_HIGH] = value_disc(a, b, curve, row[HIGH], tangent_high + SAME, mode)
    value, doubt = value_disc(a, b, curve, middle, reach, mode)
    row[VALUE_LEAST], row[VALUE_MOST] = value - doubt, value + doubt
    place, doubt = cos(middle) * x + sin(middle) * y, radius + size * reach + DIRECTION_HAIR
    row[X_STANDING], row[X_MOVING] = place - doubt, place + doubt
    write_all_force_directions(row)
    row[ACROSS_LEAST], row[ACROSS_MOST] = -inf, inf
    row[STEADY] = 0.0


@inner
def end_slope(
    second_derivative_low: float, second_derivative_high: float, side: float
) -> tuple[float, float]:
    """Slope at a tangency and its error: infinite, with the sign the second derivative gives it (side -1 at
    the low end, +1 at the high end), or unknown."""
    if second_derivative_low >= 0.0:
        return (side * inf, 0.0)
    if second_derivative_high <= 0.0:
        return (-side * inf, 0.0)
    return (0.0, inf)


@inner
def add_pieces(
    out: Array,
    count: int,
    features: Array,
    curves: Curves,
    pitch_x: float,
    share: float,
    index: int,
    low: float,
    high: float,
    cell_end: tuple[float, float, float],
    base: float,
    mode: float,
    edges: Array,
    kept: Array,
    farthest: float,
) -> int:
    """Appends the pieces of one curve over [low, high] to ``out``, which has room for one for each stretch,
    and returns their new number.

    Parameters
    ----------
    share : see ``shared_force``.
    low, high : psi in radians, inside the curve's range and inside one cell.
    cell_end : psi where the cell ends, as most pieces in it do, its cosine and its sine.
    base : psi at the low end of the curve's range.
    edges : (2, 14) work space.
    kept : (15,) the last edge that was written of the curve, and psi there: where a cell ends its neighbour
        begins.
    farthest : pieces whose rightmost peg stands farther right than this, in mm, may be left out.
    """
    integers, stretches, curve = curves.integers, curves.stretches, curves.reals[index]
    a, b = features[integers[index, TAIL]], features[integers[index, HEAD]]
    circles = mode == POSITION and a[IS_ARC] != 0.0 and a[HALF_EXTENT] >= pi
    step = integers[index, COLUMN_STEP] * pitch_x
    span = curve[TO] - curve[FROM]
    # No tail is farther from the centre of the part than this.
    size = local_size(a) + a[HALF_EXTENT]
    at_low, at_high = edges[0], edges[1]
    cell_high, end_cosine, end_sine = cell_end
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
            second_derivatives = second_derivative_beside(stretch, a, curve[LENGTH], size, left, right, mode)
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
            cosine, sine = (end_cosine, end_sine) if right == cell_high else (cos(right), sin(right))
            write_edge(at_high, a, b, curve, right, cosine, sine, mode)
            row = out[count]
            count += 1
            row[LOW], row[HIGH], row[CURVE] = left, right, index
            row[VALUE_LOW], row[SLOPE_LOW] = at_low[EDGE_VALUE], at_low[EDGE_SLOPE]
            row[VALUE_HIGH], row[SLOPE_HIGH] = at_high[EDGE_VALUE], at_high[EDGE_SLOPE]
            row[VALUE_ERROR_LOW], row[SLOPE_ERROR_LOW] = at_low[EDGE_VALUE_ERROR], at_low[EDGE_SLOPE_ERROR]
            row[VALUE_ERROR_HIGH], row[SLOPE_ERROR_HIGH] = (
                at_high[EDGE_VALUE_ERROR],
                at_high[EDGE_SLOPE_ERROR],
            )
            steady = steady and isfinite(row[SLOPE_ERROR_LOW]) and isfinite(row[SLOPE_ERROR_HIGH])
            if circles and steady:
                unwind(row, a, b, curve)
            if steady:
                write_steady(row, a, curve, at_low, at_high, stretch, right - left, share, mode)
            else:
                write_beside(row, a, b, curve, stretch, tangent_low, tangent_high, mode)
                if circles:
                    unwind(row, a, b, curve)
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
def unwind(row: Array, a: Array, b: Array, curve: Array) -> None:
    """Brings the positions at both ends of a piece on a whole circle to the turn of its inside."""
    width = row[HIGH] - row[LOW]
    for k in range(2):
        psi = row[LOW] + width / 64.0 if k == 0 else row[HIGH] - width / 64.0
        middle = curve_value(a, b, curve, psi, POSITION)[0]
        column = VALUE_LOW if k == 0 else VALUE_HIGH
        row[column] = unwrapped(row[column], middle)


@inner
def add_members(
    out: Array,
    count: int,
    first: int,
    members: IntArray,
    cell_low: float,
    cell_high: float,
    features: Array,
    curves: Curves,
    pitch_x: float,
    share: float,
    mode: float,
    edges: Array,
    kept: Array,
    farthest: float,
) -> tuple[int, int]:
    """Appends the pieces of curves, from the ``first`` of the members on, as long as ``out`` has room for all
    of a curve.

    Returns
    -------
    (which of the members comes next, number of pieces)
    """
    integers, reals = curves.integers, curves.reals
    cell_end = (cell_high, cos(cell_high), sin(cell_high))
    for n in range(first, members.shape[0]):
        index = members[n]
        # A curve of nearly a turn may enter the cell at both of its ends.
        if count + 2 * (integers[index, END_STRETCH] - integers[index, FIRST_STRETCH]) > out.shape[0]:
            return n, count
        base = reals[index, FROM] - reals[index, SHIFT]
        span = reals[index, TO] - reals[index, FROM]
        start = base + TURN * floor((cell_low - base) / TURN)
        for lap in range(2):
            low = start + lap * TURN
            left, right = max(low, cell_low), min(low + span, cell_high)
            if right - left > 0.0:
                count = add_pieces(
                    out,
                    count,
                    features,
                    curves,
                    pitch_x,
                    share,
                    index,
                    left,
                    right,
                    cell_end,
                    low,
                    mode,
                    edges,
                    kept[n],
                    farthest,
                )
    return members.shape[0], count


@inner_making_arrays
def cell_pieces(
    cell_low: float,
    cell_high: float,
    members: IntArray,
    features: Array,
    curves: Curves,
    pitch_x: float,
    least_margin: float,
    mode: float,
    kept: Array,
    farthest: float,
    room: Array,
) -> tuple[Array, int]:
    """Pieces of curves inside one cell.

    Parameters
    ----------
    cell_low, cell_high : psi in radians, less than a turn apart.
    members : (M,) indices of the curves to consider, ascending.
    features : (F, 10) rows.
    pitch_x : column pitch in mm.
    least_margin : the smallest closure margin of interest. Of four forces that sum to 1, none less than m,
        each is at least m / (1 - 3 m) of any other.
    mode : ``HEIGHT`` or ``POSITION``.
    kept : of the members, see ``edges.kept_edges``.
    farthest : pieces may be left out whose rightmost peg stands farther right than this, in mm.
    room : (R, 24) that may be written over.

    Returns
    -------
    (that room, or more of it, which begins with the pieces in the order of the curves; their number)
    """
    share = least_margin / (1.0 - 3.0 * least_margin)
    edges = np.empty((2, EDGE_LENGTH))
    done, count = 0, int(np.int64(0))
    while True:
        done, count = add_members(
            room,
            count,
            done,
            members,
            cell_low,
            cell_high,
            features,
            curves,
            pitch_x,
            share,
            mode,
            edges,
            kept,
            farthest,
        )
        if done == members.shape[0]:
            return room, count
        room = grown(room)
