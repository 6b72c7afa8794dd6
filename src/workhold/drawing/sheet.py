"""The setup sheet: one fixture on paper, to a standard scale, with all data that are needed to build it.

Plan and blocks of words are laid out so that the part is shown as large as possible. There is one page if the
drawing is as large as on more pages, else two or more. The first has the plan and the settings at the
machine, the others have the rest, below a view from the side if there is one. Scales are 1, 2 and 5 times
powers of ten, up or down (ISO 5455:1979). Round scales between these are used too, as the standard allows
where a drawing would be needlessly small.

Glossary
--------
block : some lines of words or a table under one heading, written by one function, of a known height.
run : blocks one below the other in a column.
lying, upright : a page wider than high, or higher than wide.
panel : columns of words at the right of a page, beside the plan.
strip : columns of words below the plan, two on an upright page and three on a lying one.
needed blocks : those that have to be on the page of the plan; the others may go to further pages.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import floor, log10
from typing import Any

from attrs import evolve, frozen

from workhold.drawing.annotation import draw_scale_bar
from workhold.drawing.bench import BenchDrawing, make_bench
from workhold.drawing.bent_part import draw_bent_page
from workhold.drawing.carriers import limit_holes_drawn
from workhold.drawing.hold_cautions import list_hold_cautions
from workhold.drawing.panel import TextColumn
from workhold.drawing.path_drawn import PlannedPath
from workhold.drawing.plan import BOTTOM, LEFT, RIGHT, TOP, draw_plan
from workhold.drawing.scene import (
    BLACK,
    UNITS_PER_MM,
    Box,
    LengthUnit,
    Scene,
    View,
    measure_text,
    shorten_text,
)
from workhold.drawing.sheet_blocks import make_blocks
from workhold.drawing.sheet_facts import (
    PAPERS,
    Caution,
    SheetDetails,
    collect_sheet_details,
    list_cautions,
    measure_edge_distances,
)
from workhold.drawing.sheet_writing import Block, SetupSheet, find_sheet_heights, measure_block_height
from workhold.drawing.side_drawing import SideFigure
from workhold.drawing.side_view import choose_side_view
from workhold.drawing.supports_drawn import PlannedSupports
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Fixture
from workhold.model.result import Result
from workhold.model.setup import choose_part_zero
from workhold.model.workpiece import Workpiece

__all__ = ["draw_sheet", "draw_setup_sheet", "choose_standard_scale"]

PAPER_NAMES = {"a4": "A4", "letter": "Letter"}
# A cell for the part's name narrower than this, in page units, is left out of the foot.
NARROWEST_NAME = 90.0
# Part zero and the hole that places are measured from are shown on the plan up to so many pitches beside it.
NEAR = 2


def draw_sheet(
    fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit, details: SheetDetails
) -> tuple[str, ...]:
    """Return the pages of a fixture's setup sheet as SVG text, landscape or
    portrait, whichever shows the part largest.

    The groups of class ``part`` and ``pegs`` carry the map from the vise frame (mm) to the page in their
    attribute ``data-model-to-page``, written as an SVG matrix. The plan's scale on paper is a standard one.
    All pages have the paper's size.
    """
    bench = make_bench(fixture, workpiece, toolkit)
    details = details if details.zero else evolve(details, zero=choose_part_zero(workpiece))
    lengths = LengthUnit.from_typical_length(details.unit, bench.shown.pitch)
    if fixture.hold is not None:
        distances, heights = list[float](), None
        cautions = [Caution(kind, words) for kind, words in list_hold_cautions(fixture)]
    else:
        distances = measure_edge_distances(fixture, workpiece, toolkit)
        cautions = list_cautions(fixture, toolkit, distances, details, lengths)
        heights = find_sheet_heights(fixture, workpiece, toolkit, details)
    sheet = SetupSheet(
        fixture, workpiece, toolkit, details, lengths, tuple(cautions), tuple(distances), heights
    )
    figure = make_side_figure(sheet, bench)
    zero = sheet.zero_place
    near = bench.extent.grow(NEAR * bench.shown.pitch)
    zero_box, origin_box = Box(*zero, *zero), Box(0.0, 0.0, 0.0, 0.0)
    sheet = evolve(sheet, zero_shown=near.contains(zero_box), origin_shown=near.contains(origin_box))
    extent = bench.extent.unite(zero_box) if sheet.zero_shown else bench.extent
    extent = extent.unite(origin_box) if sheet.origin_shown else extent
    path = None
    if details.program is not None:
        path = PlannedPath(details.program, fixture, details.passing)
        extent = path.enlarge_extent(extent)
    width, height = (UNITS_PER_MM * side for side in PAPERS[details.paper_size])
    layout = arrange_sheet((width, height), extent, *make_blocks(sheet), figure)
    title = f"{sheet.name}: setup sheet of fixture {details.number}"
    pages = [Scene.make_page(layout.page, title) for _ in (layout.columns, *layout.more)]
    scene = pages[0]
    room = layout.plan
    view = View.fit_box(extent, compute_plan_room(room), layout.scale.factor * UNITS_PER_MM)
    marks = [(zero, "X0 Y0")] if sheet.zero_shown else []
    if sheet.origin_shown and all(peg.hole != sheet.datum.name for peg in fixture.pegs):
        marks.append(((0.0, 0.0), sheet.datum.mark))
    planned = None if details.supports is None else PlannedSupports.from_chosen(details.supports)
    draw_plan(scene, bench, view, workpiece, room, lengths, marks, angle="θ", supports=planned, path=path)
    words = f", scale {layout.scale.name}"
    if bench.shown.carriers and not limit_holes_drawn(view, bench.shown):
        words += "; only the holes near the pegs are drawn"
    draw_scale_bar(scene, (room.x0, room.y1), view.scale, lengths, more=words)
    for page, columns in zip(pages, (layout.columns, *layout.more), strict=True):
        write_columns(page, columns)
    if figure is not None and layout.figure is not None:
        box, scale = layout.figure
        figure.draw(pages[1], box, scale.name, scale.factor)
    if details.bending is not None:
        pages.append(Scene.make_page(layout.page, title))
        room = Box(MARGIN, MARGIN, layout.page[0] - MARGIN, layout.page[1] - MARGIN - FOOT)
        mover = toolkit.moving.noun
        said = details.bending.list_sentences(mover, details.unit)
        said += [f"Beware: {one}" for one in details.bending.list_warnings(details.bend, details.unit)]
        draw_bent_page(pages[-1], room, details.bending, lengths, said)
    for number, page in enumerate(pages, 1):
        draw_foot(page, layout, sheet, f"{number} of {len(pages)}")
    return tuple(page.to_svg() for page in pages)


def draw_setup_sheet(result: Result, rank: int, **asked: Any) -> tuple[str, ...]:
    """Return the pages of the setup sheet of a result's fixture, as SVG text.

    Arguments and errors are those of :func:`workhold.drawing.sheet_facts.collect_sheet_details`.
    """
    fixture, details = collect_sheet_details(result, rank, **asked)
    return draw_sheet(fixture, result.workpiece, result.toolkit, details)


def make_side_figure(sheet: SetupSheet, bench: BenchDrawing) -> SideFigure | None:
    """Return the view from the side; None if the sheet has no heights (the part's thickness is not known)."""
    if sheet.heights is None:
        return None
    view = choose_side_view(bench, sheet.workpiece, sheet.heights, sheet.details.supports)
    return SideFigure(view, sheet.lengths, sheet.plates_noun)


def write_columns(scene: Scene, columns: tuple[Filled, ...]) -> None:
    """Write blocks of words on a page; ``columns`` holds (box, blocks) of each column."""
    group = scene.group("words")
    for box, blocks in columns:
        column = TextColumn(group, box.x0, box.y0, box.width)
        for block in blocks:
            block(column)


def draw_foot(scene: Scene, layout: PageLayout, sheet: SetupSheet, page: str) -> None:
    """Draw the row of cells at a page's lower edge; ``page`` is the page's number as text."""
    details, (width, height) = sheet.details, layout.page
    box = Box(MARGIN, height - MARGIN - FOOT + 10, width - MARGIN, height - MARGIN)
    cells = [
        (details.listed_as, f"{details.number} of {details.count}"),
        ("Scale", f"{layout.scale.name} on {PAPER_NAMES[details.paper_size]}"),
        ("Print at", "100 %"),
        ("Lengths", sheet.lengths.unit.name),
        ("Date", details.day.isoformat()),
        *([("Result file, SHA-256", f"{details.result_hash[:12]}…")] if details.result_hash else []),
        ("Program", f"workhold {details.version}"),
        ("Page", page),
    ]
    widths = [max(measure_text(name, 9), measure_text(value, 12, bold=True)) + 16 for name, value in cells]
    room = box.width - sum(widths)
    if room >= NARROWEST_NAME:
        cells.insert(0, ("Part", shorten_text(sheet.name, 12, room - 16, bold=True)))
        widths.insert(0, room)
    else:
        widths = [cell + room / len(cells) for cell in widths]
    group = scene.group("foot")
    group.add_rectangle(box, "#ffffff", BLACK, 1.4)
    x = box.x0
    for (name, value), cell in zip(cells, widths, strict=True):
        if x > box.x0:
            group.add_line([(x, box.y0), (x, box.y1)], BLACK, 0.8)
        group.add_text((x + 8, box.y0 + 9), name, 9)
        group.add_text((x + 8, box.y0 + 23), value, 12, bold=True)
        x += cell


# A drawing that is larger by rounding alone still fits.
ROUNDING = 1e-9
STEPS = 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0


@frozen
class StandardScale:
    """A scale such as 1:2.

    Parameters
    ----------
    name : "paper:model", such as "1:2"; the smaller number is 1.
    factor : mm on paper for one mm of the model.
    """

    name: str
    factor: float


def choose_standard_scale(largest: float) -> StandardScale:
    """Return the largest standard scale with at most ``largest`` mm on paper for one mm of the model.

    >>> [choose_standard_scale(largest).name for largest in (1.0, 0.99, 0.3, 7.0, 0.011)]
    ['1:1', '1:1.5', '1:4', '6:1', '1:100']
    """
    if largest >= 1 - ROUNDING:
        power = 10 ** floor(log10(largest) + ROUNDING)
        enlarged = max(step * power for step in STEPS if step * power <= largest * (1 + ROUNDING))
        return StandardScale(f"{enlarged:g}:1", enlarged)
    power = 10 ** floor(log10(1 / largest) + ROUNDING)
    reduced = min(step * power for step in (*STEPS, 10.0) if step * power >= (1 - ROUNDING) / largest)
    return StandardScale(f"1:{reduced:.12g}", 1 / reduced)


# Ten millimetres on all sides, more than printers leave blank.
MARGIN = 10 * UNITS_PER_MM
GUTTER = 22.0
# The line of cells at the lower edge, and the room for the scale bar below the plan, page units.
FOOT = 44.0
SCALE_BAR = 24.0
# Width of a column of the panel by how many there are, page units.
PANELS = {1: 340.0, 2: 310.0}
# A plan smaller than this on paper in either direction, page units, is not a plan.
SMALLEST_PLAN = 120.0
# Of a page's height, how much a view from the side may take.
MOST_FIGURE = 0.62
# How much smaller a view from the side is drawn to save a page.
SMALLER_FIGURE = 0.45
# A drawing this wide or high on paper, page units, needs no second page to become larger.
LARGE_ENOUGH = 70 * UNITS_PER_MM

Page = tuple[float, float]
Filled = tuple[Box, tuple[Block, ...]]


@frozen
class PageLayout:
    """The places of the plan and the blocks on the pages of a sheet.

    Parameters
    ----------
    page : width and height, page units.
    plan : the page box of the drawing.
    columns : (box, blocks) of each column beside or below the plan.
    more : such columns of each further page; empty for a sheet of one page.
    scale : scale of the plan.
    figure : (page box, scale) of the side view at the top of the second page; None without one.
    """

    page: Page
    plan: Box
    columns: tuple[Filled, ...]
    more: tuple[tuple[Filled, ...], ...]
    scale: StandardScale
    figure: tuple[Box, StandardScale] | None = None


def arrange_sheet(
    paper: Page,
    extent: Box,
    needed: Sequence[Block],
    others: Sequence[Block],
    figure: SideFigure | None = None,
) -> PageLayout:
    """Return the best layout of blocks and a plan of an extent (mm) on paper.

    ``paper`` is its (width, height) in page units when upright. The blocks ``needed`` are on the page of the
    plan; if they leave no room for it, the last of them go to the second page. A view from the side
    (``figure``) is at the top of the second page. A layout of one page is chosen if its drawing is as large
    as on two pages, or large enough.
    """
    lying_page, blocks = (paper[1], paper[0]), [*needed, *others]
    least = len(needed)
    choices = [
        *(lay_out_beside_plan(lying_page, extent, blocks, least, count, figure) for count in PANELS),
        lay_out_below_plan(paper, extent, blocks, len(blocks), figure),
        lay_out_below_plan(paper, extent, blocks, least, figure),
        # A long part that stands upright, and one that lies.
        lay_out_beside_plan(paper, extent, blocks, least, 1, figure),
        lay_out_below_plan(lying_page, extent, blocks, least, figure),
    ]
    found = [choice for choice in choices if choice is not None]
    if not found and needed:
        return arrange_sheet(paper, extent, needed[:-1], [needed[-1], *others], figure)
    # A block is never cut, and one that is too high for a lying page may stand on an upright one.
    found = [choice for choice in found if not overflows_page(choice)] or found
    best = max(found, key=lambda choice: (choice.scale.factor, -len(choice.more)))
    single = [choice for choice in found if not choice.more]
    if single:
        largest = max(single, key=lambda choice: choice.scale.factor)
        drawn = largest.scale.factor * UNITS_PER_MM * max(extent.width, extent.height)
        if largest.scale.factor == best.scale.factor or drawn >= LARGE_ENOUGH:
            return largest
    return best


def overflows_page(choice: PageLayout) -> bool:
    """Return whether the words on a further page of a layout run below the page."""
    columns = (column for page in choice.more for column in page)
    return any(
        sum(measure_block_height(block, box.width) for block in blocks) > box.height
        for box, blocks in columns
    )


def compute_plan_room(plan: Box) -> Box:
    """Return the part of a plan's box in which jaws and part may be drawn, without the room for lettering."""
    return Box(plan.x0 + LEFT, plan.y0 + TOP, plan.x1 - RIGHT, plan.y1 - BOTTOM - SCALE_BAR)


def make_layout(
    page: Page,
    extent: Box,
    plan: Box,
    columns: Sequence[Filled],
    rest: Sequence[Block],
    figure: SideFigure | None = None,
) -> PageLayout | None:
    """Return a layout with a plan in the box ``plan``; None if the plan would be too small.

    ``columns`` are the filled columns beside or below the plan. The blocks ``rest`` go to further pages,
    below the view from the side (``figure``), if any.
    """
    room = compute_plan_room(plan)
    if min(room.width, room.height) < SMALLEST_PLAN:
        return None
    largest = min(room.width / extent.width, room.height / extent.height)
    scale, inner = choose_standard_scale(largest / UNITS_PER_MM), compute_inner_box(page)
    if figure is None:
        return PageLayout(page, plan, tuple(columns), fill_pages(inner, rest), scale)
    largest = figure.compute_largest_scale(inner.width, MOST_FIGURE * inner.height, scale.factor)
    own = choose_standard_scale(largest)
    foot, more = lay_out_under_figure(inner, rest, figure, own)
    smaller = choose_standard_scale(largest * SMALLER_FIGURE)
    if len(more) > 1:
        # A smaller view saves a page that would hold a few words.
        for step in list_scales_between(smaller.factor, own.factor):
            lower, fewer = lay_out_under_figure(inner, rest, figure, step)
            if len(fewer) < len(more):
                own, foot, more = step, lower, fewer
                break
    top = Box(inner.x0, inner.y0, inner.x1, foot)
    return PageLayout(page, plan, tuple(columns), more, scale, (top, own))


def lay_out_under_figure(
    inner: Box, rest: Sequence[Block], figure: SideFigure, scale: StandardScale
) -> tuple[float, tuple[tuple[Filled, ...], ...]]:
    """Return (lower edge of a side view drawn at a scale, pages of words).

    The words of the first of these pages stand below the view. ``inner`` is a page's box without margins and
    foot.
    """
    foot = inner.y0 + figure.compute_height(inner.width, scale.factor)
    return foot, fill_pages(inner, rest, Box(inner.x0, foot + GUTTER, inner.x1, inner.y1)) or ((),)


def list_scales_between(least: float, most: float) -> list[StandardScale]:
    """Return the standard scales with a factor of at least ``least`` and below ``most``, largest first."""
    found = list[StandardScale]()
    scale = choose_standard_scale(most * (1 - 1e-6))
    while scale.factor >= least * (1 - ROUNDING):
        found.append(scale)
        scale = choose_standard_scale(scale.factor * (1 - 1e-6))
    return found


def lay_out_beside_plan(
    page: Page, extent: Box, blocks: Sequence[Block], least: int, count: int, figure: SideFigure | None = None
) -> PageLayout | None:
    """Return a layout with the plan at the left and ``count`` columns at the right; None if it does not fit.

    At least the first ``least`` of the blocks must fit in these columns; the others may go to further pages.
    """
    inner, width = compute_inner_box(page), PANELS[count]
    heights = [measure_block_height(block, width) for block in blocks]
    columns, first = [], 0
    for k in range(count):
        last = first
        while last < len(blocks) and sum(heights[first : last + 1]) <= inner.height:
            last += 1
        x0 = inner.x1 - (count - k) * width - (count - 1 - k) * GUTTER
        columns.append((Box(x0, inner.y0, x0 + width, inner.y1), tuple(blocks[first:last])))
        first = last
    if first < least:
        return None
    plan = Box(inner.x0, inner.y0, columns[0][0].x0 - GUTTER, inner.y1)
    return make_layout(page, extent, plan, columns, blocks[first:], figure)


def lay_out_below_plan(
    page: Page, extent: Box, blocks: Sequence[Block], first: int, figure: SideFigure | None = None
) -> PageLayout | None:
    """Return a layout with the first ``first`` of the blocks in columns below the plan; None where the plan
    would be too small.

    There are two columns, or three on a landscape page. The other blocks go to further pages.
    """
    inner, count = compute_inner_box(page), 3 if page[0] > page[1] else 2
    width = (inner.width - (count - 1) * GUTTER) / count
    runs, height = balance_runs(
        blocks[:first], [measure_block_height(block, width) for block in blocks[:first]], count
    )
    top = inner.y1 - height
    columns = place_in_columns(Box(inner.x0, top, inner.x1, inner.y1), runs)
    plan = Box(inner.x0, inner.y0, inner.x1, top - GUTTER)
    return make_layout(page, extent, plan, columns, blocks[first:], figure)


def fill_pages(
    inner: Box, blocks: Sequence[Block], first: Box | None = None
) -> tuple[tuple[Filled, ...], ...]:
    """Return the pages that hold the blocks, as few as possible; each is a tuple of filled columns (box,
    blocks).

    A landscape page has three columns, a portrait page two. ``inner`` is a page's box without margins and
    foot; ``first`` is the free part of it on the first page (None: all of ``inner``).
    """
    if not blocks:
        return ()
    count, box = 3 if inner.width > inner.height else 2, inner if first is None else first
    width = (inner.width - (count - 1) * GUTTER) / count
    heights = [measure_block_height(block, width) for block in blocks]
    runs = fill_runs(blocks, heights, count, box.height)
    if runs is not None:
        return (tuple(place_in_columns(box, runs)),)
    fits = (
        last
        for last in range(len(blocks), 1, -1)
        if balance_runs(blocks[:last], heights[:last], count)[1] <= box.height
    )
    last = next(fits, 0 if heights[0] > box.height and first is not None else 1)
    runs, _ = balance_runs(blocks[:last], heights[:last], count)
    return (tuple(place_in_columns(box, runs)), *fill_pages(inner, blocks[last:]))


def fill_runs(
    blocks: Sequence[Block], heights: Sequence[float], count: int, height: float
) -> list[Sequence[Block]] | None:
    """Return ``count`` runs, at most ``height`` high, that contain all blocks; None if that is not possible.

    ``heights`` are those of the blocks. As many as possible of the first blocks keep their order from run to
    run. Each of the others is added below the first run with room for it.
    """
    for last in range(len(blocks), 0, -1):
        runs, most = balance_runs(blocks[:last], heights[:last], count)
        if most > height:
            continue
        sizes = dict(zip(map(id, blocks), heights, strict=True))
        columns = [list(run) for run in runs]
        free = [height - sum(sizes[id(block)] for block in run) for run in columns]
        for block, size in zip(blocks[last:], heights[last:], strict=True):
            place = next((k for k in range(count) if free[k] >= size), None)
            if place is None:
                break
            columns[place].append(block)
            free[place] -= size
        else:
            return [tuple(column) for column in columns]
    return None


def place_in_columns(box: Box, runs: Sequence[Sequence[Block]]) -> list[Filled]:
    """Return (box, blocks) for each run of blocks, in columns of equal width side by side in a page box."""
    width = (box.width - (len(runs) - 1) * GUTTER) / len(runs)
    lefts = [box.x0 + k * (width + GUTTER) for k in range(len(runs))]
    return [(Box(x0, box.y0, x0 + width, box.y1), tuple(run)) for x0, run in zip(lefts, runs, strict=True)]


def compute_inner_box(page: Page) -> Box:
    """Return the box of a page without its margins and foot."""
    return Box(MARGIN, MARGIN, page[0] - MARGIN, page[1] - MARGIN - FOOT)


def balance_runs(
    blocks: Sequence[Block], heights: Sequence[float], count: int
) -> tuple[list[Sequence[Block]], float]:
    """Return (runs, height of the highest run) for blocks cut, in their order, into ``count`` runs of nearly
    equal height.

    ``heights`` are those of the blocks.
    """
    if count == 1:
        return [blocks], sum(heights)
    best: tuple[list[Sequence[Block]], float] | None = None
    for cut in range(len(blocks) + 1):
        runs, height = balance_runs(blocks[cut:], heights[cut:], count - 1)
        highest = max(sum(heights[:cut]), height)
        if best is None or highest < best[1]:
            best = [blocks[:cut], *runs], highest
    assert best is not None
    return best
