"""Fixtures on their way to a table, made up for the tests of what lists them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from workhold.listing.canonical_form import CandidateFixtures


def candidates(count: int) -> CandidateFixtures:
    """The same Type I fixture some times over."""

    def repeated(values: object, kind: type = float) -> NDArray[np.generic]:
        return np.repeat(np.array([values], dtype=kind), count, axis=0)

    return CandidateFixtures(
        standing=repeated(2, int),
        feature=repeated([0, 1, 2, 3], int),
        column=repeated([0, 1, 0, 0], int),
        row=repeated([0, 2, 1, 4], int),
        theta=repeated(0.5),
        point=repeated([[0.0, 0.0], [3.0, 4.0], [20.0, 1.0], [21.0, 6.0]]),
        gap=repeated(17.0),
        null=repeated([0.1, 0.2, 0.3, 0.4]),
        force=repeated([0.5, 1.0, 1.5, 2.0]),
    )
