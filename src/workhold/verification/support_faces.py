"""Faces that supports and a clamp touch, by their segments: how large a disc lies on them; their centre."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import atan2, ceil, hypot, inf, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from workhold.geometry.loop import loop_segments
from workhold.geometry.segment import Arc, Segment, distance_to_segment

__all__ = ["area_center", "room_on"]

Array = NDArray[np.float64]


def turns_about(segments: Sequence[Segment], point: tuple[float, float]) -> int:
    """How often a loop runs around a point off it."""
    turned = 0.0
    for one in segments:
        places = [one.start, one.end]
        if isinstance(one, Arc):
            near = abs(hypot(point[0] - one.center[0], point[1] - one.center[1]) - one.radius)
            # A chord passes nearer to its arc than the point does.
            steps = min(4096, 8 + ceil(2 * one.half_sweep / sqrt(max(near / one.radius, 1e-8))))
            low = -one.sign * one.half_sweep
            places = [one.at(low * (1 - 2 * k / steps)) for k in range(steps + 1)]
        angles = [atan2(y - point[1], x - point[0]) for x, y in places]
        turned += sum((b - a + pi) % (2 * pi) - pi for a, b in pairwise(angles))
    return round(turned / (2 * pi))


def room_on(loops: Sequence[Array], zones: Sequence[Array], point: tuple[float, float]) -> float:
    """How large a disc about a point lies on a face and over no zone, in mm; negative off it."""
    outer: list[tuple[Segment, ...]] = []
    best, room = -inf, inf
    for number, loop in enumerate([*loops, *zones]):
        segments = tuple(loop_segments(np.asarray(loop)))
        near = min(distance_to_segment(point, one) for one in segments)
        is_in = turns_about(segments, point) != 0
        # A loop within another is an opening, one beside it a further face.
        if number < len(loops) and all(turns_about(one, segments[0].start) == 0 for one in outer):
            outer.append(segments)
            best = max(best, near if is_in else -near)
        else:
            room = min(room, -near if is_in else near)
    return min(best, room)


def area_center(loops: Sequence[Sequence[Segment]]) -> tuple[float, float]:
    """The centre of area of the part, from integrals along its border (Gauss-Legendre along each segment)."""
    nodes, weights = np.polynomial.legendre.leggauss(24)
    area = first = second = 0.0
    for one in (segment for loop in loops for segment in loop):
        if isinstance(one, Arc):
            low = one.mid_angle - one.sign * one.half_sweep
            sweep = 2 * one.sign * one.half_sweep
            angle = low + sweep * (nodes + 1) / 2
            x, y = one.center[0] + one.radius * np.cos(angle), one.center[1] + one.radius * np.sin(angle)
            dx, dy = -one.radius * np.sin(angle) * sweep / 2, one.radius * np.cos(angle) * sweep / 2
        else:
            (x0, y0), (x1, y1) = one.start, one.end
            x, y = x0 + (x1 - x0) * (nodes + 1) / 2, y0 + (y1 - y0) * (nodes + 1) / 2
            dx, dy = np.full(len(nodes), (x1 - x0) / 2), np.full(len(nodes), (y1 - y0) / 2)
        area += float(weights @ (x * dy))
        first += float(weights @ (x * x * dy)) / 2
        second -= float(weights @ (y * y * dx)) / 2
    return first / area, second / area
