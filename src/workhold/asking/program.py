"""The question of a program for the machine: how it is read, how its tools cut, and what the part is cut from."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from attrs import frozen
from attrs.converters import optional

from workhold.asking.declaring import PageLabel, check_fields, declare
from workhold.limits import convert_real

__all__ = ["FORCES", "PROGRAM", "CuttingQuestion", "ProgramQuestion", "StockQuestion"]

# Sections of the command's help.
FORCES, PROGRAM = "Cutting forces", "The program"
# Of the raw stock around the part and on top of it, in mm.
ALLOWANCE = 5.0


@frozen(field_transformer=check_fields, kw_only=True)
class ProgramQuestion:
    """How a program is read; :meth:`workhold.Program.read` explains the fields."""

    zero: Sequence[float] = declare(
        "place",
        "Point of the part, in its own coordinates, at which the program has X0 Y0.",
        default=(0.0, 0.0),
        section=PROGRAM,
        typed="Point of the part at which the program has X0 Y0: corner (lower left, as drawn), "
        "centre, hole N, or X,Y of the drawing.",
        typed_default="0,0",
        metavar="PLACE",
    )
    z_zero: str | float = declare(
        "text",
        "Height at which the program has Z0: top or bottom of the part, or a height above the "
        "part's lower side.",
        default="top",
        section=PROGRAM,
        typed="Height at which the program has Z0: a side of the part, or a height above its lower side.",
        metavar="top|bottom|LENGTH",
    )
    clearance: float = declare(
        "length",
        "Distance that tools keep from pegs, clamps and walls.",
        default=1.0,
        least="0",
        section=PROGRAM,
        word="program_clearance",
        typed_default="1mm",
    )
    rapid: str = declare(
        "choice",
        "Path of rapid moves: straight, or anywhere in the box between their ends.",
        default="straight",
        choices=("straight", "box"),
        section=PROGRAM,
    )
    unit: str | None = declare(
        "choice",
        "Unit of a program that has neither G20 nor G21.",
        choices=("mm", "inch"),
        section=PROGRAM,
        word="program_unit",
    )
    start: Sequence[float] | None = declare(
        "point",
        "Place of the tip at the start, from the program's own zero, if the program does not give it.",
        section=PROGRAM,
    )
    whole_numbers: str = declare(
        "choice",
        "Meaning of lengths without a decimal point: units, or thousandths, which are 0.001 mm "
        "or 0.0001 inch.",
        default="units",
        choices=("units", "thousandths"),
        section=PROGRAM,
    )


@frozen(field_transformer=check_fields, kw_only=True)
class CuttingQuestion:
    """How tools cut; :class:`workhold.model.cutting_tool.CuttingData` explains the fields and checks them."""

    cutting_force: float | None = declare(
        "force",
        "Cutting force, in N, at the periphery of every tool for which the table gives none.",
        least="0",
        converter=optional(convert_real),
        section=FORCES,
        typed="Cutting force, in N or such as 1.5kN, at the periphery of every tool for which the "
        "table gives none.",
    )
    power: float | None = declare(
        "power",
        "Spindle power in kW; the cutting force follows from it and the speed S.",
        converter=optional(convert_real),
        section=FORCES,
        typed="Spindle power in kW, or such as 3hp; the cutting force follows from it and the speed S.",
    )
    material: Any = declare(
        "text",
        "Material of the part, such as steel, stainless, cast-iron, aluminium, brass or "
        "titanium, or its kc1.1 in N/mm2 and mc; the cutting force follows from F, S, the teeth "
        "and the cut.",
        section=FORCES,
        metavar="NAME|KC,MC",
    )
    teeth: float | None = declare(
        "count",
        "Number of teeth of every tool for which the table gives none.",
        converter=optional(convert_real),
        section=FORCES,
    )
    cut_depth: float | None = declare(
        "length",
        "Largest depth of one cut, along the tool's axis.",
        converter=optional(convert_real),
        section=FORCES,
    )
    cut_width: float | None = declare(
        "length",
        "Width of the cut, across the feed; the tool's diameter if not given.",
        converter=optional(convert_real),
        section=FORCES,
    )
    direction: Any = declare(
        "choice",
        "Direction of the cutting force: any, or within 60 degrees of the direction against the "
        "feed; any if not given.",
        choices=("any", "feed"),
        section=FORCES,
        word="cutting_direction",
    )


@frozen(field_transformer=check_fields)
class StockQuestion:
    """What the part is cut from; :class:`workhold.model.stock.Stock` explains the fields and checks them."""

    side: float = declare(
        "length",
        "Stock around the outline; 0 if the part comes finished there.",
        PageLabel("Around"),
        default=ALLOWANCE,
        least="0",
        converter=convert_real,
    )
    top: float = declare(
        "length",
        "Stock above the part's top; 0 if the part comes finished there.",
        PageLabel("On top"),
        default=ALLOWANCE,
        least="0",
        converter=convert_real,
    )
    shape: Any = declare(
        "choice",
        "The part's outline, or the block around it.",
        default="outline",
        choices=("outline", "block"),
    )
