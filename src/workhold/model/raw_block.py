"""The raw block: where a tool may meet material, for cutting forces.

A program feeds through air as well: down to the work, and into a cut from beside it. Nobody says what the
raw part is like, so it is taken as a block: the part's outside dimensions with an allowance on all sides and
on top. A move that stays outside of it wholly presses on nothing. One that enters it counts from end to end.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from workhold.geometry.segment import Box
from workhold.model.cutting_tool import Tool
from workhold.model.moves import Moves

__all__ = ["ALLOWANCE", "above_block", "beside_block"]

# Of the raw block around the part and above it, in mm.
ALLOWANCE = 5.0


def above_block(moves: Moves, thickness: float) -> NDArray[np.bool_]:
    """(M,) whether the tip stays above the block all the way; ``thickness`` of the part in mm."""
    lowest = np.minimum(moves.start[:, 2], moves.end[:, 2])
    return np.asarray(lowest >= thickness + ALLOWANCE)


def beside_block(moves: Moves, tools: Mapping[int, Tool], part: Box) -> NDArray[np.bool_]:
    """(M,) whether the tool's edge stays beside the block all the way.

    Parameters
    ----------
    part : the part's outside dimensions, in mm.

    Segments are clipped by the sides of the block, grown by the tool's radius (Y.-D. Liang and B. A. Barsky,
    *A new concept and method for line clipping*, 1984). Of an arc the box around its circle counts.
    """
    room = np.full(len(moves), ALLOWANCE)
    for number, tool in tools.items():
        room[moves.tool == number] += tool.diameter / 2
    low = np.array([part.x0, part.y0]) - room[:, None]
    high = np.array([part.x1, part.y1]) + room[:, None]
    start, end = moves.start[:, :2], moves.end[:, :2]
    chord = end - start
    with np.errstate(divide="ignore", invalid="ignore"):
        one, other = (low - start) / chord, (high - start) / chord
    still = chord == 0.0
    within = (start >= low) & (start <= high)
    first = np.where(still, np.where(within, 0.0, 2.0), np.minimum(one, other)).max(axis=1)
    last = np.where(still, np.where(within, 1.0, -1.0), np.maximum(one, other)).min(axis=1)
    misses = np.maximum(first, 0.0) > np.minimum(last, 1.0)
    # The circle of an arc: no point is farther from the middle of the chord than twice its radius.
    bulge = moves.bulge
    round_ = bulge != 0.0
    size = np.hypot(*chord.T)
    safe = np.where(round_, np.abs(bulge), 1.0)
    reach = (size * (1.0 + safe * safe) / (2.0 * safe))[:, None]
    middle = (start + end) / 2
    far = ((middle + reach < low) | (middle - reach > high)).any(axis=1)
    return np.asarray(np.where(round_, far, misses))
