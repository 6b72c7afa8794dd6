"""Tools to write the blocks of a setup sheet: its data with its heights, headings, tables, fields to fill in.

Heights are those of part, pegs, supports and plates; a sheet marks those that are assumed.

Glossary
--------
lying plane : the plane on which the part lies, z = 0: the supports' upper side, or that of the plates.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Callable
from functools import lru_cache

from attrs import field, frozen

from workhold.conventions import DOWEL_DEPTH, DOWEL_STANDOUT, SAME_HEIGHT
from workhold.drawing.panel import FACT_NAME, TextColumn, name_pegs
from workhold.drawing.scene import BLACK, GREY, LengthUnit, Scene, measure_text
from workhold.drawing.seating_words import SeatingSentences
from workhold.drawing.sheet_facts import Caution, SheetDetails, find_part_lift
from workhold.errors import InputError, join_words
from workhold.fixels.contacts import FLAT_PIN
from workhold.fixels.setup_words import Datum
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.segment import Point
from workhold.model.bodies import THICKNESS
from workhold.model.dowel_lengths import SoldDowel, find_shortest_dowel, list_standouts
from workhold.model.dowels import describe_fit
from workhold.model.fixture import Fixture
from workhold.model.own_outlines import number_solid
from workhold.model.setup import (
    LengthSetting,
    PartZero,
    choose_part_zero,
    list_length_settings,
    name_contacts,
)
from workhold.model.solid import Band
from workhold.model.support_bodies import find_support_height
from workhold.model.support_request import find_pressed_heights
from workhold.model.support_triples import ChosenSupports
from workhold.model.workpiece import Workpiece

__all__ = [
    "BODY",
    "NOTE",
    "Block",
    "MovingBlocks",
    "SetupSheet",
    "SheetHeights",
    "Writer",
    "write_fact_or_field",
    "write_heading",
    "measure_block_height",
    "find_sheet_heights",
    "describe_pegs_in_holes",
    "describe_lie",
    "make_peg_rows",
    "find_usual_dowel",
    "write_dowel",
    "write_flats",
]

BODY, NOTE, HEADING = 12.5, 11.0, 14.0
KILO = 1000.0
# Least and largest width of a field to fill in, page units.
FIELD = 60.0, 150.0

Block = Callable[[TextColumn], None]


@frozen
class SheetHeights:
    """Heights of a set-up in mm, z upward from the plane on which the part lies.

    Parameters
    ----------
    thickness : of the part.
    peg_top : height of the pegs' upper ends.
    head_room : height kept free above the pegs; None for a part that is not a solid.
    supported_by : height of the supports, 0 without them.
    plate_thickness : of the plates through which pegs stand.
    peg_length : of the pegs.
    bands : for each peg the heights (low, high) at which it presses; None if they are unknown.
    assumed : names of the fields above whose values were not given, but assumed.
    clamped_height : of the face on which the clamp on top presses; None without one.
    dowel : if no peg length was given, a dowel on sale that stands out far enough; None if there is none.
    """

    thickness: float
    peg_top: float
    head_room: float | None
    supported_by: float
    plate_thickness: float
    peg_length: float
    bands: tuple[Band | None, ...]
    assumed: frozenset[str] = field(default=frozenset())
    clamped_height: float | None = None
    dowel: SoldDowel | None = None

    @property
    def above_plate(self) -> float:
        """The height in mm of the pegs above the plates."""
        return self.peg_top + self.supported_by

    @property
    def known_up_to(self) -> float:
        """The height in mm up to which the part's outline is known."""
        top = self.thickness if self.head_room is None else self.peg_top + self.head_room
        return min(top, self.thickness)

    def note_if_assumed(self, name: str) -> str:
        """Return " (assumed)" if the height with this field name was not given; otherwise ""."""
        return " (assumed)" if name in self.assumed else ""


