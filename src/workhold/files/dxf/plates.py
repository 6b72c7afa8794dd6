"""Jaw plates as a DXF drawing to drill them from: side by side, in millimetres, each with its outline, holes and bolts.

The first plate's hole A1 is at (0, 0); each other stands at the right of the one before it.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ezdxf import units
from ezdxf.enums import TextEntityAlignment
from ezdxf.filemanagement import new

from workhold.files.atomic import write_bytes
from workhold.files.dxf.setup import VERSION, content_of, fixed_stamps
from workhold.geometry.segment import Point
from workhold.model.jaw_plate import JawPlate

__all__ = ["PLATE_LAYERS", "beside", "plates_dxf", "write_plates_dxf"]

PLATE_LAYERS = {"PLATE": 7, "DOWEL_HOLES": 1, "BOLT_HOLES": 5, "TEXT": 8}
# Between two plates, in mm.
GAP = 20.0
# Heights of text: of the names of holes as a share of the holes, and of the titles, in mm.
NAME_HEIGHT, TITLE_HEIGHT = 0.3, 5.0


def beside(plates: Sequence[JawPlate]) -> list[float]:
    """How far to the right each plate's hole A1 stands in a drawing of all of them, in mm."""
    places, right = [], 0.0
    for number, plate in enumerate(plates):
        places.append(right + GAP - plate.outline.x0 if number else 0.0)
        right = places[-1] + plate.outline.x1
    return places


def plates_dxf(plates: Sequence[JawPlate]) -> bytes:
    """The bytes of the drawing; the same plates give the same bytes."""
    with fixed_stamps():
        document = new(VERSION)
        document.units = units.MM
        document.header["$MEASUREMENT"] = 1
        document.header["$LASTSAVEDBY"] = "workhold"
        for name, color in PLATE_LAYERS.items():
            document.layers.add(name, color=color)
        space = document.modelspace()

        def write(words: str, height: float, at: Point, align: TextEntityAlignment) -> None:
            space.add_text(words, height=height, dxfattribs={"layer": "TEXT"}).set_placement(at, align=align)

        for plate, right in zip(plates, beside(plates), strict=True):
            box = plate.outline
            corners = [(box.x0, box.y0), (box.x1, box.y0), (box.x1, box.y1), (box.x0, box.y1)]
            space.add_lwpolyline([(x + right, y) for x, y in corners], close=True, dxfattribs={"layer": "PLATE"})
            for name, (x, y) in plate.holes:
                space.add_circle((x + right, y), plate.hole_diameter / 2, {"layer": "DOWEL_HOLES"})
                write(name, NAME_HEIGHT * plate.hole_diameter, (x + right, y), TextEntityAlignment.MIDDLE_CENTER)
            for x, y in plate.bolts.places if plate.bolts else ():
                space.add_circle(
                    (x + right, y), plate.bolts.diameter / 2 if plate.bolts else 0.0, {"layer": "BOLT_HOLES"}
                )
            bolts = (
                ""
                if plate.bolts is None
                else f", {len(plate.bolts.places)} bolt holes %%c{plate.bolts.diameter:.6g} mm"
            )
            words = f"{plate.title}: {len(plate.holes)} dowel holes %%c{plate.hole_diameter:.6g} mm{bolts}"
            write(words, TITLE_HEIGHT / 2, (box.x0 + right, box.y1 + TITLE_HEIGHT), TextEntityAlignment.BOTTOM_LEFT)
        return content_of(document)


def write_plates_dxf(plates: Sequence[JawPlate], path: str | Path) -> None:
    """Writes jaw plates as a DXF drawing.

    Raises
    ------
    InputError
        When the file cannot be written.
    """
    write_bytes(path, plates_dxf(plates))
