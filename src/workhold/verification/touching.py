"""Whether a peg at its proven place touches its face inside its ends, and nothing else of the workpiece.

Rules, with the hair of ``findings``:

- ends: a contact lies at least margin - hair inside the ends of the face, and more than a hair at an end that is no tangent
  joint: a margin that is met exactly is met, and without one a contact at an end is none;
- elsewhere: as far as that along its feature to both sides the peg, as if it had no flat, keeps clear of every other segment
  (``clearance`` says what clear is). So where the feature is trimmed, because the peg comes to touch a second face across
  its own, the contact lies so far inside too.

Theorem: let a peg's centre p be at distance rho on the outer side of the line or circle of its face, its foot inside the
face, and every other segment farther than rho (of a flat: than the peg radius, which is no less). Then p lies on the
trimmed contact feature, off its ends, and outside the workpiece: the open segment from the foot to p starts on the outer
side and meets no part of the outline, so it never enters the material.
"""

from __future__ import annotations

from collections.abc import Iterator

from workhold.verification.clearance import clear_within
from workhold.verification.contacts import Contact, Pose
from workhold.verification.findings import Finding, number, rule
from workhold.verification.outline import Outline
from workhold.verification.tolerances import HAIR

__all__ = ["touching_findings"]


def touching_findings(
    name: str, contact: Contact, face: int, pose: Pose, outline: Outline, margin: float
) -> Iterator[Finding]:
    """Whether a peg, called ``name``, touches a face, ``margin`` mm inside the ends of its feature, and nothing else."""
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
