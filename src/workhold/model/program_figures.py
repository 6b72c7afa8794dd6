"""Figures of a program: lengths, times and heights by tool, and the box in which the tool's tip moves."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.model.moves import Moves, compute_path_points
from workhold.model.program import Program

__all__ = ["ToolFigures", "bound_tip", "measure_tools"]

Floats = NDArray[np.float64]


@frozen
class ToolFigures:
    """Figures of one tool in a program; lengths in mm, heights above the plane on which the part lies.

    Parameters
    ----------
    tool : number of the tool.
    first_line : line of its first move.
    cutting, rapid : lengths of its cutting and of its rapid moves.
    seconds : time of its cutting moves at their feeds, without acceleration and dwells.
    untimed : length of cutting moves without a feed.
    lowest, highest : heights of its tip over all its moves.
    lowest_cut : least height of its tip on cutting moves; None if it has none.
    """

    tool: int
    first_line: int
    cutting: float
    rapid: float
    seconds: float
    untimed: float
    lowest: float
    highest: float
    lowest_cut: float | None


def measure_tools(program: Program) -> tuple[ToolFigures, ...]:
    """Return the figures of each tool that moves, in the order of their first moves."""
    moves, length = program.moves, program.moves.length
    heights = np.stack([moves.start[:, 2], moves.end[:, 2]], axis=1)
    found = []
    for number in dict.fromkeys(moves.tool.tolist()):
        own = moves.tool == number
        cut, timed = own & moves.cutting, own & moves.cutting & (moves.feed > 0)
        found.append(
            ToolFigures(
                tool=number,
                first_line=int(moves.line[own][0]),
                cutting=float(length[cut].sum()),
                rapid=float(length[own & ~moves.cutting].sum()),
                seconds=float((length[timed] / moves.feed[timed]).sum() * 60.0),
                untimed=float(length[cut & ~timed].sum()),
                lowest=float(heights[own].min()),
                highest=float(heights[own].max()),
                lowest_cut=float(heights[cut].min()) if cut.any() else None,
            )
        )
    return tuple(found)


def bound_tip(moves: Moves) -> tuple[Floats, Floats]:
    """Return (lowest, highest) coordinates of the tip over all moves, each (x, y, z) in mm; there is at least
    one move.
    """
    points = [moves.start, moves.end, *find_arc_extremes(moves)]
    every = np.concatenate(points)
    return every.min(axis=0), every.max(axis=0)


def find_arc_extremes(moves: Moves) -> Sequence[Floats]:
    """Return the points inside arcs at which x or y is extreme, as four arrays (K, 3), each with its own K.

    At the points of the four arrays the path runs along +x, +y, -x and -y.
    """
    arc = np.flatnonzero(moves.bulge)
    start, end, bulge = moves.start[arc], moves.end[arc], moves.bulge[arc]
    chord = end[:, :2] - start[:, :2]
    # The direction at the start lies half the sweep to the right of the chord, for a positive sweep.
    sweep = 4.0 * np.arctan(bulge)
    heading = np.arctan2(chord[:, 1], chord[:, 0]) - sweep / 2
    found = []
    for quarter in range(4):
        # The path runs along an axis where its heading is a multiple of a quarter turn.
        ahead = (quarter * np.pi / 2 - heading) * np.sign(sweep)
        share = np.mod(ahead, 2 * np.pi) / np.abs(sweep)
        inside = share < 1.0
        at = compute_path_points(start[inside, :2], end[inside, :2], bulge[inside], share[inside])
        height = start[inside, 2] + share[inside] * (end - start)[inside, 2]
        found.append(np.column_stack([at, height]))
    return found
