"""The commands that list parts, toolkits and faces: ``parts``, ``toolkits`` and ``features``.

They list the built-in parts, the toolkits that come with workhold or all figures of one, and the numbered
faces of a part.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from attrs import asdict, frozen

from workhold.cli.commands import make_flag, make_option, spread_option_groups
from workhold.cli.options import SHOWN_UNIT, PartArgument, PartOptions
from workhold.cli.outputs import FORCE, JSON, print_json, read_picture_path, write_picture
from workhold.cli.program_options import SOLIDS
from workhold.cli.table import Table, format_count, print_tables
from workhold.cli.values import read_length_from_zero, read_unit

if TYPE_CHECKING:
    from workhold.files.part.loaded import LoadedPart
    from workhold.files.toolkit_file import LoadedToolkit
    from workhold.fixels.table import Form
    from workhold.model.dowels import Limits
    from workhold.units import Unit

__all__ = ["features", "parts", "toolkits"]


def parts(unit: str | None = SHOWN_UNIT, json_: bool = JSON) -> None:
    """List the built-in parts.

    They are models of the workpieces in Wallack and Canny (1996), whose dimensions were never published. Any
    of the names can stand for PART.

    Example: workhold design widget --pitch 8 --columns 1 --peg-radius 3
    """
    from workhold.files.part.finding import list_builtin_parts
    from workhold.files.part.load import load

    shown = read_unit(unit)
    if json_:
        from workhold.presenting.data import describe_part

        print_json(
            parts=[
                {**describe_part(load(one.name)), "description": one.description}
                for one in list_builtin_parts()
            ]
        )
        return
    decimals = shown.decimals - 2
    width, height = f">width {shown.abbreviation}", f">height {shown.abbreviation}"
    table = Table(("name", width, height, ">faces", "description"))
    for part in list_builtin_parts():
        workpiece = load(part.name)
        x0, y0, x1, y1 = workpiece.bounds
        size = shown.format_number(x1 - x0, decimals), shown.format_number(y1 - y0, decimals)
        table.add_row(part.name, *size, str(len(workpiece.faces)), part.description)
    print_tables(table)


def toolkits(
    name: Annotated[
        str | None,
        typer.Argument(
            metavar="[VISE]",
            help="Show all figures of this toolkit: a name, a TOML file of your own, or a vise of FreeCAD.",
        ),
    ] = None,
    unit: str | None = SHOWN_UNIT,
    json_: bool = JSON,
) -> None:
    """List the vises, plates and fences that come with workhold, or show all figures of one.

    Names that begin with clamp- are plates with a lattice of dowel holes, three locators and a side clamp;
    two-clamp- have two clamps, and fence- have a fence and one locator. The others are vises with such a plate
    on each jaw. Their number of columns is only a usual one: your jaws may have more or fewer.

    Example: workhold toolkits plate-one-inch --unit inch
    """
    shown = None if unit is None else read_unit(unit)
    from workhold.files.toolkit_file import list_preset_names, load_toolkit
    from workhold.units import MILLIMETRE

    if json_:
        from workhold.presenting.data import describe_toolkit

        print_json(
            toolkits=[
                describe_toolkit(load_toolkit(one))
                for one in (list_preset_names() if name is None else [name])
            ]
        )
        return
    if name is None:
        print_tables(tabulate_toolkits(shown or MILLIMETRE))
        return
    loaded = load_toolkit(name)
    print_tables(
        *(line for line in (loaded.name, loaded.title) if line),
        tabulate_toolkit_figures(loaded, shown or loaded.unit),
    )
    if loaded.source:
        print_tables(f"Source: {loaded.source}.")


def tabulate_toolkits(unit: Unit) -> Table:
    """Return a table of all preset toolkits."""
    from workhold.files.toolkit_file import list_preset_names, load_toolkit

    of = unit.abbreviation
    table = Table(("name", f">pitch {of}", f">peg Ø {of}", ">columns", f">peg off by {of}", "what it is"))
    for name in list_preset_names():
        loaded = load_toolkit(name)
        if not loaded.toolkit.plates:
            table.add_row(name, *["-"] * 4, loaded.title)
            continue
        first = loaded.toolkit.plates[0]
        table.add_row(
            name,
            format_pitch(first.pitch, unit),
            unit.format_short_length(2 * first.peg_radius),
            "any" if first.columns is None else str(first.columns),
            unit.format_number(loaded.tolerance.peg, unit.decimals + 1),
            loaded.title,
        )
    return table


def tabulate_toolkit_figures(loaded: LoadedToolkit, unit: Unit) -> Table:
    """Return a table with a row of words and value for each figure of a toolkit, lengths in a unit."""
    toolkit, of = loaded.toolkit, unit.abbreviation
    if not toolkit.plates:
        table = Table(("figure", "value"))
        for words, value in list_own_figures(loaded, unit):
            table.add_row(words, value)
        return table
    first, finest = toolkit.plates[0], unit.decimals + 1
    each = f"on {'each' if len(toolkit.plates) > 1 else 'the'} {first.noun}"
    table = Table(("figure", "value"))
    table.add_row("distance between holes", f"{format_pitch(first.pitch, unit)} {of}")
    for words, count in (("columns", first.columns), ("rows", first.rows)):
        table.add_row(f"{words} {each}", "as many as needed" if count is None else str(count))
    table.add_row("peg radius", f"{unit.format_short_length(first.peg_radius, finest)} {of}")
    if first.flat is not None:
        table.add_row(
            "from a peg's centre to its flat", f"{unit.format_short_length(first.flat.distance, finest)} {of}"
        )
    for words, value in list_own_figures(loaded, unit):
        table.add_row(words, value)
    if loaded.tolerance.fit is not None:
        table.add_row("pin diameter", format_limits(loaded.tolerance.fit.pin, unit))
        table.add_row("hole diameter", format_limits(loaded.tolerance.fit.hole, unit))
        assumed = " (assumed: no source says)" if loaded.tolerance.fit.position_assumed else ""
        table.add_row(
            "largest error of a hole's place",
            f"{unit.format_short_length(loaded.tolerance.fit.position, finest)} {of}{assumed}",
        )
    assumed = " (assumed: no pin and hole are given)" if loaded.tolerance.fit is None else ""
    table.add_row(
        "largest error of a peg's surface",
        f"{unit.format_short_length(loaded.tolerance.peg, finest)} {of}{assumed}",
    )
    table.add_row(
        "largest error of a face of the part",
        f"{unit.format_short_length(loaded.tolerance.face, finest)} {of}",
    )
    return table


def list_own_figures(loaded: LoadedToolkit, unit: Unit) -> Iterator[tuple[str, str]]:
    """Yield (words, value as text) of the figures that a toolkit has beyond those of every plate; unset ones
    are left out.
    """
    from workhold.fixels.kinds import find_table

    toolkit = loaded.toolkit
    for hardware in (toolkit.supports, toolkit.top_clamp, toolkit.pins):
        for row in () if hardware is None else hardware.table.fields:
            value = getattr(hardware, row.name)
            if row.form in ("length", "stress") and value is not None:
                yield row.figure, format_field_value(row.form, value, unit)
            elif value is not None:
                each = (f"{format_field_value(row.form, one, unit).replace(' to ', ', ')}" for one in value)
                yield row.figure, "; ".join(each)
    for row in find_table(loaded.kind).fields:
        value = getattr(toolkit, row.name)
        is_usual = value == (toolkit.find_followed_length(row) if row.follows else row.default)
        if row.figure and (row.unset or row.is_always_shown or not is_usual):
            assumed = " (assumed: no source says)" if row.name in loaded.assumed else ""
            yield (
                row.figure,
                (row.unset if value is None else format_field_value(row.form, value, unit)) + assumed,
            )


def format_field_value(form: Form, value: Any, unit: Unit) -> str:
    """Return the value of a toolkit's field as text with the unit's abbreviation where it is a length.

    ``form`` is the form of the field, such as "length".
    """
    if form == "count":
        return str(value)
    if form == "stress":
        return unit.format_stress(value)
    if form == "force":
        return unit.format_force(value)
    if form == "choice":
        return str(value)
    if form == "lengths":
        return f"{', '.join(unit.format_short_length(one) for one in value)} {unit.abbreviation}"
    if form == "holes":
        return " ".join(holes.name for holes in value)
    if form == "directions":
        return " or ".join(one if isinstance(one, str) else " and ".join(one) for one in value)
    if form == "pitch":
        return f"{format_pitch(value, unit)} {unit.abbreviation}"
    lengths = value if isinstance(value, tuple) else (value,)
    return f"{' to '.join(unit.format_short_length(one, unit.decimals + 1) for one in lengths)} {unit.abbreviation}"


def format_pitch(pitch: tuple[float, float], unit: Unit) -> str:
    """Return a pitch (x, y) in mm as text without the unit:
    one number where both are equal, else such as "10 x 12.5".
    """
    x, y = (unit.format_short_length(length) for length in pitch)
    return x if pitch[0] == pitch[1] else f"{x} x {y}"


def format_limits(limits: Limits, unit: Unit) -> str:
    """Return limits in mm as text with the unit's abbreviation, such as "5.98 to 6.00 mm"."""
    return f"{unit.format_number(limits[0])} to {unit.format_length(limits[1])}"


