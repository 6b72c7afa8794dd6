"""The blocks of a setup sheet that tell of a plate with locators and a clamp, in place of those that tell of a vise."""

from __future__ import annotations

from math import ceil

from workhold.drawing.panel import NUMBERS, Column, clamp_place, diameter_words, holes_words
from workhold.drawing.sheet_writing import (
    BODY,
    NOTE,
    Sheet,
    fact_or_field,
    heading,
    inside_words,
    lies_words,
    listed,
    peg_rows,
    write_dowel,
    write_table,
)
from workhold.model.holes import column_letters
from workhold.model.setting import Setting, setting_of
from workhold.model.shown import shown
from workhold.model.toolkit import Carrier

__all__ = ["clamp_steps", "write_clamp", "write_locators", "write_plate"]


def mover(sheet: Sheet) -> Carrier:
    """The clamp of the fixture."""
    return sheet.toolkit.carrier(sheet.fixture.pegs[-1].carrier)


def set_on(sheet: Sheet) -> Setting:
    """What to set on the clamp."""
    setting = setting_of(sheet.fixture, sheet.toolkit)
    assert setting is not None
    return setting


def write_locators(column: Column, sheet: Sheet) -> None:
    """Write where the locators stand, and the clamp's tip."""
    plate, clamp = sheet.toolkit.carriers[0], mover(sheet)
    wall = sheet.toolkit.wall
    what = f"{plate.peg.capitalize()}s" if wall is None else f"{wall.noun.capitalize()} and {plate.peg}"
    heading(column, f"{what} {diameter_words(plate, sheet.lengths)}")
    names = [clamp.noun if peg.carrier == clamp.name else peg.hole for peg in sheet.fixture.pegs]
    header, rows, per = peg_rows(sheet, names)
    write_table(column, header, rows)
    column.paragraph(
        f"x, y: centre of the {plate.peg} or of the {clamp.noun}'s tip, from {sheet.origin_words}"
        f"{'' if sheet.origin_shown else ', which lies beside the plan'}.",
        NOTE,
    )
    if wall is not None:
        ends = list(dict.fromkeys(peg.touching for peg in sheet.fixture.pegs if peg.is_on_wall))
        lies = f"with {ends[0]}" if len(ends) == 1 else f"from {ends[0]} to {ends[1]}"
        column.paragraph(
            f"The part lies flush on the {wall.noun} {lies}. Row 1 of the {plate.noun} is "
            f"{sheet.lengths.words(plate.offset[1])} from the {wall.noun}.",
            NOTE,
        )
    column.paragraph(f"{per} of {clamp.noun} force, without friction.", NOTE)
    write_dowel(column, sheet)


def write_clamp(column: Column, sheet: Sheet) -> None:
    """Write where the clamp is bolted, which way it pushes, how far its tip is out and with what force."""
    clamp, tip, lengths, setting = mover(sheet), sheet.fixture.pegs[-1], sheet.lengths, set_on(sheet)
    label, place = clamp_place(tip, clamp)
    heading(column, f"{label} {place}")
    column.words(lengths.words(setting.length), 28, bold=True, gap=0.4)
    if clamp.has_a_hole:
        column.paragraph(f"Stroke: from the centre of hole {place} to the centre of the tip, once it touches.", NOTE)
    else:
        column.paragraph(f"{setting.title[0].upper()}{setting.title[1:]}, to its centre, once it touches.", NOTE)
    column.y += 3
    towards = sheet.toolkit.arrangement(sheet.fixture.type, sheet.fixture.direction).towards
    column.fact("pushes", f"{towards}, {str(sheet.fixture.direction).replace('-', '−')}", bold=True)
    column.fact("round tip", diameter_words(clamp, lengths), bold=True)
    if clamp.travel is not None and clamp.travel.most is not None:
        least, most = sorted((abs(clamp.travel.least), abs(clamp.travel.most)))
        column.fact("stroke it has", f"{lengths.short_number(least)} to {lengths.short(most)}")
    force, unit, loads = sheet.details.jaw_force, lengths.unit, sheet.details.loads
    fact_or_field(column, f"{clamp.noun} force", None if force is None else unit.force_words(force))
    if loads:
        needed = max(case.needed.value for case in loads)
        column.fact("the loads need at least", f"{unit.force_above(needed)} {unit.force}", bold=True)
    fact_or_field(column, "torque of its screw", None)


