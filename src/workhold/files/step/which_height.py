"""The outlines of a solid at heights of the pegs, as rows of numbers, and which height is the better one.

Carriers with heights of their own meet outlines of their own. What each range of heights offers is said in a
table and in words.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from workhold.conventions import SAME_HEIGHT
from workhold.errors import InputError
from workhold.files.questions import PEG_HEIGHT, SECTION
from workhold.files.step.heights import HeightOutline, StandingSolid
from workhold.geometry.loop import loop_segments, signed_area
from workhold.geometry.segment import Segment
from workhold.model.solid import Band, HeightRow, SolidOutline

__all__ = [
    "OrderedLoops",
    "OwnDrawing",
    "advice",
    "height_remarks",
    "height_table",
    "measures",
    "ordered_loops",
    "own_drawings",
    "vertices_of",
]

# Heights of the pegs that the table looks at, at most.
MOST_ROWS = 60
# Edges of a solid times heights that the table looks at, at most: of parts with many faces it has fewer rows.
MOST_EDGES = 6_000


def vertices_of(loop: Sequence[Any]) -> NDArray[np.float64]:
    """Vertices (N, 3) of a loop of strips, each running to the next."""
    return np.array([(*strip.start, strip.bulge) for strip in loop])


def measures(outline: HeightOutline) -> tuple[float, float, float, float]:
    """Area, border, touchable border and shortest band of an outline, in mm² and mm."""
    border = touchable = area = 0.0
    bands = []
    for loop in outline.loops:
        segments: Sequence[Segment] = loop_segments(vertices_of(loop))
        area += signed_area(segments)
        border += sum(segment.length for segment in segments)
        for segment, strip in zip(segments, loop, strict=True):
            if strip.band is not None:
                touchable += segment.length
                bands.append(strip.band[1] - strip.band[0])
    return area, border, touchable, min(bands, default=0.0)


def height_table(solid: StandingSolid, room: float, least: float) -> list[HeightRow]:
    """Ranges of peg heights with what their outlines offer, without those whose outline is refused."""
    levels = {round(z, 6) for face in solid.faces for z in (face.low, face.high)}
    levels |= {round(z - room, 6) for z in levels} | {round(solid.height, 6)}
    heights = sorted(z for z in levels if least < z <= solid.height + SAME_HEIGHT)
    most = min(MOST_ROWS, max(2, MOST_EDGES // len(solid.edges)))
    if len(heights) > most:
        heights = [heights[round(k)] for k in np.linspace(0, len(heights) - 1, most)]
    rows: list[HeightRow] = []
    for low, high in pairwise([0.0, *heights]):
        try:
            figures = measures(solid.outline(high, room, least))
        except InputError:
            continue
        row = HeightRow(low, high, *figures)
        if rows and rows[-1].high == low and is_like(rows[-1], row):
            rows[-1] = evolve(row, low=rows[-1].low)
        else:
            rows.append(row)
    return rows


def is_like(a: HeightRow, b: HeightRow) -> bool:
    """Whether two ranges offer the same outline, as far as its figures show."""
    pairs = ((a.area, b.area), (a.border, b.border), (a.touchable, b.touchable))
    return all(abs(one - other) <= 1e-6 * max(one, 1.0) for one, other in pairs)


def longest(rows: Sequence[HeightRow]) -> HeightRow | None:
    """The range with the longest touchable border; of equal ones that of the highest pegs."""
    most = max((row.touchable for row in rows), default=0.0)
    return max(
        (row for row in rows if row.touchable >= most * (1 - 1e-9) > 0),
        key=lambda row: row.high,
        default=None,
    )


def advice(solid: StandingSolid, room: float, least: float) -> str:
    """What to give instead, in words."""
    best = longest(height_table(solid, room, least))
    if best is None:
        return f"give another axis, or {SECTION}"
    return f"give {PEG_HEIGHT} {best.high:.6g}mm, or another axis"


def height_remarks(
    outline: HeightOutline, found: SolidOutline, rows: Sequence[HeightRow], feet: int
) -> list[str]:
    """What an outline by height is, what may be touched of it, and a height at which more may be."""
    _, border, touchable, band = measures(outline)
    reach = (
        "pegs are taken to reach as high"
        if outline.peg_height == found.height
        else f"the outline is what pegs of {outline.peg_height:.6g} mm, with {outline.head_room:g} mm free "
        "above, can meet"
    )
    remarks = [f"The part is {found.height:.6g} mm high along {found.axis}; {reach}."]
    if feet > 1:
        remarks.append(f"It has {feet} separate pieces, between which pegs may stand.")
    if touchable < border * (1 - 1e-9):
        remarks.append(
            f"Upright faces stand over {touchable:.4g} of {border:.4g} mm of the outline, and only these are "
            f"touched; the shortest is {band:.4g} mm high there."
        )
    elif band < min(outline.peg_height, found.height) - SAME_HEIGHT:
        remarks.append(f"The shortest upright face on the outline is {band:.4g} mm high there.")
    return [*remarks, *better_height(rows, touchable)]


def better_height(rows: Sequence[HeightRow], touchable: float) -> list[str]:
    """A sentence on the height of pegs that could touch most, if that is more than a length in mm."""
    best = longest(rows)
    if best is None or best.touchable <= touchable * (1 + 1e-6):
        return []
    return [f"With {PEG_HEIGHT} {best.high:.6g}mm most could be touched: {best.touchable:.4g} mm."]


@frozen(eq=False)
class OrderedLoops:
    """The loops of an outline, outer ones first, the largest of them before all.

    Parameters
    ----------
    loops : vertices (N, 3) of each, in mm.
    bands, faces : of every segment, as ``SolidOutline`` has them.
    feet : how many loops are outer ones.
    """

    loops: tuple[NDArray[np.float64], ...]
    bands: tuple[Band | None, ...]
    faces: tuple[tuple[int, ...], ...]
    feet: int


def ordered_loops(outline: HeightOutline) -> OrderedLoops:
    """The loops of an outline with what may be touched of them."""
    loops = [vertices_of(loop) for loop in outline.loops]
    areas = [signed_area(loop_segments(loop)) for loop in loops]
    order = sorted(range(len(loops)), key=lambda k: -areas[k])
    strips = [strip for k in order for strip in outline.loops[k]]
    return OrderedLoops(
        tuple(loops[k] for k in order),
        tuple(strip.band for strip in strips),
        tuple(strip.faces for strip in strips),
        sum(area > 0 for area in areas),
    )


@frozen(eq=False)
class OwnDrawing:
    """What carriers of a role meet of a solid: loops (N, 3) in mm, and the solid with their bands."""

    role: str
    loops: tuple[NDArray[np.float64], ...]
    solid: SolidOutline


def own_drawings(
    solid: StandingSolid, heights: Mapping[str, Sequence[float]], found: SolidOutline
) -> Iterator[OwnDrawing]:
    """What carriers with heights of their own meet.

    Parameters
    ----------
    heights : by role, in mm.
    found : the solid as all other pegs meet it.

    Raises
    ------
    InputError
        Naming the role, where such an outline cannot be made or has nothing to touch.
    """
    for role, (low, high) in heights.items():
        where = f"along {found.axis}, from {low:g} to {high:g} mm, where the {role} reaches"
        if low >= solid.height:
            raise InputError(
                f"{where}, there is nothing of the part, which is {solid.height:.6g} mm high: give heights "
                f"of the {role} that begin below that."
            )
        try:
            ordered = ordered_loops(solid.outline(high, found.head_room, found.least_band, low))
        except InputError as error:
            raise InputError(
                f"{where}, {str(error).rstrip('.')}: give other heights of the {role}."
            ) from error
        if not any(ordered.bands):
            raise InputError(
                f"{where}, no upright face of the part is at least {found.least_band:g} mm high: give other "
                f"heights of the {role}."
            )
        own = evolve(found, low=low, peg_height=high, bands=ordered.bands, faces=ordered.faces)
        own = evolve(own, bottom=(), top=(), top_heights=())
        yield OwnDrawing(role, ordered.loops, own)
