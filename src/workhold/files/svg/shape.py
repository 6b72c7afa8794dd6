"""A shape: what one SVG element draws, as a chain in its own user units (y down)."""

from __future__ import annotations

from collections.abc import Mapping
from math import hypot

from attrs import field, frozen

from workhold.geometry.rational import Pieces
from workhold.geometry.segment import Point

__all__ = ["Shape", "near"]


@frozen
class Shape:
    """N + 1 points in user units, N bulges, N labels, and the segments that are curves, by their numbers."""

    points: tuple[Point, ...]
    bulges: tuple[float, ...]
    labels: tuple[str, ...]
    curved: Mapping[int, Pieces] = field(factory=dict)

    def closed(self) -> Shape:
        """The shape with a line from its end to its start, unless it ends there."""
        if near(self.points[0], self.points[-1]):
            return self
        label = f"{self.labels[0].rpartition(' segment ')[0] or self.labels[0]} segment {len(self.labels) + 1}"
        return Shape((*self.points, self.points[0]), (*self.bulges, 0.0), (*self.labels, label), self.curved)


def near(p: Point, q: Point) -> bool:
    """Whether two points are equal but for rounding."""
    return hypot(p[0] - q[0], p[1] - q[1]) <= 1e-12 * (1 + abs(p[0]) + abs(p[1]))
