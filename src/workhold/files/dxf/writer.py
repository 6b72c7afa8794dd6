"""Writing of DXF drawings: a set-up for a CAM system, and the jaw plates to drill.

A set-up shows the part in its pose, pegs, holes and plates on layers of their own. The geometry is exact, in
millimetres in the vise frame, whose origin is the left jaw's hole L-A1, or hole A1 of a plate. Lines and arcs
of the part are closed LWPOLYLINEs with bulges; whole circles, pegs and holes are CIRCLEs.

Jaw plates stand side by side, each with its outline, holes and bolts. The first plate's hole A1 is at (0, 0);
each other stands at the right of the one before it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from io import StringIO
from math import tan
from typing import TYPE_CHECKING

from ezdxf import options, units  # type: ignore[attr-defined]
from ezdxf.enums import TextEntityAlignment
from ezdxf.filemanagement import new

from workhold.fixels.carrier import Carrier, make_column_letters
from workhold.fixels.pegs import make_peg_outline
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.segment import Arc, Point, Segment
from workhold.model.dowels import JawPlate, place_plates_in_drawing
from workhold.model.fixture import Fixture
from workhold.model.pose import Pose
from workhold.model.setup import PartZero, choose_part_zero
from workhold.model.shown import MOST_HOLES, ShownSetUp, find_shown
from workhold.model.workpiece import Workpiece

if TYPE_CHECKING:
    from ezdxf.document import Drawing
    from ezdxf.layouts.layout import Modelspace

__all__ = [
    "CLEARANCE",
    "PLATE_LAYERS",
    "write_drawing_bytes",
    "list_layer_colours",
    "make_plates_dxf",
    "make_setup_dxf",
]

# Layer names and their AutoCAD colour numbers; besides, each carrier has a layer, such as JAW_LEFT, PLATE or
# CLAMP, the pegs have one, PEGS or LOCATORS, and so has what is set, OPENING or CLAMP_SETTING.
PART, HOLES, OTHERS = {"PART": 7}, {"KEEP_OUT": 30, "HOLES": 8, "HOLES_USED": 1}, {"PART_ZERO": 2, "TEXT": 7}
PEGS, SETTING = 1, 6
STILL, SLIDING = 5, 3
# mm. How far the cutter is to keep off the pegs where nobody says.
CLEARANCE = 1.0
VERSION = "R2010"
# Sizes as shares of the smaller pitch: height of text, and length of the axes at the part's zero.
TEXT_HEIGHT, AXIS = 0.3, 1.0
# The head of the arrow behind a clamp: its length and half its width, as shares of the pitch.
ARROW_HEAD, HALF_HEAD = 0.3, 0.12
# Radius of a hole whose pegs are points, as a share of the pitch.
POINT_HOLE = 1 / 7


def make_setup_dxf(
    fixture: Fixture,
    workpiece: Workpiece,
    toolkit: Toolkit,
    zero: PartZero | None = None,
    clearance: float = CLEARANCE,
) -> bytes:
    """Return the bytes of a set-up's DXF drawing; the same set-up gives the same bytes.

    Parameters
    ----------
    zero : part zero; if None, the one that :func:`choose_part_zero` chooses by itself.
    clearance : distance that the cutter must keep from the pegs' bodies, in mm.
    """
    with make_drawing(list_layer_colours(toolkit)) as document:
        space, seen = document.modelspace(), find_shown(fixture, toolkit, workpiece)
        add_carriers(space, seen)
        for wall in seen.walls:
            space.add_lwpolyline(
                wall.bar.corners, close=True, dxfattribs={"layer": name_plate_layer(wall.carrier)}
            )
        add_part(space, workpiece.apply_pose(fixture.pose))
        add_pegs(space, seen, clearance)
        add_clamps(space, seen, clearance)
        add_travel(space, seen)
        add_zero(space, fixture.pose, (zero or choose_part_zero(workpiece)).point, AXIS * seen.pitch)
        return write_drawing_bytes(document)


@contextmanager
def make_drawing(layers: Mapping[str, int]) -> Iterator[Drawing]:
    """Yield a new ezdxf drawing in mm with layers of the given colours; it must be written inside the block.

    Within the block ezdxf writes no times and no random numbers, so that the same content gives the same
    bytes.
    """
    before = options.write_fixed_meta_data_for_testing
    options.write_fixed_meta_data_for_testing = True
    try:
        document = new(VERSION)
        document.units = units.MM
        document.header["$MEASUREMENT"] = 1
        document.header["$LASTSAVEDBY"] = "workhold"
        for name, color in layers.items():
            document.layers.add(name, color=color)
        yield document
    finally:
        options.write_fixed_meta_data_for_testing = before


def write_drawing_bytes(document: Drawing) -> bytes:
    """Return the bytes of a drawing, with its classes sorted: ezdxf would add them in a random order."""
    for name in sorted(document.entitydb.dxf_types_in_use()):
        document.classes.add_class(name)
    stream = StringIO()
    document.write(stream)
    return document.encode(stream.getvalue())


def name_plate_layer(carrier: Carrier) -> str:
    """Return the name of the layer for a carrier's plate or body.

    >>> from workhold import Vise
    >>> [name_plate_layer(carrier) for carrier in Vise(pitch=10, columns=2, peg_radius=3).carriers]
    ['JAW_LEFT', 'JAW_RIGHT']
    """
    if not (carrier.has_lattice and carrier.letter):
        return carrier.noun.upper()
    return f"{carrier.noun}_{carrier.name}".upper()


def name_peg_layer(carrier: Carrier) -> str:
    """Return the name of the layer for a carrier's pegs; for a clamp, the name of the layer for its body."""
    return f"{carrier.peg}s".upper() if carrier.has_lattice else name_plate_layer(carrier)


