"""Where the plan and the blocks of words of a setup sheet go: the arrangement that shows the part largest.

Glossary
--------
lying, upright : a page wider than high, or higher than wide.
panel : columns of words at the right of a lying page, beside the plan.
strip : two columns of words below the plan of an upright page.
needed blocks : those that have to be on the page of the plan; the others may go to further pages.
"""

from __future__ import annotations

from collections.abc import Sequence

from attrs import frozen

from workhold.drawing.plan import BOTTOM, LEFT, RIGHT, TOP
from workhold.drawing.scene import UNITS_PER_MM, Box
from workhold.drawing.sheet_scale import StandardScale, standard_scale
from workhold.drawing.sheet_writing import Block, height_of

__all__ = ["FOOT", "MARGIN", "Arrangement", "Filled", "arranged", "plan_room"]

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
# A drawing this wide or high on paper, page units, needs no second page to become larger.
LARGE_ENOUGH = 70 * UNITS_PER_MM

Page = tuple[float, float]
Filled = tuple[Box, tuple[Block, ...]]


@frozen
class Arrangement:
    """Where things go.

    Parameters
    ----------
    page : width and height, page units.
    plan : the box of the drawing.
    columns : columns of words beside or below the plan, each with its blocks.
    more : columns of each further page, if there are some.
    scale : what the plan is drawn to.
    """

    page: Page
    plan: Box
    columns: tuple[Filled, ...]
    more: tuple[tuple[Filled, ...], ...]
    scale: StandardScale


def arranged(paper: Page, extent: Box, needed: Sequence[Block], others: Sequence[Block]) -> Arrangement:
    """The arrangement of blocks and a plan of an extent (mm) on a paper (width and height when upright, page units).

    Of needed blocks that leave no room for a plan the last ones go to the second page.
    """
    lying_page, blocks = (paper[1], paper[0]), [*needed, *others]
    least = len(needed)
    choices = [
        *(beside(lying_page, extent, blocks, least, count) for count in PANELS),
        below(paper, extent, blocks, len(blocks)),
        below(paper, extent, blocks, least),
    ]
    found = [choice for choice in choices if choice is not None]
    if not found and needed:
        return arranged(paper, extent, needed[:-1], [needed[-1], *others])
    # A block is never cut, and one that is too high for a lying page may stand on an upright one.
    found = [choice for choice in found if not runs_over(choice)] or found
    best = max(found, key=lambda choice: choice.scale.factor)
    single = [choice for choice in found if not choice.more]
    if single:
        largest = max(single, key=lambda choice: choice.scale.factor)
        drawn = largest.scale.factor * UNITS_PER_MM * max(extent.width, extent.height)
        if largest.scale.factor == best.scale.factor or drawn >= LARGE_ENOUGH:
            return largest
    return best


def runs_over(choice: Arrangement) -> bool:
    """Whether words run over the foot of a further page."""
    columns = (column for page in choice.more for column in page)
    return any(sum(height_of(block, box.width) for block in blocks) > box.height for box, blocks in columns)


def plan_room(plan: Box) -> Box:
    """The part of a plan's box that jaws and part may take."""
    return Box(plan.x0 + LEFT, plan.y0 + TOP, plan.x1 - RIGHT, plan.y1 - BOTTOM - SCALE_BAR)


def arrangement_of(
    page: Page, extent: Box, plan: Box, columns: Sequence[Filled], rest: Sequence[Block]
) -> Arrangement | None:
    """An arrangement with the rest of the blocks on further pages; None when no room is left for the plan."""
    room = plan_room(plan)
    if min(room.width, room.height) < SMALLEST_PLAN:
        return None
    largest = min(room.width / extent.width, room.height / extent.height)
    return Arrangement(page, plan, tuple(columns), pages_of_words(page, rest), standard_scale(largest / UNITS_PER_MM))


def beside(page: Page, extent: Box, blocks: Sequence[Block], least: int, count: int) -> Arrangement | None:
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
    return arrangement_of(page, extent, plan, columns, blocks[first:])


def below(page: Page, extent: Box, blocks: Sequence[Block], first: int) -> Arrangement | None:
    """Plan above and the ``first`` blocks in a strip of two columns."""
    inner = inner_box(page)
    width = (inner.width - GUTTER) / 2
    runs, height = level_runs(blocks[:first], [height_of(block, width) for block in blocks[:first]], 2)
    top = inner.y1 - height
    columns = side_by_side(Box(inner.x0, top, inner.x1, inner.y1), runs)
    return arrangement_of(page, extent, Box(inner.x0, inner.y0, inner.x1, top - GUTTER), columns, blocks[first:])


def pages_of_words(page: Page, blocks: Sequence[Block]) -> tuple[tuple[Filled, ...], ...]:
    """The columns of as few pages of words only as hold the blocks: three on a lying page, two on an upright one."""
    if not blocks:
        return ()
    inner, count = inner_box(page), 3 if page[0] > page[1] else 2
    width = (inner.width - (count - 1) * GUTTER) / count
    heights = [height_of(block, width) for block in blocks]
    fits = (last for last in range(len(blocks), 1, -1) if level_runs(blocks[:last], heights, count)[1] <= inner.height)
    last = next(fits, 1)
    runs, _ = level_runs(blocks[:last], heights, count)
    return (tuple(side_by_side(inner, runs)), *pages_of_words(page, blocks[last:]))


def side_by_side(box: Box, runs: Sequence[Sequence[Block]]) -> list[Filled]:
    """Runs of blocks in columns of equal width."""
    width = (box.width - (len(runs) - 1) * GUTTER) / len(runs)
    lefts = [box.x0 + k * (width + GUTTER) for k in range(len(runs))]
    return [(Box(x0, box.y0, x0 + width, box.y1), tuple(run)) for x0, run in zip(lefts, runs, strict=True)]


def inner_box(page: Page) -> Box:
    """A page without its margins and its foot."""
    return Box(MARGIN, MARGIN, page[0] - MARGIN, page[1] - MARGIN - FOOT)


def level_runs(blocks: Sequence[Block], heights: Sequence[float], count: int) -> tuple[list[Sequence[Block]], float]:
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
