"""All clamps that may push at a seat, and the pairs that hold the part there, in closed form and in balls.

A clamp's tip moves along a row or column of holes. Every such line meets the contact feature of each face in
at most two points; only points at which the clamp pushes on the face count. So enumerating lines, faces and
points gives all clamps of a seat, without a search. Doubtful clamps are kept and marked as such.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import combinations, product
from math import ceil, floor

from attrs import evolve, frozen
from flint import arb

from workhold.fixels.toolkit import Carrier
from workhold.model.fixture import ClampPair, Fixture, Peg
from workhold.model.query import Query
from workhold.verification.ball_geometry import (
    ArcSide,
    BallOutline,
    LineSide,
    Point,
    Side,
    compute_dot_product,
    find_largest,
    make_exact_point,
    turn_vector,
)
from workhold.verification.contacts import BallContact, BallPose, select_outline_for
from workhold.verification.placing import (
    compute_zone_distance,
    find_avoided_faces,
    find_faces_without_band,
    prove_pose,
)
from workhold.verification.rules.hardware import ToolkitRules
from workhold.verification.rules.travel import (
    WAYS,
    find_clamp_line,
    find_direction,
    list_directions,
    measure_piece_distance,
)
from workhold.verification.seat import (
    LOCATORS,
    ClampPush,
    LocatorWrenches,
    SeatBalance,
    compute_closure_margin,
    find_ratio,
)
from workhold.verification.tolerances import (
    HAIR,
    LEAST_PUSH,
    LEAST_SHARE,
    MOST_FORCE,
    NO_REACTION,
    SAME,
    SAME_FREEDOM,
    Finding,
    format_middle,
    judge_slack,
)
from workhold.verification.tool_walk import HoldingElement, make_walk
from workhold.verification.touching import find_points_on_line, judge_touching

__all__ = ["SeatClamp", "SeatOnPlate", "count_pairs_at_seat"]

# mm. A program's clearance that is met or missed by no more is in doubt.
IN_DOUBT = 2e-7
# mm. Lines of holes this near beside the part are looked at as well.
BESIDE = 1e-3


@frozen(eq=False)
class BoltHole:
    """A hole in which a clamp may be bolted.

    Parameters
    ----------
    column, row : of the hole; for a clamp that is its tip alone, the number along the clamp's line is None.
    place : of the hole on the plate, in mm.
    stroke : distance in mm from the hole to the tip.
    sure : whether the clamp certainly may be bolted there.
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
    direction : direction in which it pushes, such as "-x".
    line : number of the row or column along which it moves.
    face : number of the face that it pushes on.
    tip : centre of its tip on the plate, in mm.
    push : reaction of the locators to it.
    holes : holes in which it may be bolted.
    sure : whether it certainly satisfies all rules about itself.
    """

    direction: str
    line: int
    face: int
    tip: Point
    push: ClampPush
    holes: Sequence[BoltHole]
    sure: bool


@frozen(eq=False)
class SeatPair:
    """Two clamps that hold the part: freedom in degrees, closure margin, and whether it is certain that they
    hold it.
    """

    freedom: arb
    margin: arb
    sure: bool


@frozen(eq=False)
class SeatOnPlate:
    """A seat on the plate.

    Parameters
    ----------
    query : the query.
    hardware : the rules of its toolkit.
    outline : the outline of the workpiece that clamps touch.
    pegs : the fixed pegs in holes: three, or one beside a wall.
    locators : their contacts by name.
    pose : the proven pose; its first travel is 0.
    seat : wrenches of the locators, and of the ends of a wall's contact.
    """

    query: Query
    hardware: ToolkitRules
    outline: BallOutline
    pegs: Sequence[Peg]
    locators: Sequence[tuple[str, BallContact]]
    pose: BallPose
    seat: LocatorWrenches

    @classmethod
    def from_fixture(
        cls,
        fixture: Fixture,
        contacts: Sequence[BallContact],
        pose: BallPose,
        query: Query,
        hardware: ToolkitRules,
        outline: BallOutline,
    ) -> SeatOnPlate:
        """Return the seat of a fixture at a proven pose; ``contacts`` are those of its pegs in their
        order.
        """
        named = zip(hardware.names, fixture.pegs[:LOCATORS], contacts, strict=False)
        held = [(name, peg, contact) for name, peg, contact in named if not contact.is_flush]
        locators = [(name, contact) for name, _, contact in held]
        still = BallPose.from_turn_and_place(pose.theta, pose.x, pose.y, arb(0))
        seat = LocatorWrenches.from_contacts(contacts[:LOCATORS], still)
        met = select_outline_for(outline, fixture.pegs[-1].carrier)
        return cls(query, hardware, met, [peg for _, peg, _ in held], locators, still, seat)

    @property
    def lattice(self) -> Carrier:
        """The holes that the clamps are bolted in."""
        return self.hardware.lattices[0]

    def find_tip_radius(self, direction: str) -> float:
        """Return the radius in mm of the tip of a clamp in a direction."""
        return self.hardware.tips[direction].peg_radius

    def list_pairs(self, directions: Sequence[str]) -> Iterator[SeatPair]:
        """Yield each pair of clamps, one in each of two directions, that holds the part at this seat.

        Pairs of which that is uncertain are included.
        """
        one, other = directions
        found = {direction: self.list_clamps(direction) for direction in dict.fromkeys(directions)}
        both = combinations(found[one], 2) if one == other else product(found[one], found[other])
        for first, second in both:
            ratio = find_ratio(first.push, second.push)
            if ratio is not None and ratio.high is not None and ratio.high < ratio.low:
                continue
            margin = compute_closure_margin(first.push, second.push)
            if margin < LEAST_SHARE:
                continue
            stands = [sure for *_, sure in self.list_hole_choices(first, second)]
            if stands:
                sure = any(stands) and first.sure and second.sure and bool(margin > LEAST_SHARE)
                freedom = arb(0, 90) if ratio is None else ratio.freedom
                yield SeatPair(freedom, margin, sure and ratio is not None)

    def list_clamps(self, direction: str) -> list[SeatClamp]:
        """Return all clamps that may push in a direction here; clamps that hold the part alone are left out.

        Uncertain ones are included. They are sorted by face, then by line.
        """
        found: list[SeatClamp] = []
        avoided = find_avoided_faces(self.query) | find_faces_without_band(self.query.workpiece)
        for face, side in sorted(self.outline.faces.items()):
            if face in avoided:
                continue
            for line in self.list_lines(side, direction):
                for clamp in self.list_clamps_on_line(side, face, line, direction):
                    # A tip at a joint touches both faces, and counts on the first.
                    if not any(other.line == line and are_touching(other.tip, clamp.tip) for other in found):
                        found.append(clamp)
        return found

    def list_lines(self, side: Side, direction: str) -> list[int]:
        """Return the numbers of the rows (for clamps along x) or columns (along y) on which a clamp's tip may
        touch a side.

        A line must fit on the plate together with the seat's pegs.
        """
        upright = direction.endswith("y")
        axis = self.compute_axis(upright)
        ends = [side.center] if isinstance(side, ArcSide) else [side.start, side.end]
        reach = self.find_tip_radius(direction) + (
            float(side.radius.mid()) if isinstance(side, ArcSide) else 0.0
        )
        places = [
            float((compute_dot_product(axis, end) + self.compute_origin_coordinate(upright)).mid())
            for end in ends
        ]
        pitch, noun = self.lattice.pitch[not upright], "column" if upright else "row"
        low, high = (
            ceil((min(places) - reach - BESIDE) / pitch),
            floor((max(places) + reach + BESIDE) / pitch),
        )
        numbers = [getattr(peg, noun) for peg in self.pegs]
        return [line for line in range(low, high + 1) if self.hardware.has_numbers(noun, [*numbers, line])]

    def compute_axis(self, upright: bool) -> Point:
        """Return a unit vector in the part's frame: the plate's x axis if ``upright``, else the plate's y
        axis.

        It is square to the lines: columns if ``upright``, else rows.
        """
        way = (1.0, 0.0) if upright else (0.0, 1.0)
        return turn_vector(make_exact_point(*way), self.pose.cosine, -self.pose.sine)

    def compute_origin_coordinate(self, upright: bool) -> arb:
        """Return the plate coordinate in mm of the part's origin: x from column 0 if ``upright``, else y from
        row 0.
        """
        x, y = self.lattice.offset
        return self.pose.x - x if upright else self.pose.y - y

    def list_clamps_on_line(self, side: Side, face: int, line: int, direction: str) -> Iterator[SeatClamp]:
        """Yield the clamps on a row or column that touch a side; those that certainly break a rule are left
        out.
        """
        upright, radius = direction.endswith("y"), arb(self.find_tip_radius(direction))
        if isinstance(side, ArcSide) and not side.compute_offset_radius(radius) > 0:
            return
        axis, way = self.compute_axis(upright), make_exact_point(*map(float, WAYS[direction]))
        back = turn_vector(way, self.pose.cosine, -self.pose.sine)
        if isinstance(side, LineSide) and not compute_dot_product(back, side.normal) > LEAST_PUSH:
            return
        level = arb(self.lattice.pitch[not upright]) * line - self.compute_origin_coordinate(upright)
        for point in find_points_on_line(side, radius, axis, level):
            if not compute_dot_product(back, side.compute_outward_normal(point)) > 0:
                continue
            x, y = turn_vector(point, self.pose.cosine, self.pose.sine)
            tip = x + self.pose.x, y + self.pose.y
            clamp = self.make_clamp(BallContact(tip, way, side, radius), face, line, direction)
            if clamp is not None:
                yield clamp

    def make_clamp(self, contact: BallContact, face: int, line: int, direction: str) -> SeatClamp | None:
        """Return the clamp whose tip is at a contact; None if it certainly breaks a rule or has no possible
        hole.
        """
        margin = self.query.contact_margin
        touches = decide_verdict(judge_touching("a clamp", contact, face, self.pose, self.outline, margin))
        if touches is False:
            return None
        push = self.seat.make_push(contact, self.pose)
        if push.push < LEAST_PUSH or push.least_share > NO_REACTION:
            return None
        most = push.largest_share - MOST_FORCE * push.push
        if most > 0:
            return None
        sure = [
            touches is True,
            bool(push.push > LEAST_PUSH),
            bool(push.least_share < NO_REACTION),
            bool(most < 0),
        ]
        zones, place = self.query.restrictions.zones, contact.compute_center_in_part(self.pose)
        clear = [compute_zone_distance(zone, place) - contact.radius + HAIR for zone in zones]
        if any(off < 0 for off in clear):
            return None
        passed = self.is_clear_of_program(contact, contact)
        if passed is False:
            return None
        sure += [passed is True, *(bool(off > 0) for off in clear)]
        holes = list(self.list_bolt_holes(contact, line, direction))
        return SeatClamp(direction, line, face, contact.hole, push, holes, all(sure)) if holes else None

    def is_clear_of_program(self, tip: BallContact, hole: BallContact) -> bool | None:
        """Return whether the program's tools keep clear of a clamp body that reaches from its tip to a hole.

        True if the query has no program to check; None if it is uncertain.
        """
        if self.query.program_to_clear is None:
            return True
        program, height = self.query.program_to_clear
        low, height = next(iter(self.hardware.tips.values())).heights or (0.0, height)
        (x, y), (from_x, from_y) = (
            (float(u.mid()), float(v.mid()))
            for u, v in (one.compute_center_in_part(self.pose) for one in (tip, hole))
        )
        radius = float(tip.clear_radius.mid())
        element = HoldingElement("a clamp", "", (x, y), (from_x, from_y), radius, height, low=low)
        near = make_walk(program).find_nearest(element)
        if near.high < program.clearance - IN_DOUBT:
            return False
        return True if near.low > program.clearance + IN_DOUBT else None

    def list_bolt_holes(self, contact: BallContact, line: int, direction: str) -> Iterator[BoltHole]:
        """Yield the holes in which a clamp with its tip at a contact may be bolted, regardless of the other
        clamp.

        For a clamp without a stroke, which is its tip alone, there is one entry: the tip.
        """
        upright, rules = direction.endswith("y"), self.hardware.stroke
        if rules.span is None:
            stands = decide_verdict(rules.judge("a clamp", self.locators, contact, self.pose, self.outline))
            if stands is not False:
                column, row = (line, None) if upright else (None, line)
                yield BoltHole(column, row, contact.hole, arb(0), stands is True)
            return
        (pitch_x, pitch_y), (x, y) = self.lattice.pitch, self.lattice.offset
        tip, sign = contact.hole[int(upright)] - (y if upright else x), sum(WAYS[direction])
        pitch = pitch_y if upright else pitch_x
        near, far = sorted(float(tip.mid()) + sign * stroke for stroke in rules.span)
        for count in range(ceil((near - BESIDE) / pitch), floor((far + BESIDE) / pitch) + 1):
            stroke = sign * (arb(pitch) * count - tip)
            column, row = (line, count) if upright else (count, line)
            place = x + arb(pitch_x) * column, y + arb(pitch_y) * row
            bolted, pose = evolve(contact, hole=place), evolve(self.pose, travels=(-stroke,))
            stands = decide_verdict(rules.judge("a clamp", self.locators, bolted, pose, self.outline))
            passed = self.is_clear_of_program(contact, evolve(bolted, way=make_exact_point(0.0, 0.0)))
            if stands is not False and passed is not False:
                yield BoltHole(column, row, place, stroke, stands is True and passed is True)

    def list_hole_choices(
        self, one: SeatClamp, other: SeatClamp
    ) -> Iterator[tuple[BoltHole, BoltHole, bool]]:
        """Yield (hole of ``one``, hole of ``other``, is certain) for each choice in which both clamps fit on
        the plate and keep clear of each other.
        """
        apart = arb(self.find_tip_radius(one.direction)) + self.find_tip_radius(other.direction) - HAIR
        for first, second in product(one.holes, other.holes):
            columns = [peg.column for peg in self.pegs] + [
                h.column for h in (first, second) if h.column is not None
            ]
            rows = [peg.row for peg in self.pegs] + [h.row for h in (first, second) if h.row is not None]
            if not (self.hardware.has_numbers("column", columns) and self.hardware.has_numbers("row", rows)):
                continue
            clear = measure_piece_distance((one.tip, first.place), (other.tip, second.place)) - apart
            if not clear < 0:
                yield first, second, first.sure and second.sure and bool(clear > 0)

    def judge_pair(
        self,
        fixture: Fixture,
        pair: ClampPair,
        contacts: Sequence[BallContact],
        pose: BallPose,
        balance: SeatBalance,
    ) -> Iterator[Finding]:
        """Yield findings against the fixture's pair of clamps.

        Three faults: the clamps are not bolted with the least total travel; another pair of the seat is
        better; the stated number of pairs of the seat is wrong.
        """
        if self.hardware.stroke.span is not None:
            yield from self.judge_strokes(fixture, contacts, pose)
        if not self.hardware.every:
            yield from judge_best_pair(pair, balance, list(self.list_pairs(list_directions(fixture))))
        elif pair.count != 1:
            yield Finding(True, f"it stands for {pair.count} pairs of clamps, and all are listed")

    def judge_strokes(
        self, fixture: Fixture, contacts: Sequence[BallContact], pose: BallPose
    ) -> Iterator[Finding]:
        """Yield a finding for each choice of holes with a smaller total travel in which both clamps fit."""
        clamps = []
        for peg, contact in zip(fixture.pegs[LOCATORS:], contacts[LOCATORS:], strict=True):
            tip = evolve(contact, hole=contact.compute_point(pose), travel=0)
            line, direction, push = (
                find_clamp_line(peg),
                find_direction(peg),
                self.seat.make_push(tip, self.pose),
            )
            holes = list(self.list_bolt_holes(tip, line, direction))
            clamps.append(SeatClamp(direction, line, peg.face, tip.hole, push, holes, True))
        total = -sum(pose.travels, arb(0))
        for first, second, sure in self.list_hole_choices(*clamps):
            less = total - HAIR - first.stroke - second.stroke
            if less < 0:
                continue
            words = f"{format_middle(first.stroke + second.stroke)} mm of travel in all, not {format_middle(total)}"
            yield Finding(sure and bool(less > 0), f"the clamps could be bolted with {words}")


def judge_best_pair(pair: ClampPair, balance: SeatBalance, pairs: Sequence[SeatPair]) -> Iterator[Finding]:
    """Yield a finding where ``pair`` states a wrong number of pairs at its
    seat, or one of ``pairs`` is better.

    Better means freer by more than ``SAME_FREEDOM``, or as free with a larger closure margin.
    """
    sure = [one for one in pairs if one.sure]
    if not len(sure) <= pair.count <= len(pairs):
        yield Finding(
            True, f"it stands for {pair.count} pairs of clamps, and there are {len(sure)} at its seat"
        )
    elif len(sure) < len(pairs):
        yield Finding(False, f"there are {len(sure)} to {len(pairs)} pairs of clamps at its seat")
    freedom, margin = balance.ratio.freedom, balance.margin
    freest = find_largest([freedom, *(one.freedom for one in sure)])
    yield from judge_slack(
        -(freest - freedom - SAME_FREEDOM - HAIR),
        f"another pair of clamps at its seat has a freedom of {format_middle(freest)} degrees, this one "
        f"{format_middle(freedom)}",
    )
    rivals = [one.margin for one in sure if freest - one.freedom < SAME_FREEDOM - HAIR]
    widest = find_largest([margin, *rivals])
    yield from judge_slack(
        2 * HAIR - (widest - margin),
        f"an equally free pair of clamps at its seat has a closure margin of {format_middle(widest)}, this one "
        f"{format_middle(margin)}",
    )


def count_pairs_at_seat(
    fixture: Fixture, query: Query, hardware: ToolkitRules, outline: BallOutline
) -> tuple[int, int] | None:
    """Return the least and greatest possible number of clamp pairs at a
    fixture's seat; None without a proven pose.
    """
    contacts = hardware.make_contacts(fixture, outline)
    pose, _ = prove_pose(contacts, fixture.pose, hardware.compute_travels(fixture))
    if pose is None:
        return None
    standing = SeatOnPlate.from_fixture(fixture, contacts, pose, query, hardware, outline)
    pairs = list(standing.list_pairs(list_directions(fixture)))
    return sum(one.sure for one in pairs), len(pairs)


def decide_verdict(findings: Iterable[Finding]) -> bool | None:
    """Return True if there are no findings, False if any finding is definite, None if all are uncertain."""
    doubt = False
    for finding in findings:
        if finding.definite:
            return False
        doubt = True
    return None if doubt else True


def are_touching(one: Point, other: Point) -> bool:
    """Return whether two points certainly agree to ``SAME`` mm in x and in y."""
    return all(bool(abs(a - b) < SAME) for a, b in zip(one, other, strict=True))
