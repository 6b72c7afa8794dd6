"""Where a workpiece lies in the toolkit's frame: its pose, and flush against a wall.

The wall runs along x at y = 0 and the part lies above it, so the orientation determines the hull edge
that lies on the wall. The part touches the wall at the ends of that edge.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import radians, tau
from typing import Any, overload

import numpy as np
from attrs import field, frozen
from numpy.typing import ArrayLike, NDArray

from workhold.errors import InputError, quote_value
from workhold.geometry.hull import HullEdge, HullEnd
from workhold.geometry.segment import Arc, Line, Segment
from workhold.geometry.symmetry import rotate_vectors
from workhold.limits import convert_real, make_real_array, name_number_fields

__all__ = ["ENDS", "Flush", "Pose"]

Array = NDArray[np.float64]

# What the ends of the contact are called, in the order in which they are listed.
ENDS = ("left", "right")


@frozen(field_transformer=name_number_fields)
class Pose:
    """Where a part lies: the map of its point q to R(theta) q + (x, y).

    Points q are in the part's frame, that of its drawing, in mm. They go to the toolkit's frame: the origin is
    its first hole, column A and row 1 (of a vise that of the left jaw), x runs along its columns from A to B and
    y along its rows from 1 to 2. Beside a wall y is 0 at the wall.

    Parameters
    ----------
    theta_deg : by how much the part is turned, in degrees, counter-clockwise; 0 as it is drawn.
    x, y : where the part's origin lies in the toolkit's frame, in mm.

    Raises
    ------
    InputError
        For what are no numbers.

    Examples
    --------
    >>> pose = Pose(90.0, 40.0, 5.0)
    >>> pose.apply([(3.0, 1.0), (0.0, 0.0)]).round(12).tolist()
    [[39.0, 8.0], [40.0, 5.0]]
    >>> pose.inverse.apply([(39.0, 8.0)]).round(12).tolist()
    [[3.0, 1.0]]
    >>> (pose.matrix @ (3.0, 1.0, 1.0)).round(12).tolist()
    [39.0, 8.0, 1.0]
    """

    theta_deg: float = field(converter=convert_real)
    x: float = field(converter=convert_real)
    y: float = field(converter=convert_real)

    @property
    def written_deg(self) -> float:
        """The turn in degrees as people write it: less than an eighth of a turn clockwise is a negative angle.

        >>> Pose(359.75, 0.0, 0.0).written_deg, Pose(315.0, 0.0, 0.0).written_deg
        (-0.25, 315.0)
        """
        return self.theta_deg - 360.0 if self.theta_deg > 315.0 else self.theta_deg

    @property
    def inverse(self) -> Pose:
        """The way back, from the toolkit's frame to the part's."""
        x, y = rotate_vectors(-self.x, -self.y, -radians(self.theta_deg))
        return Pose(-self.theta_deg, float(x), float(y))

    @property
    def matrix(self) -> Array:
        """The map as a (3, 3) array: ``matrix @ (x, y, 1)`` is a point of the part in the toolkit's frame, in mm."""
        (a, b), (c, d) = self.turn(1.0, 0.0), self.turn(0.0, 1.0)
        return np.array([[a, c, self.x], [b, d, self.y], [0.0, 0.0, 1.0]])

    @overload
    def turn(self, x: ArrayLike, y: None = None) -> Array: ...

    @overload
    def turn(self, x: Any, y: Any) -> tuple[Any, Any]: ...

    def turn(self, x: Any, y: Any = None) -> Array | tuple[Any, Any]:
        """Directions of the part as they point in the toolkit's frame.

        Parameters
        ----------
        x, y : (..., 2) vectors alone, of which an array comes back; or their x and y, of which two come back.
        """
        if y is None:
            if isinstance(x, str):
                raise InputError(f"points cannot be {quote_value(x)}: give numbers (N, 2).")
            vectors = make_real_array(x, "a coordinate")
            return np.stack(self.turn(vectors[..., 0], vectors[..., 1]), axis=-1)
        return rotate_vectors(x, y, radians(self.theta_deg))

    @overload
    def apply(self, x: ArrayLike, y: None = None) -> Array: ...

    @overload
    def apply(self, x: Any, y: Any) -> tuple[Any, Any]: ...

    def apply(self, x: Any, y: Any = None) -> Array | tuple[Any, Any]:
        """Points of the part in the toolkit's frame, in mm.

        Parameters
        ----------
        x, y : (..., 2) points alone, of which an array comes back; or their x and y, of which two come back.
        """
        if y is None:
            return np.asarray(self.turn(x) + np.array([self.x, self.y]))
        turned_x, turned_y = self.turn(x, y)
        return turned_x + self.x, turned_y + self.y

    def carry(self, segment: Segment) -> Segment:
        """A segment of the part in the toolkit's frame."""
        if isinstance(segment, Line):
            return Line(self.apply(*segment.start), self.apply(*segment.end))
        middle = segment.mid_angle + radians(self.theta_deg)
        return Arc(self.apply(*segment.center), segment.radius, middle, segment.half_sweep, segment.sign)


