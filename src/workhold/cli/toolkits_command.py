"""``workhold toolkits``: the vises, plates and fences that come with workhold, and what a file of one says."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated

import typer

from workhold.cli.json_output import JsonOption, print_json
from workhold.cli.options import SHOWN_UNIT
from workhold.cli.values import length_unit

if TYPE_CHECKING:
    from workhold.cli.tables import Table
    from workhold.files.toolkit.reader import LoadedToolkit
    from workhold.model.dowel import Limits
    from workhold.model.units import Unit

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
    from workhold.model.units import MILLIMETRE

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
    from workhold.model.vise import Vise

    toolkit, of = loaded.toolkit, unit.abbreviation
    first, finest = toolkit.carriers[0], unit.decimals + 1
    each = f"on each {first.noun}" if isinstance(toolkit, Vise) else f"on the {first.noun}"
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
    """What only a toolkit of its kind has, and its value in words."""
    from workhold.model.fence import Fence
    from workhold.model.plate import Plate
    from workhold.model.vise import Vise

    toolkit, of = loaded.toolkit, unit.abbreviation
    assumed = dict.fromkeys(loaded.assumed, " (assumed: no source says)")
    if isinstance(toolkit, Fence):
        offset = f"{unit.figure(toolkit.wall_offset, unit.decimals + 1)} {of}"
        yield "from the fence to the first row of holes", offset + assumed.get("wall_offset", "")
    if isinstance(toolkit, Plate):
        tip = f"{unit.figure(toolkit.clamp_radius, unit.decimals + 1)} {of}"
        yield "radius of the clamp's tip", tip + assumed.get("clamp_radius", "")
        reach = "any" if toolkit.travel is None else " to ".join(unit.figure(length) for length in toolkit.travel)
        yield (
            "from the clamp's hole to its tip",
            f"{reach} {of if toolkit.travel else ''}".strip() + assumed.get("travel", ""),
        )
        if toolkit.clamps == 2:
            yield "clamps, needed together", "2"
            yield "the clamps push along", " or ".join(" and ".join(pair) for pair in toolkit.directions)
        else:
            yield "the clamp pushes along", " or ".join(toolkit.directions)
    if isinstance(toolkit, Vise):
        yield "smallest gap between left and right pegs", f"{unit.figure(toolkit.min_gap)} {of}"
        most = toolkit.max_opening
        yield "largest opening", "no limit" if most is None else f"{unit.figure(most)} {of}"
        if toolkit.row_offset:
            yield "right rows above left rows", f"{unit.figure(toolkit.row_offset)} {of}"
        if toolkit.body_radius != toolkit.peg_radius:
            yield "radius of the pegs' bodies", f"{unit.figure(toolkit.body_radius)} {of}"
        if toolkit.blocked:
            yield "blocked", " ".join(holes.name for holes in toolkit.blocked)


def pitch_words(pitch: tuple[float, float], unit: Unit) -> str:
    """The pitch as one number, or as two where they differ."""
    x, y = (unit.figure(length) for length in pitch)
    return x if pitch[0] == pitch[1] else f"{x} x {y}"


def limits_words(limits: Limits, unit: Unit) -> str:
    """Two limits of a diameter."""
    return f"{unit.number(limits[0])} to {unit.text(limits[1])}"
