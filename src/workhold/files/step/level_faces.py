"""The level faces of a standing solid that supports and a clamp on top may touch."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi, tan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from workhold.conventions import ALIGNED, SAME_HEIGHT
from workhold.errors import InputError
from workhold.files.outline.joining import closed_loop
from workhold.files.step.edge_curves import EdgeCurve
from workhold.files.step.faces import SLOPING, SolidFace
from workhold.files.step.heights import StandingSolid
from workhold.files.step.regions import borders, level_region
from workhold.geometry.loop import loop_segments, reversed_vertices, signed_area
from workhold.geometry.segment import Line, Point, Segment, segment_rows
from workhold.geometry.subdivision import BorderPiece, border_loops, border_pieces, subdivide
from workhold.kernels.base.distance import is_inside, outline_distances

__all__ = ["bottom_loops", "known_levels", "top_loops"]

Array = NDArray[np.float64]
Box = tuple[float, float, float, float]
# Points across a face, each way, at which what lies above it is asked for, and where nothing there is round;
# along an edge; how far from the face's border, in mm.
ACROSS, ACROSS_FLAT, ALONG, OFF = 12, 4, 33, 1e-3


def known_levels(solid: StandingSolid) -> dict[str, list[Any]]:
    """The level faces of a solid by the names that ``SolidOutline`` has for them."""
    top = top_loops(solid)
    return {
        "bottom": [loop.tolist() for loop in bottom_loops(solid)],
        "top": [loop.tolist() for loop, _ in top],
        "top_heights": [height for _, height in top],
    }


def bottom_loops(solid: StandingSolid) -> list[Array]:
    """Loops (N, 3) of the faces on which the part lies: outer ones counter-clockwise, openings clockwise."""
    lying = [
        face for face in solid.faces if face.lie == "level" and not face.upward and face.low <= SAME_HEIGHT
    ]
    return joined([loops_of(face) for face in lying])


def top_loops(solid: StandingSolid) -> list[tuple[Array, float]]:
    """Loops (N, 3) of level faces with nothing of the solid above them, each with its height in mm.

    Faces of one height that lie side by side are one face; those of other heights stay faces of their own.
    """
    found: list[tuple[float, list[list[Array]]]] = []
    for face in solid.faces:
        if face.lie == "level" and face.upward:
            loops = loops_of(face)
            if loops and is_free(solid, face, loops):
                level = next((faces for z, faces in found if abs(z - face.low) <= SAME_HEIGHT), None)
                if level is None:
                    found.append((face.low, [loops]))
                else:
                    level.append(loops)
    return [(loop, height) for height, faces in found for loop in joined(faces)]


def joined(faces: Sequence[Sequence[Array]]) -> list[Array]:
    """Loops (N, 3) of level faces of one height, without the edges along which they touch.

    CAD programs split a face where a line was once imprinted on it. One face stays as it is.
    """
    kept = [loops for loops in faces if loops]
    if len(kept) < 2:
        return [loop for loops in kept for loop in loops]
    inside = [segment_rows(segments_of(loops)) for loops in kept]
    pieces = border_pieces(
        subdivide(segment for loops in kept for segment in segments_of(loops)),
        lambda point: any(is_inside(*point, rows) for rows in inside),
    )
    return [smoothed(loop) for loop in border_loops(pieces)]


def segments_of(loops: Sequence[Array]) -> list[Segment]:
    """All segments of some loops."""
    return [segment for loop in loops for segment in loop_segments(loop)]


def smoothed(loop: Sequence[BorderPiece]) -> Array:
    """Vertices (N, 3) of a border's loop, where pieces that continue one line or half a circle are one."""
    first = next((k for k in range(len(loop)) if not continues(loop[k - 1], loop[k])), 0)
    runs: list[list[BorderPiece]] = []
    for piece in [*loop[first:], *loop[:first]]:
        if runs and continues(runs[-1][-1], piece) and sweep([*runs[-1], piece]) <= pi + ALIGNED:
            runs[-1].append(piece)
        else:
            runs.append([piece])
    return np.array([(*run[0].start, tan(sweep(run) / 4) * (1 if run[0].forward else -1)) for run in runs])


def continues(before: BorderPiece, after: BorderPiece) -> bool:
    """Whether a piece goes on along the same line or circle."""
    return before.carrier is after.carrier and before.forward == after.forward


def sweep(run: Sequence[BorderPiece]) -> float:
    """The angle over which pieces of one circle run, in radians; 0 on a line."""
    if isinstance(run[0].carrier.segment, Line):
        return 0.0
    return sum(piece.high - piece.low for piece in run)


