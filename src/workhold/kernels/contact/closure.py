"""Force closure of four frictionless contacts (model: condition 4).

The wrench of a contact at q with outward unit normal n is w = (n, (q - c) x n / L). Four wrenches of the plane's
three-dimensional wrench space have a null vector whose entries are, up to a common factor, the signed 3x3 minors of
[w1 w2 w3 w4] (Cramer's rule); they positively span the space exactly when all entries have one sign and none is 0.
Reference: B. Mishra, J. T. Schwartz, M. Sharir, *On the existence and synthesis of multifinger positive grips*,
Algorithmica 2 (1987); the construction from minors is linear algebra.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.compiling import inner
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, IS_ARC, RADIUS, SIGN, X, Y

Array = NDArray[np.float64]

# Rounding of a minor.
ROUNDING = 1e-14


@inner
def cross(ax: float, ay: float, bx: float, by: float) -> float:
    """Cross product of two vectors of the plane."""
    return ax * by - ay * bx


@inner
def minors(points: Array, normals: Array, length: float, out: Array) -> float:
    """Null vector of the four wrenches, not scaled: their signed 3x3 minors.

    Parameters
    ----------
    points : (4, 2) contact points (or peg centres: they lie on the same lines of action) about the centre c, in mm.
    normals : (4, 2) outward unit normals.
    length : L in mm.
    out : (4,) receives the minors.

    Returns
    -------
    float
        The sum of their sizes; 0 when the wrenches do not span the space.
    """
    t0 = cross(points[0, 0], points[0, 1], normals[0, 0], normals[0, 1]) / length
    t1 = cross(points[1, 0], points[1, 1], normals[1, 0], normals[1, 1]) / length
    t2 = cross(points[2, 0], points[2, 1], normals[2, 0], normals[2, 1]) / length
    t3 = cross(points[3, 0], points[3, 1], normals[3, 0], normals[3, 1]) / length
    m01 = cross(normals[0, 0], normals[0, 1], normals[1, 0], normals[1, 1])
    m02 = cross(normals[0, 0], normals[0, 1], normals[2, 0], normals[2, 1])
    m03 = cross(normals[0, 0], normals[0, 1], normals[3, 0], normals[3, 1])
    m12 = cross(normals[1, 0], normals[1, 1], normals[2, 0], normals[2, 1])
    m13 = cross(normals[1, 0], normals[1, 1], normals[3, 0], normals[3, 1])
    m23 = cross(normals[2, 0], normals[2, 1], normals[3, 0], normals[3, 1])
    out[0] = t1 * m23 - t2 * m13 + t3 * m12
    out[1] = -(t0 * m23 - t2 * m03 + t3 * m02)
    out[2] = t0 * m13 - t1 * m03 + t3 * m01
    out[3] = -(t0 * m12 - t1 * m02 + t2 * m01)
    return abs(out[0]) + abs(out[1]) + abs(out[2]) + abs(out[3])


@inner
def minor_band(swing: float, away: float, length: float) -> float:
    """How far a minor may be off when normals may be turned by ``swing`` radians and points be off by ``away`` mm.

    Moments over L, of size 1.42 at most, are off by away / L + 1.42 swing, and products of two normals by 2 swing. A minor
    is three products of one with the other, so it is off by 12.8 swing + 3 away / L; the rest is for the second order.
    """
    return 20.0 * swing + 4.0 * away / length + ROUNDING


@inner
def outward_normal(row: Array, x: float, y: float) -> tuple[float, float]:
    """Outward unit normal of a feature at a point on it."""
    if row[IS_ARC] == 0.0:
        return (row[AXIS_Y], -row[AXIS_X])
    scale = row[SIGN] / row[RADIUS]
    return (scale * (x - row[X]), scale * (y - row[Y]))
