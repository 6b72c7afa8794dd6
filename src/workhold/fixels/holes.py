"""Holes by name: letter of the carrier, column letters, row from 1, such as ``L-B3``; without a row a whole column."""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import cache

from attrs import frozen

from workhold.errors import InputError

__all__ = ["Holes", "column_letters", "hole_name", "holes_named", "letter_of"]

# The carrier that is the only one with holes.
ALONE = "plate"
NAME = re.compile(r"([A-Z])-?([A-Z]{1,3})([1-9][0-9]{0,8})?")


@cache
def column_letters(column: int) -> str:
    """Letters of a column counted from 0: A to Z, then AA, AB and so on.

    >>> [column_letters(c) for c in (0, 25, 26, 51, 52)]
    ['A', 'Z', 'AA', 'AZ', 'BA']
    """
    letters = ""
    column += 1
    while column:
        column, rest = divmod(column - 1, 26)
        letters = chr(ord("A") + rest) + letters
    return letters


def hole_name(carrier: str, column: int, row: int | None) -> str:
    """The name of a hole, or of a whole column, of a carrier of a name; column and row count from 0.

    >>> hole_name("left", 1, 2), hole_name("right", 0, None), hole_name("plate", 1, 2)
    ('L-B3', 'R-A', 'B3')
    """
    letter = letter_of(carrier)
    return f"{letter and letter + '-'}{column_letters(column)}{'' if row is None else row + 1}"


def letter_of(carrier: str) -> str:
    """What the names of a carrier's holes begin with; nothing where there is but one lattice."""
    return "" if carrier == ALONE else carrier[0].upper()


@frozen
class Holes:
    """A hole of a carrier, or a whole column of them.

    Parameters
    ----------
    carrier : its name, such as "left".
    column : counted from 0.
    row : counted from 0; None is the whole column.
    """

    carrier: str
    column: int
    row: int | None = None

    @property
    def name(self) -> str:
        """What it is called."""
        return hole_name(self.carrier, self.column, self.row)


def holes_named(name: str, carriers: Iterable[str], noun: str) -> Holes:
    """The hole or column of a name, as :func:`hole_name` gives it.

    Parameters
    ----------
    name : in any mixture of capitals, with or without the hyphen.
    carriers, noun : the names of the carriers it may be on, and what one of them is called.

    Raises
    ------
    InputError
        When it is no such name.

    Examples
    --------
    >>> holes_named("R-A3", ("left", "right"), "jaw")
    Holes(carrier='right', column=0, row=2)
    """
    match = NAME.fullmatch(name.strip().upper())
    carrier = None if match is None else next((one for one in carriers if letter_of(one) == match[1]), None)
    if match is None or carrier is None:
        raise InputError(
            f"{name!r} names no hole: give {noun}, column letter and row, such as L-B3, or L-B for a whole column."
        )
    column = 0
    for letter in match[2]:
        column = 26 * column + ord(letter) - ord("A") + 1
    return Holes(carrier, column - 1, None if match[3] is None else int(match[3]) - 1)
