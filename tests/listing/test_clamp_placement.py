"""Clamps are bolted in the nearest hole that will do."""

from __future__ import annotations

from typing import Any

import pytest

from toolkit_results import NOTCHED, part
from workhold import Fence, Plate, Result, design
from workhold.fixels.plate import Plate as AnyPlate


def holes(result: Result) -> set[tuple[Any, ...]]:
    """Fixtures by their holes, with orientations."""
    return {
        (
            f.direction,
            round(f.pose.theta_deg, 4),
            *((peg.column, peg.row) for peg in f.pegs),
            round(f.pegs[-1].x, 4),
        )
        for f in result
    }


@pytest.mark.parametrize(
    "toolkit",
    [
        Plate((14, 12), 2, columns=7, rows=7, directions=["-x", "+y"]),
        Fence((10, 8), 2, wall_offset=5, columns=8, rows=8),
    ],
    ids=["plate", "wall"],
)
def test_a_longer_stroke_leaves_clamps_where_a_shorter_one_has_them(toolkit: AnyPlate) -> None:
    """And some have several holes within the longer one."""
    short, long = (design(part(NOTCHED), toolkit.changed({"travel": (4.0, most)})) for most in (12.0, 44.0))
    assert holes(short) <= holes(long) and len(short) > 20
    without = design(part(NOTCHED), toolkit.changed({"travel": (14.0, 44.0)}))
    farther = {key[:-3] for key in holes(without)}
    assert any(key[:-3] in farther for key in holes(short))
