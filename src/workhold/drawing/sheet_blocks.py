"""The blocks of words and tables on a setup sheet; each writes itself down a column and can be measured beforehand."""

from __future__ import annotations

from collections.abc import Callable

from workhold.drawing.fonts import shortened, text_width, wrapped
from workhold.drawing.panel import NUMBERS, Column, draw_legend, fixture_words, offset_words
from workhold.drawing.scene import BLACK
from workhold.drawing.sheet_clamp import clamp_steps, clamp_writers, write_locators, write_plate
from workhold.drawing.sheet_facts import caliper_check
from workhold.drawing.sheet_figures import write_loads, write_quality
from workhold.drawing.sheet_seating import write_seating, write_wrong_seats
from workhold.drawing.sheet_side import write_part, write_side
from workhold.drawing.sheet_writing import (
    BODY,
    NOTE,
    Block,
    Sheet,
    heading,
    inside_words,
    lies_words,
    peg_rows,
    write_dowel,
    write_flats,
)
from workhold.model.holes import column_letters, hole_name
from workhold.model.units import INCH
from workhold.plain import listed

__all__ = ["blocks_of"]

NAME_SIZES = (26.0, 22.0, 18.0)
MOST_NAME_LINES = 3


def blocks_of(sheet: Sheet) -> tuple[list[Block], list[Block]]:
    """All blocks of a sheet in reading order: those needed beside the plan, and the others."""
    clamped = sheet.fixture.direction is not None
    held = [write_locators, *clamp_writers(sheet)] if clamped else [write_pegs, write_opening]
    needed, others = [write_title, *held, write_zero], [write_side, write_part, write_steps]
    if sheet.cautions:
        needed.append(write_cautions)
    if sheet.seating is not None:
        others += [write_seating, write_wrong_seats]
    elif sheet.details.by_hand is not None or sheet.details.not_seated:
        others.append(write_seating)
    if sheet.details.loads:
        others.append(write_loads)
    others += [write_quality, write_plate if clamped else write_counting, write_legend]
    return [bound(writer, sheet) for writer in needed], [bound(writer, sheet) for writer in others]


def bound(writer: Callable[[Column, Sheet], None], sheet: Sheet) -> Block:
    """A writer with its sheet."""
    return lambda column: writer(column, sheet)


def write_title(column: Column, sheet: Sheet) -> None:
    """Write which fixture of which part this is."""
    size = next((s for s in NAME_SIZES if text_width(sheet.name, s, bold=True) <= column.width), NAME_SIZES[-1])
    lines = wrapped(sheet.name, size, column.width, bold=True)
    if len(lines) > MOST_NAME_LINES:
        rest = " ".join(lines[MOST_NAME_LINES - 1 :])
        lines = [*lines[: MOST_NAME_LINES - 1], shortened(rest + "…", size, column.width, bold=True)]
    for line in lines:
        column.words(line, size, bold=True, gap=0.4)
    column.y += 4
    column.words(f"Fixture {sheet.details.number} of {sheet.details.count}", 16, bold=True, gap=0.5)
    column.paragraph(fixture_words(sheet.fixture, sheet.toolkit), BODY)
    x0, y0, x1, y1 = sheet.workpiece.bounds
    lengths = sheet.lengths
    column.words(f"Outside {lengths.number(x1 - x0)} × {lengths.words(y1 - y0)}, as drawn", BODY, gap=0.3)


def write_pegs(column: Column, sheet: Sheet) -> None:
    """Write the four pegs."""
    heading(column, f"Pegs{peg_size(sheet)}")
    first = sheet.toolkit.carriers[0]
    header, rows, per = peg_rows(sheet, [peg.hole for peg in sheet.fixture.pegs])
    stands_on = [first.noun, *(peg.carrier for peg in sheet.fixture.pegs)]
    table = [[row[0], word, *row[1:]] for row, word in zip([header, *rows], stands_on, strict=True)]
    column.table(table[0], table[1:], BODY)
    column.paragraph(
        f"x, y: centre of the peg, from the centre of hole {sheet.origin} of the fixed {first.noun}"
        f"{'' if sheet.origin_shown else ', which lies beside the plan'}.",
        NOTE,
    )
    column.paragraph(f"{per} of {first.noun} force, without friction.", NOTE)
    write_flats(column, sheet)
    write_dowel(column, sheet)


def peg_size(sheet: Sheet) -> str:
    """The size of the pegs, behind a word."""
    carrier, lengths = sheet.toolkit.carriers[0], sheet.lengths
    if not carrier.peg_radius:
        return " (points, no diameter)"
    body = f", body Ø {lengths.short(2 * carrier.body_radius)}" if carrier.body_radius > carrier.peg_radius else ""
    return f" Ø {lengths.short(2 * carrier.peg_radius)}{body}"


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


