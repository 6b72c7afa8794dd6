"""Boxes join as they do one after the other in plain Python."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from workhold.kernels.proof.merging import merge_boxes

BOX = st.tuples(*[st.integers(0, 6)] * 4, *[st.integers(0, 2)] * 4, st.booleans())


@pytest.mark.thorough
@given(st.lists(BOX, max_size=12))
def test_boxes_join_the_one_before(boxes: list[tuple[int, ...]]) -> None:
    """Boxes that touch join where they may, and what they join grows; others stay as they are."""
    low = np.array([box[:4] for box in boxes], dtype=float).reshape(-1, 4)
    high = low + np.array([box[4:8] for box in boxes], dtype=float).reshape(-1, 4)
    may = np.array([int(box[8]) for box in boxes], dtype=np.int64)
    groups: list[tuple[list[int], np.ndarray, np.ndarray]] = []
    for n in range(len(boxes)):
        if groups and may[n] and (low[n] <= groups[-1][2]).all() and (groups[-1][1] <= high[n]).all():
            members, lowest, highest = groups[-1]
            groups[-1] = ([*members, n], np.minimum(lowest, low[n]), np.maximum(highest, high[n]))
        else:
            groups.append(([n], low[n].copy(), high[n].copy()))
    heads = np.zeros(len(boxes), np.int64)
    count = merge_boxes(low, high, may, heads)
    assert count == len(groups)
    for head, (members, lowest, highest) in zip(heads[:count].tolist(), groups, strict=True):
        number = -1 - head if head < 0 else head
        assert (number, head < 0) == (members[0], len(members) == 1)
        assert (low[number] == lowest).all() and (high[number] == highest).all()
