"""The rules that are a dowel plate's own: locators in its holes, the clamp on a line of them, and where that is bolted.

A clamp with a travel is bolted in the nearest hole behind its tip that fits everything. Its body, all that is within its
radius of the piece from hole to tip, contains that of the same clamp in a nearer hole: where it clears locators and part, it
would from there as well, and a nearer hole is left out only because it is off the plate or too near.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import pi, radians, tau
from typing import ClassVar

from attrs import evolve, frozen
from flint import arb

from workhold.errors import InputError
from workhold.model.fixture import Fixture, Peg
from workhold.model.holes import column_letters, hole_name
from workhold.model.plate import Plate
from workhold.model.query import Query
from workhold.verification.balls import Point, exact_point, norm
from workhold.verification.capsule import clearance
from workhold.verification.contacts import Contact, Pose, standing_contact
from workhold.verification.findings import Finding, number, rule
from workhold.verification.hardware import Hardware, Key, Place, Rank, from_anchor
from workhold.verification.outline import Outline
from workhold.verification.rules import AGREEMENT, BODY_SLACK, HAIR, LEAST_CLAMPING, SAME, WALL
from workhold.verification.sides import Side

__all__ = [
    "LOCATORS",
    "PLATE",
    "WAYS",
    "PlateRules",
    "clamp_place",
    "direction_of",
    "in_holes",
    "is_along_x",
    "quarter_turns",
    "seen_along_x",
    "travels_of",
]

# The ways a clamp may move when it clamps, in the order of a list, and the way of its travel, which grows as it opens.
WAYS = {"-x": (1, 0), "+x": (-1, 0), "-y": (0, 1), "+y": (0, -1)}
PLATE = "plate"
LOCATORS = 3


@frozen
class PlateRules(Hardware):
    """The rules of a plate with one translating clamp."""

    names: ClassVar[tuple[str, ...]] = ("locator 1", "locator 2", "locator 3", "the clamp")
    travel_words: ClassVar[str] = "place of the clamp's tip on its line"
    slack_words: ClassVar[str] = "the clamp does not push the part"
    wider_words: ClassVar[str] = (
        "a smaller contact margin, a longer stroke, more columns or rows, fewer restrictions or more directions"
    )
    least_clamping: ClassVar[float] = LEAST_CLAMPING
    kinds: ClassVar[str] = "clamp"
    pegs_wanted: ClassVar[str] = "three locators and then a clamp"
    # Of columns and rows, those that count from the lowest that is used.
    from_lowest: ClassVar[tuple[str, ...]] = ("column", "row")

    toolkit: Plate

    @property
    def origin(self) -> tuple[float, float]:
        """Where the hole in column 0 and row 0 is, in mm."""
        return 0.0, 0.0

    @property
    def names_in_holes(self) -> tuple[str, ...]:
        """Of the locators, and of the clamp."""
        return self.names

    def fits(self, noun: str, numbers: Sequence[int]) -> bool:
        """Whether there is a plate that has columns or rows of such numbers."""
        count, lowest = getattr(self.toolkit, f"{noun}s"), min(numbers) if noun in self.from_lowest else 0
        return min(numbers) >= lowest and (count is None or max(numbers) - lowest < count)

    def has_its_pegs(self, fixture: Fixture) -> bool:
        """Whether the pegs of a fixture are three locators and then its clamp."""
        return [peg.carrier for peg in fixture.pegs] == [PLATE, PLATE, PLATE, f"clamp {fixture.direction}"]

    @property
    def largest_radius(self) -> float:
        """Of locators and tip, in mm."""
        return max(self.toolkit.peg_radius, self.toolkit.clamp_radius)

    @property
    def is_bolted(self) -> bool:
        """Whether the hole that the clamp is bolted in is told."""
        return self.toolkit.travel is not None

    def taken(self, fixture: Fixture) -> Fixture:
        """A fixture as it is read, with the travel that puts the clamp's tip where it is written.

        Raises
        ------
        InputError
            When it has no clamp.
        """
        if fixture.type != self.kinds or fixture.direction is None:
            raise InputError(f"its type is not {self.kinds}")
        return evolve(fixture, jaw_separation=self.travel_of(fixture.pegs[-1]))

    def travel_of(self, clamp: Peg) -> float:
        """How far a clamp has travelled from its hole to where it is written, in mm."""
        way, (pitch_x, pitch_y), (x, y) = WAYS.get(direction_of(clamp), (0, 0)), self.toolkit.pitch, self.origin
        return (clamp.x - x - clamp.column * pitch_x) * way[0] + (clamp.y - y - clamp.row * pitch_y) * way[1]

    def contact(self, peg: Peg, side: Side) -> Contact:
        """The contact of a locator, or of the clamp's tip, which moves on its line, with a side."""
        (pitch_x, pitch_y), (x, y) = self.toolkit.pitch, self.origin
        hole = x + arb(pitch_x) * peg.column, y + arb(pitch_y) * peg.row
        if peg.carrier == PLATE:
            still = exact_point(0.0, 0.0)
            return standing_contact(hole, still, side, self.toolkit.peg_radius, self.toolkit.flat)
        way = WAYS[direction_of(peg)]
        return Contact(hole, exact_point(*map(float, way)), side, arb(self.toolkit.clamp_radius))

    def lattice_numbers(self, fixture: Fixture) -> tuple[list[int], list[int]]:
        """Columns and rows of the plate that a fixture takes: of its locators, and of each clamp's hole or its line."""
        locators, clamps = in_holes(fixture)
        columns, rows = ([getattr(peg, name) for peg in locators] for name in ("column", "row"))
        for clamp in clamps:
            if self.is_bolted or not is_along_x(clamp):
                columns.append(clamp.column)
            if self.is_bolted or is_along_x(clamp):
                rows.append(clamp.row)
        return columns, rows

    def hole_findings(self, fixture: Fixture) -> Iterator[Finding]:
        """What is wrong with roles, direction, columns, rows and the places x, y written for them."""
        plate = self.toolkit
        yield from self.asked_findings(fixture)
        locators, clamps = in_holes(fixture)
        if len({(peg.column, peg.row) for peg in locators}) < len(locators):
            yield Finding(True, "two locators are in the same hole")
        for noun, numbers, count in zip(
            ("column", "row"), self.lattice_numbers(fixture), (plate.columns, plate.rows), strict=True
        ):
            for name, place in zip(self.names_in_holes, numbers, strict=False):
                if place < 0 or (count is not None and place >= count):
                    known = f"{noun}s from 0 upward" if count is None else f"{count} {noun}s"
                    yield Finding(True, f"{name} is in {noun} {place} of a plate with {known}")
            if min(numbers) > 0 and noun in self.from_lowest:
                yield Finding(True, f"its lowest {noun} is {min(numbers)}, and not 0")
        for name, peg in zip(self.names_in_holes, locators, strict=False):
            yield from self.place_findings(name, peg, (0, 0), 0.0)
        for name, clamp, travelled in zip(
            self.names_in_holes[len(locators) :], clamps, travels_of(fixture), strict=True
        ):
            if clamp.place != clamp_place(direction_of(clamp), clamp.column, clamp.row, self.is_bolted):
                told = "hole in which it is bolted" if self.is_bolted else "line alone, since it has no travel"
                yield Finding(True, f"{name} is not told by the {told}")
            if not self.is_bolted and (clamp.column if is_along_x(clamp) else clamp.row):
                yield Finding(True, f"the place of {name} on its line is not counted from the plate's first hole")
            yield from self.place_findings(name, clamp, WAYS[direction_of(clamp)], travelled)

    def asked_findings(self, fixture: Fixture) -> Iterator[Finding]:
        """Whether a fixture has the pegs of its kind, and a direction that is asked for."""
        if not self.has_its_pegs(fixture):
            yield Finding(True, f"its pegs are not {self.pegs_wanted}")
        if fixture.direction not in self.toolkit.directions:
            yield Finding(True, f"its clamp moves in {fixture.direction}, which is not asked for")

    def place_findings(self, name: str, peg: Peg, moving: tuple[int, int], travelled: float) -> Iterator[Finding]:
        """Whether a peg is written to be in its hole, or on its line as far as it has travelled."""
        for axis, written, count, pitch, first, way in zip(
            "xy", (peg.x, peg.y), (peg.column, peg.row), self.toolkit.pitch, self.origin, moving, strict=True
        ):
            off = abs(first + arb(pitch) * count + arb(travelled) * way - written)
            if not off < AGREEMENT:
                words = f"the {axis} of {name} is {number(off)} mm from that of its {'line' if any(moving) else 'hole'}"
                yield from rule(AGREEMENT - off, words, words)

    def standing_findings(
        self, fixture: Fixture, contacts: list[Contact], pose: Pose, outline: Outline
    ) -> Iterator[Finding]:
        """Whether the clamp, bolted where it is said to be, reaches its place and clears locators and part."""
        *locators, clamp = (contact for contact in contacts if not contact.is_flush)
        yield from self.clamp_findings(self.names_in_holes[-1], locators, clamp, pose, outline)
        if self.toolkit.travel is not None:
            yield from self.nearer_findings(fixture, -pose.travel, self.toolkit.travel[0])

    def flush_findings(
        self, fixture: Fixture, contacts: Sequence[Contact], pose: Pose, outline: Outline
    ) -> Iterator[Finding]:
        """Whether the part lies on what it is to lie on; a plate has no such thing."""
        return iter(())

    def clamp_findings(
        self, name: str, locators: Sequence[Contact], clamp: Contact, pose: Pose, outline: Outline
    ) -> Iterator[Finding]:
        """Whether a clamp of a name, bolted in its hole, reaches its place and clears locators and part."""
        tip = clamp.place(pose)
        bolted = evolve(clamp, way=exact_point(0.0, 0.0)) if self.is_bolted else clamp
        hole, stroke = bolted.place(pose), -pose.travel
        for other, locator in zip(self.names_in_holes, locators, strict=False):
            apart = distance_from_piece(locator.hole, tip, hole) - locator.clear_radius - clamp.radius
            yield from rule(
                apart + HAIR,
                f"{name} meets {other}: they overlap by {number(-apart)} mm",
                f"{name} touches {other} exactly at the edge of what is allowed",
            )
        if self.toolkit.travel is None:
            return
        least, most = self.toolkit.travel
        yield from rule(
            stroke - least + HAIR,
            f"{name} is bolted {number(stroke)} mm behind its tip, nearer than the {least:g} mm of its stroke",
            f"{name} is bolted exactly at the edge of the least of its stroke",
        )
        yield from rule(
            most - stroke + HAIR,
            f"{name} is bolted {number(stroke)} mm behind its tip, beyond the {most:g} mm of its stroke",
            f"{name} is bolted exactly at the edge of the most of its stroke",
        )
        if stroke > 0:
            start, end = clamp.in_part(pose), bolted.in_part(pose)
            clear = clearance(start, end, clamp.radius, outline.segments, enough=1.0)
            yield from rule(
                clear + BODY_SLACK,
                f"{name} enters the workpiece between its hole and its tip by {number(-clear)} mm",
                f"{name} touches the workpiece between its hole and its tip exactly at the edge of what is allowed",
            )

    def nearer_findings(self, fixture: Fixture, stroke: arb, least: float) -> Iterator[Finding]:
        """Whether the clamp is bolted in the nearest hole on the plate."""
        clamp, along_x = fixture.pegs[-1], is_along_x(fixture.pegs[-1])
        way, pitch = WAYS[direction_of(clamp)], self.toolkit.pitch[0 if along_x else 1]
        noun, locators = "column" if along_x else "row", in_holes(fixture)[0]
        nearer = getattr(clamp, noun) - way[0 if along_x else 1]
        if self.fits(noun, [*(getattr(peg, noun) for peg in locators), nearer]):
            yield from rule(
                least - HAIR - (stroke - pitch),
                f"the clamp could be bolted one hole nearer, {number(stroke - pitch)} mm behind its tip",
                "one hole nearer the clamp would be bolted exactly at the edge of the least of its stroke",
            )

    def broken_restriction(self, fixture: Fixture, query: Query) -> str:
        """A plate rules nothing out."""
        return ""

    def body_radius(self, peg: Peg) -> float:
        """Radius in mm of a locator, or of the clamp's tip."""
        return self.toolkit.peg_radius if peg.carrier == PLATE else self.toolkit.clamp_radius

    def patterns(self, fixture: Fixture) -> Iterator[tuple[Key, Place]]:
        """The locators' holes and the clamp's line, up to lattice steps, names and the half turn that makes +x into -x."""
        if not self.has_its_pegs(fixture):
            return
        sign = 1 if (fixture.direction or "").startswith("-") else -1
        *locators, clamp = fixture.pegs
        column, row = min(sign * peg.column for peg in locators), min(sign * peg.row for peg in locators)
        places = sorted((sign * peg.column - column, sign * peg.row - row, k) for k, peg in enumerate(locators))
        anchor, along_x = locators[places[0][2]], is_along_x(clamp)
        line = sign * clamp.row - row if along_x else sign * clamp.column - column
        ahead = clamp.x - anchor.x if along_x else clamp.y - anchor.y
        angle = radians(fixture.pose.theta_deg) + (pi if sign < 0 else 0.0)
        key = along_x, tuple((column, row) for column, row, _ in places), line
        yield key, (angle, *from_anchor(fixture, anchor), sign * ahead)

    def rank(self, fixture: Fixture) -> Rank:
        """Direction and holes, orientation and faces, as they are on the plate turned so that its clamp moves in -x.

        Columns count from the first locator and from the clamp itself, rows from the lowest of all.
        """
        direction = fixture.direction or ""
        turns = quarter_turns(direction)
        pegs = [(*seen_along_x(turns, peg.column, peg.row), peg.face) for peg in fixture.pegs]
        first, lowest = min(column for column, *_ in pegs[:3]), min(row for _, row, _ in pegs)
        *locators, (_, line, face) = pegs
        shifted = sorted((column - first, row - lowest, face) for column, row, face in locators)
        columns, rows, faces = (list(numbers) for numbers in zip(*shifted, (0, line - lowest, face), strict=True))
        angle = (radians(fixture.pose.theta_deg) - turns * pi / 2 + SAME) % tau - SAME
        return [list(WAYS).index(direction), *columns, *rows], angle, faces


