"""The rules that are a fence's own where two clamps hold the part: one locator as a stop, and when two fixtures are one."""

from __future__ import annotations

from collections.abc import Iterator
from math import radians, tau
from typing import ClassVar

from attrs import frozen

from workhold.model.fixture import Fixture
from workhold.verification.fence import FenceRules
from workhold.verification.hardware import Key, Place, Rank, from_anchor
from workhold.verification.pair_plate import PairRules, directions_of, line_of
from workhold.verification.plate import PLATE, WAYS, direction_of, in_holes, is_along_x
from workhold.verification.rules import SAME, WALL

__all__ = ["FencePairRules"]


@frozen
class FencePairRules(FenceRules, PairRules):
    """The rules of a fence with one locator and two clamps: the part lies on the wall as with one, and is pressed as on a
    plate with two."""

    names: ClassVar[tuple[str, ...]] = (*FenceRules.names[:-1], *PairRules.names[-2:])
    kinds: ClassVar[str] = "edge2"
    pegs_wanted: ClassVar[str] = "one locator, the two ends of the fence and then two clamps"

    def has_its_pegs(self, fixture: Fixture) -> bool:
        """Whether the pegs of a fixture are one locator, the wall's two ends and then its two clamps."""
        clamps = [f"clamp {name}" for name in directions_of(fixture)]
        return len(clamps) == 2 and [peg.carrier for peg in fixture.pegs] == [PLATE, WALL, WALL, *clamps]

    def patterns(self, fixture: Fixture) -> Iterator[tuple[Key, Place]]:
        """The locator's row and the clamps' lines, or their directions alone where one pair stands for all, up to steps
        along the wall."""
        if not self.has_its_pegs(fixture):
            return
        (anchor,), clamps = in_holes(fixture)
        there = []
        for clamp in clamps:
            along_x, way = is_along_x(clamp), list(WAYS).index(direction_of(clamp))
            line = line_of(clamp) - (0 if along_x else anchor.column)
            there.append((way, line, clamp.x - anchor.x if along_x else clamp.y))
        there.sort()
        lines = tuple((way, line) if self.every else way for way, line, _ in there)
        aheads = [ahead for *_, ahead in there] if self.every else []
        yield (anchor.row, lines), (radians(fixture.pose.theta_deg), *from_anchor(fixture, anchor), *aheads)

    def rank(self, fixture: Fixture) -> Rank:
        """Directions, columns and rows of locator and clamps, orientation and faces."""
        locators, clamps = in_holes(fixture)
        pegs = [*locators, *clamps]
        ways = [list(WAYS).index(name) for name in directions_of(fixture)]
        angle = (radians(fixture.pose.theta_deg) + SAME) % tau - SAME
        return [*ways, *(p.column for p in pegs), *(p.row for p in pegs)], angle, [peg.face for peg in fixture.pegs]
