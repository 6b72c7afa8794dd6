"""Moving pegs tried with three standing pegs: places where rows of holes meet features.

With the three standing pegs in place the workpiece stands still, and each row of the moving carrier meets
each feature in at most two points.
"""

from __future__ import annotations

from math import atan2, ceil, floor, inf, pi, sin, sqrt

import numpy as np

from workhold.conventions import GAP_SLACK, LEAST_CLAMPING
from workhold.kernels.base.compiling import Array, inner
from workhold.kernels.base.feature import (
    AXIS_X,
    AXIS_Y,
    HALF_EXTENT,
    IS_ARC,
    RADIUS,
    SIGN,
    X,
    Y,
    compute_exact_dot,
    find_arc_middle,
    intersect_near_middle,
    is_shallow,
)
from workhold.kernels.base.tables import Limits
from workhold.kernels.contact.location_bounds import is_beyond
from workhold.kernels.contact.record import PEG_FEATURE, PEG_RADIUS, PEG_X, PEG_Y, Angle, place_peg
from workhold.kernels.contact.rules import bound_minor_error, compute_outward_normal
from workhold.kernels.curves.block_work import (
    BlockWork,
    add_listed,
    add_seat,
    has_no_moving_peg,
    limits_errors,
)
from workhold.kernels.curves.piece_bounds import HAIR

# mm. Points this far beyond an arc's ends count as points of it: more than ``END_SLACK`` and rounding.
SPARE = 1e-6


@inner
def find_lines_between(
    lowest: float, highest: float, base: float, pitch_y: float, error: float
) -> tuple[int, int]:
    """Return the first and last number of the rows of holes with
    heights in [lowest, highest]; first > last for none.

    Row k is at the height ``base`` + k ``pitch_y``. Heights are in mm and known to ``error``, so rows up to
    that far outside are included.
    """
    slack = 1e-9 + error / pitch_y
    return int(ceil((lowest - base) / pitch_y - slack)), int(floor((highest - base) / pitch_y + slack))


@inner
def find_height_range(row: Array, ax: float, ay: float) -> tuple[float, float]:
    """Return the lowest and highest value of a . q in mm over a
    feature's points q, with a = (ax, ay) a unit vector.

    Points up to ``SPARE`` mm beyond an arc's ends count as its points. See ``base.feature`` for the layout of
    ``row``.
    """
    if row[IS_ARC] == 0.0:
        middle, reach = ax * row[X] + ay * row[Y], row[HALF_EXTENT] * abs(ax * row[AXIS_X] + ay * row[AXIS_Y])
        return (middle - reach, middle + reach)
    half = row[HALF_EXTENT] + SPARE / row[RADIUS]
    # Its two highest places, from the arc's middle: at an end, and at its circle's top, if that is on it.
    along, across = ax * row[AXIS_X] + ay * row[AXIS_Y], row[AXIS_X] * ay - row[AXIS_Y] * ax
    top = atan2(across, along)
    if half >= pi:
        middle = ax * row[X] + ay * row[Y]
        return (middle - row[RADIUS], middle + row[RADIUS])
    x, y = find_arc_middle(row)
    middle = ax * x + ay * y
    one, two = (
        compute_height_above_middle(row, half, along, across),
        compute_height_above_middle(row, -half, along, across),
    )
    lowest, highest = min(one, two), max(one, two)
    if abs(top) <= half:
        highest = max(highest, compute_height_above_middle(row, top, along, across))
    if abs(top) >= pi - half:
        lowest = min(lowest, compute_height_above_middle(row, top + pi, along, across))
    return (middle + lowest, middle + highest)


@inner
def compute_height_above_middle(row: Array, parameter: float, along: float, across: float) -> float:
    """Return the height in mm of an arc's point above the arc's middle; the point is given by its parameter
    in radians.

    The direction of height is a unit vector: ``along`` is its component on the arc's axis, ``across`` its
    component square to the axis. See ``base.feature`` for the layout of ``row``.
    """
    sine = sin(parameter / 2.0)
    return row[RADIUS] * (sin(parameter) * across - 2.0 * sine * sine * along)


