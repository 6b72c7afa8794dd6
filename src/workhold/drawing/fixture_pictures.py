"""Pictures of fixtures: one on a sheet to set the vise from, and small ones to choose among."""

from __future__ import annotations

from collections.abc import Sequence

from workhold.drawing.annotation import draw_scale_bar
from workhold.drawing.bench import BenchDrawing, draw_bench, draw_inset, make_bench
from workhold.drawing.carriers import limit_holes_drawn
from workhold.drawing.hold_blocks import draw_hold_panel
from workhold.drawing.panel import (
    TextColumn,
    draw_legend,
    draw_peg_table,
    draw_settings,
    draw_title,
    format_closure_margin,
    format_count,
)
from workhold.drawing.path_drawn import PlannedPath
from workhold.drawing.plan import BOTTOM, LEFT, RIGHT, TOP, draw_plan
from workhold.drawing.program_picture import write_path
from workhold.drawing.scene import (
    GREY,
    LANDSCAPE,
    PORTRAIT,
    Box,
    LengthUnit,
    Scene,
    View,
    measure_text,
    shorten_text,
)
from workhold.errors import InputError
from workhold.fixels.toolkit import Toolkit
from workhold.listing.identity import ShownEntries
from workhold.model.fixture import Fixture
from workhold.model.jaw_hold import JawHold
from workhold.model.result import Result
from workhold.model.straps import StrappedHold
from workhold.model.workpiece import Workpiece
from workhold.units import MILLIMETRE, Unit

__all__ = [
    "MOST_THUMBNAILS",
    "draw_best_thumbnails",
    "arrange_cells",
    "draw_fixture",
    "draw_heading",
    "draw_thumbnail",
    "draw_thumbnails",
]

EDGE = 32.0
PANEL, GUTTER = 326.0, 24.0
SCALE_BAR = 36.0
HIGHEST_INSET = 320.0


def place_drawing_on_page(page: tuple[float, float], extent: Box) -> tuple[Box, View]:
    """Return (page box of the drawing, view): the box is beside the panel of words.

    The view is the largest one that shows an extent (mm) and leaves room in the box for lettering.
    """
    box = Box(EDGE, EDGE, page[0] - EDGE - PANEL - GUTTER, page[1] - EDGE)
    inner = Box(box.x0 + LEFT, box.y0 + TOP, box.x1 - RIGHT, box.y1 - BOTTOM - SCALE_BAR)
    return box, View.fit_box(extent, inner)


def draw_fixture(
    fixture: Fixture,
    workpiece: Workpiece,
    toolkit: Toolkit,
    *,
    title: str | None = None,
    unit: Unit = MILLIMETRE,
    path: PlannedPath | None = None,
) -> str:
    """Return the drawing of a fixture on an A4 sheet, landscape, or portrait when that shows it much larger.

    The groups of class ``part`` and ``pegs`` carry the map from the vise frame (mm) to the page in their
    attribute ``data-model-to-page``, written as an SVG matrix.

    Parameters
    ----------
    title : what to call the fixture, such as ``Fixture 3 of 70``.
    path : the paths of a program's tools, to draw as well.

    Returns
    -------
    str
        SVG text.
    """
    bench = make_bench(fixture, workpiece, toolkit)
    extent = bench.extent if path is None else path.enlarge_extent(bench.extent)
    lengths = LengthUnit.from_typical_length(unit, bench.shown.pitch)
    page, (drawing, view) = LANDSCAPE, place_drawing_on_page(LANDSCAPE, extent)
    upright, upright_view = place_drawing_on_page(PORTRAIT, extent)
    if upright_view.scale > 1.15 * view.scale:
        page, drawing, view = PORTRAIT, upright, upright_view
    scene = Scene.make_page(page, f"{workpiece.name}: {title or 'Fixture'}")
    draw_plan(scene, bench, view, workpiece, drawing, lengths, path=path)
    draw_scale_bar(scene, (drawing.x0, drawing.y1), view.scale, lengths)
    panel = Box(drawing.x1 + GUTTER, drawing.y0, page[0] - EDGE, drawing.y1)
    draw_panel(scene, panel, bench, view, workpiece, title, lengths, path)
    return scene.to_svg()


