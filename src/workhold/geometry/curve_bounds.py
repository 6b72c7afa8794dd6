"""How far a curve may be from a line or an arc: bounds by control points, no sampling.

Let a rational function have Bernstein coefficients a in its numerator and b > 0 in its denominator. It lies between the
smallest and the largest a / b, since it is a mean of them with positive weights. Distances from a line are such a function,
and so are squares of distances from a point. Halving the pieces brings the bound four times as near to the distance.

Glossary
--------
forward : a curve runs along a line without turning back, or around a centre in one sense. Between common ends it then has a
    point at each place of the line or arc, so that either is as far from the other as the curve's points are.
"""

from __future__ import annotations

from functools import lru_cache
from math import comb, inf

import numpy as np
from numpy.typing import NDArray

from workhold.geometry.rational import Pieces, halved
from workhold.geometry.segment import Arc, Segment

__all__ = ["departure"]

Array = NDArray[np.float64]

# Halvings, after which a bound is within some thousandth of the curve's own size of what it bounds, squared.
MOST_HALVINGS = 7
# A bound this near to a distance that is reached is good enough.
NEAR_ENOUGH = 1.03
# A share of the coefficients: a derivative that is nowhere below minus this vanishes or rises, but for rounding.
ROUNDING = 1e-11


@lru_cache(maxsize=64)
def product_table(n: int, m: int) -> tuple[Array, ...]:
    """Weights (n + 1, m + 1) of the products of Bernstein coefficients of degrees n and m."""
    i, j = np.arange(n + 1)[:, None], np.arange(m + 1)[None, :]
    weights = np.array([[comb(n, a) * comb(m, b) / comb(n + m, a + b) for b in range(m + 1)] for a in range(n + 1)])
    place = np.zeros((n + m + 1, n + 1, m + 1))
    place[i + j, i, j] = weights
    return (place.reshape(n + m + 1, -1),)


def product(a: Array, b: Array) -> Array:
    """(P, n + m + 1) Bernstein coefficients of the products of (P, n + 1) and (P, m + 1) ones."""
    (table,) = product_table(a.shape[1] - 1, b.shape[1] - 1)
    outer: Array = (a[:, :, None] * b[:, None, :]).reshape(len(a), -1)
    return outer @ table.T


def turning(u: Array, v: Array) -> Array:
    """Bernstein coefficients of u v' - u' v, whose sign is that of the derivative of v / u."""
    n = u.shape[1] - 1
    return product(u, n * np.diff(v)) - product(n * np.diff(u), v)


def departure(pieces: Pieces, segment: Segment, limit: float) -> float:
    """A bound on how far a curve and a line or arc between the same ends are from each other, in mm.

    Parameters
    ----------
    pieces : the curve; its ends are those of the segment, but for rounding, or the segment is a full circle.
    segment : the line or arc.
    limit : the largest bound that is of use.

    Returns
    -------
    float
        The bound; infinity where it is not shown to be within the limit, or the curve does not run forward.
    """
    for halving in range(MOST_HALVINGS + 1):
        reached, bound, forward = measured(pieces, segment)
        if reached > limit:
            return inf
        if bound <= limit and forward and (bound <= NEAR_ENOUGH * reached + 1e-9 or halving == MOST_HALVINGS):
            return bound
        if len(pieces) > 4096 and bound <= limit and forward:
            return bound
        if halving < MOST_HALVINGS:
            pieces = halved(pieces)
    return inf


def measured(pieces: Pieces, segment: Segment) -> tuple[float, float, bool]:
    """A distance that is reached, a bound of all, and whether the curve runs forward."""
    w = pieces[..., 2]
    if isinstance(segment, Arc):
        x, y = (pieces[..., k] - segment.center[k] * w for k in (0, 1))
        radius = segment.radius
        # How far the square of the distance from the centre is from that of the radius.
        off = product(x, x) + product(y, y) - radius * radius * product(w, w)
        ratio = off / product(w, w)
        away = np.abs(ratio) / (radius + np.sqrt(np.maximum(radius * radius + ratio, 0.0)))
        around = segment.sign * (product(x, np.diff(y)) - product(y, np.diff(x)))
        # Pieces that cover half a turn or more are distinguished from their complements when they are halved.
        (ax, bx), (ay, by) = (one[:, [0, -1]].T for one in (x, y))
        covered = segment.sign * np.arctan2(ax * by - ay * bx, ax * bx + ay * by).sum()
        forward = (around >= -ROUNDING * radius * radius).all() and abs(covered - 2 * segment.half_sweep) < 1e-3
        return float(away[:, [0, -1]].max()), float(away.max()), bool(forward)
    (x0, y0), (tx, ty) = segment.start, segment.tangent
    x, y = pieces[..., 0] - x0 * w, pieces[..., 1] - y0 * w
    away = np.abs(x * ty - y * tx) / w
    along = turning(w, x * tx + y * ty)
    forward = bool((along >= -ROUNDING * segment.length).all())
    return float(away[:, [0, -1]].max()), float(away.max()), forward
