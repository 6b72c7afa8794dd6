"""A pose: where a workpiece lies in the vise frame."""

from __future__ import annotations

from math import radians
from typing import Any

from attrs import frozen

from workhold.geometry.segment import Arc, Line, Segment
from workhold.geometry.symmetry import rotated

__all__ = ["Pose"]


@frozen
class Pose:
    """The map of a workpiece point q to R(theta) q + (x, y) in the vise frame; theta in degrees, x and y in
    mm.

    Points and directions are given by their coordinates, numbers or arrays of them.

    Examples
    --------
    >>> pose = Pose(90.0, 40.0, 5.0)
    >>> [round(float(v), 12) for v in (*pose.apply(3.0, 1.0), *pose.inverse.apply(39.0, 8.0))]
    [39.0, 8.0, 3.0, 1.0]
    """

    theta_deg: float
    x: float
    y: float

    @property
    def inverse(self) -> Pose:
        """The way back, from the vise frame to the workpiece's."""
        x, y = rotated(-self.x, -self.y, -radians(self.theta_deg))
        return Pose(-self.theta_deg, float(x), float(y))

    def turn(self, x: Any, y: Any) -> tuple[Any, Any]:
        """Directions of the workpiece as they point in the vise frame."""
        return rotated(x, y, radians(self.theta_deg))

    def apply(self, x: Any, y: Any) -> tuple[Any, Any]:
        """Points of the workpiece, in mm, in the vise frame."""
        turned_x, turned_y = self.turn(x, y)
        return turned_x + self.x, turned_y + self.y

    def carry(self, segment: Segment) -> Segment:
        """A segment of the workpiece in the vise frame."""
        if isinstance(segment, Line):
            return Line(self.apply(*segment.start), self.apply(*segment.end))
        middle = segment.mid_angle + radians(self.theta_deg)
        return Arc(self.apply(*segment.center), segment.radius, middle, segment.half_sweep, segment.sign)
