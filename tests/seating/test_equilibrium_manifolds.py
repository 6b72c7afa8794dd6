"""Three parallel forces balance only with the middle one against the outer two."""

from __future__ import annotations

import pytest

from seating_examples import LEFT, RIGHT, held
from workhold import Vise, Workpiece
from workhold.kernels.seating.columns import CONTACTS, SEPARATION
from workhold.seating.pattern import Pattern
from workhold.seating.solver import Solver

PLATE = Workpiece.from_loops("plate", [[[0, 0, 0], [40, 0, 0], [40, 90, 0], [0, 90, 0]]])


@pytest.mark.parametrize(
    ("heights", "is_held"),
    [((10.0, -40.0), True), ((30.0, -40.0), False), ((-10.0, -40.0), False), ((19.0, -70.0), True)],
)
def test_a_plate_lies_square_only_against_a_peg_between(heights, is_held):
    """Two left pegs 20 apart and one of two right ones, the other of which touches nothing or lies beside them too."""
    vise = Vise(10, 2, 3)
    pegs = [(LEFT, 0.0, 0.0), (LEFT, 0.0, 20.0), (RIGHT, 10.0, heights[0]), (RIGHT, 20.0, heights[1])]
    pattern = Pattern.of(held(pegs, (0.0, 0.0, 0.0), 0.0), vise)
    tree = Solver(PLATE, vise).trees(pattern)[0]
    # Its two long faces are 40 + 2 * 3 apart, the jaws' pegs 10 nearer.
    square = [
        one
        for one in (*tree.loose, *tree.slack)
        if abs(one[SEPARATION] - 36.0) < 1e-9 and one[CONTACTS] >= 3.0
    ]
    assert bool(square) == is_held
