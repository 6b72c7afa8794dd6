"""Whether what is told to be an equilibrium is one: contacts that touch, and forces of which none pulls that balance.

It is asked of a pass before a capture opening is told, with nothing of what the pass was found by but its pose and contacts.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.feature import AXIS_X, AXIS_Y, IS_ARC, RADIUS, X, Y
from workhold.kernels.seating.columns import CONFIG, CONTACTS, PEG, PIECE
from workhold.seating.balance import contact_normals
from workhold.seating.descents import Closing

__all__ = ["is_equilibrium"]

Array = NDArray[np.float64]
# No unit, and mm: forces, per unit of the jaw's and with moments over the part's size, balance to this, and contacts touch.
SETTLED = 1e-9
# No unit. A force above minus this does not pull.
PULLS = 1e-9


def is_equilibrium(row: Array, closing: Closing) -> bool:
    """Whether a candidate (24,) is an equilibrium of its contacts, or of two or three of them."""
    pegs = closing.pattern.at(row[CONFIG][None])[0]
    for k in range(int(row[CONTACTS])):
        peg, piece = int(row[PEG + k]), int(row[PIECE + k])
        # Where a wall is touched follows from the pose.
        if peg < len(pegs) and abs(beside(closing.locus.rows[piece], *pegs[peg])) > SETTLED * max(1.0, closing.size):
            return False
    places, normals, moves = contact_normals(closing.locus, closing.pattern, row)
    moments = (places[:, 0] * normals[:, 1] - places[:, 1] * normals[:, 0]) / closing.size
    wrenches = np.stack([normals[:, 0], normals[:, 1], moments, normals[:, 0] * moves])
    # Loose rest may touch with more than three: some of them do.
    for count in (3, 2):
        for chosen in combinations(range(wrenches.shape[1]), count):
            some, target = wrenches[:, chosen], np.array([0.0, 0.0, 0.0, 1.0])
            forces = np.linalg.lstsq(some, target, rcond=None)[0]
            if forces.min() > -PULLS and np.abs(some @ forces - target).max() < SETTLED * (1.0 + np.abs(forces).sum()):
                return True
    return False


def beside(row: Array, x: float, y: float) -> float:
    """How far in mm a point is from the carrier of a piece."""
    dx, dy = x - row[X], y - row[Y]
    if row[IS_ARC] == 0.0:
        return float(dx * row[AXIS_Y] - dy * row[AXIS_X])
    return float(np.hypot(dx, dy) - row[RADIUS])
