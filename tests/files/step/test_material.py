"""Where upright lines run inside a solid, against the library's own classification of points."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest

pytest.importorskip("OCP", reason="the extra 'step' is not installed")

from OCP.BRepPrimAPI import BRepPrimAPI_MakeCone, BRepPrimAPI_MakeSphere
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
from step_shapes import at_height, box, chamfered, cut, cylinder, filleted, fused, upright

from workhold.files.step.edge_curves import edge_curves
from workhold.files.step.faces import solid_faces
from workhold.files.step.material import Material
from workhold.files.step.plane_faces import PlaneFaces

CONE = BRepPrimAPI_MakeCone(gp_Ax2(gp_Pnt(20, 12, 8), gp_Dir(0, 0, 1)), 9.0, 4.0, 14.0).Shape()
DRILLED = cut(
    filleted(box(60, 40, 14), 6, upright),
    cylinder(4, 30, (45, 20, 6)),
    cylinder(3, 60, (30, -5, 7), (0, 1, 0)),
)
SOLIDS = {
    "drilled": chamfered(DRILLED, 1.5, at_height(14.0)),
    "boss": fused(cut(box(60, 40, 10), cylinder(5, 20, (45, 20, 4))), CONE),
    "ball": cut(box(50, 40, 20), BRepPrimAPI_MakeSphere(gp_Pnt(25, 20, 22), 15.0).Shape()),
}


@pytest.mark.parametrize("name", SOLIDS)
def test_intervals_are_where_the_library_finds_material(name: str) -> None:
    """At random points and heights a solid has material just where an interval of its upright line says so."""
    shape: Any = SOLIDS[name]
    faces = solid_faces(shape)
    material = Material(shape, faces, edge_curves(faces))
    random = np.random.default_rng(7)
    for x, y, z in random.uniform((-2.0, -2.0, -1.0), (62.0, 42.0, 24.0), (400, 3)).tolist():
        inside = any(low < z < high for low, high in material.intervals((x, y)))
        assert inside == material.is_inside((x, y), z), (x, y, z)


@pytest.mark.parametrize("passed", [[0.0, 0.0, 14.0], [0.0, 0.0, 14.0, 14.0], [0.0, 6.0, 14.0]])
def test_faces_met_twice_or_not_at_all(monkeypatch: pytest.MonkeyPatch, passed: list[float]) -> None:
    """Where a line meets two neighbours on their edge, or a face too much, each range is asked for by itself."""
    shape: Any = box(60, 40, 14)
    faces = solid_faces(shape)
    monkeypatch.setattr(Material, "heights", lambda self, point: passed)
    intervals = Material(shape, faces, edge_curves(faces)).intervals((30.0, 20.0))
    assert (intervals[0][0], intervals[-1][1]) == (0.0, 14.0)
    assert all(a[1] == b[0] for a, b in pairwise(intervals))


def test_inside_of_a_border_is_found_at_the_heights_of_its_corners() -> None:
    """Points level with corners, and with the ends of arcs, are on the right side; so are those in holes."""
    corners = [(0.0, 0.0), (30.0, 0.0), (30.0, 20.0), (0.0, 20.0)]
    lines = [(*a, b[0] - a[0], b[1] - a[1]) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]
    arcs = np.array([(20.0, 10.0, 5.0, 0.0, np.pi)])
    planes, boxes = np.array([(7.0, 0.5, 0.0)]), np.array([(0.0, 0.0, 30.0, 20.0)])
    border = PlaneFaces(planes, np.array(lines), np.array([0, 4]), arcs, np.array([0, 1]), boxes)
    for x, y in [(5.0, 10.0), (14.9, 10.0), (25.1, 10.0), (20.0, 4.9), (1e-3, 1e-3)]:
        assert border.heights((x, y)) == [7.0 + 0.5 * x]
    for point in [(20.0, 10.0), (24.9, 10.0), (-1.0, 0.0), (31.0, 20.0), (31.0, 10.0)]:
        assert border.heights(point) == []
