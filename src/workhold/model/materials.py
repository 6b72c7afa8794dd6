"""What it takes to cut a material: the specific cutting force of Kienzle, from a tool maker's table.

A chip of thickness h and width b, both in mm, takes the force kc1.1 h^(1 - mc) b (O. Kienzle, "Die Bestimmung
von Kräften und Leistungen an spanenden Werkzeugen und Werkzeugmaschinen", VDI-Z 94, 1952).
"""

from __future__ import annotations

from math import isfinite

from attrs import frozen

from workhold.errors import InputError
from workhold.limits import real

__all__ = ["MATERIALS", "SOURCE", "CutMaterial", "material_named"]

SOURCE = "Iscar, Turning Tools catalogue 2017, page 558, material groups of VDI 3323"
# N/mm2. What is harder to cut than all of the table is a slip of the pen.
MOST_SPECIFIC = 20_000.0


@frozen
class CutMaterial:
    """A material as it is cut.

    Parameters
    ----------
    name : as it is asked for.
    words : what it is.
    kc : kc1.1, the force in N on a chip 1 mm thick and 1 mm wide.
    mc : by how much less than the chip's thickness the force grows.
    source : of both numbers.

    Raises
    ------
    InputError
        For numbers that cannot be.
    """

    name: str
    words: str
    kc: float
    mc: float
    source: str = SOURCE

    def __attrs_post_init__(self) -> None:
        if not (0.0 < real(self.kc) <= MOST_SPECIFIC and 0.0 <= real(self.mc) < 1.0):
            raise InputError(
                f"a material with kc1.1 {self.kc:g} and mc {self.mc:g} is none: give N/mm2 up to "
                f"{MOST_SPECIFIC:g} and a number from 0 to below 1, such as 1500,0.22."
            )

    def force(self, thickness: float, width: float) -> float:
        """The force in N on a chip, of which thickness and width are in mm."""
        return float(self.kc * thickness ** (1.0 - self.mc) * width)


MATERIALS = (
    CutMaterial("mild-steel", "steel with less than 0.25 % C, 125 HB (group 1)", 1350.0, 0.21),
    CutMaterial("steel", "steel with 0.25 % C or more, 190 HB (group 2)", 1500.0, 0.22),
    CutMaterial("tempered-steel", "steel, quenched and tempered, 250 HB (group 3)", 1675.0, 0.24),
    CutMaterial("alloy-steel", "low alloy steel, 200 HB (group 6)", 1775.0, 0.24),
    CutMaterial("hard-alloy-steel", "low alloy steel, tempered, 350 HB (group 9)", 1800.0, 0.24),
    CutMaterial("tool-steel", "high alloy and tool steel, 200 HB (group 10)", 2450.0, 0.23),
    CutMaterial(
        "ferritic-stainless", "stainless steel, ferritic, martensitic, 200 HB (group 12)", 1875.0, 0.21
    ),
    CutMaterial("stainless", "stainless steel, austenitic, 180 HB (group 14)", 2150.0, 0.20),
    CutMaterial("cast-iron", "grey cast iron, 180 HB (group 15)", 1150.0, 0.20),
    CutMaterial("hard-cast-iron", "grey cast iron, pearlitic, 260 HB (group 16)", 1350.0, 0.28),
    CutMaterial("ductile-iron", "nodular cast iron, pearlitic, 250 HB (group 18)", 1350.0, 0.28),
    CutMaterial("malleable-iron", "malleable cast iron, pearlitic, 230 HB (group 20)", 1420.0, 0.30),
    CutMaterial("aluminium", "wrought aluminium alloy, hardened, 100 HB (group 22)", 800.0, 0.25),
    CutMaterial("cast-aluminium", "cast aluminium with up to 12 % Si, 90 HB (group 24)", 700.0, 0.25),
    CutMaterial("silicon-aluminium", "cast aluminium with more than 12 % Si, 130 HB (group 25)", 750.0, 0.25),
    CutMaterial("brass", "brass, 90 HB (group 27)", 700.0, 0.27),
    CutMaterial("copper", "electrolytic copper, 100 HB (group 28)", 700.0, 0.27),
    CutMaterial("nickel-alloy", "alloy of nickel or cobalt, 350 HB (group 34)", 3300.0, 0.24),
    CutMaterial("pure-titanium", "titanium of 400 MPa (group 36)", 1700.0, 0.23),
    CutMaterial("titanium", "titanium alloy, alpha and beta, hardened, of 1050 MPa (group 37)", 2110.0, 0.22),
)
OTHER_NAMES = {"aluminum": "aluminium", "cast-aluminum": "cast-aluminium", "nodular-iron": "ductile-iron"}


def material_named(text: str) -> CutMaterial:
    """A material by its name, or from kc1.1 and mc with a comma between them.

    Raises
    ------
    InputError
        For a name that is not in the table, and numbers that cannot be.

    Examples
    --------
    >>> material_named("Mild steel").kc, material_named("2000,0.25").mc
    (1350.0, 0.25)
    >>> round(material_named("steel").force(0.1, 5.0))
    1245
    """
    numbers = [real(word) for word in text.split(",")]
    if len(numbers) == 2 and all(map(isfinite, numbers)):
        return CutMaterial(text.strip(), "a material of your own", numbers[0], numbers[1], "given")
    name = "-".join(text.lower().replace("_", " ").replace("-", " ").split())
    name = OTHER_NAMES.get(name, name)
    for one in MATERIALS:
        if one.name == name:
            return one
    raise InputError(
        f"the material '{text[:40]}' is not known: give {', '.join(one.name for one in MATERIALS)}, or its "
        "own kc1.1 in N/mm2 and mc, such as 1500,0.22; of plastics and wood give a force instead."
    )
