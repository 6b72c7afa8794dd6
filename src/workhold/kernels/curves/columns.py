"""Columns of the table of chord curves, which kernels hand each other.

Curve table, whole numbers (C, 7): TAIL and HEAD (features), COLUMN_STEP and ROW_STEP (of the head from the tail), CENTER
(number of the common centre of concentric arcs, -1 for others), FIRST_STRETCH and END_STRETCH (the curve's stretches).

Curve table, reals (C, 14): FROM and TO (alpha in radians), BRANCH, TANGENT_FROM and TANGENT_TO (bound of the error in
radians of that end where the chord is a tangency there, 0 where it is not), LENGTH, SHIFT (arg Delta: psi = alpha - shift)
and its COSINE and SINE, BACKWARD_ERROR (see ``chord``), COINCIDENCE (its kind, see ``through_motion``), MIDDLE (alpha)
and SIDE of the coincidence, KAPPA (sum of the features' curvatures in 1 / mm).

Feature rows are those of ``geometry.segment``.
"""

from __future__ import annotations

TAIL, HEAD, COLUMN_STEP, ROW_STEP, CENTER, FIRST_STRETCH, END_STRETCH = range(7)
CURVE_INTEGERS = 7
FROM, TO, BRANCH, TANGENT_FROM, TANGENT_TO, LENGTH, SHIFT = range(7)
COSINE, SINE, BACKWARD_ERROR, COINCIDENCE, MIDDLE, SIDE, KAPPA = range(7, 14)
CURVE_REALS = 14
