"""Convex hulls: of points, and the hull edges of an outline, on which it can lie flush.

Hull edges are the straight pieces of the boundary of an outline's convex hull. Each is a common tangent of
two corners, of a corner and a convex arc, or of two convex arcs, and the whole outline is on its left. All
pairs are examined, so none is missed. A tangent that lies on another one, within the rounding of a drawing,
is the same edge, which may run over several faces and the gaps between them.

Glossary
--------
support : the extent of an outline in a direction: the largest scalar product of a point with the unit vector.
piece : a joint of two faces, or a convex arc; it is outermost in the directions of its normals.
end : an end of a hull edge: a corner, the end of a face that lies along it, or the point where an arc leaves
    it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from math import dist

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from workhold.conventions import LEAST_HULL_EDGE, TOUCHING
from workhold.geometry.segment import Arc, Line, Point, Segment

__all__ = ["HullEdge", "HullEnd", "HullTouch", "compute_convex_hull", "find_hull_edges", "find_touches_along"]


def compute_convex_hull(points: Iterable[Point]) -> list[Point]:
    """Return the corners of the convex hull, counter-clockwise from the leftmost (of these, the lowest).

    Points on sides are left out. Two distinct points or fewer are returned sorted.

    Reference: A. M. Andrew, *Another efficient algorithm for convex hulls in two dimensions*, Information
    Processing Letters 9 (1979).

    Examples
    --------
    >>> compute_convex_hull([(0, 0), (2, 0), (1, 1), (2, 2), (0, 2), (1, 0)])
    [(0, 0), (2, 0), (2, 2), (0, 2)]
    """
    ordered = sorted(set(points))
    if len(ordered) <= 2:
        return ordered
    lower, upper = compute_half_hull(ordered), compute_half_hull(ordered[::-1])
    return lower[:-1] + upper[:-1]


def compute_half_hull(ordered: list[Point]) -> list[Point]:
    """Return one half of the convex hull: the points of a sorted list through which a chain turns left at
    each point.

    The chain runs from the first point of the list to the last.
    """
    chain: list[Point] = []
    for x, y in ordered:
        while len(chain) >= 2:
            (ax, ay), (bx, by) = chain[-2:]
            if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0:
                break
            chain.pop()
        chain.append((x, y))
    return chain


Array = NDArray[np.float64]

# Pieces that are paired with all others at a time.
BLOCK = 256


@frozen
class HullEnd:
    """An end of a hull edge.

    Parameters
    ----------
    point : in mm.
    faces : indices of the faces that meet there: two at a corner, one if a face lies along the edge or the
        end is on an arc.
    center, radius : centre and radius of the arc in mm; at a corner, ``point`` and 0.
    along : whether a face lies along the edge there.
    """

    point: Point
    faces: tuple[int, ...]
    center: Point
    radius: float
    along: bool


@frozen
class HullEdge:
    """A hull edge, directed so that the outline is on its left."""

    start: HullEnd
    end: HullEnd

    @property
    def length(self) -> float:
        """Length in mm."""
        return dist(self.start.point, self.end.point)

    @property
    def tangent(self) -> Point:
        """Unit vector (x, y) from start to end."""
        (ax, ay), (bx, by) = self.start.point, self.end.point
        return (bx - ax) / self.length, (by - ay) / self.length

    def measure_height(self, point: Point) -> float:
        """Return the signed distance in mm of a point from the edge's infinite line, positive on the left."""
        (x, y), (tx, ty) = self.start.point, self.tangent
        return (point[1] - y) * tx - (point[0] - x) * ty


@frozen(eq=False)
class HullPieces:
    """N pieces of an outline that may lie on its convex hull: joints of segments, and convex arcs.

    Parameters
    ----------
    center, radius : (N, 2) and (N,) in mm; a joint has radius 0.
    middle : (N, 2) unit vectors from the centres to the arcs' middles.
    cosine : (N,) cosine of half the angle that an arc covers; -2 for a joint or a whole circle.
    faces : for each piece, the indices of its faces.
    """

    center: Array
    radius: Array
    middle: Array
    cosine: Array
    faces: tuple[tuple[int, ...], ...]

    @classmethod
    def from_segments(cls, segments: Sequence[Segment], counts: Sequence[int] | None = None) -> HullPieces:
        """Return the pieces of closed chains of segments; see :func:`find_hull_edges` for the parameters."""
        before: list[int] = []
        for count in [len(segments)] if counts is None else counts:
            first = len(before)
            before += [first + (k - 1) % count for k in range(count)]
        joints: dict[Point, tuple[int, ...]] = {}
        rows: list[tuple[float, ...]] = []
        faces: list[tuple[int, ...]] = []
        for k, segment in enumerate(segments):
            if not (isinstance(segment, Arc) and segment.is_full):
                joints[segment.start] = (before[k], k)
            if isinstance(segment, Arc) and segment.sign > 0:
                middle = np.cos(segment.mid_angle), np.sin(segment.mid_angle)
                cosine = -2.0 if segment.is_full else np.cos(segment.half_sweep)
                rows.append((*segment.center, segment.radius, *middle, cosine))
                faces.append((k,))
        for point in compute_convex_hull(joints):
            rows.append((*point, 0.0, 1.0, 0.0, -2.0))
            faces.append(joints[point])
        table = np.array(rows).reshape(-1, 6)
        return cls(table[:, :2], table[:, 2], table[:, 3:5], table[:, 5], tuple(faces))

    def find_supporting(
        self, normal: Array, chosen: NDArray[np.int64] | slice = slice(None)
    ) -> NDArray[np.bool_]:
        """Return whether the chosen pieces have a point with a given outward normal, so that they can be
        outermost there.

        ``normal`` (..., 2) are unit vectors. A piece is an arc that contains the direction, a joint, or a
        whole circle. The result has the shape (...) to which normals and pieces broadcast.
        """
        along = (normal * self.middle[chosen]).sum(axis=-1)
        return np.asarray(along >= self.cosine[chosen])


