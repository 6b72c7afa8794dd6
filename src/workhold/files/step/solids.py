"""The solids of a STEP file, in mm, turned so that the chosen axis points up."""

from __future__ import annotations

import re
from collections.abc import Iterable
from math import isfinite
from typing import Any

from attrs import frozen

from workhold.errors import InputError
from workhold.files.questions import PART_NUMBER
from workhold.limits import MOST_LENGTH

__all__ = [
    "AXES",
    "Solid",
    "along",
    "axis_named",
    "chosen_solid",
    "lost_remarks",
    "numbered",
    "read_solids",
    "solid_remarks",
]

# What becomes x, y and up for each axis: the part is seen from the axis's far end, right-handed.
AXES = {"x": (1, 2, 0), "y": (2, 0, 1), "z": (0, 1, 2)}
SOLID_LIST = 10


@frozen
class Solid:
    """One solid of a file.

    Parameters
    ----------
    number : from 1, by decreasing volume.
    shape : Open CASCADE's solid, in mm.
    volume : in mm³.
    low, high : corners (x, y, z) of its bounding box in mm.
    """

    number: int
    shape: Any
    volume: float
    low: tuple[float, float, float]
    high: tuple[float, float, float]

    def __str__(self) -> str:
        size = " x ".join(f"{b - a:.6g}" for a, b in zip(self.low, self.high, strict=True))
        place = ", ".join(f"{round(a, 6) + 0.0:.6g}" for a in self.low)
        return f"solid {self.number} is {size} mm at ({place})"


def read_solids(content: bytes) -> tuple[Solid, ...]:
    """Every solid of a STEP file, wherever assemblies place it, by decreasing volume.

    Raises
    ------
    InputError
        For files that are no STEP, damaged, without a unit of length, or without a solid.
    """
    refuse_other_formats(content)
    shape = transferred(content)
    solids = numbered(sub_shapes(shape, "SOLID"))
    if not solids:
        if counted_in_text(content):
            raise InputError(
                "no solid of the STEP file can be read: repair it in a CAD program and export it again."
            )
        sheets = len(sub_shapes(shape, "FACE"))
        held = f"surfaces ({sheets}) but no solid" if sheets else "no solid"
        raise InputError(f"the STEP file holds {held}: export the part as a closed solid.")
    return solids


def numbered(shapes: Iterable[Any]) -> tuple[Solid, ...]:
    """Solids of Open CASCADE by decreasing volume.

    Raises
    ------
    InputError
        As :func:`measured`.
    """
    solids = sorted(map(measured, shapes), key=lambda solid: (-solid.volume, solid.low, solid.high))
    return tuple(Solid(k, s.shape, s.volume, s.low, s.high) for k, s in enumerate(solids, start=1))


def counted_in_text(content: bytes) -> int:
    """How many solids stand in the text of a STEP file, before assemblies repeat them."""
    return len(re.findall(rb"=\s*(?:MANIFOLD_SOLID_BREP|BREP_WITH_VOIDS|FACETED_BREP)\s*\(", content))


def lost_remarks(content: bytes, solids: tuple[Solid, ...]) -> list[str]:
    """What to say about solids that the library could not make of the file's text."""
    if counted_in_text(content) <= len(solids):
        return []
    return [
        f"The file names {counted_in_text(content)} solids, but only {len(solids)} could be read: "
        "check that yours "
        "is there."
    ]


def refuse_other_formats(content: bytes) -> None:
    """Refuses what is plainly no STEP file, is cut short, or has no unit (the library would take mm).

    Raises
    ------
    InputError
        Saying what it is.
    """
    if content.startswith(b"PK"):
        raise InputError("this is a compressed file, not a STEP file: unpack it first.")
    if b"ISO-10303-21" not in content[:4096]:
        raise InputError(
            "this is not a STEP file (it does not begin with ISO-10303-21): export the part as STEP."
        )
    if b"END-ISO-10303-21" not in content[-4096:]:
        raise InputError("the STEP file is cut short (it has no end mark): export or copy it again.")
    # Files with nothing in them have no unit either, and are distinguished later.
    if b"_REPRESENTATION" in content and b"LENGTH_UNIT" not in content:
        raise InputError("the STEP file does not give its unit of length: export it again, with units.")


