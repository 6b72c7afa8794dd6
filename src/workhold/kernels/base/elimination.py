"""Inverses of matrices of four rows."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.compiling import inner

Array = NDArray[np.float64]


@inner
def eliminate(matrix: Array, inverse: Array) -> float:
    """Invert a (4, 4) matrix, which is used up, by Gauss and Jordan's elimination with pivots by rows.

    Returns
    -------
    float
        The size of the determinant; where it is 0 or NaN there is no inverse.
    """
    for i in range(4):
        for j in range(4):
            inverse[i, j] = 1.0 if i == j else 0.0
    determinant = 1.0
    for k in range(4):
        best = k
        for i in range(k + 1, 4):
            if abs(matrix[i, k]) > abs(matrix[best, k]):
                best = i
        pivot = matrix[best, k]
        determinant *= abs(pivot)
        if not determinant > 0.0:
            return determinant
        for j in range(4):
            one, other = matrix[best, j] / pivot, inverse[best, j] / pivot
            matrix[best, j], inverse[best, j] = matrix[k, j], inverse[k, j]
            matrix[k, j], inverse[k, j] = one, other
        for i in range(4):
            factor = matrix[i, k] if i != k else 0.0
            for j in range(4):
                matrix[i, j] -= factor * matrix[k, j]
                inverse[i, j] -= factor * inverse[k, j]
    return determinant
