"""Names in a row or a column moved apart so that none covers another, each as near to its place as can be."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

__all__ = ["moved_apart"]


def moved_apart(
    wanted: Sequence[float], sizes: Sequence[float], gap: float, low: float, high: float
) -> list[float]:
    """The middles of names of some sizes on a line, ``gap`` apart, nearest to the places that are wanted.

    Names keep their order. Where all of them do not fit between ``low`` and ``high`` they begin at ``low``.
    The sum of squares of the moves is least: runs of names that touch move together (pool adjacent
    violators).

    Examples
    --------
    >>> moved_apart([10.0, 10.0, 60.0], [10.0, 10.0, 10.0], 2.0, -9.0, 100.0)
    [4.0, 16.0, 60.0]
    """
    order = sorted(range(len(wanted)), key=lambda k: (wanted[k], k))
    # Distance of each middle from that of the first name, where all of them touch.
    offsets = [0.0]
    for one, other in pairwise(order):
        offsets.append(offsets[-1] + (sizes[one] + sizes[other]) / 2 + gap)
    runs: list[tuple[float, int]] = []
    for k, offset in zip(order, offsets, strict=False):
        runs.append((wanted[k] - offset, 1))
        while len(runs) > 1 and runs[-2][0] > runs[-1][0]:
            (a, m), (b, n) = runs[-2:]
            runs[-2:] = [((a * m + b * n) / (m + n), m + n)]
    starts = [start for start, count in runs for _ in range(count)]
    if not starts:
        return []
    first, last = low + sizes[order[0]] / 2, high - sizes[order[-1]] / 2 - offsets[-1]
    placed = [0.0] * len(wanted)
    for k, offset, start in zip(order, offsets, starts, strict=True):
        placed[k] = max(min(start, last), first) + offset
    return placed
