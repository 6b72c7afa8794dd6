"""Options that describe one toolkit, made from the field table."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from attrs import evolve, field, frozen

from workhold.cli.commands import option
from workhold.cli.values import length, optional_length, pitches, two_lengths, whole_number
from workhold.errors import InputError
from workhold.fixels.fields import MIN_GAP, NAMES, OPTIONS
from workhold.fixels.table import TOOLKIT_SECTION
from workhold.units import Unit

if TYPE_CHECKING:
    from workhold.fixels.toolkit import Toolkit
    from workhold.model.requirements import Tolerance

__all__ = ["READERS", "TOOLKIT", "ToolkitWords"]

TOOLKIT = option(
    TOOLKIT_SECTION,
    "NAME|FILE",
    f"{' '.join(f'{name}: {words}.' for name, words in NAMES.items())} Or a name of workhold toolkits, or a "
    "TOML file. vise if not given.",
    "--toolkit",
)
MIN_OPENING = option(
    TOOLKIT_SECTION,
    "LENGTH",
    "Smallest distance from the left jaw's last column to the right jaw's first, if larger.",
)


def typed_options() -> dict[str, Any]:
    """Makes the attributes of :class:`ToolkitWords` in the order of the help, from the field table."""
    out = {
        "vise": option(
            TOOLKIT_SECTION, "NAME|FILE", "The same as --toolkit; the options below change what it says."
        ),
        "toolkit": TOOLKIT,
    }
    for row in OPTIONS:
        out[row.name] = option(row.section, row.metavar, row.help.format(option=row.option), row.option)
        if row is MIN_GAP:
            out["min_opening"] = MIN_OPENING
    words: Any = str | None
    several: Any = list[str] | None
    lists = {row.name for row in OPTIONS if row.form == "holes"}
    return {
        name: field(default=given, type=several if name in lists else words) for name, given in out.items()
    }


@frozen(these=typed_options())
class ToolkitWords:
    """The options of the toolkit, as typed; None for those not given."""

    if TYPE_CHECKING:
        vise: str | None
        toolkit: str | None
        min_opening: str | None

    def fields(self, unit: Unit) -> dict[str, Any]:
        """Makes keyword arguments of a toolkit, in mm, of the options that were given."""
        return {
            row.name: READERS[row.form](row.option, words, unit)
            for row in OPTIONS
            if (words := getattr(self, row.name)) not in (None, [])
        }

    def refuse_others(self, kind: type[Toolkit]) -> None:
        """Refuses options that a kind of toolkit does not have."""
        from workhold.fixels.kinds import owner_of

        known = {row.name for row in kind.table.fields}
        for row in OPTIONS:
            typed = [row.option] if getattr(self, row.name) else []
            if row is MIN_GAP and self.min_opening is not None:
                typed.append("--min-opening")
            if typed and row.name not in known:
                raise InputError(
                    f"{typed[0]} is of {owner_of(row).noun}s: a {kind.noun} has no {row.belongs_to}; leave "
                    "it out, or choose another --toolkit."
                )

    def asked(self, unit: Unit) -> tuple[Toolkit, Tolerance | None]:
        """The toolkit, and the tolerance that a named one comes with.

        Raises
        ------
        InputError
            For words that mean nothing, options that are missing, and a vise that cannot be.
        """
        fields, tolerance = self.fields(unit), None
        opening = optional_length("--min-opening", self.min_opening, unit)
        from workhold.fixels.kinds import ALIASES, KINDS, USUAL, kind_of, toolkit_of

        kind, said = kind_of(USUAL)
        words = [word for word in (self.vise, self.toolkit) if word is not None]
        named = [word for word in words if word.lower() not in (*KINDS, *ALIASES)]
        if len(named) > 1:
            raise InputError(
                f"--vise {named[0]} and --toolkit {named[1]} name two toolkits: give one of them."
            )
        if named:
            from workhold.files.toolkit_file import load_toolkit

            loaded = load_toolkit(named[0])
            kind, said, tolerance = loaded.kind, loaded.fields, loaded.tolerance
            if fields.get("peg_radius", said["peg_radius"]) != said["peg_radius"]:
                tolerance = evolve(tolerance, fit=None)
        for word in words:
            if word not in named:
                kind, more = kind_of(word.lower())
                said = {**said, **more}
        self.refuse_others(KINDS[kind])
        fields = {**said, **fields}
        for row in KINDS[kind].table.fields:
            if row.is_required and row.name not in fields:
                noun = KINDS[kind].noun
                raise InputError(
                    f"the {noun}'s {row.missing} is not given: add {row.option}, or name a {noun} with "
                    "--toolkit (see workhold toolkits)."
                )
        vise = toolkit_of(kind, fields)
        travel = vise.moving.travel
        if opening is None or travel is None:
            return vise, tolerance
        if travel.most is not None and opening > travel.most:
            most = unit.figure(travel.most)
            raise InputError(
                f"the smallest opening {unit.figure(opening)} {unit.abbreviation} is above the largest, "
                f"{most} {unit.abbreviation}: no opening is left."
            )
        if opening > travel.least:
            # The jaws never stand farther apart than the pegs, so the one limit says it all.
            vise = toolkit_of(kind, fields | {MIN_GAP.name: opening})
        return vise, tolerance


def lengths(option_name: str, text: str, unit: Unit) -> tuple[float, ...]:
    """Reads lengths with commas between them; returns them in mm."""
    return tuple(length(option_name, word, unit) for word in text.split(","))


def span(option_name: str, text: str, unit: Unit) -> tuple[float, ...]:
    """Reads the least and the most of a length; returns them in mm."""
    remedy = "two lengths: give the least and the most, such as 10,35."
    return two_lengths(option_name, text, unit, remedy)


def directions(option_name: str, text: str) -> list[str | tuple[str, ...]]:
    """Reads directions such as ``-x,-y``, or pairs of them such as ``-x:-y,-x:+y``; refuses both together."""
    words = [word.strip() for word in text.split(",")]
    if len({":" in word for word in words}) == 2:
        raise InputError(
            f"{option_name} {text!r} has pairs and single directions: give one kind, such as -x:-y,-x:+y."
        )
    return [tuple(name.strip() for name in word.split(":")) if ":" in word else word for word in words]


# How the words of an option are read, by the form of its field.
READERS: Mapping[str, Callable[[str, Any, Unit], Any]] = {
    "count": lambda name, text, unit: whole_number(name, text),
    "length": length,
    "pitch": lambda name, text, unit: pitches(text, unit),
    "span": span,
    "flat": lengths,
    "heights": span,
    "holes": lambda name, texts, unit: [hole for text in texts for hole in text.split(",")],
    "directions": lambda name, text, unit: directions(name, text),
}
