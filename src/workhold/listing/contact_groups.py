"""Contacts of three locators and a clamp, in packed form, and groups of them that contain whole seats.

In packed form they need half the memory of records, since all contacts of a range of orientations are kept
until they are ordered (``listing.seat_order``).
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

# Integers below this fit 16 bits.
SMALL = 1 << 15
# Records that are unpacked together.
TOGETHER = 1 << 16


@frozen(eq=False)
class PackedContacts:
    """Kernel records (N, 19), see ``kernels.contact.record``, with
    integer columns stored apart to save memory.

    Parameters
    ----------
    whole : (N, 13) the columns that hold integers, as 16-bit integers where these suffice.
    reals : (N, 6) the other columns.
    """

    whole: NDArray[np.int16] | NDArray[np.int64]
    reals: Array

    @classmethod
    def from_blocks(cls, blocks: list[Array]) -> PackedContacts:
        """Return the records of blocks, each (N, 19), in order; the
        list ``blocks`` is emptied to save memory.
        """
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
        """Return the records (M, 19) that an index array or slice selects."""
        return np.hstack([self.whole[chosen], self.reals[chosen]])

    def iterate_parts(self) -> Iterator[Array]:
        """Yield all records as arrays (N, 19) of at most
        :data:`TOGETHER` rows; one empty array if there are none.
        """
        for first in range(0, max(len(self), 1), TOGETHER):
            yield self.take(slice(first, first + TOGETHER))


IntArray = NDArray[np.int64]

# Contacts in the first batch of seats; each further batch has twice as many.
FIRST_CONTACTS = 1 << 12


@frozen(eq=False)
class SeatGroups:
    """Contacts of all directions of the clamp in groups; every seat lies wholly in one group.

    Parameters
    ----------
    order : (M,) indices of contacts, group by group; indices count on from one direction's records to the
        next's.
    starts : (G,) index in ``order`` at which each group begins.
    bounds : (G,) lower bounds of the ranking keys of fixtures in each group.
    sharpened : called with ``order`` and ``starts`` of some groups; returns better bounds, from pairs of
        clamps. None if pairs cannot improve the bounds, or have already done so.
    alike : number of leading entries of the keys that ``sharpened`` does not change.
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
        """Yield, batch by batch, the indices of contacts of groups,
        best bound first, ascending within a batch.

        The iteration ends when no remaining group can have one of the best. Before asking for the next batch,
        the caller adds its findings to ``kept``. Groups that may have the least error come first.

        Parameters
        ----------
        floor : a lower bound of the errors, in billionths of a mm, of all fixtures outside these groups that
            are not yet found.
        together : about the number of contacts in the first batch; it doubles from batch to batch.
        """
        left = np.arange(len(self))
        sizes = np.diff(self.starts, append=len(self.order))
        while len(left):
            bounds = self.bounds.take(left)
            lowest = min(floor, bounds.lowest_error)
            left, keys = left[~(out := kept.are_beaten(bounds, lowest))], kept.keys
            kept.has_dropped |= bool(out.any())
            if len(left) == 0:
                return
            bounds = bounds.take(~out)
            numbers = bounds.make_order_numbers(
                keys.least_error if keys.is_fine.any() else bounds.lowest_error
            )
            if bounds.error is not None and not keys.is_known_above(bounds.lowest_error):
                # Groups that may have the least error come first.
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
                rest = self.bounds.take(left[end:]).lowest_error
                yield from self.select_groups_with_sharper_bounds(left[:end]).iterate_batches(
                    kept, min(floor, rest), together
                )
            left, together = left[end:], 2 * together

    def select_contacts(self, groups: IntArray) -> tuple[IntArray, IntArray]:
        """Return (1) the contacts of some groups, concatenated, and (2)
        the index at which each group begins there.
        """
        sizes = np.diff(self.starts, append=len(self.order))[groups]
        starts = np.cumsum(sizes) - sizes
        return self.order[np.arange(sizes.sum()) + np.repeat(self.starts[groups] - starts, sizes)], starts

    def append_group(self, last: IntArray) -> SeatGroups:
        """Return the groups with one more at the end: contacts ``last`` (N,) that surely form no fixture.

        The new group has the worst bounds; without contacts, none is added.
        """
        if len(last) == 0:
            return self
        order, starts = np.concatenate([self.order, last]), np.append(self.starts, len(self.order))
        return SeatGroups(order, starts, self.bounds.concatenate(self.bounds.keys_of_nothing))

    def select_groups_with_sharper_bounds(self, groups: IntArray) -> SeatGroups:
        """Return some groups, given by index, with bounds improved by pairs of clamps.

        Groups without a bound stay without.
        """
        assert self.sharpened is not None
        order, starts = self.select_contacts(groups)
        sharp, bounds = self.sharpened(order, starts), self.bounds.take(groups)
        return SeatGroups(order, starts, sharp.choose(bounds.is_known, bounds))
