"""What a setup sheet says of two jaws: their opening and how to measure it, what to do, and how their holes are counted."""

from __future__ import annotations

from workhold.drawing.panel import NUMBERS, Column, offset_words
from workhold.drawing.sheet_facts import caliper_check
from workhold.drawing.sheet_pegs import put_words, touch_words
from workhold.drawing.sheet_writing import BODY, NOTE, MovingBlocks, Sheet, Writer, heading, inside_words, lies_words
from workhold.model.holes import column_letters, hole_name

__all__ = ["OPENING"]


def opening_writers(sheet: Sheet) -> list[Writer]:
    """The block about the opening."""
    return [write_opening]


def write_opening(column: Column, sheet: Sheet) -> None:
    """Write the opening and how to measure it."""
    fixture, toolkit, lengths = sheet.fixture, sheet.toolkit, sheet.lengths
    first, moving = toolkit.carriers[0], toolkit.moving
    heading(column, f"Opening S of the {moving.noun}s")
    column.words(lengths.words(fixture.jaw_separation), 28, bold=True, gap=0.4)
    check = caliper_check(fixture, toolkit)
    one, other = (column_letters(hole[0]) for hole in (check.left, check.right))
    column.paragraph(
        f"x from the centres of column {one} of the {first.title} to those of column {other} of the {moving.title}.",
        NOTE,
    )
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
    """What to do, one or two sentences each."""
    fixture, lengths, moving, force = sheet.fixture, sheet.lengths, sheet.toolkit.moving, sheet.details.jaw_force
    there, more, back = ("Open", "wider", "Close") if sheet.toolkit.clamping > 0 else ("Close", "narrower", "Open")
    with_force = "" if force is None else f" with {lengths.unit.force_words(force)}"
    return [
        put_words(sheet),
        f"{there} the {moving.noun}s a little {more} than S = {lengths.words(fixture.jaw_separation)} and lay the part in "
        f"as drawn, {lies_words(sheet)}.{inside_words(sheet)}",
        f"{back} the {moving.title} until all {NUMBERS[len(fixture.pegs)]} pegs touch. The opening is then S; if "
        "not, the part lies another way.",
        f"Clamp{with_force}. The pegs touch: {touch_words(sheet)}",
    ]


def write_counting(column: Column, sheet: Sheet) -> None:
    """Write how holes are counted."""
    lengths, first, moving = sheet.lengths, sheet.toolkit.carriers[0], sheet.toolkit.moving
    heading(column, "Counting holes")
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


OPENING = MovingBlocks(opening_writers, opening_steps, write_counting)
