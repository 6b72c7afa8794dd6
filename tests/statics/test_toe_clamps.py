"""What Mishra's toe clamps are cited for (docs/plates.md): six contacts close if any do, and four hold a rectangle."""

from __future__ import annotations

from itertools import combinations
from math import cos, pi, sin

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import linprog

Array = NDArray[np.float64]


def wrenches(points: Array, inward: Array) -> Array:
    """Wrenches (N, 3) of unit forces along inward normals (N, 2) at points (N, 2)."""
    return np.column_stack([inward, points[:, 0] * inward[:, 1] - points[:, 1] * inward[:, 0]])


def closes(forces: Array) -> bool:
    """Whether wrenches (N, 3) span the space positively: of rank 3, with a null vector whose entries all are positive."""
    if len(forces) < 4 or np.linalg.matrix_rank(forces, tol=1e-9) < 3:
        return False
    # Scaled, every entry can be made 1 or more.
    return (
        linprog(
            np.ones(len(forces)), A_eq=forces.T, b_eq=np.zeros(3), bounds=[(1.0, None)] * len(forces)
        ).status
        == 0
    )


@pytest.mark.thinned(2)
@pytest.mark.parametrize("seed", range(12))
def test_six_contacts_close_if_any_do(seed: int) -> None:
    """Contacts on the sides of a random rectangle or around a triangle; a subset that closes may leave the others out."""
    random = np.random.default_rng(seed)
    while True:
        angles = random.uniform(0, 2 * pi, 9)
        inward = np.array([[cos(angle), sin(angle)] for angle in angles])
        every = wrenches(random.uniform(-1, 1, (9, 2)) - inward, inward)
        if closes(every):
            break
    assert any(closes(every[list(chosen)]) for count in (4, 5, 6) for chosen in combinations(range(9), count))


def test_two_along_each_of_three_axes_need_all_six() -> None:
    """The bound is met: without one of them the others do not close."""
    axes = np.vstack([np.eye(3), -np.eye(3)])
    assert closes(axes)
    assert not any(closes(np.delete(axes, k, axis=0)) for k in range(6))


@pytest.mark.parametrize("seed", range(20))
def test_four_toe_clamps_hold_a_rectangle_anywhere_on_the_plate(seed: int) -> None:
    """One on each side, on the rows and columns of a lattice that the rectangle lies on at a random place."""
    random = np.random.default_rng(seed)
    pitch = random.uniform(5, 30)
    width, height = random.uniform(2.01, 5, 2) * pitch
    first_column, first_row = random.uniform(0, pitch, 2)
    columns = np.arange(first_column, width, pitch)
    rows = np.arange(first_row, height, pitch)
    assert len(columns) >= 2 and len(rows) >= 2

    def held(left: float, right: float, below: float, above: float) -> bool:
        """Whether clamps on these rows and columns close."""
        points = np.array([[0, left], [width, right], [below, 0], [above, height]]) - [width / 2, height / 2]
        return closes(wrenches(points, np.array([[1.0, 0], [-1, 0], [0, 1], [0, -1]])))

    assert held(rows[0], rows[1], columns[1], columns[0]) != held(rows[0], rows[1], columns[0], columns[1])
    assert not held(rows[0], rows[0], columns[0], columns[0])
    assert not held(rows[0], rows[0], columns[0], columns[1])
