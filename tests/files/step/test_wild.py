"""STEP files as programs write them: splines for everything, edges near their walls, placements, splinters, no solid."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("OCP", reason="the extra 'step' is not installed")

from OCP.BRep import BRep_Builder
from OCP.BRepBuilderAPI import BRepBuilderAPI_Copy, BRepBuilderAPI_NurbsConvert, BRepBuilderAPI_Transform
from OCP.BRepPrimAPI import BRepPrimAPI_MakeSphere
from OCP.collections import Array1_gp_Pnt
from OCP.GC import GC_MakeSegment
from OCP.Geom import Geom_BezierCurve
from OCP.gp import gp_Ax1, gp_Ax2, gp_Dir, gp_Pnt, gp_Trsf, gp_Vec
from OCP.ShapeFix import ShapeFix_ShapeTolerance
from OCP.STEPCAFControl import STEPCAFControl_Writer
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDocStd import TDocStd_Document
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Compound
from OCP.XCAFDoc import XCAFDoc_DocumentTool
from step_shapes import box, cut, cylinder, filleted, fused, prism, upright, write_step

from solid_examples import EXAMPLES
from workhold import load
from workhold.errors import InputError
from workhold.files.part.load import read_workpiece
from workhold.files.step.heights import measure_outline, stand_solid
from workhold.files.step.level_faces import find_bottom_loops, find_open_level_tops
from workhold.files.step.library import list_sub_shapes
from workhold.geometry.loop import compute_signed_area, make_loop_segments

PLATE = cut(filleted(box(60, 40, 20), 5, upright), cylinder(6, 40, (30, 20, -5)))


def rotation(angle: float, *axis: float) -> gp_Trsf:
    """A turn about an axis through the origin, in radians."""
    turn = gp_Trsf()
    turn.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(*axis)), angle)
    return turn


def moved(angle: float) -> gp_Trsf:
    """A turn about z and a way off the origin."""
    step = gp_Trsf()
    step.SetTranslation(gp_Vec(1234.567, -345.678, 99.1))
    return step.Multiplied(rotation(angle, 0, 0, 1))


def mirror() -> gp_Trsf:
    """The mirror image in x = 0."""
    image = gp_Trsf()
    image.SetMirror(gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(1, 0, 0)))
    return image


def larger() -> gp_Trsf:
    """25.4 times as large."""
    scale = gp_Trsf()
    scale.SetScale(gp_Pnt(0, 0, 0), 25.4)
    return scale


def figures(shape: Any, high: float, scale: float = 1.0) -> list[float]:
    """Area, border, touchable border, pieces, and areas of the faces below and on top, in the first size."""
    solid = stand_solid(shape)
    outline = solid.make_outline(scale * high, 0.5 * scale, scale)
    area, border, touchable, band = measure_outline(outline)
    level = [
        sum(compute_signed_area(make_loop_segments(loop)) for loop in loops)
        for loops in (
            find_bottom_loops(solid),
            [loop for top in find_open_level_tops(solid) for loop in top.open],
        )
    ]
    lengths = [border / scale, touchable / scale, band / scale, len(outline.loops)]
    return [area / scale**2, *lengths, *(one / scale**2 for one in level)]


WAYS = {
    "splines": lambda shape: BRepBuilderAPI_NurbsConvert(shape, True).Shape(),
    "moved": lambda shape: shape.Moved(TopLoc_Location(moved(0.5))),
    "mirrored": lambda shape: BRepBuilderAPI_Transform(shape, mirror(), True).Shape(),
    "larger": lambda shape: BRepBuilderAPI_Transform(shape, larger(), True).Shape(),
}
# What is a spline by then is refused, with the place.
NOT_AS_SPLINES = ("lying shaft", "valve body")


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize(
    "example",
    [
        pytest.param(
            one, id=one.name, marks=() if k % 3 == 0 or one.name == "cross drilled" else pytest.mark.prove
        )
        for k, one in enumerate(EXAMPLES)
    ],
)
def test_the_same_solid_written_otherwise(example: Any, way: str) -> None:
    """As splines, turned and moved, mirrored, and 25.4 times as large, a solid has the same outline and level faces."""
    shape = example.make()
    for high in example.heights:
        other = WAYS[way](shape)
        try:
            found = figures(other, high, 25.4 if way == "larger" else 1.0)
        except InputError as error:
            assert way == "splines" and example.name in NOT_AS_SPLINES and "does not close at" in str(error)
            continue
        assert found == pytest.approx(figures(shape, high), rel=1e-6, abs=1e-4)


def test_edges_off_their_walls_by_a_thousandth(tmp_path: Path) -> None:
    """Edges with a wide tolerance, as a repair leaves them, read as the part that they are of."""
    loose = BRepBuilderAPI_Copy(PLATE).Shape()
    ShapeFix_ShapeTolerance().SetTolerance(loose, 1e-3)
    one, other = (
        load(write_step(tmp_path / "part.step", shape), peg_height=12.0) for shape in (PLATE, loose)
    )
    assert one == other


def test_assembly_with_placements(tmp_path: Path) -> None:
    """The same part placed twice is two solids where the assembly has them, each as it lies there."""
    document = TDocStd_Document(TCollection_ExtendedString("BinXCAF"))
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    root, label = shapes.NewShape(), shapes.AddShape(PLATE, False)
    for turn in (moved(0.0), rotation(np.pi / 2, 1, 0, 0)):
        shapes.AddComponent(root, label, TopLoc_Location(turn))
    shapes.UpdateAssemblies()
    writer = STEPCAFControl_Writer()
    writer.Transfer(document)
    writer.Write(str(tmp_path / "assembly.step"))
    sizes = set()
    for number in (1, 2):
        loaded = read_workpiece(tmp_path / "assembly.step", part_number=number, peg_height=12.0)
        assert "The file holds 2 solids" in loaded.remarks[0]
        x0, y0, x1, y1 = loaded.workpiece.bounds
        assert loaded.workpiece.solid is not None
        sizes.add((round(x1 - x0), round(y1 - y0), round(loaded.workpiece.solid.height)))
    assert sizes == {(60, 40, 20), (60, 20, 40)}


def test_surfaces_without_a_solid_are_refused(tmp_path: Path) -> None:
    """Faces alone, also those of a closed part, are none of a solid."""
    together, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(together)
    for face in list_sub_shapes(PLATE, "FACE")[1:]:
        builder.Add(together, face)
    with pytest.raises(InputError, match=r"surfaces \(10\) but no solid: export the part as a closed solid"):
        load(write_step(tmp_path / "part.step", together), peg_height=12.0)


def spline_block() -> Any:
    """A block with a wall that is a true spline."""
    poles = Array1_gp_Pnt(1, 4)
    for k, point in enumerate([(60, 0), (75, 15), (48, 25), (60, 40)], start=1):
        poles.SetValue(k, gp_Pnt(*point, 0))
    corners = [gp_Pnt(60, 40, 0), gp_Pnt(0, 40, 0), gp_Pnt(0, 0, 0), gp_Pnt(60, 0, 0)]
    sides = [GC_MakeSegment(a, b).Value() for a, b in pairwise(corners)]
    return prism([Geom_BezierCurve(poles), *sides], 20)


def test_true_splines(tmp_path: Path) -> None:
    """A spline over the foot of a part is no matter; one in the outline is refused with the wall's name and a height."""
    stands = fused(box(80, 40, 10, (0, 0, -10)), spline_block())
    path = write_step(tmp_path / "part.step", stands)
    assert load(path, peg_height=12.0).bounds == pytest.approx((0, 0, 80, 40))
    with pytest.raises(InputError, match=r"neither line nor arc: a free-form wall .* give peg_height 30mm"):
        load(path, axis="-z", peg_height=12.0)


def test_silhouette_whose_heights_are_not_known_says_so(tmp_path: Path) -> None:
    """A ball is read as a silhouette; that nothing tells where pegs touch it is said with what helps."""
    ball = BRepPrimAPI_MakeSphere(gp_Pnt(0, 0, 0), 9).Shape()
    loaded = read_workpiece(write_step(tmp_path / "ball.step", ball))
    assert loaded.workpiece.solid is None
    assert loaded.remarks[-1].startswith(
        "At which heights its faces are touched is not known: along z no upright"
    )
    spline = read_workpiece(write_step(tmp_path / "spline.step", spline_block()), fit=0.01)
    assert not any("is not known" in remark for remark in spline.remarks)