def in_one_turn(angle: Array) -> Array:
    """Angles in radians in [0, 2 pi), also those that rounding puts just below 0."""
    turned = angle % tau
    return np.asarray(np.where(turned >= tau - 1e-15 * tau, 0.0, turned))


@frozen(eq=False)
class Flush:
    """A workpiece's hull edges, and how it lies on each.

    Parameters
    ----------
    theta : (E,) orientation of the workpiece in radians, in [0, 2 pi), in which each lies on the wall.
    ends : (E, 2, 2) their starts and ends in the workpiece's coordinates, in mm.
    face : (E, 2) numbers of the faces that a table of fixtures names for them: of a corner the lower one.
    touching : numbers of the faces that touch the wall at the start and at the end of each. A corner has
        those of two faces, the lower one first.
    shared : (E, 2) numbers that are equal where one face's error moves several contacts alike: the face's
        number; for a corner a number below zero of its own.
    """

    theta: Array
    ends: Array
    face: NDArray[np.int32]
    touching: tuple[tuple[tuple[int, ...], tuple[int, ...]], ...]
    shared: NDArray[np.int64]

    @classmethod
    def of(cls, edges: Sequence[HullEdge], numbers: Sequence[int]) -> Flush:
        """Makes it of hull edges and the numbers of the faces that they name by index."""
        tangent = np.array([edge.tangent for edge in edges]).reshape(-1, 2)

        def named(end: HullEnd) -> tuple[int, ...]:
            return tuple(sorted(numbers[index] for index in end.faces))

        touching = tuple((named(edge.start), named(edge.end)) for edge in edges)
        shared = [
            [faces[0] if len(faces) == 1 else -1 - k for k, faces in enumerate(pair)] for pair in touching
        ]
        return cls(
            theta=in_one_turn(-np.arctan2(tangent[:, 1], tangent[:, 0])),
            ends=np.array([(edge.start.point, edge.end.point) for edge in edges]).reshape(-1, 2, 2),
            face=np.array([[faces[0] for faces in pair] for pair in touching], np.int32).reshape(-1, 2),
            touching=touching,
            shared=np.array(shared, np.int64).reshape(-1, 2),
        )

    @property
    def length(self) -> Array:
        """Lengths (E,) in mm."""
        return np.asarray(np.hypot(*(self.ends[:, 1] - self.ends[:, 0]).T))

    def number(self, theta: Array) -> NDArray[np.int64]:
        """The hull edge (N,) nearest to the wall in each orientation (N,); -1 where there is none."""
        if len(self.theta) == 0:
            return np.full(len(theta), -1, np.int64)
        order = np.argsort(self.theta)
        # The last stands before the first, too, and the first behind the last.
        order = np.concatenate([order[-1:], order, order[:1]])
        around = self.theta[order]
        around[0], around[-1] = around[0] - tau, around[-1] + tau
        return order[np.searchsorted((around[:-1] + around[1:]) / 2.0, in_one_turn(theta))]

    def x(self, theta: Array, position: Array) -> Array:
        """x (N, 2) of the ends of the contact in mm, of poses of orientations (N,) and positions (N, 2)."""
        if len(self.theta) == 0:
            return np.full((len(theta), 2), np.nan)
        ends = self.ends[self.number(theta)]
        return np.asarray(rotate_vectors(ends[..., 0], ends[..., 1], theta[:, None])[0] + position[:, :1])
