"""The hardware that a set-up needs, counted, and the block of a setup sheet that lists it."""

from __future__ import annotations

from collections import Counter

from attrs import frozen

from workhold.drawing.panel import TextColumn
from workhold.drawing.sheet_writing import (
    BODY,
    NOTE,
    SetupSheet,
    SheetHeights,
    find_usual_dowel,
    write_heading,
)
from workhold.fixels.contacts import CLAMP_TIP, WALL_END
from workhold.fixels.toolkit import Toolkit
from workhold.model.dowel_lengths import find_shortest_dowel
from workhold.model.fixture import Fixture

__all__ = ["HardwareItem", "list_hardware", "write_hardware"]

OF_TIP = "diameter of the tip"
# Pegs that could be shorter by less than this, in mm, are left as they are.
SHORTER = 2.0


def list_sheet_hardware(sheet: SetupSheet) -> list[HardwareItem]:
    """Return the hardware of a sheet's set-up.

    The length of pegs is None if it would follow from assumed heights only.
    """
    chosen, heights, details = sheet.details.supports, sheet.heights, sheet.details
    length = details.peg_length if heights is None else heights.peg_length
    # Where the pegs' height was assumed, so would be the length, of which nothing then is known.
    if heights is not None and "peg_top" in heights.assumed and details.peg_length is None:
        length = None
    pads = top_tip = None
    if chosen is not None:
        assert heights is not None
        pads = (2 * chosen.supports.request.pad_radius, heights.supported_by)
        top_tip = 2 * chosen.supports.request.tip_radius
    return list_hardware(sheet.fixture, sheet.toolkit, length, pads, top_tip)


def write_hardware(column: TextColumn, sheet: SetupSheet) -> None:
    """Write the table of the hardware that the set-up needs, and notes on the composition of the pegs'
    lengths.
    """
    lengths, heights, details, items = sheet.lengths, sheet.heights, sheet.details, list_sheet_hardware(sheet)
    write_heading(column, "To take from the drawer")
    rows = [
        [
            f"{item.count} {item.name}",
            "–" if item.diameter is None else lengths.format_short_number(item.diameter),
            describe_length(item, sheet),
        ]
        for item in items
    ]
    column.write_table(["", f"Ø {lengths.sign}", f"length {lengths.sign}"], rows, BODY)
    if any(item.note == OF_TIP for item in items):
        column.write_paragraph("The Ø of a clamp is that of its tip.", NOTE)
    plate = sheet.toolkit.plates[0]
    if sheet.dowel:
        column.write_paragraph(f"{plate.peg.capitalize()}s: {sheet.dowel}.", NOTE)
    if heights is None or details.peg_length is not None or "peg_top" in heights.assumed:
        return
    out = [f"{lengths.format_length(heights.peg_top)} beside the part"]
    if heights.supported_by:
        out.append(
            f"{lengths.format_length(heights.supported_by)} of supports{heights.note_if_assumed('supported_by')}"
        )
    sold, least = heights.dowel, "" if heights.dowel is not None else "at least "
    deep = heights.peg_length - heights.above_plate
    out.append(f"{least}{lengths.format_length(deep)} in the {plate.noun}")
    name = f"Length of a {plate.peg}" if sold is None else f"Dowels of {sold.name}, {sold.standard}"
    column.write_paragraph(f"{name}: {' + '.join(out)}.", NOTE)
    if deep > heights.plate_thickness and "plate_thickness" not in heights.assumed:
        column.write_paragraph(
            f"They reach {lengths.format_length(deep - heights.plate_thickness)} below the {plate.noun}: leave room "
            "for that.",
            NOTE,
        )
    pressed = find_highest_press(sheet, heights)
    if pressed is not None:
        shorter = find_shortest_dowel(sheet.toolkit.peg_diameter or 0.0, pressed + heights.supported_by)
        what = "shorter ones" if shorter is None else f"dowels of {shorter.name}"
        column.write_paragraph(
            f"No {plate.peg} is pressed above {lengths.format_length(pressed)}, so {what} are long enough too.",
            NOTE,
        )


