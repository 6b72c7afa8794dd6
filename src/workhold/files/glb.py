"""GLB files of fixtures: glTF 2.0 in its binary form (Khronos Group, "glTF 2.0 Specification", section 4.4).

Each body is a node with its own mesh, named as the body is, below one node for the whole fixture. Bodies of
one kind share a material. Lengths are metres, and y is up. The node's ``extras`` have data for viewers: the
body's ``kind`` and, for a sliding body, ``opens``, the direction in which it opens.

In a mesh, arcs are chords, and each slab is a closed surface of its own: two caps and the walls between them.
A vertex occurs once for each of its normals, so that edges look sharp and round walls smooth.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Sequence
from math import acos, ceil, dist, pi
from typing import Any

import numpy as np
from attrs import define, field, frozen
from numpy.typing import NDArray

from workhold.geometry.segment import Line, Point, Segment
from workhold.geometry.triangulation import triangulate
from workhold.model.bodies import COLOURS, BodyKind, FixtureBody, Slab

__all__ = ["SAGITTA", "Mesh", "make_bodies_glb", "make_body_mesh", "make_surface_mesh"]

Array = NDArray[np.float64]
Triangles = NDArray[np.int64]

# How far a chord may be from its arc, in mm, and how much of a turn it may stand for.
SAGITTA, LARGEST_TURN = 0.05, pi / 6
# Vertices that are nearer to the one before than this in mm are one with it in single precision.
SAME = 1e-4
# Numbers of the specification: its name, kinds of chunks, component types, targets of buffer views.
MAGIC, JSON_CHUNK, BINARY_CHUNK = 0x46546C67, 0x4E4F534A, 0x004E4942
FLOAT, UNSIGNED_INT = 5126, 5125
VERTICES, ELEMENTS = 34962, 34963


@frozen(eq=False)
class Mesh:
    """Triangles in space.

    Parameters
    ----------
    positions : (N, 3) float32 vertices in metres, y up, as glTF has them.
    normals : (N, 3) float32 unit vectors outward.
    triangles : (M, 3) uint32 indices of vertices, counter-clockwise from outside.
    colours : (N, 3) float32 linear red, green and blue from 0 to 1, over a white material; None for the
        colour of the body's kind.
    about : further ``extras`` of its node, as plain data; None for none.
    """

    positions: NDArray[np.float32]
    normals: NDArray[np.float32]
    triangles: NDArray[np.uint32]
    colours: NDArray[np.float32] | None = None
    about: dict[str, Any] | None = None


def make_body_mesh(body: FixtureBody) -> Mesh:
    """Return the mesh of a body from its slabs (outlines with holes between two heights)."""
    parts = [part for slab in body.slabs for part in mesh_slab(slab)]
    points, outward, triangles = zip(*parts, strict=True)
    first = np.cumsum([0, *map(len, points[:-1])])
    numbers = [own + before for own, before in zip(triangles, first, strict=True)]
    return make_surface_mesh(np.concatenate(points), np.concatenate(outward), np.concatenate(numbers))


def make_surface_mesh(
    positions: Array, normals: Array, triangles: Triangles, colours: Array | None = None
) -> Mesh:
    """Return the mesh, in glTF's axes and metres, of a surface with z up.

    Parameters
    ----------
    positions, normals : (N, 3) vertices in mm and unit vectors outward.
    triangles : (M, 3) indices of vertices.
    colours : (N, 3) red, green and blue from 0 to 1 as on a screen (sRGB); None for the colour of the body's
        kind.
    """
    light = None
    if colours is not None:
        dark = colours <= 0.04045
        light = np.where(dark, colours / 12.92, ((colours + 0.055) / 1.055) ** 2.4).astype(np.float32)
    return Mesh(
        convert_to_gltf_axes(positions / 1000.0),
        convert_to_gltf_axes(normals),
        triangles.astype(np.uint32),
        light,
    )


def convert_to_gltf_axes(vectors: Array) -> NDArray[np.float32]:
    """Return vectors (N, 3) with z up as float32 vectors with y up: (x, z, -y)."""
    turned = np.stack([vectors[:, 0], vectors[:, 2], -vectors[:, 1]], axis=1).astype(np.float32)
    return turned + np.float32(0.0)


def mesh_slab(slab: Slab) -> list[tuple[Array, Array, Triangles]]:
    """Return (positions, normals, triangles) of the lower
    cap, the upper cap and the wall of each loop of a slab.

    The list has one tuple for each of these pieces. Positions (N, 3) are in mm, z up; triangles (M, 3) are
    indices into the positions of the same tuple.
    """
    loops = [split_loop_into_chords(loop) for loop in (slab.outer, *slab.holes)]
    flat = np.array([piece.start for loop in loops for piece in loop])
    caps = np.array(triangulate([[piece.start for piece in loop] for loop in loops]), dtype=np.int64)
    parts: list[tuple[Array, Array, Triangles]] = []
    for height, up, triangles in ((slab.low, -1.0, caps[:, ::-1]), (slab.high, 1.0, caps)):
        points = np.column_stack([flat, np.full(len(flat), height)])
        parts.append((points, np.tile((0.0, 0.0, up), (len(flat), 1)), triangles))
    parts += [mesh_wall(loop, slab.low, slab.high) for loop in loops]
    return parts


@frozen
class WallPiece:
    """A flat piece of a wall: its line seen from above in mm, and at both ends the
    outward unit normals of the segment it stands for.
    """

    start: Point
    end: Point
    normals: tuple[Point, Point]


def split_loop_into_chords(loop: Sequence[Segment]) -> list[WallPiece]:
    """Return the wall pieces over the chords of a loop's segments, in running
    order; chords that are too short are left out.

    Neighbouring pieces share their ends, so the pieces close.
    """
    places: list[tuple[Point, int, float]] = []
    for number, segment in enumerate(loop):
        for parameter in list_chord_parameters(segment)[:-1]:
            point = segment.compute_point(parameter)
            if not places or dist(point, places[-1][0]) > SAME:
                places.append((point, number, parameter))
    while dist(places[-1][0], places[0][0]) <= SAME:
        places.pop()
    out = []
    for k, (start, number, first) in enumerate(places):
        end, following, last = places[(k + 1) % len(places)]
        segment = loop[number]
        if following != number:
            last = list_chord_parameters(segment)[-1]
        out.append(WallPiece(start, end, (segment.compute_normal(first), segment.compute_normal(last))))
    return out


def list_chord_parameters(segment: Segment) -> list[float]:
    """Return the parameters of the ends of a segment's chords
    in running order, both ends of the segment included.
    """
    if isinstance(segment, Line):
        return [-segment.half_extent, segment.half_extent]
    widest = min(2 * acos(max(0.0, 1.0 - SAGITTA / segment.radius)), LARGEST_TURN)
    count = ceil(2 * segment.half_sweep / widest)
    half = segment.sign * segment.half_sweep
    return [half * (2 * k / count - 1.0) for k in range(count + 1)]


def mesh_wall(loop: Sequence[WallPiece], low: float, high: float) -> tuple[Array, Array, Triangles]:
    """Return positions (4 N, 3) in mm, normals (4 N, 3) and
    triangles (2 N, 3) of the wall over a loop of N pieces.
    """
    points = np.array(
        [(*place, z) for piece in loop for place in (piece.start, piece.end) for z in (low, high)]
    )
    outward = np.array([(*normal, 0.0) for piece in loop for normal in piece.normals for _ in range(2)])
    first = 4 * np.arange(len(loop))[:, None]
    triangles = np.concatenate([first + np.array(corners) for corners in ((0, 2, 3), (0, 3, 1))])
    return points, outward, triangles


def make_bodies_glb(bodies: Sequence[FixtureBody], name: str, part: Mesh | None = None) -> bytes:
    """Return the bytes of a GLB file of bodies below one node called ``name``.

    Parameters
    ----------
    part : the mesh of the part's own shape; of its prism if None.
    """
    kinds = [kind for kind in BodyKind if any(body.kind is kind for body in bodies)]
    scene = GlbBuffer()
    nodes: list[dict[str, Any]] = [{"name": name, "children": [k + 1 for k in range(len(bodies))]}]
    meshes = []
    for number, body in enumerate(bodies):
        mesh = make_body_mesh(body) if part is None or body.kind is not BodyKind.PART else part
        # What has colours of its own has the material after those of the kinds.
        look = kinds.index(body.kind) if mesh.colours is None else len(kinds)
        meshes.append({"name": body.name, "primitives": [scene.add(mesh, look)]})
        extras: dict[str, Any] = {"kind": str(body.kind)} | (mesh.about or {})
        if body.opens is not None:
            extras["opens"] = [body.opens[0], 0.0, 0.0 - body.opens[1]]
        nodes.append({"name": body.name, "mesh": number, "extras": extras})
    document = {
        "asset": {"version": "2.0", "generator": "workhold"},
        "scene": 0,
        "scenes": [{"name": name, "nodes": [0]}],
        "nodes": nodes,
        "meshes": meshes,
        "materials": [
            *map(make_material, kinds),
            *([COLOURED] if part is not None and part.colours is not None else []),
        ],
        "accessors": scene.accessors,
        "bufferViews": scene.views,
        "buffers": [{"byteLength": len(scene.content)}],
    }
    text = json.dumps(document, separators=(",", ":"), allow_nan=False).encode("ascii")
    chunks = make_chunk(JSON_CHUNK, text, b" ") + make_chunk(BINARY_CHUNK, bytes(scene.content), b"\0")
    return struct.pack("<III", MAGIC, 2, 12 + len(chunks)) + chunks


def make_chunk(kind: int, content: bytes, filling: bytes) -> bytes:
    """Return a chunk of a GLB file with its length and kind, padded to a multiple of four bytes with the byte
    ``filling``.
    """
    content += filling * (-len(content) % 4)
    return struct.pack("<II", len(content), kind) + content


def make_material(kind: BodyKind) -> dict[str, Any]:
    """Return glTF's material for a kind of body, its colour in linear light."""
    factor = [*(convert_to_linear_light(value) for value in COLOURS[kind]), 1.0]
    return {
        "name": str(kind),
        "pbrMetallicRoughness": {
            "baseColorFactor": factor,
            "metallicFactor": 0.1,
            "roughnessFactor": 0.7,
        },
    }


