"""Ranges of direction over which a chord exists, with closed-form ends.

A chord of length d from feature a to feature b can begin or cease to exist in three ways only. Its tail
reaches an end of a, its head reaches an end of b, or the chord is a tangency. All these directions are arc
cosines. Between two neighbours of the sorted list a branch exists throughout or not at all, so one test in
the middle decides.

The ranges hold every chord between the features, in spite of rounding. The features' ends have been moved out
by far more than rounding (``conventions.LOOSE``). A range too narrow for the test counts wherever the
carriers of the features meet, and contacts found past an end are discarded later. The end of a range at a
tangency is known to a stated error.
"""

from __future__ import annotations

from math import acos, atan2, cos, hypot, pi, sin, sqrt

import numpy as np

from workhold.conventions import EXACT, PARALLEL, SQUARE
from workhold.kernels.base.compiling import Array, inner
from workhold.kernels.base.feature import (
    AXIS_X,
    AXIS_Y,
    HALF_EXTENT,
    IS_ARC,
    RADIUS,
    X,
    Y,
    compute_local_size,
    compute_point,
    find_arc_middle,
    is_shallow,
)
from workhold.kernels.base.interval import TURN
from workhold.kernels.chord.coincidences import (
    are_concentric,
    are_one_chord_apart,
    find_line_side,
    find_touching_side,
)
from workhold.kernels.chord.evaluation import compute_chord, find_parameter
from workhold.kernels.chord.shallow import compute_tangent_offset, does_shallow_chord_fit, enclose_arcs_cosine

MOST_EVENTS = 16
# The column of an event that says whether the branch exists behind it.
ALIVE = 3
MOST_RANGES = 2 * (MOST_EVENTS + 1)
# Kinds of events: an end of a feature is reached (ranges are merged over it when the chord exists on both
# sides), the chord is a tangency, or ranges are cut for another reason.
END, TANGENCY, CUT = 0.0, 1.0, 2.0
# Half-width in radians of the sliver left out around a coincidence (see ``chord.coincidences``): there both
# contacts share one line of action; what slides there is covered by the sliding pairs.
SLIVER = 1e-12
# In ranges narrower than this, in radians, the test in the middle cannot be trusted near a tangency.
NARROW = 1e-6
# This far from a tangency, by X, a chord moves along features no faster than a hundred times its length.
STEADY = 0.01
# Ends of features are met with this much to spare, in mm: more than rounding, less than they were moved out.
SPARE = 1e-8
# Relative rounding of a cosine, in half units in the last place: differences and products of coordinates,
# their sum, the length of a line's direction, the radius added, and the quotient make eight.
ROUNDINGS = 10.0 * 1.2e-16


@inner
def add_event(events: Array, count: int, alpha: float, kind: float, error: float) -> int:
    """Append an event to ``events``: the direction alpha brought into
    [0, 2 pi), its kind, and a bound of its error.

    All angles are in radians. Return the new number of events. See ``chord.intervals`` for the layout of
    ``events``.
    """
    alpha = alpha % TURN
    events[count, 0] = alpha
    events[count, 1] = kind
    events[count, 2] = error
    return count + 1


@inner
def add_pair(events: Array, count: int, middle: float, cosine: float, kind: float, rounding: float) -> int:
    """Append both solutions alpha of cos(alpha - middle) = cosine as events of a kind; none where |cosine| >
    1.

    ``rounding`` bounds the cosine's error. Return the new number of events. See ``chord.intervals`` for the
    layout of ``events``.
    """
    if abs(cosine) <= 1.0:
        offset = acos(cosine)
        error = 2e-15 + 2.0 * rounding / max(sin(offset), sqrt(rounding))
        count = add_event(events, count, middle + offset, kind, error)
        count = add_event(events, count, middle - offset, kind, error)
    return count


