"""The fewest sets that together hold all members, and the curve of the least loss for each number of set-ups.

Set cover is solved exactly (``family.solver``). An answer is taken as the least only when the solver's lower
bound, rounded up, is the number of sets it found.

The curve gives for each number of set-ups the least worst loss among the members, proven. At a bound on the
loss only the sets of members that patterns hold matter, and of these only those contained in no other: few,
even of 10^6 patterns. Let f(bound) be the smallest number of them that hold every member. It falls as the
bound grows, and only at loss values of the table. Where f differs between two bounds, bisection over the
losses between them finds where it falls. In the bisection between two bounds a pattern is left out if some
other pattern already holds, at the lower bound, all members that it holds at the upper bound. So the work
soon gets small.

In shapes, S is the number of sets, M that of members, P that of patterns, and W that of words.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from math import ceil
from time import monotonic

import numpy as np
from attrs import define, field, frozen
from numpy.typing import NDArray

from workhold.family.members import Member
from workhold.family.solver import ROUNDING, find_best_choice
from workhold.listing.canonical_form import mark_changes

__all__ = [
    "Cover",
    "LossTable",
    "Point",
    "Search",
    "convert_bits_to_sets",
    "find_smallest_cover",
    "compute_curve",
    "find_first_cover",
    "find_greedy_cover",
    "find_maximal_sets",
    "bound_cover_size",
    "iterate_least_losses",
    "make_loss_table",
]

BoolArray = NDArray[np.bool_]
WordArray = NDArray[np.uint64]

WORD = 64


@frozen
class Cover:
    """A cover.

    Parameters
    ----------
    sets : indices of the sets, ascending.
    at_least : proven lower bound of the number of sets in any cover.
    """

    sets: tuple[int, ...]
    at_least: int

    @property
    def is_least(self) -> bool:
        """Whether it is proven that no cover has fewer sets."""
        return self.at_least == len(self.sets)


def find_maximal_sets(masks: WordArray) -> NDArray[np.int64]:
    """Return the indices (K,) of the sets that are contained in no other set, largest set first.

    ``masks`` (S, W) holds each set as bits in words. Of equal sets only the first is kept.
    """
    words = list(masks.T)
    by_mask = np.lexsort(words)
    first = np.sort(by_mask[mark_changes([word[by_mask] for word in words])])
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


def find_greedy_cover(sets: BoolArray) -> tuple[int, ...]:
    """Return the sorted indices of the sets of a cover, found by the greedy algorithm.

    ``sets`` (S, M) says which members each set holds; every member must be in some set. Each step takes the
    set that holds most of the members not yet held.
    """
    left, chosen = np.ones(sets.shape[1], np.bool_), []
    while left.any():
        chosen.append(int(np.argmax((sets & left).sum(axis=1))))
        left &= ~sets[chosen[-1]]
    return tuple(sorted(chosen))


def find_smallest_cover(sets: BoolArray, deadline: float | None = None) -> Cover:
    """Return a cover with the fewest sets that together hold all M members.

    ``sets`` (S, M) says which members each set holds; every member must be in some set. After ``deadline``,
    on the clock ``time.monotonic``, the result is the best cover found, with the lower bound proven so far.
    """
    from scipy.optimize import LinearConstraint

    quick = find_greedy_cover(sets)
    # Members that share no set need a set each: often that is already as many as there are.
    at_least = bound_cover_size(sets)
    if at_least == len(quick):
        return Cover(quick, at_least)
    constraint = LinearConstraint(sets.T.astype(np.float64), lb=1.0)
    seconds = None if deadline is None else deadline - monotonic()
    found, bound = find_best_choice(np.ones(len(sets)), constraint, seconds)
    if bound is not None:
        at_least = max(at_least, ceil(bound - ROUNDING))
    chosen = quick if found is None else tuple(found)
    if len(quick) <= len(chosen) or not sets[list(chosen)].any(axis=0).all():
        chosen = quick
    return Cover(chosen, min(at_least, len(chosen)))


def bound_cover_size(sets: BoolArray) -> int:
    """Return a lower bound of the number of sets in any cover.

    It is a number of members, found greedily, no two of which are in the same set. ``sets`` is (S, M).
    """
    beside = sets.T.astype(np.int64) @ sets.astype(np.int64) > 0
    left, count = np.ones(len(beside), np.bool_), 0
    while left.any():
        places = np.flatnonzero(left)
        one = places[np.argmin(beside[np.ix_(places, places)].sum(axis=1))]
        left &= ~beside[one]
        count += 1
    return count


def find_first_cover(
    sets: BoolArray, count: int, known: tuple[int, ...], deadline: float | None = None
) -> tuple[int, ...]:
    """Return the lexicographically first cover of ``count`` sets, as sorted indices.

    ``sets`` is (S, M); ``known`` is any cover of ``count`` sets, sorted. After the deadline the result is the
    first cover found so far.
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
            found = complete_cover(sets, rest, number + 1, count - len(chosen) - 1, deadline)
        if found is not None:
            known = (*chosen, number, *found)
            chosen.append(number)
            left = rest
    return tuple(chosen)


