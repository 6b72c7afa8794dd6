"""What is left out before it is looked at is nothing, and many fixtures at once are told as one by one."""

from __future__ import annotations

import numpy as np
import pytest
from attrs import evolve

from seating_examples import cells_by_pair, moved, solved, two_contacts_of
from workhold.kernels.seating.candidates import complete_third, complete_three
from workhold.kernels.seating.columns import BOTTOM, CANDIDATE_LENGTH, CELL_LENGTH, DEPTH, SEPARATION, TOP
from workhold.kernels.seating.four_contacts import write_third_of_jaw, write_two_pairs
from workhold.kernels.seating.three_contacts import ROOT_LENGTH, write_three_contacts
from workhold.seating.closing import fill_rows
from workhold.seating.pattern import Pattern
from workhold.seating.solver import SeatingSolver


def told_by(holdings, boundary, pattern, discs, stop):
    """Candidates of three contacts above the stop, and of three with one jaw."""
    stack, work, three, third = np.empty((DEPTH, 2)), np.empty((5, len(discs))), [], []
    for side in holdings.jaws:
        given = *cells_by_pair(holdings, side), holdings.sought, discs
        three.append(fill_rows(ROOT_LENGTH, 4096, write_three_contacts, *given, stop, stack, work))
        third.append(fill_rows(ROOT_LENGTH, 4096, write_third_of_jaw, *given, stack))
    three, third = np.concatenate(three), np.concatenate(third)
    found = fill_rows(
        CANDIDATE_LENGTH, len(three) + 1, complete_three, three, holdings.given, boundary.pocket_pieces
    )
    fixed = fill_rows(
        CANDIDATE_LENGTH, len(third) + 1, complete_third, third, holdings.given, boundary.pocket_pieces
    )
    return found[found[:, SEPARATION] > pattern.stop], fixed


@pytest.mark.parametrize("number", range(3))
def test_pieces_left_out_have_no_roots(number):
    """Discs as large as the table and no stop let every piece be looked at: no more balances are found."""
    solver, fixture, _ = solved(number)
    pattern = Pattern.from_fixture(fixture, solver.toolkit)
    closing = solver.make_closing(pattern, False)
    boundary, holdings = closing.boundary, two_contacts_of(closing)
    everywhere = np.array(boundary.discs)
    everywhere[:, 2] += 1e4
    few, fixed = told_by(holdings, boundary, pattern, boundary.discs, pattern.stop)
    all_of_them, all_fixed = told_by(holdings, boundary, pattern, everywhere, -1e4)
    assert len(few) > 20
    assert np.array_equal(few, all_of_them)
    assert np.array_equal(fixed, all_fixed)
    # Whatever the stop, what is just above it is found.
    for stop in few[:: len(few) // 8, SEPARATION] - 1e-6:
        above, _ = told_by(holdings, boundary, evolve(pattern, stop=stop), boundary.discs, stop)
        assert np.array_equal(above, few[few[:, SEPARATION] > stop])


def test_holdings_meet_as_of_each_cell_by_itself():
    """Which cells of the other jaw reach into a cell does not depend on the cells before it."""
    solver, fixture, _ = solved(0)
    pattern = Pattern.from_fixture(fixture, solver.toolkit)
    holdings = two_contacts_of(solver.make_closing(pattern, False))
    left, right = holdings.make_jaw_cells(0), holdings.make_jaw_cells(1)
    work = np.empty((2, CELL_LENGTH)), np.empty((DEPTH, 2)), np.empty(len(right.cells), np.int64)
    every = fill_rows(ROOT_LENGTH, 1024, write_two_pairs, left, right, holdings.sought, *work)
    ones = [left._replace(cells=one[None, :]) for one in left.cells]
    alone = [fill_rows(ROOT_LENGTH, 64, write_two_pairs, one, right, holdings.sought, *work) for one in ones]
    assert len(every) > 10
    assert np.array_equal(every, np.concatenate(alone))
    # Nor does what is left out by heights meet.
    tall = [jaw._replace(cells=np.array(jaw.cells)) for jaw in (left, right)]
    for jaw in tall:
        jaw.cells[:, BOTTOM], jaw.cells[:, TOP] = -1e9, 1e9
    assert left.height != right.height
    assert np.array_equal(fill_rows(ROOT_LENGTH, 1024, write_two_pairs, *tall, holdings.sought, *work), every)


@pytest.mark.thorough
def test_many_fixtures_are_told_as_one_by_one():
    """In their order, two of one pattern among them, with any number of threads."""
    solver, fixture, told = solved(1)
    again = moved(fixture, [1, 2, 3, 0], False, (16.0, 8.0))
    turned = moved(fixture, [0, 1, 2, 3], True, (0.0, 0.0))
    for threads in (1, 2):
        one, two, three = SeatingSolver(solver.workpiece, solver.toolkit).solve_all(
            [again, turned, fixture], False, threads
        )
        for other, given in ((one, again), (two, turned), (three, fixture)):
            own = next(seat for seat in other.seats if seat.is_own)
            assert own.pose.theta_deg == pytest.approx(given.pose.theta_deg % 360.0, abs=1e-9)
            assert own.pose.x == pytest.approx(given.pose.x, abs=1e-9)
            assert other.capture_opening == pytest.approx(told.capture_opening, abs=1e-9)
