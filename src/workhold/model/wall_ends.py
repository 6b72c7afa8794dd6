"""The two ends of the part's contact with a wall: the ends of a hull edge, or of its common stretch with the
wall.

A wall with ends, such as a flat jaw of a vise, covers a range of x in its own frame. The part touches the
wall's line at the points K of a hull edge, which may bridge gaps. The common stretch is the convex hull of
the points of K that lie on the wall. Its ends carry the wall's force, so they are the contacts.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.conventions import GAP_SLACK, SAME_PLACE
from workhold.fixels.carrier import WALL
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.hull import HullTouch, find_touches_along
from workhold.geometry.segment import Box
from workhold.model.workpiece import Workpiece

__all__ = [
    "CommonStretch",
    "WallEnds",
    "find_common_stretch",
    "measure_standouts",
    "list_hull_touches",
    "find_wall_ends",
]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


def list_hull_touches(workpiece: Workpiece, edge: int) -> tuple[HullTouch, ...]:
    """Return the parts of a workpiece's outline that touch the line of the hull edge with this index.

    See :func:`find_touches_along` for their form and order.
    """
    own, _ = workpiece.find_outline(WALL)
    segments = [face.segment for face in own.outer_faces]
    return find_touches_along(workpiece.hull_edges[edge], segments, own.outer_face_counts)


@frozen(eq=False)
class CommonStretch:
    """Common stretches of a part and walls at N places along a hull edge, in mm from the edge's start.

    Parameters
    ----------
    start, end : (N,) ends of the stretch; where there is none, inf and -inf.
    first, last : (N,) indices of the touches at the start and at the end.
    """

    start: Array
    end: Array
    first: IntArray
    last: IntArray

    @property
    def length(self) -> Array:
        """Lengths (N,) in mm; -inf if there is no stretch."""
        return self.end - self.start


def find_common_stretch(touches: Sequence[HullTouch], low: Array, high: Array) -> CommonStretch:
    """Return the stretches that the touches along a hull edge share with N walls.

    Each wall reaches from ``low`` to ``high``, (N,) in mm from the edge's start.
    """
    ends = np.array([(one.low, one.high) for one in touches])
    start, end = np.maximum(ends[:, 0], low[:, None]), np.minimum(ends[:, 1], high[:, None])
    inside = start <= end + GAP_SLACK
    start, end = np.where(inside, start, np.inf), np.where(inside, end, -np.inf)
    least, most = start.min(axis=1), end.max(axis=1)
    # What lies along the edge stands before what touches in a point.
    first = (start <= least[:, None] + SAME_PLACE).argmax(axis=1)
    last = (end >= most[:, None] - SAME_PLACE).argmax(axis=1)
    return CommonStretch(least, most, first, last)


@frozen(eq=False)
class WallEnds:
    """The two ends of the contact with a wall of N fixtures.

    Parameters
    ----------
    x : (N, 2) x of the first and the second end in mm.
    length : (N,) length of the contact in mm.
    named : for each thing that may touch the wall, the numbers of its faces: one, or two at a corner.
    which : (N, 2) index into ``named`` of what touches at each end.
    """

    x: Array
    length: Array
    named: tuple[tuple[int, ...], ...]
    which: IntArray

    @property
    def face(self) -> IntArray:
        """Numbers (N, 2) of the faces that touch at the ends; at a corner the lower number of its two faces."""
        lower = np.array([faces[0] for faces in self.named], np.int64)
        return np.asarray(lower[self.which])

    @property
    def shared(self) -> IntArray:
        """Labels (N, 2), equal where the error of one face moves both ends alike.

        A label is the number of the face; at a corner it is -1 for the first end and -2 for the second.
        """
        is_corner = np.array([len(faces) > 1 for faces in self.named])
        return np.where(is_corner[self.which], np.array([-1, -2]), self.face)

    def list_touching_faces(self, row: int) -> tuple[tuple[int, ...], tuple[int, ...]]:
        """Return the numbers of the faces that touch at the first and at the second end in a row.

        Each is a tuple of one number, or of two at a corner.
        """
        one, other = self.which[row].tolist()
        return self.named[one], self.named[other]


def find_wall_ends(workpiece: Workpiece, toolkit: Toolkit, theta: Array, position: Array) -> WallEnds:
    """Return the two ends of the contact with a toolkit's wall for N poses.

    If a wall with ends does not reach the part, the ends are those of the contact with an endless wall.

    Parameters
    ----------
    theta, position : (N,) in radians and (N, 2) in mm, of the poses.
    """
    flush, jaw = workpiece.flush, toolkit.wall_with_ends
    reach = None if jaw is None else jaw.reach
    edge, x = flush.find_nearest_edges(theta), flush.compute_end_x(theta, position)
    named = [faces for pair in flush.touching for faces in pair]
    which = 2 * edge[:, None] + np.arange(2)
    if reach is None or len(flush.theta) == 0:
        return WallEnds(x, flush.length[edge], tuple(named), which)
    length = flush.length[edge].copy()
    numbers = [face.number for face in workpiece.find_outline(WALL)[0].faces]
    first: int = workpiece.find_outline(WALL)[1]
    for number in np.unique(edge).tolist():
        rows = np.flatnonzero(edge == number)
        touches, start = list_hull_touches(workpiece, number), x[rows, 0].copy()
        common = find_common_stretch(touches, reach[0] - start, reach[1] - start)
        there = np.isfinite(common.start)
        rows, start = rows[there], start[there]
        x[rows] = start[:, None] + np.stack([common.start, common.end], axis=1)[there]
        length[rows] = common.length[there]
        which[rows] = len(named) + np.stack([common.first, common.last], axis=1)[there]
        named += [tuple(sorted(first + numbers[index] for index in one.faces)) for one in touches]
    return WallEnds(x, length, tuple(named), which)


def measure_standouts(part: Box, reach: tuple[float, float]) -> tuple[float, float]:
    """Return the distances in mm by which a part's box extends beyond a wall's left and right end; 0 if it
    does not.
    """
    return max(reach[0] - part.x0, 0.0), max(part.x1 - reach[1], 0.0)
