"""Numbers as they are given to the model."""

from __future__ import annotations

from math import inf, nan
from typing import Any

__all__ = ["real"]


def real(value: Any) -> float:
    """A number as a float: infinite when it is a whole number beyond all floats, NaN when it is no number.

    So that what refuses numbers that are not finite refuses these as well.

    Examples
    --------
    >>> real(3), real(-(10**400)), real("three")
    (3.0, -inf, nan)
    """
    try:
        return float(value)
    except OverflowError:
        return inf if value > 0 else -inf
    except (TypeError, ValueError):
        return nan
