"""GLB files read by the specification of glTF 2.0, with everything checked on the way."""

from __future__ import annotations

import json
import struct
from collections import Counter
from typing import Any

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.files.glb import make_bodies_glb
from workhold.fixels.toolkit import Toolkit
from workhold.model.bodies import BodySizes, list_fixture_bodies
from workhold.model.fixture import Fixture
from workhold.model.workpiece import Workpiece

KINDS = {5126: np.dtype("<f4"), 5125: np.dtype("<u4")}
WIDTHS = {"VEC3": 3, "SCALAR": 1}


@frozen(eq=False)
class ReadBody:
    """A node with a mesh: its positions (N, 3) in mm with z up, triangles (M, 3), and what else it says."""

    name: str
    kind: str
    material: str
    opens: list[float] | None
    positions: NDArray[np.float64]
    normals: NDArray[np.float64]
    triangles: NDArray[np.int64]

    @property
    def volume(self) -> float:
        """What its surface encloses, in mm³ (divergence theorem)."""
        a, b, c = (self.positions[self.triangles[:, k]] for k in range(3))
        return float((a * np.cross(b, c)).sum() / 6)

    @property
    def heights(self) -> tuple[float, float]:
        """Its lowest and highest z in mm."""
        return float(self.positions[:, 2].min()), float(self.positions[:, 2].max())

    def assert_closed(self) -> None:
        """Every edge, between places and not numbers of vertices, is run once each way; normals look outward."""
        places = [tuple(place) for place in self.positions]
        edges = Counter(
            (places[u], places[v]) for a, b, c in self.triangles for u, v in ((a, b), (b, c), (c, a))
        )
        assert all(count == edges[edge[::-1]] for edge, count in edges.items()), self.name
        assert all(u != v for u, v in edges), self.name
        a, b, c = (self.positions[self.triangles[:, k]] for k in range(3))
        faced = np.cross(b - a, c - a)
        along = (faced[:, None] * self.normals[self.triangles]).sum(axis=2)
        assert (along > 0.8 * np.linalg.norm(faced, axis=1)[:, None] - 1e-9).all(), self.name
        assert np.allclose(np.linalg.norm(self.normals, axis=1), 1.0, atol=1e-6)


def read_glb(content: bytes) -> tuple[dict[str, Any], list[ReadBody]]:
    """The JSON of a file, and its bodies in the order of its nodes."""
    magic, version, length = struct.unpack_from("<4sII", content)
    assert (magic, version, length) == (b"glTF", 2, len(content)) and length % 4 == 0
    size, kind = struct.unpack_from("<I4s", content, 12)
    assert kind == b"JSON" and size % 4 == 0
    document = json.loads(content[20 : 20 + size])
    binary_size, kind = struct.unpack_from("<I4s", content, 20 + size)
    assert kind == b"BIN\0" and binary_size % 4 == 0 and 28 + size + binary_size == length
    binary = content[28 + size :]
    (buffer,) = document["buffers"]
    assert buffer["byteLength"] <= binary_size < buffer["byteLength"] + 4
    assert document["asset"]["version"] == "2.0"
    ends = 0
    for view in document["bufferViews"]:
        assert view["byteOffset"] == ends and view["buffer"] == 0
        ends += view["byteLength"]
    assert ends == buffer["byteLength"]

    def values(number: int, target: int) -> NDArray[Any]:
        accessor = document["accessors"][number]
        view = document["bufferViews"][accessor["bufferView"]]
        assert view["target"] == target
        width, dtype = WIDTHS[accessor["type"]], KINDS[accessor["componentType"]]
        assert view["byteLength"] == accessor["count"] * width * dtype.itemsize
        found = np.frombuffer(binary, dtype, accessor["count"] * width, view["byteOffset"]).reshape(-1, width)
        if "min" in accessor:
            assert accessor["min"] == found.min(axis=0).tolist()
            assert accessor["max"] == found.max(axis=0).tolist()
        return found

    (top,) = document["scenes"][document["scene"]]["nodes"]
    bodies = []
    for number in document["nodes"][top]["children"]:
        node = document["nodes"][number]
        (primitive,) = document["meshes"][node["mesh"]]["primitives"]
        positions = values(primitive["attributes"]["POSITION"], 34962)
        assert "min" in document["accessors"][primitive["attributes"]["POSITION"]]
        normals = values(primitive["attributes"]["NORMAL"], 34962)
        indices = values(primitive["indices"], 34963).astype(np.int64)
        assert len(positions) == len(normals) and indices.min() >= 0 and indices.max() < len(positions)
        extras = node["extras"]
        material = document["materials"][primitive["material"]]["name"]
        opening = extras.get("opens")
        bodies.append(
            ReadBody(
                node["name"],
                extras["kind"],
                material,
                None if opening is None else [opening[0], -opening[2], opening[1]],
                z_up(positions) * 1000,
                z_up(normals),
                indices.reshape(-1, 3),
            )
        )
    assert len(document["nodes"]) == len(bodies) + 1
    return document, bodies


def z_up(vectors: NDArray[Any]) -> NDArray[np.float64]:
    """Vectors of glTF, whose y is up, with z up."""
    x, y, z = vectors.astype(np.float64).T
    return np.stack([x, -z, y], axis=1)


def fixture_glb(
    fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit, sizes: BodySizes | None = None
) -> bytes:
    """The bytes of a fixture's GLB file; the usual heights if no sizes are given."""
    bodies = list_fixture_bodies(fixture, workpiece, toolkit, sizes)
    return make_bodies_glb(bodies, f"{bodies[0].name} set-up")
