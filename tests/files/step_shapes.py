"""Solids for the tests of STEP files, made with Open CASCADE, and their files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("OCP", reason="the extra 'step' is not installed")

from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeWire
from OCP.BRepFilletAPI import BRepFilletAPI_MakeChamfer, BRepFilletAPI_MakeFillet
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder, BRepPrimAPI_MakePrism
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt, gp_Vec
from OCP.STEPControl import STEPControl_StepModelType, STEPControl_Writer

from workhold.files.step.library import compute_bounding_box, list_sub_shapes, load_step_library


def box(x: float, y: float, z: float, at: Sequence[float] = (0, 0, 0)) -> Any:
    """A box of a size, with its lowest corner at a point."""
    return BRepPrimAPI_MakeBox(gp_Pnt(*at), x, y, z).Solid()


def cylinder(
    radius: float, height: float, at: Sequence[float], direction: Sequence[float] = (0, 0, 1)
) -> Any:
    """A cylinder that stands on a point."""
    return BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(*at), gp_Dir(*direction)), radius, height).Solid()


def cut(shape: Any, *tools: Any) -> Any:
    """A shape without some others."""
    for tool in tools:
        shape = BRepAlgoAPI_Cut(shape, tool).Shape()
    return shape


def fused(shape: Any, *others: Any) -> Any:
    """Shapes made one."""
    for other in others:
        shape = BRepAlgoAPI_Fuse(shape, other).Shape()
    return shape


def edges_where(shape: Any, wanted: Any) -> list[Any]:
    """Edges, each once, whose bounding box corners (low, high) fulfil a condition."""
    found: list[Any] = []
    for edge in list_sub_shapes(shape, "EDGE"):
        if wanted(*compute_bounding_box(edge)) and not any(edge.IsSame(other) for other in found):
            found.append(edge)
    return found


def upright(low: Sequence[float], high: Sequence[float]) -> bool:
    """Whether an edge's box is a line along z."""
    return high[0] - low[0] < 1e-6 and high[1] - low[1] < 1e-6


def at_height(z: float) -> Any:
    """The condition that an edge lies level at a height."""
    return lambda low, high: abs(low[2] - z) < 1e-6 and abs(high[2] - z) < 1e-6


def filleted(shape: Any, radius: float, wanted: Any) -> Any:
    """A shape with some edges rounded."""
    maker = BRepFilletAPI_MakeFillet(shape)
    for edge in edges_where(shape, wanted):
        maker.Add(radius, edge)
    return maker.Shape()


def chamfered(shape: Any, size: float, wanted: Any) -> Any:
    """A shape with some edges broken."""
    maker = BRepFilletAPI_MakeChamfer(shape)
    for edge in edges_where(shape, wanted):
        maker.Add(size, edge)
    return maker.Shape()


def prism(curves: Sequence[Any], height: float) -> Any:
    """A prism along z over Open CASCADE's curves, in running order."""
    wire = BRepBuilderAPI_MakeWire()
    for curve in curves:
        wire.Add(BRepBuilderAPI_MakeEdge(curve).Edge())
    face = BRepBuilderAPI_MakeFace(wire.Wire()).Face()
    return BRepPrimAPI_MakePrism(face, gp_Vec(0, 0, height)).Shape()


def write_step(path: Path, *shapes: Any) -> Path:
    """Write shapes to a STEP file."""
    load_step_library()
    writer = STEPControl_Writer()
    for shape in shapes:
        writer.Transfer(shape, STEPControl_StepModelType.STEPControl_AsIs)
    writer.Write(str(path))
    return path
