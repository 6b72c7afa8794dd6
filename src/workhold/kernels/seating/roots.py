"""The three functions of the orientation whose roots are equilibria, and how a root between two signs is found.

MISS : height of the foot of the instant centre P on a third peg's piece, less the third peg's own height.
    Zero where the third normal goes through P. Its derivative is x . (P - foot) + y . foot'.
APART : difference of the heights of two pairs. Zero where both hold the part.
GAP : distance of another peg of the same jaw from a piece. Zero where it touches.
"""

from __future__ import annotations

from math import cos, sin

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.compiling import inner
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, IS_ARC, RADIUS, SIGN, X, Y
from workhold.kernels.seating.columns import Given
from workhold.kernels.seating.pieces import foot, length
from workhold.kernels.seating.two_contact_curves import height, pair_at

Array = NDArray[np.float64]

MISS, APART, GAP = 0.0, 1.0, 2.0
# mm. A function this near to 0 at an end has a root there: rounding.
AT_END = 1e-10
MOST_STEPS = 80


@inner
def value(
    kind: float, one: Array, two: Array, piece: Array, first: float, second: float, given: Given, psi: float
) -> float:
    """A function at an orientation.

    Parameters
    ----------
    one, two : pairs; the second is asked for APART only.
    piece : row; asked for MISS and GAP.
    first, second : for MISS the height of the third peg above the first, and the side of the foot. For GAP
        the other peg's place in the closing frame, from the first.
    """
    s = pair_at(one, given, psi)
    cosine, sine = cos(psi), sin(psi)
    if kind == APART:
        t = pair_at(two, given, psi)
        return height(two, given, t[0], t[1], cosine, sine) - height(one, given, s[0], s[1], cosine, sine)
    if kind == MISS:
        f = foot(piece, s[6], s[7], second)
        return cosine * (f[1] - s[1]) - sine * (f[0] - s[0]) - first
    return gap(piece, s[0] + cosine * first - sine * second, s[1] + sine * first + cosine * second)


@inner
def gap(piece: Array, x: float, y: float) -> float:
    """Distance in mm of a point from a piece's carrier, negative on the part's side."""
    dx, dy = x - piece[X], y - piece[Y]
    if piece[IS_ARC] == 0.0:
        return dx * piece[AXIS_Y] - dy * piece[AXIS_X]
    return piece[SIGN] * (length(dx, dy) - piece[RADIUS])


@inner
def have_no_root(f_low: float, f_high: float) -> bool:
    """Whether a function's values at two orientations leave no root between them."""
    return f_low * f_high > 0.0 and min(abs(f_low), abs(f_high)) > AT_END


@inner
def root_between(
    kind: float,
    one: Array,
    two: Array,
    piece: Array,
    first: float,
    second: float,
    given: Given,
    low: float,
    high: float,
) -> tuple[bool, float]:
    """Whether a function has different signs at two orientations, or is 0 at one, and a root between them."""
    f_low = value(kind, one, two, piece, first, second, given, low)
    f_high = value(kind, one, two, piece, first, second, given, high)
    if f_low * f_high > 0.0:
        return (not have_no_root(f_low, f_high), low if abs(f_low) < abs(f_high) else high)
    psi = (low + high) / 2.0
    for step in range(MOST_STEPS):
        f = value(kind, one, two, piece, first, second, given, psi)
        if (f > 0.0) == (f_high > 0.0):
            high, f_high = psi, f
        else:
            low, f_low = psi, f
        if f == 0.0 or high - low < 1e-15:
            break
        # The straight line's root, and every third time the middle, so that the range surely shrinks.
        psi = low - f_low * (high - low) / (f_high - f_low) if f_high != f_low else (low + high) / 2.0
        if step % 3 == 2 or not low < psi < high:
            psi = (low + high) / 2.0
    return (True, psi)


@inner
def is_level(
    kind: float,
    one: Array,
    two: Array,
    piece: Array,
    first: float,
    second: float,
    given: Given,
    low: float,
    high: float,
    least: float,
) -> bool:
    """Whether three values over a range too narrow to cut are far from 0 by more than they differ."""
    f = value(kind, one, two, piece, first, second, given, (low + high) / 2.0)
    f_low = value(kind, one, two, piece, first, second, given, low)
    f_high = value(kind, one, two, piece, first, second, given, high)
    return abs(f) > least and abs(f) > 2.0 * max(abs(f - f_low), abs(f - f_high))
