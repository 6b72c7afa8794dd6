"""The ranges of direction over which a chord exists, with closed-form ends.

A chord of length d from feature a to feature b can begin or cease to exist only where its tail reaches an end of a, its
head reaches an end of b, or the chord is a tangency. All these directions are arc cosines. Between two neighbours of the
sorted list a branch exists throughout or not at all, so one test in the middle decides.
"""

from __future__ import annotations

from math import acos, atan2, cos, hypot, pi, sin

import numpy as np
from numpy.typing import NDArray

from holdfast.kernels.chord import CONCENTRIC, are_concentric, are_one_chord_apart, chord, parameter_on
from holdfast.kernels.compiling import compiled
from holdfast.kernels.through_motion import beyond_line

Array = NDArray[np.float64]

TURN = 2.0 * pi
# Lines whose directions' cross product is below this are parallel (within 1e-9 rad).
PARALLEL = 1e-9
MOST_EVENTS = 16
# Kinds of events: an end of a feature is reached (ranges are merged over it when the chord exists on both sides), the chord
# is a tangency, or ranges are cut for another reason.
END, TANGENCY, CUT = 0.0, 1.0, 2.0
# Half-width in radians of the sliver left out around a coincidence (see ``through_motion``): there both contacts share one
# line of action; what slides there is covered by the uprights. Nothing narrower than a sliver counts as a range.
SLIVER = 1e-12


@compiled
def add_event(events: Array, count: int, alpha: float, kind: float) -> int:
    """Append a direction, brought into [0, 2 pi), to the events; return the new count."""
    alpha = alpha % TURN
    events[count, 0] = alpha
    events[count, 1] = kind
    return count + 1


@compiled
def add_pair(events: Array, count: int, middle: float, cosine: float, kind: float) -> int:
    """Append both solutions of cos(alpha - middle) = cosine, if there are any."""
    if abs(cosine) <= 1.0:
        offset = acos(cosine)
        count = add_event(events, count, middle + offset, kind)
        count = add_event(events, count, middle - offset, kind)
    return count


@compiled
def point_on(row: Array, parameter: float) -> tuple[float, float]:
    """Point of a feature at a parameter."""
    if row[0] == 0.0:
        return (row[1] + parameter * row[3], row[2] + parameter * row[4])
    c, s = cos(parameter), sin(parameter)
    return (row[1] + row[6] * (c * row[3] - s * row[4]), row[2] + row[6] * (s * row[3] + c * row[4]))


@compiled
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
            count = add_pair(events, count, atan2(ny, nx) + turned, (nx * dx + ny * dy) / d, kind)
        else:
            apart = hypot(dx, dy)
            if apart > 0.0:
                cosine = (d * d + (apart - fixed[6]) * (apart + fixed[6])) / (2.0 * d * apart)
                count = add_pair(events, count, atan2(dy, dx) + turned, cosine, kind)
    return count


@compiled
def add_line_tangencies(events: Array, count: int, line: Array, arc: Array, d: float, turned: float) -> int:
    """Directions at which a chord between a line and an arc has parallel normals."""
    nx, ny = line[4], -line[3]
    apart = nx * (arc[1] - line[1]) + ny * (arc[2] - line[2])
    middle = atan2(ny, nx) + turned
    if beyond_line(line, arc, d) != 0.0:
        straight = middle if beyond_line(line, arc, d) > 0.0 else middle + pi
        count = add_event(events, count, straight - SLIVER, CUT)
        count = add_event(events, count, straight + SLIVER, CUT)
        other = (apart - arc[6]) / d if beyond_line(line, arc, d) > 0.0 else (apart + arc[6]) / d
        return add_pair(events, count, middle, other, TANGENCY)
    count = add_pair(events, count, middle, (apart + arc[6]) / d, TANGENCY)
    return add_pair(events, count, middle, (apart - arc[6]) / d, TANGENCY)


