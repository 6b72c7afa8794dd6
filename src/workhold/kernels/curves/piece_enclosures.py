"""Enclosures of a piece of a chord curve: of its second derivative, its value and its pegs' places.

Second derivatives: with P the instant centre and K >= |P'| (see ``stretches``)

    |h''| = |y . P + x . P'| <= |P| + K      and      |s''| = |P' . r_a| <= K      (divided by R_a on an arc);

the place along x, x . u, has the slope y . P and so the second derivative |x . P - y . P'| <= |P| + K, and a
contact direction turns at the rate p / R, which changes by at most K / R. A function of such a second
derivative B is within B w^2 / 8 of its linear interpolation over a range w. Beside a tangency the second
derivative is bounded on one side only, by X^3 P'.

Directions of forces are described in ``curves.piece_bounds``, and columns in ``base.tables``.
"""

from __future__ import annotations

from math import cos, hypot, inf, isfinite, sin

from workhold.kernels.base.compiling import Array, inner
from workhold.kernels.base.feature import IS_ARC, RADIUS
from workhold.kernels.base.tables import (
    ACROSS_LEAST,
    ACROSS_MOST,
    EDGE_ACROSS,
    EDGE_ARM,
    EDGE_CENTER,
    EDGE_CENTER_ERROR,
    EDGE_ERROR,
    EDGE_X,
    HEAD_NORMAL_X,
    HEAD_NORMAL_Y,
    HIGH,
    KAPPA,
    LENGTH,
    LOW,
    SECOND_DERIVATIVE_HIGH,
    SECOND_DERIVATIVE_LOW,
    SLOPE_ERROR_HIGH,
    SLOPE_ERROR_LOW,
    SLOPE_HIGH,
    SLOPE_LOW,
    STEADY,
    TAIL_NORMAL_X,
    TAIL_NORMAL_Y,
    VALUE_ERROR_HIGH,
    VALUE_ERROR_LOW,
    VALUE_HIGH,
    VALUE_LEAST,
    VALUE_LOW,
    VALUE_MOST,
    X_MOVING,
    X_STANDING,
)
from workhold.kernels.chord.evaluation import HEIGHT
from workhold.kernels.chord.stretches import (
    ALONG_HIGH,
    ALONG_LOW,
    LARGEST_CROSS,
    LEAST_CUBE,
    PART_A,
    PART_B,
    SPEED,
    X_HIGH,
    X_LOW,
    Y_HIGH,
    Y_LOW,
)
from workhold.kernels.curves.piece_bounds import (
    DIRECTION_HAIR,
    SAME,
    enclose_tail,
    enclose_value,
    write_all_force_directions,
    write_force_directions,
)

# The directions of a piece are given only if its pegs' contacts turn by less than this, in radians.
MOST_TURN = 1.0


