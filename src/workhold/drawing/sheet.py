"""The setup sheet: one fixture on paper, to a standard scale, with all that is needed to build it.

Plan and blocks of words are laid out so that the part shows largest. There is one page when that costs the
drawing nothing, else two or more. The first has the plan and what is set at the machine, the others have the
rest, below a view from the side where there is one. Scales are 1, 2 and 5 times powers of ten, up or down
(ISO 5455:1979). Round scales between these are used too, as the standard allows where a drawing would be
needlessly small.

Glossary
--------
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

from workhold.drawing.annotation import scale_bar
from workhold.drawing.bench import Bench, bench_of
from workhold.drawing.carriers import most_holes
from workhold.drawing.panel import TextColumn
from workhold.drawing.path_drawn import PlannedPath
from workhold.drawing.plan import BOTTOM, LEFT, RIGHT, TOP, draw_plan
from workhold.drawing.scene import BLACK, UNITS_PER_MM, Box, LengthUnit, Scene, View, shortened, text_width
from workhold.drawing.sheet_blocks import blocks_of
from workhold.drawing.sheet_facts import (
    PAPERS,
    Caution,
    SheetDetails,
    cautions_of,
    edge_distances,
    result_details,
)
from workhold.drawing.sheet_writing import Block, Sheet, height_of, heights_of
from workhold.drawing.side_drawing import SideFigure
from workhold.drawing.side_view import side_view
from workhold.drawing.supports_drawn import PlannedSupports
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Fixture
from workhold.model.hold_words import hold_cautions
from workhold.model.result import Result
from workhold.model.setup import part_zero
from workhold.model.workpiece import Workpiece

__all__ = ["draw_sheet", "result_sheet", "standard_scale"]

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
    attribute ``data-model-to-page``, written as an SVG matrix. On paper its scale is a standard one. Returns
    the SVG text of every page, each of the paper's size.
    """
    bench = bench_of(fixture, workpiece, toolkit)
    details = details if details.zero else evolve(details, zero=part_zero(workpiece))
    lengths = LengthUnit.suiting(details.unit, bench.shown.pitch)
    if fixture.hold is not None:
        distances, heights = list[float](), None
        cautions = [Caution(kind, words) for kind, words in hold_cautions(fixture.hold)]
    else:
        distances = edge_distances(fixture, workpiece, toolkit)
        cautions = cautions_of(fixture, toolkit, distances, details, lengths)
        heights = heights_of(fixture, workpiece, toolkit, details)
    sheet = Sheet(fixture, workpiece, toolkit, details, lengths, tuple(cautions), tuple(distances), heights)
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
    width, height = (UNITS_PER_MM * side for side in PAPERS[details.paper_size])
    layout = arranged((width, height), extent, *blocks_of(sheet), figure)
    title = f"{sheet.name}: setup sheet of fixture {details.number}"
    pages = [Scene.page(layout.page, title) for _ in (layout.columns, *layout.more)]
    scene = pages[0]
    room = layout.plan
    view = View.fitting(extent, plan_room(room), layout.scale.factor * UNITS_PER_MM)
    marks = [(zero, "X0 Y0")] if sheet.zero_shown else []
    if sheet.origin_shown and all(peg.hole != sheet.datum.name for peg in fixture.pegs):
        marks.append(((0.0, 0.0), sheet.datum.mark))
    planned = None if details.supports is None else PlannedSupports.of(details.supports)
    draw_plan(scene, bench, view, workpiece, room, lengths, marks, angle="θ", supports=planned, path=path)
    words = f", scale {layout.scale.name}"
    if bench.shown.carriers and not most_holes(view, bench.shown):
        words += "; only the holes near the pegs are drawn"
    scale_bar(scene, (room.x0, room.y1), view.scale, lengths, more=words)
    for page, columns in zip(pages, (layout.columns, *layout.more), strict=True):
        write_columns(page, columns)
    if figure is not None and layout.figure is not None:
        box, scale = layout.figure
        figure.draw(pages[1], box, scale.name, scale.factor)
    for number, page in enumerate(pages, 1):
        draw_foot(page, layout, sheet, f"{number} of {len(pages)}")
    return tuple(page.svg() for page in pages)


def result_sheet(result: Result, rank: int, **asked: Any) -> tuple[str, ...]:
    """The pages of the setup sheet of one fixture, as SVG text.

    Its arguments and errors are those of :func:`workhold.drawing.sheet_facts.result_details`.
    """
    fixture, details = result_details(result, rank, **asked)
    return draw_sheet(fixture, result.workpiece, result.toolkit, details)


def figure_of(sheet: Sheet, bench: Bench) -> SideFigure | None:
    """The view from the side; None where nobody knows how thick the part is."""
    if sheet.heights is None:
        return None
    view = side_view(bench, sheet.workpiece, sheet.heights, sheet.details.supports)
    return SideFigure(view, sheet.lengths, sheet.plates_noun)


