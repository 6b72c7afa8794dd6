"""Materials of parts: stiffness, density and strength, each with its source."""

from __future__ import annotations

from math import isfinite

from attrs import field, frozen

from workhold.errors import InputError
from workhold.limits import convert_real

__all__ = ["MATERIALS", "ElasticMaterial", "find_material"]


@frozen
class ElasticMaterial:
    """A material with the same stiffness in every direction.

    Parameters
    ----------
    name : name as users write it.
    elastic_modulus : Young's modulus E in MPa.
    poisson : Poisson's ratio, from 0 to below 0.5.
    density : in kg/m³.
    source : where the numbers are taken from.
    strength : von Mises stress in MPa at which the material yields or, if brittle, breaks; None when not
        known.
    strength_source : the alloy and condition that the strength belongs to, and its source.
    """

    name: str
    elastic_modulus: float = field(converter=convert_real)
    poisson: float = field(converter=convert_real)
    density: float = field(converter=convert_real)
    source: str = "given"
    strength: float | None = None
    strength_source: str = "given"

    def __attrs_post_init__(self) -> None:
        if not (isfinite(self.elastic_modulus) and 1.0 <= self.elastic_modulus <= 1e7):
            raise InputError(
                f"Young's modulus {self.elastic_modulus:g} cannot be used: give it in MPa, such as 69000 for aluminium."
            )
        if not 0.0 <= self.poisson <= 0.49:
            raise InputError(f"Poisson's ratio {self.poisson:g} cannot be used: give one from 0 to 0.49.")
        if not (isfinite(self.density) and self.density > 0.0):
            raise InputError(f"the density {self.density:g} cannot be used: give it in kg/m³.")
        if self.strength is not None and not (isfinite(self.strength) and self.strength > 0.0):
            raise InputError(
                f"the yield strength {self.strength:g} cannot be used: give it in MPa, such as 276."
            )

    @property
    def words(self) -> str:
        """Name with Young's modulus and Poisson's ratio, as text for people.

        >>> MATERIALS["mild-steel"].words
        'mild-steel (E 205 GPa, Poisson 0.29)'
        """
        return f"{self.name} (E {self.elastic_modulus / 1000:.3g} GPa, Poisson {self.poisson:.2g})"


MATWEB, ASSUMED_RATIO = "MatWeb", "Poisson's ratio assumed"
CALLISTER = "W. D. Callister, Materials Science and Engineering, table B.4"
# A tenth more or less of Poisson's ratio changes how far a part bends by some hundredths. What stood in no table that could
# be looked up says that it is assumed.
MATERIALS = {
    one.name: one
    for one in (
        ElasticMaterial(
            "aluminium-6061", 68_900.0, 0.33, 2700.0, f"{MATWEB}, aluminum 6061-T6", 276.0, f"T6, {CALLISTER}"
        ),
        ElasticMaterial(
            "aluminium-7075", 71_700.0, 0.33, 2810.0, f"{MATWEB}, aluminum 7075-T6", 505.0, f"T6, {CALLISTER}"
        ),
        ElasticMaterial(
            "mild-steel",
            205_000.0,
            0.29,
            7870.0,
            f"{MATWEB}, AISI 1020 steel, cold rolled; E and Poisson's ratio typical for steel, as of AISI 4140",
            210.0,
            f"AISI 1020, hot rolled, the least; cold drawn 350; {CALLISTER}",
        ),
        ElasticMaterial(
            "steel-4140",
            205_000.0,
            0.29,
            7850.0,
            f"{MATWEB}, AISI 4140 steel, oil quenched",
            417.0,
            "annealed, eFunda, AISI 4140; tempered it has twice that",
        ),
        ElasticMaterial(
            "stainless-304",
            193_000.0,
            0.29,
            8000.0,
            f"W. D. Callister, Materials Science and Engineering, appendix B; {ASSUMED_RATIO}",
            205.0,
            f"annealed, the least, {CALLISTER}",
        ),
        ElasticMaterial(
            "brass",
            97_000.0,
            0.31,
            8490.0,
            f"{MATWEB}, free-cutting brass UNS C36000",
            140.0,
            "soft annealed, the least, Fisk Alloy, C36000; half-hard 170",
        ),
        ElasticMaterial(
            "cast-iron",
            100_000.0,
            0.26,
            7150.0,
            f"The Engineering ToolBox, engineering materials: cast iron, grade 20; {ASSUMED_RATIO}",
            124.0,
            f"breaks in tension, gray iron G1800, the least, {CALLISTER}",
        ),
        ElasticMaterial(
            "pom",
            2_800.0,
            0.35,
            1410.0,
            "E assumed, between 2.5 and 3.0 GPa of copolymer and homopolymer in the Engineering Plastics Handbook, "
            f"table 5.5; {ASSUMED_RATIO}",
            65.0,
            "copolymer, Engineering Plastics Handbook, table 5.5",
        ),
        ElasticMaterial(
            "pa6",
            3_300.0,
            0.39,
            1140.0,
            "assumed, of dry stock; moist it is much softer",
            45.0,
            "assumed, of moist stock",
        ),
        ElasticMaterial("peek", 4_200.0, 0.38, 1310.0, "assumed", 90.0, "assumed"),
    )
}


def find_material(name: str) -> ElasticMaterial:
    """Return the material with a name, or one made from numbers: "E in MPa,Poisson's ratio", such as
    "69000,0.33".

    A third number is its yield strength in MPa, as in "69000,0.33,276".

    Raises
    ------
    InputError
        For an unknown name and for impossible numbers.

    Examples
    --------
    >>> find_material("brass").density, find_material("2400, 0.4").poisson, find_material("2400,0.4,50").strength
    (8490.0, 0.4, 50.0)
    """
    key = name.strip().lower().replace(" ", "-").replace("_", "-")
    if key in MATERIALS:
        return MATERIALS[key]
    numbers = name.split(",")
    if len(numbers) in (2, 3):
        try:
            modulus, poisson, *strength = map(float, numbers)
        except ValueError:
            pass
        else:
            return ElasticMaterial(
                name.strip(), modulus, poisson, 1000.0, strength=next(iter(strength), None)
            )
    raise InputError(
        f"the material {name[:40]!r} is not known: choose {', '.join(MATERIALS)}, or give E in MPa and Poisson's "
        "ratio, such as 69000,0.33, and the yield strength in MPa if it is known: 69000,0.33,276."
    )
