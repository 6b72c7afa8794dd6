"""``workhold explore``: the same part in many toolkits."""

from __future__ import annotations

import csv
import io
from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import typer
from attrs import frozen

from workhold.cli.commands import make_option, print_remark, spread_option_groups
from workhold.cli.ending import INTERRUPTED, set_event_on_interrupt
from workhold.cli.options import CALLED, PartArgument, PartOptions
from workhold.cli.outputs import FORCE, JSON, print_json, refuse_output
from workhold.cli.program_options import SOLIDS, ProgramOptions
from workhold.cli.progress import show_search_progress
from workhold.cli.search_options import QueryOptions
from workhold.cli.table import Table, print_tables
from workhold.cli.toolkit_options import (
    SWEEP,
    TOOLKIT,
    ToolkitListOptions,
    collect_carrier_heights,
    find_peg_diameter,
    list_toolkits_to_try,
    make_query,
)
from workhold.cli.values import read_unit
from workhold.errors import InputError
from workhold.units import Unit

if TYPE_CHECKING:
    from workhold.files.part.loaded import LoadedPart
    from workhold.model.query import Query
    from workhold.search.design import ToolkitOutcome

__all__ = ["explore"]


VISES = make_option(
    SWEEP,
    "NAMES|FILES",
    "Vises and plates by name or from TOML files, such as plate-20mm,clamp-plate-20mm; all presets if "
    "neither this nor --pitch is given.",
)


@frozen
class TableOptions:
    """The options that choose where the table goes, as typed."""

    out: str | None = make_option(None, "FILE", "Write the table to this file, as comma-separated values.")
    force: bool = FORCE
    json_: bool = JSON


@frozen
class ExploreTask:
    """A part to be tried in many toolkits.

    Parameters
    ----------
    loaded : the part as it was read, one reading for each peg height.
    queries : by name of the toolkit, its query, or the error that says why the toolkit cannot be made.
    unit : of lengths shown.
    """

    loaded: Sequence[LoadedPart]
    queries: Sequence[tuple[str, Query | InputError]]
    written: TableOptions
    unit: Unit

    @property
    def ranking(self) -> tuple[str, ...]:
        """Keys of the figures in the table: those that the first usable toolkit ranks by; () where none is
        usable.
        """
        return next((query.rank_by for _, query in self.queries if not isinstance(query, InputError)), ())


@spread_option_groups
def explore(
    part: PartArgument,
    *,
    vise: list[str] | None = VISES,
    toolkit: str | None = TOOLKIT,
    varied: ToolkitListOptions,
    words: QueryOptions,
    machined: ProgramOptions,
    written: TableOptions,
    reading: PartOptions,
) -> None:
    """Try PART in many toolkits: how many fixtures each has, and the figures of its first choice.

    The command combines the lists of figures with each other, and with each toolkit that you name. If you
    name none, it tries all presets that have such figures.

    Example: workhold explore part.dxf --pitch 8,10,12.5 --columns 1,2 --peg-radius 3
    """
    asked = parse(part, vise, toolkit, varied, words, machined, written, reading)
    report(asked, explore_each_toolkit(asked))


