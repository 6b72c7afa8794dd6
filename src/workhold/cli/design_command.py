"""``workhold design``: every fixture of a part in a vise or on a plate."""

from __future__ import annotations

import sys
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any, TextIO

import typer
from attrs import frozen

from workhold.asking.declaring import list_declarations
from workhold.asking.search import SEARCH, SearchQuestion
from workhold.cli.commands import make_flag, make_option, print_remark, spread_option_groups
from workhold.cli.declared import make_flag_attribute, make_option_attributes, make_word_attribute, read_words
from workhold.cli.design_report import (
    NEAREST_MISS,
    draw_best,
    explain_none,
    list_picture_names,
    write_fixture_pictures,
)
from workhold.cli.ending import INTERRUPTED, set_event_on_interrupt
from workhold.cli.options import CALLED, PartArgument, PartOptions
from workhold.cli.outputs import (
    FORCE,
    FORMAT,
    JSON,
    OUTPUT,
    STANDARD_OUTPUT,
    choose_output_form,
    print_json,
    refuse_both,
    refuse_output_folder,
    refuse_result_file,
    write_found,
)
from workhold.cli.program_options import ProgramOptions
from workhold.cli.progress import show_search_progress
from workhold.cli.search_options import QueryOptions, SeatingOptions, add_dowel_fit, avoid_faces_cut_before
from workhold.cli.setup_sheets import refuse_sheet, write_first_sheet
from workhold.cli.supports_command import read_asked_thickness, report_supported
from workhold.cli.table import format_count, print_tables
from workhold.cli.toolkit_options import ToolkitOptions
from workhold.cli.values import (
    choose_printed_unit,
    read_choice,
    read_optional_count,
    read_unit,
    read_whole_number,
)
from workhold.errors import InputError

if TYPE_CHECKING:
    from threading import Event

    from workhold.files.part.loaded import LoadedPart
    from workhold.model.query import Query
    from workhold.model.result import Result
    from workhold.model.support_triples import Supports
    from workhold.units import Unit

__all__ = ["design"]

EVERY_TYPE = "both"
ENGINES = ("curves", "algebra")
# Bytes of a fixture in a file of each form, and the largest file that is text.
BYTES, MOST_TEXT = {"json": 960, "csv": 550, "npz": 225}, 7e8
OF_ONE = list_declarations(SearchQuestion, [SEARCH])
TYPE = make_option(
    SEARCH,
    "I|II|both",
    "For a vise: I is two pegs on each jaw; II is three on the left jaw and one on the right.",
    "--type",
    default="both",
)
ALL = make_flag(
    SEARCH,
    "List all fixtures, however many there are; otherwise, of more than 200,000 only the "
    "best 1,000 are listed.",
    "--all",
)
ENGINE = make_option(
    SEARCH,
    "curves|algebra",
    "curves: the fast search. algebra: the paper's own polynomials, slower; both list the same fixtures.",
    default="curves",
)


@frozen(
    these=make_option_attributes(
        OF_ONE,
        best={"type_": make_word_attribute(TYPE)},
        listing={"every": make_flag_attribute(ALL)},
        threads=make_word_attribute(make_option(SEARCH, "N", "Threads to use; all processors if not given.")),
        engine=make_word_attribute(ENGINE),
    )
)
class SearchOptions:
    """The options of one search, as typed."""

    if TYPE_CHECKING:
        type_: str
        best: str | None
        every: bool
        threads: str | None
        engine: str


