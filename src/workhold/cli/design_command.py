"""``workhold design``: every fixture of a part in a vise or on a plate."""

from __future__ import annotations

import sys
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any, TextIO

import typer

from workhold.cli.commands import flag, option, print_remark, spread
from workhold.cli.design_report import NEAREST_MISS, draw_best, draw_one, explain_none, picture_names
from workhold.cli.ending import INTERRUPTED, ask_to_stop
from workhold.cli.options import CALLED, PartArgument, PartWords
from workhold.cli.outputs import (
    FORCE,
    FORMAT,
    JSON,
    OUTPUT,
    STANDARD_OUTPUT,
    output_form,
    print_json,
    refuse_both,
    refuse_output_folder,
    refuse_result_file,
    write_found,
)
from workhold.cli.program_options import ProgramWords
from workhold.cli.progress import search_progress
from workhold.cli.search_options import QueryWords, SeatingWords, with_fit_of, without_faces_cut
from workhold.cli.setup_sheets import first_sheet, refuse_sheet
from workhold.cli.supports_command import asked_thickness, report_supported
from workhold.cli.table import plural, print_tables
from workhold.cli.toolkit_options import ToolkitWords
from workhold.cli.values import choice, length_unit, optional_count, printed_unit, whole_number
from workhold.errors import InputError

if TYPE_CHECKING:
    from threading import Event

    from workhold.model.query import Query
    from workhold.model.result import Result
    from workhold.model.support_triples import Supports
    from workhold.units import Unit

__all__ = ["design"]

SEARCH = "The search"
EVERY_TYPE = "both"
ENGINES = ("curves", "algebra")
# Bytes of a fixture in a file of each form, and the largest file that is text.
BYTES, MOST_TEXT = {"json": 960, "csv": 550, "npz": 225}, 7e8