def parse(
    part: str,
    vise: list[str] | None,
    toolkit: str | None,
    varied: ToolkitListOptions,
    words: QueryOptions,
    machined: ProgramOptions,
    written: TableOptions,
    reading: PartOptions,
) -> ExploreTask:
    """Return what was typed as a task, with the part read and a query made for each toolkit."""
    shown = read_unit(reading.unit)
    toolkits = list_toolkits_to_try(vise, toolkit, varied, shown)
    asked = words.read_arguments(shown, machined.program is not None, machined.has_forces)
    if written.out is not None:
        named = (name for names in vise or () for name in names.split(","))
        refuse_output(written.out, (part, words.loads, *machined.files, *named), written.force)
    # Pegs of each diameter reach as high as they must beside a solid, and the outline is what those meet.
    is_solid = reading.peg_height is None and Path(part).suffix.lower() in SOLIDS
    diameters = [find_peg_diameter(one) if is_solid else None for one in toolkits]
    loaded = read_part_by_diameter(
        diameters, part, collect_carrier_heights(toolkits), machined.adapt_part_options(part, reading)
    )
    refuse_unknown_faces(asked["restrictions"].avoid, loaded.values())
    further = {
        one: machined.read_query_arguments(shown, reading.peg_height, each.workpiece)
        for one, each in loaded.items()
    }
    queries = [
        (one.name, make_query(loaded[diameter].workpiece, one, asked | further[diameter]))
        for one, diameter in zip(toolkits, diameters, strict=True)
    ]
    return ExploreTask(list(loaded.values()), queries, written, shown)


def read_part_by_diameter(
    diameters: Iterable[float | None], part: str, heights: Mapping[str, Sequence[float]], reading: PartOptions
) -> dict[float | None, LoadedPart]:
    """Read the part once for each diameter of pegs in mm, and return the parts by diameter.

    None stands for the diameter that was given. Each remark is printed once.
    """
    loaded: dict[float | None, LoadedPart] = {}
    for one in dict.fromkeys(diameters):
        said = {remark for each in loaded.values() for remark in each.remarks}
        loaded[one] = reading.load(part, heights, one, said)
    return loaded


def refuse_unknown_faces(numbers: Sequence[int], loaded: Collection[LoadedPart]) -> None:
    """Raise InputError for a face number that does not exist, or is not certain, in any reading of the part."""
    from workhold.contact.features import find_face_of_segment
    from workhold.files.part.load import refuse_unsure_numbers

    for each in loaded:
        refuse_unsure_numbers(each, numbers, CALLED)
    for number in numbers:
        for each in loaded:
            find_face_of_segment(each.workpiece, number)


def explore_each_toolkit(asked: ExploreTask) -> list[ToolkitOutcome]:
    """Return the outcome of each toolkit in order, or of those tried before a Ctrl-C."""
    from workhold.cli.warming import compile_kernels
    from workhold.search.design import explore as try_all

    found: list[ToolkitOutcome] = []
    with set_event_on_interrupt("the results so far are kept") as cancel:
        compile_kernels(cancel)
        with show_search_progress() as progress:
            for item in try_all(asked.queries, cancel):
                found.append(item)
                progress(len(found) / len(asked.queries), sum(one.fixtures for one in found))
    return found


def report(asked: ExploreTask, found: list[ToolkitOutcome]) -> None:
    """Print the table and the first choice, and write the file.

    Exits with INTERRUPTED where some toolkits were not tried.
    """
    from workhold.files.atomic import write_text_file
    from workhold.files.toolkit_file import is_sold
    from workhold.search.design import choose_first_toolkit

    out, types = asked.written.out, list(dict.fromkeys(name for one in found for name in one.found))
    first = choose_first_toolkit(found, asked.ranking, is_sold)
    if not asked.written.json_:
        print_explored(asked, found, types, first)
    if out is not None:
        with write_text_file(Path(out)) as stream:
            stream.write(format_csv_table(found, types))
    if asked.written.json_:
        from workhold.presenting.data import describe_explored

        choice = {"ranking": list(asked.ranking), "first_choice": None if first is None else first.name}
        print_json(toolkits=describe_explored(found), **choice, written=[] if out is None else [out])
    elif out is not None:
        print_tables(f"Written to {out}.")
    if len(found) < len(asked.queries):
        print_remark(f"interrupted: {len(asked.queries) - len(found)} toolkits were not tried.")
        raise typer.Exit(INTERRUPTED)


# Figures that a narrow terminal shows as well.
FIGURES_KEPT = 3