@frozen
class FeatureOptions:
    """The options that choose what is listed of a part, as typed."""

    draw: str | None = make_option(None, "FILE", "Draw them into this file, whose name ends in .svg or .png.")
    force: bool = FORCE
    toolkit: str | None = make_option(
        None,
        "NAME|FILE",
        "Toolkit that will hold the part: faces of a STEP file get the numbers that design "
        "--toolkit gives them, with pegs no higher than they must be.",
        "--toolkit",
    )
    peg_radius: str | None = make_option(
        None, "LENGTH", "Also draw where the centres of pegs of this radius can be."
    )
    parts: bool = make_flag(
        None, "List and draw the parts of a file that holds several, or the solids of a STEP file.", "--parts"
    )
    layers: bool = make_flag(None, "List the layers of a DXF file with their contents.", "--layers")
    json_: bool = JSON


@frozen
class FeaturesTask:
    """A part whose faces, layers, solids or parts are to be listed.

    Parameters
    ----------
    radius : radius in mm of the pegs whose centres' curves are drawn; None for no curves.
    unit : of lengths shown.
    """

    part: str
    words: FeatureOptions
    reading: PartOptions
    radius: float | None
    picture: Path | None
    unit: Unit

    @property
    def written(self) -> list[str]:
        """Paths of what is written: the picture, or none."""
        return [] if self.picture is None else [str(self.picture)]

    def load(self) -> LoadedPart:
        """Return the part as read from its file.

        If a toolkit is named, the part is read with the carrier heights and the peg diameter of that toolkit.
        """
        if self.words.toolkit is None:
            return self.reading.load(self.part)
        from workhold.files.toolkit_file import load_toolkit

        held_in = load_toolkit(self.words.toolkit).toolkit
        return self.reading.load(self.part, held_in.heights, held_in.peg_diameter)


