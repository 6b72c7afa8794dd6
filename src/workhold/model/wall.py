"""Where a part that lies flush against a wall touches it: at the ends of the hull edge that lies on the wall.

The wall runs along x at y = 0 and the part lies above it, so the orientation determines the hull edge.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import tau

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.geometry.hull import HullEdge
from workhold.geometry.symmetry import rotated

__all__ = ["ENDS", "ON_WALL", "Flush"]

Array = NDArray[np.float64]

# What the ends of the contact are called, in the order in which they are listed.
ENDS = ("left", "right")
# Where they stand among the pegs of a fixture: after the locator.
ON_WALL = slice(1, 3)


@frozen
class WallEnd:
    """What touches the wall at an end of the contact.

    Parameters
    ----------
    faces : numbers of one face, or of the two that meet at a corner.
    along : whether the face lies along the wall.
    """

    faces: tuple[int, ...]
    along: bool

    @property
    def face(self) -> int:
        """The number of the face that a table of fixtures names: of a corner the lower one."""
        return self.faces[0]

    @property
    def beside(self) -> int | None:
        """The number of the other face of a corner."""
        return self.faces[1] if len(self.faces) > 1 else None


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
    face : (E, 2) numbers of the faces named for them.
    touching : what touches the wall at both ends of each.
    shared : (E, 2) numbers that are equal where one face's error moves several contacts alike: the face's
        number; for a corner a number below zero of its own.
    """

    theta: Array
    ends: Array
    face: NDArray[np.int32]
    touching: tuple[tuple[WallEnd, WallEnd], ...]
    shared: NDArray[np.int64]

    @classmethod
    def of(cls, edges: Sequence[HullEdge], numbers: Sequence[int]) -> Flush:
        """Makes it of hull edges and the numbers of the faces that they name by index."""
        tangent = np.array([edge.tangent for edge in edges]).reshape(-1, 2)
        touching = []
        for edge in edges:
            one, other = (
                WallEnd(tuple(sorted(numbers[index] for index in end.faces)), end.along)
                for end in (edge.start, edge.end)
            )
            touching.append((one, other))
        shared = [
            [end.face if len(end.faces) == 1 else -1 - k for k, end in enumerate(pair)] for pair in touching
        ]
        return cls(
            theta=in_one_turn(-np.arctan2(tangent[:, 1], tangent[:, 0])),
            ends=np.array([(edge.start.point, edge.end.point) for edge in edges]).reshape(-1, 2, 2),
            face=np.array([[end.face for end in pair] for pair in touching], np.int32).reshape(-1, 2),
            touching=tuple(touching),
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
        return np.asarray(rotated(ends[..., 0], ends[..., 1], theta[:, None])[0] + position[:, :1])
