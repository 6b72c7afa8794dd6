"""Bands: the heights at which a peg may press on each piece of an outline, from the solid's upright faces.

Upright faces cover ranges of height above each point of the outline's border. The border is cut into pieces
at all places where such a range can begin, end, split, merge or jump, and where one of its ends passes the
lowest or highest height that pegs reach. So the number of ranges is the same all along a piece, and each of
their ends follows one edge of a wall.

Glossary
--------
carrier : the infinite line or the whole circle that a segment lies on. A position on it is in mm along a line
    and in radians around a circle.
wall : an upright face of the solid.
run : a maximal range of heights that walls cover above a place.
branch : a part of a wall's edge along which the position on the carrier is monotonic.
steep : said of a point where an edge is upright up to rounding, so that the end of a run jumps.
"""

from __future__ import annotations

from bisect import bisect_left
from collections import defaultdict
from collections.abc import Iterator, Sequence
from functools import cached_property
from itertools import pairwise
from math import acos, atan2, cos, hypot, pi, sin, tau
from typing import Any

import numpy as np
from attrs import define, evolve, field, frozen
from numpy.typing import NDArray

from workhold.files.step.edge_curves import (
    ONE_HEIGHT,
    WHOLE_TURN,
    EdgeCurve,
    Point3,
    compute_curve_point,
    compute_points_along,
    find_zero_crossing,
)
from workhold.files.step.faces import SolidFace
from workhold.files.step.library import occ
from workhold.geometry.segment import Arc, Line, Point, Segment
from workhold.geometry.subdivision import BorderPiece, CutCurve
from workhold.model.solid import Band

__all__ = ["CoveredPiece", "RunEnd", "KnownWalls", "WallRun", "WallEdge", "WallsByCarrier", "measure_band"]

# Edges this far from a carrier in mm, and farther, are not asked whether they lie on it.
NEAR = 1e-4
# Gaps between walls, and runs, that are shorter in mm are none.
LEAST_GAP = 1e-6
# An edge whose tangent rises this much more than it goes along is steep: a share of the tangent.
STEEP = 1e-3
# An edge that comes as near to upright, as a share, is looked at where it does so most.
NEARLY_STEEP = 0.2
# Points for each piece of a spline at which it is looked at, and points at most.
PER_PIECE, MOST_POINTS = 8, 400
# Shares of a piece at which it may be looked at.
SHARES = (0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8)
# What rounding may take of a parameter in radians, near an end at which an edge is steep.
ROUNDING = 1e-6
# A turn of an edge's direction is found to this share of the range in which it lies, by halving.
HALVINGS = 48


def measure_band(band: Band) -> float:
    """Return the length z1 - z0 in mm of a band (z0, z1); negative for
    the empty intersection of two bands.
    """
    return band[1] - band[0]


