"""The contents of a view of a set-up from the side: spans across the view, and elements hidden by the part.

Only known geometry is drawn. A part from a drawing is a prism. A part from a solid has its outline up to the
pegs' head room; above that only the part's height and the extents of its level upper faces are known.

Glossary
--------
across : along the view's horizontal axis, from left to right, in mm.
span : (least, greatest) horizontal coordinate of a thing in the view, in mm.
hidden : behind the part, as seen by the viewer.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.drawing.bench import BenchDrawing, find_contact
from workhold.drawing.scene import View
from workhold.drawing.sheet_writing import SheetHeights
from workhold.fixels.contacts import CLAMP_TIP
from workhold.geometry.loop import check_vertices, make_loop_segments
from workhold.geometry.segment import Box, Point
from workhold.model.solid import Band
from workhold.model.support_triples import ChosenSupports
from workhold.model.workpiece import Workpiece

__all__ = ["SideContact", "SidePad", "SideView", "choose_side_view"]

Span = tuple[float, float]
# Points along the outline stand at most so far apart, as a share of the part's extent.
FINE = 1 / 400


@frozen
class ViewDirection:
    """A direction of view.

    Parameters
    ----------
    words : such as "from below".
    seen_along : the direction of the plan along which the viewer looks.
    right : unit vector in the plan that points to the right of the view.
    towards : unit vector in the plan towards the viewer.
    """

    words: str
    seen_along: str
    right: Point
    towards: Point

    def project(self, point: Point) -> float:
        """Return a plan point's horizontal coordinate in the view, in mm."""
        return point[0] * self.right[0] + point[1] * self.right[1]

    def project_box(self, box: Box) -> Span:
        """Return the least and greatest horizontal coordinate, in mm, of a plan box."""
        ends = [self.project(corner) for corner in ((box.x0, box.y0), (box.x1, box.y1))]
        return min(ends), max(ends)


# The view that stands below the plan in first-angle order comes first: it is taken where all else is equal.
WAYS = (
    ViewDirection("from the lower side of the plan", "+y", (1.0, 0.0), (0.0, -1.0)),
    ViewDirection("from the right side of the plan", "−x", (0.0, 1.0), (1.0, 0.0)),
)


@frozen
class SideContact:
    """A peg, or the tip of a clamp, in the view.

    Parameters
    ----------
    name : name of its hole.
    at, radius : its horizontal coordinate and its radius, in mm.
    touches : horizontal coordinate of the point where it touches the part.
    band : the heights (low, high) at which it presses; None where they are unknown.
    is_hidden : whether the part is between it and the viewer.
    hole : for a clamp with a known hole, the hole's horizontal coordinate; None for pegs.
    is_clamp : whether it is the tip of a clamp.
    heights : heights (low, high) of its carrier, if the carrier has heights of its own; None if it is as high
        as the pegs.
    """

    name: str
    at: float
    radius: float
    touches: float
    band: Band | None
    is_hidden: bool
    hole: float | None
    is_clamp: bool
    heights: Band | None = None


@frozen
class SidePad:
    """A support in the view: its hole's name, and its horizontal coordinate in mm."""

    name: str
    at: float


