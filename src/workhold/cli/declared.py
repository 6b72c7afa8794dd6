"""Options made from declared fields: their place in a command's signature, and how the words typed are
read."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from datetime import date
from math import isfinite
from typing import TYPE_CHECKING, Any

from attrs import field

from workhold.asking.declaring import Declaration, Form
from workhold.cli.commands import make_flag, make_option
from workhold.cli.values import (
    read_choice,
    read_length,
    read_length_from_zero,
    read_number,
    read_optional_count,
    read_optional_force,
    read_optional_positive_length,
    read_positive_number,
    read_quantity,
    read_three_lengths,
    read_two_lengths,
    read_whole_number,
)
from workhold.errors import InputError
from workhold.units import Unit

if TYPE_CHECKING:
    from workhold.model.requirements import Zone

__all__ = [
    "make_flag_attribute",
    "make_word_attribute",
    "read_separated_lengths",
    "make_field_option",
    "make_option_attributes",
    "read_words",
    "read_zone",
    "make_list_attribute",
]

# Forms of which an option may be given more than once.
SEVERAL: frozenset[Form] = frozenset({"faces", "zones", "angles", "names", "rings"})


def make_field_option(row: Declaration) -> Any:
    """Return the Typer option of a declared field, to stand as the default of a parameter."""
    words = row.typed or row.help
    if row.form == "flag":
        return make_flag(row.section, words, row.option)
    return make_option(row.section, row.metavar, words, row.option, default=format_default(row))


def format_default(row: Declaration) -> str | None:
    """Return a field's default as it would be typed; None where it has none or its help text describes it."""
    if row.typed_default:
        return row.typed_default
    if row.default is None or row.form in SEVERAL:
        return None
    return f"{row.default:g}" if isinstance(row.default, float) else str(row.default)


def make_word_attribute(option: Any) -> Any:
    """Return the attrs attribute of an option with a value that belongs to no declared field."""
    kind: Any = str | None
    return field(default=option, type=kind)


def make_flag_attribute(option: Any) -> Any:
    """Return the attrs attribute of an option without a value that belongs to no declared field."""
    return field(default=option, type=bool)


def make_list_attribute(option: Any) -> Any:
    """Return the attrs attribute of an option that may be repeated and belongs to no declared field."""
    kind: Any = list[str] | None
    return field(default=option, type=kind)


def make_option_attributes(rows: Iterable[Declaration], **beside: Any) -> dict[str, Any]:
    """Return attrs attributes by name for a group of options: one for each declared field, and those in
    ``beside``.

    Parameters
    ----------
    beside : further options by name. A value made by :func:`make_word_attribute` or the like is put last;
        under a field's name, a mapping of such attributes is put before that field.
    """
    out: dict[str, Any] = {}
    for row in rows:
        out |= beside.pop(row.name, {})
        kind: Any = bool if row.form == "flag" else list[str] | None if row.form in SEVERAL else str | None
        out[row.argument] = field(default=make_field_option(row), type=kind)
    return out | beside


def read_declared_length(row: Declaration, text: str, unit: Unit) -> float | None:
    """Return the length in mm typed for a field; raise InputError where it is less than the field allows."""
    match row.least:
        case "above 0":
            return read_optional_positive_length(row.option, text, unit)
        case "0":
            return read_length_from_zero(row.option, text, unit)
    return read_length(row.option, text, unit)


def read_rings(row: Declaration, texts: list[str], unit: Unit) -> list[tuple[float, ...]]:
    """Return rings (x, y, least, most) in mm from words such as ``0,0,20,60``."""
    return [read_separated_lengths(row.option, text, ",", 4, unit) for text in texts]


def read_separated_lengths(
    option_name: str, text: str, mark: str, count: int, unit: Unit
) -> tuple[float, ...]:
    """Return ``count`` lengths in mm from text in which they are separated by ``mark``.

    Raises InputError for any other number of lengths.
    """
    words = text.split(mark)
    if len(words) != count:
        raise InputError(
            f"{option_name} {text!r} cannot be used: give {count} lengths with {mark!r} between them."
        )
    return tuple(read_length(option_name, word, unit) for word in words)


def read_day(row: Declaration, text: str, unit: Unit) -> date:
    """Return the date written as YYYY-MM-DD; raise InputError for anything else."""
    try:
        return date.fromisoformat(text)
    except ValueError:
        raise InputError(
            f"{row.option} {text!r} is not a date: give it as YYYY-MM-DD, such as 2026-03-31."
        ) from None


def read_faces(row: Declaration, texts: list[str], unit: Unit) -> tuple[int, ...]:
    """Return numbers of faces from words such as ``1,4``, in the order typed."""
    return tuple(read_whole_number(row.option, word) for text in texts for word in text.split(","))


def read_angles(row: Declaration, texts: list[str], unit: Unit) -> tuple[tuple[float, float], ...]:
    """Return ranges of angles in degrees from words such as ``-10..10``;
    a single number is a range of that angle alone.
    """
    return tuple(read_angle(row.option, text) for text in texts)


def read_angle(option_name: str, text: str) -> tuple[float, float]:
    """Return the range of angles (least, most) in degrees of one word; raise InputError for anything else."""
    low, dots, high = text.partition("..")
    least, most = (read_number(word.strip()) for word in ((low, high) if dots else (low, low)))
    if not (isfinite(least) and isfinite(most)):
        raise InputError(
            f"{option_name} {text!r} is not a range of angles: give it in degrees, such as -10..10."
        )
    return least, most


