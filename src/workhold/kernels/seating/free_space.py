"""Where a part is free between pegs: slices of the C-space, and directions in which it can be taken away.

In a slice at one orientation and height a part's free places along x are intervals for each jaw. Places are
counted from the part's place in its seat, with both jaws as they stand there. With the jaws opened by s, x in
an interval of the left and x - s in one of the right is free. A pair of intervals is open below s where the
low end of the left less the high end of the right is less.

A part is taken away straight with the jaws as they stand. Seen from a peg's centre, the directions in which
it meets a piece of the boundary from outside are a range. So are those that lead into a piece that it
touches. Where the ranges of all pegs, and of a wall, leave any direction, they leave the end of one of them.

Glossary
--------
slice : a part of the C-space in which a coordinate has one value: T. Lozano-Perez, "Spatial planning: a
    configuration space approach", IEEE Transactions on Computers C-32 (1983).
"""

from __future__ import annotations

from math import acos, atan2, cos, floor, hypot, inf, isnan, nan, pi, sin, sqrt

from workhold.kernels.base.compiling import (
    Array,
    Matrix,
    Stack,
    Vector,
    compiled,
    inner,
)
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, RADIUS, SIGN, X, Y
from workhold.kernels.seating.columns import Obstacles
from workhold.kernels.seating.obstacles import (
    compute_angle_from_middle,
    compute_length,
    compute_normal,
    compute_turned_place,
    cut_by_wall,
    is_on_piece,
)
from workhold.kernels.seating.two_contact_curves import measure_gap

# Intervals of a jaw that are kept at one place, and crossings that are looked at.
MOST_INTERVALS, MOST_CROSSINGS = 6, 256
# A grid does not stand on its middle, where pegs touch: by these parts of a step.
OFF_TURN, OFF_SHIFT = 0.29, 0.37


@inner
def add_crossing(crossings: Array, count: int, at: float, sign: float) -> int:
    """Append the position in mm at which a part moving along +x begins (sign 1) or ceases (-1) to contain a
    peg.

    Return the new number of crossings, which counts also those for which ``crossings`` has no room.
    """
    if count < crossings.shape[0]:
        crossings[count, 0], crossings[count, 1] = at, sign
    return count + 1


@inner
def collect_crossings(
    config: Array, theta: float, y: float, jaw: int, obstacles: Obstacles, crossings: Array
) -> int:
    """Write the positions at which a part that moves along x crosses the pegs of a jaw to ``crossings``,
    unsorted.

    The part has the orientation ``theta`` and the height ``y``; the jaw stands as in ``config``. A row holds
    the part's shift in x from its place in ``config`` in mm, and 1 where a peg enters the part or -1 where it
    leaves. Return the number of crossings, also of those for which there is no room. A configuration is theta
    in radians, x, y and the jaw separation S in mm.
    """
    cosine, sine = cos(theta), sin(theta)
    count = 0
    for k in range(obstacles.pegs.shape[0]):
        if obstacles.right[k] != jaw:
            continue
        ahead = obstacles.pegs[k, 0] + obstacles.right[k] * config[3] - config[1]
        level = obstacles.pegs[k, 1] - y
        for piece in range(obstacles.parts[jaw, 0], obstacles.parts[jaw, 1]):
            row = obstacles.rows[piece]
            cx, up = cosine * row[X] - sine * row[Y], level - (sine * row[X] + cosine * row[Y])
            ax, ay = cosine * row[AXIS_X] - sine * row[AXIS_Y], sine * row[AXIS_X] + cosine * row[AXIS_Y]
            if row[IS_ARC] == 0.0:
                # Half open, so that a joint counts once; the normal is (ay, -ax).
                if ay != 0.0 and -row[HALF_EXTENT] <= up / ay < row[HALF_EXTENT]:
                    count = add_crossing(
                        crossings, count, ahead - (cx + up / ay * ax), 1.0 if ay > 0.0 else -1.0
                    )
                continue
            if abs(up) >= row[RADIUS]:
                continue
            for side in range(2):
                dx = (1.0 - 2.0 * side) * sqrt((row[RADIUS] - up) * (row[RADIUS] + up))
                angle = compute_angle_from_middle(row, cosine * dx + sine * up, cosine * up - sine * dx)
                if row[HALF_EXTENT] >= pi or -row[HALF_EXTENT] <= angle < row[HALF_EXTENT]:
                    count = add_crossing(
                        crossings, count, ahead - (cx + dx), 1.0 if row[SIGN] * dx > 0.0 else -1.0
                    )
    return count


