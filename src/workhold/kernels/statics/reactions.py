"""Peg forces under loads.

A load row (11,) holds: the force in N, the point it acts at (x, y) about c in mm, the moment in N mm, cosine and sine of the
first and last direction, cosine and sine of the middle one, and the cosine of half the range (-1 for any direction).

Forces are linear in (cosine, sine) of the load's direction, so each is a sinusoid: its largest value over a range is its
amplitude if the peak lies in the range, and the larger of the values at the ends if not.
"""

from __future__ import annotations

from math import hypot

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.compiling import inner

Array = NDArray[np.float64]

FORCE, POINT_X, POINT_Y, MOMENT, LOW_X, LOW_Y, HIGH_X, HIGH_Y, MIDDLE_X, MIDDLE_Y, HALF = range(11)
LOAD_LENGTH = 11


@inner
def largest_value(x: float, y: float, load: Array) -> float:
    """Largest value of x cos + y sin over the directions of a load row."""
    size = hypot(x, y)
    if x * load[MIDDLE_X] + y * load[MIDDLE_Y] >= size * load[HALF]:
        return size
    return max(x * load[LOW_X] + y * load[LOW_Y], x * load[HIGH_X] + y * load[HIGH_Y])


@inner
def largest_reaction(inverse: Array, length: float, loads: Array) -> float:
    """Largest peg force in N that resists some load with the least clamping that keeps all forces from being negative.

    Forces that balance a load are f = f0 + k lambda for any k. The smallest k without a negative force is the largest of
    -f0_i / lambda_i, so f_j is the largest over i of f0_j - f0_i lambda_j / lambda_i, a sinusoid in the load's direction for
    each i. Rank by this: R. C. Brost, K. Y. Goldberg, *A complete algorithm for designing planar fixtures using modular
    components*, IEEE Transactions on Robotics and Automation 12 (1996).

    Parameters
    ----------
    inverse : (4, P) of the contact matrix, see ``kernels.statics.contact_matrix``.
    length : L in mm.
    loads : (M, 11) rows.
    """
    most = 0.0
    for m in range(len(loads)):
        load = loads[m]
        force, px, py, moment = load[FORCE], load[POINT_X] / length, load[POINT_Y] / length, load[MOMENT] / length
        for j in range(inverse.shape[1]):
            for i in range(inverse.shape[1]):
                if i != j:
                    ratio = inverse[3, j] / inverse[3, i]
                    a = inverse[0, j] - ratio * inverse[0, i]
                    b = inverse[1, j] - ratio * inverse[1, i]
                    c = inverse[2, j] - ratio * inverse[2, i]
                    most = max(most, moment * c + force * largest_value(a - py * c, b + px * c, load))
    return most
