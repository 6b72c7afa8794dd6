"""The words of ``--load`` for loads in space: those of the plane, and height, axial force and tilt."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING

from workhold.cli.search_options import parse_load
from workhold.cli.values import number
from workhold.errors import InputError

if TYPE_CHECKING:
    from workhold.model.support_request import SpatialLoad
    from workhold.units import Unit

__all__ = ["spatial_load"]


def spatial_load(text: str, thickness: float, unit: Unit) -> SpatialLoad:
    """A load with its heights, its axial force and what tilts, from the text of ``--load``.

    Raises
    ------
    InputError
        For words that mean nothing.
    """
    from workhold.model.support_request import SpatialLoad

    place = f'--load "{text}"'
    own, rest = dict[str, str](), list[str]()
    for word in text.split():
        key, _, value = word.partition("=")
        if key in ("z", "axial", "tilt"):
            own[key] = value
        else:
            rest.append(word)
    acts = any(word.startswith(("force=", "moment=")) for word in rest)
    try:
        planar = parse_load(" ".join(rest if acts else [*rest, "force=1"]), unit.millimetres)
    except InputError as error:
        raise InputError(str(error).replace(" force=1", "")) from error
    heights = ranged(place, own.get("z"), (thickness, thickness))
    scale = unit.millimetres
    tilt = own.get("tilt", "0,0").split(",")
    if len(tilt) != 2:
        raise InputError(f"{place} cannot be used at 'tilt': give tilt=ABOUTX,ABOUTY in N mm.")
    return SpatialLoad(
        points=planar.points,
        heights=(heights[0] * scale, heights[1] * scale) if "z" in own else heights,
        force=planar.force if acts else 0.0,
        directions=planar.directions,
        axial=ranged(place, own.get("axial"), (0.0, 0.0)),
        moment=planar.moment,
        tilt=(number(tilt[0]), number(tilt[1])),
        name=planar.name,
    )


def ranged(place: str, text: str | None, usual: tuple[float, float]) -> tuple[float, float]:
    """One number or a range LOW..HIGH.

    Raises
    ------
    InputError
        For anything else.
    """
    if text is None:
        return usual
    low, _, high = text.partition("..")
    found = number(low), number(high or low)
    if not all(map(isfinite, found)):
        raise InputError(f"{place} cannot be used at '{text}': give a number, or a range LOW..HIGH.")
    return found
