"""The table of the force that each load asks for, where friction holds the part."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from workhold.cli.table import Table
from workhold.presenting.figure_words import format_rounded
from workhold.units import Unit

__all__ = ["tabulate_needs"]


def tabulate_needs(names: Iterable[str], needs: Sequence[float | None], heading: str, unit: Unit) -> Table:
    """Return a table of the force in N that each load needs,
    by the names of loads; None is "no force holds it".
    """
    table = Table((">load", "name", f">{heading} {unit.force}"))
    for number, (name, need) in enumerate(zip(names, needs, strict=True), 1):
        text = "no force holds it" if need is None else format_rounded(need / unit.newtons, 1)
        table.add_row(str(number), name, text)
    return table
