"""Closed loops of segments: construction from vertices, direction, checks, and faces.

Glossary
--------
vertices : (N, 3) rows x, y, bulge; segment k runs from vertex k to vertex k + 1, the last one back to vertex
    0.
joint : the common end of two neighbouring segments of a loop.
place : words that say where something is, such as ``loop 0, segment 3 (LINE 2F)``.
face : a run of neighbouring segments that continue the same line or the same circle.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import cached_property, partial
from math import atan2, cos, dist, pi, sin
from typing import TypeVar

import numpy as np
from attrs import define, evolve, frozen
from numpy.typing import ArrayLike, NDArray

from workhold.conventions import (
    MEETS_AGAIN,
    READING,
    SAME_CARRIER,
    SAME_DIRECTION,
    SHORTEST,
    STRAIGHT,
    TOUCHING,
    WHOLE,
)
from workhold.errors import InputError
from workhold.geometry.segment import (
    Arc,
    Line,
    Segment,
    compute_bounding_box,
    find_common_points,
    make_segment_from_bulge,
    make_segment_rows,
)
from workhold.kernels.base.distance import measure_winding
from workhold.limits import MOST_COMPARED, MOST_LENGTH, MOST_RADIUS, make_real_array

__all__ = [
    "ComparisonBudget",
    "Face",
    "LoopShape",
    "check_vertices",
    "encloses",
    "list_loop_faces",
    "make_loop_segments",
    "find_near_pairs",
    "refuse_meeting",
    "refuse_meeting_loops",
    "refuse_no_area",
    "refuse_self_crossing",
    "reverse_vertices",
    "cut_into_runs",
    "compute_signed_area",
]

Place = Callable[[int], str]
Item = TypeVar("Item")


class ComparisonBudget:
    """A limit on the number of pairs of segments and loops of a part that are compared.

    Parameters
    ----------
    part : name of the part in the error's message.
    most : how many pairs there may be.
    """

    def __init__(self, part: str, most: int = MOST_COMPARED) -> None:
        self.part = part
        self.most = self.left = most

    def spend(self, pairs: int) -> None:
        """Subtract a number of pairs from the pairs that may still be compared.

        Raises
        ------
        InputError
            Where fewer than 0 are left.
        """
        self.left -= pairs
        if self.left < 0:
            raise InputError(
                f"{self.part} has more than {self.most:,} pairs of segments that come near each other, too "
                "many to compare: draw its outline with fewer segments."
            )


@define(frozen=True, slots=False, eq=False)
class LoopShape:
    """A loop's segments, with bounds for quick comparison with other loops.

    Parameters
    ----------
    segments : in running order; the loop may run either way round.
    boxes : (N, 4) bounding boxes of the segments: smallest x and y, largest x and y, in mm.
    """

    segments: tuple[Segment, ...]
    boxes: NDArray[np.float64]

    @classmethod
    def from_segments(cls, segments: Sequence[Segment]) -> LoopShape:
        """Return the shape of a closed chain of segments."""
        return cls(tuple(segments), np.array([compute_bounding_box(segment) for segment in segments]))

    @cached_property
    def rows(self) -> NDArray[np.float64]:
        """Kernel rows of the segments, shape (N, 10)."""
        return make_segment_rows(self.segments)

    @cached_property
    def chords(self) -> NDArray[np.float64]:
        """For each segment its start x, y, its end x, y, and its largest distance from its chord (N, 5), in
        mm.
        """
        return np.array(
            [(*segment.start, *segment.end, measure_depth(segment)) for segment in self.segments]
        ).reshape(-1, 5)

    @cached_property
    def box(self) -> NDArray[np.float64]:
        """Bounding box (4,) of the loop: smallest x and y, largest x and y, in mm."""
        return np.concatenate([self.boxes[:, :2].min(axis=0), self.boxes[:, 2:].max(axis=0)])


def check_vertices(vertices: ArrayLike, loop: str, place: Place) -> NDArray[np.float64]:
    """Return a checked, read-only copy of the vertices of one loop, with nearly straight arcs made lines.

    Parameters
    ----------
    vertices : (N, 3) array-like of x, y in mm and bulge.
    loop : name of the loop, for messages.
    place : returns the name of segment k, for messages.

    Returns
    -------
    (N, 3) array, read-only. Bulges below ``STRAIGHT``, and bulges of arcs that rise less than ``READING`` mm
    from their chords, are 0.

    Raises
    ------
    InputError
        For a wrong shape, NaN, infinite and far too large numbers, zero-length segments, or too few segments
        to enclose anything.
    """
    no_list = f"{loop} is not a list of [x, y, bulge] numbers: give three numbers for every vertex."
    try:
        array = make_real_array(vertices, f"{loop}: a coordinate")
    except InputError:
        raise
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(no_list) from error
    if array.ndim != 2 or array.shape[1] != 3:
        raise InputError(no_list)
    bad = np.flatnonzero(~np.isfinite(array).all(axis=1))
    if bad.size:
        raise InputError(
            f"{place(int(bad[0]))} has a coordinate or bulge that is not a finite number: correct it."
        )
    if len(array) < 2 or (len(array) == 2 and not array[:, 2].any()):
        raise InputError(
            f"{loop} has too few segments to enclose an area: it needs three lines, or two segments with an "
            "arc."
        )
    far = np.flatnonzero((np.abs(array[:, :2]) > MOST_LENGTH).any(axis=1))
    if far.size:
        k = int(far[0])
        raise InputError(
            f"{place(k)} has a coordinate beyond {MOST_LENGTH:g} mm, at ({array[k, 0]:g}, {array[k, 1]:g}): "
            "check the numbers and the unit, and draw the part near the origin."
        )
    steps = np.hypot(*(np.roll(array[:, :2], -1, axis=0) - array[:, :2]).T)
    short = np.flatnonzero(steps < SHORTEST)
    if short.size:
        k = int(short[0])
        raise InputError(
            f"{place(k)} has zero length at ({array[k, 0]:.6g}, {array[k, 1]:.6g}): remove the doubled "
            "vertex (a full circle is drawn as two halves)."
        )
    refuse_large_radius(array, steps, place)
    array[~is_curved(array[:, 2], steps), 2] = 0.0
    array.setflags(write=False)
    return array


def is_curved(bulge: NDArray[np.float64], steps: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return for each of N segments whether it is noticeably an arc: its rise above the chord is not
    negligible.

    ``bulge`` (N,) is tan(sweep / 4), ``steps`` (N,) are the chords in mm. The rise is bulge * chord / 2.
    """
    size = np.abs(bulge)
    return (size * steps / 2.0 >= READING) & (size >= STRAIGHT)


