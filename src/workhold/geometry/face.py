"""Faces: runs of neighbouring segments that continue the same line or the same circle."""

from __future__ import annotations

from collections.abc import Sequence
from math import atan2, pi

from attrs import evolve, frozen

from workhold.conventions import WHOLE
from workhold.geometry.loop import same_carrier
from workhold.geometry.segment import Arc, Line, Segment

__all__ = ["Face", "faces_of_loop"]

# A whole circle has no joint, yet its parameter must start somewhere: at a direction no drawing is likely to use.
SEAM_ANGLE = 2.2360679775 + pi


@frozen
class Face:
    """A straight or circular side of the workpiece.

    Parameters
    ----------
    number : the smallest number among its segments; it names the face.
    segments : the numbers of its segments, in running order.
    segment : the whole face as one segment.
    """

    number: int
    segments: tuple[int, ...]
    segment: Segment


def merged(run: Sequence[Segment]) -> Segment:
    """One segment for a run of segments of the same line or circle."""
    first = run[0]
    if len(run) == 1:
        return first
    if isinstance(first, Line):
        return Line(first.start, run[-1].end)
    half_sweep = sum(s.half_sweep for s in run if isinstance(s, Arc))
    if half_sweep > pi - WHOLE:
        return Arc(first.center, first.radius, SEAM_ANGLE - pi, pi, first.sign)
    start = atan2(first.start[1] - first.center[1], first.start[0] - first.center[0])
    return evolve(first, mid_angle=start + first.sign * half_sweep, half_sweep=half_sweep)


def faces_of_loop(segments: Sequence[Segment], first_number: int) -> list[Face]:
    """Faces of one loop whose segments are numbered from ``first_number``; ordered by their numbers."""
    count = len(segments)
    starts = [k for k in range(count) if not same_carrier(segments[k - 1], segments[k])] or [0]
    faces = []
    for position, start in enumerate(starts):
        stop = starts[position + 1] if position + 1 < len(starts) else starts[0] + count
        run = [k % count for k in range(start, stop)]
        numbers = tuple(first_number + k for k in run)
        faces.append(Face(min(numbers), numbers, merged([segments[k] for k in run])))
    return sorted(faces, key=lambda face: face.number)
