"""The blocks of a setup sheet for what is set: pegs, moving jaws or clamps, and how holes are counted.

The block of the pegs says where each stands and which face it touches. Two jaws have a block about their
opening and how to measure it. A plate with locators and clamps has blocks about the clamps instead. The block
about counting holes also says how far the whole set-up may be moved along them.
"""

from __future__ import annotations

from functools import partial

from workhold.drawing.panel import (
    NUMBERS,
    TextColumn,
    diameter_words,
    holes_words,
    moved_words,
    offset_words,
    plural,
)
from workhold.drawing.sheet_facts import caliper_check
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
    peg_rows,
    write_dowel,
    write_flats,
)
from workhold.errors import listed
from workhold.fixels.carrier import Carrier, column_letters, hole_name
from workhold.fixels.contacts import WALL_END
from workhold.model.clamps import clamp_names, clamp_shares, freedom_words, order_words, second_over_first
from workhold.model.moved_setup import overhang_words, spare_holes
from workhold.model.setup import LengthSetting

__all__ = ["CLAMPS", "OPENING", "touch_words", "write_counting", "write_pegs"]


def write_pegs(column: TextColumn, sheet: Sheet) -> None:
    toolkit, plates = sheet.toolkit, sheet.toolkit.plates
    first, noun = plates[0], toolkit.moving.noun
    heading(column, f"{toolkit.setup_words.standing} {peg_size(sheet, first)}")
    header, rows, per = peg_rows(sheet)
    table = [header, *rows]
    if len(plates) > 1:
        stands_on = [first.noun, *(peg.carrier for peg in sheet.fixture.pegs)]
        table = [[row[0], word, *row[1:]] for row, word in zip(table, stands_on, strict=True)]
    column.table(table[0], table[1:], BODY)
    of_tips = f" or of {'the' if sheet.is_closed_at_once else 'a'} {noun}'s tip" if toolkit.tips else ""
    of_plate = f" of the fixed {first.noun}" if len(plates) > 1 else ""
    column.paragraph(
        f"x, y: centre of the {first.peg}{of_tips}, from {sheet.datum.point}{of_plate}"
        f"{'' if sheet.origin_shown else ', which lies beside the plan'}.",
        NOTE,
    )
    for wall in (carrier for carrier in toolkit.carriers if carrier.contact is WALL_END):
        write_flush(column, sheet, wall)
    if words := overhang_words(sheet.fixture, toolkit, sheet.workpiece, sheet.lengths.words):
        column.paragraph(words, NOTE, bold=True)
    added = "" if sheet.is_closed_at_once else f", both {noun}s added up, in the ratio stated below"
    column.paragraph(f"{per} of {noun} force{added}, without friction.", NOTE)
    write_flats(column, sheet)
    write_dowel(column, sheet)


def peg_size(sheet: Sheet, carrier: Carrier) -> str:
    if not carrier.peg_radius:
        return "(points, no diameter)"
    lengths = sheet.lengths
    size = f"Ø {lengths.short(2 * carrier.peg_radius)}"
    if carrier.body_radius > carrier.peg_radius:
        size += f", body Ø {lengths.short(2 * carrier.body_radius)}"
    return size


def write_flush(column: TextColumn, sheet: Sheet, wall: Carrier) -> None:
    plate, edge = sheet.toolkit.plates[0], sheet.datum.edge
    ends = list(dict.fromkeys(peg.touching for peg in sheet.fixture.pegs if peg.carrier == wall.name))
    lies = f"with {ends[0]}" if len(ends) == 1 else f"from {ends[0]} to {ends[1]}"
    words = f"The part lies flush on the {wall.noun} {lies}."
    if wall.width is not None:
        words += f" That is {sheet.lengths.words(wall.width)} wide."
    if edge is not None:
        words += f" Row 1 of the {plate.noun} is {sheet.lengths.words(edge)} from the {wall.noun}."
    column.paragraph(words, NOTE)


def put_words(sheet: Sheet) -> str:
    """Where to put the pegs, a sentence."""
    plates, holes = sheet.toolkit.plates, list[str]()
    for plate in plates:
        there = listed([peg.hole for peg in sheet.fixture.pegs if peg.carrier == plate.name])
        stands = "fixed" if plate.travel is None else "sliding"
        holes.append(f"{there} of the {stands} {plate.title}" if len(plates) > 1 else there)
    first, edge = plates[0], sheet.datum.edge
    return sheet.toolkit.setup_words.put.format(
        peg=first.peg,
        plate=first.noun,
        holes=listed(holes),
        edge="" if edge is None else sheet.lengths.words(edge),
    )


