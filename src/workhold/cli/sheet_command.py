"""The command ``sheet``: one fixture on paper or for a CAM system."""

from __future__ import annotations

from datetime import date
from pathlib import Path
from threading import Event
from typing import Annotated, Any

import typer

from workhold.cli.commands import flag, option
from workhold.cli.options import SHOWN_UNIT, asked_rank, result_with
from workhold.cli.outputs import FORCE, JSON, print_written, refuse_output
from workhold.cli.search_options import FRICTION, JAW, JAW_FORCE, LOAD, LOADS_FILE, asked_loads
from workhold.cli.setup_sheets import chosen_of_file, chosen_supports, first_side_of
from workhold.cli.values import (
    choice,
    length_from_zero,
    length_unit,
    optional_force,
    optional_positive_length,
    positive_number,
    printed_unit,
    two_lengths,
)
from workhold.errors import InputError
from workhold.limits import refuse_long
from workhold.units import Unit

__all__ = ["sheet"]

ON_PAPER, BODIES, SUPPORTS = "On the paper", "Part and pegs", "Supports and the other side"


def sheet(
    result_file: Annotated[
        str,
        typer.Argument(
            metavar="RESULT", help="A result file of workhold design, or a file of workhold supports --out."
        ),
    ],
    number: Annotated[
        str,
        typer.Argument(
            metavar="N",
            help="Which fixture, by rank: 1 is the best; of a file of supports which set of three.",
        ),
    ],
    out: Annotated[
        str,
        typer.Option(
            "--out",
            "-o",
            metavar="FILE",
            help="The file to write; its name ends in .pdf, .svg, .png, .dxf, .step or .csv.",
        ),
    ],
    force: bool = FORCE,
    paper: str | None = option(
        ON_PAPER, "SIZE", "a4 or letter; letter for lengths in inches if not given, else a4."
    ),
    unit: str | None = SHOWN_UNIT,
    part_name: str | None = option(ON_PAPER, "NAME", "What to call the part; its own name if not given."),
    day: str | None = option(ON_PAPER, "YYYY-MM-DD", "The date of the sheet; today if not given.", "--date"),
    zero: str | None = option(
        None,
        "POINT",
        "Part zero: corner (lower left, as drawn), centre, hole N, or X,Y of the drawing. If not given, the "
        "origin of the drawing where that is on the part, else the corner.",
    ),
    at: str | None = option(
        None,
        "HOLE",
        "Where on the plate all of it stands: the hole of its lowest column and row, such as D4. In the "
        "middle of the plate if not given.",
    ),
    machine_position: str | None = option(
        ON_PAPER,
        "X,Y",
        "Where the machine stands over hole A1 of the fixed jaw: gives the lines G10 L2 and G68.",
    ),
    thickness: str | None = option(
        BODIES, "LENGTH", "Thickness of the part; that of its solid, or a line to write it on, if not given."
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
    plate_thickness: str | None = option(
        BODIES, "LENGTH", "How far pegs go into the plate; 10 mm is assumed if not given."
    ),
    supports: bool = flag(
        SUPPORTS,
        "With the best three supports under the part and a clamp on top, of the usual sizes.",
        "--supports",
    ),
    support_height: str | None = option(
        SUPPORTS, "LENGTH", "How high the supports lift the part; 10 mm is assumed if not given."
    ),
    first_setup: str | None = option(
        SUPPORTS,
        "RESULT",
        "Of a solid's second side: the result of the first, to say which faces it cuts and locates on.",
    ),
    seating: bool = flag(
        ON_PAPER,
        "Say whether the part ends up there: how far to open, and how it looks where it does not.",
        "--seating",
    ),
    load: list[str] | None = LOAD,
    loads: str | None = LOADS_FILE,
    jaw_force: str | None = JAW_FORCE,
    jaw: str = JAW,
    friction: str | None = FRICTION,
    json_: bool = JSON,
) -> None:
    """Write the setup sheet of fixture N of a result: plan to scale, pegs, opening, part zero, quality,
    loads, cautions.

    Loads given here stand instead of those in the result. The paper sizes are A4 and Letter. Where the part's
    thickness is known, a view from the side has the heights. A .dxf or .step file holds the set-up itself, in
    mm, for a CAM system; a .csv file lists the pins.

    Example: workhold sheet part.json 1 -o setup.pdf --jaw-force 3000
    """
    from workhold.presenting.assembly import STEP_ENDINGS
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
    from workhold.verification.supports import is_supports_file

    settings: dict[str, Any] = {
        "paper": "" if paper is None else choice("--paper", paper, ("a4", "letter")),
        "unit": shown_unit,
        "day": date.today() if day is None else day_of(day),
        "part_name": part_name,
        "jaw_force": optional_force("--jaw-force", jaw_force),
        "friction": None if friction is None else positive_number("--friction", friction),
        "jaw": jaw_stiffness(jaw),
        "zero": zero,
        "at": at,
        "thickness": optional_positive_length("--thickness", thickness, shown_unit),
        "peg_length": optional_positive_length("--peg-length", peg_length, shown_unit),
        "peg_height": optional_positive_length("--peg-height", peg_height, shown_unit),
        "dowel": dowel,
        "seating": seating or None,
        "machine_position": None if machine_position is None else position(machine_position, shown_unit),
        "support_height": optional_positive_length("--support-height", support_height, shown_unit),
        "plate_thickness": optional_positive_length("--plate-thickness", plate_thickness, shown_unit),
    }
    keep_off = length_from_zero("--clearance", clearance, shown_unit)
    given = asked_loads(load, loads, shown_unit)
    on_supports = is_supports_file(result_file)
    for_cam = ending in MODEL_ENDINGS
    shows_supports = not for_cam or ending in STEP_ENDINGS
    refuse_in_space(for_cam, shows_supports, path, supports or on_supports, support_height, first_setup)
    refuse_output(path, (result_file, loads, first_setup), force)
    if on_supports:
        chosen = chosen_of_file(result_file, rank, settings, given)
        result, rank = chosen.supports.fixture.listing.result, 1
        settings |= {"supports": chosen, "listed_as": "Supports"}
        settings |= {"number": chosen.number, "count": len(chosen.supports.triples)}
        given = tuple(flat for one in chosen.supports.loads if (flat := one.planar) is not None)
    else:
        result = result_with(result_file, rank)
        if supports:
            settings["supports"] = chosen_supports(
                result, rank, settings["thickness"], given or None, settings["jaw_force"]
            )
    if first_setup is not None:
        settings["first_side"] = first_side_of(result, rank, first_setup)
    if seating and result[rank - 1].seating is None and result.toolkit.closes_at_once:
        from workhold.cli.warming import compile_seating

        compile_seating(Event())
    if for_cam:
        write_model(path, result, rank, settings, keep_off)
    else:
        settings |= {"loads": given or result.query.loads, "unit": printed_unit(unit, result.toolkit)}
        write_paper(path, result, rank, result_file, settings)
    print_written(json_, f"Written to {path}.", path)


def refuse_in_space(
    for_cam: bool,
    shows_supports: bool,
    path: Path,
    supported: bool,
    support_height: str | None,
    first_setup: str | None,
) -> None:
    """Refuses what stands on paper only in a file for a CAM system, and a height of no supports."""
    if for_cam and first_setup is not None:
        raise InputError(
            f"--first-setup is of a sheet on paper, not of {path}: let the name end in .pdf, .svg or .png."
        )
    if supported and not shows_supports:
        raise InputError(
            f"{path} has no supports: let the name end in .pdf, .svg, .png or .step, or leave --supports out."
        )
    if support_height is not None and not supported:
        raise InputError("--support-height is of supports: give --supports, or leave it out.")


def day_of(text: str) -> date:
    """Reads a date typed as YYYY-MM-DD."""
    try:
        return date.fromisoformat(text)
    except ValueError:
        raise InputError(
            f"--date {text!r} is not a date: give it as YYYY-MM-DD, such as 2026-03-31."
        ) from None


def position(text: str, unit: Unit) -> tuple[float, float]:
    """Reads a position typed as X,Y; returns its two lengths in mm."""
    option_name = "--machine-position"
    place = two_lengths(option_name, text, unit, "a position: give it as X,Y, such as -312.5,-88.")
    for value in place:
        refuse_long(option_name, value)
    return place
