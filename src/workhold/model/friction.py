"""Coefficients of friction between fixture and part: their names and usual values.

Static friction between a smooth steel jaw and a milled steel part that cutting oil has wetted. Makers of chucks print
0.10 for a smooth clamping surface on a milled part, the least of their tables but for ground ones (0.07): Röhm,
"Force monitoring RN-1391", table 4, clamping coefficients; Hainbuch, manual of SPANNTOP nova, table 5, friction.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite
from typing import Any

from attrs import frozen

from workhold.errors import InputError
from workhold.limits import MOST_FRICTION, convert_real

__all__ = [
    "COEFFICIENTS",
    "SAFETY",
    "FrictionCoefficient",
    "Coefficients",
    "to_coefficients",
    "find_friction_coefficient",
]

# By name, in the order of their names.
Coefficients = tuple[tuple[str, float], ...]
# On every load but weight.
SAFETY = 2.0


@frozen
class FrictionCoefficient:
    """A coefficient of friction that is usual.

    Parameters
    ----------
    value : the number.
    between : the two surfaces that rub, in words.
    source : where the number is taken from.
    """

    value: float
    between: str
    source: str


COEFFICIENTS: Mapping[str, FrictionCoefficient] = {
    "jaw": FrictionCoefficient(
        0.10, "smooth jaw and milled steel", "clamping coefficients of Röhm and Hainbuch"
    ),
    "plate": FrictionCoefficient(0.10, "plate and milled steel", "as of a smooth jaw"),
    "support": FrictionCoefficient(0.10, "support and milled steel", "as of a smooth jaw"),
    "tip": FrictionCoefficient(0.10, "clamp tip and milled steel", "as of a smooth jaw"),
}


def to_coefficients(value: Any) -> Coefficients | None:
    """Return pairs (name, coefficient), sorted by name, from a mapping or from pairs.

    Return None for None and for an empty mapping.

    Raises
    ------
    InputError
        For unknown names, and impossible coefficients.

    Examples
    --------
    >>> to_coefficients({"plate": 0.2, "jaw": 0.15})
    (('jaw', 0.15), ('plate', 0.2))
    """
    if value is None:
        return None
    try:
        given = dict(value)
    except (TypeError, ValueError) as error:
        raise InputError(
            f"friction cannot be {value!r}: give coefficients by name, such as jaw 0.15."
        ) from error
    for name, number in given.items():
        if name not in COEFFICIENTS:
            raise InputError(
                f"friction of {str(name)[:40]!r} is not known: give that of {', '.join(COEFFICIENTS)}."
            )
        if not (isfinite(convert_real(number, "a coefficient of friction")) and 0 < number <= MOST_FRICTION):
            raise InputError(
                f"friction {number:g} of the {name} cannot be used: give a coefficient above 0 and at most "
                f"{MOST_FRICTION:g}, such as 0.15."
            )
    return tuple(sorted((str(name), float(number)) for name, number in given.items())) or None


def find_friction_coefficient(given: Coefficients | None, name: str) -> float:
    """Return the coefficient of this name: the given one, else the usual one of :data:`COEFFICIENTS`."""
    return dict(given or ()).get(name, COEFFICIENTS[name].value)
