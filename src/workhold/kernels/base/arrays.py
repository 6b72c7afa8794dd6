"""Arrays inside kernels: the order of their rows, and inverses of matrices of four rows."""

from __future__ import annotations

from workhold.kernels.base.compiling import Array, IntArray, inner


@inner
def sort_rows(rows: Array, column: int, sign: float, keys: Array, order: IntArray, out: Array) -> None:
    """Write the (N, M) ``rows`` to ``out`` in ascending order of
    ``sign * rows[:, column]`` (Shell sort, not stable).

    ``rows`` stays as it is; ``keys`` and ``order`` are (N,) work space, after which ``order[j]`` is the index
    in ``rows`` of row j of ``out``.
    """
    count = rows.shape[0]
    for k in range(count):
        keys[k], order[k] = sign * rows[k, column], k
    step = 1
    while step < count // 3:
        step = 3 * step + 1
    while step > 0:
        for k in range(step, count):
            key, item, at = keys[k], order[k], k
            while at >= step and keys[at - step] > key:
                keys[at], order[at] = keys[at - step], order[at - step]
                at -= step
            keys[at], order[at] = key, item
        step //= 3
    for j in range(count):
        for k in range(rows.shape[1]):
            out[j, k] = rows[order[j], k]


@inner
def write_inverse(matrix: Array, inverse: Array) -> float:
    """Write the inverse of a (4, 4) matrix to ``inverse`` by Gauss-Jordan elimination with row pivoting.

    ``matrix`` is overwritten.

    Returns
    -------
    float
        Absolute value of the determinant. Where it is 0 or NaN, ``inverse`` holds no inverse.
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
        # With a name for each entry, the pivot's row is not read again for each row that it is taken from.
        a, b = matrix[best, 0] / pivot, matrix[best, 1] / pivot
        c, d = matrix[best, 2] / pivot, matrix[best, 3] / pivot
        e, f = inverse[best, 0] / pivot, inverse[best, 1] / pivot
        g, h = inverse[best, 2] / pivot, inverse[best, 3] / pivot
        for j in range(4):
            matrix[best, j], inverse[best, j] = matrix[k, j], inverse[k, j]
        matrix[k, 0], matrix[k, 1], matrix[k, 2], matrix[k, 3] = a, b, c, d
        inverse[k, 0], inverse[k, 1], inverse[k, 2], inverse[k, 3] = e, f, g, h
        for i in range(4):
            if i != k:
                factor = matrix[i, k]
                matrix[i, 0] -= factor * a
                matrix[i, 1] -= factor * b
                matrix[i, 2] -= factor * c
                matrix[i, 3] -= factor * d
                inverse[i, 0] -= factor * e
                inverse[i, 1] -= factor * f
                inverse[i, 2] -= factor * g
                inverse[i, 3] -= factor * h
    return determinant
