"""The setup sheet: one fixture on paper, to a standard scale, with all that is needed to build it without asking.

One page when that costs the drawing nothing, else two: the first with the plan and what is set at the machine, the second
with the rest.
"""

from __future__ import annotations

from workhold.drawing.bench import bench_of
from workhold.drawing.dimensions import scale_bar
from workhold.drawing.fonts import shortened, text_width
from workhold.drawing.inset import draw_inset
from workhold.drawing.length_unit import LengthUnit
from workhold.drawing.panel import Column
from workhold.drawing.plan import draw_plan
from workhold.drawing.plates import most_holes
from workhold.drawing.scene import BLACK, UNITS_PER_MM, Box, Scene, View
from workhold.drawing.sheet_arrangement import FOOT, MARGIN, Arrangement, Filled, arranged, plan_room
from workhold.drawing.sheet_blocks import Sheet, blocks_of, height_of
from workhold.drawing.sheet_details import PAPERS, SheetDetails
from workhold.drawing.sheet_facts import cautions_of, edge_distances
from workhold.model.fixture import Fixture
from workhold.model.toolkit import Toolkit
from workhold.model.workpiece import Workpiece

__all__ = ["draw_sheet"]

PAPER_NAMES = {"a4": "A4", "letter": "Letter"}
# A cell for the part's name narrower than this, in page units, is left out of the foot.
NARROWEST_NAME = 90.0
LOWEST_INSET, HIGHEST_INSET, INSET_GAP = 170.0, 320.0, 16.0


def draw_sheet(fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit, details: SheetDetails) -> tuple[str, ...]:
    """Draw the setup sheet of a fixture on one page or two, lying or upright, whichever shows the part largest.

    The groups of class ``part`` and ``pegs`` carry the map from the vise frame (mm) to the page in their attribute
    ``data-model-to-page``, written as an SVG matrix; on paper it is a standard scale.

    Returns
    -------
    tuple of str
        SVG text of every page, each of the paper's size.
    """
    bench, zero = bench_of(fixture, workpiece, toolkit), (fixture.pose.x, fixture.pose.y)
    lengths = LengthUnit.suiting(details.unit, bench.shown.pitch)
    cautions = cautions_of(fixture, edge_distances(fixture, workpiece, toolkit), details, lengths)
    zero_shown = bench.extent.contains(Box(*zero, *zero))
    sheet = Sheet(fixture, workpiece, toolkit, details, lengths, tuple(cautions), zero_shown)
    width, height = (UNITS_PER_MM * side for side in PAPERS[details.paper])
    arrangement = arranged((width, height), bench.extent, *blocks_of(sheet))
    scene = new_page(arrangement, sheet)
    room = arrangement.plan
    view = View.fitting(bench.extent, plan_room(room), arrangement.scale.factor * UNITS_PER_MM)
    marks = [(zero, "part zero")]
    origin = sheet.origin
    if all(peg.hole != origin for peg in fixture.pegs):
        marks.append(((0.0, 0.0), f"{origin} (0, 0)"))
    draw_plan(scene, bench, view, workpiece, room, lengths, marks, angle="θ")
    words = f", scale {arrangement.scale.name}"
    if not most_holes(view, bench.shown):
        words += "; only the holes near the pegs are drawn"
    scale_bar(scene, (room.x0, room.y1), view.scale, lengths, more=words)
    pages = [scene]
    write_columns(scene, arrangement.columns)
    if arrangement.second:
        pages.append(new_page(arrangement, sheet))
        write_columns(pages[1], arrangement.second)
    write_inset(pages[-1], arrangement.second or arrangement.columns, sheet)
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


def write_inset(scene: Scene, columns: tuple[Filled, ...], sheet: Sheet) -> None:
    """Draw the part as it was drawn below the shortest of the columns, if that leaves room."""
    used = [sum(height_of(block, box.width) for block in blocks) for box, blocks in columns]
    box = columns[used.index(min(used))][0]
    top = box.y0 + min(used) + INSET_GAP
    room = Box(box.x0, top, box.x1, min(box.y1, top + HIGHEST_INSET))
    if room.height >= LOWEST_INSET:
        draw_inset(scene, room, sheet.workpiece, sheet.fixture, zero=True)


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
        ("Result file, SHA-256", f"{details.result_hash[:12]}…"),
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
