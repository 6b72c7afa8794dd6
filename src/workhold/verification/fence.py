"""The rules that are a fence's own: the part flush on a straight wall, one locator, and a clamp as on a plate.

What touches the wall is derived from the outline at the written pose: the lowest joints and convex arcs. Then the wall's two
ends are contacts like any other, each with an equation of its own: its lowest point is at y = 0.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isnan, radians, tau
from typing import ClassVar

from attrs import frozen
from flint import arb

from workhold.model.fence import Fence
from workhold.model.fixture import Fixture, Peg
from workhold.model.query import Query
from workhold.verification.balls import Point, exact_point, norm, turned
from workhold.verification.contacts import Contact, Pose
from workhold.verification.findings import Finding, number, rule
from workhold.verification.hardware import Key, Place, Rank, from_anchor
from workhold.verification.outline import Outline
from workhold.verification.plate import PLATE, WAYS, PlateRules, in_holes, is_along_x
from workhold.verification.rules import AGREEMENT, FLUSH, HAIR, LEAST_FLUSH, SAME, WALL
from workhold.verification.sides import ArcSide, LineSide
from workhold.verification.zones import zone_low

__all__ = ["WALL_ENDS", "FenceRules"]

# Where the ends of the contact with the wall stand among the pegs.
ON_WALL = slice(1, 3)
# What the ends of the contact are called.
WALL_ENDS = ("fence left", "fence right")


@frozen(eq=False)
class WallContact(Contact):
    """A corner or a convex arc that touches a wall along x at y = 0, from above.

    Parameters
    ----------
    center, bow : of the arc, and its radius; the corner itself and 0; in mm in the workpiece's frame.
    faces : numbers of the arc, of a face that lies along the wall, or of the two that meet at a corner.
    length : of the contact with the wall, in mm.
    """

    is_flush: ClassVar[bool] = True

    center: Point
    bow: arb
    faces: tuple[int, ...]
    length: arb

    @property
    def size(self) -> arb:
        """How long the part lies on the wall."""
        return self.length

    def outward(self, pose: Pose) -> Point:
        """Down, as the workpiece sees it."""
        return -pose.sine, -pose.cosine

    def in_part(self, pose: Pose) -> Point:
        """The point that touches, in the workpiece's frame."""
        x, y = self.outward(pose)
        return self.center[0] + self.bow * x, self.center[1] + self.bow * y

    def place(self, pose: Pose) -> Point:
        """The point that touches, in the toolkit's frame."""
        x, y = turned(self.in_part(pose), pose.cosine, pose.sine)
        return x + pose.x, y + pose.y

    def equation(self, pose: Pose) -> tuple[arb, list[arb]]:
        """How high its lowest point is, and the derivatives of that by theta, x, y and travel."""
        x, y = turned(self.center, pose.cosine, pose.sine)
        return y + pose.y - self.bow, [x, arb(0), arb(1), arb(0)]


@frozen(eq=False)
class Low:
    """A joint or a convex arc of an outline with its lowest point, roughly, in mm in the toolkit's frame."""

    center: Point
    bow: arb
    faces: tuple[int, ...]
    x: float
    y: float