def describe_length(item: HardwareItem, sheet: SetupSheet) -> str:
    """Return the length of an item in the sheet's unit.

    If the length of pegs is unknown, the result is the name of the usual dowel, or "–" if there is none.
    """
    if item.length is not None:
        return sheet.lengths.format_number(item.length)
    heights = sheet.heights
    usual = find_usual_dowel(sheet, heights) if item.of_pegs and heights is not None else None
    return "–" if usual is None else usual.name


def find_highest_press(sheet: SetupSheet, heights: SheetHeights) -> float | None:
    """Return the greatest height in mm at which any peg presses, if pegs of that height would be enough.

    Shorter pegs press at the same places and leave more room. Returns None if they would be shorter by less
    than ``SHORTER`` or not at all, for a part that is not a solid, and for pegs that end below the part's
    top.
    """
    solid, carriers = sheet.workpiece.solid, {one.name: one for one in sheet.toolkit.carriers}
    if solid is None or heights.peg_top < solid.height or any(one.heights for one in carriers.values()):
        return None
    tops = [
        band[1] if band is not None else heights.peg_top
        for peg, band in zip(sheet.fixture.pegs, heights.bands, strict=True)
        if carriers[peg.carrier].contact is not CLAMP_TIP
    ]
    return max(tops) if tops and max(tops) < heights.peg_top - SHORTER else None


@frozen
class HardwareItem:
    """Hardware of one kind and size.

    Parameters
    ----------
    count : number of pieces.
    name : word for them, such as "locators".
    diameter : in mm; None if not round.
    length : length of pegs, or height of supports, in mm; None where it is unknown or there is none.
    note : a remark of a few words.
    of_pegs : whether they stand in holes of a plate, like dowels.
    """

    count: int
    name: str
    diameter: float | None = None
    length: float | None = None
    note: str = ""
    of_pegs: bool = False


def list_hardware(
    fixture: Fixture,
    toolkit: Toolkit,
    peg_length: float | None = None,
    supports: tuple[float, float | None] | None = None,
    top_tip: float | None = None,
) -> list[HardwareItem]:
    """Return the hardware items of a set-up, in the order in which it is put together.

    Parameters
    ----------
    peg_length : in mm; None where it is unknown.
    supports : (diameter, height) in mm of three supports, the height None where unknown; None without
        supports.
    top_tip : diameter in mm of the tip of the clamp on top; None without one.

    Examples
    --------
    >>> from workhold import Plate, Workpiece, design
    >>> part = Workpiece.from_points("bar", [(0, 0), (90, 0), (70, 40), (0, 50)])
    >>> plate = Plate(pitch=20, peg_radius=3, travel=(10, 60))
    >>> [(one.count, one.name) for one in list_hardware(design(part, plate, best=1)[0], plate)]
    [(3, 'locators'), (1, 'clamp'), (1, 'bolt for a clamp')]
    """
    items: list[HardwareItem] = []
    placed = [(toolkit.find_carrier(peg.carrier), peg) for peg in fixture.placed]
    pegs = [carrier for carrier, _ in placed if carrier.contact is not CLAMP_TIP]
    kinds = Counter((c.peg, c.peg_radius, c.flat is not None) for c in pegs)
    for (name, radius, flat), count in kinds.items():
        note = "with a flat" if flat else ""
        items.append(
            HardwareItem(count, format_count(name, count), 2 * radius or None, peg_length, note, True)
        )
    if supports is not None:
        items.append(HardwareItem(3, "supports", *supports))
    clamps = [carrier for carrier, _ in placed if carrier.contact is CLAMP_TIP]
    for (name, radius), count in Counter((c.noun, c.peg_radius) for c in clamps).items():
        items.append(HardwareItem(count, format_count(name, count), 2 * radius or None, None, OF_TIP))
    bolted = sum(all(carrier.counted_axes) for carrier in clamps)
    if bolted:
        words = f"{format_count('bolt', bolted)} for {'a clamp' if bolted == 1 else 'clamps'}"
        items.append(HardwareItem(bolted, words))
    if top_tip is not None:
        items.append(HardwareItem(1, "clamp on top", top_tip, None, OF_TIP))
    walls = (carrier for carrier in toolkit.carriers if carrier.contact is WALL_END)
    return [*items, *(HardwareItem(1, carrier.noun) for carrier in walls)]


def format_count(noun: str, count: int) -> str:
    """Return the noun, with a plural s unless the count is 1."""
    return noun if count == 1 else f"{noun}s"
