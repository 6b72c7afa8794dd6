"""Parts from objects of other libraries, by what these can do; ezdxf is there, the others are where they are installed."""

from __future__ import annotations

import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import ezdxf
import pytest
from reading_helpers import area

import workhold
from workhold.errors import InputError
from workhold.files.part.load import read_workpiece


class Ring:
    """A ring as shapely has it, with the first corner again at the end."""

    geom_type = "LinearRing"
    __geo_interface__ = ()

    def __init__(self, coords: list[tuple[float, ...]]) -> None:
        self.coords = [*coords, coords[0]]


class Polygon:
    """A polygon as shapely has it."""

    geom_type = "Polygon"
    __geo_interface__ = ()

    def __init__(self, outline: list[tuple[float, ...]], *holes: list[tuple[float, ...]]) -> None:
        self.exterior, self.interiors = Ring(outline), [Ring(hole) for hole in holes]


def rectangle(width: float, height: float, at: float = 0.0) -> list[tuple[float, ...]]:
    return [(at, 0.0), (at + width, 0.0), (at + width, height), (at, height)]


def test_a_polygon_is_read_with_its_holes_in_mm() -> None:
    """Heights are left aside, corners that repeat are one, and a name can be given."""
    outline = [(0.0, 0.0, 7.0), (50.0, 0.0, 7.0), (50.0, 0.0, 7.0), (50.0, 30.0, 7.0), (0.0, 30.0, 7.0)]
    part = workhold.load(Polygon(outline, [(20.0, 1.0), (30.0, 1.0), (25.0, 5.0)]), name="plate")
    assert part.name == "plate" and [len(loop) for loop in part.loops] == [4, 3]
    assert part.bounds == (0.0, 0.0, 50.0, 30.0)
    assert workhold.load(Polygon(outline), unit="inch").bounds[2] == 1270.0


def test_several_polygons_are_parts() -> None:
    """The largest if none is chosen."""
    several = SimpleNamespace(
        geom_type="MultiPolygon",
        __geo_interface__={},
        geoms=[Polygon(rectangle(10, 10)), Polygon(rectangle(20, 10, at=40))],
    )
    assert area(workhold.load(several)) == pytest.approx(200)
    assert area(workhold.load(several, part_number=2)) == pytest.approx(100)


def test_chords_of_shapely_become_arcs() -> None:
    """The circle about a point, as shapely buffers it, with its own departure."""
    shapely = pytest.importorskip("shapely", reason="shapely is not installed")
    drilled = shapely.box(0, 0, 60, 40).difference(shapely.Point(20, 20).buffer(8, quad_segs=64))
    part = workhold.load(drilled)
    assert len(part.faces) == 5 and part.faces[-1].segment.radius == pytest.approx(8)  # type: ignore[union-attr]
    assert 0 < part.departure < 1e-3


def drawing(units: int = ezdxf.units.MM) -> Any:
    document = ezdxf.new()  # type: ignore[attr-defined]
    document.units = units
    document.modelspace().add_lwpolyline(
        [(0, 0, 0), (50, 0, 0), (50, 30, 0.3), (0, 30, 0)], format="xyb", close=True
    )
    document.modelspace().add_circle((20, 10), 4, dxfattribs={"layer": "HOLES"})
    return document


@pytest.mark.parametrize("units", [ezdxf.units.MM, ezdxf.units.IN])
def test_a_document_is_read_as_its_file(units: int, tmp_path: Path) -> None:
    """With the same unit, layers and remarks."""
    document = drawing(units)
    document.saveas(tmp_path / "drawing.dxf")
    for choice in ({}, {"layers": ["0"]}, {"unit": "mm"}):
        ours, theirs = (read_workpiece(one, **choice) for one in (document, tmp_path / "drawing.dxf"))
        assert ours.workpiece == theirs.workpiece and ours.remarks == theirs.remarks


def test_a_document_without_a_unit_asks() -> None:
    with pytest.raises(InputError, match="50 mm wide, or 50 in = 1,270 mm"):
        workhold.load(drawing(0))
    assert workhold.load(drawing(0), unit="mm").bounds[2] == 50.0


