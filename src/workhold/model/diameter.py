"""The diameter of a workpiece: the largest distance between two points of its outline."""

from __future__ import annotations

from math import hypot, pi, sin, tau

import numpy as np

from workhold.geometry.segment import Arc, Segment
from workhold.model.workpiece import Workpiece

__all__ = ["outline_diameter", "segments_diameter"]

# Distances that differ by less in proportion may be equal but for rounding.
ROUNDED = 1e-9


def outline_diameter(workpiece: Workpiece) -> float:
    """Largest distance in mm between two points of the silhouette, and of the outlines of carriers.

    Its ends are two joints, a joint and the far side of an arc, or the far sides of two arcs. Far sides lie
    on the line through the arcs' centres.
    """
    outer = [face.segment for one in workpiece.every_outline for face in one.outer_faces]
    middle = np.array([segment.at(0.0) for segment in outer])
    reach = np.array([farthest_from_middle(segment) for segment in outer])
    apart = [np.hypot(*(middle[index:] - middle[index]).T) for index in range(len(outer))]
    best, least = 0.0, max(float(distances.max()) for distances in apart)
    for index, distances in enumerate(apart):
        # Only pairs that are far enough apart are looked at closely.
        most = (distances + reach[index] + reach[index:]) * (1.0 + ROUNDED)
        for other in index + np.flatnonzero(most >= max(best, least)):
            best = max(best, segments_diameter(outer[index], outer[other]))
    return best


def farthest_from_middle(segment: Segment) -> float:
    """Largest distance in mm between the middle of a segment and a point of it."""
    if isinstance(segment, Arc):
        return 2.0 * segment.radius * sin(min(segment.half_sweep, pi) / 2.0)
    return segment.half_extent


def segments_diameter(a: Segment, b: Segment) -> float:
    """Largest distance in mm between a point of one segment and a point of another."""
    best = max(hypot(p[0] - q[0], p[1] - q[1]) for p in (a.start, a.end) for q in (b.start, b.end))
    for arc, other in ((a, b), (b, a)):
        if isinstance(arc, Arc):
            for q in (other.start, other.end):
                if (far := far_point(arc, q)) is not None:
                    best = max(best, hypot(far[0] - q[0], far[1] - q[1]))
    if isinstance(a, Arc) and isinstance(b, Arc):
        far_a, far_b = far_point(a, b.center), far_point(b, a.center)
        if far_a is not None and far_b is not None:
            best = max(best, hypot(far_a[0] - far_b[0], far_a[1] - far_b[1]))
        opposite = abs((a.mid_angle - b.mid_angle) % tau - pi)
        if a.center == b.center and opposite <= a.half_sweep + b.half_sweep:
            best = max(best, a.radius + b.radius)
    return best


def far_point(arc: Arc, point: tuple[float, float]) -> tuple[float, float] | None:
    """The point of an arc's circle farthest from a point, if it lies on the arc."""
    dx, dy = arc.center[0] - point[0], arc.center[1] - point[1]
    distance = hypot(dx, dy)
    if distance == 0.0:
        return None
    far = (arc.center[0] + arc.radius * dx / distance, arc.center[1] + arc.radius * dy / distance)
    return far if abs(arc.parameter(far)) <= arc.half_sweep else None
