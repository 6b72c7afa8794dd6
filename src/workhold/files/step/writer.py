"""Writing of STEP assemblies with colours: a set-up, and jaw plates to drill.

A set-up is the part in its pose, the pegs, the clamps with their bolts, and the plates with their holes. The
frame is the vise's, in millimetres, with x to the right. Its origin is the left jaw's hole L-A1, or hole A1
of a plate, on top of the plates. The part lies there, and the pegs stand through the plates up to the part's
upper side, unless another height is given.

Jaw plates are solids with their dowel holes and bolt holes through them, their upper sides at z = 0. They
stand side by side as in the DXF drawing of the same plates.

Colours (ISO 10303-46, presentation appearance) are added to the file's text. The STEP library writes them in
the order of addresses in memory, so the same bodies would not give the same bytes. Here they follow the
bodies.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from io import BytesIO
from math import cos, isfinite, pi, sin
from pathlib import Path
from typing import Any

from workhold.errors import InputError
from workhold.files.atomic import write_bytes
from workhold.files.replacing import refuse_other_ending, refuse_output
from workhold.files.step.library import list_sub_shapes, load_step_library, occ, raise_shape
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.segment import Arc, Line, Point, Segment
from workhold.model.bodies import COLOURS, THICKNESS, BodyKind, BodySizes, FixtureBody, list_fixture_bodies
from workhold.model.dowels import JawPlate, place_plates_in_drawing
from workhold.model.fixture import Fixture
from workhold.model.pose import Pose
from workhold.model.setup import PartZero, choose_part_zero
from workhold.model.workpiece import Workpiece

__all__ = [
    "Colour",
    "make_bodies_step",
    "add_colours",
    "make_named_solids",
    "make_plates_step",
    "make_setup_step",
    "write_setup_step",
]

# The header's time stamp, so that the same set-up gives the same bytes.
TIME_STAMP = "1970-01-01T00:00:00"
# mm. Length of the axes at part zero where there are no holes whose pitch it could be.
AXIS = 10.0
# Red, green and blue from 0 to 1.
Colour = tuple[float, float, float]

NUMBER = re.compile(rb"^#(\d+)\s*=", re.MULTILINE)
BODY = re.compile(
    rb"^#\d+\s*=\s*ADVANCED_BREP_SHAPE_REPRESENTATION\(\s*'[^']*'\s*,\s*\(([#\d,\s]*)\)\s*,\s*#(\d+)\s*\)",
    re.MULTILINE,
)
SOLID = re.compile(rb"^#(\d+)\s*=\s*(?:MANIFOLD_SOLID_BREP|BREP_WITH_VOIDS)\b", re.MULTILINE)
END = b"ENDSEC;\nEND-ISO-10303-21;"


def write_setup_step(
    fixture: Fixture,
    workpiece: Workpiece,
    toolkit: Toolkit,
    path: str | Path,
    *,
    thickness: float | None = None,
    plate_thickness: float | None = None,
    peg_length: float | None = None,
    peg_height: float | None = None,
    zero: PartZero | None = None,
    overwrite: bool = False,
) -> None:
    """Write a set-up as a STEP assembly; the same set-up gives the same bytes.

    Parameters
    ----------
    thickness : height of the part in mm; if None, the height of its solid, or 10 without a solid.
    plate_thickness : thickness of all plates in mm; 10 if None. Holes go through the plates.
    peg_height : height in mm to which the pegs stand out of the plates. If None: the peg height of the part's
        solid, or without a solid the height of the part.
    peg_length : length of the pegs in mm; if None they reach down to the plates' lower sides.
    zero : part zero; if None, the one that :func:`choose_part_zero` chooses by itself.
    overwrite : whether a file that workhold has not written may be replaced.

    Raises
    ------
    InputError
        For a fixture of another part or toolkit, pegs without a radius, and a length that is not positive.
        Also for a file that cannot be written or replaced, and when the extra ``step`` is not installed.
    """
    fixture.refuse_others(workpiece, toolkit)
    refuse_other_ending(path, (".step", ".stp"), "a STEP file")
    refuse_output(path, force=overwrite)
    sizes = {
        "thickness": thickness,
        "plate_thickness": plate_thickness,
        "peg_length": peg_length,
        "peg_height": peg_height,
    }
    write_bytes(path, make_setup_step(fixture, workpiece, toolkit, zero=zero, **sizes))


def make_setup_step(
    fixture: Fixture,
    workpiece: Workpiece,
    toolkit: Toolkit,
    *,
    zero: PartZero | None = None,
    **sizes: Any,
) -> bytes:
    """Return the bytes of a set-up's STEP assembly; the arguments, with ``sizes``, are those of
    :func:`write_setup_step`.
    """
    bodies = list_fixture_bodies(fixture, workpiece, toolkit, BodySizes.from_workpiece(workpiece, **sizes))
    return make_bodies_step(bodies, toolkit, (zero or choose_part_zero(workpiece)).point, fixture.pose)


def make_bodies_step(
    bodies: Sequence[FixtureBody], toolkit: Toolkit, zero: Point, pose: Pose, part: Any = None
) -> bytes:
    """Return the bytes of a STEP assembly of a set-up's bodies, with axes drawn at part zero.

    Parameters
    ----------
    bodies : bodies of the set-up, the part first.
    zero : part zero (x, y) in mm, in the part's frame.
    pose : pose of the part.
    part : Open CASCADE's solid of the part in its pose; the prism of its body if None.

    Raises
    ------
    InputError
        When the extra ``step`` is not installed.
    """
    if part is None:
        named = make_named_solids(bodies)
    else:
        others = make_named_solids([body for body in bodies if body.kind is not BodyKind.PART])
        named = [(bodies[0].name, part, COLOURS[BodyKind.PART]), *others]
    pitch = min((min(carrier.pitch) for carrier in toolkit.plates), default=AXIS)
    axes = make_axes_at(zero, pose, pitch)
    return make_assembly(f"{bodies[0].name} set-up", [*named, ("part zero X0 Y0", axes, None)])


def make_named_solids(bodies: Sequence[FixtureBody]) -> list[tuple[str, Any, Colour]]:
    """Return (name, solid of Open CASCADE, colour) for all
    bodies; a body in several pieces gives one for each.

    Raises
    ------
    InputError
        When the extra ``step`` is not installed.
    """
    load_step_library()
    return [
        (body.name if number == 0 else f"{body.name} piece {number + 1}", solid, COLOURS[body.kind])
        for body in bodies
        for number, solid in enumerate(make_solids(body))
    ]


def make_axes_at(point: Point, pose: Pose, length: float) -> Any:
    """Return two edges at z = 0 from a point of the part: one along the part's x, ``length`` mm long, and one
    along its y, half as long.

    The point is in the part's frame, the edges in the frame of the set-up.
    """
    axes, builder = occ.TopoDS_Compound(), occ.BRep_Builder()
    builder.MakeCompound(axes)
    x, y = point
    start, *ends = (pose.apply(*p) for p in ((x, y), (x + length, y), (x, y + length / 2)))
    for end in ends:
        builder.Add(axes, make_edge(Line(start, end)))
    return axes


def make_solids(body: FixtureBody) -> list[Any]:
    """Return a body as one solid, or as one for each of its pieces."""
    first, *others = (
        extrude_border(make_wire(slab.outer), [make_wire(hole) for hole in slab.holes], slab.low, slab.high)
        for slab in body.slabs
    )
    for other in others:
        first = occ.BRepAlgoAPI_Fuse(first, other).Shape()
    return list_sub_shapes(first, "SOLID")


def make_wire(segments: Iterable[Segment]) -> Any:
    """Return Open CASCADE's closed wire at z = 0 of segments in running order."""
    maker = occ.BRepBuilderAPI_MakeWire()
    for segment in segments:
        maker.Add(make_edge(segment))
    return maker.Wire()


