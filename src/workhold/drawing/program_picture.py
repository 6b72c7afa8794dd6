"""A program from above, in colours for tool and height with rapid moves dashed, and its block of words beside
a plan.

The block has the program's zero, its tools with their lines, and the move that comes nearest to what holds
the part.
"""

from __future__ import annotations

from math import inf

from workhold.drawing.annotation import draw_scale_bar
from workhold.drawing.bench import make_outline_path
from workhold.drawing.panel import TextColumn, format_count
from workhold.drawing.part_pictures import EDGE, FOOTER, HEADER, draw_header
from workhold.drawing.path_drawn import (
    COLOURS,
    NEAREST,
    SHADES,
    PagePaths,
    PlannedPath,
    draw_paths,
    find_heights_cut,
    shade_colour,
)
from workhold.drawing.scene import BLACK, GREY, LANDSCAPE, Box, LengthUnit, Scene, View, shorten_text
from workhold.drawing.sheet_writing import BODY, NOTE, SetupSheet, write_heading
from workhold.errors import join_words
from workhold.model.program import Program
from workhold.model.program_figures import bound_tip, measure_tools
from workhold.model.workpiece import Workpiece
from workhold.units import MILLIMETRE, Unit

__all__ = ["draw_program", "describe_clearance", "write_path", "write_program"]

SIDE = 268.0
PART = "#eceff2"
LEGEND_ROW = 62.0
MOST_LISTED = 8
# Where the columns of tools begin, as shares of the width; the first is a piece of the path.
SWATCH = 22.0
COLUMNS = (0.0, 0.10, 0.30, 0.60, 1.0)
MOST_TOOLS = 12
SIZE = 12.0


def draw_program(program: Program, *, workpiece: Workpiece | None = None, unit: Unit = MILLIMETRE) -> str:
    """Return a picture of the paths of a program's tools from above, on A4.

    Parameters
    ----------
    workpiece : the part, drawn below the paths; None draws no part.

    Returns
    -------
    str
        SVG text; the group of class ``paths`` carries the map from mm to the page.
    """
    figures = measure_tools(program)
    bounds = compute_shown_bounds(program, workpiece)
    lengths = LengthUnit.from_typical_length(unit, max(bounds.width, bounds.height))
    width, height = LANDSCAPE
    room = Box(EDGE, EDGE + HEADER, width - EDGE - SIDE, height - EDGE - FOOTER)
    view = View.fit_box(bounds, room.grow(-8))
    scene = Scene.make_page(LANDSCAPE, f"{program.name}: paths of the tools")
    words = (
        f"{format_count(len(program.moves), 'move')} of {format_count(len(figures), 'tool')}, seen from above"
    )
    draw_header(scene, LANDSCAPE, program.name, words)
    if workpiece is not None:
        d = make_outline_path(workpiece.loop_segments, view)
        scene.group("part", view).add_path(d, BLACK, 1.2, PART, fill_rule="evenodd")
    draw_paths(scene.group("paths", view), program, PagePaths.from_moves(program.moves, view))
    draw_zero(scene, view(program.zero))
    draw_legend(scene, program, lengths, Box(width - EDGE - SIDE + 20, room.y0, width - EDGE, room.y1))
    draw_scale_bar(scene, (EDGE, height - EDGE), view.scale, lengths)
    return scene.to_svg()


def compute_shown_bounds(program: Program, workpiece: Workpiece | None) -> Box:
    """Return the box in mm of all that the tools sweep, the program's zero and the part."""
    low, high = bound_tip(program.moves)
    around = max(tool.diameter for tool in program.tools.values()) / 2
    swept = Box(*low[:2].tolist(), *high[:2].tolist()).grow(around)
    bounds = swept.unite(Box(*program.zero, *program.zero))
    return bounds if workpiece is None else bounds.unite(Box(*workpiece.bounds))


