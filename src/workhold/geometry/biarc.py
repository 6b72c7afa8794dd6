"""Biarcs in place of a curve that is no line or arc.

Glossary
--------
biarc : two arcs that leave two points in given directions and meet in a common one (K. M. Bolton, "Biarc curves",
    Computer-Aided Design 7 (1975) 89-92; D. S. Meek and D. J. Walton, "Approximation of discrete data by G1 arc splines",
    Computer-Aided Design 24 (1992) 301-306).
joint : where the two arcs of a biarc meet.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import atan2, cos, dist, inf, pi, sin, sqrt, tan

import numpy as np
from attrs import frozen

from workhold.conventions import CORNER, SHORTEST
from workhold.geometry.curve_bounds import departure
from workhold.geometry.rational import Pieces, cut, direction_at, end_directions, point_at
from workhold.geometry.segment import Point, segment_from_bulge

__all__ = ["FittedRun", "biarcs", "corners_of"]

# A biarc is as long as it can be but for this share, and so many lengths are tried.
STEP, MOST_STEPS = 0.02, 60


@frozen
class FittedRun:
    """A line or arc in place of a part of a curve, its ends as points, and a bound of the distance in mm."""

    points: tuple[Point, ...]
    bulges: tuple[float, ...]
    departure: float


def biarcs(pieces: Pieces, tolerance: float) -> list[FittedRun]:
    """Biarcs in place of a curve, each as long as the tolerance allows, tangent to the curve where they meet.

    Corners of the curve stay corners.
    """
    corners = [0, *corners_of(pieces)]
    found: list[FittedRun] = []
    for first, last in zip(corners, [*corners[1:], len(pieces)], strict=True):
        found += smooth_biarcs(pieces[first:last], tolerance)
    return found


def smooth_biarcs(pieces: Pieces, tolerance: float) -> Iterator[FittedRun]:
    """Biarcs in place of a curve without corners."""
    total = float(len(pieces))
    place, step = 0.0, total
    while place < total:
        run, reach = longest_biarc(pieces, place, step, tolerance)
        yield run
        step, place = 1.2 * (reach - place), reach


def longest_biarc(pieces: Pieces, place: float, step: float, tolerance: float) -> tuple[FittedRun, float]:
    """The biarc that reaches farthest from a place of a curve, to within a share of ``STEP``, and where it ends.

    ``step`` is the first length tried. What is smaller than the tolerance may be a line instead.
    """
    total = float(len(pieces))
    room = total - place
    best, low, high = None, 0.0, inf
    step = min(step, room)
    for _ in range(MOST_STEPS):
        reach = total if step == room else place + step
        run = biarc(pieces, place, reach, tolerance) or small_line(pieces, place, reach, tolerance)
        if run is None:
            high = step
        else:
            best, low = run, step
        if best is not None and (low == room or high - low < STEP * high):
            return best, total if low == room else place + low
        step = min(2.0 * step, room) if high == inf else (low + high) / 2
    line = small_line(pieces, place, reach, inf)
    assert line is not None
    return line, reach


def small_line(pieces: Pieces, first: float, last: float, tolerance: float) -> FittedRun | None:
    """The line in place of a stretch of a curve, such as a cusp, that is smaller than the tolerance; None for others."""
    stretch = cut(pieces, first, last)
    places = (stretch[..., :2] / stretch[..., 2:]).reshape(-1, 2)
    size = float(np.hypot(*np.ptp(places, axis=0)))
    ends = point_at(pieces, first), point_at(pieces, last)
    return FittedRun(ends, (0.0,), size) if size <= tolerance else None


def biarc(pieces: Pieces, first: float, last: float, tolerance: float) -> FittedRun | None:
    """The biarc in place of a stretch of a smooth curve; None where it departs by more than the tolerance.

    Each arc is compared with the part of the curve between its ends. Both centres lie on the normal at the joint, so the
    curve changes from one arc to the other where it crosses that.
    """
    start, end = point_at(pieces, first), point_at(pieces, last)
    begins, ends = direction_at(pieces, first, after=True), direction_at(pieces, last, after=False)
    joint = joint_of(start, end, begins, ends)
    if joint is None or min(dist(start, joint), dist(joint, end)) < SHORTEST:
        return None
    one, other = turn(begins, less(joint, start)), turn(less(end, joint), ends)
    if max(abs(one), abs(other)) > pi / 2:
        return None
    c, s = cos(2 * one), sin(2 * one)
    middle = crossing(pieces, first, last, joint, (c * begins[0] - s * begins[1], s * begins[0] + c * begins[1]))
    if middle is None:
        return None
    bulges = tan(one / 2), tan(other / 2)
    away = 0.0
    for low, high, p, q, bulge in ((first, middle, start, joint, bulges[0]), (middle, last, joint, end, bulges[1])):
        away = max(away, departure(cut(pieces, low, high), segment_from_bulge(p, q, bulge), tolerance))
        if away > tolerance:
            return None
    return FittedRun((start, joint, end), bulges, away)


def less(p: Point, q: Point) -> Point:
    """The vector from q to p."""
    return p[0] - q[0], p[1] - q[1]


def turn(u: Point, v: Point) -> float:
    """Signed angle from one vector to another."""
    return atan2(u[0] * v[1] - u[1] * v[0], u[0] * v[0] + u[1] * v[1])


def joint_of(start: Point, end: Point, begins: Point, ends: Point) -> Point | None:
    """Where the arcs of a biarc meet when both tangents up to their corners are equally long; None where there is none.

    The length d solves |end - start - d (begins + ends)| = 2 d.
    """
    vx, vy = less(end, start)
    tx, ty = begins[0] + ends[0], begins[1] + ends[1]
    along, square = vx * tx + vy * ty, vx * vx + vy * vy
    # 4 - |t|², which is 2 (1 - begins . ends), without cancellation.
    lacking = (begins[0] - ends[0]) ** 2 + (begins[1] - ends[1]) ** 2
    divisor = along + sqrt(along * along + lacking * square)
    if divisor <= 0.0:
        return None
    d = square / divisor
    corners = (start[0] + d * begins[0], start[1] + d * begins[1]), (end[0] - d * ends[0], end[1] - d * ends[1])
    return (corners[0][0] + corners[1][0]) / 2, (corners[0][1] + corners[1][1]) / 2


def crossing(pieces: Pieces, first: float, last: float, joint: Point, across: Point) -> float | None:
    """The parameter at which a stretch of a curve crosses the line through a point, square to a direction (Illinois)."""

    def height(parameter: float) -> float:
        x, y = less(point_at(pieces, parameter), joint)
        return x * across[0] + y * across[1]

    low, high = height(first), height(last)
    if not low < 0.0 < high:
        return None
    size, side = high - low, 0
    middle = first
    for _ in range(100):
        middle = (first * high - last * low) / (high - low)
        value = height(middle)
        if abs(value) <= 1e-12 * size or last - first <= 1e-14 * last:
            break
        if value > 0.0:
            last, high = middle, value
            low, side = (low / 2 if side == 1 else low), 1
        else:
            first, low = middle, value
            high, side = (high / 2 if side == -1 else high), -1
    return middle


def corners_of(pieces: Pieces) -> list[int]:
    """Numbers of the pieces that begin in another direction than the piece before ends in."""
    leaving, entering = end_directions(pieces)
    turned = np.hypot(*(entering[:-1] - leaving[1:]).T) > CORNER
    return [int(k) + 1 for k in np.flatnonzero(turned)]
