"""Obstacles to a part: pieces of the boundary on which centres of pegs lie, and a straight wall.

Corners of the part's hull, and convex arcs on it, come no nearer to a wall than they may. A row of a hull has
the centre x and y of a piece about the centre of the part's box, and its radius. Then follow the unit vector
to its middle, and the cosine of half its sweep. The cosine is -2 for a corner, which supports in every
direction. See ``geometry.hull``. Two configurations in which a part covers the same area are recognized by
its outline.
"""

from __future__ import annotations

from math import atan2, cos, hypot, inf, pi, sin, sqrt
from typing import NamedTuple

from workhold.conventions import PARALLEL, SAME_CENTER
from workhold.kernels.base.compiling import (
    Array,
    ByteVector,
    Matrix,
    Vector,
    compiled,
    inner,
)
from workhold.kernels.base.distance import measure_segment_distance
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, RADIUS, SIGN, X, Y, is_shallow
from workhold.kernels.seating.columns import Obstacles

# mm. Two pieces are as near when their distances agree to this: they end in one point.
SAME_END = 1e-9


class FootPoint(NamedTuple):
    """The foot of the perpendicular from a point to a piece's line or circle.

    Parameters
    ----------
    x, y : its place in mm.
    normal_x, normal_y : unit outward normal of the piece there.
    distance : of the point from the circle's centre, in mm; inf for a line.
    """

    x: float
    y: float
    normal_x: float
    normal_y: float
    distance: float


@inner
def compute_length(x: float, y: float) -> float:
    """Return the length of the vector (x, y), computed as sqrt(x^2 + y^2) because ``hypot`` takes three times
    as long.

    The squares must not overflow.
    """
    return sqrt(x * x + y * y)


@inner
def compute_peg_place(config: Array, obstacles: Obstacles, peg: int) -> tuple[float, float]:
    """Return the place (x, y) of a peg's centre in the part's frame in a configuration (4,), in mm.

    A configuration is theta in radians, x, y and the jaw separation S in mm.
    """
    return compute_turned_place(config, cos(config[0]), sin(config[0]), obstacles, peg)


@inner
def compute_turned_place(
    config: Array, cosine: float, sine: float, obstacles: Obstacles, peg: int
) -> tuple[float, float]:
    """Return the place (x, y) of a peg's centre in the part's frame,
    in mm, with the cosine and sine of theta given.

    A configuration is theta in radians, x, y and the jaw separation S in mm.
    """
    x = obstacles.pegs[peg, 0] + obstacles.right[peg] * config[3] - config[1]
    y = obstacles.pegs[peg, 1] - config[2]
    return (cosine * x + sine * y, cosine * y - sine * x)


@inner
def compute_cosine_and_sine(theta: float, turn: Array) -> tuple[float, float]:
    """Return the cosine and sine of an orientation in radians.

    ``turn`` (3,) caches the last orientation with its cosine and sine; it is updated in place.
    """
    if theta != turn[0]:
        turn[0], turn[1], turn[2] = theta, cos(theta), sin(theta)
    return (turn[1], turn[2])


@inner
def compute_angle_from_middle(row: Array, dx: float, dy: float) -> float:
    """Return the angle in radians, in [-pi, pi], from an arc's middle
    to the direction (dx, dy), seen from its centre.

    See ``base.feature`` for the layout of ``row``.
    """
    return atan2(row[AXIS_X] * dy - row[AXIS_Y] * dx, row[AXIS_X] * dx + row[AXIS_Y] * dy)


@inner
def is_on_piece(row: Array, x: float, y: float, slack: float) -> bool:
    """Return whether a point of a piece's line or circle lies on the piece, or past its end by at most
    ``slack`` mm.

    (x, y) must lie on the line or circle. See ``base.feature`` for the layout of ``row``.
    """
    dx, dy = x - row[X], y - row[Y]
    if row[IS_ARC] == 0.0:
        return abs(dx * row[AXIS_X] + dy * row[AXIS_Y]) <= row[HALF_EXTENT] + slack
    return (
        row[HALF_EXTENT] >= pi
        or abs(compute_angle_from_middle(row, dx, dy)) <= row[HALF_EXTENT] + slack / row[RADIUS]
    )


