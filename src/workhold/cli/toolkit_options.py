"""Options that describe a toolkit, or several toolkits for commands that try many.

Several toolkits are given by names, files and kinds, and by lists of values of their figures. The field table
says which figures there are and how the words typed for each are read.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import product
from math import prod
from typing import TYPE_CHECKING, Any

from attrs import evolve, field, frozen

from workhold.cli.commands import make_option
from workhold.cli.search_options import add_dowel_fit
from workhold.cli.values import (
    read_length,
    read_optional_force,
    read_optional_length,
    read_pitches,
    read_two_lengths,
    read_whole_number,
)
from workhold.errors import InputError
from workhold.fixels.fields import COLUMNS, FLAT, MIN_GAP, NAMES, OPTIONS, PEG_RADIUS, PITCH, ROWS, TRAVEL
from workhold.fixels.table import TOOLKIT_SECTION, FieldTable, Form, ToolkitField
from workhold.units import Unit

if TYPE_CHECKING:
    from workhold.fixels.toolkit import Toolkit
    from workhold.model.query import Query
    from workhold.model.requirements import Tolerance
    from workhold.model.workpiece import Workpiece

__all__ = [
    "READERS",
    "TOOLKIT",
    "ToolkitListOptions",
    "NamedToolkit",
    "ToolkitOptions",
    "collect_carrier_heights",
    "find_peg_diameter",
    "make_query",
    "list_toolkits_to_try",
    "split_words",
]

TOOLKIT = make_option(
    TOOLKIT_SECTION,
    "NAME|FILE",
    f"{' '.join(f'{name}: {words}.' for name, words in NAMES.items())} Or a name of workhold toolkits, a TOML "
    "file, or a vise of FreeCAD (.FCStd). vise if not given.",
    "--toolkit",
)
MIN_OPENING = make_option(
    TOOLKIT_SECTION,
    "LENGTH",
    "Smallest distance from the left jaw's last column to the right jaw's first, if larger.",
)


def make_toolkit_options() -> dict[str, Any]:
    """Return the attrs attributes of :class:`ToolkitOptions` by name, in the order of the help."""
    out = {
        "vise": make_option(
            TOOLKIT_SECTION, "NAME|FILE", "The same as --toolkit; the options below change its values."
        ),
        "toolkit": TOOLKIT,
    }
    for row in OPTIONS:
        out[row.name] = make_option(row.section, row.metavar, row.help.format(option=row.option), row.option)
        if row is MIN_GAP:
            out["min_opening"] = MIN_OPENING
    words: Any = str | None
    several: Any = list[str] | None
    lists = {row.name for row in OPTIONS if row.form == "holes"}
    return {
        name: field(default=given, type=several if name in lists else words) for name, given in out.items()
    }


@frozen(these=make_toolkit_options())
class ToolkitOptions:
    """The options of the toolkit, as typed; None for those not given."""

    if TYPE_CHECKING:
        vise: str | None
        toolkit: str | None
        min_opening: str | None

    def read_given_fields(self, unit: Unit) -> dict[str, Any]:
        """Return keyword arguments of a toolkit from the options that were given, lengths in mm."""
        return {
            row.name: READERS[row.form](row.option, words, unit)
            for row in OPTIONS
            if (words := getattr(self, row.name)) not in (None, [])
        }

    def refuse_others(self, kind: type[Toolkit]) -> None:
        """Raise InputError for an option given that this kind of toolkit does not have."""
        from workhold.fixels.kinds import find_owner

        known = {row.name for row in kind.table.fields}
        for row in OPTIONS:
            typed = [row.option] if getattr(self, row.name) else []
            if row is MIN_GAP and self.min_opening is not None:
                typed.append("--min-opening")
            if typed and row.name not in known:
                raise InputError(
                    f"{typed[0]} is of {find_owner(row).noun}s: a {kind.noun} has no {row.belongs_to}; leave "
                    "it out, or choose another --toolkit."
                )

    def read_toolkit(self, unit: Unit) -> tuple[Toolkit, Tolerance | None]:
        """Return the toolkit, and the tolerance of a named one; the tolerance is None for a kind.

        Raises
        ------
        InputError
            For words that cannot be read, options that are missing, and values that make no toolkit.
        """
        fields, tolerance = self.read_given_fields(unit), None
        opening = read_optional_length("--min-opening", self.min_opening, unit)
        from workhold.fixels.kinds import ALIASES, KINDS, USUAL, make_toolkit, resolve_kind

        kind, said = resolve_kind(USUAL)
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
            if fields.get("peg_radius", said.get("peg_radius")) != said.get("peg_radius"):
                tolerance = evolve(tolerance, fit=None)
        for word in words:
            if word not in named:
                kind, more = resolve_kind(word.lower())
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
        vise = make_toolkit(kind, fields)
        travel = vise.moving.travel
        if opening is None or travel is None:
            return vise, tolerance
        if travel.most is not None and opening > travel.most:
            most = unit.format_short_length(travel.most)
            raise InputError(
                f"the smallest opening {unit.format_short_length(opening)} {unit.abbreviation} is above the largest, "
                f"{most} {unit.abbreviation}: no opening is left."
            )
        if opening > travel.least:
            # The jaws never stand farther apart than the pegs, so the one limit says it all.
            vise = make_toolkit(kind, fields | {MIN_GAP.name: opening})
        return vise, tolerance


def read_lengths(option_name: str, text: str, unit: Unit) -> tuple[float, ...]:
    """Return lengths in mm from text with commas between them."""
    return tuple(read_length(option_name, word, unit) for word in text.split(","))


def read_length_range(option_name: str, text: str, unit: Unit) -> tuple[float, ...]:
    """Return (least, greatest) length in mm, from two lengths with a comma between them."""
    remedy = "two lengths: give the least and the most, such as 10,35."
    return read_two_lengths(option_name, text, unit, remedy)


def read_directions(option_name: str, text: str) -> list[str | tuple[str, ...]]:
    """Return directions from text such as ``-x,-y``, or pairs of directions from ``-x:-y,-x:+y``.

    Raises InputError for a mixture of both.
    """
    words = [word.strip() for word in text.split(",")]
    if len({":" in word for word in words}) == 2:
        raise InputError(
            f"{option_name} {text!r} has pairs and single directions: give one kind, such as -x:-y,-x:+y."
        )
    return [tuple(name.strip() for name in word.split(":")) if ":" in word else word for word in words]


# How the words of an option are read, by the form of its field.
READERS: Mapping[str, Callable[[str, Any, Unit], Any]] = {
    "count": lambda name, text, unit: read_whole_number(name, text),
    "length": read_length,
    "pitch": read_pitches,
    "span": read_length_range,
    "flat": read_lengths,
    "heights": read_length_range,
    "holes": lambda name, texts, unit: [hole for text in texts for hole in text.split(",")],
    "directions": lambda name, text, unit: read_directions(name, text),
    "lengths": read_lengths,
    "choice": lambda name, text, unit: text,
    "force": lambda name, text, unit: read_optional_force(name, text),
}


# How the entries of a list look, by the form of a field. What is not a number is not varied.
ENTRIES: dict[Form, str] = {
    PITCH.form: "such as 8,10,12.5 or 10x12.5.",
    COLUMNS.form: "such as 1,2,4.",
    PEG_RADIUS.form: "such as 2.5,3.",
    TRAVEL.form: "the least and the most of each with a colon, such as 10:35,15:50.",
    FLAT.form: "each with or without half its width after a colon, such as 2.5,2.5:1.5.",
}
LISTED = tuple(row for row in OPTIONS if row.form in ENTRIES)
SWEEP = "Toolkits to try"
PLURALS = {
    PITCH.name: "Pitches",
    COLUMNS.name: "Numbers of columns",
    ROWS.name: "Numbers of rows",
    PEG_RADIUS.name: "Peg radii",
}


def make_list_options() -> dict[str, Any]:
    """Return the attrs attributes of :class:`ToolkitListOptions` by name, in the order of the help."""
    words: Any = str | None
    made = {}
    for row in LISTED:
        says = ENTRIES[row.form] if not row.allowed else f"such as {','.join(map(str, row.allowed))}."
        plural = PLURALS.get(row.name, row.labels[0].label)
        made[row.name] = field(
            default=make_option(SWEEP, "LIST", f"{plural}, {says}", row.option), type=words, kw_only=True
        )
    return made


@frozen(these=make_list_options())
class ToolkitListOptions:
    """Lists of figures of toolkits, as typed; None for those not given."""

    def list_given_fields(self) -> list[tuple[ToolkitField, str]]:
        """Return the fields that are varied, each with its list as typed."""
        typed = ((row, getattr(self, row.name)) for row in LISTED)
        return [(row, text) for row, text in typed if isinstance(text, str)]

    @property
    def has_pitches(self) -> bool:
        """Whether pitches are varied; only then can lists make toolkits without a named one."""
        return any(row is PITCH for row, _ in self.list_given_fields())


# More toolkits than this are more likely a slip than a wish.
MOST_TOOLKITS = 1000


@frozen
class NamedToolkit:
    """A toolkit to try: its name, its kind and keyword arguments, and its tolerance if it has one."""

    name: str
    kind: str
    fields: dict[str, Any]
    tolerance: Tolerance | None = None

    def apply_changes(self, changes: list[tuple[str, dict[str, Any]]]) -> NamedToolkit:
        """Return a toolkit with fields changed and the words of each change added to its name."""
        name = ", ".join(filter(None, (self.name, *(words for words, _ in changes))))
        fields = {key: value for _, change in changes for key, value in change.items()}
        return NamedToolkit(name, self.kind, self.fields | fields, self.tolerance)


def make_query(workpiece: Workpiece, named: NamedToolkit, asked: dict[str, Any]) -> Query | InputError:
    """Return the query for a toolkit, or the error (not raised) that says why the toolkit cannot be made."""
    from workhold.fixels.kinds import make_toolkit
    from workhold.model.query import Query

    try:
        return Query(
            workpiece,
            make_toolkit(named.kind, named.fields),
            **asked | {"tolerance": add_dowel_fit(asked["tolerance"], named.tolerance)},
        )
    except InputError as error:
        return error


def collect_carrier_heights(toolkits: Sequence[NamedToolkit]) -> dict[str, tuple[float, ...]]:
    """Return by role all heights (low, high) in mm of carriers, so that one reading of a part serves all
    toolkits.

    Toolkits that cannot be made are left out. Raises InputError where two toolkits differ in the heights of a
    role.
    """
    from workhold.fixels.kinds import make_toolkit

    found: dict[str, tuple[float, ...]] = {}
    for one in toolkits:
        try:
            heights = make_toolkit(one.kind, one.fields).heights
        except InputError:
            # Why there is no such toolkit stands in its row.
            continue
        for role, ends in heights.items():
            if found.setdefault(role, ends) != ends:
                raise InputError(
                    f"the toolkits have two heights of the {role}, and a part is read once for all of them: "
                    "try those of one height at a time."
                )
    return found


def find_peg_diameter(named: NamedToolkit) -> float | None:
    """Return the diameter of a toolkit's pegs in mm; None where the toolkit cannot be made."""
    from workhold.fixels.kinds import make_toolkit

    try:
        return make_toolkit(named.kind, named.fields).peg_diameter
    except InputError:
        return None


