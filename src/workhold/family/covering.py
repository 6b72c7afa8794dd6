"""The fewest sets that together hold all members, exactly: set cover, solved by HiGHS.

HiGHS (Huangfu & Hall, *Parallelizing the dual revised simplex method*, Math. Prog. Comp. 10, 2018) branches
and bounds; it comes with SciPy. Its answer is taken as the least only when its lower bound, rounded up, is
the number of sets it found.
"""

from __future__ import annotations

from math import ceil
from time import monotonic

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.errors import InputError
from workhold.listing.canonical_form import changes

__all__ = [
    "REQUIREMENT",
    "Cover",
    "as_sets",
    "cover",
    "first_cover",
    "greedy",
    "load_solver",
    "maximal",
    "packing",
]

BoolArray = NDArray[np.bool_]
WordArray = NDArray[np.uint64]

REQUIREMENT = "scipy>=1.13"
WORD = 64
# A bound this little below a whole number is that number.
ROUNDING = 1e-6


@frozen
class Cover:
    """A cover.

    Parameters
    ----------
    sets : numbers of the sets, in order.
    at_least : no cover has fewer sets than this.
    """

    sets: tuple[int, ...]
    at_least: int

    @property
    def is_least(self) -> bool:
        """Whether it is proven that there is none with fewer sets."""
        return self.at_least == len(self.sets)


def load_solver() -> None:
    """Loads HiGHS.

    Raises
    ------
    InputError
        When SciPy is not installed; with the remedy.
    """
    try:
        import scipy.optimize  # noqa: F401
    except ImportError as error:
        raise InputError(
            f"a family needs SciPy, which is not installed: pip install '{REQUIREMENT}'."
        ) from error


def maximal(masks: WordArray) -> NDArray[np.int64]:
    """The sets (K,) of some (S, W), given as bits, that are in no other one, larger ones first.

    Of equal sets it is the first.
    """
    words = list(masks.T)
    by_mask = np.lexsort(words)
    first = np.sort(by_mask[changes([word[by_mask] for word in words])])
    size = np.bitwise_count(masks[first]).sum(axis=1).astype(np.int64)
    order = first[np.argsort(-size, kind="stable")]
    kept = np.zeros((0, masks.shape[1]), np.uint64)
    out = []
    for number in order.tolist():
        mask = masks[number]
        if not ((mask & ~kept) == 0).all(axis=1).any():
            kept = np.concatenate([kept, mask[None]])
            out.append(number)
    return np.array(out, np.int64)


def greedy(sets: BoolArray) -> tuple[int, ...]:
    """A cover by the greedy algorithm: each time the set (of S, M) that holds most of what is left.

    Every member has to be in some set.
    """
    left, chosen = np.ones(sets.shape[1], np.bool_), []
    while left.any():
        chosen.append(int(np.argmax((sets & left).sum(axis=1))))
        left &= ~sets[chosen[-1]]
    return tuple(sorted(chosen))


def cover(sets: BoolArray, deadline: float | None = None) -> Cover:
    """The fewest of some sets (S, M) of members that hold them all; every member is in some set.

    Parameters
    ----------
    deadline : of the clock ``time.monotonic``; when it comes, the best cover known so far and what is proven
        of the least.
    """
    from scipy.optimize import Bounds, LinearConstraint, milp

    quick = greedy(sets)
    # Members that share no set need a set each: often that is already as many as there are.
    at_least = packing(sets)
    if at_least == len(quick):
        return Cover(quick, at_least)
    options: dict[str, float] = {"mip_rel_gap": 0.0}
    if deadline is not None:
        options["time_limit"] = max(deadline - monotonic(), 0.0)
    constraint = LinearConstraint(sets.T.astype(np.float64), lb=1.0)
    count = len(sets)
    found = milp(
        np.ones(count),
        integrality=np.ones(count),
        bounds=Bounds(0, 1),
        constraints=constraint,
        options=options,
    )
    bound = found.mip_dual_bound
    if bound is not None and np.isfinite(bound):
        at_least = max(at_least, ceil(bound - ROUNDING))
    chosen = quick if found.x is None else tuple(np.flatnonzero(found.x > 0.5).tolist())
    if len(quick) <= len(chosen) or not sets[list(chosen)].any(axis=0).all():
        chosen = quick
    return Cover(chosen, min(at_least, len(chosen)))


def packing(sets: BoolArray) -> int:
    """A lower bound of covers: a number of members no two of which are in one set, found greedily."""
    beside = sets.T.astype(np.int64) @ sets.astype(np.int64) > 0
    left, count = np.ones(len(beside), np.bool_), 0
    while left.any():
        places = np.flatnonzero(left)
        one = places[np.argmin(beside[np.ix_(places, places)].sum(axis=1))]
        left &= ~beside[one]
        count += 1
    return count


def first_cover(
    sets: BoolArray, count: int, known: tuple[int, ...], deadline: float | None = None
) -> tuple[int, ...]:
    """The first cover of some number of sets (of S, M) in lexicographic order; ``known`` is one of that many.

    After the deadline it is the first that is known then.
    """
    chosen: list[int] = []
    left = np.ones(sets.shape[1], np.bool_)
    for number in range(len(sets)):
        if not left.any():
            break
        rest = left & ~sets[number]
        if known[len(chosen)] == number:
            found: tuple[int, ...] | None = known[len(chosen) + 1 :]
        else:
            found = completed(sets, rest, number + 1, count - len(chosen) - 1, deadline)
        if found is not None:
            known = (*chosen, number, *found)
            chosen.append(number)
            left = rest
    return tuple(chosen)


def completed(
    sets: BoolArray, left: BoolArray, first: int, count: int, deadline: float | None
) -> tuple[int, ...] | None:
    """Up to ``count`` sets from the ``first`` on that hold what is left; None if none are found."""
    if not left.any():
        return ()
    some = sets[first:, left]
    if not len(some) or not some.any(axis=0).all() or left.sum() > count * some.sum(axis=1).max():
        return None
    found = cover(some, deadline)
    return tuple(first + one for one in found.sets) if len(found.sets) <= count else None


def as_sets(masks: WordArray, members: int) -> BoolArray:
    """Sets (S, W) of bits as (S, M)."""
    bits = np.unpackbits(masks.view(np.uint8), axis=1, bitorder="little")
    return bits[:, :members].astype(np.bool_)