@spread_option_groups
def features(part: PartArgument, *, words: FeatureOptions, reading: PartOptions) -> None:
    """List the numbered faces of PART, as pictures and result files name them.

    Example: workhold features part.dxf --draw faces.svg
    """
    asked = parse(part, words, reading)
    if words.layers:
        report_layers(asked)
    elif words.parts and asked.picture is None and Path(part).suffix.lower() in SOLIDS:
        report_solids(asked)
    elif words.parts:
        report_parts(asked, asked.load())
    else:
        report_faces(asked, asked.load())


def parse(part: str, words: FeatureOptions, reading: PartOptions) -> FeaturesTask:
    """Return what was typed as a task, checked; the part itself is not read yet."""
    unit, radius = read_unit(reading.unit), words.peg_radius
    wide = None if radius is None else read_length_from_zero("--peg-radius", radius, unit)
    picture = read_picture_path(words.draw, (part,), words.force)
    return FeaturesTask(part, words, reading, wide, picture, unit)


def report_faces(asked: FeaturesTask, loaded: LoadedPart) -> None:
    """Print the faces of a part, and draw them if asked.

    Where a peg radius was typed, the drawing also has the curves of the peg's centre along each face.
    """
    workpiece, unit = loaded.workpiece, asked.unit
    if not asked.words.json_:
        from workhold.cli.tables import (
            explain_missing_face_numbers,
            tabulate_face_heights,
            tabulate_faces,
            tabulate_peg_heights,
        )

        x0, y0, x1, y1 = workpiece.bounds
        size = f"{unit.format_number(x1 - x0)} x {unit.format_length(y1 - y0)}"
        of_solid = (*tabulate_face_heights(workpiece, unit), *tabulate_peg_heights(loaded.heights, unit))
        print_tables(
            f"{workpiece.name}: {size}, {format_count(len(workpiece.faces), 'face')}",
            tabulate_faces(workpiece, unit),
            *explain_missing_face_numbers(workpiece),
            *of_solid,
        )
    if asked.picture is not None:
        from workhold.drawing.part_pictures import draw_features

        write_picture(asked.picture, draw_features(workpiece, peg_radius=asked.radius, unit=unit))
    if not asked.words.json_:
        print_tables(*(f"Drawn in {path}." for path in asked.written))
        return
    from workhold.presenting.data import describe_part

    rows = {"heights": [asdict(row) for row in loaded.heights]} if loaded.heights else {}
    print_json(**describe_part(workpiece, loaded.remarks), **rows, written=asked.written)


