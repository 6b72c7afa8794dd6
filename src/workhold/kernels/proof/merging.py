"""Merging of overlapping boxes of one candidate.

One contact is found by several pairs of chords, and in neighbouring cells, so the same candidate occurs in
several boxes.
"""

from __future__ import annotations

from workhold.kernels.base.compiling import (
    IntVector,
    Matrix,
    compiled,
)


@compiled
def merge_boxes(low: Matrix, high: Matrix, may: IntVector, heads: IntVector) -> int:
    """Merge each box into the group of the boxes just before it where both are of one candidate and overlap.

    A group is represented by its first box, the head, whose corners in ``low`` and ``high`` grow in place to
    hold the whole group. Each box is compared with the current head only.

    Parameters
    ----------
    low, high : (N, 4) lower and upper corners of the boxes.
    may : (N,) 1 where a box is of the same candidate as the box before it.
    heads : (N,) its first entries receive, for each group, the index h of its head, or -1 - h where the group
        is a single box.

    Returns
    -------
    Number of groups.
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
