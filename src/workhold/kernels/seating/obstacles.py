"""What stops a part: pieces of the boundary on which centres of pegs lie, and a straight wall.

Corners of the part's hull, and convex arcs on it, come no nearer to a wall than they may. A row of a hull has
the centre x and y of a piece about the centre of the part's box, and its radius. Then follow the unit vector
to its middle, and the cosine of half its sweep. The cosine is -2 for a corner, which supports in every
direction. See ``geometry.hull``. Whether a part covers the place that it covers elsewhere is seen from
its outline.
"""

from __future__ import annotations

from math import atan2, cos, hypot, inf, pi, sin, sqrt

from workhold.conventions import PARALLEL, SAME_CENTER
from workhold.kernels.base.compiling import (
    Array,
    ByteVector,
    Matrix,
    Vector,
    compiled,
    inner,
)
from workhold.kernels.base.distance import segment_distance
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, RADIUS, SIGN, X, Y, is_shallow
from workhold.kernels.seating.columns import Obstacles

# mm. Two pieces are as near when their distances agree to this: they end in one point.
SAME_END = 1e-9
Foot = tuple[float, float, float, float, float]


@inner
def length(x: float, y: float) -> float:
    """The length of a vector in mm whose squares are in range, in a third of the time of ``hypot``."""
    return sqrt(x * x + y * y)


@inner
def place_on_part(config: Array, obstacles: Obstacles, peg: int) -> tuple[float, float]:
    """Place of a peg's centre on the part in a configuration (4,)."""
    return turned_place(config, cos(config[0]), sin(config[0]), obstacles, peg)


@inner
def turned_place(
    config: Array, cosine: float, sine: float, obstacles: Obstacles, peg: int
) -> tuple[float, float]:
    """Place of a peg's centre on the part in a configuration (4,) of known cosine and sine."""
    x = obstacles.pegs[peg, 0] + obstacles.right[peg] * config[3] - config[1]
    y = obstacles.pegs[peg, 1] - config[2]
    return (cosine * x + sine * y, cosine * y - sine * x)


@inner
def cosine_and_sine(theta: float, turn: Array) -> tuple[float, float]:
    """The cosine and the sine of an orientation, which ``turn`` (3,) keeps until another is asked for."""
    if theta != turn[0]:
        turn[0], turn[1], turn[2] = theta, cos(theta), sin(theta)
    return (turn[1], turn[2])


@inner
def angle_from_middle(row: Array, dx: float, dy: float) -> float:
    """Angle in radians, in (-pi, pi], of a direction from an arc's centre, seen from its middle."""
    return atan2(row[AXIS_X] * dy - row[AXIS_Y] * dx, row[AXIS_X] * dx + row[AXIS_Y] * dy)


@inner
def on_piece(row: Array, x: float, y: float, slack: float) -> bool:
    """Whether a point of a piece's carrier lies on the piece, or past its end by at most a slack in mm."""
    dx, dy = x - row[X], y - row[Y]
    if row[IS_ARC] == 0.0:
        return abs(dx * row[AXIS_X] + dy * row[AXIS_Y]) <= row[HALF_EXTENT] + slack
    return (
        row[HALF_EXTENT] >= pi
        or abs(angle_from_middle(row, dx, dy)) <= row[HALF_EXTENT] + slack / row[RADIUS]
    )


@inner
def normal_at(row: Array, x: float, y: float) -> tuple[float, float]:
    """Outward unit normal of a piece at a point on it."""
    if row[IS_ARC] == 0.0:
        return (row[AXIS_Y], -row[AXIS_X])
    dx, dy = x - row[X], y - row[Y]
    size = max(length(dx, dy), 1e-150)
    return (row[SIGN] * dx / size, row[SIGN] * dy / size)


@inner
def foot(row: Array, x: float, y: float, side: float) -> Foot:
    """Foot of a point on a piece's carrier, of a circle that on the point's side (1) or the far one (-1).

    Returns
    -------
    (x, y, outward normal's x and y, distance in mm from the centre or inf of a line)
    """
    dx, dy = x - row[X], y - row[Y]
    if row[IS_ARC] == 0.0:
        s = dx * row[AXIS_X] + dy * row[AXIS_Y]
        return (row[X] + s * row[AXIS_X], row[Y] + s * row[AXIS_Y], row[AXIS_Y], -row[AXIS_X], inf)
    size = max(length(dx, dy), 1e-150)
    ex, ey = side * dx / size, side * dy / size
    return (row[X] + row[RADIUS] * ex, row[Y] + row[RADIUS] * ey, row[SIGN] * ex, row[SIGN] * ey, size)


@inner
def share_normals(a: Array, b: Array) -> bool:
    """Whether two pieces are parallel lines or concentric arcs: a normal of one is one of the other."""
    if a[IS_ARC] != b[IS_ARC]:
        return False
    if a[IS_ARC] == 0.0:
        return abs(a[AXIS_X] * b[AXIS_Y] - a[AXIS_Y] * b[AXIS_X]) <= PARALLEL
    return length(a[X] - b[X], a[Y] - b[Y]) <= SAME_CENTER


