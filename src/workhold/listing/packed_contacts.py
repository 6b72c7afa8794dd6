"""Contacts of three locators and a clamp in half the room of records: all of a range wait to be ordered."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.kernels.contact.record import PSI, RECORD_LENGTH

__all__ = ["PackedContacts"]

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
