"""Telling on the terminal why there is no fixture, and drawing the nearest miss."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, TextIO

if TYPE_CHECKING:
    from workhold.fixels.toolkit import Toolkit
    from workhold.model.explanation import Explanation
    from workhold.model.result import Result
    from workhold.units import Unit

__all__ = ["explain_none"]

MOST_HELPS = 6


def explain_none(result: Result, threads: int | None, folder: Path | None, unit: Unit, stream: TextIO) -> None:
    """Say what each rule took away, what came nearest, and what would help.

    Parameters
    ----------
    folder : where the nearest miss is drawn, if anywhere.
    """
    from workhold.search.explaining import explain

    explanation = explain(result.query, threads, unit)
    print_explanation(explanation, result.query.toolkit, unit, stream)
    if folder is not None and explanation.nearest is not None:
        draw_nearest_miss(explanation, result, folder, unit, stream)


def print_explanation(explanation: Explanation, toolkit: Toolkit, unit: Unit, stream: TextIO) -> None:
    """Write the explanation."""
    from workhold.cli.tables import Table, fixture_tables, print_tables

    print_tables("", stream=stream)
    if explanation.contacts == 0:
        print_tables(f"No {toolkit.wording.four} can touch the part at the same time.", stream=stream)
    else:
        table = Table(("rule", ">sets of four contacts", ">removed", ">left"))
        for removal in explanation.removals:
            table.add_row(removal.rule, f"{removal.before:,}", f"{removal.removed:,}", f"{removal.after:,}")
        print_tables(table, f"The last were removed by: {explanation.last_rule}.", stream=stream)
    if explanation.nearest is not None:
        _, _, _, pegs = fixture_tables(explanation.nearest.fixture, toolkit, 1, 1, unit)
        print_tables("", f"Nearest miss: {explanation.nearest.words}", pegs, stream=stream)
    print_tables("", stream=stream)
    if not explanation.helps:
        print_tables("No single change that was tried helps; workhold explore tries others.", stream=stream)
        return
    helps = Table(("what would help", ">fixtures"))
    for item in explanation.helps[:MOST_HELPS]:
        helps.add_row(item.change, f"{item.fixtures:,}" if item.complete else f"over {item.fixtures:,}")
    print_tables(helps, stream=stream)


def draw_nearest_miss(explanation: Explanation, result: Result, folder: Path, unit: Unit, stream: TextIO) -> None:
    """Draw the nearest miss into a folder, as SVG and PNG.

    Raises
    ------
    InputError
        When the folder cannot be written.
    """
    from workhold.cli.pictures import NEAREST_MISS, draw_one
    from workhold.cli.tables import print_tables

    assert explanation.nearest is not None
    written = draw_one(explanation.nearest.fixture, result, folder, NEAREST_MISS, "Nearest miss", unit)
    print_tables(f"Drawn: the nearest miss in {written[0]} and {written[-1].name}.", stream=stream)
