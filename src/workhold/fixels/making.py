"""Constructors of toolkits, made from their tables of fields, with the checks of every constructor.

A kind names its fields by annotations alone. The form, default, minimum and limit of each are in its row of
``fixels.fields``. The same checks apply to lattices of holes of every kind.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from functools import partial
from itertools import combinations_with_replacement
from math import inf, isfinite, isnan, nan
from typing import Any, TypeVar

from attrs import NOTHING, evolve, field, frozen
from attrs.converters import optional

from workhold.errors import InputError
from workhold.fixels.carrier import WALL, Carrier, HoleSelection, parse_hole_name
from workhold.fixels.contacts import DIRECTIONS
from workhold.fixels.fields import PITCH
from workhold.fixels.pegs import convert_flat, resolve_flat
from workhold.fixels.support_hardware import HARDWARE, convert_hardware
from workhold.fixels.table import ToolkitField
from workhold.fixels.toolkit import Toolkit, ToolkitChange
from workhold.limits import MOST_BLOCKED, MOST_HOLES, MOST_LENGTHS, convert_real, refuse_long, refuse_strong

__all__ = [
    "suggest_half_pitch",
    "make_lattice_carrier",
    "make_class_from_table",
    "convert_optional_length",
    "convert_pitch",
    "refuse_all_out_of_bounds",
    "refuse_many_holes",
    "complete_and_check",
    "make_wall_carrier",
    "convert_whole_number",
]


def convert_pitch(value: Any) -> tuple[float, float]:
    """Return a pitch as two floats (x, y), from two numbers or from one for both.

    Raises
    ------
    InputError
        For another number of values, and for what is not a number.
    """
    numbers = tuple(value) if isinstance(value, Iterable) and not isinstance(value, str) else (value, value)
    if len(numbers) != 2:
        raise InputError(f"pitch {value} is not one number or two: give one pitch, or X,Y.")
    return convert_real(numbers[0], "pitch"), convert_real(numbers[1], "pitch")


def convert_whole_number(value: Any, name: str = "a count") -> Any:
    """Return a number that is whole as an int; other numbers, and None, are returned unchanged and refused
    later.

    ``name`` names the number in the error's message.

    Raises
    ------
    InputError
        For a value that is not a number.
    """
    return (
        int(value)
        if value is not None and isfinite(convert_real(value, name)) and value == int(value)
        else value
    )


def convert_optional_length(value: float | None, name: str = "a length") -> float:
    """Return a length as a float; None and NaN get placeholders that are handled later.

    None becomes NaN, which is later replaced by the default; NaN becomes inf, which is later refused.
    """
    return nan if value is None else inf if isnan(convert_real(value, name)) else convert_real(value)


def refuse_lattice(
    pitch: tuple[float, float], columns: int | None, rows: int | None, peg_radius: float, noun: str, peg: str
) -> None:
    """Raise InputError for an invalid pitch, count of holes or peg radius, or pegs too thick for neighbouring
    holes.

    ``noun`` and ``peg`` are the words for the carrier and for its pegs in messages.
    """
    for value in pitch:
        if not (isfinite(value) and value > 0):
            raise InputError(
                f"pitch {value} is not a positive length: give the distance between holes in mm."
            )
    for name, count in (("columns", columns), ("rows", rows)):
        if count is not None and (not isinstance(count, int) or count < 1):
            raise InputError(f"{name} {count} is not a positive whole number: a {noun} needs at least one.")
    if not (isfinite(peg_radius) and peg_radius >= 0):
        raise InputError(f"peg radius {peg_radius} is not a length: give 0 or more, in mm.")
    if 2 * peg_radius > min(pitch):
        raise InputError(
            f"{peg}s of radius {peg_radius:g} overlap in neighbouring holes {min(pitch):g} apart: use a "
            f"smaller {peg} or a larger pitch."
        )


def refuse_many_holes(columns: int | None, rows: int | None, noun: str) -> None:
    """Raise InputError for more than ``MOST_HOLES`` holes; a count of None is taken as 1.

    ``noun`` is the word for the carrier in the message.
    """
    holes = (columns or 1) * (rows or 1)
    if holes > MOST_HOLES:
        raise InputError(
            f"a {noun} of {holes:,} holes is beyond the {MOST_HOLES:,} this program takes: give fewer "
            "columns or rows, as many as the part can reach."
        )


Kind = TypeVar("Kind", bound=type[Toolkit])

# The error message for a length, by its smallest value.
BOUNDS = {
    "above 0": "is not a positive length: give it in mm",
    "0": "is not a length: give 0 or more, in mm",
    "any": "is not a length: give it in mm",
}


def make_class_from_table(kind: Kind) -> Kind:
    """Return a toolkit's class made a frozen attrs class, whose attributes have the defaults and converters
    of its table.

    Raises
    ------
    KeyError
        For an annotation of the class without a field of this name in its table.
    """
    rows = {row.name: row for row in kind.table.fields}
    names = [name for name, form in kind.__annotations__.items() if not str(form).startswith("ClassVar")]
    inherits = kind.__base__ is not Toolkit
    these = {name: make_field_attribute(rows[name], inherits=inherits) for name in names}
    for name in () if inherits else HARDWARE:
        these[name] = field(default=None, converter=partial(convert_hardware, name), kw_only=True)
    if not inherits:
        # What is known of the pegs makes no other toolkit.
        these["tolerance"] = field(default=None, kw_only=True, eq=False, repr=False)
    return frozen(these=these)(kind)


def make_field_attribute(row: ToolkitField, *, inherits: bool) -> Any:
    """Return the attrs attribute of a field.

    It is keyword-only for a class that inherits fields (``inherits``), and for fields that files leave out.
    """
    by_name = row.is_silent or inherits
    default = NOTHING if row.is_required else row.default
    return field(default=default, converter=choose_converter(row), kw_only=by_name)


def choose_converter(row: ToolkitField) -> Callable[[Any], Any]:
    """Return the function that converts values of a field, by the field's form.

    Some converters let invalid values pass, which are refused when the toolkit is complete.
    """
    match row.form:
        case "length" if row.follows:
            return partial(convert_optional_length, name=row.words)
        case "length":
            number = partial(convert_real, name=row.words)
            return number if row.is_required or row.default is not None else optional(number)
        case "count":
            return partial(convert_whole_number, name=row.words)
        case "force":
            number = partial(convert_real, name=row.words)
            return number if row.is_required else optional(number)
        case "choice":
            return row.check_value
        case "holes":
            return partial(convert_holes, carriers=row.carriers, noun=row.carrier_noun)
        case "pitch" if row.default is None:
            both: Callable[[Any], Any] = optional(convert_pitch)
            return both
        case form:
            return CONVERTERS[form]


def convert_holes(
    holes: Iterable[HoleSelection | str], *, carriers: tuple[str, ...], noun: str
) -> tuple[HoleSelection, ...]:
    """Return holes as a tuple of ``HoleSelection``; names such as "L-B3" are parsed.

    ``carriers`` are the names of the carriers that may have the holes, ``noun`` the word for a carrier in
    messages.
    """
    return tuple(parse_hole_name(one, carriers, noun) if isinstance(one, str) else one for one in holes)


def convert_two_lengths(value: Iterable[float] | None, *, wrong: str) -> tuple[float, float] | None:
    """Return two lengths as floats; None for None.

    ``wrong`` is the message of the error, in which "{value}" stands for the value.

    Raises
    ------
    InputError
        For anything but two numbers.
    """
    if value is None:
        return None
    numbers = tuple(value) if isinstance(value, Iterable) else (value,)
    if len(numbers) != 2:
        raise InputError(wrong.format(value=value))
    return convert_real(numbers[0]), convert_real(numbers[1])


def convert_directions(value: str | Iterable[Any] | None) -> tuple[Any, ...]:
    """Return the directions in which a clamp may push, or pairs of directions, in the order of
    ``DIRECTIONS``.

    None gives an empty tuple. A single name counts as a list of one.

    Raises
    ------
    InputError
        For unknown directions, an empty list, and values other than names or pairs of names.
    """
    if value is None:
        return ()
    names = list(value) if isinstance(value, Iterable) and not isinstance(value, str) else [value]
    if not names:
        raise InputError(f"the clamp has no direction: choose among {', '.join(DIRECTIONS)}.")
    if any(isinstance(name, str) for name in names):
        for name in names:
            refuse_direction(name)
        return tuple(name for name in DIRECTIONS if name in names)
    pairs = [tuple(one) if isinstance(one, Iterable) else (one,) for one in names]
    for two in pairs:
        if len(two) != 2:
            raise InputError(
                f"{two} is not a pair of directions: give two for the two clamps, such as ('-x', '-y')."
            )
        for name in two:
            refuse_direction(name)
    asked = [set(two) for two in pairs]
    return tuple(two for two in combinations_with_replacement(DIRECTIONS, 2) if set(two) in asked)


def refuse_direction(name: Any) -> None:
    """Raise InputError for anything that is not one of ``DIRECTIONS``."""
    if not isinstance(name, str) or name not in DIRECTIONS:
        raise InputError(
            f"a clamp cannot move in the direction {name!r}: choose among {', '.join(DIRECTIONS)}."
        )


def convert_lengths(value: float | Iterable[float] | None) -> tuple[float, ...]:
    """Return lengths as floats in ascending order, each once; one number gives one length, None an empty
    tuple.
    """
    given = () if value is None else value if isinstance(value, Iterable) else (value,)
    return tuple(sorted({convert_real(one, "a length") for one in given}))


CONVERTERS: dict[str, Callable[[Any], Any]] = {
    "pitch": convert_pitch,
    "span": partial(
        convert_two_lengths,
        wrong="travel {value} is not two lengths: give the least and the most stroke of the clamp, in mm.",
    ),
    "flat": convert_flat,
    "heights": partial(
        convert_two_lengths,
        wrong="heights {value} are not two lengths: give the lower and the upper end of the part that "
        "touches, in mm.",
    ),
    "directions": convert_directions,
    "lengths": convert_lengths,
}


def complete_and_check(toolkit: Any, *, noun: str, peg: str) -> None:
    """Complete a new toolkit in place with the defaults that follow from other fields, and check all its
    values.

    ``noun`` and ``peg`` are the words for the carrier and for its pegs in messages.

    Raises
    ------
    InputError
        For invalid values.
    """
    rows = toolkit.table.fields
    for row in rows:
        value = getattr(toolkit, row.name)
        if row.form == "length" and row.follows and isnan(value):
            object.__setattr__(toolkit, row.name, toolkit.find_followed_length(row))
        if row.form == "count" and row.allowed and value not in row.allowed:
            few = " or ".join(map(str, row.allowed))
            raise InputError(f"{row.words} {value} cannot be: a {toolkit.noun} has {few}.")
    refuse_lattice(toolkit.pitch, toolkit.columns, toolkit.rows, toolkit.peg_radius, noun, peg)
    refuse_all_out_of_bounds(toolkit)
    refuse_many_holes(toolkit.columns, toolkit.rows, noun)
    for row in rows:
        if row.form == "holes":
            refuse_blocked(toolkit, row)


def refuse_all_out_of_bounds(toolkit: Any) -> None:
    """Raise InputError where any field has a value below its minimum or too large to compute with.

    A flat of pegs is completed in place with its half width.
    """
    for row in toolkit.table.fields:
        refuse_out_of_bounds(toolkit, row)


def refuse_out_of_bounds(toolkit: Any, row: ToolkitField) -> None:
    """Raise InputError where the field ``row`` has a value below its minimum or too large to compute with.

    A flat of pegs is completed in place with its half width.
    """
    value = getattr(toolkit, row.name)
    match row.form:
        case "length" if value is not None:
            is_low = value <= 0 if row.least == "above 0" else value < 0 and row.least == "0"
            if not isfinite(value) or is_low:
                raise InputError(f"{row.words} {value} {BOUNDS[row.least]}.")
            least = getattr(toolkit, row.at_least) if row.at_least else -inf
            if value < least:
                raise InputError(row.below.format(value=value, least=least))
            refuse_long(row.words, value)
        case "force" if value is not None:
            if not 0 < value < inf:
                raise InputError(f"{row.words} {value} is not a force: give it in N.")
            refuse_strong(row.words, value)
        case "lengths":
            if any(not 0 <= one < inf for one in value):
                raise InputError(
                    f"{row.words} {', '.join(map(str, value))} are not lengths: give 0 or more, in mm."
                )
            if len(value) > MOST_LENGTHS:
                raise InputError(f"{len(value)} {row.words} are more than {MOST_LENGTHS}: name those to try.")
            refuse_long(row.words, max(value, default=0.0))
        case "span" if value is not None:
            if not 0 <= value[0] <= value[1] < inf:
                raise InputError(
                    f"{row.words} {value[0]:g} to {value[1]:g} is not possible: give the least and the most "
                    "from the clamp's hole to its tip, in mm."
                )
            refuse_long(row.words, value[1])
        case "heights" if value is not None:
            if not 0 <= value[0] < value[1] < inf:
                raise InputError(
                    f"{row.words} {value[0]:g} to {value[1]:g} are not possible: give the lower end, 0 or "
                    "more, and then the upper one, in mm above the plane on which the part lies."
                )
            refuse_long(row.words, value[1])
        case "pitch" if value is not None:
            refuse_long(row.words, max(value))
        case "flat":
            object.__setattr__(toolkit, row.name, resolve_flat(value, toolkit.peg_radius))


def refuse_blocked(toolkit: Any, row: ToolkitField) -> None:
    """Raise InputError for blocked holes that do not exist or are too many, or where every column of a
    carrier is blocked.
    """
    blocked, columns, rows, noun = getattr(toolkit, row.name), toolkit.columns, toolkit.rows, row.carrier_noun
    if len(blocked) > MOST_BLOCKED:
        raise InputError(
            f"{len(blocked):,} blocked holes are more than the {MOST_BLOCKED:,} this program takes: block "
            "whole columns, such as L-B."
        )
    for holes in blocked:
        if holes.column >= columns:
            raise InputError(f"hole {holes.name} is blocked, but each {noun} has only {columns} columns.")
        if rows is not None and holes.row is not None and holes.row >= rows:
            raise InputError(f"hole {holes.name} is blocked, but each {noun} has only {rows} rows.")
    for carrier in row.carriers:
        if (
            len({holes.column for holes in blocked if holes.carrier == carrier and holes.row is None})
            == columns
        ):
            raise InputError(f"every column of the {carrier} {noun} is blocked: leave at least one.")


def make_lattice_carrier(toolkit: Any, name: str, **others: Any) -> Carrier:
    """Return a carrier with a toolkit's pitch, columns, rows, peg radius, flat and blocked holes.

    ``others`` are attributes of the carrier that are added or set to other values.
    """
    size = toolkit.pitch, toolkit.columns, toolkit.rows, toolkit.peg_radius, toolkit.peg_radius
    rows = (row for row in toolkit.table.fields if row.form == "holes")
    blocked = tuple(one for row in rows for one in getattr(toolkit, row.name) if one.carrier == name)
    return evolve(Carrier(name, *size, flat=getattr(toolkit, "flat", None), blocked=blocked), **others)


def make_wall_carrier(toolkit: Any, noun: str, width: float | None = None) -> Carrier:
    """Return a toolkit's straight wall, which runs along x at y = 0.

    ``noun`` is the word for it, such as "fence"; ``width`` is in mm, None for an endless wall.
    """
    size, heights = (toolkit.pitch, toolkit.columns, toolkit.rows), toolkit.wall_heights
    return Carrier(WALL, *size, 0.0, 0.0, noun=noun, peg="end", is_wall=True, heights=heights, width=width)


def suggest_half_pitch(toolkit: Any) -> Iterator[ToolkitChange]:
    """Yield one change of a toolkit to half the pitch, if the pegs are thin enough for it.

    The numbers of columns and rows grow so that all old holes remain.
    """
    if min(toolkit.pitch) >= 4 * toolkit.peg_radius:
        counts = {name: getattr(toolkit, name) for name in ("columns", "rows")}
        more = {name: 2 * count - 1 for name, count in counts.items() if count is not None}
        yield ToolkitChange(
            "with half the pitch", {PITCH.name: tuple(one / 2 for one in toolkit.pitch), **more}
        )
