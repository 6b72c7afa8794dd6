"""Programs as text, read with one tool of 10 mm, and ways to compare what two of them sweep."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from workhold import Program
from workhold.model.cutting_tool import Cylinder, Tool
from workhold.model.program import SweptPiece

PROGRAMS = Path(__file__).parent.parent / "data" / "programs"
HEAD = "G21 G90 G17\nT1 M6\n"
MILL = Tool(1, [Cylinder(0.0, 30.0, 5.0), Cylinder(30.0, 70.0, 20.0)], 10.0, "mill")


def read_text(folder: Path, text: str, **options: Any) -> Program:
    """A program from its text, with heights as it says them, and with tool 1 unless others are given."""
    path = folder / "program.nc"
    path.write_text(text)
    options.setdefault("tools", {1: MILL})
    options.setdefault("z_zero", 0.0)
    return Program.read(path, **options)


def read_tools(folder: Path, table: Path, *numbers: int, unit: str = "G21") -> tuple[dict[int, Tool], bool]:
    """The tools of a table that a program calls, and whether the table says its unit."""
    called = "".join(f"T{number} M6\nG0 X0 Y0 Z9\n" for number in numbers)
    read = read_text(folder, f"{unit} G90 G17\n{called}", tools=table)
    return dict(read.tools), not any("does not say its unit" in note for note in read.notes)


def shapes(pieces: Sequence[SweptPiece], digits: int = 7) -> list[tuple[object, ...]]:
    """All that pieces sweep, without their lines, to some digits."""
    return [
        (
            one.kind,
            one.tool,
            tuple(tuple(round(value, digits) + 0.0 for value in vertex) for vertex in one.path),
            tuple(round(value, digits) + 0.0 for value in one.tip),
            one.radius,
            one.heights,
        )
        for one in pieces
    ]