@frozen(eq=False, slots=False)
class WallEdge:
    """An edge of a wall that is not upright, with points at all places where it turns.

    Parameters
    ----------
    edge : it projects to a line or an arc; between two of its points its position along the segment and its
        height are both monotonic.
    segment : the line or arc that the edge projects to.
    branches : indices (first, last) of the points at the ends of each branch.
    steep : indices of the points at which the edge is steep.
    """

    edge: EdgeCurve
    segment: Segment
    branches: tuple[tuple[int, int], ...]
    steep: frozenset[int]

    @property
    def is_level(self) -> bool:
        """Whether all points of the edge have the same height."""
        return self.edge.high - self.edge.low <= ONE_HEIGHT

    @classmethod
    def from_edge(cls, edge: EdgeCurve, segment: Segment) -> WallEdge:
        """Make the wall edge of an edge that projects to
        ``segment``, with points added at all places where it turns.

        It turns where its position along the segment or its height changes from growing to falling or back.
        """
        last = len(edge.points) - 1
        if last == 1:
            rise = abs(float(edge.points[1, 2] - edge.points[0, 2]))
            is_steep = segment.length <= STEEP * hypot(rise, segment.length)
            return cls(edge, segment, ((0, 1),), frozenset((0, 1) if is_steep else ()))
        if edge.high - edge.low <= ONE_HEIGHT:
            return cls(
                edge,
                segment,
                tuple(split_into_branches(compute_positions_along(segment, edge.points), ())),
                frozenset(),
            )
        edge, upright = split_at_turns(edge, segment)
        steep = frozenset(k for k, one in enumerate(edge.parameters.tolist()) if one in upright)
        return cls(
            edge,
            segment,
            tuple(split_into_branches(compute_positions_along(segment, edge.points), steep)),
            steep,
        )

    def find_cut_points(self, low: float, high: float) -> Iterator[Point]:
        """Yield the points (x, y) in mm at which an outline
        between two z in mm must be cut because of this edge.

        These are the ends of its branches (stretches over which its position along the segment is monotonic),
        and the places where it crosses ``high`` or has a point within rounding of ``low`` or ``high``.
        Crossings of ``low`` are left out: the outline is cut there in any case. A level edge yields nothing.
        """
        points = self.edge.points
        if self.is_level:
            return
        yield from ((float(points[k, 0]), float(points[k, 1])) for one in self.branches for k in one)
        yield from self.edge.find_crossings_with_height(high)
        away = np.abs(points[:, 2:] - (low, high)).min(axis=1)
        yield from ((float(x), float(y)) for x, y in points[away <= LEAST_GAP, :2])


