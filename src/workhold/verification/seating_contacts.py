"""Contacts that a seating states, and where what moves stops without the part."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import inf, sqrt

from attrs import frozen
from flint import arb

from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Peg
from workhold.verification.balls import Point, exact_point, turned
from workhold.verification.outline import BallOutline
from workhold.verification.sides import ArcSide
from workhold.verification.tolerances import AGREEMENT

__all__ = ["StatedContact", "stop_of", "touching_faults", "touching_wall"]

# mm. A tip may be in a locator by this much: rounding.
APART = 1e-6


@frozen
class StatedContact:
    """A contact of a seat or a pass.

    Parameters
    ----------
    peg : its number.
    at, normal : in the toolkit's frame, in mm from its origin, where the part is touched, and the outward
        unit normal there.
    off : how far in mm the peg is from touching, at most.
    is_inside : whether what is touched is the inside of a face, or a corner.
    """

    peg: int
    at: Point
    normal: Point
    off: float
    is_inside: bool


def touching_wall(
    outline: BallOutline, contact: Mapping[str, int], pose: Mapping[str, float], mirrored: bool
) -> StatedContact:
    """A contact with a wall along x at y = 0: a corner, or the lowest point of a convex arc above it."""
    number, down, is_corner = contact["peg"], exact_point(0.0, -1.0), "corner" in contact
    side = outline.faces.get(contact["corner" if is_corner else "face"])
    sine, cosine = (arb(pose["theta_deg"]) / 180).sin_cos_pi()
    if is_corner and side is not None:
        local, off = side.start, arb(0)
    elif isinstance(side, ArcSide) and side.sign > 0:
        x, y = turned(down, cosine, -sine)
        x = -x if mirrored else x
        local = side.center[0] + side.radius * x, side.center[1] + side.radius * y
        off = side.distance(local)
    else:
        return StatedContact(number, exact_point(0.0, 0.0), down, float("inf"), False)
    x, y = turned((-local[0], local[1]) if mirrored else local, cosine, sine)
    at = x + pose["x"], y + pose["y"]
    return StatedContact(number, at, down, float(abs(at[1]).upper()), bool(off < AGREEMENT))


def touching_faults(contacts: Sequence[StatedContact], on_wall: Sequence[int], wall: str) -> Iterator[str]:
    """Contacts that do not touch what they are said to touch, or stand there twice, or lack the wall's first end.

    The pegs ``on_wall`` are ends of the contact with what is called ``wall``.
    """
    ends = [one.peg for one in contacts if one.peg in on_wall]
    if ends != list(on_wall[: len(ends)]):
        yield f"does not tell the ends on the {wall} from the first on"
    if len({(one.peg, *(round(float(part.mid()), 5) for part in one.at)) for one in contacts}) < len(contacts):
        yield "has a contact twice"
    for one in contacts:
        if not (one.off < AGREEMENT and one.is_inside):
            yield f"has peg {one.peg} not where it is said to touch"


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
