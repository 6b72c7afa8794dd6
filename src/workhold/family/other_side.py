"""The other side of a part: what is asked for it once it is turned over for the second operation.

Turned over about its y axis, a part shows the mirrored outline, and whatever was said of it in its own coordinates is
mirrored with it: faces, zones, loads, and its zero, which stays the same point of the part.
"""

from __future__ import annotations

import numpy as np
from attrs import evolve
from numpy.typing import NDArray

from workhold.model.load import ANY_DIRECTION, Load
from workhold.model.part_zero import PartZero
from workhold.model.query import Query
from workhold.model.restrictions import Restrictions, zone_of
from workhold.model.workpiece import Workpiece

__all__ = ["OTHER_SIDE", "other_side", "zero_of_other_side"]

# What stands behind the name of a part that is turned over.
OTHER_SIDE = "side 2"


def mirrored(loop: NDArray[np.float64]) -> NDArray[np.float64]:
    """Vertices (N, 3) of x, y and bulge with x the other way round."""
    return np.asarray(loop * np.array([-1.0, 1.0, -1.0]) + 0.0)


def mirrored_load(load: Load) -> Load:
    """A load on the part as it acts when the part is turned over."""
    low, high = load.directions
    directions = ANY_DIRECTION if (low, high) == ANY_DIRECTION else (180.0 - high, 180.0 - low)
    return evolve(load, points=[(-x, y) for x, y in load.points], directions=directions, moment=0.0 - load.moment)


def segment_numbers(workpiece: Workpiece) -> dict[int, int]:
    """For each segment of a part its number in the part turned over: its loops run the other way round."""
    out, first = dict[int, int](), 0
    for loop in workpiece.loops:
        out |= {first + k: first + len(loop) - 1 - k for k in range(len(loop))}
        first += len(loop)
    return out


def other_side(query: Query) -> Query:
    """What is asked for a part, for the same part turned over; angles in the vise stay as they are.

    Examples
    --------
    >>> from workhold import Vise, Workpiece
    >>> part = Workpiece.from_loops("wedge", [[[0, 0, 0], [40, 0, 0], [10, 30, 0]]])
    >>> turned = other_side(Query(part, Vise(pitch=10, columns=1, peg_radius=3), restrictions=Restrictions(avoid=(1,))))
    >>> turned.workpiece.name, turned.workpiece.loops[0][:, 0].tolist(), turned.restrictions.avoid
    ('wedge, side 2', [0.0, -10.0, -40.0], (1,))
    """
    part, asked = query.workpiece, query.restrictions
    loops = [mirrored(loop) for loop in part.loops]
    numbers = segment_numbers(part)
    return evolve(
        query,
        workpiece=Workpiece.from_loops(f"{part.name}, {OTHER_SIDE}", loops, departure=part.departure),
        restrictions=Restrictions(
            # A number that no face has is refused where the part as it is drawn is asked for.
            avoid=[numbers.get(number, number) for number in asked.avoid],
            zones=[zone_of(mirrored(zone.loop).tolist()) for zone in asked.zones],
            angles=asked.angles,
        ),
        loads=[mirrored_load(load) for load in query.loads],
    )


def zero_of_other_side(zero: PartZero) -> PartZero:
    """A part's zero in the coordinates of the part turned over: the same point of the part."""
    x, y = zero.point
    return PartZero((0.0 - x, y), zero.words)