@inner
def write_free_intervals(
    config: Array, theta: float, y: float, jaw: int, obstacles: Obstacles, crossings: Array, out: Array
) -> int:
    """Write the intervals (low, high) of x in which the pegs of a jaw
    are outside the part to ``out``, ascending.

    x is the part's shift in mm from its place in ``config``, at ``theta`` and ``y``; the first low end is
    -inf, the last high end inf. Return their number; 0 where there is no room, or rounding leaves them in
    doubt. A configuration is theta in radians, x, y and the jaw separation S in mm.
    """
    count = collect_crossings(config, theta, y, jaw, obstacles, crossings)
    if count > crossings.shape[0]:
        return 0
    for i in range(1, count):
        at, sign = crossings[i, 0], crossings[i, 1]
        j = i
        while j > 0 and crossings[j - 1, 0] > at:
            crossings[j, 0], crossings[j, 1] = crossings[j - 1, 0], crossings[j - 1, 1]
            j -= 1
        crossings[j, 0], crossings[j, 1] = at, sign
    found, depth, low = 0, 0, -inf
    for i in range(count):
        depth += 1 if crossings[i, 1] > 0.0 else -1
        if depth == 1 and crossings[i, 1] > 0.0:
            if crossings[i, 0] > low:
                if found >= out.shape[0] - 1:
                    return 0
                out[found, 0], out[found, 1] = low, crossings[i, 0]
                found += 1
        elif depth == 0:
            low = crossings[i, 0]
    if depth != 0:
        # A joint was missed or counted twice.
        return 0
    out[found, 0], out[found, 1] = low, inf
    return found + 1