def draw_zero(scene: Scene, at: tuple[float, float]) -> None:
    """Draw the program's zero with its X and Y axes at a page point."""
    group = scene.group("program-zero")
    x, y = at
    group.add_arrow((x, y), (x + 34, y), BLACK, 1.4, 8)
    group.add_arrow((x, y), (x, y - 34), BLACK, 1.4, 8)
    group.add_circle((x, y), 4, "#ffffff", BLACK, 1.4)
    group.add_text((x + 42, y), "X", 12, "middle", halo=2)
    group.add_text((x, y - 43), "Y", 12, "middle", halo=2)


def draw_legend(scene: Scene, program: Program, lengths: LengthUnit, box: Box) -> None:
    """Write the tools with their colours, the shades of height and the sign of rapid moves into a page
    box.
    """
    group, figures, y = scene.group("legend"), measure_tools(program), box.y0 + 8
    for place, one in enumerate(figures[:MOST_LISTED]):
        tool = program.tools[one.tool]
        group.add_line(
            [(box.x0, y), (box.x0 + 26, y)], COLOURS[place % len(COLOURS)], 8, stroke_linecap="round"
        )
        head = f"T{one.tool}  Ø {lengths.format_short(tool.diameter)}"
        group.add_text((box.x0 + 40, y), head, 14, bold=True)
        words = [tool.name] if tool.name else []
        if one.lowest_cut is not None:
            words.append(f"down to z {lengths.format_number(one.lowest_cut)}")
        for line, text in enumerate(words):
            shown = shorten_text(text, 12, box.width - 40)
            group.add_text((box.x0 + 40, y + 19 + 17 * line), shown, 12, fill=GREY)
        y += LEGEND_ROW
    if len(figures) > MOST_LISTED:
        group.add_text(
            (box.x0 + 40, y), f"and {format_count(len(figures) - MOST_LISTED, 'tool')} more", 12, fill=GREY
        )
        y += LEGEND_ROW
    y += 8
    for level in range(SHADES):
        x = box.x0 + 22 * level
        group.add_rectangle(Box(x, y - 6, x + 22, y + 6), shade_colour(COLOURS[0], level))
    low, high = map(lengths.format_number, find_heights_cut(program))
    group.add_text((box.x0, y + 20), f"dark at z {low}, light at z {high} {lengths.sign}", 12, fill=GREY)
    y += 52
    group.add_line([(box.x0, y), (box.x0 + 34, y)], GREY, 1.2, stroke_dasharray="6 5")
    group.add_text((box.x0 + 44, y), "rapid move", 12, fill=GREY)


def write_program(column: TextColumn, sheet: SetupSheet) -> None:
    """Write a sheet's block about its program: its path, tools and cutting forces."""
    details = sheet.details
    assert details.program is not None
    write_heading(column, "Program")
    # On supports the pegs stand farther out of the plate than over the part's lower side.
    top = details.peg_height if sheet.heights is None else sheet.heights.peg_top
    path = PlannedPath(details.program, sheet.fixture, details.passing, top)
    write_path(column, path, sheet.lengths)
    if details.cutting is not None:
        moving, unit = sheet.toolkit.moving.noun, sheet.lengths.unit
        needed, *others = details.cutting.list_sentences(moving, unit, len(sheet.fixture.travels))
        column.y += 3
        column.write_paragraph(needed, BODY, bold=True)
        for sentence in others:
            column.write_paragraph(sentence, NOTE)


def write_path(column: TextColumn, path: PlannedPath, lengths: LengthUnit, fill: str = BLACK) -> None:
    """Write the program's zero, its tools in their colours with their lines, and the move nearest to the
    fixture.
    """
    program = path.program
    x, y = program.zero
    name = shorten_text(program.name, BODY, 0.75 * column.width, bold=True)
    column.write_fact("program", name, BODY, bold=True)
    column.write_fact(
        "its X0 Y0, as drawn", f"x {lengths.format_number(x)}, y {lengths.format_length(y)}", BODY
    )
    held = "block" if program.raised else "part"
    column.write_fact(f"its Z0 above the {held}'s lower side", lengths.format_length(program.z_zero), BODY)
    column.write_fact("tools keep off at least", lengths.format_length(program.clearance), BODY)
    column.y += 2
    write_tools(column, program, lengths, fill)
    y = column.y + 6
    column.scene.add_line([(column.x, y), (column.x + SWATCH, y)], GREY, 1.0, stroke_dasharray="6 5")
    column.scene.add_text((column.x + SWATCH + 8, y), "rapid moves; dark lines are low, pale ones high", NOTE)
    column.y += 16
    mark = column.y + 5
    column.scene.add_line([(column.x, mark), (column.x + SWATCH, mark)], NEAREST, 2.6)
    column.write_paragraph(describe_clearance(path, lengths), NOTE, fill=fill, indent=SWATCH + 8)
    if above := list_tools_above_pegs(path):
        column.write_paragraph(
            f"All the way above what holds the part: {join_words(above)}.", NOTE, fill=fill
        )


