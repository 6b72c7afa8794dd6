"""Free curves in an outline: a border along any part of one is found."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("OCP", reason="the extra 'step' is not installed")

from step_shapes import box

from workhold.files.step.faces import list_solid_faces
from workhold.files.step.projected import OtherCurveError, refuse_others


@pytest.mark.parametrize("k", range(1, 32))
def test_a_curve_that_is_border_at_one_point_only_is_refused(k: int) -> None:
    """Whichever point of a curve has material on one side only, the outline is refused."""
    points = np.column_stack([np.arange(33.0), np.zeros(33)])
    with pytest.raises(OtherCurveError):
        refuse_others(
            [(0, points)],
            list_solid_faces(box(9, 9, 9)),
            lambda places: [y < 0 or abs(x - k) > 0.3 for x, y in places],
        )


def test_a_curve_within_the_material_is_let_pass() -> None:
    """Of a curve with material on both sides nothing is said."""
    points = np.column_stack([np.arange(33.0), np.zeros(33)])
    refuse_others([(0, points)], list_solid_faces(box(9, 9, 9)), lambda places: [True] * len(places))
