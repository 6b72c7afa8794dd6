"""A picture of a program from above: where its tools go, by tool and by height, rapid moves dashed."""

from __future__ import annotations

from math import atan, ceil, hypot, pi

import numpy as np
from numpy.typing import NDArray

from workhold.drawing.annotation import scale_bar
from workhold.drawing.bench import outline_path
from workhold.drawing.panel import plural
from workhold.drawing.scene import (
    BLACK,
    GREY,
    LANDSCAPE,
    Box,
    LengthUnit,
    Scene,
    View,
    number,
    shortened,
)
from workhold.model.moves import along
from workhold.model.program import Program
from workhold.model.program_figures import ToolFigures, tip_box, tool_figures
from workhold.model.workpiece import Workpiece
from workhold.units import MILLIMETRE, Unit

__all__ = ["draw_program"]

EDGE, HEADER, FOOTER, SIDE = 32.0, 62.0, 30.0, 268.0
# A colour for each tool, in the order in which they move; they begin again after the last.
COLOURS = ("#1f6fb4", "#d1660d", "#2a8f4d", "#8a4fb0", "#c0392b", "#138a8a", "#8a6d1f", "#b8437f")
# Shades of a tool's colour by height: mixed with white above, with black below.
SHADES = 6
LIGHT, DARK = 0.6, 0.45
BAND = "0.13"
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
    paths = scene.group("paths", view, stroke_linecap="round")
    draw_bands(paths, program, figures, view)
    draw_rapids(paths, program, view)
    levels = heights_cut(program)
    draw_cuts(paths, program, figures, view, levels)
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


def heights_cut(program: Program) -> tuple[float, float]:
    """The least and the greatest height of the tip at cutting moves, in mm."""
    cut = program.moves.cutting
    heights = np.concatenate([program.moves.start[cut, 2], program.moves.end[cut, 2], [program.z_zero]])
    return float(heights.min()), float(heights.max())


def path_data(program: Program, rows: NDArray[np.int64], view: View) -> str:
    """SVG path data of some moves; a move that goes on where the last one ended begins no new line."""
    moves = program.moves
    start, end, bulge = moves.start[rows, :2], moves.end[rows, :2], moves.bulge[rows]
    middle = along(start, end, bulge, np.full(len(rows), 0.5))
    found, last = [], None
    for one, other, half, bent in zip(
        start.tolist(), end.tolist(), middle.tolist(), bulge.tolist(), strict=True
    ):
        if one != last:
            found.append("M{} {}".format(*map(number, view(one))))
        last = other
        if not bent:
            found.append("L{} {}".format(*map(number, view(other))))
            continue
        sweep = 4 * abs(atan(bent))
        radius = number(
            hypot(other[0] - one[0], other[1] - one[1]) * (1 + bent * bent) / (4 * abs(bent)) * view.scale
        )
        # Half a turn is drawn in two pieces, of which the direction is clear.
        ends = [other] if ceil(sweep / (0.9 * pi)) == 1 else [half, other]
        for place in ends:
            x, y = map(number, view(place))
            found.append(f"A{radius} {radius} 0 0 {0 if bent > 0 else 1} {x} {y}")
    return "".join(found)


def draw_bands(paths: Scene, program: Program, figures: tuple[ToolFigures, ...], view: View) -> None:
    """Draws what the flutes sweep at cutting moves, as broad lines that one can look through."""
    for place, one in enumerate(figures):
        rows = np.flatnonzero((program.moves.tool == one.tool) & program.moves.cutting)
        if len(rows):
            wide = program.tools[one.tool].diameter * view.scale
            paths.path(
                path_data(program, rows, view),
                COLOURS[place % len(COLOURS)],
                wide,
                stroke_opacity=BAND,
                **{"class": "band"},
            )


def draw_rapids(paths: Scene, program: Program, view: View) -> None:
    """Draws rapid moves, dashed."""
    flat = (program.moves.start[:, :2] != program.moves.end[:, :2]).any(axis=1)
    rows = np.flatnonzero(~program.moves.cutting & flat)
    if len(rows):
        paths.path(path_data(program, rows, view), GREY, 1.0, stroke_dasharray="6 5", **{"class": "rapid"})


def draw_cuts(
    paths: Scene,
    program: Program,
    figures: tuple[ToolFigures, ...],
    view: View,
    levels: tuple[float, float],
) -> None:
    """Draws the axis at cutting moves, the higher ones first; upright moves are dots."""
    moves = program.moves
    middle = (moves.start[:, 2] + moves.end[:, 2]) / 2
    low, high = levels
    shade = np.clip(((middle - low) / max(high - low, 1e-9) * SHADES).astype(int), 0, SHADES - 1)
    upright = (moves.start[:, :2] == moves.end[:, :2]).all(axis=1)
    for level in range(SHADES - 1, -1, -1):
        for place, one in enumerate(figures):
            own = (moves.tool == one.tool) & moves.cutting & (shade == level)
            colour = shaded(COLOURS[place % len(COLOURS)], level)
            for rows, wide in ((np.flatnonzero(own & ~upright), 1.8), (np.flatnonzero(own & upright), 5.0)):
                if len(rows):
                    paths.path(path_data(program, rows, view), colour, wide, **{"class": f"cut-{one.tool}"})


def shaded(colour: str, level: int) -> str:
    """A colour at a level, from 0, the lowest and darkest.

    >>> shaded("#808080", 0), shaded("#808080", SHADES - 1)
    ('#464646', '#cccccc')
    """
    share = level / (SHADES - 1)
    parts = [int(colour[k : k + 2], 16) for k in (1, 3, 5)]
    if share < 0.5:
        mixed = [part * (1 - DARK * (1 - 2 * share)) for part in parts]
    else:
        mixed = [part + (255 - part) * LIGHT * (2 * share - 1) for part in parts]
    return "#" + "".join(f"{int(part):02x}" for part in mixed)


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