def refuse_large_radius(array: NDArray[np.float64], steps: NDArray[np.float64], place: Place) -> None:
    """Raise InputError, with the name of the place, where an arc's radius is too large.

    ``array`` (N, 3) are the vertices of a loop, ``steps`` (N,) the chords in mm.
    """
    bulge = np.minimum(np.abs(array[:, 2]), 1e30)
    curved = is_curved(bulge, steps)
    radius = np.where(curved, steps * (bulge + 1.0 / np.where(curved, bulge, 1.0)) / 4.0, 0.0)
    for k in np.flatnonzero(radius > np.where(bulge > 1.0, MOST_LENGTH, MOST_RADIUS))[:1]:
        most = MOST_LENGTH if bulge[k] > 1.0 else MOST_RADIUS
        raise InputError(
            f"{place(int(k))} is an arc of radius {radius[k]:.3g} mm (bulge {array[k, 2]:g}), beyond "
            f"{most:g} mm: check the bulge, or draw a line."
        )


def make_loop_segments(vertices: NDArray[np.float64]) -> tuple[Segment, ...]:
    """Return the segments of a loop of (N, 3) vertices; the last one ends at the first vertex."""
    points = [(float(x), float(y)) for x, y in vertices[:, :2]]
    ends = points[1:] + points[:1]
    return tuple(
        make_segment_from_bulge(p, q, float(b)) for p, q, b in zip(points, ends, vertices[:, 2], strict=True)
    )


def compute_signed_area(segments: Sequence[Segment]) -> float:
    """Return the area in mm² of a loop, positive counter-clockwise (shoelace formula plus circular segments)."""
    area = 0.0
    for segment in segments:
        (x0, y0), (x1, y1) = segment.start, segment.end
        area += (x0 * y1 - x1 * y0) / 2
        if isinstance(segment, Arc):
            area += segment.sign * segment.radius**2 * compute_circular_segment(2 * segment.half_sweep) / 2
    return area


def compute_circular_segment(sweep: float) -> float:
    """Return sweep - sin(sweep) for a sweep in radians, also for small sweeps without loss of digits."""
    if sweep > 0.1:
        return sweep - sin(sweep)
    square = sweep * sweep
    return sweep * square / 6 * (1 - square / 20 * (1 - square / 42 * (1 - square / 72)))


