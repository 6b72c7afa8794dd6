"""Where pegs touch, for carriers whose pegs are alike and for others."""

from __future__ import annotations

from itertools import combinations, permutations
from math import cos, pi, sin
from random import Random
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from attrs import evolve

from closing_forces import clamping_force, null_vectors
from workhold import Vise, Workpiece
from workhold.conventions import LEAST_SPAN
from workhold.kernels.contact.rules import write_minors
from workhold.statics.contact_matrix import TouchableFeatures, compute_outward_normals

# An L: the faces at x = 20 and y = 20 meet in a concave corner, where a peg's centre stays its radius away.
CORNER = Workpiece.from_loops(
    "L", [[[0, 0, 0], [60, 0, 0], [60, 20, 0], [20, 20, 0], [20, 60, 0], [0, 60, 0]]]
)
BELOW, ABOVE, BESIDE, LEFT = 0, 2, 3, 5


def toolkit(standing: float, moving: float) -> Any:
    """A vise as far as statics look at it, with pegs of two radii."""
    one, other = Vise(pitch=10, columns=1, peg_radius=2).carriers
    carriers = (evolve(one, peg_radius=standing), evolve(other, peg_radius=moving))
    return SimpleNamespace(carriers=carriers, clamping=1, moving_axis=(1, 0))


@pytest.mark.parametrize(("standing", "moving"), [(2.0, 2.0), (2.0, 5.0), (5.0, 2.0), (3.0, 0.0)])
def test_a_peg_is_as_far_from_the_end_of_a_face_as_its_own_radius_lets_it(
    standing: float, moving: float
) -> None:
    """A peg 6 mm from the concave corner, along either face, is 6 mm less its radius from the end of its feature; so are
    pegs of another radius on the same face."""
    touched = TouchableFeatures.from_workpiece(CORNER, toolkit(standing, moving))
    carriers = np.array([[0, 0, 1, 1]])
    radii = np.array([standing, standing, moving, moving])
    faces = np.array([[ABOVE, LEFT, BESIDE, BELOW], [BESIDE, BELOW, ABOVE, LEFT]])
    at = {
        ABOVE: lambda r: (26, 20 + r),
        BESIDE: lambda r: (20 + r, 26),
        LEFT: lambda r: (-r, 30),
        BELOW: lambda r: (31, -r),
    }
    pegs = np.array(
        [[at[face](r) for r, face in zip(radii, row, strict=True)] for row in faces.tolist()], np.float64
    )
    found = touched.compute_contact_matrices(pegs, np.zeros((2, 3)), np.repeat(carriers, 2, axis=0), faces)
    inner = np.isin(faces, (ABOVE, BESIDE))
    assert found.ends[inner] == pytest.approx((6.0 - np.stack([radii, radii]))[inner])
    assert found.normals[faces == ABOVE] == pytest.approx(np.array([(0, 1), (0, 1)]))
    assert touched.length == pytest.approx(np.hypot(60, 60) / 2 + max(standing, moving))


# Four frictionless contacts close exactly when their one null vector is positive.
def contacts(random: Random) -> tuple[np.ndarray, np.ndarray]:
    """Four random contact points within 50 mm and unit normals."""
    angles = np.array([random.uniform(-pi, pi) for _ in range(4)])
    points = np.array([[random.uniform(-50, 50), random.uniform(-50, 50)] for _ in range(4)])
    return points, np.stack([np.cos(angles), np.sin(angles)], axis=1)


def wrenches(points, normals, length):
    """The matrix [w1 w2 w3 w4], 3 x 4."""
    moments = (points[:, 0] * normals[:, 1] - points[:, 1] * normals[:, 0]) / length
    return np.vstack([normals.T, moments])


def solved(points, normals, length):
    """Smallest entry of the kernel's null vector, scaled to sum 1, and that vector."""
    out = np.empty(4)
    assert write_minors(points, normals, length, out) == np.abs(out).sum()
    null = out / out.sum()
    return null.min(), null


def close_by_separation(matrix) -> bool:
    """Positive spanning by its definition: no plane through the origin has all wrenches on one closed side.

    It is enough to try planes through two of the wrenches (Stiemke's lemma for vectors in general position).
    """
    for i, j in combinations(range(4), 2):
        sides = np.cross(matrix[:, i], matrix[:, j]) @ np.delete(matrix, [i, j], axis=1)
        if sides[0] * sides[1] >= 0:
            return False
    return True


def test_the_null_vector_is_null_and_sums_to_one():
    """[w1 w2 w3 w4] lambda = 0 and sum lambda = 1; the singular value decomposition gives the same vector."""
    random = Random(1)
    for _ in range(500):
        points, normals = contacts(random)
        smallest, null = solved(points, normals, 40.0)
        scale = np.abs(null).max()
        assert np.abs(wrenches(points, normals, 40.0) @ null).max() < 1e-12 * scale
        assert null.sum() == pytest.approx(1.0, abs=1e-12 * scale)
        assert smallest == null.min()
        kernel = np.linalg.svd(wrenches(points, normals, 40.0))[2][3]
        assert np.allclose(kernel / kernel.sum(), null, rtol=1e-7)


def test_compiled_and_array_forms_agree():
    """kernels.contact.closure.minors and algebra.conditions.compute_wrench_minors, both scaled, are one function."""
    random = Random(2)
    many = [contacts(random) for _ in range(300)]
    points, normals = (np.array(column) for column in zip(*many, strict=True))
    array_form = null_vectors(points, normals, 30.0)
    for k, (p, n) in enumerate(many):
        assert np.allclose(solved(p, n, 30.0)[1], array_form[k], rtol=1e-9)