@spread
def design(
    part: PartArgument,
    *,
    held_in: ToolkitWords,
    words: QueryWords,
    seated_by: SeatingWords,
    machined: ProgramWords,
    type_: str = option(
        SEARCH,
        "I|II|both",
        "Of a vise: I: two pegs on each jaw; II: three on the left, one on the right.",
        "--type",
        default="both",
    ),
    best: str | None = option(SEARCH, "K", "Keep only the best K."),
    every: bool = flag(
        SEARCH,
        "List all fixtures, however many: of more than 200,000 only the best 1,000 are listed else.",
        "--all",
    ),
    listing: str | None = option(
        SEARCH,
        "best|all",
        "Of two clamps: best: for each seat of the locators its best pair of clamps, and how many there "
        "are; all: every pair. best if not given.",
    ),
    threads: str | None = option(SEARCH, "N", "Threads to use; all processors if not given."),
    engine: str = option(
        SEARCH,
        "curves|algebra",
        "curves: the fast search. algebra: the paper's own polynomials, slower; both list the same fixtures.",
        default="curves",
    ),
    out: str | None = option(OUTPUT, "FILE", "Write all fixtures to this file; - is the terminal."),
    format_: str | None = FORMAT,
    draw: str | None = option(
        OUTPUT, "DIR", "Draw the best twelve and a sheet of thumbnails into this folder, or the nearest miss."
    ),
    force: bool = FORCE,
    list_: str = option(OUTPUT, "N", "How many to list on the terminal.", "--list", default="5"),
    unfit: bool = flag(OUTPUT, "List also what is no fixture for a workshop, in red.", "--unfit"),
    supports: bool = flag(
        OUTPUT,
        "Also find three supports and a clamp on top for the best twenty, as supports does.",
        "--supports",
    ),
    sheet: str | None = option(
        OUTPUT,
        "FILE",
        "Write the setup sheet of the first choice into this file (.pdf, .svg, .png), with --supports on "
        "its supports.",
    ),
    json_: bool = JSON,
    reading: PartWords,
) -> None:
    """Find every way to hold PART in a vise, or on a plate with a clamp or two.

    In a vise four pegs stand in holes of the two jaws: two on each (type I), or three on the left and one on
    the right (type II). On a plate three locators stand in holes, and a clamp pushes along a row or a column,
    or two do. Lengths are in millimetres, or in the unit of --unit, or carry their own: 0.5in.

    Example: workhold design part.dxf --vise plate-20mm --out part.json
    """
    # Everything cheap is checked before anything is read, and everything is checked before the search.
    shown = length_unit(reading.unit)
    kept = optional_count("--best", best)
    workers = optional_count("--threads", threads)
    engine = choice("--engine", engine, ENGINES)
    if every and kept is not None:
        raise InputError("--all and --best are opposites: leave one of them out.")
    listed = whole_number("--list", list_)
    form = output_form(out, format_)
    refuse_both(json_, out)
    if json_ and supports:
        raise InputError("--supports prints a table: leave --json out, or ask the command supports.")
    folder = None if draw is None else Path(draw)
    stream = sys.stderr if out == STANDARD_OUTPUT else sys.stdout
    given = (part, held_in.vise, words.loads, *machined.files)
    if out is not None and out != STANDARD_OUTPUT:
        refuse_result_file(out, form, given, force)
    if folder is not None:
        refuse_output_folder(folder, picture_names(), given, force)
    refuse_sheet(sheet, (*given, words.not_on_faces_cut_in), out, force)
    toolkit, tolerance = held_in.asked(shown)
    asked = words.asked(shown, machined.program is not None, machined.has_forces) | seated_by.asked(shown)
    asked["tolerance"] = with_fit_of(asked["tolerance"], tolerance)
    type_ = choice("--type", type_, (*toolkit.types, EVERY_TYPE))
    from workhold.files.part.load import refuse_unsure_numbers
    from workhold.geometry.segment import Box
    from workhold.kernels.base.compiling import is_first_run
    from workhold.model.query import Query
    from workhold.model.requirements import far_loads

    first_run, second = is_first_run(), None
    if first_run and engine == "curves":
        from workhold.cli.warming import begin_compiling, compile_kernels

        second = begin_compiling()
    loaded = machined.reading(part, reading).load(part, toolkit.heights, toolkit.peg_diameter)
    refuse_unsure_numbers(loaded, asked["restrictions"].avoid, CALLED)
    workpiece = loaded.workpiece
    asked |= machined.asked(shown, reading.peg_height, workpiece)
    asked["restrictions"] = without_faces_cut(asked["restrictions"], workpiece, words.not_on_faces_cut_in)
    thickness = machined.thickness if supports or machined.program is None else None
    high = asked_thickness(supports, thickness, workpiece, shown)
    query = Query(
        workpiece, toolkit, None if type_ == EVERY_TYPE else type_, best=kept, listing=listing, **asked
    )
    for remark in far_loads(query.loads, Box(*workpiece.bounds)):
        print_remark(remark)
    printed = printed_unit(reading.unit, toolkit)
    start = perf_counter()
    # What was found is decided for a moment more (``proof.deciding``); the rest of it is left.
    with ask_to_stop("what was found is kept as far as it is soon proven") as cancel:
        if first_run and engine == "curves":
            compile_kernels(cancel, second)
        if query.seating is not None and query.toolkit.closes_at_once:
            from workhold.cli.warming import compile_seating

            compile_seating(cancel)
        streamed, estimated = out if form == "npz" and engine == "curves" else None, None
        with search_progress() as progress:
            if engine == "curves":
                progress(0.0, 0)
                query, estimated = as_many_as_asked(query, every, out, form, workers, cancel)
            result = answered(query, engine, streamed, threads=workers, progress=progress, cancel=cancel)
    if out is not None and streamed is None:
        result = write_found(result, out, form)
    if json_:
        from workhold.listing.identity import entries
        from workhold.presenting.data import result_data

        further = further_data(result, engine, workers, folder, printed) | {"estimated": estimated}
        if sheet is not None:
            written = first_sheet(result, sheet, out, high, printed, words.not_on_faces_cut_in)
            further["sheet"] = sheet if written else None
        print_json(**result_data(result, entries(result, unfit), max(listed, 0)), result_file=out, **further)
        if not result.complete:
            raise typer.Exit(INTERRUPTED)
        return
    compiled = ", compiling on this first run included" if first_run else ""
    spent = f"{perf_counter() - start:.1f} s{compiled}"
    report(result, spent, out, form, listed, printed, unfit, stream)
    supported: tuple[Supports, ...] = ()
    if high is not None:
        supported = report_supported(result, high, printed, stream)
    if not result.complete:
        raise typer.Exit(INTERRUPTED)
    if not any(result.found.values()) and engine == "curves":
        from workhold.cli.tables import other_heights

        explain_none(result, workers, folder, printed, stream)
        print_tables(*other_heights(workpiece, loaded.heights, printed), stream=stream)
    elif folder is not None:
        drawn = draw_best(result, folder, printed)
        pictures = f"Drawn: {plural(len(drawn), 'picture')} in {folder}." if drawn else "Nothing to draw."
        print_tables(pictures, stream=stream)
    if sheet is not None:
        ranked = first_sheet(result, sheet, out, high, printed, words.not_on_faces_cut_in, supported)
        if ranked is None:
            print_tables(f"As there is no fixture, {sheet} was not written.", stream=stream)
        else:
            print_tables(f"The setup sheet of fixture {ranked} was written to {sheet}.", stream=stream)