@inner
def compute_normal(row: Array, x: float, y: float) -> tuple[float, float]:
    """Return the outward unit normal (x, y) of a piece at a point on it.

    See ``base.feature`` for the layout of ``row``.
    """
    if row[IS_ARC] == 0.0:
        return (row[AXIS_Y], -row[AXIS_X])
    dx, dy = x - row[X], y - row[Y]
    size = max(compute_length(dx, dy), 1e-150)
    return (row[SIGN] * dx / size, row[SIGN] * dy / size)


@inner
def find_foot(row: Array, x: float, y: float, side: float) -> FootPoint:
    """Return the foot of the perpendicular from a point to a piece's line or circle.

    On a circle there are two: with ``side`` 1 the foot lies on the point's side of the centre, with -1 on the
    opposite side; on a line ``side`` is ignored. See ``base.feature`` for the layout of ``row``.
    """
    dx, dy = x - row[X], y - row[Y]
    if row[IS_ARC] == 0.0:
        s = dx * row[AXIS_X] + dy * row[AXIS_Y]
        return FootPoint(row[X] + s * row[AXIS_X], row[Y] + s * row[AXIS_Y], row[AXIS_Y], -row[AXIS_X], inf)
    size = max(compute_length(dx, dy), 1e-150)
    ex, ey = side * dx / size, side * dy / size
    return FootPoint(
        row[X] + row[RADIUS] * ex, row[Y] + row[RADIUS] * ey, row[SIGN] * ex, row[SIGN] * ey, size
    )


@inner
def share_normals(a: Array, b: Array) -> bool:
    """Return whether two pieces are parallel lines or concentric arcs, so that each normal of one is normal
    to the other.

    See ``base.feature`` for the layout of ``a`` and ``b``.
    """
    if a[IS_ARC] != b[IS_ARC]:
        return False
    if a[IS_ARC] == 0.0:
        return abs(a[AXIS_X] * b[AXIS_Y] - a[AXIS_Y] * b[AXIS_X]) <= PARALLEL
    return compute_length(a[X] - b[X], a[Y] - b[Y]) <= SAME_CENTER


@inner
def measure_distance_to_piece(row: Array, x: float, y: float) -> float:
    """Return the distance in mm of a point from a piece, negative
    where the point is on the part's side of the piece.

    See ``base.feature`` for the layout of ``row``.
    """
    dx, dy = x - row[X], y - row[Y]
    if row[IS_ARC] == 0.0:
        across = dx * row[AXIS_Y] - dy * row[AXIS_X]
        beyond = max(abs(dx * row[AXIS_X] + dy * row[AXIS_Y]) - row[HALF_EXTENT], 0.0)
        away = compute_length(beyond, across)
        return away if across >= 0.0 else -away
    size = compute_length(dx, dy)
    angle = 0.0 if row[HALF_EXTENT] >= pi else compute_angle_from_middle(row, dx, dy)
    if abs(angle) <= row[HALF_EXTENT]:
        return row[SIGN] * (size - row[RADIUS])
    end = row[HALF_EXTENT] if angle > 0.0 else -row[HALF_EXTENT]
    nx = row[AXIS_X] * cos(end) - row[AXIS_Y] * sin(end)
    ny = row[AXIS_Y] * cos(end) + row[AXIS_X] * sin(end)
    ex, ey = dx - row[RADIUS] * nx, dy - row[RADIUS] * ny
    away = compute_length(ex, ey)
    return away if row[SIGN] * (ex * nx + ey * ny) >= 0.0 else -away


@inner
def find_nearest_piece(
    x: float, y: float, rows: Array, first: int, end: int, guess: int
) -> tuple[float, int]:
    """Return (distance in mm of a peg's centre from pieces ``first`` to ``end`` - 1 of the boundary, the
    nearest piece).

    The distance is negative where the peg is in the part. ``guess`` is the number of a piece that may be the
    nearest, to save time; any other number is allowed.

    Where the nearest point is an inner corner, in which two pieces end, the centre is in the part. The centre
    may lie on the outer side of one of them. So of two equally near pieces, the piece on whose inner side the
    centre lies counts. See ``base.feature`` for the layout of ``rows``.
    """
    best, nearest = inf, first
    if first <= guess < end:
        best, nearest = measure_distance_to_piece(rows[guess], x, y), guess
    for k in range(first, end):
        row = rows[k]
        # What cannot be nearer: its carrier is not.
        dx, dy = x - row[X], y - row[Y]
        off = (
            dx * row[AXIS_Y] - dy * row[AXIS_X]
            if row[IS_ARC] == 0.0
            else compute_length(dx, dy) - row[RADIUS]
        )
        if abs(off) < abs(best) + SAME_END:
            d = measure_distance_to_piece(row, x, y)
            if abs(d) < abs(best) - SAME_END or (abs(d) < abs(best) + SAME_END and d < 0.0):
                best, nearest = d, k
    return (best, nearest)


