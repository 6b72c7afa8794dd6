"""Tools to write the blocks of a setup sheet: its data, headings, tables, fields to fill in."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Callable
from functools import lru_cache

from attrs import frozen

from workhold.drawing.panel import FACT_NAME, TextColumn, pegs_words
from workhold.drawing.scene import BLACK, GREY, LengthUnit, Scene, text_width
from workhold.drawing.seating_words import SeatingSentences
from workhold.drawing.sheet_facts import Caution, SheetDetails
from workhold.drawing.sheet_heights import SheetHeights
from workhold.errors import listed
from workhold.fixels.contacts import FLAT_PIN
from workhold.fixels.setup_words import Datum
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.segment import Point
from workhold.model.dowels import fit_words
from workhold.model.fixture import Fixture, Peg
from workhold.model.setup import LengthSetting, PartZero, contact_names, part_zero, settings_of
from workhold.model.workpiece import Workpiece

__all__ = [
    "BODY",
    "NOTE",
    "Block",
    "MovingBlocks",
    "Sheet",
    "Writer",
    "fact_or_field",
    "heading",
    "height_of",
    "inside_words",
    "lies_words",
    "peg_rows",
    "write_dowel",
    "write_flats",
]

BODY, NOTE, HEADING = 12.5, 11.0, 14.0
KILO = 1000.0
# Least and largest width of a field to fill in, page units.
FIELD = 60.0, 150.0

Block = Callable[[TextColumn], None]


@frozen
class Sheet:
    """The data of a setup sheet.

    Parameters
    ----------
    fixture, workpiece, toolkit, details : what it is of, and what does not follow from these.
    lengths : how lengths are written.
    cautions : what to beware of.
    heights : those that are known; None where nobody knows how thick the part is.
    zero_shown, origin_shown : whether these are on the plan.
    """

    fixture: Fixture
    workpiece: Workpiece
    toolkit: Toolkit
    details: SheetDetails
    lengths: LengthUnit
    cautions: tuple[Caution, ...]
    heights: SheetHeights | None = None
    zero_shown: bool = True
    origin_shown: bool = True

    @property
    def name(self) -> str:
        """The part's name."""
        return self.details.part_name or self.workpiece.name

    @property
    def zero(self) -> PartZero:
        """Part zero."""
        return self.details.zero or part_zero(self.workpiece)

    @property
    def zero_place(self) -> Point:
        """Where part zero lies in the vise frame, in mm."""
        x, y = self.fixture.pose.apply(*self.zero.point)
        return float(x), float(y)

    @property
    def seating(self) -> SeatingSentences | None:
        """Sentences on where else the pegs can hold the part; None where the sheet does not show it."""
        seating = self.details.seating
        return (
            None if seating is None else SeatingSentences(seating, self.fixture, self.toolkit, self.lengths)
        )

    @property
    def datum(self) -> Datum:
        """What places are measured from."""
        return self.toolkit.datum

    @property
    def is_closed_at_once(self) -> bool:
        """Whether one thing is set and tightened, rather than two clamps in turn."""
        return len(self.fixture.travels) == 1

    @property
    def settings(self) -> tuple[LengthSetting, ...]:
        """What is set on each thing that moves."""
        return settings_of(self.fixture, self.toolkit)


Writer = Callable[[TextColumn, Sheet], None]


@frozen
class MovingBlocks:
    """What a sheet says of things that move.

    Parameters
    ----------
    settings : the blocks about the lengths to set.
    steps : what to do, one or two sentences each, up to the machine's zero.
    """

    settings: Callable[[Sheet], list[Writer]]
    steps: Callable[[Sheet], list[str]]


# A layout asks for each block in each width many times; a sheet has some hundred of these.
@lru_cache(maxsize=256)
def height_of(block: Block, width: float) -> float:
    """Height of a block in a column of a width, page units."""
    column = TextColumn(Scene(ET.Element("g")), 0.0, 0.0, width)
    block(column)
    return column.y


def heading(column: TextColumn, words: str) -> None:
    """Writes the heading of a block below a line."""
    column.rule(1.4)
    column.words(words, HEADING, bold=True, gap=0.65)


