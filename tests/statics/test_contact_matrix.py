"""Where pegs touch, for carriers whose pegs are alike and for others."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from attrs import evolve

from workhold.fixels.vise import Vise
from workhold.model.workpiece import Workpiece
from workhold.statics.contact_matrix import Touched

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
    touched = Touched.of(CORNER, toolkit(standing, moving))
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
    found = touched.contact_matrices(pegs, np.zeros((2, 3)), np.repeat(carriers, 2, axis=0), faces)
    inner = np.isin(faces, (ABOVE, BESIDE))
    assert found.ends[inner] == pytest.approx((6.0 - np.stack([radii, radii]))[inner])
    assert found.normals[faces == ABOVE] == pytest.approx(np.array([(0, 1), (0, 1)]))
    assert touched.length == pytest.approx(np.hypot(60, 60) / 2 + max(standing, moving))
