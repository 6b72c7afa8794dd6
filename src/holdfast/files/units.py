"""Units of length: every file comes out in millimetres, and none without a unit is guessed at."""

from __future__ import annotations

from holdfast.errors import InputError

__all__ = ["UNITS", "millimetres_per"]

# Exact by definition (international inch, 1959).
UNITS = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "inch": 25.4, "in": 25.4}


def millimetres_per(unit: str) -> float:
    """Millimetres in one unit.

    Raises
    ------
    InputError
        For a unit that is not known.

    Examples
    --------
    >>> millimetres_per("inch")
    25.4
    """
    try:
        return UNITS[unit.strip().lower()]
    except KeyError:
        raise InputError(f"Unit '{unit[:40]}' is not known: use mm, cm, m or inch.") from None