@frozen
class FenceRules(PlateRules):
    """The rules of a fence with one locator and one clamp."""

    names: ClassVar[tuple[str, ...]] = (
        "the locator",
        "the fence at its left end",
        "the fence at its right end",
        "the clamp",
    )
    kinds: ClassVar[str] = "edge"
    pegs_wanted: ClassVar[str] = "one locator, the two ends of the fence and then a clamp"
    from_lowest: ClassVar[tuple[str, ...]] = ("column",)

    toolkit: Fence

    @property
    def origin(self) -> tuple[float, float]:
        """The first row is so far from the wall."""
        return 0.0, self.toolkit.wall_offset

    @property
    def names_in_holes(self) -> tuple[str, ...]:
        """Of the locator, and of each clamp."""
        return self.names[0], *self.names[ON_WALL.stop :]

    def has_its_pegs(self, fixture: Fixture) -> bool:
        """Whether the pegs of a fixture are the wall's two ends, one locator and then its clamp."""
        return [peg.carrier for peg in fixture.pegs] == [PLATE, WALL, WALL, f"clamp {fixture.direction}"]

    def contacts(self, fixture: Fixture, outline: Outline) -> list[Contact]:
        """The contacts of locator, wall and each clamp."""
        theta = arb(fixture.pose.theta_deg) * arb.pi() / 180
        pose = Pose.of(theta, arb(fixture.pose.x), arb(fixture.pose.y), arb(0))
        low = sorted(lows(outline, pose), key=lambda one: one.y)
        flat = [one for one in low if abs(one.y) <= 10 * AGREEMENT] or low[:2]
        left, right = (end_at(flat, sign) for sign in (1, -1))
        here, there = exact_point(0.0, 0.0), arb(0)
        length = abs(arb(right.x) - left.x)
        sides = [outline.faces[peg.face] for peg in fixture.pegs]
        ends = [
            WallContact(here, here, side, there, end.center, end.bow, along_wall(end, outline, pose), length)
            for side, end in zip(sides[ON_WALL], (left, right), strict=True)
        ]
        standing = (pair for pair in zip(fixture.pegs, sides, strict=True) if pair[0].carrier != WALL)
        locator, *clamps = (self.contact(*pair) for pair in standing)
        return [locator, *exact_lengths(ends), *clamps]

    def shared_faces(self, fixture: Fixture, contacts: Sequence[Contact]) -> list[int]:
        """A corner on the wall is off by itself."""
        out = [peg.face for peg in fixture.pegs]
        for place, contact in enumerate(contacts):
            if isinstance(contact, WallContact):
                out[place] = contact.faces[0] if len(contact.faces) == 1 else -1 - place
        return out

    def standing_findings(
        self, fixture: Fixture, contacts: list[Contact], pose: Pose, outline: Outline
    ) -> Iterator[Finding]:
        """Whether the part lies flush on the wall, where it is said to, and the clamp stands as on a plate."""
        yield from self.flush_findings(fixture, contacts, pose, outline)
        yield from super().standing_findings(fixture, contacts, pose, outline)

    def flush_findings(
        self, fixture: Fixture, contacts: Sequence[Contact], pose: Pose, outline: Outline
    ) -> Iterator[Finding]:
        """Whether the part lies flush on the wall, where it is said to."""
        ends = [contact for contact in contacts if isinstance(contact, WallContact)]
        places = [end.place(pose) for end in ends]
        flush = places[1][0] - places[0][0] - LEAST_FLUSH
        words = "the part does not lie flush on the fence"
        yield from rule(flush, words, words)
        for joint, bow, faces in pieces(outline, pose):
            x, y = turned(joint, pose.cosine, pose.sine)
            low = y + pose.y - bow
            words = f"the part enters the fence at face {faces[0]} by {number(-low)} mm"
            yield from rule(low + 2 * FLUSH, words, words)
            beyond = (places[0][0] - (x + pose.x)).max(x + pose.x - places[1][0]) - 2 * FLUSH
            if not (low > FLUSH / 2 or beyond < 0):
                yield Finding(
                    bool(low < -FLUSH), f"the part lies on the fence at face {faces[0]}, beyond the ends that are told"
                )
        for name, end, peg, place in zip(self.names[ON_WALL], ends, fixture.pegs[ON_WALL], places, strict=True):
            if peg.face != min(end.faces):
                yield Finding(True, f"{name} touches face {min(end.faces)}, and not {peg.face}")
            for axis, written, derived in zip("xy", (peg.x, peg.y), place, strict=True):
                off = abs(derived - written)
                if not isnan(written) and not off < AGREEMENT:
                    words = f"the {axis} of {name} is {number(off)} mm from where the part touches"
                    yield from rule(AGREEMENT - off, words, words)

    def clamp_findings(
        self, name: str, locators: Sequence[Contact], clamp: Contact, pose: Pose, outline: Outline
    ) -> Iterator[Finding]:
        """Whether a clamp stands as on a plate, with its tip clear of the wall."""
        above = clamp.place(pose)[1] - clamp.radius
        words = f"{name} enters the fence by {number(-above)} mm"
        yield from rule(above + HAIR, words, f"{name} touches the fence exactly at the edge of what is allowed")
        yield from super().clamp_findings(name, locators, clamp, pose, outline)

    def broken_restriction(self, fixture: Fixture, query: Query) -> str:
        """A wall may not touch avoided faces, of a corner both, nor reach into keep-out zones."""
        outline = Outline.of(query.workpiece)
        avoided = {face.number for face in query.workpiece.faces if set(face.segments) & set(query.restrictions.avoid)}
        for contact in self.contacts(fixture, outline)[ON_WALL]:
            if isinstance(contact, WallContact) and avoided.issuperset(contact.faces):
                return f"the part lies on the fence with face {contact.faces[0]}, which is to be avoided"
        sine, cosine = (arb(fixture.pose.theta_deg) / 180).sin_cos_pi()
        for zone in query.restrictions.zones:
            if zone_low(zone, cosine, sine) + fixture.pose.y < -AGREEMENT:
                return "the fence stands in a keep-out zone"
        return ""

    def patterns(self, fixture: Fixture) -> Iterator[tuple[Key, Place]]:
        """The locator's row and the clamp's line, up to steps along the wall."""
        if not self.has_its_pegs(fixture):
            return
        (anchor,), (clamp,) = in_holes(fixture)
        along_x = is_along_x(clamp)
        line = clamp.row if along_x else clamp.column - anchor.column
        ahead = clamp.x - anchor.x if along_x else clamp.y
        yield (
            (fixture.direction, anchor.row, line),
            (radians(fixture.pose.theta_deg), *from_anchor(fixture, anchor), ahead),
        )

    def rank(self, fixture: Fixture) -> Rank:
        """Direction, columns and rows of locator and clamp, orientation and faces."""
        locators, clamps = in_holes(fixture)
        pegs = [*locators, *clamps]
        numbers = [list(WAYS).index(fixture.direction or ""), *(p.column for p in pegs), *(p.row for p in pegs)]
        angle = (radians(fixture.pose.theta_deg) + SAME) % tau - SAME
        return numbers, angle, [peg.face for peg in fixture.pegs]

    def body_radius(self, peg: Peg) -> float:
        """Radius in mm of the locator, or of the clamp's tip."""
        return 0.0 if peg.carrier == WALL else super().body_radius(peg)


