"""A set-up as a STEP assembly: the part in its pose, four pegs and two plates with their holes.

The frame is the vise's: millimetres, x to the right, the origin at the left jaw's hole L-A1. z is 0 on top of the plates;
the part lies there, and the pegs stand through the plates up to the part's upper side.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from io import BytesIO
from math import ceil, cos, floor, inf, isfinite, pi, radians, sin
from pathlib import Path
from typing import Any

from attrs import frozen

from holdfast.errors import InputError
from holdfast.files.atomic import write_bytes
from holdfast.files.step_library import load_step_library
from holdfast.geometry.intersect import bounding_box
from holdfast.geometry.segment import Arc, Line, Point, Segment
from holdfast.model.fixture import Fixture, Jaw, Pose
from holdfast.model.result import LEFT, RIGHT, hole_position
from holdfast.model.vise import Vise
from holdfast.model.workpiece import Workpiece

__all__ = ["setup_step", "write_setup_step"]

# The header's time stamp, so that the same set-up gives the same bytes.
TIME_STAMP = "1970-01-01T00:00:00"
# Of the jaw separation, how much the two plates may cover from either side: they do not touch.
SHARE_OF_GAP = 0.48
# With more holes than this a plate shows only those between its pegs and the opening.
MOST_HOLES = 2_000


def write_setup_step(
    fixture: Fixture,
    workpiece: Workpiece,
    vise: Vise,
    path: str | Path,
    *,
    thickness: float = 10.0,
    plate_thickness: float = 10.0,
) -> None:
    """Write a set-up as a STEP assembly; the same set-up gives the same bytes.

    Parameters
    ----------
    fixture, workpiece, vise : the set-up.
    path : the file.
    thickness : height of the part in mm.
    plate_thickness : of both plates, in mm; their holes go through.

    Raises
    ------
    InputError
        For pegs without a radius, a thickness that is not positive, a file that cannot be written, and when the extra
        ``step`` is not installed.
    """
    write_bytes(path, setup_step(fixture, workpiece, vise, thickness=thickness, plate_thickness=plate_thickness))


def setup_step(
    fixture: Fixture, workpiece: Workpiece, vise: Vise, *, thickness: float = 10.0, plate_thickness: float = 10.0
) -> bytes:
    """The bytes of a set-up's STEP assembly; see :func:`write_setup_step`.

    Raises
    ------
    InputError
        As :func:`write_setup_step`.
    """
    if vise.peg_radius <= 0:
        raise InputError("pegs of radius 0 have no body to write to a STEP file: give the vise a peg radius.")
    for name, value in (("thickness", thickness), ("plate thickness", plate_thickness)):
        if not (isfinite(value) and value > 0):
            raise InputError(f"{name} {value} is not a positive length: give it in mm.")
    load_step_library()
    named = [(workpiece.name, posed_part(workpiece, fixture.pose, thickness))]
    for peg in fixture.pegs:
        named.append((f"peg {peg.hole}", peg_body((peg.x, peg.y), vise.peg_radius, -plate_thickness, thickness)))
    for jaw in ("left", "right"):
        plate = plate_of(jaw, fixture, workpiece, vise)
        named.append((f"{jaw} jaw", plate_body(plate, vise.peg_radius, plate_thickness)))
    return assembly(f"{workpiece.name} set-up", named)


@frozen
class Plate:
    """A jaw's plate: its corners and the centres of its holes, in mm in the vise frame."""

    low: Point
    high: Point
    holes: tuple[Point, ...]


