"""The plates of a toolkit as they are drilled: dowel holes on the lattice, and holes for the bolts that hold each plate.

Places are in mm in a frame of each plate's own, whose origin is its hole A1; x and y run as in the vise.
"""

from __future__ import annotations

from math import hypot, isfinite

from attrs import frozen

from workhold.errors import InputError
from workhold.fixels.holes import hole_name
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.box import Box
from workhold.geometry.segment import Point
from workhold.units import MILLIMETRE, Unit

__all__ = ["Bolts", "JawPlate", "jaw_plates"]


@frozen
class Bolts:
    """The bolts that hold a plate: the diameter of their holes and where these are, from hole A1 of the plate, in mm."""

    diameter: float
    places: tuple[Point, ...]


@frozen
class JawPlate:
    """A plate to be drilled.

    Parameters
    ----------
    title : of its carrier, such as "left jaw".
    outline : of the plate.
    hole_diameter : of the dowel holes.
    holes : the name and the centre of each dowel hole; blocked ones are not drilled.
    bolts : that hold it, if any are given.
    """

    title: str
    outline: Box
    hole_diameter: float
    holes: tuple[tuple[str, Point], ...]
    bolts: Bolts | None


def jaw_plates(
    toolkit: Toolkit,
    *,
    hole_diameter: float | None = None,
    edge: float | None = None,
    bolts: Bolts | None = None,
    unit: Unit = MILLIMETRE,
) -> tuple[JawPlate, ...]:
    """The plates of a toolkit, a plate for each carrier that has one of its own.

    Parameters
    ----------
    hole_diameter : of the dowel holes, in mm; that of the pegs if None.
    edge : from the centres of the outermost dowel holes to the plate's edges, in mm; half a pitch if None.
    bolts : the same in every plate.
    unit : of lengths in messages.

    Raises
    ------
    InputError
        For a toolkit without a number of columns or rows, and holes that meet one another or leave the plate.

    Examples
    --------
    >>> from workhold import Vise
    >>> left, right = jaw_plates(Vise(pitch=10, columns=2, peg_radius=3, rows=3))
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
                f"dowel holes of {unit.figure(diameter)} {unit.abbreviation} do not fit a lattice whose holes are "
                f"{unit.figure(min(carrier.pitch))} {unit.abbreviation} apart: give a diameter between 0 and that."
            )
        beyond = [pitch / 2 if edge is None else edge for pitch in carrier.pitch]
        if not all(isfinite(length) and length > diameter / 2 for length in beyond):
            raise InputError(
                "the plate's edge would cut its outermost dowel holes: give a larger distance to the edge."
            )
        (pitch_x, pitch_y), (out_x, out_y) = carrier.pitch, beyond
        outline = Box(-out_x, -out_y, (carrier.columns - 1) * pitch_x + out_x, (carrier.rows - 1) * pitch_y + out_y)
        plate = JawPlate(
            carrier.title,
            outline,
            diameter,
            tuple(
                (hole_name(carrier.name, column, row), (column * pitch_x, row * pitch_y))
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
    """Refuse bolts that leave a plate or run into a hole.

    Raises
    ------
    InputError
        Naming the bolt and what it runs into.
    """
    bolts = plate.bolts
    if bolts is None:
        return
    if not (isfinite(bolts.diameter) and bolts.diameter > 0):
        raise InputError(
            f"bolt holes of {unit.figure(bolts.diameter)} {unit.abbreviation} cannot be drilled: give more than 0."
        )
    radius, apart = bolts.diameter / 2, (bolts.diameter + plate.hole_diameter) / 2
    for number, (x, y) in enumerate(bolts.places, 1):
        name = f"bolt {number} at {unit.figure(x)},{unit.figure(y)}"
        if not plate.outline.contains(Box.about((x, y), 2 * radius, 2 * radius)):
            raise InputError(f"{name} leaves the {plate.title}'s plate: move it, or make the plate larger.")
        for hole, (u, v) in plate.holes:
            if hypot(x - u, y - v) < apart:
                raise InputError(f"{name} runs into dowel hole {hole}: move it, or block that hole.")
        for other, (u, v) in enumerate(bolts.places[: number - 1], 1):
            if hypot(x - u, y - v) < bolts.diameter:
                raise InputError(f"{name} runs into bolt {other}: move one of them.")
