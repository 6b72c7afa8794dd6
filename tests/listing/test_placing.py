"""Where fixtures stand on the jaws: nearest the opening, and moved outward in the order the model says."""

from __future__ import annotations

from math import ceil

import numpy as np
import pytest
from attrs import evolve

from candidate_examples import candidates
from workhold.contact.problem import Frame
from workhold.fixels.vise import Vise
from workhold.listing.placing import outward_moves, placed_as_is


@pytest.mark.parametrize("opening", [8.0, 17.0, 23.0, 31.0, 38.0, 52.0])
def test_pegs_move_outward_no_farther_than_the_largest_opening_demands_and_left_ones_first(
    opening: float,
) -> None:
    """Pegs in two columns on the left and one on the right, in jaws of four columns 10 mm apart: one column more between
    the jaws takes a pitch off the separation. The left pegs have two columns to move, then the right ones three."""
    vise = Vise(pitch=10, columns=4, peg_radius=3, min_gap=7.0, max_opening=12.0)
    frame = Frame.of(vise, 100.0)
    found = placed_as_is(evolve(candidates(1), gap=np.array([opening])), frame)
    moves = max(ceil((opening - 12.0) / 10), 0)
    assert found.fits[0] == (opening - 10 * moves >= 7.0)
    assert (found.standing[0], found.moving[0]) == (min(moves, 2), max(moves - 2, 0))
    assert found.travel(frame)[0] == pytest.approx(opening - 10 * moves)


def test_ways_outward_are_tried_with_the_fewest_columns_first_and_most_of_them_on_the_left() -> None:
    """Where blocked holes force pegs on, the same order holds."""
    assert list(outward_moves(3, 3)) == [
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
