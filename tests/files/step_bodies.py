"""Assemblies in STEP files read again by Open CASCADE, with names and colours (XCAF)."""

from __future__ import annotations

from io import BytesIO
from itertools import combinations
from typing import Any

import pytest

pytest.importorskip("OCP", reason="the extra 'step' is not installed")

from OCP.BRepAlgoAPI import BRepAlgoAPI_Common
from OCP.BRepGProp import BRepGProp
from OCP.collections import Sequence_TDF_Label
from OCP.GProp import GProp_GProps
from OCP.Quantity import Quantity_Color, Quantity_TypeOfColor
from OCP.STEPCAFControl import STEPCAFControl_Reader
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDataStd import TDataStd_Name
from OCP.TDocStd import TDocStd_Document
from OCP.XCAFDoc import XCAFDoc_ColorType, XCAFDoc_DocumentTool

from workhold.files.step.library import compute_bounding_box
from workhold.model.bodies import COLOURS, BodyKind


def named_bodies(content: bytes) -> list[tuple[str, str, Any]]:
    """Name, kind by its colour, and shape of every coloured body of an assembly, in the order of the file."""
    document, reader = TDocStd_Document(TCollection_ExtendedString("XmlOcaf")), STEPCAFControl_Reader()
    reader.ReadStream("set-up.step", BytesIO(content))
    assert reader.Transfer(document)
    shapes, found = XCAFDoc_DocumentTool.ShapeTool_s(document.Main()), Sequence_TDF_Label()
    colours = XCAFDoc_DocumentTool.ColorTool_s(document.Main())
    shapes.GetShapes(found)
    bodies = []
    for k in range(1, found.Length() + 1):
        label, colour, name = found.Value(k), Quantity_Color(), TDataStd_Name()
        shape = shapes.GetShape_s(label)
        if shapes.IsSimpleShape_s(label) and colours.GetColor(
            shape, XCAFDoc_ColorType.XCAFDoc_ColorSurf, colour
        ):
            assert label.FindAttribute(TDataStd_Name.GetID_s(), name)
            kind = next(kind for kind in BodyKind if is_near(colour, COLOURS[kind]))
            bodies.append((name.Get().ToExtString(), str(kind), shape))
    return bodies


def is_near(colour: Any, wanted: tuple[float, float, float]) -> bool:
    """Whether a colour of the library is one as on a screen."""
    other = Quantity_Color(*wanted, Quantity_TypeOfColor.Quantity_TOC_sRGB)
    return bool(colour.Distance(other) < 0.01)


def volume(shape: Any) -> float:
    """The volume of a shape in mm³."""
    found = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, found)
    return float(found.Mass())


def assert_apart(bodies: list[tuple[str, str, Any]]) -> None:
    """No two bodies of an assembly have a volume in common."""
    for (name, _, one), (other_name, _, other) in combinations(bodies, 2):
        (low, high), (least, most) = compute_bounding_box(one), compute_bounding_box(other)
        if all(low[k] < most[k] and least[k] < high[k] for k in range(3)):
            common = volume(BRepAlgoAPI_Common(one, other).Shape())
            assert abs(common) < 1e-6, (name, other_name, common)
