"""Rotations that carry an outline onto itself."""

from __future__ import annotations

from collections.abc import Sequence
from math import atan2, hypot, pi, tau

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.conventions import SAME_AFTER_TURN
from workhold.geometry.rotation import rotated
from workhold.geometry.segment import Arc, Line, Point, Segment

__all__ = ["Rotation", "rotations_onto_itself"]


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


def centroid_of_joints(segments: Sequence[Segment]) -> Point:
    """Mean of the segments' middles, each with its length's weight: a point every rotation onto itself keeps."""
    total = sum(s.length for s in segments)
    middles = [s.center if isinstance(s, Arc) and s.is_full else s.at(0.0) for s in segments]
    x = sum(s.length * m[0] for s, m in zip(segments, middles, strict=True)) / total
    y = sum(s.length * m[1] for s, m in zip(segments, middles, strict=True)) / total
    return x, y


def turned(point: Point, about: Point, angle: float) -> Point:
    """A point turned about another."""
    x, y = rotated(point[0] - about[0], point[1] - about[1], angle)
    return about[0] + x, about[1] + y


def near(p: Point, q: Point) -> bool:
    """Whether two points agree."""
    return hypot(p[0] - q[0], p[1] - q[1]) <= SAME_AFTER_TURN


def carries(a: Segment, b: Segment, about: Point, angle: float) -> bool:
    """Whether a rotation carries segment a onto segment b."""
    if isinstance(a, Line) and isinstance(b, Line):
        return near(turned(a.start, about, angle), b.start) and near(turned(a.end, about, angle), b.end)
    if isinstance(a, Arc) and isinstance(b, Arc):
        if abs(a.radius - b.radius) > SAME_AFTER_TURN or a.sign != b.sign or a.is_full != b.is_full:
            return False
        if not near(turned(a.center, about, angle), b.center):
            return False
        return a.is_full or (near(turned(a.start, about, angle), b.start) and near(turned(a.end, about, angle), b.end))
    return False


def rotations_onto_itself(segments: Sequence[Segment]) -> list[Rotation]:
    """All rotations that carry an outline, given by its faces, onto itself; the identity comes first.

    An outline of concentric circles alone turns onto itself at every angle; only the identity is returned for it.
    """
    about = centroid_of_joints(segments)
    identity = Rotation(0.0, np.arange(len(segments), dtype=np.int64))
    anchors = [k for k, s in enumerate(segments) if not near(anchor(s), about)]
    if not anchors:
        return [identity]
    first = anchors[0]
    start = anchor(segments[first])
    found = [identity]
    for k in anchors:
        end = anchor(segments[k])
        angle = atan2(end[1] - about[1], end[0] - about[0]) - atan2(start[1] - about[1], start[0] - about[0])
        angle = snapped(angle % tau, len(segments))
        if angle == 0.0 or any(abs(angle - r.angle) < 1e-9 for r in found):
            continue
        # The first segment tells of most angles that they cannot be.
        image = permutation(segments, about, angle) if carries(segments[first], segments[k], about, angle) else None
        if image is not None:
            found.append(Rotation(angle, image))
    return sorted(found, key=lambda rotation: rotation.angle)


def anchor(segment: Segment) -> Point:
    """A point that moves with a segment: its middle, or the centre of a whole circle."""
    return segment.center if isinstance(segment, Arc) and segment.is_full else segment.at(0.0)


def snapped(angle: float, count: int) -> float:
    """The whole fraction of a turn nearest to an angle: rotations onto itself form a cyclic group."""
    for order in range(1, count + 1):
        k = round(angle / tau * order)
        if abs(angle - k * tau / order) < 1e-6:
            return (k % order) * tau / order
    return angle % (2 * pi)


def permutation(segments: Sequence[Segment], about: Point, angle: float) -> NDArray[np.int64] | None:
    """Index of the segment each is carried to, or None when one has no image."""
    image = []
    for a in segments:
        k = next((j for j, b in enumerate(segments) if carries(a, b, about, angle)), None)
        if k is None:
            return None
        image.append(k)
    return np.array(image, dtype=np.int64)
