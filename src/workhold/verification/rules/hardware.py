"""The rules of a toolkit, composed from the rules of its carriers, and the rules about its holes.

Each carrier is fixed or slides, and has one kind of contact: a peg in a hole of its own, the tip of a clamp
bolted in a hole of another carrier, or an end of a wall. With two clamps, one pair may be listed to represent
all pairs of its seat. Then fixtures of one seat and pair of directions are the same.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from functools import cached_property
from itertools import combinations
from math import hypot

from attrs import evolve, field, frozen
from flint import arb

from workhold.errors import InputError
from workhold.fixels.carrier import WALL
from workhold.fixels.contacts import CLAMP_TIP, WALL_END
from workhold.fixels.toolkit import Carrier, Toolkit
from workhold.model.fixture import Fixture, Peg
from workhold.model.query import Query
from workhold.verification.ball_geometry import BallOutline, Point, Side, make_exact_point
from workhold.verification.contacts import BallContact, BallPose, compute_standoff, select_outline_for
from workhold.verification.rules.travel import (
    WAYS,
    ClampStroke,
    find_clamp_line,
    find_direction,
    is_along_x,
    judge_nearest_rows,
    judge_opening,
    list_directions,
    measure_travel,
    name_clamp_place,
)
from workhold.verification.rules.wall import EndedWall, WallContact, check_flush, make_wall_contacts
from workhold.verification.tolerances import AGREEMENT, Finding, format_middle, judge_slack

__all__ = ["ToolkitRules"]

NUMBERS = ("no", "one", "two", "three", "four")


@frozen
class ToolkitRules:
    """The rules of a toolkit.

    Parameters
    ----------
    toolkit : the toolkit that fixtures are judged by.
    every : whether all pairs of clamps of a seat are listed; otherwise one listed pair stands for them.
    """

    toolkit: Toolkit
    every: bool = field(default=False, kw_only=True)

    @classmethod
    def from_query(cls, query: Query) -> ToolkitRules:
        """Return the rules of a query's toolkit."""
        return cls(query.toolkit, every=query.listing == "all")

    @cached_property
    def carriers(self) -> dict[str, Carrier]:
        """The carriers of pegs, by name."""
        return {one.name: one for one in self.toolkit.carriers}

    @cached_property
    def lattices(self) -> list[Carrier]:
        """The carriers with holes of their own, the fixed ones first."""
        return [one for one in self.carriers.values() if one.has_lattice]

    @cached_property
    def tips(self) -> dict[str, Carrier]:
        """The clamps by the directions in which they push."""
        return {one.direction: one for one in self.carriers.values() if one.contact is CLAMP_TIP}

    @cached_property
    def walls(self) -> list[Carrier]:
        """The wall carrier that the part lies flush on, in a list; [] without one."""
        return [one for one in self.carriers.values() if one.contact is WALL_END]

    @cached_property
    def wall_noun(self) -> str:
        """The wall's name; "" without one."""
        return next((one.noun for one in self.walls), "")

    @cached_property
    def jaw(self) -> EndedWall | None:
        """The wall with ends, centred on the columns beside it; None if the toolkit has no wall or an endless
        one.
        """
        for wall in self.walls:
            columns = self.lattices[0].columns
            if wall.width is not None and columns is not None:
                return EndedWall(wall.noun, wall.width, self.lattices[0].pitch[0], columns)
        return None

    def has_carriers(self, fixture: Fixture) -> bool:
        """Return whether the toolkit has the carriers of all the fixture's pegs."""
        return all(peg.carrier in self.carriers for peg in fixture.pegs)

    @property
    def half_turns(self) -> bool:
        """Whether half a turn leaves the toolkit unchanged: it has no wall, and
        all lattices have the same heights.
        """
        return not self.walls and len({one.heights for one in self.lattices}) == 1

    @property
    def keeps_rows(self) -> bool:
        """Whether rows are counted from a wall, because the lattice beside the wall does not move."""
        return bool(self.walls) and self.lattices[0].travel is None

    @cached_property
    def groups(self) -> list[tuple[Carrier, int]]:
        """(carrier, number of pegs on it) for each carrier of the toolkit's
        first arrangement, empty ones left out.
        """
        counts = zip(self.carriers.values(), self.toolkit.arrangements[0].pegs, strict=True)
        return [(carrier, count) for carrier, count in counts if count]

    @cached_property
    def clamps(self) -> int:
        """The number of clamps that hold the part."""
        return sum(count for carrier, count in self.groups if carrier.on is not None)

    @cached_property
    def stroke(self) -> ClampStroke:
        """The rules of each clamp's stroke.

        If a clamp has a stroke, its tip is at its hole at a travel of minus the stroke.
        """
        travel = next((tip.travel for tip in self.tips.values()), None)
        span = None if travel is None or travel.most is None else (-travel.most, -travel.least)
        return ClampStroke(span, self.wall_noun)

    @cached_property
    def from_lowest(self) -> tuple[str, ...]:
        """The nouns, of "column" and "row", that are counted from the lowest one in use.

        Rows beside a wall are counted from the wall instead.
        """
        if self.walls:
            return () if self.jaw is not None else ("column",)
        return ("column", "row") if self.tips else ()

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The names of a fixture's pegs in messages, in the order of the pegs."""
        carriers = [carrier for carrier, count in self.groups for _ in range(count)]
        total, seen, out = Counter(carrier.peg for carrier in carriers), Counter[str](), list[str]()
        for carrier in carriers:
            seen[carrier.peg] += 1
            number = seen[carrier.peg]
            if carrier.is_wall:
                out.append(f"the {carrier.noun} at its {'left' if number == 1 else 'right'} end")
            else:
                out.append(f"the {carrier.peg}" if total[carrier.peg] == 1 else f"{carrier.peg} {number}")
        return tuple(out)

    @property
    def pegs_wanted(self) -> str:
        """The pegs that a fixture must have, in words."""
        words = [
            f"the two ends of the {one.noun}"
            if one.is_wall
            else f"{NUMBERS[count]} {one.peg}{'s' * (count > 1)}"
            for one, count in self.groups
            if one.on is None
        ]
        if self.clamps:
            words.append("a clamp" if self.clamps == 1 else "two clamps")
        return f"{', '.join(words[:-1])} and then {words[-1]}"

    @property
    def same_words(self) -> str:
        """Words of a message that a fixture is the same as an earlier one; the earlier one's number follows
        them.
        """
        is_one = self.every or self.clamps < 2
        return "it is the same as" if is_one else "it has the seat and the directions of"

    @property
    def slack_words(self) -> str:
        """The words for a clamping force that is too small."""
        if self.clamps:
            return "the clamp does not push the part"
        moving = "closing" if self.toolkit.clamping > 0 else "opening"
        return f"{moving} the {self.toolkit.noun} does not clamp"

    @property
    def wider_words(self) -> str:
        """The words that name queries with weaker limits, whose results would contain this listing too."""
        fewer = "fewer restrictions or more"
        if not self.clamps:
            return f"a smaller gap or contact margin, a larger opening, more rows, {fewer} types"
        more = "directions" if self.clamps == 1 else "pairs of directions"
        return f"a smaller contact margin, a longer stroke, more columns or rows, {fewer} {more}"

    @property
    def largest_radius(self) -> float:
        """The largest radius of pegs and tips, in mm."""
        return max(one.peg_radius for one in self.carriers.values())

    def list_placed(self, fixture: Fixture) -> list[tuple[str, Peg]]:
        """Return (name, peg) of the pegs and clamps of a fixture, without the
        ends of the contact with a wall.
        """
        named = zip(self.names, fixture.pegs, strict=False)
        return [(name, peg) for name, peg in named if not peg.is_on_wall]

    def compute_travels(self, fixture: Fixture) -> dict[str, float]:
        """Return the travels of a fixture in mm by name; one travel, or with two clamps one for each."""
        if not self.clamps:
            return {"opening": fixture.travel}
        if self.clamps == 1:
            return {f"place of {self.names[-1]}'s tip on its line": fixture.travel}
        named = zip(self.names[-self.clamps :], fixture.travels, strict=True)
        return {f"place of the tip of {name} on its line": travel for name, travel in named}

    def has_its_pegs(self, fixture: Fixture) -> bool:
        """Return whether a fixture has exactly the pegs that its type and directions ask for, in the right
        order.

        The order of pegs of two jaws does not matter.
        """
        directions, carriers = list_directions(fixture), self.carriers.values()
        pegs = next((one.pegs for one in self.toolkit.arrangements if one.name == fixture.type), ())
        still = [
            c.name for c, count in zip(carriers, pegs, strict=False) for _ in range(count) if c.on is None
        ]
        wanted = [*still, *(f"clamp {direction}" for direction in directions)]
        there, order = [peg.carrier for peg in fixture.pegs], sorted if len(self.lattices) > 1 else list
        return len(directions) == self.clamps and order(there) == order(wanted)

    def complete_fixture(self, fixture: Fixture) -> Fixture:
        """Return a fixture with the travels in mm added at which its clamps' tips have their written places.

        Raises
        ------
        InputError
            When the fixture is of another type, or its pegs have carriers that are not in the toolkit.
        """
        types = self.toolkit.types
        clamps = 2 if fixture.pair is not None else 1 if fixture.direction is not None else 0
        if fixture.type not in types or clamps != self.clamps:
            raise InputError(f"its type is not {' or '.join(types)}")
        if not clamps:
            if any(peg.carrier not in self.carriers for peg in fixture.pegs):
                raise InputError(f"a peg's {self.lattices[0].noun} is not {' or '.join(self.carriers)}")
            return fixture
        moved = [
            measure_travel(peg, self.carriers.get(peg.carrier, self.lattices[0]))
            for peg in fixture.pegs[-clamps:]
        ]
        pair = None if fixture.pair is None else evolve(fixture.pair, travels=(moved[0], moved[1]))
        return evolve(fixture, travel=moved[0], pair=pair)

    def compute_hole_center(self, peg: Peg) -> Point:
        """Return the centre of a peg's hole without any travel, in the toolkit's frame in mm."""
        carrier = self.carriers[peg.carrier]
        (x, y), (pitch_x, pitch_y) = carrier.offset, carrier.pitch
        return x + arb(pitch_x) * peg.column, y + arb(pitch_y) * peg.row

    def find_way(self, peg: Peg) -> tuple[float, float]:
        """Return the unit vector along which a peg moves as its travel grows; (0, 0) for a fixed one."""
        travel = self.carriers[peg.carrier].travel
        return (0.0, 0.0) if travel is None else travel.unit

    def make_contact(self, peg: Peg, side: Side) -> BallContact:
        """Return the contact of a peg or clamp tip with a side.

        A peg with a flat touches a straight side by its flat, and an arc by its round body.
        """
        carrier = self.carriers[peg.carrier]
        body = None if carrier.flat is None else arb(carrier.peg_radius)
        radius = compute_standoff(side, carrier.peg_radius, carrier.flat)
        return BallContact(
            self.compute_hole_center(peg), make_exact_point(*self.find_way(peg)), side, radius, body=body
        )

    def make_contacts(self, fixture: Fixture, outline: BallOutline) -> list[BallContact]:
        """Return the contacts of all pegs of a fixture, in the order of the pegs.

        With two clamps, the first has travel 0 and the second travel 1 (indices of the pose's travels).
        """
        on_wall = [outline.faces[peg.face] for peg in fixture.pegs if peg.is_on_wall]
        written = BallPose.from_written(fixture.pose)
        ends = iter(
            make_wall_contacts(on_wall, select_outline_for(outline, WALL), written) if on_wall else ()
        )
        out = [
            next(ends) if peg.is_on_wall else self.make_contact(peg, outline.faces[peg.face])
            for peg in fixture.pegs
        ]
        if fixture.pair is not None:
            out[-1] = evolve(out[-1], travel=1)
        return out

    def find_pressed_contacts(
        self, fixture: Fixture, contacts: Sequence[BallContact], pose: BallPose, outline: BallOutline
    ) -> list[BallContact]:
        """Return the contacts at which the forces act at a pose.

        They are ``contacts``, except on a wall that has ends (a flat jaw): there the ends of the stretch
        common to part and jaw replace the ends of the whole contact.
        """
        if self.jaw is None:
            return [*contacts]
        ends = [contact for contact in contacts if isinstance(contact, WallContact)]
        found = iter(self.jaw.limit_contacts(ends, select_outline_for(outline, WALL), pose))
        return [next(found) if isinstance(contact, WallContact) else contact for contact in contacts]

    def judge_reach(
        self,
        fixture: Fixture,
        contacts: Sequence[BallContact],
        pose: BallPose,
        outline: BallOutline,
        shares: Sequence[arb],
    ) -> Iterator[Finding]:
        """Yield a finding if a jaw with ends is too short for its force, or other columns would hold the part
        better.

        ``contacts`` and ``shares`` are those for an endless wall. Yields nothing for a toolkit without a jaw
        with ends.
        """
        if self.jaw is None:
            return
        ends = [
            (share, contact.compute_point(pose)[0])
            for contact, share in zip(contacts, shares, strict=True)
            if isinstance(contact, WallContact)
        ]
        (one, left), (other, right) = ends
        columns = [peg.column for _, peg in self.list_placed(fixture)]
        force_at = (one * left + other * right) / (one + other)
        yield from self.jaw.judge(columns, force_at, select_outline_for(outline, WALL), pose)

    def number_shared_faces(self, fixture: Fixture, contacts: Sequence[BallContact]) -> list[int]:
        """Return a number for each contact; contacts with the same number share the error of one face.

        It is the face's number, or a negative number for a corner on a wall, which has an error of its own.
        """
        out = [peg.face for peg in fixture.pegs]
        for place, contact in enumerate(contacts):
            if isinstance(contact, WallContact):
                out[place] = contact.faces[0] if len(contact.faces) == 1 else -1 - place
        return out

    def judge_holes(self, fixture: Fixture) -> Iterator[Finding]:
        """Yield a finding for each fault of the pegs, their holes or lines, and their written x and y."""
        yield from self.judge_question(fixture)
        yield from self.judge_hole_numbers(fixture)
        moved = list(self.compute_travels(fixture).values())
        for k, (name, peg) in enumerate(zip(self.names, fixture.pegs, strict=False)):
            if peg.is_on_wall:
                continue
            if find_direction(peg):
                yield from self.judge_clamp_place(name, peg)
            travel = moved[1] if len(moved) > 1 and k == len(fixture.pegs) - 1 else moved[0]
            noun = "line" if find_direction(peg) else "hole"
            for axis, written, hole, way in zip(
                "xy", (peg.x, peg.y), self.compute_hole_center(peg), self.find_way(peg), strict=True
            ):
                off = abs(hole + arb(travel) * way - written)
                words = f"the {axis} of {name} is {format_middle(off)} mm from that of its {noun}"
                yield from judge_slack(AGREEMENT - off, words)

    def judge_question(self, fixture: Fixture) -> Iterator[Finding]:
        """Yield a finding if a fixture does not answer the query: wrong pegs for its type, or directions that
        the query excludes.

        Also yields one if two pegs share a hole.
        """
        directions, pegs = list_directions(fixture), fixture.pegs
        if not self.has_its_pegs(fixture) and len(self.lattices) > 1:
            first = self.lattices[0]
            count = sum(peg.carrier == first.name for peg in pegs)
            words = (
                f"{count} of its {len(pegs)} pegs are on the {first.title}, which is not type {fixture.type}"
            )
            yield Finding(True, words)
        elif not self.has_its_pegs(fixture):
            yield Finding(True, f"its pegs are not {self.pegs_wanted}")
        if fixture.direction not in [one.direction for one in self.toolkit.arrangements]:
            moves = "its clamp moves" if self.clamps == 1 else "its clamps move"
            yield Finding(True, f"{moves} in {' and '.join(directions)}, which is not asked for")
        lines = [
            (list(WAYS).index(find_direction(c)), find_clamp_line(c), c.face)
            for c in pegs
            if find_direction(c)
        ]
        if lines != sorted(lines):
            yield Finding(True, "its clamps are not in the order of directions, lines and faces")
        for carrier in self.lattices:
            holes = [(peg.column, peg.row) for peg in pegs if peg.carrier == carrier.name]
            if len(set(holes)) < len(holes):
                yield Finding(True, f"two {carrier.peg}s are in the same hole")

    def judge_hole_numbers(self, fixture: Fixture) -> Iterator[Finding]:
        """Yield a finding for each column or row that the carrier does not have.

        Also yields one where columns or rows that should be counted from the lowest in use are not.
        """
        standing = self.list_placed(fixture)
        for noun in ("column", "row"):
            numbers = []
            for name, peg in standing:
                if not self.is_counted(peg, noun):
                    continue
                base = self.carriers[self.carriers[peg.carrier].on or peg.carrier]
                place, count = getattr(peg, noun), getattr(base, f"{noun}s")
                numbers.append(place)
                if place < 0 or (count is not None and place >= count):
                    known = f"{noun}s from 0 upward" if count is None else f"{count} {noun}s"
                    if len(self.lattices) > 1:
                        known = known.removesuffix(" columns")
                    yield Finding(True, f"{name} is in {noun} {place} of a {base.noun} with {known}")
            if noun in self.from_lowest and min(numbers) > 0:
                yield Finding(True, f"its lowest {noun} is {min(numbers)}, and not 0")

    def is_counted(self, peg: Peg, noun: str) -> bool:
        """Return whether a peg's column or row (``noun``) is a number of the lattice.

        For a clamp that is not bolted only its line is: the row if it moves along x, else the column.
        """
        return not find_direction(peg) or self.stroke.span is not None or is_along_x(peg) == (noun == "row")

    def judge_clamp_place(self, name: str, clamp: Peg) -> Iterator[Finding]:
        """Yield a finding if a bolted clamp is not named by its hole, or an unbolted clamp by its row or
        column.
        """
        is_bolted = self.stroke.span is not None
        place = name_clamp_place(
            self.lattices[0].name, find_direction(clamp), clamp.column, clamp.row, is_bolted
        )
        if clamp.place != place:
            named_by = "hole in which it is bolted" if is_bolted else "line alone, since it has no travel"
            yield Finding(True, f"{name} is not named by the {named_by}")
        if not is_bolted and (clamp.column if is_along_x(clamp) else clamp.row):
            yield Finding(True, f"the place of {name} on its line is not counted from the plate's first hole")

    def judge_standing(
        self, fixture: Fixture, contacts: Sequence[BallContact], pose: BallPose, outline: BallOutline
    ) -> Iterator[Finding]:
        """Yield a finding for each wall, jaw, locator or clamp whose place is impossible at a pose."""
        named = list(zip(self.names, fixture.pegs, contacts, strict=True))
        if self.walls:
            ends = [(name, peg, end) for name, peg, end in named if isinstance(end, WallContact)]
            met, said = (
                select_outline_for(outline, WALL),
                self.find_pressed_contacts(fixture, contacts, pose, outline),
            )
            written = [end for end in said if isinstance(end, WallContact)]
            yield from check_flush(self.wall_noun, ends, pose, met, written)
        for jaw in self.lattices:
            if jaw.travel is not None:
                yield from judge_opening(jaw, pose.travels[0])
                if self.walls:
                    lowest = min(peg.row for peg in fixture.pegs if peg.carrier == jaw.name)
                    yield from judge_nearest_rows(jaw, lowest, pose.travels[0])
        locators = [(name, contact) for name, peg, contact in named if peg.carrier == self.lattices[0].name]
        clamps = [(name, peg, contact) for name, peg, contact in named if find_direction(peg)]
        for name, peg, clamp in clamps:
            met = select_outline_for(outline, peg.carrier)
            yield from self.stroke.judge(name, locators, clamp, pose, met)
        if len(clamps) > 1:
            yield from self.stroke.judge_clearance_between(clamps[0][2], clamps[1][2], pose)
        elif self.stroke.span is not None:
            ((name, peg, _),) = clamps
            noun, axis = ("column", 0) if is_along_x(peg) else ("row", 1)
            numbers = [getattr(one, noun) for one in fixture.pegs if one.carrier == self.lattices[0].name]
            if self.has_numbers(noun, [*numbers, getattr(peg, noun) - round(self.find_way(peg)[axis])]):
                yield from self.stroke.judge_nearest_hole(
                    name, -pose.travels[0], self.lattices[0].pitch[axis]
                )

    def has_numbers(self, noun: str, numbers: Sequence[int]) -> bool:
        """Return whether the fixed carrier has columns or rows (``noun``) of these numbers.

        Where they are counted from the lowest in use, only their span must fit.
        """
        count, lowest = getattr(self.lattices[0], f"{noun}s"), min(numbers) if noun in self.from_lowest else 0
        return min(numbers) >= lowest and (count is None or max(numbers) - lowest < count)

    def find_crowding(self, fixture: Fixture) -> str:
        """Return a sentence, without full stop, on the first peg in a blocked hole or the first two bodies
        that overlap.

        Returns "" where there are none.
        """
        pegs = [(peg, self.carriers[peg.carrier]) for peg in fixture.pegs]
        for name, (peg, carrier) in zip(self.names, pegs, strict=True):
            blocked = [holes for holes in carrier.blocked if holes.column == peg.column]
            if any(holes.row in (None, peg.row) for holes in blocked):
                return f"{name} stands in {peg.hole}, which is blocked"
        bodies = [(k, peg, c.body_radius) for k, (peg, c) in enumerate(pegs, 1) if c in self.lattices]
        for (i, one, radius), (k, other, reach) in combinations(bodies, 2):
            if hypot(one.x - other.x, one.y - other.y) < radius + reach - AGREEMENT:
                return f"the bodies of pegs {i} and {k} overlap"
        return ""
