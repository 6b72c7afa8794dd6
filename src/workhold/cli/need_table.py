"""The table of the clamping force that each load needs, where friction holds the part."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import inf

from workhold.cli.table import Table
from workhold.presenting.figure_words import format_rounded
from workhold.units import Unit, format_rounded_down

__all__ = ["format_safety", "tabulate_needs"]


def tabulate_needs(
    names: Iterable[str],
    needs: Sequence[float | None],
    heading: str,
    unit: Unit,
    times: Sequence[float] = (),
    given: float | None = None,
) -> Table:
    """Return a table with a row for each load: number, name and the force that it needs.

    ``needs`` are in N, shown in the unit's force unit; None is shown as "no force holds it". ``heading`` is
    the heading over the forces. Where a force is ``given``, in N, a column has how many ``times`` each load
    it holds; inf is shown as "any".
    """
    at = () if given is None or len(times) != len(needs) else (f">times at {unit.format_force_alone(given)}",)
    table = Table((">load", "name", f">{heading} {unit.force}", *at))
    for number, (name, need) in enumerate(zip(names, needs, strict=True), 1):
        text = "no force holds it" if need is None else format_rounded(need / unit.newtons, 1)
        reached = (format_safety(times[number - 1]),) if at else ()
        table.add_row(str(number), name, text, *reached)
    return table


def format_safety(times: float) -> str:
    """Return a number of times rounded down to two decimals; inf as "any".

    >>> format_safety(1.999), format_safety(inf)
    ('1.99', 'any')
    """
    return "any" if times == inf else format_rounded_down(times)
