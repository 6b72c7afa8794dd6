"""Options of the forces with which tools cut, where the table of tools does not say it."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from attrs import frozen

from workhold.cli.commands import option
from workhold.cli.values import choice, in_unit, optional_force, optional_positive_length, whole_number
from workhold.units import Unit

if TYPE_CHECKING:
    from workhold.model.cutting_tool import CuttingData

__all__ = [
    "CUTTING_DIRECTION",
    "CUTTING_FORCE",
    "CUT_DEPTH",
    "CUT_WIDTH",
    "MATERIAL",
    "POWER",
    "TEETH",
    "CuttingWords",
    "asked_cutting",
]

FORCES = "Cutting forces"
CUTTING_FORCE = option(
    FORCES, "FORCE", "Force at the periphery of every tool whose own the table does not give, in N or 1.5kN."
)
POWER = option(FORCES, "KW", "Power at the spindle, from which the force follows by S; also 3hp.")
MATERIAL = option(
    FORCES,
    "NAME|KC,MC",
    "What is cut, such as steel, stainless, cast-iron, aluminium, brass or titanium, or kc1.1 in N/mm2 and "
    "mc: the force follows from F, S, teeth and the cut.",
)
TEETH = option(FORCES, "N", "Teeth of every tool whose own the table does not give.")
CUT_DEPTH = option(FORCES, "LENGTH", "How deep tools cut at most at once, along their axes.")
CUT_WIDTH = option(FORCES, "LENGTH", "How broad they cut, across the feed; the tool's diameter if not given.")
CUTTING_DIRECTION = option(
    FORCES,
    "any|feed",
    "Whether a force may act in any direction, or within 60 degrees of against the feed; any if not given.",
)
POWER_WORDS = re.compile(r"\s*(?P<number>.*?)\s*(?P<unit>kW|hp)?\s*", re.IGNORECASE | re.DOTALL)
# kW in a unit; 550 foot-pounds a second.
POWERS = {"kw": 1.0, "hp": 0.7456998715822702}


@frozen
class CuttingWords:
    """The options of cutting forces, as typed; None for those not given."""

    cutting_force: str | None = None
    power: str | None = None
    material: str | None = None
    teeth: str | None = None
    cut_depth: str | None = None
    cut_width: str | None = None
    cutting_direction: str | None = None


def asked_cutting(typed: Any, unit: Unit) -> CuttingData:
    """How tools cut, from words as typed; None for those not given.

    Parameters
    ----------
    typed : has the options as attributes.

    Raises
    ------
    InputError
        For words that mean nothing, and what cannot be.
    """
    from workhold.model.cutting_tool import CuttingData

    given = {
        "cutting_force": no_force(typed.cutting_force),
        "power": asked_power(typed.power),
        "material": typed.material,
        "teeth": None if typed.teeth is None else whole_number("--teeth", typed.teeth),
        "cut_depth": optional_positive_length("--cut-depth", typed.cut_depth, unit),
        "cut_width": optional_positive_length("--cut-width", typed.cut_width, unit),
        "direction": None,
    }
    if typed.cutting_direction is not None:
        given["direction"] = choice("--cutting-direction", typed.cutting_direction, ("any", "feed"))
    return CuttingData(**given)


def no_force(text: str | None) -> float | None:
    """A cutting force in N, 0 included; None where it is not given."""
    return 0.0 if text is not None and text.strip() == "0" else optional_force("--cutting-force", text)


def asked_power(text: str | None) -> float | None:
    """A power in kW, or None where it is not given.

    Raises
    ------
    InputError
        For anything else.

    Examples
    --------
    >>> asked_power("2.2"), round(asked_power("3 hp"), 3)
    (2.2, 2.237)
    """
    if text is None:
        return None
    remedy = "a power above 0: give it in kW, such as 2.2, or as 3hp."
    return in_unit("--power", text, POWER_WORDS, POWERS, "kw", remedy)
