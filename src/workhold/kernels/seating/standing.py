"""A part on a wall, between a locator and a tip: where their three forces are in balance, over the orientation."""

from __future__ import annotations

from math import cos, inf, pi, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.compiling import compiled, inner
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, RADIUS, SIGN, X, Y
from workhold.kernels.seating.pieces import angle_from_middle

Array = NDArray[np.float64]

# mm. How far past its end a contact may lie: rounding. No unit: normals nearer to a direction than this are square to it.
END, LEVEL = 1e-9, 1e-9
# No unit. Slopes of the separation below this, times mm, are level.
FLAT = 1e-9
# Columns of what changes: the branches of locator and tip, and the number of the orientation before the change.
OF_LOCATOR, OF_TIP, BEFORE = range(3)
CHANGE_LENGTH = 3
# Where a line crosses a piece: along it, outward normal, and whether it does.
Crossed = tuple[float, float, float, bool]
NOWHERE = (0.0, 0.0, 0.0, False)


@inner
def crossed(row: Array, side: float, c: float, s: float, level: float) -> Crossed:
    """Where a level line, counted from the part's place, crosses a piece of a part turned by an angle of cosine c and
    sine s; ``side`` of an arc's two. See ``seating.crossings``."""
    up = level - (s * row[X] + c * row[Y])
    if row[IS_ARC] == 0.0:
        mx, my = c * row[AXIS_X] - s * row[AXIS_Y], s * row[AXIS_X] + c * row[AXIS_Y]
        if abs(my) < LEVEL or abs(up) > (row[HALF_EXTENT] + END) * abs(my):
            return NOWHERE
        return (c * row[X] - s * row[Y] + up / my * mx, my, -mx, True)
    if abs(up) >= row[RADIUS]:
        return NOWHERE
    dx = side * sqrt((row[RADIUS] - up) * (row[RADIUS] + up))
    # The way there from the centre, in the part's frame.
    angle = 0.0 if row[HALF_EXTENT] >= pi else angle_from_middle(row, c * dx + s * up, c * up - s * dx)
    if abs(angle) > row[HALF_EXTENT] + END / row[RADIUS]:
        return NOWHERE
    return (c * row[X] - s * row[Y] + dx, row[SIGN] * dx / row[RADIUS], row[SIGN] * up / row[RADIUS], True)


@inner
def crossed_upright(row: Array, side: float, c: float, s: float, level: float) -> Crossed:
    """The same of an upright line: a level one of a part turned by a quarter more."""
    at = crossed(row, side, -s, c, level)
    return (-at[0], at[2], -at[1], at[3])


@compiled
def stationary(
    thetas: Array,
    on_wall: Array,
    wall: Array,
    pegs: Array,
    rows: Array,
    locators: Array,
    tips: Array,
    before: Array,
    out: Array,
) -> int:
    """Write between which orientations (N,) the slope of the separation changes its sign, for each branch of the locator and
    of the tip; return their number, or -1 where they do not fit.

    Parameters
    ----------
    on_wall : (6,) piece of the hull that is on the wall throughout; see ``seating.walls``.
    wall : (3,) unit vector from the wall to the part, and how far in mm along it the wall is.
    pegs : (2, 2) of the locator, and of the tip at separation 0, in mm.
    locators, tips : (L, 2) and (T, 2) numbers of pieces, and sides of arcs.
    before : (L * T, 2) work space.
    """
    count, (ux, uy, off) = 0, (wall[0], wall[1], wall[2])
    lx, ly, ty = pegs[0, 0], pegs[0, 1], pegs[1, 1]
    upright = ux != 0.0
    # The slope before, infinite where there was no contact, and whether all pressed.
    for k in range(before.shape[0]):
        before[k, 0], before[k, 1] = inf, 0.0
    for n in range(thetas.shape[0]):
        c, s = cos(thetas[n]), sin(thetas[n])
        hx, hy = c * on_wall[0] - s * on_wall[1], s * on_wall[0] + c * on_wall[1]
        known = (ux + uy) * (off + on_wall[2]) - (hx if upright else hy)
        for i in range(locators.shape[0]):
            row = rows[int(locators[i, 0])]
            if upright:
                one = crossed_upright(row, locators[i, 1], c, s, lx - known)
                px, py = known, ly - one[0]
            else:
                one = crossed(row, locators[i, 1], c, s, ly - known)
                px, py = lx - one[0], known
            steep = one[2] if upright else one[1]
            for j in range(tips.shape[0]):
                at = before[i * tips.shape[0] + j]
                slope, presses = inf, 0.0
                if one[3]:
                    two = crossed(rows[int(tips[j, 0])], tips[j, 1], c, s, ty - py)
                    bx, by = two[1], two[2]
                    if two[3]:
                        ax, ay = one[1], one[2]
                        if upright:
                            cx, cy = lx + (py + hy - ly) * ax / ay, py + hy
                            first, second = -by / bx / ay, ux * (1.0 - by / bx / ay * ax)
                        else:
                            cx, cy = px + hx, ly + (px + hx - lx) * ay / ax
                            first, second = -1.0 / ax, uy * (by / bx - ay / ax)
                        slope = (by * (px + two[0] - cx) - bx * (ty - cy)) * steep
                        presses = 1.0 if bx > 0.0 and first > 0.0 and second > 0.0 else 0.0
                if (
                    abs(slope) < inf
                    and abs(at[0]) < inf
                    and (presses != 0.0 or at[1] != 0.0)
                    # Of a round part the separation does not depend on the orientation.
                    and max(abs(slope), abs(at[0])) > FLAT
                    and slope * at[0] <= 0.0
                ):
                    if count >= out.shape[0]:
                        return -1
                    out[count, OF_LOCATOR], out[count, OF_TIP], out[count, BEFORE] = i, j, n - 1
                    count += 1
                at[0], at[1] = slope, presses
    return count