def plate_of(jaw: Jaw, fixture: Fixture, workpiece: Workpiece, vise: Vise) -> Plate:
    """The plate of one jaw, with the holes that the pegs and the part reach over."""
    index = LEFT if jaw == "left" else RIGHT
    origin = hole_position(vise, index, 0, 0, fixture.jaw_separation)
    pegs = [peg for peg in fixture.pegs if peg.jaw == jaw]
    columns, rows = [peg.column for peg in pegs], [peg.row for peg in pegs]
    # The column next to the opening belongs to it: the jaw separation is measured from there.
    columns.append(vise.columns - 1 if jaw == "left" else 0)
    x0, y0, x1, y1 = posed_bounds(workpiece, fixture.pose)
    wide = columns + reached(x0 - origin[0], x1 - origin[0], vise.pitch[0], vise.columns)
    high = rows + reached(y0 - origin[1], y1 - origin[1], vise.pitch[1], vise.rows)
    if count(wide) * count(high) > MOST_HOLES:
        wide, high = columns, rows
    holes = tuple(
        hole_position(vise, index, column, row, fixture.jaw_separation)
        for column in range(min(wide), max(wide) + 1)
        for row in range(min(high), max(high) + 1)
    )
    half_x, half_y = vise.pitch[0] / 2, vise.pitch[1] / 2
    inner = min(half_x, SHARE_OF_GAP * fixture.jaw_separation)
    left, right = (half_x, inner) if jaw == "left" else (inner, half_x)
    return Plate((holes[0][0] - left, holes[0][1] - half_y), (holes[-1][0] + right, holes[-1][1] + half_y), holes)


def reached(low: float, high: float, pitch: float, limit: int | None) -> list[int]:
    """First and last column or row between two distances in mm from the first one; none when they lie off the jaw."""
    last = (inf if limit is None else limit) - 1
    first_reached, last_reached = max(ceil(low / pitch), 0), min(floor(high / pitch), last)
    return [first_reached, int(last_reached)] if first_reached <= last_reached else []


def count(numbers: Sequence[int]) -> int:
    """How many columns or rows there are from the smallest to the largest."""
    return max(numbers) - min(numbers) + 1


def posed(point: Point, pose: Pose) -> Point:
    """A workpiece point in the vise frame."""
    c, s = cos(radians(pose.theta_deg)), sin(radians(pose.theta_deg))
    return c * point[0] - s * point[1] + pose.x, s * point[0] + c * point[1] + pose.y


def posed_segment(segment: Segment, pose: Pose) -> Segment:
    """A segment of the workpiece in the vise frame."""
    if isinstance(segment, Line):
        return Line(posed(segment.start, pose), posed(segment.end, pose))
    mid_angle = segment.mid_angle + radians(pose.theta_deg)
    return Arc(posed(segment.center, pose), segment.radius, mid_angle, segment.half_sweep, segment.sign)


def posed_bounds(workpiece: Workpiece, pose: Pose) -> tuple[float, float, float, float]:
    """The part's bounding box in mm in the vise frame: smallest x, y, largest x, y."""
    boxes = [bounding_box(posed_segment(segment, pose)) for segment in workpiece.loop_segments[0]]
    low_x, low_y, high_x, high_y = zip(*boxes, strict=True)
    return min(low_x), min(low_y), max(high_x), max(high_y)


def posed_part(workpiece: Workpiece, pose: Pose, thickness: float) -> Any:
    """The part as a solid from z = 0 up, in its pose."""
    outer, *holes = (
        wire([posed_segment(segment, pose) for segment in segments]) for segments in workpiece.loop_segments
    )
    return extruded(outer, holes, 0.0, thickness)


def peg_body(center: Point, radius: float, low: float, high: float) -> Any:
    """A peg as a cylinder between two heights."""
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

    return BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(*center, low), gp_Dir(0.0, 0.0, 1.0)), radius, high - low).Solid()


def plate_body(plate: Plate, radius: float, thickness: float) -> Any:
    """A plate with its holes, its upper side at z = 0."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut

    (x0, y0), (x1, y1) = plate.low, plate.high
    corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
    border = wire([Line(p, q) for p, q in zip(corners, corners[1:] + corners[:1], strict=True)])

    def whole(hole: Point) -> bool:
        return x0 < hole[0] - radius and hole[0] + radius < x1 and y0 < hole[1] - radius and hole[1] + radius < y1

    holes = [wire([Arc(hole, radius, 0.0, pi, -1.0)]) for hole in plate.holes if whole(hole)]
    body = extruded(border, holes, -thickness, 0.0)
    # Jaws that nearly close leave no material around the holes of their last columns.
    for hole in plate.holes:
        if not whole(hole):
            body = BRepAlgoAPI_Cut(body, peg_body(hole, radius, -2 * thickness, thickness)).Shape()
    return body


def wire(segments: Iterable[Segment]) -> Any:
    """A closed wire at z = 0 of segments in running order."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeWire

    maker = BRepBuilderAPI_MakeWire()
    for segment in segments:
        maker.Add(edge(segment))
    return maker.Wire()


