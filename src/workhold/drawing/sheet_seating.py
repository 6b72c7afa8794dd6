"""The blocks of a setup sheet that tell whether the part ends up where it should, and how it looks where it does not."""

from __future__ import annotations

from workhold.drawing.fonts import text_width
from workhold.drawing.panel import Column
from workhold.drawing.scene import BLACK, GREY, Box, View
from workhold.drawing.seating_words import SeatingWords
from workhold.drawing.seats_picture import RIGHT, Placed, draw_lying
from workhold.drawing.sheet_writing import BODY, NOTE, Sheet, heading
from workhold.model.seating import Seat
from workhold.seating.by_hand import WHY

__all__ = ["write_seating", "write_wrong_seats"]

# Pictures in a row, and at most; the first is the right seat.
ACROSS, MOST = 3, 6
# Room between pictures, height of a picture by its width, and height and sizes of the lines below one, page units.
GAP, TALL = 8.0, 0.95
LINE, READING, SMALL = 12.5, 11.0, 9.5


def write_seating(column: Column, sheet: Sheet) -> None:
    """Write how far to open, how near to put the part, and what to read; or how to put it into two clamps."""
    heading(column, "Will it end up there?")
    put_in, steps = sheet.details.by_hand, list[str]()
    if sheet.seating is not None:
        steps = sheet.seating.steps(sheet.workpiece)
    elif put_in is not None:
        column.paragraph(WHY, BODY)
        # The order of tightening has a block of its own.
        steps = put_in.steps(sheet.lengths.words, with_order=False)
    else:
        column.paragraph(sheet.details.not_seated, BODY)
    for number, step in enumerate(steps, 1):
        column.scene.text((column.x, column.y + 0.75 * BODY), f"{number}.", BODY, bold=True, middle=False)
        column.paragraph(step, BODY, indent=18)
        column.y += 2


def write_wrong_seats(column: Column, sheet: Sheet) -> None:
    """Draw the right seat and the wrong ones that read most like it, each with its reading."""
    words = sheet.seating
    assert words is not None
    heading(column, "What it looks like")
    for sentence in words.wrong_words():
        column.paragraph(sentence, BODY)
    shown = [words.own, *words.wrong[: MOST - 1]]
    width = (column.width - (ACROSS - 1) * GAP) / ACROSS
    captions = [caption(words, seat) for seat in shown]
    below = LINE * max(map(len, captions)) + GAP
    cells = []
    for k in range(len(shown)):
        x, y = column.x + k % ACROSS * (width + GAP), column.y + 6 + k // ACROSS * (TALL * width + below + GAP)
        cells.append(Box(x, y, x + width, y + TALL * width))
    placed = [Placed.of(seat, sheet.fixture, sheet.workpiece, sheet.toolkit) for seat in shown]
    rooms = [cell.grown(-5.0) for cell in cells]
    scale = min(View.fitting(one.extent, room).scale for one, room in zip(placed, rooms, strict=True))
    group = column.scene.group("seats")
    for one, lines, cell, room in zip(placed, captions, cells, rooms, strict=True):
        seat = one.seat
        group.rectangle(cell, "#ffffff", RIGHT if seat.is_own else GREY, 2.0 if seat.is_own else 0.8, 4)
        draw_lying(group, one, View.fitting(one.extent, room, scale), 0.9)
        for k, line in enumerate(lines):
            size, colour = (READING if k == 0 else SMALL), RIGHT if seat.is_own and k == 1 else BLACK
            size = min(size, size * (width - 2) / text_width(line, size, bold=k == 0))
            group.text((cell.x0 + 2, cell.y1 + 11 + LINE * k), line, size, bold=k == 0, fill=colour, middle=False)
    column.y = cells[-1].y1 + below
    rest = len(words.wrong) - (len(shown) - 1)
    if rest:
        which = "one more is" if rest == 1 else f"{rest} more are"
        column.paragraph(f"Drawn are the nearest readings; {which} off by more.", NOTE)


def caption(words: SeatingWords, seat: Seat) -> list[str]:
    """The lines below the picture of a seat: what is read, how that differs, and what else is to be said."""
    told = ["turned over"] * seat.mirrored + ["not located"] * (seat.kind == "loose")
    told += ["not settled"] * (seat.kind == "unsettled")
    lines = [words.reads(words.reading(seat)), "right" if seat.is_own else words.difference(seat)]
    return [*lines, ", ".join(told)] if told else lines