def find_sheet_heights(
    fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit, details: SheetDetails
) -> SheetHeights | None:
    """Return the heights of a set-up; None where the part's thickness is not known.

    Raises
    ------
    InputError
        For pegs that end below the part.
    """
    solid, supports = workpiece.solid, details.supports
    thickness = details.thickness
    if thickness is None and supports is not None:
        thickness = supports.supports.request.thickness
    if thickness is None and solid is not None:
        thickness = solid.height
    if thickness is None:
        return None
    lift = find_part_lift(supports, details.support_height)
    plate = THICKNESS if details.plate_thickness is None else details.plate_thickness
    if details.peg_height is not None:
        top = details.peg_height - lift
    else:
        top = thickness if solid is None else min(solid.peg_height, thickness)
    if top <= 0:
        raise InputError(
            f"pegs {details.peg_height:g} mm high end below the part, which lies {lift:g} mm above the "
            "plates: give a larger peg height, or lower supports."
        )
    diameter, length = toolkit.peg_diameter or 0.0, details.peg_length
    dowel = None if length is not None else find_shortest_dowel(diameter, top + lift)
    if length is None:
        # A peg that is not sold is made as long as it must be to sit as deep as one that is.
        deep = DOWEL_DEPTH * diameter or plate
        length = top + lift + deep if dowel is None else dowel.length
    is_assumed = {
        "supported_by": supports is not None
        and details.support_height is None
        and find_support_height(toolkit) is None,
        "plate_thickness": details.plate_thickness is None,
        "peg_top": details.peg_height is None and solid is None,
        "peg_length": details.peg_length is None and dowel is None,
    }
    return SheetHeights(
        thickness=thickness,
        peg_top=top,
        head_room=None if solid is None else solid.head_room,
        supported_by=lift,
        plate_thickness=plate,
        peg_length=length,
        bands=find_peg_bands(fixture, workpiece, details, thickness, top),
        assumed=frozenset(name for name, is_so in is_assumed.items() if is_so),
        clamped_height=find_clamped_height(supports, thickness),
        dowel=dowel,
    )


def find_clamped_height(supports: ChosenSupports | None, thickness: float) -> float | None:
    """Return the height in mm of the face on which the clamp on top presses; None without supports."""
    if supports is None:
        return None
    request = supports.supports.request
    asked = request.find_clamped_height(supports.clamp.at)
    return thickness if asked == request.thickness else min(asked, thickness)


def find_peg_bands(
    fixture: Fixture, workpiece: Workpiece, details: SheetDetails, thickness: float, top: float
) -> tuple[Band | None, ...]:
    """Return for each peg the heights (low, high) in mm at which it may press; None for a peg where they are
    unknown.

    With supports they are those in the request for supports; without supports, those of the solid; without a
    solid, those of a prism. No height is above ``top``, the pegs' top.
    """
    supports, solid = details.supports, number_solid(workpiece)
    if supports is not None:
        request, reach = supports.supports.request, supports.supports.query.peg_height
        given = request.adapt_to_fixture(fixture, solid, reach, workpiece.numbered).list_peg_bands(
            len(fixture.pegs)
        )
        bands: list[Band | None] = [(float(low), float(high)) for low, high in given]
    elif solid is not None:
        bands = [find_pressed_heights(peg, fixture, workpiece.numbered) for peg in fixture.pegs]
    else:
        bands = [(0.0, thickness)] * len(fixture.pegs)
    return tuple(band and (min(band[0], top), min(band[1], top, thickness)) for band in bands)


