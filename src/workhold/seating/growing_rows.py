"""Arrays of rows that grow until they have room."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["filled", "with_room"]


def filled(width: int, room: int, kernel: Callable[..., int], *arguments: Any) -> NDArray[np.float64]:
    """The rows that a kernel writes into its last argument, which is made larger until it has room."""
    while True:
        out = np.empty((room, width))
        count = kernel(*arguments, out)
        if count >= 0:
            return out[:count]
        room *= 4


def with_room(rows: NDArray[Any], count: int, more: int) -> NDArray[Any]:
    """An array with room for more rows: itself, or a copy of twice the length."""
    if count + more <= len(rows):
        return rows
    out = np.empty((2 * (count + more), *rows.shape[1:]), rows.dtype)
    out[:count] = rows[:count]
    return out
