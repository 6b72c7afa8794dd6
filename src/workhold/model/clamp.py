"""What shows of a clamp that is bolted to a plate: its hole, its body and which way it pushes."""

from __future__ import annotations

from collections.abc import Iterator
from math import atan2, hypot, pi

from attrs import frozen

from workhold.fixels.carrier import Carrier
from workhold.fixels.contact_kind import CLAMP_TIP
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.box import Box
from workhold.geometry.segment import Arc, Line, Point, Segment
from workhold.model.fixture import Fixture, Peg

__all__ = ["ShownClamp", "clamping_direction", "shown_clamps"]


@frozen
class ShownClamp:
    """What shows of a clamp; lengths in mm.

    Parameters
    ----------
    carrier : the whole of it.
    tip : the peg that touches the part.
    hole : centre of the hole that it is bolted in; None where only the line is known that its tip moves along.
    clamping : unit vector along which it pushes.
    pitch : distance along that line between holes.
    """

    carrier: Carrier
    tip: Peg
    hole: Point | None
    clamping: Point
    pitch: float

    @property
    def is_upright(self) -> bool:
        """Whether it pushes along a column rather than a row."""
        return self.clamping[0] == 0

    @property
    def back(self) -> Point:
        """Where its body begins: the hole, or the tip where that is all that is known."""
        return self.hole or (self.tip.x, self.tip.y)

    def outline(self, more: float = 0.0) -> tuple[Segment, ...]:
        """The outline of its body, counter-clockwise: a capsule from the hole to the tip, or the circle of the tip alone.

        Parameters
        ----------
        more : how much larger the outline is than the body, in mm.
        """
        (ax, ay), (bx, by), radius = self.back, (self.tip.x, self.tip.y), self.carrier.peg_radius + more
        length = hypot(bx - ax, by - ay)
        if length == 0:
            return (Arc((bx, by), radius, 0.0, pi, 1.0),)
        along, (x, y) = atan2(by - ay, bx - ax), (radius * (bx - ax) / length, radius * (by - ay) / length)
        return (
            Line((ax + y, ay - x), (bx + y, by - x)),
            Arc((bx, by), radius, along, pi / 2, 1.0),
            Line((bx - y, by + x), (ax - y, ay + x)),
            Arc((ax, ay), radius, along + pi, pi / 2, 1.0),
        )

    @property
    def extent(self) -> Box:
        """That of its body."""
        one, other = (Box(x, y, x, y).grown(self.carrier.peg_radius) for x, y in (self.back, (self.tip.x, self.tip.y)))
        return one.union(other)

    @property
    def room(self) -> Box:
        """Its body, and one pitch behind it for the hand that sets it and the arrow that tells its direction."""
        behind = self.behind(self.pitch)
        return self.extent.union(Box(*behind, *behind))

    def behind(self, away: float, aside: float = 0.0) -> Point:
        """A point so far behind the hole, or the tip, and beside its line."""
        (x, y), (dx, dy) = self.back, self.clamping
        return x - away * dx - aside * dy, y - away * dy + aside * dx


def shown_clamps(fixture: Fixture, toolkit: Toolkit) -> Iterator[ShownClamp]:
    """The clamps that hold the part."""
    for peg in fixture.pegs:
        carrier = toolkit.carrier(peg.carrier)
        clamping = clamping_direction(carrier, toolkit)
        if carrier.contact is CLAMP_TIP and clamping is not None:
            hole = carrier.place(peg.column, peg.row) if carrier.measure == "stroke" else None
            yield ShownClamp(carrier, peg, hole, clamping, carrier.pitch[0 if carrier.line == "row" else 1])


def clamping_direction(carrier: Carrier, toolkit: Toolkit) -> Point | None:
    """Along which a carrier slides when it clamps, a unit vector; None when it stands still."""
    if carrier.travel is None:
        return None
    x, y = carrier.travel.unit
    return (0.0 - toolkit.clamping * x, 0.0 - toolkit.clamping * y)
