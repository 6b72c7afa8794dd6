"""Memory that the kernels of a search write to, of which each thread has its own."""

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

# Rows to begin with.
FIRST_RECORDS, FIRST_PIECES, FIRST_MEMBERS = 256, 1024, 1024


class BlockMemory(local):
    """The memory of one search; it grows where a kernel has no room for all it finds."""

    def __init__(self) -> None:
        self.records, self.pieces, self.members = FIRST_RECORDS, FIRST_PIECES, FIRST_MEMBERS
        self.renew()

    def renew(self) -> None:
        """Make memory of the present size."""
        self.space: BlockSpace = make_block_space(self.records, self.pieces, self.members)

    def run(
        self, kernel: Callable[..., int], members: NDArray[np.int64], stats: NDArray[np.int64], *given: Any
    ) -> NDArray[np.float64]:
        """Run a kernel until it has room, and return the (N, 19) records that it finds.

        Parameters
        ----------
        members : (M,) curves, the kernel's first argument.
        stats : (5,) counts that the kernel adds to, its last argument but the memory; what it counts before it
            has room is taken back.
        given : its other arguments.
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