def pieces(outline: Outline, pose: Pose) -> Iterator[tuple[Point, arb, tuple[int, ...]]]:
    """Joints of an outline, and convex arcs that run along x at their lowest point: centre and radius in mm in the
    workpiece's frame, and the numbers of their faces."""
    down = -pose.sine, -pose.cosine
    for face, side in outline.faces.items():
        if isinstance(side, ArcSide) and side.sign > 0 and (side.whole or not side.within(down) < 0):
            yield side.center, side.radius, (face,)
    before = {(float(side.end[0]), float(side.end[1])): face for face, side in outline.faces.items()}
    for face, side in outline.faces.items():
        if not (isinstance(side, ArcSide) and side.whole):
            x, y = side.start
            yield side.start, arb(0), tuple(sorted((before[float(x), float(y)], face)))


def lows(outline: Outline, pose: Pose) -> Iterator[Low]:
    """The lowest points of the pieces."""
    for center, bow, faces in pieces(outline, pose):
        x, y = turned(center, pose.cosine, pose.sine)
        yield Low(center, bow, faces, float((x + pose.x).mid()), float((y + pose.y - bow).mid()))


def end_at(flat: Sequence[Low], sign: int) -> Low:
    """What touches a wall farthest to the left (1) or right (-1): of an arc and the corner that it ends in the corner."""
    farthest = min(sign * one.x for one in flat)
    near = [one for one in flat if sign * one.x <= farthest + AGREEMENT]
    return min(near, key=lambda one: (float(one.bow.mid()), sign * one.x))


def along_wall(end: Low, outline: Outline, pose: Pose) -> tuple[int, ...]:
    """The numbers of what touches: of a corner the face that lies along the wall, where one does."""
    for face in end.faces:
        side = outline.faces[face]
        if isinstance(side, LineSide):
            heights = [turned(point, pose.cosine, pose.sine)[1] + pose.y for point in (side.start, side.end)]
            if all(abs(float(height.mid())) <= 3 * FLUSH for height in heights):
                return (face,)
    return end.faces


def exact_lengths(ends: Sequence[WallContact]) -> list[WallContact]:
    """The ends of a contact with how long it is: a common tangent of two circles, or of corners."""
    from attrs import evolve

    one, other = ends
    far = norm((other.center[0] - one.center[0], other.center[1] - one.center[1]))
    square = far * far - (one.bow - other.bow) * (one.bow - other.bow)
    length = square.sqrt() if square > 0 else arb(0)
    return [evolve(end, length=length) for end in ends]