def in_holes(fixture: Fixture) -> tuple[list[Peg], list[Peg]]:
    """The locators of a fixture, and its clamps."""
    clamps = len((fixture.direction or "").split())
    pegs = [peg for peg in fixture.pegs if peg.carrier != WALL]
    return pegs[: len(pegs) - clamps], pegs[len(pegs) - clamps :]


def direction_of(clamp: Peg) -> str:
    """The way in which a clamp moves when it clamps."""
    return clamp.carrier.removeprefix("clamp ")


def is_along_x(clamp: Peg) -> bool:
    """Whether a clamp moves along a row."""
    return clamp.carrier.endswith("x")


def travels_of(fixture: Fixture) -> tuple[float, ...]:
    """How far each clamp of a fixture has travelled from its hole, in mm."""
    return (fixture.jaw_separation,) if fixture.pair is None else fixture.pair.travels


def clamp_place(direction: str, column: int, row: int, bolted: bool) -> str:
    """What the place of a clamp is called: by its hole, or by its line where it is in none."""
    if bolted:
        return f"clamp {hole_name(PLATE, column, row)}"
    return f"clamp row {row + 1}" if direction.endswith("x") else f"clamp column {column_letters(column)}"


def quarter_turns(direction: str) -> int:
    """How many quarter turns, counter-clockwise, make -x of the plate the direction of a clamp."""
    return ("-x", "-y", "+x", "+y").index(direction)


def seen_along_x(turns: int, column: int, row: int) -> tuple[int, int]:
    """Column and row of a hole on the plate turned back by so many quarter turns."""
    return ((column, row), (row, -column), (-column, -row), (-row, column))[turns]


def distance_from_piece(point: Point, one: Point, other: Point) -> arb:
    """Distance in mm of a point from a straight piece along x or y."""
    beyond = [arb(0).max(a.min(b) - at).max(at - a.max(b)) for at, a, b in zip(point, one, other, strict=True)]
    return norm((beyond[0], beyond[1]))
