"""Edges of upright faces over the line or circle that the faces stand on: their heights at a position."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from math import pi, tau

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.files.step.edge_curves import ONE_HEIGHT, EdgeCurve, Point3
from workhold.geometry.segment import Arc, Line
from workhold.geometry.subdivision import CutCarrier

__all__ = ["WallEdge"]

# Positions nearer than this to an edge, in mm or radians, are asked for its heights.
MARGIN = 1e-3


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
