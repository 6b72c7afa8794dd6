"""All clamps that may push at a seat, and the pairs of them that hold the part there, in closed form and in balls.

A clamp's tip moves along a row or column of holes. Every such line meets the contact feature of each face in a point or two,
of which those count where the clamp pushes. So the clamps of a seat are found by going through lines, faces and points, and
nothing is sought. What is in doubt is carried along as such.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import combinations, product
from math import ceil, floor

from attrs import evolve, frozen
from flint import arb

from workhold.model.fixture import Peg
from workhold.model.query import Query
from workhold.verification.balls import Point, dot, exact_point, largest, norm, turned
from workhold.verification.contacts import Contact, Pose
from workhold.verification.ends import on_line
from workhold.verification.findings import Finding
from workhold.verification.outline import Outline
from workhold.verification.pair_balance import push_of
from workhold.verification.plate import WAYS, PlateRules
from workhold.verification.rules import HAIR, LEAST_PUSH, LEAST_SHARE, MOST_FORCE, NO_REACTION, SAME
from workhold.verification.seat import Push, Seat, closure_margin, ratio_of
from workhold.verification.sides import ArcSide, LineSide, Side
from workhold.verification.touching import touching_findings
from workhold.verification.zones import zone_distance

__all__ = ["Hole", "SeatClamp", "SeatPair", "Standing", "choices"]

# mm. Lines of holes this near beside the part are looked at as well.
BESIDE = 1e-3


@frozen(eq=False)
class Hole:
    """Where a clamp may be bolted.

    Parameters
    ----------
    column, row : of the hole; the one along its line is None for a clamp that is its tip alone.
    place, stroke : of the hole and to the tip, in mm.
    sure : whether it certainly may be bolted there.
    """

    column: int | None
    row: int | None
    place: Point
    stroke: arb
    sure: bool


@frozen(eq=False)
class SeatClamp:
    """A clamp at a seat.

    Parameters
    ----------
    direction, line, face : in which it pushes, on which row or column, on what.
    tip : on the plate, in mm.
    push : what it does.
    holes : where it may be bolted.
    sure : whether it certainly keeps all rules of its own.
    """

    direction: str
    line: int
    face: int
    tip: Point
    push: Push
    holes: Sequence[Hole]
    sure: bool


@frozen(eq=False)
class SeatPair:
    """Two clamps that hold the part: freedom in degrees, closure margin, and whether they certainly do."""

    freedom: arb
    margin: arb
    sure: bool


@frozen(eq=False)
class Standing:
    """A seat as it stands on the plate.

    Parameters
    ----------
    query, rules, outline : what is asked, of what toolkit, and the workpiece.
    pegs, locators : the locators, three or, beside a wall, one.
    pose : the solution, with a travel of 0.
    seat : their wrenches, a wall's with them.
    """

    query: Query
    rules: PlateRules
    outline: Outline
    pegs: Sequence[Peg]
    locators: Sequence[Contact]
    pose: Pose
    seat: Seat

    def pairs(self, directions: Sequence[str]) -> Iterator[SeatPair]:
        """The pairs of clamps in two directions that hold the part here, those in doubt with them."""
        one, other = directions
        found = {direction: list(self.clamps(direction)) for direction in dict.fromkeys(directions)}
        both = combinations(found[one], 2) if one == other else product(found[one], found[other])
        for first, second in both:
            ratio = ratio_of(first.push, second.push)
            if ratio is not None and ratio.high is not None and ratio.high < ratio.low:
                continue
            margin = closure_margin(first.push, second.push)
            if margin < LEAST_SHARE:
                continue
            stands = [sure for *_, sure in choices(self.rules, self.pegs, first, second)]
            if stands:
                sure = any(stands) and first.sure and second.sure and bool(margin > LEAST_SHARE)
                freedom = arb(0, 90) if ratio is None else ratio.freedom
                yield SeatPair(freedom, margin, sure and ratio is not None)

    def clamps(self, direction: str) -> Iterator[SeatClamp]:
        """All clamps that may push in a direction and do not hold the part alone."""
        found: list[SeatClamp] = []
        avoided = {f.number for f in self.query.workpiece.faces if set(f.segments) & set(self.query.restrictions.avoid)}
        for face, side in sorted(self.outline.faces.items()):
            if face in avoided:
                continue
            for line in self.lines(side, direction):
                for clamp in self.clamps_on(side, face, line, direction):
                    # A tip at a joint touches both faces, and counts on the first.
                    if not any(other.line == line and touch(other.tip, clamp.tip) for other in found):
                        found.append(clamp)
        yield from found

    def lines(self, side: Side, direction: str) -> list[int]:
        """Numbers of the rows, or columns, on which a tip may touch a side, and that fit on the plate with the locators."""
        upright = direction.endswith("y")
        axis = self.axis(upright)
        ends = [side.center] if isinstance(side, ArcSide) else [side.start, side.end]
        reach = self.rules.toolkit.clamp_radius + (float(side.radius.mid()) if isinstance(side, ArcSide) else 0.0)
        places = [float((dot(axis, end) + self.shift(upright)).mid()) for end in ends]
        pitch, noun = self.rules.toolkit.pitch[not upright], "column" if upright else "row"
        low, high = ceil((min(places) - reach - BESIDE) / pitch), floor((max(places) + reach + BESIDE) / pitch)
        numbers = [getattr(peg, noun) for peg in self.pegs]
        return [line for line in range(low, high + 1) if self.rules.fits(noun, [*numbers, line])]

    def axis(self, upright: bool) -> Point:
        """The plate's x for columns, or y for rows, in the workpiece's frame."""
        way = (1.0, 0.0) if upright else (0.0, 1.0)
        return turned(exact_point(*way), self.pose.cosine, -self.pose.sine)

    def shift(self, upright: bool) -> arb:
        """How far along that axis the workpiece's origin is from column or row 0, in mm."""
        x, y = self.rules.origin
        return self.pose.x - x if upright else self.pose.y - y

    def clamps_on(self, side: Side, face: int, line: int, direction: str) -> Iterator[SeatClamp]:
        """The clamps on a line that touch a side and keep all rules of their own, those in doubt with them."""
        upright, radius = direction.endswith("y"), arb(self.rules.toolkit.clamp_radius)
        if isinstance(side, ArcSide) and not side.reach(radius) > 0:
            return
        axis, way = self.axis(upright), exact_point(*map(float, WAYS[direction]))
        back = turned(way, self.pose.cosine, -self.pose.sine)
        if isinstance(side, LineSide) and not dot(back, side.normal) > LEAST_PUSH:
            return
        level = arb(self.rules.toolkit.pitch[not upright]) * line - self.shift(upright)
        for point in on_line(side, radius, axis, level):
            if not dot(back, side.outward(point)) > 0:
                continue
            x, y = turned(point, self.pose.cosine, self.pose.sine)
            tip = x + self.pose.x, y + self.pose.y
            clamp = self.clamp(Contact(tip, way, side, radius), face, line, direction)
            if clamp is not None:
                yield clamp

    def clamp(self, contact: Contact, face: int, line: int, direction: str) -> SeatClamp | None:
        """A clamp whose tip is where a contact is; None where it certainly breaks a rule of its own."""
        margin = self.query.contact_margin
        touches = verdict(touching_findings("a clamp", contact, face, self.pose, self.outline, margin))
        if touches is False:
            return None
        push = push_of(contact, self.pose, self.seat)
        if push.push < LEAST_PUSH or push.alone > NO_REACTION:
            return None
        most = largest([abs(force) for force in push.taken]) - MOST_FORCE * push.push
        if most > 0:
            return None
        sure = [touches is True, bool(push.push > LEAST_PUSH), bool(push.alone < NO_REACTION), bool(most < 0)]
        for zone in self.query.restrictions.zones:
            off = zone_distance(zone, contact.in_part(self.pose)) - contact.radius + HAIR
            if off < 0:
                return None
            sure.append(bool(off > 0))
        holes = list(self.holes(contact, line, direction))
        return SeatClamp(direction, line, face, contact.hole, push, holes, all(sure)) if holes else None

    def holes(self, contact: Contact, line: int, direction: str) -> Iterator[Hole]:
        """Where a clamp may be bolted whose tip is where a contact is, whatever the other clamp does."""
        upright, travel = direction.endswith("y"), self.rules.toolkit.travel
        if travel is None:
            stands = verdict(self.rules.clamp_findings("a clamp", self.locators, contact, self.pose, self.outline))
            if stands is not False:
                column, row = (line, None) if upright else (None, line)
                yield Hole(column, row, contact.hole, arb(0), stands is True)
            return
        (pitch_x, pitch_y), (x, y) = self.rules.toolkit.pitch, self.rules.origin
        tip, sign = contact.hole[int(upright)] - (y if upright else x), sum(WAYS[direction])
        pitch = pitch_y if upright else pitch_x
        near, far = sorted(float(tip.mid()) + sign * stroke for stroke in travel)
        for number in range(ceil((near - BESIDE) / pitch), floor((far + BESIDE) / pitch) + 1):
            stroke = sign * (arb(pitch) * number - tip)
            column, row = (line, number) if upright else (number, line)
            place = x + arb(pitch_x) * column, y + arb(pitch_y) * row
            bolted, pose = evolve(contact, hole=place), evolve(self.pose, travel=-stroke)
            stands = verdict(self.rules.clamp_findings("a clamp", self.locators, bolted, pose, self.outline))
            if stands is not False:
                yield Hole(column, row, place, stroke, stands is True)


