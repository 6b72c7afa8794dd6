"""Results are sequences of fixtures made from arrays."""

from __future__ import annotations

import numpy as np
import pytest
from attrs import evolve

from fakes import fake_result
from workhold import Fixture, InputError, Result, Vise, Workpiece, design, save, verify
from workhold import open as open_result
from workhold.model.fixture_table import FixtureTable
from workhold.model.notes import ChosenOnly


def test_a_result_is_a_sequence():
    """len, indices from both ends, iteration and IndexError as for a list."""
    result = fake_result(7)
    everything = list(result)
    assert len(result) == len(everything) == 7
    assert all(isinstance(fixture, Fixture) for fixture in everything)
    assert result[0] == everything[0] and result[-1] == everything[6] and result[-7] == everything[0]
    for index in (7, -8):
        with pytest.raises(IndexError):
            result[index]


def test_some_fixtures_are_a_result_again(tmp_path):
    """Slices, numbers, masks and conditions choose the same fixtures as of a list, in its order, and say so."""
    result = fake_result(7)
    everything, mask = list(result), np.arange(7) % 3 == 1
    for chosen, there in [
        (result[2:5], everything[2:5]),
        (result[[6, 1, -1]], [everything[1], everything[6]]),
        (result[np.array([4])], [everything[4]]),
        (result[mask], [everything[1], everything[4]]),
        (result.where(mask), [everything[1], everything[4]]),
        (result.where(lambda fixture: fixture == everything[3]), [everything[3]]),
        (result[9:], []),
    ]:
        assert isinstance(chosen, Result) and list(chosen) == there and chosen.found == result.found
        assert [fixture.rank for fixture in chosen] == list(range(1, len(there) + 1))
        assert chosen.notes == (*result.notes, ChosenOnly(sum(result.found.values()), len(there)))
    assert result[:] == result and result[1:4][1:].notes == result[2:4].notes


def test_chosen_fixtures_are_saved_opened_and_verified(tmp_path):
    """A note says that not all is listed, so that neither the account nor a new search misses the others."""
    wedge = Workpiece.from_loops("wedge", [[[0, 0, 0], [41, 0, 0], [13, 37, 0]]])
    result = design(wedge, Vise(pitch=15, columns=1, peg_radius=2))
    chosen = result[np.arange(len(result)) % 2 == 1]
    for name in ("some.json", "some.npz"):
        save(chosen, tmp_path / name)
        again = open_result(tmp_path / name)
        assert np.array_equal(again.table.row, chosen.table.row) and again.notes == chosen.notes
        assert verify(tmp_path / name, complete=True).faults == ()
    silent = evolve(chosen, notes=())
    assert any("nothing says why" in fault for fault in verify(silent).faults)


@pytest.mark.parametrize("rows", [np.ones(3, bool), "first", 1.5, [0.5], [[1, 2]]])
def test_what_chooses_no_fixtures_is_refused(rows):
    """In a sentence that says how to."""
    with pytest.raises(InputError, match=r"a mask has one truth|give their numbers"):
        fake_result(7)[rows]


def test_counts_count_what_is_listed():
    """counts adds up to len, by the type of each fixture."""
    result = fake_result(40)
    types = [fixture.type for fixture in result]
    assert result.counts == {"I": types.count("I"), "II": types.count("II")}
    assert sum(result.counts.values()) == len(result) == 40


def test_fixtures_repeat_their_row_of_the_table():
    """Pegs stand in their holes; the pose is in degrees; the closure margin is the smallest entry of lambda."""
    result = fake_result(12)
    for k, fixture in enumerate(result):
        lefts = 2 if fixture.type == "I" else 3
        assert [peg.carrier for peg in fixture.pegs] == ["left"] * lefts + ["right"] * (4 - lefts)
        for m, peg in enumerate(fixture.pegs):
            left, right = result.toolkit.carriers
            carrier = left if peg.carrier == "left" else right
            assert (peg.x, peg.y) == carrier.compute_hole_center(peg.column, peg.row, fixture.travel)
            assert peg.face == result.table.face[k, m] and peg.force == result.table.force[k, m]
        assert np.radians(fixture.pose.theta_deg) == pytest.approx(result.table.theta[k])
        assert fixture.quality["closure_margin"] == pytest.approx(result.table.null_vector[k].min())


def test_an_empty_result():
    """No fixtures: length 0, falsy, nothing to iterate, counts of 0."""
    result = fake_result(0)
    assert len(result) == 0 and not result and list(result) == [] and result.counts == {"I": 0, "II": 0}
    assert len(FixtureTable.make_empty()) == 0


def test_tables_are_read_only_and_can_be_reordered():
    """take(order) lists the rows in another order; arrays cannot be written to."""
    table = fake_result(6).table
    back = table.take(np.arange(5, -1, -1))
    assert np.array_equal(back.theta, table.theta[::-1]) and np.array_equal(back.row, table.row[::-1])
    assert len(table.take(slice(0, 2))) == 2
    for one in (table, back):
        with pytest.raises(ValueError, match="read-only"):
            one.theta[0] = 0.0
