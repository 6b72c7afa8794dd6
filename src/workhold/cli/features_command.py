"""``workhold features``: the numbered faces of a part."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from workhold.cli.commands import option, spread
from workhold.cli.json_output import JsonOption, print_json
from workhold.cli.options import PartArgument, PartWords
from workhold.cli.outputs import ForceOption, refuse_output
from workhold.cli.values import length_unit, optional_length, picture_ending
from workhold.errors import InputError

if TYPE_CHECKING:
    from workhold.files.part.load import Loaded
    from workhold.units import Unit

__all__ = ["features"]


@spread
def features(
    part: PartArgument,
    *,
    draw: str | None = option(None, "FILE", "Draw them into this file, whose name ends in .svg or .png."),
    force: ForceOption = False,
    peg_radius: str | None = option(None, "LENGTH", "Draw also where the centres of pegs of this radius can be."),
    parts: Annotated[
        bool, typer.Option("--parts", help="List, and draw, the parts of a file that holds several.")
    ] = False,
    layers: Annotated[
        bool, typer.Option("--layers", help="List the layers of a DXF file with what is on them.")
    ] = False,
    json_: JsonOption = False,
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
    if layers:
        list_layers(part, reading, shown_unit, json_)
        return
    loaded = reading.load(part)
    workpiece = loaded.workpiece

    from workhold.cli.tables import face_table, jumps_sentence, plural, print_tables

    if parts:
        list_parts(loaded, shown_unit, picture, ending, json_)
        return

    if not json_:
        x0, y0, x1, y1 = workpiece.bounds
        faces = plural(len(workpiece.faces), "face")
        size = f"{shown_unit.number(x1 - x0)} x {shown_unit.text(y1 - y0)}"
        table = face_table(workpiece, shown_unit)
        print_tables(f"{workpiece.name}: {size}, {faces}", table, *jumps_sentence(workpiece))
    if picture is not None and ending is not None:
        from workhold.drawing.features_picture import draw_features
        from workhold.drawing.render import render

        svg = draw_features(workpiece, peg_radius=radius, unit=shown_unit)
        write_bytes(picture, render(svg, ending))
    if json_:
        from workhold.presenting.data import part_data

        print_json(**part_data(workpiece, loaded.remarks), written=[] if picture is None else [str(picture)])
    elif picture is not None:
        print_tables(f"Drawn in {picture}.")


def list_layers(part: str, reading: PartWords, unit: Unit, as_json: bool) -> None:
    """Print the layers of a DXF file; sizes in JSON are in mm where the unit is known, else in units of the drawing.

    Raises
    ------
    InputError
        For other files.
    """
    from workhold.cli.tables import Table, print_tables
    from workhold.files.part.layers import drawn_layers

    found, known = drawn_layers(part, reading.drawing_unit, reading.unit)
    if as_json:
        names = ("name", "kinds", "hidden", "loops", "size")
        print_json(layers=[{name: getattr(one, name) for name in names} for one in found], in_mm=known)
        return
    table = Table(("layer", f"size {unit.abbreviation if known else 'as drawn'}", ">outlines", "on it"))
    for layer in found:
        size = (
            ""
            if layer.size is None
            else " x ".join(f"{length / (unit.millimetres if known else 1):.5g}" for length in layer.size)
        )
        kinds = ", ".join(f"{count} {kind}" for kind, count in sorted(layer.kinds.items()))
        table.add_row(
            layer.name,
            size,
            "?" if layer.loops is None else str(layer.loops),
            f"{kinds} (hidden: read only when named)" if layer.hidden else kinds,
        )
    print_tables(table, "Read only some of them with --layer NAME, which may be repeated.")


def list_parts(loaded: Loaded, unit: Unit, picture: Path | None, ending: str | None, as_json: bool) -> None:
    """Print the parts of a file, and draw them."""
    from workhold.cli.tables import Table, print_tables
    from workhold.files.atomic import write_bytes

    table = Table((">part", f">width {unit.abbreviation}", f">height {unit.abbreviation}", ">holes", "lowest corner"))
    for one in loaded.parts:
        x0, y0, x1, y1 = one.bounds
        corner = f"({unit.number(x0)}, {unit.number(y0)})"
        table.add_row(str(one.number), unit.number(x1 - x0), unit.number(y1 - y0), str(len(one.loops) - 1), corner)
    if not as_json:
        print_tables(table)
    if picture is not None and ending is not None:
        from workhold.drawing.parts_picture import draw_parts
        from workhold.drawing.render import render

        svg = draw_parts(
            loaded.workpiece.name,
            [[loop.vertices for loop in one.loops] for one in loaded.parts],
            loaded.number,
            unit=unit,
        )
        write_bytes(picture, render(svg, ending))
    if as_json:
        parts = [{"number": p.number, "bounds": list(p.bounds), "holes": len(p.loops) - 1} for p in loaded.parts]
        print_json(parts=parts, chosen=loaded.number, written=[] if picture is None else [str(picture)])
    elif picture is not None:
        print_tables(f"Drawn in {picture}.")
