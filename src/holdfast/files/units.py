"""Units of drawings: every file comes out in millimetres, and none without a unit is guessed at."""

from __future__ import annotations

from holdfast.model.units import unit_named

__all__ = ["millimetres_per"]


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
    return unit_named(unit).millimetres
