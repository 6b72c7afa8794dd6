"""What a setup sheet says of two jaws: their opening and how to measure it, what to do, and how their holes are counted."""

from __future__ import annotations

from workhold.drawing.panel import NUMBERS, Column
from workhold.drawing.sheet_facts import caliper_check
from workhold.drawing.sheet_pegs import put_words, touch_words
from workhold.drawing.sheet_writing import BODY, NOTE, MovingBlocks, Sheet, Writer, heading, inside_words, lies_words
from workhold.fixels.holes import column_letters, hole_name

__all__ = ["OPENING"]


def opening_writers(sheet: Sheet) -> list[Writer]:
    """The block about the opening."""
    return [write_opening]


def write_opening(column: Column, sheet: Sheet) -> None:
    """Write the opening and how to measure it."""
    fixture, toolkit, lengths = sheet.fixture, sheet.toolkit, sheet.lengths
    first, moving = toolkit.plates[0], toolkit.moving
    heading(column, f"Opening S of the {moving.noun}s")
    column.words(lengths.words(fixture.jaw_separation), 28, bold=True, gap=0.4)
    if first == moving:
        column.paragraph(f"From {sheet.datum.y} to the centres of row 1 of the {moving.title}.", NOTE)
        return
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
    words = sheet.toolkit.setup_words
    there, more, back = ("Open", "wider", "Close") if sheet.toolkit.clamping > 0 else ("Close", "narrower", "Open")
    with_force = "" if force is None else f" with {lengths.unit.force_words(force)}"
    against = f", {words.against}" if words.against else ""
    count = len(fixture.placed)
    pegs = "both" if count == 2 else f"all {NUMBERS[count]}"
    return [
        put_words(sheet),
        f"{there} the {moving.noun}s a little {more} than S = {lengths.words(fixture.jaw_separation)} and lay the part in "
        f"as drawn, {lies_words(sheet)}{against}.{inside_words(sheet)}",
        f"{back} the {moving.title} until {pegs} pegs touch. The opening is then S; if not, the part lies another way.",
        f"Clamp{with_force}. The pegs touch: {touch_words(sheet)}",
    ]


OPENING = MovingBlocks(opening_writers, opening_steps)
