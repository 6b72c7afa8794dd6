"""The blocks of a setup sheet that tell of a plate with locators and clamps, in place of those that tell of a vise."""

from __future__ import annotations

from functools import partial
from math import ceil

from workhold.drawing.panel import NUMBERS, Column, diameter_words, holes_words
from workhold.drawing.sheet_pegs import put_words, touch_words
from workhold.drawing.sheet_writing import (
    BODY,
    NOTE,
    MovingBlocks,
    Sheet,
    Writer,
    fact_or_field,
    heading,
    inside_words,
    lies_words,
)
from workhold.model.holes import column_letters
from workhold.model.setting import Setting
from workhold.model.shown import shown
from workhold.model.tightening import clamp_names, clamp_shares, freedom_words, order_words, second_over_first
from workhold.plain import listed

__all__ = ["CLAMPS"]


def clamp_writers(sheet: Sheet) -> list[Writer]:
    """The blocks about the clamp, or about each of two and the order in which they are tightened."""
    shares = clamp_shares(sheet.fixture)
    each: list[Writer] = [
        partial(write_clamp, setting=one, share=share) for one, share in zip(sheet.settings, shares, strict=True)
    ]
    return each if sheet.is_closed_at_once else [*each, write_order]


def write_clamp(column: Column, sheet: Sheet, setting: Setting, share: float) -> None:
    """Write where a clamp is bolted, which way it pushes, how far its tip is out and with what share of the force."""
    clamp, lengths = setting.carrier, sheet.lengths
    heading(column, f"{setting.label} {setting.place}")
    column.words(lengths.words(setting.length), 28 if sheet.is_closed_at_once else 22, bold=True, gap=0.4)
    how = setting.mounting.how.format(place=setting.place, title=setting.caption)
    column.paragraph(f"{how}, once it touches.", NOTE)
    column.y += 3
    direction = clamp.direction.replace("-", "−")
    column.fact("pushes", f"{clamp.towards}, {direction}", bold=True)
    column.fact("round tip", diameter_words(clamp, lengths), bold=True)
    if clamp.travel is not None and clamp.travel.most is not None:
        least, most = sorted((abs(clamp.travel.least), abs(clamp.travel.most)))
        column.fact("stroke it has", f"{lengths.short_number(least)} to {lengths.short(most)}")
    force, unit = sheet.details.jaw_force, lengths.unit
    fact_or_field(column, f"{clamp.noun} force", None if force is None else unit.force_words(share * force))
    if sheet.details.loads:
        needed = share * needed_force(sheet)
        column.fact("the loads need at least", f"{unit.force_above(needed)} {unit.force}", bold=True)
    fact_or_field(column, "torque of its screw", None)


def needed_force(sheet: Sheet) -> float:
    """The clamp force, of two clamps added up, that the loads need, in N."""
    return max(case.needed.value for case in sheet.details.loads)


def write_order(column: Column, sheet: Sheet) -> None:
    """Write in which order two clamps are tightened, and in which ratio."""
    fixture, (first, second) = sheet.fixture, clamp_names(sheet.fixture)
    heading(column, "Order of tightening")
    column.paragraph(order_words(fixture), BODY, bold=True)
    ratio = second_over_first(fixture)
    freedom = fixture.quality["clamp_freedom"]
    column.fact("clamp freedom, of 90°", f"{freedom:.1f}°", bold=True)
    column.paragraph(
        f"{freedom_words(freedom).capitalize()}. Forces here are told for {second} with {ratio:.2f} times the force of "
        f"{first}, the middle of what holds.",
        NOTE,
    )


def clamp_steps(sheet: Sheet) -> list[str]:
    """What to do, one or two sentences each."""
    toolkit, lengths, alone = sheet.toolkit, sheet.lengths, sheet.is_closed_at_once
    plate, noun = toolkit.plates[0], toolkit.moving.noun
    bolts, ups = [], []
    for setting, tip in zip(sheet.settings, sheet.fixture.pegs[-len(sheet.settings) :], strict=True):
        put = setting.mounting.put.format(clamp=f"{'the' if alone else 'a'} {noun}", place=setting.place)
        bolts.append(f"{put}, pushing {setting.carrier.towards}, and draw it back.")
        one = f"the {noun}" if alone else tip.hole
        what = setting.mounting.then.format(name=setting.name, title=setting.title)
        ups.append(
            f"Bring {one} up until its tip touches face {tip.face}. {what} is then {lengths.words(setting.length)}"
            f"{'; if not, the part lies another way.' if alone else '.'}"
        )
    if not alone:
        ups.append("If a length is not as told, the part lies another way.")
    count = sum(peg.carrier == plate.name for peg in sheet.fixture.pegs)
    against = toolkit.setup_words.against.format(count=NUMBERS[count], peg=plate.peg)
    return [
        f"{put_words(sheet)} {' '.join(bolts)}",
        f"Lay the part in as drawn, {lies_words(sheet)}, {against}.{inside_words(sheet)}",
        " ".join(ups),
        f"{clamping_words(sheet)} They touch: {touch_words(sheet)}",
    ]


def clamping_words(sheet: Sheet) -> str:
    """How to clamp, and with what force where that is known."""
    fixture, force, unit = sheet.fixture, sheet.details.jaw_force, sheet.lengths.unit
    if sheet.is_closed_at_once:
        return f"Clamp{'' if force is None else f' with {unit.force_words(force)}'}."
    if force is None:
        return order_words(fixture)
    shares = zip(clamp_names(fixture), clamp_shares(fixture), strict=True)
    each = [f"{unit.force_words(share * force)} at {name}" for name, share in shares]
    return f"{order_words(fixture)} {listed(each)} make the {unit.force_words(force)} given."


def write_plate(column: Column, sheet: Sheet) -> None:
    """Write how holes are counted, and how far the whole set-up may be moved."""
    plate, lengths = sheet.toolkit.plates[0], sheet.lengths
    heading(column, "Counting holes")
    peg, (pitch_x, pitch_y) = sheet.fixture.pegs[0], plate.pitch
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


CLAMPS = MovingBlocks(clamp_writers, clamp_steps, write_plate)
