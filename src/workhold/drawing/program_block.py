"""The block about a program beside a plan: its zero, tools with their lines, the nearest move."""

from __future__ import annotations

from math import inf

from workhold.drawing.panel import TextColumn
from workhold.drawing.path_drawn import COLOURS, NEAREST, PlannedPath
from workhold.drawing.scene import BLACK, GREY, LengthUnit, shortened
from workhold.drawing.sheet_writing import BODY, NOTE, Sheet, heading
from workhold.errors import listed
from workhold.model.program import Program
from workhold.model.program_figures import tool_figures

__all__ = ["passing_sentence", "write_path", "write_program"]

# Where the columns of tools begin, as shares of the width; the first is a piece of the path.
SWATCH = 22.0
COLUMNS = (0.0, 0.10, 0.30, 0.60, 1.0)
MOST_TOOLS = 12
SIZE = 12.0


def write_program(column: TextColumn, sheet: Sheet) -> None:
    """Writes the program of a setup sheet."""
    details = sheet.details
    assert details.program is not None
    heading(column, "Program")
    # On supports the pegs stand farther out of the plate than over the part's lower side.
    top = details.peg_height if sheet.heights is None else sheet.heights.peg_top
    path = PlannedPath(details.program, sheet.fixture, details.passing, top)
    write_path(column, path, sheet.lengths)
    if details.cutting is not None:
        moving, unit = sheet.toolkit.moving.noun, sheet.lengths.unit
        needed, *others = details.cutting.words(moving, unit, len(sheet.fixture.travels))
        column.y += 3
        column.paragraph(needed, BODY, bold=True)
        for sentence in others:
            column.paragraph(sentence, NOTE)


def write_path(column: TextColumn, path: PlannedPath, lengths: LengthUnit, fill: str = BLACK) -> None:
    """Writes where a program runs, its tools in their colours with their lines, and where they come nearest.

    Parameters
    ----------
    fill : colour of the words.
    """
    program = path.program
    x, y = program.zero
    name = shortened(program.name, BODY, 0.75 * column.width, bold=True)
    column.fact("program", name, BODY, bold=True)
    column.fact("its X0 Y0, as drawn", f"x {lengths.number(x)}, y {lengths.words(y)}", BODY)
    column.fact("its Z0 above the part's lower side", lengths.words(program.z_zero), BODY)
    column.fact("tools keep off at least", lengths.words(program.clearance), BODY)
    column.y += 2
    write_tools(column, program, lengths, fill)
    y = column.y + 6
    column.scene.line([(column.x, y), (column.x + SWATCH, y)], GREY, 1.0, stroke_dasharray="6 5")
    column.scene.text((column.x + SWATCH + 8, y), "rapid moves; dark lines are low, pale ones high", NOTE)
    column.y += 16
    mark = column.y + 5
    column.scene.line([(column.x, mark), (column.x + SWATCH, mark)], NEAREST, 2.6)
    column.paragraph(passing_sentence(path, lengths), NOTE, fill=fill, indent=SWATCH + 8)
    if above := tools_above(path):
        column.paragraph(f"All the way above what holds the part: {listed(above)}.", NOTE, fill=fill)


def write_tools(column: TextColumn, program: Program, lengths: LengthUnit, fill: str) -> None:
    """Writes the tools in their colours: diameter, name, where they begin, and how low they cut."""
    ends = [column.x + SWATCH + 8 + share * (column.width - SWATCH - 8) for share in COLUMNS]
    figures = tool_figures(program)
    header = ("", "tool", f"Ø {lengths.sign}", "lines", "lowest cut z")
    column.y += 0.75 * SIZE
    for at, words in zip(ends[1:], header[1:], strict=True):
        column.scene.text((at, column.y), words, SIZE - 1, "end" if at == ends[-1] else "start", middle=False)
    column.y += 0.7 * SIZE
    lines = last_lines(program)
    for place, one in enumerate(figures[:MOST_TOOLS]):
        tool = program.tools[one.tool]
        y = column.y + SIZE / 2
        colour = COLOURS[place % len(COLOURS)]
        column.scene.line(
            [(column.x + 3, y), (column.x + SWATCH - 3, y)], colour, 6.0, stroke_linecap="round"
        )
        low = "–" if one.lowest_cut is None else lengths.number(one.lowest_cut)
        span = f"{one.first_line} to {lines[one.tool]}"
        cells = (f"T{one.tool}", lengths.short_number(tool.diameter), span, low)
        for number, (at, words) in enumerate(zip(ends[1:], cells, strict=True)):
            anchor = "end" if number == len(cells) - 1 else "start"
            column.scene.text((at, y), words, SIZE, anchor, bold=number == 0, fill=BLACK)
        column.y += 1.35 * SIZE
        if tool.name:
            shown = shortened(tool.name, NOTE, column.width - SWATCH - 8 - (ends[1] - ends[0]))
            column.scene.text((ends[1], column.y + 3), shown, NOTE, fill=GREY)
            column.y += 1.3 * NOTE
    if len(figures) > MOST_TOOLS:
        column.paragraph(f"and {len(figures) - MOST_TOOLS} more", NOTE, fill=fill, indent=SWATCH + 8)
    column.y += 3


def tools_above(path: PlannedPath) -> list[str]:
    """The tools that never come down to the pegs; none where nobody knows how high these are."""
    if path.peg_height is None:
        return []
    return [f"T{one.tool}" for one in tool_figures(path.program) if one.lowest > path.peg_height]


def last_lines(program: Program) -> dict[int, int]:
    """The last line of each tool that moves."""
    return {int(tool): int(line) for tool, line in zip(program.moves.tool, program.moves.line, strict=True)}


def passing_sentence(path: PlannedPath, lengths: LengthUnit) -> str:
    """Where the tools come nearest to what holds the part, a sentence."""
    near = path.passing
    if near is None or near.distance == inf:
        return "No tool comes down to where anything holds the part."
    where = f"T{near.tool} in line {near.line}, {lengths.words(near.distance)} from the {near.element}"
    return f"Nearest to what holds the part: {where}."
