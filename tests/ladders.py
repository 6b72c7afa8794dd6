"""Four pegs at a fold: two ladders in a right angle, whose contact equations are solved in closed form.

The part has a wall x = 0 and a floor y = 0, each with material on one side for the left pegs and on the other for the
right ones. Two left pegs 5 mm apart and two right pegs 10 mm apart, both along the vise's x axis, lean on both, with the
right ones ``height`` above the left ones. With psi the turn of the pegs, they touch where

    height = -5/2 sin 2 psi:

at two orientations about 45 degrees for a height a little above -5/2, at one, double, for -5/2, and at none below.
"""

from __future__ import annotations

import numpy as np
from flint import arb
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Twelve numbers of a feature: kind, middle, tangent, half length, radius, sign, rest, and the slack of both ends. The
# outward normal is the tangent turned right. Left pegs push towards (1, -1), right ones towards (-1, 1).
LEFT_WALL = [0.0, 0.0, 0.0, 0.0, -1.0, 40.0, 0.0, 1.0, 0.0, 0.0, -1e-9, -1e-9]
LEFT_FLOOR = [0.0, 0.0, 0.0, -1.0, 0.0, 40.0, 0.0, 1.0, 0.0, 0.0, -1e-9, -1e-9]
RIGHT_WALL = [0.0, 0.0, 0.0, 0.0, 1.0, 40.0, 0.0, 1.0, 0.0, 0.0, -1e-9, -1e-9]
RIGHT_FLOOR = [0.0, 0.0, 0.0, 1.0, 0.0, 40.0, 0.0, 1.0, 0.0, 0.0, -1e-9, -1e-9]
FEATURES = [LEFT_WALL, LEFT_FLOOR, RIGHT_WALL, RIGHT_FLOOR]
SLIDING_PAIRS = [0.0, 0.0, 1.0, 1.0]


def offsets(height: float) -> list[tuple[float, float]]:
    """Places of the pegs in mm from the first, with the right jaw at zero."""
    return [(0.0, 0.0), (5.0, 0.0), (0.0, height), (10.0, height)]


def orientations(height: float) -> list[arb]:
    """The exact solutions psi about 45 degrees, at the precision in force."""
    sine = arb(height) / arb("-2.5")
    if sine > 1:
        return []
    if height == -2.5:
        return [arb.pi() / 4]
    half = sine.asin() / 2
    return [half, arb.pi() / 2 - half]


def unknowns(psi: arb, height: float) -> list[arb]:
    """(psi, tail x, tail y, apart) of the solution at an orientation."""
    return [psi, arb(0), -5 * psi.sin(), height * psi.sin() / psi.cos()]


def near(psi: float, height: float) -> tuple[float, float, float, float]:
    """The same in doubles, at any orientation."""
    return psi, 0.0, -5.0 * float(np.sin(psi)), height * float(np.tan(psi))
