"""``workhold sheet``: one fixture of a result file on paper, or as a drawing for the CAM system."""

from __future__ import annotations

from datetime import date
from pathlib import Path
from threading import Event
from typing import Annotated

import typer

from workhold.cli.commands import option
from workhold.cli.json_output import JsonOption, print_written
from workhold.cli.options import SHOWN_UNIT
from workhold.cli.outputs import ForceOption, refuse_output
from workhold.cli.ranked import RankArgument, ResultArgument, asked_rank, result_with
from workhold.cli.search_options import FRICTION, JAW, JAW_FORCE, LOAD, LOADS_FILE, asked_loads
from workhold.cli.values import choice, length, length_unit, optional_force, optional_positive_length, positive_number
from workhold.errors import InputError
from workhold.limits import refuse_long
from workhold.units import Unit

__all__ = ["sheet"]

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
        "Part zero: corner (lower left, as drawn), centre, hole N, or X,Y of the drawing. If not given, the origin of "
        "the drawing where that is on the part, else the corner.",
    ),
    machine_position: str | None = option(
        ON_PAPER, "X,Y", "Where the machine stands over hole A1 of the fixed jaw: gives the lines G10 L2 and G68."
    ),
    thickness: str | None = option(BODIES, "LENGTH", "Thickness of the part; a line to write it on if not given."),
    peg_length: str | None = option(BODIES, "LENGTH", "Length of the pegs."),
    peg_height: str | None = option(BODIES, "LENGTH", "How far the pegs stand out of the jaws."),
    dowel: str | None = option(
        BODIES, "WORDS", "What the pegs are and how they fit, such as '6 mm m6 in H7'; what --vise said if not given."
    ),
    clearance: str = option(
        BODIES, "LENGTH", "How far the cutter is to keep off the pegs, on the layer KEEP_OUT of a .dxf.", default="1mm"
    ),
    seating: Annotated[
        bool,
        typer.Option(
            "--seating",
            rich_help_panel=ON_PAPER,
            help="Tell whether the part ends up there: how far to open, and how it looks where it does not.",
        ),
    ] = False,
    load: list[str] | None = LOAD,
    loads: str | None = LOADS_FILE,
    jaw_force: str | None = JAW_FORCE,
    jaw: str = JAW,
    friction: str | None = FRICTION,
    json_: JsonOption = False,
) -> None:
    """Write the setup sheet of fixture N of a result: plan to scale, pegs, opening, part zero, quality, loads, cautions.

    Loads given here stand instead of those in the result. The paper sizes are A4 and Letter. A .dxf or .step file holds
    the set-up itself, in mm, for a CAM system; a .csv file lists the pins.

    Example: workhold sheet part.json 1 -o setup.pdf --jaw-force 3000
    """
    from workhold.presenting.papers import MODEL_ENDINGS, PAPER_ENDINGS, write_model, write_paper

    rank = asked_rank(number)
    path = Path(out)
    ending = path.suffix.lower()
    if ending not in PAPER_ENDINGS + MODEL_ENDINGS:
        raise InputError(
            f"-o {path} names no kind of setup sheet: let the name end in .pdf, .svg, .png, .dxf, .step or .csv."
        )
    shown_unit = length_unit(unit)

    from workhold.statics.jaw import jaw_stiffness

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
    """A date typed as YYYY-MM-DD.

    Raises
    ------
    InputError
        When it is none.
    """
    try:
        return date.fromisoformat(text)
    except ValueError:
        raise InputError(f"--date {text!r} is not a date: give it as YYYY-MM-DD, such as 2026-03-31.") from None


def position(text: str, unit: Unit) -> tuple[float, float]:
    """The two lengths in mm of a position typed as X,Y.

    Raises
    ------
    InputError
        When it is none, or beyond all lengths.
    """
    parts = text.split(",")
    if len(parts) != 2:
        raise InputError(f"--machine-position {text!r} is not a position: give it as X,Y, such as -312.5,-88.")
    x, y = (length("--machine-position", part, unit) for part in parts)
    for value in (x, y):
        refuse_long("--machine-position", value)
    return x, y