def draw_panel(
    scene: Scene,
    panel: Box,
    bench: BenchDrawing,
    view: View,
    workpiece: Workpiece,
    title: str | None,
    lengths: LengthUnit,
    path: PlannedPath | None,
) -> None:
    """Write the panel of words, and draw the part as it was drawn at the panel's lower end.

    ``view`` is the view of the drawing beside the panel.
    """
    group, fixture = scene.group("panel"), bench.fixture
    group.add_line([(panel.x0 - 12, panel.y0), (panel.x0 - 12, panel.y1)], GREY, 0.8)
    column = TextColumn(group, panel.x0, panel.y0, panel.width)
    draw_title(column, fixture, workpiece, bench.toolkit, title)
    if fixture.hold is not None:
        draw_hold_panel(column, fixture, workpiece, bench.toolkit, lengths)
        room = Box(panel.x0, column.y, panel.x1, min(panel.y1, column.y + HIGHEST_INSET))
        draw_inset(group, room, workpiece, fixture, bench.toolkit)
        return
    draw_settings(column, fixture, bench.toolkit, lengths)
    draw_peg_table(column, fixture, bench.toolkit, lengths)
    if path is not None:
        write_path(column, path, lengths, GREY)
        column.draw_rule()
    draw_legend(column, bench.toolkit)
    if not limit_holes_drawn(view, bench.shown):
        column.write_line("Only the holes near the pegs are drawn.", 11.5, fill=GREY)
    column.draw_rule()
    room = Box(panel.x0, column.y, panel.x1, min(panel.y1, column.y + HIGHEST_INSET))
    draw_inset(group, room, workpiece, fixture, bench.toolkit)


MOST_THUMBNAILS = 12
HEADER = 50.0
FOOTER = 26.0
CAPTION = 44.0
GAP = 14.0
# A thumbnail by itself, in page units.
ALONE, RIM = (320.0, 240.0), 6.0


def draw_thumbnail(fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit) -> str:
    """Return one fixture as a small picture without words, to be placed beside a text.

    Returns
    -------
    str
        SVG text.
    """
    bench = make_bench(fixture, workpiece, toolkit)
    scene = Scene.make_page(ALONE, workpiece.name)
    view = View.fit_box(bench.extent, Box(0.0, 0.0, *ALONE).grow(-RIM))
    draw_bench(scene, bench, view, weight=0.7, longest=26.0, axes=False)
    return scene.to_svg()


def draw_thumbnails(
    fixtures: Sequence[Fixture],
    workpiece: Workpiece,
    toolkit: Toolkit,
    titles: Sequence[str],
    *,
    unit: Unit = MILLIMETRE,
) -> str:
    """Return pictures of up to twelve fixtures, all to one scale, on an A4 sheet, as SVG text.

    Each has its title (such as its rank), its type, a figure of quality and its openings below it.

    Raises
    ------
    InputError
        For no fixture, more than twelve, or another number of titles than of fixtures.
    """
    count = len(fixtures)
    if not 1 <= count <= MOST_THUMBNAILS:
        raise InputError(
            f"a sheet of thumbnails holds 1 to {MOST_THUMBNAILS} fixtures, not {count}: choose fewer."
        )
    if len(titles) != count:
        raise InputError(f"{count} fixtures have {len(titles)} titles: give one title for each.")
    benches = [make_bench(fixture, workpiece, toolkit) for fixture in fixtures]
    lengths = LengthUnit.from_typical_length(unit, benches[0].shown.pitch)
    scene = Scene.make_page(LANDSCAPE, f"{workpiece.name}: fixtures")
    draw_heading(scene, workpiece.name, f"{format_count(count, 'fixture')}, all to the same scale")
    cells = arrange_cells([bench.extent for bench in benches])
    for bench, title, (cell, view) in zip(benches, titles, cells, strict=True):
        draw_cell(scene, bench, title, cell, view, lengths)
    draw_scale_bar(scene, (EDGE, LANDSCAPE[1] - EDGE + 8), cells[0][1].scale, lengths)
    return scene.to_svg()


def draw_heading(scene: Scene, name: str, words: str) -> None:
    """Write a heading on a page of small pictures: ``name`` at the upper left,
    ``words`` at the upper right.
    """
    width = LANDSCAPE[0]
    name = shorten_text(name, 24, width - 2 * EDGE - measure_text(words, 14) - 20, bold=True)
    scene.add_text((EDGE, EDGE + 10), name, 24, bold=True)
    scene.add_text((width - EDGE, EDGE + 10), words, 14, "end", fill=GREY)


