"""Outward normals and wrenches of whole sets of contacts."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.feature import AXIS_X, AXIS_Y, IS_ARC, RADIUS, SIGN, X, Y

__all__ = ["outward_normals", "wrenches"]

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


def wrenches(points: Array, normals: Array, length: float) -> Array:
    """Wrenches (..., 3) of contacts: the normal, and its moment over L.

    Parameters
    ----------
    points, normals : (..., 2) peg centres about the centre of the part, in mm, and outward unit normals there.
    length : L in mm.
    """
    moments = (points[..., 0] * normals[..., 1] - points[..., 1] * normals[..., 0]) / length
    return np.concatenate([normals, moments[..., None]], axis=-1)
