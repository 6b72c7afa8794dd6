"""The table of chord curves and sliding pairs, which kernels hand each other: its columns, and the table as one record.

Whole numbers (C, 7), the same for a sliding pair: TAIL and HEAD (features), COLUMN_STEP and ROW_STEP (of the head from the
tail), CENTER (number of the common centre of concentric arcs, -1 for others), FIRST_STRETCH and END_STRETCH (the curve's
stretches, none of a sliding pair).

Reals of a curve (C, 14): FROM and TO (alpha in radians), BRANCH, TANGENT_FROM and TANGENT_TO (bound of the error in radians
of that end where the chord is a tangency there, 0 where it is not), LENGTH, SHIFT (arg Delta: psi = alpha - shift) and its
COSINE and SINE, BACKWARD_ERROR (see ``chord.evaluation``), COINCIDENCE (its kind, see ``chord.coincidences``), MIDDLE
(alpha) and SIDE of the coincidence, KAPPA (sum of the features' curvatures in 1 / mm).

Reals of a sliding pair (P, 5): SLIDE_FROM and SLIDE_TO (parameter of the tail on its feature), DIRECTION (alpha),
STEP_LENGTH, ORIENTATION (psi in radians).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

TAIL, HEAD, COLUMN_STEP, ROW_STEP, CENTER, FIRST_STRETCH, END_STRETCH = range(7)
CURVE_INTEGERS = 7
FROM, TO, BRANCH, TANGENT_FROM, TANGENT_TO, LENGTH, SHIFT = range(7)
COSINE, SINE, BACKWARD_ERROR, COINCIDENCE, MIDDLE, SIDE, KAPPA = range(7, 14)
CURVE_REALS = 14
SLIDE_FROM, SLIDE_TO, DIRECTION, STEP_LENGTH, ORIENTATION = range(5)
SLIDING_PAIR_REALS = 5


class Curves(NamedTuple):
    """Chord curves: whole numbers (C, 7), reals (C, 14), and their stretches (S, 13), see ``chord.stretches``."""

    integers: NDArray[np.int64]
    reals: NDArray[np.float64]
    stretches: NDArray[np.float64]


class SlidingPairs(NamedTuple):
    """Sliding pairs: whole numbers (P, 7) and reals (P, 5)."""

    integers: NDArray[np.int64]
    reals: NDArray[np.float64]
