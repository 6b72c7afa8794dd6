"""Largest and smallest number of each row of an array with short rows.

NumPy finds them many times faster along the columns of a transposed copy.
"""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

__all__ = ["find_largest", "find_smallest"]

Number = TypeVar("Number", bound=np.generic)


def find_largest(values: NDArray[Number]) -> NDArray[Number]:
    """Return the largest number of each row, shape (N,), of
    an (N, K) array with K > 0; NaN for a row with a NaN.

    Examples
    --------
    >>> import numpy as np
    >>> find_largest(np.array([[1, 3, 2], [0, -1, -2]])).tolist()
    [3, 0]
    """
    return np.asarray(split_columns(values).max(axis=0))


def find_smallest(values: NDArray[Number]) -> NDArray[Number]:
    """Return the smallest number of each row, shape (N,),
    of an (N, K) array with K > 0; NaN for a row with a NaN.

    Examples
    --------
    >>> import numpy as np
    >>> find_smallest(np.array([[1, 3, 2], [0, -1, -2]])).tolist()
    [1, -2]
    """
    return np.asarray(split_columns(values).min(axis=0))


def split_columns(values: NDArray[Any]) -> Any:
    """Return the transpose (K, N) of an (N, K) array as a C-contiguous array."""
    return np.ascontiguousarray(values.T)