def edge(segment: Segment) -> Any:
    """A segment as an edge at z = 0; the circle of an arc run clockwise looks down."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge
    from OCP.gp import gp_Ax2, gp_Circ, gp_Dir, gp_Pnt

    if isinstance(segment, Line):
        return BRepBuilderAPI_MakeEdge(gp_Pnt(*segment.start, 0.0), gp_Pnt(*segment.end, 0.0)).Edge()
    start = segment.mid_angle - segment.sign * segment.half_sweep
    axes = gp_Ax2(gp_Pnt(*segment.center, 0.0), gp_Dir(0.0, 0.0, segment.sign), gp_Dir(cos(start), sin(start), 0.0))
    return BRepBuilderAPI_MakeEdge(gp_Circ(axes, segment.radius), 0.0, 2 * segment.half_sweep).Edge()


def extruded(outer: Any, holes: Sequence[Any], low: float, high: float) -> Any:
    """The solid between two heights over a border with holes, which run clockwise."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
    from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism
    from OCP.gp import gp_Dir, gp_Pln, gp_Pnt, gp_Trsf, gp_Vec
    from OCP.TopLoc import TopLoc_Location

    maker = BRepBuilderAPI_MakeFace(gp_Pln(gp_Pnt(0.0, 0.0, 0.0), gp_Dir(0.0, 0.0, 1.0)), outer)
    for hole in holes:
        maker.Add(hole)
    move = gp_Trsf()
    move.SetTranslation(gp_Vec(0.0, 0.0, low))
    face = maker.Face().Moved(TopLoc_Location(move))
    return BRepPrimAPI_MakePrism(face, gp_Vec(0.0, 0.0, high - low), True).Shape()


def assembly(name: str, named: Sequence[tuple[str, Any]]) -> bytes:
    """The STEP file of an assembly of named bodies."""
    from OCP.APIHeaderSection import APIHeaderSection_MakeHeader
    from OCP.BRep import BRep_Builder
    from OCP.STEPCAFControl import STEPCAFControl_Writer
    from OCP.STEPControl import STEPControl_StepModelType
    from OCP.StepRepr import StepRepr_NextAssemblyUsageOccurrence
    from OCP.TCollection import TCollection_ExtendedString, TCollection_HAsciiString
    from OCP.TDataStd import TDataStd_Name
    from OCP.TDocStd import TDocStd_Document
    from OCP.TopLoc import TopLoc_Location
    from OCP.TopoDS import TopoDS_Compound
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    document = TDocStd_Document(TCollection_ExtendedString("XmlOcaf"))
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    compound = TopoDS_Compound()
    BRep_Builder().MakeCompound(compound)
    root = shapes.AddShape(compound, True)
    TDataStd_Name.Set_s(root, TCollection_ExtendedString(name, True))
    for word, body in named:
        label = shapes.AddShape(body, False)
        TDataStd_Name.Set_s(label, TCollection_ExtendedString(word, True))
        placed = shapes.AddComponent(root, label, TopLoc_Location())
        TDataStd_Name.Set_s(placed, TCollection_ExtendedString(word, True))
    shapes.UpdateAssemblies()
    writer = STEPCAFControl_Writer()
    if not writer.Transfer(document, STEPControl_StepModelType.STEPControl_AsIs):
        raise RuntimeError("the STEP library could not translate the set-up")
    model = writer.ChangeWriter().Model()
    header = APIHeaderSection_MakeHeader(model)
    header.SetName(TCollection_HAsciiString("set-up"))
    header.SetTimeStamp(TCollection_HAsciiString(TIME_STAMP))
    header.SetAuthorValue(1, TCollection_HAsciiString(""))
    header.SetOrganizationValue(1, TCollection_HAsciiString(""))
    header.SetOriginatingSystem(TCollection_HAsciiString("holdfast"))
    # The library numbers the places of an assembly through the life of the process.
    entities = (model.Entity(k) for k in range(1, model.NbEntities() + 1))
    uses = (entity for entity in entities if isinstance(entity, StepRepr_NextAssemblyUsageOccurrence))
    for number, use in enumerate(uses, start=1):
        use.SetId(TCollection_HAsciiString(str(number)))
    stream = BytesIO()
    writer.WriteStream(stream)
    return stream.getvalue()
