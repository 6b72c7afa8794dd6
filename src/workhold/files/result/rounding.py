"""How numbers of a result file are rounded, and which figures it gives."""

from __future__ import annotations

from typing import Any

import numpy as np
from attrs import evolve
from numpy.typing import NDArray

from workhold.model.quality import FIGURES, Figure
from workhold.model.result import FixtureTable

__all__ = [
    "ANGLE_STEPS",
    "LENGTH_STEPS",
    "as_told",
    "known_figures",
    "rounded",
    "rounded_degrees",
    "significant",
]

LENGTH_STEPS = 1e9
ANGLE_STEPS = 1e10
# Digits of forces and figures of quality; what lies nearer than this to the middle between two such numbers is rounded
# one by one, because a product in doubles may fall on its other side.
DIGITS, DOUBTFUL = 12, 1e-3


def known_figures(table: FixtureTable) -> list[Figure]:
    """The figures of quality that all fixtures of a table have."""
    return [figure for number, figure in enumerate(FIGURES) if np.isfinite(table.quality[:, number]).all()]


def rounded(values: NDArray[np.floating[Any]], steps: float) -> NDArray[np.float64]:
    """The nearest floats to the multiples of 1/steps nearest to the values, without negative zeros."""
    return np.rint(values.astype(np.float64) * steps) / steps + 0.0


def rounded_degrees(degrees: Any) -> NDArray[np.float64]:
    """Angles in degrees, a number or an array, as they are written, in [0, 360)."""
    out = rounded(np.asarray(degrees) % 360.0, ANGLE_STEPS)
    return np.where(out >= 360.0, 0.0, out)


def as_told(table: FixtureTable) -> tuple[NDArray[np.float64], FixtureTable]:
    """Orientations (N,) in degrees as they are written, and the table with poses and travels as they are then read: where
    pegs stand follows from these, so that it is the same for the reader."""
    theta = rounded_degrees(np.degrees(table.theta))
    position, travel = (rounded(values, LENGTH_STEPS) for values in (table.position, table.jaw_separation))
    return theta, evolve(table, theta=np.radians(theta), position=position, jaw_separation=travel)


def significant(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """The floats nearest to values as they are with twelve significant digits; NaN for what is not finite, which JSON does
    not know either.

    A whole number below 1e12 times or over an exact power of ten is rounded once, as reading the digits is.
    """
    values = np.where(np.isfinite(values), values, np.nan)
    size = np.abs(values)
    known = size > 0.0
    exponent = np.floor(np.log10(np.where(known, size, 1.0))).astype(np.int64)
    shift = DIGITS - 1 - exponent
    exact = known & (np.abs(shift) <= 22)
    power = 10.0 ** np.where(exact, np.abs(shift), 0)
    scaled = np.where(shift >= 0, values * power, values / power)
    digits = np.rint(scaled)
    out = np.where(exact, np.where(shift >= 0, digits / power, digits * power), values)
    doubtful = known & ~(exact & (np.abs(scaled - np.floor(scaled) - 0.5) > DOUBTFUL))
    out[doubtful] = [float(f"{value:.{DIGITS}g}") for value in values[doubtful].tolist()]
    return np.asarray(out)