def loops_of(face: SolidFace) -> list[Array]:
    """Loops of a level face; none where its border is not made of lines and arcs alone."""
    try:
        edges = borders(level_region(face.shape, face.low, face.upward))
    except InputError:
        return []
    if not all(one.is_disguise for one in edges.curves.values()):
        return []
    loops = [closed_loop(chain).vertices for chain in edges.chains]
    loops.sort(key=lambda loop: -abs(signed_area(loop_segments(loop))))
    return [
        loop if (signed_area(loop_segments(loop)) > 0) == (number == 0) else reversed_vertices(loop)
        for number, loop in enumerate(loops)
    ]


def is_free(solid: StandingSolid, face: SolidFace, loops: Sequence[Array]) -> bool:
    """Whether nothing of a solid lies above a level face: no edge passes over it, nor material."""
    above = [one for one in solid.faces if one.high > face.low + SAME_HEIGHT and overlap(one.box, face.box)]
    if not above:
        return True
    rows = segment_rows(segments_of(loops))
    boxes, (x0, y0, x1, y1) = solid.edge_boxes, face.box
    higher = (boxes[:, 4] > face.low + SAME_HEIGHT) & (boxes[:, 0] <= x1) & (boxes[:, 1] <= y1)
    higher &= (boxes[:, 2] >= x0) & (boxes[:, 3] >= y0)
    points = [points_over(solid.edges[k], face) for k in np.flatnonzero(higher)]
    over = np.concatenate([np.zeros((0, 2)), *points])
    if len(within(over, rows)):
        return False
    # What has neither an edge nor a fold over the face covers all of it or nothing.
    is_round = any(one.lie == "leaning" and one.kind != SLOPING for one in above)
    count = ACROSS if is_round else ACROSS_FLAT
    shares = (np.arange(count) + 0.37) / count
    grid = np.stack(np.meshgrid(x0 + shares * (x1 - x0), y0 + shares * (y1 - y0)), axis=-1).reshape(-1, 2)
    inner = [beside(segment) for loop in loops for segment in loop_segments(loop)]
    return all(
        max((end for _, end in solid.material.intervals((float(x), float(y)))), default=0.0)
        <= face.low + SAME_HEIGHT
        for x, y in within(np.concatenate([grid, np.array(inner)]), rows)
    )


def beside(segment: Segment) -> Point:
    """A point near the middle of a segment, on its left."""
    (x, y), (nx, ny) = segment.at(0.0), segment.normal(0.0)
    return x - 3 * OFF * nx, y - 3 * OFF * ny


def overlap(a: Box, b: Box) -> bool:
    """Whether two boxes have more than a border in common."""
    return a[0] < b[2] - OFF and b[0] < a[2] - OFF and a[1] < b[3] - OFF and b[1] < a[3] - OFF


def points_over(edge: EdgeCurve, face: SolidFace) -> Array:
    """Points (N, 2) of an edge that lie higher than a level face and within its box."""
    points = edge.points
    if len(points) == 2:
        points = points[0] + np.linspace(*clipped(points[0], points[1], face.box), ALONG)[:, None] * (
            points[1] - points[0]
        )
    x, y, z = points.T
    x0, y0, x1, y1 = face.box
    return points[(z > face.low + SAME_HEIGHT) & (x >= x0) & (x <= x1) & (y >= y0) & (y <= y1), :2]


def clipped(start: Array, end: Array, box: Box) -> tuple[float, float]:
    """The shares of a straight edge between which it lies in a box; all of it where it does nowhere.

    Reference: Y.-D. Liang and B. A. Barsky, *A new concept and method for line clipping*, ACM Transactions on
    Graphics 3 (1984).
    """
    low, high = 0.0, 1.0
    for axis in (0, 1):
        step = float(end[axis] - start[axis])
        if step != 0.0:
            ends = sorted((box[axis + side] - float(start[axis])) / step for side in (0, 2))
            low, high = max(low, ends[0]), min(high, ends[1])
    return (low, high) if low < high else (0.0, 1.0)


def within(points: Array, rows: Array) -> Array:
    """Points (N, 2) that lie on a face, farther than rounding from its border."""
    if not len(points):
        return points
    inside = np.array([bool(is_inside(x, y, rows)) for x, y in points.tolist()])
    return points[inside & (outline_distances(np.ascontiguousarray(points), rows) > OFF)]
