"""The block of a setup sheet that lists what to take from the drawer, with sizes and counts."""

from __future__ import annotations

from workhold.drawing.panel import TextColumn
from workhold.drawing.sheet_heights import SheetHeights
from workhold.drawing.sheet_writing import BODY, NOTE, Sheet, heading
from workhold.fixels.contacts import CLAMP_TIP
from workhold.model.dowels import fit_words
from workhold.model.hardware import HardwareItem, hardware_of

__all__ = ["hardware_items", "write_hardware"]

# Pegs that could be shorter by less than this, in mm, are left as they are.
SHORTER = 2.0


def hardware_items(sheet: Sheet) -> list[HardwareItem]:
    """What the set-up of a sheet takes."""
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
    return hardware_of(sheet.fixture, sheet.toolkit, length, pads, top_tip)


def write_hardware(column: TextColumn, sheet: Sheet) -> None:
    """Writes what to take from the drawer as a table, and how the lengths come about."""
    lengths, heights, details = sheet.lengths, sheet.heights, sheet.details
    heading(column, "To take from the drawer")
    rows = [
        [
            f"{item.count} {item.name}",
            "–" if item.diameter is None else lengths.short_number(item.diameter),
            "–" if item.length is None else lengths.number(item.length),
        ]
        for item in hardware_items(sheet)
    ]
    column.table(["", f"Ø {lengths.sign}", f"length {lengths.sign}"], rows, BODY)
    if any(item.note.startswith("diameter of the tip") for item in hardware_items(sheet)):
        column.paragraph("Ø of a clamp: that of its tip.", NOTE)
    fit, plate = details.tolerance.fit, sheet.toolkit.plates[0]
    kind = details.dowel or (None if fit is None else fit_words(fit, 2 * plate.peg_radius))
    if kind:
        column.paragraph(f"{plate.peg.capitalize()}s: {kind}.", NOTE)
    if heights is None or details.peg_length is not None or "peg_top" in heights.assumed:
        return
    parts = [f"{lengths.words(heights.peg_top)} beside the part"]
    if heights.supported_by:
        parts.append(f"{lengths.words(heights.supported_by)} of supports{heights.sure('supported_by')}")
    parts.append(
        f"{lengths.words(heights.plate_thickness)} in the {plate.noun}{heights.sure('plate_thickness')}"
    )
    column.paragraph(f"Length of a {plate.peg}: {' + '.join(parts)}.", NOTE)
    pressed = pressed_up_to(sheet, heights)
    if pressed is not None:
        shorter = lengths.words(pressed + heights.supported_by + heights.plate_thickness)
        words = f"No {plate.peg} presses above {lengths.words(pressed)}"
        column.paragraph(f"{words}, so {plate.peg}s of {shorter} do as well.", NOTE)


def pressed_up_to(sheet: Sheet, heights: SheetHeights) -> float | None:
    """The height in mm above which no peg presses, where pegs are as high as the part and need not be.

    Shorter pegs press on all that they did, and stand in the way of less.
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
