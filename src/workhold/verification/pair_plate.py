"""The rules that are a plate's own where two clamps hold the part: which pegs, and when two fixtures are one."""

from __future__ import annotations

from collections.abc import Iterator
from math import pi, radians, tau
from typing import ClassVar

from attrs import evolve, field, frozen

from workhold.errors import InputError
from workhold.model.fixture import Fixture, Peg
from workhold.verification.findings import Finding
from workhold.verification.hardware import Key, Place, Rank, from_anchor
from workhold.verification.plate import LOCATORS, PLATE, WAYS, PlateRules, direction_of, is_along_x
from workhold.verification.rules import SAME

__all__ = ["PairRules", "directions_of", "line_of"]

OPPOSITE = {"-x": "+x", "+x": "-x", "-y": "+y", "+y": "-y"}


@frozen
class PairRules(PlateRules):
    """The rules of a plate with two clamps.

    Parameters
    ----------
    every : whether all pairs of clamps of a seat are listed; else one stands for them, and two fixtures of one seat and
        pair of directions are the same.
    """

    names: ClassVar[tuple[str, ...]] = ("locator 1", "locator 2", "locator 3", "clamp 1", "clamp 2")
    slack_words: ClassVar[str] = "a clamp does not push the part"
    wider_words: ClassVar[str] = (
        "a smaller contact margin, a longer stroke, more columns or rows, fewer restrictions or more pairs of directions"
    )

    kinds: ClassVar[str] = "clamp2"
    pegs_wanted: ClassVar[str] = "three locators and then two clamps"

    every: bool = field(default=False, kw_only=True)

    @property
    def same_words(self) -> str:
        """What is said of a fixture that an earlier one already is."""
        return "it is the same as" if self.every else "it has the seat and the directions of"

    def has_its_pegs(self, fixture: Fixture) -> bool:
        """Whether the pegs of a fixture are three locators and then its two clamps."""
        clamps = [f"clamp {name}" for name in directions_of(fixture)]
        return len(clamps) == 2 and [peg.carrier for peg in fixture.pegs] == [*[PLATE] * LOCATORS, *clamps]

    def taken(self, fixture: Fixture) -> Fixture:
        """A fixture as it is read, with the travels that put the clamps' tips where they are written.

        Raises
        ------
        InputError
            When it has no two clamps.
        """
        if fixture.type != self.kinds or fixture.pair is None:
            raise InputError(f"its type is not {self.kinds}")
        first, second = (self.travel_of(clamp) for clamp in fixture.pegs[LOCATORS:])
        return evolve(fixture, jaw_separation=first, pair=evolve(fixture.pair, travels=(first, second)))

    def asked_findings(self, fixture: Fixture) -> Iterator[Finding]:
        """Whether a fixture has the pegs of its kind, in their order, and directions that are asked for."""
        clamps = directions_of(fixture)
        if not self.has_its_pegs(fixture):
            yield Finding(True, f"its pegs are not {self.pegs_wanted}")
        if clamps not in self.toolkit.directions:
            yield Finding(True, f"its clamps move in {' and '.join(clamps)}, which is not asked for")
        places = [(list(WAYS).index(direction_of(c)), line_of(c), c.face) for c in fixture.pegs[LOCATORS:]]
        if places != sorted(places):
            yield Finding(True, "its clamps are not in the order of directions, lines and faces")

    def patterns(self, fixture: Fixture) -> Iterator[tuple[Key, Place]]:
        """The locators' holes and the clamps' lines, or their directions alone where one pair stands for all, up to lattice
        steps, names and the half turn, which turns directions."""
        if not self.has_its_pegs(fixture):
            return iter(())
        named = [self.pattern(fixture, sign) for sign in (1, -1)]
        least = min(key for key, _ in named)
        return ((key, place) for key, place in named if key == least)

    def pattern(self, fixture: Fixture, sign: int) -> tuple[Key, Place]:
        """The pattern as it is (sign 1) or after half a turn of the plate (-1)."""
        locators, clamps = fixture.pegs[:LOCATORS], fixture.pegs[LOCATORS:]
        lowest = min(sign * peg.column for peg in locators), min(sign * peg.row for peg in locators)
        places = sorted(
            (sign * peg.column - lowest[0], sign * peg.row - lowest[1], k) for k, peg in enumerate(locators)
        )
        anchor = locators[places[0][2]]
        angle = radians(fixture.pose.theta_deg) + (pi if sign < 0 else 0.0)
        there = []
        for clamp in clamps:
            name, upright = direction_of(clamp), not is_along_x(clamp)
            line = sign * line_of(clamp) - lowest[0 if upright else 1]
            ahead = sign * (clamp.y - anchor.y if upright else clamp.x - anchor.x)
            there.append((list(WAYS).index(name if sign > 0 else OPPOSITE[name]), line, ahead))
        there.sort()
        lines = tuple((way, line) if self.every else way for way, line, _ in there)
        aheads = [ahead for *_, ahead in there] if self.every else []
        return (tuple((column, row) for column, row, _ in places), lines), (
            angle,
            *from_anchor(fixture, anchor),
            *aheads,
        )

    def rank(self, fixture: Fixture) -> Rank:
        """Directions and holes, orientation and faces, locators by their columns and rows."""
        locators = sorted((peg.column, peg.row, peg.face) for peg in fixture.pegs[:LOCATORS])
        pegs = [*locators, *((peg.column, peg.row, peg.face) for peg in fixture.pegs[LOCATORS:])]
        columns, rows, faces = (list(numbers) for numbers in zip(*pegs, strict=True))
        ways = [list(WAYS).index(name) for name in directions_of(fixture)]
        angle = (radians(fixture.pose.theta_deg) + SAME) % tau - SAME
        return [*ways, *columns, *rows], angle, faces


def directions_of(fixture: Fixture) -> tuple[str, ...]:
    """The directions of a fixture's clamps."""
    return tuple((fixture.direction or "").split())


def line_of(clamp: Peg) -> int:
    """The number of the row or column along which a clamp moves."""
    return clamp.row if is_along_x(clamp) else clamp.column
