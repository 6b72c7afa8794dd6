"""Pictures of fixtures: one on a sheet to set the vise from, and small ones to choose among."""

from __future__ import annotations

from collections.abc import Sequence

from attrs import frozen

from workhold.drawing.annotation import scale_bar
from workhold.drawing.bench import Bench, bench_of, draw_bench, draw_inset
from workhold.drawing.carriers import most_holes
from workhold.drawing.panel import (
    TextColumn,
    closure_margin,
    draw_legend,
    draw_peg_table,
    draw_settings,
    draw_title,
    plural,
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
    shortened,
    text_width,
)
from workhold.errors import InputError
from workhold.fixels.toolkit import Toolkit
from workhold.listing.identity import Entries
from workhold.model.fixture import Fixture
from workhold.model.result import Result
from workhold.model.workpiece import Workpiece
from workhold.units import MILLIMETRE, Unit

__all__ = ["MOST_THUMBNAILS", "best_at_a_glance", "draw_fixture", "draw_thumbnail", "draw_thumbnails"]

EDGE = 32.0
PANEL = 326.0
SCALE_BAR = 36.0
HIGHEST_INSET = 320.0


@frozen
class Layout:
    """Where the drawing and the panel go on a page."""

    page: tuple[float, float]
    drawing: Box
    panel: Box

    def view(self, extent: Box) -> View:
        """The largest view of an extent (mm) that leaves room for the lettering."""
        box = self.drawing
        inner = Box(box.x0 + LEFT, box.y0 + TOP, box.x1 - RIGHT, box.y1 - BOTTOM - SCALE_BAR)
        return View.fitting(extent, inner)


def layout_on(page: tuple[float, float]) -> Layout:
    """A page with the panel at the right."""
    width, height = page
    split = width - EDGE - PANEL
    return Layout(
        page, Box(EDGE, EDGE, split - 24, height - EDGE), Box(split, EDGE, width - EDGE, height - EDGE)
    )


def draw_fixture(
    fixture: Fixture,
    workpiece: Workpiece,
    toolkit: Toolkit,
    *,
    title: str | None = None,
    unit: Unit = MILLIMETRE,
    path: PlannedPath | None = None,
) -> str:
    """Draws a fixture on an A4 sheet, landscape, or portrait when that shows it much larger.

    The groups of class ``part`` and ``pegs`` carry the map from the vise frame (mm) to the page in their
    attribute ``data-model-to-page``, written as an SVG matrix.

    Parameters
    ----------
    title : what to call the fixture, such as ``Fixture 3 of 70``.
    unit : of the lengths written.
    path : of a program's tools, to draw as well.

    Returns
    -------
    str
        SVG text.
    """
    bench = bench_of(fixture, workpiece, toolkit)
    extent = bench.extent if path is None else path.grown(bench.extent)
    lengths = LengthUnit.suiting(unit, bench.shown.pitch)
    landscape, portrait = layout_on(LANDSCAPE), layout_on(PORTRAIT)
    layout = portrait if portrait.view(extent).scale > 1.15 * landscape.view(extent).scale else landscape
    view = layout.view(extent)
    scene = Scene.page(layout.page, f"{workpiece.name}: {title or 'Fixture'}")
    draw_plan(scene, bench, view, workpiece, layout.drawing, lengths, path=path)
    scale_bar(scene, (layout.drawing.x0, layout.drawing.y1), view.scale, lengths)
    draw_panel(scene, layout.panel, bench, view, workpiece, title, lengths, path)
    return scene.svg()


def draw_panel(
    scene: Scene,
    panel: Box,
    bench: Bench,
    view: View,
    workpiece: Workpiece,
    title: str | None,
    lengths: LengthUnit,
    path: PlannedPath | None,
) -> None:
    """Writes the panel, with the part as drawn at its foot; ``view`` is that of the drawing beside it."""
    group, fixture = scene.group("panel"), bench.fixture
    group.line([(panel.x0 - 12, panel.y0), (panel.x0 - 12, panel.y1)], GREY, 0.8)
    column = TextColumn(group, panel.x0, panel.y0, panel.width)
    draw_title(column, fixture, workpiece, bench.toolkit, title)
    draw_settings(column, fixture, bench.toolkit, lengths)
    draw_peg_table(column, fixture, bench.toolkit, lengths)
    if path is not None:
        write_path(column, path, lengths, GREY)
        column.rule()
    draw_legend(column, bench.toolkit)
    if not most_holes(view, bench.shown):
        column.words("Only the holes near the pegs are drawn.", 11.5, fill=GREY)
    column.rule()
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
    """Draws one fixture as a small picture without any words, to stand beside a text.

    Returns
    -------
    str
        SVG text.
    """
    bench = bench_of(fixture, workpiece, toolkit)
    width, height = ALONE
    scene = Scene.page(ALONE, workpiece.name)
    view = View.fitting(bench.extent, Box(RIM, RIM, width - RIM, height - RIM))
    draw_bench(scene, bench, view, weight=0.7, longest=26.0, axes=False)
    return scene.svg()


