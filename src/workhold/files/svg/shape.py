"""A shape: what one SVG element draws, as a chain in its own user units (y down)."""

from __future__ import annotations

from math import hypot

from attrs import frozen

from workhold.errors import InputError
from workhold.geometry.segment import Point

__all__ = ["Shape", "near", "refused"]


@frozen
class Shape:
    """N + 1 points in user units, N bulges, N labels."""

    points: tuple[Point, ...]
    bulges: tuple[float, ...]
    labels: tuple[str, ...]

    def closed(self) -> Shape:
        """The shape with a line from its end to its start, unless it ends there."""
        if near(self.points[0], self.points[-1]):
            return self
        label = f"{self.labels[0].rpartition(' segment ')[0] or self.labels[0]} segment {len(self.labels) + 1}"
        return Shape((*self.points, self.points[0]), (*self.bulges, 0.0), (*self.labels, label))


def near(p: Point, q: Point) -> bool:
    """Whether two points are equal but for rounding."""
    return hypot(p[0] - q[0], p[1] - q[1]) <= 1e-12 * (1 + abs(p[0]) + abs(p[1]))


def refused(label: str, what: str, point: Point) -> InputError:
    """The error for shapes that are no lines and circular arcs."""
    return InputError(
        f"{label} {what} at ({point[0]:.6g}, {point[1]:.6g}), which is not made of lines and circular arcs: export the "
        "drawing with arcs, or redraw it."
    )
