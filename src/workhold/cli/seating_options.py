"""Options that ask whether the part ends up where a fixture has it."""

from __future__ import annotations

from typing import Annotated, Any

import typer
from attrs import frozen

from workhold.cli.commands import option
from workhold.cli.values import optional_count, optional_positive_length
from workhold.errors import InputError
from workhold.units import Unit

__all__ = ["SeatingWords"]

SEATING = "Seating"
FoolproofOption = Annotated[
    bool,
    typer.Option(
        "--foolproof",
        help="List only those of them that have no wrong place to rest in, or a caliper tells each.",
        rich_help_panel=SEATING,
    ),
]


@frozen
class SeatingWords:
    """What was typed about seating; None for options not given."""

    seating: str | None = option(
        SEATING,
        "K",
        "Of the first K fixtures tell from how far open, or with the clamp how far drawn back, the part is caught and where "
        "else it can rest, and order them by that too (see workhold seat).",
    )
    opening: str | None = option(
        SEATING,
        "LENGTH",
        "List only those of them that catch the part with the jaws open, or the clamp drawn back, by so much more than "
        "where they hold it; places beyond it do not count.",
    )
    foolproof: FoolproofOption = False

    def asked(self, unit: Unit) -> dict[str, Any]:
        """Keyword arguments of a query.

        Raises
        ------
        InputError
            For words that are no number or length, and for rules of seating where that is not asked for.
        """
        count = optional_count("--seating", self.seating)
        opening = optional_positive_length("--opening", self.opening, unit)
        if count is None and (opening is not None or self.foolproof):
            raise InputError(
                "--opening and --foolproof need --seating K: of how many fixtures, the first, to look at it."
            )
        return {"seating": count, "opening": opening, "foolproof": bool(self.foolproof)}
