"""What three parallel lines hold is left out early, and nothing else is."""

from __future__ import annotations

from itertools import combinations, combinations_with_replacement

import numpy as np
import pytest

from cad_parts import cad_part
from workhold import Plate, Query, Vise, load
from workhold.contact.problem import Problem
from workhold.fixels.toolkit import Toolkit
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, IS_ARC
from workhold.kernels.contact.record import FEATURES, PEG_FEATURE, PEG_LENGTH
from workhold.kernels.contact.rules import are_on_parallel_lines
from workhold.proof.degenerate import cannot_hold
from workhold.search.cells import run_blocks
from workhold.search.toolkit_search import ToolkitSearch


@pytest.mark.thorough
@pytest.mark.parametrize("count", [3, 4])
def test_three_parallel_lines_are_seen(count: int) -> None:
    """Of three pegs all must touch such lines, of four any three; arcs never count."""
    rows = Problem.from_query(Query(cad_part(2), Vise(pitch=10, columns=2, peg_radius=3))).rows
    pegs, seen = np.zeros((4, PEG_LENGTH)), set()
    for touched in combinations_with_replacement(range(len(rows)), 4):
        pegs[:, PEG_FEATURE] = touched
        some = rows[list(touched[:count])]
        wanted = any(
            all(
                one[IS_ARC] == other[IS_ARC] == 0.0
                and abs(one[AXIS_X] * other[AXIS_Y] - one[AXIS_Y] * other[AXIS_X]) < 1e-9
                for one, other in combinations(three, 2)
            )
            for three in combinations(some, 3)
        )
        assert are_on_parallel_lines(pegs, count, rows) == wanted
        seen.add(wanted)
    assert seen == {True, False}


@pytest.mark.parametrize("kit", [Vise(pitch=8, columns=2, peg_radius=3), Plate(pitch=16, peg_radius=3)])
def test_no_record_is_of_three_parallel_lines(kit: Toolkit) -> None:
    """They are most of what a vise would hand on, and the last stage would leave them out one by one."""
    problem = Problem.from_query(Query(load("widget"), kit))
    search = ToolkitSearch.from_problem(problem)
    records = np.concatenate(run_blocks(search.make_blocks(problem.query.types), 1, None, None)[0])
    rows = problem.rows[records[:, FEATURES : FEATURES + 4].astype(np.int64)]
    straight, axis = rows[..., IS_ARC] == 0.0, rows[..., AXIS_X] + 1j * rows[..., AXIS_Y]
    for three in combinations(range(4), 3):
        lines = straight[:, three].all(axis=1)
        apart = [np.abs((np.conj(axis[:, i]) * axis[:, j]).imag) for i, j in combinations(three, 2)]
        assert not (lines & (np.max(apart, axis=0) <= 1e-9)).any()
    assert len(records) > 100 and (~cannot_hold(records, problem)).any()
