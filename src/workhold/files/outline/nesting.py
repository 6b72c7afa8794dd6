"""Sorting of closed loops into parts: an outer loop, its holes, and the parts inside the holes.

Glossary
--------
depth : number of other loops a loop lies in; even for an outer loop, odd for a hole.
part : an outer loop with the holes directly in it. An island inside a hole is a part of its own.
nest : outlines that share lines, see ``outline.shared_lines``.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.conventions import TOUCHING
from workhold.errors import InputError, make_printable, shorten_middle
from workhold.files.budget import UNLIMITED, Budget
from workhold.files.outline.joining import JoinedLoop
from workhold.geometry.loop import (
    ComparisonBudget,
    LoopShape,
    compute_signed_area,
    make_loop_segments,
    refuse_meeting_loops,
    reverse_vertices,
)
from workhold.geometry.segment import Segment, compute_box_around, make_segment_rows
from workhold.geometry.subdivision import subdivide
from workhold.kernels.base.distance import is_inside, measure_outline_distances

__all__ = ["DrawnPart", "join_loops_as_one_part", "nest_loops", "boxes_meet", "refuse_loops_across"]


# mm. How far beside a line it is asked whether both of two outlines lie there.
BESIDE = 1e-4


@frozen
class DrawnPart:
    """One of the parts in a file.

    Parameters
    ----------
    number : from 1, by decreasing area.
    loops : the outer loop, then its holes.
    area : of the material, in mm².
    bounds : (smallest x, smallest y, largest x, largest y) in mm.
    """

    number: int
    loops: tuple[JoinedLoop, ...]
    area: float
    bounds: tuple[float, float, float, float]

    @property
    def segment_count(self) -> int:
        """Number of segments of all its loops."""
        return sum(len(loop.labels) for loop in self.loops)

    def __str__(self) -> str:
        """Return the part's number, size, place and holes in words."""
        x0, y0, x1, y1 = self.bounds
        holes = len(self.loops) - 1
        with_holes = f"{holes} hole{'' if holes == 1 else 's'}" if holes else "no holes"
        size = f"{x1 - x0:.6g} x {y1 - y0:.6g} mm"
        return f"part {self.number} is {size} at ({x0:.6g}, {y0:.6g}) with {with_holes}"


@frozen
class MeasuredLoop:
    """A loop as geometry: its segments counter-clockwise, their kernel rows, area in mm² and bounding box."""

    loop: JoinedLoop
    segments: tuple[Segment, ...]
    rows: NDArray[np.float64]
    area: float
    box: tuple[float, float, float, float]

    @classmethod
    def from_loop(cls, loop: JoinedLoop) -> MeasuredLoop:
        """Measure a loop that runs either way."""
        segments = make_loop_segments(loop.vertices)
        area = compute_signed_area(segments)
        if area < 0:
            segments = make_loop_segments(reverse_vertices(loop.vertices))
        return cls(loop, segments, make_segment_rows(segments), abs(area), compute_box_around(segments))


def nest_loops(loops: Sequence[JoinedLoop], budget: Budget | None = None) -> tuple[DrawnPart, ...]:
    """Return the parts that loops make, by decreasing area;
    each is an outer loop with the holes directly in it.

    Of loops that cross, no correct nesting is promised; they are refused later. Outlines that share lines (of
    one nest) are separate parts, although their borders touch. ``budget`` is spent; None means no limit.
    """
    budget = budget or Budget(UNLIMITED)
    rings = sorted(map(MeasuredLoop.from_loop, loops), key=lambda r: -r.area)
    nests = np.array([ring.loop.nest for ring in rings])
    boxes = np.array([r.box for r in rings]).reshape(-1, 4)
    depths: list[int] = []
    holes: dict[int, list[int]] = {}
    for k, inner in enumerate(rings):
        x0, y0, x1, y1 = inner.box
        larger = boxes[:k]
        around = (larger[:, 0] <= x0) & (larger[:, 1] <= y0) & (larger[:, 2] >= x1) & (larger[:, 3] >= y1)
        if nests[k]:
            around &= nests[:k] != nests[k]
        # The smallest loop around it says how deep it lies, unless loops cross.
        parent = None
        for j in reversed(np.flatnonzero(around).tolist()):
            budget.count_steps()
            if lies_inside(inner, rings[j]):
                parent = j
                break
        depths.append(0 if parent is None else depths[parent] + 1)
        if depths[k] % 2 == 0:
            holes[k] = []
        else:
            assert parent is not None
            holes[parent].append(k)
    parts = []
    for outline, inside in holes.items():
        area = rings[outline].area - sum(rings[k].area for k in inside)
        parts.append((area, outline, inside))
    parts.sort(key=lambda part: (-part[0], part[1]))
    return tuple(
        DrawnPart(number, tuple(rings[k].loop for k in (outline, *inside)), area, rings[outline].box)
        for number, (area, outline, inside) in enumerate(parts, start=1)
    )


