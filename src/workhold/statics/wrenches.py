"""Outward normals of whole sets of contacts."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["outward_normals"]

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