@compiled
def write_free_poses(
    config: Vector,
    opening: float,
    cells: int,
    step: Vector,
    lean: float,
    arm: float,
    obstacles: Obstacles,
    crossings: Matrix,
    intervals: Stack,
    out: Matrix,
) -> int:
    """Write free poses around a seat with the jaws opened to ``out``.

    For each cell of a grid of orientations and heights, and each range of x that is free of the pegs of both
    jaws, three poses are written: the one nearest to the seat, and both ends of the range. S is the jaw
    separation in mm.

    Parameters
    ----------
    config : (4,) theta, x, y, S of the seat.
    opening : in mm, by which the jaws are opened.
    cells : number of grid cells in either direction.
    step : (2,) of the grid, in radians and mm.
    lean : shift in mm of the grid's middle height per radian of orientation.
    arm : R, largest distance of a point of the silhouette from the centre, in mm.
    crossings, intervals : (MOST_CROSSINGS, 2) and (2, MOST_INTERVALS, 2) work space.
    out : (N, 5) receives |shift| + 2 R sin(|turn| / 2) in mm, and theta, x, y, S, as far as there is room.

    Returns
    -------
    number of poses written
    """
    count = 0
    for i in range(cells):
        turn = (i - cells // 2 + OFF_TURN) * step[0]
        for j in range(cells):
            shift = lean * turn + (j - cells // 2 + OFF_SHIFT) * step[1]
            theta, y = config[0] + turn, config[2] + shift
            n = write_free_intervals(config, theta, y, 0, obstacles, crossings, intervals[0])
            n = cut_by_wall(config, theta, y, obstacles, intervals[0], n)
            m = write_free_intervals(config, theta, y, 1, obstacles, crossings, intervals[1])
            for a in range(n):
                for b in range(m):
                    low = max(intervals[0, a, 0], intervals[1, b, 0] + opening)
                    high = min(intervals[0, a, 1], intervals[1, b, 1] + opening)
                    if low > high:
                        continue
                    nearest = low if low > 0.0 else high if high < 0.0 else 0.0
                    for way in range(3):
                        x = nearest if way == 0 else low if way == 1 else high
                        if (way > 0 and (x == nearest or abs(x) == inf)) or count >= out.shape[0]:
                            continue
                        row = out[count]
                        row[0] = hypot(x, shift) + 2.0 * arm * sin(abs(turn) / 2.0)
                        row[1], row[2], row[3], row[4] = theta, config[1] + x, y, config[3] + opening
                        count += 1
    return count


# mm. A peg this near to a piece touches it, and one this deep in the part, as where a way down may begin.
TOUCHED, ENTERED = 1e-4, 0.01
# mm. So far a peg is taken off what it touches, so that the way along that is seen to be free.
LIFTED = 1e-6
# Radians. Directions that pass an end by less meet it, and those that lead into what is touched by less go
# along it; one range begins where another ends if no more is between: rounding.
HAIR, ROUNDING = 1e-9, 1e-12
TURN = 2.0 * pi
# The most ranges that a peg and a piece have: into what is touched, and what is seen of an arc on each turn.
RANGES = 4


@inner
def add_range(low: float, sweep: float, ranges: Array, count: int) -> int:
    """Append a range of directions in radians to ``ranges``: its
    first direction, and its sweep counter-clockwise.

    Return the new number of ranges.
    """
    ranges[count, 0], ranges[count, 1] = low, sweep
    return count + 1


@inner
def is_touched(row: Array, x: float, y: float) -> bool:
    """Return whether a peg at (x, y) touches a piece: its centre is on the piece, or at most ``ENTERED`` mm
    inside.

    See ``base.feature`` for the layout of ``row``.
    """
    return -ENTERED < measure_gap(row, x, y) < TOUCHED and is_on_piece(row, x, y, TOUCHED)


@inner
def add_line(row: Array, axis: float, x: float, y: float, ranges: Array, count: int) -> int:
    """Append the range of directions in which a point meets a line from
    outside; return the new number, see :func:`add_piece`.

    See ``base.feature`` for the layout of ``row``.
    """
    off = measure_gap(row, x, y)
    if off <= 0.0:
        return count
    along = (x - row[X]) * row[AXIS_X] + (y - row[Y]) * row[AXIS_Y]
    low, high = atan2(off, row[HALF_EXTENT] - along), atan2(off, -row[HALF_EXTENT] - along)
    return add_range(axis + low - HAIR, high - low + 2.0 * HAIR, ranges, count)


@inner
def compute_angle_from_outside(radius: float, away: float, angle: float) -> float:
    """Return the direction in radians from a point outside a circle to a point of the circle.

    The result is measured from the direction to the centre. ``angle`` is the direction of the circle's point
    as seen from the centre, measured from that of the outer point; ``away`` is the outer point's distance
    from the centre.
    """
    return atan2(-radius * sin(angle), away - radius * cos(angle))


@inner
def compute_angle_from_inside(radius: float, away: float, angle: float) -> float:
    """Return the direction in radians from a point inside a circle to a point of the circle.

    The result and ``angle``, the direction of the circle's point as seen from the centre, are measured from
    the direction of the inner point as seen from the centre. ``away`` is the inner point's distance from the
    centre. The result stays within a quarter turn of ``angle``, so it is continuous past half turns.
    """
    return angle + atan2(away * sin(angle), radius - away * cos(angle))


@inner
def add_side(
    row: Array, axis: float, away: float, toward: float, near: bool, ranges: Array, count: int
) -> int:
    """Append the ranges of directions in which a point outside an
    arc's circle meets the near or far side of the arc.

    The point is ``away`` mm from the centre, in direction ``toward``; ``axis`` is the direction of the arc's
    middle. Return the new number of ranges. See ``base.feature`` for the layout of ``row``.
    """
    seen = acos(row[RADIUS] / away)
    first, last = (-seen, seen) if near else (seen, TURN - seen)
    middle = axis - toward
    middle -= TURN * floor(middle / TURN)
    for turns in range(-1, 2):
        around = middle + TURN * turns
        low, high = max(around - row[HALF_EXTENT], first), min(around + row[HALF_EXTENT], last)
        if low < high:
            one, two = (
                compute_angle_from_outside(row[RADIUS], away, low),
                compute_angle_from_outside(row[RADIUS], away, high),
            )
            count = add_range(toward + pi + min(one, two) - HAIR, abs(two - one) + 2.0 * HAIR, ranges, count)
    return count


@inner
def add_concave(row: Array, axis: float, x: float, y: float, ranges: Array, count: int) -> int:
    """Append the ranges of directions in which a point meets a
    concave arc, from inside or through its opening.

    Return the new number of ranges. See ``base.feature`` for the layout of ``row``.
    """
    dx, dy, radius = x - row[X], y - row[Y], row[RADIUS]
    away, toward = compute_length(dx, dy), atan2(dy, dx)
    if is_touched(row, x, y):
        # Along it there is no way.
        count = add_range(toward - pi / 2.0 - HAIR, pi + 2.0 * HAIR, ranges, count)
        away = min(away, radius)
    if away > radius:
        return add_side(row, axis, away, toward, False, ranges, count)
    if row[HALF_EXTENT] >= pi:
        return add_range(0.0, TURN, ranges, count)
    middle = axis - toward
    low = compute_angle_from_inside(radius, away, middle - row[HALF_EXTENT])
    high = compute_angle_from_inside(radius, away, middle + row[HALF_EXTENT])
    return add_range(toward + low - HAIR, high - low + 2.0 * HAIR, ranges, count)


@inner
def add_piece(row: Array, axis: float, x: float, y: float, ranges: Array, count: int) -> int:
    """Append the ranges of directions in which a point at (x, y) that
    moves straight meets a piece from outside.

    ``axis`` is the direction in radians of the piece's axis. Return the new number of ranges. See
    ``base.feature`` for the layout of ``row``.
    """
    if row[IS_ARC] == 0.0:
        return add_line(row, axis, x, y, ranges, count)
    if row[SIGN] < 0.0:
        return add_concave(row, axis, x, y, ranges, count)
    dx, dy = x - row[X], y - row[Y]
    away = compute_length(dx, dy)
    return count if away <= row[RADIUS] else add_side(row, axis, away, atan2(dy, dx), True, ranges, count)


@inner
def add_peg(
    x: float, y: float, rows: Array, axes: Array, first: int, end: int, ranges: Array, count: int
) -> int:
    """Append the ranges of directions in which a peg at (x, y) that moves straight meets pieces ``first`` to
    ``end`` - 1.

    For pieces that the peg touches, these are the directions into them. For all other pieces, the peg is
    first moved just off the pieces that it touches. Return the new number of ranges. See ``base.feature`` for
    the layout of ``rows``.
    """
    beside_x, beside_y = x, y
    for k in range(first, end):
        if is_touched(rows[k], x, y) and (rows[k, IS_ARC] == 0.0 or rows[k, SIGN] > 0.0):
            nx, ny = compute_normal(rows[k], x, y)
            count = add_range(atan2(ny, nx) + pi / 2.0 + HAIR, pi - 2.0 * HAIR, ranges, count)
            beside_x, beside_y = beside_x + LIFTED * nx, beside_y + LIFTED * ny
    for k in range(first, end):
        # What bends away from where it is touched is met nowhere else.
        if (rows[k, IS_ARC] != 0.0 and rows[k, SIGN] < 0.0) or not is_touched(rows[k], x, y):
            count = add_piece(rows[k], axes[k], beside_x, beside_y, ranges, count)
    return count


@inner
def find_free_direction(ranges: Array, count: int) -> float:
    """Return a direction in radians that lies in none of some open ranges, or NaN when they cover all
    directions.

    The search begins at the end of one range and goes on to the farthest end of a range that contains it,
    until no range does or a whole turn is covered.
    """
    if count == 0:
        return 0.0
    at, gone = ranges[0, 0] + ranges[0, 1], 0.0
    while gone <= TURN:
        farthest = 0.0
        for k in range(count):
            if ranges[k, 1] >= TURN:
                return nan
            within = at - ranges[k, 0]
            within -= TURN * floor(within / TURN)
            if ROUNDING < within < ranges[k, 1] - ROUNDING:
                farthest = max(farthest, ranges[k, 1] - within)
        if farthest == 0.0:
            return at
        at, gone = at + farthest, gone + farthest
    return nan


@inner
def find_escape_direction(config: Array, obstacles: Obstacles, axes: Array, ranges: Array) -> float:
    """Return the direction in which all pegs can leave a part straight, or NaN; see
    :func:`write_escape_directions`.

    A configuration is theta in radians, x, y and the jaw separation S in mm.
    """
    count = 0
    if obstacles.half_plane[0] != 0.0 or obstacles.half_plane[1] != 0.0:
        # The part moves the other way than pegs do on it, and nothing moves toward the wall.
        count = add_range(
            atan2(obstacles.half_plane[1], obstacles.half_plane[0]) - config[0] - pi / 2.0, pi, ranges, count
        )
    cosine, sine = cos(config[0]), sin(config[0])
    for peg in range(obstacles.pegs.shape[0]):
        (x, y), side = compute_turned_place(config, cosine, sine, obstacles, peg), obstacles.right[peg]
        first, end = obstacles.parts[side, 0], obstacles.parts[side, 1]
        count = add_peg(x, y, obstacles.rows, axes, first, end, ranges, count)
    return find_free_direction(ranges, count)


@compiled
def write_escape_directions(
    configs: Matrix, obstacles: Obstacles, axes: Vector, ranges: Matrix, out: Vector
) -> None:
    """Write, for each configuration (N, 4), a direction in which all
    pegs can leave the part straight to ``out``, or NaN.

    It is the direction in radians of the pegs' motion in the part's frame. On the way no peg enters the part,
    and the part comes no nearer to a wall. NaN stands for no such direction. Only entries of ``out`` (N,)
    that are NaN before are computed. A configuration is theta in radians, x, y and the jaw separation S in
    mm.

    Parameters
    ----------
    axes, ranges : (P,) and (RANGES * K * P + 1, 2) work space, for K pegs and P pieces.
    """
    for piece in range(axes.shape[0]):
        axes[piece] = atan2(obstacles.rows[piece, AXIS_Y], obstacles.rows[piece, AXIS_X])
    for n in range(configs.shape[0]):
        if not isnan(out[n]):
            out[n] = find_escape_direction(configs[n], obstacles, axes, ranges)