def choices(
    rules: PlateRules, pegs: Sequence[Peg], one: SeatClamp, other: SeatClamp
) -> Iterator[tuple[Hole, Hole, bool]]:
    """The holes in which two clamps may be bolted together, and whether they certainly may."""
    apart = 2 * arb(rules.toolkit.clamp_radius) - HAIR
    for first, second in product(one.holes, other.holes):
        columns = [peg.column for peg in pegs] + [h.column for h in (first, second) if h.column is not None]
        rows = [peg.row for peg in pegs] + [h.row for h in (first, second) if h.row is not None]
        if not (rules.fits("column", columns) and rules.fits("row", rows)):
            continue
        clear = pieces_apart((one.tip, first.place), (other.tip, second.place)) - apart
        if not clear < 0:
            yield first, second, first.sure and second.sure and bool(clear > 0)


def pieces_apart(one: tuple[Point, Point], other: tuple[Point, Point]) -> arb:
    """Distance in mm of two straight pieces, each along x or y."""
    beyond = []
    for a, b, c, d in zip(*one, *other, strict=True):
        beyond.append(arb(0).max(a.min(b) - c.max(d)).max(c.min(d) - a.max(b)))
    return norm((beyond[0], beyond[1]))


def verdict(findings: Iterable[Finding]) -> bool | None:
    """Whether nothing speaks against something; None where that is in doubt."""
    doubt = False
    for finding in findings:
        if finding.definite:
            return False
        doubt = True
    return None if doubt else True


def touch(one: Point, other: Point) -> bool:
    """Whether two tips are one."""
    return all(bool(abs(a - b) < SAME) for a, b in zip(one, other, strict=True))