@frozen
class SetupSheet:
    """The data of a setup sheet.

    Parameters
    ----------
    fixture, workpiece, toolkit : the fixture of the sheet, with its part and toolkit.
    details : data that do not follow from these.
    lengths : format of lengths.
    cautions : cautions on the sheet.
    edge_distances : distance in mm of each contact from the nearest edge; inf if there is none.
    heights : heights of the set-up; None if the part's thickness is unknown.
    zero_shown, origin_shown : whether part zero, and the origin of places, are on the plan.
    """

    fixture: Fixture
    workpiece: Workpiece
    toolkit: Toolkit
    details: SheetDetails
    lengths: LengthUnit
    cautions: tuple[Caution, ...]
    edge_distances: tuple[float, ...]
    heights: SheetHeights | None = None
    zero_shown: bool = True
    origin_shown: bool = True

    @property
    def name(self) -> str:
        """The part's name on the sheet."""
        return self.details.part_name or self.workpiece.name

    @property
    def zero(self) -> PartZero:
        """The part zero that the machinist sets."""
        return self.details.zero or choose_part_zero(self.workpiece)

    @property
    def zero_place(self) -> Point:
        """Part zero in the vise frame, in mm."""
        return self.fixture.pose.apply(*self.zero.point)

    @property
    def seating(self) -> SeatingSentences | None:
        """The sentences on other places in which the pegs can hold the part; None if the sheet does not show
        them.
        """
        if self.details.seating is None:
            return None
        return SeatingSentences(self.details.seating, self.fixture, self.toolkit, self.lengths)

    @property
    def datum(self) -> Datum:
        """The point and the lines from which places are measured."""
        return self.toolkit.datum

    @property
    def plates_noun(self) -> str:
        """The noun of the pegs' carriers, such as "plate" or "jaws"."""
        first, *others = self.toolkit.plates
        return f"{first.noun}s" if others else first.noun

    @property
    def dowel(self) -> str | None:
        """The pegs and their fit, in words; None if unknown."""
        fit, diameter = self.details.tolerance.fit, 2 * self.toolkit.plates[0].peg_radius
        return self.details.dowel or (None if fit is None else describe_fit(fit, diameter))

    @property
    def is_closed_at_once(self) -> bool:
        """Whether a single length is set and tightened; False with two clamps that are tightened one after
        the other.
        """
        return len(self.fixture.travels) == 1

    @property
    def settings(self) -> tuple[LengthSetting, ...]:
        return list_length_settings(self.fixture, self.toolkit)


Writer = Callable[[TextColumn, SetupSheet], None]


@frozen
class MovingBlocks:
    """The blocks and steps of a sheet about the carriers that move.

    Parameters
    ----------
    settings : returns the functions that write the blocks about the lengths to set.
    steps : returns the steps of setting up, one or two sentences each, up to the setting of the machine's
        zero.
    """

    settings: Callable[[SetupSheet], list[Writer]]
    steps: Callable[[SetupSheet], list[str]]


# A layout asks for each block in each width many times; a sheet has some hundred of these.
@lru_cache(maxsize=256)
def measure_block_height(block: Block, width: float) -> float:
    """Return the height of a block in a column of this width, both in page units."""
    column = TextColumn(Scene(ET.Element("g")), 0.0, 0.0, width)
    block(column)
    return column.y


def write_heading(column: TextColumn, words: str) -> None:
    """Draw a rule and write the heading of a block below it."""
    column.draw_rule(1.4)
    column.write_line(words, HEADING, bold=True, gap=0.65)


def write_fact_or_field(column: TextColumn, name: str, value: str | None) -> None:
    """Write a name with its value; if the value is None, with a line to write it on by hand."""
    if value is not None:
        column.write_fact(name, value, bold=True)
        return
    column.y += 0.75 * HEADING
    column.scene.add_text((column.x, column.y), name, FACT_NAME, fill=GREY, middle=False)
    least, most = FIELD
    right = column.x + column.width
    room = column.width - measure_text(name, FACT_NAME) - 10
    column.scene.add_line(
        [(right - min(max(room, least), most), column.y + 2), (right, column.y + 2)], BLACK, 0.8
    )
    column.y += 0.62 * HEADING


def make_peg_rows(sheet: SetupSheet) -> tuple[list[str], list[list[str]], str]:
    """Return (header, rows, clause) of the table of the pegs.

    The clause explains the forces, such as "N per kN: N of the pegs on the part for each kN"; the caller
    continues it with "of" and the force that is meant.
    """
    force, unit, number = sheet.details.jaw_force, sheet.lengths.unit, sheet.lengths.format_number
    per = "N per kN" if unit.newtons == 1 else f"per {KILO:.0f} {unit.force}"
    flats = FLAT_PIN in sheet.toolkit.contacts
    header = ["Hole", "face", *["flat"] * flats, f"x {sheet.lengths.sign}", f"y {sheet.lengths.sign}", per]
    if force is not None:
        header.append(f"at {unit.format_force_alone(force)}")
    rows = []
    for name, peg in zip(name_contacts(sheet.fixture, sheet.toolkit), sheet.fixture.pegs, strict=True):
        looks = "–" if peg.flat_deg is None else f"{peg.flat_deg:.2f}°"
        row = [name, peg.touched, *[looks] * flats, number(peg.x), number(peg.y), f"{KILO * peg.force:.0f}"]
        rows.append(row if force is None else [*row, unit.format_force_alone(force * peg.force)])
    each = "kN" if unit.newtons == 1 else f"{KILO:.0f} {unit.force}"
    return header, rows, f"{per}: {unit.force} of the {name_pegs(sheet.toolkit)} on the part for each {each}"


