"""Linear programs of few rows that differ in the right side alone: the least cost of each.

minimize c . x subject to A x = b, x >= 0, with c >= 0, by the simplex method in two phases (G. B. Dantzig,
*Linear Programming and Extensions*, 1963, chapter 5), by R. G. Bland's rule, which never goes in circles
(Mathematics of Operations Research 2, 1977). An optimal basis of one b stays optimal for every other b that
it solves with x >= 0, because the reduced costs do not depend on b. So few programs are solved, and the rest
are looked up.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["least_costs"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
# Parts of the largest entry of a right side: forces and costs that rounding makes; and turns of the method.
NEGLIGIBLE, MOST_TURNS = 1e-10, 2000


def least_costs(matrix: Array, costs: Array, sides: Array) -> Array:
    """Least costs (N,) of programs, infinite where nothing solves one.

    Parameters
    ----------
    matrix : (R, V) A, whose rows are of like size.
    costs : (V,) c, none negative.
    sides : (N, R) right sides b.
    """
    out, open_ = np.full(len(sides), np.inf), np.ones(len(sides), bool)
    while open_.any():
        first = int(np.flatnonzero(open_)[0])
        open_[first] = False
        basis = optimal_basis(matrix, costs, sides[first])
        if basis is None:
            continue
        values = np.linalg.solve(matrix[:, basis], sides.T).T
        size = np.abs(sides).max(axis=1, initial=1.0)
        solved = open_ & (values >= -NEGLIGIBLE * size[:, None]).all(axis=1)
        solved[first] = True
        out[solved] = np.maximum(values[solved], 0.0) @ costs[basis]
        open_ &= ~solved
    return out


def optimal_basis(matrix: Array, costs: Array, side: Array) -> IntArray | None:
    """The columns (R,) that are not 0 in a solution of the least cost; None where nothing solves it."""
    rows, columns = matrix.shape
    size = max(float(np.abs(side).max()), 1.0)
    signs = np.where(side < 0.0, -1.0, 1.0)
    wide = np.hstack([matrix, np.diag(signs)])
    basis = np.arange(columns, columns + rows)
    artificial = np.concatenate([np.zeros(columns), np.ones(rows)])
    basis, values = improved(wide, artificial, side, basis)
    if values[basis >= columns].sum() > 1e-8 * size:
        return None
    # What is artificial and 0 still leaves the basis for a column that can replace it.
    for place in np.flatnonzero(basis >= columns):
        row = np.linalg.inv(wide[:, basis])[place] @ matrix
        row[basis[basis < columns]] = 0.0
        if np.abs(row).max() < 1e-9:
            return None
        basis[place] = int(np.abs(row).argmax())
    return improved(matrix, costs, side, basis)[0]


def improved(matrix: Array, costs: Array, side: Array, basis: IntArray) -> tuple[IntArray, Array]:
    """A basis of the least cost, and its values, from one with values of 0 or more."""
    basis = basis.copy()
    for turn in range(MOST_TURNS):
        inverse = np.linalg.inv(matrix[:, basis])
        values = inverse @ side
        reduced = costs - (costs[basis] @ inverse) @ matrix
        reduced[basis] = 0.0
        entering = np.flatnonzero(reduced < -NEGLIGIBLE)
        if not len(entering):
            break
        # The steepest column is quick; Bland's first one ends where the steepest goes in circles.
        enters = int(entering[0] if turn > MOST_TURNS // 4 else entering[reduced[entering].argmin()])
        change = inverse @ matrix[:, enters]
        falls = np.flatnonzero(change > 1e-11)
        if not len(falls):
            break
        ratios = np.maximum(values[falls], 0.0) / change[falls]
        ties = falls[ratios <= ratios.min() * (1 + 1e-12)]
        leaves = ties[basis[ties].argmin()] if turn > MOST_TURNS // 4 else ties[change[ties].argmax()]
        basis[leaves] = enters
    return basis, np.linalg.inv(matrix[:, basis]) @ side
