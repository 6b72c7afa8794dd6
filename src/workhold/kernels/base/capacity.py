"""How much memory kernels are given: what was needed before, and twice as much where it did not suffice."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

Made = TypeVar("Made")


class Capacity:
    """How many rows a kernel is given to write to.

    Parameters
    ----------
    rows : how many to begin with.
    """

    def __init__(self, rows: int) -> None:
        self.rows = rows

    def give(self, write: Callable[[int], Made | None]) -> Made:
        """Return what ``write`` makes of so many rows, with more rows as long as it answers None."""
        rows = self.rows
        while (made := write(rows)) is None:
            rows *= 2
        self.rows = max(self.rows, rows)
        return made
