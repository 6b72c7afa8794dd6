"""Boxes of the same candidate that overlap, put together.

One contact is found by several pairs of chords, and in neighbouring cells.
"""

from __future__ import annotations

from workhold.kernels.base.compiling import (
    IntVector,
    Matrix,
    compiled,
)


@compiled
def merge_boxes(low: Matrix, high: Matrix, may: IntVector, heads: IntVector) -> int:
    """Lets each box join the one before it, where it may and both overlap, which grows to hold both.

    Parameters
    ----------
    low, high : (N, 4) corners of the boxes; that of a box which others have joined holds all of them.
    may : (N,) 1 where a box is of the same candidate as the box before it.
    heads : (N,) receives the numbers of the boxes that joined no other, negative less one where none joined.

    Returns
    -------
    How many boxes joined no other.
    """
    count = 0
    head = 0
    for n in range(low.shape[0]):
        joins = n > 0 and may[n] == 1
        if joins:
            for k in range(4):
                if low[n, k] > high[head, k] or low[head, k] > high[n, k]:
                    joins = False
        if joins:
            for k in range(4):
                low[head, k] = min(low[head, k], low[n, k])
                high[head, k] = max(high[head, k], high[n, k])
            heads[count - 1] = head
        else:
            head = n
            heads[count] = -1 - n
            count += 1
    return count
