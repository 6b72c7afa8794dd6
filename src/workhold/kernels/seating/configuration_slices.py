"""Slices of the C-space at one orientation and height: a part's free places along x are intervals for each jaw.

Places are counted from where the part lies in its seat, for the left jaw as it stands and for the right one
as it stands there. With the jaws opened by s, x in an interval of the left and x - s in one of the right is
free. A pair of intervals is open below s where the low end of the left less the high end of the right is
less.

Glossary
--------
slice : a part of the C-space in which a coordinate has one value: T. Lozano-Perez, "Spatial planning: a
    configuration space approach", IEEE Transactions on Computers C-32 (1983).
"""

from __future__ import annotations

from math import cos, hypot, inf, pi, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.compiling import compiled, inner
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, RADIUS, SIGN, X, Y
from workhold.kernels.seating.columns import Obstacles
from workhold.kernels.seating.pieces import angle_from_middle
from workhold.kernels.seating.walls import cut_by_wall

Array = NDArray[np.float64]

# Intervals of a jaw that are kept at one place, and crossings that are looked at.
MOST_INTERVALS, MOST_CROSSINGS = 6, 256
# A grid does not stand on its middle, where pegs touch: by these parts of a step.
OFF_TURN, OFF_SHIFT = 0.29, 0.37


@inner
def add_crossing(crossings: Array, count: int, at: float, sign: float) -> int:
    """Writes where pegs enter (1) or leave (-1) a part that moves along +x; returns the new count."""
    if count < crossings.shape[0]:
        crossings[count, 0], crossings[count, 1] = at, sign
    return count + 1


@inner
def collect_crossings(config: Array, theta: float, y: float, jaw: int, obstacles: Obstacles, crossings: Array) -> int:
    """Writes where a part moving along x meets the pegs of a jaw, which stands as in a configuration.

    Returns how many.
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
                    count = add_crossing(crossings, count, ahead - (cx + up / ay * ax), 1.0 if ay > 0.0 else -1.0)
                continue
            if abs(up) >= row[RADIUS]:
                continue
            for side in range(2):
                dx = (1.0 - 2.0 * side) * sqrt((row[RADIUS] - up) * (row[RADIUS] + up))
                angle = angle_from_middle(row, cosine * dx + sine * up, cosine * up - sine * dx)
                if row[HALF_EXTENT] >= pi or -row[HALF_EXTENT] <= angle < row[HALF_EXTENT]:
                    count = add_crossing(crossings, count, ahead - (cx + dx), 1.0 if row[SIGN] * dx > 0.0 else -1.0)
    return count


@inner
def free_intervals(
    config: Array, theta: float, y: float, jaw: int, obstacles: Obstacles, crossings: Array, out: Array
) -> int:
    """Writes the intervals of x in which the pegs of a jaw are off the part; returns how many.

    Where rounding leaves them in doubt there are none.
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
def free_poses(
    config: Array,
    opening: float,
    cells: int,
    step: Array,
    lean: float,
    arm: float,
    obstacles: Obstacles,
    crossings: Array,
    intervals: Array,
    out: Array,
) -> int:
    """Writes free poses around a seat with the jaws opened.

    Of each cell of a grid of orientations and heights, and each pair of intervals, they are the nearest and
    both ends.

    Parameters
    ----------
    config : (4,) of the seat.
    opening : in mm.
    cells, step : of the grid, both ways; (2,) in radians and mm.
    lean : how fast in mm per radian the grid's middle rises with the orientation.
    arm : R, largest distance of a point of the silhouette from the centre, in mm.
    crossings, intervals : (MOST_CROSSINGS, 2) and (2, MOST_INTERVALS, 2) work space.
    out : (N, 5) rows of |shift| + 2 R sin(|turn| / 2), and theta, x, y, S, as far as there is room.

    Returns
    -------
    how many were written
    """
    count = 0
    for i in range(cells):
        turn = (i - cells // 2 + OFF_TURN) * step[0]
        for j in range(cells):
            shift = lean * turn + (j - cells // 2 + OFF_SHIFT) * step[1]
            theta, y = config[0] + turn, config[2] + shift
            n = free_intervals(config, theta, y, 0, obstacles, crossings, intervals[0])
            n = cut_by_wall(config, theta, y, obstacles, intervals[0], n)
            m = free_intervals(config, theta, y, 1, obstacles, crossings, intervals[1])
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
