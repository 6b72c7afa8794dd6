"""What is equal by content is equal: copies, and what is read twice."""

from __future__ import annotations

import copy
import pickle

import numpy as np

from fakes import fake_result
from workhold.model.workpiece import Workpiece

PLATE = [[0.0, 0.0, 0.0], [60.0, 0.0, 0.2], [60.0, 40.0, 0.0], [0.0, 40.0, 0.0]]


def test_copies_of_a_workpiece_are_equal_and_hash_alike() -> None:
    """A copy, a pickled one, one made again; -0.0 is 0.0. Other loops and another name make another part."""
    plate = Workpiece.from_loops("plate", [PLATE])
    for same in (copy.deepcopy(plate), pickle.loads(pickle.dumps(plate)), Workpiece.from_loops("plate", [PLATE])):
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
