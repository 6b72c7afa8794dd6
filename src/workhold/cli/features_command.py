"""``workhold features``: the numbered faces of a part."""

from __future__ import annotations

from pathlib import Path

from workhold.cli.commands import option, spread
from workhold.cli.options import PartArgument, PartWords
from workhold.cli.outputs import ForceOption, refuse_output
from workhold.cli.values import length_unit, optional_length, picture_ending
from workhold.errors import InputError

__all__ = ["features"]


@spread
def features(
    part: PartArgument,
    *,
    draw: str | None = option(None, "FILE", "Draw them into this file, whose name ends in .svg or .png."),
    force: ForceOption = False,
    peg_radius: str | None = option(None, "LENGTH", "Draw also where the centres of pegs of this radius can be."),
    reading: PartWords,
) -> None:
    """List the numbered faces of PART, as pictures and result files name them.

    Example: workhold features part.dxf --draw faces.svg
    """
    from workhold.files.atomic import write_bytes

    shown_unit = length_unit(reading.unit)
    radius = optional_length("--peg-radius", peg_radius, shown_unit)
    if radius is not None and radius < 0:
        raise InputError(f"--peg-radius {peg_radius} is negative: give 0 or more.")
    picture = None if draw is None else Path(draw)
    ending = None
    if picture is not None:
        ending = picture_ending(picture)
        refuse_output(picture, (part,), force)
    loaded = reading.load(part)
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