def touch_words(sheet: Sheet) -> str:
    """What each peg touches, and how to see that it does: the end of a sentence, and another one."""
    touch = listed([f"{peg.touching} at {peg.hole}" for peg in sheet.fixture.pegs])
    return f"{touch}. A strip of paper at each must not pull out."


def write_opening(column: TextColumn, sheet: Sheet) -> None:
    fixture, toolkit, lengths = sheet.fixture, sheet.toolkit, sheet.lengths
    first, moving = toolkit.plates[0], toolkit.moving
    heading(column, f"Opening S of the {moving.noun}s")
    column.words(lengths.words(fixture.jaw_separation), 28, bold=True, gap=0.4)
    if first == moving:
        column.paragraph(f"From {sheet.datum.y} to the centres of row 1 of the {moving.title}.", NOTE)
        return
    check = caliper_check(fixture, toolkit)
    one, other = (column_letters(hole[0]) for hole in (check.left, check.right))
    between = f"column {one} of the {first.title} to those of column {other} of the {moving.title}"
    column.paragraph(f"x from the centres of {between}.", NOTE)
    left, right = hole_name(first.name, *check.left), hole_name(moving.name, *check.right)
    diameter = 2 * first.peg_radius
    spare = {2: "", 1: " (one of them a spare)", 0: " (both spare)"}[check.placed]
    column.y += 3
    column.paragraph(f"Calipers on pegs in {left} and {right}{spare}:", BODY)
    if diameter == 0:
        column.fact("centre to centre", lengths.words(check.distance), bold=True)
        return
    if check.distance > diameter:
        column.fact("inside, between the pegs", lengths.words(check.distance - diameter), bold=True)
    column.fact("outside, over both pegs", lengths.words(check.distance + diameter), bold=True)


def opening_steps(sheet: Sheet) -> list[str]:
    fixture, lengths, moving = sheet.fixture, sheet.lengths, sheet.toolkit.moving
    words, force = sheet.toolkit.setup_words, sheet.details.jaw_force
    there, more, back = "Open", "wider", "Close"
    if sheet.toolkit.clamping < 0:
        there, more, back = "Close", "narrower", "Open"
    with_force = "" if force is None else f" with {lengths.unit.force_words(force)}"
    against = f", {words.against}" if words.against else ""
    count = len(fixture.placed)
    pegs = "both" if count == 2 else f"all {NUMBERS[count]}"
    return [
        put_words(sheet),
        f"{there} the {moving.noun}s a little {more} than S = {lengths.words(fixture.jaw_separation)} and "
        f"lay the part in as drawn, {lies_words(sheet)}{against}.{inside_words(sheet)}",
        f"{back} the {moving.title} until {pegs} pegs touch. The opening is then S; if not, the part "
        "lies another way.",
        f"Clamp{with_force}. The pegs touch: {touch_words(sheet)}",
    ]


OPENING = MovingBlocks(lambda sheet: [write_opening], opening_steps)


def clamp_writers(sheet: Sheet) -> list[Writer]:
    """The blocks about the clamp, or about each of two and the order in which they are tightened."""
    shares = clamp_shares(sheet.fixture)
    each: list[Writer] = [
        partial(write_clamp, setting=one, share=share)
        for one, share in zip(sheet.settings, shares, strict=True)
    ]
    return each if sheet.is_closed_at_once else [*each, write_order]


def write_clamp(column: TextColumn, sheet: Sheet, setting: LengthSetting, share: float) -> None:
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
    if sheet.details.loads or sheet.details.cutting is not None:
        needed = share * needed_force(sheet)
        column.fact("the loads need at least", f"{unit.force_above(needed)} {unit.force}", bold=True)
    fact_or_field(column, "torque of its screw", None)


def needed_force(sheet: Sheet) -> float:
    """The clamp force, of two clamps added up, that the loads and the program need, in N."""
    cutting = sheet.details.cutting
    needs = [case.needed.value for case in sheet.details.loads]
    return max([*needs, 0.0 if cutting is None else cutting.jaw.force])


