"""Seats in which the normals of two pegs of a jaw are nearly parallel: the instant centre is metres away, and less than a
thousandth of a degree farther there are none."""

from __future__ import annotations

from math import inf
from pathlib import Path

import numpy as np
import pytest
from attrs import evolve

from seating_examples import at_angle, equilibria_of, held, solved, touching, two_contacts_of
from workhold import Vise, load
from workhold.kernels.seating.closing import AT_REST
from workhold.kernels.seating.columns import CONFIG, CONTACTS, SECOND, SEPARATION, THETA
from workhold.seating.join_tree import JoinTree
from workhold.seating.pattern import Pattern, list_subsets
from workhold.seating.solver import SeatingSolver

BRACKET = Path(__file__).parents[2] / "examples" / "bracket.dxf"
VISE = Vise(pitch=20, columns=2, peg_radius=3)
# Three locators and the tip of a clamp on a plate, whether the part is turned over, and where it comes to rest.
CASES = (
    ([(0, 0), (0, 80), (40, 100), (0, 20)], False, (-1.40139415, 15.287515, 84.638178, 10.703810)),
    ([(0, 0), (0, 80), (60, 100), (0, 20)], True, (-2.53948086, 37.029270, 59.339457, 10.684504)),
    ([(0, 60), (0, 100), (20, 0), (0, 120)], False, (0.41719594, 48.772230, 101.696097, 106.621522)),
    ([(0, 40), (40, 20), (80, 0), (0, 20)], False, (5.25306900, 97.292820, -1.605055, 63.327432)),
)


def solver_and_jaws(case):
    """The jaws of a case."""
    pegs, is_turned_over, config = case
    placed = [("left", float(x), float(y)) for x, y in pegs[:3]] + [
        ("right", pegs[3][0] + config[3], float(pegs[3][1]))
    ]
    fixture = held(placed, (0.0, 0.0, 0.0), config[3])
    # On a plate no jaw ends in another.
    pattern = evolve(Pattern.from_fixture(fixture, VISE), stop=-inf, widest=inf, gap=None)
    return SeatingSolver(load(BRACKET), VISE).make_closing(pattern, is_turned_over)


@pytest.mark.thinned(7)
@pytest.mark.parametrize("case", CASES)
def test_it_is_a_seat_and_nothing_is_unsettled(case):
    """The separation is least there, by differences of what three contacts leave free, and jaws that close lead there."""
    closing = solver_and_jaws(case)
    found = equilibria_of(closing)
    assert len(found.doubtful) == 0
    assert len(JoinTree.from_equilibria(found, closing).doubtful) == 0
    [row] = [row for row in found.seats if abs(row[SEPARATION] - case[2][3]) < 2e-6]
    assert (
        np.abs((row[CONFIG] - case[2] + np.pi) % (2.0 * np.pi) - np.pi).max() < 5e-6 and row[CONTACTS] == 3.0
    )
    given, step = two_contacts_of(closing).given, 2e-8
    assert np.abs(touching(row, given, row[CONFIG])).max() < 1e-9
    before, after = (at_angle(row, given, row[THETA] + off) for off in (-step, step))
    assert (before + after - 2.0 * row[SEPARATION]) / step**2 == pytest.approx(row[SECOND], rel=0.05)
    apart = np.random.default_rng(1).normal(0.0, 1.0, (8, 4)) * [1e-5, 1e-3, 1e-3, 0.0] + [
        0.0,
        0.0,
        0.0,
        5e-3,
    ]
    ends, how = closing.close_from(row[CONFIG] + apart, 1e-3)
    assert (how == AT_REST).all() and np.abs(ends - row[CONFIG]).max() < 1e-4


@pytest.mark.parametrize("number", range(3))
def test_second_derivatives_are_those_of_the_separation(number):
    """By differences, of three contacts of which two are of one jaw, on lines and arcs."""
    solver, fixture, _ = solved(number)
    closing = solver.make_closing(Pattern.from_fixture(fixture, solver.toolkit), False)
    found = equilibria_of(closing)
    given = two_contacts_of(closing).given
    assert len(list_subsets(closing.pattern)) > 4
    rows, steps = [row for row in (*found.seats, *found.passes) if row[CONTACTS] == 3.0], 0
    for row in rows:
        step = 1e-5 if abs(row[SECOND]) < 1e4 else 1e-6
        before, after = (at_angle(row, given, row[THETA] + off) for off in (-step, step))
        if abs(row[SECOND]) * step**2 > 1e-9:
            steps += 1
            assert (before + after - 2.0 * row[SEPARATION]) / step**2 == pytest.approx(row[SECOND], rel=2e-2)
    assert steps > 10
