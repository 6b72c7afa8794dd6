"""The commands that draw for the workshop: ``sheet``, ``copies`` and ``drill``.

They write one fixture on paper or for a CAM system, copies of a part on one plate, and the plates of a
vise's jaws.
"""

from __future__ import annotations

from datetime import date
from pathlib import Path
from threading import Event
from typing import TYPE_CHECKING, Annotated

import typer

from workhold.cli.commands import option, spread
from workhold.cli.options import SHOWN_UNIT, RankArgument, ResultArgument, asked_rank, result_with
from workhold.cli.outputs import ForceOption, JsonOption, print_json, print_written, refuse_output
from workhold.cli.search_options import FRICTION, JAW, JAW_FORCE, LOAD, LOADS_FILE, asked_loads
from workhold.cli.toolkit_options import ToolkitWords
from workhold.cli.values import (
    choice,
    length,
    length_unit,
    optional_count,
    optional_force,
    optional_positive_length,
    picture_ending,
    positive_number,
)
from workhold.errors import InputError
from workhold.limits import refuse_long
from workhold.units import Unit

if TYPE_CHECKING:
    from workhold.family.copies import Packing
    from workhold.model.dowels import Bolts
    from workhold.model.fixture import Fixture
    from workhold.model.result import Result
    from workhold.units import Unit

__all__ = ["copies", "drill", "sheet"]

ON_PAPER, BODIES = "On the paper", "Part and pegs"


def sheet(
    result_file: ResultArgument,
    number: RankArgument,
    out: Annotated[
        str,
        typer.Option(
            "--out",
            "-o",
            metavar="FILE",
            help="The file to write; its name ends in .pdf, .svg, .png, .dxf, .step or .csv.",
        ),
    ],
    force: ForceOption = False,
    paper: str = option(ON_PAPER, "SIZE", "a4 or letter.", default="a4"),
    unit: str | None = SHOWN_UNIT,
    part_name: str | None = option(ON_PAPER, "NAME", "What to call the part; its own name if not given."),
    day: str | None = option(ON_PAPER, "YYYY-MM-DD", "The date of the sheet; today if not given.", "--date"),
    zero: str | None = option(
        None,
        "POINT",
        "Part zero: corner (lower left, as drawn), centre, hole N, or X,Y of the drawing. If not given, the "
        "origin of the drawing where that is on the part, else the corner.",
    ),
    machine_position: str | None = option(
        ON_PAPER,
        "X,Y",
        "Where the machine stands over hole A1 of the fixed jaw: gives the lines G10 L2 and G68.",
    ),
    thickness: str | None = option(
        BODIES, "LENGTH", "Thickness of the part; a line to write it on if not given."
    ),
    peg_length: str | None = option(BODIES, "LENGTH", "Length of the pegs."),
    peg_height: str | None = option(BODIES, "LENGTH", "How far the pegs stand out of the jaws."),
    dowel: str | None = option(
        BODIES,
        "WORDS",
        "What the pegs are and how they fit, such as '6 mm m6 in H7'; what --vise said if not given.",
    ),
    clearance: str = option(
        BODIES,
        "LENGTH",
        "How far the cutter is to keep off the pegs, on the layer KEEP_OUT of a .dxf.",
        default="1mm",
    ),
    seating: Annotated[
        bool,
        typer.Option(
            "--seating",
            rich_help_panel=ON_PAPER,
            help="Say whether the part ends up there: how far to open, and how it looks where it does not.",
        ),
    ] = False,
    load: list[str] | None = LOAD,
    loads: str | None = LOADS_FILE,
    jaw_force: str | None = JAW_FORCE,
    jaw: str = JAW,
    friction: str | None = FRICTION,
    json_: JsonOption = False,
) -> None:
    """Write the setup sheet of fixture N of a result: plan to scale, pegs, opening, part zero, quality,
    loads, cautions.

    Loads given here stand instead of those in the result. The paper sizes are A4 and Letter. A .dxf or .step
    file holds the set-up itself, in mm, for a CAM system; a .csv file lists the pins.

    Example: workhold sheet part.json 1 -o setup.pdf --jaw-force 3000
    """
    from workhold.presenting.papers import MODEL_ENDINGS, PAPER_ENDINGS, write_model, write_paper

    rank = asked_rank(number)
    path = Path(out)
    ending = path.suffix.lower()
    if ending not in PAPER_ENDINGS + MODEL_ENDINGS:
        raise InputError(
            f"-o {path} names no kind of setup sheet: let the name end in .pdf, .svg, .png, .dxf, .step or "
            ".csv."
        )
    shown_unit = length_unit(unit)

    from workhold.statics.loads import jaw_stiffness

    settings = {
        "paper": choice("--paper", paper, ("a4", "letter")),
        "unit": shown_unit,
        "day": date.today() if day is None else day_of(day),
        "part_name": part_name,
        "jaw_force": optional_force("--jaw-force", jaw_force),
        "friction": positive_number("--friction", friction),
        "jaw": jaw_stiffness(jaw),
        "zero": zero,
        "thickness": optional_positive_length("--thickness", thickness, shown_unit),
        "peg_length": optional_positive_length("--peg-length", peg_length, shown_unit),
        "peg_height": optional_positive_length("--peg-height", peg_height, shown_unit),
        "dowel": dowel,
        "seating": seating or None,
        "machine_position": None if machine_position is None else position(machine_position, shown_unit),
    }
    keep_off = length("--clearance", clearance, shown_unit)
    if keep_off < 0:
        raise InputError(f"--clearance {clearance} is negative: give 0 or more.")
    given = asked_loads(load, loads, shown_unit)
    refuse_output(path, (result_file, loads), force)
    result = result_with(result_file, rank)
    if seating and result[rank - 1].seating is None and result.toolkit.closes_at_once:
        from workhold.cli.warming import compile_seating

        compile_seating(Event())
    if ending in MODEL_ENDINGS:
        write_model(path, result, rank, settings, keep_off)
    else:
        write_paper(path, result, rank, result_file, {**settings, "loads": given or result.query.loads})
    print_written(json_, f"Written to {path}.", path)


