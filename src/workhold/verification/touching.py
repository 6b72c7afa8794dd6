"""Whether a peg at its proven place touches its face inside its ends, and nothing else of the workpiece.

Rules, with the hair of ``findings``:

- ends: a contact lies at least margin - hair inside the ends of the face, and more than a hair at an end that
  is no tangent joint: a margin that is met exactly is met, and without one a contact at an end is none;
- elsewhere: as far as that along its feature to both sides the peg, as if it had no flat, keeps clear of
  every other segment. So where the feature is trimmed, because the peg comes to touch a second face across
  its own, the contact lies so far inside too.

Theorem: let a peg's centre p be at distance rho on the outer side of the line or circle of its face, its foot
inside the face, and every other segment farther than rho (of a flat: than the peg radius, which is no less).
Then p lies on the trimmed contact feature, off its ends, and outside the workpiece: the open segment from the
foot to p starts on the outer side and meets no part of the outline, so it never enters the material.

Glossary
--------
clearance : distance in mm from a side to the peg, negative when the peg enters it.
alongside : the clearance changes so slowly while the peg slides that its face and the side point the same
    way, or opposite ways. So it is beside a tangent joint, and in a slot exactly as wide as the peg.

A side is clear when the clearance is positive, and one that runs alongside when it is above minus a hair
(``findings``).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from flint import arb

from workhold.verification.balls import Point, dot, norm, turned
from workhold.verification.contacts import BallContact, BallPose
from workhold.verification.findings import Finding, number, rule
from workhold.verification.outline import BallOutline
from workhold.verification.sides import LineSide, Side
from workhold.verification.tolerances import HAIR, TANGENT

__all__ = ["touching_findings"]

# Pieces of a feature looked at before it is left undecided, and half the length in mm of the shortest.
MOST_PIECES = 1 << 14
SHORTEST = HAIR / 1024


def touching_findings(
    name: str, contact: BallContact, face: int, pose: BallPose, outline: BallOutline, margin: float
) -> Iterator[Finding]:
    """Whether a peg touches a face, ``margin`` mm inside the ends of its feature, and nothing else."""
    center = contact.in_part(pose)
    close = f"{name} is nearer than {margin:g} mm to the end of its feature on face {face}"
    edge = f"{name} is exactly {margin:g} mm from the end of its feature on face {face}"
    joined = outline.smooth_ends(face, contact.body is not None)
    # A margin below two hairs asks for no less than none does.
    reach = max(margin - HAIR, HAIR)
    for slack, smooth in zip(contact.side.slacks(center, contact.radius), joined, strict=False):
        inside = slack - margin + HAIR if smooth else slack - reach
        if inside > 0:
            continue
        past = f"{name} lies {number(-slack)} mm past the end of face {face}"
        at = f"{name} touches face {face} exactly at its end"
        broken = past if slack < -HAIR else at if slack < HAIR else close
        yield from rule(inside, broken, edge if margin else at)
    near = []
    for index, side in outline.others[face]:
        clearance = side.distance(center) - contact.clear_radius
        if clearance > reach:
            continue
        near.append(side)
        if clearance < -HAIR:
            yield Finding(True, f"{name} enters the workpiece at segment {index} by {number(-clearance)} mm")
        elif margin == 0.0:
            words = f"{name} touches face {face} and segment {index} at the same time"
            clear = clear_within(contact, center, [side], reach)
            if clear is not True:
                yield Finding(clear is False, words)
    if near and margin > 0.0:
        clear = clear_within(contact, center, near, reach)
        if clear is not True:
            yield Finding(clear is False, close if clear is False else edge)


def along_feature(contact: BallContact, center: Point, step: arb) -> Point:
    """The point a length in mm along the contact feature from a peg's centre."""
    side = contact.side
    if isinstance(side, LineSide):
        return center[0] + step * side.tangent[0], center[1] + step * side.tangent[1]
    angle = step / side.reach(contact.radius)
    x, y = turned(side.from_center(center), angle.cos(), angle.sin())
    return side.center[0] + x, side.center[1] + y


def runs_alongside(contact: BallContact, center: Point, side: Side) -> bool:
    """Whether a side runs alongside a peg's face where the peg is."""
    one, two = (side.distance(along_feature(contact, center, arb(step))) for step in (-HAIR, HAIR))
    return bool(abs(one - two) < 2 * HAIR * TANGENT)


def clear_within(contact: BallContact, center: Point, sides: Sequence[Side], reach: float) -> bool | None:
    """Whether a peg stays clear of some sides within a reach in mm along its feature; None if undecided.

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


def steepness(contact: BallContact, side: Side, around: Point) -> arb:
    """Bound, 1 or less, on how much a side's clearance changes per mm that the peg slides, its centre in a box.

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
