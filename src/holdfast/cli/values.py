"""Numbers typed by a user, turned into numbers or into one plain sentence."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from pathlib import Path

from holdfast.errors import InputError

__all__ = ["choice", "counting_number", "length", "optional_length", "picture_ending", "pitches", "whole_number"]

PICTURE_ENDINGS = (".svg", ".png")


def length(option: str, text: str) -> float:
    """A finite length in mm; whether its sign fits is for the vise to say.

    Raises
    ------
    InputError
        For anything that is not one finite number.

    Examples
    --------
    >>> length("--min-gap", "12.7")
    12.7
    """
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not isfinite(value) or "_" in text:
        raise InputError(f"{option} {text!r} is not a length: give a plain number in mm, such as 12.5.")
    return value


def optional_length(option: str, text: str | None) -> float | None:
    """A finite length in mm, or None where the option is not given."""
    return None if text is None else length(option, text)


def pitches(text: str) -> tuple[float, float]:
    """The x and y pitch, from one number or two.

    Raises
    ------
    InputError
        For anything else.

    Examples
    --------
    >>> pitches("10"), pitches("10,12.5")
    ((10.0, 10.0), (10.0, 12.5))
    """
    parts = text.split(",")
    if len(parts) > 2:
        raise InputError(f"--pitch {text!r} has {len(parts)} numbers: give one for both directions, or X,Y.")
    try:
        numbers = [length("--pitch", part) for part in parts]
    except InputError as error:
        raise InputError(
            f"--pitch {text!r} is not a distance between holes: give it in mm, such as 10, or as X,Y, such as 10,12.5."
        ) from error
    return numbers[0], numbers[-1]


def whole_number(option: str, text: str) -> int:
    """A whole number; whether its sign fits is for others to say.

    Raises
    ------
    InputError
        For anything else.
    """
    try:
        return int(text)
    except ValueError:
        raise InputError(f"{option} {text!r} is not a whole number.") from None


def counting_number(option: str, text: str | None, what: str) -> int | None:
    """A number of things, from 1, or None where the option is not given.

    Raises
    ------
    InputError
        Below 1, or when it is no whole number.
    """
    if text is None:
        return None
    value = whole_number(option, text)
    if value < 1:
        raise InputError(f"{option} {text} is not a number of {what}: give 1 or more.")
    return value


def choice(option: str, text: str, among: Sequence[str]) -> str:
    """One of several words, in any mixture of capitals.

    Raises
    ------
    InputError
        For any other word.

    Examples
    --------
    >>> choice("--type", "ii", ("I", "II", "both"))
    'II'
    """
    for word in among:
        if word.lower() == text.strip().lower():
            return word
    raise InputError(f"{option} {text!r} is not known: give {', '.join(among[:-1])} or {among[-1]}.")


def picture_ending(path: Path) -> str:
    """The ending of a picture's name, ``.svg`` or ``.png``.

    Raises
    ------
    InputError
        For any other.
    """
    ending = path.suffix.lower()
    if ending not in PICTURE_ENDINGS:
        raise InputError(f"--draw {path} names no kind of picture: let the name end in .svg or .png.")
    return ending