@inner
def measure_clearance(x: float, y: float, rows: Array, first: int, end: int) -> float:
    """Return the distance in mm of a peg's centre (x, y) from pieces ``first`` to ``end`` - 1; negative in
    the part.

    See :func:`find_nearest_piece`, and ``base.feature`` for the layout of ``rows``.
    """
    return find_nearest_piece(x, y, rows, first, end, first)[0]


@compiled
def write_clearances_of_points(points: Matrix, rows: Matrix, first: int, end: int, out: Vector) -> None:
    """Write to ``out`` (M,) the distances in mm of peg centres (M, 2) from pieces ``first`` to ``end`` - 1,
    negative in the part.

    See ``base.feature`` for the layout of ``rows``.
    """
    for k in range(points.shape[0]):
        out[k] = measure_clearance(points[k, 0], points[k, 1], rows, first, end)


# What supports in a direction may fall short of it by this much: rounding.
SUPPORTS = 1e-12


@inner
def add_wall(config: Array, obstacles: Obstacles, reach: float, near: Array, count: int) -> int:
    """Append a row to ``near`` for each piece of the part's hull that is within ``reach`` mm of the wall.

    ``count`` rows are written already; return the new number. Columns are those of
    ``closing.write_near_clearances``, with -1 for the peg and the row of the hull as the piece. A
    configuration is theta in radians, x, y and the jaw separation S in mm.
    """
    if obstacles.hull.shape[0] == 0:
        return count
    cosine, sine = cos(config[0]), sin(config[0])
    ux, uy = obstacles.half_plane[0], obstacles.half_plane[1]
    px, py = cosine * ux + sine * uy, cosine * uy - sine * ux
    for k in range(obstacles.hull.shape[0]):
        row = obstacles.hull[k]
        if -(px * row[3] + py * row[4]) < row[5] or count >= near.shape[0]:
            continue
        wx, wy = cosine * row[0] - sine * row[1], sine * row[0] + cosine * row[1]
        off = ux * (wx + config[1]) + uy * (wy + config[2]) - row[2] - obstacles.half_plane[2]
        if abs(off) <= reach:
            near[count, 0] = (uy * wx - ux * wy) / obstacles.size
            near[count, 1], near[count, 2], near[count, 3], near[count, 4] = ux, uy, 0.0, off
            near[count, 5], near[count, 6] = -1.0, k
            count += 1
    return count


@inner
def find_wall_clearance(config: Array, obstacles: Obstacles, slack: float) -> tuple[float, int]:
    """Return (distance in mm of the part from the wall, row of the hull that is nearest to it); (inf, -1) for
    no wall.

    A row counts where the hull is supported there in the wall's direction; the cosine of the angle may miss
    by ``slack``. A configuration is theta in radians, x, y and the jaw separation S in mm.
    """
    best, nearest = inf, -1
    if obstacles.hull.shape[0] == 0:
        return (best, nearest)
    cosine, sine = cos(config[0]), sin(config[0])
    ux, uy = obstacles.half_plane[0], obstacles.half_plane[1]
    px, py = cosine * ux + sine * uy, cosine * uy - sine * ux
    for k in range(obstacles.hull.shape[0]):
        row = obstacles.hull[k]
        if -(px * row[3] + py * row[4]) >= row[5] - slack:
            wx, wy = cosine * row[0] - sine * row[1], sine * row[0] + cosine * row[1]
            off = ux * (wx + config[1]) + uy * (wy + config[2]) - row[2] - obstacles.half_plane[2]
            if off < best:
                best, nearest = off, k
    return (best, nearest)


