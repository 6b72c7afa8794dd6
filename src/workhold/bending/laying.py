"""The rigid motion that lays a bent part against its locators."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

__all__ = ["Constraints", "find_rigid_motion"]

Array = NDArray[np.float64]
# Of the largest singular value: motions that constraints feel less than this part are left to the next ones.
FELT = 1e-6


@frozen(eq=False)
class Constraints:
    """Linear equations of a rigid motion.

    Parameters
    ----------
    rows : (R, K) coefficients of the equations. The K unknowns are shifts along x, y and z in mm, then turns
        about these axes times a length in mm, then travels of carriers in mm.
    values : (R,) right-hand sides in mm.
    """

    rows: Array
    values: Array


def find_rigid_motion(levels: Sequence[Constraints]) -> Array:
    """Return the motion (K,) that fits the levels of constraints in order of priority, by least squares.

    The first level is fitted best; among the motions that do so, the second level is fitted best, and so on.
    Remaining freedom is used to make the motion as small as possible.

    >>> import numpy as np
    >>> wall = Constraints(np.array([[1.0, 0.0], [1.0, 0.0]]), np.array([2.0, 4.0]))
    >>> floor = Constraints(np.array([[1.0, 1.0]]), np.array([0.0]))
    >>> np.round(find_rigid_motion([wall, floor]), 9).tolist()
    [3.0, -3.0]
    """
    count = levels[0].rows.shape[1]
    motion, free = np.zeros(count), np.eye(count)
    for level in levels:
        if not free.shape[1] or not len(level.rows):
            continue
        rows = level.rows @ free
        left, sizes, right = np.linalg.svd(rows, full_matrices=True)
        felt = int((sizes > FELT * max(sizes.max(initial=0.0), FELT)).sum())
        missing = level.values - level.rows @ motion
        motion = motion + free @ (right[:felt].T @ ((left[:, :felt].T @ missing) / sizes[:felt]))
        free = free @ right[felt:].T
    return motion
