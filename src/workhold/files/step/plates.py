"""Jaw plates as a STEP assembly: each a solid with its dowel holes and bolt holes through it, its upper side at z = 0.

They stand side by side as in the DXF drawing of the same plates.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite, pi
from pathlib import Path
from typing import Any

from workhold.errors import InputError
from workhold.files.atomic import write_bytes
from workhold.files.dxf.plates import beside
from workhold.files.step.library import load_step_library
from workhold.files.step.setup import THICKNESS, assembly, extruded, wire
from workhold.geometry.segment import Arc, Line, Point
from workhold.model.jaw_plate import JawPlate

__all__ = ["plates_step", "write_plates_step"]


def plates_step(plates: Sequence[JawPlate], thickness: float | None = None) -> bytes:
    """The bytes of the assembly; the same plates give the same bytes.

    Parameters
    ----------
    thickness : of the plates, in mm; 10 if None.

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
        (f"{plate.title} plate", drilled(plate, right, thickness))
        for plate, right in zip(plates, beside(plates), strict=True)
    ]
    return assembly("jaw plates", named)


def drilled(plate: JawPlate, right: float, thickness: float) -> Any:
    """A plate as a solid, moved to the right."""
    box = plate.outline
    corners = [(box.x0 + right, box.y0), (box.x1 + right, box.y0), (box.x1 + right, box.y1), (box.x0 + right, box.y1)]
    border = wire([Line(p, q) for p, q in zip(corners, corners[1:] + corners[:1], strict=True)])
    holes: list[tuple[Point, float]] = [(center, plate.hole_diameter) for _, center in plate.holes]
    if plate.bolts is not None:
        holes += [(center, plate.bolts.diameter) for center in plate.bolts.places]
    wires = [wire([Arc((x + right, y), diameter / 2, 0.0, pi, -1.0)]) for (x, y), diameter in holes]
    return extruded(border, wires, -thickness, 0.0)


def write_plates_step(plates: Sequence[JawPlate], path: str | Path, thickness: float | None = None) -> None:
    """Write jaw plates as a STEP assembly.

    Raises
    ------
    InputError
        As :func:`plates_step`, and when the file cannot be written.
    """
    write_bytes(path, plates_step(plates, thickness))