def name_setting_layer(mover: Carrier) -> str:
    """Return the name of the layer for the length to which a moving
    carrier, such as a jaw or a clamp, has to be set.
    """
    return "OPENING" if mover.has_lattice else f"{name_plate_layer(mover)}_SETTING"


def list_layer_colours(toolkit: Toolkit) -> dict[str, int]:
    """Return the AutoCAD colour number of each layer of a toolkit's set-ups, by layer name.

    >>> from workhold import Plate
    >>> print(*list_layer_colours(Plate(pitch=20, peg_radius=5)))
    PART LOCATORS CLAMP KEEP_OUT HOLES HOLES_USED CLAMP_SETTING PART_ZERO TEXT PLATE
    """
    moving = [carrier for carrier in toolkit.carriers if carrier.travel is not None]
    return {
        **PART,
        **{name_peg_layer(carrier): PEGS for carrier in toolkit.carriers if carrier.contact.is_placed},
        **HOLES,
        **{name_setting_layer(carrier): SETTING for carrier in moving},
        **OTHERS,
        **{
            name_plate_layer(carrier): SLIDING if carrier in moving else STILL for carrier in toolkit.carriers
        },
    }


def add_part(space: Modelspace, part: Workpiece) -> None:
    """Add the outline of a part, which is in its pose, on the layer PART."""
    number = 0
    for loop in part.loops:
        face = next(face for face in part.faces if number in face.segments)
        number += len(loop)
        if isinstance(face.segment, Arc) and face.segment.is_full:
            space.add_circle(face.segment.center, face.segment.radius, {"layer": "PART"})
        else:
            space.add_lwpolyline(loop.tolist(), format="xyb", close=True, dxfattribs={"layer": "PART"})