def fact_or_field(column: TextColumn, name: str, value: str | None) -> None:
    """Writes a fact, or where it is not known a line to write it on."""
    if value is not None:
        column.fact(name, value, bold=True)
        return
    column.y += 0.75 * HEADING
    column.scene.text((column.x, column.y), name, FACT_NAME, fill=GREY, middle=False)
    least, most = FIELD
    right = column.x + column.width
    room = column.width - text_width(name, FACT_NAME) - 10
    column.scene.line(
        [(right - min(max(room, least), most), column.y + 2), (right, column.y + 2)], BLACK, 0.8
    )
    column.y += 0.62 * HEADING


def peg_rows(sheet: Sheet) -> tuple[list[str], list[list[str]], str]:
    """The table of the pegs: its header, its rows, and what the forces in it are, up to "of"."""
    force, unit, number = sheet.details.jaw_force, sheet.lengths.unit, sheet.lengths.number
    per = "N per kN" if unit.newtons == 1 else f"per {KILO:.0f} {unit.force}"
    flats = FLAT_PIN in sheet.toolkit.contacts
    header = ["Hole", "face", *["flat"] * flats, f"x {sheet.lengths.sign}", f"y {sheet.lengths.sign}", per]
    if force is not None:
        header.append(f"at {unit.force_words(force)}")
    rows = []
    for name, peg in zip(contact_names(sheet.fixture, sheet.toolkit), sheet.fixture.pegs, strict=True):
        looks = [looks_words(peg)] * flats
        row = [name, peg.touched, *looks, number(peg.x), number(peg.y), f"{KILO * peg.force:.0f}"]
        rows.append(row if force is None else [*row, unit.force_words(force * peg.force)])
    each = "kN" if unit.newtons == 1 else f"{KILO:.0f} {unit.force}"
    return header, rows, f"{per}: {unit.force} of the {pegs_words(sheet.toolkit)} on the part for each {each}"


def looks_words(peg: Peg) -> str:
    """Which way a peg's flat looks."""
    return "–" if peg.flat_deg is None else f"{peg.flat_deg:.2f}°"


def write_flats(column: TextColumn, sheet: Sheet) -> None:
    """Writes what the flats of the pegs are and how they are turned, where they have some."""
    flat = sheet.toolkit.plates[0].flat
    if flat is not None:
        column.paragraph(
            "flat: which way it looks, counter-clockwise from +x; it is "
            f"{sheet.lengths.short(flat.distance)} from the centre. Turn the peg until its flat lies on the "
            "part.",
            NOTE,
        )


def lies_words(sheet: Sheet) -> str:
    """How the part lies beside its drawing."""
    return f"turned {sheet.fixture.pose.theta_deg:.1f}° counter-clockwise from its drawing"


def inside_words(sheet: Sheet) -> str:
    """Which pegs stand in holes of the part, a sentence behind another one; nothing where none does."""
    faces = sheet.workpiece.numbered.inside
    inside = [peg.hole for peg in sheet.fixture.pegs if peg.face in faces]
    return (
        f" {listed(inside)} {'stand' if len(inside) > 1 else 'stands'} inside a hole of the part."
        if inside
        else ""
    )


def write_dowel(column: TextColumn, sheet: Sheet) -> None:
    """Writes what the pegs are, how they sit in their holes and how far they stand out, or fields for it."""
    details, lengths, carrier = sheet.details, sheet.lengths, sheet.toolkit.plates[0]
    diameter = 2 * carrier.peg_radius
    fit = details.tolerance.fit
    column.y += 3
    fact_or_field(
        column, "dowel and fit", details.dowel or (None if fit is None else fit_words(fit, diameter))
    )
    if fit is not None:
        pin, hole_limits = (
            f"{lengths.short_number(low)} to {lengths.short(high)}" for low, high in (fit.pin, fit.hole)
        )
        column.paragraph(f"Pin of {pin} in a hole of {hole_limits}.", NOTE)
    jaws = f"{carrier.noun}{'s' * (len(sheet.toolkit.plates) > 1)}"
    length, height, mark = details.peg_length, details.peg_height, ""
    known = sheet.heights
    if known is not None and "peg_top" not in known.assumed:
        length, height, mark = known.peg_length, known.above_plate, known.sure("peg_length")
    for name, size in ((f"{carrier.peg} length{mark}", length), (f"height above the {jaws}", height)):
        fact_or_field(column, name, None if size is None else lengths.words(size))