@frozen
class OutputOptions:
    """The options that choose where the answer goes, as typed."""

    out: str | None = make_option(OUTPUT, "FILE", "Write all fixtures to this file; - is the terminal.")
    format_: str | None = FORMAT
    draw: str | None = make_option(
        OUTPUT,
        "DIR",
        "Draw the best twelve fixtures and a sheet of thumbnails, or the nearest miss, into this folder.",
    )
    force: bool = FORCE
    list_: str = make_option(
        OUTPUT, "N", "Number of fixtures to list on the terminal.", "--list", default="5"
    )
    unfit: bool = make_flag(OUTPUT, "Also list fixtures that no workshop can use, in red.", "--unfit")
    supports: bool = make_flag(
        OUTPUT,
        "Also find three supports and a clamp on top for the best twenty, as supports does.",
        "--supports",
    )
    sheet: str | None = make_option(
        OUTPUT,
        "FILE",
        "Write the setup sheet of the first choice into this file (.pdf, .svg, .png); with "
        "--supports the sheet has the supports.",
    )
    json_: bool = JSON

    def read_output(self, inputs: tuple[str | None, ...], before: str | None) -> OutputTarget:
        """Return where the answer goes, after all checks that are possible before the search.

        Parameters
        ----------
        inputs : files that are read before the search.
        before : a further file, which is read after the search.

        Raises
        ------
        InputError
            For outputs that cannot be written, and two outputs in one place.
        """
        listed = read_whole_number("--list", self.list_)
        form = choose_output_form(self.out, self.format_)
        refuse_both(self.json_, self.out)
        if self.json_ and self.supports:
            raise InputError("--supports prints a table: leave --json out, or ask the command supports.")
        folder = None if self.draw is None else Path(self.draw)
        if self.out is not None and self.out != STANDARD_OUTPUT:
            refuse_result_file(self.out, form, inputs, self.force)
        if folder is not None:
            refuse_output_folder(folder, list_picture_names(), inputs, self.force)
        refuse_sheet(self.sheet, (*inputs, before), self.out, self.force)
        return OutputTarget(self.out, form, folder, listed, self.unfit, self.sheet, before, self.json_)


@frozen
class OutputTarget:
    """Destinations of a search's answer: file, pictures, sheet and terminal.

    Parameters
    ----------
    out, form : path of the result file and its form; None for no file.
    folder : folder for pictures; None for no pictures.
    listed : number of fixtures that the terminal lists, and whether unfit ones are among them.
    sheet, before : path of the setup sheet of the first choice, and of the result of the previous side, which
        the sheet names.
    as_json : whether one JSON object is printed instead of tables.
    """

    out: str | None
    form: str
    folder: Path | None
    listed: int
    with_unfit: bool
    sheet: str | None
    before: str | None
    as_json: bool

    @property
    def stream(self) -> TextIO:
        """Stream for printed text: stderr where stdout carries the result file, else stdout."""
        return sys.stderr if self.out == STANDARD_OUTPUT else sys.stdout

    @property
    def file(self) -> str | None:
        """Path of the result file; None without one, and where it goes to stdout."""
        return None if self.out == STANDARD_OUTPUT else self.out


# What a part is held with that needs friction, as notes name it.
STRAPPED = "strap-plate-20mm"


@frozen
class DesignTask:
    """A search, and the form of its answer.

    Parameters
    ----------
    loaded : the part as it was read.
    every : whether all fixtures are listed, however many there are.
    thickness : thickness of the part in mm where supports are wanted, else None.
    unit : of lengths shown.
    """

    query: Query
    loaded: LoadedPart
    every: bool
    threads: int | None
    engine: str
    thickness: float | None
    unit: Unit
    output: OutputTarget


@frozen
class DesignAnswer:
    """Result of the search.

    Parameters
    ----------
    estimated : estimate of the number of fixtures, where there are very many; else None.
    spent : time that the search took, in words.
    """

    result: Result
    estimated: int | None
    spent: str


@spread_option_groups
def design(
    part: PartArgument,
    *,
    held_in: ToolkitOptions,
    words: QueryOptions,
    seated_by: SeatingOptions,
    machined: ProgramOptions,
    searched: SearchOptions,
    written: OutputOptions,
    reading: PartOptions,
) -> None:
    """Find every way to hold PART in a vise, or on a plate with a clamp or two.

    In a vise four pegs stand in holes of the two jaws: two on each (type I), or three on the left and one on
    the right (type II). On a plate three locators stand in holes, and a clamp pushes along a row or a column,
    or two clamps do. Lengths are in millimetres or in the unit of --unit; a length may carry its own: 0.5in.

    Example: workhold design part.dxf --vise plate-20mm --out part.json
    """
    asked = parse(part, held_in, words, seated_by, machined, searched, written, reading)
    report(asked, search_and_write(asked))


