"""Where what moves is stopped, and how far it has gone, from the places of pegs alone."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, sqrt

from workhold.model.fixture import Peg
from workhold.model.toolkit import Toolkit

__all__ = ["stop_of", "travelled"]

# mm. A tip may be in a locator by this much: rounding.
APART = 1e-6


def travelled(peg: Peg, toolkit: Toolkit) -> float:
    """How far in mm the carrier of a peg that moves has gone, from the peg's place."""
    carrier = toolkit.carrier(peg.carrier)
    assert carrier.travel is not None
    (x, y), (ux, uy) = carrier.place(peg.column, peg.row), carrier.travel.unit
    return float((peg.x - x) * ux + (peg.y - y) * uy)


def stop_of(pegs: Sequence[Peg], toolkit: Toolkit, separation: float) -> float | None:
    """The travel in mm at which what moves is stopped without the part; None where nothing stops it.

    Parameters
    ----------
    pegs : of a fixture.
    separation : the travel there, in mm.
    """
    moved = [peg for peg in pegs if toolkit.carrier(peg.carrier).travel is not None]
    still = [peg for peg in pegs if peg not in moved and not peg.is_on_wall]
    moving, tip = toolkit.carrier(moved[0].carrier), moved[0]
    assert moving.travel is not None
    if toolkit.clamping < 0:
        return moving.travel.most
    if toolkit.gap is not None:
        return toolkit.gap + max(peg.x for peg in still) - min(peg.x for peg in moved) + separation
    ends, (ux, uy) = [moving.travel.least], moving.travel.unit
    for peg in still:
        dx, dy = peg.x - tip.x, peg.y - tip.y
        along, across = dx * ux + dy * uy, dx * uy - dy * ux
        square = (moving.peg_radius + toolkit.carrier(peg.carrier).peg_radius) ** 2 - across * across
        # It moves against its unit vector, and meets what lies there.
        if square > 0.0 and along <= 0.0:
            ends.append(separation + min(along + sqrt(square), APART))
    if toolkit.wall is not None and uy > 0.0:
        ends.append(separation + moving.peg_radius - tip.y)
    least = max(ends)
    return None if least == -inf else least