@pytest.mark.parametrize(
    ("part", "choice", "words"),
    [
        (None, {}, "this NoneType: a part cannot be read from it: give the path of a file"),
        ({(0, 0), (1, 0), (0, 1)}, {}, "this set: a part cannot be read from it"),
        ([1, 2], {}, "an outline of 1 corners is not possible: give x and y for every corner"),
        ([], {}, "an outline of 0 corners is not possible"),
        (["a"], {}, "a corner of an outline cannot be"),
        (
            SimpleNamespace(geom_type="Point", __geo_interface__={}),
            {},
            "a Point has no outline: give a polygon",
        ),
        (Polygon(rectangle(2, 1)), {"layers": ["0"]}, "leave layers out"),
        (Polygon(rectangle(2, 1)), {"axis": "x"}, "leave axis out"),
        (Polygon([(0.0, 0.0), (2.0, 2.0), (2.0, 0.0), (0.0, 2.0)]), {}, "this Polygon: "),
        (drawing(), {"axis": "x"}, "leave axis out"),
        (SimpleNamespace(wrapped=None), {}, "a part cannot be read from it"),
    ],
)
def test_what_cannot_be_read_is_told_in_a_sentence(part: Any, choice: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        workhold.load(part, **choice)


def test_no_library_is_imported_to_find_out() -> None:
    """Reading a polygon brings none of them along."""
    before = set(sys.modules)
    workhold.load(Polygon(rectangle(20, 10)))
    assert not {"shapely", "build123d", "cadquery", "OCP"} & (set(sys.modules) - before)


class TestShapes:
    """Shapes of Open CASCADE, wrapped as build123d and CadQuery wrap them."""

    @pytest.fixture
    def shapes(self) -> Any:
        """What makes solids."""
        pytest.importorskip("OCP", reason="the extra 'step' is not installed")
        import step_shapes

        return step_shapes

    def face(self, shapes: Any, corners: list[tuple[float, float, float]]) -> Any:
        from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakePolygon
        from OCP.gp import gp_Pnt

        ring = BRepBuilderAPI_MakePolygon(*(gp_Pnt(*corner) for corner in corners), True)
        return BRepBuilderAPI_MakeFace(ring.Wire()).Face()

    def test_a_solid_is_seen_along_an_axis(self, shapes: Any) -> None:
        """As the same solid in a STEP file; as build123d's part and builder, and CadQuery's work plane, hold it."""
        solid = shapes.cut(shapes.box(40, 30, 10), shapes.cylinder(5, 10, (20, 15, 0)))
        part = SimpleNamespace(wrapped=solid, label="plate")
        holders = [solid, part, SimpleNamespace(part=part), SimpleNamespace(vals=lambda: [part])]
        for held in holders:
            loaded = workhold.load(held)
            assert len(loaded.faces) == 5 and loaded.bounds == pytest.approx((0, 0, 40, 30))
        assert workhold.load(part).name == "plate"
        assert workhold.load(part, axis="x").bounds == pytest.approx((0, 0, 30, 10))

    def test_several_solids_are_parts(self, shapes: Any) -> None:
        both = SimpleNamespace(vals=lambda: [shapes.box(10, 10, 5), shapes.box(30, 10, 5, (50, 0, 0))])
        assert workhold.load(both).bounds == pytest.approx((50, 0, 80, 10))
        assert workhold.load(both, part_number=2).bounds == pytest.approx((0, 0, 10, 10))

    @pytest.mark.parametrize("axis", ["x", "y", "z"])
    def test_a_face_is_seen_across_the_axis_it_is_level_to(self, shapes: Any, axis: str) -> None:
        """At any height; the axis need not be told, and a wrong one is refused."""
        order = {"z": (0, 1, 2), "x": (2, 0, 1), "y": (1, 2, 0)}[axis]
        corners = [(0.0, 0.0, 4.0), (30.0, 0.0, 4.0), (25.0, 20.0, 4.0)]
        face = SimpleNamespace(wrapped=self.face(shapes, [tuple(c[k] for k in order) for c in corners]))  # type: ignore[misc]
        for choice in ({}, {"axis": axis}):
            loaded = workhold.load(face, **choice)
            assert loaded.bounds == pytest.approx((0, 0, 30, 20)) and area(loaded) == pytest.approx(300)
        with pytest.raises(InputError, match="move them there, or give axis"):
            workhold.load(face, axis={"x": "y", "y": "z", "z": "x"}[axis])

    def test_faces_beside_one_another_are_parts(self, shapes: Any) -> None:
        """A sketch of CadQuery holds them as ``_faces``; one that looks down counts as well."""
        one = self.face(shapes, [(0, 0, 0), (30, 0, 0), (30, 20, 0), (0, 20, 0)])
        other = self.face(shapes, [(50, 0, 0), (50, 10, 0), (60, 10, 0), (60, 0, 0)])
        sketch = SimpleNamespace(_faces=SimpleNamespace(vals=lambda: [one, other]))
        assert area(workhold.load(sketch)) == pytest.approx(600)
        assert area(workhold.load(sketch, part_number=2)) == pytest.approx(100)

    @pytest.mark.parametrize(
        ("choice", "words"),
        [
            ({"unit": "inch"}, "leave unit out"),
            ({"layers": ["0"]}, "leave layers out"),
            ({"section": 1}, "leave the section"),
        ],
    )
    def test_choices_that_do_not_apply_are_refused(
        self, shapes: Any, choice: dict[str, Any], words: str
    ) -> None:
        with pytest.raises(InputError, match=words):
            workhold.load(self.face(shapes, [(0, 0, 0), (3, 0, 0), (0, 2, 0)]), **choice)

    def test_an_edge_is_no_part(self, shapes: Any) -> None:
        from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge
        from OCP.gp import gp_Pnt

        with pytest.raises(InputError, match="neither a face nor a solid"):
            workhold.load(BRepBuilderAPI_MakeEdge(gp_Pnt(0, 0, 0), gp_Pnt(1, 0, 0)).Edge())