def add_pegs(space: Modelspace, seen: ShownSetUp, clearance: float) -> None:
    """Add all pegs, the circles around them that the cutter must not enter, and the names of their holes.

    ``clearance`` in mm is the distance of those circles from the pegs' bodies.
    """
    for each in seen.carriers:
        for peg in each.pegs:
            if each.carrier.peg_radius > 0:
                outline = make_peg_outline(
                    (peg.x, peg.y), each.carrier.peg_radius, each.carrier.flat, peg.flat_deg
                )
                add_outline(space, outline, name_peg_layer(each.carrier))
            else:
                space.add_point((peg.x, peg.y), {"layer": name_peg_layer(each.carrier)})
            out = each.carrier.body_radius + clearance
            if out > 0:
                space.add_circle((peg.x, peg.y), out, {"layer": "KEEP_OUT"})
            add_text(space, peg.hole, (peg.x, peg.y), seen)


def add_clamps(space: Modelspace, seen: ShownSetUp, clearance: float) -> None:
    """Add each clamp's tip, its body with an arrow behind it, the area that the
    cutter must not enter, and the name of its hole.
    """
    for clamp in seen.clamps:
        layer = {"layer": name_plate_layer(clamp.carrier)}
        radius, tip = clamp.carrier.peg_radius, (clamp.tip.x, clamp.tip.y)
        if radius > 0:
            space.add_circle(tip, radius, layer)
        else:
            space.add_point(tip, layer)
        if clamp.hole is not None and radius > 0:
            add_outline(space, clamp.make_outline(), name_plate_layer(clamp.carrier))
        if radius + clearance > 0:
            add_outline(space, clamp.make_outline(clearance), "KEEP_OUT")
        head, half = radius + ARROW_HEAD * clamp.pitch, HALF_HEAD * clamp.pitch
        for away, aside in ((radius + clamp.pitch, 0.0), (head, half), (head, -half)):
            space.add_line(clamp.compute_point_behind(radius), clamp.compute_point_behind(away, aside), layer)
        add_text(space, clamp.tip.hole, clamp.back, seen)


def add_outline(space: Modelspace, outline: Sequence[Segment], layer: str) -> None:
    """Add a closed outline on a layer: one full circle, or segments as a polyline with bulges."""
    first = outline[0]
    if isinstance(first, Arc) and first.is_full:
        space.add_circle(first.center, first.radius, {"layer": layer})
        return
    bulges = [piece.sign * tan(piece.half_sweep / 2) if isinstance(piece, Arc) else 0.0 for piece in outline]
    points = [(*piece.start, bulge) for piece, bulge in zip(outline, bulges, strict=True)]
    space.add_lwpolyline(points, format="xyb", close=True, dxfattribs={"layer": layer})


def add_text(space: Modelspace, words: str, at: Point, seen: ShownSetUp) -> None:
    """Add words centred at a point (x, y), on the layer TEXT."""
    text = space.add_text(words, height=TEXT_HEIGHT * seen.pitch, dxfattribs={"layer": "TEXT"})
    text.set_placement(at, align=TextEntityAlignment.MIDDLE_CENTER)


def add_carriers(space: Modelspace, seen: ShownSetUp) -> None:
    """Add each carrier's plate, its holes, and the names of its columns and rows."""
    for each in seen.carriers:
        carrier, plate = each.carrier, each.plate
        space.add_lwpolyline(plate.corners, close=True, dxfattribs={"layer": name_plate_layer(carrier)})
        half_x, half_y = carrier.pitch[0] / 2, carrier.pitch[1] / 2
        holes = each.list_holes(MOST_HOLES)
        for hole in holes:
            radius = carrier.peg_radius or POINT_HOLE * min(carrier.pitch)
            space.add_circle(hole.center, radius, {"layer": "HOLES_USED" if hole.used else "HOLES"})
        beside = plate.x0 - half_x if each.names_at == "left" else plate.x1 + half_x
        below = plate.y1 + half_y if "bottom" in each.facing else plate.y0 - half_y
        columns, rows = {hole.column for hole in holes}, {hole.row for hole in holes}
        for column, x in each.named_columns:
            if column in columns:
                add_text(space, make_column_letters(column), (x, below), seen)
        for row, y in each.named_rows:
            if row in rows:
                add_text(space, str(row + 1), (beside, y), seen)


