"""The clearance between the tools of a program and the fixture: pegs, clamps with their bodies, and walls.

An element of a fixture is a disc, a capsule or a half plane, from the plate up to the height of the pegs or
between heights of its own. Its clearance is the least distance from the axis of a tool's cylinder to it,
minus the cylinder's radius, over the whole program at these heights.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from workhold.contact.swept import SweptSpans, find_span_path, find_swept_below, find_swept_beside_carrier
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.symmetry import rotate_vectors
from workhold.model.fixture_table import FixtureTable, compute_peg_places
from workhold.model.program import PathVertex, Program
from workhold.model.result import Result
from workhold.model.workpiece import Workpiece

__all__ = [
    "NearestMove",
    "ToolClearance",
    "name_element",
    "find_nearest_moves",
    "find_nearest_passing",
    "rename_element",
]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


@frozen(eq=False)
class NearestMove:
    """The place where the tools of a program come nearest to each of N fixtures.

    Parameters
    ----------
    clearance : (N,) in mm, negative for a collision; inf if nothing is swept at these heights.
    line, tool : (N,) line of the program, and tool number; -1 where the clearance is inf.
    contact : (N,) index of the nearest contact: a peg, a clamp, or an end on a wall.
    span : (N,) index of the swept span; -1 where there is none.
    low : (N,) whether the span is among those swept below the part.
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
    """Return for each fixture of a table the place where the tools of a program come nearest to it.

    Parameters
    ----------
    peg_height : height of the pegs in mm; the space that tools sweep above it does not count.
    """
    count = len(table)
    line, tool, contact, span = (np.full(count, -1) for _ in range(4))
    found = NearestMove(np.full(count, inf), line, tool, contact, span, np.zeros(count, np.bool_))
    x, y = compute_peg_places(table, toolkit, workpiece)
    bolts = toolkit.compute_hole_places(table.arrangement, table.column, table.row, np.zeros(count))
    carriers = toolkit.find_peg_carriers(table.arrangement)

    def map_to_part(points: tuple[Array, Array], rows: IntArray, k: int) -> Array:
        """Return the places of contact ``k`` of some rows in the part's coordinates, in mm, (R, 2)."""
        dx, dy = (values[rows, k] - table.position[rows, axis] for axis, values in enumerate(points))
        return np.stack(rotate_vectors(dx, dy, -table.theta[rows]), axis=1)

    for k in range(toolkit.peg_count):
        for number, carrier in enumerate(toolkit.carriers):
            rows, swept = (
                np.flatnonzero(carriers[:, k] == number),
                find_swept_beside_carrier(program, peg_height, carrier),
            )
            if not carrier.contact.is_placed:
                keep_smaller_clearances(found, rows, k, swept, *find_reach_to_wall(table, rows, swept))
                continue
            centers = map_to_part((x, y), rows, k)
            behind = map_to_part(bolts, rows, k) if carrier.has_body_behind else centers
            reach, span = swept.find_nearest_spans(centers, behind)
            keep_smaller_clearances(found, rows, k, swept, reach - carrier.peg_radius, span)
            if carrier.body_radius > carrier.peg_radius:
                below = find_swept_below(program, 0.0)
                reach, span = below.find_nearest_spans(centers, centers)
                keep_smaller_clearances(found, rows, k, below, reach - carrier.body_radius, span, below=True)
    return found


@frozen
class ToolClearance:
    """The place where the tools of a program come nearest to one fixture.

    Parameters
    ----------
    distance : distance to the nearest element of the fixture, in mm.
    line, tool : line of the program, and tool number.
    element : name of the nearest element, such as "peg L-A1".
    contact : index of the element among the contacts.
    path : path of the tool's axis there: one segment, arc or point in the part's coordinates, in mm.
    radius : radius of the tool's cylinder there, in mm.
    """

    distance: float
    line: int
    tool: int
    element: str
    contact: int
    path: tuple[PathVertex, ...]
    radius: float

    def rename_holes(self, before: Sequence[str], after: Sequence[str]) -> ToolClearance:
        """Return a copy with the holes in ``element`` renamed: ``before[k]`` becomes ``after[k]``."""
        return evolve(self, element=rename_element(self.element, before, after))


