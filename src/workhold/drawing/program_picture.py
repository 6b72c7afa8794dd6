"""A picture of a program from above: where its tools go, by tool and by height, rapid moves dashed."""

from __future__ import annotations

from workhold.drawing.annotation import scale_bar
from workhold.drawing.bench import outline_path
from workhold.drawing.panel import plural
from workhold.drawing.path_drawn import COLOURS, SHADES, PagePaths, draw_paths, heights_cut, shaded
from workhold.drawing.scene import (
    BLACK,
    GREY,
    LANDSCAPE,
    Box,
    LengthUnit,
    Scene,
    View,
    shortened,
)
from workhold.model.program import Program
from workhold.model.program_figures import ToolFigures, tip_box, tool_figures
from workhold.model.workpiece import Workpiece
from workhold.units import MILLIMETRE, Unit

__all__ = ["draw_program"]

EDGE, HEADER, FOOTER, SIDE = 32.0, 62.0, 30.0, 268.0
PART = "#eceff2"
LEGEND_ROW = 62.0
MOST_LISTED = 8


def draw_program(program: Program, *, workpiece: Workpiece | None = None, unit: Unit = MILLIMETRE) -> str:
    """Draws the paths of a program's tools on A4.

    Parameters
    ----------
    workpiece : the part, drawn below them.
    unit : of the lengths written.

    Returns
    -------
    str
        SVG text; the group of class ``paths`` carries the map from mm to the page.
    """
    figures = tool_figures(program)
    bounds = bounds_of(program, workpiece)
    lengths = LengthUnit.suiting(unit, max(bounds.width, bounds.height))
    width, height = LANDSCAPE
    room = Box(EDGE, EDGE + HEADER, width - EDGE - SIDE, height - EDGE - FOOTER)
    view = View.fitting(bounds, room.grown(-8))
    scene = Scene.page(LANDSCAPE, f"{program.name}: paths of the tools")
    group = scene.group("header")
    group.text((EDGE, EDGE + 12), shortened(program.name, 26, width - 2 * EDGE, bold=True), 26, bold=True)
    words = f"{plural(len(program.moves), 'move')} of {plural(len(figures), 'tool')}, seen from above"
    group.text((EDGE, EDGE + 40), words, 14, fill=GREY)
    if workpiece is not None:
        d = outline_path(workpiece.loop_segments, view)
        scene.group("part", view).path(d, BLACK, 1.2, PART, fill_rule="evenodd")
    paths = scene.group("paths", view)
    draw_paths(paths, program, PagePaths.of(program.moves, view))
    levels = heights_cut(program)
    draw_zero(scene, view(program.zero))
    draw_legend(
        scene,
        program,
        figures,
        levels,
        lengths,
        Box(width - EDGE - SIDE + 20, room.y0, width - EDGE, room.y1),
    )
    scale_bar(scene, (EDGE, height - EDGE), view.scale, lengths)
    return scene.svg()


def bounds_of(program: Program, workpiece: Workpiece | None) -> Box:
    """What is shown, in mm: all that the flutes sweep at their paths, the zero and the part."""
    low, high = tip_box(program.moves)
    around = max(tool.diameter for tool in program.tools.values()) / 2
    corners = [
        (low[0] - around, low[1] - around),
        (high[0] + around, high[1] + around),
        program.zero,
    ]
    if workpiece is not None:
        x0, y0, x1, y1 = workpiece.bounds
        corners += [(x0, y0), (x1, y1)]
    xs, ys = zip(*corners, strict=True)
    return Box(float(min(xs)), float(min(ys)), float(max(xs)), float(max(ys)))


def draw_zero(scene: Scene, at: tuple[float, float]) -> None:
    """Draws the program's X0 Y0 with its axes."""
    group = scene.group("program-zero")
    x, y = at
    group.arrow((x, y), (x + 34, y), BLACK, 1.4, 8)
    group.arrow((x, y), (x, y - 34), BLACK, 1.4, 8)
    group.circle((x, y), 4, "#ffffff", BLACK, 1.4)
    group.text((x + 42, y), "X", 12, "middle", halo=2)
    group.text((x, y - 43), "Y", 12, "middle", halo=2)


def draw_legend(
    scene: Scene,
    program: Program,
    figures: tuple[ToolFigures, ...],
    levels: tuple[float, float],
    lengths: LengthUnit,
    box: Box,
) -> None:
    """Lists the tools with their colours, and says what shades and dashes mean."""
    group = scene.group("legend")
    y = box.y0 + 8
    for place, one in enumerate(figures[:MOST_LISTED]):
        tool = program.tools[one.tool]
        group.line([(box.x0, y), (box.x0 + 26, y)], COLOURS[place % len(COLOURS)], 8, stroke_linecap="round")
        head = f"T{one.tool}  Ø {lengths.short(tool.diameter)}"
        group.text((box.x0 + 40, y), head, 14, bold=True)
        words = [tool.name] if tool.name else []
        if one.lowest_cut is not None:
            words.append(f"down to z {lengths.number(one.lowest_cut)}")
        for line, text in enumerate(words):
            shown = shortened(text, 12, box.width - 40)
            group.text((box.x0 + 40, y + 19 + 17 * line), shown, 12, fill=GREY)
        y += LEGEND_ROW
    if len(figures) > MOST_LISTED:
        group.text((box.x0 + 40, y), f"and {plural(len(figures) - MOST_LISTED, 'tool')} more", 12, fill=GREY)
        y += LEGEND_ROW
    y += 8
    for level in range(SHADES):
        x = box.x0 + 22 * level
        group.rectangle(Box(x, y - 6, x + 22, y + 6), shaded(COLOURS[0], level))
    low, high = (lengths.number(level) for level in levels)
    group.text((box.x0, y + 20), f"dark at z {low}, light at z {high} {lengths.sign}", 12, fill=GREY)
    y += 52
    group.line([(box.x0, y), (box.x0 + 34, y)], GREY, 1.2, stroke_dasharray="6 5")
    group.text((box.x0 + 44, y), "rapid move", 12, fill=GREY)
