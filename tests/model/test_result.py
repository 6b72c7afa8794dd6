"""Results are sequences of fixtures made from arrays."""

from __future__ import annotations

import numpy as np
import pytest

from fakes import fake_result
from workhold import Fixture
from workhold.model.fixture_table import FixtureTable


def test_a_result_is_a_sequence():
    """len, indices from both ends, slices, iteration and IndexError as for a list."""
    result = fake_result(7)
    everything = list(result)
    assert len(result) == len(everything) == 7
    assert all(isinstance(fixture, Fixture) for fixture in everything)
    assert result[0] == everything[0] and result[-1] == everything[6] and result[-7] == everything[0]
    assert result[2:5] == everything[2:5] and result[::-2] == everything[::-2] and result[9:] == []
    for index in (7, -8):
        with pytest.raises(IndexError):
            result[index]


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
            assert (peg.x, peg.y) == carrier.place(peg.column, peg.row, fixture.jaw_separation)
            assert peg.face == result.table.face[k, m] and peg.force == result.table.force[k, m]
        assert np.radians(fixture.pose.theta_deg) == pytest.approx(result.table.theta[k])
        assert fixture.quality["closure_margin"] == pytest.approx(result.table.null_vector[k].min())


def test_an_empty_result():
    """No fixtures: length 0, falsy, nothing to iterate, counts of 0."""
    result = fake_result(0)
    assert len(result) == 0 and not result and list(result) == [] and result.counts == {"I": 0, "II": 0}
    assert len(FixtureTable.empty()) == 0


def test_tables_are_read_only_and_can_be_reordered():
    """take(order) lists the rows in another order; arrays cannot be written to."""
    table = fake_result(6).table
    back = table.take(np.arange(5, -1, -1))
    assert np.array_equal(back.theta, table.theta[::-1]) and np.array_equal(back.row, table.row[::-1])
    assert len(table.take(slice(0, 2))) == 2
    for one in (table, back):
        with pytest.raises(ValueError, match="read-only"):
            one.theta[0] = 0.0
