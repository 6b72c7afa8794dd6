"""Meshes of bodies: triangles with normals, arcs as chords.

Each slab is a closed surface of its own: two caps and the walls between them. A vertex stands in a mesh once
for each normal that it has, so that edges are sharp and round walls smooth.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import acos, ceil, dist, pi

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.geometry.segment import Line, Point, Segment
from workhold.geometry.triangulation import triangulate
from workhold.model.bodies import FixtureBody, Slab

__all__ = ["SAGITTA", "Mesh", "body_mesh", "surface_mesh"]

Array = NDArray[np.float64]
Triangles = NDArray[np.int64]

# How far a chord may be from its arc, in mm, and how much of a turn it may stand for.
SAGITTA, LARGEST_TURN = 0.05, pi / 6
# Vertices that are nearer to the one before than this in mm are one with it in single precision.
SAME = 1e-4


@frozen(eq=False)
class Mesh:
    """Triangles in space.

    Parameters
    ----------
    positions : (N, 3) float32 vertices in metres, y up, as glTF has them.
    normals : (N, 3) float32 unit vectors outward.
    triangles : (M, 3) uint32 numbers of vertices, counter-clockwise from outside.
    """

    positions: NDArray[np.float32]
    normals: NDArray[np.float32]
    triangles: NDArray[np.uint32]


def body_mesh(body: FixtureBody, sagitta: float = SAGITTA) -> Mesh:
    """The mesh of a body.

    Parameters
    ----------
    sagitta : how far a chord may be from its arc, in mm.
    """
    positions: list[Array] = []
    normals: list[Array] = []
    triangles: list[Triangles] = []
    count = 0
    for slab in body.slabs:
        for part in slab_parts(slab, sagitta):
            points, outward, numbers = part
            positions.append(points)
            normals.append(outward)
            triangles.append(numbers + count)
            count += len(points)
    return surface_mesh(np.concatenate(positions), np.concatenate(normals), np.concatenate(triangles))


def surface_mesh(positions: Array, normals: Array, triangles: Triangles) -> Mesh:
    """The mesh of a surface with z up.

    Parameters
    ----------
    positions, normals : (N, 3) vertices in mm and unit vectors outward.
    triangles : (M, 3) numbers of vertices.
    """
    return Mesh(as_gltf(positions / 1000.0), as_gltf(normals), triangles.astype(np.uint32))


def as_gltf(vectors: Array) -> NDArray[np.float32]:
    """Vectors (N, 3) with z up as glTF has them: y up, and what was y to the back."""
    turned = np.stack([vectors[:, 0], vectors[:, 2], -vectors[:, 1]], axis=1).astype(np.float32)
    return turned + np.float32(0.0)


def slab_parts(slab: Slab, sagitta: float) -> list[tuple[Array, Array, Triangles]]:
    """Positions in mm, normals and triangles of the caps and the walls of a slab."""
    loops = [pieces_of(loop, sagitta) for loop in (slab.outer, *slab.holes)]
    flat = np.array([piece.start for loop in loops for piece in loop])
    caps = np.array(triangulate([[piece.start for piece in loop] for loop in loops]), dtype=np.int64)
    parts: list[tuple[Array, Array, Triangles]] = []
    for height, up, triangles in ((slab.low, -1.0, caps[:, ::-1]), (slab.high, 1.0, caps)):
        points = np.column_stack([flat, np.full(len(flat), height)])
        parts.append((points, np.tile((0.0, 0.0, up), (len(flat), 1)), triangles))
    parts += [wall(loop, slab.low, slab.high) for loop in loops]
    return parts


@frozen
class WallPiece:
    """A flat piece of a wall seen from above, in mm, with its segment's outward normals at its ends."""

    start: Point
    end: Point
    normals: tuple[Point, Point]


def pieces_of(loop: Sequence[Segment], sagitta: float) -> list[WallPiece]:
    """A closed loop of pieces over the chords of a loop's segments; those too short are left out."""
    places: list[tuple[Point, int, float]] = []
    for number, segment in enumerate(loop):
        for parameter in chord_ends(segment, sagitta)[:-1]:
            point = segment.at(parameter)
            if not places or dist(point, places[-1][0]) > SAME:
                places.append((point, number, parameter))
    while dist(places[-1][0], places[0][0]) <= SAME:
        places.pop()
    out = []
    for k, (start, number, first) in enumerate(places):
        end, following, last = places[(k + 1) % len(places)]
        segment = loop[number]
        if following != number:
            last = chord_ends(segment, sagitta)[-1]
        out.append(WallPiece(start, end, (segment.normal(first), segment.normal(last))))
    return out


def chord_ends(segment: Segment, sagitta: float) -> list[float]:
    """Parameters of the ends of a segment's chords in running order."""
    if isinstance(segment, Line):
        return [-segment.half_extent, segment.half_extent]
    widest = min(2 * acos(max(0.0, 1.0 - sagitta / segment.radius)), LARGEST_TURN)
    count = ceil(2 * segment.half_sweep / widest)
    half = segment.sign * segment.half_sweep
    return [half * (2 * k / count - 1.0) for k in range(count + 1)]


def wall(loop: Sequence[WallPiece], low: float, high: float) -> tuple[Array, Array, Triangles]:
    """Positions in mm, normals and triangles of the wall over a loop: two triangles over each piece."""
    points = np.array(
        [(*place, z) for piece in loop for place in (piece.start, piece.end) for z in (low, high)]
    )
    outward = np.array([(*normal, 0.0) for piece in loop for normal in piece.normals for _ in range(2)])
    first = 4 * np.arange(len(loop))[:, None]
    triangles = np.concatenate([first + np.array(corners) for corners in ((0, 2, 3), (0, 3, 1))])
    return points, outward, triangles
