"""The planar subdivision of lines and arcs: the pieces into which they cut each other, and loops of these.

Segments of one carrier are put together first, so a piece that many segments share is there once. A region is
known by asking beside every piece whether its points belong to it; pieces with the region on one side only
are its border. It is asked where no other carrier runs between the piece and the points. Two pieces that run
nowhere farther apart than carriers that are one, as beside the place where a circle touches a line, have such
points on their outer sides only, and one of them is the border.

Glossary
--------
subdivision : the pieces of some curves between all points in which these meet (de Berg et al.,
    "Computational Geometry", chapter 2).
position : place along a carrier: millimetres on a line, radians on a circle.
span : a range of positions that some segment covers.
clearance : how far a point of a piece is from all other carriers, as far as they are covered, in mm.
twins : pieces of several carriers between the same two ends that run nowhere farther apart than ``THIN``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import pairwise, product
from math import atan2, cos, dist, inf, pi, sin, tau

import numpy as np
from attrs import Factory, define, evolve, field, frozen
from numpy.typing import NDArray

from workhold.errors import InputError
from workhold.geometry.loop import Comparisons, find_near_pairs
from workhold.geometry.segment import Arc, Line, Point, Segment, bounding_box, find_carrier_crossings

__all__ = [
    "BorderPiece",
    "CutCarrier",
    "Inside",
    "join_border_loops",
    "find_border_pieces",
    "sort_distinct",
    "subdivide",
]

# Carriers, and points along one, that differ by less than this in mm are one.
ONE = 1e-6
# Pieces shorter than this in mm come of rounding and are left out.
SHORT = 1e-5
# mm. Largest gap between the ends of neighbouring pieces of a border.
REACH = 1e-4
# How far beside a piece its two sides are looked at, in mm, and as a share of the piece: far enough that
# what rises by 0.001 for 1 and ends at the piece is there.
BESIDE, BESIDE_SHARE = 2e-2, 0.1
# Where along a piece that may be, as shares of it: the first where nothing is near, or where it is farthest.
SHARES = (0.5, 0.25, 0.75, 0.375, 0.625, 0.125, 0.875, 0.03, 0.97)
# mm. Pieces that run no farther apart are twins, if their ends are no farther from each other than the second.
THIN, SAME_END = 2 * ONE, 10 * ONE
# Points times carriers that are looked at together.
AT_ONCE = 1 << 20
# Which of some points (x, y) belong to a region.
Inside = Callable[[Sequence[Point]], Sequence[bool]]


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

    def apart(self, one: float, other: float) -> float:
        """How far two positions are apart, on a circle the shorter way round."""
        away = abs(one - other)
        return away if isinstance(self.segment, Line) else abs((away + pi) % tau - pi)

    def pieces(self) -> list[tuple[float, float]]:
        """Pieces between neighbouring cuts that are covered."""
        slack = self.slack
        cuts = np.array(self.cuts)
        if isinstance(self.segment, Arc):
            cuts = (cuts + pi) % tau - pi
            if len(cuts) == 0:
                return [(-pi, 0.0), (0.0, pi)]
        distinct = sort_distinct(cuts, slack)
        if isinstance(self.segment, Arc):
            if len(distinct) > 1 and distinct[0] + tau - distinct[-1] <= slack:
                distinct.pop()
            distinct.append(distinct[0] + tau)
            for before, after in pairwise(distinct):
                # All of a circle, or almost, would end where it begins.
                if tau - (after - before) <= REACH / self.segment.radius:
                    distinct.append(before + pi)
            distinct.sort()
        least = SHORT / ONE * slack
        return [
            (low, high)
            for low, high in pairwise(distinct)
            if high - low > least and self.covers((low + high) / 2)
        ]


def sort_distinct(values: NDArray[np.float64], slack: float) -> list[float]:
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
        carrier = find_or_make_carrier(segment, carriers, found, comparisons)
        carrier.add(segment)
        carrier.owners.append(number)
    further = []
    for segment, point in cuts:
        carrier = find_or_make_carrier(segment, carriers, found)
        carrier.cuts.append(carrier.position(point))
        further.append((carrier, point))
    carriers = [carrier for carrier in carriers if carrier.spans]
    if comparisons is not None:
        # Every piece is asked for all spans.
        comparisons.spend(sum(len(one.spans) * (len(one.cuts) // 32 + 1) for one in carriers))
    boxes = np.array([bound_covered(carrier) for carrier in carriers]).reshape(-1, 4)
    for a, b in find_near_pairs(boxes, boxes):
        if comparisons is not None:
            # It takes about as long as so many others.
            comparisons.spend(10)
        if a < b:
            cut_each_other(carriers[a], carriers[b])
    cut_twins(Carriers.of(carriers), further)
    return carriers


def cut_twins(carriers: Carriers, cuts: Sequence[tuple[CutCarrier, Point]]) -> None:
    """Cuts what runs beside a carrier where that is cut besides, so that twins have the same ends."""
    for number, other in carriers.near(np.array([point for _, point in cuts]).reshape(-1, 2), THIN):
        own, point = cuts[number]
        if other is own or carriers.distance(other, point) > THIN:
            continue
        position = other.position(point)
        if all(other.apart(position, cut) > other.slack for cut in other.cuts):
            other.cuts.append(position)


def find_or_make_carrier(
    segment: Segment,
    carriers: list[CutCarrier],
    found: dict[tuple[int, ...], list[CutCarrier]],
    comparisons: Comparisons | None = None,
) -> CutCarrier:
    """The carrier of a segment, made if it is not there; ``found`` holds carriers by rough place."""
    keys = list_rough_keys(segment)
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


def list_rough_keys(segment: Segment) -> list[tuple[int, ...]]:
    """Where a carrier may be kept: the cell of its place first, then the neighbouring cells."""
    around = (0, -1, 1)
    if isinstance(segment, Arc):
        x, y, r = (round(value / 1e-3) for value in (*segment.center, segment.radius))
        return [(x + a, y + b, r + c) for a, b, c in product(around, repeat=3)]
    tx, ty = segment.tangent
    # A short segment leaves its direction open; the cells of lines are therefore by direction only.
    cell, last = round(atan2(ty, tx) % pi / 1e-2), round(pi / 1e-2)
    return [((cell + a) % last, 0) for a in around]


def bound_covered(carrier: CutCarrier) -> tuple[float, float, float, float]:
    """A box around all that is covered, grown by ``ONE``."""
    own = carrier.segment
    if isinstance(own, Arc):
        (x, y), r = own.center, own.radius + ONE
        return x - r, y - r, x + r, y + r
    low, high = min(a for a, _ in carrier.spans), max(b for _, b in carrier.spans)
    x0, y0, x1, y1 = bounding_box(own.part(low, high))
    return x0 - ONE, y0 - ONE, x1 + ONE, y1 + ONE


def cut_each_other(a: CutCarrier, b: CutCarrier) -> None:
    """Cuts two carriers where both are covered and meet, or where a span of one ends on the other.

    A circle that passes another or a line by so little that the two points are one gap touches it in the
    middle between them: the piece between would be closed like a gap, and move the ends of those beside it.
    """
    points = list(find_carrier_crossings(a.segment, b.segment))
    if len(points) == 2 and SHORT < dist(*points) <= REACH:
        (x0, y0), (x1, y1) = points
        points = [((x0 + x1) / 2, (y0 + y1) / 2)]
    for one, other in ((a, b), (b, a)):
        for point in one.ends_near(other.segment):
            if dist(point, other.at(other.position(point))) <= ONE:
                points.append(point)
    for point in points:
        first, second = a.position(point), b.position(point)
        if a.covers(first) and b.covers(second):
            a.cuts.append(first)
            b.cuts.append(second)


@frozen(eq=False)
class Carriers:
    """Some carriers, asked together which of them run near points.

    Parameters
    ----------
    every : the carriers.
    lines, circles : the numbers of those that are lines, and of the others.
    across : (3, L) of each line the numbers that give the distance of (x, y, 1) from it.
    powers : (4, C) of each circle those that give of (x² + y², x, y, 1) the square of the distance from its
        centre, less that of its radius.
    radii : (C,) of the circles, in mm.
    """

    every: Sequence[CutCarrier]
    lines: NDArray[np.int64]
    circles: NDArray[np.int64]
    across: NDArray[np.float64]
    powers: NDArray[np.float64]
    radii: NDArray[np.float64]

    @classmethod
    def of(cls, carriers: Sequence[CutCarrier]) -> Carriers:
        is_line = np.array([isinstance(one.segment, Line) for one in carriers], dtype=bool)
        across, powers, radii = [], [], []
        for carrier in carriers:
            own = carrier.segment
            if isinstance(own, Line):
                (x, y), (tx, ty) = own.middle, own.tangent
                across.append((ty, -tx, y * tx - x * ty))
            else:
                x, y = own.center
                powers.append((1.0, -2 * x, -2 * y, x * x + y * y - own.radius**2))
                radii.append(own.radius)
        return cls(
            carriers,
            np.flatnonzero(is_line),
            np.flatnonzero(~is_line),
            np.array(across).reshape(-1, 3).T,
            np.array(powers).reshape(-1, 4).T,
            np.array(radii),
        )

    def near(self, points: NDArray[np.float64], reach: float) -> Iterator[tuple[int, CutCarrier]]:
        """Numbers of points (N, 2), each with a carrier that may be no farther than a reach in mm from it."""
        step = max(1, AT_ONCE // max(1, len(self.every)))
        for first in range(0, len(points), step):
            x, y = points[first : first + step].T
            one = np.ones_like(x)
            off_line = np.abs(np.column_stack([x, y, one]) @ self.across) <= reach + ONE
            power = np.abs(np.column_stack([x * x + y * y, x, y, one]) @ self.powers)
            off_circle = power <= (2 * self.radii + reach + ONE) * (reach + ONE)
            for numbers, is_near in ((self.lines, off_line), (self.circles, off_circle)):
                for row, column in zip(*np.nonzero(is_near), strict=True):
                    yield first + int(row), self.every[numbers[column]]

    def distance(self, carrier: CutCarrier, point: Point) -> float:
        """How far a point is from what is covered of a carrier, in mm; endless where its foot is not."""
        position = carrier.position(point)
        return dist(point, carrier.at(position)) if carrier.covers(position) else inf


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
        return self.carrier.at(self.low if self.forward else self.high)

    @property
    def end(self) -> Point:
        return self.carrier.at(self.high if self.forward else self.low)

    @property
    def middle(self) -> Point:
        return self.carrier.at((self.low + self.high) / 2)

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
        if isinstance(self.carrier.segment, Line):
            return 0.0
        quarter = (self.high - self.low) / 4
        return (sin(quarter) / cos(quarter)) * (1.0 if self.forward else -1.0)


def find_border_pieces(
    carriers: Sequence[CutCarrier], inside: Inside, beside: float = BESIDE
) -> list[BorderPiece]:
    """Pieces with a region on one side only.

    Parameters
    ----------
    carriers : see :func:`subdivide`; they hold the region's whole border.
    inside : which of some points (x, y) that lie on no carrier belong to the region.
    beside : how far beside a piece its two sides are looked at, in mm, where nothing else is near.
    """
    known = Carriers.of(carriers)
    every = [BorderPiece(carrier, low, high, True) for carrier in carriers for low, high in carrier.pieces()]
    middles = np.array([piece.middle for piece in every]).reshape(-1, 2)
    crowded = {
        number
        for number, other in known.near(middles, 2 * beside)
        if other is not every[number].carrier
        and known.distance(other, (float(middles[number, 0]), float(middles[number, 1]))) <= 2 * beside
    }
    clear = find_clearest_positions({number: every[number] for number in sorted(crowded)}, known, beside)
    thin = {number: every[number] for number, (_, clearance) in clear.items() if clearance <= THIN}
    places = []
    for number, piece in enumerate(every):
        position, clearance = clear.get(number, ((piece.low + piece.high) / 2, inf))
        places.append((piece.carrier, position, min(choose_side_distance(piece, beside), clearance / 2)))
    found = [
        evolve(piece, forward=left) if left != right else None
        for piece, (left, right) in zip(every, sides(places, inside), strict=True)
    ]
    for group in twins(thin):
        first = thin[group[0]]
        position = (first.low + first.high) / 2
        ((left, right),) = sides([(first.carrier, position, choose_side_distance(first, beside))], inside)
        for number in group:
            found[number] = None
        if left != right:
            outer = evolve(first, forward=left)
            (x, y), (nx, ny) = outer.middle, outer.carrier.left(position)
            away = (-nx, -ny) if left else (nx, ny)
            number = max(
                group,
                key=lambda k: (thin[k].middle[0] - x) * away[0] + (thin[k].middle[1] - y) * away[1],
            )
            chosen = thin[number]
            runs_along = dist(chosen.start, first.start) <= dist(chosen.start, first.end)
            found[number] = evolve(chosen, forward=left == runs_along)
    return [piece for piece in found if piece is not None]


def sides(places: Sequence[tuple[CutCarrier, float, float]], inside: Inside) -> list[tuple[bool, bool]]:
    """Whether points beside positions of carriers, on the left and the right of each, are inside.

    A place is a carrier, a position, and how far beside it in mm.
    """
    points: list[Point] = []
    for carrier, position, beside in places:
        (x, y), (nx, ny) = carrier.at(position), carrier.left(position)
        points += [(x + beside * nx, y + beside * ny), (x - beside * nx, y - beside * ny)]
    found = inside(points)
    return list(zip(found[0::2], found[1::2], strict=True))


def find_clearest_positions(
    pieces: Mapping[int, BorderPiece], carriers: Carriers, beside: float
) -> dict[int, tuple[float, float]]:
    """By a piece's number its first position that is clear enough, else that with the most clearance.

    With it the clearance in mm, as far as it is looked at.
    """
    found: dict[int, tuple[float, float]] = {}
    enough = {number: 2 * choose_side_distance(piece, beside) for number, piece in pieces.items()}
    left = list(pieces)
    for share in SHARES:
        if not left:
            break
        own = [pieces[number] for number in left]
        places = [piece.low + share * (piece.high - piece.low) for piece in own]
        points = [piece.carrier.at(place) for piece, place in zip(own, places, strict=True)]
        clearances = [enough[number] for number in left]
        # No piece asks for more than twice what is looked at beside it.
        for row, other in carriers.near(np.array(points), 2 * beside):
            if other is not own[row].carrier:
                clearances[row] = min(clearances[row], carriers.distance(other, points[row]))
        for number, place, clearance in zip(left, places, clearances, strict=True):
            if number not in found or clearance > found[number][1]:
                found[number] = place, clearance
        left = [number for number in left if found[number][1] < enough[number]]
    return found


def choose_side_distance(piece: BorderPiece, beside: float) -> float:
    """How far beside a piece its two sides are looked at, in mm, where nothing is near."""
    return min(beside, BESIDE_SHARE * piece.length)


def twins(pieces: Mapping[int, BorderPiece]) -> list[list[int]]:
    """The numbers of pieces that are twins, all of the same ends together; none of a piece without one."""
    groups: list[list[int]] = []
    for number, piece in pieces.items():
        for group in groups:
            other = pieces[group[0]]
            ends = (other.start, other.end), (other.end, other.start)
            if piece.carrier is not other.carrier and any(
                dist(piece.start, start) <= SAME_END and dist(piece.end, end) <= SAME_END
                for start, end in ends
            ):
                group.append(number)
                break
        else:
            groups.append([number])
    return [group for group in groups if len(group) > 1]


def join_border_loops(pieces: Sequence[BorderPiece], reach: float = REACH) -> list[list[BorderPiece]]:
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
            away = np.hypot(starts[:, 0] - x, starts[:, 1] - y)
            free = [int(k) for k in np.flatnonzero(away <= reach) if k in left or k == first]
            # A short piece that begins here is not passed over for the next one.
            least = min((away[k] for k in free), default=0.0)
            free = [k for k in free if away[k] <= least + SHORT]
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