@inner
def add_end_events(events: Array, count: int, moving: Array, fixed: Array, d: float, turned: float) -> int:
    """Append the directions at which the chord runs from an end of
    ``moving`` to the line or circle of ``fixed``.

    ``turned`` is 0 when ``moving`` carries the tail, pi when it carries the head. A tail on a whole circle
    reaches its seam, where its position jumps by a turn; ranges are cut there. Return the new number of
    events. See ``chord.intervals`` for the layout of ``events``, ``base.feature`` for that of ``moving`` and
    ``fixed``.
    """
    ends = 1 if moving[IS_ARC] != 0.0 and moving[HALF_EXTENT] >= pi else 2
    kind = CUT if ends == 1 and turned == 0.0 else END
    for k in range(ends):
        x, y = compute_point(moving, moving[HALF_EXTENT] if k == 0 else -moving[HALF_EXTENT])
        dx, dy = fixed[X] - x, fixed[Y] - y
        if fixed[IS_ARC] == 0.0:
            nx, ny = fixed[AXIS_Y], -fixed[AXIS_X]
            count = add_pair(events, count, atan2(ny, nx) + turned, (nx * dx + ny * dy) / d, kind, 0.0)
        elif is_shallow(fixed):
            # With y from the arc's middle to the end: w . (t + k y) = -k (|y|^2 + d^2) / 2 - y . t.
            mx, my = find_arc_middle(fixed)
            dx, dy, k = x - mx, y - my, 1.0 / fixed[RADIUS]
            rx, ry = fixed[AXIS_X] + k * dx, fixed[AXIS_Y] + k * dy
            size = hypot(rx, ry)
            cosine = -(k * (dx * dx + dy * dy + d * d) / 2.0 + dx * fixed[AXIS_X] + dy * fixed[AXIS_Y]) / (
                d * size
            )
            count = add_pair(events, count, atan2(ry, rx) + turned, cosine, kind, 0.0)
        else:
            apart = hypot(dx, dy)
            if apart > 0.0:
                cosine = (d * d + (apart - fixed[RADIUS]) * (apart + fixed[RADIUS])) / (2.0 * d * apart)
                count = add_pair(events, count, atan2(dy, dx) + turned, cosine, kind, 0.0)
    return count


@inner
def add_line_tangencies(events: Array, count: int, line: Array, arc: Array, d: float, turned: float) -> int:
    """Append the directions at which a chord between a line and an arc is a tangency, or at which ranges are
    cut because of a coincidence.

    ``turned`` is 0 when the tail is on the line, pi when the head is. Return the new number of events. See
    ``chord.intervals`` for the layout of ``events``, ``base.feature`` for that of ``line`` and ``arc``.
    """
    nx, ny = line[AXIS_Y], -line[AXIS_X]
    middle = atan2(ny, nx) + turned
    if is_shallow(arc):
        mx, my = find_arc_middle(arc)
        apart = nx * (mx - line[X]) + ny * (my - line[Y]) + compute_tangent_offset(line, arc)
        rounding = ROUNDINGS * (compute_local_size(arc) + abs(line[X]) + abs(line[Y]) + abs(apart) + d) / d
        return add_pair(events, count, middle, apart / d, TANGENCY, rounding)
    apart = nx * (arc[X] - line[X]) + ny * (arc[Y] - line[Y])
    rounding = ROUNDINGS * (abs(arc[X]) + abs(arc[Y]) + abs(line[X]) + abs(line[Y]) + arc[RADIUS] + d) / d
    if find_line_side(line, arc, d) != 0.0:
        straight = middle if find_line_side(line, arc, d) > 0.0 else middle + pi
        count = add_event(events, count, straight - SLIVER, CUT, 0.0)
        count = add_event(events, count, straight + SLIVER, CUT, 0.0)
        other = (apart - arc[RADIUS]) / d if find_line_side(line, arc, d) > 0.0 else (apart + arc[RADIUS]) / d
        return add_pair(events, count, middle, other, TANGENCY, rounding)
    count = add_pair(events, count, middle, (apart + arc[RADIUS]) / d, TANGENCY, rounding)
    return add_pair(events, count, middle, (apart - arc[RADIUS]) / d, TANGENCY, rounding)