@inner
def intersect_at_height(
    row: Array, ax: float, ay: float, height: float, error: float, side: float
) -> tuple[bool, float, float, float]:
    """Return a point with height y . q = ``height`` on a feature's
    line or circle, whether or not within its ends.

    (ax, ay) is the unit vector y; ``side`` 1 or -1 picks one of an arc's two points (a line has one, for side
    1). Points at which a moving peg cannot clamp are left out: the clamping force is at most abs(n . x), and
    is too small where the feature runs nearly along x. See ``base.feature`` for the layout of ``row``.

    Returns
    -------
    (whether there may be such a point; its x and y in the part's frame in mm; how far in mm it may be off
        when the height is off by ``error``)
    """
    if row[IS_ARC] == 0.0:
        slope = ax * row[AXIS_X] + ay * row[AXIS_Y]
        if side < 0.0 or abs(slope) <= 0.5 * LEAST_CLAMPING:
            return (False, 0.0, 0.0, 0.0)
        s = (height - ax * row[X] - ay * row[Y]) / slope
        return (True, row[X] + s * row[AXIS_X], row[Y] + s * row[AXIS_Y], 1.1 * error / abs(slope))
    if is_shallow(row):
        return intersect_shallow_at_height(row, ax, ay, height, error, side)
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
def intersect_shallow_at_height(
    row: Array, ax: float, ay: float, height: float, error: float, side: float
) -> tuple[bool, float, float, float]:
    """Return the result of :func:`intersect_at_height` for a shallow arc; parameters are the same.

    See ``base.feature`` for the layout of ``row``.
    """
    x, y = find_arc_middle(row)
    along, across = ax * row[AXIS_X] + ay * row[AXIS_Y], compute_exact_dot(ax, -ay, row[AXIS_Y], row[AXIS_X])
    off, inverse = height - ax * x - ay * y, 1.0 / row[RADIUS]
    # All squares over that of the radius.
    square = across * across - inverse * off * (2.0 * along + inverse * off)
    most = square + 2.2 * inverse * error
    if most <= (0.5 * LEAST_CLAMPING) ** 2:
        return (False, 0.0, 0.0, 0.0)
    radius = 1.3 * error / sqrt(square) if square > 16.0 * inverse * error else 2.0 * row[RADIUS] * sqrt(most)
    dx, dy, _, _ = intersect_near_middle(row, ax, ay, across, off, -side)
    return (True, x + dx, y + dy, radius + error)


@inner
def write_triple(triple: Array, pegs: Array, cx: float, cy: float, features: Array, length: float) -> None:
    """Write the numbers to ``triple`` with which moving pegs are tested against the three standing pegs
    ``pegs[:3]``.

    The rows (8, 3), of which the last three are work space: let w_i = (n_i, t_i) be the wrenches of the
    standing pegs and D their determinant. Rows 0 to 2 hold the cross products of the other two wrenches,
    cyclically, with the sign of D. For a moving peg with wrench w, the null vector's entries of the standing
    pegs over that of the moving peg are minus the scalar products of these rows with w, over abs(D). Row 3
    holds the place in mm along x of the rightmost standing peg, the largest error radius of the pegs in mm,
    and the largest turn of a normal by that, in radians. Row 4 begins with abs(D). The x axis of the pegs has
    the direction (cx, cy) in the part's frame. See ``contact.record`` for the layout of ``pegs``,
    ``base.feature`` for that of ``features``.
    """
    wrenches, first = triple[:3], triple[5:]
    rightmost = -np.inf
    radius = swing = 0.0
    for k in range(3):
        x, y = pegs[k, PEG_X], pegs[k, PEG_Y]
        row = features[int(pegs[k, PEG_FEATURE])]
        nx, ny = compute_outward_normal(row, x, y)
        first[k, 0], first[k, 1], first[k, 2] = nx, ny, (x * ny - y * nx) / length
        rightmost = max(rightmost, cx * x + cy * y)
        radius = max(radius, pegs[k, PEG_RADIUS])
        if row[IS_ARC] != 0.0:
            swing = max(swing, pegs[k, PEG_RADIUS] / row[RADIUS])
    for k in range(3):
        one, two = first[(k + 1) % 3], first[(k + 2) % 3]
        wrenches[k, 0] = one[1] * two[2] - one[2] * two[1]
        wrenches[k, 1] = one[2] * two[0] - one[0] * two[2]
        wrenches[k, 2] = one[0] * two[1] - one[1] * two[0]
    determinant = wrenches[0, 0] * first[0, 0] + wrenches[0, 1] * first[0, 1] + wrenches[0, 2] * first[0, 2]
    if determinant < 0.0:
        for k in range(3):
            for n in range(3):
                wrenches[k, n] = -wrenches[k, n]
    triple[3, 0], triple[3, 1], triple[3, 2] = rightmost, radius, swing
    triple[4, 0] = abs(determinant)


