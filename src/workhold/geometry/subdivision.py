"""The planar subdivision of lines and arcs: the pieces into which they cut each other, and loops of such
pieces.

Segments of one carrier are joined first, so that a piece shared by many segments occurs once. To find the
border of a region, points on both sides of every piece are tested; pieces with the region on exactly one side
form the border. The points are so near that no other carrier runs between them and the piece. Twins, as
beside the point where a circle touches a line, have such points only on their outer sides; one of them is
then the border.

Glossary
--------
subdivision : the pieces of some curves between all points in which these meet (de Berg et al., "Computational
    Geometry", chapter 2).
position : coordinate along a carrier: millimetres on a line, radians on a circle.
span : a range of positions that some segment covers.
clearance : distance in mm of a point of a piece from the covered parts of all other carriers.
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
from workhold.geometry.loop import ComparisonBudget, find_near_pairs
from workhold.geometry.segment import Arc, Line, Point, Segment, compute_bounding_box, find_carrier_crossings

__all__ = [
    "BorderPiece",
    "CutCurve",
    "Inside",
    "join_border_loops",
    "find_border_pieces",
    "sort_distinct",
    "subdivide",
]

# mm. Carriers, and points along one, that differ by less count as one.
ONE = 1e-6
# mm. Shorter pieces are rounding errors and are left out.
SHORT = 1e-5
# mm. Largest gap between the ends of neighbouring pieces of a border.
REACH = 1e-4
# mm, and a part of the piece's length: distance of the two test points from a piece. It is large enough to be
# beyond a curve that ends at the piece with a slope of 0.001.
BESIDE, BESIDE_SHARE = 2e-2, 0.1
# Positions of the test points along a piece, as parts of it: the first with nothing near is taken, or the
# clearest.
SHARES = (0.5, 0.25, 0.75, 0.375, 0.625, 0.125, 0.875, 0.03, 0.97)
# mm. Pieces that are nowhere farther apart than THIN are twins, if their ends are within SAME_END.
THIN, SAME_END = 2 * ONE, 10 * ONE
# Points times carriers that are looked at together.
AT_ONCE = 1 << 20
# Returns which of some points (x, y) belong to a region.
Inside = Callable[[Sequence[Point]], Sequence[bool]]


@define
class CutCurve:
    """A whole line or circle (a carrier), the ranges of it that segments cover, and the positions at which it
    is cut.

    Positions are in mm on a line and in radians on a circle.

    Parameters
    ----------
    segment : one segment on the carrier; positions are parameters of this segment.
    spans : the ranges (low, high) that segments cover. On a circle low is in [-pi, pi) and high less than a
        turn above.
    cuts : positions at which the carrier is cut.
    owners : for each span, the number of the segment that covers it.
    """

    segment: Segment
    spans: list[tuple[float, float]] = Factory(list)
    cuts: list[float] = Factory(list)
    owners: list[int] = Factory(list)
    # The number of spans, and the points (N, 2) of their ends, once these were asked for.
    ends: tuple[int, NDArray[np.float64]] | None = field(init=False, default=None, eq=False, repr=False)

    @property
    def slack(self) -> float:
        """The change of position, in mm or radians, that moves a point by ``ONE`` mm."""
        return ONE if isinstance(self.segment, Line) else ONE / self.segment.radius

    def is_carrier_of(self, other: Segment) -> bool:
        """Return whether a segment lies on this same whole line or circle, within ``ONE`` mm."""
        own = self.segment
        if isinstance(own, Line) and isinstance(other, Line):
            (x, y), (tx, ty) = own.middle, own.tangent
            return all(abs((px - x) * ty - (py - y) * tx) <= ONE for px, py in (other.start, other.end))
        if isinstance(own, Arc) and isinstance(other, Arc):
            return dist(own.center, other.center) <= ONE and abs(own.radius - other.radius) <= ONE
        return False

    def find_position(self, point: Point) -> float:
        """Return the position of that point of the whole line or circle that is nearest to ``point``."""
        return self.segment.find_parameter(point)

    def compute_point(self, position: float) -> Point:
        """Return the point at a position, in mm on a line and in radians on a circle."""
        return self.segment.compute_point(position)

    def compute_left_normal(self, position: float) -> Point:
        """Return the unit vector to the left of the direction in which positions grow.

        On a circle positions grow counter-clockwise, so it points to the centre.
        """
        if isinstance(self.segment, Line):
            tx, ty = self.segment.tangent
            return -ty, tx
        angle = self.segment.mid_angle + position
        return -cos(angle), -sin(angle)

    def cover_segment(self, segment: Segment) -> None:
        """Add the range that a segment on this carrier covers to ``spans``, and its ends to ``cuts``, in
        place.

        A full circle has no ends.
        """
        if isinstance(segment, Arc) and segment.is_full:
            self.spans.append((-pi, pi))
            return
        first, last = self.find_position(segment.start), self.find_position(segment.end)
        if isinstance(segment, Arc):
            if segment.sign < 0:
                first, last = last, first
            if last < first:
                last += tau
        self.spans.append((min(first, last), max(first, last)))
        self.cuts += [first, last]

    def list_ends_near(self, segment: Segment) -> list[Point]:
        """Return those ends of spans that lie within 2 ``ONE`` mm of the whole line or circle of
        ``segment``.
        """
        if self.ends is None or self.ends[0] != len(self.spans):
            found = [
                self.compute_point(position) for position in {end for span in self.spans for end in span}
            ]
            self.ends = len(self.spans), np.array(found).reshape(-1, 2)
        points = self.ends[1]
        if isinstance(segment, Line):
            (x, y), (tx, ty) = segment.middle, segment.tangent
            away = np.abs((points[:, 0] - x) * ty - (points[:, 1] - y) * tx)
        else:
            x, y = segment.center
            away = np.abs(np.hypot(points[:, 0] - x, points[:, 1] - y) - segment.radius)
        return [(float(px), float(py)) for px, py in points[away <= 2 * ONE]]

    def is_covered(self, position: float) -> bool:
        """Return whether a position lies in one of the spans, ends included."""
        turns = (0.0,) if isinstance(self.segment, Line) else (-tau, 0.0, tau)
        slack = self.slack
        return any(
            low - slack <= position + turn <= high + slack for low, high in self.spans for turn in turns
        )

    def measure_distance(self, one: float, other: float) -> float:
        """Return the difference of two positions, in mm or radians; on a circle the shorter way round."""
        away = abs(one - other)
        return away if isinstance(self.segment, Line) else abs((away + pi) % tau - pi)

    def list_covered_pieces(self) -> list[tuple[float, float]]:
        """Return the pieces between neighbouring cuts that a span covers, as positions (low, high).

        Pieces shorter than ``SHORT`` mm are left out. A whole circle is given as at least two pieces.
        """
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
                # A piece that is a whole circle, or almost, would end where it begins, so it is cut in two.
                if tau - (after - before) <= REACH / self.segment.radius:
                    distinct.append(before + pi)
            distinct.sort()
        least = SHORT / ONE * slack
        return [
            (low, high)
            for low, high in pairwise(distinct)
            if high - low > least and self.is_covered((low + high) / 2)
        ]


def sort_distinct(values: NDArray[np.float64], slack: float) -> list[float]:
    """Return values in ascending order, without each value that is at most ``slack`` above the last one
    kept.
    """
    distinct: list[float] = []
    for value in np.sort(values):
        if not distinct or value - distinct[-1] > slack:
            distinct.append(float(value))
    return distinct


def subdivide(
    segments: Iterable[Segment],
    cuts: Iterable[tuple[Segment, Point]] = (),
    comparisons: ComparisonBudget | None = None,
) -> list[CutCurve]:
    """Return the carriers (whole lines and circles) of segments, each once, cut wherever covered parts of two
    meet.

    Parameters
    ----------
    segments : in any order and direction; they may overlap.
    cuts : further points at which the carrier of a segment is cut.
    comparisons : largest number of pairs to compare; None for no limit.

    Raises
    ------
    InputError
        For more pairs than that.
    """
    carriers: list[CutCurve] = []
    found: dict[tuple[int, ...], list[CutCurve]] = {}
    for number, segment in enumerate(segments):
        carrier = find_or_make_carrier(segment, carriers, found, comparisons)
        carrier.cover_segment(segment)
        carrier.owners.append(number)
    further = []
    for segment, point in cuts:
        carrier = find_or_make_carrier(segment, carriers, found)
        carrier.cuts.append(carrier.find_position(point))
        further.append((carrier, point))
    carriers = [carrier for carrier in carriers if carrier.spans]
    if comparisons is not None:
        # Every piece is tested against all spans.
        comparisons.spend(sum(len(one.spans) * (len(one.cuts) // 32 + 1) for one in carriers))
    boxes = np.array([bound_covered(carrier) for carrier in carriers]).reshape(-1, 4)
    for a, b in find_near_pairs(boxes, boxes):
        if comparisons is not None:
            # Cutting two carriers takes as long as about ten comparisons.
            comparisons.spend(10)
        if a < b:
            add_mutual_cuts(carriers[a], carriers[b])
    cut_twins(CutCurveIndex.from_cut_carriers(carriers), further)
    return carriers


def cut_twins(carriers: CutCurveIndex, cuts: Sequence[tuple[CutCurve, Point]]) -> None:
    """Cut, in place, each carrier that runs within ``THIN`` mm of one of ``cuts``, which are points on other
    carriers.

    So pieces of two carriers that nearly coincide have the same ends.
    """
    for number, other in carriers.iterate_pairs_near(
        np.array([point for _, point in cuts]).reshape(-1, 2), THIN
    ):
        own, point = cuts[number]
        if other is own or carriers.measure_distance(other, point) > THIN:
            continue
        position = other.find_position(point)
        if all(other.measure_distance(position, cut) > other.slack for cut in other.cuts):
            other.cuts.append(position)


def find_or_make_carrier(
    segment: Segment,
    carriers: list[CutCurve],
    found: dict[tuple[int, ...], list[CutCurve]],
    comparisons: ComparisonBudget | None = None,
) -> CutCurve:
    """Return the carrier of a segment from ``found``; where it is missing, make it and add it to ``carriers``
    and ``found``.

    The keys of ``found`` are those of :func:`list_rough_keys`.
    """
    keys = list_rough_keys(segment)
    for key in keys:
        if comparisons is not None:
            comparisons.spend(len(found.get(key, ())))
        for carrier in found.get(key, ()):
            if carrier.is_carrier_of(segment):
                return carrier
    carrier = CutCurve(segment)
    carriers.append(carrier)
    found.setdefault(keys[0], []).append(carrier)
    return carrier


def list_rough_keys(segment: Segment) -> list[tuple[int, ...]]:
    """Return the keys under which the carrier of a segment may be stored: that of its own cell, then of
    neighbouring cells.

    Cells are ranges of direction for lines, and of centre and radius for circles.
    """
    around = (0, -1, 1)
    if isinstance(segment, Arc):
        x, y, r = (round(value / 1e-3) for value in (*segment.center, segment.radius))
        return [(x + a, y + b, r + c) for a, b, c in product(around, repeat=3)]
    tx, ty = segment.tangent
    # The direction of a short segment is uncertain, so cells of lines are wide in direction and ignore the
    # distance.
    cell, last = round(atan2(ty, tx) % pi / 1e-2), round(pi / 1e-2)
    return [((cell + a) % last, 0) for a in around]


def bound_covered(carrier: CutCurve) -> tuple[float, float, float, float]:
    """Return a box around the spans of a carrier: smallest x, smallest y, largest x, largest y, in mm.

    It is ``ONE`` mm larger on each side. For a circle it is the box of the whole circle.
    """
    own = carrier.segment
    if isinstance(own, Arc):
        (x, y), r = own.center, own.radius + ONE
        return x - r, y - r, x + r, y + r
    low, high = min(a for a, _ in carrier.spans), max(b for _, b in carrier.spans)
    x0, y0, x1, y1 = compute_bounding_box(own.cut_part(low, high))
    return x0 - ONE, y0 - ONE, x1 + ONE, y1 + ONE


def add_mutual_cuts(a: CutCurve, b: CutCurve) -> None:
    """Add cuts to two carriers, in place, where covered parts of both meet, and where a span of one ends on
    the other.

    Two crossings at most ``REACH`` mm apart are replaced by one in the middle between them.
    """
    points = list(find_carrier_crossings(a.segment, b.segment))
    if len(points) == 2 and SHORT < dist(*points) <= REACH:
        (x0, y0), (x1, y1) = points
        points = [((x0 + x1) / 2, (y0 + y1) / 2)]
    for one, other in ((a, b), (b, a)):
        for point in one.list_ends_near(other.segment):
            if dist(point, other.compute_point(other.find_position(point))) <= ONE:
                points.append(point)
    for point in points:
        first, second = a.find_position(point), b.find_position(point)
        if a.is_covered(first) and b.is_covered(second):
            a.cuts.append(first)
            b.cuts.append(second)


@frozen(eq=False)
class CutCurveIndex:
    """An index of carriers (whole lines and circles) with which those near given points are found.

    Parameters
    ----------
    every : the carriers.
    lines, circles : indices of the L lines and of the C circles among them.
    across : (3, L) coefficients of x, y and 1 in the distance from each line.
    powers : (4, C) coefficients of x² + y², x, y and 1 in the squared distance from each circle's centre
        minus its squared radius.
    radii : (C,) of the circles, in mm.
    """

    every: Sequence[CutCurve]
    lines: NDArray[np.int64]
    circles: NDArray[np.int64]
    across: NDArray[np.float64]
    powers: NDArray[np.float64]
    radii: NDArray[np.float64]

    @classmethod
    def from_cut_carriers(cls, carriers: Sequence[CutCurve]) -> CutCurveIndex:
        """Return the index of carriers."""
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

    def iterate_pairs_near(self, points: NDArray[np.float64], reach: float) -> Iterator[tuple[int, CutCurve]]:
        """Yield pairs (index of a point, carrier) where a point is within ``reach`` mm of a carrier's whole
        line or circle.

        ``points`` is an array (N, 2).
        """
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

    def measure_distance(self, carrier: CutCurve, point: Point) -> float:
        """Return the distance in mm from a point to its nearest point on a carrier; inf if no span covers
        that point.
        """
        position = carrier.find_position(point)
        return dist(point, carrier.compute_point(position)) if carrier.is_covered(position) else inf


@frozen
class BorderPiece:
    """A piece of the border of a region, in the direction that has the region on its left.

    Parameters
    ----------
    carrier : the line or circle that it lies on.
    low, high : positions on the carrier, in mm or radians.
    forward : whether positions grow in running order.
    """

    carrier: CutCurve
    low: float
    high: float
    forward: bool

    @property
    def start(self) -> Point:
        """First point in running order."""
        return self.carrier.compute_point(self.low if self.forward else self.high)

    @property
    def end(self) -> Point:
        """Last point in running order."""
        return self.carrier.compute_point(self.high if self.forward else self.low)

    @property
    def middle(self) -> Point:
        return self.carrier.compute_point((self.low + self.high) / 2)

    @property
    def length(self) -> float:
        """Length in mm."""
        own = self.carrier.segment
        return (self.high - self.low) * (1.0 if isinstance(own, Line) else own.radius)

    def compute_heading(self, *, at_end: bool) -> float:
        """Return the direction in radians in which the piece runs, at its last point if ``at_end``, else at
        its first point.
        """
        nx, ny = self.carrier.compute_left_normal(self.high if at_end == self.forward else self.low)
        return atan2(-nx, ny) if self.forward else atan2(nx, -ny)

    @property
    def bulge(self) -> float:
        """Bulge in running order, tan(sweep / 4); 0 for a line."""
        if isinstance(self.carrier.segment, Line):
            return 0.0
        quarter = (self.high - self.low) / 4
        return (sin(quarter) / cos(quarter)) * (1.0 if self.forward else -1.0)


def find_border_pieces(
    carriers: Sequence[CutCurve], inside: Inside, beside: float = BESIDE
) -> list[BorderPiece]:
    """Return the pieces of carriers that have a region on one side only, in the direction with the region on
    the left.

    Parameters
    ----------
    carriers : see :func:`subdivide`; they contain the region's whole border.
    inside : takes points (x, y) and returns for each whether it belongs to the region; no point lies on a
        carrier.
    beside : distance in mm from a piece at which a point on either side is tested, where no other carrier is
        near.
    """
    known = CutCurveIndex.from_cut_carriers(carriers)
    every = [
        BorderPiece(carrier, low, high, True)
        for carrier in carriers
        for low, high in carrier.list_covered_pieces()
    ]
    middles = np.array([piece.middle for piece in every]).reshape(-1, 2)
    crowded = {
        number
        for number, other in known.iterate_pairs_near(middles, 2 * beside)
        if other is not every[number].carrier
        and known.measure_distance(other, (float(middles[number, 0]), float(middles[number, 1])))
        <= 2 * beside
    }
    clear = find_clearest_positions({number: every[number] for number in sorted(crowded)}, known, beside)
    thin = {number: every[number] for number, (_, clearance) in clear.items() if clearance <= THIN}
    places = []
    for number, piece in enumerate(every):
        position, clearance = clear.get(number, ((piece.low + piece.high) / 2, inf))
        places.append((piece.carrier, position, min(choose_side_distance(piece, beside), clearance / 2)))
    found = [
        evolve(piece, forward=left) if left != right else None
        for piece, (left, right) in zip(every, find_inside_sides(places, inside), strict=True)
    ]
    for group in group_twins(thin):
        first = thin[group[0]]
        position = (first.low + first.high) / 2
        ((left, right),) = find_inside_sides(
            [(first.carrier, position, choose_side_distance(first, beside))], inside
        )
        for number in group:
            found[number] = None
        if left != right:
            outer = evolve(first, forward=left)
            (x, y), (nx, ny) = outer.middle, outer.carrier.compute_left_normal(position)
            away = (-nx, -ny) if left else (nx, ny)
            number = max(
                group,
                key=lambda k: (thin[k].middle[0] - x) * away[0] + (thin[k].middle[1] - y) * away[1],
            )
            chosen = thin[number]
            runs_along = dist(chosen.start, first.start) <= dist(chosen.start, first.end)
            found[number] = evolve(chosen, forward=left == runs_along)
    return [piece for piece in found if piece is not None]


def find_inside_sides(
    places: Sequence[tuple[CutCurve, float, float]], inside: Inside
) -> list[tuple[bool, bool]]:
    """Return for each place whether a point to the left of a carrier, and one to the right, belong to a
    region.

    A place is (carrier, position, distance of both points from the carrier in mm). Left is seen in the
    direction of growing positions.
    """
    points: list[Point] = []
    for carrier, position, beside in places:
        (x, y), (nx, ny) = carrier.compute_point(position), carrier.compute_left_normal(position)
        points += [(x + beside * nx, y + beside * ny), (x - beside * nx, y - beside * ny)]
    found = inside(points)
    return list(zip(found[0::2], found[1::2], strict=True))


def find_clearest_positions(
    pieces: Mapping[int, BorderPiece], carriers: CutCurveIndex, beside: float
) -> dict[int, tuple[float, float]]:
    """Return for each piece, by its number, (1) a position clear of other carriers and (2) the clearance in
    mm there.

    It is the first of some positions with enough clearance, or else the one with the most. Carriers farther
    than twice ``beside`` mm are not considered.
    """
    found: dict[int, tuple[float, float]] = {}
    enough = {number: 2 * choose_side_distance(piece, beside) for number, piece in pieces.items()}
    left = list(pieces)
    for share in SHARES:
        if not left:
            break
        own = [pieces[number] for number in left]
        places = [piece.low + share * (piece.high - piece.low) for piece in own]
        points = [piece.carrier.compute_point(place) for piece, place in zip(own, places, strict=True)]
        clearances = [enough[number] for number in left]
        # No piece asks for more than twice what is looked at beside it.
        for row, other in carriers.iterate_pairs_near(np.array(points), 2 * beside):
            if other is not own[row].carrier:
                clearances[row] = min(clearances[row], carriers.measure_distance(other, points[row]))
        for number, place, clearance in zip(left, places, clearances, strict=True):
            if number not in found or clearance > found[number][1]:
                found[number] = place, clearance
        left = [number for number in left if found[number][1] < enough[number]]
    return found


def choose_side_distance(piece: BorderPiece, beside: float) -> float:
    """Return the distance in mm from a piece at which to test the points to its left and right when no other
    carrier is near.

    It is ``beside``, or less for a short piece.
    """
    return min(beside, BESIDE_SHARE * piece.length)


def group_twins(pieces: Mapping[int, BorderPiece]) -> list[list[int]]:
    """Return groups of pieces that have the same two ends but different carriers, as lists of their numbers.

    A piece without such a twin is left out.
    """
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
    """Return the pieces of a border joined to closed loops, each with the region on its left.

    If several pieces start at one point, the loop follows the piece that turns farthest to the left. So two
    corners of a region that touch stay in separate loops. No loop starts with a piece shorter than ``reach``,
    so such pieces may be left out.

    Parameters
    ----------
    reach : largest gap in mm between the ends of neighbouring pieces.

    Raises
    ------
    InputError
        If a loop does not close because some of the border is missing.
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
            # A short piece that begins here is taken before the next one.
            least = min((away[k] for k in free), default=0.0)
            free = [k for k in free if away[k] <= least + SHORT]
            if not free:
                raise InputError(f"the outline does not close at ({x:.6g}, {y:.6g})")
            heading = pieces[loop[-1]].compute_heading(at_end=True)
            following = max(
                free, key=lambda k: measure_left_turn(heading, pieces[k].compute_heading(at_end=False))
            )
            if following == first:
                break
            left.discard(following)
            loop.append(following)
        loops.append([pieces[k] for k in loop])
    return loops


def measure_left_turn(before: float, after: float) -> float:
    """Return the angle in radians, in (-pi, pi], from the direction ``before`` to the direction ``after``,
    positive to the left.
    """
    return -((before - after + pi) % tau - pi)
