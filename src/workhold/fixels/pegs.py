"""Pegs: round, or with a flat, and their outlines.

Pegs in holes are round, or have a flat for straight faces (Wallack and Canny 1996, section 2.3). Such a peg
is turned in its hole so that its flat lies on the face; its centre is then nearer to the part than its
radius. It touches arcs with its round side. Its body must be clear of everything else, whichever way it is
turned.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import acos, cos, floor, isfinite, nan, pi, radians, sin, sqrt
from typing import Any

from attrs import evolve, field, frozen

from workhold.errors import InputError
from workhold.geometry.segment import Arc, Line, Point, Segment
from workhold.limits import convert_real

__all__ = ["PegFlat", "convert_flat", "make_peg_outline", "resolve_flat", "compute_standoff"]

# Parts of the peg radius; a width that was rounded when it was written down is one still.
ROUNDED = 1e-6


@frozen
class PegFlat:
    """A flat side of a peg, which lies on straight faces of the part.

    Parameters
    ----------
    distance : from the peg's centre to its flat, in mm; at most the peg radius.
    half_width : half the width of the flat in mm; NaN for a flat that cuts the peg's whole circle at this
        distance.
    """

    distance: float = field(converter=convert_real)
    half_width: float = field(default=nan, converter=convert_real)


def convert_flat(value: Any) -> PegFlat | None:
    """Return a flat from a distance in mm, a pair (distance, half width), or a mapping with these two names.

    None and a ``PegFlat`` are returned unchanged.

    Raises InputError for anything else.

    Examples
    --------
    >>> convert_flat({"distance": 2.0, "half_width": 1.5}) == convert_flat((2.0, 1.5))
    True
    """
    if value is None or isinstance(value, PegFlat):
        return value
    if isinstance(value, Mapping) and "distance" in value and set(value) <= {"distance", "half_width"}:
        return PegFlat(**value)
    numbers = (
        tuple(value) if isinstance(value, Iterable) and not isinstance(value, (str, Mapping)) else (value,)
    )
    if not 1 <= len(numbers) <= 2 or any(isinstance(number, (str, Mapping)) for number in numbers):
        raise InputError(
            f"flat {value!r} cannot be used: give its distance from the peg's centre, and half its width, in mm."
        )
    return PegFlat(*numbers)


def resolve_flat(flat: PegFlat | None, peg_radius: float) -> PegFlat | None:
    """Return a flat with its half width filled in, for a peg of a radius in mm; None for None.

    Raises
    ------
    InputError
        For a flat that a peg of this radius cannot have.
    """
    if flat is None:
        return None
    if not (isfinite(flat.distance) and 0 <= flat.distance <= peg_radius):
        raise InputError(
            f"a peg of radius {peg_radius:g} mm cannot have a flat {flat.distance:g} mm from its "
            "centre: give 0 or more, and no more than the radius."
        )
    widest = sqrt(peg_radius**2 - flat.distance**2)
    half_width = widest if flat.half_width != flat.half_width else flat.half_width
    if not 0 <= half_width <= widest + ROUNDED * peg_radius:
        # Rounded down, so that it can be given.
        most = floor(widest * 1e3) / 1e3
        raise InputError(
            f"a flat {flat.distance:g} mm from the centre of a peg of radius {peg_radius:g} mm cannot "
            f"have half a width of {half_width:g} mm: give up to {most:.10g}."
        )
    return evolve(flat, half_width=half_width)


def compute_standoff(peg_radius: float, flat: PegFlat | None, face: Segment) -> float:
    """Return the distance in mm from a face to the centre of a peg that touches it.

    It is the distance of the flat for a straight face and a peg with a flat, else the peg radius.
    """
    return flat.distance if flat is not None and isinstance(face, Line) else peg_radius


def make_peg_outline(
    center: Point, radius: float, flat: PegFlat | None = None, flat_deg: float | None = None
) -> list[Segment]:
    """Return the outline of a peg in mm, counter-clockwise: a full circle, or an arc and a line for a flat.

    ``flat_deg`` is the direction in degrees, counter-clockwise from x, in which the flat faces. It is a full
    circle where ``flat`` or ``flat_deg`` is None.
    """
    if flat is None or flat_deg is None or flat.distance >= radius:
        return [Arc(center, radius, 0.0, pi, 1.0)]
    looks, half = radians(flat_deg), acos(flat.distance / radius)
    arc = Arc(center, radius, looks + pi, pi - half, 1.0)
    end, start = (
        (center[0] + radius * cos(looks + turn), center[1] + radius * sin(looks + turn))
        for turn in (-half, half)
    )
    return [arc, Line(end, start)]