def day_of(text: str) -> date:
    """Reads a date typed as YYYY-MM-DD.

    Raises
    ------
    InputError
        When it is none.
    """
    try:
        return date.fromisoformat(text)
    except ValueError:
        raise InputError(
            f"--date {text!r} is not a date: give it as YYYY-MM-DD, such as 2026-03-31."
        ) from None


def position(text: str, unit: Unit) -> tuple[float, float]:
    """Reads a position typed as X,Y; returns its two lengths in mm.

    Raises
    ------
    InputError
        When it is none, or beyond all lengths.
    """
    parts = text.split(",")
    if len(parts) != 2:
        raise InputError(
            f"--machine-position {text!r} is not a position: give it as X,Y, such as -312.5,-88."
        )
    x, y = (length("--machine-position", part, unit) for part in parts)
    for value in (x, y):
        refuse_long("--machine-position", value)
    return x, y


def copies(
    result_file: ResultArgument,
    number: RankArgument,
    columns: str | None = option(
        None, "N", "Columns of holes of the plate; must be given where the result does not say."
    ),
    rows: str | None = option(
        None, "N", "Rows of holes of the plate; must be given where the result does not say."
    ),
    gap: str = option(
        None, "LENGTH", "Smallest distance between a part and anything of another copy.", default="1mm"
    ),
    time_limit: str = option(None, "SECONDS", "How long to prove that no more fit.", default="60"),
    draw: str | None = option(
        None, "FILE", "Draw the plate into this file, whose name ends in .svg or .png."
    ),
    force: ForceOption = False,
    unit: str | None = SHOWN_UNIT,
    json_: JsonOption = False,
) -> None:
    """Report how many copies of fixture N a plate holds at once, and where each stands.

    The fixture is repeated by whole columns and rows, so that parts, pegs and clamps of the copies are clear
    of each other.

    Example: workhold copies part.json 1 --columns 20 --rows 15 --draw plate.png
    """
    rank = asked_rank(number)
    shown = length_unit(unit)
    asked = optional_count("--columns", columns), optional_count("--rows", rows)
    apart = length("--gap", gap, shown)
    if apart < 0:
        raise InputError(f"--gap {gap} is negative: give 0 or more.")
    seconds = positive_number("--time-limit", time_limit)
    if draw is not None:
        picture_ending(Path(draw))
        refuse_output(draw, (result_file,), force)
    from workhold.family.copies import copies_of, draw_copies, packing_of
    from workhold.fixels.making import refuse_many_holes

    result = result_with(result_file, rank)
    size = plate_size(result, asked)
    refuse_many_holes(*size, result.toolkit.noun)
    packing = packing_of(result[rank - 1], result.workpiece, result.toolkit, *size, apart, seconds)
    row = result.table.take(slice(rank - 1, rank))
    found = copies_of(row, result.toolkit, result.workpiece, packing)
    if draw is not None:
        from workhold.drawing.render import render
        from workhold.files.atomic import write_bytes

        svg = draw_copies(found, result.workpiece, result.toolkit, size, unit=shown)
        write_bytes(draw, render(svg, Path(draw).suffix))
    written = [] if draw is None else [draw]
    if json_:
        places = [{"columns": i, "rows": j} for i, j in packing.shifts]
        print_json(copies=len(found), at_most=packing.at_most, shifts=places, written=written)
        return
    print_copies(found, packing, result, size, shown)
    if written:
        from workhold.cli.table import print_tables

        print_tables(f"Written to {draw}.")


def plate_size(result: Result, asked: tuple[int | None, int | None]) -> tuple[int, int]:
    """Returns columns and rows of the plate: those asked for, or those of the result.

    Raises
    ------
    InputError
        Where neither says.
    """
    plate = result.toolkit.carriers[0]
    size = [
        one if one is not None else own for one, own in zip(asked, (plate.columns, plate.rows), strict=True)
    ]
    for name, count in zip(("columns", "rows"), size, strict=True):
        if count is None:
            raise InputError(f"how large the plate is, is not known: give --{name}.")
    return size[0] or 0, size[1] or 0


