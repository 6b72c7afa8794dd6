"""The ranges of direction over which a chord exists, with closed-form ends.

A chord of length d from feature a to feature b can begin or cease to exist only where its tail reaches an end of a, its
head reaches an end of b, or the chord is a tangency. All these directions are arc cosines. Between two neighbours of the
sorted list a branch exists throughout or not at all, so one test in the middle decides.

The ranges hold every chord between the features, in spite of rounding: the features' ends have been moved out by far more
than rounding (``contact.curves.LOOSE``), a range too narrow for the test counts wherever the carriers of the features
meet, and what is found past an end is discarded later. The end of a range at a tangency is known to an error that is told.
"""

from __future__ import annotations

from math import acos, atan2, cos, hypot, pi, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from workhold.conventions import EXACT, PARALLEL
from workhold.kernels.base.compiling import inner
from workhold.kernels.chord.coincidences import are_concentric, are_one_chord_apart, beyond_line
from workhold.kernels.chord.evaluation import chord, parameter_on

Array = NDArray[np.float64]

TURN = 2.0 * pi
MOST_EVENTS = 16
# Kinds of events: an end of a feature is reached (ranges are merged over it when the chord exists on both sides), the chord
# is a tangency, or ranges are cut for another reason.
END, TANGENCY, CUT = 0.0, 1.0, 2.0
# Half-width in radians of the sliver left out around a coincidence (see ``chord.coincidences``): there both contacts share
# one line of action; what slides there is covered by the sliding pairs.
SLIVER = 1e-12
# In ranges narrower than this, in radians, the test in the middle cannot be trusted near a tangency.
NARROW = 1e-6
# A chord this far from a tangency, by its X, moves along the features no faster than a hundred times its length.
STEADY = 0.01
# Ends of features are met with this much to spare, in mm: more than rounding, less than they were moved out.
SPARE = 1e-8
# Relative rounding of a cosine, in half units in the last place: differences and products of coordinates, their sum, the
# length of a line's direction, the radius added, and the quotient make eight.
ROUNDINGS = 10.0 * 1.2e-16


@inner
def add_event(events: Array, count: int, alpha: float, kind: float, error: float) -> int:
    """Append a direction, brought into [0, 2 pi), and a bound of its error to the events; return the new count."""
    alpha = alpha % TURN
    events[count, 0] = alpha
    events[count, 1] = kind
    events[count, 2] = error
    return count + 1


@inner
def add_pair(events: Array, count: int, middle: float, cosine: float, kind: float, rounding: float) -> int:
    """Append both solutions of cos(alpha - middle) = cosine, if there are any; ``rounding`` bounds the cosine's error."""
    if abs(cosine) <= 1.0:
        offset = acos(cosine)
        error = 2e-15 + 2.0 * rounding / max(sin(offset), sqrt(rounding))
        count = add_event(events, count, middle + offset, kind, error)
        count = add_event(events, count, middle - offset, kind, error)
    return count


@inner
def point_on(row: Array, parameter: float) -> tuple[float, float]:
    """Point of a feature at a parameter."""
    if row[0] == 0.0:
        return (row[1] + parameter * row[3], row[2] + parameter * row[4])
    c, s = cos(parameter), sin(parameter)
    return (row[1] + row[6] * (c * row[3] - s * row[4]), row[2] + row[6] * (s * row[3] + c * row[4]))


@inner
def add_end_events(events: Array, count: int, moving: Array, fixed: Array, d: float, turned: float) -> int:
    """Directions at which the chord runs from an end of ``moving`` to the carrier of ``fixed``.

    ``turned`` is 0 when ``moving`` carries the tail, pi when it carries the head. A tail on a whole circle reaches its
    seam, where its position jumps by a turn; ranges are cut there.
    """
    ends = 1 if moving[0] != 0.0 and moving[5] >= pi else 2
    kind = CUT if ends == 1 and turned == 0.0 else END
    for k in range(ends):
        x, y = point_on(moving, moving[5] if k == 0 else -moving[5])
        dx, dy = fixed[1] - x, fixed[2] - y
        if fixed[0] == 0.0:
            nx, ny = fixed[4], -fixed[3]
            count = add_pair(events, count, atan2(ny, nx) + turned, (nx * dx + ny * dy) / d, kind, 0.0)
        else:
            apart = hypot(dx, dy)
            if apart > 0.0:
                cosine = (d * d + (apart - fixed[6]) * (apart + fixed[6])) / (2.0 * d * apart)
                count = add_pair(events, count, atan2(dy, dx) + turned, cosine, kind, 0.0)
    return count


