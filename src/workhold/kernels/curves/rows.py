"""Where a row of holes meets a feature: the places at one height, and the heights between which they lie."""

from __future__ import annotations

from math import atan2, ceil, floor, pi, sin, sqrt

from workhold.conventions import LEAST_CLAMPING
from workhold.kernels.base.compiling import Array, inner
from workhold.kernels.base.feature import (
    AXIS_X,
    AXIS_Y,
    HALF_EXTENT,
    IS_ARC,
    RADIUS,
    X,
    Y,
    beside_middle,
    exact_dot,
    is_shallow,
    middle_of,
)

# Points of an arc this far beyond its ends, in mm, count as points of it: more than ``END_SLACK`` and
# rounding.
SPARE = 1e-6


@inner
def lines_between(
    lowest: float, highest: float, base: float, pitch_y: float, error: float
) -> tuple[int, int]:
    """First and last number of the lines of holes between two heights, each known to ``error``.

    Line 0 is at the height ``base``; all but the numbers is in mm.
    """
    slack = 1e-9 + error / pitch_y
    return int(ceil((lowest - base) / pitch_y - slack)), int(floor((highest - base) / pitch_y + slack))


@inner
def height_range(row: Array, ax: float, ay: float) -> tuple[float, float]:
    """Lowest and highest value of a . q over a feature's points q; those up to ``SPARE`` beyond an arc's
    ends count."""
    if row[IS_ARC] == 0.0:
        middle, reach = ax * row[X] + ay * row[Y], row[HALF_EXTENT] * abs(ax * row[AXIS_X] + ay * row[AXIS_Y])
        return (middle - reach, middle + reach)
    half = row[HALF_EXTENT] + SPARE / row[RADIUS]
    # Its two highest places, from the arc's middle: at the top of its circle, if that belongs to it, and at
    # an end.
    along, across = ax * row[AXIS_X] + ay * row[AXIS_Y], row[AXIS_X] * ay - row[AXIS_Y] * ax
    top = atan2(across, along)
    if half >= pi:
        middle = ax * row[X] + ay * row[Y]
        return (middle - row[RADIUS], middle + row[RADIUS])
    x, y = middle_of(row)
    middle = ax * x + ay * y
    one, two = height_beside(row, half, along, across), height_beside(row, -half, along, across)
    lowest, highest = min(one, two), max(one, two)
    if abs(top) <= half:
        highest = max(highest, height_beside(row, top, along, across))
    if abs(top) >= pi - half:
        lowest = min(lowest, height_beside(row, top + pi, along, across))
    return (middle + lowest, middle + highest)


@inner
def height_beside(row: Array, parameter: float, along: float, across: float) -> float:
    """How far above its middle an arc's point at a parameter is, in a direction of parts along and square to
    it."""
    sine = sin(parameter / 2.0)
    return row[RADIUS] * (sin(parameter) * across - 2.0 * sine * sine * along)


@inner
def row_meets(
    row: Array, ax: float, ay: float, height: float, error: float, side: float
) -> tuple[bool, float, float, float]:
    """A point of a feature's carrier at a height y . q, with (ax, ay) = y; ``side`` picks one of an arc's
    two.

    Where the feature runs square to the motion, a moving peg cannot push along it: the clamping force is at
    most abs(n . x). Such points are left out.

    Returns
    -------
    (whether there may be one that clamps, x, y, how far in mm it may be off when the height is off by
    ``error``)
    """
    if row[IS_ARC] == 0.0:
        slope = ax * row[AXIS_X] + ay * row[AXIS_Y]
        if side < 0.0 or abs(slope) <= 0.5 * LEAST_CLAMPING:
            return (False, 0.0, 0.0, 0.0)
        s = (height - ax * row[X] - ay * row[Y]) / slope
        return (True, row[X] + s * row[AXIS_X], row[Y] + s * row[AXIS_Y], 1.1 * error / abs(slope))
    if is_shallow(row):
        return row_meets_shallow(row, ax, ay, height, error, side)
    rise = height - ax * row[X] - ay * row[Y]
    square = (row[RADIUS] - rise) * (row[RADIUS] + rise)
    # The square is off by at most 2.2 R error.
    most = square + 2.2 * row[RADIUS] * error
    if most <= (0.5 * LEAST_CLAMPING * row[RADIUS]) ** 2:
        return (False, 0.0, 0.0, 0.0)
    along = sqrt(max(square, 0.0))
    radius = 1.3 * row[RADIUS] * error / along if square > 16.0 * row[RADIUS] * error else 2.0 * sqrt(most)
    along *= side
    # x = (ay, -ax) when y = (ax, ay).
    return (True, row[X] + rise * ax + along * ay, row[Y] + rise * ay - along * ax, radius + error)


@inner
def row_meets_shallow(
    row: Array, ax: float, ay: float, height: float, error: float, side: float
) -> tuple[bool, float, float, float]:
    """``row_meets`` for a shallow arc."""
    x, y = middle_of(row)
    along, across = ax * row[AXIS_X] + ay * row[AXIS_Y], exact_dot(ax, -ay, row[AXIS_Y], row[AXIS_X])
    off, inverse = height - ax * x - ay * y, 1.0 / row[RADIUS]
    # All squares over that of the radius.
    square = across * across - inverse * off * (2.0 * along + inverse * off)
    most = square + 2.2 * inverse * error
    if most <= (0.5 * LEAST_CLAMPING) ** 2:
        return (False, 0.0, 0.0, 0.0)
    radius = 1.3 * error / sqrt(square) if square > 16.0 * inverse * error else 2.0 * row[RADIUS] * sqrt(most)
    dx, dy, _, _ = beside_middle(row, ax, ay, across, off, -side)
    return (True, x + dx, y + dy, radius + error)
