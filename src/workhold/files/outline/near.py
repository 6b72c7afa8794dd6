"""Which of many points lie close together, in about linear time."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from workhold.errors import InputError
from workhold.files.questions import JOIN_TOLERANCE

__all__ = ["close_pairs", "groups"]

# More distinct points than this within one tolerance: the tolerance is larger than the drawing's details.
CROWD = 64


def close_pairs(points: NDArray[np.float64], tolerance: float) -> NDArray[np.int64]:
    """Pairs of points at most a tolerance apart.

    Points that are exactly equal are paired in a row, first to second, second to third; distinct points in all pairs.

    Parameters
    ----------
    points : (N, 2) array in mm.
    tolerance : in mm, positive.

    Returns
    -------
    (P, 2) array of indices.

    Raises
    ------
    InputError
        When so many points crowd within the tolerance that it cannot be meant.
    """
    if len(points) < 2:
        return np.empty((0, 2), dtype=np.int64)
    order = np.lexsort((points[:, 1], points[:, 0]))
    equal = np.all(points[order[1:]] == points[order[:-1]], axis=1)
    pairs = [np.column_stack((order[:-1][equal], order[1:][equal]))]
    distinct = order[np.concatenate(([True], ~equal))]
    pairs += [distinct[p] for p in pairs_in_strips(points[distinct], tolerance)]
    found = np.concatenate(pairs).astype(np.int64)
    found.sort(axis=1)
    return np.unique(found, axis=0)


def pairs_in_strips(points: NDArray[np.float64], tolerance: float) -> list[NDArray[np.int64]]:
    """Index pairs of distinct points at most a tolerance apart; a pair may come twice.

    Vertical strips two tolerances wide, laid twice with an offset of one, put every close pair in a common strip.
    """
    pairs = []
    for offset in (0.0, 0.5):
        strip = np.floor(points[:, 0] / (2 * tolerance) + offset)
        order = np.lexsort((points[:, 1], strip))
        strip, x, y = strip[order], points[order, 0], points[order, 1]
        for step in range(1, len(points)):
            near = (strip[step:] == strip[:-step]) & (y[step:] - y[:-step] <= tolerance)
            if not near.any():
                break
            if step > CROWD:
                k = int(np.flatnonzero(near)[0])
                raise InputError(
                    f"More than {CROWD} ends lie within {tolerance:g} mm of each other near ({x[k]:.6g}, {y[k]:.6g}): "
                    f"give a smaller {JOIN_TOLERANCE}."
                )
            near &= np.hypot(x[step:] - x[:-step], y[step:] - y[:-step]) <= tolerance
            first = np.flatnonzero(near)
            pairs.append(np.column_stack((order[first], order[first + step])))
    return pairs


def groups(count: int, pairs: NDArray[np.int64]) -> NDArray[np.int64]:
    """(count,) group numbers of items of which pairs belong together; a group is named by its smallest item."""
    parent = list(range(count))

    def root(item: int) -> int:
        while parent[item] != item:
            parent[item] = parent[parent[item]]
            item = parent[item]
        return item

    for i, j in pairs.tolist():
        a, b = root(i), root(j)
        if a != b:
            parent[max(a, b)] = min(a, b)
    return np.array([root(k) for k in range(count)], dtype=np.int64)
