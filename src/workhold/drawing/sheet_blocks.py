"""The blocks of words and tables on a setup sheet; each writes itself down a column and can be measured beforehand."""

from __future__ import annotations

from collections.abc import Mapping

from workhold.drawing.fonts import shortened, text_width, wrapped
from workhold.drawing.legend import draw_legend
from workhold.drawing.panel import Column, fixture_words
from workhold.drawing.scene import BLACK
from workhold.drawing.sheet_clamp import CLAMPS
from workhold.drawing.sheet_counting import write_counting
from workhold.drawing.sheet_figures import write_loads, write_quality
from workhold.drawing.sheet_opening import OPENING
from workhold.drawing.sheet_pegs import write_pegs
from workhold.drawing.sheet_seating import write_seating, write_wrong_seats
from workhold.drawing.sheet_side import write_part, write_side
from workhold.drawing.sheet_writing import BODY, NOTE, Block, MovingBlocks, Sheet, Writer, heading
from workhold.fixels.carrier import Measure
from workhold.units import INCH

__all__ = ["blocks_of"]

NAME_SIZES = (26.0, 22.0, 18.0)
MOST_NAME_LINES = 3
# What a sheet says of what moves, by what is set on it.
MOVING: Mapping[Measure, MovingBlocks] = {"opening": OPENING, "stroke": CLAMPS, "tip": CLAMPS}


def blocks_of(sheet: Sheet) -> tuple[list[Block], list[Block]]:
    """All blocks of a sheet in reading order: those needed beside the plan, and the others."""
    moving = MOVING[sheet.toolkit.moving.measure]
    needed: list[Writer] = [write_title, write_pegs, *moving.settings(sheet), write_zero]
    others: list[Writer] = [write_side, write_part, write_steps]
    if sheet.cautions:
        needed.append(write_cautions)
    if sheet.seating is not None:
        others += [write_seating, write_wrong_seats]
    elif sheet.details.by_hand is not None or sheet.details.not_seated:
        others.append(write_seating)
    if sheet.details.loads:
        others.append(write_loads)
    others += [write_quality, write_counting, write_legend]
    return [bound(writer, sheet) for writer in needed], [bound(writer, sheet) for writer in others]


def bound(writer: Writer, sheet: Sheet) -> Block:
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


def write_zero(column: Column, sheet: Sheet) -> None:
    """Write what the part's zero is, where it lies and how the part is turned, and the lines that tell a control."""
    zero, lengths = sheet.zero, sheet.lengths
    (x, y), turn = sheet.zero_place, f"{sheet.fixture.pose.theta_deg:.4f}"
    heading(column, "Part zero X0 Y0 and angle")
    column.fact("X0 Y0 is the", zero.words, BODY, bold=True)
    column.fact(f"x from {sheet.datum.x}", lengths.words(x), bold=True)
    column.fact(f"y from {sheet.datum.y}", lengths.words(y), bold=True)
    column.fact("turned by θ, counter-clockwise", f"{turn}°", bold=True)
    drawn = ", y ".join(map(lengths.words, zero.point))
    place = "" if sheet.zero_shown else " It lies outside the plan."
    column.paragraph(f"In the part's drawing it is at x {drawn}.{place} x runs to the right, y upward.", NOTE)
    # Haas takes three places behind the point (Mill Operator's Manual, G68).
    word = f"{sheet.fixture.pose.theta_deg:.3f}"
    turning = f"G68 X0 Y0 R{word}" if float(word) else "no G68, as the part is not turned"
    machine = sheet.details.machine_position
    if machine is None:
        words = f"G54: the machine's position over {sheet.datum.point}, plus this x and y; then {turning}."
        column.paragraph(words, NOTE)
        return
    gx, gy = (lengths.number(start + way).replace("−", "-") for start, way in zip(machine, (x, y), strict=True))
    unit = "G20" if sheet.lengths.unit is INCH else "G21"
    column.paragraph(
        f"{sheet.datum.name} at machine {' and '.join(map(lengths.words, machine))}, x along the machine's X:", NOTE
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
    given = "as given under part zero X0 Y0, or touch off the part there"
    zero = f"Set the machine's zero, G54, from {sheet.datum.name} {given}."
    for number, step in enumerate([*MOVING[sheet.toolkit.moving.measure].steps(sheet), zero], 1):
        column.scene.text((column.x, column.y + 0.75 * BODY), f"{number}.", BODY, bold=True, middle=False)
        column.paragraph(step, BODY, indent=18)
        column.y += 2


def write_legend(column: Column, sheet: Sheet) -> None:
    """Explain the signs of the plan."""
    heading(column, "Signs")
    draw_legend(column, sheet.toolkit, BLACK)
