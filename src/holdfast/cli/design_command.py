"""``holdfast design``: every fixture of a part in a vise."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from holdfast.cli.options import (
    JoinToleranceOption,
    LayerOption,
    PartArgument,
    PartNumberOption,
    UnitOption,
    load_part,
)
from holdfast.cli.progress import INTERRUPTED, ask_to_stop, search_progress
from holdfast.cli.values import choice, counting_number, length, optional_length, pitches, whole_number
from holdfast.errors import InputError

if TYPE_CHECKING:
    from holdfast.model.result import Result

__all__ = ["design"]

VISE, SEARCH, OUTPUT = "The vise", "The search", "Results"
STANDARD_OUTPUT = "-"


TYPES: dict[str, tuple[Literal["I", "II"], ...]] = {"I": ("I",), "II": ("II",), "both": ("I", "II")}
FORMATS = ("json", "csv")
ENGINES = ("curves", "algebra")


def design(
    part: PartArgument,
    pitch: Annotated[
        str,
        typer.Option(
            metavar="X[,Y]",
            help="Distance between neighbouring holes, one for both directions or X,Y.",
            rich_help_panel=VISE,
        ),
    ],
    columns: Annotated[str, typer.Option(metavar="N", help="Columns of holes on each jaw.", rich_help_panel=VISE)],
    peg_radius: Annotated[str, typer.Option(metavar="MM", help="Radius of the pegs.", rich_help_panel=VISE)],
    rows: Annotated[
        str | None,
        typer.Option(
            metavar="N", help="Rows of holes on each jaw; as many as needed if not given.", rich_help_panel=VISE
        ),
    ] = None,
    min_gap: Annotated[
        str | None,
        typer.Option(
            metavar="MM",
            help="Smallest distance along x from a left peg's centre to a right peg's; the x pitch if not given.",
            rich_help_panel=VISE,
        ),
    ] = None,
    max_opening: Annotated[
        str | None,
        typer.Option(
            metavar="MM",
            help="Largest distance from the left jaw's last column to the right jaw's first; no limit if not given.",
            rich_help_panel=VISE,
        ),
    ] = None,
    row_offset: Annotated[
        str,
        typer.Option(metavar="MM", help="Height of the right jaw's rows above the left jaw's.", rich_help_panel=VISE),
    ] = "0",
    type_: Annotated[
        str,
        typer.Option(
            "--type",
            metavar="I|II|both",
            help="I: two pegs on each jaw; II: three on the left, one on the right.",
            rich_help_panel=SEARCH,
        ),
    ] = "both",
    contact_margin: Annotated[
        str,
        typer.Option(
            metavar="MM", help="Smallest distance from a contact to the end of its face.", rich_help_panel=SEARCH
        ),
    ] = "0",
    best: Annotated[
        str | None,
        typer.Option(metavar="K", help="Keep only the best K, by closure margin.", rich_help_panel=SEARCH),
    ] = None,
    threads: Annotated[
        str | None,
        typer.Option(metavar="N", help="Threads to use; all processors if not given.", rich_help_panel=SEARCH),
    ] = None,
    engine: Annotated[
        str,
        typer.Option(
            metavar="curves|algebra",
            help="curves: the fast search. algebra: the paper's own polynomials, slower; both list the same fixtures.",
            rich_help_panel=SEARCH,
        ),
    ] = "curves",
    out: Annotated[
        str | None,
        typer.Option(
            metavar="FILE", help="Write all fixtures to this file; - is the terminal.", rich_help_panel=OUTPUT
        ),
    ] = None,
    format_: Annotated[
        str | None,
        typer.Option(
            "--format",
            metavar="json|csv",
            help="Form of the file; csv is for a spreadsheet. If not given, the file's name decides.",
            rich_help_panel=OUTPUT,
        ),
    ] = None,
    draw: Annotated[
        str | None,
        typer.Option(
            metavar="DIR",
            help="Draw the best twelve and a sheet of thumbnails into this folder.",
            rich_help_panel=OUTPUT,
        ),
    ] = None,
    list_: Annotated[
        str, typer.Option("--list", metavar="N", help="How many to list on the terminal.", rich_help_panel=OUTPUT)
    ] = "5",
    unit: UnitOption = None,
    layer: LayerOption = None,
    part_number: PartNumberOption = None,
    join_tolerance: JoinToleranceOption = "0.001",
) -> None:
    """Find every way to hold PART in a vise.

    Four pegs stand in holes of the two jaws: two on each (type I), or three on the left and one on the right (type II).
    All lengths are in millimetres.

    Example: holdfast design part.dxf --pitch 10 --columns 2 --peg-radius 3 --out part.json
    """
    # Everything cheap is checked before anything is read, and everything is checked before the search.
    pitch_x, pitch_y = pitches(pitch)
    radius = length("--peg-radius", peg_radius)
    gap, opening = optional_length("--min-gap", min_gap), optional_length("--max-opening", max_opening)
    offset, margin = length("--row-offset", row_offset), length("--contact-margin", contact_margin)
    if margin < 0:
        raise InputError(f"--contact-margin {contact_margin} is negative: give 0 or more, in mm.")
    kept = counting_number("--best", best, "fixtures to keep")
    workers = counting_number("--threads", threads, "threads")
    find_fixtures = search_of(choice("--engine", engine, ENGINES), workers)
    types = TYPES[choice("--type", type_, tuple(TYPES))]
    column_count, listed = whole_number("--columns", columns), whole_number("--list", list_)
    row_count = None if rows is None else whole_number("--rows", rows)
    form = output_format(out, format_)
    folder = None if draw is None else Path(draw)
    refuse_outputs(out, folder)

    from holdfast.kernels.compiling import is_first_run
    from holdfast.model.vise import Vise

    vise = Vise((pitch_x, pitch_y), column_count, radius, row_count, gap, opening, offset)
    workpiece = load_part(part, unit, layer, part_number, join_tolerance).workpiece
    first_run = is_first_run()
    start = perf_counter()
    with ask_to_stop() as cancel, search_progress(first_run) as progress:
        if first_run and engine == "curves":
            from holdfast.cli.warming import compile_kernels

            compile_kernels(cancel)
        result = find_fixtures(
            workpiece,
            vise,
            types=types,
            contact_margin=margin,
            best=kept,
            progress=progress,
            cancel=cancel,
        )
    spent = f"{perf_counter() - start:.1f} s" + (", compiling on this first run included" if first_run else "")
    report(result, spent, out, form, listed)
    if not result.complete:
        raise typer.Exit(INTERRUPTED)
    if folder is not None:
        draw_pictures(result, folder, out)


def search_of(engine: str, threads: int | None) -> Callable[..., Result]:
    """The search of an engine; it is imported only when it is called."""

    def search(*arguments: Any, **options: Any) -> Result:
        if engine == "algebra":
            from holdfast.algebra.engine import design_by_algebra

            return design_by_algebra(*arguments, **options)
        from holdfast.search.design import design

        return design(*arguments, threads=threads, **options)

    return search


def refuse_outputs(out: str | None, draw: Path | None) -> None:
    """Refuse outputs that could not be written in the end.

    Raises
    ------
    InputError
        Naming the file or folder.
    """
    from holdfast.files.atomic import refuse_unwritable, refuse_unwritable_folder

    if out is not None and out != STANDARD_OUTPUT:
        refuse_unwritable(out)
    if draw is not None:
        refuse_unwritable_folder(draw)


def output_format(out: str | None, asked: str | None) -> str:
    """The form of the result file: the one asked for, or the one that its name suggests.

    Raises
    ------
    InputError
        For a form that is not known.
    """
    if asked is not None:
        return choice("--format", asked, FORMATS)
    return "csv" if out is not None and out.lower().endswith(".csv") else "json"


def write_output(result: Result, out: str, form: str) -> None:
    """Write the result to a file or to the terminal."""
    if form == "csv":
        from holdfast.files.result_csv import write_result_csv as write
        from holdfast.files.result_csv import write_result_csv_to as write_to
    else:
        from holdfast.files.result_file import write_result as write
        from holdfast.files.result_file import write_result_to as write_to

    if out == STANDARD_OUTPUT:
        write_to(result, sys.stdout)
        sys.stdout.flush()
    else:
        write(result, out)


def report(result: Result, spent: str, out: str | None, form: str, listed: int) -> None:
    """Write the result and tell about it; the words go to stderr where stdout carries the file."""
    from holdfast.cli.tables import counts_sentence, print_tables, proof_sentences, result_table

    if out is not None:
        write_output(result, out, form)
    stream = sys.stderr if out == STANDARD_OUTPUT else sys.stdout
    for note in result.notes:
        typer.echo(f"holdfast: {note}", err=True)
    if len(result) and listed > 0:
        print_tables(result_table(result, listed), stream=stream)
    sentence = counts_sentence(result)
    if not sum(result.found.values()):
        found = "exists" if result.complete else "was found before the interruption"
        sentence = f"No fixture {found} for {result.workpiece.name} in this vise: the count is 0"
    written = out is not None and out != STANDARD_OUTPUT
    proof = proof_sentences(result, out if written and form == "json" else None)
    print_tables(f"{sentence}; {spent}.", *proof, stream=stream)
    if written:
        print_tables(f"Written to {out}.", stream=stream)
    if not result.complete:
        marked = f", and {out} is marked so" if written else ""
        typer.echo(f"holdfast: interrupted: this is a part of the fixtures only{marked}.", err=True)


def draw_pictures(result: Result, folder: Path, out: str | None) -> None:
    """Draw the best fixtures and say where they are."""
    from holdfast.cli.pictures import draw_best
    from holdfast.cli.tables import plural, print_tables

    written = draw_best(result, folder)
    stream = sys.stderr if out == STANDARD_OUTPUT else sys.stdout
    if written:
        print_tables(f"Drawn: {plural(len(written), 'picture')} in {folder}.", stream=stream)
    else:
        print_tables("Nothing to draw.", stream=stream)
