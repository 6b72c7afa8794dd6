"""Bands: the heights at which a peg may press on each piece of an outline, from the solid's upright faces.

Over a point of the outline's border an upright face covers ranges of height. The band of the point is the
least interval that holds them within the heights that a peg reaches. Between the ends, lowest and highest
points of the walls' edges, and those where they pass an end of these heights, both of its ends run
monotonically. So a piece has in common what both ends have.

Glossary
--------
wall : an upright face of the solid.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Sequence
from functools import cached_property
from math import pi, tau

import numpy as np
from attrs import define, field, frozen
from numpy.typing import NDArray

from workhold.conventions import SAME_HEIGHT
from workhold.files.step.edge_curves import ONE_HEIGHT, EdgeCurve, Point3
from workhold.files.step.faces import SolidFace
from workhold.geometry.segment import Arc, Line, Point, Segment
from workhold.geometry.subdivision import BorderPiece, CutCarrier
from workhold.model.solid import Band

__all__ = ["WallEdge", "Walls", "length"]

# Edges this far from a carrier in mm, and farther, are not asked whether they lie on it.
NEAR = 1e-4
# Positions nearer than this to an edge, in mm or radians, are asked for its heights.
MARGIN = 1e-3


@frozen
class Wall:
    """An upright face over a carrier.

    Parameters
    ----------
    index : of the face.
    edges : its edges that are not upright.
    """

    index: int
    edges: tuple[WallEdge, ...]

    def intervals(self, position: float, beside: float) -> list[Band]:
        """Ranges of z in mm that the face covers at a position, see :meth:`Walls.band`; the lowest first."""
        heights = sorted(z for edge in self.edges for z in edge.heights(position, beside))
        return list(zip(heights[0::2], heights[1::2], strict=False))


@define
class Walls:
    """The upright faces of a solid by the carrier that they stand on.

    Parameters
    ----------
    faces, edges : of the solid.
    low, high : z in mm between which a peg may press.
    """

    faces: Sequence[SolidFace]
    edges: Sequence[EdgeCurve]
    low: float
    high: float
    # Edges of upright faces that are not upright themselves, with the segments under them.
    upright: list[tuple[EdgeCurve, Segment]] = field(init=False)
    # Of each of them (x, y) of both ends and a radius of 0, or those of an arc's centre twice and its radius.
    places: NDArray[np.float64] = field(init=False)
    found: dict[int, list[Wall]] = field(init=False, factory=dict)
    beside: dict[tuple[int, float, float], list[Wall]] = field(init=False, factory=dict)

    def __attrs_post_init__(self) -> None:
        self.upright = [
            (edge, edge.segment)
            for edge in self.edges
            if self.faces[edge.face].lie == "upright" and edge.segment is not None
        ]
        places = [
            (*segment.center, *segment.center, segment.radius)
            if isinstance(segment, Arc)
            else (*segment.start, *segment.end, 0.0)
            for _, segment in self.upright
        ]
        self.places = np.array(places, np.float64).reshape(-1, 5)

    def cuts(self) -> list[tuple[Segment, Point]]:
        """Points at which an outline is to be cut.

        There an edge of a wall is highest or lowest, or passes an end of the heights that pegs press at, so
        that the band may jump.
        """
        return [
            (segment, point)
            for edge, segment in self.upright
            for point in (*edge.turning_points(), *edge.crossings(self.low), *edge.crossings(self.high))
        ]

    def over(self, carrier: CutCarrier) -> list[Wall]:
        """The walls that stand on a carrier."""
        if id(carrier) not in self.found:
            edges = defaultdict(list)
            for k in self.near(carrier.segment).tolist():
                edge, segment = self.upright[k]
                if carrier.holds(segment):
                    edges[edge.face].append(WallEdge.over(carrier, edge))
            self.found[id(carrier)] = [Wall(index, tuple(own)) for index, own in edges.items()]
        return self.found[id(carrier)]

    def over_piece(self, piece: BorderPiece) -> list[Wall]:
        """The walls that stand on a piece's carrier, with what they have of edges near the piece."""
        key = id(piece.carrier), piece.low, piece.high
        if key not in self.beside:
            near = [
                Wall(wall.index, tuple(one for one in wall.edges if one.is_near(piece.low, piece.high)))
                for wall in self.over(piece.carrier)
            ]
            self.beside[key] = [wall for wall in near if wall.edges]
        return self.beside[key]

    def near(self, segment: Segment) -> NDArray[np.intp]:
        """Numbers of upright faces' edges that may lie on a segment's line or circle."""
        radius = self.places[:, 4]
        if isinstance(segment, Arc):
            away = np.abs(self.places[:, [0, 1, 4]] - (*segment.center, segment.radius)).max(
                axis=1, initial=0
            )
            return np.flatnonzero((radius > 0.0) & (away <= NEAR))
        (x, y), (tx, ty) = segment.middle, segment.tangent
        across = np.abs((self.places[:, 0:4:2] - x) * ty - (self.places[:, 1:4:2] - y) * tx)
        return np.flatnonzero((radius == 0.0) & (across.max(axis=1, initial=0) <= NEAR))

    def band(
        self, piece: BorderPiece, position: float, beside: float = 0.0
    ) -> tuple[Band | None, tuple[int, ...]]:
        """The band at a position of a piece, and the indices of the walls that make it.

        No wall there has its material on the other side: a peg would meet that, and the piece were no border.

        Parameters
        ----------
        position : on the piece's carrier.
        beside : where the position is an end of the piece, a small step into it. The band is then the limit
            from there, because at the end itself other edges begin.
        """
        covered = self.ranges(piece, position, beside)
        if not covered:
            return None, ()
        band = min(one[0] for one in covered), max(one[1] for one in covered)
        return band, tuple(sorted({one[2] for one in covered}))

    def ranges(self, piece: BorderPiece, position: float, beside: float) -> list[tuple[float, float, int]]:
        """Ranges of z in mm that walls cover at a position, each with the wall's index, see :meth:`band`."""
        return [
            (*band, wall.index)
            for wall in self.over_piece(piece)
            for band in self.covered(wall, piece, position, beside)
        ]

    def is_single(self, piece: BorderPiece) -> bool:
        """Whether one range of one wall is the band all along a piece."""
        return len(self.ranges(piece, (piece.low + piece.high) / 2, 0.0)) == 1

    def covered(self, wall: Wall, piece: BorderPiece, position: float, beside: float) -> list[Band]:
        """Ranges of z in mm that a wall covers within the heights of pegs, see :meth:`band`.

        At an end of a piece a range may shrink to a point, but its limit counts there. So the ranges that
        count are those that do in the middle, where there are as many.
        """
        here = [self.within(one) for one in wall.intervals(position, beside)]
        counts = [length(one) > SAME_HEIGHT for one in here]
        if beside != 0.0:
            middle = wall.intervals((piece.low + piece.high) / 2, 0.0)
            if len(middle) == len(here):
                counts = [length(self.within(one)) > SAME_HEIGHT for one in middle]
        return [one for one, is_high in zip(here, counts, strict=True) if is_high]

    def within(self, band: Band) -> Band:
        """What of a range lies within the heights of pegs; of no length or less where nothing does."""
        return max(band[0], self.low), min(band[1], self.high)