# Of what has the colours of its vertices.
COLOURED = {
    "name": "coloured",
    "pbrMetallicRoughness": {"baseColorFactor": [1.0] * 4, "metallicFactor": 0.0, "roughnessFactor": 0.9},
}


def convert_to_linear_light(value: float) -> float:
    """Return the linear light of an sRGB value, both from 0 to 1, rounded to six decimals (IEC 61966-2-1)."""
    return round(value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4, 6)


@define
class GlbBuffer:
    """The binary buffer of a file, with its views and accessors."""

    content: bytearray = field(factory=bytearray)
    views: list[dict[str, Any]] = field(factory=list)
    accessors: list[dict[str, Any]] = field(factory=list)

    def add(self, mesh: Mesh, material: int) -> dict[str, Any]:
        """Add a mesh, and return its glTF primitive; ``material`` is the index of its material."""
        ends = {"min": mesh.positions.min(axis=0).tolist(), "max": mesh.positions.max(axis=0).tolist()}
        attributes = {
            "POSITION": self.add_accessor(mesh.positions, VERTICES, **ends),
            "NORMAL": self.add_accessor(mesh.normals, VERTICES),
        }
        if mesh.colours is not None:
            attributes["COLOR_0"] = self.add_accessor(mesh.colours, VERTICES)
        indices = self.add_accessor(mesh.triangles.reshape(-1), ELEMENTS)
        return {"attributes": attributes, "indices": indices, "material": material}

    def add_accessor(self, values: NDArray[Any], target: int, **more: list[float]) -> int:
        """Add an array of vectors (N, 3) or indices (N,) to the buffer, and return the index of its accessor.

        ``target`` is the kind of buffer in glTF, ``more`` are further keys of the accessor.
        """
        is_vector = values.ndim == 2
        content = values.astype("<f4" if is_vector else "<u4").tobytes()
        self.views.append(
            {"buffer": 0, "byteOffset": len(self.content), "byteLength": len(content), "target": target}
        )
        self.content += content
        self.accessors.append(
            {
                "bufferView": len(self.views) - 1,
                "componentType": FLOAT if is_vector else UNSIGNED_INT,
                "count": len(values),
                "type": "VEC3" if is_vector else "SCALAR",
                **more,
            }
        )
        return len(self.accessors) - 1
