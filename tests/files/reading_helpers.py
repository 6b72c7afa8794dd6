"""What the tests of reading share: making drawings, and measuring workpieces."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import ezdxf

from workhold import Workpiece
from workhold.files.part.load import LoadedPart, read_workpiece
from workhold.geometry.loop import compute_signed_area

RECTANGLE = [(0, 0), (60, 0), (60, 40), (0, 40)]


def area(workpiece: Workpiece) -> float:
    """Material area in mm²."""
    return sum(compute_signed_area(segments) for segments in workpiece.loop_segments)


def perimeter(workpiece: Workpiece) -> float:
    """Length of all loops in mm."""
    return sum(segment.length for segment in workpiece.segments)


def new_dxf(insunits: int | None = 4, version: str = "R2000") -> tuple[Any, Any]:
    """A new document and its model space."""
    document = ezdxf.new(version)
    if insunits is not None:
        document.header["$INSUNITS"] = insunits
    return document, document.modelspace()


def read_dxf(
    tmp_path: Path, draw: Callable[[Any], object], insunits: int | None = 4, **options: Any
) -> LoadedPart:
    """What is read from a DXF file whose model space a function has drawn."""
    document, space = new_dxf(insunits)
    draw(space)
    path = tmp_path / "drawn.dxf"
    document.saveas(path)
    return read_workpiece(path, **options)


def rectangle(
    space: Any, x: float = 0, y: float = 0, w: float = 60, h: float = 40, **attributes: Any
) -> None:
    """Draw a rectangle as four loose lines."""
    corners = [(x, y), (x + w, y), (x + w, y + h), (x, y + h)]
    for start, end in zip(corners, corners[1:] + corners[:1], strict=True):
        space.add_line(start, end, dxfattribs=attributes)


def read_svg(tmp_path: Path, body: str, root: str = "", **options: Any) -> LoadedPart:
    """What is read from an SVG file with this body and these root attributes."""
    path = tmp_path / "drawn.svg"
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {root}>{body}</svg>')
    return read_workpiece(path, **options)
