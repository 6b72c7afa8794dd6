"""Where a value that runs monotonically along a curve passes zero, asked for as seldom as possible.

Each point of a curve is a call of the library. So a bracket of the crossing is narrowed by false position
first, and bisection then asks only within it.

Reference: M. Dowell and P. Jarratt, *A modified regula falsi method for computing the root of an equation*,
BIT 11 (1971).
"""

from __future__ import annotations

from collections.abc import Callable

__all__ = ["bisected", "crossing"]

Function = Callable[[float], float]
# A place with the value there.
Known = tuple[float, float]
# Steps of false position, at most, and of those that move the same end before the bracket is halved; half the
# width of the last bracket, as a share of the first.
STEPS, MOST_RUN, NARROW = 16, 3, 1e-12


def crossing(value: Function, low: Known, high: Known, steps: int = 60) -> float:
    """The place at which a value that is below 0 at one end and not at the other passes 0.

    Parameters
    ----------
    low, high : both ends, the one with the value below 0 first; it may be the greater one.
    steps : of bisection.
    """
    a, b = low[0], high[0]
    first, last = narrowed(value, low, high)
    return sum(bisected(a, b, lambda t: value(t) >= 0.0, (first, last), steps)) / 2


def bisected(
    low: float, high: float, holds: Callable[[float], bool], known: tuple[float, float], steps: int
) -> tuple[float, float]:
    """The ends of the last interval of a bisection for the place from which on something holds.

    Parameters
    ----------
    low, high : it does not hold at low, and does at high.
    known : two places between them: it does not hold up to the first, and does from the second on.
    """
    before, after = known
    turn = 1.0 if high >= low else -1.0
    for _ in range(steps):
        middle = (low + high) / 2
        if middle in (low, high):
            break
        if turn * middle >= turn * after:
            high = middle
        elif turn * middle <= turn * before:
            low = middle
        elif holds(middle):
            high = middle
        else:
            low = middle
    return low, high


def narrowed(value: Function, low: Known, high: Known) -> tuple[float, float]:
    """Two near places between which a value passes 0: it is below 0 at the first, not at the second."""
    (a, fa), (b, fb) = low, high
    beside = NARROW * (b - a)
    if not (fa < 0.0 <= fb):
        return a, b
    run = 0
    for _ in range(STEPS):
        if abs(b - a) <= 2 * abs(beside):
            break
        # A step beside the estimate, to the side that lies farther, soon brings in the other end.
        t = b - fb * (b - a) / (fb - fa)
        share = (t - a) / (b - a)
        t += beside if share < 0.5 else -beside
        if abs(run) > MOST_RUN or not 0.0 < (t - a) / (b - a) < 1.0:
            t, run = (a + b) / 2, 0
        found = value(t)
        if found < 0.0:
            a, fa, run = t, found, min(run, 0) - 1
            fb = fb / 2 if run < -1 else fb
        else:
            b, fb, run = t, found, max(run, 0) + 1
            fa = fa / 2 if run > 1 else fa
    return a, b
