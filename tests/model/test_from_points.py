"""Parts of corners, as other programs have them."""

from __future__ import annotations

from math import cos, pi, sin
from typing import Any

import numpy as np
import pytest

from workhold import InputError, Workpiece
from workhold.geometry.segment import Arc

PLATE = [(-30.0, -20.0), (30.0, -20.0), (30.0, 20.0), (-30.0, 20.0)]


def circle(radius: float, count: int) -> list[tuple[float, float]]:
    """Corners of a regular polygon."""
    return [(radius * cos(2 * pi * k / count), radius * sin(2 * pi * k / count)) for k in range(count)]


@pytest.mark.parametrize("closed", [False, True])
@pytest.mark.parametrize("turned", [False, True])
def test_a_plate_of_corners_is_one_of_loops(closed: bool, turned: bool) -> None:
    """Closed by its first corner again or not, run in either direction; an array or a list."""
    corners = PLATE[::-1] if turned else PLATE
    part = Workpiece.from_points("plate", np.array([*corners, corners[0]]) if closed else corners)
    assert part == Workpiece.from_loops("plate", [[(x, y, 0.0) for x, y in corners]])


def test_chords_become_arcs_as_in_drawings() -> None:
    """720 corners are a circle, 60 are one with a fit above their sagitta and a polygon without."""
    fine, coarse = circle(10, 720), circle(10, 60)
    hole = Workpiece.from_points("plate", PLATE, [fine]).faces[-1].segment
    assert isinstance(hole, Arc) and hole.is_full and hole.radius == pytest.approx(10)
    assert len(Workpiece.from_points("plate", PLATE, [coarse]).faces) == 64
    fitted = Workpiece.from_points("plate", PLATE, [coarse], fit=0.02)
    assert len(fitted.faces) == 5 and fitted.departure == pytest.approx(10 * (1 - cos(pi / 60)))


@pytest.mark.parametrize(
    ("outline", "said"),
    [
        ([1, 2, 3], "not a list of corners"),
        ([(0, 0, 0), (1, 0, 0), (1, 1, 0)], "not a list of corners"),
        ("abc", "not a list of corners"),
        ([], "not a list of corners"),
        ([(0, 0), (1, float("nan")), (1, 1)], "corner 1 has a coordinate"),
        ([(0, 0), (1, 1)], "too few segments"),
        ([(0, 0), (0, 0), (1, 0), (1, 1)], "corner 0 has zero length"),
        ([(0, 0), (2, 2), (2, 0), (0, 2)], "cross or touch"),
    ],
)
def test_what_is_no_outline_is_refused(outline: Any, said: str) -> None:
    """One sentence with the corner."""
    with pytest.raises(InputError, match=said):
        Workpiece.from_points("plate", outline)


@pytest.mark.parametrize("fit", [0, -1, float("nan")])
def test_a_fit_is_a_length(fit: Any) -> None:
    """Above zero."""
    with pytest.raises(InputError, match=r"the fit \S+ is not usable"):
        Workpiece.from_points("plate", PLATE, fit=fit)
