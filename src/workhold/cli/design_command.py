"""``workhold design``: every fixture of a part in a vise."""

from __future__ import annotations

import sys
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Annotated, Any

import typer

from workhold.cli.explanations import explain_none
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
from workhold.cli.outputs import ForceOption, refuse_output, refuse_output_folder
from workhold.cli.pictures import picture_names
from workhold.cli.progress import INTERRUPTED, ask_to_stop, search_progress
from workhold.cli.saying import tell
from workhold.cli.search_options import (
    AngleOption,
    AvoidOption,
    ContactMarginOption,
    KeepOutOption,
    LoadOption,
    LoadsOption,
    QueryWords,
    RankByOption,
    ToleranceOption,
)
from workhold.cli.values import choice, counting_number, length_unit, whole_number
from workhold.cli.vise_options import (
    BlockedOption,
    BodyRadiusOption,
    ColumnsOption,
    MaxOpeningOption,
    MinGapOption,
    MinOpeningOption,
    PegRadiusOption,
    PitchOption,
    RowOffsetOption,
    RowsOption,
    ToolkitOption,
    ViseOption,
    ViseWords,
)

if TYPE_CHECKING:
    from workhold.model.query import Query
    from workhold.model.result import Result
    from workhold.model.units import Unit

__all__ = ["design"]

SEARCH, OUTPUT = "The search", "Results"
STANDARD_OUTPUT = "-"
TYPES, BOTH = ("I", "II"), "both"
FORMATS = ("json", "csv")
ENGINES = ("curves", "algebra")


def design(
    part: PartArgument,
    vise: ViseOption = None,
    toolkit: ToolkitOption = None,
    pitch: PitchOption = None,
    columns: ColumnsOption = None,
    peg_radius: PegRadiusOption = None,
    body_radius: BodyRadiusOption = None,
    rows: RowsOption = None,
    blocked: BlockedOption = None,
    min_gap: MinGapOption = None,
    min_opening: MinOpeningOption = None,
    max_opening: MaxOpeningOption = None,
    row_offset: RowOffsetOption = None,
    avoid: AvoidOption = None,
    keep_out: KeepOutOption = None,
    angle: AngleOption = None,
    contact_margin: ContactMarginOption = "0",
    load: LoadOption = None,
    loads: LoadsOption = None,
    rank_by: RankByOption = None,
    tolerance: ToleranceOption = None,
    type_: Annotated[
        str,
        typer.Option(
            "--type",
            metavar="I|II|both",
            help="I: two pegs on each jaw; II: three on the left, one on the right.",
            rich_help_panel=SEARCH,
        ),
    ] = "both",
    best: Annotated[
        str | None,
        typer.Option(metavar="K", help="Keep only the best K.", rich_help_panel=SEARCH),
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
            help="Draw the best twelve and a sheet of thumbnails into this folder, or the nearest miss.",
            rich_help_panel=OUTPUT,
        ),
    ] = None,
    force: ForceOption = False,
    list_: Annotated[
        str, typer.Option("--list", metavar="N", help="How many to list on the terminal.", rich_help_panel=OUTPUT)
    ] = "5",
    unit: UnitOption = None,
    layer: LayerOption = None,
    part_number: PartNumberOption = None,
    drawing_unit: DrawingUnitOption = None,
    axis: AxisOption = None,
    section: SectionOption = None,
    join_tolerance: JoinToleranceOption = JOIN_TOLERANCE,
) -> None:
    """Find every way to hold PART in a vise.

    Four pegs stand in holes of the two jaws: two on each (type I), or three on the left and one on the right (type II).
    Lengths are in millimetres, or in the unit of --unit, or carry their own: 0.5in.

    Example: workhold design part.dxf --vise plate-20mm --out part.json
    """
    # Everything cheap is checked before anything is read, and everything is checked before the search.
    shown = length_unit(unit)
    vise_words = ViseWords(
        vise,
        toolkit,
        pitch,
        columns,
        peg_radius,
        body_radius,
        rows,
        blocked,
        min_gap,
        min_opening,
        max_opening,
        row_offset,
    )
    words = QueryWords(avoid, keep_out, angle, contact_margin, load, loads, rank_by, tolerance)
    kept = counting_number("--best", best, "fixtures to keep")
    workers = counting_number("--threads", threads, "threads")
    engine = choice("--engine", engine, ENGINES)
    type_ = choice("--type", type_, (*TYPES, BOTH))
    listed = whole_number("--list", list_)
    form = output_format(out, format_)
    folder = None if draw is None else Path(draw)
    if out is not None and out != STANDARD_OUTPUT:
        refuse_output(out, (part, vise, loads), force)
    if folder is not None:
        refuse_output_folder(folder, picture_names(), (part, vise, loads), force)
    in_toolkit, of_vise = vise_words.asked(shown)
    asked = words.asked(shown)
    asked["tolerance"] = asked["tolerance"] or of_vise
    from workhold.kernels.base.compiling import is_first_run
    from workhold.model.query import Query

    workpiece = load_part(part, unit, layer, part_number, join_tolerance, drawing_unit, axis, section).workpiece
    query = Query(workpiece, in_toolkit, None if type_ == BOTH else type_, best=kept, **asked)
    first_run = is_first_run()
    start = perf_counter()
    with ask_to_stop() as cancel, search_progress(first_run) as progress:
        if first_run and engine == "curves":
            from workhold.cli.warming import compile_kernels

            compile_kernels(cancel)
        result = answered(query, engine, threads=workers, progress=progress, cancel=cancel)
    spent = f"{perf_counter() - start:.1f} s" + (", compiling on this first run included" if first_run else "")
    report(result, spent, out, form, listed, shown)
    if not result.complete:
        raise typer.Exit(INTERRUPTED)
    if not any(result.found.values()) and engine == "curves":
        explain_none(result, workers, folder, shown, sys.stderr if out == STANDARD_OUTPUT else sys.stdout)
    elif folder is not None:
        draw_pictures(result, folder, out, shown)


