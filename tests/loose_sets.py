"""Loose sets whose configurations are given."""

from __future__ import annotations

from collections.abc import Sequence
from math import nan

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.seating.columns import CANDIDATE_LENGTH, CONFIG, CONTACTS, Manifolds

Array = NDArray[np.float64]
NOWHERE = nan, nan


def laid_out(
    parts: Sequence[Array],
    contacts: Sequence[float] | None = None,
    closed: Sequence[bool] | None = None,
    across: Sequence[tuple[float, float]] | None = None,
) -> Manifolds:
    """Sets of some configurations (N, 4) each, with their first ones as candidates, of two contacts if nothing is said."""
    count = len(parts)
    rows = np.zeros((count, CANDIDATE_LENGTH))
    rows[:, CONFIG] = np.array([part[0] for part in parts]).reshape(-1, 4)
    rows[:, CONTACTS] = 2.0 if contacts is None else contacts
    configs = np.concatenate([np.zeros((0, 4)), *parts])
    begins = np.cumsum([0, *(len(part) for part in parts)])
    whole = np.zeros(count, np.int8) if closed is None else np.array(closed, np.int8)
    return Manifolds(rows, configs, begins, whole, np.array(across or [NOWHERE] * count).reshape(-1, 2))


def straight(level: float, length: float, steps: int = 5, start: tuple[float, float] = (0.0, 0.0)) -> Array:
    """Configurations along x from a place on, with one separation."""
    configs = np.zeros((steps, 4))
    configs[:, 1], configs[:, 2], configs[:, 3] = start[0] + np.linspace(0.0, length, steps), start[1], level
    return configs