def write_flats(column: TextColumn, sheet: SetupSheet) -> None:
    """Write the meaning of the table's flat angles; nothing if no peg has a flat."""
    flat = sheet.toolkit.plates[0].flat
    if flat is not None:
        column.write_paragraph(
            "flat: which way it looks, counter-clockwise from +x; it is "
            f"{sheet.lengths.format_short(flat.distance)} from the centre. Turn the peg until its flat lies on the "
            "part.",
            NOTE,
        )


def describe_lie(sheet: SetupSheet) -> str:
    """Return a phrase with the angle by which the part is turned from its drawing."""
    turn = f"{sheet.fixture.pose.written_deg:z.1f}"
    way = "clockwise" if turn.startswith("-") else "counter-clockwise"
    return f"turned {turn.removeprefix('-')}° {way} from its drawing" if float(turn) else "not turned"


def describe_pegs_in_holes(sheet: SetupSheet) -> str:
    """Return a sentence, with a leading space, on the pegs that stand in holes of the part; "" if there are
    none.
    """
    faces = sheet.workpiece.numbered.inside
    inside = [peg.hole for peg in sheet.fixture.pegs if peg.face in faces]
    return (
        f" {join_words(inside)} {'stand' if len(inside) > 1 else 'stands'} inside a hole of the part."
        if inside
        else ""
    )


def write_dowel(column: TextColumn, sheet: SetupSheet) -> None:
    """Write kind, fit, length and height above the plates of the pegs; unknown values get a line to write on."""
    details, lengths, fit = sheet.details, sheet.lengths, sheet.details.tolerance.fit
    column.y += 3
    write_fact_or_field(column, "dowel and fit", sheet.dowel)
    if fit is not None:
        pin, hole_limits = (
            f"{lengths.format_short_number(low)} to {lengths.format_short(high)}"
            for low, high in (fit.pin, fit.hole)
        )
        column.write_paragraph(f"Pin of {pin} in a hole of {hole_limits}.", NOTE)
    known, peg, above = sheet.heights, sheet.toolkit.plates[0].peg, f"height above the {sheet.plates_noun}"
    if known is None or "peg_top" in known.assumed:
        for name, size in ((f"{peg} length", details.peg_length), (above, details.peg_height)):
            write_fact_or_field(column, name, None if size is None else lengths.format_length(size))
        usual = None if known is None else find_usual_dowel(sheet, known)
        if usual is not None:
            words = (
                f"Dowels of {usual.name} would do: they stand out {lengths.format_length(usual.standout)}."
            )
            column.write_paragraph(words, NOTE)
        return
    if known.dowel is not None:
        noun = sheet.toolkit.plates[0].noun
        column.write_fact(f"{peg}s: dowels of", known.dowel.name, bold=True)
        column.write_fact(f"each sits in the {noun}", lengths.format_length(known.dowel.depth), bold=True)
    else:
        at_least = " at least" if "peg_length" in known.assumed else ""
        column.write_fact(f"{peg} length{at_least}", lengths.format_length(known.peg_length), bold=True)
    column.write_fact(above, lengths.format_length(known.above_plate), bold=True)


def find_usual_dowel(sheet: SetupSheet, heights: SheetHeights) -> SoldDowel | None:
    """Return the shortest dowel on sale that stands out of the plates as far as usual.

    Its top must not be above ``heights.peg_top``. Returns None if no dowel on sale fits.
    """
    diameter = sheet.toolkit.peg_diameter or 0.0
    usual = min(DOWEL_STANDOUT * diameter, heights.peg_top) + SAME_HEIGHT
    low = [one for one in list_standouts(diameter) if one <= usual]
    return find_shortest_dowel(diameter, max(low)) if low else None
