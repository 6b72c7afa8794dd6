"""Subsets of a pattern's pegs, which stand to each other in the same way in many patterns of one lattice.

With S free, the equilibria of two or three pegs depend on how the pegs of each jaw stand to each other, and
on how much higher one jaw's pegs are. The pegs that are left only decide whether a place is free.

Glossary
--------
subset of contacts : two or three contacts of a grasp that balance without the others: E. Rimon and A. Blake,
    "Caging planar bodies by one-parameter two-fingered gripping systems", International Journal of Robotics
    Research 18 (1999).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property, lru_cache
from itertools import combinations
from math import inf

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from workhold.seating.pattern import Pattern

__all__ = ["PegSubset", "subsets_of", "jaw_subsets"]

Array = NDArray[np.float64]
# Decimals of a mm to which pegs of one subset stand alike: what differs less is rounding, and goes.
DECIMALS = 11
# Patterns whose subsets are kept, one or two for each thread that is at work on both sides of a part.
SIDES = 64
# mm. Separations this much below a gap still count: the pattern decides which of them do.
SLACK = 1e-6


@frozen(eq=False, slots=False)
class PegSubset:
    """Pegs of a pattern in an own frame: the first at the origin, and the first that moves at x = 0.

    Parameters
    ----------
    whole : the pattern.
    numbers : of the pegs in it.
    sides, places : of each 1 where it moves, and where it stands.
    shift : (4,) by which configurations become those of the pattern.
    """

    whole: Pattern
    numbers: tuple[int, ...]
    sides: tuple[int, ...]
    places: tuple[tuple[float, float], ...]
    shift: Array

    @classmethod
    def of(cls, pattern: Pattern, numbers: Sequence[int]) -> PegSubset:
        """The subset of some pegs of a pattern, by their numbers."""
        pegs, right, beside = places_of(pattern)
        # Pegs of each jaw from left to right, those that stand still before those that move.
        start = {right[k]: k for k in reversed(numbers)}
        order = tuple(k for *_, k in sorted((right[k], *beside[start[right[k]]][k], k) for k in numbers))
        first, low = {right[k]: k for k in reversed(order)}, order[0]
        places = tuple((beside[first[right[k]]][k][0], beside[low][k][1]) for k in order)
        (x, y), apart = pegs[low], pegs[low][0] - pegs[first[1]][0] if len(first) > 1 else 0.0
        return cls(pattern, order, tuple(right[k] for k in order), places, np.array([0.0, x, y, apart]))

    @property
    def is_of_a_jaw(self) -> bool:
        """Whether all pegs move, or none."""
        return self.sides[0] == self.sides[-1]

    @cached_property
    def key(self) -> tuple[object, ...]:
        """A key that subsets share if they stand alike: all that their own pattern is made from."""
        return self.whole.radii, self.whole.frame.sign, self.whole.gap, self.sides, self.places

    @cached_property
    def pattern(self) -> Pattern:
        """The pegs alone, with no other stop than the gap, which patterns of more pegs keep too."""
        whole, alone = self.whole, (np.array(self.places), np.array(self.sides, dtype=np.int64))
        made = Pattern(*alone, whole.radii, -inf, inf, whole.frame, self.numbers, None, whole.gap)
        if whole.gap is None or self.is_of_a_jaw:
            return made
        stop, widest = made.gap_kept(whole.gap)
        return evolve(made, stop=stop - SLACK, widest=widest + SLACK)

    def of_jaw(self, side: int) -> PegSubset:
        """The pegs that stand still (0), or that move (1), as a subset of the own pattern."""
        return PegSubset.of(self.pattern, [k for k, own in enumerate(self.sides) if own == side])

    @cached_property
    def numbers_and_shift(self) -> tuple[float, ...]:
        """The jaw, the names and the shift, as of ``kernels.seating.subset_candidates``."""
        jaw = self.sides[0] if self.is_of_a_jaw else -1
        names = *self.numbers, *[-1] * (4 - len(self.numbers))
        return (jaw, *names, *self.shift[1:].tolist())

    @cached_property
    def names(self) -> Array:
        """The pattern's number of each peg, and -1 of none, which comes last."""
        return np.array([*self.numbers, -1.0])


@lru_cache(maxsize=SIDES)
def places_of(pattern: Pattern) -> tuple[list[list[float]], list[int], list[list[tuple[float, float]]]]:
    """The pegs of a pattern, whether each moves, and how far right of and above each other they are, in mm.

    Of the two indices the first is that of the peg from which the other is seen.
    """
    pegs = pattern.pegs.tolist()
    return (
        pegs,
        pattern.right.tolist(),
        [[(rounded(x - left), rounded(y - low)) for x, y in pegs] for left, low in pegs],
    )


def rounded(x: float) -> float:
    """A length in mm without its rounding, nor the sign of 0."""
    return round(x, DECIMALS) + 0.0


@lru_cache(maxsize=SIDES)
def subsets_of(pattern: Pattern) -> tuple[PegSubset, ...]:
    """All subsets of three pegs, pairs of pegs of both jaws, and pairs of a jaw that has no third peg.

    They are kept for the other side of the part.
    """
    right, every = pattern.right.tolist(), range(len(pattern.right))
    two = [(i, j) for i, j in combinations(every, 2) if right[i] != right[j] or right.count(right[i]) == 2]
    return tuple(PegSubset.of(pattern, numbers) for numbers in (*two, *combinations(every, 3)))


@lru_cache(maxsize=SIDES)
def jaw_subsets(pattern: Pattern) -> dict[int, PegSubset]:
    """The pegs of each jaw, by whether it moves (1) or not (0); kept like those of ``subsets_of``."""
    sides = dict.fromkeys(pattern.right.tolist())
    return {side: PegSubset.of(pattern, np.flatnonzero(pattern.right == side).tolist()) for side in sides}