def length(band: Band) -> float:
    """Length of a band in mm, below 0 where two bands had nothing in common."""
    return band[1] - band[0]


@define(eq=False, slots=False)
class WallEdge:
    """An edge of a wall that is not upright, over the wall's carrier.

    Parameters
    ----------
    edge : it projects to a line or an arc.
    places : (N,) positions of its points on the carrier, on a circle without jumps.
    """

    edge: EdgeCurve
    places: NDArray[np.float64]

    @classmethod
    def over(cls, carrier: CutCarrier, edge: EdgeCurve) -> WallEdge:
        """An edge over a carrier that holds it."""
        found = np.array([carrier.position((x, y)) for x, y in edge.points[:, :2].tolist()])
        return cls(edge, found if isinstance(carrier.segment, Line) else np.unwrap(found))

    @cached_property
    def span(self) -> tuple[float, float]:
        """The least and the greatest position of its points."""
        return float(self.places.min()), float(self.places.max())

    @cached_property
    def turns(self) -> tuple[float, ...]:
        """What is added to a position to find it among those of the edge: whole turns on a circle.

        A piece begins and an edge begins within half a turn of 0, and either may run a turn in its direction.
        """
        return (0.0,) if isinstance(self.edge.segment, Line) else (-2 * tau, -tau, 0.0, tau, 2 * tau)

    def is_near(self, low: float, high: float) -> bool:
        """Whether the edge runs over some of a range of positions, or almost."""
        first, last = self.span
        return any(low + turn <= last + MARGIN and high + turn >= first - MARGIN for turn in self.turns)

    def heights(self, position: float, beside: float) -> list[float]:
        """The z in mm at which the edge passes a position, as its limit from a step beside."""
        first, last = self.span
        margin = MARGIN + abs(beside)
        found: list[float] = []
        for turn in self.turns:
            if first - margin <= position + turn <= last + margin:
                found += self.passed(position + turn, beside)
        return found

    def passed(self, position: float, beside: float) -> list[float]:
        """The z in mm at a position of the edge's own turn, see :meth:`heights`."""
        edge, places = self.edge, self.places
        away = places - (position + beside)
        found = []
        # A position that is just that of a point is passed once.
        for k in np.flatnonzero((away[:-1] > 0) != (away[1:] > 0)):
            ends = sorted((float(places[k]), float(places[k + 1])))
            wanted = min(max(position, ends[0]), ends[1])
            first, last = float(edge.points[k, 2]), float(edge.points[k + 1, 2])
            share = (wanted - float(places[k])) / float(places[k + 1] - places[k])
            if len(places) == 2 or abs(last - first) <= ONE_HEIGHT or share in (0.0, 1.0):
                found.append(first + share * (last - first))
            else:
                found.append(self.refined(int(k), wanted))
        return found

    def refined(self, k: int, position: float) -> float:
        """The z in mm at which a curved edge passes a position between its points k and k + 1."""
        own = self.along((float(self.edge.points[k, 0]), float(self.edge.points[k, 1]), 0.0))
        segment = self.edge.segment
        along = self.along
        if isinstance(segment, Arc):

            def along(point: Point3) -> float:
                return own + (self.along(point) - own + pi) % tau - pi

        return self.edge.point_at(k, along, own + self.direction * (position - float(self.places[k])))[2]

    @cached_property
    def along(self) -> Callable[[Point3], float]:
        """The parameter of a point along the edge's own segment, in mm or radians."""
        segment = self.edge.segment
        assert segment is not None
        if isinstance(segment, Arc):
            return lambda point: segment.parameter((point[0], point[1]))
        (x, y), (tx, ty) = segment.middle, segment.tangent
        return lambda point: (point[0] - x) * tx + (point[1] - y) * ty

    @cached_property
    def direction(self) -> float:
        """1 where positions on the carrier grow with the segment's own parameter, else -1; 1 of an arc."""
        if isinstance(self.edge.segment, Arc):
            return 1.0
        own = np.array([self.along((x, y, 0.0)) for x, y in self.edge.points[:, :2].tolist()])
        return 1.0 if float(np.dot(own - own.mean(), self.places - self.places.mean())) > 0 else -1.0
