"""Whether a peg that slides a little along its face keeps clear of other sides.

Glossary
--------
clearance : distance in mm from a side to the peg, negative when the peg enters it.
alongside : the clearance changes so slowly while the peg slides that its face and the side point the same way, or opposite
    ways. So it is beside a tangent joint, and in a slot exactly as wide as the peg.

A side is clear when the clearance is positive, and one that runs alongside when it is above minus a hair (``findings``).
"""

from __future__ import annotations

from collections.abc import Sequence

from flint import arb

from workhold.verification.balls import Point, dot, norm, turned
from workhold.verification.contacts import Contact
from workhold.verification.sides import LineSide, Side
from workhold.verification.tolerances import HAIR, TANGENT

__all__ = ["clear_within"]

# Pieces of a feature looked at before it is left undecided, and half the length in mm of the shortest.
MOST_PIECES = 1 << 14
SHORTEST = HAIR / 1024


def along_feature(contact: Contact, center: Point, step: arb) -> Point:
    """The point a length in mm along the contact feature from a peg's centre."""
    side = contact.side
    if isinstance(side, LineSide):
        return center[0] + step * side.tangent[0], center[1] + step * side.tangent[1]
    angle = step / side.reach(contact.radius)
    x, y = turned(side.from_center(center), angle.cos(), angle.sin())
    return side.center[0] + x, side.center[1] + y


def runs_alongside(contact: Contact, center: Point, side: Side) -> bool:
    """Whether a side runs alongside a peg's face where the peg is."""
    one, two = (side.distance(along_feature(contact, center, arb(step))) for step in (-HAIR, HAIR))
    return bool(abs(one - two) < 2 * HAIR * TANGENT)


def clear_within(contact: Contact, center: Point, sides: Sequence[Side], reach: float) -> bool | None:
    """Whether a peg stays clear of some sides as far as a reach in mm along its feature; None when that is not decided.

    Pieces of the feature that are not seen to be clear are halved.
    """
    pieces = [(arb(0), arb(reach))]
    looked_at = 0
    decided = True
    while pieces and looked_at < MOST_PIECES:
        middle, half = pieces.pop()
        looked_at += 1
        point = along_feature(contact, center, middle)
        around = along_feature(contact, center, middle + arb(0, half))
        doubtful = False
        for side in sides:
            clearance = side.distance(point) - contact.clear_radius
            loss = half * steepness(contact, side, around)
            if clearance > loss:
                continue
            close = clearance < 0 or clearance + HAIR > loss
            allowed = HAIR if close and runs_alongside(contact, point, side) else 0.0
            if clearance < -allowed:
                return False
            doubtful = doubtful or not clearance + allowed > loss
        if doubtful and half < SHORTEST:
            decided = False
        elif doubtful:
            pieces += [(middle - half / 2, half / 2), (middle + half / 2, half / 2)]
    return True if decided and not pieces else None


def steepness(contact: Contact, side: Side, around: Point) -> arb:
    """Bound on how much a side's clearance changes per mm that the peg slides, its centre in a box; at most 1.

    It is the cosine between the peg's way and the way from the side's nearest point to the peg's centre.
    """
    away = side.away(around)
    if away is None:
        return arb(1)
    if isinstance(contact.side, LineSide):
        along = contact.side.tangent
    else:
        ray = contact.side.from_center(around)
        along = -ray[1], ray[0]
    size = norm(away) * norm(along)
    return (abs(dot(along, away)) / size).min(arb(1)) if size > 0 else arb(1)
