"""What acts on the part in space: loads with their heights, forces of a program, and the jaw force needed.

The cutting forces of a program are loads with heights, the thrust of drills and the pull of helices. For each
tool, what mills and what drills are loads of their own, with every force that it has; where it has more than
a few, with the largest. A path counts as the hull of its places. Arcs are taken in polygons around them, so
that nothing is less than it is, and a force may act in any direction.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from math import isfinite

import numpy as np
from attrs import evolve
from numpy.typing import NDArray

from workhold.conventions import AGREEMENT
from workhold.errors import InputError
from workhold.limits import real, refuse_strong
from workhold.model.cutting_forces import CuttingForces
from workhold.model.cutting_tool import ANY
from workhold.model.program import Program
from workhold.model.query import Query
from workhold.model.requirements import Load
from workhold.model.support_request import SpatialLoad
from workhold.statics.path_pieces import all_pieces, around_arcs, hull_of
from workhold.supports.forces import PegForces, largest_over

__all__ = ["WeakJawError", "acting_on", "checked_force", "cutting_loads", "needed_jaw_force", "spatial"]

IntArray = NDArray[np.int64]
# Forces of one tool that are loads of their own.
MOST_FORCES = 8


class WeakJawError(InputError):
    """A jaw force that is too small for a load."""


def spatial(loads: Iterable[Load | SpatialLoad], thickness: float) -> tuple[SpatialLoad, ...]:
    """Loads as they act in space, with their heights written out."""
    every = (load if isinstance(load, SpatialLoad) else SpatialLoad.of(load) for load in loads)
    return tuple(load.at_height(thickness) for load in every)


def needed_jaw_force(pegs: PegForces, loads: Sequence[SpatialLoad], jaw_force: float | None) -> float:
    """The jaw force asked for, or the one that keeps all pegs in contact under every load.

    Raises
    ------
    WeakJawError
        When the one asked for is too small, naming the load.
    """
    needs = [needed_for(pegs, load) for load in loads]
    if jaw_force is None:
        return max(needs, default=0.0)
    for load, need in zip(loads, needs, strict=True):
        if need > jaw_force * (1 + AGREEMENT):
            name = f"the load '{load.name}'" if load.name else "a load"
            raise WeakJawError(
                f"a jaw force of {jaw_force:g} N lets a peg lose contact under {name}, which takes "
                f"{need:.6g} N: give more, or leave it out."
            )
    return float(jaw_force)


def needed_for(pegs: PegForces, load: SpatialLoad) -> float:
    """The jaw force in N above which no peg lets go under a load, as ``statics.loads`` has it.

    Peg i presses with a_i + F h_i, where a_i balances the load and h_i > 0.
    """
    if load.force == 0.0 and load.moment == 0.0:
        return 0.0
    _, _, moment, closing = pegs.answers.T
    worst = 0.0
    for point in (load.points if load.force else ()) or (tuple(pegs.center),):
        x, y = pegs.at(np.array(point)).T
        asked = load.force * largest_over(-x, -y, load.directions) - load.moment * moment
        worst = max(worst, float((asked / closing).max()))
    return worst


def checked_force(jaw_force: float | None) -> float | None:
    """A jaw force in N, or None.

    Raises
    ------
    InputError
        For one that is negative or no number.
    """
    if jaw_force is None:
        return None
    if not (isfinite(real(jaw_force)) and real(jaw_force) >= 0):
        raise InputError(f"jaw force {real(jaw_force):g} cannot be used: give 0 or more.")
    refuse_strong("jaw force", real(jaw_force))
    return real(jaw_force)


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