def parse(
    part: str,
    held_in: ToolkitOptions,
    words: QueryOptions,
    seated_by: SeatingOptions,
    machined: ProgramOptions,
    searched: SearchOptions,
    written: OutputOptions,
    reading: PartOptions,
) -> DesignTask:
    """Return what was typed as a task, with the part read; cheap checks come before any file is read."""
    shown = read_unit(reading.unit)
    threads = read_optional_count("--threads", searched.threads)
    engine = read_choice("--engine", searched.engine, ENGINES)
    if searched.every and searched.best is not None:
        raise InputError("--all and --best are opposites: leave one of them out.")
    asked = read_words(OF_ONE, searched, shown)
    files = part, held_in.vise, words.loads, *machined.files
    output = written.read_output(files, words.not_on_faces_cut_in)
    toolkit, tolerance = held_in.read_toolkit(shown)
    asked |= words.read_arguments(
        shown, machined.program is not None, machined.has_forces
    ) | seated_by.read_arguments(shown)
    asked["tolerance"] = add_dowel_fit(asked["tolerance"], tolerance)
    type_ = read_choice("--type", searched.type_, (*toolkit.types, EVERY_TYPE))
    from workhold.files.part.load import refuse_unsure_numbers
    from workhold.geometry.segment import Box
    from workhold.model.query import Query
    from workhold.model.requirements import describe_far_loads

    # Jaws touch a raw block, wherever they reach on the part inside.
    heights = toolkit.heights if asked["raw"] is None else {}
    loaded = machined.adapt_part_options(part, reading).load(part, heights, toolkit.peg_diameter)
    refuse_unsure_numbers(loaded, asked["restrictions"].avoid, CALLED)
    workpiece = loaded.workpiece
    asked |= machined.read_query_arguments(shown, reading.peg_height, workpiece)
    asked["restrictions"] = avoid_faces_cut_before(
        asked["restrictions"], workpiece, words.not_on_faces_cut_in
    )
    thickness = machined.thickness if written.supports or machined.program is None else None
    high = read_asked_thickness(written.supports, thickness, workpiece, shown)
    query = Query(workpiece, toolkit, None if type_ == EVERY_TYPE else type_, **asked)
    for remark in describe_far_loads(query.loads, Box(*workpiece.bounds)):
        print_remark(remark)
    unit = choose_printed_unit(reading.unit, toolkit)
    return DesignTask(query, loaded, searched.every, threads, engine, high, unit, output)


def search_and_write(asked: DesignTask) -> DesignAnswer:
    """Return the result of the search, after writing the result file.

    A search of very many fixtures writes its file itself while it runs. After a Ctrl-C the result is
    incomplete.
    """
    query, engine, output, estimated = asked.query, asked.engine, asked.output, None
    start, is_first_run = perf_counter(), False
    # What was found is decided for a moment more (``proof.deciding``); the rest of it is left.
    with set_event_on_interrupt(
        "the fixtures found so far are kept, if their proof takes little time"
    ) as cancel:
        if engine == "curves":
            from workhold.cli.warming import compile_kernels

            is_first_run = compile_kernels(cancel)
        if query.seating is not None and query.toolkit.closes_at_once:
            from workhold.cli.warming import compile_seating

            compile_seating(cancel)
        streamed = output.out if output.form == "npz" and engine == "curves" else None
        with show_search_progress() as progress:
            if engine == "curves":
                progress(0.0, 0)
                query, estimated = limit_query_to_best(asked, cancel)
            result = search_and_stream(
                query, engine, streamed, threads=asked.threads, progress=progress, cancel=cancel
            )
    if output.out is not None and streamed is None:
        result = write_found(result, output.out, output.form)
    compiled = ", compiling on this first run included" if is_first_run else ""
    return DesignAnswer(result, estimated, f"{perf_counter() - start:.1f} s{compiled}")