def write_columns(scene: Scene, columns: tuple[Filled, ...]) -> None:
    group = scene.group("words")
    for box, blocks in columns:
        column = TextColumn(group, box.x0, box.y0, box.width)
        for block in blocks:
            block(column)


def draw_foot(scene: Scene, layout: PageLayout, sheet: Sheet, page: str) -> None:
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


# A drawing that is larger by rounding alone still fits.
ROUNDING = 1e-9
STEPS = 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0


@frozen
class StandardScale:
    """A scale such as 1:2.

    Parameters
    ----------
    name : "paper:model", the smaller of them 1.
    factor : millimetres on paper for one of the model.
    """

    name: str
    factor: float


def standard_scale(largest: float) -> StandardScale:
    """The largest scale of these with at most ``largest`` millimetres on paper for one of the model.

    >>> [standard_scale(largest).name for largest in (1.0, 0.99, 0.3, 7.0, 0.011)]
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
# A plan smaller than this on paper in either direction, page units, is no plan.
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
    """Where things go.

    Parameters
    ----------
    page : width and height, page units.
    plan : the box of the drawing.
    columns : columns of words beside or below the plan, each with its blocks.
    more : columns of each further page, if there are some.
    scale : what the plan is drawn to.
    figure : the box of the side view at the top of the second page, and its scale; None without one.
    """

    page: Page
    plan: Box
    columns: tuple[Filled, ...]
    more: tuple[tuple[Filled, ...], ...]
    scale: StandardScale
    figure: tuple[Box, StandardScale] | None = None


def arranged(
    paper: Page,
    extent: Box,
    needed: Sequence[Block],
    others: Sequence[Block],
    figure: SideFigure | None = None,
) -> PageLayout:
    """The best layout of blocks and a plan of an extent (mm) on paper.

    ``paper`` is width and height when upright, page units. Where the needed blocks leave no room for a plan,
    the last ones go to the second page. A view from the side stands at the top of that page.
    """
    lying_page, blocks = (paper[1], paper[0]), [*needed, *others]
    least = len(needed)
    choices = [
        *(beside(lying_page, extent, blocks, least, count, figure) for count in PANELS),
        below(paper, extent, blocks, len(blocks), figure),
        below(paper, extent, blocks, least, figure),
        # A long part that stands upright, and one that lies.
        beside(paper, extent, blocks, least, 1, figure),
        below(lying_page, extent, blocks, least, figure),
    ]
    found = [choice for choice in choices if choice is not None]
    if not found and needed:
        return arranged(paper, extent, needed[:-1], [needed[-1], *others], figure)
    # A block is never cut, and one that is too high for a lying page may stand on an upright one.
    found = [choice for choice in found if not runs_over(choice)] or found
    best = max(found, key=lambda choice: (choice.scale.factor, -len(choice.more)))
    single = [choice for choice in found if not choice.more]
    if single:
        largest = max(single, key=lambda choice: choice.scale.factor)
        drawn = largest.scale.factor * UNITS_PER_MM * max(extent.width, extent.height)
        if largest.scale.factor == best.scale.factor or drawn >= LARGE_ENOUGH:
            return largest
    return best


def runs_over(choice: PageLayout) -> bool:
    """Whether words run over the foot of a further page."""
    columns = (column for page in choice.more for column in page)
    return any(sum(height_of(block, box.width) for block in blocks) > box.height for box, blocks in columns)


def plan_room(plan: Box) -> Box:
    """The part of a plan's box that jaws and part may take."""
    return Box(plan.x0 + LEFT, plan.y0 + TOP, plan.x1 - RIGHT, plan.y1 - BOTTOM - SCALE_BAR)


def layout_of(
    page: Page,
    extent: Box,
    plan: Box,
    columns: Sequence[Filled],
    rest: Sequence[Block],
    figure: SideFigure | None = None,
) -> PageLayout | None:
    """A layout with the rest of the blocks on further pages; None when no room is left for the plan."""
    room = plan_room(plan)
    if min(room.width, room.height) < SMALLEST_PLAN:
        return None
    largest = min(room.width / extent.width, room.height / extent.height)
    scale, inner = standard_scale(largest / UNITS_PER_MM), inner_box(page)
    if figure is None:
        return PageLayout(page, plan, tuple(columns), pages_of_words(inner, rest), scale)
    largest = figure.largest(inner.width, MOST_FIGURE * inner.height, scale.factor)
    own = standard_scale(largest)
    foot, more = under_figure(inner, rest, figure, own)
    smaller = standard_scale(largest * SMALLER_FIGURE)
    if len(more) > 1:
        # A smaller view saves a page that would hold a few words.
        for step in between(smaller.factor, own.factor):
            lower, fewer = under_figure(inner, rest, figure, step)
            if len(fewer) < len(more):
                own, foot, more = step, lower, fewer
                break
    top = Box(inner.x0, inner.y0, inner.x1, foot)
    return PageLayout(page, plan, tuple(columns), more, scale, (top, own))


