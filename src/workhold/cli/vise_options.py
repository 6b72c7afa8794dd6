"""Options that describe the vise, shared by the commands that search."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer
from attrs import frozen

from workhold.cli.values import choice, length, optional_length, pitches, whole_number
from workhold.errors import InputError
from workhold.model.units import Unit

if TYPE_CHECKING:
    from workhold.model.tolerance import Tolerance
    from workhold.model.vise import Vise

__all__ = [
    "BlockedOption",
    "BodyRadiusOption",
    "ColumnsOption",
    "MaxOpeningOption",
    "MinGapOption",
    "MinOpeningOption",
    "PegRadiusOption",
    "PitchOption",
    "RowOffsetOption",
    "RowsOption",
    "ToolkitOption",
    "ViseOption",
    "ViseWords",
]

VISE = "The vise"


def option(*names: str, metavar: str, help: str) -> Any:
    """An option of the vise."""
    return typer.Option(*names, metavar=metavar, help=help, rich_help_panel=VISE)


ViseOption = Annotated[
    str | None,
    option(
        metavar="NAME|FILE",
        help="A vise by name (see workhold vises) or from a TOML file; the options below change what it says.",
    ),
]
ToolkitOption = Annotated[
    str | None,
    option(
        "--toolkit",
        metavar="vise|opening-vise",
        help="vise: closing clamps the part. opening-vise: opening does, from inside its holes or around a waist. "
        "What --vise says, or else vise, if not given.",
    ),
]
PitchOption = Annotated[
    str | None,
    option(metavar="X[,Y]", help="Distance between neighbouring holes, one for both directions or X,Y."),
]
ColumnsOption = Annotated[str | None, option(metavar="N", help="Columns of holes on each jaw.")]
PegRadiusOption = Annotated[str | None, option(metavar="LENGTH", help="Radius of the pegs where they touch the part.")]
BodyRadiusOption = Annotated[
    str | None,
    option(
        metavar="LENGTH",
        help="Radius of the pegs' thickest part, such as a shoulder below the part; the peg radius if not given.",
    ),
]
RowsOption = Annotated[
    str | None, option(metavar="N", help="Rows of holes on each jaw; as many as needed if not given.")
]
BlockedOption = Annotated[
    list[str] | None,
    option(metavar="HOLES", help="Holes that no peg can stand in: L-B3,R-A1; L-B is a whole column. May be repeated."),
]
MinGapOption = Annotated[
    str | None,
    option(
        metavar="LENGTH",
        help="Smallest distance along x from a left peg's centre to a right peg's; the x pitch if not given.",
    ),
]
MinOpeningOption = Annotated[
    str | None,
    option(
        metavar="LENGTH", help="Smallest distance from the left jaw's last column to the right jaw's first, if larger."
    ),
]
MaxOpeningOption = Annotated[
    str | None,
    option(
        metavar="LENGTH",
        help="Largest distance from the left jaw's last column to the right jaw's first; no limit if not given.",
    ),
]
RowOffsetOption = Annotated[
    str | None, option(metavar="LENGTH", help="Height of the right jaw's rows above the left jaw's.")
]


@frozen
class ViseWords:
    """What was typed about the vise; None for options not given."""

    vise: str | None
    toolkit: str | None
    pitch: str | None
    columns: str | None
    peg_radius: str | None
    body_radius: str | None
    rows: str | None
    blocked: list[str] | None
    min_gap: str | None
    min_opening: str | None
    max_opening: str | None
    row_offset: str | None

    def fields(self, unit: Unit) -> dict[str, Any]:
        """Keyword arguments of a vise, in mm, for the options that were given.

        Raises
        ------
        InputError
            For words that mean nothing.
        """
        out: dict[str, Any] = {}
        if self.pitch is not None:
            out["pitch"] = pitches(self.pitch, unit)
        if self.columns is not None:
            out["columns"] = whole_number("--columns", self.columns)
        if self.rows is not None:
            out["rows"] = whole_number("--rows", self.rows)
        for name in ("peg_radius", "body_radius", "min_gap", "max_opening", "row_offset"):
            text = getattr(self, name)
            if text is not None:
                out[name] = length(f"--{name.replace('_', '-')}", text, unit)
        if self.blocked:
            out["blocked"] = [name for words in self.blocked for name in words.split(",")]
        return out

    def asked(self, unit: Unit) -> tuple[Vise, Tolerance | None]:
        """The vise, and the tolerance that a named one comes with.

        Raises
        ------
        InputError
            For words that mean nothing, options that are missing, and a vise that cannot be.
        """
        fields, tolerance = self.fields(unit), None
        opening = optional_length("--min-opening", self.min_opening, unit)
        from workhold.model.kinds import KINDS, USUAL, toolkit_of

        kind = USUAL
        if self.vise is not None:
            from workhold.files.toolkit.presets import load_vise

            loaded = load_vise(self.vise)
            kind, fields, tolerance = loaded.kind, loaded.fields | fields, loaded.tolerance
        if self.toolkit is not None:
            kind = choice("--toolkit", self.toolkit, tuple(KINDS))
        for name, words in (
            ("pitch", "distance between holes"),
            ("columns", "columns"),
            ("peg_radius", "pegs' radius"),
        ):
            if name not in fields:
                option_name = f"--{name.replace('_', '-')}"
                raise InputError(
                    f"the vise's {words} is not given: add {option_name}, or name a vise with --vise (see workhold vises)."
                )
        vise = toolkit_of(kind, fields)
        if opening is not None and opening > vise.min_gap:
            # The jaws never stand farther apart than the pegs, so the one limit says it all.
            vise = toolkit_of(kind, fields | {"min_gap": opening})
        return vise, tolerance