@inner
def enclose_second_derivative_beside(
    stretch: Array, a: Array, d: float, reach: float, low: float, high: float, mode: float
) -> tuple[float, float]:
    """Return (low, high) bounds of a curve's second derivative beside a tangency; at least one of them is
    infinite.

    X^3 h'' = -x . X^3 P' - X^2 C_b y . r_a - X^3 y . u, with |C_b| <= d and |u| <= ``reach``; X^3 s'' = -X^3
    P' . r_a. See ``base.feature`` for the layout of ``a``.

    Parameters
    ----------
    stretch : (13,), see ``chord.stretches``.
    a : feature of the tail.
    d : length of the chord in mm.
    reach : bound in mm of |u|, the distance of tails from the part's origin.
    low, high : range of psi in radians.
    mode : HEIGHT for h, POSITION for s.
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
def find_largest_part(one_x: float, one_y: float, two_x: float, two_y: float) -> float:
    """Return the largest absolute x component of a unit vector while it turns at a constant rate between two
    directions.

    It turns from (one_x, one_y) to (two_x, two_y), by less than half a turn.
    """
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
    """Write the enclosures of a piece along which the instant centre has a bounded speed to the piece's row
    (24,).

    They are the columns from SECOND_DERIVATIVE_LOW on; force directions are written in the mode HEIGHT only.
    The values and slopes at both ends must be in ``row`` already. See ``base.tables`` for the layout of
    ``row``, ``curve``, ``low`` and ``high``, ``base.feature`` for that of ``a``.

    Parameters
    ----------
    a, curve : feature of the tail, and reals of the curve.
    low, high : edges of the piece.
    stretch : (13,) of the curve, see ``chord.stretches``.
    width : range of psi in radians.
    share : see ``piece_bounds.find_shared_force_range``.
    """
    speed, sag = stretch[SPEED], width * width / 8.0
    error = max(low[EDGE_ERROR], high[EDGE_ERROR])
    with_backward_error = max(low[EDGE_CENTER_ERROR], high[EDGE_CENTER_ERROR])
    center = max(low[EDGE_CENTER], high[EDGE_CENTER]) + speed * width + with_backward_error
    arm = max(low[EDGE_ARM], high[EDGE_ARM]) + speed * width + with_backward_error
    curved = curve[KAPPA]
    turns_little = (curved * arm + 1.0) * width <= MOST_TURN
    turned = curved * (speed * sag + 2.0 * error) + DIRECTION_HAIR * width + SAME
    if mode == HEIGHT:
        # x . P' by its parts along the contact directions, which have little along x on a chord along a line.
        tail = head = 1.0
        if turns_little:
            tail = find_largest_part(
                low[TAIL_NORMAL_X], low[TAIL_NORMAL_Y], high[TAIL_NORMAL_X], high[TAIL_NORMAL_Y]
            )
            head = find_largest_part(
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
    """Write the enclosures of a piece beside a tangency to the piece's row (24,), and value and slope at the
    tangency.

    ``tangent_low`` and ``tangent_high`` are the errors in radians of the low and the high end where that end
    is the tangency, and 0 where it is not. See ``base.tables`` for the layout of ``row`` and ``curve``,
    ``base.feature`` for that of ``a`` and ``b``, ``chord.stretches`` for that of ``stretch``.
    """
    middle = (row[LOW] + row[HIGH]) / 2.0
    # The end at a tangency may lie a hair beyond.
    reach = (row[HIGH] - row[LOW]) / 2.0 + max(tangent_low, tangent_high)
    x, y, radius = enclose_tail(a, b, curve, middle, reach)
    size = hypot(x, y) + radius
    row[SECOND_DERIVATIVE_LOW], row[SECOND_DERIVATIVE_HIGH] = enclose_second_derivative_beside(
        stretch, a, curve[LENGTH], size, row[LOW], row[HIGH], mode
    )
    # Where the branches meet the slope is infinite, with the sign the second derivative gives it.
    if tangent_low > 0.0:
        row[SLOPE_LOW], row[SLOPE_ERROR_LOW] = compute_end_slope(
            row[SECOND_DERIVATIVE_LOW], row[SECOND_DERIVATIVE_HIGH], -1.0
        )
    if tangent_high > 0.0:
        row[SLOPE_HIGH], row[SLOPE_ERROR_HIGH] = compute_end_slope(
            row[SECOND_DERIVATIVE_LOW], row[SECOND_DERIVATIVE_HIGH], 1.0
        )
    # There, or nearly there, the value is bounded by a disc, a hair beyond the end included.
    if tangent_low > 0.0 or not isfinite(row[VALUE_ERROR_LOW]):
        row[VALUE_LOW], row[VALUE_ERROR_LOW] = enclose_value(a, b, curve, row[LOW], tangent_low + SAME, mode)
    if tangent_high > 0.0 or not isfinite(row[VALUE_ERROR_HIGH]):
        row[VALUE_HIGH], row[VALUE_ERROR_HIGH] = enclose_value(
            a, b, curve, row[HIGH], tangent_high + SAME, mode
        )
    value, doubt = enclose_value(a, b, curve, middle, reach, mode)
    row[VALUE_LEAST], row[VALUE_MOST] = value - doubt, value + doubt
    place, doubt = cos(middle) * x + sin(middle) * y, radius + size * reach + DIRECTION_HAIR
    row[X_STANDING], row[X_MOVING] = place - doubt, place + doubt
    write_all_force_directions(row)
    row[ACROSS_LEAST], row[ACROSS_MOST] = -inf, inf
    row[STEADY] = 0.0


@inner
def compute_end_slope(
    second_derivative_low: float, second_derivative_high: float, side: float
) -> tuple[float, float]:
    """Return (slope, bound of its error) at an end of a piece that is a tangency.

    Two cases: (a) the bounds of the second derivative have one sign: the slope is inf or -inf, the error 0;
    (b) otherwise: (0, inf). ``side`` is -1 where the tangency is the low end of the piece, 1 where it is the
    high end.
    """
    if second_derivative_low >= 0.0:
        return (side * inf, 0.0)
    if second_derivative_high <= 0.0:
        return (-side * inf, 0.0)
    return (0.0, inf)
