"""``workhold explore``: the same part in many vises."""

from __future__ import annotations

import csv
import io
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

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
    RankByOption,
    RestrictionWords,
    ToleranceOption,
    asked_contact_margin,
    asked_loads,
    asked_ranking,
    asked_tolerance,
)
from workhold.cli.values import length, length_unit, whole_number
from workhold.errors import InputError
from workhold.model.units import Unit

if TYPE_CHECKING:
    from workhold.model.tolerance import Tolerance
    from workhold.search.exploring import Explored

__all__ = ["explore"]

SWEEP = "Vises to try"
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

    shown = length_unit(unit)
    vises, tolerances = asked_vises(vise, pitch, columns, peg_radius, shown)
    margin = asked_contact_margin(contact_margin, shown)
    restrictions = RestrictionWords(avoid, keep_out, angle).asked(shown)
    ranking, forces = asked_ranking(rank_by), asked_loads(load, loads, shown)
    if tolerance is not None:
        tolerances = {}
    if out is not None:
        refuse_output(out, (part, loads, *(name for names in vise or () for name in names.split(","))), force)
    from workhold.kernels.base.compiling import is_first_run
    from workhold.listing.ranking import preference_of

    preference = preference_of(ranking, asked_tolerance(tolerance, shown, None), forces)
    workpiece = load_part(part, unit, layer, part_number, join_tolerance, drawing_unit, axis, section).workpiece
    refuse_unknown_faces(workpiece, restrictions)
    first_run = is_first_run()
    from workhold.search.exploring import explore as try_all

    found: list[Explored] = []
    with ask_to_stop() as cancel, search_progress(first_run) as progress:
        if first_run:
            from workhold.cli.warming import compile_kernels

            compile_kernels(cancel)
        options: dict[str, Any] = {
            "contact_margin": margin,
            "restrictions": restrictions,
            "rank_by": preference.ranking,
            "tolerance": preference.tolerance,
            "loads": preference.loads,
        }
        for item in try_all(workpiece, vises, tolerances=tolerances, cancel=cancel, **options):
            found.append(item)
            progress(len(found) / len(vises), sum(one.fixtures for one in found))
    print_explored(found, preference.ranking, shown)
    if out is not None:
        with text_file(Path(out)) as stream:
            stream.write(table_text(found))
        from workhold.cli.tables import print_tables

        print_tables(f"Written to {out}.")
    if len(found) < len(vises):
        tell(f"interrupted: {len(vises) - len(found)} vises were not tried.")
        raise typer.Exit(INTERRUPTED)


def asked_vises(
    names: list[str] | None, pitch: str | None, columns: str | None, peg_radius: str | None, unit: Unit
) -> tuple[list[tuple[str, dict[str, Any]]], dict[str, Tolerance]]:
    """Names and keyword arguments of the vises to try, and the tolerances of those that have one.

    Raises
    ------
    InputError
        For words that mean nothing, and lists that do not make a vise.
    """
    from workhold.files.toolkit.presets import load_vise, preset_names

    lists: list[list[tuple[str, dict[str, Any]]]] = []
    if pitch is not None:
        lists.append([(f"pitch {word}", {"pitch": pitch_of(word, unit)}) for word in words_of("--pitch", pitch)])
    if columns is not None:
        numbers = [whole_number("--columns", word) for word in words_of("--columns", columns)]
        lists.append([(f"{number} column{'s' if number != 1 else ''}", {"columns": number}) for number in numbers])
    if peg_radius is not None:
        radii = [(word, length("--peg-radius", word, unit)) for word in words_of("--peg-radius", peg_radius)]
        lists.append([(f"radius {word}", {"peg_radius": radius}) for word, radius in radii])
    combined = [
        (", ".join(name for name, _ in choice), {key: value for _, fields in choice for key, value in fields.items()})
        for choice in product(*lists)
    ]
    if names is None and pitch is not None:
        if columns is None or peg_radius is None:
            raise InputError("a list of pitches alone makes no vise: give --columns and --peg-radius too, or --vise.")
        bases: list[tuple[str, dict[str, Any]]] = [("", {})]
        tolerances: dict[str, Tolerance] = {}
        return limited([one for base in bases for one in merged(base, combined)]), tolerances
    asked = preset_names() if names is None else [name for words in names for name in words_of("--vise", words)]
    loaded = [load_vise(name) for name in asked]
    vises = [one for item in loaded for one in merged((item.name, item.fields), combined)]
    tolerances = {name: item.tolerance for item in loaded for name, _ in merged((item.name, item.fields), combined)}
    return limited(vises), tolerances


def limited(vises: list[tuple[str, dict[str, Any]]]) -> list[tuple[str, dict[str, Any]]]:
    """The vises, unless there are far too many.

    Raises
    ------
    InputError
        For more than a thousand.
    """
    if len(vises) > MOST_VISES:
        raise InputError(f"the lists combine to {len(vises)} vises: give lists that combine to {MOST_VISES} or fewer.")
    return vises


def merged(
    base: tuple[str, dict[str, Any]], changes: list[tuple[str, dict[str, Any]]]
) -> list[tuple[str, dict[str, Any]]]:
    """A vise with each of some changes."""
    name, fields = base
    return [(", ".join(filter(None, (name, words))), fields | change) for words, change in changes]


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


def refuse_unknown_faces(workpiece: Any, restrictions: Any) -> None:
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
        ("vise", ">fixtures", ">type I", ">type II", *(f">best {heading(figure, unit)}" for figure in figures))
    )
    for item in found:
        counts = (f"{count:,}" for count in (item.fixtures, item.found["I"], item.found["II"]))
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
        writer.writerow([item.name, item.fixtures, item.found["I"], item.found["II"], *values, item.reason])
    return stream.getvalue()
