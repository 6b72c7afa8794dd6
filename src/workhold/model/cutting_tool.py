"""A tool of the machine as a stack of upright cylinders, with its cutting data.

The force, or data from which it is computed, are given for each tool or for the whole job. One such datum is
the material: a chip of thickness h and width b, both in mm, takes the force kc1.1 h^(1 - mc) b (O. Kienzle,
"Die Bestimmung von Kräften und Leistungen an spanenden Werkzeugen und Werkzeugmaschinen", VDI-Z 94, 1952).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import inf, isfinite
from typing import Any, Literal

from attrs import asdict, field, frozen
from attrs.converters import optional

from workhold.asking.program import CuttingQuestion
from workhold.errors import InputError
from workhold.limits import convert_real, read_number, refuse_long, refuse_strong

__all__ = [
    "ANY",
    "DIRECTIONS",
    "FEED",
    "MATERIALS",
    "SOURCE",
    "CutMaterial",
    "CuttingData",
    "CuttingDirection",
    "Cylinder",
    "Tool",
    "find_material",
]

SOURCE = "Iscar, Turning Tools catalogue 2017, page 558, material groups of VDI 3323"
# N/mm2. What is harder to cut than all of the table is a slip of the pen.
MOST_SPECIFIC = 20_000.0
CuttingDirection = Literal["any", "feed"]
ANY: CuttingDirection = "any"
FEED: CuttingDirection = "feed"
DIRECTIONS = (ANY, FEED)
# What the force follows from, of which one is given.
FORCES = ("cutting_force", "power", "material")
MOST_TEETH, MOST_POWER = 1000, 1e5
DRILL = "drill"


@frozen
class CutMaterial:
    """A material as it is cut.

    Parameters
    ----------
    name : by which the user asks for it.
    words : description of the material.
    kc : kc1.1, the force in N on a chip 1 mm thick and 1 mm wide.
    mc : Kienzle's exponent: the force grows with the chip's thickness to the power 1 - mc.
    source : where kc and mc are taken from.

    Raises
    ------
    InputError
        For impossible numbers.
    """

    name: str
    words: str
    kc: float
    mc: float
    source: str = SOURCE

    def __attrs_post_init__(self) -> None:
        if not (0.0 < convert_real(self.kc) <= MOST_SPECIFIC and 0.0 <= convert_real(self.mc) < 1.0):
            raise InputError(
                f"a material with kc1.1 {self.kc:g} and mc {self.mc:g} cannot be used: give N/mm2 up to "
                f"{MOST_SPECIFIC:g} and a number from 0 to below 1, such as 1500,0.22."
            )

    def compute_force(self, thickness: float, width: float) -> float:
        """Return the force in N on a chip whose thickness and width are in mm."""
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


def find_material(text: str) -> CutMaterial:
    """Return the material of a name, or one of the user's own from "kc1.1,mc".

    Raises
    ------
    InputError
        For a name that is not in the table, and impossible numbers.

    Examples
    --------
    >>> find_material("Mild steel").kc, find_material("2000,0.25").mc
    (1350.0, 0.25)
    >>> round(find_material("steel").compute_force(0.1, 5.0))
    1245
    """
    numbers = [read_number(word) for word in text.split(",")]
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


def to_material(value: str | CutMaterial) -> CutMaterial:
    """Return the material itself, or find it by its name; raise InputError for an unknown name."""
    return value if isinstance(value, CutMaterial) else find_material(str(value))


def to_direction(value: Any) -> CuttingDirection:
    """Return "any" or "feed" as a direction; raise InputError for any other value."""
    for word in DIRECTIONS:
        if word == value:
            return word
    raise InputError(f"the direction '{str(value)[:20]}' of cutting forces is not known: give any or feed.")


@frozen(kw_only=True)
class CuttingData(CuttingQuestion):
    """Cutting data of a tool, or of all tools of a job; None for those not known.

    Parameters
    ----------
    cutting_force : force at the periphery of the tool, in N; 0 if it hardly cuts.
    power : power at the spindle in kW, from which the force follows.
    material : material that is cut, or its name; the force then follows from Kienzle's formula.
    teeth : number of teeth.
    cut_depth, cut_width : sizes of the cut in mm, along the tool's axis and across the feed.
    point_angle : point angle of a drill, in degrees.
    helix_angle : helix angle of the flutes, in degrees; a helix pulls the part up.
    direction : ``any`` for all directions in the plane; ``feed`` for those within 60 degrees of the direction
        opposite to the feed.

    Raises
    ------
    InputError
        For impossible numbers, and more than one of force, power and material.

    Examples
    --------
    >>> CuttingData(material="steel", teeth=4).complete_with(CuttingData(power=3, cut_depth=5)).cut_depth
    5.0
    """

    material: CutMaterial | None = field(default=None, converter=optional(to_material))
    point_angle: float | None = field(default=None, converter=optional(convert_real))
    helix_angle: float | None = field(default=None, converter=optional(convert_real))
    direction: CuttingDirection | None = field(default=None, converter=optional(to_direction))

    def __attrs_post_init__(self) -> None:
        given = [name for name in FORCES if getattr(self, name) is not None]
        if len(given) > 1:
            raise InputError(f"{given[0]} and {given[1]} are two ways to the same force: give one of them.")
        for name, low, high, remedy in (
            ("cutting_force", 0.0, None, "a force of 0 or more, in N"),
            ("power", 0.0, MOST_POWER, "kW above 0"),
            ("teeth", 1.0, MOST_TEETH, "a whole number from 1"),
            ("cut_depth", 0.0, None, "a length above 0"),
            ("cut_width", 0.0, None, "a length above 0"),
            ("point_angle", 0.0, 180.0, "degrees above 0 and up to 180"),
            ("helix_angle", 0.0, 89.0, "degrees from 0 to 89"),
        ):
            value = getattr(self, name)
            if value is None:
                continue
            least = value >= low if name in ("cutting_force", "teeth", "helix_angle") else value > low
            in_range = isfinite(value) and least and (high is None or value <= high)
            if not in_range or (name == "teeth" and value != int(value)):
                raise InputError(f"{name} {value:g} cannot be used: give {remedy}.")
        refuse_strong("cutting_force", self.cutting_force or 0.0)
        for name in ("cut_depth", "cut_width"):
            refuse_long(name, getattr(self, name) or 0.0)

    @classmethod
    def from_value(cls, value: CuttingData | Mapping[str, Any] | None) -> CuttingData:
        """Return cutting data made from a mapping of field names to values.

        Cutting data are returned as they are; None gives data with all fields None.

        Raises
        ------
        InputError
            For an unknown name, and the errors of the class.
        """
        if value is None or isinstance(value, CuttingData):
            return value or cls()
        for name in value:
            if name not in asdict(cls()):
                raise InputError(f"cutting has no '{str(name)[:40]}': give {', '.join(asdict(cls()))}.")
        return cls(**value)

    @property
    def asks_for_forces(self) -> bool:
        """Whether a force, a power or a material is given, from which cutting forces follow."""
        return any(getattr(self, name) is not None for name in FORCES)

    def complete_with(self, other: CuttingData) -> CuttingData:
        """Return these data with each None replaced by the value in ``other``.

        Where these data have a force, a power or a material, none of these three is replaced.
        """
        mine = {name: getattr(self, name) for name in FIELDS}
        theirs = {name: getattr(other, name) for name in FIELDS}
        if self.asks_for_forces:
            theirs |= dict.fromkeys(FORCES)
        return CuttingData(**{name: theirs[name] if mine[name] is None else mine[name] for name in FIELDS})


FIELDS = tuple(asdict(CuttingData()))


def to_cylinders(values: Iterable[Cylinder]) -> tuple[Cylinder, ...]:
    """Return the cylinders as a tuple."""
    return tuple(values)


@frozen
class Cylinder:
    """An upright cylinder of a tool.

    Parameters
    ----------
    low, high : its heights in mm above the tip, closed.
    radius : in mm.

    Raises
    ------
    InputError
        For impossible heights and an impossible radius.
    """

    low: float = field(converter=convert_real)
    high: float = field(converter=convert_real)
    radius: float = field(converter=convert_real)

    def __attrs_post_init__(self) -> None:
        if not (0.0 <= self.low < self.high and isfinite(self.high) and 0.0 < self.radius < inf):
            raise InputError(
                f"a cylinder of a tool from {self.low:g} to {self.high:g} mm with a radius of "
                f"{self.radius:g} mm is not possible: give heights above the tip, the lower one first, "
                "and a positive radius."
            )
        refuse_long("a tool's length", self.high)
        refuse_long("a tool's radius", self.radius)


@frozen
class Tool:
    """A tool as a stack of cylinders: the flute, the shank, the holder.

    Parameters
    ----------
    number : T in the program; 0 is the tool that is in the spindle at the start.
    cylinders : in any order; they may overlap.
    diameter : of the flute, in mm.
    name : the workshop's name of it.
    cutting : cutting data of the tool; tools read from a result file have none, because the file has the
        forces.
    flute_length : length of the cutting part from the tip upward, in mm; None if it is as long as the lowest
        cylinder.
    kind : kind of tool in its table, such as ``drill``; empty if the table gives none.
    has_holder : whether one of the cylinders is the holder; None if not known: then one of several cylinders
        is taken for the holder.

    Raises
    ------
    InputError
        For a tool without a cylinder, and an impossible number or diameter.
    """

    number: int
    cylinders: tuple[Cylinder, ...] = field(converter=to_cylinders)
    diameter: float = field(converter=convert_real)
    name: str = ""
    cutting: CuttingData = field(factory=CuttingData, eq=False)
    flute_length: float | None = field(default=None, converter=optional(convert_real))
    kind: str = field(default="", converter=str, eq=False)
    has_holder: bool | None = field(default=None, eq=False)

    def __attrs_post_init__(self) -> None:
        if not self.cylinders or not 0.0 < self.diameter < inf or self.number < 0:
            raise InputError(f"tool {self.number} has no diameter: give one in mm.")
        if self.has_holder is None:
            object.__setattr__(self, "has_holder", len(self.cylinders) > 1)
        if self.flute_length is not None and not 0.0 < self.flute_length < inf:
            raise InputError(
                f"tool {self.number} has a flute of {self.flute_length:g} mm: give a length above 0."
            )

    @property
    def flute_end(self) -> float:
        """Height in mm above the tip up to which the tool cuts."""
        lowest = min(self.cylinders, key=lambda one: one.low)
        return lowest.high if self.flute_length is None else self.flute_length

    @property
    def is_drill(self) -> bool:
        """Whether the tool is a drill: the word is in its kind or, if the kind is empty, in its name."""
        return DRILL in (self.kind or self.name).lower()

    def to_dict(self) -> dict[str, Any]:
        """Return plain data as in a result file, without number and cutting data."""
        rows = [[one.low, one.high, one.radius] for one in self.cylinders]
        flute = {} if self.flute_length is None else {"flute_length": self.flute_length}
        return {"name": self.name, "diameter": self.diameter, **flute, "cylinders": rows}

    @classmethod
    def from_entries(cls, number: int, entries: Mapping[str, Any]) -> Tool:
        """Return a tool of this number from the entries of a result file.

        Raises
        ------
        InputError, LookupError, TypeError, ValueError
            For entries that lack something, or hold impossible values.
        """
        cylinders = [Cylinder(*row) for row in entries["cylinders"]]
        name, flute = str(entries.get("name", "")), entries.get("flute_length")
        return cls(number, cylinders, entries["diameter"], name, flute_length=flute)