def list_toolkits_to_try(
    names: list[str] | None, toolkit: str | None, varied: ToolkitListOptions, unit: Unit
) -> list[NamedToolkit]:
    """Return the toolkits to try: each named one, or kind, with each combination of the lists' figures.

    Parameters
    ----------
    names : names and files, with commas between them; None for all presets that have the varied fields.
    toolkit : one more name or file, or a kind; None for none.
    varied : lists of figures, which are combined with each other.
    unit : of lengths typed without one.

    Raises
    ------
    InputError
        For lists that do not make a toolkit, and more than :data:`MOST_TOOLKITS` toolkits.
    """
    from workhold.fixels.kinds import ALIASES, KINDS, USUAL, find_table, resolve_kind

    is_kind = toolkit is not None and toolkit.lower() in (*KINDS, *ALIASES)
    kind, said = resolve_kind(toolkit.lower()) if toolkit is not None and is_kind else (None, {})
    if toolkit is not None and not is_kind:
        names = [*(names or ()), toolkit]
    given = varied.list_given_fields()
    lists = [
        [
            (make_entry_name(row, word), {row.name: parse_list_entry(row, word, unit)})
            for word in split_words(row.option, text)
        ]
        for row, text in given
    ]
    if kind is not None:
        refuse_unknown_fields(find_table(kind), given)
    if names is None and varied.has_pitches:
        refuse_missing_fields(find_table(kind or USUAL), {*said, *(row.name for row, _ in given)}, given)
        refuse_unknown_fields(find_table(kind or USUAL), given)
        bases = [NamedToolkit("", kind or USUAL, dict(said))]
    else:
        bases = load_named_toolkits(names, kind, said, given)
    count = len(bases) * prod(len(entries) for entries in lists)
    if count > MOST_TOOLKITS:
        raise InputError(
            f"the lists combine to {count} toolkits: give lists that combine to {MOST_TOOLKITS} or fewer."
        )
    return [base.apply_changes(list(changes)) for base in bases for changes in product(*lists)]


