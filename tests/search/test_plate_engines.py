"""Both engines and the checker on random parts on plates; a few in every run, many by ``make prove``."""

from __future__ import annotations

from pathlib import Path
from random import Random

import numpy as np
import pytest
from numpy.typing import NDArray

from strategies import random_outline
from toolkit_results import checked
from workhold import Plate, Query, Result, answer
from workhold.algebra.engine import answer_by_algebra


def in_order(result: Result) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Directions, holes and faces of fixtures (N, 13), and angle, place and travel (N, 4), in an order of their own."""
    table = result.table
    whole = np.column_stack([table.arrangement, table.column, table.row, table.face]).astype(np.int64)
    turn = np.cos(table.theta) + 2.0 * np.sin(table.theta)
    poses = np.column_stack([turn, table.position, table.jaw_separation])
    order = np.lexsort([np.round(poses[:, 0], 4), *whole.T[::-1]])
    return whole[order], poses[order]


def compare(seed: int, path: Path) -> None:
    """One part on one plate: the same list by both engines, each fixture beyond reproach."""
    random = Random(seed)
    workpiece = random_outline(random, 3 + seed % 8)
    pitch = random.choice([12.0, 15.0, 20.0]), random.choice([12.0, 15.0, 20.0])
    travel = random.choice([None, None, (2.0, 15.0), (5.0, 40.0)])
    columns, rows = random.choice([(None, None), (5, 4), (3, 6)])
    radius = random.choice([1.0, 2.0, 3.5])
    directions = random.choice([["-x"], ["+x"], ["-y"], ["-x", "+y"]])
    plate = Plate(pitch, radius, columns=columns, rows=rows, travel=travel, directions=directions)
    one, other = answer(Query(workpiece, plate)), answer_by_algebra(Query(workpiece, plate))
    assert one.proof is not None and one.proof.undecided == ()
    (whole, poses), (whole_too, poses_too) = in_order(one), in_order(other)
    assert np.array_equal(whole, whole_too)
    assert np.allclose(poses, poses_too, atol=1e-6)
    checked(one, path)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("seed", range(3))
def test_the_algebra_lists_the_same(seed: int, tmp_path: Path) -> None:
    compare(seed, tmp_path / "result.json")


@pytest.mark.prove
@pytest.mark.parametrize("seed", range(3, 43))
def test_the_algebra_lists_the_same_of_many(seed: int, tmp_path: Path) -> None:
    compare(seed, tmp_path / "result.json")