@compiled
def add_arc_tangencies(events: Array, count: int, a: Array, b: Array, d: float) -> int:
    """Directions at which a chord between two arcs has parallel normals."""
    dx, dy = b[1] - a[1], b[2] - a[2]
    apart = hypot(dx, dy)
    if apart == 0.0:
        return count
    middle = atan2(dy, dx)
    if are_one_chord_apart(a, b, d):
        count = add_event(events, count, middle - SLIVER, CUT)
        count = add_event(events, count, middle + SLIVER, CUT)
    else:
        inner = a[6] - b[6]
        count = add_pair(events, count, middle, (apart * apart + d * d - inner * inner) / (2.0 * d * apart), TANGENCY)
    outer = a[6] + b[6]
    return add_pair(events, count, middle, (apart * apart + d * d - outer * outer) / (2.0 * d * apart), TANGENCY)


@compiled
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
        alpha, kind = events[i, 0], events[i, 1]
        j = i
        while j > 0 and events[j - 1, 0] > alpha:
            events[j, 0], events[j, 1] = events[j - 1, 0], events[j - 1, 1]
            j -= 1
        events[j, 0], events[j, 1] = alpha, kind
    return count


@compiled
def exists(a: Array, b: Array, d: float, alpha: float, branch: float) -> bool:
    """Whether a chord of a direction lies on both features."""
    wx, wy = d * cos(alpha), d * sin(alpha)
    if a[0] == 0.0 and b[0] != 0.0:
        across = a[4] * (a[1] + wx - b[1]) - a[3] * (a[2] + wy - b[2])
        if abs(across) >= b[6]:
            return False
    elif a[0] != 0.0 and b[0] == 0.0:
        across = b[4] * (b[1] - wx - a[1]) - b[3] * (b[2] - wy - a[2])
        if abs(across) >= a[6]:
            return False
    elif a[0] != 0.0:
        gap = hypot(b[1] - a[1] - wx, b[2] - a[2] - wy)
        if gap <= abs(a[6] - b[6]) or gap >= a[6] + b[6]:
            return False
    c = chord(a, b, d, alpha, branch)
    if abs(parameter_on(a, c[0], c[1])) > a[5]:
        return False
    return abs(parameter_on(b, c[0] + wx, c[1] + wy)) <= b[5]


@compiled
def chord_intervals(a: Array, b: Array, d: float) -> Array:
    """All ranges of direction of a chord of length d from feature a to feature b.

    Parameters
    ----------
    a, b : (8,) feature rows.
    d : length in mm, positive.

    Returns
    -------
    (N, 5) array
        Columns: lowest and highest alpha in radians (lowest in [0, 4 pi)), branch, whether the chord is a tangency at the
        lowest and at the highest (1) or not (0). Parallel lines give none: their chords are uprights. Nor do concentric
        arcs whose chord lies on a line through the centre: their contacts share one line of action.
    """
    if are_concentric(a, b) and min(abs(d - a[6] - b[6]), abs(d - abs(a[6] - b[6]))) <= CONCENTRIC:
        return np.empty((0, 5))
    if a[0] == 0.0 and b[0] == 0.0 and abs(a[3] * b[4] - a[4] * b[3]) <= PARALLEL:
        return np.empty((0, 5))
    events = np.empty((MOST_EVENTS, 2))
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


@compiled
def branch_intervals(
    events: Array, count: int, a: Array, b: Array, d: float, branch: float, out: Array, found: int
) -> int:
    """Write the ranges of one branch to ``out`` from row ``found`` on; return the new number of rows."""
    alive = np.empty(count, np.bool_)
    start = -1
    for i in range(count):
        low = events[i, 0]
        high = events[i + 1, 0] if i + 1 < count else events[0, 0] + TURN
        alive[i] = high - low > 3.0 * SLIVER and exists(a, b, d, (low + high) / 2.0, branch)
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
            out[found, 0], out[found, 2], out[found, 3] = low, branch, 1.0 if events[i, 1] == TANGENCY else 0.0
            found += 1
        out[found - 1, 1] = high
        out[found - 1, 4] = 1.0 if events[(i + 1) % count, 1] == TANGENCY else 0.0
        open_range = True
    return found
