"""Keep-out zones as balls: how far a point is from one."""

from __future__ import annotations

from collections.abc import Sequence

from flint import arb

from workhold.model.restrictions import Zone
from workhold.verification.balls import Point, cross, dot, least, turned
from workhold.verification.sides import ArcSide, Side, vertex_side

__all__ = ["zone_distance", "zone_low"]


def zone_sides(zone: Zone) -> list[Side]:
    """The sides of a zone."""
    vertices = [(float(x), float(y), float(bulge)) for x, y, bulge in zone.loop]
    return [vertex_side(a, b) for a, b in zip(vertices, vertices[1:] + vertices[:1], strict=True)]


def zone_low(zone: Zone, cosine: arb, sine: arb) -> arb:
    """y in mm of the lowest point of a zone, once it is turned about the workpiece's origin."""
    low = None
    for side in zone_sides(zone):
        heights = [turned(point, cosine, sine)[1] for point in (side.start, side.end)]
        if isinstance(side, ArcSide) and not side.within((-sine, -cosine)) < 0:
            heights.append(turned(side.center, cosine, sine)[1] - side.radius)
        for height in heights:
            low = height if low is None else low.min(height)
    assert low is not None
    return low


def zone_distance(zone: Zone, point: Point) -> arb:
    """Distance in mm from a point to a zone, 0 inside."""
    sides = zone_sides(zone)
    nearest = least([side.distance(point) for side in sides])
    # On the chord of an arc, as at a circle's centre, turns are not told. Nearer than any side all is inside, or none is.
    reach = nearest.abs_lower()
    for across, along in ((0.0, 0.0), (0.5, 0.25), (-0.25, 0.5)):
        turns = turns_around(sides, (point[0] + across * reach, point[1] + along * reach))
        if turns > arb.pi():
            return arb(0)
        if turns < arb.pi():
            break
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
