"""Orientations found by companion matrices and by ball arithmetic."""

from __future__ import annotations

from math import pi, tau

import numpy as np
import pytest

from workhold.algebra.candidates import SECTORS
from workhold.algebra.exact import compute_exact_resultant, find_exact_roots
from workhold.algebra.poses import find_candidate_orientations, find_companion_roots, find_poses_at
from workhold.algebra.resultants import PAPER_DEGREES, TRUE_DEGREES, compute_resultant_coefficients
from workhold.algebra.table_two import make_random_contacts, tabulate_root_counts


@pytest.mark.thorough
@pytest.mark.parametrize("case", [case for case in PAPER_DEGREES if case[0] > 0])
def test_no_real_root_is_lost_to_rounding(case: tuple[int, int]) -> None:
    """Every real root isolated in ball arithmetic is met again, to the last digits, by a pose from double precision."""
    count = 60
    contacts = make_random_contacts(case, count, 5)
    owner, psi, undecided = find_candidate_orientations(contacts, case, np.ones((count, SECTORS), np.bool_))
    assert len(undecided) == 0
    poses = find_poses_at(contacts, case, owner, psi)
    for k in range(count):
        roots = find_exact_roots(contacts.take(np.array([k])), case)
        assert roots is not None
        real = np.angle(roots[np.abs(np.abs(roots) - 1.0) < 1e-9])
        assert len(real) > 0
        found = poses.psi[poses.owner == k]
        for angle in real:
            assert np.abs((found - angle + pi) % tau - pi).min() < 1e-7


# Table 2 of the paper: degrees of the resultants in t.
@pytest.mark.thorough
def test_degrees_are_the_numbers_of_solutions_of_general_systems() -> None:
    """No row's resultant has a spurious root: its degree is that of the Groebner basis, never above the paper's."""
    for row in tabulate_root_counts():
        assert row.ours == row.general <= row.paper
        assert row.roots == row.systems * row.general


@pytest.mark.thorough
def test_every_real_root_is_a_pose() -> None:
    """On random data each real root of a resultant belongs to exactly one pose that meets all contacts."""
    for row in tabulate_root_counts(count=100, seed=7):
        assert row.real == row.poses >= row.systems
        assert (row.roots - row.real) % 2 == 0


@pytest.mark.parametrize("case", [case for case in PAPER_DEGREES if case[0] > 0])
def test_ball_arithmetic_and_double_precision_agree(case: tuple[int, int]) -> None:
    """The resultant written out over balls has the same degree and roots as the one evaluated in doubles."""
    contacts = make_random_contacts(case, 1, 11)
    exact = find_exact_roots(contacts, case)
    assert exact is not None
    assert len(exact) == TRUE_DEGREES[case] == compute_exact_resultant(contacts, case).degree()
    double = find_companion_roots(compute_resultant_coefficients(contacts, case)[0])[0]
    for root in exact:
        assert np.abs(double - root).min() <= 1e-3 * (1.0 + abs(root))
