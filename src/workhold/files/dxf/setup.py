"""A set-up as a DXF drawing for a CAM system: part in pose, pegs, holes and plates on layers of their own.

Exact geometry in millimetres in the vise frame, whose origin is the left jaw's hole L-A1. Lines and arcs of the part are
closed LWPOLYLINEs with bulges, whole circles are CIRCLEs, pegs and holes too.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING

from ezdxf import options, units  # type: ignore[attr-defined]
from ezdxf.enums import TextEntityAlignment
from ezdxf.filemanagement import new

from workhold.files.atomic import write_bytes
from workhold.geometry.segment import Arc, Point
from workhold.model.fixture import Fixture, Pose
from workhold.model.holes import column_letters
from workhold.model.shown import MOST_HOLES, Shown, shown
from workhold.model.toolkit import Carrier, Toolkit
from workhold.model.workpiece import Workpiece

if TYPE_CHECKING:
    from ezdxf.layouts.layout import Modelspace

__all__ = ["LAYERS", "setup_dxf", "write_setup_dxf"]

# Layer names and their AutoCAD colour numbers; besides, each carrier has a layer, such as JAW_LEFT.
LAYERS = {
    "PART": 7,
    "PEGS": 1,
    "HOLES": 8,
    "HOLES_USED": 1,
    "OPENING": 6,
    "PART_ZERO": 2,
    "TEXT": 7,
}
STILL, SLIDING = 5, 3
VERSION = "R2010"
# Sizes as shares of the smaller pitch: height of text, and length of the axes at the part's zero.
TEXT_HEIGHT, AXIS = 0.3, 1.0
# Radius of a hole whose pegs are points, as a share of the pitch.
POINT_HOLE = 1 / 7


def write_setup_dxf(fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit, path: str | Path) -> None:
    """Write a set-up as a DXF drawing; the same set-up gives the same bytes.

    Raises
    ------
    InputError
        When the file cannot be written.
    """
    write_bytes(path, setup_dxf(fixture, workpiece, toolkit))


def setup_dxf(fixture: Fixture, workpiece: Workpiece, toolkit: Toolkit) -> bytes:
    """The bytes of a set-up's DXF drawing, see :func:`write_setup_dxf`."""
    with fixed_stamps():
        document = new(VERSION)
        document.units = units.MM
        document.header["$MEASUREMENT"] = 1
        document.header["$LASTSAVEDBY"] = "workhold"
        for name, color in LAYERS.items():
            document.layers.add(name, color=color)
        for carrier in toolkit.carriers:
            document.layers.add(layer_of(carrier), color=STILL if carrier.travel is None else SLIDING)
        space, seen = document.modelspace(), shown(fixture, toolkit, workpiece)
        add_carriers(space, seen)
        add_part(space, workpiece.placed(fixture.pose))
        add_pegs(space, seen)
        add_travel(space, seen)
        add_zero(space, fixture.pose, AXIS * seen.pitch)
        stream = StringIO()
        document.write(stream)
        return document.encode(stream.getvalue())


def layer_of(carrier: Carrier) -> str:
    """The layer that a carrier's plate is on.

    >>> from workhold import Vise
    >>> [layer_of(carrier) for carrier in Vise(pitch=10, columns=2, peg_radius=3).carriers]
    ['JAW_LEFT', 'JAW_RIGHT']
    """
    return f"{carrier.noun}_{carrier.name}".upper()


@contextmanager
def fixed_stamps() -> Iterator[None]:
    """Make ezdxf write no time and no random numbers while the block runs."""
    before = options.write_fixed_meta_data_for_testing
    options.write_fixed_meta_data_for_testing = True
    try:
        yield
    finally:
        options.write_fixed_meta_data_for_testing = before


def add_part(space: Modelspace, part: Workpiece) -> None:
    """Add the loops of the part in its pose."""
    number = 0
    for loop in part.loops:
        face = next(face for face in part.faces if number in face.segments)
        number += len(loop)
        if isinstance(face.segment, Arc) and face.segment.is_full:
            space.add_circle(face.segment.center, face.segment.radius, {"layer": "PART"})
        else:
            space.add_lwpolyline(loop.tolist(), format="xyb", close=True, dxfattribs={"layer": "PART"})


def add_pegs(space: Modelspace, seen: Shown) -> None:
    """Add the pegs, as points if they have no size, and the names of their holes."""
    for each in seen.carriers:
        for peg in each.pegs:
            if each.carrier.peg_radius > 0:
                space.add_circle((peg.x, peg.y), each.carrier.peg_radius, {"layer": "PEGS"})
            else:
                space.add_point((peg.x, peg.y), {"layer": "PEGS"})
            add_text(space, peg.hole, (peg.x, peg.y), seen)


def add_text(space: Modelspace, words: str, at: Point, seen: Shown) -> None:
    """Add a line of text about a point."""
    text = space.add_text(words, height=TEXT_HEIGHT * seen.pitch, dxfattribs={"layer": "TEXT"})
    text.set_placement(at, align=TextEntityAlignment.MIDDLE_CENTER)


def add_carriers(space: Modelspace, seen: Shown) -> None:
    """Add the plates with their holes, column letters below them and row numbers beside them."""
    for each in seen.carriers:
        carrier, plate = each.carrier, each.plate
        corners = [(plate.x0, plate.y0), (plate.x1, plate.y0), (plate.x1, plate.y1), (plate.x0, plate.y1)]
        space.add_lwpolyline(corners, close=True, dxfattribs={"layer": layer_of(carrier)})
        half_x, half_y = carrier.pitch[0] / 2, carrier.pitch[1] / 2
        holes = each.holes(MOST_HOLES)
        for hole in holes:
            radius = carrier.peg_radius or POINT_HOLE * min(carrier.pitch)
            space.add_circle(hole.center, radius, {"layer": "HOLES_USED" if hole.used else "HOLES"})
        beside = plate.x0 - half_x if each.names_at == "left" else plate.x1 + half_x
        below = plate.y1 + half_y if "bottom" in each.facing else plate.y0 - half_y
        for column, x in {hole.column: hole.center[0] for hole in holes}.items():
            add_text(space, column_letters(column), (x, below), seen)
        for row, y in {hole.row: hole.center[1] for hole in holes}.items():
            add_text(space, str(row + 1), (beside, y), seen)


def add_travel(space: Modelspace, seen: Shown) -> None:
    """Add the axes that each travel is measured between, and the travel itself beyond the plates."""
    layer = {"layer": "OPENING"}
    for each, *axes in seen.travels:
        (x0, y0), (x1, y1) = (high for _, high in axes)
        pitch_x, pitch_y = each.carrier.pitch
        if each.upright:
            out = max(x0, x1) + pitch_x
            start, end, name_at = (out, y0), (out, y1), (out + pitch_x / 2, (y0 + y1) / 2)
        else:
            out = max(y0, y1) + pitch_y
            start, end, name_at = (x0, out), (x1, out), ((x0 + x1) / 2, out + pitch_y / 2)
        for (low, _), high in zip(axes, (start, end), strict=True):
            space.add_line(low, high, layer)
        space.add_line(start, end, layer)
        add_text(space, f"S = {each.travelled:.6g} mm", name_at, seen)


def add_zero(space: Modelspace, pose: Pose, length: float) -> None:
    """Add the part's zero point with its x axis, as long as told, and a y axis half as long."""
    layer = {"layer": "PART_ZERO"}
    space.add_point((pose.x, pose.y), layer)
    for end in (pose.apply(length, 0.0), pose.apply(0.0, length / 2)):
        space.add_line((pose.x, pose.y), end, layer)
