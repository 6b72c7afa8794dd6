"""Where the ways down off both sides of all passes of a pattern end."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.seating.closing import AT_REST
from workhold.kernels.seating.following import free_until, take_up
from workhold.seating.descents import LONGEST_STEP, Closing
from workhold.seating.equilibria import Equilibria
from workhold.seating.ways_down import starts_off

__all__ = ["both_ways_down"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


def both_ways_down(found: Equilibria, closing: Closing, seats: Array) -> tuple[Array, Array, NDArray[np.int8]]:
    """Where the ways down off both sides of all passes begin, where they end (2 N, 4), and how.

    Parameters
    ----------
    seats : (M, 4) configurations at which closing is known to end.
    """
    starts, lengths = starts_off(found.passes, closing.size)
    ends, how, left = np.array(starts), np.full(len(starts), AT_REST, np.int8), np.ones(len(starts), np.int8)
    known = np.flatnonzero(found.origins[:, 0] >= 0)
    if len(known):
        trodden, shifts = found.groups[0][1].trodden, shifts_of(found)
        ways = free_ways(found, known, closing, shifts)
        take_up(known, *ways, trodden.nodes, trodden.begins, trodden.how, shifts, ends, lengths, left)
    rest = np.flatnonzero(left)
    ends[rest], how[rest] = closing.run(ends[rest], lengths[rest], seats)
    return starts, ends, how


def shifts_of(found: Equilibria) -> Array:
    """By which configurations of each group (G, 4) become those of the pattern."""
    return np.array([group.shift for group, _ in found.groups])


def free_ways(
    found: Equilibria, passes: IntArray, closing: Closing, shifts: Array
) -> tuple[IntArray, IntArray, IntArray]:
    """The ways off both sides of some passes (2 N,), the groups whose they are, and the last node of each at which the
    pattern's other pegs are not in the part; shifts as of ``shifts_of``."""
    whose, numbers = found.origins[passes, 0], found.origins[passes, 1]
    trodden = found.groups[0][1].trodden
    new = trodden.numbers[numbers, 0] < 0
    for group in dict.fromkeys(whose[new].tolist()):
        found.groups[group][1].follow(numbers[new & (whose == group)])
    ways, whose = trodden.numbers[numbers].ravel(), np.repeat(whose, 2)
    others = np.ones((len(found.groups), len(closing.pattern.pegs)), np.int8)
    for row, (group, _) in zip(others, found.groups, strict=True):
        row[list(group.numbers)] = 0
    most, lasts = LONGEST_STEP * min(closing.pattern.radii), np.empty(len(ways), np.int64)
    work = shifts, others, most, closing.obstacles, np.empty((4, 4))
    free_until(ways, whose, trodden.nodes, trodden.begins, *work, lasts)
    return ways, whose, lasts
