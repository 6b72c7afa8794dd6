"""Whether a fixture keeps the restrictions: faces to avoid, keep-out zones, angles, blocked holes and bodies.

They are no claims of existence, so the pose as it is written is enough: one is broken when it is missed by
more than ``tolerances.AGREEMENT``.
"""

from __future__ import annotations

from collections.abc import Sequence

from flint import arb

from workhold.model.fixture import Fixture, Peg
from workhold.model.query import Query
from workhold.model.restrictions import Zone
from workhold.verification.balls import Point, cross, dot, exact_point, least, turned
from workhold.verification.outline import BallOutline
from workhold.verification.rules.hardware import ToolkitRules
from workhold.verification.rules.wall import WallContact
from workhold.verification.sides import ArcSide, Side, vertex_side
from workhold.verification.tolerances import AGREEMENT

__all__ = ["broken_restriction", "zone_distance"]


def broken_restriction(fixture: Fixture, query: Query, hardware: ToolkitRules) -> str:
    """The restriction that a fixture breaks, in one sentence without a full stop; empty when it keeps all."""
    restrictions = query.restrictions
    avoided = {face.number for face in query.workpiece.faces if set(face.segments) & set(restrictions.avoid)}
    for name, peg in zip(hardware.names, fixture.pegs, strict=True):
        if peg.is_on_wall:
            continue
        if peg.face in avoided:
            return f"{name} touches face {peg.face}, which is to be avoided"
        for zone in restrictions.zones:
            if zone_distance(zone, in_part(fixture, peg)) < hardware.carriers[peg.carrier].body_radius - AGREEMENT:
                return f"{name} stands over a keep-out zone"
    theta = fixture.pose.theta_deg
    inside = ((theta - low + AGREEMENT) % 360.0 <= high - low + 2 * AGREEMENT for low, high in restrictions.angles)
    if restrictions.angles and not any(inside):
        return f"the part lies at {theta:g} degrees, which is outside the angles asked for"
    if hardware.wall is None:
        return hardware.crowding(fixture)
    noun = hardware.wall.noun
    # Of a corner on a wall both faces are to be avoided.
    for contact in hardware.contacts(fixture, BallOutline.of(query.workpiece)):
        if isinstance(contact, WallContact) and avoided.issuperset(contact.faces):
            return f"the part lies on the {noun} with face {contact.faces[0]}, which is to be avoided"
    sine, cosine = (arb(theta) / 180).sin_cos_pi()
    for zone in restrictions.zones:
        if zone_low(zone, cosine, sine) + fixture.pose.y < -AGREEMENT:
            return f"the {noun} stands in a keep-out zone"
    return hardware.crowding(fixture)


def in_part(fixture: Fixture, peg: Peg) -> Point:
    """A peg's centre in the part's frame; in balls, and not by ``Pose``, which is what is checked."""
    sine, cosine = (arb(fixture.pose.theta_deg) / 180).sin_cos_pi()
    return turned(exact_point(peg.x - fixture.pose.x, peg.y - fixture.pose.y), cosine, -sine)


def zone_sides(zone: Zone) -> list[Side]:
    """The sides of a zone."""
    vertices = [(float(x), float(y), float(bulge)) for x, y, bulge in zone.loop]
    return [vertex_side(a, b) for a, b in zip(vertices, vertices[1:] + vertices[:1], strict=True)]


def zone_low(zone: Zone, cosine: arb, sine: arb) -> arb:
    """y in mm of the lowest point of a zone, once it is turned about the workpiece's origin."""
    heights = []
    for side in zone_sides(zone):
        heights += [turned(point, cosine, sine)[1] for point in (side.start, side.end)]
        if isinstance(side, ArcSide) and not side.within((-sine, -cosine)) < 0:
            heights.append(turned(side.center, cosine, sine)[1] - side.radius)
    return least(heights)


def zone_distance(zone: Zone, point: Point) -> arb:
    """Distance in mm from a point to a zone, 0 inside."""
    sides = zone_sides(zone)
    nearest = least([side.distance(point) for side in sides])
    # On the chord of an arc, as at a circle's centre, turns are not certain. Nearer than any side all is
    # inside, or none is.
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

    A side turns as its chord does, and an arc by a whole turn more or less when the point lies between it and
    its chord.
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