def lies_inside(inner: MeasuredLoop, outer: MeasuredLoop) -> bool:
    """Return whether the loop ``inner`` lies inside the loop ``outer``; they may share lines."""
    x, y = inner.segments[0].start
    if measure_outline_distances(np.array([(x, y)]), outer.rows)[0] > TOUCHING:
        return bool(is_inside(x, y, outer.rows))
    # It begins on the border of the other: what is farthest from that decides.
    places = np.array([p for one in inner.segments for p in (one.start, one.middle)])
    farthest = places[int(measure_outline_distances(places, outer.rows).argmax())]
    return bool(is_inside(float(farthest[0]), float(farthest[1]), outer.rows))


def join_loops_as_one_part(loops: Sequence[JoinedLoop]) -> DrawnPart:
    """Return the loops of one workpiece as one part, also where it has several outer ones."""
    parts = nest_loops(loops)
    x0, y0, x1, y1 = zip(*(part.bounds for part in parts), strict=True)
    inside = tuple(loop for part in parts for loop in part.loops)
    bounds = min(x0), min(y0), max(x1), max(y1)
    return DrawnPart(1, inside, sum(part.area for part in parts), bounds)


def refuse_loops_across(part: DrawnPart, others: Sequence[DrawnPart], budget: Budget | None = None) -> None:
    """Raise InputError where loops of other parts cross or touch a part, as holes drawn half outside do.

    The outer loop of another part may touch this part's outer loop from outside, as between parts that share
    a cut.
    """
    budget = budget or Budget(UNLIMITED)
    comparisons = ComparisonBudget("the part")
    own = [MeasuredLoop.from_loop(loop) for loop in part.loops]
    shapes = [LoopShape.from_segments(make_loop_segments(one.loop.vertices)) for one in own]
    for other in others:
        budget.count_steps()
        if not boxes_meet(part.bounds, other.bounds):
            continue
        for theirs in map(MeasuredLoop.from_loop, other.loops):
            for ours, shape in zip(own, shapes, strict=True):
                budget.count_steps()
                if not boxes_meet(ours.box, theirs.box) or 0 != ours.loop.nest == theirs.loop.nest:
                    continue
                try:
                    refuse_meeting_loops(
                        shape,
                        LoopShape.from_segments(make_loop_segments(theirs.loop.vertices)),
                        ours.loop.labels.__getitem__,
                        theirs.loop.labels.__getitem__,
                        comparisons,
                    )
                except InputError:
                    outer = ours is own[0] and theirs.loop is other.loops[0]
                    if not (outer and touch_from_outside(ours, theirs)):
                        raise


def touch_from_outside(one: MeasuredLoop, other: MeasuredLoop) -> bool:
    """Return whether two loops touch each other only from
    outside: no piece of either lies inside the other.
    """
    carriers = subdivide([*one.segments, *other.segments], comparisons=ComparisonBudget("the part"))
    for carrier in carriers:
        for low, high in carrier.list_covered_pieces():
            (x, y), (nx, ny) = (
                carrier.compute_point((low + high) / 2),
                carrier.compute_left_normal((low + high) / 2),
            )
            for side in (-BESIDE, BESIDE):
                place = x + side * nx, y + side * ny
                if is_inside(*place, one.rows) and is_inside(*place, other.rows):
                    return False
    return True


def boxes_meet(a: Sequence[float], b: Sequence[float]) -> bool:
    """Return whether two bounding boxes (x0, y0, x1, y1) overlap or touch."""
    return a[0] <= b[2] and b[0] <= a[2] and a[1] <= b[3] and b[1] <= a[3]


def choose_part(parts: Sequence[DrawnPart], number: int | str | None) -> DrawnPart:
    """Return the part with the number given (from 1); for None the first part, which is the largest.

    Raises InputError for a number that no part has, and for a name, because drawn parts have none.
    """
    if number is None:
        return parts[0]
    if isinstance(number, str):
        raise InputError(
            f"There is no part {shorten_middle(make_printable(number))!r}: only solids of a STEP file have names, so give "
            "a number."
        )
    if not 1 <= number <= len(parts):
        have = "only one part" if len(parts) == 1 else f"parts 1 to {len(parts)}"
        raise InputError(f"There is no part {number}: the file holds {have}, numbered by decreasing area.")
    return parts[number - 1]
