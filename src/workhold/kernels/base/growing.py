"""Arrays that grow by doubling."""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.compiling import inner_making_arrays

Number = TypeVar("Number", np.float64, np.int64)


@inner_making_arrays
def grown(array: NDArray[Number]) -> NDArray[Number]:
    """A copy of a (N, M) array with room for twice as many rows."""
    out = np.empty((2 * array.shape[0], array.shape[1]), array.dtype)
    for i in range(array.shape[0]):
        for j in range(array.shape[1]):
            out[i, j] = array[i, j]
    return out


@inner_making_arrays
def with_room(array: NDArray[Number], count: int) -> NDArray[Number]:
    """A (N, M) array with room for another row after ``count``: the array itself, or a grown copy when it is full."""
    return grown(array) if count == array.shape[0] else array
