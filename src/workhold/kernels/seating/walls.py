"""A straight wall, to which corners of a part's hull and convex arcs on it come no nearer than they may.

A row of a hull has the centre x and y of a piece about the centre of the part's box, and its radius. Then
follow the unit vector to its middle, and the cosine of half its sweep. The cosine is -2 for a corner, which
supports in every direction. See ``geometry.hull_edges``.
"""

from __future__ import annotations

from math import cos, inf, sin

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.compiling import inner
from workhold.kernels.seating.columns import Obstacles

Array = NDArray[np.float64]
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
def cut_by_wall(config: Array, theta: float, y: float, obstacles: Obstacles, intervals: Array, count: int) -> int:
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