def write_tools(column: TextColumn, program: Program, lengths: LengthUnit, fill: str) -> None:
    """Write the table of tools: colour, number, diameter, program lines and lowest cut; at most
    ``MOST_TOOLS`` rows.
    """
    ends = [column.x + SWATCH + 8 + share * (column.width - SWATCH - 8) for share in COLUMNS]
    figures = measure_tools(program)
    header = ("", "tool", f"Ø {lengths.sign}", "lines", "lowest cut z")
    column.y += 0.75 * SIZE
    for at, words in zip(ends[1:], header[1:], strict=True):
        column.scene.add_text(
            (at, column.y), words, SIZE - 1, "end" if at == ends[-1] else "start", middle=False
        )
    column.y += 0.7 * SIZE
    last_lines = dict(zip(program.moves.tool.tolist(), program.moves.line.tolist(), strict=True))
    for place, one in enumerate(figures[:MOST_TOOLS]):
        tool = program.tools[one.tool]
        y = column.y + SIZE / 2
        colour = COLOURS[place % len(COLOURS)]
        column.scene.add_line(
            [(column.x + 3, y), (column.x + SWATCH - 3, y)], colour, 6.0, stroke_linecap="round"
        )
        low = "–" if one.lowest_cut is None else lengths.format_number(one.lowest_cut)
        span = f"{one.first_line} to {last_lines[one.tool]}"
        cells = (f"T{one.tool}", lengths.format_short_number(tool.diameter), span, low)
        for number, (at, words) in enumerate(zip(ends[1:], cells, strict=True)):
            anchor = "end" if number == len(cells) - 1 else "start"
            column.scene.add_text((at, y), words, SIZE, anchor, bold=number == 0, fill=BLACK)
        column.y += 1.35 * SIZE
        if tool.name:
            shown = shorten_text(tool.name, NOTE, column.width - SWATCH - 8 - (ends[1] - ends[0]))
            column.scene.add_text((ends[1], column.y + 3), shown, NOTE, fill=GREY)
            column.y += 1.3 * NOTE
    if len(figures) > MOST_TOOLS:
        column.write_paragraph(f"and {len(figures) - MOST_TOOLS} more", NOTE, fill=fill, indent=SWATCH + 8)
    column.y += 3


def list_tools_above_pegs(path: PlannedPath) -> list[str]:
    """Return the names ("T3") of the tools that never come down to the pegs' height.

    Returns [] where that height is not known.
    """
    if path.peg_height is None:
        return []
    return [f"T{one.tool}" for one in measure_tools(path.program) if one.lowest > path.peg_height]


def describe_clearance(path: PlannedPath, lengths: LengthUnit) -> str:
    """Return a sentence on the move that comes nearest to the fixture."""
    near = path.passing
    if path.peg_height is None:
        # That all tools keep clear of what friction holds with is asked of each set-up.
        held_by = "locators and straps" if path.fixture.pegs else "jaws, work stop, parallels and bed"
        return f"All tools keep {lengths.format_length(path.program.clearance)} or more from {held_by}."
    if near is None or near.distance == inf:
        return "No tool comes down to where anything holds the part."
    where = (
        f"T{near.tool} in line {near.line}, {lengths.format_length(near.distance)} from the {near.element}"
    )
    return f"Nearest to what holds the part: {where}."
