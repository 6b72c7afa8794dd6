"""Arrays that grow keep their rows, and rows are sorted by a column."""

from __future__ import annotations

from random import Random

import numpy as np
import pytest
from hypothesis import given

from strategies import seeds
from workhold.kernels.base.arrays import sort_rows, with_room


def test_room_is_made_when_there_is_none_left():
    """While a row is free the array stays the same; when it is full, a copy with twice the rows begins with its rows."""
    array = np.arange(6.0).reshape(3, 2)
    assert np.shares_memory(with_room(array, 2), array)
    larger = with_room(array, 3)
    assert larger.shape == (6, 2)
    assert (larger[:3] == array).all()


@pytest.mark.parametrize("sign", [1.0, -1.0])
@given(seeds)
def test_rows_are_sorted_by_a_column(sign: float, seed: int):
    """The order runs from the least of the column, or from the greatest, and holds each row once."""
    random = Random(seed)
    count = random.randint(0, 300)
    rows, out = np.zeros((count, 5)), np.empty((count, 5))
    rows[:, 2] = [random.choice([random.uniform(-50, 50), 1.0, 2.0]) for _ in range(count)]
    rows[:, -1] = range(count)
    keys, order = np.empty(count), np.empty(count, np.int64)
    sort_rows(rows, 2, sign, keys, order, out)
    assert sorted(order.tolist()) == list(range(count))
    assert (out == rows[order]).all()
    assert (np.diff(sign * out[:, 2]) >= 0).all()