@inner
def add_line_tangencies(events: Array, count: int, line: Array, arc: Array, d: float, turned: float) -> int:
    """Directions at which a chord between a line and an arc has parallel normals."""
    nx, ny = line[4], -line[3]
    apart = nx * (arc[1] - line[1]) + ny * (arc[2] - line[2])
    middle = atan2(ny, nx) + turned
    rounding = ROUNDINGS * (abs(arc[1]) + abs(arc[2]) + abs(line[1]) + abs(line[2]) + arc[6] + d) / d
    if beyond_line(line, arc, d) != 0.0:
        straight = middle if beyond_line(line, arc, d) > 0.0 else middle + pi
        count = add_event(events, count, straight - SLIVER, CUT, 0.0)
        count = add_event(events, count, straight + SLIVER, CUT, 0.0)
        other = (apart - arc[6]) / d if beyond_line(line, arc, d) > 0.0 else (apart + arc[6]) / d
        return add_pair(events, count, middle, other, TANGENCY, rounding)
    count = add_pair(events, count, middle, (apart + arc[6]) / d, TANGENCY, rounding)
    return add_pair(events, count, middle, (apart - arc[6]) / d, TANGENCY, rounding)


@inner
def add_arc_tangencies(events: Array, count: int, a: Array, b: Array, d: float) -> int:
    """Directions at which a chord between two arcs has parallel normals."""
    dx, dy = b[1] - a[1], b[2] - a[2]
    apart = hypot(dx, dy)
    if apart == 0.0:
        return count
    middle = atan2(dy, dx)
    if are_one_chord_apart(a, b, d):
        count = add_event(events, count, middle - SLIVER, CUT, 0.0)
        count = add_event(events, count, middle + SLIVER, CUT, 0.0)
    else:
        count = add_gap(events, count, middle, apart, d, a, b, a[6] - b[6])
    return add_gap(events, count, middle, apart, d, a, b, a[6] + b[6])


@inner
def add_gap(events: Array, count: int, middle: float, apart: float, d: float, a: Array, b: Array, gap: float) -> int:
    """Append the tangencies at which the centre of b, moved back by the chord, is ``gap`` away from the centre of a.

    That distance is g with g^2 = (apart - d)^2 + 4 apart d sin(gamma / 2)^2, gamma the angle between chord and centres.
    """
    difference = apart - d
    rounding = ROUNDINGS * (abs(a[1]) + abs(a[2]) + abs(b[1]) + abs(b[2]) + a[6] + b[6] + d)
    square = (gap - difference) * (gap + difference) / (4.0 * apart * d)
    error = 2.0 * rounding * (abs(gap) + abs(difference) + rounding) / (4.0 * apart * d) + ROUNDINGS * abs(square)
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
    """All directions at which a chord may begin or cease to exist, sorted; return their number."""
    count = add_end_events(events, int(np.int64(0)), a, b, d, 0.0)
    count = add_end_events(events, count, b, a, d, pi)
    if a[0] == 0.0 and b[0] != 0.0:
        count = add_line_tangencies(events, count, a, b, d, 0.0)
    elif a[0] != 0.0 and b[0] == 0.0:
        count = add_line_tangencies(events, count, b, a, d, pi)
    elif a[0] != 0.0:
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
    """Whether a chord of a direction fits between the lines and circles that carry two features."""
    wx, wy = d * cos(alpha), d * sin(alpha)
    if a[0] == 0.0 and b[0] != 0.0:
        return abs(a[4] * (a[1] + wx - b[1]) - a[3] * (a[2] + wy - b[2])) < b[6]
    if a[0] != 0.0 and b[0] == 0.0:
        return abs(b[4] * (b[1] - wx - a[1]) - b[3] * (b[2] - wy - a[2])) < a[6]
    if a[0] != 0.0:
        gap = hypot(b[1] - a[1] - wx, b[2] - a[2] - wy)
        return abs(a[6] - b[6]) < gap < a[6] + b[6]
    return True


@inner
def only_touch(a: Array, b: Array, d: float) -> bool:
    """Whether a chord of length d between two carriers, one of them an arc, exists at one direction only or at none.

    Its contacts then share one line of action, and nothing closes.
    """
    if a[0] != 0.0 and b[0] != 0.0:
        apart = hypot(b[1] - a[1], b[2] - a[2])
        return abs(apart - d) >= a[6] + b[6] - EXACT or apart + d <= abs(a[6] - b[6]) + EXACT
    line, arc = (a, b) if a[0] == 0.0 else (b, a)
    apart = line[4] * (arc[1] - line[1]) - line[3] * (arc[2] - line[2])
    return arc[0] != 0.0 and abs(apart) - d >= arc[6] - EXACT


