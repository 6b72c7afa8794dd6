"""The question of a program for the machine: how it is read, how its tools cut, and what the part is cut from."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from attrs import frozen
from attrs.converters import optional

from workhold.asking.declaring import PageLabel, check_fields, declare
from workhold.limits import real

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
        "Where its X0 Y0 is on the part, in the part's coordinates.",
        default=(0.0, 0.0),
        section=PROGRAM,
        typed="Where its X0 Y0 is on the part: corner (lower left, as drawn), centre, hole N, or X,Y of "
        "the drawing.",
        typed_default="0,0",
        metavar="PLACE",
    )
    z_zero: str | float = declare(
        "text",
        "Where its Z0 is: top or bottom of the part, or a height above the part's lower side.",
        default="top",
        section=PROGRAM,
        typed="Where its Z0 is: a side of the part, or a height.",
        metavar="top|bottom|LENGTH",
    )
    clearance: float = declare(
        "length",
        "What tools keep from pegs, clamps and walls.",
        default=1.0,
        least="0",
        section=PROGRAM,
        word="program_clearance",
        typed_default="1mm",
    )
    rapid: str = declare(
        "choice",
        "Whether its rapid moves are straight, or may go anywhere in the box of their ends.",
        default="straight",
        choices=("straight", "box"),
        section=PROGRAM,
    )
    unit: str | None = declare(
        "choice",
        "Unit of a program without G20 and G21.",
        choices=("mm", "inch"),
        section=PROGRAM,
        word="program_unit",
    )
    start: Sequence[float] | None = declare(
        "point",
        "Where the tip is at its start, from its own zero, where the program does not say it.",
        section=PROGRAM,
    )
    whole_numbers: str = declare(
        "choice",
        "What its lengths without a decimal point count; thousandths are 0.001 mm or 0.0001 inch.",
        default="units",
        choices=("units", "thousandths"),
        section=PROGRAM,
    )


@frozen(field_transformer=check_fields, kw_only=True)
class CuttingQuestion:
    """How tools cut; :class:`workhold.model.cutting_tool.CuttingData` explains the fields and checks them."""

    cutting_force: float | None = declare(
        "force",
        "Force at the periphery of every tool whose own the table does not give, in N.",
        least="0",
        converter=optional(real),
        section=FORCES,
        typed="Force at the periphery of every tool whose own the table does not give, in N or 1.5kN.",
    )
    power: float | None = declare(
        "power",
        "Power at the spindle in kW, from which the force follows by S.",
        converter=optional(real),
        section=FORCES,
        typed="Power at the spindle, from which the force follows by S; also 3hp.",
    )
    material: Any = declare(
        "text",
        "What is cut, such as steel, stainless, cast-iron, aluminium, brass or titanium, or kc1.1 in N/mm2 "
        "and mc: the force "
        "follows from F, S, teeth and the cut.",
        section=FORCES,
        metavar="NAME|KC,MC",
    )
    teeth: float | None = declare(
        "count",
        "Teeth of every tool whose own the table does not give.",
        converter=optional(real),
        section=FORCES,
    )
    cut_depth: float | None = declare(
        "length",
        "How deep tools cut at most at once, along their axes.",
        converter=optional(real),
        section=FORCES,
    )
    cut_width: float | None = declare(
        "length",
        "How broad they cut, across the feed; the tool's diameter if not given.",
        converter=optional(real),
        section=FORCES,
    )
    direction: Any = declare(
        "choice",
        "Whether a force may act in any direction, or within 60 degrees of against the feed; any if not "
        "given.",
        choices=("any", "feed"),
        section=FORCES,
        word="cutting_direction",
    )


@frozen(field_transformer=check_fields)
class StockQuestion:
    """What the part is cut from; :class:`workhold.model.stock.Stock` explains the fields and checks them."""

    side: float = declare(
        "length",
        "How far the stock reaches around the outline; 0 where the part comes finished there.",
        PageLabel("Around"),
        default=ALLOWANCE,
        least="0",
        converter=real,
    )
    top: float = declare(
        "length",
        "How far it reaches above the part's top; 0 where the part comes finished there.",
        PageLabel("On top"),
        default=ALLOWANCE,
        least="0",
        converter=real,
    )
    shape: Any = declare(
        "choice",
        "The part's outline, or the block around it.",
        default="outline",
        choices=("outline", "block"),
    )