def transferred(content: bytes) -> Any:
    """The shape that holds everything in the file.

    Raises
    ------
    InputError
        When the library cannot read it.
    """
    from io import BytesIO

    from OCP.IFSelect import IFSelect_ReturnStatus
    from OCP.STEPControl import STEPControl_Reader

    reader = STEPControl_Reader()
    try:
        status = reader.ReadStream("part", BytesIO(content))
        if status == IFSelect_ReturnStatus.IFSelect_RetDone and reader.TransferRoots():
            shape = reader.OneShape()
            if not shape.IsNull():
                return shape
    except Exception as error:  # a damaged file may fail anywhere inside the library
        raise InputError("the STEP file is damaged: open it in a CAD program and export it again.") from error
    if status != IFSelect_ReturnStatus.IFSelect_RetDone:
        raise InputError("the STEP file is damaged: open it in a CAD program and export it again.")
    raise InputError("the STEP file holds no solid: export the part as a closed solid.")


def sub_shapes(shape: Any, kind: str) -> list[Any]:
    """The "SOLID", "FACE", "WIRE", "EDGE" or "VERTEX" parts of a shape, each as often as it is used."""
    from OCP import TopAbs
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    cast = getattr(TopoDS, kind.capitalize())
    explorer = TopExp_Explorer(shape, getattr(TopAbs.TopAbs_ShapeEnum, f"TopAbs_{kind}"))
    found = []
    while explorer.More():
        found.append(cast(explorer.Current()))
        explorer.Next()
    return found


def measured(shape: Any) -> Solid:
    """A solid with its volume and bounding box; its number comes later.

    Raises
    ------
    InputError
        When it has no volume, or coordinates that leave no digits.
    """
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, properties)
    volume = abs(properties.Mass())
    low, high = bounding_box(shape)
    if not all(isfinite(value) and abs(value) <= MOST_LENGTH for value in (*low, *high)):
        raise InputError("a solid lies more than 1 km from the origin or has no end: check the part's unit.")
    if not (isfinite(volume) and volume > 1e-9):
        raise InputError("a solid has no volume: repair it in the CAD program and export it again.")
    return Solid(0, shape, volume, low, high)


def bounding_box(shape: Any) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Both corners of a shape's bounding box in mm, to rounding."""
    from OCP.Bnd import Bnd_Box
    from OCP.BRepBndLib import BRepBndLib

    box = Bnd_Box()
    BRepBndLib.AddOptimal_s(shape, box, False, False)
    low, high = box.CornerMin(), box.CornerMax()
    return (low.X(), low.Y(), low.Z()), (high.X(), high.Y(), high.Z())


def chosen_solid(solids: tuple[Solid, ...], number: int | None) -> Solid:
    """The solid of a number, or the largest.

    Raises
    ------
    InputError
        When there is no solid of that number.
    """
    if number is None:
        return solids[0]
    if not 1 <= number <= len(solids):
        have = "only one solid" if len(solids) == 1 else f"solids 1 to {len(solids)}"
        raise InputError(f"There is no part {number}: the file holds {have}, numbered by decreasing volume.")
    return solids[number - 1]


def solid_remarks(solids: tuple[Solid, ...], chosen: Solid, asked: int | None) -> list[str]:
    """What to say about several solids in one file."""
    if len(solids) == 1:
        return []
    more = f"; and {len(solids) - SOLID_LIST} smaller ones" if len(solids) > SOLID_LIST else ""
    because = "" if asked is not None else f", the largest (choose another with {PART_NUMBER})"
    listing = "; ".join(str(solid) for solid in solids[:SOLID_LIST])
    return [f"The file holds {len(solids)} solids: {listing}{more}. Solid {chosen.number} is used{because}."]


def axis_named(axis: str | None) -> str:
    """The name of an axis, z for None.

    Raises
    ------
    InputError
        When there is none of that name.
    """
    name = "z" if axis is None else axis.strip().lower().removeprefix("+")
    if name.removeprefix("-") not in AXES:
        raise InputError(f"the axis '{name[:40]}' is not known: give x, y or z, or -x, -y or -z.")
    return name


def along(shape: Any, axis: str) -> Any:
    """A shape turned so that an axis of the file points up; see :func:`turn_along`."""
    from OCP.TopLoc import TopLoc_Location

    return shape.Moved(TopLoc_Location(turn_along(axis)))


def turn_along(axis: str) -> Any:
    """The turn that makes an axis of the file point up; coordinates only change places and signs.

    With a minus the part lies on its other side, turned over like a page: what pointed to x points to -x.
    """
    from OCP.gp import gp_Trsf

    signs = (-1.0, 1.0, -1.0) if axis.startswith("-") else (1.0, 1.0, 1.0)
    sources = zip(signs, AXES[axis.lstrip("-")], strict=True)
    rows = [[sign if column == source else 0.0 for column in range(3)] + [0.0] for sign, source in sources]
    turn = gp_Trsf()
    turn.SetValues(*rows[0], *rows[1], *rows[2])
    return turn
