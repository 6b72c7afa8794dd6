"""Orientations found by companion matrices and by ball arithmetic."""

from __future__ import annotations

from math import pi, tau

import numpy as np
import pytest

from workhold.algebra.candidates import SECTORS
from workhold.algebra.exact import exact_roots
from workhold.algebra.poses import orientations, poses_at
from workhold.algebra.resultants import PAPER_DEGREES
from workhold.algebra.table_two import random_contacts


@pytest.mark.parametrize("case", [case for case in PAPER_DEGREES if case[0] > 0])
def test_no_real_root_is_lost_to_rounding(case: tuple[int, int]) -> None:
    """Every real root isolated in ball arithmetic is met again, to the last digits, by a pose from double precision."""
    count = 60
    contacts = random_contacts(case, count, 5)
    owner, psi, undecided = orientations(contacts, case, np.ones((count, SECTORS), np.bool_))
    assert len(undecided) == 0
    poses = poses_at(contacts, case, owner, psi)
    for k in range(count):
        roots = exact_roots(contacts.take(np.array([k])), case)
        assert roots is not None
        real = np.angle(roots[np.abs(np.abs(roots) - 1.0) < 1e-9])
        assert len(real) > 0
        found = poses.psi[poses.owner == k]
        for angle in real:
            assert np.abs((found - angle + pi) % tau - pi).min() < 1e-7
