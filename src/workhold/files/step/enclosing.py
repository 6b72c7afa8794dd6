"""Curves seen from above that are neither line nor arc, enclosed in convex polygons.

A rational Bézier curve lies in the convex hull of its control points. So a curve is cut until each piece is
near to its chord, and the hulls of the pieces hold all of it. A fold of a free-form face is known only as the
place where the vertical component of the normal changes its sign. Small squares around such places enclose
it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import pairwise
from math import hypot
from typing import Any

import numpy as np
from attrs import define, field
from numpy.typing import NDArray

from workhold.conventions import SHORTEST
from workhold.errors import InputError
from workhold.files.step.edge_curves import EdgeCurve, Found
from workhold.files.step.faces import SolidFace, find_surface
from workhold.files.step.library import list_sub_shapes, occ
from workhold.files.step.projected import (
    compute_normal_height,
    cut_face_at_height,
    list_bounding_edges,
    list_leaning_faces_between,
)
from workhold.files.step.regions import convert_edge_to_pieces
from workhold.geometry.hull import compute_convex_hull
from workhold.geometry.rational import Pieces, cut_between_parameters
from workhold.geometry.segment import Line, Point, Segment

__all__ = ["Enclosure", "enclose_curves", "split_near_chords"]

Array = NDArray[np.float64]
# How far in mm control points may be from the chord of a piece that is enclosed, and how many pieces, at most.
SAFE, MOST_PIECES = 0.02, 4_000
# More polygons than these are made anew, each time as many times coarser, at most so often.
MANY, COARSER, AGAIN = 300, 8.0, 3
# mm. A piece nearer to its chord is taken for that.
FLAT = 2e-6
# Cells along both directions of a free-form face where its folds are looked for, by what share boxes around
# pieces of one are wider than their cells, and how often a cell is quartered.
CELLS, WIDER, QUARTERED = 8, 0.25, 5
# Size in mm of the squares that hold a fold, and how many of one face, at most; then they are larger.
BOX, MOST_SQUARES = 0.5, 300
# Of more free-form faces than these the squares are as much larger.
FEW = 3
Squares = dict[tuple[int, float], set[tuple[int, int]]]


@define(eq=False)
class Enclosure:
    """The bounds of something seen from above: lines and arcs, and polygons that enclose all other curves.

    Parameters
    ----------
    segments : lines and arcs.
    polygons : (N, 2) convex ones, counter-clockwise.
    """

    segments: list[Segment] = field(factory=list)
    polygons: list[Array] = field(factory=list)
    boxes: Array | None = field(init=False, default=None)

    def add(self, other: Enclosure) -> None:
        """Add the segments and polygons of another enclosure to this one."""
        self.segments += other.segments
        self.polygons += other.polygons
        self.boxes = None

    def add_points(self, points: Iterable[Point], safe: float = SAFE) -> None:
        """Add the simplified convex hull of points along a curve; a hull that is thin enough is added as a
        line from the first to the last point.

        For ``safe`` see :func:`simplify_hull`. Points all in one place add nothing.
        """
        every = list(points)
        corners = simplify_hull(
            np.array(compute_convex_hull(every)).reshape(-1, 2), every[0], every[-1], safe
        )
        if len(corners) < 2 or float(np.hypot(*np.ptp(corners, axis=0))) <= SHORTEST:
            return
        start, end = np.array(every[0]), np.array(every[-1])
        size = float(np.hypot(*(end - start)))
        off = np.abs((corners - start) @ np.array([-(end - start)[1], (end - start)[0]]))
        if len(corners) == 2 or (size > SHORTEST and off.max() <= FLAT * size):
            self.segments.append(Line((float(start[0]), float(start[1])), (float(end[0]), float(end[1]))))
        else:
            self.polygons.append(corners)
            self.boxes = None

    @property
    def lines(self) -> list[Segment]:
        """All segments, and the sides of all polygons."""
        sides = [
            Line((float(a[0]), float(a[1])), (float(b[0]), float(b[1])))
            for polygon in self.polygons
            for a, b in pairwise([*polygon, polygon[0]])
            if hypot(*(b - a)) > SHORTEST
        ]
        return [*self.segments, *sides]

    def may_hold(self, point: Point) -> bool:
        """Return whether a point is in one of the polygons. The side of the curve is not known there."""
        if not self.polygons:
            return False
        if self.boxes is None:
            self.boxes = np.array([(*one.min(axis=0), *one.max(axis=0)) for one in self.polygons])
        (x, y), boxes = point, self.boxes
        near = (boxes[:, 0] <= x) & (x <= boxes[:, 2]) & (boxes[:, 1] <= y) & (y <= boxes[:, 3])
        return any(is_within(point, self.polygons[k]) for k in np.flatnonzero(near).tolist())


def is_within(point: Point, polygon: Array) -> bool:
    """Return whether a point lies in a convex polygon (N, 2) that runs counter-clockwise, border included."""
    ahead = np.roll(polygon, -1, axis=0) - polygon
    away = np.array(point) - polygon
    return bool((ahead[:, 0] * away[:, 1] - ahead[:, 1] * away[:, 0] >= 0.0).all())


def simplify_hull(hull: Array, start: Point, end: Point, safe: float = SAFE) -> Array:
    """Return a convex polygon (N, 2) around a hull with at
    most one corner on each side of the chord start to end.

    A side is simplified only if its new corner is at most 2 * ``safe`` mm from the chord; a hull in which
    start and end are not both corners is returned unchanged.
    """
    ends = [k for k, corner in enumerate(hull.tolist()) if tuple(corner) in (start, end)]
    if len(ends) != 2 or len(hull) < 4:
        return hull
    kept: list[Array] = []
    for first, last in (ends, [ends[1], ends[0] + len(hull)]):
        run = hull[np.arange(first, last + 1) % len(hull)]
        apex = intersect_lines(run[0], run[1], run[-1], run[-2]) if len(run) > 3 else None
        chord = run[-1] - run[0]
        size = float(np.hypot(*chord))
        if apex is not None and abs(compute_cross_product(chord, apex - run[0])) <= 2 * safe * size:
            along = float(chord @ (apex - run[0]))
            run = np.array([run[0], apex, run[-1]]) if 0.0 < along < size * size else run
        kept.append(run[:-1])
    return np.concatenate(kept)


def compute_cross_product(a: Array, b: Array) -> float:
    """Return the cross product of two vectors (2,)."""
    return float(a[0] * b[1] - a[1] * b[0])


def intersect_lines(a: Array, b: Array, c: Array, d: Array) -> Array | None:
    """Return the point (2,) where the line through ``a`` and ``b`` crosses the line through ``c`` and ``d``;
    None for parallel lines.
    """
    one, other = b - a, d - c
    turn = compute_cross_product(one, other)
    if abs(turn) <= SHORTEST * float(np.hypot(*one) * np.hypot(*other)):
        return None
    return np.asarray(a + one * compute_cross_product(c - a, other) / turn)


def split_near_chords(pieces: Pieces, safe: float = SAFE) -> Iterator[Array]:
    """Yield the control points (N, 2) of consecutive runs of a curve, each within ``safe`` mm of its chord.

    Along its chord each run only moves forward. Each run is as long as these conditions allow. Raises
    InputError for a curve that takes more than ``MOST_PIECES``.
    """
    run: Array | None = None
    for control in split_each_piece(pieces, safe):
        longer = control if run is None else np.concatenate([run, control[1:]])
        if run is not None and not is_near_chord(longer, safe):
            yield run
            longer = control
        run = longer
    if run is not None:
        yield run


def is_near_chord(control: Array, safe: float) -> bool:
    """Return whether points (N, 2) are within ``safe`` mm of
    the chord from first to last and never move back along it.
    """
    chord = control[-1] - control[0]
    size = hypot(*chord)
    if size <= SHORTEST:
        return False
    away = control - control[0]
    along, off = away @ chord / size, np.abs(away @ np.array([-chord[1], chord[0]])) / size
    return bool(off.max() <= safe and (np.diff(along) >= 0.0).all())


def split_each_piece(pieces: Pieces, safe: float) -> Iterator[Array]:
    """Yield control points as :func:`split_near_chords` does, but do not join neighbouring pieces into longer
    runs.
    """
    waiting, found = [pieces[k : k + 1] for k in reversed(range(len(pieces)))], 0
    while waiting:
        piece = waiting.pop()
        control = piece[0, :, :2] / piece[0, :, 2:]
        if is_near_chord(control, safe):
            found += 1
            yield control
            continue
        if float(np.hypot(*(control - control[0]).T).max()) <= SHORTEST:
            continue
        if found + len(waiting) > MOST_PIECES:
            raise InputError("a curve of a level face bends too sharply.")
        waiting += [cut_between_parameters(piece, 0.5, 1.0), cut_between_parameters(piece, 0.0, 0.5)]


def enclose_curves(
    faces: Sequence[SolidFace],
    edges: Sequence[EdgeCurve],
    low: float,
    high: float,
    folds_of: Callable[[int], Sequence[Found]],
    squares: Squares,
    is_there: Callable[[Point], bool],
) -> Enclosure:
    """Return lines and polygons that enclose all curves that can bound a part of a
    solid seen from above and are neither lines nor arcs.

    Raises InputError for curves that take too many pieces.

    Parameters
    ----------
    low, high : z in mm between which the part of the solid lies.
    folds_of : see :func:`workhold.files.step.projected.list_projected_curves`.
    squares : raster squares that enclose the curves along which free-form faces stand upright, by face index
        and size in mm; extended in place, for other heights of the same solid.
    is_there : returns whether a point belongs to the region that is bounded; enclosures with the region
        nowhere or everywhere around them are left out.
    """
    boxes = list[Array]()
    leaning = [*list_leaning_faces_between(faces, low, high)]
    free = [k for k in leaning if any(isinstance(one, np.ndarray) for one in folds_of(k))]
    size = BOX * max(1.0, len(free) / FEW)
    # Two faces have an edge, and it is enclosed once.
    others = {id(one.curve): one for one in list_bounding_edges(faces, edges, low, high) if one.is_other}
    curves: list[tuple[Any, Array | None]] = [
        (one.curve.Edge(), one.points[:, :2]) for one in others.values()
    ]
    for index in leaning:
        face = faces[index]
        if index in free:
            if (index, size) not in squares:
                squares[index, size] = find_fold_squares(find_surface(face.shape), size)
            boxes += list_fold_boxes(squares[index, size], size, is_there)
        for z in (low, high):
            if face.low < z < face.high and any(
                isinstance(one, np.ndarray) for one in cut_face_at_height(face, z)
            ):
                plane = occ.gp_Pln(occ.gp_Pnt(0.0, 0.0, z), occ.gp_Dir(0.0, 0.0, 1.0))
                section = occ.BRepAlgoAPI_Section(face.shape, plane)
                curves += [(edge, None) for edge in list_sub_shapes(section.Shape(), "EDGE")]
    safe = SAFE
    for _ in range(AGAIN):
        found = Enclosure()
        for curve, points in curves:
            enclose_edge(found, curve, points, safe)
        if len(found.polygons) <= MANY:
            break
        safe *= COARSER
    # Of an edge that is in the slab in part the rest bounds nothing of it.
    found.polygons = [one for one in found.polygons if is_beside_some(one, is_there)] + boxes
    found.boxes = None
    return found


def is_beside_some(polygon: Array, is_there: Callable[[Point], bool]) -> bool:
    """Return whether, of points just outside a convex polygon (N, 2), some belong to the region and others do
    not.
    """
    corners = np.concatenate([polygon, (polygon + np.roll(polygon, -1, axis=0)) / 2])
    away = corners - polygon.mean(axis=0)
    size = np.hypot(*away.T)[:, None]
    places = corners + away / size * (SAFE + 0.1 * size)
    first = is_there((float(places[0, 0]), float(places[0, 1])))
    return any(is_there((float(x), float(y))) != first for x, y in places[1:])


def enclose_edge(found: Enclosure, edge: Any, points: Array | None, safe: float) -> None:
    """Add polygons or lines that enclose an edge of Open CASCADE, seen from above, to ``found``.

    Parameters
    ----------
    points : (N, 2) along the edge. They are used where the library has no curve of the edge: boxes around the
        steps from point to point then enclose it. None raises InputError in that case.
    safe : see :func:`split_near_chords`.
    """
    try:
        pieces = convert_edge_to_pieces(edge)
    except InputError:
        if points is None:
            raise
        for start, end in pairwise(points):
            wide = 0.5 * float(np.hypot(*(end - start))) + SAFE
            low, high = np.minimum(start, end) - wide, np.maximum(start, end) + wide
            found.polygons.append(np.array(list_box_corners(low, high)))
        return
    for control in split_near_chords(pieces, safe):
        found.add_points(((float(x), float(y)) for x, y in control), safe)


def list_box_corners(low: Array, high: Array) -> list[Point]:
    """Return the four corners of the box between its least and greatest corner (2,), counter-clockwise."""
    (x0, y0), (x1, y1) = low.tolist(), high.tolist()
    return [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]


def list_fold_boxes(
    squares: set[tuple[int, int]], size: float, is_there: Callable[[Point], bool]
) -> list[Array]:
    """Return boxes (4, 2) around a curve along which a face stands upright, only where the curve runs at or
    beside the region.

    Parameters
    ----------
    squares : (column, row) of the raster squares that enclose the curve. If there are very many, four at a
        time are merged into one.
    size : side of a square in mm.
    is_there : see :func:`enclose_curves`.
    """
    while len(squares) > MOST_SQUARES:
        size *= 2.0
        squares = {(i // 2, j // 2) for i, j in squares}

    def is_met(square: tuple[int, int]) -> bool:
        """Return whether a place at or around a square belongs to the region."""
        # Not only where something is beside it: a gap between two outlines that cross is narrower than places.
        i, j = square
        places = [
            (i - 0.5, j - 0.5),
            (i + 1.5, j - 0.5),
            (i + 1.5, j + 1.5),
            (i - 0.5, j + 1.5),
            (i + 0.5, j + 0.5),
        ]
        return any(is_there((x * size, y * size)) for x, y in places)

    kept = sorted((j, i) for i, j in squares if is_met((i, j)))
    rows: list[list[int]] = []
    for j, i in kept:
        if rows and rows[-1][0] == j and rows[-1][2] == i:
            rows[-1][2] = i + 1
        else:
            rows.append([j, i, i + 1])
    return [
        np.array(list_box_corners(np.array([first, j]) * size, np.array([last, j + 1]) * size))
        for j, first, last in rows
    ]


def find_fold_squares(surface: Any, size: float) -> set[tuple[int, int]]:
    """Return the squares (column, row) of a raster of ``size``
    mm in which a surface may stand upright, seen from above.
    """
    u = np.linspace(surface.FirstUParameter(), surface.LastUParameter(), CELLS + 1)
    v = np.linspace(surface.FirstVParameter(), surface.LastVParameter(), CELLS + 1)
    waiting = [(u0, u1, v0, v1, 0) for u0, u1 in pairwise(u.tolist()) for v0, v1 in pairwise(v.tolist())]
    found: set[tuple[int, int]] = set()
    while waiting:
        u0, u1, v0, v1, level = waiting.pop()
        places = [(a, b) for a in (u0, (u0 + u1) / 2, u1) for b in (v0, (v0 + v1) / 2, v1)]
        leans = [compute_normal_height(surface, a, b) for a, b in places]
        if min(leans) > 0.0 or max(leans) < 0.0:
            continue
        values = [surface.Value(a, b) for a, b in places]
        points = np.array([(value.X(), value.Y()) for value in values])
        low, high = points.min(axis=0), points.max(axis=0)
        if float((high - low).max()) <= size or level >= QUARTERED:
            wide = WIDER * (high - low) + SAFE
            (i0, j0), (i1, j1) = (
                np.floor(one / size).astype(int).tolist() for one in (low - wide, high + wide)
            )
            found |= {(i, j) for i in range(i0, i1 + 1) for j in range(j0, j1 + 1)}
        else:
            middle_u, middle_v = (u0 + u1) / 2, (v0 + v1) / 2
            waiting += [
                (a, b, c, d, level + 1)
                for a, b in ((u0, middle_u), (middle_u, u1))
                for c, d in ((v0, middle_v), (middle_v, v1))
            ]
    return found