def make_edge(segment: Segment) -> Any:
    """Return Open CASCADE's edge at z = 0 of a segment;
    the normal of a clockwise arc's circle points down.
    """
    if isinstance(segment, Line):
        return occ.BRepBuilderAPI_MakeEdge(
            occ.gp_Pnt(*segment.start, 0.0), occ.gp_Pnt(*segment.end, 0.0)
        ).Edge()
    start = segment.mid_angle - segment.sign * segment.half_sweep
    axes = occ.gp_Ax2(
        occ.gp_Pnt(*segment.center, 0.0),
        occ.gp_Dir(0.0, 0.0, segment.sign),
        occ.gp_Dir(cos(start), sin(start), 0.0),
    )
    return occ.BRepBuilderAPI_MakeEdge(occ.gp_Circ(axes, segment.radius), 0.0, 2 * segment.half_sweep).Edge()


def extrude_border(outer: Any, holes: Sequence[Any], low: float, high: float) -> Any:
    """Return the solid between two z in mm over a wire, with holes whose wires run clockwise."""
    maker = occ.BRepBuilderAPI_MakeFace(
        occ.gp_Pln(occ.gp_Pnt(0.0, 0.0, 0.0), occ.gp_Dir(0.0, 0.0, 1.0)), outer
    )
    for hole in holes:
        maker.Add(hole)
    face = raise_shape(maker.Face(), low)
    return occ.BRepPrimAPI_MakePrism(face, occ.gp_Vec(0.0, 0.0, high - low), True).Shape()