def complete_cover(
    sets: BoolArray, left: BoolArray, first: int, count: int, deadline: float | None
) -> tuple[int, ...] | None:
    """Return at most ``count`` indices of sets, all at least ``first``, that together hold the members
    ``left`` (M,).

    Returns None if none were found. Unless the deadline has passed, none exist then.
    """
    if not left.any():
        return ()
    some = sets[first:, left]
    if not len(some) or not some.any(axis=0).all() or left.sum() > count * some.sum(axis=1).max():
        return None
    found = find_smallest_cover(some, deadline)
    return tuple(first + one for one in found.sets) if len(found.sets) <= count else None


def convert_bits_to_sets(masks: WordArray, members: int) -> BoolArray:
    """Return sets as booleans (S, M), from sets as bits in words (S, W)."""
    bits = np.unpackbits(masks.view(np.uint8), axis=1, bitorder="little")
    return bits[:, :members].astype(np.bool_)


IntArray = NDArray[np.int64]


@frozen
class Point:
    """A point of the curve.

    Parameters
    ----------
    setups : number of set-ups.
    loss : the worst loss among the members, each held by the one of ``patterns`` with the least loss on it.
    at_least : proven lower bound of the number of set-ups that hold every member within this loss.
    patterns : their numbers, ascending, in the order of their identities.
    is_least : whether it is proven that no other choice of as many set-ups has a smaller loss.
    """

    setups: int
    loss: float
    at_least: int
    patterns: tuple[int, ...]
    is_least: bool = True


