"""Keep-out zones as balls: how far a point is from one."""

from __future__ import annotations

from collections.abc import Sequence

from flint import arb

from workhold.model.restrictions import Zone
from workhold.verification.balls import Point, cross, dot
from workhold.verification.sides import ArcSide, Side, vertex_side

__all__ = ["zone_distance"]


def zone_distance(zone: Zone, point: Point) -> arb:
    """Distance in mm from a point to a zone, 0 inside."""
    vertices = [(float(x), float(y), float(bulge)) for x, y, bulge in zone.loop]
    sides = [vertex_side(a, b) for a, b in zip(vertices, vertices[1:] + vertices[:1], strict=True)]
    if turns_around(sides, point) > arb.pi():
        return arb(0)
    nearest = sides[0].distance(point)
    for side in sides[1:]:
        nearest = nearest.min(side.distance(point))
    return nearest


def turns_around(sides: Sequence[Side], point: Point) -> arb:
    """Angle in radians that closed sides turn around a point off them: a whole turn inside, none outside.

    A side turns as its chord does, and an arc by a whole turn more or less when the point lies between it and its chord.
    """
    total = arb(0)
    for side in sides:
        a = side.start[0] - point[0], side.start[1] - point[1]
        b = side.end[0] - point[0], side.end[1] - point[1]
        total += arb.atan2(cross(a, b), dot(a, b))
        if isinstance(side, ArcSide):
            beside = side.sign * cross(a, b) < 0
            ray = side.from_center(point)
            if beside and dot(ray, ray) < side.radius * side.radius:
                total += side.sign * 2 * arb.pi()
    return total
