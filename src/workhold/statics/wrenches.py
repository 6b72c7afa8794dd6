"""Outward normals and minors of wrenches for whole sets of fixtures (model: condition 4)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["outward_normals", "wrench_minors"]

Array = NDArray[np.float64]


def outward_normals(rows: Array, points: Array) -> Array:
    """Outward unit normals of features at peg centres on them.

    Parameters
    ----------
    rows : (..., 8) feature rows, see ``geometry.segment.segment_rows``.
    points : (..., 2) in mm.

    Returns
    -------
    (..., 2) array
    """
    radial = rows[..., 7:8] * (points - rows[..., 1:3]) / np.where(rows[..., 6:7] == 0.0, 1.0, rows[..., 6:7])
    straight = np.stack([rows[..., 4], -rows[..., 3]], axis=-1)
    return np.where(rows[..., :1] == 0.0, straight, radial)


def wrench_minors(points: Array, normals: Array, length: float) -> Array:
    """Null vectors of four contacts' wrenches (n, (q - c) x n / L), not scaled: their signed 3x3 minors (Cramer's rule).

    Parameters
    ----------
    points : (N, 4, 2) peg centres about c in mm.
    normals : (N, 4, 2) outward unit normals.
    length : L in mm.

    Returns
    -------
    (N, 4) array
    """
    moments = (points[..., 0] * normals[..., 1] - points[..., 1] * normals[..., 0]) / length
    out = np.empty(moments.shape)
    for k in range(4):
        a, b, c = (i for i in range(4) if i != k)
        minor = sum(
            sign * moments[:, i] * (normals[:, j, 0] * normals[:, m, 1] - normals[:, j, 1] * normals[:, m, 0])
            for sign, i, j, m in ((1.0, a, b, c), (-1.0, b, a, c), (1.0, c, a, b))
        )
        out[:, k] = (-1) ** k * np.asarray(minor)
    return out
