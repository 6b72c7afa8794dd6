"""Arguments and options that several commands share."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from workhold.cli.saying import tell
from workhold.cli.values import choice, counting_number, length, length_unit, optional_length

if TYPE_CHECKING:
    from workhold.files.part.load import Loaded

__all__ = [
    "JOIN_TOLERANCE",
    "AxisOption",
    "DrawingUnitOption",
    "JoinToleranceOption",
    "LayerOption",
    "PartArgument",
    "PartNumberOption",
    "SectionOption",
    "ShownUnitOption",
    "UnitOption",
    "load_part",
]

READING = "Reading the part"
# With its unit, so that it is the same whatever --unit says.
JOIN_TOLERANCE = "0.001mm"

PartArgument = Annotated[
    str,
    typer.Argument(
        metavar="PART", help="The part: a DXF, SVG, JSON or STEP file, or a built-in name (see workhold parts)."
    ),
]
UnitOption = Annotated[
    str | None,
    typer.Option(
        metavar="UNIT",
        help="Unit of lengths given and shown (mm, cm, m, inch), and of a drawing that does not say its own; mm if not "
        "given. A length may also carry its unit: 0.5in.",
    ),
]
ShownUnitOption = Annotated[
    str | None,
    typer.Option("--unit", metavar="UNIT", help="Unit of the lengths shown (mm, cm, m, inch); mm if not given."),
]
DrawingUnitOption = Annotated[
    str | None,
    typer.Option(
        metavar="UNIT",
        help="Unit of the drawing, where it is not that of --unit, or where the file says a wrong one.",
        rich_help_panel=READING,
    ),
]
LayerOption = Annotated[
    list[str] | None,
    typer.Option(metavar="NAME", help="Read only this layer; may be repeated.", rich_help_panel=READING),
]
PartNumberOption = Annotated[
    str | None,
    typer.Option(
        "--part",
        metavar="N",
        help="Which part, when a drawing holds several; the largest if not given.",
        rich_help_panel=READING,
    ),
]
JoinToleranceOption = Annotated[
    str,
    typer.Option(metavar="LENGTH", help="Largest gap between ends of lines that is closed.", rich_help_panel=READING),
]
AxisOption = Annotated[
    str | None,
    typer.Option(
        metavar="x|y|z",
        help="STEP files: the direction that the pegs are parallel to; z if not given.",
        rich_help_panel=READING,
    ),
]
SectionOption = Annotated[
    str | None,
    typer.Option(
        metavar="HEIGHT",
        help="STEP files: take the section at this height above the part's lowest point, not the silhouette.",
        rich_help_panel=READING,
    ),
]


def load_part(
    part: str,
    unit: str | None,
    layer: list[str] | None,
    number: str | None,
    tolerance: str,
    drawing_unit: str | None = None,
    axis: str | None = None,
    section: str | None = None,
) -> Loaded:
    """Read the part and tell on stderr what a user should know about the drawing.

    Parameters
    ----------
    part, unit, layer, number, tolerance, drawing_unit : as typed; ``unit`` is that of ``tolerance``, and of a drawing
        that does not say its own; ``drawing_unit`` is that of the drawing, whatever it says.

    Raises
    ------
    InputError
        When the part cannot be used.
    """
    join_tolerance = length("--join-tolerance", tolerance, length_unit(unit))
    part_number = counting_number("--part", number, "a part")
    direction = None if axis is None else choice("--axis", axis, ("x", "y", "z"))
    height = optional_length("--section", section, length_unit(unit))
    from workhold.files.part.load import read_workpiece

    loaded = read_workpiece(
        part,
        unit=drawing_unit,
        usual_unit=unit,
        layers=layer or None,
        part_number=part_number,
        join_tolerance=join_tolerance,
        axis=direction,
        section=height,
    )
    for remark in loaded.remarks:
        tell(remark)
    return loaded