def as_many_as_asked(
    query: Query, every: bool, out: str | None, form: str, threads: int | None, cancel: Event
) -> tuple[Query, int | None]:
    """Returns the query, or one for the best fixtures where there are very many, and about how many.

    A remark says so before the search. Refuses all of very many without a file that can carry them.
    """
    from workhold.limits import thread_count
    from workhold.model.notes import round_to_two_digits
    from workhold.search.estimate import LISTED, MANY, best_where_many

    asked, count = best_where_many(query, thread_count(threads), cancel)
    if count is None or count <= MANY:
        return query, count
    name = "" if out in (None, STANDARD_OUTPUT) else f" in {out}"
    about = f"{round_to_two_digits(count):,}"
    size = f"{max(count * BYTES[form] / 1e6, 1.0):,.0f} MB{name}"
    if not every:
        print_remark(
            f"there are about {about} fixtures, {size}: these are the best {LISTED:,}; --all lists all."
        )
        return asked, count
    if form != "npz" and (not name or count * BYTES[form] > MOST_TEXT):
        columns = f"{count * BYTES['npz'] / 1e6:,.0f} MB"
        raise InputError(
            f"--all of about {about} fixtures takes {size}: write them to a file whose name ends in .npz, "
            f"which takes {columns} and is written as they are found, such as --out all.npz."
        )
    print_remark(f"there are about {about} fixtures, {size}.")
    return query, count


def answered(query: Query, engine: str, streamed: str | None, threads: int | None, **watching: Any) -> Result:
    """Returns the answer of an engine; where ``streamed`` names a file it is written during the search."""
    if engine == "algebra":
        from workhold.algebra.engine import answer_by_algebra
        from workhold.search.seated import seated_answer

        return seated_answer(query, answer_by_algebra, **watching)
    if streamed is not None:
        from workhold.files.result.columns import answer_to_file

        return answer_to_file(query, streamed, overwrite=True, threads=threads, **watching)
    from workhold.search.design import answer

    return answer(query, threads=threads, **watching)


def report(
    result: Result,
    spent: str,
    out: str | None,
    form: str,
    listed: int,
    unit: Unit,
    unfit: bool,
    stream: TextIO,
) -> None:
    """Reports a result on a stream: stderr where stdout carries the file."""
    from workhold.cli.tables import (
        counts_sentence,
        first_sentence,
        proof_sentences,
        result_table,
        unfit_sentence,
    )
    from workhold.listing.identity import entries

    for note in result.notes:
        print_remark(note.words)
    shown = entries(result, unfit)
    if len(result) and listed > 0:
        print_tables(result_table(result, shown, listed, unit), stream=stream)
        if reason := first_sentence(result, unit):
            print_tables(reason, stream=stream)
    sentence = counts_sentence(result)
    if not sum(result.found.values()):
        found = "exists" if result.complete else "was found before the interruption"
        sentence = (
            f"No fixture {found} for {result.workpiece.name} {result.toolkit.wording.inside}: the count is 0"
        )
    written = out is not None and out != STANDARD_OUTPUT
    proof = proof_sentences(result, out if written and form != "csv" else None)
    left_out = [unfit_sentence(shown.unfit)] if shown.unfit else []
    print_tables(f"{sentence}; {spent}.", *left_out, *proof, stream=stream)
    if written:
        print_tables(f"Written to {out}.", stream=stream)
    if not result.complete:
        marked = f", and {out} is marked so" if written else ""
        print_remark(f"interrupted: this is a part of the fixtures only{marked}.")


def further_data(
    result: Result, engine: str, threads: int | None, folder: Path | None, unit: Unit
) -> dict[str, Any]:
    """Returns why there is no fixture, and the pictures drawn, as plain data.

    A search that was interrupted has neither.
    """
    explained, written = None, []
    if result.complete and not any(result.found.values()) and engine == "curves":
        from workhold.presenting.data import explanation_data
        from workhold.search.explaining import explain

        why = explain(result.query, threads, unit)
        explained = explanation_data(why, result.toolkit)
        if folder is not None and why.nearest is not None:
            written = draw_one(why.nearest.fixture, result, folder, NEAREST_MISS, "Nearest miss", unit)
    elif result.complete and folder is not None:
        written = draw_best(result, folder, unit)
    return {"explanation": explained, "pictures": [str(path) for path in written]}