def reverse_vertices(vertices: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the vertices (N, 3) of the same loop run the other way round, from the same first vertex;
    read-only.
    """
    out = np.empty_like(vertices)
    order = np.concatenate(([0], np.arange(len(vertices) - 1, 0, -1)))
    out[:, :2] = vertices[order, :2]
    out[:, 2] = 0.0 - vertices[np.roll(order, -1), 2]
    out.setflags(write=False)
    return out


def refuse_no_area(shape: LoopShape, loop: str) -> None:
    """Raise InputError for a loop that encloses no area; ``loop`` is its name in the message."""
    if abs(compute_signed_area(shape.segments)) <= TOUCHING * sum(
        segment.length for segment in shape.segments
    ):
        raise InputError(f"{loop} encloses no area, it runs back along itself: draw the outline of the part.")


def find_near_pairs(boxes_a: NDArray[np.float64], boxes_b: NDArray[np.float64]) -> Iterator[tuple[int, int]]:
    """Yield pairs of indices (i, j) where box i of ``boxes_a`` and box j of ``boxes_b`` overlap or nearly
    touch.

    Boxes (N, 4) are smallest x and y, largest x and y, in mm.
    """
    for i, (x0, y0, x1, y1) in enumerate(boxes_a):
        apart = (
            (boxes_b[:, 0] > x1 + TOUCHING)
            | (boxes_b[:, 2] < x0 - TOUCHING)
            | (boxes_b[:, 1] > y1 + TOUCHING)
            | (boxes_b[:, 3] < y0 - TOUCHING)
        )
        for j in np.flatnonzero(~apart):
            yield i, int(j)


def measure_depth(segment: Segment) -> float:
    """Return the largest distance in mm of a segment from its chord; 0 for a line."""
    return segment.radius * (1 - cos(segment.half_sweep)) if isinstance(segment, Arc) else 0.0


# With more near segments than this, chords are compared first.
MANY_NEAR = 32


def find_near_segments(
    one: LoopShape, k: int, others: LoopShape, comparisons: ComparisonBudget
) -> NDArray[np.int64]:
    """Return the indices of the segments of ``others`` that may touch segment ``k`` of ``one``.

    Others are excluded by their bounding boxes and, where many boxes overlap, because they lie wholly on one
    side of the chord of segment ``k``. The remaining pairs are subtracted from ``comparisons``.
    """
    x0, y0, x1, y1 = one.boxes[k]
    boxes = others.boxes
    apart = (
        (boxes[:, 0] > x1 + TOUCHING)
        | (boxes[:, 2] < x0 - TOUCHING)
        | (boxes[:, 1] > y1 + TOUCHING)
        | (boxes[:, 3] < y0 - TOUCHING)
    )
    found = np.flatnonzero(~apart)
    if len(found) > MANY_NEAR:
        (px, py, qx, qy, depth), chords = one.chords[k], others.chords[found]
        length = float(np.hypot(qx - px, qy - py))
        if length >= SHORTEST:
            ux, uy = (qx - px) / length, (qy - py) / length
            first = ux * (chords[:, 1] - py) - uy * (chords[:, 0] - px)
            last = ux * (chords[:, 3] - py) - uy * (chords[:, 2] - px)
            reach = depth + chords[:, 4] + TOUCHING
            found = found[(np.minimum(first, last) <= reach) & (np.maximum(first, last) >= -reach)]
    comparisons.spend(len(found))
    return found


def refuse_self_crossing(shape: LoopShape, place: Place, comparisons: ComparisonBudget | None = None) -> None:
    """Raise InputError for a loop that crosses or touches itself anywhere but at its joints.

    Raises
    ------
    InputError
        Naming both segments and the point; also for more comparisons than may be made.
    """
    comparisons = comparisons or ComparisonBudget("the outline")
    segments, box = shape.segments, shape.boxes
    count = len(segments)
    # Tangent neighbours meet again within rounding of their joint; that is not a crossing.
    backward_error = max(*(MEETS_AGAIN * float(np.ptp(box[:, ends])) for ends in ([0, 2], [1, 3])), TOUCHING)
    for i in range(count):
        for j in find_near_segments(shape, i, shape, comparisons).tolist():
            if j <= i:
                continue
            joints = [segments[k].end for k, after in ((i, j), (j, i)) if (k + 1) % count == after]
            for x, y in find_common_points(segments[i], segments[j], TOUCHING):
                if all(dist((x, y), joint) > backward_error for joint in joints):
                    raise InputError(
                        f"{place(i)} and {place(j)} cross or touch at ({x:.6g}, {y:.6g}): an outline may "
                        "meet itself only where one segment ends and the next begins."
                    )


def refuse_meeting_loops(
    a: LoopShape, b: LoopShape, place_a: Place, place_b: Place, comparisons: ComparisonBudget | None = None
) -> None:
    """Raise InputError for two loops that cross or touch.

    Raises
    ------
    InputError
        Naming both segments and the point; also for more comparisons than may be made.
    """
    comparisons = comparisons or ComparisonBudget("the outline")
    for i in range(len(a.segments)):
        for j in find_near_segments(a, i, b, comparisons).tolist():
            for x, y in find_common_points(a.segments[i], b.segments[j], TOUCHING):
                raise InputError(
                    f"{place_a(i)} and {place_b(j)} cross or touch at ({x:.6g}, {y:.6g}): loops must stay "
                    "apart from each other; trim both where they cross, or leave one out."
                )


def refuse_meeting(
    shapes: Sequence[LoopShape], place: Callable[[int, int], str], comparisons: ComparisonBudget
) -> None:
    """Raise InputError if any two of the loops cross or touch.

    Parameters
    ----------
    place : returns the name of a loop's segment, from both indices.
    comparisons : the pairs that may be compared, from which each compared pair is subtracted in place.

    Raises
    ------
    InputError
        Naming both segments and the point; also for more comparisons than are allowed.
    """
    boxes = np.array([shape.box for shape in shapes])
    for a, b in find_near_pairs(boxes, boxes):
        comparisons.spend(1)
        if a < b:
            refuse_meeting_loops(shapes[a], shapes[b], partial(place, a), partial(place, b), comparisons)


def encloses(around: LoopShape, inner: LoopShape) -> bool:
    """Return whether the loop ``around`` encloses the loop ``inner``.

    The two must not meet. Either may run clockwise or counter-clockwise.
    """
    x, y = inner.segments[0].start
    return bool(abs(measure_winding(x, y, around.rows)) > pi)


def have_same_carrier(a: Segment, b: Segment) -> bool:
    """Return whether segment ``b``, next to segment ``a``, continues the line or circle of ``a`` in the same
    direction.
    """
    if isinstance(a, Line) and isinstance(b, Line):
        (tx, ty), (ux, uy) = a.tangent, b.tangent
        dx, dy = b.start[0] - a.start[0], b.start[1] - a.start[1]
        return abs(tx - ux) + abs(ty - uy) < SAME_DIRECTION and abs(dx * ty - dy * tx) < SAME_CARRIER
    if isinstance(a, Arc) and isinstance(b, Arc):
        return (
            dist(a.center, b.center) < SAME_CARRIER
            and abs(a.radius - b.radius) < SAME_CARRIER
            and a.sign == b.sign
        )
    return False


# A whole circle has no joint, yet its parameter must start somewhere: at a direction no drawing is likely to
# use.
SEAM_ANGLE = 2.2360679775 + pi


@frozen
class Face:
    """A straight or circular side of the workpiece.

    Parameters
    ----------
    number : the smallest number among its segments, which names the face.
    segments : numbers of its segments, in running order.
    segment : the whole face as one segment.
    """

    number: int
    segments: tuple[int, ...]
    segment: Segment


def merge_run(run: Sequence[Segment]) -> Segment:
    """Return one segment that replaces neighbouring segments on one line or circle."""
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


def cut_into_runs(items: Sequence[Item], continues: Callable[[Item, Item], bool]) -> list[list[Item]]:
    """Return a cyclic sequence cut into runs; within a run each item continues the item before it.

    ``continues(before, item)`` decides that. The first run starts at the first item that does not continue
    the item before it, or at index 0 where all items do.
    """
    first = next((k for k in range(len(items)) if not continues(items[k - 1], items[k])), 0)
    runs: list[list[Item]] = []
    for item in (*items[first:], *items[:first]):
        if runs and continues(runs[-1][-1], item):
            runs[-1].append(item)
        else:
            runs.append([item])
    return runs


def list_loop_faces(
    segments: Sequence[Segment], first_number: int, marks: Sequence[object] | None = None
) -> list[Face]:
    """Return the faces of one loop in ascending order of their numbers.

    ``first_number`` is the number of the loop's first segment; the other segments are numbered on from it.

    Parameters
    ----------
    marks : one for each segment; a face does not extend over different marks. None for no marks.
    """

    def continues(one: int, other: int) -> bool:
        return have_same_carrier(segments[one], segments[other]) and (
            marks is None or marks[one] == marks[other]
        )

    faces = []
    for run in cut_into_runs(range(len(segments)), continues):
        numbers = tuple(first_number + k for k in run)
        faces.append(Face(min(numbers), numbers, merge_run([segments[k] for k in run])))
    return sorted(faces, key=lambda face: face.number)