@pytest.mark.thorough
def test_positive_exactly_when_no_plane_has_all_wrenches_on_one_side():
    """All lambda_i > 0 iff the wrenches positively span R^3 (Mishra, Schwartz & Sharir 1987)."""
    random = Random(3)
    closed = 0
    for _ in range(2000):
        points, normals = contacts(random)
        verdict = close_by_separation(wrenches(points, normals, 40.0))
        assert (solved(points, normals, 40.0)[0] > 0) == verdict
        closed += verdict
    assert 50 < closed < 1500


def test_closure_does_not_depend_on_frame_scale_or_order():
    """Turning and moving the frame leaves lambda as it is; another L too; renaming the pegs permutes it."""
    random = Random(4)
    for _ in range(200):
        points, normals = contacts(random)
        null = solved(points, normals, 40.0)[1]
        size = 1e-9 * np.abs(null).max()
        t = random.uniform(-pi, pi)
        turn = np.array([[cos(t), -sin(t)], [sin(t), cos(t)]])
        shift = np.array([random.uniform(-90, 90), random.uniform(-90, 90)])
        assert np.allclose(solved(points @ turn.T + shift, normals @ turn.T, 40.0)[1], null, atol=size)
        assert np.allclose(solved(points, normals, 7.0)[1], null, atol=size)
        order = list(random.choice(list(permutations(range(4)))))
        assert np.allclose(solved(points[order], normals[order], 40.0)[1], null[order], atol=size)


def test_sliding_a_contact_along_its_line_of_action_changes_nothing():
    """A wrench depends on the line of action alone, so peg centres serve as well as contact points."""
    random = Random(5)
    for _ in range(200):
        points, normals = contacts(random)
        moved = points + normals * np.array([[random.uniform(-30, 30)] for _ in range(4)])
        null = solved(points, normals, 40.0)[1]
        assert np.allclose(solved(moved, normals, 40.0)[1], null, atol=1e-9 * np.abs(null).max())


def test_concurrent_normals_do_not_close():
    """Four lines of action through one point leave the rotation about it free: the minors all vanish."""
    random = Random(6)
    for _ in range(200):
        _, normals = contacts(random)
        points = np.array([3.0, -2.0]) + normals * np.array([[random.uniform(1, 30)] for _ in range(4)])
        matrix = wrenches(points - [3.0, -2.0], normals, 40.0)
        assert np.linalg.matrix_rank(matrix, tol=1e-9) < 3
        assert write_minors(points - [3.0, -2.0], normals, 40.0, np.empty(4)) < LEAST_SPAN * 1e-6


def test_three_concurrent_normals_leave_the_fourth_without_force():
    """If w1, w2, w3 meet in one point the fourth entry of every null vector is 0 there, so nothing closes."""
    points = np.array([[10.0, 0], [0, 10.0], [-10.0, 0], [3.0, -8.0]])
    normals = np.array([[1.0, 0], [0, 1.0], [-1.0, 0], [0, -1.0]])
    smallest, null = solved(points, normals, 10.0)
    assert smallest == pytest.approx(0.0, abs=1e-15) and null[3] == pytest.approx(0.0, abs=1e-15)


def test_a_pinwheel_on_a_square_closes_with_equal_forces():
    """Pegs on the four sides of a square, each off the middle the same way round: opposite couples... lambda = 1/4."""
    points = np.array([[10.0, 3.0], [-3.0, 10.0], [-10.0, 3.0], [3.0, -10.0]])
    normals = np.array([[1.0, 0], [0, 1.0], [-1.0, 0], [0, -1.0]])
    # The x pair is in line and the y pair is a couple: no closure.
    assert solved(points, normals, 10.0)[0] <= 0
    # Couples that turn against each other balance: x pair at +-3, y pair at +-3, of opposite sense.
    points = np.array([[10.0, 3.0], [3.0, 10.0], [-10.0, -3.0], [-3.0, -10.0]])
    smallest, null = solved(points, normals, 10.0)
    assert null == pytest.approx(np.full(4, 0.25)) and smallest == pytest.approx(0.25)


def test_clamping_force_is_the_push_of_the_left_pegs():
    """Sum over left pegs of lambda_i (-n_i) . x, with n turned by theta; the right pegs push back by the same."""
    random = Random(7)
    for _ in range(100):
        points, normals = contacts(random)
        null = solved(points, normals, 40.0)[1]
        theta = random.uniform(-pi, pi)
        lefts = np.array([[True, True, False, False]])
        force = clamping_force(null[None], normals[None], np.array([theta]), lefts)[0]
        turned = normals @ np.array([[cos(theta), sin(theta)], [-sin(theta), cos(theta)]])
        assert force == pytest.approx(-(null[:2] * turned[:2, 0]).sum(), rel=1e-9, abs=1e-9)
        other = clamping_force(null[None], normals[None], np.array([theta]), ~lefts)[0]
        assert force + other == pytest.approx(0.0, abs=1e-9 * np.abs(null).max())


def test_outward_normals_of_rows():
    """A line's normal is its tangent turned right; an arc's is radial, away from the centre if convex, to it if concave."""
    rows = np.array([[0, 1, 2, 0.6, 0.8, 5, 0, 1], [1, 1, 2, 1, 0, 3, 5, 1], [1, 1, 2, 1, 0, 3, 5, -1.0]])
    points = np.array([[1.0, 2], [4.0, 6], [4.0, 6]])
    assert compute_outward_normals(rows, points) == pytest.approx(
        np.array([[0.8, -0.6], [0.6, 0.8], [-0.6, -0.8]])
    )
