"""Options that describe the toolkit, shared by the commands that search."""

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

__all__ = ["TOOLKIT", "ToolkitWords"]

HELD_IN = "The toolkit"
CLAMPS = "The clamps of a plate or fence"


TOOLKIT = option(
    HELD_IN,
    "NAME|FILE",
    "vise: closing clamps the part. opening-vise: opening does, from inside its holes or around a waist. gripper: a vise of "
    "one column. plate: three locators on a plate of holes, and a clamp or two. fence: a straight wall that the part lies "
    "flush against, one locator and a clamp. Or a name of workhold toolkits, or a TOML file. vise if not given.",
    "--toolkit",
)
# Options that only one kind of toolkit has.
OF_VISES = ("body_radius", "blocked", "min_gap", "min_opening", "max_opening", "row_offset")
OF_PLATES = ("clamps", "clamp_radius", "travel", "direction", "wall_offset")


@frozen
class ToolkitWords:
    """What was typed about the toolkit; None for options not given."""

    vise: str | None = option(
        HELD_IN,
        "NAME|FILE",
        "The same as --toolkit; the options below change what it says.",
    )
    toolkit: str | None = TOOLKIT
    pitch: str | None = option(HELD_IN, "X[,Y]", "Distance between neighbouring holes, one for both directions or X,Y.")
    columns: str | None = option(
        HELD_IN, "N", "Columns of holes on each jaw, or on the plate: as many as needed if not given."
    )
    peg_radius: str | None = option(HELD_IN, "LENGTH", "Radius of the pegs where they touch the part.")
    body_radius: str | None = option(
        HELD_IN,
        "LENGTH",
        "Radius of the pegs' thickest part, such as a shoulder below the part; the peg radius if not given.",
    )
    flat: str | None = option(
        HELD_IN,
        "DISTANCE[,WIDTH/2]",
        "Pegs with a flat so far from their centre, turned so that it lies on straight faces, and half its width.",
    )
    rows: str | None = option(HELD_IN, "N", "Rows of holes; as many as needed if not given.")
    blocked: list[str] | None = option(
        HELD_IN, "HOLES", "Holes that no peg can stand in: L-B3,R-A1; L-B is a whole column. May be repeated."
    )
    min_gap: str | None = option(
        HELD_IN,
        "LENGTH",
        "Smallest distance along x from a left peg's centre to a right peg's; the x pitch if not given.",
    )
    min_opening: str | None = option(
        HELD_IN, "LENGTH", "Smallest distance from the left jaw's last column to the right jaw's first, if larger."
    )
    max_opening: str | None = option(
        HELD_IN,
        "LENGTH",
        "Largest distance from the left jaw's last column to the right jaw's first; no limit if not given.",
    )
    row_offset: str | None = option(HELD_IN, "LENGTH", "Height of the right jaw's rows above the left jaw's.")
    clamps: str | None = option(
        CLAMPS,
        "1|2",
        "2: two clamps that are needed together, as for a plain rectangle square to the plate; 1 if not given.",
    )
    clamp_radius: str | None = option(CLAMPS, "LENGTH", "Radius of the clamp's round tip; the peg radius if not given.")
    travel: str | None = option(
        CLAMPS,
        "LEAST,MOST",
        "Least and most from the hole that the clamp is bolted in to its tip; any, with nothing asked of its body, if not "
        "given.",
    )
    direction: str | None = option(
        CLAMPS,
        "LIST",
        "In which the clamp may push: among -x, +x, -y, +y, such as --direction=-x,-y; all that a turn of the "
        "plate does not make of another one, if not given. Of two clamps pairs, such as --direction=-x:-y,-x:+y, or single "
        "ones for all pairs of them.",
    )
    wall_offset: str | None = option(
        CLAMPS, "LENGTH", "Of a fence: distance from its wall to the first row of holes' centres; must be given."
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
        for name in (
            "peg_radius",
            "body_radius",
            "min_gap",
            "max_opening",
            "row_offset",
            "clamp_radius",
            "wall_offset",
        ):
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
        if self.flat is not None:
            out["flat"] = tuple(length("--flat", word, unit) for word in self.flat.split(","))
        if self.direction is not None:
            out["directions"] = directions(self.direction)
        if self.clamps is not None:
            out["clamps"] = whole_number("--clamps", self.clamps)
        return out

    def refuse_others(self, kind: type[Toolkit]) -> None:
        """Refuse options that a kind of toolkit does not have.

        Raises
        ------
        InputError
            Naming the first of them.
        """
        from workhold.model.fence import Fence
        from workhold.model.plate import Plate

        has_a_clamp = issubclass(kind, Plate)
        what = (
            f"of vises: a {kind.noun} has no jaws" if has_a_clamp else "of plates: a vise has no clamp beside its jaws"
        )
        others: tuple[str, ...] = OF_VISES if has_a_clamp else OF_PLATES
        for name in others:
            if getattr(self, name):
                raise InputError(f"--{name.replace('_', '-')} is {what}; leave it out, or choose another --toolkit.")
        if not issubclass(kind, Fence) and self.wall_offset is not None:
            raise InputError("--wall-offset is of fences: leave it out, or choose --toolkit fence.")

    def asked(self, unit: Unit) -> tuple[Toolkit, Tolerance | None]:
        """The toolkit, and the tolerance that a named one comes with.

        Raises
        ------
        InputError
            For words that mean nothing, options that are missing, and a vise that cannot be.
        """
        fields, tolerance = self.fields(unit), None
        opening = optional_length("--min-opening", self.min_opening, unit)
        from workhold.model.fence import Fence
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
            from workhold.files.toolkit.presets import load_toolkit

            loaded = load_toolkit(named[0])
            kind, said, tolerance = loaded.kind, loaded.fields, loaded.tolerance
            if fields.get("peg_radius", said["peg_radius"]) != said["peg_radius"]:
                tolerance = evolve(tolerance, fit=None)
        for word in (self.vise, self.toolkit):
            if word is not None and word.lower() in (*KINDS, *ALIASES):
                kind, more = kind_of(word.lower())
                said = {**said, **more}
        self.refuse_others(KINDS[kind])
        fields = {**said, **fields}
        needed = {"pitch": "distance between holes", "columns": "columns", "peg_radius": "pegs' radius"}
        if issubclass(KINDS[kind], Plate):
            del needed["columns"]
        if issubclass(KINDS[kind], Fence):
            needed["wall_offset"] = "distance from the first row of holes"
        for name, words in needed.items():
            if name not in fields:
                option_name = f"--{name.replace('_', '-')}"
                noun = KINDS[kind].noun
                raise InputError(
                    f"the {noun}'s {words} is not given: add {option_name}, or name a {noun} with --toolkit (see workhold "
                    "toolkits)."
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


def directions(text: str) -> list[str | tuple[str, ...]]:
    """Directions from words such as ``-x,-y``, or pairs of them such as ``-x:-y,-x:+y``.

    Raises
    ------
    InputError
        For directions and pairs together.
    """
    words = [word.strip() for word in text.split(",")]
    if len({":" in word for word in words}) == 2:
        raise InputError(f"--direction {text!r} has pairs and single directions: give one kind, such as -x:-y,-x:+y.")
    return [tuple(name.strip() for name in word.split(":")) if ":" in word else word for word in words]
