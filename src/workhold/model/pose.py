"""The pose of a workpiece in the toolkit's frame, and its contacts when it lies flush against a wall.

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
from workhold.limits import convert_real, make_real_array, name_fields_in_errors

__all__ = ["ENDS", "FlushContacts", "Pose"]

Array = NDArray[np.float64]

# What the ends of the contact are called, in the order in which they are listed.
ENDS = ("left", "right")


@frozen(field_transformer=name_fields_in_errors)
class Pose:
    """Position of a part in the toolkit: a point q of the part is at R(theta) q + (x, y).

    Points q are in the part's frame, that of its drawing, in mm. In the toolkit's frame the origin is its
    first hole, column A and row 1 (for a vise, that of the left jaw); x runs along the columns from A to B, y
    along the rows from 1 to 2. Beside a wall y is 0 at the wall.

    Parameters
    ----------
    theta_deg : angle in degrees by which the part is turned counter-clockwise from its drawing.
    x, y : place of the part's origin in the toolkit's frame, in mm.

    Raises
    ------
    InputError
        For values that are not numbers.

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
        """Angle in degrees as shown to users, in (-45, 315]: a clockwise turn of less than 45° is negative.

        >>> Pose(359.75, 0.0, 0.0).written_deg, Pose(315.0, 0.0, 0.0).written_deg
        (-0.25, 315.0)
        """
        return self.theta_deg - 360.0 if self.theta_deg > 315.0 else self.theta_deg

    @property
    def inverse(self) -> Pose:
        """Inverse map, from the toolkit's frame to the part's."""
        x, y = rotate_vectors(-self.x, -self.y, -radians(self.theta_deg))
        return Pose(-self.theta_deg, float(x), float(y))

    @property
    def matrix(self) -> Array:
        """Map as a (3, 3) array:
        ``matrix @ (x, y, 1)`` is a point of the part in the toolkit's frame, in mm.
        """
        (a, b), (c, d) = self.turn(1.0, 0.0), self.turn(0.0, 1.0)
        return np.array([[a, c, self.x], [b, d, self.y], [0.0, 0.0, 1.0]])

    @overload
    def turn(self, x: ArrayLike, y: None = None) -> Array: ...

    @overload
    def turn(self, x: Any, y: Any) -> tuple[Any, Any]: ...

    def turn(self, x: Any, y: Any = None) -> Array | tuple[Any, Any]:
        """Return direction vectors of the part in the toolkit's frame: rotated, not moved.

        Given ``x`` alone, an array (..., 2), return an array (..., 2); given x and y apart, return a pair.
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
        """Return points of the part in the toolkit's frame, in mm.

        Given ``x`` alone, an array (..., 2), return an array (..., 2); given x and y apart, return a pair.
        """
        if y is None:
            return np.asarray(self.turn(x) + np.array([self.x, self.y]))
        turned_x, turned_y = self.turn(x, y)
        return turned_x + self.x, turned_y + self.y

    def carry(self, segment: Segment) -> Segment:
        """Return a segment of the part, moved into the toolkit's frame."""
        if isinstance(segment, Line):
            return Line(self.apply(*segment.start), self.apply(*segment.end))
        middle = segment.mid_angle + radians(self.theta_deg)
        return Arc(self.apply(*segment.center), segment.radius, middle, segment.half_sweep, segment.sign)


def wrap_to_whole_turn(angle: Array) -> Array:
    """Return angles in radians reduced to [0, 2 pi); results that rounding leaves at 2 pi become 0."""
    turned = angle % tau
    return np.asarray(np.where(turned >= tau - 1e-15 * tau, 0.0, turned))


@frozen(eq=False)
class FlushContacts:
    """The E convex hull edges of a workpiece, and the contacts of the part when it lies on a wall with each.

    Parameters
    ----------
    theta : (E,) orientation of the workpiece in radians, in [0, 2 pi), in which the edge lies on the wall.
    ends : (E, 2, 2) start and end (x, y) of each edge in mm, in the workpiece's coordinates.
    face : (E, 2) number of the face at each end, as tables of fixtures have it; at a corner the lower of two
        numbers.
    touching : for each edge, the numbers of the faces that touch the wall at the start and at the end: one
        face, or the two faces of a corner in ascending order.
    shared : (E, 2) labels, equal for contacts that an error of one face moves together: the number of the
        face, or for a corner a unique negative number.
    """

    theta: Array
    ends: Array
    face: NDArray[np.int32]
    touching: tuple[tuple[tuple[int, ...], tuple[int, ...]], ...]
    shared: NDArray[np.int64]

    @classmethod
    def from_hull_edges(cls, edges: Sequence[HullEdge], numbers: Sequence[int]) -> FlushContacts:
        """Return the contacts of E hull edges; ``numbers[i]`` is the face number that stands for index i in
        an edge's ends.
        """
        tangent = np.array([edge.tangent for edge in edges]).reshape(-1, 2)

        def list_faces(end: HullEnd) -> tuple[int, ...]:
            """Return the numbers of the faces at an end of an edge, ascending."""
            return tuple(sorted(numbers[index] for index in end.faces))

        touching = tuple((list_faces(edge.start), list_faces(edge.end)) for edge in edges)
        shared = [
            [faces[0] if len(faces) == 1 else -1 - k for k, faces in enumerate(pair)] for pair in touching
        ]
        return cls(
            theta=wrap_to_whole_turn(-np.arctan2(tangent[:, 1], tangent[:, 0])),
            ends=np.array([(edge.start.point, edge.end.point) for edge in edges]).reshape(-1, 2, 2),
            face=np.array([[faces[0] for faces in pair] for pair in touching], np.int32).reshape(-1, 2),
            touching=touching,
            shared=np.array(shared, np.int64).reshape(-1, 2),
        )

    @property
    def length(self) -> Array:
        """Lengths (E,) of the hull edges in mm."""
        return np.asarray(np.hypot(*(self.ends[:, 1] - self.ends[:, 0]).T))

    def find_nearest_edges(self, theta: Array) -> NDArray[np.int64]:
        """Return for each orientation (N,) in radians the index
        (N,) of the hull edge with the nearest ``theta``.

        The indices are -1 where there are no hull edges.
        """
        if len(self.theta) == 0:
            return np.full(len(theta), -1, np.int64)
        order = np.argsort(self.theta)
        # The last stands before the first, too, and the first behind the last.
        order = np.concatenate([order[-1:], order, order[:1]])
        around = self.theta[order]
        around[0], around[-1] = around[0] - tau, around[-1] + tau
        return order[np.searchsorted((around[:-1] + around[1:]) / 2.0, wrap_to_whole_turn(theta))]

    def compute_end_x(self, theta: Array, position: Array) -> Array:
        """Return x in mm (N, 2), in the toolkit's frame, of the start and the end of the contact with the
        wall, for N poses.

        Poses are given by ``theta`` (N,) in radians and ``position`` (N, 2) in mm; each part lies on the hull
        edge with the nearest orientation. The result is NaN if there are no hull edges.
        """
        if len(self.theta) == 0:
            return np.full((len(theta), 2), np.nan)
        ends = self.ends[self.find_nearest_edges(theta)]
        return np.asarray(rotate_vectors(ends[..., 0], ends[..., 1], theta[:, None])[0] + position[:, :1])
