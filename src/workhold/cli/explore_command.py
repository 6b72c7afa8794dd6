"""``workhold explore``: the same part in many vises."""

from __future__ import annotations

import csv
import io
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from attrs import frozen

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
from workhold.cli.outputs import ForceOption, refuse_output
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
from workhold.cli.values import choice, length, length_unit, whole_number
from workhold.cli.vise_options import ToolkitOption
from workhold.errors import InputError
from workhold.model.units import Unit

if TYPE_CHECKING:
    from workhold.model.query import Query
    from workhold.model.restrictions import Restrictions
    from workhold.model.tolerance import Tolerance
    from workhold.model.workpiece import Workpiece
    from workhold.search.exploring import Explored

__all__ = ["explore"]

SWEEP = "Vises to try"
TYPES = ("I", "II")
# More vises than this are more likely a slip than a wish.
MOST_VISES = 1000


def explore(
    part: PartArgument,
    vise: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAMES|FILES",
            help="Vises by name or from TOML files, such as plate-20mm,plate-25mm; all presets if neither this nor --pitch "
            "is given.",
            rich_help_panel=SWEEP,
        ),
    ] = None,
    toolkit: ToolkitOption = None,
    pitch: Annotated[
        str | None, typer.Option(metavar="LIST", help="Pitches, such as 8,10,12.5 or 10x12.5.", rich_help_panel=SWEEP)
    ] = None,
    columns: Annotated[
        str | None, typer.Option(metavar="LIST", help="Numbers of columns, such as 1,2,4.", rich_help_panel=SWEEP)
    ] = None,
    peg_radius: Annotated[
        str | None, typer.Option(metavar="LIST", help="Peg radii, such as 2.5,3.", rich_help_panel=SWEEP)
    ] = None,
    avoid: AvoidOption = None,
    keep_out: KeepOutOption = None,
    angle: AngleOption = None,
    contact_margin: ContactMarginOption = "0",
    load: LoadOption = None,
    loads: LoadsOption = None,
    rank_by: RankByOption = None,
    tolerance: ToleranceOption = None,
    out: Annotated[
        str | None, typer.Option(metavar="FILE", help="Write the table to this file, as comma-separated values.")
    ] = None,
    force: ForceOption = False,
    unit: UnitOption = None,
    layer: LayerOption = None,
    part_number: PartNumberOption = None,
    drawing_unit: DrawingUnitOption = None,
    axis: AxisOption = None,
    section: SectionOption = None,
    join_tolerance: JoinToleranceOption = JOIN_TOLERANCE,
) -> None:
    """Try PART in many vises: how many fixtures there are in each, and the best of each figure of quality.

    The lists of pitches, columns and radii are combined with each other, and with each vise that is named.

    Example: workhold explore part.dxf --pitch 8,10,12.5 --columns 1,2 --peg-radius 3
    """
    from workhold.files.atomic import text_file
    from workhold.model.kinds import KINDS

    shown = length_unit(unit)
    kind = None if toolkit is None else choice("--toolkit", toolkit, tuple(KINDS))
    vises = asked_vises(vise, kind, pitch, columns, peg_radius, shown)
    asked = QueryWords(avoid, keep_out, angle, contact_margin, load, loads, rank_by, tolerance).asked(shown)
    if out is not None:
        refuse_output(out, (part, loads, *(name for names in vise or () for name in names.split(","))), force)
    from workhold.kernels.base.compiling import is_first_run

    workpiece = load_part(part, unit, layer, part_number, join_tolerance, drawing_unit, axis, section).workpiece
    refuse_unknown_faces(workpiece, asked["restrictions"])
    queries = [(one.name, query_of(workpiece, one, asked)) for one in vises]
    first_run = is_first_run()
    from workhold.search.exploring import explore as try_all

    found: list[Explored] = []
    with ask_to_stop() as cancel, search_progress(first_run) as progress:
        if first_run:
            from workhold.cli.warming import compile_kernels

            compile_kernels(cancel)
        for item in try_all(queries, cancel):
            found.append(item)
            progress(len(found) / len(vises), sum(one.fixtures for one in found))
    print_explored(found, asked["ranking"], shown)
    if out is not None:
        with text_file(Path(out)) as stream:
            stream.write(table_text(found))
        from workhold.cli.tables import print_tables

        print_tables(f"Written to {out}.")
    if len(found) < len(vises):
        tell(f"interrupted: {len(vises) - len(found)} vises were not tried.")
        raise typer.Exit(INTERRUPTED)


@frozen
class Named:
    """A vise to try: what it is called, its kind and keyword arguments, and its tolerance where it has one."""

    name: str
    kind: str
    fields: dict[str, Any]
    tolerance: Tolerance | None = None

    def changed(self, changes: list[tuple[str, dict[str, Any]]]) -> Named:
        """The vise after changes, each of which has a name."""
        name = ", ".join(filter(None, (self.name, *(words for words, _ in changes))))
        fields = {key: value for _, change in changes for key, value in change.items()}
        return Named(name, self.kind, self.fields | fields, self.tolerance)


