"""Memory that goes back to the system once nothing needs it.

The C library keeps what is freed for later. After large results that is most of what they took, because many
small pieces in between keep whole blocks from going back by themselves.
"""

from __future__ import annotations

import ctypes
import gc
from contextlib import suppress
from functools import cache
from typing import Any

__all__ = ["return_memory"]


@cache
def trimming() -> Any:
    """The function of the C library that gives freed memory back; None where it has none."""
    with suppress(OSError, AttributeError, TypeError):
        return ctypes.CDLL(None).malloc_trim
    return None


def return_memory() -> None:
    """Gives freed memory back to the system; takes milliseconds."""
    gc.collect()
    trim = trimming()
    if trim is not None:
        trim(ctypes.c_size_t(0))
