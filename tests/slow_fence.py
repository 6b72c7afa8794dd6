"""A slow search of a fence that shares no arithmetic with the program's.

Orientations are found where the lowest point of the part jumps as the part turns, by halving; a peg on a line touches where
the distance from the outline less the radius changes its sign along the line, found on a fine grid and by halving; and four
contacts close where the null vector of their wrenches, of a singular value decomposition, has one sign.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from math import atan2, cos, hypot, pi, sin, tau
from typing import Any

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold import Fence, Workpiece
from workhold.geometry.segment import Arc, Line, Segment

Point = tuple[float, float]
Array = NDArray[np.float64]
GRID = 0.1
WAYS = {"-x": (-1.0, 0.0), "+x": (1.0, 0.0), "-y": (0.0, -1.0), "+y": (0.0, 1.0)}


@frozen
class Touch:
    """A peg that touches: its centre, the outward normal there and the number of the face."""

    center: Point
    normal: Point
    face: int


def turned(point: Point, angle: float) -> Point:
    """A point turned about the origin."""
    x, y = point
    return cos(angle) * x - sin(angle) * y, sin(angle) * x + cos(angle) * y


def lowest(part: Workpiece, angle: float) -> tuple[int, Point]:
    """The lowest point of the part, in its own frame, when it is turned by an angle, and which corner or arc it is of."""
    down = atan2(*reversed(turned((0.0, -1.0), -angle)))
    points = []
    for number, segment in enumerate(part.segments[: part.outer_count]):
        points.append((2 * number, segment.start))
        convex = isinstance(segment, Arc) and segment.sign > 0
        if convex and abs((down - segment.mid_angle + pi) % tau - pi) <= segment.half_sweep:
            (x, y), r = segment.center, segment.radius
            points.append((2 * number + 1, (x + r * cos(down), y + r * sin(down))))
    return min(points, key=lambda one: turned(one[1], angle)[1])


def orientations(part: Workpiece, steps: int = 720) -> Iterator[tuple[float, Point, Point]]:
    """Orientations in which two points lie on the wall, with these, the left one first."""
    for k in range(steps):
        yield from jumps(part, tau * (k + 0.3217) / steps, tau * (k + 1.3217) / steps)


def jumps(part: Workpiece, low: float, high: float) -> Iterator[tuple[float, Point, Point]]:
    """Orientations between two in which the lowest point jumps: from a corner or an arc to another one that is apart."""
    (first, one), (last, other) = lowest(part, low), lowest(part, high)
    if first == last:
        return
    middle = (low + high) / 2
    if high - low < 1e-13:
        if hypot(one[0] - other[0], one[1] - other[1]) > 1e-6:
            yield middle, *sorted((one, other), key=lambda point: turned(point, middle)[0])
        return
    yield from jumps(part, low, middle)
    yield from jumps(part, middle, high)


def distances(points: Array, face: Segment) -> Array:
    """Distances (N,) of points (N, 2) from a face."""
    ends = [
        np.hypot(*(points - np.array(face.compute_point(way * face.half_extent))).T) for way in (-1.0, 1.0)
    ]
    if isinstance(face, Line):
        from_middle, along = points - np.array(face.middle), np.array(face.tangent)
        s, across = from_middle @ along, np.abs(from_middle @ np.array(face.compute_normal()))
    else:
        from_middle = points - np.array(face.center)
        s = (np.arctan2(from_middle[:, 1], from_middle[:, 0]) - face.mid_angle + pi) % tau - pi
        across = np.abs(np.hypot(*from_middle.T) - face.radius)
    return np.where(np.abs(s) <= face.half_extent, across, np.minimum(*ends))


def touches(
    part: Workpiece, line: tuple[Point, Point], radius: float, low: float, high: float
) -> list[Touch]:
    """Where a peg about a point of a line (a point and a direction) touches inside one face."""
    start, along = np.array(line[0]), np.array(line[1])
    faces = [face.segment for face in part.faces]
    grid = np.arange(low, high, GRID)

    def gaps(s: Array) -> Array:
        points = start + s[:, None] * along
        return np.min([distances(points, face) for face in faces], axis=0) - radius

    outside = gaps(grid) > 0
    change = np.flatnonzero(outside[1:] != outside[:-1])
    a, b = grid[change], grid[change + 1]
    for _ in range(55):
        middle = (a + b) / 2
        same = (gaps(middle) > 0) == outside[change]
        a, b = np.where(same, middle, a), np.where(same, b, middle)
    found = []
    for s in a.tolist():
        center = (float(start[0] + s * along[0]), float(start[1] + s * along[1]))
        near = sorted((float(distances(np.array([center]), face)[0]), k) for k, face in enumerate(faces))
        segment, number = faces[near[0][1]], part.faces[near[0][1]].number
        place = segment.find_parameter(center)
        slack = (segment.half_extent - abs(place)) * (segment.radius if isinstance(segment, Arc) else 1.0)
        normal = segment.compute_normal(place)
        foot = segment.compute_point(place)
        outward = (center[0] - foot[0]) * normal[0] + (center[1] - foot[1]) * normal[1]
        if slack > 1e-7 and near[1][0] > radius + 1e-7 and outward > 0:
            found.append(Touch(center, normal, number))
    return found


def lines_of(
    fence: Fence, way: str, u: float, laid: Workpiece, rows: list[float]
) -> Iterator[tuple[int, Any, Any]]:
    """The clamp's lines with a locator at u: row, or column from the locator's; the line; and how far to look."""
    low, _, high, top = laid.bounds
    if way[1] == "x":
        for k, v in enumerate(rows):
            yield k, ((0.0, v), (1.0, 0.0)), (low - 20.0, high + 20.0)
        return
    for k in range(-int(200 / fence.pitch[0]), int(200 / fence.pitch[0]) + 1):
        across = u + k * fence.pitch[0]
        if low - 20.0 < across < high + 20.0 and (fence.columns is None or abs(k) < fence.columns):
            yield k, ((across, 0.0), (0.0, 1.0)), (-20.0, top + 20.0)


def slow_fence(
    part: Workpiece,
    fence: Fence,
    met_by_clamp: Workpiece | None = None,
    met_by_wall: Workpiece | None = None,
) -> set[tuple[Any, ...]]:
    """All fixtures of a clamp without a body: direction, faces of locator and clamp, row of the locator, line of the clamp,
    and from the left end of the contact with the wall, to a thousandth of a mm, x of the locator, x and y of the tip.

    Parameters
    ----------
    met_by_clamp, met_by_wall : the outlines that these meet; that of the locator if None.
    """
    out = set()
    for angle, left, right in orientations(met_by_wall or part):
        (x0, y0), (x1, _) = turned(left, angle), turned(right, angle)

        def put(one: Workpiece, angle: float = angle, x0: float = x0, y0: float = y0) -> Workpiece:
            loops = [[(*turned((x, y), angle), b) for x, y, b in loop] for loop in one.loops]
            return Workpiece.from_loops(
                "laid", [[(x - x0, y - y0, b) for x, y, b in loop] for loop in loops], solid=one.solid
            )

        laid, met = put(part), put(met_by_clamp or part)
        low, _, high, top = laid.bounds
        low, high, top = min(low, met.bounds[0]), max(high, met.bounds[2]), max(top, met.bounds[3])
        rows = [fence.wall_offset + k * fence.pitch[1] for k in range(int(top / fence.pitch[1]) + 2)][
            : fence.rows
        ]
        known: dict[Any, list[Touch]] = {}

        def on(part: Workpiece, *asked: Any, known: dict[Any, list[Touch]] = known) -> list[Touch]:
            key = id(part), *asked
            if key not in known:
                known[key] = touches(part, *asked)
            return known[key]

        ends = [(0.0, -1.0, 0.0), (0.0, -1.0, -(x1 - x0))]
        for (row, y), way in product(enumerate(rows), fence.directions):
            for one in on(laid, ((0.0, y), (1.0, 0.0)), fence.peg_radius, low - 20.0, high + 20.0):
                u = one.center[0]
                for line, at, reach in lines_of(fence, way, u, met, rows):
                    for two in on(met, at, fence.clamp_radius, *reach):
                        (x, v), push = two.center, -float(np.dot(two.normal, WAYS[way]))
                        apart = hypot(x - u, v - y) >= fence.peg_radius + fence.clamp_radius
                        if push <= 1e-6 or v < fence.clamp_radius or not apart:
                            continue
                        pegs = [
                            (*t.normal, t.center[0] * t.normal[1] - t.center[1] * t.normal[0])
                            for t in (one, two)
                        ]
                        force = np.linalg.svd(np.array([*ends, *pegs]).T)[2][-1]
                        if force.min() > 1e-6 or force.max() < -1e-6:
                            places = (round(value, 3) + 0.0 for value in (u, x, v))
                            out.add((way, one.face, two.face, row, line, *places))
    return out
