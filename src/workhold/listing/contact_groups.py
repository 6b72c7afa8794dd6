"""Contacts of three locators and a clamp, packed as they wait, and in groups that hold whole seats.

Packed they take half the room of records, since all of a range wait to be ordered (``listing.seat_order``).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.kernels.contact.record import PSI, RECORD_LENGTH
from workhold.listing.ranking import OrderKeys
from workhold.listing.results import RankedTable

__all__ = ["PackedContacts", "SeatGroups"]

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
    def from_blocks(cls, blocks: list[Array]) -> PackedContacts:
        """Return the records of blocks, each (N, 19); the list is emptied, since there is no room for both."""
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
        """Return the records (M, 19) of an index array or slice."""
        return np.hstack([self.whole[chosen], self.reals[chosen]])

    def iterate_parts(self) -> Iterator[Array]:
        """Yield all records in parts; one empty part if there are no records."""
        for first in range(0, max(len(self), 1), TOGETHER):
            yield self.take(slice(first, first + TOGETHER))


IntArray = NDArray[np.int64]

# Contacts of the first seats that are looked at together; then twice as many each time.
FIRST_CONTACTS = 1 << 12


@frozen(eq=False)
class SeatGroups:
    """Contacts of all directions in groups that hold whole seats.

    Parameters
    ----------
    order : (M,) numbers of the contacts, counted through all directions, group by group.
    starts : (G,) where each group begins in the order.
    bounds : of each of G groups the keys that no fixture in it has less than: before, at and after steps each
        by itself.
    sharpened : the bounds of groups, given with their contacts, by the pairs of their clamps; None where
        these bound nothing that is ranked by, or all are known already.
    alike : how many numbers that order, the first ones, no pairs bound.
    """

    order: IntArray
    starts: IntArray
    bounds: OrderKeys
    sharpened: Callable[[IntArray, IntArray], OrderKeys] | None = None
    alike: int = 0

    def __len__(self) -> int:
        return len(self.starts)

    def iterate_batches(
        self, kept: RankedTable, floor: int, together: int = FIRST_CONTACTS
    ) -> Iterator[IntArray]:
        """Yield the numbers of contacts, sorted, of more and more groups, until what is kept cannot get
        better.

        Those come first that may have the least error of all, then those that may rank first.

        Parameters
        ----------
        floor : an error that nothing beside these groups has less than which is not found yet.
        """
        left = np.arange(len(self))
        sizes = np.diff(self.starts, append=len(self.order))
        while len(left):
            bounds = self.bounds.take(left)
            lowest = min(floor, bounds.lowest)
            left, keys = left[~(out := kept.are_beaten(bounds, lowest))], kept.keys
            kept.has_dropped |= bool(out.any())
            if len(left) == 0:
                return
            bounds = bounds.take(~out)
            numbers = bounds.make_order_numbers(keys.least if keys.is_fine.any() else bounds.lowest)
            if bounds.error is not None and not keys.is_known_above(bounds.lowest):
                # First what may have the least error.
                numbers = np.column_stack([bounds.first, bounds.error, numbers])
            by_bound = np.lexsort(numbers.T[::-1])
            left, numbers = left[by_bound], numbers[by_bound]
            end = int(np.searchsorted(np.cumsum(sizes[left]), together)) + 1
            if self.sharpened is None:
                yield np.sort(self.select_contacts(left[:end])[0])
            else:
                shift = numbers.shape[1] - self.bounds.width
                same = (numbers[:, : self.alike + shift] == numbers[0, : self.alike + shift]).all(axis=1)
                end = max(end, int(np.flatnonzero(same)[-1]) + 1)
                rest = self.bounds.take(left[end:]).lowest
                yield from self.select_groups_between(left[:end]).iterate_batches(
                    kept, min(floor, rest), together
                )
            left, together = left[end:], 2 * together

    def select_contacts(self, groups: IntArray) -> tuple[IntArray, IntArray]:
        """Return the contacts of some groups one after the other, and where each begins."""
        sizes = np.diff(self.starts, append=len(self.order))[groups]
        starts = np.cumsum(sizes) - sizes
        return self.order[np.arange(sizes.sum()) + np.repeat(self.starts[groups] - starts, sizes)], starts

    def append_group(self, last: IntArray) -> SeatGroups:
        """Return the groups, and one after them of contacts (N,) that hold nothing."""
        if len(last) == 0:
            return self
        order, starts = np.concatenate([self.order, last]), np.append(self.starts, len(self.order))
        return SeatGroups(order, starts, self.bounds.concatenate(self.bounds.nothing))

    def select_groups_between(self, groups: IntArray) -> SeatGroups:
        assert self.sharpened is not None
        order, starts = self.select_contacts(groups)
        sharp, bounds = self.sharpened(order, starts), self.bounds.take(groups)
        return SeatGroups(order, starts, sharp.choose(bounds.is_known, bounds))
