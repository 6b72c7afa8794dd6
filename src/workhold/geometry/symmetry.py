"""Vectors of the plane turned, and the rotations and mirror images that carry an outline onto itself.

The rotations form a cyclic group (those of a bounded figure do; H. S. M. Coxeter, *Introduction to Geometry*,
1969, section 2.7), so the smallest of them makes all others by being repeated; and one mirror image makes all
others by being turned.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from math import gcd, tau
from typing import Any

import numpy as np
from attrs import define, evolve
from numpy.typing import NDArray

from workhold.conventions import SAME_AFTER_TURN
from workhold.geometry.segment import Arc, Line, Point, Segment

__all__ = [
    "Rotation",
    "find_centroid_of_joints",
    "is_own_mirror_image",
    "middle_of",
    "rotate_vectors",
    "find_rotations_onto_itself",
    "symmetries",
]


def rotate_vectors(x: Any, y: Any, angle: Any) -> tuple[Any, Any]:
    """Vectors turned counter-clockwise by angles in radians; numbers or arrays of matching shapes.

    >>> [round(float(v), 12) for v in rotate_vectors(3.0, 1.0, np.pi / 2)]
    [-1.0, 3.0]
    """
    cosine, sine = np.cos(angle), np.sin(angle)
    return cosine * x - sine * y, sine * x + cosine * y


Array = NDArray[np.float64]

# A direction in which no two points of a drawing are likely to lie level.
ALONG = (0.7548776662, 0.5698402910)


@define(frozen=True, eq=False)
class Rotation:
    """A rotation of an outline onto itself.

    Parameters
    ----------
    angle : counter-clockwise, in radians, in [0, 2 pi).
    image : (N,) index of the segment that each segment is carried to.
    """

    angle: float
    image: NDArray[np.int64]


def find_centroid_of_joints(segments: Sequence[Segment]) -> Point:
    """Mean of the segments' middles, weighted by length: every rotation onto itself keeps this point."""
    total = sum(s.length for s in segments)
    middles = [middle_of(s) for s in segments]
    x = sum(s.length * m[0] for s, m in zip(segments, middles, strict=True)) / total
    y = sum(s.length * m[1] for s, m in zip(segments, middles, strict=True)) / total
    return x, y


def middle_of(segment: Segment) -> Point:
    """A point that moves with a segment: its middle, or the centre of a whole circle."""
    return segment.center if isinstance(segment, Arc) and segment.is_full else segment.at(0.0)


@define(frozen=True, eq=False)
class CenteredOutline:
    """N segments about a point that every rotation onto itself keeps.

    Parameters
    ----------
    points : (N, 4, 2) anchor, start, end and centre. The anchor is the middle, or the centre of a whole
        circle, of which all four are the centre. The centre of a line is its middle.
    kinds : (N, 3) signed radius (0 for a line), 1 for a whole circle, and the mark.
    """

    points: Array
    kinds: Array

    @classmethod
    def of(cls, segments: Sequence[Segment], marks: Sequence[int] = ()) -> CenteredOutline:
        """The outline of some segments; those of different marks are never images of each other."""
        points, kinds = [], []
        for s, mark in zip(segments, marks or [0] * len(segments), strict=True):
            if isinstance(s, Arc):
                points.append((s.center,) * 4 if s.is_full else (s.at(0.0), s.start, s.end, s.center))
                kinds.append((s.sign * s.radius, float(s.is_full), mark))
            else:
                points.append((s.at(0.0), s.start, s.end, s.at(0.0)))
                kinds.append((0.0, 0.0, mark))
        return cls(np.array(points) - find_centroid_of_joints(segments), np.array(kinds))

    @cached_property
    def levels(self) -> tuple[Array, NDArray[np.int64]]:
        """The anchors' places (N,) along one direction in ascending order, and whose they are."""
        level = self.points[:, 0] @ ALONG
        order = np.argsort(level, kind="stable")
        return level[order], order

    @property
    def first(self) -> int | None:
        """The first segment whose anchor is not in the middle; None where all are."""
        off_center = np.flatnonzero(np.hypot(*self.points[:, 0].T) > SAME_AFTER_TURN)
        return int(off_center[0]) if len(off_center) else None

    def angles(self, other: CenteredOutline) -> Array:
        """Angles (M,) in [0, 2 pi) that may carry the first segment's anchor to anchors of another."""
        assert self.first is not None
        x, y = other.points[np.hypot(*other.points[:, 0].T) > SAME_AFTER_TURN, 0].T
        return np.asarray((np.arctan2(y, x) - np.arctan2(*self.points[self.first, 0, ::-1])) % tau)

    def image(self, other: CenteredOutline, angle: float) -> NDArray[np.int64] | None:
        """The segment of another outline that a rotation carries each to, or None when one has no image."""
        assert self.first is not None
        # One segment rules most angles out.
        one = self.images(other, angle, slice(self.first, self.first + 1))
        found = one if (one < 0).any() else self.images(other, angle, slice(None))
        return None if (found < 0).any() else found

    def images(self, other: CenteredOutline, angle: float, chosen: slice) -> NDArray[np.int64]:
        """Segments of another outline that a rotation carries each of some to; -1 without an image."""
        points, kinds = self.points[chosen], self.kinds[chosen]
        turned = np.stack(rotate_vectors(points[..., 0], points[..., 1], angle), axis=-1)
        level, order = other.levels
        # The anchor of an image is at most so far off, and so is its level, the direction being no longer
        # than 1.
        first, end = (
            np.searchsorted(level, turned[:, 0] @ ALONG + hair)
            for hair in (-SAME_AFTER_TURN, SAME_AFTER_TURN)
        )
        found = np.full(len(turned), -1)
        for step in range(int((end - first).max(initial=0))):
            open_ = np.flatnonzero((found < 0) & (first + step < end))
            there = order[first[open_] + step]
            apart = np.hypot(*np.moveaxis(turned[open_] - other.points[there], -1, 0))
            alike = np.abs(kinds[open_] - other.kinds[there]) <= SAME_AFTER_TURN
            good = (apart <= SAME_AFTER_TURN).all(axis=1) & alike.all(axis=1)
            found[open_[good]] = there[good]
        return found