def write_zero(column: Column, sheet: Sheet) -> None:
    """Write what the part's zero is, where it lies and how the part is turned, and the lines that tell a control."""
    zero, lengths = sheet.zero, sheet.lengths
    (x, y), turn = sheet.zero_place, f"{sheet.fixture.pose.theta_deg:.4f}"
    heading(column, "Part zero X0 Y0 and angle")
    column.fact("X0 Y0 is the", zero.words, BODY, bold=True)
    column.fact(f"x from {sheet.from_x}", lengths.words(x), bold=True)
    column.fact(f"y from {sheet.from_y}", lengths.words(y), bold=True)
    column.fact("turned by θ, counter-clockwise", f"{turn}°", bold=True)
    drawn = ", y ".join(map(lengths.words, zero.point))
    place = "" if sheet.zero_shown else " It lies outside the plan."
    column.paragraph(f"In the part's drawing it is at x {drawn}.{place} x runs to the right, y upward.", NOTE)
    # Haas takes three places behind the point (Mill Operator's Manual, G68).
    word = f"{sheet.fixture.pose.theta_deg:.3f}"
    turning = f"G68 X0 Y0 R{word}" if float(word) else "no G68, as the part is not turned"
    machine = sheet.details.machine_position
    if machine is None:
        words = f"G54: the machine's position over {sheet.origin_words}, plus this x and y; then {turning}."
        column.paragraph(words, NOTE)
        return
    gx, gy = (lengths.number(start + way).replace("−", "-") for start, way in zip(machine, (x, y), strict=True))
    unit = "G20" if sheet.lengths.unit is INCH else "G21"
    column.paragraph(
        f"{sheet.origin} at machine {' and '.join(map(lengths.words, machine))}, x along the machine's X:", NOTE
    )
    column.y += 3
    column.words(f"{unit} G10 L2 P1 X{gx} Y{gy}", BODY, bold=True)
    column.words(f"G54 {turning}" if float(word) else "G54", BODY, bold=True)


def write_cautions(column: Column, sheet: Sheet) -> None:
    """Write what to beware of, each behind a sign."""
    heading(column, "Beware")
    for caution in sheet.cautions:
        y = column.y
        column.scene.text((column.x, y + 0.75 * BODY), "▲", BODY, bold=True, middle=False)
        column.paragraph(caution.sentence, BODY, indent=18)
        column.y += 2


def write_steps(column: Column, sheet: Sheet) -> None:
    """Write what to do, in order."""
    heading(column, "Setting up")
    for number, step in enumerate(steps(sheet) if sheet.fixture.direction is None else clamp_steps(sheet), 1):
        column.scene.text((column.x, column.y + 0.75 * BODY), f"{number}.", BODY, bold=True, middle=False)
        column.paragraph(step, BODY, indent=18)
        column.y += 2


def steps(sheet: Sheet) -> list[str]:
    """What to do, one or two sentences each."""
    fixture, lengths = sheet.fixture, sheet.lengths
    toolkit, moving = sheet.toolkit, sheet.toolkit.moving
    there, more, back = ("Open", "wider", "Close") if toolkit.clamping > 0 else ("Close", "narrower", "Open")
    put = [
        f"{listed([peg.hole for peg in fixture.pegs if peg.carrier == carrier.name])} of the "
        f"{'fixed' if carrier.travel is None else 'sliding'} {carrier.title}"
        for carrier in toolkit.carriers
    ]
    touch = listed([f"face {peg.face} at {peg.hole}" for peg in fixture.pegs])
    force = sheet.details.jaw_force
    with_force = "" if force is None else f" with {lengths.unit.force_words(force)}"
    return [
        f"Put pegs in {listed(put)}.",
        f"{there} the {moving.noun}s a little {more} than S = {lengths.words(fixture.jaw_separation)} and lay the part in "
        f"as drawn, {lies_words(sheet)}.{inside_words(sheet)}",
        f"{back} the {moving.title} until all {NUMBERS[len(fixture.pegs)]} pegs touch. The opening is then S; if "
        "not, the part lies another way.",
        f"Clamp{with_force}. The pegs touch: {touch}. A strip of paper at each must not pull out.",
        f"Set the machine's zero, G54, from {sheet.origin} as given under part zero X0 Y0, or touch off the part there.",
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


def write_legend(column: Column, sheet: Sheet) -> None:
    """Explain the signs of the plan."""
    heading(column, "Signs")
    draw_legend(column, sheet.toolkit, BLACK)
