"""Rotation of vectors of the plane, and the rotations and mirror images that carry an outline onto itself.

The rotations form a cyclic group (as those of a bounded figure do; H. S. M. Coxeter, *Introduction to
Geometry*, 1969, section 2.7), so the smallest generates all others, and one mirror image with the rotations
all mirror images.
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
    "compute_centroid_of_segments",
    "is_own_mirror_image",
    "find_middle",
    "rotate_vectors",
    "find_rotations_onto_itself",
    "find_symmetries",
]


def rotate_vectors(x: Any, y: Any, angle: Any) -> tuple[Any, Any]:
    """Return the vectors turned counter-clockwise by angles in radians; numbers or arrays of matching shapes.

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
    """A rotation that carries an outline onto itself.

    Parameters
    ----------
    angle : counter-clockwise, in radians, in [0, 2 pi).
    image : (N,) index of the segment that each segment is carried to.
    """

    angle: float
    image: NDArray[np.int64]


def compute_centroid_of_segments(segments: Sequence[Segment]) -> Point:
    """Return the mean of the segments' middles, weighted by their lengths, in mm.

    Every rotation of the outline onto itself leaves this point in place.
    """
    total = sum(s.length for s in segments)
    middles = [find_middle(s) for s in segments]
    x = sum(s.length * m[0] for s, m in zip(segments, middles, strict=True)) / total
    y = sum(s.length * m[1] for s, m in zip(segments, middles, strict=True)) / total
    return x, y


def find_middle(segment: Segment) -> Point:
    """Return the middle of a segment, or the centre of a whole circle."""
    return segment.center if isinstance(segment, Arc) and segment.is_full else segment.compute_point(0.0)


