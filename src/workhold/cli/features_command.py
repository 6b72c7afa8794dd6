"""``workhold features``: the numbered faces of a part."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from workhold.cli.options import (
    JOIN_TOLERANCE,
    AxisOption,
    DrawingUnitOption,
    JoinToleranceOption,
    LayerOption,
    PartArgument,
    PartNumberOption,
    SectionOption,
    UnitOption,
    load_part,
)
from workhold.cli.outputs import ForceOption, refuse_output
from workhold.cli.values import length_unit, optional_length, picture_ending
from workhold.errors import InputError

__all__ = ["features"]


def features(
    part: PartArgument,
    draw: Annotated[
        str | None, typer.Option(metavar="FILE", help="Draw them into this file, whose name ends in .svg or .png.")
    ] = None,
    force: ForceOption = False,
    peg_radius: Annotated[
        str | None, typer.Option(metavar="LENGTH", help="Draw also where the centres of pegs of this radius can be.")
    ] = None,
    unit: UnitOption = None,
    layer: LayerOption = None,
    part_number: PartNumberOption = None,
    drawing_unit: DrawingUnitOption = None,
    join_tolerance: JoinToleranceOption = JOIN_TOLERANCE,
    axis: AxisOption = None,
    section: SectionOption = None,
) -> None:
    """List the numbered faces of PART, as pictures and result files name them.

    Example: workhold features part.dxf --draw faces.svg
    """
    from workhold.files.atomic import write_bytes

    shown_unit = length_unit(unit)
    radius = optional_length("--peg-radius", peg_radius, shown_unit)
    if radius is not None and radius < 0:
        raise InputError(f"--peg-radius {peg_radius} is negative: give 0 or more.")
    picture = None if draw is None else Path(draw)
    ending = None
    if picture is not None:
        ending = picture_ending(picture)
        refuse_output(picture, (part,), force)
    loaded = load_part(part, unit, layer, part_number, join_tolerance, drawing_unit, axis, section)
    workpiece = loaded.workpiece

    from workhold.cli.tables import face_table, plural, print_tables

    x0, y0, x1, y1 = workpiece.bounds
    faces = plural(len(workpiece.faces), "face")
    size = f"{shown_unit.number(x1 - x0)} x {shown_unit.text(y1 - y0)}"
    print_tables(f"{workpiece.name}: {size}, {faces}", face_table(workpiece, shown_unit))
    if picture is not None and ending is not None:
        from workhold.drawing.features_picture import draw_features
        from workhold.drawing.render import render

        svg = draw_features(workpiece, peg_radius=radius, unit=shown_unit)
        write_bytes(picture, render(svg, ending))
        print_tables(f"Drawn in {picture}.")