def print_copies(
    found: list[Fixture], packing: Packing, result: Result, size: tuple[int, int], unit: Unit
) -> None:
    """Prints how many copies there are, and where each stands."""
    from workhold.cli.table import Table, print_tables
    from workhold.model.setup import part_zero

    zero = part_zero(result.workpiece)
    table = Table((">copy", f">X0 at x {unit.abbreviation}", f">Y0 at y {unit.abbreviation}", "holes"))
    for number, fixture in enumerate(found, 1):
        x, y = fixture.pose.apply(*zero.point)
        holes = ", ".join(peg.hole for peg in fixture.placed)
        table.add_row(str(number), unit.number(x), unit.number(y), holes)
    proven = "no more fit" if packing.at_most == len(found) else f"at most {packing.at_most} fit"
    count = "1 copy" if len(found) == 1 else f"{len(found)} copies"
    sentence = (
        f"{count} on a plate of {size[0]} columns and {size[1]} rows; {proven} by repeating this fixture."
    )
    print_tables(table, sentence, f"X0 Y0 is the {zero.words}.")


PLATES = "The plates"
ENDINGS = (".dxf", ".step", ".stp")


@spread
def drill(
    *,
    out: Annotated[
        str,
        typer.Option(
            "--out", "-o", metavar="FILE", help="The file to write; its name ends in .dxf or .step."
        ),
    ],
    force: ForceOption = False,
    held_in: ToolkitWords,
    bolts: str | None = option(
        PLATES, "X,Y;X,Y", "Where bolts hold each plate, from the centre of its hole A1: 5,-12;5,112."
    ),
    bolt_diameter: str | None = option(PLATES, "LENGTH", "Diameter of the holes for the bolts."),
    hole_diameter: str | None = option(
        PLATES,
        "LENGTH",
        "Diameter of the dowel holes; the middle of what --vise says, or that of the pegs, if not given.",
    ),
    edge: str | None = option(
        PLATES, "LENGTH", "From the outermost dowel holes to the plate's edges; half a pitch if not given."
    ),
    thickness: str | None = option(
        PLATES, "LENGTH", "Thickness of the plates in a .step file; 10 mm if not given."
    ),
    unit: str | None = SHOWN_UNIT,
    json_: JsonOption = False,
) -> None:
    """Write the plates of a vise's jaws with their dowel holes and bolt holes, to drill them from.

    Holes that are blocked are not drilled. The file is in mm, the plates side by side.

    Example: workhold drill --vise plate-20mm --rows 6 --bolts '10,10;10,90' --bolt-diameter 6.6 -o plates.dxf
    """
    path, shown = Path(out), length_unit(unit)
    ending = path.suffix.lower()
    if ending not in ENDINGS:
        raise InputError(f"-o {path} names no drawing of plates: let the name end in .dxf or .step.")
    bolted = asked_bolts(bolts, bolt_diameter, shown)
    diameter = optional_positive_length("--hole-diameter", hole_diameter, shown)
    distance = optional_positive_length("--edge", edge, shown)
    thick = optional_positive_length("--thickness", thickness, shown)
    refuse_output(path, (held_in.vise,), force)
    toolkit, tolerance = held_in.asked(shown)
    if any(carrier.rows is None or carrier.columns is None for carrier in toolkit.carriers):
        raise InputError(
            "how many columns and rows of holes the plates have is not given: add --columns and --rows."
        )
    if diameter is None and tolerance is not None and tolerance.fit is not None:
        diameter = sum(tolerance.fit.hole) / 2
    from workhold.model.dowels import jaw_plates

    made = jaw_plates(toolkit, hole_diameter=diameter, edge=distance, bolts=bolted, unit=shown)
    if ending == ".dxf":
        from workhold.files.dxf.writer import write_plates_dxf

        write_plates_dxf(made, path)
    else:
        from workhold.files.step.writer import write_plates_step

        write_plates_step(made, path, thick)
    print_written(json_, f"Written to {path}.", path)


def asked_bolts(places: str | None, diameter: str | None, unit: Unit) -> Bolts | None:
    """Reads the bolts asked for; None where there are none.

    Raises
    ------
    InputError
        For words that mean nothing, and one of the two options without the other.
    """
    if places is None and diameter is None:
        return None
    size = optional_positive_length("--bolt-diameter", diameter, unit)
    if places is None or size is None:
        raise InputError("bolts need --bolts and --bolt-diameter: give both, or neither.")
    from workhold.model.dowels import Bolts

    points = []
    for words in places.split(";"):
        numbers = words.split(",")
        if len(numbers) != 2:
            raise InputError(f"--bolts {places!r} is no list of places: give X,Y;X,Y, such as 5,-12;5,112.")
        x, y = (length("--bolts", number, unit) for number in numbers)
        points.append((x, y))
    return Bolts(size, tuple(points))
