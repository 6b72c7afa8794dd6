"""``workhold explore``: the same part in many vises and plates."""

from __future__ import annotations

import csv
import io
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer
from attrs import frozen

from workhold.cli.commands import option, spread
from workhold.cli.ending import INTERRUPTED, ask_to_stop
from workhold.cli.options import PartArgument, PartWords
from workhold.cli.outputs import ForceOption, refuse_output
from workhold.cli.progress import search_progress
from workhold.cli.saying import tell
from workhold.cli.search_options import QueryWords, with_fit_of
from workhold.cli.values import length, length_unit, whole_number
from workhold.cli.vise_options import TOOLKIT
from workhold.errors import InputError
from workhold.model.units import Unit

if TYPE_CHECKING:
    from workhold.model.query import Query
    from workhold.model.restrictions import Restrictions
    from workhold.model.tolerance import Tolerance
    from workhold.model.workpiece import Workpiece
    from workhold.search.exploring import Explored

__all__ = ["explore"]

SWEEP = "Vises and plates to try"
# More vises than this are more likely a slip than a wish.
MOST_VISES = 1000


@spread
def explore(
    part: PartArgument,
    *,
    vise: list[str] | None = option(
        SWEEP,
        "NAMES|FILES",
        "Vises and plates by name or from TOML files, such as plate-20mm,clamp-plate-20mm; all presets if neither this nor "
        "--pitch is given.",
    ),
    toolkit: str | None = TOOLKIT,
    pitch: str | None = option(SWEEP, "LIST", "Pitches, such as 8,10,12.5 or 10x12.5."),
    columns: str | None = option(SWEEP, "LIST", "Numbers of columns, such as 1,2,4."),
    peg_radius: str | None = option(SWEEP, "LIST", "Peg radii, such as 2.5,3."),
    words: QueryWords,
    out: str | None = option(None, "FILE", "Write the table to this file, as comma-separated values."),
    force: ForceOption = False,
    reading: PartWords,
) -> None:
    """Try PART in many vises and plates: how many fixtures there are in each, and the first choice in each with its figures.

    The lists of pitches, columns and radii are combined with each other, and with each vise that is named.

    Example: workhold explore part.dxf --pitch 8,10,12.5 --columns 1,2 --peg-radius 3
    """
    from workhold.files.atomic import text_file

    shown = length_unit(reading.unit)
    vises = asked_vises(vise, toolkit, pitch, columns, peg_radius, shown)
    asked = words.asked(shown)
    if out is not None:
        refuse_output(out, (part, words.loads, *(name for names in vise or () for name in names.split(","))), force)
    from workhold.kernels.base.compiling import is_first_run

    workpiece = reading.load(part).workpiece
    refuse_unknown_faces(workpiece, asked["restrictions"])
    queries = [(one.name, query_of(workpiece, one, asked)) for one in vises]
    from workhold.search.exploring import explore as try_all

    found: list[Explored] = []
    with ask_to_stop("what was tried so far is kept") as cancel:
        if is_first_run():
            from workhold.cli.warming import compile_kernels

            compile_kernels(cancel)
        with search_progress() as progress:
            for item in try_all(queries, cancel):
                found.append(item)
                progress(len(found) / len(vises), sum(one.fixtures for one in found))
    types = list(dict.fromkeys(name for one in found for name in one.found))
    # Toolkits with one clamp and with two have a default ranking each; the first that can be asked tells the columns.
    ranking = next((query.ranking for _, query in queries if not isinstance(query, InputError)), ())
    print_explored(found, types, ranking, shown)
    if out is not None:
        with text_file(Path(out)) as stream:
            stream.write(table_text(found, types))
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
            **asked | {"tolerance": with_fit_of(asked["tolerance"], named.tolerance)},
        )
    except InputError as error:
        return error


def asked_vises(
    names: list[str] | None,
    toolkit: str | None,
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
    from workhold.model.fence import Fence
    from workhold.model.kinds import ALIASES, KINDS, USUAL, kind_of
    from workhold.model.plate import Plate

    is_kind = toolkit is not None and toolkit.lower() in (*KINDS, *ALIASES)
    kind, said = kind_of(toolkit.lower()) if toolkit is not None and is_kind else (None, {})
    if toolkit is not None and not is_kind:
        names = [*(names or ()), toolkit]
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
        if peg_radius is None or (
            columns is None and not issubclass(KINDS[kind or USUAL], Plate) and "columns" not in said
        ):
            raise InputError("a list of pitches alone makes no vise: give --columns and --peg-radius too, or --vise.")
        bases = [Named("", kind or USUAL, dict(said))]
    else:
        asked = preset_names() if names is None else [name for words in names for name in words_of("--vise", words)]
        # A kind picks those of the kind, and makes one sort of vise of another.
        bases = [
            Named(one.name, kind or one.kind, {**one.fields, **said}, one.tolerance)
            for one in map(load_vise, asked)
            if kind is None
            or all(issubclass(KINDS[kind], sort) == issubclass(KINDS[one.kind], sort) for sort in (Plate, Fence))
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


def print_explored(found: list[Explored], types: list[str], ranking: tuple[str, ...], unit: Unit) -> None:
    """Write the table and say which vise is best."""
    from workhold.cli.tables import Table, figure_text, heading, print_tables
    from workhold.files.toolkit.presets import is_sold
    from workhold.model.quality import FIGURES, LOCATION_ERROR
    from workhold.search.exploring import first_choice

    keys = dict.fromkeys([*ranking, FIGURES[LOCATION_ERROR].key])
    figures = [figure for key in keys for figure in FIGURES if figure.key == key]
    table = Table(
        (
            "vise",
            ">fixtures",
            *(f">type {name}" for name in types),
            *(f">{heading(figure, unit)}" for figure in figures),
        )
    )
    for item in found:
        if item.figures and not item.fit:
            table.red.add(len(table.rows))
        counts = (f"{count:,}" for count in (item.fixtures, *(item.found.get(name, 0) for name in types)))
        values = (figure_text(f, item.figures[f.key], unit) if f.key in item.figures else "-" for f in figures)
        table.add_row(item.name, *counts, *values)
    print_tables(table)
    for item in found:
        if item.reason:
            print_tables(f"{item.name}: {item.reason}")
    best = first_choice(found, ranking, is_sold)
    if best is not None:
        told = [figure for figure in figures if figure.key in best.figures]
        words = ", ".join(f"{heading(f, unit)} {figure_text(f, best.figures[f.key], unit)}" for f in told)
        unsold = "" if is_sold(best.name) else " Nobody sells it: it is the gripper of the paper."
        print_tables(f"First choice: {best.name}; its first fixture has {words}.{unsold}")


def table_text(found: list[Explored], types: list[str]) -> str:
    """The table as comma-separated values; lengths in mm, forces in N."""
    from workhold.model.quality import FIGURES

    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    figures = [figure.key for figure in FIGURES]
    writer.writerow(["vise", "fixtures", *(f"type_{name}" for name in types), *figures, "reason"])
    for item in found:
        values = [f"{item.figures[key]:.12g}" if key in item.figures else "" for key in figures]
        counts = [item.found.get(name, 0) for name in types]
        writer.writerow([item.name, item.fixtures, *counts, *values, item.reason])
    return stream.getvalue()