@inner
def add_arc_tangencies(events: Array, count: int, a: Array, b: Array, d: float) -> int:
    """Append the directions at which a chord between two arcs is a tangency, or at which ranges are cut
    because of a coincidence.

    Return the new number of events. See ``chord.intervals`` for the layout of ``events``, ``base.feature``
    for that of ``a`` and ``b``.
    """
    dx, dy = b[X] - a[X], b[Y] - a[Y]
    apart = hypot(dx, dy)
    if apart == 0.0:
        return count
    middle, side = atan2(dy, dx), find_touching_side(a, b, d)
    if side != 0.0:
        straight = middle if side > 0.0 else middle + pi
        count = add_event(events, count, straight - SLIVER, CUT, 0.0)
        count = add_event(events, count, straight + SLIVER, CUT, 0.0)
        other = a[RADIUS] + side * b[RADIUS]
        return add_gap(events, count, middle, apart, d, a, b, other)
    if are_one_chord_apart(a, b, d):
        count = add_event(events, count, middle - SLIVER, CUT, 0.0)
        count = add_event(events, count, middle + SLIVER, CUT, 0.0)
    elif is_shallow(a) or is_shallow(b):
        near, far, swing, beta = enclose_arcs_cosine(a, b, d)
        rounding = (near[1] - near[0] + far[1] - far[0]) / (2.0 * swing) + ROUNDINGS
        count = add_pair(events, count, beta, (near[0] + near[1]) / (2.0 * swing), TANGENCY, rounding)
        return add_pair(events, count, beta, -(far[0] + far[1]) / (2.0 * swing), TANGENCY, rounding)
    else:
        count = add_gap(events, count, middle, apart, d, a, b, a[RADIUS] - b[RADIUS])
    return add_gap(events, count, middle, apart, d, a, b, a[RADIUS] + b[RADIUS])


@inner
def add_gap(
    events: Array, count: int, middle: float, apart: float, d: float, a: Array, b: Array, gap: float
) -> int:
    """Append the tangencies at which the centre of b, moved back by
    the chord, is ``gap`` away from the centre of a.

    That distance is g with g^2 = (apart - d)^2 + 4 apart d sin(gamma / 2)^2, gamma the angle between chord
    and centres' line. ``middle`` is the direction of that line in radians, ``apart`` its length in mm. Return
    the new number of events. See ``chord.intervals`` for the layout of ``events``, ``base.feature`` for that
    of ``a`` and ``b``.
    """
    difference = apart - d
    rounding = ROUNDINGS * (abs(a[X]) + abs(a[Y]) + abs(b[X]) + abs(b[Y]) + a[RADIUS] + b[RADIUS] + d)
    square = (gap - difference) * (gap + difference) / (4.0 * apart * d)
    error = 2.0 * rounding * (abs(gap) + abs(difference) + rounding) / (4.0 * apart * d) + ROUNDINGS * abs(
        square
    )
    if not 0.0 <= square <= 1.0:
        return count
    sine, cosine = sqrt(square), sqrt(1.0 - square)
    gamma = 2.0 * atan2(sine, cosine)
    # d(gamma) = d(square) / (sine cosine); where that is 0 the error is that of the root.
    spread = 2e-15 + 2.0 * error / max(sine * cosine, sqrt(error))
    count = add_event(events, count, middle + gamma, TANGENCY, spread)
    return add_event(events, count, middle - gamma, TANGENCY, spread)


@inner
def collect_events(events: Array, a: Array, b: Array, d: float) -> int:
    """Write all directions at which a chord may begin or cease to exist to ``events``, in ascending order.

    Columns: alpha in [0, 2 pi), kind, bound of its error. Return their number. See ``chord.intervals`` for
    the layout of ``events``, ``base.feature`` for that of ``a`` and ``b``.
    """
    count = add_end_events(events, int(np.int64(0)), a, b, d, 0.0)
    count = add_end_events(events, count, b, a, d, pi)
    if a[IS_ARC] == 0.0 and b[IS_ARC] != 0.0:
        count = add_line_tangencies(events, count, a, b, d, 0.0)
    elif a[IS_ARC] != 0.0 and b[IS_ARC] == 0.0:
        count = add_line_tangencies(events, count, b, a, d, pi)
    elif a[IS_ARC] != 0.0:
        count = add_arc_tangencies(events, count, a, b, d)
    for i in range(1, count):
        alpha, kind, error = events[i, 0], events[i, 1], events[i, 2]
        j = i
        while j > 0 and events[j - 1, 0] > alpha:
            events[j, 0], events[j, 1], events[j, 2] = events[j - 1, 0], events[j - 1, 1], events[j - 1, 2]
            j -= 1
        events[j, 0], events[j, 1], events[j, 2] = alpha, kind, error
    return count


