"""A check of equilibria, independent of how they are found: contacts touch, and press, and balance.

Every pass is checked before a capture opening follows from it, with nothing but its pose and contacts.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from math import hypot
from operator import mul

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.feature import AXIS_X, AXIS_Y, IS_ARC, RADIUS, X, Y
from workhold.kernels.seating.columns import CONFIG, CONTACTS, PEG, PIECE
from workhold.seating.closing import Closing
from workhold.seating.contact_forces import contact_normals

__all__ = ["is_equilibrium"]

Array = NDArray[np.float64]
# No unit, and mm: forces, per unit of the jaw's and with moments over the part's size, balance to this, and
# contacts touch.
SETTLED = 1e-9
# No unit. A force above minus this does not pull.
PULLS = 1e-9


def is_equilibrium(row: Array, closing: Closing) -> bool:
    """Whether a candidate (24,) is an equilibrium of its contacts, or of two or three of them."""
    pegs = closing.pattern.at(row[CONFIG][None])[0].tolist()
    for k in range(int(row[CONTACTS])):
        peg, piece = int(row[PEG + k]), int(row[PIECE + k])
        # Where a wall is touched follows from the pose.
        if peg < len(pegs) and abs(beside(closing.boundary.rows[piece], *pegs[peg])) > SETTLED * max(1.0, closing.size):
            return False
    places, normals, moves = contact_normals(closing.boundary, closing.pattern, row)
    moments = (places[:, 0] * normals[:, 1] - places[:, 1] * normals[:, 0]) / closing.size
    wrenches = np.stack([normals[:, 0], normals[:, 1], moments, normals[:, 0] * moves], axis=1).tolist()
    # Loose rest may touch with more than three: some of them do.
    return any(map(balance, combinations(wrenches, 3))) or any(map(balance, combinations(wrenches, 2)))


def balance(wrenches: Sequence[Sequence[float]]) -> bool:
    """Whether two or three wrenches (4,) of force, moment and force on the jaw balance it while none pulls."""
    across, along, moments, on_jaw = zip(*wrenches, strict=True)
    equations = across, along, moments
    # Two forces that balance differ in their sense alone; three are square to the equations, of which two
    # suffice.
    forces: tuple[float, ...] = (1.0, 1.0)
    if len(wrenches) == 3:
        forces = max((cross(*two) for two in combinations(equations, 2)), key=largest)
    jaw = sum(map(mul, forces, on_jaw))
    if abs(jaw) <= PULLS * largest(forces):
        return False
    forces = tuple(force / jaw for force in forces)
    most = SETTLED * (1.0 + sum(map(abs, forces)))
    return min(forces) > -PULLS and all(abs(sum(map(mul, forces, one))) < most for one in equations)


def cross(a: Sequence[float], b: Sequence[float]) -> tuple[float, ...]:
    """The vector square to two."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def largest(vector: Sequence[float]) -> float:
    """The largest component, whatever its sign."""
    return max(map(abs, vector))


def beside(row: Array, x: float, y: float) -> float:
    """The distance in mm of a point from the carrier of a piece."""
    piece = row.tolist()
    dx, dy = x - piece[X], y - piece[Y]
    if piece[IS_ARC] == 0.0:
        return float(dx * piece[AXIS_Y] - dy * piece[AXIS_X])
    return float(hypot(dx, dy) - piece[RADIUS])
