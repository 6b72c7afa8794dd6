"""Sizes of the arrays that kernels write to: the largest needed so far, doubled where it did not suffice."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

Made = TypeVar("Made")


class Capacity:
    """The number of rows that a kernel is given to write to.

    Parameters
    ----------
    rows : number to begin with, at least 1; later the largest number that was needed.
    """

    def __init__(self, rows: int) -> None:
        self.rows = rows

    def call_with_room(self, write: Callable[[int], Made | None]) -> Made:
        """Return the first result of ``write(rows)`` that is not None, calling it with ever more rows.

        ``rows`` begins with the number of rows of the last success, and is doubled after each None.
        """
        rows = self.rows
        while (made := write(rows)) is None:
            rows *= 2
        self.rows = max(self.rows, rows)
        return made
