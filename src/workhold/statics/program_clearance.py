"""How near the tools of a program come to what holds the part: to pegs, clamps with their bodies, and walls.

An element of a fixture is a disc, a capsule or a half plane up to the height of the pegs, or between heights
of its own. Its clearance is the least distance of the axis of a tool's cylinder to it, less the cylinder's
radius, over all that the program sweeps at these heights.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from workhold.contact.swept import Swept, find_swept_below, find_swept_beside_carrier, path_of
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.symmetry import rotate_vectors
from workhold.model.fixture_table import FixtureTable, peg_places
from workhold.model.program import PathVertex, Program
from workhold.model.result import Result
from workhold.model.workpiece import Workpiece

__all__ = ["NearestMove", "Passing", "element_name", "find_nearest_moves", "find_nearest_passing", "renamed"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


@frozen(eq=False)
class NearestMove:
    """Where the tools of a program come nearest to each of N fixtures.

    Parameters
    ----------
    clearance : (N,) in mm, infinite where nothing is swept at such heights.
    line, tool : (N,) of the program, -1 there.
    contact : (N,) number of the contact that it comes near to: of a peg, a clamp, or an end on a wall.
    span, low : (N,) number of the span of what is swept, and whether that is what is swept below the part.
    """

    clearance: Array
    line: IntArray
    tool: IntArray
    contact: IntArray
    span: IntArray
    low: NDArray[np.bool_]


def find_nearest_moves(
    table: FixtureTable, workpiece: Workpiece, toolkit: Toolkit, program: Program, peg_height: float
) -> NearestMove:
    """Where the tools of a program come nearest to each fixture of a table; ``peg_height`` in mm."""
    count = len(table)
    line, tool, contact, span = (np.full(count, -1) for _ in range(4))
    found = NearestMove(np.full(count, inf), line, tool, contact, span, np.zeros(count, np.bool_))
    x, y = peg_places(table, toolkit, workpiece)
    bolts = toolkit.compute_hole_places(table.arrangement, table.column, table.row, np.zeros(count))
    carriers = toolkit.find_peg_carriers(table.arrangement)

    def seen(points: tuple[Array, Array], rows: IntArray, k: int) -> Array:
        """Places (R, 2) of a contact of some rows in the part's coordinates."""
        dx, dy = (values[rows, k] - table.position[rows, axis] for axis, values in enumerate(points))
        return np.stack(rotate_vectors(dx, dy, -table.theta[rows]), axis=1)

    for k in range(toolkit.peg_count):
        for number, carrier in enumerate(toolkit.carriers):
            rows, swept = (
                np.flatnonzero(carriers[:, k] == number),
                find_swept_beside_carrier(program, peg_height, carrier),
            )
            if not carrier.contact.is_placed:
                take(found, rows, k, swept, *beside_wall(table, rows, swept))
                continue
            centers = seen((x, y), rows, k)
            behind = seen(bolts, rows, k) if carrier.has_body_behind else centers
            reach, span = swept.nearest(centers, behind)
            take(found, rows, k, swept, reach - carrier.peg_radius, span)
            if carrier.body_radius > carrier.peg_radius:
                below = find_swept_below(program, 0.0)
                reach, span = below.nearest(centers, centers)
                take(found, rows, k, below, reach - carrier.body_radius, span, below=True)
    return found


@frozen
class Passing:
    """Where the tools of a program come nearest to one fixture.

    Parameters
    ----------
    distance : from the nearest of what holds the part, in mm.
    line, tool : of the program.
    element : what it is near to, such as "peg L-A1".
    contact : number of that among the contacts.
    path : of the tool's axis there, one segment, arc or point in the part's coordinates, mm.
    radius : of the tool's cylinder there, in mm.
    """

    distance: float
    line: int
    tool: int
    element: str
    contact: int
    path: tuple[PathVertex, ...]
    radius: float

    def in_holes(self, before: Sequence[str], after: Sequence[str]) -> Passing:
        """The passing with the holes of contacts renamed, contact by contact."""
        return evolve(self, element=renamed(self.element, before, after))


def renamed(element: str, before: Sequence[str], after: Sequence[str]) -> str:
    """The name of what a contact stands on, such as "peg L-A1", with its hole renamed.

    >>> renamed("peg B2", ["A1", "B2"], ["C1", "D2"]), renamed("clamp A1", ["clamp A1"], ["clamp C1"])
    ('peg D2', 'clamp C1')
    """
    names = dict(zip(before, after, strict=True))
    noun, _, hole = element.rpartition(" ")
    return names[element] if element in names else f"{noun} {names[hole]}" if hole in names else element


def find_nearest_passing(result: Result, index: int) -> Passing | None:
    """Where the tools of a result's program come nearest to the fixture of an index.

    None without a program, and where no tool comes down to the height of pegs.
    """
    if result.query.passed is None:
        return None
    table, toolkit = result.table.take(slice(index, index + 1)), result.toolkit
    near = find_nearest_moves(table, result.workpiece, toolkit, *result.query.passed)
    if near.line[0] < 0:
        return None
    contact, span = int(near.contact[0]), int(near.span[0])
    program, height = result.query.passed
    standing = toolkit.carriers[toolkit.arrangements[int(table.arrangement[0])].carriers[contact]]
    swept = (
        find_swept_below(program, 0.0)
        if near.low[0]
        else find_swept_beside_carrier(program, height, standing)
    )
    return Passing(
        float(near.clearance[0]),
        int(near.line[0]),
        int(near.tool[0]),
        element_name(table, toolkit, 0, contact),
        contact,
        path_of(swept.tree.rows[span]),
        float(swept.tree.radius[span]),
    )


def element_name(table: FixtureTable, toolkit: Toolkit, row: int, contact: int) -> str:
    """What a contact of a fixture of a table stands on, such as "peg L-A1", "clamp row 3" or "fence"."""
    arrangement = toolkit.arrangements[int(table.arrangement[row])]
    carrier = toolkit.carriers[arrangement.carriers[contact]]
    if not carrier.contact.is_placed:
        return carrier.noun
    place = carrier.place_name(int(table.column[row, contact]), int(table.row[row, contact]))
    return f"{carrier.peg} {place}" if carrier.has_lattice else place


def beside_wall(table: FixtureTable, rows: IntArray, swept: Swept) -> tuple[Array, IntArray]:
    """Least reach (R,) to a wall of some rows of a table, and the spans (R,) that it is to."""
    # Of each hull edge on the wall there is one pose but for the place along it.
    poses = np.stack([table.theta[rows], -table.position[rows, 1]], axis=1)
    different, inverse = np.unique(poses, axis=0, return_inverse=True)
    near = [swept.above(theta, height) for theta, height in different.tolist()]
    reach, span = np.array([one for one, _ in near]), np.array([one for _, one in near], np.int64)
    inverse = inverse.ravel()
    return reach[inverse], span[inverse]


def take(
    found: NearestMove,
    rows: IntArray,
    contact: int,
    swept: Swept,
    clearance: Array,
    span: IntArray,
    below: bool = False,
) -> None:
    """Takes over clearances (R,) of a contact of some rows where they are less than those known.

    ``below`` says whether ``swept`` is what is swept below the part.
    """
    less = (clearance < found.clearance[rows]) & (span >= 0)
    chosen, spans = rows[less], span[less]
    found.clearance[chosen], found.contact[chosen] = clearance[less], contact
    found.line[chosen], found.tool[chosen] = swept.line[spans], swept.tool[spans]
    found.span[chosen], found.low[chosen] = spans, below
