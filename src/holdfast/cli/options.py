"""Arguments and options that several commands share."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from holdfast.cli.values import counting_number, length

if TYPE_CHECKING:
    from holdfast.files.load import Loaded

__all__ = ["JoinToleranceOption", "LayerOption", "PartArgument", "PartNumberOption", "UnitOption", "load_part"]

READING = "Reading the part"

PartArgument = Annotated[
    str,
    typer.Argument(
        metavar="PART", help="The part's outline: a DXF, SVG or JSON file, or a built-in name (see holdfast parts)."
    ),
]
UnitOption = Annotated[
    str | None,
    typer.Option(
        metavar="UNIT",
        help="Unit of the drawing (mm, cm, m, inch), when the file does not say or is wrong.",
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
    typer.Option(metavar="MM", help="Largest gap between ends of lines that is closed.", rich_help_panel=READING),
]


def load_part(part: str, unit: str | None, layer: list[str] | None, number: str | None, tolerance: str) -> Loaded:
    """Read the part and tell on stderr what a user should know about the drawing.

    Raises
    ------
    InputError
        When the part cannot be used.
    """
    join_tolerance = length("--join-tolerance", tolerance)
    part_number = counting_number("--part", number, "a part")
    from holdfast.files.load import read_workpiece

    loaded = read_workpiece(
        part, unit=unit, layers=layer or None, part_number=part_number, join_tolerance=join_tolerance
    )
    for remark in loaded.remarks:
        typer.echo(f"holdfast: {remark}", err=True)
    return loaded