def iterate_common_tangents(
    pieces: HullPieces,
) -> Iterator[tuple[NDArray[np.int64], NDArray[np.int64], Array]]:
    """Yield the common tangents of pairs of pieces, in blocks of M, as three arrays.

    They are the indices (M,) of the pieces at which the tangents start, those (M,) at which they end, and the
    outward unit normals n (M, 2). Both pieces lie to the left of the tangent. With D the vector from the
    first centre to the second, n . D is the first radius minus the second.
    """
    count = len(pieces.radius)
    for first in range(0, count, BLOCK):
        one = np.arange(first, min(first + BLOCK, count))
        step = pieces.center[None, :] - pieces.center[one][:, None]
        across = pieces.radius[one][:, None] - pieces.radius[None, :]
        square = (step * step).sum(axis=2)
        ahead = np.sqrt(np.maximum(square - across * across, 0.0))
        start, end = np.nonzero(ahead >= LEAST_HULL_EDGE)
        step, across, ahead, square = (v[start, end] for v in (step, across, ahead, square))
        tangent = np.stack(
            [ahead * step[:, 0] - across * step[:, 1], across * step[:, 0] + ahead * step[:, 1]], axis=1
        )
        tangent /= square[:, None]
        # n = (t_y, -t_x), so that D . n is ``across``.
        normal = np.stack([tangent[:, 1], -tangent[:, 0]], axis=1)
        good = pieces.find_supporting(normal, one[start]) & pieces.find_supporting(normal, end)
        yield one[start[good]], end[good], normal[good]


def compute_supports(pieces: HullPieces, normal: Array) -> Array:
    """Return how far an outline reaches in each of M directions: the largest coordinate along it in mm (M,).

    ``normal`` (M, 2) are unit vectors.
    """
    out = np.empty(len(normal))
    for first in range(0, len(normal), BLOCK):
        block = slice(first, first + BLOCK)
        reach = normal[block] @ pieces.center.T + pieces.radius
        there = pieces.find_supporting(normal[block][:, None])
        out[block] = np.where(there, reach, -np.inf).max(axis=1, initial=-np.inf)
    return out


def find_hull_edges(segments: Sequence[Segment], counts: Sequence[int] | None = None) -> tuple[HullEdge, ...]:
    """Return the hull edges of an outline in the order of the faces at their starts.

    Parameters
    ----------
    segments : the outer loop's faces, a closed chain with material on the left; for a part in several pieces
        one chain after the other.
    counts : number of segments of each chain; None for one chain.

    Examples
    --------
    >>> from workhold.geometry.segment import Line
    >>> points = [(0.0, 0.0), (3.0, 0.0), (3.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0)]
    >>> outline = [Line(a, b) for a, b in zip(points, points[1:] + points[:1])]
    >>> [(edge.start.faces, edge.end.faces) for edge in find_hull_edges(outline)]
    [((0,), (0,)), ((1,), (1,)), ((1, 2), (3, 4)), ((4,), (4,)), ((5,), (5,))]
    """
    pieces = HullPieces.from_segments(segments, counts)
    found: list[HullEdge] = []
    for start, end, normal in iterate_common_tangents(pieces):
        level = (pieces.center[start] * normal).sum(axis=1) + pieces.radius[start]
        good = np.flatnonzero(compute_supports(pieces, normal) <= level + TOUCHING)
        for k in good.tolist():
            ends = [make_hull_end(pieces, number, normal[k]) for number in (int(start[k]), int(end[k]))]
            if not is_on_arc(*ends):
                found.append(HullEdge(*ends))
    # Longest first, and of equal ones those between corners, where a face ends at a tangent joint.
    found.sort(
        key=lambda edge: (-round(edge.length, 6), edge.start.radius + edge.end.radius, edge.start.faces)
    )
    kept: list[HullEdge] = []
    for edge in found:
        if edge.length >= LEAST_HULL_EDGE and not any(is_part(edge, other) for other in kept):
            kept.append(edge)
    with_faces = [assign_faces_along(edge, segments) for edge in kept]
    return tuple(sorted(with_faces, key=lambda edge: (edge.start.faces[-1], edge.end.faces)))


