"""All roots of a function over a range, from enclosures of its value in the middle and its derivative throughout.

A range is dropped where the mean value theorem leaves no root, cut by the interval Newton method where the
function is monotone, and halved otherwise. What is too narrow to be halved, or hardly steep, is in doubt.

Reference: R. E. Moore, R. B. Kearfott, M. J. Cloud, *Introduction to Interval Analysis*, SIAM 2009, chapter
8.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.compiling import inner
from workhold.kernels.base.interval import Interval, idivide, ineg, ishift

__all__ = ["HALVES", "NONE", "ROOT", "has_none", "judged", "meet", "to_look_at"]

# Radians. Ranges narrower than the first are not halved, and a root known to less than the second is in
# doubt.
NARROWEST, KNOWN = 2e-8, 1e-8
# Ranges that are looked at of one function; what is left then is in doubt.
MOST_RANGES = 20000
# Verdicts on a range: to be left, to be looked at in halves or as far as it is left, a root, or one
# in doubt.
NONE, HALVES, REST, ROOT, IN_DOUBT = range(5)


@inner
def meet(a: Interval, b: Interval) -> Interval:
    """What two intervals share; its ends are in the wrong order where they share nothing."""
    return (max(a[0], b[0]), min(a[1], b[1]))


@inner
def has_none(values: Interval) -> bool:
    """Whether 0 is outside."""
    return values[0] > 0.0 or values[1] < 0.0


@inner
def judged(turn: Interval, middle: float, value: Interval, slope: Interval) -> tuple[int, Interval]:
    """The verdict on a range by a function's value in its middle and its slope, and what is left of it."""
    reach = (turn[1] - turn[0]) / 2.0
    off = reach * max(-slope[0], slope[1])
    if value[0] > off or value[1] < -off:
        return (NONE, turn)
    if not has_none(slope):
        return (HALVES, turn)
    rest = meet(turn, ishift(middle, ineg(idivide(value, slope))))
    if rest[0] > rest[1]:
        return (NONE, turn)
    if rest[1] - rest[0] < reach:
        return (REST, rest)
    # It shrinks until rounding hides the sign in the middle.
    return (ROOT if 2.0 * reach < KNOWN else IN_DOUBT, turn)


@inner
def to_look_at(verdict: int, turn: Interval, looked: int, stack: NDArray[np.float64], depth: int) -> int:
    """Writes what is left of a range after others.

    Returns the new depth, or -1 where it is neither halved nor cut.
    """
    if verdict == REST:
        stack[depth, 0], stack[depth, 1] = turn
        return depth + 1
    if turn[1] - turn[0] <= NARROWEST or looked >= MOST_RANGES or depth + 2 > stack.shape[0]:
        return -1
    middle = (turn[0] + turn[1]) / 2.0
    stack[depth, 0], stack[depth, 1] = turn[0], middle
    stack[depth + 1, 0], stack[depth + 1, 1] = middle, turn[1]
    return depth + 2
