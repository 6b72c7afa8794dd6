"""Options that describe the vise or plate, shared by the commands that search."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from attrs import evolve, frozen

from workhold.cli.commands import option
from workhold.cli.values import length, optional_length, pitches, whole_number
from workhold.errors import InputError
from workhold.model.units import Unit

if TYPE_CHECKING:
    from workhold.model.tolerance import Tolerance
    from workhold.model.toolkit import Toolkit

__all__ = ["TOOLKIT", "ViseWords"]

VISE = "The vise or plate"
PLATE = "The clamp of a plate"


TOOLKIT = option(
    VISE,
    "NAME|FILE",
    "vise: closing clamps the part. opening-vise: opening does, from inside its holes or around a waist. gripper: a vise of "
    "one column. plate: three locators on a plate of holes, and a clamp. Or a name of workhold vises, or a TOML file. vise "
    "if not given.",
    "--toolkit",
)
# Options that only one kind of toolkit has.
OF_VISES = ("body_radius", "blocked", "min_gap", "min_opening", "max_opening", "row_offset")
OF_PLATES = ("clamp_radius", "travel", "direction")


@frozen
class ViseWords:
    """What was typed about the vise or plate; None for options not given."""

    vise: str | None = option(
        VISE,
        "NAME|FILE",
        "The same as --toolkit; the options below change what it says.",
    )
    toolkit: str | None = TOOLKIT
    pitch: str | None = option(VISE, "X[,Y]", "Distance between neighbouring holes, one for both directions or X,Y.")
    columns: str | None = option(
        VISE, "N", "Columns of holes on each jaw, or on the plate: as many as needed if not given."
    )
    peg_radius: str | None = option(VISE, "LENGTH", "Radius of the pegs where they touch the part.")
    body_radius: str | None = option(
        VISE,
        "LENGTH",
        "Radius of the pegs' thickest part, such as a shoulder below the part; the peg radius if not given.",
    )
    rows: str | None = option(VISE, "N", "Rows of holes; as many as needed if not given.")
    blocked: list[str] | None = option(
        VISE, "HOLES", "Holes that no peg can stand in: L-B3,R-A1; L-B is a whole column. May be repeated."
    )
    min_gap: str | None = option(
        VISE, "LENGTH", "Smallest distance along x from a left peg's centre to a right peg's; the x pitch if not given."
    )
    min_opening: str | None = option(
        VISE, "LENGTH", "Smallest distance from the left jaw's last column to the right jaw's first, if larger."
    )
    max_opening: str | None = option(
        VISE,
        "LENGTH",
        "Largest distance from the left jaw's last column to the right jaw's first; no limit if not given.",
    )
    row_offset: str | None = option(VISE, "LENGTH", "Height of the right jaw's rows above the left jaw's.")
    clamp_radius: str | None = option(PLATE, "LENGTH", "Radius of the clamp's round tip; the peg radius if not given.")
    travel: str | None = option(
        PLATE,
        "LEAST,MOST",
        "Least and most from the hole that the clamp is bolted in to its tip; any, with nothing asked of its body, if not "
        "given.",
    )
    direction: str | None = option(
        PLATE,
        "LIST",
        "In which the clamp may push: among -x, +x, -y, +y, such as --direction=-x,-y; all that a turn of the "
        "plate does not make of another one, if not given.",
    )

    def fields(self, unit: Unit) -> dict[str, Any]:
        """Keyword arguments of a toolkit, in mm, for the options that were given.

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
        for name in ("peg_radius", "body_radius", "min_gap", "max_opening", "row_offset", "clamp_radius"):
            text = getattr(self, name)
            if text is not None:
                out[name] = length(f"--{name.replace('_', '-')}", text, unit)
        if self.blocked:
            out["blocked"] = [name for words in self.blocked for name in words.split(",")]
        if self.travel is not None:
            words = self.travel.split(",")
            if len(words) != 2:
                raise InputError(
                    f"--travel {self.travel!r} is not two lengths: give the least and the most, such as 10,35."
                )
            out["travel"] = tuple(length("--travel", word, unit) for word in words)
        if self.direction is not None:
            out["directions"] = [name.strip() for name in self.direction.split(",")]
        return out

    def refuse_others(self, of_plates: bool) -> None:
        """Refuse options that the kind of toolkit does not have.

        Raises
        ------
        InputError
            Naming the first of them.
        """
        for name in OF_VISES if of_plates else OF_PLATES:
            if getattr(self, name):
                what = (
                    "of vises: a plate has no jaws" if of_plates else "of plates: a vise has no clamp beside its jaws"
                )
                raise InputError(f"--{name.replace('_', '-')} is {what}; leave it out, or choose another --toolkit.")

    def asked(self, unit: Unit) -> tuple[Toolkit, Tolerance | None]:
        """The toolkit, and the tolerance that a named one comes with.

        Raises
        ------
        InputError
            For words that mean nothing, options that are missing, and a vise that cannot be.
        """
        fields, tolerance = self.fields(unit), None
        opening = optional_length("--min-opening", self.min_opening, unit)
        from workhold.model.kinds import ALIASES, KINDS, USUAL, kind_of, toolkit_of
        from workhold.model.plate import Plate
        from workhold.model.vise import Vise

        kind, said = kind_of(USUAL)
        named = [
            word for word in (self.vise, self.toolkit) if word is not None and word.lower() not in (*KINDS, *ALIASES)
        ]
        if len(named) > 1:
            raise InputError(f"--vise {named[0]} and --toolkit {named[1]} name two toolkits: give one of them.")
        if named:
            from workhold.files.toolkit.presets import load_vise

            loaded = load_vise(named[0])
            kind, said, tolerance = loaded.kind, loaded.fields, loaded.tolerance
            if fields.get("peg_radius", said["peg_radius"]) != said["peg_radius"]:
                tolerance = evolve(tolerance, fit=None)
        for word in (self.vise, self.toolkit):
            if word is not None and word.lower() in (*KINDS, *ALIASES):
                kind, more = kind_of(word.lower())
                said = {**said, **more}
        self.refuse_others(kind == Plate.kind)
        fields = {**said, **fields}
        needed = {"pitch": "distance between holes", "columns": "columns", "peg_radius": "pegs' radius"}
        for name, words in needed.items():
            if name not in fields and not (name == "columns" and kind == Plate.kind):
                option_name = f"--{name.replace('_', '-')}"
                noun = KINDS[kind].noun
                raise InputError(
                    f"the {noun}'s {words} is not given: add {option_name}, or name a {noun} with --toolkit (see workhold "
                    "vises)."
                )
        vise = toolkit_of(kind, fields)
        if not isinstance(vise, Vise):
            return vise, tolerance
        if opening is not None and vise.max_opening is not None and opening > vise.max_opening:
            most = unit.figure(vise.max_opening)
            raise InputError(
                f"the smallest opening {unit.figure(opening)} {unit.abbreviation} is above the largest, {most} "
                f"{unit.abbreviation}: no opening is left."
            )
        if opening is not None and opening > vise.min_gap:
            # The jaws never stand farther apart than the pegs, so the one limit says it all.
            vise = toolkit_of(kind, fields | {"min_gap": opening})
        return vise, tolerance