def report(asked: DesignTask, answer: DesignAnswer) -> None:
    """Print the result, and make the pictures and the sheet asked for;
    exit with INTERRUPTED where it is incomplete.
    """
    (report_as_json if asked.output.as_json else report_in_words)(asked, answer)
    if not answer.result.complete:
        raise typer.Exit(INTERRUPTED)


def report_as_json(asked: DesignTask, answer: DesignAnswer) -> None:
    """Print the result as one JSON object, and make the pictures and the sheet asked for."""
    from workhold.listing.identity import make_entries
    from workhold.presenting.data import describe_result

    result, output = answer.result, asked.output
    further = make_further_data(asked, result) | {"estimated": answer.estimated}
    if output.sheet is not None:
        further["sheet"] = None if write_sheet_of_first(asked, result) is None else output.sheet
    listed = describe_result(result, make_entries(result, output.with_unfit), max(output.listed, 0))
    print_json(**listed, result_file=output.out, **further)


def report_in_words(asked: DesignTask, answer: DesignAnswer) -> None:
    """Print the result as tables and sentences, and make the pictures and the sheet asked for."""
    result, output, unit = answer.result, asked.output, asked.unit
    report_found(result, answer.spent, output, unit)
    supported: tuple[Supports, ...] = ()
    if asked.thickness is not None:
        supported = report_supported(result, asked.thickness, unit, output.stream)
    if not result.complete:
        return
    if not any(result.found.values()) and asked.engine == "curves":
        from workhold.cli.tables import suggest_other_heights

        explain_none(result, asked.threads, output.folder, unit, output.stream)
        print_tables(
            *suggest_other_heights(result.workpiece, asked.loaded.heights, unit), stream=output.stream
        )
    elif output.folder is not None:
        drawn = draw_best(result, output.folder, unit)
        pictures = (
            f"Drawn: {format_count(len(drawn), 'picture')} in {output.folder}."
            if drawn
            else "Nothing to draw."
        )
        print_tables(pictures, stream=output.stream)
    if output.sheet is not None:
        rank = write_sheet_of_first(asked, result, supported)
        print_tables(
            f"As there is no fixture, {output.sheet} was not written."
            if rank is None
            else f"The setup sheet of fixture {rank} was written to {output.sheet}.",
            stream=output.stream,
        )


def write_sheet_of_first(
    asked: DesignTask, result: Result, supported: tuple[Supports, ...] = ()
) -> int | None:
    """Write the setup sheet of the first choice;
    return its rank from 1, or None where there is no fixture.
    """
    output = asked.output
    assert output.sheet is not None
    return write_first_sheet(
        result, output.sheet, output.out, asked.thickness, asked.unit, output.before, supported
    )


def limit_query_to_best(asked: DesignTask, cancel: Event) -> tuple[Query, int | None]:
    """Return the query to search, and an estimate of how many fixtures there are (None where not estimated).

    Where there are very many and --all is not given, the query is for the best only, and a remark says so.
    Raises InputError where --all is given with very many fixtures and no file that can hold them.
    """
    from workhold.limits import choose_thread_count
    from workhold.model.notes import round_to_two_digits
    from workhold.search.estimate import LISTED, MANY, ask_for_best_where_many

    output = asked.output
    query, count = ask_for_best_where_many(asked.query, choose_thread_count(asked.threads), cancel)
    if count is None or count <= MANY:
        return asked.query, count
    name = "" if output.file is None else f" in {output.file}"
    about = f"{round_to_two_digits(count):,}"
    size = f"{max(count * BYTES[output.form] / 1e6, 1.0):,.0f} MB{name}"
    if not asked.every:
        print_remark(
            f"there are about {about} fixtures, {size}. Listed are the best {LISTED:,}; --all lists all."
        )
        return query, count
    if output.form != "npz" and (not name or count * BYTES[output.form] > MOST_TEXT):
        columns = f"{count * BYTES['npz'] / 1e6:,.0f} MB"
        raise InputError(
            f"--all of about {about} fixtures takes {size}: write them to a file whose name ends in "
            f".npz, which takes {columns} and is written while they are found, such as --out all.npz."
        )
    print_remark(f"there are about {about} fixtures, {size}.")
    return asked.query, count


