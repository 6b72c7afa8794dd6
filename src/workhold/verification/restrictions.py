"""Whether a fixture keeps the restrictions.

They are no claims of existence, so the pose as it is written is enough: one is broken when it is missed by more than
``rules.AGREEMENT``.
"""

from __future__ import annotations

from flint import arb

from workhold.model.fixture import Fixture, Peg
from workhold.model.query import Query
from workhold.verification.balls import Point, exact_point, turned
from workhold.verification.hardware import Hardware
from workhold.verification.rules import AGREEMENT, WALL
from workhold.verification.zones import zone_distance

__all__ = ["broken_restriction"]


def broken_restriction(fixture: Fixture, query: Query, hardware: Hardware) -> str:
    """The restriction that a fixture breaks, in one sentence without a full stop; empty when it keeps all."""
    restrictions = query.restrictions
    avoided = {face.number for face in query.workpiece.faces if set(face.segments) & set(restrictions.avoid)}
    for name, peg in zip(hardware.names, fixture.pegs, strict=True):
        if peg.carrier == WALL:
            # What a wall keeps clear of is the hardware's to say.
            continue
        if peg.face in avoided:
            return f"{name} touches face {peg.face}, which is to be avoided"
        for zone in restrictions.zones:
            if zone_distance(zone, in_part(fixture, peg)) < hardware.body_radius(peg) - AGREEMENT:
                return f"{name} stands over a keep-out zone"
    theta = fixture.pose.theta_deg
    inside = ((theta - low + AGREEMENT) % 360.0 <= high - low + 2 * AGREEMENT for low, high in restrictions.angles)
    if restrictions.angles and not any(inside):
        return f"the part lies at {theta:g} degrees, which is outside the angles asked for"
    return hardware.broken_restriction(fixture, query)


def in_part(fixture: Fixture, peg: Peg) -> Point:
    """A peg's centre in the part's frame; in balls, and not by ``Pose``, which is what is checked."""
    sine, cosine = (arb(fixture.pose.theta_deg) / 180).sin_cos_pi()
    return turned(exact_point(peg.x - fixture.pose.x, peg.y - fixture.pose.y), cosine, -sine)
