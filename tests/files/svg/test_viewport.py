"""What a window hides of an outline."""

from __future__ import annotations

import pytest

from workhold.files.budget import UNLIMITED, Budget
from workhold.files.outline.chain import Chain
from workhold.files.svg.viewport import ClipPolygon

SQUARE = ClipPolygon(((0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0), (0.0, 0.0)), "the clip-path")


@pytest.mark.parametrize(
    "window", [SQUARE, ClipPolygon(SQUARE.corners[::-1], SQUARE.label)], ids=["turning left", "right"]
)
@pytest.mark.parametrize(
    ("low", "high", "shown"),
    [
        (1.0, 9.0, "all"),
        (0.0 - 5e-6, 10.0 + 5e-6, "all"),
        (10.0 - 5e-6, 20.0, "nothing"),
        (10.0 - 5e-5, 20.0, "some"),
        (-20.0, 0.0 + 5e-6, "nothing"),
        (5.0, 10.0 + 5e-5, "some"),
    ],
)
def test_rounding_at_an_edge_shows_nothing_and_hides_nothing(
    window: ClipPolygon, low: float, high: float, shown: str
) -> None:
    """A millionth of the window's size on either side of an edge is on it."""
    chain = Chain(((low, 4.0), (high, 4.0), (high, 6.0), (low, 6.0), (low, 4.0)), (0.0,) * 4, ("line",) * 4)
    assert window.classify_visibility(chain, Budget(UNLIMITED)) == shown
