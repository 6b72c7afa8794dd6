"""GLB files of fixtures: glTF 2.0 in its binary form (Khronos Group, "glTF 2.0 Specification", section 4.4).

Each body is a node with its own mesh, named as the body is, below one node for the whole fixture. Bodies of
one kind share a material. Lengths are metres, and y is up. What a viewer may do with a body stands in the
node's ``extras``: its ``kind``, and where it slides ``opens``, the direction in which it opens.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Sequence
from typing import Any

from attrs import define, field
from numpy.typing import NDArray

from workhold.files.glb.meshes import Mesh, body_mesh
from workhold.fixels.toolkit import Toolkit
from workhold.model.bodies import COLOURS, BodyKind, BodySizes, FixtureBody, fixture_bodies
from workhold.model.fixture import Fixture
from workhold.model.workpiece import Workpiece

__all__ = ["bodies_glb", "fixture_glb"]

# Numbers of the specification: its name, kinds of chunks, component types, targets of buffer views.
MAGIC, JSON_CHUNK, BINARY_CHUNK = 0x46546C67, 0x4E4F534A, 0x004E4942
FLOAT, UNSIGNED_INT = 5126, 5125
VERTICES, ELEMENTS = 34962, 34963


def fixture_glb(
    fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit, sizes: BodySizes | None = None
) -> bytes:
    """The bytes of a fixture's GLB file.

    Parameters
    ----------
    sizes : heights of the bodies; those of :meth:`BodySizes.of` if None.

    Raises
    ------
    InputError
        For pegs of radius 0, which have no body.
    """
    bodies = fixture_bodies(fixture, workpiece, toolkit, sizes)
    return bodies_glb(bodies, f"{bodies[0].name} set-up")


def bodies_glb(bodies: Sequence[FixtureBody], name: str, part: Mesh | None = None) -> bytes:
    """The GLB file of bodies below one node of a name.

    Parameters
    ----------
    part : the mesh of the part's own shape; of its prism if None.
    """
    kinds = [kind for kind in BodyKind if any(body.kind is kind for body in bodies)]
    scene = GlbBuffer()
    nodes: list[dict[str, Any]] = [{"name": name, "children": [k + 1 for k in range(len(bodies))]}]
    meshes = []
    for number, body in enumerate(bodies):
        mesh = body_mesh(body) if part is None or body.kind is not BodyKind.PART else part
        meshes.append({"name": body.name, "primitives": [scene.add(mesh, kinds.index(body.kind))]})
        extras: dict[str, Any] = {"kind": str(body.kind)}
        if body.opens is not None:
            extras["opens"] = [body.opens[0], 0.0, 0.0 - body.opens[1]]
        nodes.append({"name": body.name, "mesh": number, "extras": extras})
    document = {
        "asset": {"version": "2.0", "generator": "workhold"},
        "scene": 0,
        "scenes": [{"name": name, "nodes": [0]}],
        "nodes": nodes,
        "meshes": meshes,
        "materials": [material(kind) for kind in kinds],
        "accessors": scene.accessors,
        "bufferViews": scene.views,
        "buffers": [{"byteLength": len(scene.content)}],
    }
    text = json.dumps(document, separators=(",", ":"), allow_nan=False).encode("ascii")
    chunks = chunk(JSON_CHUNK, text, b" ") + chunk(BINARY_CHUNK, bytes(scene.content), b"\0")
    return struct.pack("<III", MAGIC, 2, 12 + len(chunks)) + chunks


def chunk(kind: int, content: bytes, filling: bytes) -> bytes:
    """A chunk with its length and kind, filled up to a multiple of four bytes."""
    content += filling * (-len(content) % 4)
    return struct.pack("<II", len(content), kind) + content


def material(kind: BodyKind) -> dict[str, Any]:
    """The material of a kind of body; glTF asks for linear light."""
    factor = [*(linear(value) for value in COLOURS[kind]), 1.0]
    return {
        "name": str(kind),
        "pbrMetallicRoughness": {
            "baseColorFactor": factor,
            "metallicFactor": 0.1,
            "roughnessFactor": 0.7,
        },
    }


def linear(value: float) -> float:
    """Light from a value on a screen, both from 0 to 1, to six places (IEC 61966-2-1, sRGB)."""
    return round(value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4, 6)


@define
class GlbBuffer:
    """The buffer of a file, and what says where in it things are."""

    content: bytearray = field(factory=bytearray)
    views: list[dict[str, Any]] = field(factory=list)
    accessors: list[dict[str, Any]] = field(factory=list)

    def add(self, mesh: Mesh, material: int) -> dict[str, Any]:
        """Adds a mesh, and returns its primitive."""
        ends = {"min": mesh.positions.min(axis=0).tolist(), "max": mesh.positions.max(axis=0).tolist()}
        attributes = {
            "POSITION": self.accessor(mesh.positions, VERTICES, **ends),
            "NORMAL": self.accessor(mesh.normals, VERTICES),
        }
        indices = self.accessor(mesh.triangles.reshape(-1), ELEMENTS)
        return {"attributes": attributes, "indices": indices, "material": material}

    def accessor(self, values: NDArray[Any], target: int, **more: list[float]) -> int:
        """Adds an array, and returns the number of its accessor."""
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
