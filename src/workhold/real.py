"""Numbers as they are given to the model."""

from __future__ import annotations

from math import inf, nan
from typing import Any

from workhold.errors import InputError

__all__ = ["counting_number", "real"]


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


def counting_number(name: str, value: Any) -> int | None:
    """A count from 1, or None.

    Raises
    ------
    InputError
        Naming what is counted, for anything else.
    """
    if value is None:
        return None
    try:
        if value == int(value) and value >= 1:
            return int(value)
    except (TypeError, ValueError, OverflowError):
        pass
    raise InputError(f"{name} {value} is not a positive whole number: give 1 or more.")