@frozen
class HullTouch:
    """A stretch or a point of a hull edge's line that the outline touches.

    Parameters
    ----------
    low, high : beginning and end of the stretch, in mm along the edge from its start; equal for a point.
    faces : index of the face that lies along the edge, or of the arc; both indices for a corner.
    """

    low: float
    high: float
    faces: tuple[int, ...]


def find_touches_along(
    edge: HullEdge, segments: Sequence[Segment], counts: Sequence[int] | None = None
) -> tuple[HullTouch, ...]:
    """Return the stretches, then the points, in which an outline touches the line of a hull edge.

    Stretches and points are each in order along the edge.

    Parameters
    ----------
    edge : a result of :func:`find_hull_edges` for the same segments and counts.

    Examples
    --------
    >>> from workhold.geometry.segment import Line
    >>> points = [(0, 0), (2, 0), (3, 1), (5, 1), (6, 0), (9, 0), (9, 4), (0, 4)]
    >>> outline = [Line(a, b) for a, b in zip(points, points[1:] + points[:1])]
    >>> [(one.low, one.high, one.faces) for one in find_touches_along(find_hull_edges(outline)[0], outline)][:2]
    [(0.0, 2.0, (0,)), (6.0, 9.0, (4,))]
    """
    (x, y), (tx, ty), length = edge.start.point, edge.tangent, edge.length
    along: list[HullTouch] = []
    alone: list[HullTouch] = []

    def place(point: Point) -> float:
        """Return the position of a point along the edge in mm, limited to the range from 0 to the edge's
        length.
        """
        return min(max((point[0] - x) * tx + (point[1] - y) * ty, 0.0), length)

    first = 0
    for count in [len(segments)] if counts is None else counts:
        for k in range(first, first + count):
            face, before = segments[k], first + (k - first - 1) % count
            if isinstance(face, Line):
                if all(abs(edge.measure_height(point)) <= 2 * TOUCHING for point in (face.start, face.end)):
                    along.append(HullTouch(place(face.start), place(face.end), (k,)))
            elif face.sign > 0:
                (cx, cy), radius = face.center, face.radius
                foot = cx + radius * ty, cy - radius * tx
                middle = ty * np.cos(face.mid_angle) - tx * np.sin(face.mid_angle)
                supports = face.is_full or middle >= np.cos(face.half_sweep)
                if supports and abs(edge.measure_height(foot)) <= 2 * TOUCHING:
                    alone.append(HullTouch(place(foot), place(foot), (k,)))
            whole = isinstance(face, Arc) and face.is_full
            if not whole and abs(edge.measure_height(face.start)) <= 2 * TOUCHING:
                alone.append(HullTouch(place(face.start), place(face.start), (before, k)))
        first += count
    return (
        *sorted(along, key=lambda one: one.low),
        *sorted(alone, key=lambda one: (one.low, -len(one.faces))),
    )


def make_hull_end(pieces: HullPieces, number: int, normal: Array) -> HullEnd:
    """Return the end that a hull edge with this outward normal has on piece ``number``."""
    (x, y), radius = pieces.center[number].tolist(), float(pieces.radius[number])
    nx, ny = normal.tolist()
    return HullEnd((x + radius * nx, y + radius * ny), pieces.faces[number], (x, y), radius, along=False)


def is_on_arc(one: HullEnd, other: HullEnd) -> bool:
    """Return whether two ends of a hull edge are an arc's tangent point and a corner at which this arc ends.

    Such an edge has a length by rounding only.
    """
    return (one.radius == 0.0) != (other.radius == 0.0) and not set(one.faces).isdisjoint(other.faces)


def is_part(edge: HullEdge, other: HullEdge) -> bool:
    """Return whether a hull edge lies on the edge ``other`` and runs in the same direction, within the
    rounding of a drawing.
    """
    (x, y), (tx, ty) = other.start.point, other.tangent
    for px, py in (edge.start.point, edge.end.point):
        ahead = (px - x) * tx + (py - y) * ty
        if (
            abs(other.measure_height((px, py))) > 2 * TOUCHING
            or not -2 * TOUCHING <= ahead <= other.length + 2 * TOUCHING
        ):
            return False
    (ax, ay), (bx, by) = edge.start.point, edge.end.point
    return (bx - ax) * tx + (by - ay) * ty > 0


def assign_faces_along(edge: HullEdge, segments: Sequence[Segment]) -> HullEdge:
    """Return a hull edge in which an end at a corner names only the face that lies along the edge there, if
    one does.
    """
    ends = []
    # Outline and edge run the same way: at its start the face after the corner may lie along it, at its end
    # the one before.
    for end, index in ((edge.start, -1), (edge.end, 0)):
        face = segments[end.faces[index]]
        lies = isinstance(face, Line) and all(
            abs(edge.measure_height(p)) <= 2 * TOUCHING for p in (face.start, face.end)
        )
        if end.radius == 0.0 and lies:
            end = evolve(end, faces=(end.faces[index],), along=True)
        ends.append(end)
    return HullEdge(*ends)
