"""The setup sheet: one fixture on paper, to a standard scale, with all that is needed to build it without asking.

One page when that costs the drawing nothing, else two or more: the first with the plan and what is set at the machine, the
others with the rest.
"""

from __future__ import annotations

from attrs import evolve

from workhold.drawing.bench import bench_of
from workhold.drawing.dimensions import scale_bar
from workhold.drawing.fonts import shortened, text_width
from workhold.drawing.length_unit import LengthUnit
from workhold.drawing.panel import Column
from workhold.drawing.plan import draw_plan
from workhold.drawing.plates import most_holes
from workhold.drawing.scene import BLACK, UNITS_PER_MM, Box, Scene, View
from workhold.drawing.sheet_arrangement import FOOT, MARGIN, Arrangement, Filled, arranged, plan_room
from workhold.drawing.sheet_blocks import blocks_of
from workhold.drawing.sheet_details import PAPERS, SheetDetails
from workhold.drawing.sheet_facts import cautions_of, edge_distances
from workhold.drawing.sheet_writing import Sheet
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Fixture
from workhold.model.part_zero import part_zero
from workhold.model.workpiece import Workpiece

__all__ = ["draw_sheet"]

PAPER_NAMES = {"a4": "A4", "letter": "Letter"}
# A cell for the part's name narrower than this, in page units, is left out of the foot.
NARROWEST_NAME = 90.0
# Part zero and the hole that places are told from are shown on the plan up to so many pitches beside it.
NEAR = 2


def draw_sheet(fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit, details: SheetDetails) -> tuple[str, ...]:
    """Draw the setup sheet of a fixture on one page or more, lying or upright, whichever shows the part largest.

    The groups of class ``part`` and ``pegs`` carry the map from the vise frame (mm) to the page in their attribute
    ``data-model-to-page``, written as an SVG matrix; on paper it is a standard scale.

    Returns
    -------
    tuple of str
        SVG text of every page, each of the paper's size.
    """
    bench = bench_of(fixture, workpiece, toolkit)
    details = details if details.zero else evolve(details, zero=part_zero(workpiece))
    lengths = LengthUnit.suiting(details.unit, bench.shown.pitch)
    cautions = cautions_of(fixture, toolkit, edge_distances(fixture, workpiece, toolkit), details, lengths)
    sheet = Sheet(fixture, workpiece, toolkit, details, lengths, tuple(cautions))
    zero = sheet.zero_place
    near = bench.extent.grown(NEAR * bench.shown.pitch)
    zero_box, origin_box = Box(*zero, *zero), Box(0.0, 0.0, 0.0, 0.0)
    sheet = evolve(sheet, zero_shown=near.contains(zero_box), origin_shown=near.contains(origin_box))
    extent = bench.extent.union(zero_box) if sheet.zero_shown else bench.extent
    extent = extent.union(origin_box) if sheet.origin_shown else extent
    width, height = (UNITS_PER_MM * side for side in PAPERS[details.paper])
    arrangement = arranged((width, height), extent, *blocks_of(sheet))
    scene = new_page(arrangement, sheet)
    room = arrangement.plan
    view = View.fitting(extent, plan_room(room), arrangement.scale.factor * UNITS_PER_MM)
    marks = [(zero, "X0 Y0")] if sheet.zero_shown else []
    if sheet.origin_shown and all(peg.hole != sheet.datum.name for peg in fixture.pegs):
        marks.append(((0.0, 0.0), sheet.datum.mark))
    draw_plan(scene, bench, view, workpiece, room, lengths, marks, angle="θ")
    words = f", scale {arrangement.scale.name}"
    if not most_holes(view, bench.shown):
        words += "; only the holes near the pegs are drawn"
    scale_bar(scene, (room.x0, room.y1), view.scale, lengths, more=words)
    pages = [scene]
    write_columns(scene, arrangement.columns)
    for columns in arrangement.more:
        pages.append(new_page(arrangement, sheet))
        write_columns(pages[-1], columns)
    for number, page in enumerate(pages, 1):
        draw_foot(page, arrangement, sheet, f"{number} of {len(pages)}")
    return tuple(page.svg() for page in pages)


def new_page(arrangement: Arrangement, sheet: Sheet) -> Scene:
    """An empty page."""
    return Scene.page(arrangement.page, f"{sheet.name}: setup sheet of fixture {sheet.details.number}")


def write_columns(scene: Scene, columns: tuple[Filled, ...]) -> None:
    """Write the blocks of each column."""
    group = scene.group("words")
    for box, blocks in columns:
        column = Column(group, box.x0, box.y0, box.width)
        for block in blocks:
            block(column)


def draw_foot(scene: Scene, arrangement: Arrangement, sheet: Sheet, page: str) -> None:
    """Draw the foot, a line of cells as in the title block of a drawing."""
    details, (width, height) = sheet.details, arrangement.page
    box = Box(MARGIN, height - MARGIN - FOOT + 10, width - MARGIN, height - MARGIN)
    cells = [
        ("Fixture", f"{details.number} of {details.count}"),
        ("Scale", f"{arrangement.scale.name} on {PAPER_NAMES[details.paper]}"),
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