def load_named_toolkits(
    names: list[str] | None, kind: str | None, said: Mapping[str, Any], given: list[tuple[ToolkitField, str]]
) -> list[NamedToolkit]:
    """Return the named toolkits, or for None all presets that have every varied field, each with the fields
    ``said`` set.

    With ``kind`` given, all toolkits are of this kind, and only its fields are used. Raises InputError for
    fields that a named toolkit does not have, and where no toolkit is left.
    """
    from workhold.files.toolkit_file import list_preset_names, load_toolkit
    from workhold.fixels.kinds import find_table

    if names is None:
        loaded = [
            one
            for one in map(load_toolkit, list_preset_names())
            if not list_unknown_fields(find_table(one.kind), given)
        ]
    else:
        loaded = [load_toolkit(name) for words in names for name in split_words("--vise", words)]
        for one in loaded:
            refuse_unknown_fields(find_table(one.kind), given)
    # A kind picks those of the kind, and makes one sort of toolkit of another.
    bases = [
        NamedToolkit(one.name, kind or one.kind, {**one.fields, **said}, one.tolerance)
        for one in loaded
        if kind is None or find_table(kind) is find_table(one.kind)
    ]
    if not bases:
        which = f"that is a {find_table(kind).noun}" if kind else "with all of the fields to vary"
        raise InputError(
            f"there is no toolkit {which}: name others with --toolkit (see workhold toolkits), or give "
            f"{PITCH.option} and all that such a toolkit needs."
        )
    return bases


