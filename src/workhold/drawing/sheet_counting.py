"""What a setup sheet says of holes: how they are counted, and how far the whole set-up may be moved along them."""

from __future__ import annotations

from math import ceil

from workhold.drawing.panel import Column, holes_words, offset_words
from workhold.drawing.sheet_writing import BODY, Sheet, heading
from workhold.fixels.holes import column_letters
from workhold.model.shown import shown

__all__ = ["write_counting"]


def write_counting(column: Column, sheet: Sheet) -> None:
    """Write how holes are counted."""
    heading(column, "Counting holes")
    several = len(sheet.toolkit.plates) > 1
    (write_jaws if several else write_plate)(column, sheet)


def write_jaws(column: Column, sheet: Sheet) -> None:
    """Write how the holes of two plates are counted."""
    lengths, first, moving = sheet.lengths, sheet.toolkit.plates[0], sheet.toolkit.moving
    pitch_x, pitch_y = (lengths.short(pitch) for pitch in first.pitch)
    peg = sheet.fixture.pegs[0]
    size, where = f"one column of holes, {pitch_y} apart", f"A on both {first.noun}s"
    if first.column_count > 1:
        size = f"{first.column_count} columns of holes, {pitch_x} apart; the rows are {pitch_y} apart"
        where = f"A to {column_letters(first.column_count - 1)} from left to right, on each {first.noun}"
    example = f"{peg.hole} is the {first.title}'s column {column_letters(peg.column)}, row {peg.row + 1}"
    column.paragraph(f"{example}. Each {first.noun} has {size}.", BODY)
    rows = f"Row 1 is the lowest; any row of the vise will do, the same for both {first.noun}s."
    if first.rows is not None:
        rows = f"Row 1 is the lowest of {first.rows}."
    column.paragraph(f"Columns: {where}. {rows}", BODY)
    if offset := offset_words(sheet.toolkit, lengths):
        column.paragraph(f"Row 1 of the {moving.title} lies {offset} that of the {first.name}.", BODY)


def write_plate(column: Column, sheet: Sheet) -> None:
    """Write how the holes of the only plate are counted, and how far the whole set-up may be moved."""
    plate, lengths = sheet.toolkit.plates[0], sheet.lengths
    peg = next(peg for peg in sheet.fixture.pegs if peg.carrier == plate.name)
    pitch_x, pitch_y = plate.pitch
    apart = (
        f"{lengths.short(pitch_x)} apart both ways"
        if pitch_x == pitch_y
        else f"{lengths.short(pitch_x)} apart along the rows and {lengths.short(pitch_y)} along the columns"
    )
    named = f"{peg.hole} is column {column_letters(peg.column)}, row {peg.row + 1}"
    column.paragraph(f"{named}: columns from left to right, rows from {sheet.datum.rows_from}.", BODY)
    size = "" if plate.columns is None and plate.rows is None else f", {holes_words(plate)}"
    column.paragraph(f"The holes of the {plate.noun} are {apart}{size}.", BODY)
    column.paragraph(moving_words(sheet), BODY)
    for side, way, count, noun in beyond_plate(sheet):
        by = f"{count} {noun}{'' if count == 1 else 's'}"
        column.paragraph(
            f"As named, the part reaches beyond the {side} of the {plate.noun}; {by} {way} it does not.", BODY
        )


def moving_words(sheet: Sheet) -> str:
    """How far all of the set-up may be moved along the holes of the plate."""
    ways = []
    known = zip(spare_holes(sheet), ("column", "row"), ("further right", "further up"), strict=True)
    for spare, noun, way in list(known)[: 1 if sheet.datum.fixes_rows else 2]:
        if spare is None:
            ways.append(f"any {noun}s {way}")
        elif spare:
            ways.append(f"up to {spare} {noun}{'' if spare == 1 else 's'} {way}")
    if not ways:
        return f"The set-up fits the {sheet.toolkit.noun} in this place only."
    return f"All of it may stand {' and '.join(ways)}; places are then told from {sheet.datum.substitute}."


def spare_holes(sheet: Sheet) -> tuple[int | None, int | None]:
    """How many columns and rows the set-up may be moved right and up; None where the plate has no end."""
    plate, toolkit = sheet.toolkit.plates[0], sheet.toolkit
    counted = [(peg, toolkit.carrier(peg.carrier).counted) for peg in sheet.fixture.pegs]
    columns = max(peg.column for peg, (in_column, _) in counted if in_column)
    rows = max(peg.row for peg, (_, in_row) in counted if in_row)
    return (
        None if plate.columns is None else plate.columns - 1 - columns,
        None if plate.rows is None else plate.rows - 1 - rows,
    )


def beyond_plate(sheet: Sheet) -> list[tuple[str, str, int, str]]:
    """The lower sides of a plate that the part reaches beyond as holes are named, and by how many columns or rows the set-up
    has to be moved, and can be, so that it no longer does.
    """
    plate, part = sheet.toolkit.plates[0], shown(sheet.fixture, sheet.toolkit, sheet.workpiece).part
    sides = (("left side", "further right", part.x0, "column"), ("lower side", "further up", part.y0, "row"))
    found = []
    for (side, way, low, noun), pitch, spare in zip(sides, plate.pitch, spare_holes(sheet), strict=True):
        needed = 0 if noun == "row" and sheet.datum.fixes_rows else ceil(-low / pitch - 0.5)
        if spare is not None and 0 < needed <= spare:
            found.append((side, way, needed, noun))
    return found