def list_known_figures(item: ToolkitOutcome, query: tuple[str, Query | InputError]) -> dict[str, float]:
    """Return the figures of a toolkit's first fixture by key; {} where it has none.

    An edge distance is inf where the part has no edge.
    """
    from workhold.presenting.figure_words import find_edgeless_distance, mark_edgeless

    asked = query[1]
    if isinstance(asked, InputError):
        return {}
    return mark_edgeless(item.figures, find_edgeless_distance(asked.workpiece, asked.toolkit))


def print_explored(
    asked: ExploreTask, found: list[ToolkitOutcome], types: list[str], best: ToolkitOutcome | None
) -> None:
    """Print the table, the reasons of toolkits without fixtures, and which toolkit is the first choice."""
    from workhold.cli.tables import explain_sliding_part
    from workhold.files.toolkit_file import is_sold
    from workhold.model.jaw_hold import HOLD_FIGURES
    from workhold.model.quality import FIGURES, LOCATION_ERROR, PROGRAM_FIGURE
    from workhold.presenting.figure_words import format_figure, format_figure_number, make_heading

    unit, ranking = asked.unit, asked.ranking
    known = [list_known_figures(*each) for each in zip(found, asked.queries, strict=False)]
    keys = dict.fromkeys([FIGURES[LOCATION_ERROR].key, *ranking])
    figures = [
        figure for key in keys for figure in (*FIGURES, PROGRAM_FIGURE, *HOLD_FIGURES) if figure.key == key
    ]
    # What is known of all, then what there may be no room for: later figures, and of which types the fixtures
    # are.
    headings = [
        *(f">{make_heading(figure, unit)}" for figure in figures),
        *(f">type {name}" for name in types),
    ]
    table = Table(("toolkit", ">fixtures", *headings), spare=max(len(headings) - FIGURES_KEPT, 0))
    for item, own in zip(found, known, strict=True):
        if own and not item.fit:
            table.red.add(len(table.rows))
        counts = ("-" if item.about is not None else f"{item.found.get(name, 0):,}" for name in types)
        values = (format_figure_number(f, own[f.key], unit) if f.key in own else "-" for f in figures)
        about = "" if item.about is None else "~"
        table.add_row(item.name, f"{about}{item.fixtures:,}", *values, *counts)
    print_tables(table)
    if any(item.about is not None for item in found):
        print_tables(
            "~ marks an estimate: where a toolkit has many fixtures, only its first choice is searched for."
        )
    for item in found:
        if item.reason:
            print_tables(f"{item.name}: {item.reason}")
    if best is not None:
        own = known[found.index(best)]
        shown = [f for f in (*figures[1:], figures[0]) if f.key in own]
        shown = shown or [f for f in HOLD_FIGURES if f.key in own]
        words = ", ".join(f"{f.words} {format_figure(f, own[f.key], unit)}" for f in shown)
        unsold = "" if is_sold(best.name) else " It is the paper's gripper, and no shop sells it."
        over = f"It holds the part over {best.held:.0%} of its length."
        print_tables(f"First choice: {best.name}; its first fixture has {words}. {over}{unsold}")
        return
    sliding = [explain_sliding_part(one.workpiece, one.heights) for one in asked.loaded]
    if all(sliding):
        print_tables(*sliding[0])


def format_csv_table(found: list[ToolkitOutcome], types: list[str]) -> str:
    """Return the table as comma-separated values; lengths in mm, forces in N."""
    from workhold.model.quality import FIGURES

    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    figures = [figure.key for figure in FIGURES]
    writer.writerow(
        ["toolkit", "fixtures", "estimated", *(f"type_{name}" for name in types), *figures, "reason"]
    )
    for item in found:
        values = [f"{item.figures[key]:.12g}" if key in item.figures else "" for key in figures]
        is_estimated = item.about is not None
        counts = ["" if is_estimated else item.found.get(name, 0) for name in types]
        writer.writerow(
            [item.name, item.fixtures, "yes" if is_estimated else "", *counts, *values, item.reason]
        )
    return stream.getvalue()
