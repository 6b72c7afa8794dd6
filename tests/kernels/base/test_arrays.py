"""Arrays that grow keep their rows."""

from __future__ import annotations

import numpy as np

from workhold.kernels.base.arrays import with_room


def test_room_is_made_when_there_is_none_left():
    """While a row is free the array stays the same; when it is full, a copy with twice the rows begins with its rows."""
    array = np.arange(6.0).reshape(3, 2)
    assert np.shares_memory(with_room(array, 2), array)
    larger = with_room(array, 3)
    assert larger.shape == (6, 2)
    assert (larger[:3] == array).all()
