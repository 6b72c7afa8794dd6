"""A dowel plate: locators in its holes, and one clamp or two that push along lines of holes.

One clamp is the fixture of Brost & Goldberg 1996. With two clamps five pegs hold the part (a shop's 3-2-1).
The locators alone fix its pose; only both clamps together press it against all of them.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from itertools import combinations_with_replacement
from math import inf
from typing import Any, ClassVar

from attrs import evolve

from workhold.errors import InputError
from workhold.fixels.carrier import Heights
from workhold.fixels.contacts import DIRECTIONS
from workhold.fixels.fields import (
    CLAMP_HEIGHTS,
    CLAMP_RADIUS,
    CLAMPS,
    DIRECTION,
    FLAT,
    LOCATOR_HEIGHTS,
    ON_A_PLATE,
    PEG_RADIUS,
    PITCH,
    TRAVEL,
)
from workhold.fixels.making import finer, lattice_carrier, made_from_table, settle
from workhold.fixels.pegs import Flat
from workhold.fixels.setup_words import PageWords, SetupWords
from workhold.fixels.table import FieldTable
from workhold.fixels.toolkit import Arrangement, Carrier, Change, Symmetry, Toolkit, Travel, Wording
from workhold.units import Unit

__all__ = ["Plate"]


def turned_half(name: str) -> str:
    """What half a turn makes of a direction."""
    return f"{'-' if name[0] == '+' else '+'}{name[1]}"


FIELDS = FieldTable(
    "plate",
    "A plate with locators and a clamp",
    (*ON_A_PLATE, CLAMP_RADIUS, TRAVEL, CLAMPS, DIRECTION, FLAT, LOCATOR_HEIGHTS, CLAMP_HEIGHTS),
)


@made_from_table
class Plate(Toolkit):
    """A plate with a lattice of holes: three locators in any of them, and clamps along rows and columns.

    Parameters
    ----------
    pitch : distance between neighbouring columns and rows in mm, one number or (x, y).
    peg_radius : of the locators in mm; 0 is allowed.
    columns, rows : of holes, or None for as many as needed.
    clamp_radius : of the clamp's round tip in mm; None means the peg radius.
    travel : least and most in mm from the hole that the clamp is bolted in to its tip. None makes the clamp
        its tip alone, and asks nothing of its body.
    directions : of clamping, among "-x", "+x", "-y" and "+y". None means all
        that differ by more than a turn of the plate. Two clamps take pairs, such as [("-x", "-y")]; single
        directions stand for all pairs of them.
    clamps : 1, or 2 that are needed together.
    flat : of the locators, which lies on straight faces: its distance from a locator's centre, and half its
        width, in mm; None for round ones. A clamp's tip is round.
    locator_heights, clamp_heights : lower and upper end in mm, above the plane on which the part lies, of the
        locators, and of the clamps with their tips. None where they reach up to the peg height.

    Raises
    ------
    InputError
        For values that are not finite and positive, and for locators too fat for neighbouring holes.

    Examples
    --------
    >>> from workhold import Plate
    >>> Plate(pitch=20, peg_radius=3).directions, Plate(pitch=20, peg_radius=3, columns=8, rows=6).directions
    (('-x',), ('-x', '-y'))
    >>> Plate(pitch=20, peg_radius=3, clamps=2).directions
    (('-x', '-y'),)
    """

    kind: ClassVar[str] = "translating-clamp"
    table: ClassVar[FieldTable] = FIELDS
    noun: ClassVar[str] = "plate"
    locked: ClassVar[str] = "a screw clamp,"
    clamping: ClassVar[int] = 1
    symmetries: ClassVar[tuple[Symmetry, ...]] = ()
    wording: ClassVar[Wording] = Wording(
        two="two locators",
        four="three locators and a clamp",
        inside="on this plate",
        within=(
            "their places as asked: with the columns, rows and angles given, and clear of the clamp with its "
            "stroke"
        ),
        rules="closes and is pressed together by the clamp",
        backwards="the clamp pulls, not when it pushes",
        holes="holes that the plate does not have",
    )
    setup_words: ClassVar[SetupWords] = SetupWords(
        standing="Locators",
        located_by="Three locators",
        put="Put {peg}s in {holes} of the {plate}.",
        against="against all {count} {peg}s",
        touching="four pegs",
    )

    page: ClassVar[PageWords] = PageWords(
        "Plate with one clamp or two",
        "Close clamp",
        {PITCH.name: [20.0, 20.0], PEG_RADIUS.name: 3.0, CLAMPS.name: 1},
    )

    pitch: tuple[float, float]
    peg_radius: float
    columns: int | None
    rows: int | None
    clamp_radius: float
    travel: tuple[float, float] | None
    directions: tuple[Any, ...]
    clamps: int
    flat: Flat | None
    locator_heights: Heights | None
    clamp_heights: Heights | None

    def __attrs_post_init__(self) -> None:
        settle(self, noun=self.noun, peg="locator")
        object.__setattr__(self, "directions", self.resolved_directions())

    @property
    def is_paired(self) -> bool:
        """Whether two clamps are needed together."""
        return self.clamps == 2

    @property
    def is_square(self) -> bool:
        """Whether a quarter turn of the plate leaves it as it is."""
        holes = lattice_carrier(self, "plate")
        return holes.pitch[0] == holes.pitch[1] and holes.columns == holes.rows

    def resolved_directions(self) -> tuple[Any, ...]:
        """The directions, or pairs of them, that are meant.

        Raises
        ------
        InputError
            For pairs where there is one clamp.
        """
        names = self.directions
        if not self.is_paired:
            if any(not isinstance(name, str) for name in names):
                raise InputError(
                    "the directions are pairs, but there is one clamp: give two clamps, or no pairs."
                )
            return names or self.usual_directions
        if not names:
            return self.usual_pairs
        return tuple(combinations_with_replacement(names, 2)) if isinstance(names[0], str) else names

    @property
    def usual_directions(self) -> tuple[str, ...]:
        """All directions that differ by more than a turn of the plate."""
        return ("-x",) if self.is_square else ("-x", "-y")

    @property
    def usual_pairs(self) -> tuple[tuple[str, str], ...]:
        """Two clamps square to each other, in all ways that differ by more than a turn of the plate."""
        return (("-x", "-y"),) if self.is_square else (("-x", "-y"), ("-x", "+y"))

    @property
    def distinct_directions(self) -> tuple[str, ...]:
        """The clamps' directions, without those that half a turn of the plate makes of another one."""
        if self.is_paired:
            return tuple(name for name in DIRECTIONS if any(name in pair for pair in self.distinct_pairs))
        return tuple(
            name for name in self.directions if not (name[0] == "+" and f"-{name[1]}" in self.directions)
        )

    @property
    def distinct_pairs(self) -> tuple[tuple[str, str], ...]:
        """The pairs of directions without those that half a turn of the plate makes of another one."""
        out: list[tuple[str, str]] = []
        for one, other in self.directions:
            if {(turned_half(one), turned_half(other)), (turned_half(other), turned_half(one))}.isdisjoint(
                out
            ):
                out.append((one, other))
        return tuple(out)

    @property
    def arrangements(self) -> tuple[Arrangement, ...]:  # type: ignore[override]
        """Three locators and a clamp for each direction, or two clamps for each pair of directions."""
        names = self.distinct_directions
        if not self.is_paired:
            return tuple(
                Arrangement("clamp", (3, *(int(other == name) for other in names)), name) for name in names
            )
        return tuple(
            Arrangement("clamp2", (3, *(pair.count(name) for name in names)), " ".join(pair))
            for pair in self.distinct_pairs
        )

    @cached_property
    def carriers(self) -> tuple[Carrier, ...]:
        """The plate, and for each direction the clamp, whose travel grows as it opens."""
        return self.plate_and_clamps((0.0, 0.0))

    def plate_and_clamps(self, offset: tuple[float, float]) -> tuple[Carrier, ...]:
        """The plate with its first hole at a place in mm, and the clamp of each direction."""
        plate = lattice_carrier(
            self, "plate", offset=offset, noun="plate", peg="locator", heights=self.locator_heights
        )
        least, most = (-inf, None) if self.travel is None else (-self.travel[1], -self.travel[0])
        clamp = lattice_carrier(
            self,
            "clamp",
            peg_radius=self.clamp_radius,
            body_radius=self.clamp_radius,
            offset=offset,
            noun="clamp",
            peg="clamp",
            on="plate",
            flat=None,
            heights=self.clamp_heights,
        )
        return (
            plate,
            *(
                evolve(clamp, name=f"clamp {name}", travel=Travel(DIRECTIONS[name], least, most))
                for name in self.distinct_directions
            ),
        )

    @property
    def ways(self) -> tuple[Plate, ...]:
        """The plate with one clamp in one direction each time."""
        return tuple(
            self.changed({CLAMPS.name: 1, DIRECTION.name: (name,)}) for name in self.distinct_directions
        )

    @property
    def law(self) -> str:
        """The law of one clamp, or of two."""
        return "two clamps" if self.is_paired else "plate"

    @property
    def half_turned(self) -> tuple[int, ...] | None:
        """The plate takes its own place, and each clamp that of the one that pushes the other way."""
        names = [carrier.name for carrier in self.carriers]
        ahead = [f"clamp {turned_half(carrier.direction)}" for carrier in self.carriers[1:]]
        return (0, *(names.index(name) if name in names else -1 for name in ahead))

    def further_changes(self, unit: Unit) -> Iterator[Change]:
        """The clamp along rows and columns, and half the pitch."""
        if self.is_paired:
            yield Change("with one clamp", {CLAMPS.name: 1, DIRECTION.name: None})
            if len(self.distinct_pairs) == 1:
                pairs = ("-x", "-y"), ("-x", "+y")
                yield Change("with the clamps along rows and columns either way", {DIRECTION.name: pairs})
        if not self.is_paired:
            yield Change("with a second clamp", {CLAMPS.name: 2, DIRECTION.name: None})
            if len(self.distinct_directions) == 1:
                yield Change("with the clamp along the columns as well", {DIRECTION.name: ("-x", "-y")})
        yield from finer(self)
