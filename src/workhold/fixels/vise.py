"""The fixture vise: two jaws with a lattice of peg holes each (paper, sections 1 and 2)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cached_property
from typing import TYPE_CHECKING, Any

from attrs import evolve

from workhold.fixels import fields
from workhold.fixels.carrier import Heights, HoleSelection
from workhold.fixels.making import complete_and_check, make_class_from_table, make_lattice_carrier
from workhold.fixels.pegs import PegFlat
from workhold.fixels.setup_words import PageWords, SetupWords
from workhold.fixels.table import FieldTable
from workhold.fixels.toolkit import (
    Arrangement,
    Carrier,
    Symmetry,
    Toolkit,
    ToolkitChange,
    ToolkitWording,
    Travel,
)
from workhold.units import Unit

__all__ = ["OpeningVise", "Vise"]


@make_class_from_table
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
        mm; None for round pegs.
    left_heights, right_heights : lower and upper end in mm, above the plane on which the part lies, of the
        pegs of each jaw. None where they reach up to the peg height.
    supports, top_clamp, pins : the owner's supports under the part, clamp on top and limits of pins, as mappings
        of figures in mm and MPa (see ``fixels.support_hardware``); None for the usual ones.
    tolerance : how far these pegs and the faces that they touch may be off; None where not known.

    Raises
    ------
    InputError
        For values that are not finite and positive, and for pegs too thick for neighbouring holes.

    Examples
    --------
    >>> from workhold import Vise
    >>> Vise(pitch=10, columns=2, peg_radius=3).min_gap
    10.0
    """

    kind = "vise"
    table = FieldTable(
        "vise",
        "A vise",
        (
            fields.PITCH,
            fields.COLUMNS,
            fields.PEG_RADIUS,
            fields.ROWS,
            fields.ROW_OFFSET,
            fields.MIN_GAP,
            fields.MAX_OPENING,
            fields.BODY_RADIUS,
            fields.BLOCKED,
            fields.FLAT,
            fields.LEFT_HEIGHTS,
            fields.RIGHT_HEIGHTS,
        ),
    )
    noun = "vise"
    locked = "a screw vise, its jaw"
    law = "vise"
    arrangements = (Arrangement("I", (2, 2)), Arrangement("II", (3, 1)))
    wording = ToolkitWording(
        two="two pegs of one jaw",
        four="four pegs of the two jaws",
        inside="in this vise",
        within="the jaws as asked: with the rows, opening, angles, shoulders and blocked holes given",
        rules="keeps the smallest gap, closes and clamps",
        backwards="the jaws are pressed apart, not when they close",
        holes="holes that the jaws do not have, or too near for the bodies",
    )
    setup_words = SetupWords(standing="Pegs", put="Put {peg}s in {holes}.", touching="four pegs")
    page = PageWords(
        "Vise, pegs on both jaws",
        "Close vise",
        {fields.PITCH.name: [10.0, 10.0], fields.COLUMNS.name: 2, fields.PEG_RADIUS.name: 3.0},
    )

    pitch: tuple[float, float]
    columns: int
    peg_radius: float
    rows: int | None
    min_gap: float
    max_opening: float | None
    row_offset: float
    body_radius: float
    blocked: tuple[HoleSelection, ...]
    flat: PegFlat | None
    left_heights: Heights | None
    right_heights: Heights | None

    if TYPE_CHECKING:
        # As the table makes it, for editors and mypy; a test compares the two.
        def __init__(
            self,
            pitch: float | Iterable[float],
            columns: int,
            peg_radius: float,
            rows: int | None = None,
            min_gap: float | None = None,
            max_opening: float | None = None,
            row_offset: float = 0.0,
            body_radius: float | None = None,
            blocked: Iterable[HoleSelection | str] = (),
            *,
            flat: float | Iterable[float] | PegFlat | None = None,
            left_heights: Iterable[float] | None = None,
            right_heights: Iterable[float] | None = None,
            supports: Any = None,
            top_clamp: Any = None,
            pins: Any = None,
            tolerance: Any = None,
        ) -> None: ...

    def __attrs_post_init__(self) -> None:
        complete_and_check(self, noun="jaw", peg="peg")

    @property
    def symmetries(self) -> tuple[Symmetry, ...]:  # type: ignore[override]
        """Half a turn, which exchanges the jaws; empty where the pegs of the two jaws have different
        heights.
        """
        return (Symmetry(1, (1, 0)),) if self.left_heights == self.right_heights else ()

    @property
    def carriers(self) -> tuple[Carrier, ...]:
        """The left and the right jaw."""
        return self.jaws

    @cached_property
    def jaws(self) -> tuple[Carrier, ...]:
        """The left jaw, and the right jaw, whose travel is the jaw separation."""
        both = {"body_radius": self.body_radius, "noun": "jaw"}
        left = make_lattice_carrier(self, "left", **both, heights=self.left_heights)
        right = make_lattice_carrier(
            self,
            "right",
            **both,
            offset=((self.columns - 1) * left.pitch[0], self.row_offset),
            travel=Travel(0.0, self.min_gap, self.max_opening),
            heights=self.right_heights,
        )
        return left, right

    @property
    def gap(self) -> float:
        """The smallest distance in mm along x from a left peg's centre to a right peg's."""
        return self.min_gap

    def list_further_changes(self, unit: Unit) -> Iterator[ToolkitChange]:
        """Yield the changes that apply: a smaller gap, one more column, offset rows, half the pitch."""
        jaw, _ = self.carriers
        narrow, offset = 2 * jaw.peg_radius, jaw.pitch[1] / 2
        words = [f"{unit.format_short_length(length)} {unit.abbreviation}" for length in (narrow, offset)]
        if self.min_gap > narrow > 0:
            yield ToolkitChange(f"with a smallest gap of {words[0]}", {fields.MIN_GAP.name: narrow})
        yield ToolkitChange("with one more column on each jaw", {fields.COLUMNS.name: self.columns + 1})
        if self.row_offset == 0.0:
            yield ToolkitChange(
                f"with the right jaw's rows offset by {words[1]}", {fields.ROW_OFFSET.name: offset}
            )
        if min(jaw.pitch) >= 4 * jaw.peg_radius:
            half = (jaw.pitch[0] / 2, jaw.pitch[1] / 2)
            yield ToolkitChange(
                "with half the pitch",
                {
                    fields.PITCH.name: half,
                    fields.MIN_GAP.name: min(self.min_gap, half[0]),
                    fields.BLOCKED.name: (),
                },
            )


@make_class_from_table
class OpeningVise(Vise):
    """A vise that clamps by opening: its pegs hold the part from inside its holes, or around a waist.

    Parameters, errors and all rules are those of :class:`Vise`; only the sign of clamping differs.
    """

    kind = "opening-vise"
    clamping = -1
    wording = evolve(Vise.wording, backwards="the jaws close, not when they are pressed apart")
    page = PageWords("Vise that holds by opening", "Open vise", Vise.page.start)