def query_of(workpiece: Workpiece, named: Named, asked: dict[str, Any]) -> Query | InputError:
    """The query for a vise, or why there is no such vise."""
    from workhold.model.kinds import toolkit_of
    from workhold.model.query import Query

    try:
        return Query(
            workpiece,
            toolkit_of(named.kind, named.fields),
            **asked | {"tolerance": asked["tolerance"] or named.tolerance},
        )
    except InputError as error:
        return error


def asked_vises(
    names: list[str] | None,
    kind: str | None,
    pitch: str | None,
    columns: str | None,
    peg_radius: str | None,
    unit: Unit,
) -> list[Named]:
    """The vises to try.

    Raises
    ------
    InputError
        For words that mean nothing, lists that do not make a vise, and more than a thousand vises.
    """
    from workhold.files.toolkit.presets import load_vise, preset_names
    from workhold.model.kinds import USUAL

    lists: list[list[tuple[str, dict[str, Any]]]] = []
    if pitch is not None:
        lists.append([(f"pitch {word}", {"pitch": pitch_of(word, unit)}) for word in words_of("--pitch", pitch)])
    if columns is not None:
        numbers = [whole_number("--columns", word) for word in words_of("--columns", columns)]
        lists.append([(f"{number} column{'s' if number != 1 else ''}", {"columns": number}) for number in numbers])
    if peg_radius is not None:
        radii = [(word, length("--peg-radius", word, unit)) for word in words_of("--peg-radius", peg_radius)]
        lists.append([(f"radius {word}", {"peg_radius": radius}) for word, radius in radii])
    if names is None and pitch is not None:
        if columns is None or peg_radius is None:
            raise InputError("a list of pitches alone makes no vise: give --columns and --peg-radius too, or --vise.")
        bases = [Named("", kind or USUAL, {})]
    else:
        asked = preset_names() if names is None else [name for words in names for name in words_of("--vise", words)]
        bases = [
            Named(loaded.name, kind or loaded.kind, loaded.fields, loaded.tolerance) for loaded in map(load_vise, asked)
        ]
    vises = [base.changed(list(changes)) for base in bases for changes in product(*lists)]
    if len(vises) > MOST_VISES:
        raise InputError(f"the lists combine to {len(vises)} vises: give lists that combine to {MOST_VISES} or fewer.")
    return vises


def words_of(option: str, text: str) -> list[str]:
    """The entries of a list.

    Raises
    ------
    InputError
        When one is missing.
    """
    words = [word.strip() for word in text.split(",")]
    if not all(words):
        raise InputError(f"{option} {text!r} has an empty entry: give a list such as 1,2,4.")
    return words


def pitch_of(word: str, unit: Unit) -> tuple[float, float]:
    """A pitch for both directions, or ``XxY``."""
    x, cross, y = word.partition("x")
    return length("--pitch", x, unit), length("--pitch", y if cross else x, unit)


def refuse_unknown_faces(workpiece: Workpiece, restrictions: Restrictions) -> None:
    """Refuse faces that do not exist, for which no vise is to blame.

    Raises
    ------
    InputError
        Naming the face.
    """
    from workhold.contact.features import face_of_segment

    for number in restrictions.avoid:
        face_of_segment(workpiece, number)


def print_explored(found: list[Explored], ranking: tuple[str, ...], unit: Unit) -> None:
    """Write the table and say which vise is best."""
    from workhold.cli.tables import Table, figure_text, heading, print_tables
    from workhold.model.quality import FIGURES
    from workhold.search.exploring import best_of

    figures = [figure for figure in FIGURES if any(figure.key in item.best for item in found)]
    table = Table(
        (
            "vise",
            ">fixtures",
            *(f">type {name}" for name in TYPES),
            *(f">best {heading(figure, unit)}" for figure in figures),
        )
    )
    for item in found:
        counts = (f"{count:,}" for count in (item.fixtures, *(item.found.get(name, 0) for name in TYPES)))
        values = (figure_text(f, item.best[f.key], unit) if f.key in item.best else "-" for f in figures)
        table.add_row(item.name, *counts, *values)
    print_tables(table)
    for item in found:
        if item.reason:
            print_tables(f"{item.name}: {item.reason}")
    best = best_of(found, ranking[0])
    if best is not None:
        print_tables(f"Best by {ranking[0].replace('_', ' ')}: {best.name}.")


def table_text(found: list[Explored]) -> str:
    """The table as comma-separated values; lengths in mm, forces in N."""
    from workhold.model.quality import FIGURES

    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(
        ["vise", "fixtures", "type_one", "type_two", *(f"best_{figure.key}" for figure in FIGURES), "reason"]
    )
    for item in found:
        values = [f"{item.best[f.key]:.12g}" if f.key in item.best else "" for f in FIGURES]
        counts = [item.found.get(name, 0) for name in TYPES]
        writer.writerow([item.name, item.fixtures, *counts, *values, item.reason])
    return stream.getvalue()