def add_travel(space: Modelspace, seen: ShownSetUp) -> None:
    """Add each length to set as a dimension, with the axes that it is measured between.

    Dimensions are drawn outside the plates; several in the same direction are drawn one outside the other.
    """
    for number, measured in enumerate(seen.measured):
        setting, layer = measured.setting, {"layer": name_setting_layer(measured.setting.carrier)}
        farther = 1 + sum(one.is_upright == measured.is_upright for one in seen.measured[:number])
        (x0, y0), (x1, y1) = (high for _, high in measured.axes)
        pitch_x, pitch_y = setting.carrier.pitch
        if measured.is_upright:
            out = max(x0, x1) + farther * pitch_x
            start, end, name_at = (out, y0), (out, y1), (out + pitch_x / 2, (y0 + y1) / 2)
        else:
            out = max(y0, y1) + farther * pitch_y
            start, end, name_at = (x0, out), (x1, out), ((x0 + x1) / 2, out + pitch_y / 2)
        for (low, _), high in zip(measured.axes, (start, end), strict=True):
            space.add_line(low, high, layer)
        space.add_line(start, end, layer)
        add_text(space, f"{setting.sign} = {setting.length:.6g} mm", name_at, seen)


def add_zero(space: Modelspace, pose: Pose, zero: Point, length: float) -> None:
    """Add the part's zero point with its x axis, ``length`` mm long, and a y axis half as long.

    ``zero`` is in the part's frame.
    """
    layer, (x, y) = {"layer": "PART_ZERO"}, zero
    space.add_point(pose.apply(x, y), layer)
    for end in (pose.apply(x + length, y), pose.apply(x, y + length / 2)):
        space.add_line(pose.apply(x, y), end, layer)


PLATE_LAYERS = {"PLATE": 7, "DOWEL_HOLES": 1, "BOLT_HOLES": 5, "TEXT": 8}
# Heights of text: of the names of holes as a share of the holes, and of the titles, in mm.
NAME_HEIGHT, TITLE_HEIGHT = 0.3, 5.0


def make_plates_dxf(plates: Sequence[JawPlate]) -> bytes:
    """Return the bytes of a DXF drawing of jaw plates; the same plates give the same bytes."""
    with make_drawing(PLATE_LAYERS) as document:
        space = document.modelspace()

        def write(words: str, height: float, at: Point, align: TextEntityAlignment) -> None:
            """Add words with an alignment at a point (x, y), ``height`` mm tall."""
            space.add_text(words, height=height, dxfattribs={"layer": "TEXT"}).set_placement(at, align=align)

        for plate, right in zip(plates, place_plates_in_drawing(plates), strict=True):
            corners = [(x + right, y) for x, y in plate.outline.corners]
            space.add_lwpolyline(corners, close=True, dxfattribs={"layer": "PLATE"})
            for name, (x, y) in plate.holes:
                center = (x + right, y)
                space.add_circle(center, plate.hole_diameter / 2, {"layer": "DOWEL_HOLES"})
                write(name, NAME_HEIGHT * plate.hole_diameter, center, TextEntityAlignment.MIDDLE_CENTER)
            words = f"{plate.title}: {len(plate.holes)} dowel holes %%c{plate.hole_diameter:.6g} mm"
            if plate.bolts is not None:
                for x, y in plate.bolts.places:
                    space.add_circle((x + right, y), plate.bolts.diameter / 2, {"layer": "BOLT_HOLES"})
                words += f", {len(plate.bolts.places)} bolt holes %%c{plate.bolts.diameter:.6g} mm"
            at = (plate.outline.x0 + right, plate.outline.y1 + TITLE_HEIGHT)
            write(words, TITLE_HEIGHT / 2, at, TextEntityAlignment.BOTTOM_LEFT)
        return write_drawing_bytes(document)
