"""The cutting forces of a program as loads in space: with heights, drill thrust and the pull of helices.

For each tool, what mills and what drills are loads of their own, with every force that it has; where it has
more than a few, with the largest. A path counts as the hull of its places. Arcs are taken in polygons around
them, so that nothing is less than it is, and a force may act in any direction.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from attrs import evolve
from numpy.typing import NDArray

from workhold.model.cutting_data import ANY
from workhold.model.cutting_forces import CuttingForces
from workhold.model.program import Program
from workhold.model.query import Query
from workhold.model.requirements import Load
from workhold.model.support_request import SpatialLoad
from workhold.statics.path_pieces import all_pieces, around_arcs, hull_of

__all__ = ["acting_on", "cutting_loads"]

IntArray = NDArray[np.int64]
# Forces of one tool that are loads of their own.
MOST_FORCES = 8


def acting_on(query: Query, thickness: float) -> tuple[Load | SpatialLoad, ...]:
    """The loads of a query and those that its program makes on a part of a thickness in mm."""
    return (*query.loads, *(() if query.program is None else cutting_loads(query.program, thickness)))


def cutting_loads(program: Program, thickness: float) -> tuple[SpatialLoad, ...]:
    """The loads of a program on a part of a thickness in mm; none without forces."""
    forces = program.forces
    if forces is None:
        return ()
    found = list[SpatialLoad]()
    acts = (forces.torque > 0.0) | (forces.force > 0.0)
    for tool in program.tools:
        own = acts & (program.moves.tool == tool)
        for drills, word in ((False, "milling"), (True, "drilling")):
            rows = np.flatnonzero(own & ((forces.force == 0.0) == drills))
            for group in alike(forces, rows):
                found += loads_of(program, forces, group, thickness, f"T{tool} {word}")
    return tuple(found)


def alike(forces: CuttingForces, rows: IntArray) -> Iterator[IntArray]:
    """Moves of one force each; all together where there are more than a few forces."""
    values, which = np.unique(forces.torque[rows], return_inverse=True)
    if len(values) > MOST_FORCES:
        yield rows
    else:
        yield from (rows[which == k] for k in range(len(values)))


def loads_of(
    program: Program, forces: CuttingForces, rows: IntArray, thickness: float, name: str
) -> Iterator[SpatialLoad]:
    """The loads of some moves, with the torque either way round."""
    moves = program.moves
    only = np.zeros(len(moves))
    only[rows] = 1.0
    none = np.zeros(len(moves))
    any_way = CuttingForces(only, none, np.zeros((len(moves), 2)), none, ANY)
    pieces = all_pieces(evolve(program, forces=any_way), (0.0, 0.0))
    is_arc = pieces.radius > 0.0
    x, y = around_arcs(pieces, np.flatnonzero(is_arc))
    points = np.concatenate(
        [np.stack([pieces.x[~is_arc], pieces.y[~is_arc]], axis=1), np.stack([x.ravel(), y.ravel()], axis=1)]
    )
    tip = np.concatenate([moves.start[rows, 2], moves.end[rows, 2]]) + np.tile(forces.height[rows], 2)
    # What a tool does below the part or over it acts at its lower or upper side.
    heights = np.clip([tip.min(), tip.max()], 0.0, thickness)
    load = SpatialLoad(
        points=hull_of(points).tolist(),
        force=float(forces.force[rows].max()),
        heights=(float(heights[0]), float(heights[1])),
        axial=(float(forces.axial[rows, 0].min()), float(forces.axial[rows, 1].max())),
        moment=float(forces.torque[rows].max()),
        name=name,
    )
    yield load
    yield evolve(load, moment=-load.moment)