def clamp_steps(sheet: Sheet) -> list[str]:
    """What to do, one or two sentences each."""
    fixture, lengths, clamp, setting = sheet.fixture, sheet.lengths, mover(sheet), set_on(sheet)
    plate, tip = sheet.toolkit.carriers[0], fixture.pegs[-1]
    place = clamp_place(tip, clamp)[1]
    towards = sheet.toolkit.arrangement(fixture.type, fixture.direction).towards
    bolt = (
        f"Bolt the {clamp.noun} in {place}"
        if clamp.has_a_hole
        else f"Set the {clamp.noun} so that its tip is on {place}"
    )
    names = [peg.hole for peg in fixture.pegs[:-1] if not peg.is_on_wall]
    touch = listed([f"{peg.touching} at {peg.hole}" for peg in fixture.pegs])
    force = sheet.details.jaw_force
    with_force = "" if force is None else f" with {lengths.unit.force_words(force)}"
    what = f"Its {setting.name}" if clamp.has_a_hole else f"The {setting.title},"
    wall = sheet.toolkit.wall
    if wall is None:
        put = f"Put {plate.peg}s in {listed(names)} of the {plate.noun}."
        against = f"against all {NUMBERS[len(names)]} {plate.peg}s"
    else:
        put = (
            f"Fix the {wall.noun} along the rows, its edge {lengths.words(plate.offset[1])} from the centres of row 1, and "
            f"put the {plate.peg} in {listed(names)} of the {plate.noun}."
        )
        against = f"flush on the {wall.noun} and against the {plate.peg}"
    return [
        f"{put} {bolt}, pushing {towards}, and draw it back.",
        f"Lay the part in as drawn, {lies_words(sheet)}, {against}.{inside_words(sheet)}",
        f"Bring the {clamp.noun} up until its tip touches face {tip.face}. {what} is then "
        f"{lengths.words(setting.length)}; if not, the part lies another way.",
        f"Clamp{with_force}. They touch: {touch}. A strip of paper at each must not pull out.",
        f"Set the machine's zero, G54, from {sheet.origin} as given under part zero X0 Y0, or touch off the part there.",
    ]


def write_plate(column: Column, sheet: Sheet) -> None:
    """Write how holes are counted, and how far the whole set-up may be moved."""
    plate, lengths = sheet.toolkit.carriers[0], sheet.lengths
    heading(column, "Counting holes")
    peg, (pitch_x, pitch_y) = sheet.fixture.pegs[0], plate.pitch
    apart = (
        f"{lengths.short(pitch_x)} apart both ways"
        if pitch_x == pitch_y
        else f"{lengths.short(pitch_x)} apart along the rows and {lengths.short(pitch_y)} along the columns"
    )
    named = f"{peg.hole} is column {column_letters(peg.column)}, row {peg.row + 1}"
    wall = sheet.toolkit.wall
    below = "below" if wall is None else f"the {wall.noun}"
    column.paragraph(f"{named}: columns from left to right, rows from {below}.", BODY)
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
    # With a fence the rows are given.
    for spare, noun, way in list(known)[: 2 if sheet.toolkit.wall is None else 1]:
        if spare is None:
            ways.append(f"any {noun}s {way}")
        elif spare:
            ways.append(f"up to {spare} {noun}{'' if spare == 1 else 's'} {way}")
    if not ways:
        return f"The set-up fits the {sheet.toolkit.noun} in this place only."
    stands = f"All of it may stand {' and '.join(ways)}"
    if sheet.toolkit.wall is not None:
        return f"{stands}; places are then told from the column that takes the place of A."
    return f"{stands}; places are then told from the hole that takes the place of {sheet.origin}."


def spare_holes(sheet: Sheet) -> tuple[int | None, int | None]:
    """How many columns and rows the set-up may be moved right and up; None where the plate has no end."""
    plate, clamp, pegs = sheet.toolkit.carriers[0], mover(sheet), sheet.fixture.pegs
    in_holes = pegs if clamp.has_a_hole else pegs[:-1]
    columns = max(peg.column for peg in (in_holes if clamp.is_along_x else pegs))
    rows = max(peg.row for peg in (pegs if clamp.is_along_x else in_holes))
    return (
        None if plate.columns is None else plate.columns - 1 - columns,
        None if plate.rows is None else plate.rows - 1 - rows,
    )


def beyond_plate(sheet: Sheet) -> list[tuple[str, str, int, str]]:
    """The lower sides of a plate that the part reaches beyond as holes are named, and by how many columns or rows the set-up
    has to be moved, and can be, so that it no longer does.
    """
    plate, part = sheet.toolkit.carriers[0], shown(sheet.fixture, sheet.toolkit, sheet.workpiece).part
    sides = (("left side", "further right", part.x0, "column"), ("lower side", "further up", part.y0, "row"))
    found = []
    for (side, way, low, noun), pitch, spare in zip(sides, plate.pitch, spare_holes(sheet), strict=True):
        needed = ceil(-low / pitch - 0.5) if noun == "column" or sheet.toolkit.wall is None else 0
        if spare is not None and 0 < needed <= spare:
            found.append((side, way, needed, noun))
    return found
