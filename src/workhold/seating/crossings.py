"""Where a line on which a peg's centre moves crosses a piece of the part, and roots over the orientation."""

from __future__ import annotations

from collections.abc import Callable
from math import pi

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, RADIUS, SIGN, X, Y

__all__ = ["LEVEL", "Crossing", "crossing", "off_piece", "roots", "solved"]

Array = NDArray[np.float64]
# mm. How far past its end a contact may lie: rounding. No unit: normals nearer to a direction than this are square to it.
END, LEVEL = 1e-9, 1e-9
# Parts into which a range with a root is cut, and how often: to the last digit.
PARTS, CUTS = 32, 12


@define(frozen=True, eq=False)
class Crossing:
    """Where a straight line through pegs' centres, along x or y, crosses a piece of the part in orientations (N,).

    Parameters
    ----------
    along : (N,) coordinate of the crossing along the line, from the part's place, in mm.
    normal : (2, N) outward unit normals of the part there.
    there : (N,) whether it is on the piece.
    """

    along: Array
    normal: Array
    there: NDArray[np.bool_]


def crossing(row: Array, side: float, theta: Array, level: Array, vertical: bool) -> Crossing:
    """Where a line at a level, counted from the part's place, crosses a piece; ``side`` of an arc's two.

    A vertical line is a level one of a part that is turned by a quarter more.
    """
    theta = theta + (pi / 2 if vertical else 0.0)
    c, s = np.cos(theta), np.sin(theta)
    cx, up = c * row[X] - s * row[Y], level - (s * row[X] + c * row[Y])
    mx, my = c * row[AXIS_X] - s * row[AXIS_Y], s * row[AXIS_X] + c * row[AXIS_Y]
    if row[IS_ARC] == 0.0:
        steep = np.where(np.abs(my) < LEVEL, np.nan, my)
        there = np.abs(up) <= (row[HALF_EXTENT] + END) * np.abs(steep)
        along, normal = cx + up / steep * mx, np.stack([my, -mx])
    else:
        dx = side * np.sqrt(np.maximum((row[RADIUS] - up) * (row[RADIUS] + up), 0.0))
        angle = np.arctan2(mx * up - my * dx, mx * dx + my * up)
        whole = row[HALF_EXTENT] >= pi
        there = (np.abs(up) < row[RADIUS]) & (whole | (np.abs(angle) <= row[HALF_EXTENT] + END / row[RADIUS]))
        along, normal = cx + dx, row[SIGN] * np.stack([dx, up]) / row[RADIUS]
    if vertical:
        along, normal = -along, np.stack([normal[1], -normal[0]])
    return Crossing(along, normal, np.asarray(there, np.bool_))


def off_piece(row: Array, theta: Array, away: Array) -> Array:
    """Distance (N,) from a piece's carrier of a place (2, N) in the toolkit's frame from the part's."""
    c, s = np.cos(theta), np.sin(theta)
    dx, dy = c * away[0] + s * away[1] - row[X], c * away[1] - s * away[0] - row[Y]
    if row[IS_ARC] == 0.0:
        return np.asarray(dx * row[AXIS_Y] - dy * row[AXIS_X])
    return np.asarray(np.hypot(dx, dy) - row[RADIUS])


def roots(function: Callable[[Array], Array], thetas: Array) -> list[float]:
    """Where a function changes its sign between neighbouring orientations."""
    values = function(thetas)
    return [solved(function, thetas[k], thetas[k + 1]) for k in np.flatnonzero(values[1:] * values[:-1] <= 0.0)]


def solved(function: Callable[[Array], Array], low: float, high: float) -> float:
    """A root between two orientations at which a function has different signs: by its values at many places at once."""
    for _ in range(CUTS):
        between = np.linspace(low, high, PARTS + 1)
        values = function(between)
        change = np.flatnonzero((values[1:] <= 0.0) != (values[0] <= 0.0))
        if not len(change):
            break
        low, high = between[change[0]], between[change[0] + 1]
    return float((low + high) / 2.0)
