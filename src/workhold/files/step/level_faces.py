"""The level faces of a standing solid that supports and a clamp on top may touch."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from workhold.conventions import SAME_HEIGHT
from workhold.errors import InputError
from workhold.files.outline.chain import Chain
from workhold.files.step.faces import SolidFace
from workhold.files.step.heights import StandingSolid
from workhold.files.step.regions import borders, level_region
from workhold.geometry.loop import loop_segments, reversed_vertices, signed_area
from workhold.geometry.segment import segment_rows
from workhold.kernels.base.distance import is_inside, outline_distances

__all__ = ["bottom_loops", "top_loops"]

Array = NDArray[np.float64]
# Points across a face, each way, at which what lies above it is asked for; how far from its border, in mm.
ACROSS, OFF = 12, 1e-3


def bottom_loops(solid: StandingSolid) -> list[Array]:
    """Loops (N, 3) of the faces on which the part lies: outer ones counter-clockwise, openings clockwise."""
    lying = [
        face for face in solid.faces if face.lie == "level" and not face.upward and face.low <= SAME_HEIGHT
    ]
    return [loop for face in lying for loop in loops_of(face)]


def top_loops(solid: StandingSolid) -> list[Array]:
    """Loops (N, 3) of level faces with nothing of the solid above them, at whatever height."""
    found: list[Array] = []
    for face in solid.faces:
        if face.lie == "level" and face.upward:
            loops = loops_of(face)
            if loops and is_free(solid, face, loops):
                found += loops
    return found


def loops_of(face: SolidFace) -> list[Array]:
    """Loops of a level face; none where its border is not made of lines and arcs alone."""
    try:
        edges = borders(level_region(face.shape, face.low, face.upward))
    except InputError:
        return []
    if edges.curves:
        return []
    loops = sorted(map(vertices_of, edges.chains), key=lambda loop: -abs(signed_area(loop_segments(loop))))
    return [
        loop if (signed_area(loop_segments(loop)) > 0) == (number == 0) else reversed_vertices(loop)
        for number, loop in enumerate(loops)
    ]


def vertices_of(chain: Chain) -> Array:
    """Vertices (N, 3) of a closed chain."""
    return np.column_stack([np.array(chain.points[:-1]), np.array(chain.bulges)])


def is_free(solid: StandingSolid, face: SolidFace, loops: Sequence[Array]) -> bool:
    """Whether nothing of a solid lies above a level face: no edge passes over it, nor material."""
    rows = segment_rows([segment for loop in loops for segment in loop_segments(loop)])
    above = [edge.points for edge in solid.edges if edge.high > face.low + SAME_HEIGHT]
    over = np.concatenate([np.zeros((0, 3)), *above])
    over = over[over[:, 2] > face.low + SAME_HEIGHT][:, :2]
    x0, y0, x1, y1 = face.box
    shares = (np.arange(ACROSS) + 0.37) / ACROSS
    grid = np.stack(np.meshgrid(x0 + shares * (x1 - x0), y0 + shares * (y1 - y0)), axis=-1).reshape(-1, 2)
    if len(within(over, rows)):
        return False
    return all(
        max((end for _, end in solid.material.intervals((float(x), float(y)))), default=0.0)
        <= face.low + SAME_HEIGHT
        for x, y in within(grid, rows)
    )


def within(points: Array, rows: Array) -> Array:
    """Points (N, 2) that lie on a face, farther than rounding from its border."""
    if not len(points):
        return points
    inside = np.array([bool(is_inside(x, y, rows)) for x, y in points.tolist()])
    return points[inside & (outline_distances(np.ascontiguousarray(points), rows) > OFF)]
