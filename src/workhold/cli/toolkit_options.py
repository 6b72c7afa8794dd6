"""Options that describe one toolkit, and lists of toolkits for the commands that try many.

A list holds names, files and kinds, and its figures may be lists as well.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import product
from typing import TYPE_CHECKING, Any

from attrs import evolve, field, frozen

from workhold.cli.commands import option
from workhold.cli.search_options import with_fit_of
from workhold.cli.values import length, optional_length, pitches, whole_number
from workhold.errors import InputError
from workhold.fixels.fields import MIN_GAP, NAMES, OPTIONS, PITCH
from workhold.fixels.table import TOOLKIT_SECTION
from workhold.units import Unit

if TYPE_CHECKING:
    from workhold.fixels.toolkit import Toolkit
    from workhold.model.query import Query
    from workhold.model.requirements import Tolerance
    from workhold.model.workpiece import Workpiece

__all__ = ["TOOLKIT", "Named", "ToolkitWords", "query_of", "toolkits_to_try", "words_of"]

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
        """Makes keyword arguments of a toolkit, in mm, of the options that were given.

        Raises
        ------
        InputError
            For words that mean nothing.
        """
        return {
            row.name: READERS[row.form](row.option, words, unit)
            for row in OPTIONS
            if (words := getattr(self, row.name)) not in (None, [])
        }

    def refuse_others(self, kind: type[Toolkit]) -> None:
        """Refuses options that a kind of toolkit does not have.

        Raises
        ------
        InputError
            Naming the first of them.
        """
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
        named = [
            word
            for word in (self.vise, self.toolkit)
            if word is not None and word.lower() not in (*KINDS, *ALIASES)
        ]
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
        for word in (self.vise, self.toolkit):
            if word is not None and word.lower() in (*KINDS, *ALIASES):
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
    """Reads the least and the most of a length; returns them in mm.

    Raises
    ------
    InputError
        For less or more than two lengths.
    """
    if text.count(",") != 1:
        raise InputError(
            f"{option_name} {text!r} is not two lengths: give the least and the most, such as 10,35."
        )
    return lengths(option_name, text, unit)


def directions(option_name: str, text: str) -> list[str | tuple[str, ...]]:
    """Reads directions such as ``-x,-y``, or pairs of them such as ``-x:-y,-x:+y``.

    Raises
    ------
    InputError
        For directions and pairs together.
    """
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
    "holes": lambda name, texts, unit: [hole for text in texts for hole in text.split(",")],
    "directions": lambda name, text, unit: directions(name, text),
}


# More toolkits than this are more likely a slip than a wish.
MOST_TOOLKITS = 1000


@frozen
class Named:
    """A toolkit to try: its name, its kind and keyword arguments, and its tolerance where it has one."""

    name: str
    kind: str
    fields: dict[str, Any]
    tolerance: Tolerance | None = None

    def changed(self, changes: list[tuple[str, dict[str, Any]]]) -> Named:
        """Applies changes, each of which has a name."""
        name = ", ".join(filter(None, (self.name, *(words for words, _ in changes))))
        fields = {key: value for _, change in changes for key, value in change.items()}
        return Named(name, self.kind, self.fields | fields, self.tolerance)


def query_of(workpiece: Workpiece, named: Named, asked: dict[str, Any]) -> Query | InputError:
    """Makes the query for a toolkit, or returns the error that says why there is no such toolkit."""
    from workhold.fixels.kinds import toolkit_of
    from workhold.model.query import Query

    try:
        return Query(
            workpiece,
            toolkit_of(named.kind, named.fields),
            **asked | {"tolerance": with_fit_of(asked["tolerance"], named.tolerance)},
        )
    except InputError as error:
        return error


def toolkits_to_try(
    names: list[str] | None,
    toolkit: str | None,
    pitch: str | None,
    columns: str | None,
    peg_radius: str | None,
    unit: Unit,
) -> list[Named]:
    """Lists the toolkits to try.

    Raises
    ------
    InputError
        For words that mean nothing, lists that do not make a toolkit, and more than a thousand toolkits.
    """
    from workhold.files.toolkit_file import load_toolkit, preset_names
    from workhold.fixels.kinds import ALIASES, KINDS, USUAL, kind_of, table_of

    is_kind = toolkit is not None and toolkit.lower() in (*KINDS, *ALIASES)
    kind, said = kind_of(toolkit.lower()) if toolkit is not None and is_kind else (None, {})
    if toolkit is not None and not is_kind:
        names = [*(names or ()), toolkit]
    lists: list[list[tuple[str, dict[str, Any]]]] = []
    if pitch is not None:
        lists.append(
            [(f"pitch {word}", {PITCH.name: pitch_of(word, unit)}) for word in words_of("--pitch", pitch)]
        )
    if columns is not None:
        numbers = [whole_number("--columns", word) for word in words_of("--columns", columns)]
        lists.append(
            [(f"{number} column{'s' if number != 1 else ''}", {"columns": number}) for number in numbers]
        )
    if peg_radius is not None:
        radii = [(word, length("--peg-radius", word, unit)) for word in words_of("--peg-radius", peg_radius)]
        lists.append([(f"radius {word}", {"peg_radius": radius}) for word, radius in radii])
    if names is None and pitch is not None:
        listed = {"columns": columns, "peg_radius": peg_radius}
        needed = {row.name for row in table_of(kind or USUAL).fields if row.is_required}
        if any(name in needed and name not in said and text is None for name, text in listed.items()):
            raise InputError(
                "a list of pitches alone makes no vise: give --columns and --peg-radius too, or --vise."
            )
        bases = [Named("", kind or USUAL, dict(said))]
    else:
        asked = (
            preset_names()
            if names is None
            else [name for words in names for name in words_of("--vise", words)]
        )
        # A kind picks those of the kind, and makes one sort of toolkit of another.
        bases = [
            Named(one.name, kind or one.kind, {**one.fields, **said}, one.tolerance)
            for one in map(load_toolkit, asked)
            if kind is None or table_of(kind) is table_of(one.kind)
        ]
    toolkits = [base.changed(list(changes)) for base in bases for changes in product(*lists)]
    if len(toolkits) > MOST_TOOLKITS:
        raise InputError(
            f"the lists combine to {len(toolkits)} toolkits: give lists that combine to {MOST_TOOLKITS} or "
            "fewer."
        )
    return toolkits


def words_of(option: str, text: str) -> list[str]:
    """Splits a list into its entries.

    Raises
    ------
    InputError
        When one is missing.
    """
    words = [word.strip() for word in text.split(",")]
    if not all(words):
        raise InputError(f"{option} {text!r} has an empty entry: give a list such as 1,2,4.")
    return words


def pitch_of(word: str, unit: Unit) -> tuple[float, float]:
    """Reads a pitch for both directions, or ``XxY``."""
    x, cross, y = word.partition("x")
    return length("--pitch", x, unit), length("--pitch", y if cross else x, unit)