def write_order(column: TextColumn, sheet: Sheet) -> None:
    fixture, (first, second) = sheet.fixture, clamp_names(sheet.fixture)
    heading(column, "Order of tightening")
    column.paragraph(order_words(fixture), BODY, bold=True)
    ratio = second_over_first(fixture)
    freedom = fixture.quality["clamp_freedom"]
    column.fact("clamp freedom, of 90°", f"{freedom:.1f}°", bold=True)
    column.paragraph(
        f"{freedom_words(freedom).capitalize()}. Forces here are stated for {second} with {ratio:.2f} times "
        f"the force of {first}, the middle of what holds.",
        NOTE,
    )


def clamp_steps(sheet: Sheet) -> list[str]:
    toolkit, lengths, alone = sheet.toolkit, sheet.lengths, sheet.is_closed_at_once
    plate, noun = toolkit.plates[0], toolkit.moving.noun
    bolts, ups = [], []
    for setting, tip in zip(sheet.settings, sheet.fixture.pegs[-len(sheet.settings) :], strict=True):
        put = setting.mounting.put.format(clamp=f"{'the' if alone else 'a'} {noun}", place=setting.place)
        bolts.append(f"{put}, pushing {setting.carrier.towards}, and draw it back.")
        one = f"the {noun}" if alone else tip.hole
        what = setting.mounting.then.format(name=setting.name, title=setting.title)
        ups.append(
            f"Bring {one} up until its tip touches face {tip.face}. {what} is then "
            f"{lengths.words(setting.length)}{'; if not, the part lies another way.' if alone else '.'}"
        )
    if not alone:
        ups.append("If a length is not as stated, the part lies another way.")
    count = sum(peg.carrier == plate.name for peg in sheet.fixture.pegs)
    against = toolkit.setup_words.against.format(count=NUMBERS[count], peg=plate.peg)
    return [
        f"{put_words(sheet)} {' '.join(bolts)}",
        f"Lay the part in as drawn, {lies_words(sheet)}, {against}.{inside_words(sheet)}",
        " ".join(ups),
        f"{clamping_words(sheet)} They touch: {touch_words(sheet)}",
    ]


def clamping_words(sheet: Sheet) -> str:
    fixture, force, unit = sheet.fixture, sheet.details.jaw_force, sheet.lengths.unit
    if sheet.is_closed_at_once:
        return f"Clamp{'' if force is None else f' with {unit.force_words(force)}'}."
    if force is None:
        return order_words(fixture)
    shares = zip(clamp_names(fixture), clamp_shares(fixture), strict=True)
    each = [f"{unit.force_words(share * force)} at {name}" for name, share in shares]
    return f"{order_words(fixture)} {listed(each)} make the {unit.force_words(force)} given."


CLAMPS = MovingBlocks(clamp_writers, clamp_steps)


def write_counting(column: TextColumn, sheet: Sheet) -> None:
    heading(column, "Counting holes")
    several = len(sheet.toolkit.plates) > 1
    (write_jaws if several else write_plate)(column, sheet)


def write_jaws(column: TextColumn, sheet: Sheet) -> None:
    """Writes how the holes of two plates are counted."""
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
    if words := place_words(sheet):
        column.paragraph(words, BODY)


def write_plate(column: TextColumn, sheet: Sheet) -> None:
    """Writes how the holes of the only plate are counted, and how far the whole set-up may be moved."""
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
    if words := place_words(sheet):
        column.paragraph(words, BODY)


def place_words(sheet: Sheet) -> str:
    """Where on its plate all of a set-up stands, a sentence; nothing where that is as it is listed."""
    if sheet.details.supports is not None or sheet.details.moved == (0, 0):
        return ""
    where = (
        "as asked" if sheet.details.is_asked_place else f"in the middle of the {sheet.toolkit.plates[0].noun}"
    )
    return f"All stands {moved_words(sheet.details.moved)} than the fixture is listed, {where}."


def moving_words(sheet: Sheet) -> str:
    """How far all of the set-up may be moved along the holes of the plate."""
    ways = []
    spares = spare_holes(sheet.fixture, sheet.toolkit)
    words = (("column", "left", "right"), ("row", "down", "up"))
    for (back, ahead), (noun, down, up) in zip(spares, words, strict=True):
        for spare, way in ((ahead, up), (back, down)):
            if spare is None:
                ways.append(f"any {noun}s further {way}")
            elif spare:
                ways.append(f"up to {plural(spare, noun)} further {way}")
    if not ways:
        return f"The set-up fits the {sheet.toolkit.noun} in this place only."
    return f"All of it may stand {listed(ways)}; places are then measured from {sheet.datum.substitute}."
