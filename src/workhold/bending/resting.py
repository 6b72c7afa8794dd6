"""A part that rests on a stiff plate, which presses on it where they touch and nowhere else.

The level faces below the part are cut into N cells. The plate presses on cell i with a force p_i >= 0, and the
cell may rise off the plate by s_i >= 0, but not both. With C the compliance of the cells to each other, u their
rise by all other forces and W the wrench (F_z, M_x, M_y) of a unit force on each,

    s = C p + u + W m,   W' p = -w,   p >= 0,   s >= 0,   p's = 0,

where w is the wrench of the other forces and m the rigid motion of the part (rise, and two turns). These are
the conditions of a convex quadratic program (N. Kikuchi, J. T. Oden, *Contact Problems in Elasticity*, 1988).
It is solved iteratively from a guess of the touching cells: cells under tension are removed, cells that sink
into the plate are added. Further loads on the part change the forces of the touching cells; the set of
touching cells stays fixed.
"""

from __future__ import annotations

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.errors import InputError

__all__ = ["PlateRest", "find_rest"]

Array = NDArray[np.float64]
# How often the guess is mended, and the share of the largest force or rise that counts as nothing.
MOST_GUESSES, NOTHING = 400, 1e-9


@frozen(eq=False)
class PlateRest:
    """Cells of a part that touch the plate, with their forces and compliance.

    Parameters
    ----------
    touching : (T,) indices of the cells that touch.
    pressures : (N,) force in N on each cell; 0 where it does not touch.
    compliance : (T, T) rise in mm of each touching cell (row) per N on each touching cell (column).
    wrenches : (T, 3) wrench (F_z, M_x, M_y) of a unit force on each, in N and N mm.
    """

    touching: NDArray[np.int64]
    pressures: Array
    compliance: Array
    wrenches: Array

    def compute_bearing_forces(self, rise: Array, load: Array) -> Array:
        """Return the forces (T, V) in N by which the touching cells balance V further loads without moving.

        Parameters
        ----------
        rise : (T, V) rise in mm of each touching cell under the loads alone.
        load : (3, V) wrench (F_z, M_x, M_y) of the loads.
        """
        return solve_balance(self.compliance, self.wrenches, rise, load)[0]


def solve_balance(compliance: Array, wrenches: Array, rise: Array, load: Array) -> tuple[Array, Array]:
    """Return (forces (T, V), motions (3, V)) under which the T cells do not rise and V loads are balanced.

    The parameters are as in :class:`PlateRest` and :meth:`PlateRest.compute_bearing_forces`.
    """
    count = len(compliance)
    soft = max(float(np.abs(compliance).max()), 1e-30)
    sizes = np.maximum(np.abs(wrenches).max(axis=0), 1e-30)
    scaled = wrenches / sizes
    matrix = np.block([[compliance / soft, scaled], [scaled.T, np.zeros((3, 3))]])
    right = np.vstack([-rise / soft, -load / sizes[:, None]])
    found, *_ = np.linalg.lstsq(matrix, right, rcond=1e-12)
    return found[:count], soft * found[count:] / sizes[:, None]


def find_rest(compliance: Array, wrenches: Array, rise: Array, load: Array) -> PlateRest:
    """Return the cells that touch the plate and the force of the plate on each of N cells.

    Parameters
    ----------
    compliance : (N, N) rise in mm of each cell (row) per N on each cell (column).
    wrenches : (N, 3) wrench (F_z, M_x, M_y) of a unit force on each, in N and N mm.
    rise : (N,) rise in mm of each cell under all other forces.
    load : (3,) wrench (F_z, M_x, M_y) of all other forces.

    Raises
    ------
    InputError
        When no pressure from below balances the load: the part tips.

    Examples
    --------
    Three cells in a row, under a stiff part that is pressed down in the middle: all three carry the same
    force.

    >>> import numpy as np
    >>> stiff, row = 1e-9 * np.eye(3), np.array([[1.0, 0.0, 10.0], [1.0, 0.0, 0.0], [1.0, 0.0, -10.0]])
    >>> np.round(find_rest(stiff, row, np.zeros(3), np.array([-30.0, 0.0, 0.0])).pressures, 6).tolist()
    [10.0, 10.0, 10.0]
    """
    count = len(compliance)
    touching = np.ones(count, np.bool_)
    guesses: set[bytes] = set()
    for _ in range(MOST_GUESSES):
        own = np.flatnonzero(touching)
        forces, motion = solve_balance(
            compliance[np.ix_(own, own)], wrenches[own], rise[own, None], load[:, None]
        )
        pressures = np.zeros(count)
        pressures[own] = forces[:, 0]
        gaps = compliance @ pressures + rise + wrenches @ motion[:, 0]
        pulls = np.where(touching, -pressures, 0.0) / max(np.abs(pressures).max(), 1e-30)
        sinks = np.where(touching, 0.0, -gaps) / max(np.abs(gaps).max(), 1e-30)
        is_wrong = (pulls > NOTHING) | (sinks > NOTHING)
        if not is_wrong.any():
            if np.abs(wrenches.T @ pressures + load).max() > 1e-6 * np.abs(load).max():
                break
            return PlateRest(own, pressures, compliance[np.ix_(own, own)], wrenches[own])
        guesses.add(touching.tobytes())
        mended = touching ^ is_wrong
        if not mended.any() or mended.tobytes() in guesses:
            # Guesses go round in a circle: mend the first wrong cell alone, which comes to an end (K. G. Murty, 1974).
            mended = touching.copy()
            mended[np.flatnonzero(is_wrong)[-1]] ^= True
        touching = mended
    raise InputError("what presses on the part tips it off the plate, so that it is not known what bears it.")