def make_assembly(name: str, named: Sequence[tuple[str, Any, Colour | None]]) -> bytes:
    """Return the bytes of a STEP assembly of named shapes, with colours for those that have one."""
    document = occ.TDocStd_Document(occ.TCollection_ExtendedString("XmlOcaf"))
    shapes = occ.XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    compound = occ.TopoDS_Compound()
    occ.BRep_Builder().MakeCompound(compound)
    root = shapes.AddShape(compound, True)
    occ.TDataStd_Name.Set_s(root, occ.TCollection_ExtendedString(name, True))
    for word, body, _ in named:
        label = shapes.AddShape(body, False)
        occ.TDataStd_Name.Set_s(label, occ.TCollection_ExtendedString(word, True))
        placed = shapes.AddComponent(root, label, occ.TopLoc_Location())
        occ.TDataStd_Name.Set_s(placed, occ.TCollection_ExtendedString(word, True))
    shapes.UpdateAssemblies()
    writer = occ.STEPCAFControl_Writer()
    if not writer.Transfer(document, occ.STEPControl_AsIs):
        raise RuntimeError("the STEP library could not translate the set-up")
    model = writer.ChangeWriter().Model()
    header = occ.APIHeaderSection_MakeHeader(model)
    header.SetName(occ.TCollection_HAsciiString("set-up"))
    header.SetTimeStamp(occ.TCollection_HAsciiString(TIME_STAMP))
    header.SetAuthorValue(1, occ.TCollection_HAsciiString(""))
    header.SetOrganizationValue(1, occ.TCollection_HAsciiString(""))
    header.SetOriginatingSystem(occ.TCollection_HAsciiString("workhold"))
    # The library numbers the places of an assembly through the life of the process.
    entities = (model.Entity(k) for k in range(1, model.NbEntities() + 1))
    uses = (entity for entity in entities if isinstance(entity, occ.StepRepr_NextAssemblyUsageOccurrence))
    for number, use in enumerate(uses, start=1):
        use.SetId(occ.TCollection_HAsciiString(str(number)))
    stream = BytesIO()
    writer.WriteStream(stream)
    return add_colours(stream.getvalue(), [colour for _, _, colour in named if colour is not None])


def make_plates_step(plates: Sequence[JawPlate], thickness: float | None = None) -> bytes:
    """Return the bytes of a STEP assembly of jaw plates; the same plates give the same bytes.

    Parameters
    ----------
    thickness : thickness of the plates in mm; 10 if None.

    Raises
    ------
    InputError
        For a thickness that is not positive, and when the extra ``step`` is not installed.
    """
    thickness = THICKNESS if thickness is None else thickness
    if not (isfinite(thickness) and thickness > 0):
        raise InputError(f"thickness {thickness} is not a positive length: give it in mm.")
    load_step_library()
    named = [
        (f"{plate.title} plate", make_drilled_plate(plate, right, thickness), COLOURS[BodyKind.PLATE])
        for plate, right in zip(plates, place_plates_in_drawing(plates), strict=True)
    ]
    return make_assembly("jaw plates", named)


def make_drilled_plate(plate: JawPlate, right: float, thickness: float) -> Any:
    """Return the solid of a jaw plate, its upper side at
    z = 0, moved by ``right`` mm along x; lengths in mm.
    """
    corners = [(x + right, y) for x, y in plate.outline.corners]
    border = make_wire([Line(p, q) for p, q in zip(corners, corners[1:] + corners[:1], strict=True)])
    holes: list[tuple[Point, float]] = [(center, plate.hole_diameter) for _, center in plate.holes]
    if plate.bolts is not None:
        holes += [(center, plate.bolts.diameter) for center in plate.bolts.places]
    wires = [make_wire([Arc((x + right, y), diameter / 2, 0.0, pi, -1.0)]) for (x, y), diameter in holes]
    return extrude_border(border, wires, -thickness, 0.0)


def add_colours(text: bytes, colours: Sequence[Colour]) -> bytes:
    """Return the text of a STEP file with a colour for each of its bodies, in their order in the file.

    Raises RuntimeError unless the file has one body for each colour.
    """
    bodies = list(BODY.finditer(text))
    if len(bodies) != len(colours) or END not in text:
        raise RuntimeError("the STEP library has written other bodies than it was given")
    solids = {int(found[1]) for found in SOLID.finditer(text)}
    number = max(int(found[1]) for found in NUMBER.finditer(text))
    lines: list[str] = []

    def add(entity: str) -> str:
        """Append an entity to the text and return its reference, such as "#12"."""
        nonlocal number
        number += 1
        lines.append(f"#{number} = {entity};\n")
        return f"#{number}"

    styles: dict[Colour, str] = {}
    for body, colour in zip(bodies, colours, strict=True):
        if colour not in styles:
            part = add(f"COLOUR_RGB('',{','.join(f'{value:.4f}' for value in colour)})")
            for kind in (
                "FILL_AREA_STYLE_COLOUR('',{})",
                "FILL_AREA_STYLE('',({}))",
                "SURFACE_STYLE_FILL_AREA({})",
                "SURFACE_SIDE_STYLE('',({}))",
                "SURFACE_STYLE_USAGE(.BOTH.,{})",
                "PRESENTATION_STYLE_ASSIGNMENT(({}))",
            ):
                part = add(kind.format(part))
            styles[colour] = part
        parts = [int(part) for part in re.findall(rb"#(\d+)", body[1])]
        items = [add(f"STYLED_ITEM('color',({styles[colour]}),#{part})") for part in parts if part in solids]
        add(
            f"MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION('',({','.join(items)}),#{int(body[2])})"
        )
    before, end, after = text.rpartition(END)
    return before + "".join(lines).encode("ascii") + end + after
