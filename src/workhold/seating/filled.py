"""Room for as many rows as a kernel finds."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["filled"]


def filled(width: int, room: int, kernel: Callable[..., int], *arguments: Any) -> NDArray[np.float64]:
    """What a kernel writes into its last argument, an array of rows that is made larger until it has room."""
    while True:
        out = np.empty((room, width))
        count = kernel(*arguments, out)
        if count >= 0:
            return out[:count]
        room *= 4
