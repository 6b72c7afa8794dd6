"""``workhold toolkits``: the vises, plates and fences that come with workhold, and what a file of one says."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Any

import typer

from workhold.cli.json_output import JsonOption, print_json
from workhold.cli.options import SHOWN_UNIT
from workhold.cli.values import length_unit

if TYPE_CHECKING:
    from workhold.cli.tables import Table
    from workhold.files.toolkit.reader import LoadedToolkit
    from workhold.fixels.table import Form
    from workhold.model.dowel import Limits
    from workhold.units import Unit

__all__ = ["toolkits"]


def toolkits(
    name: Annotated[
        str | None,
        typer.Argument(metavar="[VISE]", help="Show all figures of this one: a name, or a TOML file of your own."),
    ] = None,
    unit: str | None = SHOWN_UNIT,
    json_: JsonOption = False,
) -> None:
    """List the vises, plates and fences that come with workhold, or show all figures of one.

    Those named clamp- are plates with a lattice of dowel holes, three locators and a clamp, two-clamp- with two, fence- with
    a fence and one locator. The others are vises with such a plate on each jaw; their number of columns is a usual one:
    your jaws may have more or fewer.

    Example: workhold toolkits plate-one-inch --unit inch
    """
    shown = None if unit is None else length_unit(unit)
    from workhold.cli.tables import print_tables
    from workhold.files.toolkit.presets import load_toolkit, preset_names
    from workhold.units import MILLIMETRE

    if json_:
        from workhold.presenting.data import toolkit_data

        print_json(toolkits=[toolkit_data(load_toolkit(one)) for one in (preset_names() if name is None else [name])])
        return
    if name is None:
        print_tables(toolkits_table(shown or MILLIMETRE))
        return
    loaded = load_toolkit(name)
    print_tables(*(line for line in (loaded.name, loaded.title) if line), figures_table(loaded, shown or loaded.unit))
    if loaded.source:
        print_tables(f"Source: {loaded.source}.")


def toolkits_table(unit: Unit) -> Table:
    """All presets, one line each, with lengths in a unit."""
    from workhold.cli.tables import Table
    from workhold.files.toolkit.presets import load_toolkit, preset_names

    of = unit.abbreviation
    table = Table(("name", f">pitch {of}", f">peg Ø {of}", ">columns", f">peg off by {of}", "what it is"))
    for name in preset_names():
        loaded = load_toolkit(name)
        first = loaded.toolkit.carriers[0]
        table.add_row(
            name,
            pitch_words(first.pitch, unit),
            unit.figure(2 * first.peg_radius),
            "any" if first.columns is None else str(first.columns),
            unit.number(loaded.tolerance.peg, unit.decimals + 1),
            loaded.title,
        )
    return table


def figures_table(loaded: LoadedToolkit, unit: Unit) -> Table:
    """Every figure of a toolkit, one line each."""
    from workhold.cli.tables import Table

    toolkit, of = loaded.toolkit, unit.abbreviation
    first, finest = toolkit.carriers[0], unit.decimals + 1
    each = f"on {'each' if len(toolkit.plates) > 1 else 'the'} {first.noun}"
    table = Table(("figure", "value"))
    table.add_row("distance between holes", f"{pitch_words(first.pitch, unit)} {of}")
    for words, count in (("columns", first.columns), ("rows", first.rows)):
        table.add_row(f"{words} {each}", "as many as needed" if count is None else str(count))
    table.add_row("peg radius", f"{unit.figure(first.peg_radius, finest)} {of}")
    if first.flat is not None:
        table.add_row("from a peg's centre to its flat", f"{unit.figure(first.flat.distance, finest)} {of}")
    for words, value in own_figures(loaded, unit):
        table.add_row(words, value)
    if loaded.fit is not None:
        table.add_row("pin diameter", limits_words(loaded.fit.pin, unit))
        table.add_row("hole diameter", limits_words(loaded.fit.hole, unit))
        assumed = " (assumed: no source says)" if loaded.fit.position_assumed else ""
        table.add_row("hole off its place by at most", f"{unit.figure(loaded.fit.position, finest)} {of}{assumed}")
    assumed = " (assumed: no pin and hole are given)" if loaded.fit is None else ""
    table.add_row("peg's surface off by at most", f"{unit.figure(loaded.tolerance.peg, finest)} {of}{assumed}")
    table.add_row("part's face off by at most", f"{unit.figure(loaded.tolerance.face, finest)} {of}")
    return table


def own_figures(loaded: LoadedToolkit, unit: Unit) -> Iterator[tuple[str, str]]:
    """Yield what only a toolkit of its kind has, and its value in words."""
    from workhold.fixels.kinds import table_of

    toolkit = loaded.toolkit
    for row in table_of(loaded.kind).fields:
        value = getattr(toolkit, row.name)
        is_usual = value == (toolkit.followed(row) if row.follows else row.default)
        if row.figure and (row.unset or row.is_always_shown or not is_usual):
            assumed = " (assumed: no source says)" if row.name in loaded.assumed else ""
            yield row.figure, (row.unset if value is None else words_of_value(row.form, value, unit)) + assumed


def words_of_value(form: Form, value: Any, unit: Unit) -> str:
    """The value of a field of some form, as it stands among the figures of a toolkit."""
    if form == "count":
        return str(value)
    if form == "holes":
        return " ".join(holes.name for holes in value)
    if form == "directions":
        return " or ".join(one if isinstance(one, str) else " and ".join(one) for one in value)
    lengths = value if isinstance(value, tuple) else (value,)
    return f"{' to '.join(unit.figure(one, unit.decimals + 1) for one in lengths)} {unit.abbreviation}"


def pitch_words(pitch: tuple[float, float], unit: Unit) -> str:
    """The pitch as one number, or as two where they differ."""
    x, y = (unit.figure(length) for length in pitch)
    return x if pitch[0] == pitch[1] else f"{x} x {y}"


def limits_words(limits: Limits, unit: Unit) -> str:
    """Two limits of a diameter."""
    return f"{unit.number(limits[0])} to {unit.text(limits[1])}"
