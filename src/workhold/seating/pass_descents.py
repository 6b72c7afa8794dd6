"""Where the descent paths off both sides of all passes of a pattern end."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.seating.closing import AT_REST
from workhold.kernels.seating.descent_paths import free_until, take_up
from workhold.seating.closing import LONGEST_STEP, Closing
from workhold.seating.descent_paths import descent_starts
from workhold.seating.equilibria import Equilibria

__all__ = ["pass_descents"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


def pass_descents(found: Equilibria, closing: Closing, seats: Array) -> tuple[Array, Array, NDArray[np.int8]]:
    """Where the descent paths off both sides of all passes begin, where they end (2 N, 4), and how.

    Parameters
    ----------
    seats : (M, 4) configurations at which closing is known to end.
    """
    starts, lengths = descent_starts(found.passes, closing.size)
    ends, how, left = np.array(starts), np.full(len(starts), AT_REST, np.int8), np.ones(len(starts), np.int8)
    known = np.flatnonzero(found.origins[:, 0] >= 0)
    if len(known):
        cache, shifts = found.subsets[0][1].cache, shifts_of(found)
        paths = free_paths(found, known, closing, shifts)
        take_up(known, *paths, cache.nodes, cache.begins, cache.how, shifts, ends, lengths, left)
    rest = np.flatnonzero(left)
    ends[rest], how[rest] = closing.run(ends[rest], lengths[rest], seats)
    return starts, ends, how


def shifts_of(found: Equilibria) -> Array:
    """The shifts (G, 4) by which configurations of each subset become those of the pattern."""
    return np.array([subset.shift for subset, _ in found.subsets])


def free_paths(
    found: Equilibria, passes: IntArray, closing: Closing, shifts: Array
) -> tuple[IntArray, IntArray, IntArray]:
    """The paths off both sides of some passes, as far as the pattern's other pegs are not in the part.

    Parameters
    ----------
    shifts : see ``shifts_of``.

    Returns
    -------
    tuple
        Numbers of the paths in the cache, their subsets, and the last node of each: all (2 N,).
    """
    whose, numbers = found.origins[passes, 0], found.origins[passes, 1]
    cache = found.subsets[0][1].cache
    new = cache.numbers[numbers, 0] < 0
    for subset in dict.fromkeys(whose[new].tolist()):
        found.subsets[subset][1].follow(numbers[new & (whose == subset)])
    paths, whose = cache.numbers[numbers].ravel(), np.repeat(whose, 2)
    others = np.ones((len(found.subsets), len(closing.pattern.pegs)), np.int8)
    for row, (subset, _) in zip(others, found.subsets, strict=True):
        row[list(subset.numbers)] = 0
    most, lasts = LONGEST_STEP * min(closing.pattern.radii), np.empty(len(paths), np.int64)
    work = shifts, others, most, closing.obstacles, np.empty((4, 4))
    free_until(paths, whose, cache.nodes, cache.begins, *work, lasts)
    return paths, whose, lasts