def rename_element(element: str, before: Sequence[str], after: Sequence[str]) -> str:
    """Return the name of an element, such as "peg L-A1", with its hole renamed.

    ``before[k]`` becomes ``after[k]``; other names stay.

    >>> rename_element("peg B2", ["A1", "B2"], ["C1", "D2"]), rename_element("clamp A1", ["clamp A1"], ["clamp C1"])
    ('peg D2', 'clamp C1')
    """
    names = dict(zip(before, after, strict=True))
    noun, _, hole = element.rpartition(" ")
    return names[element] if element in names else f"{noun} {names[hole]}" if hole in names else element


def find_nearest_passing(result: Result, index: int) -> ToolClearance | None:
    """Return the place where the tools of a result's program come nearest to fixture ``index``.

    None without a program, and if no tool comes down to the height of the pegs.
    """
    if result.query.program_to_clear is None:
        return None
    table, toolkit = result.table.take(slice(index, index + 1)), result.toolkit
    near = find_nearest_moves(table, result.workpiece, toolkit, *result.query.program_to_clear)
    if near.line[0] < 0:
        return None
    contact, span = int(near.contact[0]), int(near.span[0])
    program, height = result.query.program_to_clear
    standing = toolkit.carriers[toolkit.arrangements[int(table.arrangement[0])].carriers[contact]]
    swept = (
        find_swept_below(program, 0.0)
        if near.low[0]
        else find_swept_beside_carrier(program, height, standing)
    )
    return ToolClearance(
        float(near.clearance[0]),
        int(near.line[0]),
        int(near.tool[0]),
        name_element(table, toolkit, 0, contact),
        contact,
        find_span_path(swept.tree.rows[span]),
        float(swept.tree.radius[span]),
    )


def name_element(table: FixtureTable, toolkit: Toolkit, row: int, contact: int) -> str:
    """Return the name of the element of contact ``contact`` in table row ``row``, such as "peg L-A1" or
    "fence".
    """
    arrangement = toolkit.arrangements[int(table.arrangement[row])]
    carrier = toolkit.carriers[arrangement.carriers[contact]]
    if not carrier.contact.is_placed:
        return carrier.noun
    place = carrier.name_place(int(table.column[row, contact]), int(table.row[row, contact]))
    return f"{carrier.peg} {place}" if carrier.has_lattice else place


def find_reach_to_wall(table: FixtureTable, rows: IntArray, swept: SweptSpans) -> tuple[Array, IntArray]:
    """Return (the distance in mm of the swept tools from the wall, the index of the nearest span), (R,) each.

    Distances are those of the tools' cylinders; ``rows`` (R,) are rows of the table.
    """
    # All fixtures on one hull edge have the same pose except for the place along the wall.
    poses = np.stack([table.theta[rows], -table.position[rows, 1]], axis=1)
    different, inverse = np.unique(poses, axis=0, return_inverse=True)
    near = [swept.find_reach_below_line(theta, height) for theta, height in different.tolist()]
    reach, span = np.array([one for one, _ in near]), np.array([one for _, one in near], np.int64)
    inverse = inverse.ravel()
    return reach[inverse], span[inverse]


def keep_smaller_clearances(
    found: NearestMove,
    rows: IntArray,
    contact: int,
    swept: SweptSpans,
    clearance: Array,
    span: IntArray,
    below: bool = False,
) -> None:
    """Write clearances (R,) of contact ``contact`` into the rows of
    ``found`` where they are smaller than the ones there.

    ``span`` (R,) are the indices of the nearest spans. ``below`` tells whether ``swept`` is the space swept
    below the part.
    """
    less = (clearance < found.clearance[rows]) & (span >= 0)
    chosen, spans = rows[less], span[less]
    found.clearance[chosen], found.contact[chosen] = clearance[less], contact
    found.line[chosen], found.tool[chosen] = swept.line[spans], swept.tool[spans]
    found.span[chosen], found.low[chosen] = spans, below
