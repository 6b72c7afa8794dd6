"""Buffers that the kernels of a search write to; each thread has its own set."""

from __future__ import annotations

from collections.abc import Callable
from threading import local
from typing import Any

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.curves.block_work import (
    NO_ROOM_FOR_RECORDS,
    STOPPED,
    BlockSpace,
    make_block_space,
)

__all__ = ["BlockMemory"]

# Initial numbers of rows of each buffer.
FIRST_RECORDS, FIRST_PIECES, FIRST_MEMBERS = 256, 1024, 1024


class BlockMemory(local):
    """Buffers that the kernels of one search write to, one set for each thread.

    The buffers grow when a kernel runs out of room.
    """

    def __init__(self) -> None:
        self.records, self.pieces, self.members = FIRST_RECORDS, FIRST_PIECES, FIRST_MEMBERS
        self.renew()

    def renew(self) -> None:
        """Replace the buffers by new ones of the current sizes; their contents are lost."""
        self.space: BlockSpace = make_block_space(self.records, self.pieces, self.members)

    def run_kernel(
        self, kernel: Callable[..., int], members: NDArray[np.int64], stats: NDArray[np.int64], *given: Any
    ) -> NDArray[np.float64]:
        """Run a kernel and return a copy of the records (N, 19) that it wrote.

        Where the buffers are too small, the kernel runs again with larger ones. Columns of a record: see
        ``kernels.contact.record``.

        Parameters
        ----------
        kernel : called as ``kernel(members, *given, stats, space)``; returns the number of records, or a
            negative code where the buffers are too small.
        members : (M,) indices of curves.
        stats : (5,) counts that the kernel adds to. Counts added by a run without enough room are subtracted
            again, except the stop flag.
        given : the kernel's other arguments.
        """
        if len(members) > self.members:
            self.members = max(2 * self.members, len(members))
            self.renew()
        before = stats[:STOPPED].copy()
        while (count := kernel(members, *given, stats, self.space)) < 0:
            stats[:STOPPED] = before
            if count == NO_ROOM_FOR_RECORDS:
                self.records *= 2
            else:
                self.pieces *= 2
            self.renew()
        return self.space.out[:count].copy()