@frozen
class SideView:
    """A set-up from the side; spans and coordinates are horizontal, in mm.

    Parameters
    ----------
    way : direction of view.
    heights : all heights of the set-up.
    part : span of the part's outline.
    upper : span of the part above ``heights.known_up_to``, as far as known.
    feet : spans on which the part lies; the whole outline if no level lower face is known.
    plates, walls : their spans.
    contacts : pegs and clamps.
    pads, pad_radius : the supports, and the radius of each.
    clamp, tip_radius : horizontal coordinate of the clamp on top (None without one), and the radius of its
        tip.
    clamped_height : height at which the clamp on top presses.
    wall_heights : heights (low, high) of walls, where these are their own; otherwise None.
    tops : (span, height) of each level upper face above ``heights.known_up_to``.
    """

    way: ViewDirection
    heights: SheetHeights
    part: Span
    upper: Span
    feet: tuple[Span, ...]
    plates: tuple[Span, ...]
    walls: tuple[Span, ...]
    contacts: tuple[SideContact, ...]
    pads: tuple[SidePad, ...] = ()
    pad_radius: float = 0.0
    clamp: float | None = None
    tip_radius: float = 0.0
    clamped_height: float = 0.0
    wall_heights: Band | None = None
    tops: tuple[tuple[Span, float], ...] = ()

    @property
    def extent(self) -> Box:
        """The box of everything, horizontal coordinate by height, in mm."""
        spans = [self.part, self.upper, *self.plates, *self.walls]
        spans += [(one.at - one.radius, one.at + one.radius) for one in self.contacts]
        spans += [
            (one.hole - one.radius, one.hole + one.radius) for one in self.contacts if one.hole is not None
        ]
        low = -self.heights.supported_by - self.heights.plate_thickness
        own = [one.heights for one in self.contacts if one.heights is not None]
        high = max(self.heights.thickness, self.heights.peg_top, *(top for _, top in own))
        return Box(min(a for a, _ in spans), low, max(b for _, b in spans), high)


def choose_side_view(
    bench: BenchDrawing,
    workpiece: Workpiece,
    heights: SheetHeights,
    supports: ChosenSupports | None = None,
) -> SideView:
    """Return the best side view: no wall hides the part, and most pegs are clear of each other.

    Among equally good views, the one with the widest least gap between pegs is chosen.
    """
    way = max(
        WAYS, key=lambda one: (sees_past_walls(bench, one), *measure_peg_spread(bench, one), -WAYS.index(one))
    )
    pose, (x0, x1) = bench.fixture.pose, way.project_box(bench.shown.part)
    pads, request = ((), None) if supports is None else (supports.pads, supports.supports.request)
    placed = [SidePad(pad.hole, way.project(pose.apply(pad.x, pad.y))) for pad in pads]
    solid = workpiece.solid
    tops, feet = (
        ([], [])
        if solid is None
        else (collect_spans(loops or (), bench, way) for loops in (solid.top, solid.bottom))
    )
    levels: dict[float, list[Sequence[Sequence[float]]]] = {}
    if solid is not None:
        tops_at = solid.top_heights or (heights.thickness,) * len(solid.top or ())
        for loop, height in zip(solid.top or (), tops_at, strict=True):
            levels.setdefault(height, []).append(loop)
    return SideView(
        way=way,
        heights=heights,
        part=(x0, x1),
        upper=(min([x0, *(a for a, _ in tops)]), max([x1, *(b for _, b in tops)])),
        feet=tuple(feet or [(x0, x1)]),
        plates=tuple(merge_spans(way.project_box(one.plate) for one in bench.shown.carriers)),
        walls=tuple(way.project_box(one.bar) for one in bench.shown.walls),
        contacts=tuple(list_side_contacts(bench, way, heights)),
        pads=tuple(placed),
        pad_radius=0.0 if request is None else request.pad_radius,
        clamp=None if supports is None else way.project(pose.apply(*supports.clamp.at)),
        tip_radius=0.0 if request is None else request.tip_radius,
        clamped_height=heights.thickness if heights.clamped_height is None else heights.clamped_height,
        tops=tuple(
            (span, height)
            for height, loops in sorted(levels.items())
            if height > heights.known_up_to
            for span in collect_spans(loops, bench, way)
        ),
        wall_heights=next((wall.carrier.heights for wall in bench.shown.walls), None),
    )


def sees_past_walls(bench: BenchDrawing, way: ViewDirection) -> bool:
    """Return whether every wall hides less than half of the part's width in the view."""
    low, high = way.project_box(bench.shown.part)
    walls = [way.project_box(wall.bar) for wall in bench.shown.walls]
    return all(min(high, b) - max(low, a) < 0.5 * (high - low) for a, b in walls)


