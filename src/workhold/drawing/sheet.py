"""The setup sheet: one fixture on paper, to a standard scale, with all that is needed to build it."""

from __future__ import annotations

from attrs import evolve

from workhold.drawing.annotation import scale_bar
from workhold.drawing.bench import Bench, bench_of
from workhold.drawing.carriers import most_holes
from workhold.drawing.panel import TextColumn
from workhold.drawing.path_drawn import PlannedPath
from workhold.drawing.plan import draw_plan
from workhold.drawing.scene import BLACK, UNITS_PER_MM, Box, LengthUnit, Scene, View, shortened, text_width
from workhold.drawing.sheet_blocks import blocks_of
from workhold.drawing.sheet_facts import PAPERS, SheetDetails, cautions_of, edge_distances
from workhold.drawing.sheet_layout import (
    FOOT,
    MARGIN,
    MOST_FIGURE,
    Filled,
    PageLayout,
    arranged,
    inner_box,
    plan_room,
    standard_scale,
)
from workhold.drawing.sheet_writing import Sheet, heights_of
from workhold.drawing.side_drawing import SideFigure
from workhold.drawing.side_view import side_view
from workhold.drawing.supports_drawn import PlannedSupports
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Fixture
from workhold.model.setup import part_zero
from workhold.model.workpiece import Workpiece

__all__ = ["draw_sheet"]

PAPER_NAMES = {"a4": "A4", "letter": "Letter"}
# A cell for the part's name narrower than this, in page units, is left out of the foot.
NARROWEST_NAME = 90.0
# Part zero and the hole that places are measured from are shown on the plan up to so many pitches beside it.
NEAR = 2


def draw_sheet(
    fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit, details: SheetDetails
) -> tuple[str, ...]:
    """Draws the setup sheet of a fixture, lying or upright, whichever shows the part largest.

    The groups of class ``part`` and ``pegs`` carry the map from the vise frame (mm) to the page in their
    attribute ``data-model-to-page``, written as an SVG matrix. On paper its scale is a standard one.

    Returns
    -------
    tuple of str
        SVG text of every page, each of the paper's size.
    """
    bench = bench_of(fixture, workpiece, toolkit)
    details = details if details.zero else evolve(details, zero=part_zero(workpiece))
    lengths = LengthUnit.suiting(details.unit, bench.shown.pitch)
    cautions = cautions_of(fixture, toolkit, edge_distances(fixture, workpiece, toolkit), details, lengths)
    heights = heights_of(fixture, workpiece, toolkit, details)
    sheet = Sheet(fixture, workpiece, toolkit, details, lengths, tuple(cautions), heights)
    figure = figure_of(sheet, bench)
    zero = sheet.zero_place
    near = bench.extent.grown(NEAR * bench.shown.pitch)
    zero_box, origin_box = Box(*zero, *zero), Box(0.0, 0.0, 0.0, 0.0)
    sheet = evolve(sheet, zero_shown=near.contains(zero_box), origin_shown=near.contains(origin_box))
    extent = bench.extent.union(zero_box) if sheet.zero_shown else bench.extent
    extent = extent.union(origin_box) if sheet.origin_shown else extent
    path = None
    if details.program is not None:
        path = PlannedPath(details.program, fixture, details.passing)
        extent = path.grown(extent)
    width, height = (UNITS_PER_MM * side for side in PAPERS[details.paper])
    layout = arranged((width, height), extent, *blocks_of(sheet), figure)
    scene = new_page(layout, sheet)
    room = layout.plan
    view = View.fitting(extent, plan_room(room), layout.scale.factor * UNITS_PER_MM)
    marks = [(zero, "X0 Y0")] if sheet.zero_shown else []
    if sheet.origin_shown and all(peg.hole != sheet.datum.name for peg in fixture.pegs):
        marks.append(((0.0, 0.0), sheet.datum.mark))
    planned = None if details.supports is None else PlannedSupports.of(details.supports)
    draw_plan(scene, bench, view, workpiece, room, lengths, marks, angle="θ", supports=planned, path=path)
    words = f", scale {layout.scale.name}"
    if not most_holes(view, bench.shown):
        words += "; only the holes near the pegs are drawn"
    scale_bar(scene, (room.x0, room.y1), view.scale, lengths, more=words)
    pages = [scene]
    write_columns(scene, layout.columns)
    for columns in layout.more:
        pages.append(new_page(layout, sheet))
        write_columns(pages[-1], columns)
    if figure is not None and layout.figure is not None:
        most = MOST_FIGURE * inner_box(layout.page).height
        figure.draw(pages[1], layout.figure, most, layout.scale.factor)
    for number, page in enumerate(pages, 1):
        draw_foot(page, layout, sheet, f"{number} of {len(pages)}")
    return tuple(page.svg() for page in pages)


def figure_of(sheet: Sheet, bench: Bench) -> SideFigure | None:
    """The view from the side; None where nobody knows how thick the part is."""
    if sheet.heights is None:
        return None
    view = side_view(bench, sheet.workpiece, sheet.heights, sheet.details.supports)

    def scale_of(largest: float) -> tuple[str, float]:
        scale = standard_scale(largest)
        return scale.name, scale.factor

    first, *others = sheet.toolkit.plates
    return SideFigure(view, sheet.lengths, scale_of, f"{first.noun}{'s' * bool(others)}")


def new_page(layout: PageLayout, sheet: Sheet) -> Scene:
    """An empty page."""
    return Scene.page(layout.page, f"{sheet.name}: setup sheet of fixture {sheet.details.number}")


def write_columns(scene: Scene, columns: tuple[Filled, ...]) -> None:
    """Writes the blocks of each column."""
    group = scene.group("words")
    for box, blocks in columns:
        column = TextColumn(group, box.x0, box.y0, box.width)
        for block in blocks:
            block(column)


def draw_foot(scene: Scene, layout: PageLayout, sheet: Sheet, page: str) -> None:
    """Draws the foot, a line of cells as in the title block of a drawing."""
    details, (width, height) = sheet.details, layout.page
    box = Box(MARGIN, height - MARGIN - FOOT + 10, width - MARGIN, height - MARGIN)
    cells = [
        (details.listed_as, f"{details.number} of {details.count}"),
        ("Scale", f"{layout.scale.name} on {PAPER_NAMES[details.paper]}"),
        ("Print at", "100 %"),
        ("Lengths", sheet.lengths.unit.name),
        ("Date", details.day.isoformat()),
        *([("Result file, SHA-256", f"{details.result_hash[:12]}…")] if details.result_hash else []),
        ("Program", f"workhold {details.version}"),
        ("Page", page),
    ]
    widths = [max(text_width(name, 9), text_width(value, 12, bold=True)) + 16 for name, value in cells]
    room = box.width - sum(widths)
    if room >= NARROWEST_NAME:
        cells.insert(0, ("Part", shortened(sheet.name, 12, room - 16, bold=True)))
        widths.insert(0, room)
    else:
        widths = [cell + room / len(cells) for cell in widths]
    group = scene.group("foot")
    group.rectangle(box, "#ffffff", BLACK, 1.4)
    x = box.x0
    for (name, value), cell in zip(cells, widths, strict=True):
        if x > box.x0:
            group.line([(x, box.y0), (x, box.y1)], BLACK, 0.8)
        group.text((x + 8, box.y0 + 9), name, 9)
        group.text((x + 8, box.y0 + 23), value, 12, bold=True)
        x += cell
