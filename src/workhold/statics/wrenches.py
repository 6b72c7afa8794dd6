"""Outward normals of whole sets of contacts."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.feature import AXIS_X, AXIS_Y, IS_ARC, RADIUS, SIGN, X, Y

__all__ = ["outward_normals"]

Array = NDArray[np.float64]


def outward_normals(rows: Array, points: Array) -> Array:
    """Outward unit normals of features at peg centres on them.

    Parameters
    ----------
    rows : (..., 10) feature rows, see ``geometry.segment.segment_rows``.
    points : (..., 2) in mm.

    Returns
    -------
    (..., 2) array
    """
    is_arc, radius, sign = (rows[..., k, None] for k in (IS_ARC, RADIUS, SIGN))
    radial = sign * (points - rows[..., X : Y + 1]) / np.where(radius == 0.0, 1.0, radius)
    straight = np.stack([rows[..., AXIS_Y], -rows[..., AXIS_X]], axis=-1)
    return np.where(is_arc == 0.0, straight, radial)
