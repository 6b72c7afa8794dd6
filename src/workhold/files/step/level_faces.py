"""The level faces of a standing solid that supports and a clamp on top may touch.

Where the border of a face has a curve that is neither line nor arc, such as the mouth of a bore aslant, lines
stand in its place that leave all of the curve's other side out. A rational Bézier curve lies in the convex hull
of its control points, so the side of the hull that lies in the face does for each short piece of it: a chord
where the curve bends about the face, tangents where it bends away from it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from math import dist, hypot, pi, tan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from workhold.conventions import ALIGNED, SAME_HEIGHT, SHORTEST
from workhold.errors import InputError
from workhold.files.outline.chain import Chain
from workhold.files.outline.joining import closed_loop
from workhold.files.step.edge_curves import EdgeCurve
from workhold.files.step.faces import SLOPING, SolidFace
from workhold.files.step.heights import StandingSolid
from workhold.files.step.regions import borders, level_region
from workhold.geometry.loop import checked_vertices, loop_segments, reversed_vertices, signed_area
from workhold.geometry.rational import Pieces, cut, point_at, points_along
from workhold.geometry.segment import Line, Point, Segment, segment_rows
from workhold.geometry.subdivision import BorderPiece, border_loops, border_pieces, subdivide
from workhold.kernels.base.distance import is_inside, outline_distances

__all__ = ["bottom_loops", "known_levels", "top_loops"]

Array = NDArray[np.float64]
Box = tuple[float, float, float, float]
# Points across a face, each way, at which what lies above it is asked for, and where nothing there is round;
# along an edge; how far from the face's border, in mm.
ACROSS, ACROSS_FLAT, ALONG, OFF = 12, 4, 33, 1e-3
# How far in mm lines may be from a curve that they stand for, and how many of them, at most.
SAFE, MOST_LINES = 0.02, 4_000
# mm. A point nearer to a line lies on it.
STRAIGHT_ON = 1e-9


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
        lambda points: [any(is_inside(*point, rows) for rows in inside) for point in points],
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
    """Loops of a level face; of curves that are neither line nor arc what surely belongs to it.

    None where the border cannot be read, and where lines in the place of its curves would cross others.
    """
    try:
        edges = borders(level_region(face.shape, face.low, face.upward))
        if not all(one.is_disguise for one in edges.curves.values()):
            # The section has curves of its own near the face's, which are exact.
            edges = borders(face.shape)
        chains = [closed_loop(chain).vertices for chain in edges.chains]
    except InputError:
        return []
    order = sorted(range(len(chains)), key=lambda k: -abs(signed_area(loop_segments(chains[k]))))
    loops = []
    for number, k in enumerate(order):
        is_turned = (signed_area(loop_segments(chains[k])) > 0) != (number == 0)
        true = {label: one.pieces for label, one in edges.curves.items() if not one.is_disguise}
        if not true.keys().isdisjoint(edges.chains[k].labels):
            try:
                loops.append(safe_loop(edges.chains[k], true, is_turned))
            except InputError:
                return []
        else:
            loops.append(reversed_vertices(chains[k]) if is_turned else chains[k])
    return loops


def safe_loop(chain: Chain, curves: Mapping[str, Pieces], is_turned: bool) -> Array:
    """Vertices (N, 3) of a face's border with safe lines in the place of its curves, the face on the left.

    Parameters
    ----------
    chain : the border with some lines and arcs in their place.
    curves : the pieces of each by its label.
    is_turned : whether the chain has the face on its right.

    Raises InputError where the lines cross each other or another segment.
    """
    vertices: list[tuple[float, float, float]] = []
    count = len(chain.bulges)
    done: set[str] = set()
    for k in range(count):
        label = chain.labels[k]
        if label not in curves:
            vertices.append((*chain.points[k], chain.bulges[k]))
        elif label not in done:
            done.add(label)
            run = [chain.points[m] for m in range(count) if chain.labels[m] == label]
            pieces = curves[label]
            points = safe_points(pieces, runs_back(pieces, run), is_turned)
            vertices += [(x, y, 0.0) for x, y in points[:-1]]
    loop = np.array(vertices)
    loop = reversed_vertices(loop) if is_turned else loop
    return checked_vertices(loop.tolist(), "face", "face, side {}".format)


def runs_back(pieces: Pieces, run: Sequence[Point]) -> bool:
    """Whether points along a curve run from its end to its start."""
    start, end = point_at(pieces, 0.0), point_at(pieces, float(len(pieces)))
    if dist(start, end) > SHORTEST:
        return dist(run[0], end) < dist(run[0], start)
    return (enclosed(points_along(pieces, 8)) > 0) != (enclosed(np.array(run)) > 0)


def enclosed(points: Array) -> float:
    """The area in mm² within points (N, 2) in running order, positive where that is counter-clockwise."""
    x, y = points.T
    return float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) / 2


def safe_points(pieces: Pieces, is_back: bool, is_turned: bool) -> list[Point]:
    """Points of lines that leave all of the face's other side out, in the direction that a curve is run.

    Parameters
    ----------
    pieces : of the curve.
    is_back : whether it is run from its end to its start.
    is_turned : whether the face is on the right of the run.

    Raises InputError for a curve of which no part is near to its chord.
    """
    side = 1.0 if is_back == is_turned else -1.0
    found = [point_at(pieces, 0.0)]
    waiting = [pieces[k : k + 1] for k in reversed(range(len(pieces)))]
    while waiting:
        piece = waiting.pop()
        points = safe_chain(piece[0], side)
        if points is not None:
            found += points
        elif len(found) + len(waiting) > MOST_LINES:
            raise InputError("a curve of a level face bends too sharply.")
        else:
            waiting += [cut(piece, 0.5, 1.0), cut(piece, 0.0, 0.5)]
    kept = found[:1]
    for point, following in pairwise(found[1:]):
        # Two tangents of a smooth curve are one line where they meet.
        if not is_between(kept[-1], point, following):
            kept.append(point)
    kept.append(found[-1])
    return kept[::-1] if is_back else kept


def is_between(start: Point, point: Point, end: Point) -> bool:
    """Whether a point lies on the line between two others, within rounding."""
    dx, dy = end[0] - start[0], end[1] - start[1]
    across = (point[0] - start[0]) * dy - (point[1] - start[1]) * dx
    return abs(across) <= STRAIGHT_ON * hypot(dx, dy)


def safe_chain(piece: Array, side: float) -> list[Point] | None:
    """The points after the first of lines for a piece; None where they would be too far from it.

    They are corners of the convex hull of its control points, of which the piece never runs out.

    Parameters
    ----------
    side : 1 where the face is on the left of the piece's own direction, else -1.
    """
    control = piece[:, :2] / piece[:, 2:]
    chord = control[-1] - control[0]
    size = hypot(*chord)
    if size <= SHORTEST:
        return [] if float(np.hypot(*(control - control[0]).T).max()) <= SHORTEST else None
    tx, ty = chord / size
    x, y = (control - control[0]).T
    along, off = x * tx + y * ty, side * (y * tx - x * ty)
    if np.abs(off).max() > SAFE or (np.diff(along) < 0.0).any():
        return None
    # The hull's side that lies in the face (A. M. Andrew, *Another efficient algorithm for convex hulls in two
    # dimensions*, Information Processing Letters 9 (1979)).
    hull: list[int] = []
    for k in range(len(control)):
        while len(hull) > 1 and (along[hull[-1]] - along[hull[-2]]) * (off[k] - off[hull[-2]]) >= (
            off[hull[-1]] - off[hull[-2]]
        ) * (along[k] - along[hull[-2]]):
            hull.pop()
        hull.append(k)
    return [(float(control[k, 0]), float(control[k, 1])) for k in hull[1:]]


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
