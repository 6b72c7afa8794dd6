"""What is equal by content is equal: copies, and what is read twice."""

from __future__ import annotations

import copy
import pickle

import attrs
import numpy as np
import pytest

from fakes import fake_proof, fake_result
from workhold import Workpiece
from workhold.model.fixture_table import FixtureTable

PLATE = [[0.0, 0.0, 0.0], [60.0, 0.0, 0.2], [60.0, 40.0, 0.0], [0.0, 40.0, 0.0]]


def test_copies_of_a_workpiece_are_equal_and_hash_alike() -> None:
    """A copy, a pickled one, one made again; -0.0 is 0.0. Other loops and another name make another part."""
    plate = Workpiece.from_loops("plate", [PLATE])
    for same in (
        copy.deepcopy(plate),
        pickle.loads(pickle.dumps(plate)),
        Workpiece.from_loops("plate", [PLATE]),
    ):
        assert same == plate and hash(same) == hash(plate)
    signed = np.array(PLATE)
    signed[0, 1] = -0.0
    assert Workpiece.from_loops("plate", [signed]) == plate
    assert Workpiece.from_loops("other", [PLATE]) != plate
    moved = [[x, y, 0.1 if bulge else 0.0] for x, y, bulge in PLATE]
    assert Workpiece.from_loops("plate", [moved]) != plate
    assert plate != "plate"


def test_fixtures_are_hashed_by_content() -> None:
    """A set holds each once, though its figures of quality are a dictionary."""
    result = fake_result(3)
    assert len({*result[:3], *result[:2]}) == 3
    assert hash(copy.deepcopy(result[0])) == hash(result[0])


def test_copies_of_a_result_are_equal_and_hash_alike() -> None:
    """Also with figures of quality that are not known, which are not equal as numbers; more fixtures than one block."""
    result = fake_result(5000)
    quality = result.table.quality.copy()
    quality[:, 3] = np.nan
    result = attrs.evolve(result, table=attrs.evolve(result.table, quality=quality), proof=fake_proof(3))
    for same in (copy.copy(result), copy.deepcopy(result), pickle.loads(pickle.dumps(result))):
        assert same == result and hash(same) == hash(result)
    assert result.table != "table"


@pytest.mark.parametrize("name", [column.name for column in attrs.fields(FixtureTable)])
def test_results_differ_by_any_number_of_the_last_fixture(name: str) -> None:
    result = fake_result(5000)
    changed = getattr(result.table, name).copy()
    changed[-1] += 1
    assert attrs.evolve(result, table=attrs.evolve(result.table, **{name: changed})) != result


def test_results_differ_by_length_and_by_what_is_said_of_them() -> None:
    result = fake_result(3)
    assert FixtureTable.make_empty() != result.table != FixtureTable.make_empty()
    assert attrs.evolve(result, table=result.table.take(slice(2))) != result
    for change in (
        {"complete": False},
        {"notes": ("a",)},
        {"found": {"I": 9}},
        {"distinct": {}},
        {"statistics": {"a": 1}},
    ):
        assert attrs.evolve(result, **change) != result