def measure_peg_spread(bench: BenchDrawing, way: ViewDirection) -> tuple[int, float]:
    """Return (number of gaps between neighbouring pegs in the view, least gap in mm); the least gap is 0
    without gaps.
    """
    pegs = [bench.fixture.pegs[k] for k in bench.placed]
    places = sorted(
        (way.project((peg.x, peg.y)), bench.toolkit.find_carrier(peg.carrier).peg_radius) for peg in pegs
    )
    gaps = [right - left - r - s for (left, r), (right, s) in pairwise(places)]
    clear = [gap for gap in gaps if gap > 0]
    return len(clear), round(min(clear, default=0.0), 6)


def merge_spans(spans: Iterable[Span]) -> list[Span]:
    """Return the union of spans as disjoint spans, from left to right.

    >>> merge_spans([(5, 9), (0, 3), (2, 4)])
    [(0, 4), (5, 9)]
    """
    out: list[Span] = []
    for low, high in sorted(spans):
        if out and low <= out[-1][1]:
            out[-1] = out[-1][0], max(out[-1][1], high)
        else:
            out.append((low, high))
    return out


def collect_spans(
    loops: Iterable[Sequence[Sequence[float]]], bench: BenchDrawing, way: ViewDirection
) -> list[Span]:
    """Return the disjoint horizontal spans that level faces have in the view.

    ``loops`` are the borders of the faces, in the part's frame.
    """
    found = []
    for number, loop in enumerate(loops):
        rows = [list(vertex) for vertex in loop]
        vertices = check_vertices(rows, f"face {number}", lambda side: f"side {side}")
        placed = map(bench.fixture.pose.carry, make_loop_segments(vertices))
        places = [
            way.project(one.compute_point(share * one.half_extent)) for one in placed for share in SHARES
        ]
        found.append((min(places), max(places)))
    return merge_spans(found)


SHARES = tuple(np.linspace(-1.0, 1.0, 33).tolist())


def list_side_contacts(
    bench: BenchDrawing, way: ViewDirection, heights: SheetHeights
) -> Iterable[SideContact]:
    """Yield the pegs and clamps of a fixture, with their places in the view."""
    size = max(bench.shown.part.width, bench.shown.part.height)
    step = max(size * FINE, 1e-9)
    outlines = bench.sample_outlines(View(1.0, 0.0, 0.0), step)
    holes = {clamp.tip: clamp.hole for clamp in bench.shown.clamps}
    for index in bench.placed:
        peg = bench.fixture.pegs[index]
        carrier = bench.toolkit.find_carrier(peg.carrier)
        touches, _ = find_contact(carrier.contact, (peg.x, peg.y), bench.faces[index])
        hole = holes.get(peg)
        yield SideContact(
            name=peg.hole,
            at=way.project((peg.x, peg.y)),
            radius=carrier.peg_radius,
            touches=way.project(touches),
            band=heights.bands[index],
            is_hidden=any(hides_point(outline, (peg.x, peg.y), way) for outline in outlines),
            hole=None if hole is None else way.project(hole),
            is_clamp=carrier.contact is CLAMP_TIP,
            heights=carrier.heights,
        )


def hides_point(outline: NDArray[np.float64], at: Point, way: ViewDirection) -> bool:
    """Return whether the part's loop ``outline`` lies between a point of the plan and the viewer.

    ``outline`` (N, 2) has its points in mm with y downward, as on a page.
    """
    x, y = outline[:, 0], -outline[:, 1]
    across = x * way.right[0] + y * way.right[1] - way.project(at)
    near = (x - at[0]) * way.towards[0] + (y - at[1]) * way.towards[1]
    # Where the ray crosses, the outline changes sides.
    before, after = across[:-1], across[1:]
    crosses = (before < 0) != (after < 0)
    share = np.where(crosses, before / np.where(crosses, before - after, 1.0), 0.0)
    return bool((crosses & (near[:-1] + share * (near[1:] - near[:-1]) > 0)).any())