@inner
def may_close(
    triple: Array,
    row: Array,
    x: float,
    y: float,
    radius: float,
    cx: float,
    cy: float,
    gap: float,
    limits: Limits,
) -> bool:
    """Return whether a moving peg may make a fixture with three
    standing pegs: a quick necessary test before ``is_fixture``.

    It tests the gap and the least closure margin. See ``base.feature`` for the layout of ``row``.

    Parameters
    ----------
    triple : (8, 3) rows of :func:`write_triple`.
    row, x, y, radius : the moving peg's feature, its centre and error radius in mm.
    cx, cy : cosine and sine of psi.
    gap : smallest gap in mm, reduced by the doubt about the orientation.
    """
    length = limits.wrench_length
    doubt = max(triple[3, 1], radius)
    if cx * x + cy * y - triple[3, 0] < gap - 2.0 * doubt:
        return False
    nx, ny = compute_outward_normal(row, x, y)
    swing = max(triple[3, 2], 0.0 if row[IS_ARC] == 0.0 else radius / row[RADIUS])
    t = (x * ny - y * nx) / length
    band = bound_minor_error(swing, doubt, length)
    determinant = triple[4, 0]
    if determinant <= band:
        return True
    smallest = total = determinant
    for k in range(3):
        entry = -(triple[k, 0] * nx + triple[k, 1] * ny + triple[k, 2] * t)
        smallest, total = min(smallest, entry), total + abs(entry)
    return smallest + band > limits.least_margin * (total - 4.0 * band)


@inner
def find_closing_heights(
    triple: Array, row: Array, ax: float, ay: float, error: float, length: float
) -> tuple[float, float]:
    """Return the lowest and highest a . q in mm over points q of a
    straight feature where a moving peg may close.

    Return (inf, -inf) where none may. The forces of the standing pegs are linear in the position along the
    feature, and must not be negative. See ``base.feature`` for the layout of ``row``.

    Parameters
    ----------
    triple : (8, 3) rows of :func:`write_triple`.
    row : a line.
    ax, ay : unit vector across the rows of holes, in the part's frame.
    error : how far in mm heights may be off.
    length : L in mm, by which moments are divided.
    """
    slope = ax * row[AXIS_X] + ay * row[AXIS_Y]
    if abs(slope) <= 0.5 * LEAST_CLAMPING:
        return (inf, -inf)
    low, high = -row[HALF_EXTENT] - SPARE, row[HALF_EXTENT] + SPARE
    band = bound_minor_error(triple[3, 2], max(triple[3, 1], 1.1 * error / abs(slope)), length)
    nx, ny = row[AXIS_Y], -row[AXIS_X]
    t = (row[X] * ny - row[Y] * nx) / length
    if triple[4, 0] > band:
        for k in range(3):
            taken = band - (triple[k, 0] * nx + triple[k, 1] * ny + triple[k, 2] * t)
            change = triple[k, 2] / length
            if abs(change) * length <= HAIR:
                if taken + abs(change) * 2.0 * length < 0.0:
                    return (inf, -inf)
            elif change > 0.0:
                low = max(low, -taken / change - HAIR)
            else:
                high = min(high, -taken / change + HAIR)
    if low > high:
        return (inf, -inf)
    middle, one, two = ax * row[X] + ay * row[Y], low * slope, high * slope
    return (middle + min(one, two), middle + max(one, two))


