"""Tools from their fields, as tables and Python give them: from diameters and lengths to cylinders."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite
from typing import Any

from workhold.errors import InputError
from workhold.limits import real
from workhold.model.cutting_tool import CuttingData, Cylinder, Tool
from workhold.units import Unit, unit_named

__all__ = ["FIELDS", "SHAPE", "is_bare", "tool_of_fields"]

LENGTHS = ("diameter", "flute_length", "shank_diameter", "stickout", "holder_diameter", "holder_length")
# How it cuts; flutes are teeth. A corner or a point is inside the flat end as which every tool is taken.
CUTTING = (
    "cutting_force",
    "power",
    "material",
    "teeth",
    "cut_depth",
    "cut_width",
    "point_angle",
    "helix_angle",
)
OTHERS = ("corner_radius", "flutes")
FIELDS = ("name", "unit", *LENGTHS, *CUTTING, *OTHERS)
UNSURE = ("teeth", "point_angle")
SHAPE = (
    "tool.{number} = {{diameter = 10, flute_length = 22, stickout = 40, holder_diameter = 40, "
    "holder_length = 50}}"
)
# mm. As far up as a tool is taken to go where nobody says: past everything that holds a part.
ENDLESS = 1000.0


def tool_of_fields(number: int, fields: Mapping[str, Any], place: str, unit: Unit) -> Tool:
    """A tool as a flute, a shank above it and a holder.

    Parameters
    ----------
    fields : lengths by their names; the diameter is needed. A tool whose stickout is not said goes on upward.
    place : where they stand, for messages.
    unit : of lengths, where the fields do not say.

    Raises
    ------
    InputError
        For a field that is not known, or cannot be.

    Examples
    --------
    >>> from workhold.units import MILLIMETRE
    >>> fields = {"diameter": 10, "stickout": 40, "holder_diameter": 40, "holder_length": 50}
    >>> [(one.low, one.high, one.radius) for one in tool_of_fields(1, fields, "T1", MILLIMETRE).cylinders]
    [(0.0, 40.0, 5.0), (40.0, 90.0, 20.0)]
    """
    for key in fields:
        if key not in FIELDS:
            raise InputError(f"{place} has an unknown key '{str(key)[:40]}': give {', '.join(FIELDS)}.")
    unit = unit if fields.get("unit") is None else unit_named(str(fields["unit"]))
    lengths = {}
    for key in LENGTHS:
        if fields.get(key) is not None:
            value = real(fields[key])
            if isinstance(fields[key], bool) or not (isfinite(value) and value > 0):
                raise InputError(f"{place}: {key} is not a length above 0: give a number.")
            lengths[key] = unit.length(value)
    if "diameter" not in lengths:
        raise InputError(f"{place} has no diameter: give one.")
    try:
        cutting = cutting_of(fields, unit)
        name = str(fields.get("name") or "")
        return Tool(number, stack(lengths, place), lengths["diameter"], name, cutting)
    except InputError as error:
        raise InputError(str(error) if str(error).startswith(place) else f"{place}: {error}") from error


def cutting_of(fields: Mapping[str, Any], unit: Unit) -> CuttingData:
    """How a tool cuts, from its fields.

    A table that was written for another program may say of flutes and of a point what cannot be used here.
    That is refused only where it is the force that is asked for.

    Parameters
    ----------
    unit : of lengths.

    Raises
    ------
    InputError
        For what cannot be.
    """
    given = {key: fields[key] for key in CUTTING if fields.get(key) is not None}
    if fields.get("flutes") is not None:
        given.setdefault("teeth", fields["flutes"])
    for key in ("cut_depth", "cut_width"):
        if key in given:
            given[key] = unit.length(real(given[key]))
    if not given.keys() & {"cutting_force", "power", "material"}:
        given = {key: value for key, value in given.items() if key not in UNSURE or is_usable(key, value)}
    return CuttingData(**given)


def is_usable(key: str, value: Any) -> bool:
    """Whether a field of how a tool cuts is one."""
    try:
        CuttingData(**{key: value})
    except InputError:
        return False
    return True


def stack(lengths: Mapping[str, float], place: str) -> list[Cylinder]:
    """The cylinders of a tool from its lengths in mm.

    Raises
    ------
    InputError
        For a shank or a holder whose place is not said.
    """
    flute, reach = lengths.get("flute_length"), lengths.get("stickout")
    radius, shank = lengths["diameter"] / 2, lengths.get("shank_diameter")
    top = ENDLESS if reach is None else reach
    if "holder_diameter" in lengths and reach is None:
        raise InputError(f"{place} has a holder and no stickout: give how far the tool stands out of it.")
    if "holder_length" in lengths and "holder_diameter" not in lengths:
        raise InputError(f"{place} has a holder_length and no holder_diameter: give both.")
    if shank is None:
        found = [Cylinder(0.0, top, radius)]
    elif flute is None:
        raise InputError(f"{place} has a shank and no flute_length: give where the shank begins.")
    elif flute < top:
        found = [Cylinder(0.0, flute, radius), Cylinder(flute, top, shank / 2)]
    else:
        found = [Cylinder(0.0, top, radius)]
    if "holder_diameter" in lengths and reach is not None:
        end = reach + lengths.get("holder_length", ENDLESS)
        found.append(Cylinder(reach, end, lengths["holder_diameter"] / 2))
    return found


def is_bare(tool: Tool) -> bool:
    """Whether nothing is known of a tool's holder."""
    return (
        len({one.radius for one in tool.cylinders}) == 1 or max(one.high for one in tool.cylinders) == ENDLESS
    )
