"""The planar subdivision of lines and arcs: the pieces into which they cut each other, and loops of these.

Segments of one carrier are put together first, so a piece that many segments share is there once. A region is
known by asking beside every piece whether its points belong to it; pieces with the region on one side only
are its border.

Glossary
--------
subdivision : the pieces of some curves between all points in which these meet (de Berg et al.,
    "Computational Geometry", chapter 2).
position : place along a carrier: millimetres on a line, radians on a circle.
span : a range of positions that some segment covers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from itertools import pairwise, product
from math import atan2, cos, dist, pi, sin, tau

import numpy as np
from attrs import Factory, define, field, frozen
from numpy.typing import NDArray

from workhold.errors import InputError
from workhold.geometry.loop import Comparisons, near_pairs
from workhold.geometry.segment import Arc, Line, Point, Segment, bounding_box, carrier_intersections

__all__ = ["BorderPiece", "CutCarrier", "border_loops", "border_pieces", "distinct_sorted", "subdivide"]

# Carriers, and points along one, that differ by less than this in mm are one.
ONE = 1e-6
# Pieces shorter than this in mm come of rounding and are left out.
SHORT = 1e-5
# How far beside a piece its two sides are looked at, in mm, and as a share of the piece.
BESIDE, BESIDE_SHARE = 4e-4, 0.1


@define
class CutCarrier:
    """A line or a circle with the spans that segments cover, and the positions at which it is cut.

    Parameters
    ----------
    segment : one segment on it, which fixes positions: they are its parameters.
    spans : (low, high) positions; of a circle low is in [-pi, pi) and high less than a turn above.
    cuts : positions.
    owners : for every span the number of the segment that covers it, by the order in which they were given.
    """

    segment: Segment
    spans: list[tuple[float, float]] = Factory(list)
    cuts: list[float] = Factory(list)
    owners: list[int] = Factory(list)
    # The number of spans, and the points (N, 2) of their ends, once these were asked for.
    ends: tuple[int, NDArray[np.float64]] | None = field(init=False, default=None, eq=False, repr=False)

    @property
    def slack(self) -> float:
        """The position's change that is ``ONE`` long."""
        return ONE if isinstance(self.segment, Line) else ONE / self.segment.radius

    def holds(self, other: Segment) -> bool:
        """Whether another segment lies on the same line or circle."""
        own = self.segment
        if isinstance(own, Line) and isinstance(other, Line):
            (x, y), (tx, ty) = own.middle, own.tangent
            return all(abs((px - x) * ty - (py - y) * tx) <= ONE for px, py in (other.start, other.end))
        if isinstance(own, Arc) and isinstance(other, Arc):
            return dist(own.center, other.center) <= ONE and abs(own.radius - other.radius) <= ONE
        return False

    def position(self, point: Point) -> float:
        """The position of the carrier's point nearest to a point."""
        return self.segment.parameter(point)

    def at(self, position: float) -> Point:
        """The point at a position."""
        return self.segment.at(position)

    def left(self, position: float) -> Point:
        """Unit vector to the left when positions grow; on a circle it points to the centre."""
        if isinstance(self.segment, Line):
            tx, ty = self.segment.tangent
            return -ty, tx
        angle = self.segment.mid_angle + position
        return -cos(angle), -sin(angle)

    def add(self, segment: Segment) -> None:
        """Covers the span of a segment on this carrier, and cuts at its ends."""
        if isinstance(segment, Arc) and segment.is_full:
            self.spans.append((-pi, pi))
            return
        first, last = self.position(segment.start), self.position(segment.end)
        if isinstance(segment, Arc):
            if segment.sign < 0:
                first, last = last, first
            if last < first:
                last += tau
        self.spans.append((min(first, last), max(first, last)))
        self.cuts += [first, last]

    def ends_near(self, segment: Segment) -> list[Point]:
        """Ends of spans that lie within twice ``ONE`` of a segment's line or circle."""
        if self.ends is None or self.ends[0] != len(self.spans):
            found = [self.at(position) for position in {end for span in self.spans for end in span}]
            self.ends = len(self.spans), np.array(found).reshape(-1, 2)
        points = self.ends[1]
        if isinstance(segment, Line):
            (x, y), (tx, ty) = segment.middle, segment.tangent
            away = np.abs((points[:, 0] - x) * ty - (points[:, 1] - y) * tx)
        else:
            x, y = segment.center
            away = np.abs(np.hypot(points[:, 0] - x, points[:, 1] - y) - segment.radius)
        return [(float(px), float(py)) for px, py in points[away <= 2 * ONE]]

    def covers(self, position: float) -> bool:
        """Whether a span holds a position, ends included."""
        turns = (0.0,) if isinstance(self.segment, Line) else (-tau, 0.0, tau)
        slack = self.slack
        return any(
            low - slack <= position + turn <= high + slack for low, high in self.spans for turn in turns
        )

    def pieces(self) -> list[tuple[float, float]]:
        """Pieces between neighbouring cuts that are covered."""
        slack = self.slack
        cuts = np.array(self.cuts)
        if isinstance(self.segment, Arc):
            cuts = (cuts + pi) % tau - pi
            if len(cuts) == 0:
                return [(-pi, 0.0), (0.0, pi)]
        distinct = distinct_sorted(cuts, slack)
        if isinstance(self.segment, Arc):
            if len(distinct) > 1 and distinct[0] + tau - distinct[-1] <= slack:
                distinct.pop()
            distinct.append(distinct[0] + tau)
            if len(distinct) == 2:
                distinct.insert(1, distinct[0] + pi)
        least = SHORT / ONE * slack
        return [
            (low, high)
            for low, high in pairwise(distinct)
            if high - low > least and self.covers((low + high) / 2)
        ]


