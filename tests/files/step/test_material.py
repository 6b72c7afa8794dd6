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

from workhold.files.step.edge_curves import list_edge_curves
from workhold.files.step.faces import list_solid_faces
from workhold.files.step.material import Material, PlaneFaces

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
    faces = list_solid_faces(shape)
    material = Material(shape, faces, list_edge_curves(faces))
    random = np.random.default_rng(7)
    for x, y, z in random.uniform((-2.0, -2.0, -1.0), (62.0, 42.0, 24.0), (400, 3)).tolist():
        inside = any(low < z < high for low, high in material.find_material_intervals((x, y)))
        assert inside == material.is_inside((x, y), z), (x, y, z)


FUNNEL = cut(
    box(60, 40, 20), BRepPrimAPI_MakeCone(gp_Ax2(gp_Pnt(30, 20, 2), gp_Dir(0, 0, 1)), 0.0, 25.0, 30.0).Shape()
)
CONES = {
    "one with gaps": cut(
        CONE, *(cylinder(1.5, 30, (20 + x, 12 + y, 5)) for x in (-6, 0, 6) for y in (-6, 6))
    ),
    "one cut aslant": cut(CONE, box(20, 20, 8, (22, 9, 15)), cylinder(2, 40, (0, 12, 14), (1, 0, 0))),
    "a funnel to its tip": FUNNEL,
    "upside down": BRepPrimAPI_MakeCone(gp_Ax2(gp_Pnt(20, 12, 22), gp_Dir(0, 0, -1)), 9.0, 0.0, 14.0).Shape(),
}


@pytest.mark.parametrize("name", CONES)
def test_upright_cones_are_met_where_the_library_meets_them(name: str) -> None:
    """A line passes a cone at the very heights that the library finds, also beside the cone's edges."""
    from OCP.gp import gp_Lin
    from OCP.IntCurvesFace import IntCurvesFace_Intersector

    faces = [face for face in list_solid_faces(CONES[name]) if face.kind == "cone"]
    edges = list_edge_curves(faces)
    flat, others = PlaneFaces.from_faces(faces, edges)
    assert bool(others) == (name == "one cut aslant")
    random = np.random.default_rng(5)
    met = 0
    for point in [*random.uniform((5.0, 0.0), (55.0, 40.0), (300, 2)).tolist(), *beside(edges, random)]:
        found = []
        for face in faces:
            asked = IntCurvesFace_Intersector(face.shape, 1e-9)
            asked.Perform(gp_Lin(gp_Pnt(*point, -9.0), gp_Dir(0.0, 0.0, 1.0)), -1.0, 1e3)
            found += [asked.WParameter(k) - 9.0 for k in range(1, asked.NbPnt() + 1)]
        if not others:
            assert sorted(flat.find_crossing_heights(tuple(point))) == pytest.approx(
                sorted(found), abs=1e-9
            ), point
        met += len(found)
    assert met > 20


def beside(edges: Any, random: np.random.Generator) -> list[list[float]]:
    """Points a few 0.0001 mm beside edges that are seen from above."""
    points = [point[:2] for edge in edges if edge.segment for point in edge.points[1:-1]]
    return [(point + random.uniform(-4e-4, 4e-4, 2)).tolist() for point in points]


@pytest.mark.parametrize("passed", [[0.0, 0.0, 14.0], [0.0, 0.0, 14.0, 14.0], [0.0, 6.0, 14.0]])
def test_faces_met_twice_or_not_at_all(monkeypatch: pytest.MonkeyPatch, passed: list[float]) -> None:
    """Where a line meets two neighbours on their edge, or a face too much, each range is asked for by itself."""
    shape: Any = box(60, 40, 14)
    faces = list_solid_faces(shape)
    monkeypatch.setattr(Material, "find_crossing_heights", lambda self, point, near: passed)
    intervals = Material(shape, faces, list_edge_curves(faces)).find_material_intervals((30.0, 20.0))
    assert (intervals[0][0], intervals[-1][1]) == (0.0, 14.0)
    assert all(a[1] == b[0] for a, b in pairwise(intervals))


def test_inside_of_a_border_is_found_at_the_heights_of_its_corners() -> None:
    """Points level with corners, and with the ends of arcs, are on the right side; so are those in holes."""
    corners = [(0.0, 0.0), (30.0, 0.0), (30.0, 20.0), (0.0, 20.0)]
    lines = [(*a, b[0] - a[0], b[1] - a[1]) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]
    arcs = np.array([(20.0, 10.0, 5.0, 0.0, np.pi)])
    planes, boxes = np.array([(7.0, 0.5, 0.0, 0.0, 0.0, 0.0)]), np.array([(0.0, 0.0, 30.0, 20.0)])
    border = PlaneFaces(planes, np.array(lines), np.array([0, 4]), arcs, np.array([0, 1]), boxes)
    for x, y in [(5.0, 10.0), (14.9, 10.0), (25.1, 10.0), (20.0, 4.9), (1e-3, 1e-3)]:
        assert border.find_crossing_heights((x, y)) == [7.0 + 0.5 * x]
    for point in [(20.0, 10.0), (24.9, 10.0), (-1.0, 0.0), (31.0, 20.0), (31.0, 10.0)]:
        assert border.find_crossing_heights(point) == []