def search_and_stream(
    query: Query, engine: str, streamed: str | None, threads: int | None, **watching: Any
) -> Result:
    """Return the result of a search by ``engine``, "curves" or "algebra".

    If ``streamed`` is a path, the result file is written there during the search. ``watching`` are further
    keyword arguments of the search, such as progress and cancel.
    """
    if engine == "algebra":
        from workhold.algebra.engine import find_fixtures_by_algebra
        from workhold.search.seated import answer_with_seating

        return answer_with_seating(query, find_fixtures_by_algebra, **watching)
    if streamed is not None:
        from workhold.files.result.columns import answer_to_file

        return answer_to_file(query, streamed, overwrite=True, threads=threads, **watching)
    from workhold.search.design import answer

    return answer(query, threads=threads, **watching)


def report_found(result: Result, spent: str, output: OutputTarget, unit: Unit) -> None:
    """Print notes, the best fixtures, how many there are, the time spent and the proof."""
    from workhold.cli.tables import (
        count_fixtures_in_words,
        count_unfit_in_words,
        describe_proof_and_undecided,
        explain_first_fixture,
        tabulate_result,
    )
    from workhold.listing.identity import make_entries

    for note in result.notes:
        print_remark(note.words)
    shown = make_entries(result, output.with_unfit)
    if len(result) and output.listed > 0:
        print_tables(tabulate_result(result, shown, output.listed, unit), stream=output.stream)
        if reason := explain_first_fixture(result, unit):
            print_tables(reason, stream=output.stream)
    sentence = count_fixtures_in_words(result)
    if not sum(result.found.values()):
        found = "exists" if result.complete else "was found before the interruption"
        sentence = (
            f"No fixture {found} for {result.workpiece.name} {result.toolkit.wording.inside}: the count is 0"
        )
    out = output.file
    proof = describe_proof_and_undecided(result, out if output.form != "csv" else None)
    left_out = [count_unfit_in_words(shown.unfit, result.toolkit)] if shown.unfit else []
    print_tables(f"{sentence}; {spent}.", *left_out, *proof, stream=output.stream)
    if out is not None:
        print_tables(f"Written to {out}.", stream=output.stream)
    if any(STRAPPED in note.words for note in result.reasons):
        print_remark(f"friction holds it under straps: try workhold design PART --toolkit {STRAPPED}.")
    if not result.complete:
        marked = "" if out is None else f", and {out} is marked so"
        print_remark(f"interrupted: these are only some of the fixtures{marked}.")


def make_further_data(asked: DesignTask, result: Result) -> dict[str, Any]:
    """Return plain data: "explanation" (why there is no fixture, or None) and "pictures" (paths of those
    drawn).

    The pictures are drawn here. For a search that was interrupted the explanation is None and no picture is
    drawn.
    """
    explained, written = None, []
    folder, unit = asked.output.folder, asked.unit
    if result.complete and not any(result.found.values()) and asked.engine == "curves":
        from workhold.presenting.data import describe_explanation
        from workhold.search.explaining import explain

        why = explain(result.query, asked.threads, unit)
        explained = describe_explanation(why, result.toolkit)
        if folder is not None and why.nearest is not None:
            written = write_fixture_pictures(
                why.nearest.fixture, result, folder, NEAREST_MISS, "Nearest miss", unit
            )
    elif result.complete and folder is not None:
        written = draw_best(result, folder, unit)
    return {"explanation": explained, "pictures": [str(path) for path in written]}
