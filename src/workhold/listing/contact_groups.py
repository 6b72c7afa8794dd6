"""Contacts of three locators and a clamp, packed as they wait, and in groups that hold whole seats.

Packed they take half the room of records, since all of a range wait to be ordered (``listing.seat_order``).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import inf

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.kernels.contact.record import PSI, RECORD_LENGTH
from workhold.listing.ranking import is_worse
from workhold.listing.results import RankedTable

__all__ = ["PackedContacts", "SeatGroups", "in_order_of_bounds"]

Array = NDArray[np.float64]

# Numbers below this are kept in 16 bits.
SMALL = 1 << 15
# Records that are unpacked together.
TOGETHER = 1 << 16


@frozen(eq=False)
class PackedContacts:
    """Records (N, 19), see ``kernels.contact.record``, whole numbers apart from others.

    Parameters
    ----------
    whole : (N, 13) columns that are whole numbers.
    reals : (N, 6) the other columns.
    """

    whole: NDArray[np.int16] | NDArray[np.int64]
    reals: Array

    @classmethod
    def of(cls, blocks: list[Array]) -> PackedContacts:
        """The records of blocks, each (N, 19); the list is emptied, since there is no room for both."""
        end = sum(map(len, blocks))
        small = all(np.abs(block[:, :PSI]).max(initial=0.0) < SMALL for block in blocks)
        whole = np.empty((end, PSI), np.int16 if small else np.int64)
        reals = np.empty((end, RECORD_LENGTH - PSI))
        while blocks:
            block = blocks.pop()
            first = end - len(block)
            whole[first:end], reals[first:end] = block[:, :PSI], block[:, PSI:]
            end = first
        return cls(whole, reals)

    def __len__(self) -> int:
        return len(self.reals)

    def take(self, chosen: NDArray[np.int64] | slice) -> Array:
        """The records (M, 19) of an index array or slice."""
        return np.hstack([self.whole[chosen], self.reals[chosen]])

    def parts(self) -> Iterator[Array]:
        """All records, some at a time; one part of nothing where there are none."""
        for first in range(0, max(len(self), 1), TOGETHER):
            yield self.take(slice(first, first + TOGETHER))


IntArray = NDArray[np.int64]

# Contacts of the first seats that are looked at together; then twice as many each time.
FIRST_CONTACTS = 1 << 12


@frozen(eq=False)
class SeatGroups:
    """Contacts of all directions in groups that hold whole seats, those first that may rank first.

    Parameters
    ----------
    order : (M,) numbers of the contacts, counted through all directions, group by group.
    ends : (G,) where each group ends in the order.
    bounds : (G, R) keys to rank by, none of a fixture in the group being better, in lexicographic order.
    sharpened : the bounds of groups, given with their contacts, by the pairs of their clamps; None where
        these bound nothing that is ranked by, or all are known already.
    alike : how many keys, the first ones, no pairs bound.
    """

    order: IntArray
    ends: IntArray
    bounds: Array
    sharpened: Callable[[IntArray, IntArray], Array] | None = None
    alike: int = 0

    def reach(self, last: Array | None) -> int:
        """The number of groups, the first ones, that may hold what ranks no worse than keys (R,).

        They are all groups where ``last`` is None.
        """
        if last is None:
            return len(self.ends)
        return len(self.ends) - int(is_worse(self.bounds, last).sum())

    def batches(self, kept: RankedTable, together: int = FIRST_CONTACTS) -> Iterator[IntArray]:
        """Numbers of contacts, sorted, of more and more groups, until what is kept cannot get better."""
        first = 0
        while first < (end := self.reach(kept.last)):
            begin = int(self.ends[first - 1]) if first else 0
            end = min(end, int(np.searchsorted(self.ends, begin + together)) + 1)
            if self.sharpened is None:
                yield np.sort(self.order[begin : self.ends[end - 1]])
            else:
                same = (self.bounds[:, : self.alike] == self.bounds[first, : self.alike]).all(axis=1)
                end = max(end, int(np.flatnonzero(same)[-1]) + 1)
                yield from self.between(first, end).batches(kept, together)
            first, together = end, 2 * together
        kept.has_dropped |= first < len(self.ends)

    def followed_by(self, last: IntArray) -> SeatGroups:
        """The groups, and one after them of contacts (N,) that hold nothing."""
        if len(last) == 0:
            return self
        order, ends = np.concatenate([self.order, last]), np.append(self.ends, len(self.order) + len(last))
        return SeatGroups(order, ends, np.concatenate([self.bounds, np.full((1, self.bounds.shape[1]), inf)]))

    def between(self, first: int, end: int) -> SeatGroups:
        """Some of the groups, with the bounds by their pairs, and in the order of these."""
        assert self.sharpened is not None
        begin = int(self.ends[first - 1]) if first else 0
        order, ends = self.order[begin : self.ends[end - 1]], self.ends[first:end] - begin
        starts = np.concatenate([[0], ends[:-1]])
        bounds = np.where(
            self.bounds[first:end, :1] == -inf, self.bounds[first:end], self.sharpened(order, starts)
        )
        return in_order_of_bounds(order, starts, bounds)


def in_order_of_bounds(order: IntArray, starts: IntArray, bounds: Array) -> SeatGroups:
    """Groups that begin at some places (G,) of an order (M,), in the order of their bounds (G, R)."""
    by_bound = np.lexsort(bounds.T[::-1])
    sizes = np.diff(starts, append=len(order))[by_bound]
    ends = np.cumsum(sizes)
    shifts = np.repeat(starts[by_bound] - (ends - sizes), sizes)
    return SeatGroups(order[np.arange(len(order)) + shifts], ends, bounds[by_bound])
