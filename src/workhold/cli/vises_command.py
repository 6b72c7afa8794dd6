"""``workhold vises``: the vises that come with workhold, and what a vise file says."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from workhold.cli.options import ShownUnitOption
from workhold.cli.values import length_unit

if TYPE_CHECKING:
    from workhold.cli.tables import Table
    from workhold.files.toolkit.reader import LoadedVise
    from workhold.model.dowel import Limits
    from workhold.model.units import Unit

__all__ = ["vises"]


def vises(
    name: Annotated[
        str | None,
        typer.Argument(metavar="[VISE]", help="Show all figures of this one: a name, or a TOML file of your own."),
    ] = None,
    unit: ShownUnitOption = None,
) -> None:
    """List the vises that come with workhold, or show all figures of one.

    They are plates with a lattice of dowel holes, one on each jaw. The number of columns is a usual one: your jaws may
    have more or fewer.

    Example: workhold vises plate-one-inch --unit inch
    """
    shown = None if unit is None else length_unit(unit)
    from workhold.cli.tables import print_tables
    from workhold.files.toolkit.presets import load_vise
    from workhold.model.units import MILLIMETRE

    if name is None:
        print_tables(vises_table(shown or MILLIMETRE))
        return
    loaded = load_vise(name)
    print_tables(*(line for line in (loaded.name, loaded.title) if line), figures_table(loaded, shown or loaded.unit))
    if loaded.source:
        print_tables(f"Source: {loaded.source}.")


def vises_table(unit: Unit) -> Table:
    """All presets, one line each, with lengths in a unit."""
    from workhold.cli.tables import Table
    from workhold.files.toolkit.presets import load_vise, preset_names

    of = unit.abbreviation
    table = Table(("name", f">pitch {of}", f">peg Ø {of}", ">columns", f">peg off by {of}", "what it is"))
    for name in preset_names():
        loaded = load_vise(name)
        vise = loaded.vise
        table.add_row(
            name,
            pitch_words(vise.pitch, unit),
            unit.figure(2 * vise.peg_radius),
            str(vise.columns),
            unit.number(loaded.tolerance.peg, unit.decimals + 1),
            loaded.title,
        )
    return table


def figures_table(loaded: LoadedVise, unit: Unit) -> Table:
    """Every figure of a vise, one line each."""
    from workhold.cli.tables import Table

    vise, of = loaded.vise, unit.abbreviation
    finest = unit.decimals + 1
    table = Table(("figure", "value"))
    table.add_row("distance between holes", f"{pitch_words(vise.pitch, unit)} {of}")
    table.add_row("columns on each jaw", str(vise.columns))
    table.add_row("rows on each jaw", "as many as needed" if vise.rows is None else str(vise.rows))
    table.add_row("peg radius", f"{unit.figure(vise.peg_radius, finest)} {of}")
    table.add_row("smallest gap between left and right pegs", f"{unit.figure(vise.min_gap)} {of}")
    opening = "no limit" if vise.max_opening is None else f"{unit.figure(vise.max_opening)} {of}"
    table.add_row("largest opening", opening)
    if vise.row_offset:
        table.add_row("right rows above left rows", f"{unit.figure(vise.row_offset)} {of}")
    if vise.body_radius != vise.peg_radius:
        table.add_row("radius of the pegs' bodies", f"{unit.figure(vise.body_radius)} {of}")
    if vise.blocked:
        table.add_row("blocked", " ".join(holes.name for holes in vise.blocked))
    if loaded.fit is not None:
        table.add_row("pin diameter", limits_words(loaded.fit.pin, unit))
        table.add_row("hole diameter", limits_words(loaded.fit.hole, unit))
        assumed = " (assumed: no source says)" if loaded.fit.position_assumed else ""
        table.add_row("hole off its place by at most", f"{unit.figure(loaded.fit.position, finest)} {of}{assumed}")
    assumed = " (assumed: no pin and hole are given)" if loaded.fit is None else ""
    table.add_row("peg's surface off by at most", f"{unit.figure(loaded.tolerance.peg, finest)} {of}{assumed}")
    table.add_row("part's face off by at most", f"{unit.figure(loaded.tolerance.face, finest)} {of}")
    return table


def pitch_words(pitch: tuple[float, float], unit: Unit) -> str:
    """The pitch as one number, or as two where they differ."""
    x, y = (unit.figure(length) for length in pitch)
    return x if pitch[0] == pitch[1] else f"{x} x {y}"


def limits_words(limits: Limits, unit: Unit) -> str:
    """Two limits of a diameter."""
    return f"{unit.number(limits[0])} to {unit.text(limits[1])}"