def read_zone(option_name: str, text: str, unit: Unit) -> Zone:
    """Return a keep-out zone from words such as ``circle=10,5,8``
    or ``polygon=0,0;10,0;10,8``, lengths in ``unit``.
    """
    from workhold.model.requirements import circle_zone, polygon_zone

    kind, _, rest = text.partition("=")
    points = [
        [read_length(option_name, word, unit) for word in words.split(",")]
        for words in rest.split(";")
        if words.strip()
    ]
    kind = kind.strip().lower()
    if kind == "circle" and len(points) == 1 and len(points[0]) == 3:
        return circle_zone(*points[0])
    if kind == "polygon" and all(len(point) == 2 for point in points):
        return polygon_zone(points)
    raise InputError(f"{option_name} {text!r} is not a zone: give circle=X,Y,RADIUS or polygon=X,Y;X,Y;X,Y.")


POWER_WORDS = re.compile(r"\s*(?P<number>.*?)\s*(?P<unit>kW|hp)?\s*", re.IGNORECASE | re.DOTALL)
# kW in a unit; 550 foot-pounds a second.
POWERS = {"kw": 1.0, "hp": 0.7456998715822702}


def read_power(option_name: str, text: str) -> float:
    """Return a power in kW from a number in kW, or with the unit kW or hp.

    Examples
    --------
    >>> read_power("--power", "2.2"), round(read_power("--power", "3 hp"), 3)
    (2.2, 2.237)
    """
    remedy = "a power above 0: give it in kW, such as 2.2, or as 3hp."
    return read_quantity(option_name, text, POWER_WORDS, POWERS, "kw", remedy)


def read_force(row: Declaration, text: str, unit: Unit) -> float | None:
    """Return a force in N; 0.0 is allowed where the field says so, else it must be positive."""
    return 0.0 if row.least == "0" and text.strip() == "0" else read_optional_force(row.option, text)


# How the words of an option are read, by the form of its field; words of other forms stay as they are.
def read_coefficients(option_name: str, text: str) -> dict[str, float]:
    """Return positive numbers by name from words such as ``jaw=0.15,plate=0.1``.

    Examples
    --------
    >>> read_coefficients("--friction", "jaw=0.15,plate=0.1")
    {'jaw': 0.15, 'plate': 0.1}
    """
    out = {}
    for word in text.split(","):
        name, equals, value = word.partition("=")
        if not equals:
            raise InputError(
                f"{option_name} {text!r} names no coefficients: give them as jaw=0.15,plate=0.15."
            )
        out[name.strip().lower()] = read_positive_number(option_name, value)
    return out


def read_margins(option_name: str, text: str, unit: Unit) -> dict[str, float]:
    """Return lengths in mm by name from words such as ``side=3,top=2,bottom=5``.

    Examples
    --------
    >>> from workhold.units import MILLIMETRE
    >>> read_margins("--raw", "side=3,top=0,bottom=0.2in", MILLIMETRE)
    {'side': 3.0, 'top': 0.0, 'bottom': 5.08}
    """
    out = dict[str, float]()
    for word in text.split(","):
        name, equals, value = word.partition("=")
        key = name.strip().lower()
        if not equals or key in out:
            raise InputError(
                f"{option_name} {text!r} is not a raw block: say each once, as in side=3,top=2,bottom=5."
            )
        out[key] = read_length_from_zero(option_name, value, unit)
    return out


READERS: Mapping[Form, Callable[[Declaration, Any, Unit], Any]] = {
    "count": lambda row, text, unit: read_optional_count(row.option, text),
    "length": read_declared_length,
    "force": read_force,
    "power": lambda row, text, unit: read_power(row.option, text),
    "number": lambda row, text, unit: read_positive_number(row.option, text),
    "choice": lambda row, text, unit: read_choice(row.option, text, row.choices),
    "place": lambda row, text, unit: read_two_lengths(
        row.option, text, unit, "a position: give it as X,Y, such as -312.5,-88."
    ),
    "point": lambda row, text, unit: read_three_lengths(
        row.option, text, unit, "a place: give three lengths, such as 0,0,50."
    ),
    "day": read_day,
    "rings": read_rings,
    "faces": read_faces,
    "zones": lambda row, texts, unit: tuple(read_zone(row.option, text, unit) for text in texts),
    "angles": read_angles,
    "margins": lambda row, text, unit: read_margins(row.option, text, unit),
    "coefficients": lambda row, text, unit: read_coefficients(row.option, text),
}


def read_words(rows: Iterable[Declaration], typed: Any, unit: Unit) -> dict[str, Any]:
    """Return the values of declared fields by name, read from what was typed;
    a field that was not typed has its default.

    Parameters
    ----------
    typed : an object with the words of each field as an attribute.

    Raises
    ------
    InputError
        For words that cannot be read.
    """
    return {row.name: read_declared_value(row, getattr(typed, row.argument), unit) for row in rows}


def read_declared_value(row: Declaration, words: Any, unit: Unit) -> Any:
    """Return the value of one declared field from what was typed for it; its default where nothing was."""
    if not words and words != "":
        return row.default
    reader = READERS.get(row.form)
    return words if reader is None else reader(row, words, unit)