def distinct_sorted(values: NDArray[np.float64], slack: float) -> list[float]:
    """Sorted values without those that lie within the slack above another."""
    distinct: list[float] = []
    for value in np.sort(values):
        if not distinct or value - distinct[-1] > slack:
            distinct.append(float(value))
    return distinct


def subdivide(
    segments: Iterable[Segment],
    cuts: Iterable[tuple[Segment, Point]] = (),
    comparisons: Comparisons | None = None,
) -> list[CutCarrier]:
    """Carriers of some segments, cut wherever two of them meet.

    Parameters
    ----------
    segments : in any order and direction; they may overlap.
    cuts : further points at which the carrier of a segment is to be cut.
    comparisons : how many pairs may still be compared; None is no limit.

    Raises
    ------
    InputError
        For more pairs than that.
    """
    carriers: list[CutCarrier] = []
    found: dict[tuple[int, ...], list[CutCarrier]] = {}
    for number, segment in enumerate(segments):
        carrier = carrier_of(segment, carriers, found, comparisons)
        carrier.add(segment)
        carrier.owners.append(number)
    for segment, point in cuts:
        carrier = carrier_of(segment, carriers, found)
        carrier.cuts.append(carrier.position(point))
    carriers = [carrier for carrier in carriers if carrier.spans]
    if comparisons is not None:
        # Every piece is asked for all spans.
        comparisons.spend(sum(len(one.spans) * (len(one.cuts) // 32 + 1) for one in carriers))
    boxes = np.array([covered_box(carrier) for carrier in carriers]).reshape(-1, 4)
    for a, b in near_pairs(boxes, boxes):
        if comparisons is not None:
            # It takes about as long as so many others.
            comparisons.spend(10)
        if a < b:
            cut_each_other(carriers[a], carriers[b])
    return carriers


def carrier_of(
    segment: Segment,
    carriers: list[CutCarrier],
    found: dict[tuple[int, ...], list[CutCarrier]],
    comparisons: Comparisons | None = None,
) -> CutCarrier:
    """The carrier of a segment, made if it is not there; ``found`` holds carriers by rough place."""
    keys = rough_keys(segment)
    for key in keys:
        if comparisons is not None:
            comparisons.spend(len(found.get(key, ())))
        for carrier in found.get(key, ()):
            if carrier.holds(segment):
                return carrier
    carrier = CutCarrier(segment)
    carriers.append(carrier)
    found.setdefault(keys[0], []).append(carrier)
    return carrier


def rough_keys(segment: Segment) -> list[tuple[int, ...]]:
    """Where a carrier may be kept: the cell of its place first, then the neighbouring cells."""
    around = (0, -1, 1)
    if isinstance(segment, Arc):
        x, y, r = (round(value / 1e-3) for value in (*segment.center, segment.radius))
        return [(x + a, y + b, r + c) for a, b, c in product(around, repeat=3)]
    tx, ty = segment.tangent
    # A short segment leaves its direction open; the cells of lines are therefore by direction only.
    cell, last = round(atan2(ty, tx) % pi / 1e-2), round(pi / 1e-2)
    return [((cell + a) % last, 0) for a in around]


def covered_box(carrier: CutCarrier) -> tuple[float, float, float, float]:
    """A box around all that is covered, grown by ``ONE``."""
    own = carrier.segment
    if isinstance(own, Arc):
        (x, y), r = own.center, own.radius + ONE
        return x - r, y - r, x + r, y + r
    low, high = min(a for a, _ in carrier.spans), max(b for _, b in carrier.spans)
    x0, y0, x1, y1 = bounding_box(own.part(low, high))
    return x0 - ONE, y0 - ONE, x1 + ONE, y1 + ONE


def cut_each_other(a: CutCarrier, b: CutCarrier) -> None:
    """Cuts two carriers where both are covered and meet, or where a span of one ends on the other."""
    points = list(carrier_intersections(a.segment, b.segment))
    for one, other in ((a, b), (b, a)):
        for point in one.ends_near(other.segment):
            if dist(point, other.at(other.position(point))) <= ONE:
                points.append(point)
    for point in points:
        first, second = a.position(point), b.position(point)
        if a.covers(first) and b.covers(second):
            a.cuts.append(first)
            b.cuts.append(second)


@frozen
class BorderPiece:
    """A piece of a region's border, run with the region on its left.

    Parameters
    ----------
    carrier : the line or circle that it lies on.
    low, high : positions on the carrier, in mm or radians.
    forward : whether positions grow along the run.
    """

    carrier: CutCarrier
    low: float
    high: float
    forward: bool

    @property
    def start(self) -> Point:
        """First point of the run."""
        return self.carrier.at(self.low if self.forward else self.high)

    @property
    def end(self) -> Point:
        """Last point of the run."""
        return self.carrier.at(self.high if self.forward else self.low)

    @property
    def length(self) -> float:
        """Length of the run in mm."""
        own = self.carrier.segment
        return (self.high - self.low) * (1.0 if isinstance(own, Line) else own.radius)

    def heading(self, *, at_end: bool) -> float:
        """Direction of the run in radians, at its first point or its last."""
        nx, ny = self.carrier.left(self.high if at_end == self.forward else self.low)
        return atan2(-nx, ny) if self.forward else atan2(nx, -ny)

    @property
    def bulge(self) -> float:
        """The DXF bulge of the run."""
        if isinstance(self.carrier.segment, Line):
            return 0.0
        quarter = (self.high - self.low) / 4
        return (sin(quarter) / cos(quarter)) * (1.0 if self.forward else -1.0)


def border_pieces(carriers: Sequence[CutCarrier], inside: Callable[[Point], bool]) -> list[BorderPiece]:
    """Pieces with a region on one side only.

    Parameters
    ----------
    carriers : see :func:`subdivide`; they hold the region's whole border.
    inside : whether a point (x, y) that lies on no carrier belongs to the region.
    """
    found = []
    pieces = [(carrier, low, high) for carrier in carriers for low, high in carrier.pieces()]
    middles = [carrier.at((low + high) / 2) for carrier, low, high in pieces]
    free = clearances([carrier for carrier, _, _ in pieces], middles, carriers)
    for (carrier, low, high), (x, y), room in zip(pieces, middles, free, strict=True):
        unit = 1.0 if isinstance(carrier.segment, Line) else carrier.segment.radius
        nx, ny = carrier.left((low + high) / 2)
        beside = min(BESIDE, BESIDE_SHARE * (high - low) * unit, room / 2)
        left = inside((x + beside * nx, y + beside * ny))
        right = inside((x - beside * nx, y - beside * ny))
        if left != right:
            found.append(BorderPiece(carrier, low, high, left))
    return found


def clearances(
    own: Sequence[CutCarrier], points: Sequence[Point], carriers: Sequence[CutCarrier]
) -> list[float]:
    """How far in mm points of carriers are from what is covered of the others, where that is very near.

    Other carriers do not meet these points, which lie between cuts; one that nearly touches there lies between
    a point and a place that is looked at beside it.
    """
    places = np.array(points).reshape(-1, 2)
    free = [2 * BESIDE] * len(points)
    for carrier in carriers:
        segment = carrier.segment
        if isinstance(segment, Arc):
            away = np.abs(
                np.hypot(places[:, 0] - segment.center[0], places[:, 1] - segment.center[1]) - segment.radius
            )
        else:
            (x, y), (tx, ty) = segment.middle, segment.tangent
            away = np.abs((places[:, 0] - x) * ty - (places[:, 1] - y) * tx)
        for k in np.flatnonzero((away < 2 * BESIDE) & (away > ONE)).tolist():
            if own[k] is not carrier and carrier.covers(carrier.position(points[k])):
                free[k] = min(free[k], float(away[k]))
    return free


def border_loops(pieces: Sequence[BorderPiece], reach: float = 1e-4) -> list[list[BorderPiece]]:
    """Pieces of a border joined to closed loops, each run with the region on the left.

    Where several runs leave a point, the one that turns farthest to the left is taken. So two corners of a
    region that touch stay corners of one loop each. Pieces shorter than a gap are no loop, and may be left
    out.

    Parameters
    ----------
    reach : largest gap in mm between the ends of neighbouring pieces.

    Raises
    ------
    InputError
        When a loop does not close, so that some of the border is missing.
    """
    left = set(range(len(pieces)))
    starts = np.array([piece.start for piece in pieces]).reshape(-1, 2)
    long = [k for k, piece in enumerate(pieces) if piece.length > reach]
    loops = []
    for first in long:
        if first not in left:
            continue
        left.discard(first)
        loop = [first]
        while True:
            x, y = pieces[loop[-1]].end
            near = np.flatnonzero(np.hypot(starts[:, 0] - x, starts[:, 1] - y) <= reach)
            free = [int(k) for k in near if k in left or k == first]
            if not free:
                raise InputError(f"the outline does not close at ({x:.6g}, {y:.6g})")
            heading = pieces[loop[-1]].heading(at_end=True)
            following = max(free, key=lambda k: turn_left(heading, pieces[k].heading(at_end=False)))
            if following == first:
                break
            left.discard(following)
            loop.append(following)
        loops.append([pieces[k] for k in loop])
    return loops


def turn_left(before: float, after: float) -> float:
    """Turn from one direction to another in radians, in (-pi, pi], positive to the left."""
    return -((before - after + pi) % tau - pi)