def list_unknown_fields(table: FieldTable, given: list[tuple[ToolkitField, str]]) -> list[ToolkitField]:
    """Return the varied fields that a kind's table lacks."""
    known = {row.name for row in table.fields}
    return [row for row, _ in given if row.name not in known]


def refuse_unknown_fields(table: FieldTable, given: list[tuple[ToolkitField, str]]) -> None:
    """Raise InputError for a varied field that a kind's table lacks."""
    from workhold.fixels.kinds import find_owner

    for row in list_unknown_fields(table, given):
        raise InputError(
            f"{row.option} is of {find_owner(row).noun}s: a {table.noun} has no {row.belongs_to}; leave it "
            "out, or choose another toolkit."
        )


def refuse_missing_fields(table: FieldTable, known: set[str], given: list[tuple[ToolkitField, str]]) -> None:
    """Raise InputError where a required field of a toolkit is not among the known ones."""
    missing = [row.option for row in table.fields if row.is_required and row.name not in known]
    if missing:
        alone = "a list of pitches alone makes" if len(given) == 1 else "these lists alone make"
        raise InputError(
            f"{alone} no {table.noun}: give {' and '.join(missing)} too, or name toolkits with --toolkit."
        )


def parse_list_entry(row: ToolkitField, word: str, unit: Unit) -> Any:
    """Return the value of one entry of a field's list, lengths in mm."""
    if row.form == PITCH.form:
        return read_pitch(row.option, word, unit)
    if row.form == TRAVEL.form and word.count(":") != 1:
        raise InputError(
            f"{row.option} {word!r} is not two lengths: give the least and the most with a colon, such as "
            "10:35."
        )
    value = READERS[row.form](row.option, word.replace(":", ","), unit)
    if row.allowed and value not in row.allowed:
        raise InputError(f"{row.option} {word} is not known: give {' or '.join(map(str, row.allowed))}.")
    return value


def make_entry_name(row: ToolkitField, word: str) -> str:
    """Return the words that an entry of a field's list adds to the name of a toolkit.

    >>> make_entry_name(COLUMNS, "1"), make_entry_name(PEG_RADIUS, "2.5"), make_entry_name(PITCH, "8")
    ('1 column', 'radius 2.5', 'pitch 8')
    """
    if row.form == "count":
        number = word.lstrip("0") or word
        return f"{number} {row.words.removesuffix('s') if number == '1' else row.words}"
    return f"{'radius' if row is PEG_RADIUS else row.words} {word}"


def split_words(option: str, text: str) -> list[str]:
    """Return the words between commas, stripped; raise InputError where one is empty."""
    words = [word.strip() for word in text.split(",")]
    if not all(words):
        raise InputError(f"{option} {text!r} has an empty entry: give a list such as 1,2,4.")
    return words


def read_pitch(option_name: str, word: str, unit: Unit) -> tuple[float, float]:
    """Return a pitch (x, y) in mm from one length for both directions, or from ``XxY``."""
    x, cross, y = word.partition("x")
    return read_length(option_name, x, unit), read_length(option_name, y if cross else x, unit)
