"""A load is what it was given, in one form, and never one that cannot act."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from workhold import Load
from workhold.errors import InputError
from workhold.model.requirements import ANY_DIRECTION

ANGLES = st.floats(-1000, 1000)


@given(ANGLES, st.floats(0, 360))
def test_directions_have_one_form(low: float, width: float) -> None:
    """low in [0, 360), high at most a turn further, the same range as given; a second time changes nothing."""
    load = Load([(0, 0)], 1, (low, low + width))
    first, last = load.directions
    assert 0 <= first < 360 and first <= last <= first + 360
    if load.directions != ANY_DIRECTION:
        assert (first - low + 180) % 360 == pytest.approx(180, abs=1e-9)
        assert last - first == pytest.approx(width, abs=1e-9)
    assert Load([(0, 0)], 1, load.directions).directions == load.directions


def test_any_direction() -> None:
    """A whole turn from anywhere is any direction."""
    for low in (0, -180, 77, 500):
        assert Load([(0, 0)], 1, (low, low + 360)).directions == ANY_DIRECTION


@pytest.mark.parametrize(
    "values",
    [
        {"force": -1, "points": [(0, 0)]},
        {"force": float("nan"), "points": [(0, 0)]},
        {"force": 1},
        {"force": 1, "points": [(0, float("inf"))]},
        {"force": 1, "points": [(0, 0)], "directions": (0, 361)},
        {"force": 1, "points": [(0, 0)], "directions": (0, float("nan"))},
        {"moment": float("inf")},
        {},
    ],
)
def test_what_cannot_act_is_refused(values: dict[str, object]) -> None:
    """One sentence each."""
    with pytest.raises(InputError, match=r"\.$"):
        Load(**values)  # type: ignore[arg-type]
