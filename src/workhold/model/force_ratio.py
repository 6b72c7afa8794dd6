"""The forces of two clamps: in which ratio they press every locator, and the ratio at which figures are taken.

Let the locators carry b1 f1 + b2 f2 where the clamps push with f1 and f2. All three are pressed exactly for an open interval
of f2 / f1. How far apart its ends are as angles is the clamp freedom: by how much the two forces may differ.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from workhold.conventions import NO_REACTION

__all__ = ["ratios", "working_forces"]

Array = NDArray[np.float64]

LOCATORS = 3


def ratios(reactions: Array) -> tuple[Array, Array]:
    """The ends (N,) of the open interval of f2 / f1 in which all locators are pressed, infinite where there is none above.

    Parameters
    ----------
    reactions : (N, 3 or more, 2) forces of the locators, and of further pegs, per unit of f1 and of f2.

    Examples
    --------
    >>> low, high = ratios(np.array([[[1.0, 0.0], [-0.5, 1.0], [0.5, 0.0]]]))
    >>> float(low[0]), float(high[0])
    (0.5, inf)
    """
    locators = np.where(np.abs(reactions[:, :LOCATORS]) < NO_REACTION, 0.0, reactions[:, :LOCATORS])
    one, two = locators[..., 0], locators[..., 1]
    with np.errstate(divide="ignore", invalid="ignore"):
        ends = -one / two
    low = np.where(two > 0.0, ends, 0.0).max(axis=1, initial=0.0)
    high = np.where(two < 0.0, ends, np.inf).min(axis=1, initial=np.inf)
    # Where no force of the second clamp reaches a locator, the first has to press it.
    high = np.where(((two == 0.0) & (one <= 0.0)).any(axis=1), 0.0, high)
    return low + 0.0, high + 0.0


def working_forces(reactions: Array) -> Array:
    """Forces (N, P) of all pegs per unit of f1 + f2 at the working ratio, the middle of the interval as an angle.

    Parameters
    ----------
    reactions : (N, P, 2) forces per unit of f1 and of f2.
    """
    low, high = ratios(reactions)
    angle = (np.arctan(low) + np.arctan(high)) / 2
    one, two = np.cos(angle), np.sin(angle)
    return np.asarray((reactions[..., 0] * one[:, None] + reactions[..., 1] * two[:, None]) / (one + two)[:, None])
