"""A straight wall that the part lies flush on, as two contacts at the ends of a hull edge.

The wall runs along x at y = 0 with the part above it. What touches it is derived from the outline at the
written pose: the lowest joints and convex arcs. The two ends are contacts like any other, each with an
equation of its own: its lowest point is at y = 0.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isnan
from typing import ClassVar

from attrs import frozen
from flint import arb

from workhold.model.fixture import Peg
from workhold.verification.ball_geometry import (
    ArcSide,
    BallOutline,
    LineSide,
    Point,
    Side,
    exact_point,
    norm,
    turned,
)
from workhold.verification.contacts import BallContact, BallPose
from workhold.verification.tolerances import AGREEMENT, FLUSH, LEAST_FLUSH, Finding, number, rule

__all__ = ["WallContact", "flush_findings", "wall_contacts"]


@frozen(eq=False)
class Support:
    """A joint or a convex arc of an outline that may touch a wall.

    Parameters
    ----------
    center, bow : of the arc, and its radius; the joint itself and 0; in mm in the workpiece's frame.
    faces : numbers of the arc, or of the two faces that meet at the joint.
    """

    center: Point
    bow: arb
    faces: tuple[int, ...]

    def lowest(self, pose: BallPose) -> Point:
        """The lowest point in the toolkit's frame, in mm."""
        x, y = turned(self.center, pose.cosine, pose.sine)
        return x + pose.x, y + pose.y - self.bow


@frozen(eq=False)
class WallContact(BallContact):
    """A joint or a convex arc that touches a wall.

    Parameters
    ----------
    piece : what touches.
    faces : numbers of the arc, of a face that lies along the wall, or of the two that meet at a joint.
    length : of the contact with the wall, in mm.
    """

    is_flush: ClassVar[bool] = True

    piece: Support
    faces: tuple[int, ...]
    length: arb

    @property
    def size(self) -> arb:
        """How long the part lies on the wall."""
        return self.length

    def outward(self, pose: BallPose) -> Point:
        """The direction down, as the workpiece sees it."""
        return -pose.sine, -pose.cosine

    def in_part(self, pose: BallPose) -> Point:
        """The point that touches, in the workpiece's frame."""
        (x, y), (across, down) = self.piece.center, self.outward(pose)
        return x + self.piece.bow * across, y + self.piece.bow * down

    def place(self, pose: BallPose) -> Point:
        """The point that touches, in the toolkit's frame."""
        return self.piece.lowest(pose)

    def equation(self, pose: BallPose) -> tuple[arb, list[arb]]:
        """How high its lowest point is, and the derivatives of that by theta, x, y and travel."""
        x, y = self.piece.lowest(pose)
        return y, [x - pose.x, arb(0), arb(1), arb(0)]


def wall_contacts(sides: Sequence[Side], outline: BallOutline, pose: BallPose) -> list[WallContact]:
    """The two ends of the contact with a wall at a pose, from left to right, each on a side."""
    lows = [
        (float(y.mid()), float(x.mid()), piece)
        for piece in pieces(outline, pose)
        for x, y in (piece.lowest(pose),)
    ]
    lows.sort(key=lambda low: low[0])
    flat = [low for low in lows if abs(low[0]) <= 10 * AGREEMENT] or lows[:2]
    left, right = (end_at([(sign * x, piece) for _, x, piece in flat]) for sign in (1, -1))
    # A common tangent of two circles, or of joints.
    far = norm((right.center[0] - left.center[0], right.center[1] - left.center[1]))
    square = far * far - (left.bow - right.bow) * (left.bow - right.bow)
    length, here = square.sqrt() if square > 0 else arb(0), exact_point(0.0, 0.0)
    return [
        WallContact(here, here, side, arb(0), end, along_wall(end, outline, pose), length)
        for side, end in zip(sides, (left, right), strict=True)
    ]


def pieces(outline: BallOutline, pose: BallPose) -> Iterator[Support]:
    """Joints of an outline, and convex arcs that run along x at their lowest point."""
    down = -pose.sine, -pose.cosine
    for face, side in outline.faces.items():
        if isinstance(side, ArcSide) and side.sign > 0 and (side.whole or not side.within(down) < 0):
            yield Support(side.center, side.radius, (face,))
    before = {(float(side.end[0]), float(side.end[1])): face for face, side in outline.faces.items()}
    for face, side in outline.faces.items():
        if not (isinstance(side, ArcSide) and side.whole):
            x, y = side.start
            yield Support(side.start, arb(0), tuple(sorted((before[float(x), float(y)], face))))


def end_at(flat: Sequence[tuple[float, Support]]) -> Support:
    """The piece at the least of some places: of an arc and the joint that it ends in the joint."""
    least = min(place for place, _ in flat)
    near = [low for low in flat if low[0] <= least + AGREEMENT]
    return min(near, key=lambda low: (float(low[1].bow.mid()), low[0]))[1]


def along_wall(end: Support, outline: BallOutline, pose: BallPose) -> tuple[int, ...]:
    """The numbers of what touches: of a joint the face that lies along the wall, where one does."""
    for face in end.faces:
        side = outline.faces[face]
        if isinstance(side, LineSide):
            heights = [turned(point, pose.cosine, pose.sine)[1] + pose.y for point in (side.start, side.end)]
            if all(abs(float(height.mid())) <= 3 * FLUSH for height in heights):
                return (face,)
    return end.faces


def flush_findings(
    noun: str, ends: Sequence[tuple[str, Peg, WallContact]], pose: BallPose, outline: BallOutline
) -> Iterator[Finding]:
    """Whether the part lies flush on a wall called ``noun``, its two named ends where they are written."""
    (left, _), (right, _) = places = [contact.place(pose) for _, _, contact in ends]
    yield from rule(right - left - LEAST_FLUSH, f"the part does not lie flush on the {noun}")
    for piece in pieces(outline, pose):
        (x, low), face = piece.lowest(pose), piece.faces[0]
        yield from rule(low + 2 * FLUSH, f"the part enters the {noun} at face {face} by {number(-low)} mm")
        beyond = (left - x).max(x - right) - 2 * FLUSH
        if not (low > FLUSH / 2 or beyond < 0):
            words = f"the part lies on the {noun} at face {face}, beyond its stated ends"
            yield Finding(bool(low < -FLUSH), words)
    for (name, peg, contact), place in zip(ends, places, strict=True):
        if peg.face != min(contact.faces):
            yield Finding(True, f"{name} touches face {min(contact.faces)}, and not {peg.face}")
        for axis, written, derived in zip("xy", (peg.x, peg.y), place, strict=True):
            off = abs(derived - written)
            if not isnan(written) and not off < AGREEMENT:
                words = f"the {axis} of {name} is {number(off)} mm from where the part touches"
                yield from rule(AGREEMENT - off, words)
