"""Choices of least total cost under linear constraints, found by the solver HiGHS (branch and bound) of
SciPy.

References
----------
Q. Huangfu, J. A. J. Hall, "Parallelizing the dual revised simplex method", Mathematical Programming
Computation 10 (2018) 119-142.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from workhold.errors import InputError

__all__ = ["REQUIREMENT", "ROUNDING", "find_best_choice", "load_solver"]

REQUIREMENT = "scipy>=1.13"
# A bound this little below a whole number is that number.
ROUNDING = 1e-6


def load_solver() -> None:
    """Check that HiGHS can be imported.

    Raises
    ------
    InputError
        When SciPy is not installed; the message says how to install it.
    """
    try:
        import scipy.optimize  # noqa: F401
    except ImportError as error:
        raise InputError(
            f"a family needs SciPy, which is not installed: pip install '{REQUIREMENT}'."
        ) from error


def find_best_choice(
    costs: NDArray[np.float64], constraint: Any, seconds: float | None
) -> tuple[list[int] | None, float | None]:
    """Return (indices of the chosen items, lower bound of the total cost) for a choice of least total cost.

    ``costs`` (N,) has the cost of each item. ``constraint`` is a SciPy constraint on N variables, which are 1
    for a chosen item, else 0. After ``seconds`` (None: no limit) the choice is the best one found. Either
    result is None if it is not known.
    """
    from scipy.optimize import Bounds, milp

    options = (
        {"mip_rel_gap": 0.0} if seconds is None else {"mip_rel_gap": 0.0, "time_limit": max(seconds, 0.0)}
    )
    found = milp(
        costs,
        integrality=np.ones(len(costs)),
        bounds=Bounds(0, 1),
        constraints=constraint,
        options=options,
    )
    bound = found.mip_dual_bound
    chosen = None if found.x is None else np.flatnonzero(found.x > 0.5).tolist()
    return chosen, None if bound is None or not np.isfinite(bound) else float(bound)
