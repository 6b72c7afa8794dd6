"""Dowel pins and the plates drilled for them: limits of pins and holes, and places of dowel and bolt holes.

Places on a plate are in mm in the plate's own frame: the origin is its hole A1, and x and y run as in the
vise.

Glossary
--------
limits : smallest and largest diameter that a maker may deliver, in mm.
position : largest distance in mm, in any direction, of the centre of a hole from its place on the lattice.
clearance : diameter of a hole minus that of the pin in it; a pin wider than its hole is pressed in and has
    none.

A design assumes that every peg is a circle of the peg radius ρ about its place on the lattice. Let a pin of
diameter d be in a hole of diameter D whose centre has the error p. The pin can be anywhere in its hole, so
the error of its centre is at most p + max(0, D - d)/2, and the error of its surface, in any direction, is at
most

    p + max(0, D - d)/2 + |d - 2ρ|/2 .

That grows with D and is convex in d, hence largest at the largest hole and at one of the pin's two limits:
:func:`compute_peg_error`. It is the sum of the worst cases, as drawings add them up (ISO 286-1:2010 defines limits
and clearance).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot, isfinite

from attrs import frozen

from workhold.conventions import SAME_SIZE
from workhold.errors import InputError
from workhold.fixels.carrier import make_hole_name
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.segment import Box, Point
from workhold.units import MILLIMETRE, Unit

__all__ = [
    "Bolts",
    "DowelSize",
    "DowelFit",
    "JawPlate",
    "Limits",
    "describe_fit",
    "list_jaw_plates",
    "compute_peg_error",
    "place_plates_in_drawing",
    "refuse_limits",
]

Limits = tuple[float, float]
# ISO 286-2:2010, class H7: up to this nominal diameter in mm a hole may be so many mm wider and no narrower.
H7 = ((3.0, 0.010), (6.0, 0.012), (10.0, 0.015), (18.0, 0.018), (30.0, 0.021), (50.0, 0.025))
# A pin whose diameter is this far from that of the peg, in proportion, is not the peg: a radius was given for
# a diameter.
FAR = 0.1


# Between two plates, in mm.
PLATE_GAP = 20.0


@frozen
class DowelSize:
    """A size of a standard's dowel pins.

    Parameters
    ----------
    nominal : diameter by which the size is called, in mm.
    pin : limits of the pin, in mm.
    hole : limits of the hole recommended with it, in mm; None where the standard recommends none.
    """

    nominal: float
    pin: Limits
    hole: Limits | None = None


@frozen
class DowelFit:
    """A pin in its hole.

    Parameters
    ----------
    pin, hole : smallest and largest diameters in mm.
    position : largest distance in mm of the centre of a hole from its place.
    position_assumed : whether ``position`` is assumed because none was given.
    standard : standard of the pin, such as "ISO 2338 m6"; empty if none is named.
    """

    pin: Limits
    hole: Limits
    position: float
    position_assumed: bool
    standard: str = ""


def name_hole_class(nominal: float, hole: Limits) -> str | None:
    """Return "H7" if the limits of a hole are those of H7 for its nominal diameter in mm, else None.

    >>> name_hole_class(6.0, (6.0, 6.012)), name_hole_class(6.0, (5.987, 6.0))
    ('H7', None)
    """
    wider = next((wider for largest, wider in H7 if nominal <= largest), None)
    return (
        None
        if wider is None or max(abs(hole[0] - nominal), abs(hole[1] - nominal - wider)) > SAME_SIZE
        else "H7"
    )


def describe_fit(fit: DowelFit, nominal: float) -> str:
    """Return a few words that name a pin and how it sits in its hole.

    Parameters
    ----------
    nominal : diameter of the peg, in mm.

    Examples
    --------
    >>> describe_fit(DowelFit((6.004, 6.012), (6.0, 6.012), 0.01, True, "ISO 2338 m6"), 6.0)
    'ISO 2338 m6 in H7'
    >>> describe_fit(DowelFit((6.003, 6.009), (5.987, 6.0), 0.01, True, "ASME B18.8.5M"), 6.0)
    'ASME B18.8.5M, pressed in'
    """
    hole = name_hole_class(nominal, fit.hole)
    if hole is not None:
        return f"{fit.standard or 'pin'} in {hole}"
    how = (
        "pressed in"
        if fit.pin[0] >= fit.hole[1]
        else "goes in by hand"
        if fit.pin[1] <= fit.hole[0]
        else "tight or loose"
    )
    return f"{fit.standard or 'pin'}, {how}"


def compute_peg_error(peg_radius: float, pin: Limits, hole: Limits, position: float) -> float:
    """Return the largest error in mm of a peg's surface along a normal, by the formula at the head of this
    file.

    Parameters
    ----------
    peg_radius : the radius designed with, in mm.
    pin, hole : limits of both diameters, in mm.
    position : of the hole, in mm.

    Examples
    --------
    A 6 mm pin of 5.982 to 6.000 mm (h8) in a hole of 6.000 to 6.012 mm (H7), placed to 0.010 mm. The
    smallest pin in the widest hole is 0.015 mm off its hole's centre and its surface 0.009 mm nearer to it.

    >>> round(compute_peg_error(3.0, (5.982, 6.0), (6.0, 6.012), 0.010), 6)
    0.034
    """
    return (
        position + max(max(0.0, hole[1] - diameter) + abs(diameter - 2 * peg_radius) for diameter in pin) / 2
    )


def refuse_limits(name: str, limits: Limits, peg_radius: float) -> None:
    """Raise InputError for limits in mm that cannot be those of a pin or hole for a peg of this radius.

    Parameters
    ----------
    name : name of the limits in the message, with which its sentence begins.

    Raises
    ------
    InputError
        For limits that are not positive, the wrong way round, or far from the peg's diameter.
    """
    low, high = limits
    if not (isfinite(low) and isfinite(high) and low > 0):
        raise InputError(
            f"{name} {low:g} to {high:g} mm is not a range of diameters: give two positive lengths."
        )
    if low > high:
        raise InputError(
            f"{name} {low:g} to {high:g} mm is the wrong way round: give the smallest diameter first."
        )
    if max(abs(low - 2 * peg_radius), abs(high - 2 * peg_radius)) > FAR * 2 * peg_radius:
        raise InputError(
            f"{name} {low:g} to {high:g} mm is not that of a peg of radius {peg_radius:g} mm: correct one of "
            "them, and mind that the one is a diameter, the other a radius."
        )


@frozen
class Bolts:
    """The bolts that hold a plate: the diameter of their holes and where these are, from hole A1 of the
    plate, in mm.
    """

    diameter: float
    places: tuple[Point, ...]


@frozen
class JawPlate:
    """A plate to be drilled.

    Parameters
    ----------
    title : name of the carrier, such as "left jaw".
    outline : of the plate.
    hole_diameter : of the dowel holes.
    holes : name and centre of each dowel hole that is drilled; blocked holes are left out.
    bolts : bolts that hold the plate; None if none are given.
    """

    title: str
    outline: Box
    hole_diameter: float
    holes: tuple[tuple[str, Point], ...]
    bolts: Bolts | None


def list_jaw_plates(
    toolkit: Toolkit,
    *,
    hole_diameter: float | None = None,
    edge: float | None = None,
    bolts: Bolts | None = None,
    unit: Unit = MILLIMETRE,
) -> tuple[JawPlate, ...]:
    """Return a plate to be drilled for each of ``toolkit.plates``, in that order.

    Each is in a frame of its own with the origin at its hole A1.

    Parameters
    ----------
    hole_diameter : diameter of the dowel holes, in mm; None for the diameter of the pegs.
    edge : distance in mm from the centres of the outermost dowel holes to the plate's edges; None for half a
        pitch.
    bolts : bolts, the same in every plate; None for none.
    unit : of lengths in messages.

    Raises
    ------
    InputError
        For a toolkit without a number of columns or rows, and holes that meet one another or leave the plate.

    Examples
    --------
    >>> from workhold import Vise
    >>> left, right = list_jaw_plates(Vise(pitch=10, columns=2, peg_radius=3, rows=3))
    >>> left.outline, [name for name, _ in right.holes[:3]]
    (Box(x0=-5.0, y0=-5.0, x1=15.0, y1=25.0), ['R-A1', 'R-B1', 'R-A2'])
    """
    plates = []
    for carrier in toolkit.plates:
        if carrier.rows is None or carrier.columns is None:
            raise InputError("how many columns and rows of holes the plates have is not given: give both.")
        diameter = 2 * carrier.peg_radius if hole_diameter is None else hole_diameter
        if not 0 < diameter < min(carrier.pitch):
            raise InputError(
                f"dowel holes of {unit.format_short_length(diameter)} {unit.abbreviation} do not fit a lattice whose "
                f"holes are {unit.format_short_length(min(carrier.pitch))} {unit.abbreviation} apart: give a diameter "
                "between 0 and that."
            )
        margins = [pitch / 2 if edge is None else edge for pitch in carrier.pitch]
        if not all(isfinite(length) and length > diameter / 2 for length in margins):
            raise InputError(
                "the plate's edge would cut its outermost dowel holes: give a larger distance to the edge."
            )
        (pitch_x, pitch_y), (out_x, out_y) = carrier.pitch, margins
        outline = Box(
            -out_x, -out_y, (carrier.columns - 1) * pitch_x + out_x, (carrier.rows - 1) * pitch_y + out_y
        )
        plate = JawPlate(
            carrier.title,
            outline,
            diameter,
            tuple(
                (make_hole_name(carrier.name, column, row), (column * pitch_x, row * pitch_y))
                for row in range(carrier.rows)
                for column in range(carrier.columns)
                if not carrier.is_blocked(column, row)
            ),
            bolts,
        )
        refuse_bolts(plate, unit)
        plates.append(plate)
    return tuple(plates)


def refuse_bolts(plate: JawPlate, unit: Unit) -> None:
    """Raise InputError if a bolt hole leaves the plate, or overlaps a dowel hole or another bolt hole."""
    bolts = plate.bolts
    if bolts is None:
        return
    if not (isfinite(bolts.diameter) and bolts.diameter > 0):
        raise InputError(
            f"bolt holes of {unit.format_short_length(bolts.diameter)} {unit.abbreviation} cannot be drilled: give more "
            "than 0."
        )
    radius, apart = bolts.diameter / 2, (bolts.diameter + plate.hole_diameter) / 2
    for number, (x, y) in enumerate(bolts.places, 1):
        name = f"bolt {number} at {unit.format_short_length(x)},{unit.format_short_length(y)}"
        if not plate.outline.contains(Box.from_center((x, y), 2 * radius, 2 * radius)):
            raise InputError(f"{name} leaves the {plate.title}'s plate: move it, or make the plate larger.")
        for hole, (u, v) in plate.holes:
            if hypot(x - u, y - v) < apart:
                raise InputError(f"{name} runs into dowel hole {hole}: move it, or block that hole.")
        for other, (u, v) in enumerate(bolts.places[: number - 1], 1):
            if hypot(x - u, y - v) < bolts.diameter:
                raise InputError(f"{name} runs into bolt {other}: move one of them.")


def place_plates_in_drawing(plates: Sequence[JawPlate]) -> list[float]:
    """Return x in mm of each plate's hole A1 in a drawing of all plates side by side; the first is at 0."""
    places, right = [], 0.0
    for number, plate in enumerate(plates):
        places.append(right + PLATE_GAP - plate.outline.x0 if number else 0.0)
        right = places[-1] + plate.outline.x1
    return places
