"""Below which friction a part cannot stick near its seat: where three of the four contacts balance the jaw inside their
cones.

Contact i presses with h (-n + s mu t), |s| <= 1. Three forces balance where the determinant of their wrenches is zero; with
three unknown ratios, one of them up to scale, the least largest ratio has all three equal, or one of the contacts without
force (V.-D. Nguyen, International Journal of Robotics Research 7, 1988). A determinant of signs is a cubic in mu. Where less
friction does, the jaw's share of the forces vanishes at the least: the three lock whatever its force. Halving finds that.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.seating.sticking import least_friction

__all__ = ["sticking_friction"]

Array = NDArray[np.float64]
# mm. Contacts are counted in parts of how far they are apart, but of this at least.
SMALLEST = 1e-9


def sticking_friction(points: Array, normals: Array, right: Array) -> float:
    """The least coefficient of friction at which three of four contacts (two included) balance the jaw, or infinity.

    Parameters
    ----------
    points : (4, 2) contact points in mm, in the vise frame.
    normals : (4, 2) outward unit normals there.
    right : (4,) 1 for contacts of the right jaw's pegs, 0 for others.
    """
    size = max(float((points.max(axis=0) - points.min(axis=0)).max()), SMALLEST)
    told = (
        (points - points.sum(axis=0) / len(points)) / size,
        np.ascontiguousarray(normals),
        np.asarray(right, dtype=np.int64),
    )
    return float(least_friction(*told, np.empty((4, 3)), np.empty((4, 3)), np.empty((4, 4)), np.empty((4, 4))))
