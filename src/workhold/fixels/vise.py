"""The fixture vise: two jaws with a lattice of peg holes each (paper, sections 1 and 2)."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import ClassVar

from attrs import evolve

from workhold.fixels.carrier import Heights, Holes
from workhold.fixels.fields import (
    BLOCKED,
    BODY_RADIUS,
    COLUMNS,
    FLAT,
    LEFT_HEIGHTS,
    MAX_OPENING,
    MIN_GAP,
    PEG_RADIUS,
    PITCH,
    RIGHT_HEIGHTS,
    ROW_OFFSET,
    ROWS,
)
from workhold.fixels.making import lattice_carrier, made_from_table, settle
from workhold.fixels.pegs import Flat
from workhold.fixels.setup_words import PageWords, SetupWords
from workhold.fixels.table import FieldTable
from workhold.fixels.toolkit import Arrangement, Carrier, Change, Symmetry, Toolkit, Travel, Wording
from workhold.units import Unit

__all__ = ["OpeningVise", "Vise"]


# The jaws, the one that stands still first, and what each is called.
JAWS, NOUN = ("left", "right"), "jaw"
WORDING = Wording(
    two="two pegs of one jaw",
    four="four pegs of the two jaws",
    inside="in this vise",
    within="the jaws as asked: with the rows, opening, angles, shoulders and blocked holes given",
    rules="keeps the smallest gap, closes and clamps",
    backwards="the jaws are pressed apart, not when they close",
    holes="holes that the jaws do not have, or too near for the bodies",
)
SETUP = SetupWords(
    standing="Pegs",
    put="Put {peg}s in {holes}.",
    touching="four pegs",
)


FIELDS = FieldTable(
    "vise",
    "A vise",
    (
        PITCH,
        COLUMNS,
        PEG_RADIUS,
        ROWS,
        ROW_OFFSET,
        MIN_GAP,
        MAX_OPENING,
        BODY_RADIUS,
        BLOCKED,
        FLAT,
        LEFT_HEIGHTS,
        RIGHT_HEIGHTS,
    ),
)


@made_from_table
class Vise(Toolkit):
    """Two jaws, the left one fixed, the right one sliding along x, each with a lattice of holes.

    Parameters
    ----------
    pitch : distance between neighbouring columns and rows in mm, one number or (x, y).
    columns : columns of holes on each jaw.
    peg_radius : in mm; 0 is allowed.
    rows : rows of holes on each jaw, or None for as many as needed.
    min_gap : smallest distance in x from the centre of a left peg to the centre of a right one, in mm; None
        means the x pitch.
    max_opening : largest opening in mm, or None for no limit.
    row_offset : height in mm of the right jaw's row 0 above the left jaw's.
    body_radius : radius in mm of the thickest part of a peg, its shoulder, which lies below the workpiece;
        None means the peg radius. Bodies may neither overlap nor stand over a keep-out zone.
    blocked : holes and columns that no peg can stand in, or their names, such as "L-B3" and "R-A".
    flat : of the pegs, which lies on straight faces: its distance from a peg's centre, and half its width, in
        mm; None for round ones.
    left_heights, right_heights : lower and upper end in mm, above the plane on which the part lies, of the
        pegs of each jaw. None where they reach up to the peg height.

    Raises
    ------
    InputError
        For values that are not finite and positive, and for pegs too fat for neighbouring holes.

    Examples
    --------
    >>> from workhold import Vise
    >>> Vise(pitch=10, columns=2, peg_radius=3).min_gap
    10.0
    """

    kind: ClassVar[str] = "vise"
    table: ClassVar[FieldTable] = FIELDS
    noun: ClassVar[str] = "vise"
    locked: ClassVar[str] = "a screw vise, its jaw"
    arrangements: ClassVar[tuple[Arrangement, ...]] = (Arrangement("I", (2, 2)), Arrangement("II", (3, 1)))
    clamping: ClassVar[int] = 1
    wording: ClassVar[Wording] = WORDING
    setup_words: ClassVar[SetupWords] = SETUP

    page: ClassVar[PageWords] = PageWords(
        "Vise, pegs on both jaws",
        "Close vise",
        {PITCH.name: [10.0, 10.0], COLUMNS.name: 2, PEG_RADIUS.name: 3.0},
    )

    pitch: tuple[float, float]
    columns: int
    peg_radius: float
    rows: int | None
    min_gap: float
    max_opening: float | None
    row_offset: float
    body_radius: float
    blocked: tuple[Holes, ...]
    flat: Flat | None
    left_heights: Heights | None
    right_heights: Heights | None

    def __attrs_post_init__(self) -> None:
        settle(self, noun=NOUN, peg="peg")

    @property
    def symmetries(self) -> tuple[Symmetry, ...]:  # type: ignore[override]
        """Half a turn, which swaps the jaws; none where their pegs have different heights."""
        return (Symmetry(1, (1, 0)),) if self.left_heights == self.right_heights else ()

    @property
    def carriers(self) -> tuple[Carrier, Carrier]:
        """The jaws, which are made once."""
        return self.jaws

    @cached_property
    def jaws(self) -> tuple[Carrier, Carrier]:
        """The left jaw, and the right jaw, whose travel is the jaw separation."""
        left = lattice_carrier(
            self,
            JAWS[0],
            body_radius=self.body_radius,
            blocked=tuple(holes for holes in self.blocked if holes.carrier == JAWS[0]),
            noun=NOUN,
            heights=self.left_heights,
        )
        right = evolve(
            left,
            name=JAWS[1],
            offset=((self.columns - 1) * left.pitch[0], self.row_offset),
            blocked=tuple(holes for holes in self.blocked if holes.carrier == JAWS[1]),
            travel=Travel(0.0, self.min_gap, self.max_opening),
            heights=self.right_heights,
        )
        return left, right

    @property
    def law(self) -> str:
        """The law of two jaws."""
        return "vise"

    @property
    def gap(self) -> float:
        """The smallest gap in mm."""
        return self.min_gap

    def further_changes(self, unit: Unit) -> Iterator[Change]:
        """A smaller gap, a column more, rows offset and half the pitch."""

        def words(length: float) -> str:
            return f"{unit.figure(length)} {unit.abbreviation}"

        jaw, _ = self.carriers
        narrow, offset = 2 * jaw.peg_radius, jaw.pitch[1] / 2
        if self.min_gap > narrow > 0:
            yield Change(f"with a smallest gap of {words(narrow)}", {MIN_GAP.name: narrow})
        yield Change("with one more column on each jaw", {COLUMNS.name: self.columns + 1})
        if self.row_offset == 0.0:
            yield Change(f"with the right jaw's rows offset by {words(offset)}", {ROW_OFFSET.name: offset})
        if min(jaw.pitch) >= 4 * jaw.peg_radius:
            half = (jaw.pitch[0] / 2, jaw.pitch[1] / 2)
            yield Change(
                "with half the pitch",
                {PITCH.name: half, MIN_GAP.name: min(self.min_gap, half[0]), BLOCKED.name: ()},
            )


@made_from_table
class OpeningVise(Vise):
    """The vise that clamps by opening: its pegs hold the part from inside its holes, or around a waist.

    Parameters, errors and all rules are those of :class:`Vise`; only the sign of clamping differs.
    """

    kind: ClassVar[str] = "opening-vise"
    clamping: ClassVar[int] = -1
    wording: ClassVar[Wording] = evolve(WORDING, backwards="the jaws close, not when they are pressed apart")
    page: ClassVar[PageWords] = PageWords("Vise that holds by opening", "Open vise", Vise.page.start)
