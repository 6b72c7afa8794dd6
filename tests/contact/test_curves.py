"""Features as the search takes them."""

from __future__ import annotations

from math import cos, sin, tan, tau

import numpy as np
import pytest

from chord_examples import arc_row, chord_intervals, line_row, overshoot, solutions
from workhold import Plate, Query, Vise, Workpiece, count_contacts, load
from workhold.contact.curves import loosen_rows, make_curve_table
from workhold.contact.problem import Problem
from workhold.conventions import LOOSE
from workhold.kernels.base.tables import BRANCH, FIRST_STRETCH, FROM, HEAD, LENGTH, SHIFT, TAIL, TO
from workhold.kernels.chord.intervals import NARROW
from workhold.search.toolkit_search import list_lattice_steps


def test_ends_are_moved_out_by_the_same_length_on_lines_and_arcs() -> None:
    """Half the length of a line and of arcs of any radius grows by ``LOOSE`` mm; a whole circle has no end to move."""
    rows = np.array(
        [line_row(1, 2, 0.3, 7.0), *(arc_row(0, 0, r, 1.0, 0.8) for r in (0.5, 3.0, 80.0)), arc_row(0, 0, 3)]
    )
    grown = (loosen_rows(rows) - rows)[:, 5] * np.where(rows[:, 6] == 0.0, 1.0, rows[:, 6])
    assert grown == pytest.approx([LOOSE, LOOSE, LOOSE, LOOSE, 0.0], rel=1e-6)
    assert (loosen_rows(rows)[:, :5] == rows[:, :5]).all()


def gear(teeth: int, root: float, head: float) -> Workpiece:
    """A gear of arcs: root, flank, head and flank of each tooth."""
    loop = []
    for k in range(teeth):
        for share, radius, sweep in (
            (0.0, root, 0.3),
            (0.3, root, 0.0),
            (0.42, head, 0.46),
            (0.88, head, 0.0),
        ):
            angle = tau * (k + share) / teeth
            loop.append((radius * cos(angle), radius * sin(angle), tan(tau * sweep / teeth / 4.0)))
    return Workpiece.from_loops("gear", [loop])


@pytest.mark.thorough
def test_a_chord_that_just_touches_a_circle_is_of_those_of_its_arcs_that_it_meets() -> None:
    """The heads of all teeth are on one circle. No narrow range is missing in which a chord reaches both features, and
    most others are left out."""
    vise = Vise(pitch=50.0, columns=2, peg_radius=8.0)
    problem = Problem.from_query(Query(gear(8, 28.0, 34.0), vise))
    rows = loosen_rows(problem.rows[:, :10])
    steps = list_lattice_steps(problem.frame.carriers, problem.diameter)
    curves = make_curve_table(rows, steps).curves
    kept = {
        (*whole[[TAIL, HEAD]].tolist(), *real[[LENGTH, FROM, TO, BRANCH]].tolist())
        for whole, real in zip(curves.integers, curves.reals, strict=True)
    }
    left_out = 0
    for tail, a in enumerate(rows):
        for head in range(tail, len(rows)):
            for d in steps.lengths.tolist():
                for low, high, branch, *_ in chord_intervals(a, rows[head], d).tolist():
                    there = (tail, head, d, low, high, branch) in kept
                    if high - low > NARROW:
                        assert there
                        continue
                    alphas = np.linspace(low, high, 5)
                    reached = False
                    for alpha, tails in zip(alphas, solutions(a, rows[head], d, alphas), strict=True):
                        heads = tails + d * np.array([cos(alpha), sin(alpha)])
                        # The chord moves by far less than this over so narrow a range.
                        reached |= bool(
                            (np.maximum(overshoot(a, tails), overshoot(rows[head], heads)) < 1e-6).any()
                        )
                    left_out += not there
                    assert there or not reached
    assert left_out > 100
    assert len(kept) < 0.5 * (len(kept) + left_out)
    assert count_contacts(gear(8, 28.0, 34.0), vise) == 0


@pytest.mark.parametrize("ranges", [[(-0.01, 0.02)], [(1.5, 1.6), (3.1, 3.2)], [(-3.3, -3.0), (6.2, 6.3)]])
def test_a_table_for_some_orientations_has_all_curves_that_come_there(
    ranges: list[tuple[float, float]],
) -> None:
    """It has each curve of the whole table that is at an orientation within a range, and no other."""
    problem = Problem.from_query(Query(load("flange"), Plate(pitch=12, peg_radius=3)))
    rows = loosen_rows(problem.rows[:, :10])
    steps = list_lattice_steps(problem.frame.carriers, problem.diameter)
    whole, some = (
        {
            tuple(kept[:FIRST_STRETCH].tolist()) + tuple(real.tolist())
            for kept, real in zip(*table.curves[:2], strict=True)
        }
        for table in (make_curve_table(rows, steps), make_curve_table(rows, steps, within=np.array(ranges)))
    )
    assert some <= whole and 0 < len(some) < 0.6 * len(whole)
    for row in whole:
        real = np.array(row[FIRST_STRETCH:])
        low, high = real[FROM] - real[SHIFT], real[TO] - real[SHIFT]
        is_there = any(
            np.ceil((low - end - 1e-7) / tau) * tau + begin <= high + 1e-7 for begin, end in ranges
        )
        surely = any(np.ceil((low - end + 1e-7) / tau) * tau + begin <= high - 1e-7 for begin, end in ranges)
        assert not surely or row in some
        assert is_there or row not in some