def find_rotations_onto_itself(segments: Sequence[Segment], marks: Sequence[int] = ()) -> list[Rotation]:
    """All rotations that carry an outline, given by its faces, onto itself; the identity comes first.

    An outline of concentric circles alone turns onto itself at every angle; only the identity is returned for
    it. Of several outlines marks say of which each face is, and every one is carried onto itself.
    """
    outline = CenteredOutline.of(segments, marks)
    rotations = [Rotation(0.0, np.arange(len(segments), dtype=np.int64))]
    if outline.first is None:
        return rotations
    angles = outline.angles(outline)
    orders = (n for n in range(len(segments), 1, -1) if np.abs(angles - tau / n).min() <= SAME_AFTER_TURN)
    found = ((order, outline.image(outline, tau / order)) for order in orders)
    order, generator = next(((order, image) for order, image in found if image is not None), (1, None))
    for k in range(1, order):
        assert generator is not None
        shared = gcd(k, order)
        rotations.append(Rotation(k // shared * tau / (order // shared), generator[rotations[-1].image]))
    return rotations


def symmetries(segments: Sequence[Segment], marks: Sequence[int] = ()) -> list[NDArray[np.int64]]:
    """Indices (N,) of segments' images under every rotation and mirror image of an outline onto itself.

    The identity comes first. Of concentric circles alone, which every motion about their centre carries, it
    is the only one. Marks are those of :func:`find_rotations_onto_itself`.
    """
    images = [rotation.image for rotation in find_rotations_onto_itself(segments, marks)]
    outline = CenteredOutline.of(segments, marks)
    mirror = None if outline.first is None else match_mirror_image(outline, segments, marks)
    return images if mirror is None else [*images, *(image[mirror] for image in images)]


def is_own_mirror_image(segments: Sequence[Segment]) -> bool:
    """Whether an outline turned over looks as before, once it is turned round as well."""
    outline = CenteredOutline.of(segments)
    return outline.first is None or match_mirror_image(outline, segments) is not None


def match_mirror_image(
    outline: CenteredOutline, segments: Sequence[Segment], marks: Sequence[int] = ()
) -> NDArray[np.int64] | None:
    """Indices of segments' mirror images in an outline; None where no mirror image maps it onto itself."""
    mirrored = CenteredOutline.of([mirror_image(segment) for segment in segments], marks)
    found = (mirrored.image(outline, angle) for angle in mirrored.angles(outline).tolist())
    return next((image for image in found if image is not None), None)


def mirror_image(segment: Segment) -> Segment:
    """A segment reflected in the x axis, with the material on its left again."""

    def over(point: Point) -> Point:
        return point[0], -point[1]

    if isinstance(segment, Line):
        return Line(over(segment.end), over(segment.start))
    return evolve(segment, center=over(segment.center), mid_angle=-segment.mid_angle, rest=over(segment.rest))
