"""The table of the clamping force that each load needs, where friction holds the part."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from workhold.cli.table import Table
from workhold.presenting.figure_words import format_rounded
from workhold.units import Unit

__all__ = ["tabulate_needs"]


def tabulate_needs(names: Iterable[str], needs: Sequence[float | None], heading: str, unit: Unit) -> Table:
    """Return a table with a row for each load: number, name and the force that it needs.

    ``needs`` are in N, shown in the unit's force unit; None is shown as "no force holds it". ``heading`` is
    the heading over the forces.
    """
    table = Table((">load", "name", f">{heading} {unit.force}"))
    for number, (name, need) in enumerate(zip(names, needs, strict=True), 1):
        text = "no force holds it" if need is None else format_rounded(need / unit.newtons, 1)
        table.add_row(str(number), name, text)
    return table
