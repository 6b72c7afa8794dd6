"""A set-up as a DXF drawing for a CAM system: part in pose, pegs, holes and jaws on layers of their own.

Exact geometry in millimetres in the vise frame, whose origin is the left jaw's hole L-A1. Lines and arcs of the part are
closed LWPOLYLINEs with bulges, whole circles are CIRCLEs, pegs and holes too.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from io import StringIO
from math import cos, radians, sin
from pathlib import Path
from typing import TYPE_CHECKING

from ezdxf import options, units  # type: ignore[attr-defined]
from ezdxf.enums import TextEntityAlignment
from ezdxf.filemanagement import new

from workhold.files.atomic import write_bytes
from workhold.files.setup_plates import Plate, plate_of, posed_workpiece
from workhold.geometry.segment import Arc, Point
from workhold.model.fixture import Fixture
from workhold.model.holes import column_letters
from workhold.model.vise import Vise
from workhold.model.workpiece import Workpiece

if TYPE_CHECKING:
    from ezdxf.layouts.layout import Modelspace

__all__ = ["LAYERS", "setup_dxf", "write_setup_dxf"]

# Layer names and their AutoCAD colour numbers.
LAYERS = {
    "PART": 7,
    "PEGS": 1,
    "HOLES": 8,
    "HOLES_USED": 1,
    "JAW_LEFT": 5,
    "JAW_RIGHT": 3,
    "OPENING": 6,
    "PART_ZERO": 2,
    "TEXT": 7,
}
VERSION = "R2010"
# Sizes as shares of the smaller pitch: height of text, and length of the axes at the part's zero.
TEXT_HEIGHT, AXIS = 0.3, 1.0
# Radius of a hole whose pegs are points, as a share of the pitch.
POINT_HOLE = 1 / 7


def write_setup_dxf(fixture: Fixture, workpiece: Workpiece, vise: Vise, path: str | Path) -> None:
    """Write a set-up as a DXF drawing; the same set-up gives the same bytes.

    Raises
    ------
    InputError
        When the file cannot be written.
    """
    write_bytes(path, setup_dxf(fixture, workpiece, vise))


def setup_dxf(fixture: Fixture, workpiece: Workpiece, vise: Vise) -> bytes:
    """The bytes of a set-up's DXF drawing, see :func:`write_setup_dxf`."""
    with fixed_stamps():
        document = new(VERSION)
        document.units = units.MM
        document.header["$MEASUREMENT"] = 1
        for name, color in LAYERS.items():
            document.layers.add(name, color=color)
        space = document.modelspace()
        part = posed_workpiece(workpiece, fixture.pose)
        plates = [plate_of(jaw, fixture, part, vise) for jaw in ("left", "right")]
        add_jaws(space, plates, fixture, vise)
        add_part(space, part)
        add_pegs(space, fixture, vise)
        add_opening(space, plates, fixture, vise)
        add_zero(space, fixture, vise)
        stream = StringIO()
        document.write(stream)
        return document.encode(stream.getvalue())


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


def add_pegs(space: Modelspace, fixture: Fixture, vise: Vise) -> None:
    """Add the pegs, as points if they have no size, and the names of their holes."""
    for peg in fixture.pegs:
        if vise.peg_radius > 0:
            space.add_circle((peg.x, peg.y), vise.peg_radius, {"layer": "PEGS"})
        else:
            space.add_point((peg.x, peg.y), {"layer": "PEGS"})
        add_text(space, peg.hole, (peg.x, peg.y), vise)


def add_text(space: Modelspace, words: str, at: Point, vise: Vise) -> None:
    """Add a line of text about a point."""
    text = space.add_text(words, height=TEXT_HEIGHT * min(vise.pitch), dxfattribs={"layer": "TEXT"})
    text.set_placement(at, align=TextEntityAlignment.MIDDLE_CENTER)


def add_jaws(space: Modelspace, plates: list[Plate], fixture: Fixture, vise: Vise) -> None:
    """Add the plates with their holes, column letters below them and row numbers beside them."""
    used = {(peg.jaw, peg.column, peg.row) for peg in fixture.pegs}
    radius = vise.peg_radius or POINT_HOLE * min(vise.pitch)
    for jaw, plate in zip(("left", "right"), plates, strict=True):
        (x0, y0), (x1, y1) = plate.low, plate.high
        layer = {"layer": f"JAW_{jaw.upper()}"}
        space.add_lwpolyline([(x0, y0), (x1, y0), (x1, y1), (x0, y1)], close=True, dxfattribs=layer)
        beside = x0 - vise.pitch[0] / 2 if jaw == "left" else x1 + vise.pitch[0] / 2
        first_column, first_row = plate.holes[0][0]
        for (column, row), center in plate.holes:
            name = "HOLES_USED" if (jaw, column, row) in used else "HOLES"
            space.add_circle(center, radius, {"layer": name})
            if row == first_row:
                add_text(space, column_letters(column), (center[0], y0 - vise.pitch[1] / 2), vise)
            if column == first_column:
                add_text(space, str(row + 1), (beside, center[1]), vise)


def add_opening(space: Modelspace, plates: list[Plate], fixture: Fixture, vise: Vise) -> None:
    """Add the axes of the two columns at the opening, and the jaw separation between them."""
    left = (vise.columns - 1) * vise.pitch[0]
    right = left + fixture.jaw_separation
    low, high = min(plate.low[1] for plate in plates), max(plate.high[1] for plate in plates)
    top = high + vise.pitch[1]
    for x in (left, right):
        space.add_line((x, low), (x, top), {"layer": "OPENING"})
    space.add_line((left, top), (right, top), {"layer": "OPENING"})
    add_text(space, f"S = {fixture.jaw_separation:.6g} mm", ((left + right) / 2, top + vise.pitch[1] / 2), vise)


def add_zero(space: Modelspace, fixture: Fixture, vise: Vise) -> None:
    """Add the part's zero point with its x axis and a y axis half as long."""
    pose, length = fixture.pose, AXIS * min(vise.pitch)
    c, s = cos(radians(pose.theta_deg)), sin(radians(pose.theta_deg))
    layer = {"layer": "PART_ZERO"}
    space.add_point((pose.x, pose.y), layer)
    space.add_line((pose.x, pose.y), (pose.x + length * c, pose.y + length * s), layer)
    space.add_line((pose.x, pose.y), (pose.x - length / 2 * s, pose.y + length / 2 * c), layer)