@inner
def faces_away(row: Array, cx: float, cy: float, clamping: float, doubt: float) -> bool:
    """Return whether a moving peg cannot clamp on a feature because the feature is a line that faces the
    wrong way.

    (cx, cy) is the direction of the pegs' x axis in the part's frame, known to ``doubt`` radians;
    ``clamping`` is 1 or -1 as in ``Limits``. False for arcs. See ``base.feature`` for the layout of ``row``.
    """
    return row[IS_ARC] == 0.0 and clamping * (row[AXIS_Y] * cx - row[AXIS_X] * cy) < -HAIR - doubt


@inner
def are_locators_beyond(angle: Angle, work: BlockWork) -> bool:
    """Return whether the three standing pegs in place certainly have a larger location error than is allowed.

    ``work.triple`` must hold the rows that :func:`write_triple` makes of these pegs.
    """
    triple, length = work.triple, work.limits.wrench_length
    band = bound_minor_error(triple[3, 2], triple[3, 1], length)
    numbers = work.null
    for k in range(3):
        numbers[k] = work.pegs[k, PEG_FEATURE]
    return is_beyond(triple[:3], numbers, 3, triple[4, 0], band, angle.psi, work.features.precision)


@inner
def add_moving_pegs(out: Array, count: int, angle: Angle, reach: float, work: BlockWork) -> int:
    """Try every moving peg with the three standing pegs in ``work.pegs[:3]``; append the fixtures to ``out``.

    Where no pegs move, append the three standing pegs by themselves.

    Returns
    -------
    New number of records, or NO_ROOM_FOR_RECORDS (-1)
    """
    pegs, triple, lattice, limits, features = work.pegs, work.triple, work.lattice, work.limits, work.features
    if has_no_moving_peg(features):
        return add_seat(out, count, angle, reach, work)
    _, cx, cy = angle
    pitch_y, length, rows = lattice.pitch_y, limits.wrench_length, features.rows
    base = cx * pegs[0, PEG_Y] - cy * pegs[0, PEG_X] + lattice.row_offset
    # Points of the part are at most 2 L apart.
    error = pegs[0, PEG_RADIUS] + 4.0 * length * reach
    gap = limits.gap - GAP_SLACK - HAIR - 4.0 * length * reach
    write_triple(triple, pegs, cx, cy, rows, length)
    if limits_errors(work) and are_locators_beyond(angle, work):
        return count
    asks_closure = not work.counting and limits.pairing == 0.0
    for e in range(features.moving[0], features.moving[1]):
        row = rows[e]
        if not work.counting and faces_away(row, cx, cy, limits.clamping, reach):
            continue
        if asks_closure and limits.least_margin > 0.0 and row[IS_ARC] == 0.0:
            lowest, highest = find_closing_heights(triple, row, -cy, cx, error, length)
            if lowest > highest:
                continue
        else:
            lowest, highest = find_height_range(row, -cy, cx)
        first, last = find_lines_between(lowest, highest, base, pitch_y, error)
        # Nor does the side of an arc count that faces away.
        sides = 2 if work.counting or row[IS_ARC] == 0.0 else 1
        begin = 0 if sides == 2 or limits.clamping * row[SIGN] > 0.0 else 1
        for line in range(first, last + 1):
            for k in range(begin, begin + sides):
                meets, x, y, radius = intersect_at_height(
                    row, -cy, cx, base + line * pitch_y, error, 1.0 - 2.0 * k
                )
                if not meets:
                    continue
                if asks_closure and not may_close(triple, row, x, y, radius, cx, cy, gap, limits):
                    continue
                place_peg(pegs[3], x, y, e, 0.0, float(line), radius)
                count = add_listed(out, count, 3.0, angle, reach, True, work)
                if count < 0:
                    return count
    return count