def under_figure(
    inner: Box, rest: Sequence[Block], figure: SideFigure, scale: StandardScale
) -> tuple[float, tuple[tuple[Filled, ...], ...]]:
    """Where a view from the side at a scale ends, and the pages of words, the first below it."""
    foot = inner.y0 + figure.height(inner.width, scale.factor)
    return foot, pages_of_words(inner, rest, Box(inner.x0, foot + GUTTER, inner.x1, inner.y1)) or ((),)


def between(least: float, most: float) -> list[StandardScale]:
    """The standard scales from one below the larger factor down to the smaller one."""
    found = list[StandardScale]()
    scale = standard_scale(most * (1 - 1e-6))
    while scale.factor >= least * (1 - ROUNDING):
        found.append(scale)
        scale = standard_scale(scale.factor * (1 - 1e-6))
    return found


def beside(
    page: Page, extent: Box, blocks: Sequence[Block], least: int, count: int, figure: SideFigure | None = None
) -> PageLayout | None:
    """Plan at the left and a panel of ``count`` columns; None when the ``least`` first blocks do not fit."""
    inner, width = inner_box(page), PANELS[count]
    heights = [height_of(block, width) for block in blocks]
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
    return layout_of(page, extent, plan, columns, blocks[first:], figure)


def below(
    page: Page, extent: Box, blocks: Sequence[Block], first: int, figure: SideFigure | None = None
) -> PageLayout | None:
    """Plan above and the ``first`` blocks in a strip of two columns, of three on a lying page."""
    inner, count = inner_box(page), 3 if page[0] > page[1] else 2
    width = (inner.width - (count - 1) * GUTTER) / count
    runs, height = level_runs(blocks[:first], [height_of(block, width) for block in blocks[:first]], count)
    top = inner.y1 - height
    columns = side_by_side(Box(inner.x0, top, inner.x1, inner.y1), runs)
    plan = Box(inner.x0, inner.y0, inner.x1, top - GUTTER)
    return layout_of(page, extent, plan, columns, blocks[first:], figure)


def pages_of_words(
    inner: Box, blocks: Sequence[Block], first: Box | None = None
) -> tuple[tuple[Filled, ...], ...]:
    """The columns of as few pages as hold the blocks: three on a lying page, two on an upright one.

    ``inner`` is a page without margins and foot, ``first`` what there is of the first page, where not all of
    it is free.
    """
    if not blocks:
        return ()
    count, box = 3 if inner.width > inner.height else 2, inner if first is None else first
    width = (inner.width - (count - 1) * GUTTER) / count
    heights = [height_of(block, width) for block in blocks]
    runs = filled_runs(blocks, heights, count, box.height)
    if runs is not None:
        return (tuple(side_by_side(box, runs)),)
    fits = (
        last
        for last in range(len(blocks), 1, -1)
        if level_runs(blocks[:last], heights[:last], count)[1] <= box.height
    )
    last = next(fits, 0 if heights[0] > box.height and first is not None else 1)
    runs, _ = level_runs(blocks[:last], heights[:last], count)
    return (tuple(side_by_side(box, runs)), *pages_of_words(inner, blocks[last:]))


def filled_runs(
    blocks: Sequence[Block], heights: Sequence[float], count: int, height: float
) -> list[Sequence[Block]] | None:
    """Runs that hold all blocks within a height; None where there are none.

    The first of them stand in their order, and the rest where a column has room below.
    """
    for last in range(len(blocks), 0, -1):
        runs, most = level_runs(blocks[:last], heights[:last], count)
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


def side_by_side(box: Box, runs: Sequence[Sequence[Block]]) -> list[Filled]:
    """Runs of blocks in columns of equal width."""
    width = (box.width - (len(runs) - 1) * GUTTER) / len(runs)
    lefts = [box.x0 + k * (width + GUTTER) for k in range(len(runs))]
    return [(Box(x0, box.y0, x0 + width, box.y1), tuple(run)) for x0, run in zip(lefts, runs, strict=True)]


def inner_box(page: Page) -> Box:
    """A page without its margins and its foot."""
    return Box(MARGIN, MARGIN, page[0] - MARGIN, page[1] - MARGIN - FOOT)


def level_runs(
    blocks: Sequence[Block], heights: Sequence[float], count: int
) -> tuple[list[Sequence[Block]], float]:
    """Blocks in ``count`` runs as level as their order allows, and the height of the highest."""
    if count == 1:
        return [blocks], sum(heights)
    best: tuple[list[Sequence[Block]], float] | None = None
    for cut in range(len(blocks) + 1):
        runs, height = level_runs(blocks[cut:], heights[cut:], count - 1)
        highest = max(sum(heights[:cut]), height)
        if best is None or highest < best[1]:
            best = [blocks[:cut], *runs], highest
    assert best is not None
    return best