@inner
def reaches(row: Array, x: float, y: float) -> bool:
    """Whether a point of a feature's carrier is on the feature, or past its end by no more than ``SPARE``."""
    spare = SPARE if row[0] == 0.0 else SPARE / row[6]
    return abs(parameter_on(row, x, y)) <= row[5] + spare


@inner
def exists(a: Array, b: Array, d: float, alpha: float, branch: float) -> bool:
    """Whether a chord of a direction lies on both features."""
    if not carriers_meet(a, b, d, alpha):
        return False
    c = chord(a, b, d, alpha, branch)
    return reaches(a, c[0], c[1]) and reaches(b, c[0] + d * cos(alpha), c[1] + d * sin(alpha))


@inner
def is_alive(
    a: Array, b: Array, d: float, branch: float, low: float, high: float, kind_low: float, kind_high: float
) -> bool:
    """Whether a branch may exist between two neighbouring events."""
    middle = (low + high) / 2.0
    if high - low > NARROW:
        return exists(a, b, d, middle, branch)
    if not carriers_meet(a, b, d, middle):
        return False
    if high - low > 3.0 * SLIVER:
        return True
    if kind_low == TANGENCY or kind_high == TANGENCY:
        return high > low
    if kind_low == CUT or kind_high == CUT:
        return False
    # Both are ends: a steady chord cannot come in from a loosened end as far as the true one.
    c = chord(a, b, d, middle, branch)
    return high > low and abs(c[2] * c[5] - c[3] * c[4]) < STEADY


@inner
def chord_intervals(a: Array, b: Array, d: float) -> Array:
    """All ranges of direction of a chord of length d from feature a to feature b.

    Parameters
    ----------
    a, b : (8,) feature rows.
    d : length in mm, positive.

    Returns
    -------
    (N, 5) array
        Columns: lowest and highest alpha in radians (lowest in [0, 4 pi)), branch, and for the lowest and the highest
        alpha a bound of its error in radians when the chord is a tangency there, 0 when it is not. Parallel lines give
        none: their chords are sliding pairs. Nor do concentric arcs whose chord lies on a line through the centre: their
        contacts share one line of action.
    """
    if are_concentric(a, b) and min(abs(d - a[6] - b[6]), abs(d - abs(a[6] - b[6]))) <= EXACT:
        return np.empty((0, 5))
    if a[0] == 0.0 and b[0] == 0.0 and abs(a[3] * b[4] - a[4] * b[3]) <= PARALLEL:
        return np.empty((0, 5))
    if only_touch(a, b, d):
        return np.empty((0, 5))
    events = np.empty((MOST_EVENTS, 3))
    count = collect_events(events, a, b, d)
    branches = 1 if a[0] == 0.0 and b[0] == 0.0 else 2
    out = np.empty((2 * (count + 1), 5))
    found = int(np.int64(0))
    for k in range(branches):
        branch = 1.0 if k == 0 else -1.0
        if count == 0:
            if exists(a, b, d, 0.5, branch):
                out[found, 0], out[found, 1], out[found, 2] = 0.0, TURN, branch
                out[found, 3], out[found, 4] = 0.0, 0.0
                found += 1
            continue
        found = branch_intervals(events, count, a, b, d, branch, out, found)
    return out[:found]


@inner
def branch_intervals(
    events: Array, count: int, a: Array, b: Array, d: float, branch: float, out: Array, found: int
) -> int:
    """Write the ranges of one branch to ``out`` from row ``found`` on; return the new number of rows."""
    alive = np.empty(count, np.bool_)
    start = -1
    for i in range(count):
        low = events[i, 0]
        high = events[i + 1, 0] if i + 1 < count else events[0, 0] + TURN
        alive[i] = is_alive(a, b, d, branch, low, high, events[i, 1], events[(i + 1) % count, 1])
        if not alive[i]:
            start = i
    # Begin behind a gap, so that no range is split where the circle of directions is cut.
    first = (start + 1) % count
    open_range = False
    for step in range(count):
        i = (first + step) % count
        lap = TURN if first + step >= count else 0.0
        low = events[i, 0] + lap
        high = (events[i + 1, 0] if i + 1 < count else events[0, 0] + TURN) + lap
        if not alive[i]:
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