def answered(query: Query, engine: str, threads: int | None, **watching: Any) -> Result:
    """The answer of an engine, which is imported only now."""
    if engine == "algebra":
        from workhold.algebra.engine import answer_by_algebra

        return answer_by_algebra(query, **watching)
    from workhold.search.design import answer

    return answer(query, threads=threads, **watching)


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
        from workhold.files.result.csv import write_result_csv as write
        from workhold.files.result.csv import write_result_csv_to as write_to
    else:
        from workhold.files.result.writer import write_result as write
        from workhold.files.result.writer import write_result_to as write_to

    if out == STANDARD_OUTPUT:
        write_to(result, sys.stdout)
        sys.stdout.flush()
    else:
        write(result, out)


def report(result: Result, spent: str, out: str | None, form: str, listed: int, unit: Unit) -> None:
    """Write the result and tell about it; the words go to stderr where stdout carries the file."""
    from workhold.cli.tables import counts_sentence, print_tables, proof_sentences, result_table

    if out is not None:
        write_output(result, out, form)
    stream = sys.stderr if out == STANDARD_OUTPUT else sys.stdout
    for note in result.notes:
        tell(note)
    if len(result) and listed > 0:
        print_tables(result_table(result, listed, unit), stream=stream)
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
        tell(f"interrupted: this is a part of the fixtures only{marked}.")


def draw_pictures(result: Result, folder: Path, out: str | None, unit: Unit) -> None:
    """Draw the best fixtures and say where they are."""
    from workhold.cli.pictures import draw_best
    from workhold.cli.tables import plural, print_tables

    written = draw_best(result, folder, unit)
    stream = sys.stderr if out == STANDARD_OUTPUT else sys.stdout
    if written:
        print_tables(f"Drawn: {plural(len(written), 'picture')} in {folder}.", stream=stream)
    else:
        print_tables("Nothing to draw.", stream=stream)