@define(frozen=True, eq=False)
class CenteredOutline:
    """The N segments of an outline, relative to a point that rotations of the outline onto itself leave in
    place.

    Parameters
    ----------
    points : (N, 4, 2) for each segment four points in mm: anchor, start, end and centre. The anchor is the
        middle. For a whole circle all four are its centre; for a line the centre is the middle.
    kinds : (N, 3) signed radius (0 for a line), 1 for a whole circle, and the segment's mark.
    """

    points: Array
    kinds: Array

    @classmethod
    def from_segments(cls, segments: Sequence[Segment], marks: Sequence[int] = ()) -> CenteredOutline:
        """Return the outline of segments, relative to their centroid.

        ``marks`` has a number for each segment: no segment is the image of a segment with another mark. Empty
        for no marks.
        """
        points, kinds = [], []
        for s, mark in zip(segments, marks or [0] * len(segments), strict=True):
            if isinstance(s, Arc):
                points.append(
                    (s.center,) * 4 if s.is_full else (s.compute_point(0.0), s.start, s.end, s.center)
                )
                kinds.append((s.sign * s.radius, float(s.is_full), mark))
            else:
                points.append((s.compute_point(0.0), s.start, s.end, s.compute_point(0.0)))
                kinds.append((0.0, 0.0, mark))
        return cls(np.array(points) - compute_centroid_of_segments(segments), np.array(kinds))

    @cached_property
    def levels(self) -> tuple[Array, NDArray[np.int64]]:
        """The anchors sorted along one direction: (1) their coordinates (N,) ascending, (2) the indices (N,)
        of their segments.
        """
        level = self.points[:, 0] @ ALONG
        order = np.argsort(level, kind="stable")
        return level[order], order

    @property
    def first(self) -> int | None:
        """The index of the first segment whose anchor is not at the centroid; None if all are."""
        off_center = np.flatnonzero(np.hypot(*self.points[:, 0].T) > SAME_AFTER_TURN)
        return int(off_center[0]) if len(off_center) else None

    def list_candidate_angles(self, other: CenteredOutline) -> Array:
        """Return the rotations that could carry this outline onto ``other``, as angles (M,) in [0, 2 pi).

        They are the rotations that turn the anchor of segment ``first`` into the direction of an anchor of
        ``other``.
        """
        assert self.first is not None
        x, y = other.points[np.hypot(*other.points[:, 0].T) > SAME_AFTER_TURN, 0].T
        return np.asarray((np.arctan2(y, x) - np.arctan2(*self.points[self.first, 0, ::-1])) % tau)

    def find_image(self, other: CenteredOutline, angle: float) -> NDArray[np.int64] | None:
        """Return for each segment the index (N,) of the segment of ``other`` onto which a rotation carries
        it.

        ``angle`` is in radians. None where some segment has no image.
        """
        assert self.first is not None
        # One segment rules most angles out.
        one = self.find_images_of(other, angle, slice(self.first, self.first + 1))
        found = one if (one < 0).any() else self.find_images_of(other, angle, slice(None))
        return None if (found < 0).any() else found

    def find_images_of(self, other: CenteredOutline, angle: float, chosen: slice) -> NDArray[np.int64]:
        """Return for each of M chosen segments the index (M,) of the segment of ``other`` onto which a
        rotation carries it.

        ``angle`` is in radians. -1 where there is none.
        """
        points, kinds = self.points[chosen], self.kinds[chosen]
        turned = np.stack(rotate_vectors(points[..., 0], points[..., 1], angle), axis=-1)
        level, order = other.levels
        # The anchor of an image is within SAME_AFTER_TURN, and so is its level, as the direction is no longer
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
    """Return all rotations that carry an outline onto itself, the identity first, then ascending by angle.

    An outline of concentric circles alone has only the identity here.

    Parameters
    ----------
    segments : the faces of the outline.
    marks : one for each face, such as the number of its outline; faces only map to faces of the same mark.
    """
    outline = CenteredOutline.from_segments(segments, marks)
    rotations = [Rotation(0.0, np.arange(len(segments), dtype=np.int64))]
    if outline.first is None:
        return rotations
    angles = outline.list_candidate_angles(outline)
    orders = (n for n in range(len(segments), 1, -1) if np.abs(angles - tau / n).min() <= SAME_AFTER_TURN)
    found = ((order, outline.find_image(outline, tau / order)) for order in orders)
    order, generator = next(((order, image) for order, image in found if image is not None), (1, None))
    for k in range(1, order):
        assert generator is not None
        shared = gcd(k, order)
        rotations.append(Rotation(k // shared * tau / (order // shared), generator[rotations[-1].image]))
    return rotations


def find_symmetries(segments: Sequence[Segment], marks: Sequence[int] = ()) -> list[NDArray[np.int64]]:
    """Return all rotations and mirror images of an outline onto itself, each as an index array (N,).

    Entry k is the index of the segment onto which segment k is carried. The identity comes first, then the
    other rotations, then mirror images. For an outline of concentric circles alone, only the identity is
    returned. See :func:`find_rotations_onto_itself` for ``marks``.
    """
    images = [rotation.image for rotation in find_rotations_onto_itself(segments, marks)]
    outline = CenteredOutline.from_segments(segments, marks)
    mirror = None if outline.first is None else match_mirror_image(outline, segments, marks)
    return images if mirror is None else [*images, *(image[mirror] for image in images)]


def is_own_mirror_image(segments: Sequence[Segment]) -> bool:
    """Return whether an outline is symmetric about some axis."""
    outline = CenteredOutline.from_segments(segments)
    return outline.first is None or match_mirror_image(outline, segments) is not None


def match_mirror_image(
    outline: CenteredOutline, segments: Sequence[Segment], marks: Sequence[int] = ()
) -> NDArray[np.int64] | None:
    """Return one mirror image of an outline onto itself; None where there is none.

    It is given as the index (N,) of the segment onto which each segment is carried.
    """
    mirrored = CenteredOutline.from_segments([mirror_image(segment) for segment in segments], marks)
    found = (
        mirrored.find_image(outline, angle) for angle in mirrored.list_candidate_angles(outline).tolist()
    )
    return next((image for image in found if image is not None), None)


def mirror_image(segment: Segment) -> Segment:
    """Return a segment reflected in the x axis, with its direction reversed, so that the material stays on
    its left.
    """

    def mirror_point(point: Point) -> Point:
        return point[0], -point[1]

    if isinstance(segment, Line):
        return Line(mirror_point(segment.end), mirror_point(segment.start))
    return evolve(
        segment,
        center=mirror_point(segment.center),
        mid_angle=-segment.mid_angle,
        rest=mirror_point(segment.rest),
    )