def arrange_cells(extents: Sequence[Box]) -> list[tuple[Box, View]]:
    """Return (page cell, view) for each extent (mm); all views have one scale and leave room for a caption
    below.
    """
    cells = make_thumbnail_boxes(len(extents))
    rooms = [Box(cell.x0 + 8, cell.y0 + 8, cell.x1 - 8, cell.y1 - CAPTION) for cell in cells]
    scale = min(View.fit_box(extent, room).scale for extent, room in zip(extents, rooms, strict=True))
    views = [View.fit_box(extent, room, scale) for extent, room in zip(extents, rooms, strict=True)]
    return list(zip(cells, views, strict=True))


def draw_best_thumbnails(result: Result, shown: ShownEntries, unit: Unit = MILLIMETRE) -> str:
    """Return the thumbnails of the first twelve shown entries of a result, as SVG text.

    The title of each is its rank, with the number of its near duplicates.

    Raises
    ------
    InputError
        For a result without entries.
    """
    indices, like = (numbers[:MOST_THUMBNAILS].tolist() for numbers in (shown.index, shown.like))
    titles = [
        f"{index + 1}{f', and {more:,} like it' * bool(more)}"
        for index, more in zip(indices, like, strict=True)
    ]
    fixtures = [result[index] for index in indices]
    return draw_thumbnails(fixtures, result.workpiece, result.toolkit, titles, unit=unit)


def make_thumbnail_boxes(count: int) -> list[Box]:
    """Return page cells of equal size for ``count`` thumbnails (at most 12), row by row.

    There are at most four across and three down.
    """
    across = next(columns for columns, most in ((1, 1), (2, 4), (3, 6), (4, 12)) if count <= most)
    down = -(-count // across)
    width = (LANDSCAPE[0] - 2 * EDGE - (across - 1) * GAP) / across
    height = (LANDSCAPE[1] - 2 * EDGE - HEADER - FOOTER - (down - 1) * GAP) / down
    cells = []
    for k in range(count):
        x, y = EDGE + (k % across) * (width + GAP), EDGE + HEADER + (k // across) * (height + GAP)
        cells.append(Box(x, y, x + width, y + height))
    return cells


def caption_hold(fixture: Fixture, lengths: LengthUnit) -> str:
    """Return the caption of a part held by friction.

    It is the clamping force needed, if known. Otherwise it is "unfit" or "a seat" under straps, and the grip
    between flat jaws.
    """
    hold = fixture.hold
    assert hold is not None
    if hold.clamp_needed is not None:
        return f"needs {lengths.unit.format_force(hold.clamp_needed)}"
    if isinstance(hold, StrappedHold):
        return "unfit" if hold.is_unfit else "a seat"
    return f"grip {lengths.format_short(hold.grip, 4)}"


def draw_cell(
    scene: Scene, bench: BenchDrawing, title: str, cell: Box, view: View, lengths: LengthUnit
) -> None:
    """Draw one thumbnail with its caption into a page cell."""
    group = scene.group("thumbnail")
    group.add_rectangle(cell, "#ffffff", "#b9bec6", 1.0, 5)
    draw_bench(group, bench, view, weight=0.55, longest=26.0, axes=False)
    fixture, width = bench.fixture, cell.width - 20
    kind = bench.toolkit.find_arrangement(fixture.type, fixture.direction).short_title
    if isinstance(fixture.hold, JawHold):
        kind = (
            f"on {lengths.format_short(fixture.hold.parallels)}" if fixture.hold.parallels else "on the bed"
        )
    if isinstance(fixture.hold, StrappedHold):
        count = len(fixture.hold.straps)
        kind = "" if not count else "1 strap" if count == 1 else f"{count} straps"
    name = shorten_text(title, 15, width - measure_text(kind, 13, bold=True) - 10, bold=True)
    group.add_text((cell.x0 + 10, cell.y1 - 30), name, 15, bold=True)
    group.add_text((cell.x1 - 10, cell.y1 - 30), kind, 13, "end", bold=True)
    figure = caption_hold(fixture, lengths) if fixture.hold else f"margin {format_closure_margin(fixture)}"
    group.add_text((cell.x0 + 10, cell.y1 - 12), figure, 12, fill=GREY)
    if bench.shown.measured:
        settings = [measured.setting for measured in bench.shown.measured]
        signs = " and ".join(dict.fromkeys(setting.sign for setting in settings))
        words = f"{signs} = {', '.join(lengths.format_length(setting.length) for setting in settings)}"
        group.add_text((cell.x1 - 10, cell.y1 - 12), words, 12, "end", fill=GREY)