@inner
def measure_wall_clearance(config: Array, obstacles: Obstacles, slack: float) -> float:
    """Return the distance in mm of the part from the wall, inf where there is no wall; see
    :func:`find_wall_clearance`.

    A configuration is theta in radians, x, y and the jaw separation S in mm.
    """
    return find_wall_clearance(config, obstacles, slack)[0]


@inner
def cut_by_wall(
    config: Array, theta: float, y: float, obstacles: Obstacles, intervals: Array, count: int
) -> int:
    """Cut intervals (low, high) of the part's shift in x in place to where the part is clear of the wall.

    The first ``count`` rows of ``intervals`` are given; return how many are left. Shifts, in mm, are counted
    from the part's place in ``config``, but with the orientation ``theta`` and the height ``y``. A
    configuration is theta in radians, x, y and the jaw separation S in mm.
    """
    cosine, sine = cos(theta), sin(theta)
    ux, uy = obstacles.half_plane[0], obstacles.half_plane[1]
    px, py = cosine * ux + sine * uy, cosine * uy - sine * ux
    for k in range(obstacles.hull.shape[0]):
        row = obstacles.hull[k]
        if -(px * row[3] + py * row[4]) < row[5]:
            continue
        wx, wy = cosine * row[0] - sine * row[1], sine * row[0] + cosine * row[1]
        least = obstacles.half_plane[2] + row[2] - uy * (wy + y) - ux * (wx + config[1])
        if abs(uy) > 0.5:
            if least > 0.0:
                return 0
            continue
        left = 0
        for i in range(count):
            low, high = intervals[i, 0], intervals[i, 1]
            if ux > 0.0:
                low = max(low, least)
            else:
                high = min(high, -least)
            if low <= high:
                intervals[left, 0], intervals[left, 1] = low, high
                left += 1
        count = left
    return count


@inner
def is_near(x: float, y: float, row: Array, most: float) -> bool:
    """Return whether the point (x, y) is within ``most`` mm of a segment.

    See ``base.feature`` for the layout of ``row``.
    """
    if not is_shallow(row):
        dx, dy = x - row[X], y - row[Y]
        off = hypot(dx, dy) - row[RADIUS] if row[IS_ARC] != 0.0 else dx * row[AXIS_Y] - dy * row[AXIS_X]
        if abs(off) > most:
            return False
    return measure_segment_distance(x, y, row) <= most


@inner
def is_same_cover(one: Array, other: Array, sign: float, rows: Array, points: Array, most: float) -> bool:
    """Return whether a part covers the same place in two
    configurations (4,): whether all points lie on its faces.

    ``sign`` is -1 where the part is turned over in ``other``, x to -x in its own frame, else 1. ``points``
    (M, 2) are moved from ``other`` to ``one``, where each must be within ``most`` mm of a face in ``rows``
    (S, 10). See ``base.feature`` for the layout of ``rows``.
    """
    turn = other[0] - one[0]
    cosine, sine, c, s = cos(turn), sin(turn), cos(one[0]), sin(one[0])
    dx, dy = other[1] - one[1], other[2] - one[2]
    for k in range(points.shape[0]):
        px, py = sign * points[k, 0], points[k, 1]
        # As the point lies on the part in the one configuration.
        x = cosine * px - sine * py + c * dx + s * dy
        y = sine * px + cosine * py + c * dy - s * dx
        near = False
        for row in range(rows.shape[0]):
            near = near or is_near(x, y, rows[row], most)
        if not near:
            return False
    return True


@compiled
def write_same_cover(
    one: Vector,
    others: Matrix,
    turned_over: ByteVector,
    rows: Matrix,
    points: Matrix,
    most: float,
    out: ByteVector,
) -> None:
    """Write 1 to ``out`` (N,) for each configuration in which a part
    covers the same place as in ``one`` (4,), else 0.

    See ``base.feature`` for the layout of ``rows``.

    Parameters
    ----------
    others : (N, 4) configurations.
    turned_over : (N,) 1 where the part is turned over, x to -x in its own frame.
    rows, points : (S, 10) faces about the centre of the part, and (M, 2) points on them.
    most : how far in mm a point may be from all faces.
    """
    for n in range(others.shape[0]):
        sign = -1.0 if turned_over[n] == 1 else 1.0
        out[n] = 1 if is_same_cover(one, others[n], sign, rows, points, most) else 0