def report_layers(asked: FeaturesTask) -> None:
    """Print the layers of a DXF file.

    In JSON, sizes are in mm where the drawing's unit is known ("in_mm"), else in units of the drawing.
    """
    from workhold.files.part.survey import list_drawn_layers

    unit = asked.unit
    found, known = list_drawn_layers(asked.part, asked.reading.drawing_unit, asked.reading.unit)
    if asked.words.json_:
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


def report_solids(asked: FeaturesTask) -> None:
    """Print the solids of a STEP file."""
    from workhold.cli.tables import tabulate_solids
    from workhold.files.part.loaded import solids_in

    solids = solids_in(asked.part)
    if asked.words.json_:
        print_json(solids=[asdict(solid) for solid in solids])
        return
    print_tables(
        tabulate_solids(solids, asked.unit), "Take one of them with --part and its number or its name."
    )


def report_parts(asked: FeaturesTask, loaded: LoadedPart) -> None:
    """Print the parts of a drawing, and draw them if asked."""
    unit = asked.unit
    table = Table(
        (">part", f">width {unit.abbreviation}", f">height {unit.abbreviation}", ">holes", "lowest corner")
    )
    for one in loaded.parts:
        x0, y0, x1, y1 = one.bounds
        corner = f"({unit.format_number(x0)}, {unit.format_number(y0)})"
        table.add_row(
            str(one.number),
            unit.format_number(x1 - x0),
            unit.format_number(y1 - y0),
            str(len(one.loops) - 1),
            corner,
        )
    if not asked.words.json_:
        print_tables(table)
    if asked.picture is not None:
        from workhold.drawing.part_pictures import draw_parts

        svg = draw_parts(
            loaded.workpiece.name,
            [[loop.vertices for loop in one.loops] for one in loaded.parts],
            loaded.number,
            unit=unit,
        )
        write_picture(asked.picture, svg)
    if not asked.words.json_:
        print_tables(*(f"Drawn in {path}." for path in asked.written))
        return
    parts = [{"number": p.number, "bounds": list(p.bounds), "holes": len(p.loops) - 1} for p in loaded.parts]
    print_json(parts=parts, chosen=loaded.number, written=asked.written)