def compute_positions_along(segment: Segment, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the positions (N,) of points (N, 3) along a
    segment's line (mm) or circle (radians, without jumps).
    """
    found = np.array([segment.find_parameter((x, y)) for x, y in points[:, :2].tolist()])
    return found if isinstance(segment, Line) else np.unwrap(found)


def split_into_branches(
    places: NDArray[np.float64], cuts: frozenset[int] | tuple[()]
) -> Iterator[tuple[int, int]]:
    """Yield (first, last), indices of points, for each stretch of an edge
    along which its position is monotonic.

    Parameters
    ----------
    places : (N,) positions of the points along the edge's projection.
    cuts : indices of points at which a stretch ends in any case.
    """
    steps = np.diff(places)
    first, way = 0, 0.0
    for k, step in enumerate(steps.tolist()):
        turns = abs(step) > ONE_HEIGHT and way * step < 0
        if (turns or k in cuts) and k > first:
            yield first, k
            first, way = k, 0.0
        if abs(step) > ONE_HEIGHT:
            way = step
    yield first, len(steps)


def compute_slopes(edge: EdgeCurve, segment: Segment, parameter: float) -> tuple[float, float]:
    """Return the components along the segment and upward of the edge's unit tangent at a parameter.

    The tangent points in the direction of growing parameters.
    """
    point, step = occ.gp_Pnt(), occ.gp_Vec()
    edge.curve.D1(parameter, point, step)
    if step.Magnitude() <= ONE_HEIGHT:
        # A curve that halts has no direction of its own there: that of a point beside it is its limit.
        first, last = float(edge.parameters[0]), float(edge.parameters[-1])
        aside = 1e-4 * (last - first)
        edge.curve.D1(parameter + (aside if parameter + aside <= last else -aside), point, step)
    size = max(step.Magnitude(), ONE_HEIGHT)
    if isinstance(segment, Arc):
        x, y = point.X() - segment.center[0], point.Y() - segment.center[1]
        tx, ty = -y / segment.radius, x / segment.radius
    else:
        tx, ty = segment.tangent
    return float(step.X() * tx + step.Y() * ty) / size, float(step.Z()) / size


def split_at_turns(edge: EdgeCurve, segment: Segment) -> tuple[EdgeCurve, frozenset[float]]:
    """Return an edge with points added wherever it turns, and
    the parameters at which it stands upright or turns back.

    It turns where the tangent's component along the segment or upward changes its sign. The tangent is
    evaluated because points are not enough: a closed edge that begins near its lowest point turns between its
    last two.
    """
    parameters = edge.parameters
    if edge.curve.GetType() == occ.GeomAbs_BSplineCurve:
        count = min(PER_PIECE * edge.curve.NbKnots(), MOST_POINTS)
        parameters = np.union1d(parameters, np.linspace(parameters[0], parameters[-1], count))

    def compute_slope(kind: int, parameter: float) -> float:
        """Return the tangent's component along the segment (kind 0) or upward (kind 1) at a parameter."""
        return compute_slopes(edge, segment, parameter)[kind]

    values = np.array([compute_slopes(edge, segment, t) for t in parameters.tolist()])
    turns: list[set[float]] = [set(), set()]
    for kind in (0, 1):
        for k in np.flatnonzero(values[:-1, kind] * values[1:, kind] < 0).tolist():
            low, high = float(parameters[k]), float(parameters[k + 1])
            for _ in range(HALVINGS):
                middle = (low + high) / 2
                if compute_slope(kind, middle) * values[k, kind] > 0:
                    low = middle
                else:
                    high = middle
            turns[kind].add((low + high) / 2)
    upright = turns[0] | {
        t for t, one in zip(parameters.tolist(), values[:, 0], strict=True) if abs(one) <= STEEP
    }
    size = np.abs(values[:, 0])
    for k in range(1, len(size) - 1):
        if size[k] <= NEARLY_STEEP and size[k] <= min(size[k - 1], size[k + 1]):
            low, high = float(parameters[k - 1]), float(parameters[k + 1])
            for _ in range(HALVINGS):
                a, b = low + (high - low) / 3, high - (high - low) / 3
                if abs(compute_slope(0, a)) < abs(compute_slope(0, b)):
                    high = b
                else:
                    low = a
            if abs(compute_slope(0, (low + high) / 2)) <= STEEP:
                upright.add((low + high) / 2)
    known = np.union1d(parameters, np.array(sorted(turns[0] | turns[1] | upright)))
    found = evolve(edge, parameters=known, points=compute_points_along(edge.curve, known))
    return found, frozenset(upright)


@frozen
class Conic:
    """A circle or an ellipse in space, whose points are center + along cos t + across sin t.

    Its height over a place on a carrier has a closed form; on a curve of the library it takes some twenty
    evaluations.

    Parameters
    ----------
    center, along, across : x, y and z in mm.
    """

    center: Point3
    along: Point3
    across: Point3

    @classmethod
    def from_curve(cls, curve: Any) -> Conic | None:
        """Return the conic of a curve of Open CASCADE; None for curves of other kinds."""
        kind = curve.GetType()
        if kind not in (occ.GeomAbs_Circle, occ.GeomAbs_Ellipse):
            return None
        is_round = kind == occ.GeomAbs_Circle
        own = curve.Circle() if is_round else curve.Ellipse()
        sizes = (own.Radius(),) * 2 if is_round else (own.MajorRadius(), own.MinorRadius())
        place, directions = own.Location(), (own.XAxis().Direction(), own.YAxis().Direction())
        along, across = (
            (size * one.X(), size * one.Y(), size * one.Z())
            for size, one in zip(sizes, directions, strict=True)
        )
        return cls((place.X(), place.Y(), place.Z()), along, across)

    def compute_height_at(self, carrier: Segment, place: float, first: float, last: float) -> float | None:
        """Return the z in mm at which the conic passes a position
        on a line or circle, between two of its parameters t.

        Parameters
        ----------
        carrier : a segment of the line or circle, from whose middle positions are measured.
        place : the position, in mm along a line; on a circle in radians from its segment's middle angle.
        first, last : parameters t in radians between which the conic counts, less than half a turn apart, in
            any order.

        Returns
        -------
        None where the conic does not pass the position between them.
        """
        if isinstance(carrier, Line):
            (px, py), (nx, ny), off = carrier.middle, carrier.tangent, place
        else:
            (px, py), angle, off = carrier.center, carrier.mid_angle + place, 0.0
            nx, ny = -sin(angle), cos(angle)
        # (center + along cos t + across sin t - p) . n = off
        a = self.along[0] * nx + self.along[1] * ny
        b = self.across[0] * nx + self.across[1] * ny
        wanted = off - (self.center[0] - px) * nx - (self.center[1] - py) * ny
        size = hypot(a, b)
        if abs(wanted) > size * (1.0 + ROUNDING):
            return None
        middle, half = (first + last) / 2, abs(last - first) / 2
        turn = acos(min(max(wanted / size, -1.0), 1.0))
        found = (atan2(b, a) + side * turn - middle for side in (1.0, -1.0))
        away = min(((one + pi) % tau - pi for one in found), key=abs)
        if abs(away) > half + ROUNDING:
            return None
        t = middle + min(max(away, -half), half)
        return self.center[2] + self.along[2] * cos(t) + self.across[2] * sin(t)


@frozen(eq=False, slots=False)
class EdgeBranch:
    """A branch of a wall's edge over the wall's carrier.

    Parameters
    ----------
    edge : see :class:`WallEdge`.
    carrier : a segment of the wall's line or circle, from which positions are measured.
    parameters : (N,) of the edge's curve, rising or falling.
    places : (N,) positions on the carrier there, rising; on a circle, angles without jumps.
    heights : (N,) z in mm there; between two neighbours the height is monotonic.
    steep : two flags: whether the edge is steep at its first and at its last position.
    known : cache of heights in mm by position.
    """

    edge: EdgeCurve
    carrier: Segment
    parameters: NDArray[np.float64]
    places: NDArray[np.float64]
    heights: NDArray[np.float64]
    steep: tuple[bool, bool]
    known: dict[float, float] = field(init=False, factory=dict)

    @classmethod
    def make_branches(cls, carrier: Segment, wall_edge: WallEdge) -> Iterator[EdgeBranch]:
        """Yield the pieces of a wall's edge; along each piece its position along the wall only grows or only
        falls.

        ``carrier`` is a segment of the wall's line or circle, from which positions are measured.
        """
        edge = wall_edge.edge
        places = compute_positions_along(carrier, edge.points)
        for first, last in wall_edge.branches:
            part = slice(first, last + 1)
            values = edge.parameters[part], places[part], edge.points[part, 2]
            steep = first in wall_edge.steep, last in wall_edge.steep
            if places[last] < places[first]:
                values, steep = (values[0][::-1], values[1][::-1], values[2][::-1]), steep[::-1]
            # Rounding may leave points beside a turn in the other order.
            yield cls(edge, carrier, values[0], np.maximum.accumulate(values[1]), values[2], steep)

    @cached_property
    def level(self) -> float | None:
        """z in mm of a level edge piece; None when it rises or falls."""
        least, greatest = float(self.heights.min()), float(self.heights.max())
        return float(self.heights[0]) if greatest - least <= ONE_HEIGHT else None

    def list_turns_to_add(self, position: float) -> list[float]:
        """Return the offsets that bring a position on the line
        or circle into the range of positions of this edge piece.

        On a circle the offsets are whole turns in radians, and there may be several; on a line the only one
        is 0. The list is empty where the piece does not lie over the position.
        """
        first, last = float(self.places[0]), float(self.places[-1])
        if isinstance(self.carrier, Arc) and abs(last - first - tau) <= WHOLE_TURN:
            return [first + (position - first) % tau - position]
        around = (0.0,) if isinstance(self.carrier, Line) else (-2 * tau, -tau, 0.0, tau, 2 * tau)
        return [turn for turn in around if first < position + turn < last]

    def compute_height_at(self, place: float) -> float:
        """Return the z in mm of the edge piece at a position; beyond the
        piece's ends, the z of the nearer end.
        """
        if self.level is not None:
            return self.level
        places, heights = self.listed_points
        if place <= places[0]:
            return heights[0]
        if place >= places[-1]:
            return heights[-1]
        k = bisect_left(places, place) - 1
        first, last = heights[k], heights[k + 1]
        share = (place - places[k]) / (places[k + 1] - places[k])
        if len(self.edge.points) == 2 or abs(last - first) <= ONE_HEIGHT or share in (0.0, 1.0):
            return first + share * (last - first)
        if place not in self.known:
            self.known[place] = self.refine_height(k, place)
        return self.known[place]

    @cached_property
    def listed_points(self) -> tuple[list[float], list[float]]:
        """Positions and heights of the branch as lists of floats, because elements of
        lists are read much faster than those of arrays.
        """
        return self.places.tolist(), self.heights.tolist()

    def refine_height(self, k: int, place: float) -> float:
        """Return the z in mm of a curved edge at the position ``place``,
        which is between its points k and k + 1.
        """
        if self.conic is not None:
            z = self.conic.compute_height_at(self.carrier, place, *self.parameters[k : k + 2].tolist())
            if z is not None:
                return self.clamp_height(k, z)
        # One point of the library for all: making one takes longer than finding it.
        point, carrier, near = occ.gp_Pnt(), self.carrier, float(self.places[k])
        find, x_of, y_of = self.edge.curve.D0, point.X, point.Y
        if isinstance(carrier, Line):
            (px, py), (tx, ty) = carrier.middle, carrier.tangent

            def measure_offset(parameter: float) -> float:
                """Return the position of a point of the curve along the line,
                minus the wanted position, in mm.
                """
                find(parameter, point)
                return float((x_of() - px) * tx + (y_of() - py) * ty - place)

        else:

            def measure_offset(parameter: float) -> float:
                """Return the position of a point of the curve around the circle,
                minus the wanted position, in radians.
                """
                find(parameter, point)
                found = carrier.find_parameter((x_of(), y_of()))
                return near + (found - near + pi) % tau - pi - place

        ends = [(float(self.parameters[j]), float(self.places[j]) - place) for j in (k, k + 1)]
        return self.clamp_height(
            k, compute_curve_point(self.edge.curve, find_zero_crossing(measure_offset, ends[0], ends[1]))[2]
        )

    def clamp_height(self, k: int, z: float) -> float:
        """Return ``z`` in mm, limited to the range between the heights of the edge's points k and k + 1."""
        return min(max(z, float(self.heights[k : k + 2].min())), float(self.heights[k : k + 2].max()))

    @cached_property
    def conic(self) -> Conic | None:
        """The circle or ellipse that the edge is a piece of; None for other curves."""
        return Conic.from_curve(self.edge.curve)

    def compute_height_range(self, low: float, high: float) -> Band:
        """Return the least and the greatest z in mm of the edge piece from position ``low`` to position
        ``high``.
        """
        if self.level is not None:
            return self.level, self.level
        inner = self.heights[(self.places > low) & (self.places < high)].tolist()
        found = (self.compute_height_at(low), self.compute_height_at(high), *inner)
        return min(found), max(found)


@frozen(eq=False)
class RunEnd:
    """The lower or upper end of a run over a piece: the height of a branch, limited to the heights of pegs.

    Parameters
    ----------
    branch : branch of a wall's edge whose height this end has.
    turn : offset to add to a position of the piece to get its position on the branch.
    low, high : z in mm between which a peg may press.
    """

    branch: EdgeBranch
    turn: float
    low: float
    high: float

    def compute_height_at(self, position: float) -> float:
        """Return the z in mm of this end of a range of touchable heights at a position of the piece.

        It is limited to the range of heights where pegs press.
        """
        return min(max(self.branch.compute_height_at(position + self.turn), self.low), self.high)

    def compute_height_range(self, low: float, high: float) -> Band:
        """Return the least and greatest z in mm of this end of a range of heights, from position ``low`` to
        ``high`` of the piece.

        Both are limited to the range of heights where pegs press.
        """
        least, greatest = self.branch.compute_height_range(low + self.turn, high + self.turn)
        return min(max(least, self.low), self.high), min(max(greatest, self.low), self.high)

    def list_inner_positions(self, low: float, high: float) -> list[float]:
        """Return the positions strictly between ``low`` and ``high`` at which the edge's height may change
        from rising to falling or back.

        Between neighbours in the list the height is monotonic. The list is empty for a level edge.
        """
        if self.branch.level is not None:
            return []
        places = self.branch.places - self.turn
        return [float(place) for place in places[(places > low) & (places < high)]]

    def is_steep_at(self, position: float, beside: float, slack: float) -> bool:
        """Return whether this end of a range of heights jumps
        at a position, because its edge ends upright there.

        Parameters
        ----------
        beside : position at which the height is checked; where it is not strictly within the heights of pegs,
            the limit hides the jump, and the answer is False.
        slack : largest distance of the edge piece's end from the position.
        """
        places = self.branch.places[[0, -1]] - self.turn
        steep = any(
            is_steep and abs(float(place) - position) <= slack
            for place, is_steep in zip(places, self.branch.steep, strict=True)
        )
        return steep and self.low < self.branch.compute_height_at(beside + self.turn) < self.high


@frozen(eq=False)
class WallRun:
    """A run over a piece of the border.

    Parameters
    ----------
    lower, upper : its ends.
    """

    lower: RunEnd
    upper: RunEnd

    def compute_heights_at(self, position: float) -> Band:
        """Return the lower and the upper z in mm of the
        covered range of heights at a position of the piece.
        """
        return self.lower.compute_height_at(position), self.upper.compute_height_at(position)

    def compute_common_band(self, low: float, high: float) -> Band:
        """Return the heights (z0, z1) in mm that this range covers at every position from ``low`` to
        ``high``; z1 < z0 if there is no such height.
        """
        return self.lower.compute_height_range(low, high)[1], self.upper.compute_height_range(low, high)[0]

    def bound_length(self, low: float, high: float) -> float:
        """Return an upper bound in mm of the length (upper minus lower z) of this range at any position from
        ``low`` to ``high``.
        """
        return self.upper.compute_height_range(low, high)[1] - self.lower.compute_height_range(low, high)[0]


@frozen(eq=False)
class CoveredPiece:
    """A piece of the border, or a part of one, with the runs above it.

    Parameters
    ----------
    piece : piece of the border.
    low, high : positions on its carrier.
    runs : from the lowest up.
    faces : indices of the walls over it, sorted.
    """

    piece: BorderPiece
    low: float
    high: float
    runs: tuple[WallRun, ...]
    faces: tuple[int, ...]

    @property
    def size(self) -> float:
        """Its length, in mm on a line and in radians on a circle."""
        return self.high - self.low

    @property
    def ends(self) -> tuple[float, float]:
        """Its positions at the start and the end in the direction of the border."""
        return (self.low, self.high) if self.piece.forward else (self.high, self.low)

    def cut_between(self, low: float, high: float) -> CoveredPiece:
        """Return the part of the piece between two positions, with all height ranges and faces."""
        return evolve(self, low=low, high=high)

    def cut_at(self, positions: Sequence[float]) -> list[CoveredPiece]:
        """Return the parts of the piece between the given positions, in the direction of the border."""
        found = [self.cut_between(a, b) for a, b in pairwise([self.low, *sorted(positions), self.high])]
        return found if self.piece.forward else found[::-1]

    def measure_longest_run_at(self, position: float) -> float:
        """Return the height in mm (upper minus lower z) of the longest range that walls
        cover at a position; 0 where walls cover nothing.
        """
        return max((measure_band(run.compute_heights_at(position)) for run in self.runs), default=0.0)

    def list_inner_positions(self) -> list[float]:
        """Return the sorted positions within the piece between
        which the ends of every covered height range are monotonic.
        """
        found = {
            place
            for run in self.runs
            for end in (run.lower, run.upper)
            for place in end.list_inner_positions(self.low, self.high)
        }
        return sorted(found)


@frozen(eq=False)
class UprightWall:
    """A wall over a carrier.

    Parameters
    ----------
    index : index of the face.
    branches : branches of the face's edges that are not upright.
    """

    index: int
    branches: tuple[EdgeBranch, ...]

    def list_covered_ranges(
        self, position: float, low: float, high: float
    ) -> list[tuple[float, float, WallRun]]:
        """Return the ranges of height that the wall covers above
        a position, from the lowest up, as (z0, z1, run), z in mm.

        The ranges are limited to the heights ``low`` to ``high``, and those shorter than ``LEAST_GAP`` are
        left out. The run of each range gives its heights at other positions of the piece, too.
        """
        passed = sorted(
            (
                (branch.compute_height_at(position + turn), RunEnd(branch, turn, low, high))
                for branch in self.branches
                for turn in branch.list_turns_to_add(position)
            ),
            key=lambda one: one[0],
        )
        return [
            (max(a, low), min(b, high), WallRun(lower, upper))
            for (a, lower), (b, upper) in zip(passed[0::2], passed[1::2], strict=False)
            if min(b, high) - max(a, low) > LEAST_GAP
        ]


@frozen(eq=False)
class KnownWalls:
    """Cache of a solid's wall edges and branches, which are the same for all heights of pegs.

    Parameters
    ----------
    edges : edges of walls by the identity of their points.
    branches : branches by the identity of the edge's curve and a segment of its carrier.
    """

    edges: dict[int, WallEdge] = field(factory=dict)
    branches: dict[tuple[int, Segment], tuple[EdgeBranch, ...]] = field(factory=dict)

    def find_branches_over(self, carrier: Segment, wall_edge: WallEdge) -> tuple[EdgeBranch, ...]:
        """Return the monotonic pieces of a wall's edge over a line or circle; the pieces are cached and keep
        the heights that they have computed.
        """
        key = id(wall_edge.edge.curve), carrier
        if key not in self.branches:
            self.branches[key] = tuple(EdgeBranch.make_branches(carrier, wall_edge))
        return self.branches[key]


@define
class WallsByCarrier:
    """The upright faces of a solid, looked up by the carrier that they stand on.

    Parameters
    ----------
    faces, edges : all faces and edges of the solid.
    low, high : z in mm between which a peg may press.
    known : cache of the solid's wall edges and branches.
    """

    faces: Sequence[SolidFace]
    edges: Sequence[EdgeCurve]
    low: float
    high: float
    # Edges of upright faces that are not upright themselves.
    upright: list[WallEdge] = field(init=False)
    # Of each of them (x, y) of both ends and a radius of 0, or those of an arc's centre twice and its radius.
    places: NDArray[np.float64] = field(init=False)
    found: dict[int, list[UprightWall]] = field(init=False, factory=dict)
    known: KnownWalls = field(factory=KnownWalls)

    def __attrs_post_init__(self) -> None:
        self.upright = [
            self.find_wall_edge(edge, edge.segment)
            for edge in self.edges
            if self.faces[edge.face].lie == "upright" and edge.segment is not None
        ]
        places = [
            (*segment.center, *segment.center, segment.radius)
            if isinstance(segment, Arc)
            else (*segment.start, *segment.end, 0.0)
            for segment in (one.segment for one in self.upright)
        ]
        self.places = np.array(places, np.float64).reshape(-1, 5)

    def find_wall_edge(self, edge: EdgeCurve, segment: Segment) -> WallEdge:
        """Return the wall edge of an edge whose projection is ``segment``; the result is cached, because two
        walls share the edge.
        """
        key = id(edge.points)
        if key not in self.known.edges:
            self.known.edges[key] = WallEdge.from_edge(edge, segment)
        same = self.known.edges[key]
        return same if same.edge.face == edge.face else evolve(same, edge=evolve(same.edge, face=edge.face))

    def find_cut_points(self) -> list[tuple[Segment, Point]]:
        """Return (segment, point) for all points (x, y) at which an outline must be cut.

        There the ranges of height that upright faces cover may change.
        """
        return [
            (one.segment, point) for one in self.upright for point in one.find_cut_points(self.low, self.high)
        ]

    def find_level_edge_ends(self) -> Iterator[tuple[Segment, Point]]:
        """Yield (segment, point) for both end points (x, y) of each
        level edge of an upright face, except for whole circles.

        These points are needed as cuts only if the edges themselves are not among the segments that are
        subdivided.
        """
        for one in self.upright:
            if one.is_level and not (isinstance(one.segment, Arc) and one.segment.is_full):
                yield from ((one.segment, one.segment.start), (one.segment, one.segment.end))

    def find_walls_over(self, carrier: CutCurve) -> list[UprightWall]:
        """Return the upright faces that stand on a line or
        circle, each with the pieces of its edges over it.
        """
        if id(carrier) not in self.found:
            branches: defaultdict[int, list[EdgeBranch]] = defaultdict(list)
            for k in self.find_near_edges(carrier.segment).tolist():
                one = self.upright[k]
                if carrier.is_carrier_of(one.segment):
                    branches[one.edge.face] += self.known.find_branches_over(carrier.segment, one)
            self.found[id(carrier)] = [UprightWall(index, tuple(own)) for index, own in branches.items()]
        return self.found[id(carrier)]

    def find_near_edges(self, segment: Segment) -> NDArray[np.intp]:
        """Return the indices in ``upright`` of the edges that lie near a segment's line, judged by both ends,
        or near its circle, judged by centre and radius.
        """
        radius = self.places[:, 4]
        if isinstance(segment, Arc):
            away = np.abs(self.places[:, [0, 1, 4]] - (*segment.center, segment.radius)).max(
                axis=1, initial=0
            )
            return np.flatnonzero((radius > 0.0) & (away <= NEAR))
        (x, y), (tx, ty) = segment.middle, segment.tangent
        across = np.abs((self.places[:, 0:4:2] - x) * ty - (self.places[:, 1:4:2] - y) * tx)
        return np.flatnonzero((radius == 0.0) & (across.max(axis=1, initial=0) <= NEAR))

    def find_covered(self, piece: BorderPiece) -> CoveredPiece:
        """Return a piece of the border with the ranges of height that upright faces cover over it.

        The ranges are limited to the heights of pegs; ranges of several faces that touch or overlap are
        merged. All faces over the piece have their material on the same side; otherwise the piece would not
        be a border.
        """
        walls = self.find_walls_over(piece.carrier)
        middle = find_clear_place(piece, [branch for wall in walls for branch in wall.branches])
        ranges = sorted(
            (
                (low, high, wall.index, run)
                for wall in walls
                for low, high, run in wall.list_covered_ranges(middle, self.low, self.high)
            ),
            key=lambda one: one[:3],
        )
        runs: list[tuple[float, WallRun]] = []
        for low, high, _, run in ranges:
            if runs and low <= runs[-1][0] + LEAST_GAP:
                if high > runs[-1][0]:
                    runs[-1] = high, WallRun(runs[-1][1].lower, run.upper)
            else:
                runs.append((high, run))
        faces = tuple(sorted({one[2] for one in ranges}))
        return CoveredPiece(piece, piece.low, piece.high, tuple(run for _, run in runs), faces)


def find_clear_place(piece: BorderPiece, branches: Sequence[EdgeBranch]) -> float:
    """Return a position of a piece, near its middle, at which no edge piece ends.

    Edges beyond the heights of pegs may end anywhere along the piece. If every position tried is too near to
    an end, the position farthest from all ends is returned.
    """
    ends = np.array([branch.places[[0, -1]] for branch in branches]).ravel()

    def measure_room(position: float) -> float:
        """Return the distance of a position from the nearest
        end of an edge piece; inf where there are none.
        """
        away = ends - position
        if isinstance(piece.carrier.segment, Arc):
            away = (away + pi) % tau - pi
        return float(np.abs(away).min(initial=np.inf))

    places = [piece.low + share * (piece.high - piece.low) for share in SHARES]
    return next(
        (one for one in places if measure_room(one) > piece.carrier.slack), max(places, key=measure_room)
    )
