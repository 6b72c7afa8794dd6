"""Arrays that grow by doubling."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.compiling import inner

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


@inner
def grown(array: Array) -> Array:
    """A copy of a (N, M) array with room for twice as many rows."""
    out = np.empty((2 * array.shape[0], array.shape[1]))
    for i in range(array.shape[0]):
        for j in range(array.shape[1]):
            out[i, j] = array[i, j]
    return out


@inner
def with_room(array: Array, count: int) -> Array:
    """A (N, M) array with room for another row after ``count``: the array itself, or a grown copy when it is full."""
    return grown(array) if count == array.shape[0] else array


@inner
def grown_whole(array: IntArray) -> IntArray:
    """A copy of a (N, M) array of whole numbers with room for twice as many rows."""
    out = np.empty((2 * array.shape[0], array.shape[1]), np.int64)
    for i in range(array.shape[0]):
        for j in range(array.shape[1]):
            out[i, j] = array[i, j]
    return out
