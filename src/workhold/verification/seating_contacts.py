"""Contacts that a seating tells: where the part is touched, and whether it is."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from attrs import frozen
from flint import arb

from workhold.verification.balls import Point, exact_point, turned
from workhold.verification.outline import Outline
from workhold.verification.sides import ArcSide
from workhold.verification.tolerances import AGREEMENT

__all__ = ["Touching", "touching_faults", "touching_wall"]


@frozen
class Touching:
    """A contact of a seat or a pass.

    Parameters
    ----------
    peg : its number.
    at, normal : in the toolkit's frame, in mm from its origin, where the part is touched, and the outward unit normal there.
    off : how far in mm the peg is from touching, at most.
    is_inside : whether what is touched is the inside of a face, or a corner.
    """

    peg: int
    at: Point
    normal: Point
    off: float
    is_inside: bool


def touching_wall(outline: Outline, contact: Mapping[str, int], pose: Mapping[str, float], mirrored: bool) -> Touching:
    """A contact with a wall along x at y = 0, the part above it: a corner, or the lowest point of a convex arc."""
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
        return Touching(number, exact_point(0.0, 0.0), down, float("inf"), False)
    x, y = turned((-local[0], local[1]) if mirrored else local, cosine, sine)
    at = x + pose["x"], y + pose["y"]
    return Touching(number, at, down, float(abs(at[1]).upper()), bool(off < AGREEMENT))


def touching_faults(contacts: Sequence[Touching], on_wall: Sequence[int]) -> Iterator[str]:
    """Contacts that do not touch what they are said to touch, or are told twice, or on a wall, of which the ends have these
    numbers, not from the first on."""
    ends = [one.peg for one in contacts if one.peg in on_wall]
    if ends != list(on_wall[: len(ends)]):
        yield "does not tell the ends on the fence from the first on"
    if len({(one.peg, *(round(float(part.mid()), 5) for part in one.at)) for one in contacts}) < len(contacts):
        yield "has a contact twice"
    for one in contacts:
        if not (one.off < AGREEMENT and one.is_inside):
            yield f"has peg {one.peg} not where it is said to touch"
