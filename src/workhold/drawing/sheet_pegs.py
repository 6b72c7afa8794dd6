"""What a setup sheet says of the pegs: where each stands and which face it touches, and the first thing to do with them."""

from __future__ import annotations

from workhold.drawing.panel import Column
from workhold.drawing.sheet_writing import BODY, NOTE, Sheet, heading, peg_rows, write_dowel, write_flats
from workhold.fixels.carrier import Carrier
from workhold.fixels.contact_kind import WALL_END
from workhold.plain import listed

__all__ = ["put_words", "touch_words", "write_pegs"]


def write_pegs(column: Column, sheet: Sheet) -> None:
    """Write where the pegs stand, and the tips of clamps."""
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
    added = "" if sheet.is_closed_at_once else f", both {noun}s added up, in the ratio told below"
    column.paragraph(f"{per} of {noun} force{added}, without friction.", NOTE)
    write_flats(column, sheet)
    write_dowel(column, sheet)


def peg_size(sheet: Sheet, carrier: Carrier) -> str:
    """The size of a carrier's pegs, behind a word."""
    if not carrier.peg_radius:
        return "(points, no diameter)"
    lengths = sheet.lengths
    body = f", body Ø {lengths.short(2 * carrier.body_radius)}" if carrier.body_radius > carrier.peg_radius else ""
    return f"Ø {lengths.short(2 * carrier.peg_radius)}{body}"


def write_flush(column: Column, sheet: Sheet, wall: Carrier) -> None:
    """Write where the part lies flush on a wall, and how far the plate is from it."""
    plate, edge = sheet.toolkit.plates[0], sheet.datum.edge
    ends = list(dict.fromkeys(peg.touching for peg in sheet.fixture.pegs if peg.carrier == wall.name))
    lies = f"with {ends[0]}" if len(ends) == 1 else f"from {ends[0]} to {ends[1]}"
    row = "" if edge is None else f" Row 1 of the {plate.noun} is {sheet.lengths.words(edge)} from the {wall.noun}."
    column.paragraph(f"The part lies flush on the {wall.noun} {lies}.{row}", NOTE)


def put_words(sheet: Sheet) -> str:
    """Where to put the pegs, a sentence."""
    plates, holes = sheet.toolkit.plates, list[str]()
    for plate in plates:
        there = listed([peg.hole for peg in sheet.fixture.pegs if peg.carrier == plate.name])
        stands = "fixed" if plate.travel is None else "sliding"
        holes.append(f"{there} of the {stands} {plate.title}" if len(plates) > 1 else there)
    first, edge = plates[0], sheet.datum.edge
    return sheet.toolkit.setup_words.put.format(
        peg=first.peg, plate=first.noun, holes=listed(holes), edge="" if edge is None else sheet.lengths.words(edge)
    )


def touch_words(sheet: Sheet) -> str:
    """What each peg touches, and how to see that it does: the end of a sentence, and another one."""
    touch = listed([f"{peg.touching} at {peg.hole}" for peg in sheet.fixture.pegs])
    return f"{touch}. A strip of paper at each must not pull out."
