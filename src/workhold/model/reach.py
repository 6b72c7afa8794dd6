"""The holes of a lattice in reach of a part, and which plates face one another.

The reach is defined in the glossary of ``model.shown``.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from itertools import combinations
from math import ceil, floor, inf
from typing import Literal

from workhold.errors import InputError
from workhold.fixels.carrier import Carrier
from workhold.geometry.segment import Box, Point
from workhold.limits import MOST_STEPS
from workhold.model.clamps import ShownClamp
from workhold.model.fixture import Fixture

__all__ = ["Side", "cells_in_reach", "facing_gaps", "held_box", "reach_of", "span"]

Side = Literal["left", "right", "bottom", "top"]

# Relative to the pitch: a hole this little outside the reach is in it.
ROUNDING = 1e-6


def held_box(part: Box, fixture: Fixture, clamps: Sequence[ShownClamp]) -> Box:
    """The extent of part, pegs and clamps, in mm."""
    places = [*((peg.x, peg.y) for peg in fixture.pegs), *(clamp.back for clamp in clamps)]
    return reduce(Box.union, (Box(x, y, x, y) for x, y in places), part)


def reach_of(held: Box, fixture: Fixture, carriers: Sequence[Carrier]) -> Box:
    """The reach about the extent of part, pegs and clamps, in mm; see the glossary."""
    reach = held
    more = max(reach.width, reach.height) / 14
    more_x, more_y = (max(more, *(carrier.pitch[axis] for carrier in carriers)) for axis in (0, 1))
    reach = Box(reach.x0 - more_x, reach.y0 - more_y, reach.x1 + more_x, reach.y1 + more_y)
    for carrier in carriers:
        if carrier.travel is not None:
            along_x, along_y = carrier.travel.unit
            for x, y in (carrier.place(0, 0), carrier.place(0, 0, fixture.jaw_separation)):
                x, y = x if along_x else reach.x0, y if along_y else reach.y0
                reach = reach.union(Box(x, y, x, y))
    return reach


def cells_in_reach(carrier: Carrier, travelled: float, reach: Box, held: Point) -> tuple[range, range]:
    """Columns and rows of a carrier in reach, at least one of each.

    A lattice without an end has those before the first ones too that lie under what is held, whose lower left
    corner is ``held`` in mm. Rows that are counted from a wall begin there. Refuses so many holes that no
    fixture of a search has them in reach.
    """
    x, y = carrier.place(0, 0, travelled)
    columns = in_reach(reach.x0 - x, reach.x1 - x, carrier.pitch[0], carrier.columns, held[0] - x)
    rows = in_reach(reach.y0 - y, reach.y1 - y, carrier.pitch[1], carrier.rows, held[1] - y)
    if (columns.stop - columns.start) * (rows.stop - rows.start) > MOST_STEPS:
        raise InputError(
            f"part and pegs reach over more than {MOST_STEPS:,} holes of the {carrier.title}, too many to "
            "show: check the fixture's pose, its pegs and the pitch."
        )
    return columns, rows


def in_reach(low: float, high: float, pitch: float, count: int | None, held: float) -> range:
    """Columns or rows between two distances in mm from the first one; at least one.

    Without a number of them, they begin within half a pitch of ``held`` if that is before the first one.
    """
    last, first = max(floor(high / pitch + ROUNDING), 0), max(ceil(low / pitch - ROUNDING), 0)
    if count is not None:
        last, first = min(last, count - 1), min(first, count - 1)
    elif held < 0:
        first = min(first, floor(held / pitch + 0.5 + ROUNDING))
    return range(first, max(last, first) + 1)


def span(carrier: Carrier, travelled: float, columns: range, rows: range) -> Box:
    """The box of the centres of the holes in some columns and rows."""
    first, last = (carrier.place(columns[end], rows[end], travelled) for end in (0, -1))
    return Box(*first, *last)


def facing_gaps(spans: list[Box]) -> list[dict[Side, float]]:
    """The sides of each box that face another box, with the smallest gap there in mm."""
    gaps: list[dict[Side, float]] = [{} for _ in spans]

    def face(one: int, side: Side, gap: float) -> None:
        gaps[one][side] = min(gap, gaps[one].get(side, inf))

    for i, k in combinations(range(len(spans)), 2):
        for low, high in ((i, k), (k, i)):
            across, upward = spans[high].x0 - spans[low].x1, spans[high].y0 - spans[low].y1
            if across > 0:
                face(low, "right", across)
                face(high, "left", across)
            elif upward > 0 and spans[low].x0 <= spans[high].x1 and spans[high].x0 <= spans[low].x1:
                face(low, "top", upward)
                face(high, "bottom", upward)
    return gaps