@frozen(eq=False)
class LossTable:
    """The loss of each pattern on each member that it holds: E entries, sorted by loss.

    Parameters
    ----------
    members : the number M of members.
    words : (P, W) the patterns, in lexicographic order.
    number : (P,) number of each pattern among all patterns of the family, from 0, in that order.
    pattern, member : (E,) the entry's row of ``words``, and its member's number.
    loss : (E,) ascending.
    """

    members: int
    words: IntArray
    number: IntArray
    pattern: IntArray
    member: IntArray
    loss: NDArray[np.float64]

    def make_masks(self, bound: float) -> NDArray[np.uint64]:
        """Return for each pattern, as bits in words (P, K), the set of members that it holds within the loss
        ``bound``.
        """
        end = int(np.searchsorted(self.loss, bound, side="right"))
        out = np.zeros((len(self.words), -(-self.members // WORD)), np.uint64)
        member = self.member[:end].astype(np.uint64)
        place = (self.pattern[:end], (member // np.uint64(WORD)).astype(np.int64))
        np.bitwise_or.at(out, place, np.uint64(1) << (member % np.uint64(WORD)))
        return out

    def select_patterns(self, chosen: IntArray) -> LossTable:
        """Return the table reduced to the patterns at the rows ``chosen``, renumbered in that order."""
        place = np.full(len(self.words), -1)
        place[chosen] = np.arange(len(chosen))
        kept = place[self.pattern] >= 0
        entries = place[self.pattern[kept]], self.member[kept], self.loss[kept]
        return LossTable(self.members, self.words[chosen], self.number[chosen], *entries)

    def list_losses(self, patterns: Sequence[int]) -> NDArray[np.float64]:
        """Return the losses (K, M) of K patterns, given by rows, on each member; NaN where a pattern does not
        hold the member.
        """
        out = np.full((len(patterns), self.members), np.nan)
        for row, place in enumerate(patterns):
            entries = np.flatnonzero(self.pattern == place)
            out[row, self.member[entries]] = self.loss[entries]
        return out


def make_loss_table(members: Sequence[Member]) -> LossTable:
    """Return the loss table of members.

    There must be at least one member, and each must be held by some pattern.
    """
    words = np.concatenate([one.words for one in members])
    owner = np.repeat(np.arange(len(members)), [len(one.words) for one in members])
    loss = np.concatenate([one.loss for one in members])
    order = np.lexsort(words.T[::-1])
    fresh = mark_changes(list(words[order].T))
    pattern = np.empty(len(words), np.int64)
    pattern[order] = np.cumsum(fresh) - 1
    by_loss = np.argsort(loss, kind="stable")
    words = words[order[fresh]]
    return LossTable(
        len(members), words, np.arange(len(words)), pattern[by_loss], owner[by_loss], loss[by_loss]
    )


@define
class Search:
    """The search for the losses at which fewer set-ups are enough.

    Parameters
    ----------
    table : the losses.
    bounds : (B,) the distinct losses that matter, ascending from the least bound at which every member is
        held.
    deadline : on the clock ``time.monotonic``; see :func:`find_smallest_cover`.
    progress : called with the fraction done.
    covers : found so far, by index into ``bounds``; the sets of each are given by numbers of patterns.
    """

    table: LossTable
    bounds: NDArray[np.float64]
    deadline: float | None
    progress: Callable[[float], None]
    covers: dict[int, Cover] = field(factory=dict)
    done: float = 0.0

    def search_at_bound(self, place: int, table: LossTable) -> None:
        """Find the fewest patterns of ``table`` that together hold all members within the loss
        ``bounds[place]``.

        They are stored in ``covers``.
        """
        masks = table.make_masks(float(self.bounds[place]))
        kept = find_maximal_sets(masks)
        found = find_smallest_cover(convert_bits_to_sets(masks[kept], table.members), self.deadline)
        numbers = tuple(sorted(table.number[kept[list(found.sets)]].tolist()))
        self.covers[place] = Cover(numbers, found.at_least)

    def search_between(self, low: int, high: int, table: LossTable, share: float) -> None:
        """Find covers at the bounds between two indices ``low`` and ``high``, by bisection where their sizes
        differ.

        The covers at both indices must be known. ``share`` is this call's fraction of the whole work, for the
        progress report.
        """
        if high - low < 2 or len(self.covers[low].sets) == len(self.covers[high].sets):
            self.done += share
            self.progress(self.done)
            return
        table = table.select_patterns(self.list_worth_trying(low, high, table))
        middle = (low + high) // 2
        self.search_at_bound(middle, table)
        self.search_between(low, middle, table, share / 2)
        self.search_between(middle, high, table, share / 2)

    def list_worth_trying(self, low: int, high: int, table: LossTable) -> IntArray:
        """Return the rows of the patterns that a cover at a bound between two indices may need.

        A pattern is left out if some other pattern holds, at the lower bound already, all members that the
        first one holds at the upper bound.
        """
        least, most = (table.make_masks(float(self.bounds[place])) for place in (low, high))
        largest = find_maximal_sets(least)
        inside = np.zeros(len(least), np.bool_)
        for mask in least[largest]:
            inside |= ((most & ~mask) == 0).all(axis=1)
        inside[largest] = False
        return np.flatnonzero(~inside)


def compute_curve(
    table: LossTable,
    most_loss: float = np.inf,
    deadline: float | None = None,
    progress: Callable[[float], None] = lambda fraction: None,
) -> tuple[Point, ...]:
    """Return the points of the curve, fewest set-ups and largest loss first.

    A number of set-ups is left out where a smaller number has the same loss. Losses above ``most_loss`` are
    not accepted; within ``most_loss`` every member must be held by some pattern. After ``deadline``, on the
    clock ``time.monotonic``, only the points known so far are returned.
    """
    least = float(np.max([table.loss[table.member == one].min() for one in range(table.members)]))
    bounds = np.unique(table.loss[(table.loss >= least) & (table.loss <= most_loss)])
    search, last = Search(table, bounds, deadline, progress), len(bounds) - 1
    for place in (0, last):
        search.search_at_bound(place, table)
    search.search_between(0, last, table, 1.0)
    return tuple(reversed(list(iterate_least_losses(search))))


def iterate_least_losses(search: Search) -> Iterator[Point]:
    """Yield the curve's points, one for each number of set-ups, the smallest loss first."""
    fewest = len(search.table.words) + 1
    for place in sorted(search.covers):
        count = len(search.covers[place].sets)
        if count >= fewest:
            continue
        fewest = count
        # What is proven of the least number at a bound holds at every smaller one.
        at_least = max(one.at_least for other, one in search.covers.items() if other >= place)
        is_least = place == 0 or (place - 1 in search.covers and search.covers[place - 1].at_least > count)
        yield Point(count, float(search.bounds[place]), at_least, name_patterns(search, place), is_least)


def name_patterns(search: Search, place: int) -> tuple[int, ...]:
    """Return the numbers of the patterns of the lexicographically first cover at index ``place`` of the
    bounds.

    The cover is made of maximal sets of members. A set's number is that of the first pattern that holds
    exactly these members.
    """
    table = search.table
    masks = table.make_masks(float(search.bounds[place]))
    kept = np.sort(find_maximal_sets(masks))
    sets = convert_bits_to_sets(masks[kept], table.members)
    found = convert_bits_to_sets(masks[list(search.covers[place].sets)], table.members)
    known = {int(np.flatnonzero((sets >= one).all(axis=1))[0]) for one in found}
    return tuple(
        kept[list(find_first_cover(sets, len(known), tuple(sorted(known)), search.deadline))].tolist()
    )
