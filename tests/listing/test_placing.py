"""Where fixtures stand: on jaws nearest the opening and then outward in order, clamps in the nearest hole that will do."""

from __future__ import annotations

from math import ceil
from typing import Any

import numpy as np
import pytest
from attrs import evolve

from candidate_examples import candidates
from toolkit_results import NOTCHED, part
from workhold import Fence, Plate, Result, Vise, design
from workhold import Plate as AnyPlate
from workhold.contact.problem import SearchFrame
from workhold.listing.placing import list_outward_moves, place_as_is


@pytest.mark.parametrize("opening", [8.0, 17.0, 23.0, 31.0, 38.0, 52.0])
def test_pegs_move_outward_no_farther_than_the_largest_opening_demands_and_left_ones_first(
    opening: float,
) -> None:
    """Pegs in two columns on the left and one on the right, in jaws of four columns 10 mm apart: one column more between
    the jaws takes a pitch off the separation. The left pegs have two columns to move, then the right ones three."""
    vise = Vise(pitch=10, columns=4, peg_radius=3, min_gap=7.0, max_opening=12.0)
    frame = SearchFrame.from_toolkit(vise, 100.0)
    found = place_as_is(evolve(candidates(1), gap=np.array([opening])), frame)
    moves = max(ceil((opening - 12.0) / 10), 0)
    assert found.fits[0] == (opening - 10 * moves >= 7.0)
    assert (found.standing[0], found.moving[0]) == (min(moves, 2), max(moves - 2, 0))
    assert found.compute_travel(frame)[0] == pytest.approx(opening - 10 * moves)


def test_ways_outward_are_tried_with_the_fewest_columns_first_and_most_of_them_on_the_left() -> None:
    """Where blocked holes force pegs on, the same order holds."""
    assert list(list_outward_moves(3, 3)) == [
        (0, 0),
        (1, 0),
        (0, 1),
        (2, 0),
        (1, 1),
        (0, 2),
        (2, 1),
        (1, 2),
        (2, 2),
    ]


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


@pytest.mark.thorough
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
    short, long = (
        design(part(NOTCHED), toolkit.with_fields({"travel": (4.0, most)})) for most in (12.0, 44.0)
    )
    assert holes(short) <= holes(long) and len(short) > 20
    without = design(part(NOTCHED), toolkit.with_fields({"travel": (14.0, 44.0)}))
    farther = {key[:-3] for key in holes(without)}
    assert any(key[:-3] in farther for key in holes(short))
