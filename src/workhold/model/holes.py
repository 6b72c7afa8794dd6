"""Holes by name: jaw, column letters, row number from 1, such as ``L-B3``; a name without a row is a whole column."""

from __future__ import annotations

import re

from attrs import frozen

from workhold.errors import InputError

__all__ = ["Holes", "column_letters", "hole_name", "holes_named"]

NAME = re.compile(r"([LR])-?([A-Z]{1,3})([1-9][0-9]{0,8})?")
JAW_LETTERS = {"L": "left", "R": "right"}


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


def hole_name(jaw: str, column: int, row: int | None) -> str:
    """The name of a hole, or of a whole column; column and row count from 0.

    >>> hole_name("left", 1, 2), hole_name("right", 0, None)
    ('L-B3', 'R-A')
    """
    return f"{jaw[0].upper()}-{column_letters(column)}{'' if row is None else row + 1}"


@frozen
class Holes:
    """A hole of a jaw, or a whole column of them.

    Parameters
    ----------
    jaw : "left" or "right".
    column : counted from 0.
    row : counted from 0; None is the whole column.
    """

    jaw: str
    column: int
    row: int | None = None

    @property
    def name(self) -> str:
        """What it is called."""
        return hole_name(self.jaw, self.column, self.row)


def holes_named(name: str) -> Holes:
    """The hole or column of a name.

    Raises
    ------
    InputError
        When it is no such name.

    Examples
    --------
    >>> holes_named("R-A3")
    Holes(jaw='right', column=0, row=2)
    """
    match = NAME.fullmatch(name.strip().upper())
    if match is None:
        raise InputError(
            f"{name!r} names no hole: give jaw, column letter and row, such as L-B3, or L-B for a whole column."
        )
    jaw, letters, row = match.groups()
    column = 0
    for letter in letters:
        column = 26 * column + ord(letter) - ord("A") + 1
    return Holes(JAW_LETTERS[jaw], column - 1, None if row is None else int(row) - 1)
