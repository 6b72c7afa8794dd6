"""The blocks of a setup sheet that tell of a plate with locators and clamps, in place of those that tell of a vise."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
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
    peg_rows,
    write_dowel,
    write_flats,
)
from workhold.model.fixture import Pair
from workhold.model.holes import column_letters
from workhold.model.setting import Setting, settings_of
from workhold.model.shown import shown
from workhold.model.tightening import clamp_names, clamp_shares, freedom_words, order_words
from workhold.model.units import Unit
from workhold.plain import listed

__all__ = ["clamp_steps", "clamp_writers", "write_locators", "write_plate"]


def clamps_of(sheet: Sheet) -> tuple[Setting, ...]:
    """What to set on each clamp."""
    return settings_of(sheet.fixture, sheet.toolkit)


def write_locators(column: Column, sheet: Sheet) -> None:
    """Write where the locators stand, and the clamps' tips."""
    plate, noun, wall = sheet.toolkit.carriers[0], sheet.toolkit.moving.noun, sheet.toolkit.wall
    what = f"{plate.peg.capitalize()}s" if wall is None else f"{wall.noun.capitalize()} and {plate.peg}"
    heading(column, f"{what} {diameter_words(plate, sheet.lengths)}")
    several = sheet.fixture.pair is not None
    clamps = {setting.carrier.name for setting in clamps_of(sheet)}
    names = [noun if peg.carrier in clamps and not several else peg.hole for peg in sheet.fixture.pegs]
    header, rows, per = peg_rows(sheet, names)
    column.table(header, rows, BODY)
    column.paragraph(
        f"x, y: centre of the {plate.peg} or of {'a' if several else 'the'} {noun}'s tip, from {sheet.origin_words}"
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
    of = f"{noun} force" if not several else f"{noun} force, both {noun}s added up, in the ratio told below"
    column.paragraph(f"{per} of {of}, without friction.", NOTE)
    write_flats(column, sheet)
    write_dowel(column, sheet)


def clamp_writers(sheet: Sheet) -> list[Callable[[Column, Sheet], None]]:
    """The blocks about the clamp, or about each of two and the order in which they are tightened."""
    settings = clamps_of(sheet)
    if sheet.fixture.pair is None:
        return [partial(write_clamp, setting=settings[0], share=1.0)]
    shares = clamp_shares(sheet.fixture.pair)
    each = [partial(write_clamp, setting=one, share=share) for one, share in zip(settings, shares, strict=True)]
    return [*each, write_order]


def write_clamp(column: Column, sheet: Sheet, setting: Setting, share: float) -> None:
    """Write where a clamp is bolted, which way it pushes, how far its tip is out and with what share of the force."""
    clamp, lengths, alone = setting.carrier, sheet.lengths, sheet.fixture.pair is None
    assert setting.tip is not None
    label, place = clamp_place(setting.tip, clamp)
    heading(column, f"{label} {place}")
    column.words(lengths.words(setting.length), 28 if alone else 22, bold=True, gap=0.4)
    if clamp.has_a_hole:
        column.paragraph(f"Stroke: from the centre of hole {place} to the centre of the tip, once it touches.", NOTE)
    else:
        column.paragraph(f"{setting.title[0].upper()}{setting.title[1:]}, to its centre, once it touches.", NOTE)
    column.y += 3
    direction = clamp.name.rpartition(" ")[2].replace("-", "−")
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
    assert fixture.pair is not None
    heading(column, "Order of tightening")
    column.paragraph(order_words(fixture), BODY, bold=True)
    ratio = fixture.pair.working_ratio
    freedom = fixture.quality["clamp_freedom"]
    column.fact("clamp freedom, of 90°", f"{freedom:.1f}°", bold=True)
    column.paragraph(
        f"{freedom_words(freedom).capitalize()}. Forces here are told for {second} with {ratio:.2f} times the force of "
        f"{first}, the middle of what holds.",
        NOTE,
    )


def clamp_steps(sheet: Sheet) -> list[str]:
    """What to do, one or two sentences each."""
    fixture, lengths, settings = sheet.fixture, sheet.lengths, clamps_of(sheet)
    plate, noun, several = sheet.toolkit.carriers[0], sheet.toolkit.moving.noun, fixture.pair is not None
    names = [peg.hole for peg in fixture.pegs if peg.carrier == plate.name]
    touch = listed([f"{peg.touching} at {peg.hole}" for peg in fixture.pegs])
    bolts, ups = [], []
    for setting in settings:
        clamp, tip = setting.carrier, setting.tip
        assert tip is not None
        called, place = f"{'a' if several else 'the'} {noun}", clamp_place(tip, clamp)[1]
        bolt = f"Bolt {called} in {place}" if clamp.has_a_hole else f"Set {called} so that its tip is on {place}"
        bolts.append(f"{bolt}, pushing {clamp.towards}, and draw it back.")
        one = tip.hole if several else f"the {noun}"
        what = f"Its {setting.name}" if clamp.has_a_hole else f"The {setting.title},"
        ups.append(
            f"Bring {one} up until its tip touches face {tip.face}. {what} is then {lengths.words(setting.length)}"
            f"{'.' if several else '; if not, the part lies another way.'}"
        )
    if several:
        ups.append("If a length is not as told, the part lies another way.")
    wall, force, unit = sheet.toolkit.wall, sheet.details.jaw_force, lengths.unit
    if wall is None:
        put = f"Put {plate.peg}s in {listed(names)} of the {plate.noun}."
        against = f"against all {NUMBERS[len(names)]} {plate.peg}s"
    else:
        put = (
            f"Fix the {wall.noun} along the rows, its edge {lengths.words(plate.offset[1])} from the centres of row 1, and "
            f"put the {plate.peg} in {listed(names)} of the {plate.noun}."
        )
        against = f"flush on the {wall.noun} and against the {plate.peg}"
    clamping = f"Clamp{'' if force is None else f' with {unit.force_words(force)}'}."
    if fixture.pair is not None:
        forces = "" if force is None else " " + listed_forces(fixture.pair, clamp_names(fixture), force, unit)
        clamping = f"{order_words(fixture)}{forces}"
    return [
        f"{put} {' '.join(bolts)}",
        f"Lay the part in as drawn, {lies_words(sheet)}, {against}.{inside_words(sheet)}",
        " ".join(ups),
        f"{clamping} They touch: {touch}. A strip of paper at each must not pull out.",
        f"Set the machine's zero, G54, from {sheet.origin} as given under part zero X0 Y0, or touch off the part there.",
    ]


def listed_forces(pair: Pair, names: tuple[str, ...], force: float, unit: Unit) -> str:
    """What force each of two clamps gets, as a sentence."""
    each = [
        f"{unit.force_words(share * force)} at {name}" for name, share in zip(names, clamp_shares(pair), strict=True)
    ]
    return f"{listed(each)} make the {unit.force_words(force)} given."


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
    plate, toolkit = sheet.toolkit.carriers[0], sheet.toolkit
    standing = [(peg, toolkit.carrier(peg.carrier)) for peg in sheet.fixture.pegs]
    columns = max(peg.column for peg, carrier in standing if carrier.has_a_hole or not carrier.is_along_x)
    rows = max(peg.row for peg, carrier in standing if carrier.has_a_hole or carrier.is_along_x)
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
