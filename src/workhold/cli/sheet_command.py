"""``workhold sheet``: one fixture of a result file on paper, or as a drawing for the CAM system."""

from __future__ import annotations

from datetime import date
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from workhold.cli.options import ShownUnitOption
from workhold.cli.outputs import ForceOption, refuse_output
from workhold.cli.ranked import RankArgument, ResultArgument, asked_rank, result_with
from workhold.cli.search_options import FrictionOption, JawForceOption, LoadOption, LoadsOption, asked_loads
from workhold.cli.values import choice, length_unit, positive_number
from workhold.errors import InputError

if TYPE_CHECKING:
    from workhold.model.load import Load
    from workhold.model.result import Result

__all__ = ["sheet"]

PAPER_ENDINGS = (".pdf", ".svg", ".png")
MODEL_ENDINGS = (".dxf", ".step", ".stp")
# A PNG is so many pixels wide; a second page makes it higher.
PNG_WIDTH = 2400

ON_PAPER = "On the paper"


def sheet(
    result_file: ResultArgument,
    number: RankArgument,
    out: Annotated[
        str,
        typer.Option(
            "--out", "-o", metavar="FILE", help="The file to write; its name ends in .pdf, .svg, .png, .dxf or .step."
        ),
    ],
    force: ForceOption = False,
    paper: Annotated[str, typer.Option(metavar="SIZE", help="a4 or letter.", rich_help_panel=ON_PAPER)] = "a4",
    unit: ShownUnitOption = None,
    part_name: Annotated[
        str | None,
        typer.Option(
            metavar="NAME", help="What to call the part; its own name if not given.", rich_help_panel=ON_PAPER
        ),
    ] = None,
    day: Annotated[
        str | None,
        typer.Option(
            "--date", metavar="YYYY-MM-DD", help="The date of the sheet; today if not given.", rich_help_panel=ON_PAPER
        ),
    ] = None,
    load: LoadOption = None,
    loads: LoadsOption = None,
    jaw_force: JawForceOption = None,
    friction: FrictionOption = None,
) -> None:
    """Write the setup sheet of fixture N of a result: plan to scale, pegs, opening, part zero, quality, loads, cautions.

    Loads given here stand instead of those in the result. The paper sizes are A4 and Letter. A .dxf or .step file holds
    the set-up itself, in mm, for a CAM system.

    Example: workhold sheet part.json 1 -o setup.pdf --jaw-force 3000
    """
    rank = asked_rank(number)
    path = Path(out)
    ending = path.suffix.lower()
    if ending not in PAPER_ENDINGS + MODEL_ENDINGS:
        raise InputError(
            f"-o {path} names no kind of setup sheet: let the name end in .pdf, .svg, .png, .dxf or .step."
        )
    shown_unit = length_unit(unit)
    settings = {
        "paper": choice("--paper", paper, ("a4", "letter")),
        "unit": shown_unit,
        "day": date.today() if day is None else day_of(day),
        "part_name": part_name,
        "jaw_force": positive_number("--jaw-force", jaw_force),
        "friction": positive_number("--friction", friction),
    }
    given = asked_loads(load, loads, shown_unit)
    refuse_output(path, (result_file, loads), force)
    result = result_with(result_file, rank)
    if ending in MODEL_ENDINGS:
        write_model(path, ending, result, rank)
    else:
        write_paper(path, ending, result, rank, given or result.query.loads, result_file, settings)
    from workhold.cli.tables import print_tables

    print_tables(f"Written to {path}.")


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


def write_model(path: Path, ending: str, result: Result, rank: int) -> None:
    """Write the set-up for a CAM system."""
    setup = (result[rank - 1], result.workpiece, result.vise, path)
    if ending == ".dxf":
        from workhold.files.dxf.setup import write_setup_dxf

        write_setup_dxf(*setup)
        return
    from workhold.files.step.setup import write_setup_step

    write_setup_step(*setup)


def write_paper(
    path: Path,
    ending: str,
    result: Result,
    rank: int,
    loads: tuple[Load, ...],
    result_file: str,
    settings: dict[str, Any],
) -> None:
    """Write the sheet."""
    from hashlib import sha256

    from workhold.drawing.render import svg_to_png
    from workhold.drawing.result_sheet import result_sheet
    from workhold.drawing.scene import stacked
    from workhold.files.atomic import write_bytes

    digest = sha256(Path(result_file).read_bytes()).hexdigest()
    pages = result_sheet(result, rank, result_hash=digest, loads=loads, **settings)
    if ending == ".pdf":
        from workhold.drawing.pdf import svg_to_pdf

        write_bytes(path, svg_to_pdf(pages, settings["day"]))
    elif ending == ".svg":
        write_bytes(path, stacked(pages).encode("utf-8"))
    else:
        write_bytes(path, svg_to_png(stacked(pages), PNG_WIDTH))
