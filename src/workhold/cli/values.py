"""Readers of typed words: each returns a value, or raises an error of one plain sentence."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping, Sequence
from math import inf, isfinite, nan
from pathlib import Path
from typing import TYPE_CHECKING

from workhold.errors import InputError
from workhold.limits import check_count, refuse_long, refuse_strong
from workhold.units import INCH, MILLIMETRE, POUND, Unit, find_pixels_per_inch, find_unit

if TYPE_CHECKING:
    from workhold.fixels.toolkit import Toolkit

__all__ = [
    "read_choice",
    "read_quantity",
    "read_length",
    "read_length_from_zero",
    "read_unit",
    "read_number",
    "read_optional_count",
    "read_optional_force",
    "read_optional_length",
    "read_optional_positive_length",
    "read_picture_ending",
    "read_pitches",
    "read_positive_number",
    "choose_printed_unit",
    "read_two_lengths",
    "read_usual_unit",
    "read_whole_number",
]

PICTURE_ENDINGS = (".svg", ".png")
# A number and perhaps its unit: 12.5, 0.5in, 1/2", 1-1/4 inch. The units are those of workhold.units.
LENGTH = re.compile(r"\s*(?P<number>.*?)\s*(?P<unit>mm|cm|m|inch|in|\")?\s*", re.IGNORECASE | re.DOTALL)
FORCE = re.compile(r"\s*(?P<number>.*?)\s*(?P<unit>kN|N|lbf)?\s*", re.IGNORECASE | re.DOTALL)
FORCE_UNITS = {"n": 1.0, "kn": 1000.0, "lbf": POUND}
FRACTION = re.compile(r"(?P<sign>[+-]?)(?:(?P<whole>[0-9]+)[ -])?(?P<above>[0-9]+)/(?P<below>[0-9]+)")


def read_unit(name: str | None) -> Unit:
    """Return the unit of lengths typed and shown: the named one, else that of the environment, else mm.

    A name for a drawing's pixels, such as px96, also gives mm.
    """
    name = read_usual_unit() if name is None else name
    return MILLIMETRE if name is None or find_pixels_per_inch(name) is not None else find_unit(name)


def read_usual_unit() -> str | None:
    """Return the name of the unit in the environment variable ``WORKHOLD_UNIT``; None if it is not set."""
    return os.environ.get("WORKHOLD_UNIT") or None


def choose_printed_unit(name: str | None, toolkit: Toolkit) -> Unit:
    """Return the unit in which a fixture's lengths are shown: the named one, else the environment's, else
    that of the holes.

    Numbers that are typed without a unit stay in the unit of :func:`read_unit`.
    """
    return INCH if name is None and read_usual_unit() is None and toolkit.is_in_inches else read_unit(name)


def read_length(option: str, text: str, unit: Unit = MILLIMETRE) -> float:
    """Return a finite length in mm, of any sign; raise InputError for anything else.

    Parameters
    ----------
    option : name of the option, for messages.
    text : a number or a fraction, which may carry a unit of its own.
    unit : unit of a number that carries none.

    Examples
    --------
    >>> read_length("--min-gap", "12.7"), read_length("--min-gap", "0.5in"), read_length("--min-gap", '1-1/2"')
    (12.7, 12.7, 38.1)
    """
    match = LENGTH.fullmatch(text)
    value = nan
    if match is not None:
        own = match["unit"]
        value = (unit if own is None else find_unit(own)).to_mm(read_number(match["number"]))
    if not isfinite(value):
        raise InputError(
            f"{option} {text!r} is not a length: give a plain number in {unit.abbreviation}, such as 12.5, "
            "or one with its unit, such as 0.5in."
        )
    refuse_long(option, value)
    return value


def read_length_from_zero(option: str, text: str, unit: Unit = MILLIMETRE) -> float:
    """Return a length of 0 or more in mm, read as by :func:`read_length`;
    raise InputError for anything else.
    """
    value = read_length(option, text, unit)
    if value < 0:
        raise InputError(f"{option} {text} is negative: give 0 or more.")
    return value


def read_two_lengths(option: str, text: str, unit: Unit, remedy: str) -> tuple[float, float]:
    """Return two lengths in mm from text with a comma between them; raise InputError for anything else.

    ``remedy`` completes the message "… is not <remedy>".
    """
    words = text.split(",")
    if len(words) != 2:
        raise InputError(f"{option} {text!r} is not {remedy}")
    return read_length(option, words[0], unit), read_length(option, words[1], unit)


def read_three_lengths(option: str, text: str, unit: Unit, remedy: str) -> tuple[float, float, float]:
    """Return three lengths in mm with commas between them; ``remedy`` is as in :func:`read_two_lengths`."""
    words = text.split(",")
    if len(words) != 3:
        raise InputError(f"{option} {text!r} is not {remedy}")
    x, y, z = (read_length(option, word, unit) for word in words)
    return x, y, z


def read_number(text: str) -> float:
    """Return a number, or a fraction such as 1/2 or 1-1/2, as a float;
    NaN for anything else, inf for a fraction over 0.
    """
    fraction = FRACTION.fullmatch(text)
    if fraction is None:
        try:
            return nan if "_" in text else float(text)
        except ValueError:
            return nan
    below = float(fraction["below"])
    value = float(fraction["above"]) / below + float(fraction["whole"] or 0) if below else inf
    return -value if fraction["sign"] == "-" else value


def read_optional_length(option: str, text: str | None, unit: Unit = MILLIMETRE) -> float | None:
    """Return a finite length in mm, read as by :func:`read_length`, or None for None."""
    return None if text is None else read_length(option, text, unit)


def read_optional_positive_length(option: str, text: str | None, unit: Unit = MILLIMETRE) -> float | None:
    """Return a length above 0 in mm, read as by :func:`read_length`,
    or None for None; raise InputError for anything else.
    """
    value = read_optional_length(option, text, unit)
    if value is not None and value <= 0:
        raise InputError(f"{option} {text!r} is not above 0: give a positive length.")
    return value


def read_pitches(option_name: str, text: str, unit: Unit = MILLIMETRE) -> tuple[float, float]:
    """Return the pitch (x, y) in mm from one length for both directions, or from two.

    Parameters
    ----------
    unit : of numbers that carry none.

    Examples
    --------
    >>> read_pitches("--pitch", "10,12.5"), read_pitches("--pitch", "1/2in")
    ((10.0, 12.5), (12.7, 12.7))
    """
    parts = text.split(",")
    if len(parts) > 2:
        raise InputError(
            f"{option_name} {text!r} has {len(parts)} numbers: give one for both directions, or X,Y."
        )
    try:
        numbers = [read_length(option_name, part, unit) for part in parts]
    except InputError as error:
        raise InputError(
            f"{option_name} {text!r} is not a distance between holes: give it in {unit.abbreviation}, such as 10, "
            "or as X,Y, such as 10,12.5."
        ) from error
    return numbers[0], numbers[-1]


def read_whole_number(option: str, text: str) -> int:
    """Return an int of any sign; raise InputError for anything else."""
    try:
        return int(text)
    except ValueError:
        raise InputError(f"{option} {text!r} is not a whole number.") from None


def read_optional_count(option: str, text: str | None) -> int | None:
    """Return an int of 1 or more, or None for None; raise InputError for anything else."""
    return None if text is None else check_count(option, read_whole_number(option, text))


def read_positive_number(option: str, text: str) -> float:
    """Return a finite number above 0; raise InputError for anything else."""
    value = read_number(text.strip())
    if not (isfinite(value) and value > 0):
        raise InputError(f"{option} {text!r} is not a positive number: give one above 0.")
    return value


def read_optional_force(option: str, text: str | None) -> float | None:
    """Return a force above 0 in N, or None for None; raise InputError for anything else.

    Examples
    --------
    >>> read_optional_force("--jaw-force", "3kN"), read_optional_force("--jaw-force", "1000 lbf")
    (3000.0, 4448.2216152605)
    """
    if text is None:
        return None
    remedy = "a force above 0: give it in N, or with its unit, such as 3kN or 700lbf."
    value = read_quantity(option, text, FORCE, FORCE_UNITS, "n", remedy)
    refuse_strong(option, value)
    return value


def read_quantity(
    option: str, text: str, words: re.Pattern[str], units: Mapping[str, float], usual: str, remedy: str
) -> float:
    """Return a finite number above 0, converted by its unit; raise InputError for anything else.

    Parameters
    ----------
    words : pattern of the text, with the groups ``number`` and ``unit``.
    units : factor of each unit, by its name in small letters.
    usual : name of the unit of a number without one.
    remedy : what the text should be; it completes the message "… is not <remedy>".
    """
    match = words.fullmatch(text)
    value = nan if match is None else read_number(match["number"]) * units[(match["unit"] or usual).lower()]
    if not (isfinite(value) and value > 0):
        raise InputError(f"{option} {text!r} is not {remedy}")
    return value


def read_choice(option: str, text: str, among: Sequence[str]) -> str:
    """Return the word in ``among`` that equals the text, capitals ignored; raise InputError where none does.

    Examples
    --------
    >>> read_choice("--type", "ii", ("I", "II", "both"))
    'II'
    """
    for word in among:
        if word.lower() == text.strip().lower():
            return word
    raise InputError(f"{option} {text!r} is not known: give {', '.join(among[:-1])} or {among[-1]}.")


def read_picture_ending(path: Path) -> str:
    """Return the ending of a path, ".svg" or ".png"; raise InputError for any other."""
    ending = path.suffix.lower()
    if ending not in PICTURE_ENDINGS:
        raise InputError(f"--draw {path} names no kind of picture: let the name end in .svg or .png.")
    return ending