@inner
def carriers_meet(a: Array, b: Array, d: float, alpha: float) -> bool:
    """Return whether a chord of direction alpha fits between the whole lines or circles of two features.

    See ``base.feature`` for the layout of ``a`` and ``b``.
    """
    wx, wy = d * cos(alpha), d * sin(alpha)
    if is_shallow(a) or is_shallow(b):
        return does_shallow_chord_fit(a, b, wx, wy)
    if a[IS_ARC] == 0.0 and b[IS_ARC] != 0.0:
        return abs(a[AXIS_Y] * (a[X] + wx - b[X]) - a[AXIS_X] * (a[Y] + wy - b[Y])) < b[RADIUS]
    if a[IS_ARC] != 0.0 and b[IS_ARC] == 0.0:
        return abs(b[AXIS_Y] * (b[X] - wx - a[X]) - b[AXIS_X] * (b[Y] - wy - a[Y])) < a[RADIUS]
    if a[IS_ARC] != 0.0:
        gap = hypot(b[X] - a[X] - wx, b[Y] - a[Y] - wy)
        return abs(a[RADIUS] - b[RADIUS]) < gap < a[RADIUS] + b[RADIUS]
    return True


@inner
def can_only_touch(a: Array, b: Array, d: float) -> bool:
    """Return whether a chord of length d between two whole lines or circles exists at one direction at most.

    Its contacts then share one line of action, and nothing closes. Return False for two lines, and for
    shallow arcs, whose ranges are short in any case. See ``base.feature`` for the layout of ``a`` and ``b``.
    """
    if is_shallow(a) or is_shallow(b):
        return False
    if a[IS_ARC] != 0.0 and b[IS_ARC] != 0.0:
        apart = hypot(b[X] - a[X], b[Y] - a[Y])
        return (
            abs(apart - d) >= a[RADIUS] + b[RADIUS] - EXACT or apart + d <= abs(a[RADIUS] - b[RADIUS]) + EXACT
        )
    line, arc = (a, b) if a[IS_ARC] == 0.0 else (b, a)
    apart = line[AXIS_Y] * (arc[X] - line[X]) - line[AXIS_X] * (arc[Y] - line[Y])
    return arc[IS_ARC] != 0.0 and abs(apart) - d >= arc[RADIUS] - EXACT


@inner
def are_parallel(a: Array, b: Array) -> bool:
    """Return whether two features are parallel lines.

    See ``base.feature`` for the layout of ``a`` and ``b``.
    """
    is_straight = a[IS_ARC] == 0.0 and b[IS_ARC] == 0.0
    return is_straight and abs(a[AXIS_X] * b[AXIS_Y] - a[AXIS_Y] * b[AXIS_X]) <= PARALLEL


@inner
def share_one_line(a: Array, b: Array, d: float) -> bool:
    """Return whether two pegs d mm apart, wherever they touch two features, push along one common line of
    action.

    This is the case (a) between parallel lines, square to them, (b) on a diameter through a common centre,
    and (c) where the lines or circles, moved by the chord, only touch. Wrenches of opposite or equal contacts
    are dependent: with a third they fix no pose, and nothing closes. See ``base.feature`` for the layout of
    ``a`` and ``b``.
    """
    if are_parallel(a, b):
        apart = a[AXIS_Y] * (b[X] - a[X]) - a[AXIS_X] * (b[Y] - a[Y])
        return abs(apart) >= d * (1.0 - SQUARE)
    if are_concentric(a, b):
        return min(abs(d - a[RADIUS] - b[RADIUS]), abs(d - abs(a[RADIUS] - b[RADIUS]))) <= EXACT
    return can_only_touch(a, b, d)


@inner
def reaches(row: Array, x: float, y: float) -> bool:
    """Return whether a point of a feature's line or circle is on the
    feature, or beyond its end by at most ``SPARE`` mm.

    See ``base.feature`` for the layout of ``row``.
    """
    spare = SPARE if row[IS_ARC] == 0.0 else SPARE / row[RADIUS]
    return abs(find_parameter(row, x, y)) <= row[HALF_EXTENT] + spare


@inner
def has_chord(a: Array, b: Array, d: float, alpha: float, branch: float) -> bool:
    """Return whether a chord of length d, direction alpha and a branch lies on both features.

    See ``base.feature`` for the layout of ``a`` and ``b``.
    """
    if not carriers_meet(a, b, d, alpha):
        return False
    c = compute_chord(a, b, d, alpha, branch)
    return reaches(a, c.x, c.y) and reaches(b, c.x + d * cos(alpha), c.y + d * sin(alpha))