@inner
def distance_to(row: Array, x: float, y: float) -> float:
    """The distance in mm of a point from a piece, negative where the piece is seen from the part's side."""
    dx, dy = x - row[X], y - row[Y]
    if row[IS_ARC] == 0.0:
        across = dx * row[AXIS_Y] - dy * row[AXIS_X]
        beyond = max(abs(dx * row[AXIS_X] + dy * row[AXIS_Y]) - row[HALF_EXTENT], 0.0)
        away = length(beyond, across)
        return away if across >= 0.0 else -away
    size = length(dx, dy)
    angle = 0.0 if row[HALF_EXTENT] >= pi else angle_from_middle(row, dx, dy)
    if abs(angle) <= row[HALF_EXTENT]:
        return row[SIGN] * (size - row[RADIUS])
    end = row[HALF_EXTENT] if angle > 0.0 else -row[HALF_EXTENT]
    nx = row[AXIS_X] * cos(end) - row[AXIS_Y] * sin(end)
    ny = row[AXIS_Y] * cos(end) + row[AXIS_X] * sin(end)
    ex, ey = dx - row[RADIUS] * nx, dy - row[RADIUS] * ny
    away = length(ex, ey)
    return away if row[SIGN] * (ex * nx + ey * ny) >= 0.0 else -away


@inner
def nearest_piece(x: float, y: float, rows: Array, first: int, end: int, guess: int) -> tuple[float, int]:
    """The distance in mm of a peg's centre from pieces of the boundary, and the nearest piece.

    The distance is negative where the peg is in the part. A guess of the nearest piece saves time; it need
    not be one of them.

    Where the nearest point is an inner corner, in which two pieces end, the centre is in the part. It may lie
    on the outer side of one of them, so that of two as near the one on whose inner side it is counts.
    """
    best, nearest = inf, first
    if first <= guess < end:
        best, nearest = distance_to(rows[guess], x, y), guess
    for k in range(first, end):
        row = rows[k]
        # What cannot be nearer: its carrier is not.
        dx, dy = x - row[X], y - row[Y]
        off = dx * row[AXIS_Y] - dy * row[AXIS_X] if row[IS_ARC] == 0.0 else length(dx, dy) - row[RADIUS]
        if abs(off) < abs(best) + SAME_END:
            d = distance_to(row, x, y)
            if abs(d) < abs(best) - SAME_END or (abs(d) < abs(best) + SAME_END and d < 0.0):
                best, nearest = d, k
    return (best, nearest)


@inner
def clearance(x: float, y: float, rows: Array, first: int, end: int) -> float:
    """The distance alone, as of ``nearest_piece``."""
    return nearest_piece(x, y, rows, first, end, first)[0]


@compiled
def clearances(points: Matrix, rows: Matrix, first: int, end: int, out: Vector) -> None:
    """Writes the distances in mm (M,) of peg centres (M, 2) from pieces ``first`` to ``end``."""
    for k in range(points.shape[0]):
        out[k] = clearance(points[k, 0], points[k, 1], rows, first, end)


# What supports in a direction may fall short of it by this much: rounding.
SUPPORTS = 1e-12


@inner
def add_wall(config: Array, obstacles: Obstacles, reach: float, near: Array, count: int) -> int:
    """Writes clearances from the wall within a reach after ``count`` others, and -1 for a peg.

    Returns the new count.

    See ``closing.look_around``.
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
def beside_wall(config: Array, obstacles: Obstacles, slack: float) -> tuple[float, int]:
    """The distance in mm of the part from the wall, infinite without one, and the number of what is nearest.

    What supports may fall short by a slack.
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
def off_wall(config: Array, obstacles: Obstacles, slack: float) -> float:
    """The distance of ``beside_wall``."""
    return beside_wall(config, obstacles, slack)[0]


@inner
def cut_by_wall(
    config: Array, theta: float, y: float, obstacles: Obstacles, intervals: Array, count: int
) -> int:
    """Cuts intervals of x, from the part's place, to where it is off a wall; returns how many there are."""
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
    """Whether a point is within a distance of a segment. The carrier decides of most that they are not."""
    if not is_shallow(row):
        dx, dy = x - row[X], y - row[Y]
        off = hypot(dx, dy) - row[RADIUS] if row[IS_ARC] != 0.0 else dx * row[AXIS_Y] - dy * row[AXIS_X]
        if abs(off) > most:
            return False
    return segment_distance(x, y, row) <= most


@inner
def covers_same(one: Array, other: Array, sign: float, rows: Array, points: Array, most: float) -> bool:
    """Whether a part covers in two configurations the same place; ``sign`` is -1 for one turned over."""
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
def cover_same(
    one: Vector,
    others: Matrix,
    turned_over: ByteVector,
    rows: Matrix,
    points: Matrix,
    most: float,
    out: ByteVector,
) -> None:
    """Writes whether a part covers in configurations (N, 4) the place that it covers in one (4,).

    Parameters
    ----------
    turned_over : (N,) 1 where the part is turned over, x to -x in its own frame.
    rows, points : (S, 10) faces about the centre of the part, and (M, 2) points on them.
    most : how far in mm a point may be from all faces.
    """
    for n in range(others.shape[0]):
        sign = -1.0 if turned_over[n] == 1 else 1.0
        out[n] = 1 if covers_same(one, others[n], sign, rows, points, most) else 0
