"""Some of a pattern's pegs by themselves: they stand to each other in the same way in many patterns of one lattice.

With S free, what two or three pegs do depends on how those of each jaw stand to each other and on how much higher those of
one jaw are than those of the other. The pegs that are left only say whether a place is free.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from math import inf

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.kernels.seating.columns import PEG, PLACE_X, PLACE_Y, SEPARATION, THETA
from workhold.seating.pattern import Pattern

__all__ = ["Group", "groups_of"]

Array = NDArray[np.float64]
# Decimals of a mm to which pegs of one group stand alike: what differs less is rounding, and goes.
DECIMALS = 11


@frozen(eq=False)
class Group:
    """Pegs of a pattern.

    Parameters
    ----------
    key : what groups share that stand alike, all that their own pattern is made from.
    pattern : the pegs alone, in a frame of their own: the first at the origin, as is the x of the first that moves.
    numbers : theirs in the pattern.
    shift : (4,) by which their configurations become those of the pattern.
    """

    key: tuple[float, ...]
    pattern: Pattern
    numbers: tuple[int, ...]
    shift: Array

    @classmethod
    def of(cls, pattern: Pattern, numbers: Sequence[int]) -> Group:
        """Some pegs of a pattern, by their numbers."""
        pegs, right = pattern.pegs.tolist(), pattern.right.tolist()
        # Pegs of each jaw from left to right, those that stand still before those that move.
        start = {right[k]: pegs[k] for k in reversed(numbers)}
        told = sorted(
            (right[k], rounded(pegs[k][0] - start[right[k]][0]), rounded(pegs[k][1] - start[right[k]][1]), k)
            for k in numbers
        )
        order = tuple(k for *_, k in told)
        first = {right[k]: pegs[k] for k in reversed(order)}
        low = pegs[order[0]]
        places = [(rounded(pegs[k][0] - first[right[k]][0]), rounded(pegs[k][1] - low[1])) for k in order]
        sides = np.array([right[k] for k in order], dtype=np.int64)
        apart = low[0] - first[1][0] if len(first) > 1 else 0.0
        alone = Pattern(np.array(places), sides, pattern.radii, -inf, inf, pattern.door, order, None, pattern.gap)
        key = (
            *pattern.radii,
            pattern.door.sign,
            pattern.gap or 0.0,
            *sides.tolist(),
            *(x for at in places for x in at),
        )
        return cls(key, alone.bounded(), order, np.array([0.0, low[0], low[1], apart]))

    def candidates(self, rows: Array) -> Array:
        """Candidates (N, 24) of the pegs alone as those of the pattern."""
        out = np.array(rows)
        out[:, [THETA, PLACE_X, PLACE_Y, SEPARATION]] += self.shift
        names = np.array([*self.numbers, -1.0])
        out[:, PEG : PEG + 4] = names[out[:, PEG : PEG + 4].astype(np.int64)]
        return out


def rounded(x: float) -> float:
    """A length in mm without its rounding, nor the sign of 0."""
    return round(x, DECIMALS) + 0.0


def groups_of(pattern: Pattern) -> list[Group]:
    """The pairs of pegs of both jaws, those of a jaw that has no third, and all that are three."""
    right, every = pattern.right.tolist(), range(len(pattern.right))
    two = [(i, j) for i, j in combinations(every, 2) if right[i] != right[j] or right.count(right[i]) == 2]
    return [Group.of(pattern, numbers) for numbers in (*two, *combinations(every, 3))]
