"""How numbers of a result file are rounded, and which figures it gives."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from workhold.model.quality import FIGURES, Figure
from workhold.model.result import FixtureTable

__all__ = ["ANGLE_STEPS", "LENGTH_STEPS", "known_figures", "rounded"]

LENGTH_STEPS = 1e9
ANGLE_STEPS = 1e10


def known_figures(table: FixtureTable) -> list[Figure]:
    """The figures of quality that all fixtures of a table have."""
    return [figure for number, figure in enumerate(FIGURES) if np.isfinite(table.quality[:, number]).all()]


def rounded(values: NDArray[np.floating[Any]], steps: float) -> NDArray[np.float64]:
    """The nearest floats to the multiples of 1/steps nearest to the values, without negative zeros."""
    return np.rint(values.astype(np.float64) * steps) / steps + 0.0
