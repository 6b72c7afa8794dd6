"""Whether a peg at its proven place touches its face, and nothing else of the workpiece.

Theorem: let a peg's centre p be at distance rho on the outer side of the line or circle of its face, its foot inside the
face, and every other segment farther than rho. Then p lies on the trimmed contact feature, off its ends, and outside the
workpiece: the open segment from the foot to p starts on the outer side and meets no part of the outline, so it never
enters the material.
"""

from __future__ import annotations

from collections.abc import Iterator

from flint import arb

from holdfast.verification.balls import Point, norm, turned
from holdfast.verification.contacts import Contact, Pose
from holdfast.verification.findings import COINCIDENCE, Finding, number, rule
from holdfast.verification.outline import Outline
from holdfast.verification.sides import LineSide, Side

__all__ = ["margin_findings", "touching_findings"]

# Pieces of a feature looked at before a margin is left undecided.
MOST_PIECES = 1 << 14


def touching_findings(name: str, contact: Contact, face: int, pose: Pose, outline: Outline) -> Iterator[Finding]:
    """Whether a peg, called ``name``, touches a face inside its ends and nothing else."""
    center = contact.in_part(pose)
    slack = contact.side.slack(center, contact.radius)
    if slack is not None:
        yield from rule(
            slack,
            f"{name} lies {number(-slack)} mm past the end of face {face}",
            f"{name} touches face {face} exactly at its end",
        )
    for index, side in outline.others(face):
        clearance = side.distance(center) - contact.radius
        if not clearance > 0:
            yield from rule(
                clearance,
                f"{name} enters the workpiece at segment {index} by {number(-clearance)} mm",
                f"{name} touches face {face} and segment {index} at the same time",
            )


def along_feature(contact: Contact, center: Point, step: arb) -> Point:
    """The point a length in mm along the contact feature from a peg's centre."""
    side = contact.side
    if isinstance(side, LineSide):
        return center[0] + step * side.tangent[0], center[1] + step * side.tangent[1]
    angle = step / side.reach(contact.radius)
    x, y = turned(side.from_center(center), angle.cos(), angle.sin())
    return side.center[0] + x, side.center[1] + y


def margin_findings(
    name: str, contact: Contact, face: int, pose: Pose, outline: Outline, margin: float
) -> Iterator[Finding]:
    """Whether the trimmed feature goes on for a margin in mm on both sides of a contact."""
    if margin == 0.0:
        return
    center = contact.in_part(pose)
    slack = contact.side.slack(center, contact.radius)
    close = f"{name} is nearer than {margin:g} mm to the end of its feature on face {face}"
    edge = f"{name} is exactly {margin:g} mm from the end of its feature on face {face}"
    if slack is not None:
        yield from rule(slack - margin, close, edge)
    near = [side for _, side in outline.others(face) if not side.distance(center) > contact.radius + margin]
    alone = len(outline.members[face]) == 1 or isinstance(contact.side, LineSide)
    standing = clear_within(contact, center, near, margin, alone)
    if standing is not True:
        yield Finding(standing is False, close if standing is False else edge)


def clear_within(contact: Contact, center: Point, sides: list[Side], margin: float, joints: bool) -> bool | None:
    """Whether a peg stays clear of some sides as far as a margin along its feature; None when that is not decided.

    Pieces of the feature that are not seen to be clear are halved. ``joints`` says that the ends of the face lie exactly
    on its line or circle and are farther than the margin.
    """
    pieces = [(arb(0), arb(margin))]
    looked_at = 0
    decided = True
    while pieces and looked_at < MOST_PIECES:
        middle, half = pieces.pop()
        looked_at += 1
        point = along_feature(contact, center, middle)
        around = along_feature(contact, center, middle + arb(0, half))
        if any(side.distance(point) - contact.radius < -COINCIDENCE for side in sides):
            return False
        if all(
            side.distance(point) - contact.radius > half or (joints and turns_away(contact, side, point, around, half))
            for side in sides
        ):
            continue
        if half < COINCIDENCE:
            decided = False
            continue
        pieces += [(middle - half / 2, half / 2), (middle + half / 2, half / 2)]
    return True if decided and not pieces else None


def turns_away(contact: Contact, side: Side, point: Point, around: Point, half: arb) -> bool:
    """Whether a side that shares a joint with a peg's face stays clear on a piece of the feature.

    When the nearest point of the side is one of its ends, the joint cannot be what is too near: it lies on the line or
    circle of the face, whose only point at distance rho is the foot. The other end must be far enough.
    """
    if not side.is_past_ends(around):
        return False
    for joint, end, other in (
        (side.start, contact.side.end, side.end),
        (side.end, contact.side.start, side.start),
    ):
        if (joint[0] - end[0]).is_zero() and (joint[1] - end[1]).is_zero():
            return bool(norm((point[0] - other[0], point[1] - other[1])) - contact.radius > half)
    return False
