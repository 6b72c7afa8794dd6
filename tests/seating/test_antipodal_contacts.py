"""Tangencies of chords on two pieces, found once for each length and jaw."""

from __future__ import annotations

import numpy as np
import pytest

from seating_examples import solved
from workhold.kernels.seating.parallel_and_concentric import ALPHA, write_tangent_chords
from workhold.seating.antipodal_contacts import find_chord_tangencies
from workhold.seating.closing import fill_rows


@pytest.mark.parametrize("jaw", [0, 1])
def test_each_length_has_tangencies_of_its_own(jaw: int) -> None:
    """Lengths that differ by little have others, however often each is asked for."""
    boundary = next(iter(solved(0)[0].boundaries.values()))
    first, end = boundary.parts[jaw].tolist()
    found = 0
    for length in (20.0, 20.3, 20.0, 20.30001):
        rows = find_chord_tangencies(boundary, length, jaw)
        assert np.array_equal(
            rows, fill_rows(ALPHA + 1, 256, write_tangent_chords, boundary.pieces, first, end, length)
        )
        found += len(rows)
    assert found > 4