def draw_thumbnails(
    fixtures: Sequence[Fixture],
    workpiece: Workpiece,
    toolkit: Toolkit,
    titles: Sequence[str],
    *,
    unit: Unit = MILLIMETRE,
) -> str:
    """Draws up to twelve fixtures on an A4 sheet to one scale, with type, closure margin and opening.

    Parameters
    ----------
    titles : what to call each of them, such as its rank.
    unit : of the lengths written.

    Returns
    -------
    str
        SVG text.

    Raises
    ------
    InputError
        For no fixture, more than twelve, or another number of titles.
    """
    count = len(fixtures)
    if not 1 <= count <= MOST_THUMBNAILS:
        raise InputError(
            f"a sheet of thumbnails holds 1 to {MOST_THUMBNAILS} fixtures, not {count}: choose fewer."
        )
    if len(titles) != count:
        raise InputError(f"{count} fixtures have {len(titles)} titles: give one title for each.")
    benches = [bench_of(fixture, workpiece, toolkit) for fixture in fixtures]
    lengths = LengthUnit.suiting(unit, benches[0].shown.pitch)
    cells = grid(count)
    rooms = [Box(cell.x0 + 8, cell.y0 + 8, cell.x1 - 8, cell.y1 - CAPTION) for cell in cells]
    scale = min(View.fitting(bench.extent, room).scale for bench, room in zip(benches, rooms, strict=True))
    scene = Scene.page(LANDSCAPE, f"{workpiece.name}: fixtures")
    width, height = LANDSCAPE
    words = f"{plural(count, 'fixture')}, all to the same scale"
    name = shortened(workpiece.name, 24, width - 2 * EDGE - text_width(words, 14) - 20, bold=True)
    scene.text((EDGE, EDGE + 10), name, 24, bold=True)
    scene.text((width - EDGE, EDGE + 10), words, 14, "end", fill=GREY)
    for bench, title, cell, room in zip(benches, titles, cells, rooms, strict=True):
        draw_cell(scene, bench, title, cell, View.fitting(bench.extent, room, scale), lengths)
    scale_bar(scene, (EDGE, height - EDGE + 8), scale, lengths)
    return scene.svg()


def best_at_a_glance(result: Result, shown: Entries, unit: Unit = MILLIMETRE) -> str:
    """Thumbnails of the first twelve entries of a result as SVG text, with ranks and numbers of near
    duplicates.

    Raises
    ------
    InputError
        For no entry.
    """
    indices, like = (numbers[:MOST_THUMBNAILS].tolist() for numbers in (shown.index, shown.like))
    titles = [
        f"{index + 1}{f', and {more:,} like it' * bool(more)}"
        for index, more in zip(indices, like, strict=True)
    ]
    fixtures = [result[index] for index in indices]
    return draw_thumbnails(fixtures, result.workpiece, result.toolkit, titles, unit=unit)


def grid(count: int) -> list[Box]:
    """Equal cells for a number of thumbnails, row by row: at most four across and three down."""
    across = next(columns for columns, most in ((1, 1), (2, 4), (3, 6), (4, 12)) if count <= most)
    down = -(-count // across)
    width = (LANDSCAPE[0] - 2 * EDGE - (across - 1) * GAP) / across
    height = (LANDSCAPE[1] - 2 * EDGE - HEADER - FOOTER - (down - 1) * GAP) / down
    cells = []
    for k in range(count):
        x, y = EDGE + (k % across) * (width + GAP), EDGE + HEADER + (k // across) * (height + GAP)
        cells.append(Box(x, y, x + width, y + height))
    return cells


def draw_cell(scene: Scene, bench: Bench, title: str, cell: Box, view: View, lengths: LengthUnit) -> None:
    """Draws one thumbnail with its caption."""
    group = scene.group("thumbnail")
    group.rectangle(cell, "#ffffff", "#b9bec6", 1.0, 5)
    draw_bench(group, bench, view, weight=0.55, longest=26.0, axes=False)
    fixture, width = bench.fixture, cell.width - 20
    kind = bench.toolkit.arrangement(fixture.type, fixture.direction).short_title
    name = shortened(title, 15, width - text_width(kind, 13, bold=True) - 10, bold=True)
    group.text((cell.x0 + 10, cell.y1 - 30), name, 15, bold=True)
    group.text((cell.x1 - 10, cell.y1 - 30), kind, 13, "end", bold=True)
    group.text((cell.x0 + 10, cell.y1 - 12), f"margin {closure_margin(fixture)}", 12, fill=GREY)
    if bench.shown.measured:
        settings = [measured.setting for measured in bench.shown.measured]
        signs = " and ".join(dict.fromkeys(setting.sign for setting in settings))
        words = f"{signs} = {', '.join(lengths.words(setting.length) for setting in settings)}"
        group.text((cell.x1 - 10, cell.y1 - 12), words, 12, "end", fill=GREY)
