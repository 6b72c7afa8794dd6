"""The rules that are a vise's own: jaws, holes, the smallest gap and the largest opening (model: "Vise", "Fixture")."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from math import hypot, pi, radians, tau
from typing import ClassVar

from attrs import frozen
from flint import arb

from workhold.errors import InputError
from workhold.model.fixture import Fixture, Peg
from workhold.model.query import Query
from workhold.model.vise import Vise
from workhold.verification.balls import Point, exact_point
from workhold.verification.contacts import Contact, Pose, standing_contact
from workhold.verification.findings import Finding, number, rule
from workhold.verification.hardware import Hardware, Key, Place, Rank, from_anchor
from workhold.verification.outline import Outline
from workhold.verification.rules import AGREEMENT, HAIR, LEAST_CLAMPING, SAME
from workhold.verification.sides import Side

__all__ = ["ViseRules"]

# Pegs on the left jaw for each type of fixture (model: "Fixture").
LEFT_PEGS = {"I": 2, "II": 3}
JAWS = ("left", "right")


@frozen
class ViseRules(Hardware):
    """The rules of a vise, closing or opening; pegs are told by their number."""

    names: ClassVar[tuple[str, ...]] = ("peg 1", "peg 2", "peg 3", "peg 4")
    travel_words: ClassVar[str] = "opening"
    wider_words: ClassVar[str] = (
        "a smaller gap or contact margin, a larger opening, more rows, fewer restrictions or more types"
    )
    least_clamping: ClassVar[float] = LEAST_CLAMPING

    toolkit: Vise

    @property
    def slack_words(self) -> str:
        """What is wrong where the clamping force is none."""
        return f"{'closing' if self.toolkit.clamping > 0 else 'opening'} the vise does not clamp"

    @property
    def largest_radius(self) -> float:
        """Of the pegs, in mm."""
        return self.toolkit.peg_radius

    def taken(self, fixture: Fixture) -> Fixture:
        """A fixture as it is read.

        Raises
        ------
        InputError
            When its type is unknown, or the jaw of a peg.
        """
        if fixture.type not in LEFT_PEGS:
            raise InputError(f"its type is not {' or '.join(LEFT_PEGS)}")
        if any(peg.carrier not in JAWS for peg in fixture.pegs):
            raise InputError(f"a peg's jaw is not {' or '.join(JAWS)}")
        return fixture

    def place(self, peg: Peg) -> Point:
        """Centre of a peg's hole in the vise frame for a jaw separation of 0, in mm (model: "Vise")."""
        vise = self.toolkit
        pitch_x, pitch_y = vise.pitch
        if peg.carrier == "left":
            return arb(pitch_x) * peg.column, arb(pitch_y) * peg.row
        return arb(pitch_x) * (vise.columns - 1 + peg.column), arb(pitch_y) * peg.row + vise.row_offset

    def contact(self, peg: Peg, side: Side) -> Contact:
        """The contact of a peg with a side; right pegs move along x with the jaw separation."""
        way = exact_point(float(peg.carrier == "right"), 0.0)
        return standing_contact(self.place(peg), way, side, self.toolkit.peg_radius, self.toolkit.flat)

    def hole_findings(self, fixture: Fixture) -> Iterator[Finding]:
        """What is wrong with jaws, columns, rows and the places x, y written for them."""
        vise = self.toolkit
        lefts = sum(peg.carrier == "left" for peg in fixture.pegs)
        if len(fixture.pegs) != 4 or LEFT_PEGS.get(fixture.type) != lefts:
            yield Finding(
                True, f"{lefts} of its {len(fixture.pegs)} pegs are on the left jaw, which is not type {fixture.type}"
            )
        if len({(peg.carrier, peg.column, peg.row) for peg in fixture.pegs}) < len(fixture.pegs):
            yield Finding(True, "two pegs are in the same hole")
        for name, peg in zip(self.names, fixture.pegs, strict=False):
            if not 0 <= peg.column < vise.columns:
                yield Finding(True, f"{name} is in column {peg.column} of a jaw with {vise.columns}")
            if peg.row < 0 or (vise.rows is not None and peg.row >= vise.rows):
                rows = "rows from 0 upward" if vise.rows is None else f"{vise.rows} rows"
                yield Finding(True, f"{name} is in row {peg.row} of a jaw with {rows}")
            x, y = self.place(peg)
            if peg.carrier == "right":
                x += fixture.jaw_separation
            for axis, written, derived in (("x", peg.x, x), ("y", peg.y, y)):
                off = abs(derived - written)
                if not off < AGREEMENT:
                    words = f"the {axis} of {name} is {number(off)} mm from that of its hole"
                    yield from rule(AGREEMENT - off, words, words)

    def standing_findings(
        self, fixture: Fixture, contacts: list[Contact], pose: Pose, outline: Outline
    ) -> Iterator[Finding]:
        """Whether the jaws can stand at a proven separation, met to a hair (see ``findings``).

        The separation is the gap between the columns next to the opening, so no right peg is nearer to a left one.
        """
        separation = pose.travel
        gap, limit = self.toolkit.min_gap, self.toolkit.max_opening
        yield from rule(
            separation - gap + HAIR,
            f"the opening of {number(separation)} mm is below the smallest gap of {gap:g} mm",
            "the opening is exactly at the edge of the smallest gap",
        )
        if limit is not None:
            yield from rule(
                limit - separation + HAIR,
                f"the opening of {number(separation)} mm is above the largest opening of {limit:g} mm",
                "the opening is exactly at the edge of the largest opening",
            )

    def broken_restriction(self, fixture: Fixture, query: Query) -> str:
        """A peg in a blocked hole, or two whose bodies overlap."""
        for name, peg in zip(self.names, fixture.pegs, strict=True):
            blocked = (
                holes for holes in self.toolkit.blocked if (holes.carrier, holes.column) == (peg.carrier, peg.column)
            )
            if any(holes.row in (None, peg.row) for holes in blocked):
                return f"{name} stands in {peg.hole}, which is blocked"
        for (i, one), (k, other) in combinations(enumerate(fixture.pegs, 1), 2):
            if hypot(one.x - other.x, one.y - other.y) < 2 * self.toolkit.body_radius - AGREEMENT:
                return f"the bodies of pegs {i} and {k} overlap"
        return ""

    def body_radius(self, peg: Peg) -> float:
        """Radius in mm of a peg's shoulder."""
        return self.toolkit.body_radius

    def patterns(self, fixture: Fixture) -> Iterator[tuple[Key, Place]]:
        """The patterns of holes up to lattice steps, names of pegs and the half turn that swaps the jaws."""
        if {peg.carrier for peg in fixture.pegs} != set(JAWS):
            return iter(())
        named = [pattern(fixture, sign) for sign in (1, -1)]
        least = min(key for key, _ in named)
        return ((key, place) for key, place in named if key == least)

    def rank(self, fixture: Fixture) -> Rank:
        """Type and holes, orientation and faces.

        Columns count from each jaw's first peg, rows from the lowest of all. A fixture of two pegs on each jaw is the same
        after a half turn of the vise, which swaps the jaws: it counts as it is at an orientation below half a turn.
        """
        jaws = [[peg for peg in fixture.pegs if peg.carrier == jaw] for jaw in JAWS]
        angle = (radians(fixture.pose.theta_deg) + SAME) % tau - SAME
        sign = -1 if len(jaws[0]) == len(jaws[1]) and angle >= pi - SAME else 1
        lowest = min(sign * peg.row for peg in fixture.pegs)
        pegs: list[tuple[int, int, int]] = []
        for jaw in jaws[::sign]:
            first = min((sign * peg.column for peg in jaw), default=0)
            pegs += sorted((sign * peg.column - first, sign * peg.row - lowest, peg.face) for peg in jaw)
        columns, rows, faces = (list(numbers) for numbers in zip(*pegs, strict=True))
        return [list(LEFT_PEGS).index(fixture.type), *columns, *rows], angle - pi * (sign < 0), faces


def pattern(fixture: Fixture, sign: int) -> tuple[Key, Place]:
    """The pattern of holes as it is (sign 1) or after a half turn of the vise (-1)."""
    near = "left" if sign > 0 else "right"
    lowest = min(sign * peg.row for peg in fixture.pegs)
    key, anchors = [], []
    for ours in (True, False):
        pegs = [peg for peg in fixture.pegs if (peg.carrier == near) == ours]
        first = min(sign * peg.column for peg in pegs)
        places = sorted((sign * peg.column - first, sign * peg.row - lowest, k) for k, peg in enumerate(pegs))
        key.append(tuple((column, row) for column, row, _ in places))
        anchors.append(pegs[places[0][2]])
    angle = radians(fixture.pose.theta_deg) + (pi if sign < 0 else 0.0)
    return tuple(key), (angle, *from_anchor(fixture, anchors[0]), sign * (anchors[1].x - anchors[0].x))