@inner
def may_branch_exist(
    a: Array, b: Array, d: float, branch: float, low: float, high: float, kind_low: float, kind_high: float
) -> bool:
    """Return whether a branch may exist between two neighbouring events at ``low`` and ``high``.

    ``kind_low`` and ``kind_high`` are the kinds of the events. See ``base.feature`` for the layout of ``a``
    and ``b``.
    """
    middle = (low + high) / 2.0
    if high - low > NARROW:
        return has_chord(a, b, d, middle, branch)
    if not carriers_meet(a, b, d, middle):
        return False
    if high - low > 3.0 * SLIVER:
        return True
    if kind_low == TANGENCY or kind_high == TANGENCY:
        return high > low
    if kind_low == CUT or kind_high == CUT:
        return False
    # Both are ends: a steady chord cannot come in from a loosened end as far as the true one.
    c = compute_chord(a, b, d, middle, branch)
    return high > low and abs(c.ax * c.by - c.ay * c.bx) < STEADY


@inner
def write_chord_intervals(a: Array, b: Array, d: float, events: Array, out: Array) -> int:
    """Write all ranges of direction of a chord of length d from
    feature a to feature b to ``out``; return their number.

    Parallel lines give none: their chords are sliding pairs. Nor do features that the chord always touches
    along one line of action, see :func:`share_one_line`. See ``base.feature`` for the layout of ``a`` and
    ``b``, ``chord.intervals`` for that of ``events``.

    Parameters
    ----------
    a, b : feature rows.
    d : length in mm, positive.
    events : (MOST_EVENTS, 4) work space.
    out : (MOST_RANGES, 5) receives the ranges. Columns: lowest and highest alpha in radians (lowest in [0, 4
        pi)), branch, and for both alphas a bound of its error in radians when the chord is a tangency there,
        0 when it is not.
    """
    if are_parallel(a, b) or share_one_line(a, b, d):
        return 0
    count = collect_events(events, a, b, d)
    branches = 1 if a[IS_ARC] == 0.0 and b[IS_ARC] == 0.0 else 2
    found = int(np.int64(0))
    for k in range(branches):
        branch = 1.0 if k == 0 else -1.0
        if count == 0:
            if has_chord(a, b, d, 0.5, branch):
                out[found, 0], out[found, 1], out[found, 2] = 0.0, TURN, branch
                out[found, 3], out[found, 4] = 0.0, 0.0
                found += 1
            continue
        found = write_branch_intervals(events, count, a, b, d, branch, out, found)
    return found


@inner
def write_branch_intervals(
    events: Array, count: int, a: Array, b: Array, d: float, branch: float, out: Array, found: int
) -> int:
    """Write the ranges of one branch to ``out`` from row ``found`` on; return the new number of rows.

    ``count`` is the number of ``events``, at least 1; their column ALIVE is overwritten. See
    ``chord.intervals`` for the layout of ``events``, ``base.feature`` for that of ``a`` and ``b``.
    """
    start = -1
    for i in range(count):
        low = events[i, 0]
        high = events[i + 1, 0] if i + 1 < count else events[0, 0] + TURN
        alive = may_branch_exist(a, b, d, branch, low, high, events[i, 1], events[(i + 1) % count, 1])
        events[i, ALIVE] = 1.0 if alive else 0.0
        if not alive:
            start = i
    # Begin behind a gap, so that no range is split where the circle of directions is cut.
    first = (start + 1) % count
    open_range = False
    for step in range(count):
        i = (first + step) % count
        lap = TURN if first + step >= count else 0.0
        low = events[i, 0] + lap
        high = (events[i + 1, 0] if i + 1 < count else events[0, 0] + TURN) + lap
        if events[i, ALIVE] == 0.0:
            open_range = False
            continue
        if open_range and events[i, 1] == END:
            out[found - 1, 1] = high
        else:
            out[found, 0], out[found, 2] = low, branch
            out[found, 3] = events[i, 2] if events[i, 1] == TANGENCY else 0.0
            found += 1
        out[found - 1, 1] = high
        following = (i + 1) % count
        out[found - 1, 4] = events[following, 2] if events[following, 1] == TANGENCY else 0.0
        open_range = True
    return found
