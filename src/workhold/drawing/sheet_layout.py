"""How a setup sheet is laid out: plan and blocks of words on pages, so that the part shows largest.

There is one page when that costs the drawing nothing, else two or more. The first has the plan and what is
set at the machine, the others have the rest, below a view from the side where there is one. Scales are 1, 2
and 5 times powers of ten, up or down (ISO 5455:1979). Round scales between these are used too, as the
standard allows where a drawing would be needlessly small.

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

from attrs import frozen

from workhold.drawing.plan import BOTTOM, LEFT, RIGHT, TOP
from workhold.drawing.scene import UNITS_PER_MM, Box
from workhold.drawing.sheet_writing import Block, height_of
from workhold.drawing.side_drawing import SideFigure

__all__ = [
    "FOOT",
    "MARGIN",
    "MOST_FIGURE",
    "SCALE_BAR",
    "Filled",
    "PageLayout",
    "arranged",
    "inner_box",
    "plan_room",
    "standard_scale",
]

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
    figure : the box of the side view at the top of the second page; None without one.
    """

    page: Page
    plan: Box
    columns: tuple[Filled, ...]
    more: tuple[tuple[Filled, ...], ...]
    scale: StandardScale
    figure: Box | None = None


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
    high = figure.height(inner.width, MOST_FIGURE * inner.height, scale.factor)
    under = Box(inner.x0, inner.y0 + high + GUTTER, inner.x1, inner.y1)
    more = pages_of_words(inner, rest, under) or ((),)
    return PageLayout(
        page, plan, tuple(columns), more, scale, Box(inner.x0, inner.y0, inner.x1, inner.y0 + high)
    )


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

    Parameters
    ----------
    inner : a page without margins and foot.
    first : what there is of the first page, where not all of it is free.
    """
    if not blocks:
        return ()
    count, box = 3 if inner.width > inner.height else 2, inner if first is None else first
    width = (inner.width - (count - 1) * GUTTER) / count
    heights = [height_of(block, width) for block in blocks]
    fits = (
        last
        for last in range(len(blocks), 1, -1)
        if level_runs(blocks[:last], heights[:last], count)[1] <= box.height
    )
    last = next(fits, 0 if heights[0] > box.height and first is not None else 1)
    runs, _ = level_runs(blocks[:last], heights[:last], count)
    return (tuple(side_by_side(box, runs)), *pages_of_words(inner, blocks[last:]))


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
