"""Null vectors and clamping forces of whole sets of contacts, as the model states them (conditions 4 and 5)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from workhold.algebra.conditions import compute_wrench_minors
from workhold.conventions import LEAST_SPAN

Array = NDArray[np.float64]


def null_vectors(points: Array, normals: Array, length: float) -> Array:
    """Null vectors scaled to sum 1, (N, 4); all -1 where the wrenches do not span the space. Parameters as for
    ``compute_wrench_minors``."""
    out = compute_wrench_minors(points, normals, length)
    total = out.sum(axis=1, keepdims=True)
    spans = np.abs(total) > LEAST_SPAN
    return np.asarray(np.where(spans, out / np.where(spans, total, 1.0), -1.0))


def clamping_force(null: Array, normals: Array, theta: Array, lefts: NDArray[np.bool_]) -> Array:
    """Push of the left pegs along the vise's x axis, sum over left pegs of lambda_i (-n_i) . x.

    Parameters
    ----------
    null : (N, 4) null vectors.
    normals : (N, 4, 2) outward unit normals in the workpiece's frame.
    theta : (N,) orientation of the workpiece in radians.
    lefts : (N, 4) which pegs are on the left jaw.

    Returns
    -------
    (N,) array
    """
    along = normals[..., 0] * np.cos(theta)[:, None] - normals[..., 1] * np.sin(theta)[:, None]
    return np.asarray(-(null * along * lefts).sum(axis=1))
