"""Part zero: the point of a part that a machinist programs from, X0 Y0.

Where nothing is asked for it is the origin of the drawing if that lies on the part's outside dimensions or within them,
because the CAM system took the same drawing; else it is the lower left corner of the part as drawn. A drawing far from its
origin, such as a part cut out of a large assembly, so never gives a zero beside the machine.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

from attrs import frozen

from workhold.conventions import AGREEMENT
from workhold.errors import InputError
from workhold.geometry.intersect import bounding_box
from workhold.geometry.segment import Arc, Point
from workhold.limits import refuse_long
from workhold.model.workpiece import Workpiece
from workhold.units import MILLIMETRE, Unit

__all__ = ["PartZero", "hole_centers", "part_zero"]

WAYS = "give corner, centre, hole and its number, or a point of the drawing as X,Y"


@frozen
class PartZero:
    """A part's zero.

    Parameters
    ----------
    point : in mm in the part's coordinates, which are those of its drawing.
    words : what it is, such as "centre of hole 2".
    """

    point: Point
    words: str


def part_zero(workpiece: Workpiece, asked: str | Sequence[float] | None = None, unit: Unit = MILLIMETRE) -> PartZero:
    """The zero of a part.

    Parameters
    ----------
    asked : "corner" (the lower left one of the outside dimensions), "centre" (of the same), "hole N" (its centre; holes are
        counted from 1 as in the inset of the setup sheet), "X,Y" or two numbers, or None for what the module's head says.
    unit : of the numbers.

    Raises
    ------
    InputError
        For anything else, and a hole that the part does not have.

    Examples
    --------
    >>> far = Workpiece.from_loops("plate", [[[2000, 0, 0], [2040, 0, 0], [2040, 20, 0], [2000, 20, 0]]])
    >>> [part_zero(far, asked).point for asked in (None, "centre", "2010,5")]
    [(2000.0, 0.0), (2020.0, 10.0), (2010.0, 5.0)]
    """
    x0, y0, x1, y1 = workpiece.bounds
    if asked is None:
        within = min(-x0, -y0, x1, y1) >= -AGREEMENT
        return PartZero((0.0, 0.0), "origin of the drawing") if within else part_zero(workpiece, "corner")
    if not isinstance(asked, str):
        return PartZero(given_point(list(map(str, asked)), str(asked), unit), "point given")
    word = asked.strip().lower()
    if word == "corner":
        return PartZero((x0, y0), "lower left corner as drawn")
    if word in ("centre", "center"):
        return PartZero(workpiece.center, "centre of the outside dimensions")
    if word.startswith("hole"):
        number, centers = word.removeprefix("hole").strip(), hole_centers(workpiece)
        if number.isascii() and number.isdigit() and 0 < int(number[:9]) <= len(centers):
            return PartZero(centers[int(number) - 1], f"centre of hole {int(number)}")
        count = {0: "no hole", 1: "one hole"}.get(len(centers), f"holes 1 to {len(centers)}")
        raise InputError(f"part zero {asked[:40]!r} cannot be used: the part has {count}; {WAYS}.")
    return PartZero(given_point(asked.split(","), repr(asked[:40]), unit), "point given")


def given_point(numbers: Sequence[str], words: str, unit: Unit) -> Point:
    """The point in mm that two numbers tell.

    Raises
    ------
    InputError
        When they are not two finite numbers, or are beyond all lengths.
    """
    try:
        x, y = (unit.length(float(number)) for number in numbers)
    except (ValueError, OverflowError):
        x = y = float("nan")
    if not (isfinite(x) and isfinite(y)):
        raise InputError(f"part zero {words} is not known: {WAYS}.")
    for value in (x, y):
        refuse_long("part zero", value)
    return x, y


def hole_centers(workpiece: Workpiece) -> list[Point]:
    """The centre of each hole, in the order of the part's loops: of a round one that of its circle, else the middle of its
    outside dimensions.
    """
    outer = len(workpiece.loops[0])
    round_ones = {
        face.number: face.segment.center
        for face in workpiece.faces
        if face.number >= outer and isinstance(face.segment, Arc) and face.segment.is_full
    }
    centers, number = [], outer
    for loop in workpiece.loop_segments[1:]:
        boxes = [bounding_box(segment) for segment in loop]
        middle = [(min(box[k] for box in boxes) + max(box[k + 2] for box in boxes)) / 2 for k in (0, 1)]
        x, y = round_ones.get(number, middle)
        centers.append((float(x), float(y)))
        number += len(loop)
    return centers
